//! A membrane that the host has cut into subdomains: nodes on several of them have one number.

use std::sync::Arc;

use decks::random::Random;
use feti_contact::solver::{Modes, Outcome, Problem, Rank, RowKind, RowsInput, SparseInput, Storage};

use crate::support::linked::on_ranks;

const WIDTH: usize = 7;
const LENGTH: usize = 24;
const LINE: usize = WIDTH + 1;
const NODES: usize = LINE * (LENGTH + 1);

/// The elements of a subdomain: columns and rows of the mesh.
type Block = (std::ops::Range<usize>, std::ops::Range<usize>);

/// Numbers of its nodes, K by rows of the lower triangle, and its load; with `ghost` the number of another node, which it does not use.
fn body(of: &Block, ghost: Option<usize>) -> (Vec<i64>, Vec<Vec<(usize, f64)>>, Vec<f64>) {
    let across = of.0.len() + 1;
    let place = |i: usize, j: usize| (j - of.1.start) * across + i - of.0.start;
    let numbers =
        (of.1.start..=of.1.end).flat_map(|j| (of.0.start..=of.0.end).map(move |i| (j * LINE + i) as i64));
    let mut numbers: Vec<i64> = numbers.collect();
    let n = numbers.len();
    let (mut k, mut load) = (vec![vec![0.0; n]; n], vec![0.0; n]);
    for j in of.1.clone() {
        for i in of.0.clone() {
            let node = [place(i, j), place(i + 1, j), place(i, j + 1), place(i + 1, j + 1)];
            for a in 0..4 {
                load[node[a]] -= 0.02 * (1.0 + (i as f64 - 2.0) * 0.1);
                for b in 0..4 {
                    k[node[a]][node[b]] += if a == b {
                        4.0
                    } else if a + b == 3 {
                        -2.0
                    } else {
                        -1.0
                    };
                }
            }
        }
    }
    let entries =
        |row: Vec<f64>, a: usize| (0..=a).map(|b| (b, row[b])).filter(|entry| entry.1 != 0.0).collect();
    let mut rows: Vec<Vec<(usize, f64)>> =
        k.into_iter().enumerate().map(|(a, row)| entries(row, a)).collect();
    if let Some(ghost) = ghost.filter(|ghost| !numbers.contains(&(*ghost as i64))) {
        numbers.push(ghost as i64);
        rows.push(Vec::new());
        load.push(0.0);
    }
    (numbers, rows, load)
}

fn add_body(problem: &mut Problem, of: &Block, ghost: Option<usize>, spoken: bool) {
    let (numbers, rows, load) = body(of, ghost);
    let n = numbers.len();
    let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
    for row in rows {
        row.iter().for_each(|(j, v)| (col.push(*j as i64), val.push(*v)).0);
        ptr.push(col.len());
    }
    let p = problem.add_body(n).unwrap();
    problem
        .set_stiffness(p, SparseInput { ptr: &ptr, col: &col, val: &val, storage: Storage::Lower })
        .unwrap();
    if spoken {
        problem.set_null_space(p, n, 1, &vec![1.0; n], n, Modes::Candidates).unwrap();
    }
    problem.set_load(p, &load).unwrap();
    problem.set_numbering(p, &numbers).unwrap();
}

/// The obstacle at a node, or the support of a node of the first line.
fn add_row(problem: &mut Problem, node: usize) {
    let (kind, val, rhs) = match node < LINE {
        true => (RowKind::Equality, 1.0, 0.0),
        false => (RowKind::Inequality, -1.0, 0.5 + 0.01 * (node % 5) as f64),
    };
    let rows = RowsInput { ptr: &[0, 1], body: None, dof: &[node as i64], val: &[val], rhs: Some(&[rhs]) };
    problem.add_rows(kind, rows).unwrap();
}

/// u of every subdomain, whose copies of a node differ by rounding, and the force of every node.
#[derive(Clone, PartialEq)]
struct Answer {
    u: Vec<Vec<f64>>,
    force: Vec<f64>,
}

fn bits(of: &Answer) -> Vec<u64> {
    of.u.iter().flatten().chain(&of.force).map(|v| v.to_bits()).collect()
}

fn take(problem: &mut Problem, bodies: &[usize], rows: &[usize], to: &mut Answer) {
    for (p, k) in bodies.iter().enumerate() {
        to.u[*k] = problem.displacement(p).unwrap().to_vec();
    }
    for (kind, is) in [(RowKind::Equality, true), (RowKind::Inequality, false)] {
        let forces = problem.multipliers(kind).unwrap();
        let of_kind = rows.iter().filter(|node| (**node < LINE) == is);
        of_kind.zip(forces).for_each(|(node, force)| to.force[*node] = *force);
    }
}

fn nothing(bodies: usize) -> Answer {
    Answer { u: vec![Vec::new(); bodies], force: vec![f64::NAN; NODES] }
}

/// The same in one body.
fn undivided() -> Answer {
    let (mut problem, mut answer) = (Problem::new(), nothing(1));
    add_body(&mut problem, &(0..WIDTH, 0..LENGTH), None, true);
    let rows: Vec<usize> = (0..NODES).collect();
    rows.iter().for_each(|node| add_row(&mut problem, *node));
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    take(&mut problem, &[0], &rows, &mut answer);
    answer
}

/// Subdomains and rows dealt out to ranks; the answer, and the bytes of a problem file of all ranks.
fn dealt(blocks: &[Block], ghosts: bool, size: usize, random: &mut Random) -> (Answer, Vec<u8>) {
    let path = std::env::temp_dir().join(format!("feti-glued-{}.feti", std::process::id()));
    let mut deal = |count: usize| {
        let mut all: Vec<(u64, usize, usize)> =
            (0..count).map(|k| (random.bits(), k, random.below(size))).collect();
        all.sort_unstable();
        all.into_iter().map(|(_, k, rank)| (k, rank)).collect::<Vec<_>>()
    };
    let (bodies, rows) = (deal(blocks.len()), deal(NODES));
    let run = |rank: Arc<Rank>| {
        let (number, mut problem, mut answer) = (rank.ranks.rank, Problem::new(), nothing(blocks.len()));
        problem.join(rank).unwrap();
        problem.set_i64("glue", 1).unwrap();
        let own = |all: &[(usize, usize)]| -> Vec<usize> {
            all.iter().filter(|(_, rank)| *rank == number).map(|(k, _)| *k).collect()
        };
        let ghost = |k: usize| (ghosts && k % 3 == 0).then_some((k * 37 + 11) % NODES);
        let add = |k: usize, problem: &mut Problem| add_body(problem, &blocks[k], ghost(k), k % 2 == 0);
        let (bodies, rows) = (own(&bodies), own(&rows));
        bodies.iter().for_each(|k| add(*k, &mut problem));
        rows.iter().for_each(|node| add_row(&mut problem, *node));
        problem.write_file(&path).unwrap();
        assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
        take(&mut problem, &bodies, &rows, &mut answer);
        answer
    };
    let all = on_ranks(size, run);
    let mut merged = nothing(blocks.len());
    for own in all {
        let forces = merged.force.iter_mut().zip(own.force);
        forces.filter(|(to, _)| to.is_nan()).for_each(|(to, from)| *to = from);
        let u = merged.u.iter_mut().zip(own.u);
        u.filter(|(to, _)| to.is_empty()).for_each(|(to, from)| *to = from);
    }
    let file = std::fs::read(&path).unwrap();
    std::fs::remove_file(&path).unwrap();
    (merged, file)
}

/// Of one rank that reads the file: u of the subdomains in their order.
fn read(file: &[u8], blocks: usize) -> Vec<Vec<f64>> {
    let mut problem = Problem::new();
    problem.read_bytes(file).unwrap();
    assert_eq!(problem.solve().unwrap().outcome, Outcome::Solved);
    (0..blocks).map(|p| problem.displacement(p).unwrap().to_vec()).collect()
}

#[test]
fn subdomains_of_several_ranks_have_the_forces_of_the_undivided_body() {
    let right = undivided();
    let strips: Vec<Block> = (0..12).map(|s| (0..WIDTH, 2 * s..2 * s + 2)).collect();
    let ends = [0, 3, 5, WIDTH];
    let patches: Vec<Block> =
        (0..4).flat_map(|b| (0..3).map(move |a| (ends[a]..ends[a + 1], 6 * b..6 * b + 6))).collect();
    for (blocks, ghosts) in [(&strips, false), (&patches, false), (&strips, true)] {
        let mut random = Random::new(7);
        let (one, file) = dealt(blocks, ghosts, 2, &mut random);
        let mut in_order: Vec<&Vec<f64>> = one.u.iter().collect();
        // a ghost may be the least number of its body
        let again = read(&file, blocks.len());
        let by_bits = |u: &&Vec<f64>| u.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        in_order.sort_by_key(by_bits);
        let mut again: Vec<&Vec<f64>> = again.iter().collect();
        again.sort_by_key(by_bits);
        assert!(again == in_order, "solved from the file");
        let largest = right.force.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        for (got, force) in one.force.iter().zip(&right.force) {
            assert!((got - force).abs() <= 1e-9 * largest, "{got} for {force}");
        }
        for size in [2, 3, 4, 4] {
            let (other, bytes) = dealt(blocks, ghosts, size, &mut random);
            assert_eq!(bits(&other), bits(&one), "{size} ranks");
            assert!(bytes == file, "{size} ranks: another file");
        }
    }
}
