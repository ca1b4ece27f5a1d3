//! Bodies lent to other ranks: bits, what is sent, what is kept there and for how long.

mod failures;
mod given;
mod parts;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use crate::body::{Bodies, Kept, Lending, Name};
use crate::error::Result;
use crate::linalg::{Entries, Matrix, Operator};
use crate::ranks::loopback::linked;
use crate::ranks::Ranks;
use crate::serving::{answer, answer_all, taken};
use crate::solve::local::Negate;
use crate::solve::Case;
use crate::solver::{FrictionInput, Outcome, Problem, RowKind, RowsInput, SparseInput, Storage};

/// Questions of each kind.
type Asked = [u64; Name::ALL.len()];

/// Unknowns of a chain.
pub(super) const N: usize = 5;

/// Chains in a row, of springs `stiffness[p]`, the first held; gaps between neighbours, and each pushed to the first.
fn chains(stiffness: &[f64], lending: Option<Lending>) -> Problem {
    let mut problem = Problem::new();
    problem.prepared.lending = lending;
    for (p, &k) in stiffness.iter().enumerate() {
        let body = problem.add_body(N).unwrap();
        set(&mut problem, body, k);
        let mut f = [0.0; N];
        (f[N - 1], f[1]) = (-1.0 - p as f64 / 8.0, 0.25);
        problem.set_load(body, &f).unwrap();
    }
    for p in 1..stiffness.len() {
        // a unit step from the end of one to the begin of the next
        let (body, dof) = ([p as i64 - 1, p as i64], [N as i64 - 1, 0]);
        let rows =
            RowsInput { ptr: &[0, 2], body: Some(&body), dof: &dof, val: &[1.0, -1.0], rhs: Some(&[0.1]) };
        problem.add_rows(RowKind::Inequality, rows).unwrap();
    }
    problem
}

fn set(problem: &mut Problem, body: usize, k: f64) {
    set_chains(problem, body, &[k], body == 0);
}

/// K of a body that consists of chains, the first of them held if `held`.
pub(super) fn set_chains(problem: &mut Problem, body: usize, stiffness: &[f64], held: bool) {
    let row = |i: usize| {
        let (k, at) = (stiffness[i / N], i % N);
        let is_free_end = (at == 0 && !(held && i == 0)) || at + 1 == N;
        (if at > 0 { -k } else { 0.0 }, if is_free_end { k } else { 2.0 * k })
    };
    set_springs(problem, body, (0..N * stiffness.len()).map(row));
}

/// K of springs in a row: of each unknown the entry before the diagonal, if it is not 0, and that on it.
pub(super) fn set_springs(problem: &mut Problem, body: usize, rows: impl Iterator<Item = (f64, f64)>) {
    let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
    for (i, (before, own)) in rows.enumerate() {
        if before != 0.0 {
            col.push(i as i64 - 1);
            val.push(before);
        }
        col.push(i as i64);
        val.push(own);
        ptr.push(col.len());
    }
    let input = SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower };
    problem.set_stiffness(body, input).unwrap();
}

fn bits(problem: &Problem) -> Vec<u64> {
    let (u, lambda) = (problem.displacements().unwrap(), problem.multipliers(RowKind::Inequality).unwrap());
    u.iter().chain(lambda).map(|v| v.to_bits()).collect()
}

fn solved(problem: &mut Problem) -> Result<Vec<u64>> {
    assert_eq!(problem.solve()?.outcome, Outcome::Solved);
    Ok(bits(problem))
}

fn serial(stiffness: &[f64]) -> Vec<u64> {
    solved(&mut chains(stiffness, None)).unwrap()
}

/// Two ranks that serve, and what each keeps after its last answer.
pub struct Served {
    leader: Arc<Ranks>,
    threads: Vec<JoinHandle<()>>,
    kept: Vec<Arc<AtomicUsize>>,
    asked: Vec<Arc<Mutex<Asked>>>,
    bytes: Vec<Arc<Mutex<Asked>>>,
}

/// `instead`: of rank and number of the request, an answer in place of the right one.
pub fn served(instead: impl Fn(usize, usize) -> Option<Result<Vec<u8>>> + Clone + Send + 'static) -> Served {
    let (leader, others) = linked(3);
    serving(leader, others, instead)
}

fn serving(
    leader: Arc<Ranks>,
    others: Vec<Arc<Ranks>>,
    instead: impl Fn(usize, usize) -> Option<Result<Vec<u8>>> + Clone + Send + 'static,
) -> Served {
    let mut all =
        Served { leader, threads: Vec::new(), kept: Vec::new(), asked: Vec::new(), bytes: Vec::new() };
    for ranks in others {
        let kept = Arc::new(AtomicUsize::new(0));
        let [asked, bytes] = [0; 2].map(|_| Arc::new(Mutex::new([0; Name::ALL.len()])));
        all.kept.push(Arc::clone(&kept));
        all.asked.push(Arc::clone(&asked));
        all.bytes.push(Arc::clone(&bytes));
        let instead = instead.clone();
        all.threads.push(std::thread::spawn(move || {
            let (bodies, mut count) = (Bodies::new(taken), 0);
            let served = answer_all(&ranks, &bodies, &mut |incoming, bodies| {
                count += 1;
                let answered = instead(ranks.rank, count).unwrap_or_else(|| answer(bodies, incoming, 1));
                kept.store(bodies.kept(), Ordering::Relaxed);
                *asked.lock().unwrap() = bodies.asked();
                *bytes.lock().unwrap() = bodies.bytes();
                answered
            });
            drop(served);
            kept.store(bodies.kept(), Ordering::Relaxed);
        }));
    }
    all
}

impl Served {
    pub fn lending(&self) -> Option<Lending> {
        Some(Lending::new(Arc::clone(&self.leader), true))
    }

    fn kept(&self) -> usize {
        self.kept.iter().map(|kept| kept.load(Ordering::Relaxed)).sum()
    }

    fn asked(&self, name: Name) -> u64 {
        self.asked.iter().map(|asked| asked.lock().unwrap()[name as usize]).sum()
    }

    /// Bytes of the questions of this kind, and of their answers.
    fn bytes(&self, name: Name) -> u64 {
        self.bytes.iter().map(|bytes| bytes.lock().unwrap()[name as usize]).sum()
    }

    /// What is kept after the end.
    pub fn end(self) -> usize {
        self.leader.end().unwrap();
        let Self { leader, threads, kept, .. } = self;
        drop(leader);
        threads.into_iter().for_each(|thread| thread.join().unwrap());
        kept.iter().map(|kept| kept.load(Ordering::Relaxed)).sum()
    }
}

/// The entries of F in some rows and columns.
fn entries(problem: &Problem) -> Vec<f64> {
    let dual = &problem.prepared.done(problem.solved()).unwrap().islands[0].dual;
    let mut block = Matrix::zeros(3, 3).unwrap();
    dual.add_block(&[0, 1, 3], &mut block).unwrap();
    block.data
}

/// Friction on the first contact row, along another unknown of both chains.
fn rub(problem: &mut Problem) {
    let (body, dof) = ([0, 1], [2, 2]);
    let rows = RowsInput { ptr: &[0, 2], body: Some(&body), dof: &dof, val: &[1.0, -1.0], rhs: None };
    let nodes = FrictionInput { dim: 1, normal: &[0], rows, coefficient: Some(&[0.2]), bound: None };
    problem.add_friction(nodes).unwrap();
}

/// Different chains, and equal ones, which share their K+ on each rank.
#[test]
fn lent_bodies_have_the_bits_and_the_work_of_those_that_stay() {
    for stiffness in [vec![4.0, 3.0, 2.0, 1.0, 5.0], vec![2.0; 7]] {
        let served = served(|_, _| None);
        let (mut lent, mut alone) = (chains(&stiffness, served.lending()), chains(&stiffness, None));
        for option in [
            "dual_operator=explicit",
            "dual_operator=implicit",
            "preconditioner=lumped",
            "preconditioner=dirichlet",
        ] {
            [&mut lent, &mut alone].into_iter().for_each(|problem| problem.set_text(option).unwrap());
            assert_eq!(solved(&mut lent), solved(&mut alone), "{option}");
            assert_eq!(entries(&lent), entries(&alone), "{option}");
        }
        [&mut lent, &mut alone].into_iter().for_each(rub);
        assert_eq!(solved(&mut lent), solved(&mut alone), "with friction");
        assert_eq!(lent.work(), alone.work());
        // 0, 1, 3, 4, and 6 of 7; of the equal ones 0 is held, 3 and 6 are on one rank
        let given = if stiffness.len() == 5 { 4 } else { 3 };
        assert_eq!(served.asked(Name::Give), given, "equal bodies of a rank are given once");
        let bodies = lent.solved().bodies.iter().map(|given| &given.body);
        let here: Vec<bool> =
            bodies.map(|body| body.stiffness.is_some() && body.elsewhere().is_none()).collect();
        assert_eq!(here, (0..stiffness.len()).map(|p| p % 3 == 2).collect::<Vec<_>>());
        let names =
            [Name::Factorise, Name::Boundary, Name::Multiply, Name::Entries, Name::Join, Name::Displace];
        assert!(names.into_iter().all(|name| served.asked(name) > 1));
        assert_eq!((served.asked(Name::Fit), served.asked(Name::Solve)), (served.asked(Name::Measure), 0));
        drop(lent);
        assert_eq!(served.end(), 0);
    }
}

/// What rank 0 has of a body elsewhere are numbers where rows touch it.
#[test]
fn rank_0_has_no_matrix_null_space_or_metric_of_a_lent_body() {
    let served = served(|_, _| None);
    let mut problem = chains(&[4.0, 3.0, 2.0, 1.0, 5.0], served.lending());
    solved(&mut problem).unwrap();
    let (model, prepared) = (problem.solved(), &problem.prepared);
    let ready = &prepared.done(model).unwrap().islands[0];
    let bodies = prepared.locals(model, ready).unwrap();
    let mut lent = 0;
    for (k, &p) in ready.island.bodies.iter().enumerate() {
        let (inverse, seen) = (prepared.inverse(model, p).unwrap(), bodies.body(k));
        let is_away = ready.away(k).is_some();
        lent += usize::from(is_away);
        assert_eq!(inverse.kplus.elsewhere().is_some(), is_away);
        assert_eq!((inverse.kplus.null_space().is_err(), inverse.grounded.is_none()), (is_away, is_away));
        assert_eq!((ready.metric.on(k).len(), seen.here().is_err()), (if is_away { 0 } else { N }, is_away));
        assert_eq!(seen.diagonal().len(), seen.touched().len());
    }
    assert_eq!(lent, 4);
    drop(bodies);
    drop(problem);
    assert_eq!(served.end(), 0);
}

/// Two numbers for each row of a body, and what does not depend on rows.
#[test]
fn a_product_is_one_request_and_one_answer_on_each_rank_and_two_numbers_for_each_row_of_a_body() {
    let served = served(|_, _| None);
    let mut problem = chains(&[4.0, 3.0, 2.0, 1.0, 5.0], served.lending());
    solved(&mut problem).unwrap();
    let before = (problem.traffic(), served.asked(Name::Multiply), served.bytes(Name::Multiply));
    let dual = &problem.prepared.done(problem.solved()).unwrap().islands[0].dual;
    let mut image = vec![0.0; dual.order()];
    dual.try_apply(&vec![1.0; dual.order()], &mut image).unwrap();
    let after = (problem.traffic(), served.asked(Name::Multiply), served.bytes(Name::Multiply));
    assert_eq!((after.0.messages - before.0.messages, after.1 - before.1), (4, 4));
    // chains 0, 1, 3, 4 are lent: 1, 2, 2, 1 rows
    assert_eq!(after.2 - before.2, 16 * 6 + 34 * 4);
    drop(problem);
    assert_eq!(served.end(), 0);
}

#[test]
fn what_is_computed_once_is_neither_sent_nor_made_again() {
    let served = served(|_, _| None);
    let mut problem = chains(&[4.0, 3.0, 2.0, 1.0], served.lending());
    solved(&mut problem).unwrap();
    let made = || [Name::Factorise, Name::Join].map(|name| served.asked(name));
    let told = || [Name::Give, Name::Enter, Name::Way].map(|name| served.asked(name));
    let (first, at_setup, bytes) = (made(), told(), problem.traffic().bytes);
    problem.set_load(1, &[0.0, 0.0, -2.0, 0.0, 0.0]).unwrap();
    solved(&mut problem).unwrap();
    assert_eq!(made(), first, "a new load");
    assert!(problem.traffic().bytes - bytes < bytes);
    assert_eq!(at_setup, [3; 3]);
    assert_eq!(told(), at_setup, "no gap demands a motion: none is a difference of lengths");
    assert_eq!(served.asked(Name::GiveLoad), 4, "the load of one body alone is new");
    set(&mut problem, 0, 8.0);
    solved(&mut problem).unwrap();
    assert_eq!((made()[0], told()[0]), (first[0] + 1, 4), "new values of one body");
}

#[test]
fn other_ranks_keep_nothing_that_rank_0_has_dropped() {
    let served = served(|_, _| None);
    let stiffness = [4.0, 3.0, 2.0, 1.0];
    let mut problem = chains(&stiffness, served.lending());
    let mut after_two = 0;
    for step in 0..12 {
        (0..4).for_each(|p| set(&mut problem, p, stiffness[p] + step as f64));
        let row = RowsInput { ptr: &[0, 1], body: Some(&[3]), dof: &[4], val: &[1.0], rhs: Some(&[9.0]) };
        problem.add_rows(RowKind::Inequality, row).unwrap();
        solved(&mut problem).unwrap();
        problem.clear_rows(RowKind::Inequality);
        for p in 1..4 {
            let (body, dof) = ([p - 1, p], [N as i64 - 1, 0]);
            let rows = RowsInput {
                ptr: &[0, 2],
                body: Some(&body),
                dof: &dof,
                val: &[1.0, -1.0],
                rhs: Some(&[0.1]),
            };
            problem.add_rows(RowKind::Inequality, rows).unwrap();
        }
        solved(&mut problem).unwrap();
        match step {
            1 => after_two = served.kept(),
            _ => assert!(step < 1 || served.kept() == after_two, "step {step}: {}", served.kept()),
        }
    }
    // several problems at once, one dropped by another thread
    let others: Vec<Problem> = (0..3)
        .map(|_| {
            let mut other = chains(&stiffness, served.lending());
            solved(&mut other).unwrap();
            other
        })
        .collect();
    std::thread::spawn(move || drop(others)).join().unwrap();
    solved(&mut problem).unwrap();
    drop(problem);
    assert!(after_two > 0 && served.end() == 0);
}

#[test]
fn a_vector_that_two_name_is_changed_for_one_alone() {
    let served = served(|_, _| None);
    let mut problem = chains(&[4.0, 3.0, 2.0, 1.0], served.lending());
    solved(&mut problem).unwrap();
    let ready = &problem.prepared.done(problem.solved()).unwrap().islands[0];
    let case = Case { model: problem.solved(), prepared: &problem.prepared, ready, method: None };
    let bodies = case.locals().unwrap();
    let first = bodies.put((0..4).map(|p| vec![p as f64; N]).collect()).unwrap();
    let mut second = first.clone();
    let all = |v: &Kept| bodies.bring(v).unwrap().concat();
    for sign in [-1.0, 1.0, -1.0] {
        bodies.change(|_| Negate, &mut second, ()).unwrap();
        assert!(all(&first).iter().zip(all(&second)).all(|(a, b)| sign * a == b));
    }
    drop((first, second, bodies));
    drop(problem);
    assert_eq!(served.end(), 0);
}

/// Bars of n unknowns one behind the other, of equal springs, in one problem each: floating but for the first, tied at one end and in
/// contact at the other, with unequal springs inside that depend on the place from the ends alone.
fn bars(n: usize, lending: Option<Lending>) -> Problem {
    let mut problem = Problem::new();
    problem.prepared.lending = lending;
    for p in 0..6 {
        let body = problem.add_body(n).unwrap();
        let k = 1.0 + p as f64 / 16.0;
        let row = |i: usize| {
            let ends = usize::from(i == 0) + usize::from(i + 1 == n);
            let ground = if p == 0 && i == 0 { 1.0 } else { 0.0 };
            (if i > 0 { -k } else { 0.0 }, (2 - ends) as f64 * k + ground)
        };
        set_springs(&mut problem, body, (0..n).map(row));
        let mut f = vec![0.0; n];
        f[n - 1] = -1.0;
        problem.set_load(body, &f).unwrap();
    }
    for p in 1..6 {
        let (body, dof) = ([p - 1, p], [n as i64 - 1, 0]);
        let rows =
            RowsInput { ptr: &[0, 2], body: Some(&body), dof: &dof, val: &[1.0, -1.0], rhs: Some(&[0.0]) };
        problem.add_rows(if p % 2 == 0 { RowKind::Equality } else { RowKind::Inequality }, rows).unwrap();
    }
    problem
}

/// All that is sent after the matrix, the load and u are sizes and values where rows touch.
#[test]
fn what_is_asked_about_a_bar_does_not_depend_on_its_length() {
    let of = [50, 200, 800].map(|n| {
        let served = served(|_, _| None);
        let mut problem = bars(n, served.lending());
        solved(&mut problem).unwrap();
        let all: Vec<(Name, u64, u64)> =
            Name::ALL.iter().map(|&name| (name, served.asked(name), served.bytes(name))).collect();
        drop(problem);
        assert_eq!(served.end(), 0);
        all
    });
    let whole = [Name::Give, Name::GiveLoad, Name::Bring, Name::Section];
    let mut kinds = 0;
    for k in 0..Name::ALL.len() {
        let [short, long, longest] = of.each_ref().map(|all| all[k]);
        if short.1 == 0 || whole.contains(&short.0) {
            continue;
        }
        kinds += 1;
        for (name, asked, bytes) in [long, longest] {
            assert!(asked > 0, "{name:?}");
            let per = |asked: u64, bytes: u64| bytes as f64 / asked as f64;
            let ratio = per(asked, bytes) / per(short.1, short.2);
            assert!((ratio - 1.0).abs() < 0.02, "{name:?}: {ratio}");
        }
    }
    assert!(kinds >= 10, "{kinds}");
}
