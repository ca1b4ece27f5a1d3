//! Documentation of an item: free text around one Markdown table `| argument | in/out | shape | rule |`.
//!
//! The table is read because it holds what a C type does not say: whether a pointer leads to one number or to an
//! array (shape `scalar` or anything else), and whether it may be NULL (the word `NULL` in the rule).

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Direction {
    In,
    Out,
    InOut,
}

impl Direction {
    fn parse(cell: &str) -> Option<Self> {
        match cell {
            "in" => Some(Direction::In),
            "out" => Some(Direction::Out),
            "in/out" => Some(Direction::InOut),
            _ => None,
        }
    }

    /// Fortran's INTENT.
    pub fn intent(self) -> &'static str {
        match self {
            Direction::In => "in",
            Direction::Out => "out",
            Direction::InOut => "inout",
        }
    }

    fn doxygen(self) -> &'static str {
        match self {
            Direction::In => "",
            Direction::Out => "[out]",
            Direction::InOut => "[in,out]",
        }
    }
}

/// One argument's row of the table.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub argument: String,
    pub direction: Direction,
    pub shape: String,
    pub rule: String,
}

impl Row {
    /// The rule names NULL, as a whole word: the pointer may be NULL.
    pub fn is_nullable(&self) -> bool {
        self.rule.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').any(|word| word == "NULL")
    }

    /// What an argument of this name is in every call; the header says it once.
    fn is_of_every_call(&self) -> bool {
        let rules =
            [("p", "the handle"), ("body", "number of the body, from 0"), ("n", "unknowns of the body")];
        rules.contains(&(self.argument.as_str(), self.rule.as_str()))
    }
}

#[derive(Clone, Debug, Default)]
pub struct Doc {
    before: Vec<String>,
    pub rows: Vec<Row>,
    after: Vec<String>,
}

impl Doc {
    /// One sentence.
    pub fn of(sentence: String) -> Self {
        Doc { before: vec![sentence], ..Doc::default() }
    }

    /// The first paragraph.
    pub fn summary(&self) -> String {
        self.paragraphs()[0].first().cloned().unwrap_or_default()
    }

    pub fn parse(lines: &[String]) -> Result<Self, String> {
        check_characters(lines)?;
        let Some(start) = lines.iter().position(|line| is_header(line)) else {
            return Ok(Doc { before: lines.to_vec(), ..Doc::default() });
        };
        let header = cells(&lines[start], usize::MAX);
        let column = |name: &str| {
            let found = header.iter().position(|cell| cell == name);
            found.ok_or_else(|| format!("the argument table has no column `{name}`"))
        };
        let columns = [column("argument")?, column("in/out")?, column("shape")?, column("rule")?];
        let table = lines[start..].iter().take_while(|line| line.trim_start().starts_with('|'));
        let end = start + table.count();
        let rows = lines[start..end].iter().skip(2).map(|line| row(line, header.len(), columns));
        Ok(Doc {
            before: lines[..start].to_vec(),
            rows: rows.collect::<Result<_, _>>()?,
            after: lines[end..].to_vec(),
        })
    }

    /// The paragraphs before the table, and those after it, each in one line.
    pub fn paragraphs(&self) -> [Vec<String>; 2] {
        let of = |lines: &[String]| -> Vec<String> {
            paragraphs(lines, usize::MAX).into_iter().filter(|line| !line.is_empty()).collect()
        };
        [of(&self.before), of(&self.after)]
    }

    /// Plain lines of at most `width` characters; the table becomes one `@param name (shape) rule` per argument, except for what
    /// the rules of every call say.
    pub fn render(&self, width: usize) -> Vec<String> {
        let mut lines = paragraphs(&self.before, width);
        let rows: Vec<_> = self.rows.iter().filter(|row| !row.is_of_every_call()).collect();
        let name_width = rows.iter().map(|row| row.argument.len()).max().unwrap_or(0);
        let tag_width = rows.iter().map(|row| row.direction.doxygen().len()).max().unwrap_or(0);
        if !lines.is_empty() && !rows.is_empty() {
            lines.push(String::new());
        }
        for row in rows {
            let head = format!("@param{:tag_width$} {:name_width$} ", row.direction.doxygen(), row.argument);
            let shape = if row.shape == "scalar" { String::new() } else { format!("({}) ", row.shape) };
            lines.extend(wrap(&head, &" ".repeat(head.len()), &format!("{shape}{}", row.rule), width));
        }
        lines
    }
}

/// A C comment must not be opened or closed by the text, and both outputs are ASCII.
fn check_characters(lines: &[String]) -> Result<(), String> {
    for line in lines {
        if !line.is_ascii() {
            return Err(format!("the documentation is not ASCII: \"{line}\""));
        }
        if line.contains("*/") || line.contains("/*") {
            return Err(format!("the documentation holds a C comment mark: \"{line}\""));
        }
    }
    Ok(())
}

fn is_header(line: &str) -> bool {
    line.trim_start().starts_with('|') && cells(line, 2).first().is_some_and(|cell| cell == "argument")
}

/// Cells of a table row; the last of `count` keeps any further bar, so that a rule may hold |x|.
fn cells(line: &str, count: usize) -> Vec<String> {
    let line = line.trim();
    let line = line.strip_prefix('|').unwrap_or(line);
    let line = line.strip_suffix('|').unwrap_or(line);
    line.splitn(count, '|').map(|cell| cell.trim().replace("\\|", "|")).collect()
}

fn row(line: &str, count: usize, columns: [usize; 4]) -> Result<Row, String> {
    let cells = cells(line, count);
    if cells.len() != count {
        return Err(format!(
            "the argument table has a row of {} cells instead of {count}: {line}",
            cells.len()
        ));
    }
    let [argument, direction, shape, rule] = columns.map(|k| cells[k].clone());
    let argument = argument.replace('`', "");
    let Some(direction) = Direction::parse(&direction) else {
        return Err(format!("argument `{argument}`: in/out is `{direction}`, not `in`, `out` or `in/out`"));
    };
    Ok(Row { argument, direction, shape: shape.replace('`', ""), rule: links_removed(&rule) })
}

/// `[`name`]`, a link of rustdoc, becomes `name`.
fn links_removed(text: &str) -> String {
    text.replace("[`", "`").replace("`]", "`")
}

/// Joins the lines of each paragraph and wraps them; a heading `# Safety` becomes `Safety:`.
fn paragraphs(lines: &[String], width: usize) -> Vec<String> {
    let mut blocks: Vec<String> = Vec::new();
    // Whether the next line continues the last block, and whether that is still a heading alone.
    let (mut open, mut heading) = (false, false);
    for line in lines {
        let text = links_removed(line.trim());
        if let Some(title) = text.strip_prefix('#') {
            blocks.push(format!("{}:", title.trim_start_matches('#').trim()));
            (open, heading) = (true, true);
        } else if text.is_empty() {
            if open && !heading {
                blocks.push(String::new());
                open = false;
            }
        } else if open && !is_list_item(&text) {
            let last = blocks.last_mut().expect("an open paragraph exists");
            *last = format!("{last} {text}");
            heading = false;
        } else {
            blocks.push(text);
            (open, heading) = (true, false);
        }
    }
    while blocks.last().is_some_and(String::is_empty) {
        blocks.pop();
    }
    let indent = |block: &str| if is_list_item(block) { "  " } else { "" };
    blocks.iter().flat_map(|block| wrap("", indent(block), block, width)).collect()
}

fn is_list_item(text: &str) -> bool {
    text.starts_with("- ") || text.starts_with("* ")
}

/// Breaks `text` between words: `head` leads the first line, `hang` the others.
pub fn wrap(head: &str, hang: &str, text: &str, width: usize) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = head.to_string();
    let mut empty = true;
    for word in text.split_whitespace() {
        let space = usize::from(!empty);
        if !empty && line.len() + space + word.len() > width {
            lines.push(std::mem::replace(&mut line, hang.to_string()));
            empty = true;
        }
        if !empty {
            line.push(' ');
        }
        line.push_str(word);
        empty = false;
    }
    lines.push(line.trim_end().to_string());
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str) -> Vec<String> {
        text.lines().map(str::to_string).collect()
    }

    const TABLE: &str = "Solves.\n\n| argument | in/out | shape | rule |\n|---|---|---|---|\n| `p` | in | scalar | handle |\n\
        | x | out | `ld * n` | |x| <= 1, may be NULL |\n\nKeeps nothing.";

    #[test]
    fn table_rows_are_read_and_a_rule_may_hold_bars() {
        let doc = Doc::parse(&lines(TABLE)).unwrap();
        assert_eq!(doc.rows.len(), 2);
        assert_eq!(doc.rows[1].shape, "ld * n");
        assert_eq!(doc.rows[1].rule, "|x| <= 1, may be NULL");
        assert!(doc.rows[1].is_nullable() && !doc.rows[0].is_nullable());
    }

    #[test]
    fn null_counts_only_as_a_whole_word() {
        let rule = |rule: &str| Row {
            argument: "x".into(),
            direction: Direction::In,
            shape: "n".into(),
            rule: rule.into(),
        };
        assert!(rule("`NULL`: zeros").is_nullable());
        assert!(!rule("FETI_NULL_SPACE otherwise; NULLs are not counted").is_nullable());
    }

    #[test]
    fn a_comment_mark_in_the_text_is_refused() {
        assert!(Doc::parse(&lines("u'K*/2")).unwrap_err().contains("comment mark"));
    }

    #[test]
    fn an_unknown_direction_is_refused_with_its_argument() {
        let text = TABLE.replace("| x | out |", "| x | write |");
        assert!(Doc::parse(&lines(&text)).unwrap_err().contains("argument `x`: in/out is `write`"));
    }

    #[test]
    fn paragraphs_lists_and_headings_keep_their_lines() {
        let text = "One\ntwo:\n\nThree.\n- a\n- b\n\n# Safety\n\nNone.\n";
        let rendered = Doc::parse(&lines(text)).unwrap().render(80);
        assert_eq!(rendered, ["One two:", "", "Three.", "- a", "- b", "", "Safety: None."]);
    }

    #[test]
    fn rendering_wraps_and_lists_the_arguments() {
        let text = Doc::parse(&lines(TABLE)).unwrap().render(30);
        assert_eq!(text[0], "Solves.");
        assert_eq!(text[2], "@param      p handle");
        assert!(text.iter().all(|line| line.len() <= 30), "{text:?}");
    }
}
