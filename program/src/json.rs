//! JSON as text: objects, arrays, texts and numbers.

/// `{"name":value,...}`
pub fn object(items: &[(&str, String)]) -> String {
    let items: Vec<_> = items.iter().map(|(name, value)| format!("{}:{value}", text(name))).collect();
    format!("{{{}}}", items.join(","))
}

pub fn array(items: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", items.into_iter().collect::<Vec<_>>().join(","))
}

/// JSON has neither infinity nor NaN.
pub fn number(x: f64) -> String {
    if x.is_finite() {
        format!("{x:e}")
    } else {
        "null".to_owned()
    }
}

pub fn text(text: &str) -> String {
    let mut out = String::from("\"");
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c < ' ' => out += &format!("\\u{:04x}", u32::from(c)),
            c => out.push(c),
        }
    }
    out + "\""
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotes_and_line_ends_are_escaped_and_infinity_is_null() {
        let it = object(&[("a\"b", array([number(0.5), number(f64::INFINITY)])), ("c", text("1\n\\"))]);
        assert_eq!(it, "{\"a\\\"b\":[5e-1,null],\"c\":\"1\\u000a\\\\\"}");
    }
}
