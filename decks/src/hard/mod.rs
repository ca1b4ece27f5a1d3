//! Random problems that have been refused, left unsolved or answered wrongly by hands other than ours: nearly dependent rows,
//! loads that balance themselves, leverage, gaps and bodies of unequal size, few digits, motions that nothing resists.
//!
//! What may come of a case is known: it is made from an answer as [`crate::varied`] makes its cases, or from a proof that there is
//! none. Cases of [`Kind::Drawn`] have small integers for data and are made from neither: whoever tells their end has to prove it
//! ([`proof`]).
//!
//! | file | |
//! |---|---|
//! | `bodies` | contrast, connected parts, digits, coordinates far from the origin |
//! | `rows` | ties, rows nearly parallel, leverage, rows without force |
//! | `balanced` | loads on free bodies that balance themselves, nearly or not |
//! | `none` | loads that nothing holds, gaps that contradict each other |
//! | `small` | few unknowns, degenerate; drawn without an answer |
//! | `proof` | whether a motion or weights of rows prove that there is no answer |

mod balanced;
mod bodies;
mod none;
pub mod proof;
mod rows;
mod small;
#[cfg(test)]
mod tests;

use crate::random::Random;
use crate::varied::{self, draft::Draft, Class, Varied};
use crate::yardstick::Answer;
use crate::Deck;

/// What is hard about a case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// Free bodies under loads whose resultant is 1e-16 to 1e-2 of them.
    Balanced,
    /// Chains of ties with contrast 1 to 1e6, closed by ties that follow from the others.
    Ties,
    /// Rows that differ by 1e-12 to 1e-6 of their length.
    Near,
    /// Bodies without forces on their rows, some touching, some without load.
    Idle,
    /// Forces 1e3 to 1e6 times the load.
    Leverage,
    /// Gaps of 1e-6 to 1e6 deformations.
    Gaps,
    /// Bodies of stiffness 1e-4 to 1e4.
    Contrast,
    /// K of 8 to 15 digits.
    Digits,
    /// Bodies of two to four connected parts.
    Parts,
    /// 10 to 25 unknowns, about 5 contact rows and 4 ties, of small integers, redundant, many without force.
    Small,
    /// The same with loads and gaps drawn as well: the end is not known.
    Drawn,
    /// A rigid motion that no row resists, and a load that drives it.
    NotHeld,
    /// Weights of rows that leave nothing of them but a negative gap.
    Contradict,
}

pub const KINDS: [Kind; 13] = [
    Kind::Balanced,
    Kind::Ties,
    Kind::Near,
    Kind::Idle,
    Kind::Leverage,
    Kind::Gaps,
    Kind::Contrast,
    Kind::Digits,
    Kind::Parts,
    Kind::Small,
    Kind::Drawn,
    Kind::NotHeld,
    Kind::Contradict,
];

/// How the library learns the null spaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Given {
    NullSpaces,
    Coordinates,
    Nothing,
}

/// What a case may end with: near a limit both sides of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ends {
    pub solved: bool,
    pub marginal: bool,
    pub load_not_held: bool,
    pub gaps_contradict: bool,
}

impl Ends {
    pub const SOLVED: Ends =
        Ends { solved: true, marginal: false, load_not_held: false, gaps_contradict: false };
    pub const ANY: Ends = Ends { solved: true, marginal: true, load_not_held: true, gaps_contradict: true };
}

#[derive(Clone, Debug)]
pub struct Hard {
    /// Named after seed and kinds.
    pub deck: Deck,
    /// The kind the case was drawn for, then those that came with it.
    pub kinds: Vec<Kind>,
    pub given: Given,
    pub ends: Ends,
    /// Where there is one, and it is known. Of dependent rows only B'lambda + H'mu is unique.
    pub answer: Option<Answer>,
    /// As in [`Varied`], of the answer.
    pub undetermined: usize,
    pub condition: f64,
    /// Part of the loads that nothing holds: what takes it is anybody's choice.
    pub resultant: f64,
    /// Decimal digits of K, 16 for all.
    pub digits: usize,
    /// In words: figures that the kinds have drawn.
    pub detail: String,
}

impl Hard {
    /// Floating bodies whose rigid motions K resists by more than 1e-13 of itself: whether a load is held is then blurred.
    pub fn blurred(&self) -> bool {
        self.digits < 13 && self.deck.bodies.iter().any(|body| !body.modes().is_empty())
    }

    /// All kinds in one word.
    pub fn kind(&self) -> String {
        let names: Vec<String> = self.kinds.iter().map(|kind| format!("{kind:?}")).collect();
        names.join("+")
    }
}

/// How cases are mixed.
#[derive(Clone, Copy, Debug)]
pub struct Mixture {
    /// Unknowns of a case, about.
    pub unknowns: usize,
    /// Chance of each kind that may come with another one.
    pub chance: f64,
    /// Chance of coordinates 1000 bodies away from the origin, of no null spaces, of springs in the rows.
    pub far: f64,
    pub nothing: f64,
    pub springs: f64,
}

/// Cases mostly of one kind, up to 80 unknowns.
pub const MIXTURE: Mixture = Mixture { unknowns: 80, chance: 0.08, far: 0.15, nothing: 0.1, springs: 0.08 };

/// Smaller ones, of more kinds at once.
pub const SECOND_MIXTURE: Mixture =
    Mixture { unknowns: 45, chance: 0.25, far: 0.3, nothing: 0.2, springs: 0.15 };

/// Kinds that may come with others.
const EXTRAS: [Kind; 7] =
    [Kind::Ties, Kind::Near, Kind::Idle, Kind::Leverage, Kind::Gaps, Kind::Contrast, Kind::Parts];

/// The kind that the case of a seed is drawn for.
pub fn main(seed: u64) -> Kind {
    KINDS[(seed % KINDS.len() as u64) as usize]
}

/// The case of one seed; seeds 13 apart are of the same main kind.
pub fn case(seed: u64) -> Hard {
    mixed(seed, &MIXTURE)
}

/// The same from another mixture.
pub fn mixed(seed: u64, mixture: &Mixture) -> Hard {
    let main = main(seed);
    let mut random = Random::new(seed ^ 0x6861_7264);
    if matches!(main, Kind::Small | Kind::Drawn) {
        return small::case(seed, main, random);
    }
    let mut plan = Plan::new(main, mixture, &mut random);
    let mut draft = plan.bodies(mixture.unknowns, random);
    match main {
        Kind::Balanced => balanced::case(seed, plan, draft),
        Kind::NotHeld => none::not_held(seed, plan, draft),
        Kind::Contradict => none::contradict(seed, plan, draft),
        _ => {
            plan.rows(&mut draft);
            plan.finish(seed, draft)
        }
    }
}

/// What has been drawn about a case before its bodies.
struct Plan {
    kinds: Vec<Kind>,
    classes: Vec<Class>,
    given: Given,
    /// Coordinates far from the origin.
    far: bool,
    digits: usize,
    detail: String,
    /// Equality row, and the rows it is a sum of with their factors: its h is that sum, rounded once more.
    sums: Vec<(usize, Vec<(usize, f64)>)>,
}

impl Plan {
    fn new(main: Kind, mixture: &Mixture, random: &mut Random) -> Plan {
        let mut kinds = vec![main];
        for extra in EXTRAS {
            let fits = main != Kind::Balanced || matches!(extra, Kind::Contrast | Kind::Parts);
            if random.chance(mixture.chance) && extra != main && fits {
                kinds.push(extra);
            }
        }
        let rounded = main == Kind::Digits || main == Kind::Balanced && random.chance(0.15);
        let digits = if rounded { 8 + random.below(8) } else { 16 };
        let springs = random.chance(mixture.springs) && main != Kind::Balanced;
        let nothing = random.chance(mixture.nothing) && digits >= 13;
        let given = match random.chance(0.5) {
            _ if nothing => Given::Nothing,
            true => Given::NullSpaces,
            false => Given::Coordinates,
        };
        let mut classes = if springs { vec![Class::Springs] } else { vec![] };
        if main == Kind::Balanced && random.chance(0.2) {
            classes.push(Class::Moduli);
        }
        Plan {
            kinds,
            classes,
            given,
            far: random.chance(if main == Kind::Balanced { 0.4 } else { mixture.far }),
            digits,
            detail: String::new(),
            sums: Vec::new(),
        }
    }

    fn is(&self, kind: Kind) -> bool {
        self.kinds.contains(&kind)
    }

    fn note(&mut self, what: &str) {
        self.detail.push_str(what);
        self.detail.push_str("; ");
    }

    /// Rows of all kinds but those that take their own.
    fn rows(&mut self, draft: &mut Draft) {
        let idle = if self.is(Kind::Idle) { rows::idle(self, draft) } else { vec![] };
        if idle.len() < draft.group.len() {
            varied::rows::draw(draft);
        }
        if self.is(Kind::Ties) {
            rows::ties(self, draft);
        }
        if self.is(Kind::Leverage) {
            rows::leverage(self, draft);
        }
        if self.is(Kind::Near) {
            rows::near(self, draft);
        }
        if self.is(Kind::Idle) {
            rows::unload(draft, &idle);
        }
        if self.is(Kind::Gaps) {
            rows::gaps(self, draft);
        } else {
            draft.travel();
        }
    }

    /// Gaps and loads.
    fn finish(self, seed: u64, draft: Draft) -> Hard {
        let mut varied = draft.finish(seed);
        for (row, sum) in &self.sums {
            let rhs = &mut varied.deck.equalities.rhs;
            rhs[*row] = sum.iter().map(|&(i, factor)| factor * rhs[i]).sum();
        }
        self.hard(seed, varied)
    }

    fn hard(self, seed: u64, varied: Varied) -> Hard {
        let Varied { mut deck, displacement, forces, equality_forces, .. } = varied;
        let (condition, undetermined) =
            (varied::condition(&deck, &forces), varied::undetermined(&deck, &forces));
        let names: Vec<String> = self.kinds.iter().map(|kind| format!("{kind:?}")).collect();
        deck.name = format!("hard_{seed}_{}", names.join("+"));
        Hard {
            deck,
            kinds: self.kinds,
            given: self.given,
            ends: Ends::SOLVED,
            answer: Some(Answer { u: displacement, lambda: forces, mu: equality_forces }),
            undetermined,
            condition,
            resultant: 0.0,
            digits: self.digits,
            detail: self.detail,
        }
    }
}
