//! What variables of the environment ask of a battery: other problems, or more of them.

use std::ops::Range;

/// The value of a variable that is a whole number.
pub fn asked(name: &str) -> Option<u64> {
    std::env::var(name).ok().and_then(|text| text.parse().ok())
}

/// The seeds of a run: BATTERY problems, or `problems`, from BATTERY_SEED, or 0, on.
pub fn seeds(problems: u64) -> Range<u64> {
    let first = asked("BATTERY_SEED").unwrap_or(0);
    first..first + asked("BATTERY").unwrap_or(problems)
}

/// Whether BATTERY_MIXTURE is 2: problems are drawn from the second mixture.
pub fn is_second_mixture() -> bool {
    asked("BATTERY_MIXTURE") == Some(2)
}

/// A kind of problem, named with its mixture.
pub fn with_mixture(kind: &str) -> String {
    format!("{kind}{}", if is_second_mixture() { " 2" } else { "" })
}
