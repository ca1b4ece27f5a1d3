//! The decks, cheap ones first, with their goals and the figures published for them.

use decks::{Cube, Deck, Glue, Moduli, Stack};

/// A generator with its parameters.
pub enum Model {
    Cube(Cube),
    Stack(Stack),
}

impl Model {
    pub fn build(&self) -> Deck {
        match self {
            Model::Cube(cube) => cube.build(),
            Model::Stack(stack) => stack.build(),
        }
    }
}

/// Figures known for a deck: applications of F, start gradients included.
#[derive(Clone, Copy)]
pub struct Published {
    pub linear: usize,
    pub products: usize,
}

pub struct Case {
    pub name: String,
    pub model: Model,
    /// Largest ratio of F to linear.
    pub goal: f64,
    pub published: Option<Published>,
    /// Every row closes on purpose.
    pub all_closed: bool,
}

/// F from the smaller deck to the larger one may grow by `goal`.
pub struct Comparison {
    pub from: String,
    pub to: String,
    pub goal: f64,
}

/// Name of the line about three more digits.
pub const TIGHTER: &str = "tolerance 1e-9 to 1e-12 cube_3x3x3_h4_floating";

pub fn cases() -> Vec<Case> {
    let mut cases = stacks();
    cases.extend([cube(2, 4, 1.5, Some((16, 20))), cube(3, 2, 1.6, Some((14, 16)))]);
    cases.extend([cube(3, 4, 1.5, Some((17, 20))), cube(4, 4, 1.5, Some((17, 21)))]);
    cases.push(compliant());
    cases.extend(contrasts());
    cases.extend(redundant());
    cases.extend([plane(4, 8, None), plane(4, 16, None), plane(4, 32, None)]);
    cases.extend([plane(8, 8, Some((16, 21))), plane(8, 16, Some((20, 25))), plane(16, 8, None)]);
    cases.extend([plane(8, 32, Some((24, 32))), plane(16, 16, None)]);
    cases.extend([slab(8, 1.6, 23), cube(5, 4, 1.5, Some((17, 24))), slab(12, 1.6, 26)]);
    cases.extend([cube(3, 8, 1.6, Some((22, 32))), plane(16, 32, None), slab(16, 1.65, 29)]);
    cases.extend(large_stacks());
    cases.push(cube(3, 12, 1.8, Some((25, 39))));
    cases
}

pub fn growths() -> [Comparison; 2] {
    let growth = |from: String, to: String, goal: f64| Comparison { from, to, goal };
    [growth(cube_name(2, 4), cube_name(5, 4), 1.3), growth(slab_name(8), slab_name(16), 1.35)]
}

/// The floating cube whose tolerance is tightened.
pub fn tighter() -> Case {
    let model = Cube { clamp: false, waves: 0.3, ..cubic(3, 4) };
    case(TIGHTER, Model::Cube(model), 1.6, None)
}

/// The first load step counted, and the cube that the steps load.
pub const FIRST_STEP: usize = 4;
pub fn stepped(step: usize) -> Case {
    case(format!("load_step_{step}"), Model::Cube(cubic(3, 4)), 1.1, None)
}

fn case(name: impl Into<String>, model: Model, goal: f64, published: Option<(usize, usize)>) -> Case {
    let published = published.map(|(linear, products)| Published { linear, products });
    Case { name: name.into(), model, goal, published, all_closed: false }
}

/// side^3 subdomains of h^3 elements, clamped at x = 0.
fn cubic(side: usize, h: usize) -> Cube {
    Cube { subdomains: [side; 3], elements: h, ..Cube::default() }
}

fn cube_name(side: usize, h: usize) -> String {
    format!("cube_{side}x{side}x{side}_h{h}")
}

/// The obstacle of 3^3 covered by a layer of the material of the body, one element thick: every contact row is a
/// spring about as stiff as the body is at its node.
fn compliant() -> Case {
    let model = Cube { layer: 0.25, ..cubic(3, 4) };
    case(format!("{}_compliant", cube_name(3, 4)), Model::Cube(model), 1.6, None)
}

fn cube(side: usize, h: usize, goal: f64, published: Option<(usize, usize)>) -> Case {
    case(cube_name(side, h), Model::Cube(cubic(side, h)), goal, published)
}

/// side^2 subdomains of h^2 elements in plane strain; half the load on 16^2, which else closes 80 % of the rows.
fn plane(side: usize, h: usize, published: Option<(usize, usize)>) -> Case {
    let pressure = if side < 16 { 1.0 } else { 0.5 } * Cube::default().pressure;
    let model = Model::Cube(Cube { dimension: 2, pressure, ..cubic(side, h) });
    case(format!("plane_{side}x{side}_h{h}"), model, if h < 12 { 1.6 } else { 1.8 }, published)
}

fn slab_name(side: usize) -> String {
    format!("slab_{side}x{side}_h4")
}

/// side x side x 1 subdomains, not clamped: waves of the normals hold it sideways.
fn slab(side: usize, goal: f64, products: usize) -> Case {
    let model = Cube { subdomains: [side, side, 1], clamp: false, waves: 0.3, ..cubic(side, 4) };
    case(slab_name(side), Model::Cube(model), goal, Some((18, products)))
}

/// Stiffness jumps between the subdomains of 3^3. The default load closes 1 % of the rows under stiff
/// subdomains: the checkerboards are pressed harder, the layers start with an interference of gap/4.
fn contrasts() -> [Case; 3] {
    let checkerboard = |contrast: f64, factor: f64| {
        let pressure = factor * Cube::default().pressure;
        Model::Cube(Cube { moduli: Moduli::Checkerboard(contrast), pressure, ..cubic(3, 4) })
    };
    let layers = Cube { moduli: Moduli::Layers(1e4), gap_offset: -0.005, ..cubic(3, 4) };
    [
        case("checkerboard_1e3", checkerboard(1e3, 300.0), 2.0, Some((53, 66))),
        case("checkerboard_1e6", checkerboard(1e6, 3e5), 2.0, None),
        case("layers_1e4", Model::Cube(layers), 2.0, Some((20, 23))),
    ]
}

/// Every pair of copies of a node is glued: at edges and corners of subdomains the rows depend on each other.
fn redundant() -> [Case; 3] {
    let named = |name: &str, goal, cube: Cube| {
        case(name, Model::Cube(Cube { glue: Glue::Redundant, ..cube }), goal, None)
    };
    [
        named("cube_3x3x3_h4_redundant", 1.5, cubic(3, 4)),
        named("plane_8x8_h8_redundant", 1.6, Cube { dimension: 2, ..cubic(8, 8) }),
        named(
            "slab_8x8_h4_redundant",
            1.6,
            Cube { subdomains: [8, 8, 1], clamp: false, waves: 0.3, ..cubic(8, 4) },
        ),
    ]
}

/// Two or three bodies on non-matching grids, floating and held. The default load closes 26 to 40 % of the rows
/// under a floating body; under one held at its side, or with repeated rows, it takes two or three times that.
fn stacks() -> Vec<Case> {
    let base = Stack { in_plane: vec![8, 6], layers: vec![4, 3], ..Stack::default() };
    let steel = 210_000.0;
    let three = Stack { bodies: 3, in_plane: vec![8, 6, 7], layers: vec![4, 3, 3], ..base.clone() };
    let variants = [
        ("two", [1.0, 2.0], base.clone()),
        ("two_e210000", [steel, 2.0 * steel], Stack { moduli: vec![steel], ..base.clone() }),
        ("two_contrast_1e6", [1.0, 1e6], Stack { moduli: vec![1.0, 1e6], ..base.clone() }),
        ("two_random_normals", [1.0, 2.0], Stack { noise: 0.1, ..base.clone() }),
        ("two_all_closed", [1.0, 1.0], Stack { gap: -0.001, ..base.clone() }),
        ("two_repeated_rows", [2.0, 3.0], Stack { repeated: 40, ..base.clone() }),
        ("two_flat", [1.0, 2.0], Stack { flat: true, ..base.clone() }),
        ("three", [1.0, 2.0], three),
    ];
    let none = [None, None];
    variants.into_iter().flat_map(|(name, loads, stack)| both_ways(name, stack, loads, none)).collect()
}

/// 46 875 unknowns (the held one fewer), 625 rows; matching grids.
fn large_stacks() -> [Case; 2] {
    let stack = Stack { in_plane: vec![24], layers: vec![12], ..Stack::default() };
    both_ways("two_47k", stack, [1.0, 1.0], [Some((9, 15)), Some((10, 25))])
}

/// The stack floating, then held at its side (coercive); loads in units of the default pressure.
fn both_ways(name: &str, stack: Stack, loads: [f64; 2], published: [Option<(usize, usize)>; 2]) -> [Case; 2] {
    let ways = [("floating", false, 2.0), ("held", true, 3.0)];
    std::array::from_fn(|k| {
        let (way, hold, goal) = ways[k];
        let pressure = loads[k] * stack.pressure;
        let model = Model::Stack(Stack { hold, pressure, ..stack.clone() });
        let all_closed = stack.gap < 0.0;
        Case { all_closed, ..case(format!("{name}_{way}"), model, goal, published[k]) }
    })
}
