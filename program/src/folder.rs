//! A problem as a folder of text files (docs/program.md): K1.mtx, R1.mtx, B.mtx, c.txt, H.mtx, h.txt, T.mtx, friction.txt, f.txt, dofs.txt, options.txt, and
//! the answer u.txt, lambda.txt, mu.txt, lambda_t.txt.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use feti_contact::solver::{Csr, FrictionInput, Modes, Problem, RowKind, RowsInput, Storage, TripletInput};

use crate::contents::{word, Contents};

const KINDS: [(&str, &str, RowKind); 2] =
    [("B.mtx", "c.txt", RowKind::Inequality), ("H.mtx", "h.txt", RowKind::Equality)];

/// The numbers of a text file, and the first line; none if there is no file.
struct Text {
    name: String,
    first: String,
    numbers: Vec<f64>,
}

fn text(folder: &Path, name: &str) -> Result<Option<Text>, String> {
    let path = folder.join(name);
    if !path.exists() {
        return Ok(None);
    }
    let said = |why: String| format!("{}: {why}", path.display());
    let all = fs::read_to_string(&path).map_err(|error| said(error.to_string()))?;
    let first = all.lines().next().unwrap_or_default().to_owned();
    let data = all.lines().enumerate().filter(|(_, line)| !line.starts_with(['%', '#']));
    let words = data.flat_map(|(k, line)| line.split_whitespace().map(move |word| (k, word)));
    let number = |(k, word): (usize, &str)| {
        word.parse().map_err(|_| said(format!("line {}: {word} is no number", k + 1)))
    };
    Ok(Some(Text { name: name.to_owned(), first, numbers: words.map(number).collect::<Result<_, _>>()? }))
}

impl Text {
    fn said(&self, why: &str) -> String {
        format!("{}: {why}", self.name)
    }

    fn size(&self, k: usize) -> Result<usize, String> {
        let number = self
            .numbers
            .get(k)
            .filter(|number| **number >= 0.0 && number.fract() == 0.0 && **number < 2f64.powi(53));
        number.map(|number| *number as usize).ok_or_else(|| self.said("a size is missing"))
    }

    /// Rows, columns, and the entries with row and column from 0; symmetric matrices as they are stored.
    fn triplets(&self) -> Result<(usize, usize, Vec<(usize, usize, f64)>), String> {
        let (rows, columns) = (self.size(0)?, self.size(1)?);
        if self.first.contains("array") {
            let values = self.numbers.get(2..).unwrap_or_default();
            if values.len() != rows.saturating_mul(columns) {
                return Err(self.said(&format!("{} values, not {rows} x {columns}", values.len())));
            }
            let at = |(k, value): (usize, &f64)| (k % rows.max(1), k / rows.max(1), *value);
            return Ok((rows, columns, values.iter().enumerate().map(at).collect()));
        }
        let (entries, data) = (self.size(2)?, self.numbers.get(3..).unwrap_or_default());
        if data.len() != entries.saturating_mul(3) {
            return Err(self.said(&format!("{} numbers, not those of {entries} entries", data.len())));
        }
        let inside =
            |x: f64, most: usize| (x >= 1.0 && x <= most as f64 && x.fract() == 0.0).then(|| x as usize - 1);
        let entry = |e: &[f64]| {
            let place = inside(e[0], rows).zip(inside(e[1], columns));
            place
                .map(|(i, j)| (i, j, e[2]))
                .ok_or_else(|| self.said(&format!("entry {} {} is outside", e[0], e[1])))
        };
        Ok((rows, columns, data.chunks_exact(3).map(entry).collect::<Result<_, _>>()?))
    }

    /// Of a matrix with more rows than entries there have to be so many other numbers.
    fn by_rows(&self, unknowns: usize, others: usize) -> Result<(Vec<usize>, Vec<i64>, Vec<f64>), String> {
        let (rows, columns, mut entries) = self.triplets()?;
        if columns != unknowns {
            return Err(self.said(&format!("{columns} columns, not the {unknowns} unknowns of all bodies")));
        }
        if rows > entries.len().max(others) {
            return Err(self.said(&format!("{rows} rows, but only {} entries", entries.len())));
        }
        entries.sort_by_key(|(i, _, _)| *i);
        let ptr = (0..=rows).map(|i| entries.partition_point(|entry| entry.0 < i)).collect();
        Ok((
            ptr,
            entries.iter().map(|entry| entry.1 as i64).collect(),
            entries.iter().map(|entry| entry.2).collect(),
        ))
    }

    /// Column k of a table with so many columns.
    fn column(&self, k: usize, columns: usize) -> Vec<f64> {
        self.numbers.iter().skip(k).step_by(columns.max(1)).copied().collect()
    }
}

pub fn read(folder: &Path) -> Result<Problem, String> {
    let mut problem = Problem::new();
    problem.offer_method(&paper::Paper);
    let told = |error: feti_contact::error::Error| format!("{}: {error}", folder.display());
    if let Ok(options) = fs::read_to_string(folder.join("options.txt")) {
        // a folder of somebody else writes nowhere
        if options.contains("log_file") {
            return Err(format!("{}: options.txt: log_file belongs to the command line", folder.display()));
        }
        problem.set_text(&options).map_err(told)?;
    }
    let mut starts = vec![0];
    while let Some(k) = text(folder, &format!("K{}.mtx", starts.len()))? {
        let (n, columns, entries) = k.triplets()?;
        if columns != n {
            return Err(k.said(&format!("{n} rows and {columns} columns")));
        }
        let body = problem.add_body(n).map_err(told)?;
        let storage = if k.first.contains("general") { Storage::Full } else { Storage::Lower };
        let [row, col] =
            [0, 1].map(|k| entries.iter().map(|e| if k == 0 { e.0 } else { e.1 } as i64).collect::<Vec<_>>());
        let val: Vec<f64> = entries.iter().map(|e| e.2).collect();
        let k = TripletInput { row: &row, col: &col, val: &val, storage };
        problem.set_stiffness_triplets(body, n, k).map_err(told)?;
        motions(&mut problem, folder, body, n)?;
        starts.push(starts[body] + n);
    }
    let [bodies, unknowns] = [starts.len() - 1, starts[starts.len() - 1]];
    if bodies == 0 {
        return Err(format!("{}: there is no K1.mtx", folder.display()));
    }
    let of_length = |name: &str, length: usize| match text(folder, name)? {
        Some(of) if of.numbers.len() != length => {
            Err(of.said(&format!("{} numbers, not {length}", of.numbers.len())))
        }
        of => Ok(of),
    };
    if let Some(f) = of_length("f.txt", unknowns)? {
        (0..bodies)
            .try_for_each(|p| problem.set_load(p, &f.numbers[starts[p]..starts[p + 1]]))
            .map_err(told)?;
    }
    if let Some(places) = of_length("dofs.txt", unknowns.saturating_mul(5))? {
        coordinates(&mut problem, &places, &starts).map_err(told)?;
    }
    for (matrix, rhs, kind) in KINDS {
        let Some(rows) = text(folder, matrix)? else { continue };
        let given = text(folder, rhs)?.map_or(0, |of| of.numbers.len());
        let (ptr, dof, val) = rows.by_rows(unknowns, given)?;
        let rows = ptr.len() - 1;
        let gaps = of_length(rhs, rows)?.map_or(vec![0.0; rows], |of| of.numbers);
        let rows = RowsInput { ptr: &ptr, body: None, dof: &dof, val: &val, rhs: Some(&gaps) };
        problem.add_rows(kind, rows).map_err(told)?;
        if let Some(inv_k) = of_length(&format!("inv_k_{rhs}"), gaps.len())? {
            problem.set_compliance(kind, 0, &inv_k.numbers).map_err(told)?;
        }
    }
    friction(&mut problem, folder, unknowns)?;
    Ok(problem)
}

/// R of a body; without a file K is not singular.
fn motions(problem: &mut Problem, folder: &Path, body: usize, n: usize) -> Result<(), String> {
    let Some(r) = text(folder, &format!("R{}.mtx", body + 1))? else {
        return problem.set_null_space(body, n, 0, &[], n, Modes::Exact).map_err(|error| error.to_string());
    };
    let path = folder.join(&r.name);
    let comment = fs::read_to_string(path).unwrap_or_default().lines().nth(1).unwrap_or_default().to_owned();
    let modes = match comment.trim_start_matches(['%', ' ']) {
        "unknown" => return Ok(()),
        "candidates" => Modes::Candidates,
        "soft" => Modes::Soft,
        _ => Modes::Exact,
    };
    if !r.first.contains("array") {
        return Err(r.said("an array is expected, all numbers by columns"));
    }
    let (rows, columns, entries) = r.triplets()?;
    let mut basis = vec![0.0; rows * columns];
    entries.iter().for_each(|(i, j, value)| basis[i + rows * j] = *value);
    problem
        .set_null_space(body, rows, columns, &basis, rows, modes)
        .map_err(|error| format!("{}: {error}", r.name))
}

/// Node, direction, x, y, z of every unknown: direction 0 in bodies without coordinates.
fn coordinates(problem: &mut Problem, places: &Text, starts: &[usize]) -> feti_contact::error::Result<()> {
    let [node, dir] = [0, 1].map(|k| places.column(k, 5).iter().map(|x| *x as i32).collect::<Vec<_>>());
    let xyz: Vec<f64> = places.numbers.chunks_exact(5).flat_map(|line| line[2..].to_vec()).collect();
    for p in 0..starts.len() - 1 {
        let own = starts[p]..starts[p + 1];
        if dir[own.clone()].iter().any(|dir| *dir != 0) {
            problem.set_coordinates(
                p,
                3,
                &node[own.clone()],
                &dir[own.clone()],
                &xyz[3 * own.start..3 * own.end],
                3,
            )?;
        }
    }
    Ok(())
}

/// friction.txt has a line for each node: contact row from 1 or 0, coefficient, bound, compliance, slips; T.mtx their rows.
fn friction(problem: &mut Problem, folder: &Path, unknowns: usize) -> Result<(), String> {
    let (Some(rows), Some(laws)) = (text(folder, "T.mtx")?, text(folder, "friction.txt")?) else {
        return Ok(());
    };
    let told = |error: feti_contact::error::Error| format!("friction.txt: {error}");
    let (ptr, dof, val) = rows.by_rows(unknowns, laws.numbers.len())?;
    let all = ptr.len() - 1;
    // 4 numbers a node, and one for each row
    let nodes = laws.numbers.len().saturating_sub(all) / 4;
    if nodes == 0 || 4 * nodes + all != laws.numbers.len() || all % nodes != 0 {
        return Err(
            laws.said(&format!("a line has 4 numbers and a slip for each of the {all} rows of T.mtx"))
        );
    }
    let dim = all / nodes;
    let [normal, coefficient, bound, inv_kt] = [0, 1, 2, 3].map(|k| laws.column(k, 4 + dim));
    let normal: Vec<i64> = normal.iter().map(|row| *row as i64 - 1).collect();
    let s_old: Vec<f64> = laws.numbers.chunks_exact(4 + dim).flat_map(|line| line[4..].to_vec()).collect();
    let rows = RowsInput { ptr: &ptr, body: None, dof: &dof, val: &val, rhs: None };
    let input =
        FrictionInput { dim, normal: &normal, rows, coefficient: Some(&coefficient), bound: Some(&bound) };
    problem.add_friction(input).map_err(told)?;
    problem.set_friction_compliance(0, &inv_kt).map_err(told)?;
    problem.set_friction_reference(0, nodes, dim, &s_old).map_err(told)
}

/// u, lambda, mu, lambda_t of `solve --write` or of a reference; none without u. What is absent is 0.
pub fn answer(folder: &Path, problem: &Problem) -> Result<Option<[Vec<f64>; 4]>, String> {
    let sizes = problem.sizes();
    let of = |name: &str, length: usize| {
        let found = match text(folder, &format!("{name}.txt"))? {
            None => text(folder, &format!("{name}_ref.txt"))?,
            found => found,
        };
        Ok::<_, String>(found.map_or_else(|| vec![0.0; length], |found| found.numbers))
    };
    if !["u.txt", "u_ref.txt"].iter().any(|name| folder.join(name).exists()) {
        return Ok(None);
    }
    Ok(Some([
        of("u", sizes.dofs)?,
        of("lambda", sizes.rows)?,
        of("mu", sizes.equalities)?,
        of("lambda_t", sizes.tangential)?,
    ]))
}

pub fn write_answer(problem: &Problem, folder: &Path) -> Result<(), String> {
    let all = [
        ("u.txt", problem.displacements()),
        ("lambda.txt", problem.multipliers(RowKind::Inequality)),
        ("mu.txt", problem.multipliers(RowKind::Equality)),
        ("lambda_t.txt", problem.multipliers(RowKind::Tangential)),
    ];
    for (name, values) in all {
        put(folder, name, &lines(values.map_err(|error| error.to_string())?))?;
    }
    Ok(())
}

fn put(folder: &Path, name: &str, text: &str) -> Result<(), String> {
    let path = folder.join(name);
    let done = fs::create_dir_all(folder).and_then(|()| fs::write(&path, text));
    done.map_err(|error| format!("{}: {error}", path.display()))
}

fn lines(values: &[f64]) -> String {
    values.iter().fold(String::new(), |mut out, value| {
        let _ = writeln!(out, "{value:e}");
        out
    })
}

/// The entries of a matrix, from 1.
fn mtx<E: Iterator<Item = (usize, f64)>>(
    symmetry: &str,
    [rows, columns, entries]: [usize; 3],
    row: impl Fn(usize) -> E,
) -> String {
    let mut out = format!("%%MatrixMarket matrix coordinate real {symmetry}\n{rows} {columns} {entries}\n");
    for i in 0..rows {
        for (j, value) in row(i) {
            let _ = writeln!(out, "{} {} {value:e}", i + 1, j + 1);
        }
    }
    out
}

fn general(rows: &Csr) -> String {
    mtx("general", [rows.rows(), rows.cols, rows.val.len()], |i| rows.row(i))
}

/// Every file of the problem; numbers come back bit by bit.
pub fn write(all: &Contents, folder: &Path) -> Result<(), String> {
    let (mut loads, mut places) = (Vec::new(), String::from("# node direction x y z\n"));
    for (p, body) in all.bodies.iter().enumerate() {
        let n = body.n();
        let k = body.k().ok_or_else(|| format!("body {p} has no stiffness"))?;
        let text = mtx("symmetric", [n, n, k.val.len()], |i| k.lower_row(i));
        put(folder, &format!("K{}.mtx", p + 1), &text)?;
        let columns = body.declared().unwrap_or(0);
        let (basis, said) = body.given.motions.map_or((&[][..], "unknown"), |(basis, of)| (basis, word(of)));
        if columns > 0 || body.given.motions.is_none() {
            let head = format!("%%MatrixMarket matrix array real general\n% {said}\n{n} {columns}\n");
            put(folder, &format!("R{}.mtx", p + 1), &(head + &lines(basis)))?;
        }
        loads.extend_from_slice(&body.load);
        for i in 0..n {
            let _ = match body.given.coordinates {
                Some((xyz, dir)) => {
                    let [x, y, z] = xyz[i];
                    writeln!(places, "{} {} {x:e} {y:e} {z:e}", i + 1, dir[i])
                }
                None => writeln!(places, "{} 0 0 0 0", i + 1),
            };
        }
    }
    put(folder, "f.txt", &lines(&loads))?;
    if all.bodies.iter().any(|body| body.given.coordinates.is_some()) {
        put(folder, "dofs.txt", &places)?;
    }
    for ((matrix, rhs, _), rows) in KINDS.iter().zip(&all.rows) {
        if rows.rhs.is_empty() {
            continue;
        }
        put(folder, matrix, &general(&rows.matrix))?;
        put(folder, rhs, &lines(&rows.rhs))?;
        if rows.compliance.iter().any(|inv_k| *inv_k != 0.0) {
            put(folder, &format!("inv_k_{rhs}"), &lines(&rows.compliance))?;
        }
    }
    if !all.options.is_empty() {
        put(folder, "options.txt", &format!("{}\n", all.options))?;
    }
    let of = all.friction;
    if of.nodes.is_empty() {
        return Ok(());
    }
    put(folder, "T.mtx", &general(&of.rows.matrix))?;
    let mut laws = String::from("# contact row, coefficient, bound, compliance, slips\n");
    for node in &of.nodes {
        let _ = write!(laws, "{}", node.normal.map_or(0, |row| row + 1));
        let law = [node.coefficient, node.bound, of.rows.compliance[node.first]];
        for x in law.iter().chain(&of.rows.rhs[node.rows()]) {
            let _ = write!(laws, " {x:e}");
        }
        laws.push('\n');
    }
    put(folder, "friction.txt", &laws)
}
