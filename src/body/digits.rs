//! How many digits the entries of K have. If a host prints K, or stores it in single precision, the library gets a different K: its
//! rounding resists the motions of the null space. The possible size of this resistance is estimated from K itself.

use std::collections::HashMap;
use std::fmt;

use crate::error::Result;
use crate::linalg::{Matrix, Symmetric};
use crate::numbers::body::{LAST_DIGITS_USED, PIVOT_ROUNDING, ROWS_SUM_TO_0, SIMPLE};
use crate::platform::memory::{reserved, zeros};
use crate::ranks::Wire;

/// Number of rows in the sample, and of entries per row.
const ROWS: usize = 64;
const ENTRIES: usize = 16;
/// Fewer digits mean round numbers, unless K shows their rounding, ...
pub(super) const FEWEST: usize = 7;
/// ... and about one in a hundred double precision numbers needs no more than `MOST` digits.
const MOST: usize = 15;
/// The last of the 24 bits of a number in single precision may be 0: all but 1 of 32 numbers need at least this many
/// bits.
const BITS: u32 = 20;
/// Entries are compared with the first so many values that are not in simple ratios.
const MODULI: usize = 8;
/// Bound of a row sum that is 0 up to rounding of its terms.
const SUM: f64 = 2.0 * f64::EPSILON;

/// The precision to which the entries of a matrix were rounded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Digits {
    /// Significant decimal digits, up to 15.
    Decimal(usize),
    /// Single precision.
    Single,
}

/// As the number of decimal digits, 0 for single precision.
impl Wire for Digits {
    fn put(&self, to: &mut Vec<u8>) {
        match self {
            Self::Decimal(digits) => digits.put(to),
            Self::Single => 0usize.put(to),
        }
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        Ok(match usize::take(from)? {
            0 => Self::Single,
            digits => Self::Decimal(digits),
        })
    }
}

impl fmt::Display for Digits {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Decimal(digits) => write!(out, "{digits} digits"),
            Self::Single => out.write_str("single precision"),
        }
    }
}

impl Digits {
    /// From this number of digits on, resistance that may be rounding is reported.
    pub const TOLD: usize = 3;

    /// `None` if the entries have double precision, or few digits because they are exact: most entries need fewer digits
    /// than the longest, or nearly every row sums to 0, as for springs between dofs.
    pub fn of(k: &Symmetric) -> Result<Option<Self>> {
        Self::of_least(k, FEWEST)
    }

    /// The same, from this number of digits on.
    pub fn of_least(k: &Symmetric, fewest: usize) -> Result<Option<Self>> {
        let sampled = sampled(k);
        let used = |uses: &dyn Fn(f64) -> bool| {
            let beside = || sampled.iter().filter(|entry| entry.1);
            let count = beside().filter(|entry| uses(entry.0)).count();
            count > 0 && count as f64 >= LAST_DIGITS_USED * beside().count() as f64
        };
        let found = Self::among(&sampled, fewest, used);
        Ok(if found.is_some() && sums_are_exact(k)? { None } else { found })
    }

    /// The digits without these two exceptions: K has negative stiffness along a motion, so its entries cannot be exact.
    pub fn of_rounded(k: &Symmetric, fewest: usize) -> Option<Self> {
        Self::among(&sampled(k), fewest, |_| true)
    }

    /// So few digits that the numbers may also be round: only motions that show the rounding may tell.
    pub fn are_few(self) -> bool {
        matches!(self, Self::Decimal(digits) if digits < FEWEST)
    }

    fn among(
        sampled: &[(f64, bool)],
        fewest: usize,
        used: impl Fn(&dyn Fn(f64) -> bool) -> bool,
    ) -> Option<Self> {
        let digits = decimal(sampled);
        if digits.is_some_and(|digits| digits < fewest) {
            return None;
        }
        let digits = digits.filter(|&digits| used(&|v| !has(v, digits - 2)));
        let single = sampled.iter().all(|&(v, _)| f64::from(v as f32) == v) && used(&|v| bits(v) >= BITS);
        // large numbers in single precision are integers with few digits
        match digits {
            Some(digits) if digits <= FEWEST || !single => Some(Self::Decimal(digits)),
            _ => single.then_some(Self::Single),
        }
    }

    /// The spacing of numbers with these digits at `v`, in units of v; the largest rounding error is half of it.
    fn unit(self, v: f64) -> f64 {
        match self {
            Self::Decimal(digits) => 10f64.powi(v.abs().log10().floor() as i32 + 1 - digits as i32),
            Self::Single => 2f64.powi(v.abs().log2().floor() as i32 - 23),
        }
    }

    /// The largest spacing of numbers with these digits, relative to the number.
    pub fn relative(self) -> f64 {
        self.unit(1.0)
    }

    /// The relative pivot that rounding of the entries may leave in place of 0: then the dof must be in t.
    pub fn pivot(self) -> f64 {
        PIVOT_ROUNDING * self.relative()
    }

    /// Standard deviation of `v'E v` for each motion v, one per column of x, E the rounding of the entries: the errors of entries in a simple ratio have this ratio, those of other entries are independent. A matrix of
    /// round numbers with one modulus has a single error, which resists no motion.
    pub fn noise(self, k: &Symmetric, x: &Matrix) -> Result<Vec<f64>> {
        const WHAT: &str = "the rounding of a stiffness matrix";
        let mut slots: HashMap<u64, (usize, f64)> = HashMap::new();
        let (entries, count) = (k.col.len(), x.cols);
        // the first entry of each slot, and the spacing at it
        let (mut first, mut units, mut sums) =
            (reserved(entries, WHAT)?, reserved(entries, WHAT)?, zeros(entries * count, WHAT)?);
        for i in 0..k.order() {
            for (j, value) in k.lower_row(i).filter(|entry| entry.1 != 0.0) {
                let size = value.abs();
                let (slot, ratio) = *slots.entry(size.to_bits()).or_insert_with(|| {
                    let like = first.iter().take(MODULI).position(|&first| in_simple_ratio(first, size));
                    let slot = like.unwrap_or(first.len());
                    if like.is_none() {
                        first.push(size);
                        units.push(f64::INFINITY);
                    }
                    let ratio = size / first[slot];
                    units[slot] = units[slot].min(self.unit(size) / ratio);
                    (slot, ratio)
                });
                let times = ratio * if i == j { value.signum() } else { 2.0 * value.signum() };
                (0..count).for_each(|c| sums[slot * count + c] += times * x.get(i, c) * x.get(j, c));
            }
        }
        let square = |c: usize, slot: usize| (units[slot] * sums[slot * count + c]).powi(2) / 12.0;
        Ok((0..count).map(|c| (0..units.len()).map(|slot| square(c, slot)).sum::<f64>().sqrt()).collect())
    }

    /// Upper bound of the change of `K v` by rounding of the entries, row by row.
    pub fn most(self, k: &Symmetric, v: &[f64]) -> Result<Vec<f64>> {
        let mut most = zeros(k.order(), "the rounding of a stiffness matrix")?;
        for i in 0..k.order() {
            for (j, value) in k.lower_row(i).filter(|entry| entry.1 != 0.0) {
                let half = 0.5 * self.unit(value);
                most[i] += half * v[j].abs();
                if i != j {
                    most[j] += half * v[i].abs();
                }
            }
        }
        Ok(most)
    }
}

/// Nonzero entries of rows spread over the matrix, from both ends of each row, and whether they are off-diagonal.
fn sampled(k: &Symmetric) -> Vec<(f64, bool)> {
    let n = k.order();
    let rows = (0..ROWS.min(n)).map(|r| if n <= ROWS { r } else { (2 * r + 1) * n / (2 * ROWS) });
    let entries = rows.flat_map(|i| {
        let (begin, end) = (k.ptr[i], k.ptr[i + 1]);
        let taken = (begin..end).filter(move |at| at - begin < ENTRIES / 2 || end - at <= ENTRIES / 2);
        taken.map(move |at| (k.val[at], at + 1 < end))
    });
    entries.filter(|entry| entry.0 != 0.0).collect()
}

/// The digits that suffice for all numbers; `None` if one needs more than `MOST`.
fn decimal(numbers: &[(f64, bool)]) -> Option<usize> {
    numbers.iter().try_fold(1, |digits, &(v, _)| (digits..=MOST).find(|&digits| has(v, digits)))
}

/// Whether `v` printed with this many significant digits and read again is `v`.
fn has(v: f64, digits: usize) -> bool {
    format!("{v:.*e}", digits.saturating_sub(1)).parse() == Ok(v)
}

/// Whether the ratio of two positive numbers is exactly a simple one.
fn in_simple_ratio(a: f64, b: f64) -> bool {
    let (small, large) = (a.min(b), a.max(b));
    let mut q = 1.0;
    while q <= SIMPLE[1] {
        let p = (q * large / small).round();
        if p > SIMPLE[0] {
            return false;
        }
        if p * small == q * large {
            return true;
        }
        q += 1.0;
    }
    false
}

/// Number of bits from the first to the last 1, of a normal number.
fn bits(v: f64) -> u32 {
    let mantissa = v.to_bits() & ((1 << 52) - 1);
    53 - mantissa.trailing_zeros().min(52)
}

/// Whether `K (1, .., 1)' = 0` in nearly all rows and positive in the others, which have springs to the ground. Rounding
/// leaves sums of both signs.
fn sums_are_exact(k: &Symmetric) -> Result<bool> {
    const WHAT: &str = "the sums of the rows of a stiffness matrix";
    let (mut ones, mut sums, mut terms) =
        (zeros(k.order(), WHAT)?, zeros(k.order(), WHAT)?, zeros(k.order(), WHAT)?);
    ones.fill(1.0);
    k.mul_with_terms(&ones, &mut sums, &mut terms);
    let left = |(sum, terms): &(&f64, &f64)| sum.abs() > SUM * **terms;
    let others = || sums.iter().zip(&terms).filter(left);
    let few = (others().count() as f64) < (1.0 - ROWS_SUM_TO_0) * k.order() as f64;
    Ok(few && others().all(|(sum, _)| *sum > 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of springs between n dofs, `ground` at the first.
    fn chain(n: usize, spring: impl Fn(usize) -> f64, ground: f64) -> Symmetric {
        let (mut ptr, mut col, mut val) = (vec![0], Vec::new(), Vec::new());
        for i in 0..n {
            let [before, after] =
                [if i > 0 { spring(i - 1) } else { ground }, if i + 1 < n { spring(i) } else { 0.0 }];
            if i > 0 {
                col.push(i as u32 - 1);
                val.push(-before);
            }
            col.push(i as u32);
            val.push(before + after);
            ptr.push(col.len());
        }
        Symmetric::new(ptr, col, val)
    }

    fn rounded(mut k: Symmetric, to: impl Fn(f64) -> f64) -> Symmetric {
        k.val = k.val.iter().map(|v| to(*v)).collect::<Vec<f64>>().into();
        k
    }

    fn printed(v: f64, digits: usize) -> f64 {
        format!("{v:.*e}", digits - 1).parse().unwrap()
    }

    #[test]
    fn the_digits_of_entries_that_were_printed_or_kept_in_single_precision_are_found() {
        let any = |i: usize| 1.0 + (i as f64).sin().abs();
        assert_eq!(Digits::of(&chain(100, any, 0.0)).unwrap(), None);
        for digits in 7..=15 {
            let k = rounded(chain(100, any, 0.0), |v| printed(v, digits));
            assert_eq!(Digits::of(&k).unwrap(), Some(Digits::Decimal(digits)));
        }
        let k = rounded(chain(100, any, 0.0), |v| f64::from(v as f32));
        assert_eq!(Digits::of(&k).unwrap(), Some(Digits::Single));
    }

    #[test]
    fn entries_that_are_exact_with_few_digits_are_not_taken_for_rounded_ones() {
        let of = |k: Symmetric| Digits::of(&k).unwrap();
        assert_eq!(of(chain(100, |_| 1.0, 1e-8)), None);
        // every dof has a spring to the ground: half of the entries need nine digits
        let mut springs = chain(100, |_| 1.0, 0.0);
        (0..100).for_each(|i| springs.val[2 * i] += 1e-8);
        assert_eq!(of(springs), None);
        // springs of eight digits each, a soft one at the end
        assert_eq!(of(chain(100, |i| 1e7 + (7_654_321 * i % 89_999_999) as f64, 1.0)), None);
        assert_eq!(of(chain(100, |i| (0.1 + 0.01 * i as f64) as f32 as f64, 0.0)), None);
    }

    /// For many matrices rounded in this way, `v'E v` has the predicted deviation.
    #[test]
    fn the_noise_foretold_is_that_of_rounding() {
        let digits = Digits::Decimal(8);
        let (mut worst, mut sum, mut count) = (0.0f64, 0.0, 0);
        for turn in 0..200 {
            let k = chain(50, |i| 1.0 + 7.0 * (3.0 * (i + 100 * turn) as f64).sin().abs(), 0.0);
            let near = rounded(k.clone(), |v| printed(v, 8));
            let ones = vec![1.0; 50];
            let motion = Matrix { rows: 50, cols: 1, data: ones.clone() };
            let expected = digits.noise(&near, &motion).unwrap()[0];
            let mut image = vec![0.0; 50];
            near.mul(&ones, &mut image);
            let found = image.iter().sum::<f64>() / expected;
            worst = worst.max(found.abs());
            sum += found * found;
            count += 1;
        }
        let deviation = (sum / f64::from(count)).sqrt();
        assert!((0.8..1.2).contains(&deviation) && worst < 4.5, "{deviation} {worst}");
    }
}
