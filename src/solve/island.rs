//! One island: solve the dual, recover the displacements, certify.

use std::time::{Duration, Instant};

use crate::body::Home;
use crate::error::Result;
use crate::linalg::{Csr, Operator};
use crate::model::{Accuracy, Settings, SolvedModel};
use crate::platform::{interrupt, threads};
use crate::progress::{Steps, Stops, Voice};
use crate::qp::{self, Direct, Effort, Qp, Rung, Solution, Tries, Verdict};
use crate::solve::case::Case;
use crate::solve::certifier::Certifier;
use crate::solve::diagnosis::Unheld;
use crate::solve::fallback::MethodOptions;
use crate::solve::finish::{finish, is_to_finish};
use crate::solve::host_form::host_form;
use crate::solve::interruptible::Interruptible;
use crate::solve::method::chosen;
use crate::solve::outcome::outcome;
use crate::solve::presolve::presolve;
use crate::solve::recovery::{Ending, Faces, Recovery};
use crate::solve::report::Outcome;
use crate::solve::rounds::solve_in_rounds;
use crate::solve::scaled::Scaled;
use crate::solve::slides::Slide;

/// How the solution of one island ended.
pub struct Solved {
    pub ending: Ending,
    /// Of every body, length.
    pub u: Vec<Home>,
    pub outcome: Outcome,
    /// The direct finish has replaced the answer.
    pub finished: bool,
    /// The largest share of the load that nothing holds, over the groups of bodies that move together.
    pub unheld: f64,
    /// The motion of a body that slides farthest, along rows that hardly resist it.
    pub slide: Option<Slide>,
    /// G' without resistance that is noise of the data, if bodies would slide along it.
    pub cleaned: Option<Box<Csr>>,
    /// The second tries made.
    pub tries: Tries,
    /// Time for recovery and certification of answers, including the last.
    pub recovery: Duration,
}

/// Limit of the answers after which resistance that is noise of the data is removed from G.
const CLEANINGS: usize = 4;

/// Name of S11 in the log.
const DIAGNOSIS: &str = "forces nearest to the load";

/// Result of one run on an island.
enum Tried {
    Ended(Box<Solved>),
    /// Bodies slide along rows that resist them by no more than the accuracy of the data: G' without this resistance, and
    /// the forces of this answer.
    Slides {
        cleaned: Box<Csr>,
        x: Vec<f64>,
        below: f64,
    },
    /// No forces were found that hold the load, with the rows marked in `far` left out.
    NotHeld {
        far: Vec<bool>,
    },
}

/// Solves (10)-(11) on island `number`: the dual from x = `start`, the displacements, the certificate. If there is no
/// answer, the error names the reason. A part of the load that nothing holds is removed if it may be rounding.
pub fn solve_island(
    case: Case,
    number: usize,
    start: Vec<f64>,
    stops: &Stops,
    voice: &mut dyn Voice,
) -> Result<Solved> {
    threads::with_team(case.threads(), || {
        let (ended, tries) =
            qp::during(case.model.settings.without as u64, || solve_held(case, number, start, stops, voice));
        Ok(Solved { tries, ..ended? })
    })
}

fn solve_held(
    case: Case,
    number: usize,
    mut start: Vec<f64>,
    stops: &Stops,
    voice: &mut dyn Voice,
) -> Result<Solved> {
    let mut dual = scaled(case)?;
    if start.iter().any(|x| *x != 0.0) {
        case.ready.dual.load_springs(&dual.resultants, &mut start);
    }
    let mut cleanings = 0;
    loop {
        let cleans = cleanings < CLEANINGS;
        match interrupt::part("dual solve", || run(case, number, (&dual, cleans), &start, stops, voice))? {
            Tried::Ended(mut solved) => {
                solved.cleaned = dual.cleaned;
                return Ok(*solved);
            }
            Tried::Slides { cleaned, x, below } => {
                voice.line(format!(
                    "bodies slide along rows that resist them by less than {below:.1e} of their terms, the accuracy of the \
                     data: these motions count as undetermined"
                ))?;
                cleanings += 1;
                dual = scaled(case)?;
                dual.cleaned = Some(cleaned);
                start = x;
            }
            Tried::NotHeld { far } => {
                let least = interrupt::part(DIAGNOSIS, || Unheld::least(case, &dual, &far))?;
                if let Some(error) = least.proof(case, &dual, &far)? {
                    return Err(error);
                }
                let share = least.share;
                let relative = match Rung::Relative.is_tried() {
                    true => interrupt::part(DIAGNOSIS, || Unheld::relative(case, &dual, &far))?,
                    false => None,
                };
                let left = relative.filter(Unheld::is_little).unwrap_or(least);
                dual.take(case, &left.x, left.load_to_take(share), share)?;
                dual.along = left.amplitudes;
                start = left.x;
            }
        }
    }
}

/// Scaled loads and gaps for the dual; refuses rows whose gaps no displacement satisfies.
pub fn scaled(case: Case) -> Result<Scaled> {
    Scaled::new(case, |farthest| interrupt::part("presolve", || presolve(case, farthest)))
}

/// One run on these loads and gaps: method, least travel, corrector, verdict.
fn run(
    case: Case,
    number: usize,
    (dual, cleans): (&Scaled, bool),
    start: &[f64],
    stops: &Stops,
    voice: &mut dyn Voice,
) -> Result<Tried> {
    let (settings, ready) = (&case.model.settings, case.ready);
    let f = Interruptible::new(&ready.dual, ready.product_threads(case.threads()));
    let (qp, direct) = (dual.qp(ready, &f), direct(case)?);
    let mut judge = Certifier::new(Recovery::new(case, dual, Faces::new(qp, direct))?);
    let steps = &mut Steps::new(number, ready.island.unit, &dual.gaps.bounded, stops.clone(), voice);
    let solution = by_method(case, dual, (qp, direct), start, &mut judge, steps)?;
    if matches!(solution.verdict, Verdict::Infeasible { .. }) && dual.unheld.is_none() {
        return Ok(Tried::NotHeld { far: judge.assumed.far });
    }
    let (judging, recovering) = (judge.spent, Instant::now());
    // an accepted answer is returned with its displacements and its certificate
    let mut ending = interrupt::never(|| judge.ending(solution))?;
    let recovery = &judge.recovery;
    let spoilt = recovery.bring_to_rest(&mut ending)?;
    let slides = interrupt::never(|| recovery.slides(&ending))?;
    let accuracy = Accuracy {
        data: match dual.cleaned.is_some() || !slides.all.is_empty() {
            true => case.model.accuracy_of_coordinates(),
            false => settings.data_accuracy,
        },
    };
    if cleans && !recovery.friction && !ending.solution.verdict.is_stop() {
        let cleaned = slides.without_noise(recovery, accuracy.data);
        if let Some(cleaned) = cleaned.filter(|_| Rung::Slides.is_tried()) {
            return Ok(Tried::Slides { cleaned, x: ending.solution.x, below: accuracy.data });
        }
    }
    let finished = corrected(settings, recovery, &mut ending, spoilt)?;
    let slide = if finished { interrupt::never(|| recovery.slides(&ending))? } else { slides }.worst();
    let outcome = outcome(case, dual, recovery, &mut ending, (slide.is_some(), accuracy))?;
    let stays = |k: usize| case.model.bodies[case.island().bodies[k]].body.is_given_there();
    let u = interrupt::never(|| recovery.data.bodies.home(&ending.recovered.u.of, stays))?;
    Ok(Tried::Ended(Box::new(Solved {
        ending,
        u,
        outcome,
        finished,
        unheld: dual.unheld.as_ref().map_or(0.0, |taken| taken.share),
        slide,
        cleaned: None,
        tries: Tries::default(),
        recovery: judging + recovering.elapsed(),
    })))
}

/// Solves the dual by the method that the options ask for.
fn by_method<'a>(
    case: Case<'a>,
    dual: &Scaled,
    (qp, direct): (Qp<'a>, Direct<'a>),
    start: &[f64],
    judge: &mut Certifier<'a>,
    steps: &mut Steps,
) -> Result<Solution> {
    let settings = &case.model.settings;
    let other = chosen(settings, case.method)?;
    match other.filter(|other| other.is_in_units_of_host(settings) && !case.has_friction()) {
        Some(other) => {
            let form = host_form(case, &dual.gaps)?;
            other.solve(settings, qp, Some(&form), start, judge, steps)
        }
        None => solve_in_rounds(case, &MethodOptions { settings, other, direct }, qp, start, judge, steps),
    }
}

/// Corrects a solved answer by the data of the host, first that of least travel if a far way has spoilt it; whether a
/// corrected answer has replaced it.
fn corrected(
    settings: &Settings,
    recovery: &Recovery,
    ending: &mut Ending,
    spoilt: Option<Ending>,
) -> Result<bool> {
    let is_solved = ending.solution.verdict == Verdict::Solved;
    if !is_solved || !is_to_finish(settings, recovery, ending, spoilt.is_some()) {
        return Ok(false);
    }
    if let Some(mut rest) = spoilt {
        finish(recovery, &mut rest, Effort::AllSets)?;
        if rest.judgement.certificate.passed() {
            *ending = rest;
            return Ok(true);
        }
    }
    Ok(finish(recovery, ending, Effort::AllSets)?.replaced)
}

/// F for the direct method, which observes the memory limit.
pub fn direct(case: Case<'_>) -> Result<Direct<'_>> {
    let Case { model: SolvedModel { settings, .. }, prepared, ready, .. } = case;
    let asked = usize::try_from(settings.direct_limit).unwrap_or(usize::MAX);
    let most = asked.min(ready.dual.order() + ready.dual.modes());
    let fits = prepared.done(case.model)?.operators.check_more(settings, Direct::bytes(most)).is_ok();
    Ok(Direct { entries: &*ready.dual, limit: if fits { most } else { 0 } })
}
