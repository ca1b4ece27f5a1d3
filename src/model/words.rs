//! Options whose value is one of a few words.

use std::ffi::CStr;

/// An option with a fixed set of words; the first is the default.
pub trait Word {
    fn word(&self) -> &'static CStr;
    /// Takes the value for this word, if there is one.
    fn take(&mut self, word: &[u8]) -> bool;
    fn words(&self) -> &'static [&'static CStr];
}

macro_rules! words {
    ($(
        $(#[$doc:meta])*
        $name:ident: $first:ident = $first_word:literal $(, $other:ident = $word:literal)+;
    )+) => {$(
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
        pub enum $name {
            #[default]
            $first,
            $($other,)+
        }

        impl $name {
            const ALL: &'static [Self] = &[Self::$first $(, Self::$other)+];
            pub const WORDS: &'static [&'static CStr] = &[$first_word $(, $word)+];
        }

        impl Word for $name {
            fn word(&self) -> &'static CStr {
                Self::WORDS[*self as usize]
            }

            fn take(&mut self, word: &[u8]) -> bool {
                let found = Self::ALL.iter().find(|value| value.word().to_bytes() == word);
                found.map(|value| *self = *value).is_some()
            }

            fn words(&self) -> &'static [&'static CStr] {
                Self::WORDS
            }
        }
    )+};
}

words! {
    /// `preconditioner`
    Preconditioning: Automatic = c"automatic", None = c"none", Lumped = c"lumped", Dirichlet = c"dirichlet";
    /// `dual_operator`
    OperatorForm: Automatic = c"automatic", Explicit = c"explicit", Implicit = c"implicit";
    /// `method`
    Method: Proportioning = c"proportioning", PaperFeasible = c"paper-feasible",
    PaperMonotone = c"paper-monotone", PaperExtrapolating = c"paper-extrapolating";
    /// `start`
    StartFrom: Cold = c"cold", Previous = c"previous";
    /// `finish`
    FinishBy: Automatic = c"automatic", None = c"none", Direct = c"direct";
    /// `log_level`
    LogTo: Phase = c"phase", Result = c"result", Step = c"step";
    /// `paper_units`
    PaperUnits: Relative = c"relative", Printed = c"printed";
    /// `paper_step_1`
    PaperStep1: Corrected = c"corrected", Printed = c"printed";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_makes_the_value_that_has_it_and_no_other_word_makes_one() {
        let mut method = Method::default();
        for word in method.words() {
            assert!(method.take(word.to_bytes()) && method.word() == *word);
        }
        assert_eq!(method, Method::PaperExtrapolating);
        assert!(!method.take(b"Paper-monotone") && method == Method::PaperExtrapolating);
    }
}
