//! The second tries of a solve. Each has a name, is counted, and can be left out (option `without`), which shows what it saves.

use std::cell::Cell;

/// Makes the list of second tries: name, where it stands, what is tried.
macro_rules! rungs {
    ($($rung:ident: $name:literal, $what:literal;)+) => {
        /// A second try; its number is its bit in option `without`.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Rung {
            $(#[doc = $what] $rung,)+
        }

        impl Rung {
            /// Name and meaning of each.
            pub const ALL: &[(Self, &str, &str)] = &[$((Self::$rung, $name, $what),)+];
        }
    };
}

rungs! {
    Start: "first face", "S6.1: a warm start's own face is tried first";
    ProjectionInside: "projection inside", "J3: an interior point method after short steps of a projection";
    Fit: "fitted again", "S8: the least-squares multiplier is refined";
    Plateau: "plateau", "P1: the answer is judged where the residual stays";
    TightenBy: "tightened by", "P1.3: the target by the violation reported";
    Tighten: "tightened", "P1.4: a tenth of the target";
    ProjectedFirst: "projected first", "P4: a step expected to leave the bounds is projected before its product";
    PullAll: "all pulling", "P9: all rows with a negative multiplier leave at once, before P10";
    Reference: "last motions", "P10: free motions of the last gradient projection";
    Faces: "faces", "S10: faces by the data of the host where the iteration gives up, or costs as much";
    SparseFaces: "sparse faces", "S13: sparse factors where dense ones lose the digits of an answer";
    Interior: "interior point", "S13.6: faces from an interior point";
    AllRows: "all rows", "S13: the face with rows that nearly depend on others";
    Again: "again", "S10: the iteration again from an interior point";
    Slides: "slides", "S12: resistance that is noise is taken out";
    Relative: "relative shares", "S11: unheld parts by shares of each body";
    FarRows: "far rows", "S5.2: far rows join because no answer passes";
    Trial: "trial", "S7: Newton steps between rounds";
    Mend: "mended", "S7.6: an answer of a round is corrected";
    FirstProof: "first proof", "S7: loads that fall without end, in a round without an answer";
    Finish: "finish", "S13: delicate answers are corrected";
    Inner: "steps without product", "F4: steps to new faces with the pairs at hand";
    Turned: "turned", "F6: amplitudes fitted once more at the end";
    ShortPath: "short path", "F7: smoothed laws until the states are known";
    Supports: "weak supports", "F7: weak supports with kept pairs";
    SupportPath: "path on supports", "F7: a path where Newton's method fails on supports";
    Sticking: "all sticking", "F7: from the answer in which all closed nodes stick";
    LongPath: "long path", "F7: the path to rounding with relaxed bounds";
    DensePath: "dense path", "F7: dense systems along the smoothed laws";
    DenseRelaxed: "dense path, relaxed", "F7: the same with relaxed bounds";
    Combinations: "combinations", "F7: all combinations of states";
    DenseSupports: "dense supports", "F7: weak supports with dense systems";
    Tighter: "tighter laws", "F8: a smaller merit for a refused point";
    Corrected: "corrected", "F8: a refused point is corrected by the data of the host";
    RowsClosed: "rows closed", "S13.4: conjugate gradients close rows that the factors of a face left out";
}

const COUNT: usize = Rung::ALL.len();

/// How often each second try was made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tries([u32; COUNT]);

impl Default for Tries {
    fn default() -> Self {
        Self([0; COUNT])
    }
}

impl std::ops::Add for Tries {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k].saturating_add(other.0[k])))
    }
}

impl Tries {
    /// How often each was made.
    pub fn all(&self) -> &[u32] {
        &self.0
    }

    /// None for another number of second tries.
    pub fn from_all(all: &[u32]) -> Option<Self> {
        all.try_into().ok().map(Self)
    }

    /// Names and numbers of the second tries made.
    pub fn made(&self) -> impl Iterator<Item = (&'static str, u32)> + '_ {
        Rung::ALL.iter().map(|(rung, name, _)| (*name, self.0[*rung as usize])).filter(|made| made.1 > 0)
    }
}

thread_local! {
    /// What is left out, and what was tried so far, by the solve of this thread.
    static PRESENT: Cell<(u64, Tries)> = const { Cell::new((0, Tries([0; COUNT]))) };
}

/// Runs a solve without the second tries of these bits; what it tried.
pub fn during<T>(without: u64, work: impl FnOnce() -> T) -> (T, Tries) {
    let _before = Restore(PRESENT.replace((without, Tries::default())));
    let done = work();
    (done, PRESENT.get().1)
}

/// When dropped, also after a panic, it restores the solve that called the host whose function has begun another.
struct Restore((u64, Tries));

impl Drop for Restore {
    fn drop(&mut self) {
        PRESENT.set(self.0);
    }
}

impl Rung {
    /// Counts this try, unless it is left out.
    pub fn is_tried(self) -> bool {
        let (without, mut tries) = PRESENT.get();
        let is_tried = without >> self as u32 & 1 == 0;
        if is_tried {
            tries.0[self as usize] = tries.0[self as usize].saturating_add(1);
            PRESENT.set((without, tries));
        }
        is_tried
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solve_counts_its_own_tries_and_leaves_out_what_it_is_told_to_leave_out() {
        let (_, outer) = during(0, || {
            assert!(Rung::Faces.is_tried() && Rung::Again.is_tried());
            let (inner, tries) =
                during(1 << Rung::Faces as u32, || [Rung::Faces, Rung::Again].map(Rung::is_tried));
            assert_eq!((inner, tries.made().collect::<Vec<_>>()), ([false, true], vec![("again", 1)]));
            assert!(Rung::Faces.is_tried());
        });
        assert_eq!((outer + outer).made().collect::<Vec<_>>(), [("faces", 4), ("again", 2)]);
    }

    #[test]
    fn every_second_try_has_a_bit_of_its_own_within_the_range_of_the_option() {
        for (k, (rung, ..)) in Rung::ALL.iter().enumerate() {
            assert!(*rung as usize == k && k < 53);
        }
    }
}
