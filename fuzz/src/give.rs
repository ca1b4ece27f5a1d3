//! The calls that change a problem.

use std::ffi::{c_char, c_void, CString};

use feti_contact_c::*;

use super::buffers::Out;
use super::host::{Host, KINDS, LARGEST};
use super::listeners::Watcher;
use super::models::{self, Model};

/// Adds a body like `model` and returns its number.
pub fn body(host: &mut Host, model: Model) -> Option<usize> {
    let mut number = Out::<i64>::new(1);
    let huge = if host.turn() {
        [0, -1, i64::MIN, i64::MAX, (1 << 60) - 1, 1 << 40][host.bytes.below(6)]
    } else {
        0
    };
    let n = if huge == 0 { model.n as i64 } else { huge };
    // SAFETY: room for one number.
    let status = unsafe { feti_body_add(host.handle(), n, host.out(&mut number)) };
    if !host.done(status, &[&number]) {
        return None;
    }
    host.changed();
    assert_eq!(number.cells[0], host.bodies.len() as i64);
    host.bodies.push(Model { n: n as usize, ..model });
    host.lent.push(Default::default());
    Some(host.bodies.len() - 1)
}

/// A matrix of one of several kinds with `n` unknowns.
pub fn some_model(host: &mut Host) -> Model {
    let (kind, n) = (host.bytes.below(8), 1 + host.bytes.below(6));
    match kind {
        0 | 1 => models::chain(&mut host.bytes, n, 0.0),
        2 | 3 => models::chain(&mut host.bytes, n, 2.0),
        4 => models::definite(&mut host.bytes, n),
        5 => models::grid(1 + n % 3, 1),
        6 => models::grounded_grid(1, 1 + n % 2, 1.0),
        _ => models::any(&mut host.bytes, n),
    }
}

/// A body that can be filled; the host's model of it is left in the list.
pub fn pick(host: &mut Host) -> Option<usize> {
    let count = host.bodies.len();
    let body = host.bytes.below(count);
    (body < count && host.bodies[body].n <= LARGEST).then_some(body)
}

/// Spoils an index array but for its last entry, which may only fall: the library believes it.
pub fn spoil_indices(host: &mut Host, indices: &mut [i64], last_is_length: bool) {
    if indices.is_empty() || !host.turn() {
        return;
    }
    let at = host.bytes.below(indices.len());
    let new = [-1, 0, indices[at] + 1, indices[at] - 1, i64::from(i32::MAX), i64::from(i32::MIN)]
        [host.bytes.below(6)];
    let length = last_is_length && at + 1 == indices.len();
    indices[at] = if length { new.min(indices[at]) } else { new };
}

pub fn narrow(wide: &[i64]) -> Vec<i32> {
    wide.iter().map(|value| *value as i32).collect()
}

/// The null space of a body as its model has it, exactly or among candidates.
pub fn null_space(host: &mut Host, body: usize) {
    let model = host.bodies[body].clone();
    let (n, ld) = (model.n, model.n + host.bytes.below(2));
    let flags = if host.bytes.chance(64) { FETI_CANDIDATES } else { FETI_EXACT };
    let extra = if flags == FETI_CANDIDATES { host.numbers(n) } else { Vec::new() };
    let columns: Vec<f64> = model.modes.iter().chain(&extra).copied().collect();
    let r = columns.len() / n;
    let mut basis = vec![0.0; ld * r];
    (0..n * r).for_each(|at| basis[at % n + at / n * ld] = columns[at]);
    if host.turn() && r > 0 {
        let at = host.bytes.below(n * r);
        basis[at] = host.bytes.wild();
    }
    let (p, body, r, n) = (host.handle(), host.known(body), host.length(r), host.known(n));
    // SAFETY: basis holds ld * r numbers.
    let status =
        unsafe { feti_body_null_space(p, body, r, n, host.array(&basis), host.length(ld), host.code(flags)) };
    if host.done(status, &[]) {
        host.changed();
    }
}

pub fn coordinates(host: &mut Host, body: usize) {
    let model = host.bodies[body].clone();
    let n = model.n;
    let xy: Vec<f64> = if model.xy.is_empty() { host.numbers(2 * n) } else { model.xy.clone() };
    let node: Vec<i32> = (0..n).map(|i| (i / model.per_node.max(1)) as i32).collect();
    let mut dir: Vec<i32> = (0..n).map(|i| (i % model.per_node.max(1)) as i32 + 1).collect();
    if host.turn() {
        let at = host.bytes.below(n);
        dir[at] = i32::from(host.bytes.byte() as i8);
    }
    let (p, body, dim) = (host.handle(), host.known(body), host.code(2).min(2));
    let (n, node, dir) = (host.known(n), host.array(&node), host.array(&dir));
    // SAFETY: two coordinates of each unknown; a spoilt dimension or ld is smaller or refused.
    let status =
        unsafe { feti_body_coordinates(p, body, dim, n, node, dir, host.array(&xy), host.length(2)) };
    if host.done(status, &[]) {
        host.changed();
    }
    if host.bytes.chance(64) {
        let flags = if host.bytes.chance(128) { FETI_SOFT } else { FETI_CANDIDATES };
        let status = feti_body_coordinates_flags(host.handle(), body, host.code(flags));
        if host.done(status, &[]) {
            host.changed();
        }
    }
}

/// The load of a body: `f`, or any numbers.
pub fn load(host: &mut Host, body: usize, f: Option<Vec<f64>>) {
    let n = host.bodies[body].n;
    let f = f.unwrap_or_else(|| host.numbers(n));
    let (p, body, n) = (host.handle(), host.known(body), host.known(n));
    // SAFETY: n numbers.
    let status = unsafe { feti_body_load(p, body, n, host.array(&f)) };
    host.done(status, &[]);
    host.changed();
}

/// A row of B or H: entries as (body, dof, value), and its right-hand side.
pub type Row = (Vec<(usize, usize, f64)>, f64);

/// Any rows over the bodies that are there.
pub fn some_rows(host: &mut Host) -> Vec<Row> {
    let entry = |host: &mut Host| {
        let body = pick(host)?;
        Some((body, host.bytes.below(host.bodies[body].n), host.bytes.number()))
    };
    let count = host.bytes.below(4);
    let row = |host: &mut Host| {
        let entries = 1 + host.bytes.below(3);
        ((0..entries).filter_map(|_| entry(host)).collect(), host.bytes.number())
    };
    (0..count).map(|_| row(host)).collect()
}

/// Adds rows; bodies by number, or numbers of unknowns that count through all bodies.
pub fn rows(host: &mut Host, kind: usize, rows: &[Row]) {
    let form = host.bytes.byte();
    let (base, concatenated) = (i64::from(form & 1), form >> 1 & 3 == 3);
    let start = |body: usize| host.bodies[..body].iter().map(|b| b.n as i64).fold(0, i64::wrapping_add);
    let (mut pointer, mut body, mut dof, mut value) = (vec![base], Vec::new(), Vec::new(), Vec::new());
    for (entries, _) in rows {
        for &(b, d, v) in entries {
            body.push(b as i64 + base);
            dof.push((if concatenated { start(b) } else { 0 }).wrapping_add(d as i64 + base));
            value.push(v);
        }
        pointer.push(dof.len() as i64 + base);
    }
    let mut right: Vec<f64> = rows.iter().map(|row| row.1).collect();
    for wild in [&mut value, &mut right] {
        if !wild.is_empty() && host.turn() {
            let at = host.bytes.below(wild.len());
            wild[at] = host.bytes.wild();
        }
    }
    spoil_indices(host, &mut pointer, true);
    spoil_indices(host, &mut body, false);
    spoil_indices(host, &mut dof, false);
    let status = add(host, kind, form, [&pointer, &body, &dof], &value, &right);
    if status >= 0 {
        host.changed();
    }
}

fn add(host: &mut Host, kind: usize, form: u8, indices: [&[i64]; 3], value: &[f64], right: &[f64]) -> i32 {
    let mut first = Out::<i64>::new(1);
    let (base, concatenated) = (i32::from(form & 1), form >> 1 & 3 == 3);
    let (p, code, count) = (host.handle(), host.code(KINDS[kind]), host.length(right.len()));
    let (value, base, right_at) = (host.array(value), host.code(base), host.array(right));
    // SAFETY: the last pointer is at most the number of entries.
    let status = unsafe {
        if form >> 3 & 1 == 0 {
            let wide: Vec<*const i64> = indices.iter().map(|array| host.array(array)).collect();
            let body = if concatenated { std::ptr::null() } else { wide[1] };
            feti_rows_add_i64(
                p,
                code,
                count,
                wide[0],
                body,
                wide[2],
                value,
                base,
                right_at,
                host.out(&mut first),
            )
        } else {
            let narrow = indices.map(narrow);
            let at: Vec<*const i32> = narrow.iter().map(|array| host.array(array)).collect();
            let body = if concatenated { std::ptr::null() } else { at[1] };
            feti_rows_add_i32(p, code, count, at[0], body, at[2], value, base, right_at, host.out(&mut first))
        }
    };
    if host.done(status, &[&first]) {
        // A spoilt kind may be the other one, a spoilt count one less.
        let kind = KINDS.iter().position(|k| *k == code).expect("an unknown kind was taken");
        host.rows[kind] += usize::try_from(count).expect("a negative count was taken");
    }
    status
}

/// New right-hand sides, or compliances, of some rows.
pub fn row_numbers(host: &mut Host, compliance: bool) {
    let kind = host.bytes.below(2);
    let rows = host.rows[kind];
    let first = host.bytes.below(rows + 1);
    let count = rows - first;
    let mut values = host.numbers(count);
    if compliance {
        values.iter_mut().for_each(|v| *v = if host.bytes.chance(8) { *v } else { v.abs() / 16.0 });
    }
    let (p, code, first) = (host.handle(), host.code(KINDS[kind]), host.length(first));
    let (count, values) = (host.length(count), host.array(&values));
    // A spoilt kind may be the other one, with other rows: their numbers are not the host's to know.
    if code != KINDS[kind] && KINDS.contains(&code) {
        return;
    }
    // SAFETY: count numbers.
    let status = unsafe {
        let call = if compliance { feti_rows_compliance } else { feti_rows_rhs };
        call(p, code, first, count, values)
    };
    if host.done(status, &[]) {
        host.changed();
    }
}

pub fn rows_clear(host: &mut Host) {
    let (p, code) = (host.handle(), host.bytes.below(2));
    let code = host.code(KINDS[code]);
    let status = feti_rows_clear(p, code);
    if host.done(status, &[]) {
        let kind = KINDS.iter().position(|k| *k == code).expect("an unknown kind was taken");
        host.rows[kind] = 0;
        if kind == 0 {
            (host.nodes, host.dim) = (0, 0);
        }
        host.changed();
    }
}

/// Start values, or fixing unknowns.
pub fn start(host: &mut Host) {
    let kind = host.bytes.below(2);
    let values = host.numbers(host.rows[kind]);
    let (p, code, rows) = (host.handle(), host.code(KINDS[kind]), host.known(values.len()));
    if code != KINDS[kind] && KINDS.contains(&code) {
        return;
    }
    // SAFETY: as many numbers as rows.
    let status = unsafe { feti_start_from(p, code, rows, host.array(&values)) };
    host.done(status, &[]);
}

pub fn fixing(host: &mut Host, body: usize) {
    let model = &host.bodies[body];
    let (n, r) = (model.n, model.r());
    let dofs: Vec<i64> = (0..r).map(|_| host.bytes.below(n + 1) as i64).collect();
    let (p, body, r) = (host.handle(), host.known(body), host.length(r));
    // SAFETY: r numbers.
    let status = unsafe { feti_body_fixing_set(p, body, r, host.array(&dofs)) };
    if host.done(status, &[]) {
        host.changed();
    }
}

pub fn states(host: &mut Host) {
    let id = host.states.get(host.bytes.below(host.states.len())).map_or(0, |state| state.0 as usize);
    let mut number = Out::<i64>::new(1);
    // SAFETY: room for one number.
    unsafe {
        match host.bytes.below(4) {
            0 | 3 => {
                let status = feti_state_save(host.handle(), host.out(&mut number));
                if host.done(status, &[&number]) {
                    host.states.push((number.cells[0], host.rows, (host.nodes, host.dim)));
                }
            }
            1 => {
                let (p, id) = (host.handle(), host.known(id));
                let status = feti_state_restore(p, id);
                if host.done(status, &[]) {
                    let state = host.states.iter().find(|state| state.0 == id);
                    let state = state.expect("no state with this number was saved");
                    (host.rows, (host.nodes, host.dim)) = (state.1, state.2);
                    host.changed();
                }
            }
            _ => {
                let status = feti_state_drop(host.handle(), host.known(id));
                host.done(status, &[]);
            }
        }
    }
}

/// Hears of progress; other calls on the problem are refused meanwhile.
extern "C" fn watch(user: *mut c_void, now: *const feti_progress) -> i32 {
    // SAFETY: user is the watcher of the host, whose problem is solving; now is valid during the call.
    unsafe {
        let watcher = &mut *user.cast::<Watcher>();
        watcher.calls += 1;
        assert!((*now).struct_size > 0);
        let p = std::ptr::without_provenance_mut(watcher.p);
        assert_eq!(feti_rows_clear(p, FETI_INEQUALITY), FETI_BUSY);
        if watcher.calls <= watcher.until {
            return 0;
        }
        if watcher.verdict == 2 {
            assert_eq!(feti_cancel(p), FETI_OK);
            return 0;
        }
        watcher.verdict
    }
}

pub fn progress(host: &mut Host) {
    *host.watcher = Watcher {
        p: host.p.addr(),
        calls: 0,
        until: host.bytes.below(16) as u64,
        verdict: [0, 0, 1, -1, 2][host.bytes.below(5)],
    };
    let user: *mut Watcher = &mut *host.watcher;
    let function: feti_progress_fn = if host.bytes.chance(64) { None } else { Some(watch) };
    // SAFETY: the watcher stays where it is as long as the host.
    let status = unsafe { feti_on_progress(host.handle(), function, user.cast()) };
    host.done(status, &[]);
    let status = feti_cancel(host.handle());
    host.done(status, &[]);
}

/// Values that end in time.
const WHOLE: [i64; 10] = [0, 1, 2, 3, 5, 50, 1000, -1, i64::MIN, i64::MAX];

/// Sets an option of the list to a value within or beyond its range.
pub fn option(host: &mut Host) {
    // SAFETY: the struct is as large as it says, the texts are static.
    let (option, name) = unsafe {
        let mut option: feti_option = std::mem::zeroed();
        option.struct_size = size_of::<feti_option>() as i64;
        let count = usize::try_from(feti_option_count()).expect("a count");
        assert_eq!(feti_option_at(host.bytes.below(count) as i64, &mut option), FETI_OK);
        (option, std::ffi::CStr::from_ptr(option.name))
    };
    // a file of any name
    let name = if name == c"log_file" { c"log_level" } else { name };
    let name_at = if host.turn() { std::ptr::null() } else { name.as_ptr() };
    let choice = host.bytes.byte();
    let status = match option.r#type {
        FETI_OPTION_F64 => number_option(host, &option, name_at, choice),
        FETI_OPTION_I64 => {
            let mut value = WHOLE[usize::from(choice) % WHOLE.len()];
            if matches!(name.to_bytes(), b"max_steps" | b"paper_outer" | b"threads") && value > 1000 {
                value = 3;
            }
            // SAFETY: a text or NULL.
            let status = unsafe { feti_set_i64(host.handle(), name_at, value) };
            host.injected |= name.to_bytes() == b"fault_injection" && status == FETI_OK && value == 1;
            status
        }
        _ => word_option(host, name_at, choice),
    };
    host.done(status, &[]);
}

fn number_option(host: &mut Host, option: &feti_option, name: *const c_char, choice: u8) -> i32 {
    let (low, high, usual) = (option.minimum, option.maximum, option.default_f64);
    let value = match choice % 8 {
        0 => low,
        1 => high,
        2 => host.bytes.wild(),
        3 => low - 1.0,
        4 => usual * 10.0,
        5 => usual * 0.1,
        _ => usual,
    };
    // A limit of time in between would end a solve anywhere.
    // SAFETY: the names of the list are static texts.
    let timed = unsafe { std::ffi::CStr::from_ptr(option.name) } == c"time_limit";
    let value = if timed && value > 0.0 && value < 1e6 { 0.0 } else { value };
    // SAFETY: a text or NULL.
    unsafe { feti_set_f64(host.handle(), name, value) }
}

fn word_option(host: &mut Host, name: *const c_char, choice: u8) -> i32 {
    const WORDS: [&str; 16] = [
        "automatic",
        "none",
        "lumped",
        "dirichlet",
        "explicit",
        "implicit",
        "proportioning",
        "cold",
        "previous",
        "direct",
        "relative",
        "printed",
        "corrected",
        "paper-feasible",
        "paper-monotone",
        "paper-extrapolating",
    ];
    let word = CString::new(WORDS[usize::from(choice) % WORDS.len()]).expect("no NUL");
    let word = if host.turn() { std::ptr::null() } else { word.as_ptr() };
    // SAFETY: texts or NULL.
    unsafe { feti_set_str(host.handle(), name, word) }
}
