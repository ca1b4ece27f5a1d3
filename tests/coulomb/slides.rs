//! Slides against all combinations of states: where bodies may rest they do not slide, and where they slide it is said.

use decks::random::Random;
use decks::rubbing::Rubbing;
use decks::{Body, Csr, Deck};
use feti_contact::error::Kind;
use feti_contact::solver::Outcome;

use crate::coulomb::enumeration::{answers, slides};
use crate::support::hand_over;

/// A floating body in the plane: two unknowns a point.
fn body(dense: &[Vec<f64>], modes: Option<Vec<Vec<f64>>>, load: Vec<f64>) -> Body {
    let n = dense.len();
    let mut stiffness = Csr::empty(n);
    for row in dense {
        stiffness.push_row(&row.iter().copied().enumerate().collect::<Vec<_>>());
    }
    Body {
        stiffness,
        null_space: modes,
        load,
        coordinates: vec![[0.0; 3]; n],
        node: (0..n).map(|i| i as i32 / 2 + 1).collect(),
        direction: (0..n).map(|i| i as i32 % 2 + 1).collect(),
    }
}

/// A bar along x on a floor below both ends: contact rows give way by 1/1000, a spring of 1 across the floor could press as much as
/// friction needs.
fn bar(k: f64, over: f64) -> Deck {
    let (mu, press) = (0.5, 5.0);
    let push = over * mu * press;
    let dense = [vec![k, 0.0, -k, 0.0], vec![0.0; 4], vec![-k, 0.0, k, 0.0], vec![0.0; 4]];
    let modes = vec![vec![1.0, 0.0, 1.0, 0.0], vec![0.0, 1.0, 0.0, 1.0], vec![0.0, 0.0, 0.0, 1.0]];
    let mut deck = Deck::new("bar", vec![body(&dense, Some(modes), vec![push, -press, push, -press])]);
    for end in 0..2 {
        deck.contact.push_compliant(&[(2 * end + 1, -1.0)], 0.0, 1e-3);
        deck.friction.push(Some(end), &[&[(2 * end, 1.0)]], mu, 0.0);
    }
    deck.equalities.push_compliant(&[(1, 0.5), (3, 0.5)], 0.0, 1.0);
    deck
}

/// By hand: the floor of stiffness 2000 and the spring of 1 share the load of 10.
#[test]
fn a_bar_slides_just_beyond_mu_and_what_is_held_is_known() {
    for stiffness in [1.0, 1e3, 1e6] {
        for over in [1.0001, 1.001, 1.01, 1.05, 1.3, 2.0] {
            for sense in [1.0, -1.0] {
                let mut problem = hand_over::problem(&bar(stiffness, sense * over)).unwrap();
                let error = problem.solve().map(|report| report.outcome).unwrap_err();
                assert_eq!(error.kind, Kind::Slides, "{over} {error}");
                let (capacity, want) =
                    (problem.findings().unwrap().capacity.unwrap(), 2000.0 / 2001.0 / over);
                assert!((capacity - want).abs() < 1e-4, "{over}: {capacity} for {want}");
            }
        }
        let mut problem = hand_over::problem(&bar(stiffness, 0.999)).unwrap();
        assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    }
}

/// Bars between all of k points, each a node with friction on a floor of its own.
fn frame(random: &mut Random, k: usize) -> Deck {
    let points: Vec<[f64; 2]> = (0..k).map(|_| [random.uniform(), random.uniform()]).collect();
    let mut dense = vec![vec![0.0; 2 * k]; 2 * k];
    for (i, j) in (0..k).flat_map(|i| (i + 1..k).map(move |j| (i, j))) {
        let (x, y) = (points[i][0] - points[j][0], points[i][1] - points[j][1]);
        let (length, stiffness) = (x.hypot(y), 1.0 + random.uniform());
        let along = [(2 * i, x), (2 * i + 1, y), (2 * j, -x), (2 * j + 1, -y)];
        for (a, va) in along {
            along.iter().for_each(|&(b, vb)| dense[a][b] += stiffness * (va / length) * (vb / length));
        }
    }
    let motion = |of: &dyn Fn(usize) -> [f64; 2]| (0..k).flat_map(of).collect::<Vec<f64>>();
    let modes =
        vec![motion(&|_| [1.0, 0.0]), motion(&|_| [0.0, 1.0]), motion(&|i| [-points[i][1], points[i][0]])];
    let load = random.normals(2 * k, 0.5);
    let mut deck = Deck::new("frame", vec![body(&dense, Some(modes), load)]);
    for i in 0..k {
        let (s, c) = (6.3 * random.uniform()).sin_cos();
        let gap = if random.chance(0.5) { 0.0 } else { random.uniform() };
        let mu = [0.1, 0.6, 1.0, 2.0, 4.0][random.below(5)];
        deck.contact.push(&[(2 * i, c), (2 * i + 1, s)], gap);
        deck.friction.push(Some(i), &[&[(2 * i, -s), (2 * i + 1, c)]], mu, 0.0);
    }
    deck
}

/// Some rest, some slide, some might do either, and then it is a rest that is found.
#[test]
fn small_frames_slide_only_where_they_cannot_rest() {
    let asked = |name: &str, instead: u64| std::env::var(name).map_or(instead, |text| text.parse().unwrap());
    let (first, most) = (asked("BATTERY_SEED", 0), asked("BATTERY", 3000));
    let (mut rests, mut both, mut sliding, mut named, mut stalled) = (0, 0, 0, 0, 0);
    for seed in first..first + most {
        let deck = frame(&mut Random::new(seed), 2 + seed as usize % 3);
        let (Some(rest), Some((slide, doubtful))) = (answers(&deck), slides(&deck)) else { continue };
        let ended =
            hand_over::problem(&deck).and_then(|mut problem| problem.solve().map(|report| report.outcome));
        let kind = ended.as_ref().err().map(|error| error.kind);
        let is_solved = ended.as_ref().is_ok_and(|outcome| *outcome == Outcome::Solved);
        let is_stalled = ended.as_ref().is_ok_and(|outcome| *outcome == Outcome::Stalled);
        stalled += usize::from(is_stalled);
        let text = format!("{seed}: {} rests, slides {slide:?}, ended {ended:?}", rest.answers.len());
        if !rest.answers.is_empty() {
            rests += 1;
            both += usize::from(!slide.is_empty());
            assert!(kind != Some(Kind::Slides), "{text}");
            if !is_solved {
                println!("{text}");
            }
        } else if !slide.is_empty() && !doubtful && !rest.doubtful && kind != Some(Kind::LoadNotHeld) {
            sliding += 1;
            named += usize::from(kind == Some(Kind::Slides));
            if kind != Some(Kind::Slides) {
                println!("{text}");
            }
        }
    }
    println!("{rests} may rest, {both} of them slide too; {named} named of {sliding} that slide; {stalled} stalled");
    assert!(rests as u64 > most / 20, "{rests}");
    assert!(
        1000 * stalled as u64 <= 2 * most && 100 * named >= 95 * sliding,
        "{stalled}, {named} of {sliding}"
    );
}

/// Blocks on each other in space, all interfaces as strong, pushed obliquely: where the load passes what the cones hold, some of them
/// stay together although their friction is at its bound.
#[test]
fn blocks_pushed_just_beyond_their_cones_are_named_and_just_below_held() {
    for (blocks, mu, height) in [(3, 0.6, 0.0449), (2, 0.1, 0.1457), (3, 0.3, 0.0493), (1, 0.3, 0.3)] {
        for load in [0.9999, 1.0001, 1.001, 1.1] {
            let deck = Rubbing { height, ..Rubbing::new(3, 4, blocks, mu, load) }.build();
            let ended = hand_over::problem(&deck)
                .and_then(|mut problem| problem.solve().map(|report| report.outcome));
            let right = match &ended {
                Ok(outcome) => load < 1.0 && *outcome == Outcome::Solved,
                Err(error) => load > 1.0 && error.kind == Kind::LoadNotHeld,
            };
            assert!(right, "{} height {height}: {ended:?}", deck.name);
        }
    }
}

/// A frame that may slide and has one rest, whose gaps are far larger than what its states are measured by.
#[test]
fn a_rest_known_only_to_the_rounding_of_a_far_way_is_found() {
    for seed in [199000529, 199007178] {
        let deck = frame(&mut Random::new(seed), 2 + seed as usize % 3);
        assert_eq!(answers(&deck).unwrap().answers.len(), 1, "{seed}");
        let ended = hand_over::problem(&deck).and_then(|mut problem| problem.solve());
        assert_eq!(ended.unwrap().outcome, Outcome::Solved, "{seed}");
    }
}
