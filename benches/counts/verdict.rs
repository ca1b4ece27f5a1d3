//! Whether a count is good enough, and how it is printed.

use crate::measure::Measurement;
use crate::table::Case;

/// How much F may exceed the published figure.
const EXCESS: f64 = 1.2;
/// By how many applications the linear solve may exceed the published figure.
const SLACK: usize = 2;
/// Closed rows, percent: a deck with few or nearly all rows in contact is too easy.
const BALANCED: std::ops::RangeInclusive<f64> = 25.0..=75.0;

/// What keeps the line from being ok; nothing when it is.
pub fn reasons(case: &Case, m: &Measurement) -> Vec<String> {
    let mut reasons = Vec::new();
    if m.ratio() > case.goal {
        reasons.push("the ratio exceeds its goal".to_owned());
    }
    if let Some(published) = case.published {
        let (most, linear) = (EXCESS * published.products as f64, published.linear + SLACK);
        if m.linear > linear {
            reasons.push(format!("linear exceeds {} + {SLACK}", published.linear));
        }
        if m.products as f64 > most {
            reasons.push(format!("F exceeds {EXCESS} x {}", published.products));
        }
    }
    if case.all_closed && m.closed < m.rows {
        reasons.push("not all rows closed".to_owned());
    }
    if !case.all_closed && !BALANCED.contains(&m.closed_percent()) {
        reasons.push(format!("not {} to {} % closed", BALANCED.start(), BALANCED.end()));
    }
    reasons
}

/// The line of a deck and its details.
pub fn line(case: &Case, m: &Measurement, reasons: &[String]) -> String {
    let word = if reasons.is_empty() { "ok" } else { "short" };
    let because = if reasons.is_empty() { String::new() } else { format!("; {}", reasons.join(", ")) };
    format!(
        "count {} F {} linear {} ratio {:.2} goal {:.2} {word}\n    M {}, coarse solves {}, coarse \
         refactorisations {}, closed {} of {} rows ({:.0} %), {:.2} s, in all {:.1} s{because}",
        case.name,
        m.products,
        m.linear,
        m.ratio(),
        case.goal,
        m.preconditioned,
        m.coarse_solves,
        m.coarse_factorisations,
        m.closed,
        m.rows,
        m.closed_percent(),
        m.seconds,
        m.seconds_in_all,
    )
}
