//! Problems without a drawn answer: stacks pushed by a little less and a little more than friction holds, and any loads.

use decks::random::Random;
use decks::{Block, Deck, Friction};

use super::body::{elements, Drawing, Held};
use super::node::{Contact, State};
use super::{coefficient, Drawn, Known, Sizes};

/// Of the load under which a stack slides.
const PUSHES: [f64; 4] = [0.9, 0.999, 1.001, 1.1];

/// One to three flat blocks on each other and on the ground, pressed from above and pushed along the lower face of one of them.
pub fn sliding(random: &mut Random) -> Drawn {
    let dim = 2 + usize::from(random.chance(0.4));
    let count = 1 + random.below(3);
    let grid = match dim {
        2 => [1 + random.below(4), 1 + random.below(2), 1],
        _ => [1 + random.below(2), 1 + random.below(2), 1],
    };
    let mut size = [2.0, 2.0, 2.0];
    size[dim - 1] = 0.3;
    let block = |random: &mut Random| Block {
        dimension: dim,
        elements: grid,
        size,
        young: random.decades(-1.0, 1.0),
        ..Block::default()
    };
    let blocks: Vec<Block> = (0..count).map(|_| block(random)).collect();
    let bodies = blocks.iter().map(|block| block.floating().body).collect();
    let mut deck = Deck::new("sliding", bodies);
    deck.friction = Friction::none(dim - 1, deck.dofs());
    let up = dim - 1;
    let places: Vec<[usize; 3]> = blocks[0].grids().collect();
    let nodes_at = |level: usize| (0..places.len()).filter(|&i| places[i][up] == level).collect::<Vec<_>>();
    let (lower, upper) = (nodes_at(0), nodes_at(grid[up]));
    let n = dim * places.len();
    let press = random.decades(-2.0, 0.0);
    let kind = random.below(3);
    let mut holds = Vec::new();
    for p in 0..count {
        let mu = if kind == 1 { 0.0 } else { random.between(0.05, 1.0) };
        let bound = if kind == 0 { 0.0 } else { press * random.between(0.05, 0.5) / lower.len() as f64 };
        for (&own, &under) in lower.iter().zip(&upper) {
            let factor = if random.chance(0.2) { random.decades(-2.0, 2.0) } else { 1.0 };
            let row = |axis: usize, sense: f64| {
                let mut row = vec![(p * n + dim * own + axis, sense * factor)];
                row.extend((p > 0).then(|| ((p - 1) * n + dim * under + axis, -sense * factor)));
                row
            };
            deck.contact.push(&row(up, -1.0), 0.0);
            let tangents: Vec<Vec<(usize, f64)>> = (0..up).map(|axis| row(axis, 1.0)).collect();
            let views: Vec<&[(usize, f64)]> = tangents.iter().map(Vec::as_slice).collect();
            deck.friction.push(Some(deck.contact.len() - 1), &views, mu, bound / factor);
        }
        holds.push(mu * press + bound * lower.len() as f64);
    }
    let pushed = random.below(count);
    let of = PUSHES[random.below(4)];
    let push = of * holds[..=pushed].iter().fold(f64::INFINITY, |least: f64, hold| least.min(*hold));
    let angle = if dim == 3 { random.between(0.0, std::f64::consts::TAU) } else { 0.0 };
    let along = if dim == 3 { [angle.cos(), angle.sin()] } else { [1.0, 0.0] };
    let share = 1.0 / lower.len() as f64;
    upper.iter().for_each(|&i| deck.bodies[count - 1].load[dim * i + up] -= press * share);
    for &i in &lower {
        (0..up).for_each(|axis| deck.bodies[pushed].load[dim * i + axis] += push * share * along[axis]);
    }
    let known = if of < 1.0 { Known::Answer } else { Known::NotHeld };
    Drawn { class: "sliding", deck, known, elements: blocks.iter().map(elements).collect() }
}

/// Any loads on held bodies; on floating ones the forces of rows that do not all keep their laws.
pub fn loaded(random: &mut Random, class: &'static str, sizes: &Sizes) -> Drawn {
    let dim = 2 + usize::from(random.chance(0.25));
    let mut drawing = Drawing::new(dim, 1.0, 1.0);
    let floating = class == "loads, floating";
    for p in 0..1 + random.below(2) {
        let kind = random.below(5);
        let held = match floating && p == 0 {
            true => [Held::No, Held::InPart][random.below(2)],
            false => Held::Wholly,
        };
        drawing.add_held(random, 1.0, kind, held);
    }
    let most = sizes.nodes.min(if dim == 2 { 5 } else { 4 });
    let count = 1 + random.below(most);
    let bodies = drawing.bodies.len();
    let (moves, dofs) = (random.decades(-3.0, 0.0), drawing.offset(bodies));
    let mut deck = Deck::new("loads", drawing.bodies.clone());
    deck.friction = Friction::none(dim - 1, dofs);
    let (mut normal, mut along) = (Vec::new(), Vec::new());
    let beyond = random.between(0.5, 1.3);
    let mu = coefficient(random);
    for k in 0..count {
        let mut contact = Contact::new(random, "plane", &drawing, k % bodies);
        let gap = if random.chance(0.6) { 0.0 } else { moves * random.decades(-2.0, 0.0) };
        (contact.gap, contact.factor, contact.mu) = (Some(gap), 1.0, mu);
        contact.push(&mut deck, &vec![0.0; dofs], &State::open(dim - 1));
        normal.push(moves * random.decades(-1.0, 0.0));
        let of = normal[k] * mu * beyond / ((dim - 1) as f64).sqrt();
        along.extend((1..dim).map(|_| of * random.between(-1.0, 1.0)));
    }
    let (b, t) = (&deck.contact.matrix, &deck.friction.rows.matrix);
    let mut loads: Vec<f64> = if floating {
        b.transpose_times(&normal).iter().zip(t.transpose_times(&along)).map(|(b, t)| b + t).collect()
    } else {
        random.normals(dofs, moves)
    };
    for body in &mut deck.bodies {
        let rest = loads.split_off(body.dofs());
        body.load = std::mem::replace(&mut loads, rest);
        if floating {
            // strains that no resultant comes with
            let u = random.normals(body.dofs(), 0.3 * moves);
            let own = body.stiffness.times(&u);
            body.load.iter_mut().zip(own).for_each(|(f, k)| *f += k);
        }
    }
    Drawn { class, deck, known: Known::Nothing, elements: drawing.elements }
}
