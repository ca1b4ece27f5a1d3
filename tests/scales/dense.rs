//! A second solver for small problems of held bodies: dense, by active sets, refined with residuals in twice the precision.

use decks::Deck;

use crate::scales::largest;

/// Entries by rows.
pub struct Dense {
    pub n: usize,
    pub entries: Vec<f64>,
}

impl Dense {
    pub fn zeros(n: usize) -> Dense {
        Dense { n, entries: vec![0.0; n * n] }
    }

    pub fn row(&self, i: usize) -> &[f64] {
        &self.entries[i * self.n..(i + 1) * self.n]
    }
}

/// b - sum a_k x_k with every product and sum exact to twice the precision (Ogita, Rump, Oishi 2005, Dot2).
fn residual(b: f64, a: &[f64], x: &[f64]) -> f64 {
    let (mut sum, mut rest) = (b, 0.0);
    for (a, x) in a.iter().zip(x) {
        let product = -a * x;
        let lost = (-a).mul_add(*x, -product);
        let next = sum + product;
        let part = next - sum;
        rest += (sum - (next - part)) + (product - part) + lost;
        sum = next;
    }
    sum + rest
}

/// LU with rows exchanged, equilibrated by the largest entry of each row.
struct Factors {
    lu: Dense,
    rows: Vec<usize>,
}

impl Factors {
    fn of(a: &Dense) -> Factors {
        let n = a.n;
        let (mut lu, mut rows) = (Dense { n, entries: a.entries.clone() }, (0..n).collect::<Vec<_>>());
        let scale: Vec<f64> = (0..n).map(|i| largest(a.row(i))).collect();
        for k in 0..n {
            let size = |i: usize| lu.entries[rows[i] * n + k].abs() / scale[rows[i]];
            let best = (k..n).max_by(|i, j| size(*i).total_cmp(&size(*j))).unwrap();
            assert!(size(best) > 1e-15, "the reference meets a singular matrix");
            rows.swap(k, best);
            let pivot = lu.row(rows[k])[k..].to_vec();
            for i in &rows[k + 1..] {
                let row = &mut lu.entries[i * n + k..(i + 1) * n];
                row[0] /= pivot[0];
                let factor = row[0];
                row[1..].iter_mut().zip(&pivot[1..]).for_each(|(r, p)| *r -= factor * p);
            }
        }
        Factors { lu, rows }
    }

    fn solve(&self, b: &[f64]) -> Vec<f64> {
        let n = self.lu.n;
        let mut x: Vec<f64> = self.rows.iter().map(|i| b[*i]).collect();
        for i in 0..n {
            let row = self.lu.row(self.rows[i]);
            x[i] -= crate::scales::dot(&row[..i], &x[..i]);
        }
        for i in (0..n).rev() {
            let row = self.lu.row(self.rows[i]);
            x[i] = (x[i] - crate::scales::dot(&row[i + 1..], &x[i + 1..])) / row[i];
        }
        x
    }
}

/// a x = b, refined four times.
pub fn solve(a: &Dense, b: &[f64]) -> Vec<f64> {
    let factors = Factors::of(a);
    let mut x = factors.solve(b);
    for _ in 0..4 {
        let rest: Vec<f64> = (0..a.n).map(|i| residual(b[i], a.row(i), &x)).collect();
        x.iter_mut().zip(factors.solve(&rest)).for_each(|(x, d)| *x += d);
    }
    x
}

/// u and lambda of the face `closed`: K u + B'lambda = f, b_i u = c_i on its rows, lambda_i = 0 elsewhere.
fn on_face(deck: &Deck, closed: &[bool]) -> (Vec<f64>, Vec<f64>) {
    let rows: Vec<usize> = (0..closed.len()).filter(|i| closed[*i]).collect();
    let n = deck.dofs();
    let mut kkt = Dense::zeros(n + rows.len());
    let order = kkt.n;
    for (p, body) in deck.bodies.iter().enumerate() {
        let first = deck.offset(p);
        for i in 0..body.dofs() {
            body.stiffness.row(i).for_each(|(j, k)| kkt.entries[(first + i) * order + first + j] = k);
        }
    }
    let mut rhs = deck.load();
    for (k, row) in rows.iter().enumerate() {
        for (dof, b) in deck.contact.matrix.row(*row) {
            kkt.entries[(n + k) * order + dof] = b;
            kkt.entries[dof * order + n + k] = b;
        }
        rhs.push(deck.contact.rhs[*row]);
    }
    let mut u = solve(&kkt, &rhs);
    let mut lambda = vec![0.0; closed.len()];
    rows.iter().zip(u.split_off(n)).for_each(|(row, force)| lambda[*row] = force);
    (u, lambda)
}

/// u and lambda of the optimal face, found from the face given by exchanging the first row that is wrong (Murty 1974), which
/// ends for every problem whose bodies are held and whose rows are independent.
pub fn optimum(deck: &Deck, mut closed: Vec<bool>) -> (Vec<f64>, Vec<f64>) {
    assert!(deck.equalities.is_empty() && deck.bodies.iter().all(|body| body.modes().is_empty()));
    for _ in 0..10_000 {
        let (u, lambda) = on_face(deck, &closed);
        let moved = deck.contact.matrix.times(&u);
        let (force, length) = (largest(&lambda), largest(&u));
        let wrong = |i: &usize| {
            if closed[*i] {
                lambda[*i] < -1e-13 * force
            } else {
                moved[*i] - deck.contact.rhs[*i] > 1e-13 * length
            }
        };
        match (0..closed.len()).find(wrong) {
            None => return (u, lambda),
            Some(i) => closed[i] = !closed[i],
        }
    }
    panic!("{}: the reference finds no optimal face", deck.name);
}

/// lambda >= 0 with F lambda >= `over` and no force where a row is open, the same way from the face given.
pub fn dual_optimum(f: &Dense, over: &[f64], mut closed: Vec<bool>) -> Vec<f64> {
    for _ in 0..10_000 {
        let rows: Vec<usize> = (0..f.n).filter(|i| closed[*i]).collect();
        let entries = rows.iter().flat_map(|i| rows.iter().map(|j| f.row(*i)[*j])).collect();
        let rhs: Vec<f64> = rows.iter().map(|i| over[*i]).collect();
        let mut lambda = vec![0.0; f.n];
        let forces = solve(&Dense { n: rows.len(), entries }, &rhs);
        rows.iter().zip(forces).for_each(|(row, force)| lambda[*row] = force);
        let (force, length) = (largest(&lambda), largest(over));
        let wrong = |i: &usize| {
            if closed[*i] {
                lambda[*i] < -1e-12 * force
            } else {
                over[*i] - crate::scales::dot(f.row(*i), &lambda) > 1e-12 * length
            }
        };
        match (0..f.n).find(wrong) {
            None => return lambda,
            Some(i) => closed[i] = !closed[i],
        }
    }
    panic!("the reference finds no optimal face");
}

/// Spring 3 pushed by 4 against a wall at 1/2, and one pushed by 1 that does not reach its wall: lambda = 4 - 3/2 and 0.
#[test]
fn the_reference_finds_the_face_of_two_springs_from_any_other() {
    use decks::small::Obstacle;
    let springs = [4.0, 1.0].map(|force| Obstacle { spring: 3.0, force, gap: 0.5 }.build().deck);
    let deck = crate::scales::plane::side_by_side(&springs);
    for face in [[false, false], [true, true], [true, false], [false, true]] {
        let (u, lambda) = optimum(&deck, face.to_vec());
        assert!(
            crate::scales::distance(&u, &[0.5, 1.0 / 3.0]) < 1e-15
                && crate::scales::distance(&lambda, &[2.5, 0.0]) < 1e-14
        );
    }
}
