//! Types and declarations as C spells them, for the test programs and the reference pages.

use crate::model::{Function, Type};

/// `const double *`, `int64_t`, `feti_info`.
pub fn spelled(ty: &Type) -> String {
    match ty {
        Type::I32 => "int32_t".to_string(),
        Type::I64 => "int64_t".to_string(),
        Type::F64 => "double".to_string(),
        Type::Char => "char".to_string(),
        Type::Void => "void".to_string(),
        Type::Named(name) => name.clone(),
        Type::Array(of, n) => format!("{}[{n}]", spelled(of)),
        Type::Pointer { mutable, to } => {
            let star = if to.target().is_some() { "*" } else { " *" };
            format!("{}{}{star}", if *mutable { "" } else { "const " }, spelled(to))
        }
    }
}

/// `const double *f`, `int64_t n`, `char function[40]`.
pub fn declared(ty: &Type, name: &str) -> String {
    match ty {
        Type::Array(of, n) => format!("{} {name}[{n}]", spelled(of)),
        Type::Pointer { .. } => format!("{}{name}", spelled(ty)),
        _ => format!("{} {name}", spelled(ty)),
    }
}

/// `int32_t feti_gaps(feti_problem *p, int64_t rows, double *slack)`; one argument a line where it would pass `width`.
pub fn prototype(function: &Function, width: usize) -> String {
    let arguments: Vec<_> = function.arguments.iter().map(|a| declared(&a.ty, &a.name)).collect();
    let head = format!("{}(", declared(&function.result, &function.name));
    if arguments.is_empty() {
        return format!("{head}void)");
    }
    let line = format!("{head}{})", arguments.join(", "));
    if line.len() <= width {
        return line;
    }
    format!("{head}{})", arguments.join(&format!(",\n{}", " ".repeat(head.len()))))
}
