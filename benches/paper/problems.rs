//! What is run, what the paper prints for it, and the range in which a figure of ours is `ok`: exact for Problem 1; for
//! Problems 2 and 3, whose data are not printed, the sizes of our data and the counts that an independent program
//! needed on it. docs/paper.md gives the reason for every figure that is not the printed one.

/// One problem with the configuration of the paper's method.
pub struct Problem {
    pub name: &'static str,
    /// Folder in tests/data.
    pub data: &'static str,
    pub method: &'static str,
    pub gamma: f64,
    pub rho_0: f64,
    pub m: f64,
    /// Relative precision of Step 2.
    pub tolerance: f64,
    /// Dofs held in K+ of each body; none: chosen by the library.
    pub fixing: &'static [&'static [usize]],
    pub figures: Figures,
}

pub struct Figures {
    pub outer: Figure,
    pub inner: Figure,
    pub products: Figure,
    pub unknowns: Figure,
    pub duals: Figure,
    pub accuracy: Figure,
}

/// The printed figure, and the range in which ours is `ok`.
pub struct Figure {
    pub printed: Option<f64>,
    least: f64,
    most: f64,
}

impl Figure {
    pub fn holds(&self, ours: f64) -> bool {
        (self.least..=self.most).contains(&ours)
    }
}

const fn range(printed: f64, least: f64, most: f64) -> Figure {
    Figure { printed: Some(printed), least, most }
}

const fn exact(printed: f64) -> Figure {
    range(printed, printed, printed)
}

/// No figure in the paper; ours is known.
const fn unprinted(least: f64, most: f64) -> Figure {
    Figure { printed: None, least, most }
}

const fn at_most(printed: f64) -> Figure {
    range(printed, 0.0, printed)
}

const ANY: Figure = unprinted(0.0, f64::INFINITY);

/// Problems 2: printed rho = 10^6, M = 10^4.
const fn cylinders(
    name: &'static str,
    gamma: f64,
    fixing: &'static [&'static [usize]],
    f: Figures,
) -> Problem {
    let (method, rho_0, m, tolerance) = ("paper-extrapolating", 1e6, 1e4, 1e-4);
    Problem { name, data: name, method, gamma, rho_0, m, tolerance, fixing, figures: f }
}

/// Problems 3: the printed defaults, Gamma = 10.
const fn blocks(name: &'static str, fixing: &'static [&'static [usize]], figures: Figures) -> Problem {
    let (method, gamma, rho_0, m, tolerance) = ("paper-monotone", 10.0, 100.0, 1.0, 1e-4);
    Problem { name, data: name, method, gamma, rho_0, m, tolerance, fixing, figures }
}

pub const PROBLEMS: [Problem; 6] = [
    Problem {
        name: "p1",
        data: "p1_P3",
        method: "paper-extrapolating",
        gamma: 1.0,
        rho_0: 100.0,
        m: 1.0,
        tolerance: 1e-5,
        // the node (2, 1)
        fixing: &[&[], &[440]],
        figures: Figures {
            outer: exact(3.0),
            inner: exact(23.0),
            products: exact(34.0),
            unknowns: unprinted(861.0, 861.0),
            duals: unprinted(21.0, 21.0),
            accuracy: at_most(1e-5),
        },
    },
    cylinders(
        "p2_A",
        0.1,
        // 30 of the 72 vertical unknowns lead into the range, the choice of the library (25 steps) does not
        &[&[1], &[]],
        Figures {
            outer: range(3.0, 2.0, 2.0),
            inner: range(42.0, 36.0, 61.0),
            products: ANY,
            unknowns: range(288.0, 283.0, 283.0),
            duals: range(14.0, 13.0, 13.0),
            accuracy: at_most(1e-4),
        },
    ),
    cylinders(
        "p2_B1",
        0.1,
        // 25 of the 72 vertical unknowns lead into the range, the choice of the library (49 steps) does not
        &[&[3], &[3]],
        Figures {
            outer: unprinted(2.0, 2.0),
            inner: unprinted(56.0, 62.0),
            products: ANY,
            unknowns: range(288.0, 284.0, 284.0),
            duals: exact(14.0),
            accuracy: at_most(1e-4),
        },
    ),
    cylinders(
        "p2_B2",
        1.0,
        &[],
        Figures {
            outer: unprinted(2.0, 2.0),
            inner: unprinted(41.0, 53.0),
            products: ANY,
            unknowns: exact(288.0),
            duals: exact(14.0),
            accuracy: at_most(1e-4),
        },
    ),
    blocks(
        "p3_2block",
        &[&[], &[0, 3192, 3]],
        Figures {
            outer: range(3.0, 1.0, 1.0),
            inner: range(105.0, 70.0, 200.0),
            products: ANY,
            unknowns: range(4663.0, 4712.0, 4712.0),
            duals: exact(221.0),
            accuracy: at_most(1e-4),
        },
    ),
    blocks(
        "p3_3block",
        &[&[], &[0, 3192, 3], &[0, 1824, 3]],
        Figures {
            outer: range(3.0, 1.0, 1.0),
            inner: range(276.0, 210.0, 350.0),
            products: ANY,
            unknowns: range(6419.0, 6422.0, 6422.0),
            duals: range(382.0, 377.0, 377.0),
            accuracy: at_most(1e-4),
        },
    ),
];
