//! The rules of the generator, each on the smallest source that shows it.

use crate::check::first_difference;
use crate::f77;
use crate::order::Section;
use crate::{generate, options, package_version, run};

const VERSION: [u32; 3] = [1, 2, 3];
const HANDLE: &str = "/// A problem.\n#[repr(C)] pub struct feti_problem { _private: [u8; 0] }\n";
const INFO: &str = "#[repr(C)] pub struct feti_info { pub struct_size: i64, pub r#type: i32, \
                    pub function: [c_char; 40], pub name: *const c_char }\n";

fn header_and_module(source: &str) -> Result<[String; 2], String> {
    let mut texts =
        generate(&[("ffi.rs".to_string(), source.to_string())], VERSION)?.into_iter().map(|(_, text)| text);
    Ok([texts.next().unwrap(), texts.next().unwrap()])
}

fn module(source: &str) -> String {
    header_and_module(source).unwrap()[1].clone()
}

fn error(source: &str) -> String {
    header_and_module(source).unwrap_err()
}

/// A function with one argument `x` and its table row.
fn with_argument(ty: &str, direction: &str, shape: &str, rule: &str) -> String {
    format!(
        "{HANDLE}{INFO}/// Does it.\n///\n/// | argument | in/out | shape | rule |\n/// |---|---|---|---|\n\
         /// | `x` | {direction} | {shape} | {rule} |\n\
         #[no_mangle] pub unsafe extern \"C\" fn feti_do(x: {ty}) -> i32 {{ 0 }}"
    )
}

fn assert_dummy(ty: &str, direction: &str, shape: &str, rule: &str, expected: &str) {
    let text = module(&with_argument(ty, direction, shape, rule));
    assert!(text.lines().any(|line| line.trim() == expected), "{ty}: no line `{expected}` in\n{text}");
}

#[test]
fn public_names_that_differ_by_case_only_are_refused() {
    let source =
        "pub const FETI_ACTIVE: i32 = 1;\n#[no_mangle] pub extern \"C\" fn feti_active() -> i32 { 0 }";
    let message = error(source);
    assert!(message.contains("`FETI_ACTIVE` and `feti_active`"), "{message}");
    let with_type = format!("pub const FETI_INFO: i32 = 1;\n{INFO}");
    assert!(error(&with_type).contains("`FETI_INFO` and `feti_info`"));
}

#[test]
fn arguments_that_differ_by_case_only_are_refused() {
    let source = "/// | argument | in/out | shape | rule |\n/// |---|---|---|---|\n/// | r | in | scalar | |\n\
                  /// | R | in | scalar | |\n#[no_mangle] pub extern \"C\" fn feti_do(r: i64, R: i64) -> i32 { 0 }";
    let message = error(source);
    assert!(message.contains("feti_do") && message.contains("`r` and `R`"), "{message}");
}

#[test]
fn a_type_outside_the_list_is_refused_with_function_and_argument() {
    for ty in [
        "usize",
        "bool",
        "*const u8",
        "feti_info",
        "c_char",
        "&f64",
        "*mut feti_other",
        "Option<i32>",
        "[f64; 3]",
    ] {
        let message = error(&with_argument(ty, "in", "scalar", ""));
        assert!(
            message.contains("`feti_do`, argument `x`") && message.contains("not allowed"),
            "{ty}: {message}"
        );
    }
    let message = error("#[no_mangle] pub extern \"C\" fn feti_do() -> *mut f64 { todo!() }");
    assert!(message.contains("`feti_do`: result type `*mut f64`"), "{message}");
    let message = error("#[repr(C)] pub struct feti_info { pub ok: bool }");
    assert!(message.contains("`feti_info`, field `ok`"), "{message}");
}

#[test]
fn numbers_go_by_value_and_handles_as_c_ptr() {
    assert_dummy("i32", "in", "scalar", "", "integer(c_int32_t), value :: x");
    assert_dummy("f64", "in", "scalar", "", "real(c_double), value :: x");
    assert_dummy("*mut feti_problem", "in", "scalar", "NULL: HANDLE", "type(c_ptr), value :: x");
    assert_dummy("*mut *mut feti_problem", "in/out", "scalar", "", "type(c_ptr), intent(inout) :: x");
}

#[test]
fn shape_decides_between_a_scalar_and_an_array() {
    assert_dummy("*mut i64", "out", "scalar", "", "integer(c_int64_t), intent(out) :: x");
    assert_dummy("*mut i64", "in/out", "scalar", "", "integer(c_int64_t), intent(inout) :: x");
    assert_dummy("*const f64", "in", "`ld * n`", "", "real(c_double), intent(in) :: x(*)");
    assert_dummy("*const c_char", "in", "text", "", "character(kind=c_char), intent(in) :: x(*)");
    assert_dummy("*mut feti_info", "out", "scalar", "", "type(feti_info), intent(inout) :: x");
}

#[test]
fn a_pointer_that_may_be_null_is_a_c_ptr() {
    for ty in ["*const f64", "*mut i64", "*mut feti_info", "*mut c_char"] {
        let direction = if ty.starts_with("*mut") { "out" } else { "in" };
        assert_dummy(ty, direction, "scalar", "may be NULL", "type(c_ptr), value :: x");
        let without = module(&with_argument(ty, direction, "scalar", "FETI_NULL_SPACE"));
        assert!(!without.contains("type(c_ptr), value :: x"), "{ty}");
    }
}

#[test]
fn an_argument_without_a_row_or_against_its_direction_is_refused() {
    let missing = with_argument("i32", "in", "scalar", "").replace("`x`", "`y`");
    assert!(error(&missing).contains("argument `x`: no row"));
    assert!(error(&with_argument("*const f64", "out", "n", "")).contains("documented as written"));
    assert!(error(&with_argument("*mut f64", "in", "n", "")).contains("documented as read"));
}

/// A callback type with this result, and a function that takes it with its user data.
fn with_callback(ty: &str) -> String {
    let rows = "/// | argument | in/out | shape | rule |\n/// |---|---|---|---|\n";
    format!(
        "{INFO}/// Hears.\n///\n{rows}/// | `user` | in | scalar | may be NULL |\n/// | `now` | in | scalar | valid here |\n\
         pub type feti_hear_fn = {ty};\n\
         /// Tells.\n///\n{rows}/// | `callback` | in | scalar | NULL: none |\n/// | `user` | in | scalar | |\n\
         #[no_mangle] pub unsafe extern \"C\" fn feti_tell(callback: feti_hear_fn, user: *mut c_void) -> i32 {{ 0 }}"
    )
}

#[test]
fn a_callback_is_a_function_pointer_in_c_and_an_abstract_interface_in_fortran() {
    let ty = "Option<unsafe extern \"C\" fn(user: *mut c_void, now: *const feti_info) -> i32>";
    let [header, module] = header_and_module(&with_callback(ty)).unwrap();
    assert!(
        header.contains("typedef int32_t (*feti_hear_fn)(void *user, const feti_info *now);"),
        "{header}"
    );
    assert!(header.contains("int32_t feti_tell(feti_hear_fn callback, void *user);"), "{header}");
    for line in [
        "integer(c_int32_t) function feti_hear_fn(user, now) bind(C)",
        "type(c_ptr), value :: user",
        "type(feti_info), intent(in) :: now",
        "type(c_funptr), value :: callback",
    ] {
        assert!(module.lines().any(|found| found.trim() == line), "no line `{line}` in\n{module}");
    }
    assert!(module.contains("only: c_char, c_double, c_funptr, c_int32_t"), "{module}");
}

#[test]
fn a_callback_that_hosts_cannot_write_is_refused() {
    for ty in [
        "Option<extern \"C\" fn(user: *mut c_void, now: *const feti_info) -> i32>",
        "Option<unsafe fn(user: *mut c_void, now: *const feti_info) -> i32>",
        "unsafe extern \"C\" fn(user: *mut c_void, now: *const feti_info) -> i32",
        "*mut c_void",
    ] {
        assert!(error(&with_callback(ty)).contains("type `feti_hear_fn`"), "{ty}");
    }
    let of = |arguments: &str, result: &str| {
        error(&with_callback(&format!("Option<unsafe extern \"C\" fn({arguments}) -> {result}>")))
    };
    assert!(of("user: *mut c_void, now: *const feti_info", "f64").contains("a callback returns i32"));
    assert!(of("*mut c_void, now: *const feti_info", "i32").contains("has no plain name"));
    assert!(of("user: *mut c_void, now: bool", "i32").contains("argument `now`"));
    assert!(of("user: *const c_void, now: *const feti_info", "i32").contains("argument `user`"));
}

#[test]
fn functions_must_be_exported_and_visible() {
    let hidden = "#[no_mangle] extern \"C\" fn feti_do() -> i32 { 0 }";
    assert!(error(hidden).contains("without pub extern"));
    let forgotten = "pub extern \"C\" fn feti_do() -> i32 { 0 }";
    assert!(error(forgotten).contains("without #[no_mangle]"));
    for hidden in
        ["make! { #[no_mangle] pub extern \"C\" fn feti_do() {} }", "mod m { #[no_mangle] fn feti_do() {} }"]
    {
        assert!(error(hidden).contains("is not seen"));
    }
    let newer = "#[unsafe(no_mangle)] pub extern \"C\" fn feti_do() -> i32 { 0 }";
    assert!(module(newer).contains("function feti_do() bind(C, name=\"feti_do\")"));
}

#[test]
fn handles_are_incomplete_in_c_and_structs_complete() {
    let [header, module] =
        header_and_module(&with_argument("*mut feti_problem", "in", "scalar", "")).unwrap();
    assert!(header.contains("typedef struct feti_problem feti_problem;"), "{header}");
    assert!(header.contains("int32_t feti_do(feti_problem *x);"), "{header}");
    for field in ["int32_t type;", "char function[40];", "const char *name;"] {
        assert!(header.contains(field), "{header}");
    }
    for field in
        ["integer(c_int32_t) :: type", "character(kind=c_char) :: function(40)", "type(c_ptr) :: name"]
    {
        assert!(module.contains(field), "{module}");
    }
    assert!(!module.contains(":: feti_problem"), "{module}");
}

#[test]
fn constants_and_version_come_out_in_both_languages() {
    let [header, module] = header_and_module("/// Refused.\npub const FETI_ARGUMENT: i32 = -100;").unwrap();
    assert!(
        header.contains("#define FETI_ARGUMENT -100")
            && header.contains("#define FETI_CONTACT_VERSION_MINOR 2")
    );
    assert!(
        module.contains("FETI_ARGUMENT = -100_c_int32_t")
            && module.contains("FETI_CONTACT_VERSION_PATCH = 3_c")
    );
    let manifest =
        "[workspace.package]\nname = \"x\"\nversion = \"10.2.3\"\n[dependencies]\nversion = \"9.9.9\"\n";
    assert_eq!(package_version(manifest), Some([10, 2, 3]));
    assert_eq!(package_version("[package]\nname = \"x\"\n[dependencies]\nversion = \"9.9.9\"\n"), None);
}

#[test]
fn documentation_reaches_both_outputs_within_the_fortran_line() {
    let rule = "word ".repeat(60);
    let [header, module] = header_and_module(&with_argument("i32", "in", "scalar", &rule)).unwrap();
    assert!(header.contains(" * Does it.") && header.contains(" * @param x word"), "{header}");
    assert!(module.contains("!> Does it."), "{module}");
    assert!(module.lines().all(|line| line.len() <= 132));
}

#[test]
fn drift_is_named_by_file_and_line() {
    let message = first_difference("a.h", "one\ntwo\n", "one\n2\n").unwrap();
    assert_eq!(message, "a.h:2: committed \"two\", generated \"2\"");
    assert!(first_difference("a.h", "one\n", "one\ntwo\n").unwrap().starts_with("a.h:2:"));
    assert!(first_difference("a.h", "", "one\n").is_some());
    assert_eq!(first_difference("a.h", "one\n", "one\n"), None);
}

#[test]
fn check_passes_after_writing_and_fails_after_an_edit() {
    let root = std::env::temp_dir().join(format!("feti_bindgen_root_{}", std::process::id()));
    let source = root.join("c/src");
    std::fs::create_dir_all(&source).unwrap();
    std::fs::write(root.join("Cargo.toml"), "[workspace.package]\nversion = \"0.1.0\"\n").unwrap();
    std::fs::write(source.join("a.rs"), with_argument("i32", "in", "scalar", "")).unwrap();
    let call = |check: &[&str]| {
        let root = ["--root", root.to_str().unwrap()];
        let sections =
            [Section { heading: "All", says: "", names: &["feti_problem", "feti_info", "feti_do"] }];
        run(&options(root.iter().chain(check).map(|s| s.to_string())).unwrap(), &sections)
    };
    assert!(call(&["--check"]).unwrap_err().contains("include/feti_contact.h:1:"));
    call(&[]).unwrap();
    call(&["--check"]).unwrap();
    std::fs::write(source.join("a.rs"), with_argument("i64", "in", "scalar", "")).unwrap();
    let message = call(&["--check"]).unwrap_err();
    assert!(message.contains("include/feti_contact.h:") && message.contains("int64_t x"), "{message}");
    assert!(message.contains("include/fortran/feti_contact_c.f90:"), "{message}");
    std::fs::remove_dir_all(&root).unwrap();
}

#[test]
fn the_header_shows_problem_rules_example_and_contents_before_the_declarations() {
    let functions = ["feti_solve", "feti_body_stiffness_i64", "feti_body_stiffness_i32", "feti_body_add"]
        .map(|name| format!("#[no_mangle] pub extern \"C\" fn {name}() -> i32 {{ 0 }}"));
    let [header, module] = header_and_module(&(HANDLE.to_string() + &functions.join("\n"))).unwrap();
    let (before, declarations) = header.split_once("#include <stdint.h>").unwrap();
    for line in
        [" * @code\n", " * int main(void)\n", " * @endcode\n", " * Bodies: Give each body", "B u <= c"]
    {
        assert!(before.contains(line), "no `{line}` in\n{before}");
    }
    for [text, call] in [[declarations, "("], [&module, "() bind(C"]] {
        let places = [
            "Problem ===",
            "Bodies ===",
            "feti_body_add",
            "stiffness_i32",
            "stiffness_i64",
            "Solve ===",
            "feti_solve",
        ]
        .map(|name| {
            let wanted = if name.ends_with('=') { name.to_string() } else { format!("{name}{call}") };
            text.find(&wanted).unwrap_or_else(|| panic!("no `{wanted}` in\n{text}"))
        });
        assert!(places.is_sorted(), "{places:?} in\n{text}");
    }
}

fn subroutines(function: &str) -> String {
    let head = "/// A problem.\n#[repr(C)] pub struct feti_problem { _private: [u8; 0] }\n";
    f77::print(&crate::checked(&[("a.rs".to_string(), format!("{head}{function}"))], [0, 1, 0]).unwrap())
}

#[test]
fn integers_are_converted_and_numbers_count_from_one() {
    let text = subroutines(
        "/// Adds.\n///\n/// | argument | in/out | shape | rule |\n/// |---|---|---|---|\n/// | p | in | scalar | |\n\
         /// | n | in | scalar | |\n/// | body | out | scalar | |\n\
         #[no_mangle] pub unsafe extern \"C\" fn feti_body_add(p: *mut feti_problem, n: i64, body: *mut i64) -> i32 { 0 }",
    );
    for line in [
        "!> Adds. C: feti_body_add.",
        "recursive subroutine ftbadd(ip, n, ibody, ierr)",
        "  integer, intent(in) :: ip, n",
        "  ierr = told(feti_body_add(handle(ip), wide(n), body))",
        "  if (ierr == FETI_OK) call fit(body + 1, ibody, ierr)",
    ] {
        assert!(text.lines().any(|found| found == line), "no `{line}` in\n{text}");
    }
}

#[test]
fn an_argument_that_the_host_does_not_give_moves_the_places_of_the_others() {
    let rows: String = ["p", "body", "n", "row_ptr", "col", "val", "base", "storage", "flags"]
        .map(|name| {
            let shape = if ["row_ptr", "col", "val"].contains(&name) { "n" } else { "scalar" };
            format!("    /// | {name} | in | {shape} | |\n")
        })
        .concat();
    let text = subroutines(&format!(
        "twins! {{\n    /// Gives K.\n    ///\n    /// | argument | in/out | shape | rule |\n    /// |---|---|---|---|\n{rows}\
         fn feti_body_stiffness_i32, feti_body_stiffness_i64(p: *mut feti_problem, body: i64, n: i64, row_ptr: *const I, \
         col: *const I, val: *const f64, base: i32, storage: i32, flags: i32) |call| {{ 0 }} }}"
    ));
    let call = text.replace(" &\n   ", "");
    assert!(call.contains("1_c_int32_t, narrow(istor), FETI_COPY), [1, 2, 3, 4, 5, 6, 0, 7, 0])"), "{text}");
}

#[test]
fn a_page_has_the_statements_that_call_its_function() {
    let calls = f77::calls();
    assert_eq!(calls["feti_last_error"], ["CALL FTERR(IERR, TEXT)"]);
    assert_eq!(calls["feti_friction_law"].len(), 2);
    assert_eq!(calls["feti_body_numbering_i64"], ["CALL FTBNUM(IP, IBODY, N, INUM, IERR)"]);
}

/// A file generated for one function of C: `feti_rows_rhs` with these arguments and rows of its table.
fn of_rows(file: &str) -> String {
    let source = format!(
        "{HANDLE}/// Replaces right-hand sides.\n///\n/// | argument | in/out | shape | rule |\n/// |---|---|---|---|\n\
         /// | p | in | scalar | the handle |\n/// | kind | in | scalar | FETI_EQUALITY |\n/// | first | in | scalar | first row, from 0 |\n\
         /// | rows | in | scalar | number of rows |\n/// | rhs | in | rows | c or h, length |\n\
         #[no_mangle] pub unsafe extern \"C\" fn feti_rows_rhs(p: *mut feti_problem, kind: i32, first: i64, rows: i64, \
         rhs: *const f64) -> i32 {{ 0 }}"
    );
    let texts = generate(&[("rows.rs".to_string(), source)], VERSION).unwrap();
    texts.into_iter().find(|(path, _)| path.ends_with(file)).unwrap().1
}

#[test]
fn a_typed_procedure_counts_from_one_and_takes_sizes_from_arrays() {
    let text = of_rows("feti_contact_rows.f90");
    for line in [
        "  public :: rows_rhs",
        "  !> Replaces right-hand sides. kind: FETI_EQUALITY. first: first row, from 1. rhs(rows): c or h, length.",
        "  recursive subroutine rows_rhs(p, kind, first, rhs, stat, errmsg)",
        "    real(real64), intent(in), contiguous :: rhs(:)",
    ] {
        assert!(text.lines().any(|found| found == line), "no `{line}` in\n{text}");
    }
    let call = text.replace(" &\n      ", " ");
    let expected =
        "feti_rows_rhs(handle_of(p), kind, int(first - 1, c_int64_t), size(rhs, kind=c_int64_t), rhs)";
    assert!(call.contains(expected), "{text}");
}

#[test]
fn the_python_module_has_texts_pointers_and_numbers_as_ctypes_passes_them() {
    let (c, mut text) = (with_argument("*const c_char", "in", "text", "a name"), String::new());
    for (path, generated) in generate(&[("ffi.rs".to_string(), c)], VERSION).unwrap() {
        if path.ends_with("_raw.py") {
            text = generated;
        }
    }
    for line in [
        "    \"feti_do\": (c_int32, [c_char_p]),",
        "class feti_info(Structure):",
        "        (\"type\", c_int32),",
        "        (\"function\", c_char * 40),",
    ] {
        assert!(text.lines().any(|found| found == line), "no `{line}` in\n{text}");
    }
}

#[test]
fn a_method_of_python_has_words_defaults_and_lengths_from_the_shapes_of_arrays() {
    let expected = "
    def set_rhs(self, kind: str, rhs: Any, first: int = 0) -> None:
        \"\"\"Replaces c or h of rows from `first` on. kind: \"contact\" or \"equality\".\"\"\"
        rhs = numbers(rhs, \"rhs\", (None,))
        call(\"rows_rhs\", self._handle, one_of(KINDS, kind, \"kind\"), first, rhs.size, rhs)
";
    let text = of_rows("_methods.py");
    assert!(text.contains(expected), "{text}");
}
