//! Sources read as text: words, paths, what belongs to tests.

pub fn line_of(code: &str, at: usize) -> usize {
    1 + code[..at].matches('\n').count()
}

pub fn is_word(c: u8) -> bool {
    c.is_ascii_alphanumeric() || c == b'_'
}

/// Positions of `token` that do not continue a longer word to the left.
pub fn occurrences<'a>(code: &'a str, token: &'a str) -> impl Iterator<Item = usize> + 'a {
    let free =
        move |at: &usize| !is_word(token.as_bytes()[0]) || *at == 0 || !is_word(code.as_bytes()[at - 1]);
    code.match_indices(token).map(|(at, _)| at).filter(free)
}

/// Positions of `word` as a whole word.
pub fn words<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let ends = move |at: &usize| code.as_bytes().get(at + word.len()).is_none_or(|&c| !is_word(c));
    occurrences(code, word).filter(ends)
}

/// A path that starts with crate, self, super or, in another crate, the name of the library.
pub struct Named {
    pub at: usize,
    pub through_super: bool,
    pub of_library: bool,
    /// From the root.
    pub path: Vec<String>,
}

/// The crate on which those in other folders stand.
const LIBRARY: &str = "feti_contact";

/// All paths of `use` declarations and expressions that start as [`Named`] says, those in braces one by one.
pub fn paths(file: &str, code: &str) -> Vec<Named> {
    let starts = ["crate", "self", "super", LIBRARY].into_iter().flat_map(|word| {
        let first = move |at: &usize| {
            !code[..*at].trim_end().ends_with("::") && code[at + word.len()..].trim_start().starts_with("::")
        };
        words(code, word).filter(first).map(move |at| (at, word))
    });
    let from = |(at, word): (usize, &str)| {
        let module = module_at(file, code, at);
        let (through_super, of_library) = (word == "super", word == LIBRARY);
        let paths = expanded(&code[at..], Renamed::AsItWas).into_iter();
        let named = move |path| {
            let path = absolute(path, &module)?;
            Some(Named { at, through_super, of_library, path })
        };
        paths.filter_map(named)
    };
    starts.flat_map(from).collect()
}

/// `src/solver/file/mod.rs` -> [solver, file]; `c/src/lib.rs`, `main.rs` -> [].
pub fn module_of(file: &str) -> Vec<String> {
    let file = file.split_once("src/").map_or(file, |(_, file)| file).trim_end_matches(".rs");
    let file = file.trim_end_matches("/mod");
    file.split('/').filter(|name| !["lib", "main"].contains(name)).map(str::to_owned).collect()
}

/// The module of the file, and in it those opened with `mod name {` around `at`.
fn module_at(file: &str, code: &str, at: usize) -> Vec<String> {
    let inline = words(code, "mod").filter_map(|start| {
        let open = start + code[start..].find(['{', ';'])?;
        let inside = code.as_bytes()[open] == b'{' && open < at && at < closing(code, open);
        inside.then(|| code[start + 3..open].trim().to_owned())
    });
    module_of(file).into_iter().chain(inline).collect()
}

/// Which name of `old as new` counts.
#[derive(Clone, Copy, PartialEq)]
pub enum Renamed {
    AsItWas,
    AsItIs,
}

/// The paths that start here, those in braces one by one.
pub fn expanded(code: &str, renamed: Renamed) -> Vec<Vec<String>> {
    let mut head = Vec::new();
    let mut rest = code;
    loop {
        rest = rest.trim_start();
        if rest.starts_with('{') {
            let inside = &rest[1..closing(rest, 0) - 1];
            let parts = split(inside).into_iter().flat_map(|part| expanded(part, renamed));
            return parts.map(|tail| [head.clone(), tail].concat()).collect();
        }
        let name: String = rest.bytes().take_while(|c| is_word(*c)).map(char::from).collect();
        if name.is_empty() {
            break;
        }
        rest = rest[name.len()..].trim_start();
        head.push(name);
        match rest.strip_prefix("::") {
            Some(tail) => rest = tail,
            None => break,
        }
    }
    if let Some(new) = rest.strip_prefix("as ").filter(|_| renamed == Renamed::AsItIs) {
        head.pop();
        head.extend(expanded(new, renamed).concat());
    }
    vec![head]
}

/// What commas outside of braces part.
fn split(list: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0, 0, Vec::new());
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&list[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&list[start..]);
    parts.into_iter().filter(|part| !part.trim().is_empty()).collect()
}

/// The path from the root; none through `super` beyond it.
fn absolute(path: Vec<String>, module: &[String]) -> Option<Vec<String>> {
    let mut base = match path.first()?.as_str() {
        "crate" | LIBRARY => Vec::new(),
        _ => module.to_vec(),
    };
    for name in path {
        match name.as_str() {
            "crate" | "self" | LIBRARY => {}
            "super" => drop(base.pop()?),
            _ => base.push(name),
        }
    }
    Some(base)
}

/// Position after the brace that closes the one at `open`.
pub fn closing(code: &str, open: usize) -> usize {
    let mut depth = 0usize;
    for (at, c) in code[open..].bytes().enumerate() {
        match c {
            b'{' => depth += 1,
            b'}' => depth -= 1,
            _ => continue,
        }
        if depth == 0 {
            return open + at + 1;
        }
    }
    code.len()
}

/// What `#[cfg(test)]` covers in this file.
pub fn test_ranges(code: &str) -> Vec<std::ops::Range<usize>> {
    let item = |at: usize| match code[at..].find(['{', ';']) {
        Some(offset) if code.as_bytes()[at + offset] == b'{' => at..closing(code, at + offset),
        Some(offset) => at..at + offset,
        None => at..code.len(),
    };
    occurrences(code, "#[cfg(test)]").map(item).collect()
}

/// Modules `mod name;` that exist in tests only.
pub fn test_modules(code: &str) -> Vec<String> {
    let items = test_ranges(code).into_iter().map(|range| code[range].to_owned());
    let name = |item: String| item.rsplit_once("mod ").map(|(_, name)| name.trim().to_owned());
    items.filter(|item| !item.contains('{')).filter_map(name).collect()
}

/// The source with comments, strings and characters blanked, every line in its place.
pub fn without_text(text: &str) -> String {
    let bytes = text.as_bytes();
    let (mut out, mut at) = (bytes.to_vec(), 0);
    while at < bytes.len() {
        let end = at + length_of_text(&bytes[at..], at > 0 && is_word(bytes[at - 1]));
        if end == at {
            at += 1;
            continue;
        }
        out[at..end].iter_mut().filter(|c| **c != b'\n').for_each(|c| *c = b' ');
        at = end;
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// Length of the comment, string or character that starts here, 0 for none.
pub fn length_of_text(rest: &[u8], inside_word: bool) -> usize {
    let until = |start: usize, end: &[u8]| {
        let found = rest[start..].windows(end.len()).position(|window| window == end);
        found.map_or(rest.len(), |at| start + at + end.len())
    };
    match rest {
        [b'/', b'/', ..] => rest.iter().position(|c| *c == b'\n').unwrap_or(rest.len()),
        [b'/', b'*', ..] => block_comment(rest),
        [b'"', ..] => quoted(rest, b'"'),
        [b'r', b'#' | b'"', ..] | [b'b' | b'c', b'r', b'#' | b'"', ..] if !inside_word => {
            let start = rest.iter().position(|c| *c == b'r').unwrap_or(0) + 1;
            let hashes = rest[start..].iter().take_while(|c| **c == b'#').count();
            if rest.get(start + hashes) != Some(&b'"') {
                return 0;
            }
            until(start + hashes + 1, &[b"\"".as_slice(), &vec![b'#'; hashes]].concat())
        }
        [b'\'', b'\\', ..] => quoted(rest, b'\''),
        [b'\'', c, tail @ ..] if tail.first() == Some(&b'\'') || !c.is_ascii() => quoted(rest, b'\''),
        _ => 0,
    }
}

pub fn block_comment(rest: &[u8]) -> usize {
    let (mut depth, mut at) = (0, 0);
    while at < rest.len() {
        match &rest[at..] {
            [b'/', b'*', ..] => (depth, at) = (depth + 1, at + 2),
            [b'*', b'/', ..] => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            break;
        }
    }
    at
}

pub fn quoted(rest: &[u8], quote: u8) -> usize {
    let mut at = 1;
    while at < rest.len() && rest[at] != quote {
        at += if rest[at] == b'\\' { 2 } else { 1 };
    }
    (at + 1).min(rest.len())
}
