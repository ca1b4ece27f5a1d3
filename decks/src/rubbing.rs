//! Friction decks: bodies that touch along the axes, pressed together and pushed along each other.

use std::collections::HashMap;

use crate::{Block, Blocks, Cube, Deck, Friction, Stack};

/// `deck` with a node of friction for each of its contact rows, whose normals must be parallel to axes: the tangential rows of a
/// node have the weights of the contact row on the same nodes of the mesh, in all other directions. Eliminated dofs drop out.
pub fn with_friction(deck: Deck, coefficient: f64) -> Deck {
    let directions = deck.bodies.iter().flat_map(|body| &body.direction).copied().max().unwrap_or(0);
    let places = places(&deck);
    let mut friction = Friction::none(directions as usize - 1, deck.dofs());
    let dof_of: HashMap<_, _> = places.iter().enumerate().map(|(dof, place)| (*place, dof)).collect();
    for row in 0..deck.contact.len() {
        let entries: Vec<(usize, f64)> = deck.contact.matrix.row(row).collect();
        let Some(normal) = entries.first().map(|(dof, _)| places[*dof].2) else { continue };
        assert!(entries.iter().all(|(dof, _)| places[*dof].2 == normal), "an oblique normal");
        let along = |direction: i32| -> Vec<(usize, f64)> {
            let entry = |&(dof, weight): &(usize, f64)| {
                let (body, node, _) = places[dof];
                Some((*dof_of.get(&(body, node, direction))?, weight))
            };
            entries.iter().filter_map(entry).collect()
        };
        let tangents: Vec<_> = (1..=directions).filter(|at| *at != normal).map(along).collect();
        let rows: Vec<&[(usize, f64)]> = tangents.iter().map(Vec::as_slice).collect();
        friction.push(Some(row), &rows, coefficient, 0.0);
    }
    Deck { friction, ..deck }
}

/// Body, label of the node and direction of every dof.
fn places(deck: &Deck) -> Vec<(usize, i32, i32)> {
    let of = |(p, body): (usize, &crate::Body)| {
        let own = body.node.iter().zip(&body.direction);
        own.map(|(node, direction)| (p, *node, *direction)).collect::<Vec<_>>()
    };
    deck.bodies.iter().enumerate().flat_map(of).collect()
}

/// Spreads a force along x and, in space, y over the bodies from `first` on, by the volume at each node: in bodies of one
/// material it goes with the diagonal of K.
pub fn push(deck: &mut Deck, first: usize, force: [f64; 2]) {
    let share = |body: &crate::Body, direction: i32| -> Vec<(usize, f64)> {
        let own = (0..body.dofs()).filter(|&dof| body.direction[dof] == direction);
        own.map(|dof| (dof, body.stiffness.get(dof, dof))).collect()
    };
    for (direction, force) in (1..).zip(force).filter(|(_, force)| *force != 0.0) {
        let bodies = deck.bodies[first..].iter();
        let whole: f64 = bodies.flat_map(|body| share(body, direction)).map(|(_, part)| part).sum();
        for body in &mut deck.bodies[first..] {
            for (dof, part) in share(body, direction) {
                body.load[dof] += force * part / whole;
            }
        }
    }
}

/// What presses, force: the load along the last axis, without its sign.
pub fn pressed(deck: &Deck) -> f64 {
    let last = deck.bodies.iter().flat_map(|body| &body.direction).max().copied().unwrap_or(0);
    let of = |body: &crate::Body| -> f64 {
        body.load.iter().zip(&body.direction).filter(|(_, at)| **at == last).map(|(f, _)| f).sum()
    };
    deck.bodies.iter().map(of).sum::<f64>().abs()
}

/// Blocks without any support but the contact between them and a rigid plane: one on the plane, or two or three upon each other
/// whose meshes do not match. All have the base 1 (plane strain) or 1 x 1. The top is pressed down evenly, the highest block
/// pushed along at every node: where load = 1 it slides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rubbing {
    /// 2 or 3.
    pub dimension: usize,
    /// Elements along the base of the lowest block, n; the second has 3 n / 4, the third n - 1.
    pub elements: usize,
    /// 1 to 3.
    pub blocks: usize,
    /// mu, no unit.
    pub coefficient: f64,
    /// The push, as a part of the load that makes the blocks slide.
    pub load: f64,
    /// Height of each block, length.
    pub height: f64,
    /// E, Young's modulus, force per area.
    pub young: f64,
}

/// Pressure on the top, in units of E: force per area.
const PRESSURE: f64 = 1e-3;
/// Gap at the distance r from the axis: GAP r^2, length; on the higher interfaces 30 % and 60 % more.
const GAP: f64 = 2e-3;
const MORE_GAP: f64 = 0.3;
/// Angle between the push and x in space.
const ANGLE: f64 = 0.3;

impl Rubbing {
    pub fn new(dimension: usize, elements: usize, blocks: usize, coefficient: f64, load: f64) -> Rubbing {
        let height = if blocks == 1 { 0.5 } else { 0.15 };
        Rubbing { dimension, elements, blocks, coefficient, load, height, young: 1.0 }
    }

    /// 2D with n = 32 and 3D with n = 8; one block and three; mu .1, .6, 1; .3, .8, .97 of the load that makes them slide.
    pub fn floating_36() -> Vec<Rubbing> {
        let mut all = Vec::new();
        for (dimension, elements) in [(2, 32), (3, 8)] {
            for blocks in [1, 3] {
                for mu in [0.1, 0.6, 1.0] {
                    all.extend(
                        [0.3, 0.8, 0.97].map(|load| Rubbing::new(dimension, elements, blocks, mu, load)),
                    );
                }
            }
        }
        all
    }

    /// One contact row with friction for each node of the lower face of each block.
    pub fn build(&self) -> Deck {
        let blocks: Vec<Block> = (0..self.blocks).map(|level| self.block(level)).collect();
        let mut bodies: Vec<_> = blocks.iter().map(|block| block.floating().body).collect();
        let (highest, top) = (&blocks[self.blocks - 1], &mut bodies[self.blocks - 1]);
        self.press(highest, &mut top.load);
        let mut deck = Deck::new(self.name(), bodies);
        for (level, block) in blocks.iter().enumerate() {
            let below = level.checked_sub(1).map(|under| (&blocks[under], deck.offset(under)));
            self.add_contact(&mut deck, (block, level), below);
        }
        let force = self.load * self.coefficient * pressed(&deck);
        let force =
            if self.dimension == 2 { [1.0, 0.0] } else { [ANGLE.cos(), ANGLE.sin()] }.map(|c| c * force);
        push(&mut deck, self.blocks - 1, force);
        with_friction(deck, self.coefficient)
    }

    pub fn name(&self) -> String {
        let Rubbing { dimension, elements, blocks, coefficient, load, .. } = self;
        format!("rub_{dimension}d_n{elements}_{blocks}_mu{coefficient}_load{load}")
    }

    fn block(&self, level: usize) -> Block {
        let n = self.elements;
        let n = [n, (3 * n / 4).max(2), (n - 1).max(2)][level];
        let last = self.dimension - 1;
        let (mut elements, mut size, mut origin) = ([n; 3], [1.0; 3], [0.0; 3]);
        elements[last] = ((n as f64 * self.height).round() as usize).max(1);
        size[last] = self.height;
        origin[last] = self.height * level as f64;
        Block { dimension: self.dimension, elements, size, origin, young: self.young, ..Block::default() }
    }

    /// -u + (that of the block below) <= gap along the last axis.
    fn add_contact(&self, deck: &mut Deck, (block, level): (&Block, usize), below: Option<(&Block, usize)>) {
        let (d, last) = (self.dimension, self.dimension - 1);
        let offset = deck.offset(level);
        for at in block.grids().filter(|at| at[last] == 0) {
            let mut row = vec![(offset + d * block.node(at) + last, -1.0)];
            if let Some((lower, first)) = below {
                let corners = above(lower, block, at);
                row.extend(corners.into_iter().map(|(node, weight)| (first + d * node + last, weight)));
            }
            let place = block.position(at);
            let far: f64 = place[..last].iter().map(|x| (x - 0.5) * (x - 0.5)).sum();
            deck.contact.push(&row, GAP * far * (1.0 + MORE_GAP * level as f64));
        }
    }

    /// Even pressure on the top: half as much at an edge.
    fn press(&self, block: &Block, load: &mut [f64]) {
        let (d, last) = (self.dimension, self.dimension - 1);
        for (node, at) in block.grids().enumerate().filter(|(_, at)| at[last] == block.elements[last]) {
            let part = |axis: usize| {
                let rim = at[axis] == 0 || at[axis] == block.elements[axis];
                let share = if rim { 0.5 } else { 1.0 };
                share / block.elements[axis] as f64
            };
            load[d * node + last] -= PRESSURE * self.young * (0..last).map(part).product::<f64>();
        }
    }
}

/// Nodes of the upper face of `lower` around the node `at` of the block upon it, with their weights, by exact integer division.
fn above(lower: &Block, block: &Block, at: [usize; 3]) -> Vec<(usize, f64)> {
    let last = block.dimension - 1;
    let cell =
        |axis: usize| (at[axis] * lower.elements[axis] / block.elements[axis]).min(lower.elements[axis] - 1);
    let local = |axis: usize| {
        let past = at[axis] * lower.elements[axis] - cell(axis) * block.elements[axis];
        past as f64 / block.elements[axis] as f64
    };
    let mut found = Vec::new();
    for corner in 0..1usize << last {
        let bit = |axis: usize| corner >> axis & 1;
        let weight = |axis: usize| if bit(axis) == 1 { local(axis) } else { 1.0 - local(axis) };
        let weight: f64 = (0..last).map(weight).product();
        let mut place = [0; 3];
        (0..last).for_each(|axis| place[axis] = cell(axis) + bit(axis));
        place[last] = lower.elements[last];
        if weight > 0.0 {
            found.push((lower.node(place), weight));
        }
    }
    found
}

/// Glued subdomains on the obstacle plane, pushed along as a whole by `load` of mu times what presses; a clamp holds a part of it.
pub fn cube(cube: &Cube, coefficient: f64, load: f64) -> Deck {
    let mut deck = cube.build();
    let force = load * coefficient * pressed(&deck);
    push(&mut deck, 0, [force * ANGLE.cos(), if cube.dimension == 3 { force * ANGLE.sin() } else { 0.0 }]);
    with_friction(deck, coefficient)
}

/// Flat blocks upon each other, the lowest clamped at its bottom, the highest pressed by a patch and pushed along; where load = 1
/// those that float slide.
pub fn stack(stack: &Stack, coefficient: f64, load: f64) -> Deck {
    let mut deck = Stack { flat: true, ..stack.clone() }.build();
    let force = load * coefficient * pressed(&deck);
    push(&mut deck, stack.bodies - 1, [force * ANGLE.cos(), force * ANGLE.sin()]);
    with_friction(deck, coefficient)
}

/// The two blocks of the benchmark, the upper one pushed along.
pub fn blocks(blocks: &Blocks, coefficient: f64, load: f64) -> Deck {
    let mut deck = blocks.build();
    let force = load * coefficient * pressed(&deck);
    push(&mut deck, 1, [force * ANGLE.cos(), force * ANGLE.sin()]);
    with_friction(deck, coefficient)
}

#[cfg(test)]
mod tests {
    use super::{blocks, cube, pressed, stack, with_friction, Rubbing};
    use crate::{Blocks, Cube, Deck, Stack};

    /// What a uniform displacement of all bodies along an axis does in rows.
    fn moved(deck: &Deck, axis: i32, of: &crate::Rows) -> Vec<f64> {
        let directions = deck.bodies.iter().flat_map(|body| &body.direction);
        of.matrix.times(&directions.map(|own| f64::from(*own == axis)).collect::<Vec<_>>())
    }

    /// `dim` rows a node, over the dofs of its contact row turned to the other directions, with the same weights.
    fn assert_well_formed(deck: &Deck) {
        let (nodes, dim) = (&deck.friction, deck.friction.dim);
        assert_eq!(nodes.normal.len(), deck.contact.len());
        assert_eq!((nodes.rows.len(), nodes.rows.matrix.cols), (dim * nodes.normal.len(), deck.dofs()));
        assert!(nodes.rows.matrix.is_sorted());
        let direction: Vec<i32> = deck.bodies.iter().flat_map(|body| body.direction.clone()).collect();
        let coordinates: Vec<_> = deck.bodies.iter().flat_map(|body| body.coordinates.clone()).collect();
        for (node, normal) in nodes.normal.iter().enumerate() {
            let own: Vec<_> = deck.contact.matrix.row(normal.unwrap()).collect();
            let mut taken = vec![direction[own[0].0]];
            for row in dim * node..dim * (node + 1) {
                let along: Vec<_> = nodes.rows.matrix.row(row).collect();
                assert_eq!(along.len(), own.len());
                let axis = direction[along[0].0];
                assert!(along.iter().all(|(dof, _)| direction[*dof] == axis) && !taken.contains(&axis));
                taken.push(axis);
                for ((a, v), (b, w)) in along.iter().zip(&own) {
                    assert!(coordinates[*a] == coordinates[*b] && v == w);
                }
            }
        }
    }

    #[test]
    fn every_deck_is_well_formed() {
        for deck in [
            with_friction(Blocks::default().build(), 0.5),
            blocks(&Blocks { elements: 3, ..Blocks::default() }, 0.5, 0.5),
            stack(&Stack { bodies: 3, in_plane: vec![4, 3, 5], ..Stack::default() }, 0.3, 0.9),
            cube(&Cube::default(), 0.3, 0.5),
            cube(&Cube { dimension: 2, clamp: false, ..Cube::default() }, 1.0, 0.8),
        ] {
            assert_well_formed(&deck);
        }
        for case in Rubbing::floating_36() {
            let n = if case.dimension == 2 { 8 } else { 4 };
            assert_well_formed(&Rubbing { elements: n, ..case }.build());
        }
    }

    #[test]
    fn there_are_36_floating_decks_and_no_body_is_held() {
        let all = Rubbing::floating_36();
        assert_eq!(all.len(), 36);
        let deck = all[35].build();
        assert_eq!(deck.bodies.len(), 3);
        let modes: Vec<usize> = deck.bodies.iter().map(|body| body.modes().len()).collect();
        assert_eq!((modes, deck.contact.len()), (vec![6; 3], 9 * 9 + 7 * 7 + 8 * 8));
        assert_eq!(all[0].build().contact.len(), 33);
    }

    /// The plane holds what moves with it and no interface between blocks feels a motion of all.
    #[test]
    fn weights_of_a_node_sum_to_nothing_between_blocks_and_to_one_on_the_plane() {
        let deck = Rubbing::new(3, 4, 3, 0.5, 0.5).build();
        let on_plane = 25;
        for axis in 1..=2 {
            let slips = moved(&deck, axis, &deck.friction.rows);
            assert_eq!(slips[..2 * on_plane].iter().map(|slip| slip.abs()).sum::<f64>(), on_plane as f64);
            assert!(slips[2 * on_plane..].iter().all(|slip| slip.abs() < 1e-15));
        }
        assert!(moved(&deck, 3, &deck.friction.rows).iter().all(|slip| *slip == 0.0));
    }

    /// Push and pressure, by direction.
    #[test]
    fn the_push_is_its_part_of_the_load_that_makes_the_blocks_slide() {
        for deck in [
            Rubbing::new(3, 4, 3, 0.6, 0.8).build(),
            stack(&Stack::default(), 0.6, 0.8),
            blocks(&Blocks::default(), 0.6, 0.8),
            cube(&Cube { clamp: false, ..Cube::default() }, 0.6, 0.8),
        ] {
            let along = |axis: i32| -> f64 {
                let own = deck.bodies.iter().flat_map(|body| body.load.iter().zip(&body.direction));
                own.filter(|(_, at)| **at == axis).map(|(f, _)| f).sum()
            };
            let push = along(1).hypot(along(2));
            assert!((push - 0.6 * 0.8 * pressed(&deck)).abs() < 1e-12 * push, "{}", deck.name);
            assert!(along(3) < 0.0);
        }
        assert!((pressed(&Rubbing::new(2, 8, 1, 0.1, 0.0).build()) - 1e-3).abs() < 1e-18);
    }
}
