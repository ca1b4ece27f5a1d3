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

K is the stiffness of several bodies, which may float. The forces of the rows are lambda >= 0 for
B u <= c and mu for H u = h: K u = f - B'lambda - H'mu.

Functions return a status: 0 for success, above 0 for an answer that is usable but incomplete, below
0 for a failure, whose text feti_last_error returns. Exceptions are feti_version..., feti_status_...,
feti_option_count and feti_last_error. In the descriptions `FETI_STATE if ...` means that the function
returns FETI_STATE in that case. After a failure nothing is written or changed, and the call can be
repeated with other arguments; only FETI_INTERNAL closes the problem.

`p` is the handle, `body` the number of a body, `n` the number of its unknowns. Bodies, unknowns and
rows count from 0; arrays of indices count from their argument `base`. An array has the shape in
parentheses; other pointers lead to one number, and may be NULL only if the description says so.
Texts end with NUL. Sparse matrices are stored as compressed sparse rows, dense matrices by columns.
The library copies what it is given, except with FETI_BORROW. Structs begin with `struct_size`, which
the caller sets to their size. Functions of the host, and the data given with them, must exist until
they are replaced or the problem is destroyed. The library prints nothing. Only one call at a time may
use a problem; several threads may use different problems. Any consistent set of units will do.

A first program needs ten functions: feti_problem_create, feti_body_add, feti_body_stiffness_i32,
feti_body_load, feti_rows_add_i32, feti_solve, feti_displacement, feti_multipliers, feti_last_error,
feti_problem_destroy.

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
    let mut text = format!("{RULES}{EXAMPLE}@endcode\n\nContents, in the order of use:\n");
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
