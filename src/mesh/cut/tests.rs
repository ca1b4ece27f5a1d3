use super::*;

/// Bricks of a grid, three unknowns for each node: what they join and their centres.
struct Grid {
    ptr: Vec<usize>,
    dof: Vec<u32>,
    centres: Vec<[f64; 3]>,
    unknowns: usize,
}

impl Grid {
    fn new(steps: [usize; 3], closed: bool) -> Self {
        let along = [steps[0] + usize::from(!closed), steps[1] + 1, steps[2] + 1];
        let node = |at: [usize; 3]| at[0] % along[0] + along[0] * (at[1] + along[1] * at[2]);
        let (mut ptr, mut dof, mut centres) = (vec![0], Vec::new(), Vec::new());
        for k in 0..steps.iter().product::<usize>() {
            let low = [k % steps[0], k / steps[0] % steps[1], k / steps[0] / steps[1]];
            for bits in 0..8 {
                let node = node(std::array::from_fn(|axis| low[axis] + (bits >> axis & 1)));
                dof.extend((0..3).map(|axis| (3 * node + axis) as u32));
            }
            ptr.push(dof.len());
            let centre = low.map(|at| at as f64 + 0.5);
            let (turn, radius) = (std::f64::consts::TAU * centre[0] / steps[0] as f64, 20.0 + centre[1]);
            centres.push(if closed { [radius * turn.cos(), radius * turn.sin(), centre[2]] } else { centre });
        }
        Self { ptr, dof, centres, unknowns: 3 * along.iter().product::<usize>() }
    }

    fn elements(&self) -> Elements<'_> {
        Elements { ptr: &self.ptr, dof: &self.dof, unknowns: self.unknowns }
    }

    /// Unknowns of every piece.
    fn sizes(&self, piece: &[u32]) -> Vec<usize> {
        let mut sets = vec![
            std::collections::BTreeSet::<u32>::new();
            piece.iter().max().map_or(0, |last| *last as usize + 1)
        ];
        for (e, &piece) in piece.iter().enumerate() {
            sets[piece as usize].extend(&self.dof[self.ptr[e]..self.ptr[e + 1]]);
        }
        sets.iter().map(std::collections::BTreeSet::len).collect()
    }

    /// Copies of unknowns, and the largest piece against the mean; every piece hangs together by faces.
    fn quality(&self, piece: &[u32]) -> (usize, f64) {
        let sizes = self.sizes(piece);
        let graph = Graph::of(&Incidence::of(&self.elements()).unwrap()).unwrap();
        assert_eq!(graph.parts(piece).unwrap().1.len(), sizes.len(), "a piece is not connected");
        let all: usize = sizes.iter().sum();
        (all - self.unknowns, *sizes.iter().max().unwrap() as f64 * sizes.len() as f64 / all as f64)
    }
}

/// Copies that a cut into equal blocks has.
fn ideal(steps: usize, blocks: usize) -> usize {
    3 * ((steps + blocks).pow(3) - (steps + 1).pow(3))
}

#[test]
fn a_cube_is_cut_nearly_as_well_as_into_equal_blocks() {
    for (steps, blocks) in [(28_usize, 4_usize), (28, 7), (18, 6)] {
        let grid = Grid::new([steps; 3], false);
        for (centres, copies, balance) in [(Some(&grid.centres[..]), 1.01, 1.01), (None, 1.35, 1.25)] {
            let piece = cut(&grid.elements(), centres, blocks.pow(3)).unwrap();
            assert_eq!(grid.sizes(&piece).len(), blocks.pow(3));
            let (found, most) = grid.quality(&piece);
            let known = centres.is_some();
            assert!(
                found as f64 <= copies * ideal(steps, blocks) as f64,
                "{steps} {blocks} {known}: {found}"
            );
            assert!(most <= balance, "{steps} {blocks} {known}: {most}");
        }
    }
}

#[test]
fn rings_plates_and_bars_are_cut_into_connected_pieces_of_one_size() {
    for (grid, pieces, most) in [
        (Grid::new([60, 3, 3], true), 12, 1.1),
        (Grid::new([40, 40, 1], false), 16, 1.1),
        (Grid::new([100, 2, 2], false), 10, 1.1),
        (Grid::new([13, 11, 7], false), 9, 1.25),
    ] {
        for centres in [Some(&grid.centres[..]), None] {
            let piece = cut(&grid.elements(), centres, pieces).unwrap();
            let (_, found) = grid.quality(&piece);
            assert!(found <= most + if centres.is_some() { 0.0 } else { 0.2 }, "{found}");
        }
    }
}

#[test]
fn small_elements_go_with_those_that_have_their_unknowns() {
    let mut grid = Grid::new([6, 6, 6], false);
    let bricks = grid.ptr.len() - 1;
    for dof in (0..grid.unknowns as u32).step_by(7) {
        grid.dof.push(dof);
        grid.ptr.push(grid.dof.len());
        grid.centres.push([0.0; 3]);
    }
    // all its unknowns are held
    grid.ptr.push(grid.dof.len());
    grid.centres.push([0.0; 3]);
    let piece = cut(&grid.elements(), Some(&grid.centres), 8).unwrap();
    for e in bricks..grid.ptr.len() - 2 {
        let dof = grid.dof[grid.ptr[e]];
        let has = |brick: &usize| grid.dof[grid.ptr[*brick]..grid.ptr[*brick + 1]].contains(&dof);
        assert!((0..bricks).filter(has).any(|brick| piece[brick] == piece[e]));
    }
    assert_eq!(grid.sizes(&piece).len(), 8);
}

#[test]
fn parts_of_a_body_get_pieces_of_their_own_and_none_more_than_elements() {
    let [one, other] = [Grid::new([8, 4, 4], false), Grid::new([4, 4, 4], false)];
    let mut both = Grid {
        ptr: one.ptr.clone(),
        dof: one.dof.clone(),
        centres: one.centres.clone(),
        unknowns: one.unknowns + other.unknowns,
    };
    both.dof.extend(other.dof.iter().map(|dof| dof + one.unknowns as u32));
    both.ptr.extend(other.ptr[1..].iter().map(|at| at + one.dof.len()));
    both.centres.extend(&other.centres);
    let piece = cut(&both.elements(), Some(&both.centres), 6).unwrap();
    let (first, second) = piece.split_at(one.centres.len());
    let pieces = |of: &[u32]| of.iter().collect::<std::collections::BTreeSet<_>>().len();
    assert_eq!((pieces(first), pieces(second), pieces(&piece)), (4, 2, 6));
    let few = Grid::new([2, 2, 1], false);
    assert_eq!(few.sizes(&cut(&few.elements(), None, 9).unwrap()), [24; 4]);
    assert_eq!(cut(&few.elements(), None, 1).unwrap(), [0; 4]);
}
