//! Correct answers of the dense models by elimination, with friction by the states of its nodes.

use super::model::{solve, DenseAnswer, DenseModel, DenseRows};
use crate::constraints::FrictionNode;

#[derive(Clone, Default)]
pub struct DenseNode {
    /// Contact row.
    pub normal: Option<usize>,
    /// One or two tangential rows.
    pub rows: Vec<Vec<(usize, f64)>>,
    /// s_old, length, one or two.
    pub old: Vec<f64>,
    /// C_t, length / force.
    pub compliance: f64,
    pub coefficient: f64,
    /// Force.
    pub bound: f64,
}

/// Direction of a slip; none: the node sticks.
type Along = Option<[f64; 2]>;

impl DenseModel {
    /// Tangential rows with s_old as right-hand sides.
    pub fn tangential(&self) -> DenseRows {
        let of = |node: &DenseNode| {
            let rows = node.rows.iter().zip(&node.old);
            rows.map(|(row, old)| (row.clone(), *old, node.compliance)).collect::<Vec<_>>()
        };
        self.nodes.iter().flat_map(of).collect()
    }

    pub fn laws(&self) -> Vec<FrictionNode> {
        let mut next = 0;
        let of = |node: &DenseNode| {
            let (first, count) = (next, node.rows.len());
            next += count;
            let DenseNode { normal, coefficient, bound, .. } = *node;
            FrictionNode { normal, first, count, coefficient, bound }
        };
        self.nodes.iter().map(of).collect()
    }

    /// `s = T u - s_old - C_t lambda_t` of every node.
    pub fn slips(&self, answer: &DenseAnswer) -> Vec<[f64; 2]> {
        let rows = DenseModel::rows(&self.tangential(), self.unknowns());
        let of = |node: FrictionNode| {
            let mut slip = [0.0; 2];
            node.rows()
                .zip(&mut slip)
                .for_each(|(i, s)| *s = -rows.open_gap(i, &answer.u, answer.tangential[i]));
            slip
        };
        self.laws().into_iter().map(of).collect()
    }

    /// The answer with the forces of the active rows and the states by the law of friction: a node sticks if `lambda_t +
    /// k s` is in its disc; otherwise this vector is the direction of its slip.
    pub fn answer(&self) -> DenseAnswer {
        let mut along: Vec<Along> = vec![None; self.nodes.len()];
        let k = self.parts.iter().map(|part| part.k[0][0]).fold(f64::INFINITY, f64::min) / 4.0;
        for _ in 0..5000 {
            let answer = self.with_states(&along);
            let (slips, mut change) = (self.slips(&answer), 0.0);
            for ((law, slip), along) in self.laws().into_iter().zip(slips).zip(&mut along) {
                let mut moved = slip.map(|s| k * s);
                law.rows().zip(&mut moved).for_each(|(i, x)| *x += answer.tangential[i]);
                let (size, bound) = (moved[0].hypot(moved[1]), law.limit(&answer.lambda));
                // the force of a slipping node comes from this direction: it continues to slip if the force is exactly at
                // the bound
                let next = (size > bound * (1.0 + 1e-14)).then(|| moved.map(|x| x / size));
                change = f64::max(
                    change,
                    match (&along, next) {
                        (Some(old), Some(new)) => (old[0] - new[0]).hypot(old[1] - new[1]),
                        (None, None) => 0.0,
                        _ => 1.0,
                    },
                );
                *along = next;
            }
            if change <= 1e-13 {
                return answer;
            }
        }
        panic!("no states of the nodes: {along:?}");
    }

    /// The answer for given slip directions; none: the node sticks.
    fn with_states(&self, along: &[Along]) -> DenseAnswer {
        let (n, tangential, laws) = (self.unknowns(), self.tangential(), self.laws());
        let sticking: Vec<usize> = laws
            .iter()
            .zip(along)
            .filter(|(_, along)| along.is_none())
            .flat_map(|(law, _)| law.rows())
            .collect();
        let active = self.active.iter().map(|&i| &self.contact[i]);
        let rows: Vec<_> =
            active.chain(&self.equalities).chain(sticking.iter().map(|&i| &tangential[i])).collect();
        let m = rows.len();
        let mut a = vec![vec![0.0; n + m]; n + m];
        let (mut b, mut start) = (vec![0.0; n + m], 0);
        for part in &self.parts {
            for i in 0..part.k.len() {
                a[start + i][start..start + part.k.len()].copy_from_slice(&part.k[i]);
                b[start + i] = part.load[i];
            }
            start += part.k.len();
        }
        for (i, (entries, rhs, compliance)) in rows.iter().enumerate() {
            for &(j, v) in entries {
                a[n + i][j] = v;
                a[j][n + i] = v;
            }
            a[n + i][n + i] = -compliance;
            b[n + i] =
                rhs - entries.iter().map(|&(j, v)| v * self.travel.get(j).unwrap_or(&0.0)).sum::<f64>();
        }
        let place = |normal: Option<usize>| self.active.iter().position(|&i| Some(i) == normal);
        for (law, along) in laws.iter().zip(along) {
            for (i, along) in law.rows().zip(along.iter().flatten()) {
                for &(j, v) in &tangential[i].0 {
                    b[j] -= v * along * law.bound;
                    place(law.normal).into_iter().for_each(|k| a[j][n + k] += v * along * law.coefficient);
                }
            }
        }
        let mut x = solve(&a, &b);
        x.iter_mut().zip(&self.travel).for_each(|(x, t)| *x += t);
        let mut lambda = vec![0.0; self.contact.len()];
        self.active.iter().enumerate().for_each(|(k, &i)| lambda[i] = x[n + k]);
        let (first, mut forces) =
            (n + self.active.len() + self.equalities.len(), vec![0.0; tangential.len()]);
        for (law, along) in laws.iter().zip(along) {
            let bound = law.limit(&lambda);
            law.rows().zip(along.iter().flatten()).for_each(|(i, along)| forces[i] = bound * along);
        }
        sticking.iter().zip(&x[first..]).for_each(|(&i, force)| forces[i] = *force);
        let mu = x[n + self.active.len()..first].to_vec();
        DenseAnswer { u: x[..n].to_vec(), lambda, mu, tangential: forces }
    }
}
