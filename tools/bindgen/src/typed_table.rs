//! What typed/table says of the procedures of the typed Fortran modules.

const TABLE: &str = include_str!("typed/table");

/// A procedure of the table.
#[derive(Clone, Debug, Default)]
pub struct Entry {
    pub module: &'static str,
    pub generic: &'static str,
    /// The name in module feti_contact, if it is not feti_ and the generic name.
    face: Option<&'static str>,
    pub name: &'static str,
    pub by_hand: bool,
    pub arguments: Vec<&'static str>,
    pub function: &'static str,
    pub note: &'static str,
    /// (argument of C, condition, text)
    pub checks: Vec<(&'static str, &'static str, &'static str)>,
    /// (argument of C, value)
    pub given: Vec<(&'static str, &'static str)>,
    /// What describes a generic in place of the summary and the arguments of C.
    pub described: Option<&'static str>,
    pub paragraphs: Vec<&'static str>,
}

impl Entry {
    pub fn outside(&self) -> String {
        self.face.map_or(format!("feti_{}", self.generic), str::to_string)
    }

    /// The specific procedures: for integers of 4 and 8 bytes, or one.
    pub fn specifics(&self) -> Vec<(String, Option<Kind>)> {
        match self.name.strip_suffix('*') {
            Some(stem) => {
                [Kind::Int32, Kind::Int64].map(|kind| (format!("{stem}{}", kind.name()), Some(kind))).to_vec()
            }
            None => vec![(self.name.to_string(), None)],
        }
    }

    /// `NAME`, `WORD NAME`, both with or without arguments, before the function of C.
    fn read(module: &'static str, line: &'static str) -> Self {
        let (head, note) = line.split_once(": ").unwrap_or((line, ""));
        let (head, function) = head.rsplit_once(' ').expect("a line names a function of C");
        let (names, arguments) = head.split_once('(').unwrap_or((head, ""));
        let by_hand = names.ends_with(" by hand");
        let names = names.trim_end_matches(" by hand");
        let (generic, name) = names.split_once(' ').unwrap_or((names, names));
        let face = generic.split_once('=').map(|(_, face)| face);
        let plain = |name: &'static str| name.split('=').next().unwrap_or(name);
        let (generic, name) = (plain(generic), plain(name));
        let arguments = arguments.strip_suffix(')').unwrap_or(arguments).split(", ").collect();
        Entry { module, generic, face, name, by_hand, arguments, function, note, ..Entry::default() }
    }
}

/// The modules of the table, each with what it is about, and its procedures.
pub fn modules() -> Vec<(&'static str, &'static str, Vec<Entry>)> {
    let mut modules: Vec<(_, _, Vec<Entry>)> = Vec::new();
    for line in TABLE.lines().filter(|line| !line.is_empty() && !line.starts_with(['#', ':', '+'])) {
        if let Some(heading) = line.strip_prefix("module ") {
            let (name, about) =
                heading.split_once(": ").unwrap_or((heading.trim_end_matches(" by hand"), ""));
            modules.push((name, about, Vec::new()));
            continue;
        }
        let Some((module, _, entries)) = modules.last_mut() else { continue };
        let last = entries.last_mut();
        match (line.get(..4), last) {
            (Some("  ? "), Some(entry)) => {
                let (condition, text) = line[4..].split_once(": ").expect("condition and text");
                let (k, condition) = condition.split_once(' ').expect("number and condition");
                entry.checks.push((k, condition, text));
            }
            (Some("  = "), Some(entry)) => entry.given.extend(line[4..].split_once(' ')),
            (Some("  < "), Some(entry)) => entry.described = Some(&line[4..]),
            (Some("  > "), Some(entry)) => entry.paragraphs.push(&line[4..]),
            _ => entries.push(Entry::read(module, line)),
        }
    }
    modules
}

/// The members of a struct that count from 0 in C.
pub fn counted(structure: &str) -> Vec<&'static str> {
    let mut lists = TABLE.lines().filter_map(|line| line.strip_prefix(": ")?.split_once(' '));
    lists.find(|(name, _)| *name == structure).map_or(Vec::new(), |(_, members)| members.split(' ').collect())
}

/// The integers of index arrays and states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Int32,
    Int64,
}

impl Kind {
    pub fn name(self) -> &'static str {
        match self {
            Kind::Int32 => "int32",
            Kind::Int64 => "int64",
        }
    }
}

/// An argument of the host: `R=basis(:,:)`, `rhs?(:)`, `val=>(:)`, `first?+1`, `body+1!`.
pub struct Dummy {
    pub name: &'static str,
    pub of_c: &'static str,
    pub shape: &'static str,
    pub is_optional: bool,
    pub is_pointer: bool,
    pub is_raised: bool,
    pub is_zero_after_failure: bool,
}

impl Dummy {
    pub fn read(token: &'static str) -> Self {
        let end = |text: &str| text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
        let (name, mut rest) = token.split_at(end(token));
        let mut of_c = name;
        let is_pointer = rest.starts_with("=>");
        if let Some(other) = rest.strip_prefix('=').filter(|_| !is_pointer) {
            (of_c, rest) = other.split_at(end(other));
        }
        let shape = rest.find('(').map_or("", |start| &rest[start..=rest.find(')').unwrap_or(start)]);
        let (is_optional, is_zero_after_failure) = (rest.contains('?'), rest.ends_with('!'));
        Dummy {
            name,
            of_c,
            shape,
            is_optional,
            is_pointer,
            is_raised: rest.contains("+1"),
            is_zero_after_failure,
        }
    }

    pub fn rank(&self) -> usize {
        self.shape.matches(':').count()
    }
}

/// The further names of a module that a host uses.
pub fn further(module: &str) -> Option<&'static str> {
    let mut lines = TABLE.lines().skip_while(|line| !line.starts_with(&format!("module {module}"))).skip(1);
    lines.next()?.strip_prefix("+ ")
}
