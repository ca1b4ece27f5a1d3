//! The options: name, meaning, default and range in one table; set and read by name.

use std::ffi::CStr;

use crate::error::{Error, Result};
use crate::model::words::{
    FinishBy, LogTo, Method, OperatorForm, PaperStep1, PaperUnits, Preconditioning, StartFrom, Word,
};
use crate::numbers::data::{MANY, NO_LIMIT};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum OptionValue {
    F64(f64),
    I64(i64),
    Str(&'static CStr),
    /// A text of the host, not one of a few words.
    Text(&'static CStr),
}

/// One option in the list for the host. `minimum` and `maximum` bound numbers.
pub struct OptionInfo {
    pub name: &'static CStr,
    pub doc: &'static CStr,
    pub default: OptionValue,
    pub minimum: f64,
    pub maximum: f64,
    field: Location,
}

/// The field with the value of an option.
enum Location {
    F64(fn(&mut Settings) -> &mut f64),
    I64(fn(&mut Settings) -> &mut i64),
    Str(fn(&mut Settings) -> &mut dyn Word),
    Text(fn(&mut Settings) -> &mut String),
}

/// The range of an option that is a text.
const NO_RANGE: std::ops::RangeInclusive<f64> = 0.0..=0.0;

const fn c_text(terminated: &'static str) -> &'static CStr {
    match CStr::from_bytes_with_nul(terminated.as_bytes()) {
        Ok(text) => text,
        Err(_) => c"",
    }
}

/// Makes from one line per option a field in [`Settings`] and an entry of the list [`OPTIONS`].
macro_rules! settings {
    ($($field:ident: $kind:ty = $value:ident($default:expr), $range:expr, $doc:literal;)+) => {
        /// Values of all options; the table has their meaning. `Settings::new` gives the defaults.
        #[derive(Debug, Clone, PartialEq, Default)]
        pub struct Settings {
            $(pub $field: $kind,)+
        }

        static OPTIONS: &[OptionInfo] = &[$(OptionInfo {
            name: c_text(concat!(stringify!($field), "\0")),
            doc: $doc,
            default: OptionValue::$value($default),
            minimum: *$range.start(),
            maximum: *$range.end(),
            field: Location::$value(|settings| &mut settings.$field),
        },)+];
    };
}

settings! {
    tolerance: f64 = F64(1e-12), 1e-14..=1e-2,
        c"The dual problem of each group of bodies is solved until its projected gradient, which is a gap, is at most this fraction of the motion of the bodies along the rows and of the gaps within that range; then the solve goes on until the certificate passes.";
    certificate_tolerance: f64 = F64(1e-8), 1e-14..=1e-1,
        c"An answer counts as solved if every entry of the certificate is at most this value, for every body and row relative to its own forces and deformation.";
    gamma: f64 = F64(1.0), 1e-3..=1e3,
        c"Gamma of the proportionality test: the largest ratio of the error of the choice of the face to the error on the current face.";
    time_limit: f64 = F64(NO_LIMIT), 0.0..=NO_LIMIT,
        c"Wall time in seconds after which a solve, including its setup, ends with FETI_TIME and the best answer so far, if there is one.";
    symmetry_tolerance: f64 = F64(1e-10), 0.0..=1e-2,
        c"Full storage: the largest |K_ij - K_ji| relative to sqrt(K_ii K_jj); the library averages the two entries.";
    null_space_tolerance: f64 = F64(1e-8), 1e-15..=1e-2,
        c"A given null space R is accepted if |K R| is at most this fraction of |K||R| in the metric of diag K.";
    data_accuracy: f64 = F64(1e-10), 1e-14..=1e-6,
        c"Accuracy of normals, weights and coordinates in the rows, relative to their terms. A motion that every row with a force resists by less than this is undetermined: the rows are solved as if they did not resist it, and a share of the load along it up to this value is rounding, up to 1000 times this value marginal.";
    max_steps: i64 = I64(10_000), 1.0..=MANY,
        c"Number of steps of the dual method after which a solve ends with FETI_ITERATIONS and the best answer so far, unless the direct method completes the answer (option direct_limit).";
    memory_limit: i64 = I64(0), 0.0..=MANY,
        c"Largest number of bytes for factors and dual operators, of all ranks together; 0: no limit. Dual operators that do not fit are applied matrix-free (option dual_operator); if the limit would still be exceeded, the call returns FETI_MEMORY before it allocates anything.";
    threads: i64 = I64(0), 0.0..=4096.0,
        c"Number of threads for the setup and for expensive products with the dual operator (at most one thread for 500 unknowns and four for a CPU); 0: as many as the CPUs that this process may use. The answer has the same bits for any number.";
    pieces: i64 = I64(0), 0.0..=1e6,
        c"Number of pieces into which a body given by its elements is cut when its first element matrix arrives. 0: the library chooses by size, one piece below 40000 unknowns for each solve that option steps expects; 1: no body is cut; n: about n pieces for each body.";
    steps: i64 = I64(0), 0.0..=1e6,
        c"Expected number of solves with the same stiffness matrices, for other loads, gaps or rows; 0: unknown. 1 or 2: large solid bodies whose null space is known are factorised in single precision, with corrections to double: less time and half of the memory for the first solve, more time for each later one. From 3 on bodies given by elements are cut at larger sizes (option pieces).";
    glue: i64 = I64(0), 0.0..=1.0,
        c"Effect of a number of the host (feti_body_numbering) that unknowns of several bodies share, from the next call of that function on. 0: the number is refused; 1: these unknowns move together, joined by internal equality rows.";
    index_base: i64 = I64(0), 0.0..=1.0,
        c"Base of the numbers in error texts: 0 for C, 1 for Fortran.";
    log_file: String = Text(c""), NO_RANGE,
        c"Path of a file to which the lines of the log of setups and solves are added, from level result to that of option log_level, one by one; empty: none. If it cannot be opened, the option is refused.";
    log_level: LogTo = Str(LogTo::WORDS[0]), NO_RANGE,
        c"Amount of lines in log_file, as of feti_on_log: phase; result, which is less; step, which is more.";
    fault_injection: i64 = I64(0), 0.0..=1.0,
        c"1: the next feti_solve fails with FETI_INTERNAL, so that a host can test its own error handling.";
    without: i64 = I64(0), 0.0..=MANY,
        c"For tests: second tries that a solve leaves out, the sum of 2^k for number k of the list that make rungs prints.";
    preconditioner: Preconditioning = Str(Preconditioning::WORDS[0]), NO_RANGE,
        c"Preconditioner of the dual problem: automatic (lumped if products with F are expensive, otherwise none); none; lumped (stiffness of the constrained unknowns with all other unknowns held); dirichlet (all other unknowns free: fewer steps, but one more factorisation of each body). For a body with functions of the host, the preconditioner uses the diagonal.";
    dual_operator: OperatorForm = Str(OperatorForm::WORDS[0]), NO_RANGE,
        c"Form of the dual operator of a body: explicit (assembled: a product reads 4 m^2 bytes for m rows); implicit (matrix-free: a product takes two triangular solves, which needs less memory but is slower); automatic (chosen by a model of the time; a body with functions of the host begins implicit and becomes explicit when its products have cost as much; implicit if memory_limit leaves no room).";
    method: Method = Str(Method::WORDS[0]), NO_RANGE,
        c"Method for the dual problem: proportioning on its feasible set; paper-..., Algorithm 3 of the paper with Algorithm 1 in one of its variants, without preconditioner and without another method where it gives up.";
    start: StartFrom = Str(StartFrom::WORDS[0]), NO_RANGE,
        c"Start of a solve: cold (no forces; the same input gives the same bits) or previous (forces and active set of the last answer for these rows); values of feti_start_from take precedence.";
    direct_limit: i64 = I64(1000), 0.0..=MANY,
        c"Largest number of forces plus floating modes for which the dual problem may be solved by dense factors on the active set, if the iteration gives up or option finish requests a direct solve; 0: never.";
    finish: FinishBy = Str(FinishBy::WORDS[0]), NO_RANGE,
        c"What follows a solve: direct (dense factors on the active set found, with corrections from K, B, f, c: errors fall to rounding level; the result is kept only if the certificate is no worse); none; automatic (direct if a body is ill-conditioned or rows join bodies of very different stiffness or deformation, where errors that matter could remain although the certificate passes).";
    paper_units: PaperUnits = Str(PaperUnits::WORDS[0]), NO_RANGE,
        c"Methods paper-...: scaling of their parameters. relative: rho_0 in |A|/|D|^2, M in |A|/|D|, eta_0 in the size of d, for the scaled rows; printed: units of the host, its basis R, tolerance relative to |b| and |d|.";
    paper_step_1: PaperStep1 = Str(PaperStep1::WORDS[0]), NO_RANGE,
        c"Methods paper-...: end of Step 1. printed: |g^P| <= M |D x - d|; corrected: once |D x - d| is within its tolerance, this test no longer ends Step 1, and |g^P| must reach its tolerance too.";
    paper_alpha: f64 = F64(0.1), 1e-6..=0.999,
        c"alpha of Algorithm 3: factor for the bound eta on |D x - d| when the bound was kept.";
    paper_beta: f64 = F64(100.0), 1.001..=1e6,
        c"beta of Algorithm 3: factor for the penalty rho when eta was exceeded.";
    paper_rho_0: f64 = F64(100.0), 1e-30..=1e30,
        c"rho_0 of Algorithm 3: the first penalty.";
    paper_eta_0: f64 = F64(1e-3), 1e-30..=1e30,
        c"eta_0 of Algorithm 3: the first bound on |D x - d|.";
    paper_m: f64 = F64(0.0), 0.0..=1e30,
        c"M of Algorithm 3: the inner problem is solved until |g^P| <= M |D x - d|; 0: rho_0 / 100.";
    paper_mu_0: f64 = F64(0.0), -1e30..=1e30,
        c"mu^0 of Algorithm 3: every entry of the first multiplier.";
    paper_extrapolation: f64 = F64(5.0), 1.01..=1e3,
        c"Method paper-extrapolating: factor between successive trial steps beyond a bound.";
    paper_outer: i64 = I64(60), 1.0..=1e6,
        c"Number of problems with bounds only that the methods paper-... solve before they end with FETI_ITERATIONS.";
}

/// All options, in the order of the table.
pub fn options() -> &'static [OptionInfo] {
    OPTIONS
}

impl Settings {
    pub fn new() -> Self {
        let mut settings = Self::default();
        for option in options() {
            match (&option.field, option.default) {
                (Location::F64(field), OptionValue::F64(value)) => *field(&mut settings) = value,
                (Location::I64(field), OptionValue::I64(value)) => *field(&mut settings) = value,
                _ => {}
            }
        }
        settings
    }

    pub fn set_f64(&mut self, name: &str, value: f64) -> Result<()> {
        let option = find(name)?;
        let Location::F64(field) = &option.field else { return Err(wrong_type(option)) };
        check(option, value)?;
        *field(self) = value;
        Ok(())
    }

    pub fn set_i64(&mut self, name: &str, value: i64) -> Result<()> {
        let option = find(name)?;
        let Location::I64(field) = &option.field else { return Err(wrong_type(option)) };
        check(option, value as f64)?;
        *field(self) = value;
        Ok(())
    }

    pub fn set_str(&mut self, name: &str, value: &str) -> Result<()> {
        let option = find(name)?;
        let field = match &option.field {
            Location::Str(field) => field(self),
            Location::Text(field) => {
                value.clone_into(field(self));
                return Ok(());
            }
            _ => return Err(wrong_type(option)),
        };
        // hosts and problem files of version 0.2 may ask for a method that has been removed
        let value = if (name, value) == ("method", "smalbe") { "proportioning" } else { value };
        if field.take(value.as_bytes()) {
            return Ok(());
        }
        let known: Vec<_> = field.words().iter().map(|word| word.to_string_lossy()).collect();
        let what = format!("option \"{name}\" is one of {}, not \"{value}\"", known.join(", "));
        Err(Error::argument("value", what))
    }

    pub fn get_f64(&self, name: &str) -> Result<f64> {
        let option = find(name)?;
        let OptionValue::F64(value) = option.value(self) else { return Err(wrong_type(option)) };
        Ok(value)
    }

    pub fn get_i64(&self, name: &str) -> Result<i64> {
        let option = find(name)?;
        let OptionValue::I64(value) = option.value(self) else { return Err(wrong_type(option)) };
        Ok(value)
    }

    pub fn get_str(&self, name: &str) -> Result<String> {
        let option = find(name)?;
        match (option.value(self), &option.field) {
            (_, Location::Text(field)) => Ok(field(&mut self.clone()).clone()),
            (OptionValue::Str(word), _) => Ok(word.to_string_lossy().into_owned()),
            _ => Err(wrong_type(option)),
        }
    }

    /// Takes the options that belong to the host, and not to a problem in a file, from other settings.
    pub fn keep_of_host(&mut self, other: &Self) {
        self.index_base = other.index_base;
        self.log_file.clone_from(&other.log_file);
        self.log_level = other.log_level;
    }
}

impl OptionInfo {
    /// Its value in these settings.
    pub(super) fn value(&self, settings: &Settings) -> OptionValue {
        let settings = &mut settings.clone();
        match self.field {
            Location::F64(field) => OptionValue::F64(*field(settings)),
            Location::I64(field) => OptionValue::I64(*field(settings)),
            Location::Str(field) => OptionValue::Str(field(settings).word()),
            Location::Text(_) => self.default,
        }
    }
}

/// The option with this name.
pub fn find(name: &str) -> Result<&'static OptionInfo> {
    options().iter().find(|option| option.name.to_bytes() == name.as_bytes()).ok_or_else(|| {
        let mut names: Vec<_> = options().iter().map(|o| o.name.to_string_lossy()).collect();
        names.sort_by_cached_key(|known| edits(name, known));
        Error::argument("name", format!("there is no option \"{name}\"; there are {}", names.join(", ")))
    })
}

/// Letters to insert, delete or replace to get from one name to another.
fn edits(from: &str, to: &str) -> usize {
    let mut line: Vec<usize> = (0..=to.len()).collect();
    for (i, a) in from.bytes().enumerate() {
        let mut diagonal = std::mem::replace(&mut line[0], i + 1);
        for (j, b) in to.bytes().enumerate() {
            let replaced = diagonal + usize::from(a != b);
            diagonal = line[j + 1];
            line[j + 1] = replaced.min(diagonal + 1).min(line[j] + 1);
        }
    }
    line[to.len()]
}

fn wrong_type(option: &OptionInfo) -> Error {
    let kind = match option.default {
        OptionValue::F64(_) => "a real number (f64)",
        OptionValue::I64(_) => "a whole number (i64)",
        OptionValue::Str(_) | OptionValue::Text(_) => "a text (str)",
    };
    Error::argument("name", format!("option \"{}\" is {kind}", option.name.to_string_lossy()))
}

fn check(option: &OptionInfo, value: f64) -> Result<()> {
    if (option.minimum..=option.maximum).contains(&value) {
        return Ok(());
    }
    let (name, low, high) = (option.name.to_string_lossy(), option.minimum, option.maximum);
    let what = format!("option \"{name}\" takes {low:e} to {high:e}, not {value:e}");
    Err(Error::argument("value", what).value(value).limit(if value < low { low } else { high }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Kind;

    #[test]
    fn a_method_that_is_gone_is_read_as_the_default() {
        let mut settings = Settings::new();
        settings.set_str("method", "paper-monotone").unwrap();
        settings.set_str("method", "smalbe").unwrap();
        assert_eq!(settings.get_str("method").unwrap(), "proportioning");
    }

    #[test]
    fn every_option_starts_with_its_listed_default_inside_its_range() {
        let settings = Settings::new();
        for option in options() {
            let name = option.name.to_str().unwrap();
            let value = match option.default {
                OptionValue::F64(value) => {
                    assert_eq!(settings.get_f64(name).unwrap(), value);
                    value
                }
                OptionValue::I64(value) => {
                    assert_eq!(settings.get_i64(name).unwrap(), value);
                    value as f64
                }
                OptionValue::Str(value) | OptionValue::Text(value) => {
                    assert_eq!(settings.get_str(name).unwrap().as_bytes(), value.to_bytes());
                    continue;
                }
            };
            assert!((option.minimum..=option.maximum).contains(&value), "{name}");
        }
    }

    #[test]
    fn every_option_has_a_row_with_its_default_in_the_documents() {
        let root = env!("CARGO_MANIFEST_DIR");
        let [page, paper] = ["options", "paper"]
            .map(|page| std::fs::read_to_string(format!("{root}/docs/{page}.md")).unwrap());
        for option in options() {
            let name = option.name.to_str().unwrap();
            if name.starts_with("paper_") {
                assert!(
                    paper.lines().any(|row| row.starts_with('|') && row.contains(&format!("`{name}`"))),
                    "{name}"
                );
                continue;
            }
            let row = page.lines().find(|row| row.starts_with(&format!("| `{name}` | ")));
            let default = row.and_then(|row| row.split(" | ").nth(1));
            let default = default.unwrap_or_else(|| panic!("add a row to docs/options.md for {name}"));
            let right = match option.default {
                OptionValue::F64(value) if value == NO_LIMIT => default == "none",
                OptionValue::F64(value) => default.parse() == Ok(value),
                OptionValue::I64(value) => default.parse() == Ok(value),
                OptionValue::Text(text) if text.is_empty() => default == "none",
                OptionValue::Str(text) | OptionValue::Text(text) => default == text.to_str().unwrap(),
            };
            assert!(right, "docs/options.md has another default of {name}: {default}");
        }
    }

    #[test]
    fn unknown_names_wrong_types_and_values_out_of_range_change_nothing() {
        let mut settings = Settings::new();
        let misspelt = settings.set_f64("tolerence", 1e-6).unwrap_err();
        assert_eq!(misspelt.kind, Kind::Argument("name"));
        assert!(misspelt.what.contains("\"tolerence\"; there are tolerance, "), "nearest first: {misspelt}");
        assert!(settings.set_i64("tread", 1).unwrap_err().what.contains("there are threads, "));
        assert_eq!(settings.set_i64("tolerance", 1).unwrap_err().kind, Kind::Argument("name"));
        assert_eq!(settings.set_f64("tolerance", f64::NAN).unwrap_err().kind, Kind::Argument("value"));
        assert_eq!(settings.set_i64("threads", -1).unwrap_err().kind, Kind::Argument("value"));
        assert_eq!(settings.set_str("preconditioner", "Lumped").unwrap_err().kind, Kind::Argument("value"));
        assert_eq!(settings, Settings::new());
        settings.set_f64("tolerance", 1e-6).unwrap();
        assert_eq!(settings.get_f64("tolerance").unwrap(), 1e-6);
    }
}
