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

/// The names that follow `::` at the start of `rest`: one, or the heads of a `{...}` list.
pub fn heads(rest: &str) -> Vec<String> {
    let Some(rest) = rest.trim_start().strip_prefix("::") else { return Vec::new() };
    let rest = rest.trim_start();
    let head = |text: &str| -> String {
        let text = text.trim_start();
        let name: String = text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        if name.is_empty() {
            text.chars().take(1).collect()
        } else {
            name
        }
    };
    let Some(list) = rest.strip_prefix('{') else { return vec![head(rest)] };
    let (mut depth, mut start, mut names) = (0, 0, Vec::new());
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                names.push(head(&list[start..at]));
                start = at + 1;
                if c == '}' {
                    break;
                }
            }
            _ => {}
        }
    }
    names.retain(|name| !name.is_empty() && name != "}" && name != ",");
    names
}

/// Every `crate::name`, with what `crate::{a, b}` names.
pub fn paths_from_root(code: &str) -> Vec<(usize, String)> {
    let of = |at: usize| heads(&code[at + 5..]).into_iter().map(move |name| (at, name));
    words(code, "crate").flat_map(of).collect()
}

/// Every `super::...::name`, with the number of `super`.
pub fn paths_through_super(code: &str) -> Vec<(usize, usize, String)> {
    let mut found = Vec::new();
    for at in words(code, "super").filter(|&at| !code[..at].trim_end().ends_with("super::")) {
        let (mut supers, mut rest) = (1, &code[at + 5..]);
        while let Some(next) = rest.strip_prefix("::super") {
            (supers, rest) = (supers + 1, next);
        }
        found.extend(heads(rest).into_iter().map(|name| (at, supers, name)));
    }
    found
}

/// Modules between the root and the code at `at`: those of the path and those opened with `mod name {`.
pub fn depth_at(path: &str, code: &str, at: usize) -> usize {
    let of_file = path.split('/').count() - usize::from(path.ends_with("/mod.rs"));
    let inline = words(code, "mod").filter(|&start| {
        let header = code[start..].find(['{', ';']).map(|offset| start + offset);
        header.is_some_and(|open| code.as_bytes()[open] == b'{' && open < at && at < closing(code, open))
    });
    of_file + inline.count()
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
