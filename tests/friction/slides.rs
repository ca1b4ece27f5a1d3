//! Loads beyond what friction holds, although forces within the cones balance them: named with the part that is held, at the price of a few
//! held loads.

use feti_contact::linalg::Matrix;
use feti_contact::qp::friction::{FrictionSolution, FrictionStart, Node};
use feti_contact::qp::Verdict;

use crate::friction::problem::{Given, Random};

/// A floating body on k nodes, pressed down by 1 and pushed along by `push`, and a spring across, which could press as much as friction
/// needs.
fn block(seed: u64, k: usize, mu: f64, push: f64) -> Given {
    let mut random = Random::new(seed);
    let m = 2 * k + 1;
    let (within, d) = (random.positive(2 * k, 0.3), random.vector(2 * k));
    let entry = |i: usize, j: usize| match (i < 2 * k, j < 2 * k) {
        (true, true) => within.get(i, j),
        (false, false) => 1.0,
        _ => 0.0,
    };
    let f = Matrix::from_fn(m, m, entry).unwrap();
    let d: Vec<f64> = d.iter().map(|d| 0.1 * d).chain([0.0]).collect();
    let nodes = (0..k).map(|i| Node::new(Some(2 * i), &[2 * i + 1], mu, 0.0).unwrap()).collect();
    let by = 1.0 / (k as f64).sqrt();
    let along = |which: usize| (0..2 * k).map(move |i| if i % 2 == which { by } else { 0.0 });
    let g = [along(0).chain([1.0]).collect::<Vec<f64>>(), along(1).chain([0.0]).collect()];
    Given::new(f, d, nodes).floating(&g, vec![1.0, push])
}

fn solved(given: &Given) -> FrictionSolution {
    given.from(FrictionStart::default(), 1e-9, 400)
}

/// While it slides the normal forces do not depend on the push: what far more than enough has held is the limit.
#[test]
fn a_push_just_beyond_what_friction_holds_is_a_slide_at_the_price_of_a_few_held_loads() {
    let (mut named, mut of, mut prices) = (0, 0, Vec::new());
    for seed in 0..60 {
        let (k, mu) = (2 + seed as usize % 11, [0.1, 0.3, 0.6, 1.0][seed as usize / 11 % 4]);
        let far = solved(&block(seed, k, mu, 3.0));
        let Some(slide) = far.slide else { panic!("{seed}: {:?} {:?}", far.verdict, far.counts) };
        let limit = 3.0 * slide.capacity;
        let held = solved(&block(seed, k, mu, 0.9 * limit));
        assert_eq!(held.verdict, Verdict::Solved, "{seed}");
        for over in [1.0001, 1.001, 1.01, 1.05, 1.5] {
            let found = solved(&block(seed, k, mu, over * limit));
            of += 1;
            let price = found.counts.products as f64 / held.counts.products as f64;
            prices.push(price);
            match found.slide {
                Some(slide) => {
                    assert_eq!(found.verdict, Verdict::Stalled, "{seed} {over}");
                    assert!((slide.capacity - 1.0 / over).abs() < 1e-4, "{seed} {over}: {}", slide.capacity);
                    named += 1;
                }
                None => println!("{seed} {over}: {:?} {:?} {}", found.verdict, found.counts, found.merit),
            }
        }
    }
    prices.sort_by(f64::total_cmp);
    let (median, worst) = (prices[prices.len() / 2], prices[prices.len() - 1]);
    println!("{named} of {of}, price {median} held loads, at most {worst}");
    assert!(named * 100 >= 99 * of && median <= 20.0, "{named} of {of}, {median}");
}
