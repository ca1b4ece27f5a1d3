//! Random small problems, 3 to about 120 unknowns, of all the kinds that go wrong in practice, with a known answer.
//!
//! Bodies, displacements u, forces lambda, mu and the set of closed rows are drawn; loads and gaps follow from them,
//! f = K u + B'lambda + H'mu, c = B u - C lambda + slack, h = H u - C mu, each sum rounded once. The answer is right to the last
//! bit of f, c, h.
//!
//! | file | |
//! |---|---|
//! | `bodies` | springs, networks, trusses, blocks, supports by penalty |
//! | `draft` | a case while it is drawn |
//! | `rows` | contact rows, glue, struts, far rows |
//! | `condition` | motions that the closed rows leave, condition of the final face |

mod bodies;
mod condition;
pub(crate) mod draft;
pub(crate) mod rows;
#[cfg(test)]
pub(crate) mod tests;

pub use crate::dense::orthonormal;
use crate::random::Random;
use crate::varied::draft::Draft;
use crate::Deck;

/// What is special about a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Class {
    /// Two or three groups of bodies that no row joins, stiffness 1e-8 to 1e8, loads alike.
    Groups,
    /// Rows that never close: slack 1e6 to 1e30 displacements, some infinite.
    Far,
    /// Floating bodies move rigidly by 1 to 1e8 times their deformation.
    Travel,
    /// Displacements prescribed by penalty: K_ii (1 + p), p = 1e8 to 1e20, f_i = p K_ii u0.
    Penalty,
    /// Equality rows between bodies, also redundant ones.
    Glue,
    /// Half of the rows are springs; bodies of one unknown.
    Springs,
    /// No body feels a resultant: forces only within bodies, supports without reaction.
    Thermal,
    /// The last iteration of Newton's method: f nearly B'lambda, u 1e-6 to 1e-12 of what f alone would move.
    Newton,
    /// Every spring of a body has its own stiffness, down to 1e-9.
    Moduli,
    /// Bodies of stiffness 1e-6 to 1e6.
    StiffOnSoft,
    /// Null spaces are random combinations of the rigid modes.
    Mixed,
    /// Null spaces are wrong by 1e-13 of their length.
    Noisy,
    /// K, B, H, f, c, h have 15 decimal digits.
    Rounded,
    /// B and H have 8 to 14 decimal digits. Only as an extra.
    Printed,
    /// Some bodies of one unknown have 1e-20 to 1 of the stiffness that they were drawn with. Only as an extra.
    Pilots,
    /// Some bodies have 1e-22 to 1e-14 of the deformation and forces that they were drawn with. Only as an extra.
    Idle,
}

pub const CLASSES: [Class; 13] = [
    Class::Groups,
    Class::Far,
    Class::Travel,
    Class::Penalty,
    Class::Glue,
    Class::Springs,
    Class::Thermal,
    Class::Newton,
    Class::Moduli,
    Class::StiffOnSoft,
    Class::Mixed,
    Class::Noisy,
    Class::Rounded,
];

/// A problem with its answer.
#[derive(Clone, Debug)]
pub struct Varied {
    /// Named after the seed and all its classes. Gaps may be infinite.
    pub deck: Deck,
    /// The class the case was drawn for, then those that came with it.
    pub classes: Vec<Class>,
    /// u over all bodies, length.
    pub displacement: Vec<f64>,
    /// lambda, one force per contact row. Of dependent rows only B'lambda + H'mu is unique.
    pub forces: Vec<f64>,
    /// mu, one force per equality row.
    pub equality_forces: Vec<f64>,
    /// Dimension of the rigid motions that neither rows with a force nor equality rows resist; with any only forces and
    /// deformation are unique.
    pub undetermined: usize,
    /// Unknowns with a penalty.
    pub penalties: Vec<usize>,
    /// Pilots: unknown, and the stiffness that its rows give it.
    pub pilots: Vec<(usize, f64)>,
    /// Largest over smallest singular value of [K B_F' H'; B_F -C; H -C] on the rows F with a force, scaled by D = diag K and
    /// s_i = (b_i D^-1 b_i' + C_i)^-1/2, without the zeros of undetermined motions and redundant rows. Infinite where these
    /// cannot be told from the others.
    pub condition: f64,
}

impl Varied {
    /// All classes in one word.
    pub fn kind(&self) -> String {
        let names: Vec<String> = self.classes.iter().map(|class| format!("{class:?}")).collect();
        names.join("+")
    }
}

/// How cases are mixed.
#[derive(Clone, Copy, Debug)]
pub struct Mixture {
    /// Unknowns of a case, about.
    pub unknowns: usize,
    /// Classes that a case may have beside its main one, each with this chance.
    pub extras: &'static [Class],
    pub chance: f64,
}

/// Cases mostly of one class, up to 120 unknowns.
pub const MIXTURE: Mixture = Mixture {
    unknowns: 120,
    extras: &[Class::Far, Class::Glue, Class::Springs, Class::Mixed, Class::Noisy, Class::Rounded],
    chance: 0.1,
};

/// Smaller ones, of more classes at once.
pub const SECOND_MIXTURE: Mixture = Mixture {
    unknowns: 70,
    extras: &[
        Class::Moduli,
        Class::StiffOnSoft,
        Class::Travel,
        Class::Far,
        Class::Glue,
        Class::Springs,
        Class::Mixed,
        Class::Noisy,
        Class::Rounded,
    ],
    chance: 0.3,
};

/// What hosts hand over: pilots, printed rows and idle bodies among the others.
pub const HOST_MIXTURE: Mixture = Mixture {
    unknowns: 90,
    extras: &[
        Class::Printed,
        Class::Pilots,
        Class::Idle,
        Class::Travel,
        Class::Far,
        Class::Glue,
        Class::Springs,
        Class::Mixed,
        Class::Rounded,
    ],
    chance: 0.25,
};

/// The condition of any problem on the rows with a force, as [`Varied::condition`] has it.
pub fn condition(deck: &Deck, forces: &[f64]) -> f64 {
    condition::Face::of(deck, |i| forces[i] > 0.0).condition()
}

/// Dimension of the rigid motions that neither rows with a force nor equality rows resist.
pub fn undetermined(deck: &Deck, forces: &[f64]) -> usize {
    condition::Face::of(deck, |i| forces[i] > 0.0).undetermined
}

/// The case of one seed; seeds 13 apart are of the same main class.
pub fn case(seed: u64) -> Varied {
    mixed(seed, &MIXTURE)
}

/// The same from another mixture.
pub fn mixed(seed: u64, mixture: &Mixture) -> Varied {
    let mut random = Random::new(seed ^ 0x7661_7269_6564);
    let main = CLASSES[(seed % CLASSES.len() as u64) as usize];
    let mut classes = vec![main];
    for &extra in mixture.extras {
        let fits = extra != main && (main != Class::Thermal || extra != Class::Glue);
        if random.chance(mixture.chance) && fits {
            classes.push(extra);
        }
    }
    let mut draft = Draft::new(classes, mixture.unknowns, random);
    draft.round_stiffness();
    draft.deform();
    rows::draw(&mut draft);
    draft.round_rows();
    draft.travel();
    draft.prescribe();
    draft.finish(seed)
}

/// The nearest number of 15 decimal digits.
pub fn rounded(value: f64) -> f64 {
    rounded_to(value, 15)
}

/// The nearest number of so many decimal digits, 1 or more.
pub fn rounded_to(value: f64, digits: usize) -> f64 {
    if !value.is_finite() {
        return value;
    }
    format!("{value:.*e}", digits - 1).parse().expect("a number")
}
