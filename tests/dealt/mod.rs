//! Bodies, rows and nodes dealt out at random to ranks, which are threads here: the bits of one rank, and those of a problem that is given in
//! the order of its numbers.

mod cases;
mod files;
mod glued;
mod large;

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use decks::random::Random;
use decks::{battery, hard, varied, Deck, Rows};
use feti_contact::error::Result;
use feti_contact::solver::{
    serve, Candidate, FrictionInput, Modes, Problem, Rank, Report, RowKind, RowsInput,
};

use crate::support::linked::on_ranks;
use crate::support::{asked, hand_over};
use crate::{coulomb, soft};

/// What a host says of the null space of a body: all of it, motions that are nearly in it, where its nodes lie, or nothing.
#[derive(Clone, Copy)]
enum Motions {
    Exact,
    Soft,
    Placed,
    Unsaid,
}

/// That, and its options.
type Said = (Motions, &'static str);

/// Which bodies, contact rows, equality rows and nodes a rank gives, in its order.
#[derive(Default, Clone)]
struct Hand {
    bodies: Vec<usize>,
    rows: [Vec<usize>; 2],
    nodes: Vec<usize>,
    /// It has nothing, and serves.
    serves: bool,
}

/// The bits of an answer, by the numbers of the deck; or why there is none.
#[derive(Debug, PartialEq)]
struct Bits {
    told: String,
    /// Of every body.
    u: Vec<Vec<u64>>,
    reactions: Vec<Vec<u64>>,
    /// Of every row of each kind.
    forces: [Vec<Vec<u64>>; 3],
    gaps: Vec<Vec<u64>>,
    /// Of every node.
    slips: Vec<Vec<u64>>,
    states: Vec<String>,
    /// Weights of contact and equality rows in a contradiction, or factors of rows that repeat others.
    weights: [Vec<Vec<u64>>; 2],
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|v| v.to_bits()).collect()
}

/// Numbers of the unknowns: of every body the first.
fn firsts(deck: &Deck) -> Vec<usize> {
    let mut firsts = vec![0];
    deck.bodies.iter().for_each(|body| firsts.push(firsts[firsts.len() - 1] + body.dofs()));
    firsts
}

/// Rows as the given ones of a rank; by bodies of this rank if it has all and `by_bodies`, otherwise by numbers.
fn add(
    problem: &mut Problem,
    (deck, hand): (&Deck, &Hand),
    of: &Rows,
    row: &[usize],
    by_bodies: bool,
    add: &mut dyn FnMut(&mut Problem, RowsInput),
) {
    let firsts = firsts(deck);
    let (mut ptr, mut dof, mut val, mut body) = (vec![0], Vec::new(), Vec::new(), Vec::new());
    let mut has_all = by_bodies;
    for &i in row {
        for (j, v) in of.matrix.row(i) {
            let p = firsts[1..].partition_point(|end| *end <= j);
            let own = hand.bodies.iter().position(|q| *q == p);
            has_all &= own.is_some();
            body.push((own.unwrap_or(0) as i64, (j - firsts[p]) as i64));
            dof.push(j as i64);
            val.push(v);
        }
        ptr.push(dof.len());
    }
    let (bodies, dofs): (Vec<i64>, Vec<i64>) = body.into_iter().unzip();
    let rhs: Vec<f64> = row.iter().map(|i| of.rhs[*i]).collect();
    let input = match has_all {
        true => RowsInput { ptr: &ptr, body: Some(&bodies), dof: &dofs, val: &val, rhs: Some(&rhs) },
        false => RowsInput { ptr: &ptr, body: None, dof: &dof, val: &val, rhs: Some(&rhs) },
    };
    add(problem, input);
}

/// Gives the part of a rank.
fn give(problem: &mut Problem, deck: &Deck, hand: &Hand, (motions, options): Said) {
    problem.offer_method(&paper::Paper);
    problem.set_text(options).unwrap();
    let firsts = firsts(deck);
    for &p in &hand.bodies {
        let body = problem.add_body(deck.bodies[p].dofs()).unwrap();
        hand_over::set_body(problem, body, &deck.bodies[p]).unwrap();
        say(problem, body, &deck.bodies[p], motions);
        let numbers: Vec<i64> = (firsts[p]..firsts[p + 1]).map(|number| number as i64).collect();
        problem.set_numbering(body, &numbers).unwrap();
    }
    for (kind, of) in [(RowKind::Inequality, &deck.contact), (RowKind::Equality, &deck.equalities)] {
        for &i in &hand.rows[kind as usize] {
            add(problem, (deck, hand), of, &[i], i % 3 == 0, &mut |problem, rows| {
                let first = problem.add_rows(kind, rows).unwrap();
                problem.set_compliance(kind, first, &of.compliance[i..=i]).unwrap();
            });
        }
    }
    let friction = &deck.friction;
    for &k in &hand.nodes {
        let own = |row: usize| hand.rows[0].iter().position(|i| *i == row).unwrap() as i64;
        let normal = [friction.normal[k].map_or(-1, own)];
        let rows: Vec<usize> = (k * friction.dim..(k + 1) * friction.dim).collect();
        let of = &friction.rows;
        // as its contact row: the library compares the entries of both
        let by_bodies = friction.normal[k].is_none_or(|row| row % 3 == 0);
        add(problem, (deck, hand), of, &rows, by_bodies, &mut |problem, rows| {
            let (coefficient, bound) = ([friction.coefficient[k]], [friction.bound[k]]);
            let s_old: Vec<f64> = rows.rhs.unwrap().to_vec();
            let rows = RowsInput { rhs: None, ..rows };
            let (coefficient, bound) = (Some(&coefficient[..]), Some(&bound[..]));
            let (dim, normal) = (friction.dim, &normal[..]);
            let first =
                problem.add_friction(FrictionInput { dim, normal, rows, coefficient, bound }).unwrap();
            problem.set_friction_compliance(first, &[of.compliance[k * dim]]).unwrap();
            problem.set_friction_reference(first, 1, dim, &s_old).unwrap();
        });
    }
}

/// A text without what it says in brackets, where rows have the numbers of their ranks.
fn without_numbers(text: &str) -> String {
    match (text.find('('), text.find(')')) {
        (Some(begin), Some(end)) if begin < end => format!("{}{}", &text[..begin], &text[end..]),
        _ => text.split(" and ").next().unwrap_or_default().to_owned(),
    }
}

/// Takes in what a rank has got.
fn take(
    problem: &mut Problem,
    deck: &Deck,
    hand: &Hand,
    rank: usize,
    ended: &Result<Report>,
    all: &mut Bits,
) {
    all.told = match ended {
        Ok(report) => {
            let certificate = &report.certificate;
            let entries: Vec<_> = certificate.entries().iter().map(|of| (of.figure, of.ratio)).collect();
            let figures = [report.unheld, report.gap_scale, report.energy];
            let more = (report.floating_modes, report.active, report.undetermined, report.finished);
            format!(
                "{:?} {entries:?} {:?} {:?} {figures:?} {more:?}",
                report.outcome, report.counts, report.sizes
            )
        }
        Err(error) => {
            let body = error.place.body.map(|body| match error.place.rank {
                Some(of) if of == rank => hand.bodies[body],
                _ => body,
            });
            let named = error.place.rank.is_none_or(|of| of == rank);
            format!(
                "{:?} {} {:?} {:?}",
                error.kind,
                without_numbers(&error.what),
                error.place.value,
                body.filter(|_| named)
            )
        }
    };
    for kind in [RowKind::Inequality, RowKind::Equality] {
        for (row, weight) in problem.findings().iter().flat_map(|of| of.rows(kind)) {
            // rows that have been added again have no numbers of the deck
            let of = hand.rows[kind as usize].get(row);
            of.into_iter().for_each(|of| all.weights[kind as usize][*of] = bits(&[weight]));
        }
    }
    let Ok(u) = problem.displacements().map(<[f64]>::to_vec) else { return };
    let mut at = 0;
    for (body, p) in hand.bodies.iter().enumerate() {
        let n = deck.bodies[*p].dofs();
        all.u[*p] = bits(&u[at..at + n]);
        at += n;
        let mut r = vec![0.0; n];
        if problem.reaction(None, body, &mut r).is_ok() {
            all.reactions[*p] = bits(&r);
        }
    }
    for kind in RowKind::ALL {
        let forces = problem.multipliers(kind).unwrap().to_vec();
        let dim = deck.friction.dim;
        match kind {
            RowKind::Tangential => {
                let each = hand.nodes.iter().zip(forces.chunks(dim.max(1)));
                each.for_each(|(k, own)| all.forces[2][*k] = bits(own));
            }
            kind => {
                let each = hand.rows[kind as usize].iter().zip(&forces);
                each.for_each(|(i, own)| all.forces[kind as usize][*i] = bits(&[*own]));
            }
        }
    }
    let slips = problem.slips().unwrap().to_vec();
    let each = hand.nodes.iter().zip(slips.chunks(deck.friction.dim.max(1)));
    each.for_each(|(k, own)| all.slips[*k] = bits(own));
    let gaps = problem.gaps().unwrap().to_vec();
    hand.rows[0].iter().zip(&gaps).for_each(|(i, own)| all.gaps[*i] = bits(&[*own]));
    let states = problem.active().unwrap().to_vec();
    hand.rows[0].iter().zip(&states).for_each(|(i, own)| all.states[*i] = format!("{own:?}"));
}

fn nothing(deck: &Deck) -> Bits {
    let [contact, equalities] =
        [&deck.contact, &deck.equalities].map(|rows| vec![Vec::new(); rows.rhs.len()]);
    let bodies = vec![Vec::new(); deck.bodies.len()];
    Bits {
        told: String::new(),
        u: bodies.clone(),
        reactions: bodies,
        weights: [contact.clone(), equalities.clone()],
        gaps: contact.clone(),
        slips: vec![Vec::new(); deck.friction.normal.len()],
        states: vec![String::new(); contact.len()],
        forces: [contact, equalities, vec![Vec::new(); deck.friction.normal.len()]],
    }
}

/// Every rank gives its hand; the answers of a first solve, and of a second one with loads once and a quarter as large. With a path it is
/// first written to a file.
fn solved(deck: &Deck, hands: &[Hand], said: Said, file: Option<&Path>) -> Vec<Bits> {
    let run = |rank: Arc<Rank>| {
        let (number, mut problem) = (rank.ranks.rank, Problem::new());
        if hands[number].serves {
            serve(&rank, 1).unwrap();
            return Vec::new();
        }
        problem.join(Arc::clone(&rank)).unwrap();
        give(&mut problem, deck, &hands[number], said);
        let (hand, mut ends) = (&hands[number], Vec::new());
        let mut end = |problem: &mut Problem, ended: &Result<Report>| {
            let mut own = nothing(deck);
            take(problem, deck, hand, number, ended, &mut own);
            ends.push(own);
        };
        let loaded = |problem: &mut Problem, by: f64| {
            for (body, p) in hand.bodies.iter().enumerate() {
                let load: Vec<f64> = deck.bodies[*p].load.iter().map(|f| by * f).collect();
                problem.set_load(body, &load).unwrap();
            }
        };
        file.into_iter().for_each(|path| problem.write_file(path).unwrap());
        let first = problem.solve();
        end(&mut problem, &first);
        let state = problem.save_state().unwrap();
        problem.set_str("start", "previous").unwrap();
        loaded(&mut problem, 1.25);
        let second = problem.solve();
        end(&mut problem, &second);
        if second.is_ok() {
            let checked = check(&mut problem);
            end(&mut problem, &checked);
            problem.commit_friction().ok();
            loaded(&mut problem, 1.0);
            let third = problem.solve();
            end(&mut problem, &third);
        }
        problem.restore_state(state).unwrap();
        end(&mut problem, &first);
        let fourth = problem.solve();
        end(&mut problem, &fourth);
        again(&mut problem, deck, hand);
        let fifth = problem.solve();
        end(&mut problem, &fifth);
        if let Some(body) = hand.bodies.iter().position(|p| *p == deck.bodies.len() / 2) {
            stiffen(&mut problem, body, &deck.bodies[hand.bodies[body]]);
        }
        let sixth = problem.solve();
        end(&mut problem, &sixth);
        drop(problem);
        serve(&rank, 1).unwrap();
        ends
    };
    let mut all = on_ranks(hands.len(), run);
    let mut merged = all.remove(0);
    for own in all.into_iter().filter(|own| !own.is_empty()) {
        for (to, from) in merged.iter_mut().zip(own) {
            to.merge(from);
        }
    }
    merged
}

/// Two of the contact rows once more, with smaller gaps.
fn again(problem: &mut Problem, deck: &Deck, hand: &Hand) {
    let count = deck.contact.rhs.len();
    let twice = [0, count / 2];
    for i in hand.rows[0].iter().filter(|i| twice[..count.min(2)].contains(i)) {
        add(problem, (deck, hand), &deck.contact, &[*i], true, &mut |problem, rows| {
            let rhs = [rows.rhs.unwrap()[0] * 0.9 - 1e-3];
            problem.add_rows(RowKind::Inequality, RowsInput { rhs: Some(&rhs), ..rows }).unwrap();
        });
    }
}

/// A body with twice its stiffness.
fn stiffen(problem: &mut Problem, body: usize, of: &decks::Body) {
    let mut twice = of.clone();
    twice.stiffness.val.iter_mut().for_each(|v| *v *= 2.0);
    hand_over::set_body(problem, body, &twice).unwrap();
}

impl Bits {
    /// Takes in what another rank has got.
    fn merge(&mut self, other: Bits) {
        fn fill<T: Default + PartialEq>(to: &mut [T], from: Vec<T>) {
            to.iter_mut().zip(from).for_each(|(to, from)| {
                if *to == T::default() {
                    *to = from;
                }
            });
        }
        if other.told.len() > self.told.len() {
            self.told = other.told;
        }
        fill(&mut self.u, other.u);
        fill(&mut self.reactions, other.reactions);
        self.forces.iter_mut().zip(other.forces).for_each(|(to, from)| fill(to, from));
        self.weights.iter_mut().zip(other.weights).for_each(|(to, from)| fill(to, from));
        fill(&mut self.gaps, other.gaps);
        fill(&mut self.slips, other.slips);
        fill(&mut self.states, other.states);
    }
}

/// All on one rank, in the order of the deck.
fn whole(deck: &Deck) -> Hand {
    let rows = [&deck.contact, &deck.equalities].map(|rows| (0..rows.rhs.len()).collect());
    Hand {
        bodies: (0..deck.bodies.len()).collect(),
        rows,
        nodes: (0..deck.friction.normal.len()).collect(),
        serves: false,
    }
}

/// Dealt out at random to so many ranks, of which some may get nothing.
fn dealt(deck: &Deck, size: usize, random: &mut Random) -> Vec<Hand> {
    let mut hands = vec![Hand::default(); size];
    let (first, players) = (random.below(size), 1 + random.below(size));
    let shuffled = |count: usize, random: &mut Random| {
        let mut all: Vec<(u64, usize)> = (0..count).map(|k| (random.bits(), k)).collect();
        all.sort_unstable();
        all.into_iter()
            .map(|(bits, k)| ((first + (bits / 7) as usize % players) % size, k))
            .collect::<Vec<_>>()
    };
    shuffled(deck.bodies.len(), random).into_iter().for_each(|(rank, p)| hands[rank].bodies.push(p));
    let mut rank_of = vec![0; deck.contact.rhs.len()];
    for (kind, rows) in [&deck.contact, &deck.equalities].into_iter().enumerate() {
        for (rank, i) in shuffled(rows.rhs.len(), random) {
            hands[rank].rows[kind].push(i);
            if kind == 0 {
                rank_of[i] = rank;
            }
        }
    }
    for (rank, k) in shuffled(deck.friction.normal.len(), random) {
        let rank = deck.friction.normal[k].map_or(rank, |row| rank_of[row]);
        hands[rank].nodes.push(k);
    }
    for hand in hands.iter_mut().skip(1) {
        let is_empty = hand.bodies.is_empty() && hand.nodes.is_empty() && hand.rows.iter().all(Vec::is_empty);
        hand.serves = is_empty && random.chance(0.5);
    }
    hands
}

/// The pairs of rows that are given twice: of each row, ascending, with all before it.
fn equal_rows(rows: &Rows) -> Vec<(usize, usize)> {
    let (mut known, mut pairs) = (HashMap::<_, Vec<usize>>::new(), Vec::new());
    for i in 0..rows.rhs.len() {
        // 0 and -0 are equal
        let bits = |v: f64| (v + 0.0).to_bits();
        let entries: Vec<_> = rows.matrix.row(i).map(|(j, v)| (j, bits(v))).collect();
        let same = known.entry((entries, bits(rows.rhs[i]), bits(rows.compliance[i]))).or_default();
        pairs.extend(same.iter().map(|j| (i, *j)));
        same.push(i);
    }
    pairs
}

/// Of rows that are given twice any may have the force.
fn without_order_of_equal_rows(equal: &[Vec<(usize, usize)>; 2], bits: &mut Bits) {
    for (kind, pairs) in equal.iter().enumerate() {
        for &(i, j) in pairs {
            let of = |bits: &Bits, i: usize| {
                let state = (kind == 0).then(|| bits.states[i].clone());
                (bits.forces[kind][i].clone(), state, bits.weights[kind][i].clone())
            };
            if of(bits, i) < of(bits, j) {
                bits.forces[kind].swap(i, j);
                bits.weights[kind].swap(i, j);
                if kind == 0 {
                    bits.states.swap(i, j);
                }
            }
        }
    }
}

/// The last answer as a host would check it; the certificate in its report.
fn check(problem: &mut Problem) -> Result<Report> {
    let mut report = problem.report().unwrap().clone();
    let [lambda, mu, tangential] = RowKind::ALL.map(|kind| problem.multipliers(kind).unwrap().to_vec());
    let u = problem.displacements().unwrap().to_vec();
    let answer = Candidate { u: &u, lambda: &lambda, mu: &mu, tangential: &tangential };
    report.certificate = problem.check_with_friction(answer)?;
    Ok(report)
}

/// Three deals of every problem, on 1 to 4 ranks; every fifth also as a file.
fn compare(name: &str, seed: u64, deck: &Deck, said: Said) {
    compare_on([0, 1, 2].map(|deal| 1 + (seed as usize + deal) % 4), name, seed, deck, said);
}

/// A deal for each of these numbers of ranks.
fn compare_on<const DEALS: usize>(sizes: [usize; DEALS], name: &str, seed: u64, deck: &Deck, said: Said) {
    let path = std::env::temp_dir().join(format!("feti-dealt-{}-{name}-{seed}.feti", std::process::id()));
    let file = Some(&path).filter(|_| seed % 5 == 0).map(|path| &**path);
    let written = || file.map(|path| std::fs::read(path).unwrap());
    let equal = [&deck.contact, &deck.equalities].map(equal_rows);
    let mut one = solved(deck, &[whole(deck)], said, file);
    let bytes = written();
    bytes.iter().for_each(|bytes| is_read(name, seed, bytes, deck, &one[0]));
    one.iter_mut().for_each(|bits| without_order_of_equal_rows(&equal, bits));
    let mut random = Random::new(seed ^ 0xdea1);
    for (deal, size) in sizes.into_iter().enumerate() {
        let hands = dealt(deck, size, &mut random);
        let mut got = solved(deck, &hands, said, file);
        assert!(written() == bytes, "{name} {seed}, deal {deal} on {size} ranks: another file");
        got.iter_mut().for_each(|bits| without_order_of_equal_rows(&equal, bits));
        assert_eq!(got.len(), one.len());
        assert_eq!(got[got.len() - 4], got[0], "{name} {seed}: the restored answer");
        for (step, (got, one)) in got.iter().zip(&one).enumerate() {
            assert_eq!(got, one, "{name} {seed}, deal {deal} on {size} ranks, solve {step}");
        }
    }
    file.into_iter().for_each(|path| std::fs::remove_file(path).unwrap());
}

/// One rank that reads the file of several has their displacements, and writes the same file.
fn is_read(name: &str, seed: u64, file: &[u8], deck: &Deck, all: &Bits) {
    let mut problem = Problem::new();
    problem.read_bytes(file).unwrap();
    assert!(problem.write_bytes().unwrap() == file, "{name} {seed}: written again it is another file");
    problem.solve().ok();
    let Ok(u) = problem.displacements() else {
        assert!(all.u.iter().all(Vec::is_empty), "{name} {seed}: solved from a file it has no answer");
        return;
    };
    let mut at = 0;
    for (body, expected) in deck.bodies.iter().zip(&all.u) {
        assert_eq!(&bits(&u[at..at + body.dofs()]), expected, "{name} {seed}: solved from a file");
        at += body.dofs();
    }
}

fn say(problem: &mut Problem, body: usize, of: &decks::Body, motions: Motions) {
    let (n, modes) = (of.dofs(), of.modes());
    match motions {
        Motions::Exact => problem.set_null_space(body, n, modes.len(), &modes.concat(), n, Modes::Exact),
        Motions::Soft => problem.set_null_space(body, n, modes.len(), &modes.concat(), n, Modes::Soft),
        Motions::Placed => {
            let places = of.coordinates.concat();
            problem.set_coordinates(body, dimension(of), &of.node, &of.direction, &places, 3)
        }
        Motions::Unsaid => Ok(()),
    }
    .unwrap();
}

fn dimension(of: &decks::Body) -> usize {
    of.direction.iter().fold(1, |most, &axis| most.max(axis)) as usize
}

/// Number of problems of each kind in the ordinary run.
const PROBLEMS: u64 = 100;

/// The problems of a seed, each with the name of its kind.
fn drawn(seed: u64) -> Vec<(&'static str, Deck, Said)> {
    let case = hard::case(seed);
    let motions = match case.given {
        hard::Given::NullSpaces => Motions::Exact,
        hard::Given::Coordinates => Motions::Placed,
        hard::Given::Nothing => Motions::Unsaid,
    };
    let mut all = vec![
        ("varied", varied::case(seed).deck, (Motions::Exact, "")),
        ("known outcome", battery::case(seed).deck, (Motions::Exact, "")),
        ("hard", case.deck, (motions, "")),
        ("driven", soft::random::driven(seed), (Motions::Soft, "")),
    ];
    if seed % 10 == 3 {
        all.push(("by the paper", battery::case(seed).deck, (Motions::Exact, "method=paper-monotone")));
    }
    if seed % 4 == 0 {
        let deck = coulomb::drawn::case(seed, &coulomb::drawn::SIZES).deck;
        all.push(("friction", deck, (Motions::Exact, "")));
    }
    all
}

#[test]
fn problems_dealt_out_to_ranks_have_the_bits_of_one_rank() {
    for seed in asked::seeds(PROBLEMS) {
        drawn(seed).iter().for_each(|(name, deck, said)| compare(name, seed, deck, *said));
    }
}

/// Two nodes have equal contact rows, but other friction.
#[test]
fn equal_contact_rows_with_unequal_friction_come_in_one_order() {
    let deck = coulomb::drawn::case(176, &coulomb::drawn::SIZES).deck;
    let row = |i: usize| deck.contact.matrix.row(i);
    assert!(row(1).eq(row(2)) && deck.contact.rhs[1] == deck.contact.rhs[2]);
    (176..184).for_each(|seed| compare("equal rows", seed, &deck, (Motions::Exact, "")));
}
