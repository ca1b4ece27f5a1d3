//! Options as a text: `tolerance=1e-8 threads=4`.

use std::ffi::CStr;

use crate::error::{Error, Kind, Result};
use crate::model::settings::{find, options, OptionInfo, OptionValue, Settings};

/// Options that a problem in a file has not.
const OF_HOST: [&CStr; 3] = [c"index_base", c"log_file", c"log_level"];

/// One `name = value` of a text, and the bytes at which name and value begin.
#[derive(Debug, PartialEq)]
struct Item<'a> {
    name: (usize, &'a str),
    value: (usize, &'a str),
}

/// The rest of a text that has not been read.
struct Rest<'a> {
    text: &'a str,
    at: usize,
}

impl Settings {
    /// Sets all options in the text, in its order, or none of them. Items `name = value` are separated by blanks, commas
    /// or line ends; `#` begins a comment up to the end of the line.
    pub fn set_text(&mut self, text: &str) -> Result<()> {
        let mut changed = self.clone();
        let mut rest = Rest { text, at: 0 };
        while let Some(item) = rest.item()? {
            let (at, value) = item.value;
            changed.set_by_type(item.name.1, value).map_err(|mut error| {
                let byte = if error.kind == Kind::Argument("name") { item.name.0 } else { at };
                error.kind = Kind::Argument("text");
                error.byte(byte)
            })?;
        }
        *self = changed;
        Ok(())
    }

    /// Sets an option of any type from a text.
    fn set_by_type(&mut self, name: &str, value: &str) -> Result<()> {
        let wrong = |kind: &str| {
            Error::argument("value", format!("option \"{name}\" is {kind}, which \"{value}\" is not"))
        };
        match find(name)?.default {
            OptionValue::I64(_) => self.set_i64(name, value.parse().map_err(|_| wrong("a whole number"))?),
            OptionValue::Str(_) | OptionValue::Text(_) => self.set_str(name, value),
            OptionValue::F64(_) => {
                // Fortran writes 1d-8
                let number = value.replace(['d', 'D'], "e").parse();
                self.set_f64(name, number.map_err(|_| wrong("a number"))?)
            }
        }
    }

    /// The options that differ from their defaults, as a text for `set_text`, without those that belong to the
    /// host ([`Self::keep_of_host`]).
    pub fn changes(&self) -> String {
        let of_host = |option: &OptionInfo| OF_HOST.contains(&option.name);
        let changed = |option: &&OptionInfo| !of_host(option) && option.value(self) != option.default;
        let item = |option: &OptionInfo| {
            let name = option.name.to_string_lossy();
            match option.value(self) {
                OptionValue::F64(value) => format!("{name}={value:e}"),
                OptionValue::I64(value) => format!("{name}={value}"),
                OptionValue::Str(word) | OptionValue::Text(word) => {
                    format!("{name}={}", word.to_string_lossy())
                }
            }
        };
        options().iter().filter(changed).map(item).collect::<Vec<_>>().join(" ")
    }
}

fn is_blank(c: char) -> bool {
    c.is_ascii_whitespace()
}

impl<'a> Rest<'a> {
    fn item(&mut self) -> Result<Option<Item<'a>>> {
        self.pass_separators();
        if self.rest().is_empty() {
            return Ok(None);
        }
        let name = self.word();
        self.pass(is_blank);
        if name.1.is_empty() || !self.rest().starts_with('=') {
            let what = match name.1 {
                "" => "there is no name before this sign =".to_owned(),
                name => format!("option \"{name}\" has no value: {name}=... is missing"),
            };
            return Err(Error::argument("text", what).byte(name.0));
        }
        self.at += 1;
        self.pass(is_blank);
        let value = self.word();
        if value.1.is_empty() {
            let what = format!("option \"{}\" has no value after the sign =", name.1);
            return Err(Error::argument("text", what).byte(value.0));
        }
        Ok(Some(Item { name, value }))
    }

    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn pass(&mut self, passed: impl Fn(char) -> bool) {
        self.at += self.rest().find(|c| !passed(c)).unwrap_or(self.rest().len());
    }

    fn pass_separators(&mut self) {
        self.pass(|c| is_blank(c) || c == ',');
        while self.rest().starts_with('#') {
            self.pass(|c| c != '\n');
            self.pass(|c| is_blank(c) || c == ',');
        }
    }

    /// The text up to a separator, a sign = or a comment, and the byte at which it begins.
    fn word(&mut self) -> (usize, &'a str) {
        let start = self.at;
        self.pass(|c| !is_blank(c) && !matches!(c, ',' | '=' | '#'));
        (start, &self.text[start..self.at])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::words::Preconditioning;

    fn set(text: &str) -> Result<Settings> {
        let mut settings = Settings::new();
        settings.set_text(text).map(|()| settings)
    }

    #[test]
    fn blanks_commas_ends_of_lines_and_comments_separate() {
        let expected = Settings {
            tolerance: 1e-8,
            threads: 4,
            preconditioner: Preconditioning::Lumped,
            ..Settings::new()
        };
        for text in [
            "tolerance=1e-8 threads=4 preconditioner=lumped",
            "preconditioner=lumped,threads=4,tolerance=1e-8",
            " tolerance = 1D-8,\n\tthreads\t=\t+4 # cores\r\n# gamma = 2\npreconditioner =lumped#end",
            "tolerance=1e-3 threads=4 preconditioner=lumped tolerance=1e-8",
        ] {
            assert_eq!(set(text).unwrap(), expected, "{text}");
        }
        for nothing in ["", " ,\n", "# threads=4", "#"] {
            assert_eq!(set(nothing).unwrap(), Settings::new(), "{nothing}");
        }
    }

    #[test]
    fn what_is_wrong_is_named_with_its_byte_and_nothing_is_set() {
        for (text, byte, says) in [
            ("threads=4 tolerence=1e-8", 10, "no option \"tolerence\""),
            ("threads=4 tolerance=1e3", 20, "\"tolerance\" takes"),
            ("threads=4 tolerance=small", 20, "\"tolerance\" is a number"),
            ("tolerance=1e-8,threads=1.5", 23, "\"threads\" is a whole number"),
            ("tolerance=nan", 10, "\"tolerance\" takes"),
            ("gamma=2 preconditioner=Lumped", 23, "\"preconditioner\" is one of"),
            ("gamma=2 threads", 8, "\"threads\" has no value"),
            ("gamma=2 threads 4", 8, "\"threads\" has no value"),
            ("gamma=2 threads= # 4", 17, "\"threads\" has no value"),
            ("gamma=2 =4", 8, "no name"),
            ("gamma=2 # \u{e9}\n\u{e9}=4", 13, "no option \"\u{e9}\""),
        ] {
            let mut settings = Settings::new();
            let error = settings.set_text(text).unwrap_err();
            assert_eq!(
                (error.kind, error.place.byte),
                (Kind::Argument("text"), Some(byte)),
                "{text}: {error}"
            );
            assert!(error.what.contains(says), "{text}: {error}");
            assert_eq!(settings, Settings::new());
        }
    }

    #[test]
    fn the_changes_of_all_options_come_back_bit_by_bit() {
        let mut settings = Settings::new();
        assert_eq!(settings.changes(), "");
        for option in options() {
            let name = option.name.to_str().unwrap();
            match option.default {
                OptionValue::F64(default) => {
                    let value = if default == 0.0 { 1.0 / 3.0 } else { default * (1.0 - 1.0 / 3.0) };
                    settings.set_f64(name, value.max(option.minimum)).unwrap();
                }
                OptionValue::I64(default) => {
                    settings.set_i64(name, (default + 1).min(option.maximum as i64)).unwrap()
                }
                OptionValue::Str(_) => {
                    let known = settings.set_str(name, "?").unwrap_err().what;
                    let last = known.split_once(", not").unwrap().0.rsplit(' ').next().unwrap();
                    settings.set_str(name, last).unwrap();
                }
                OptionValue::Text(_) => settings.set_str(name, "a file").unwrap(),
            }
        }
        let text = settings.changes();
        assert_eq!(text.split(' ').count(), options().len() - OF_HOST.len(), "{text}");
        let mut back = set(&text).unwrap();
        assert_ne!(back, settings);
        back.keep_of_host(&settings);
        assert_eq!(back, settings);
    }
}
