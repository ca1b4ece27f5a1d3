//! What stands before the declarations of the header: the problem, the rules of every call, an example, the contents.

use std::fmt::Write;

use crate::order::Group;

/// A whole program; tests/docs compiles it out of the header and compares what it prints.
const EXAMPLE: &str = include_str!("example.c");
const WIDTH: usize = 100;

const RULES: &str = "\
@file
Contact problems of elastic bodies by FETI duality.

  minimise 1/2 u'K u - f'u  over all u with  B u <= c  and  H u = h

K is the stiffness of several bodies, floating ones included. The forces of the rows are lambda >= 0
of B u <= c and mu of H u = h: K u = f - B'lambda - H'mu.

Functions return a status: 0 for success, above 0 for an answer that is usable but incomplete, below
0 for a failure, whose text feti_last_error tells; exceptions are feti_version..., feti_status_...,
feti_option_count and feti_last_error. Bodies, unknowns and rows count from 0; arrays of indices
count from their argument base. Matrices by rows are compressed sparse rows, dense ones column-major.
What is handed over is copied, unless FETI_BORROW says otherwise. The library prints nothing. A
problem serves one call at a time, different problems may be used by different threads. Units are the
host's: any that fit together.

Example: a block of two unknowns and stiffness 4000 N/mm floats 0.5 mm before a wall, and a force of
100 N on its rear pushes it there. It prints `force 100 N, rear 0.525 mm, front 0.5 mm`.
@code
";

/// The comment, one line of text to a line.
pub fn comment(groups: &[Group]) -> String {
    let contents = groups.iter().map(|group| {
        let functions: Vec<_> = group.functions.iter().map(|function| function.name.as_str()).collect();
        (group.heading, group.says, functions)
    });
    let mut text = format!("{RULES}{EXAMPLE}@endcode\n\nContents, in the order of the job:\n");
    for (heading, says, functions) in contents {
        let _ = write!(text, "\n{heading}: {says}\n{}", wrapped(&functions));
    }
    let lines = text.lines().map(|line| format!(" * {line}").trim_end().to_string() + "\n");
    format!("/**\n{} */", lines.collect::<String>())
}

fn wrapped(names: &[&str]) -> String {
    let mut out = String::new();
    let mut line = String::new();
    for name in names {
        if line.len() + name.len() + 4 > WIDTH {
            let _ = writeln!(out, "   {line}");
            line.clear();
        }
        line.push(' ');
        line.push_str(name);
    }
    if !line.is_empty() {
        let _ = writeln!(out, "   {line}");
    }
    out
}
