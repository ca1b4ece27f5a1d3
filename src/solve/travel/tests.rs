use super::*;
use crate::body::{GeneralizedInverse, Local, LocalDual, Modes, NullSpaceInput, Seen};
use crate::linalg::Symmetric;
use crate::qp::AnswerFace;

/// Null space, metric, grounded unknowns.
type OfBody<'a> = (&'a Matrix, &'a [f64], &'a [u32]);

/// Runs `work` with these bodies, whose unknowns are all touched.
fn with_bodies<T>(of: &[OfBody], work: impl FnOnce(&Locals, &Touched) -> T) -> T {
    let (mut ranges, mut matrices) = (Vec::new(), Vec::new());
    for (_, metric, _) in of {
        let (n, first) = (metric.len(), ranges.last().map_or(0, |range: &Range<usize>| range.end));
        ranges.push(first..first + n);
        matrices.push(Symmetric::new((0..=n).collect(), (0..n as u32).collect::<Vec<_>>(), metric.to_vec()));
    }
    let none = |n: usize| NullSpaceInput { vectors: Matrix::zeros(n, 0).unwrap(), modes: Modes::Exact };
    let made = |k: &Symmetric| GeneralizedInverse::plan(k.clone().into(), &none(k.order()), 1e-8)?.execute();
    let kplus: Vec<_> = matrices.iter().map(|k| made(k).unwrap().inverse).collect();
    let (touched, rows) = (Touched::of(&ranges, 0..ranges.last().unwrap().end), Csr::empty(0));
    let body = |p: usize| {
        let (null_space, metric, grounded) = of[p];
        let dual = LocalDual { kplus: &kplus[p], rows: &rows, metric, island: 1.0, by: 1.0, size: 1.0 };
        let (stiffness, touched, dual) = ((&matrices[p]).into(), touched.on(p), Some(dual));
        Seen::Here(Local {
            stiffness,
            null_space,
            said: None,
            soft: false,
            unit: 1.0,
            grounded,
            touched,
            dual,
        })
    };
    work(&Locals::new((0..of.len()).map(body).collect(), 1), &touched)
}

fn kept(v: &[f64], unknowns: usize) -> Kept {
    Kept::of(v.chunks(unknowns).map(<[f64]>::to_vec).collect())
}

/// Blocks of four unknowns, (x, y) of two points, which slide along x and y and rotate; the unknowns have different
/// weights.
struct FreeBlocks {
    null_space: Matrix,
    count: usize,
    metric: Vec<f64>,
}

impl FreeBlocks {
    fn new(count: usize) -> Self {
        let metric: Vec<f64> = (0..4 * count).map(|i| 1.0 + (i % 3) as f64).collect();
        let null_space =
            Matrix { rows: 4, cols: 3, data: vec![1., 0., 1., 0., 0., 1., 0., 1., 0.3, -1., 0.7, 1.] };
        Self { null_space, count, metric }
    }

    /// The answer, its amplitudes from u on, and the dimension of the kernel.
    fn solve(&self, rows: &Csr, gaps: &[f64], lambda: &[f64], u: &[f64]) -> (Rest, usize) {
        let mut g_transposed = Csr::empty(3 * self.count);
        for i in 0..rows.rows() {
            let mut row = vec![0.0; 3 * self.count];
            for (unknown, b) in rows.row(i) {
                (0..3).for_each(|j| row[3 * (unknown / 4) + j] += b * self.null_space.get(unknown % 4, j));
            }
            g_transposed.push_row(row.into_iter().enumerate().filter(|(_, v)| *v != 0.0));
        }
        let held: Vec<bool> = lambda.iter().map(|lambda| *lambda <= 0.0).collect();
        let amplitudes = AnswerFace::new(&g_transposed, &[], &held, 1.5e-14).unwrap().undetermined().unwrap();
        let modes: Vec<_> = (0..self.count).map(|p| 3 * p..3 * p + 3).collect();
        let bodies: Vec<_> =
            self.metric.chunks(4).map(|metric| (&self.null_space, metric, &[][..])).collect();
        let rest = with_bodies(&bodies, |bodies, touched| {
            let open = OpenMotions {
                bodies,
                modes: &modes,
                rounding: 1e-14,
                amplitudes: &amplitudes,
                touched,
                rows,
                gaps,
                compliance: &vec![0.0; gaps.len()],
                lambda,
            };
            travel(&open, &kept(u, 4), vec![0.0; 3 * self.count]).unwrap()
        });
        (rest, amplitudes.cols)
    }

    fn length(&self, u: &[f64]) -> f64 {
        u.iter().zip(&self.metric).map(|(u, d)| d * u * u).sum::<f64>().sqrt()
    }
}

/// Block 0 stands on two closed rows and slides along x; a wall stops it on the way back, at x = 0.25.
#[test]
fn a_block_slides_back_as_far_as_the_wall_allows_whatever_the_start() {
    let blocks = FreeBlocks::new(1);
    let mut rows = Csr::empty(4);
    rows.push_row([(1, -1.0)]);
    rows.push_row([(3, -1.0)]);
    rows.push_row([(0, -1.0)]);
    rows.push_row([(2, 1.0)]);
    for (slide, wall) in [(3.0, -0.25), (1e6, -0.25), (0.5, f64::INFINITY), (1e9, 1e30)] {
        let u = [slide, 0.1, slide + 0.01, -0.1];
        let (at_rest, free) = blocks.solve(&rows, &[-0.1, 0.1, wall, 1e20], &[1.0, 2.0, 0.0, 0.0], &u);
        let x = at_rest.u.at_rows[0];
        assert!(free == 1 && (at_rest.u.at_rows[2] - x - 0.01).abs() < 1e-9 * slide, "{free} {x}");
        assert!((at_rest.u.at_rows[1] - 0.1).abs().max((at_rest.u.at_rows[3] + 0.1).abs()) <= 1e-15 * slide);
        // without the wall: x + 3 (x + 0.01) = 0, the weights being 1 and 3
        let expected = if wall < 0.0 { 0.25 } else { -0.03 / 4.0 };
        assert!((x - expected).abs() <= 1e-15 * slide + 1e-15, "{slide} {wall}: {x}");
        assert!((at_rest.amplitudes[0] - (x - slide)).abs() <= 1e-15 * slide);
    }
}

/// Loose blocks: each returns separately, and a second solve changes nothing.
#[test]
fn three_hundred_loose_blocks_go_back_and_stay() {
    let blocks = FreeBlocks::new(300);
    let mut rows = Csr::empty(1200);
    let (mut gaps, mut lambda) = (Vec::<f64>::new(), Vec::<f64>::new());
    for p in 0..300 {
        rows.push_row([(4 * p + 1, -1.0)]);
        rows.push_row([(4 * p + 3, -1.0)]);
        gaps.extend([0.0, 0.0]);
        lambda.extend([1.0, f64::from(p % 2 == 0)]);
        if p > 0 {
            rows.push_row([(4 * p - 2, 1.0), (4 * p, -1.0)]);
            gaps.push(0.5);
            lambda.push(0.0);
        }
    }
    let elastic: Vec<f64> =
        (0..1200).map(|i| if i % 2 == 1 { 0.0 } else { 0.2 * (i as f64).sin() }).collect();
    let mut answers = Vec::new();
    for travelled in [0.0, 1.0, 1e5] {
        let mut u = elastic.clone();
        (0..300).for_each(|p| [4 * p, 4 * p + 2].iter().for_each(|&i| u[i] += travelled * (p as f64).cos()));
        // gaps at rows that the start violates: the row keeps its violation
        let open: Vec<f64> = (0..rows.rows())
            .map(|i| if lambda[i] > 0.0 { gaps[i] } else { gaps[i].max(rows.row_dot(i, &u)) })
            .collect();
        let gaps_now = if travelled == 0.0 { gaps.clone() } else { open };
        let (Rest { u: answer, .. }, free) = blocks.solve(&rows, &gaps_now, &lambda, &u);
        let answer = answer.at_rows;
        assert_eq!(free, 150 + 2 * 150);
        let met = |i: usize| rows.row_dot(i, &answer) <= gaps_now[i] + 1e-15 * (1.0 + travelled);
        assert!((0..rows.rows()).filter(|&i| lambda[i] == 0.0).all(met));
        assert!(blocks.length(&answer) <= blocks.length(&u));
        let (again, _) = blocks.solve(&rows, &gaps_now, &lambda, &answer);
        let further =
            again.u.at_rows.iter().zip(&answer).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(further <= 1e-14 * (1.0 + travelled), "{further:e}");
        answers.push(answer);
    }
    let far = answers[0].iter().zip(&answers[2]).fold(0.0f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(far < 1.0, "{far}");
}

/// A motion is exactly 0 on a grounded unknown, and grounded unknowns do not change its rows.
#[test]
fn grounded_unknowns_stay_to_the_last_bit() {
    let null_space = Matrix { rows: 3, cols: 1, data: vec![1.0, 1.0, 1e-20] };
    let mut rows = Csr::empty(3);
    rows.push_row([(0, 1.0), (2, -1.0)]);
    with_bodies(&[(&null_space, &[1.0, 1.0, 1e20], &[2])], |bodies, touched| {
        let open = OpenMotions {
            bodies,
            modes: std::slice::from_ref(&(0..1)),
            rounding: 1e-14,
            amplitudes: &Matrix { rows: 1, cols: 1, data: vec![2.0] },
            touched,
            rows: &rows,
            gaps: &[1.0],
            compliance: &[0.0],
            lambda: &[0.0],
        };
        for start in [0.0, 1.0, 1e10] {
            let at_rest = travel(&open, &kept(&[-5.0, -5.0, -2.0], 3), vec![start]).unwrap();
            assert_eq!(at_rest.u.at_rows, [-1.0, -1.0, -2.0]);
            assert_eq!(at_rest.amplitudes, [4.0]);
        }
    });
}

/// A soft spring to a stiff unknown: the pair moves together.
#[test]
fn a_grounded_unknown_that_hangs_on_another_moves_with_it() {
    let null_space = Matrix { rows: 2, cols: 1, data: vec![1.0, 1.0] };
    let at_rest = with_bodies(&[(&null_space, &[1.0, 1e-3], &[1])], |bodies, touched| {
        let open = OpenMotions {
            bodies,
            modes: std::slice::from_ref(&(0..1)),
            rounding: 1e-14,
            amplitudes: &Matrix { rows: 1, cols: 1, data: vec![1.0] },
            touched,
            rows: &Csr::empty(2),
            gaps: &[],
            compliance: &[],
            lambda: &[],
        };
        travel(&open, &kept(&[-5.0, -1000.0], 2), vec![2.0]).unwrap()
    });
    // a - 5 + 1e-3 (a - 1000) = 0
    let a = 6.0 / 1.001;
    assert!((at_rest.amplitudes[0] - a).abs() < 1e-13);
    let u = &at_rest.u.at_rows;
    assert!((u[0] - (a - 5.0)).abs() < 1e-13 && (u[1] - (a - 1000.0)).abs() < 1e-11);
}
