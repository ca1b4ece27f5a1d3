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
        Type::Array(of, n) => format!("{}[{n}]", declared(of, name)),
        Type::Pointer { .. } => format!("{}{name}", spelled(ty)),
        _ => format!("{} {name}", spelled(ty)),
    }
}

/// `int32_t feti_gaps(feti_problem *p, int64_t rows, double *slack)`, broken between arguments where it would pass `width`.
pub fn prototype(function: &Function, width: usize) -> String {
    let arguments: Vec<_> = function.arguments.iter().map(|a| declared(&a.ty, &a.name)).collect();
    let head = format!("{}(", declared(&function.result, &function.name));
    if arguments.is_empty() {
        return format!("{head}void)");
    }
    let (mut out, mut line) = (String::new(), head.clone());
    for (k, argument) in arguments.iter().enumerate() {
        let end = if k + 1 < arguments.len() { "," } else { ")" };
        if k > 0 && line.len() + argument.len() + 3 > width {
            out.push_str(&line);
            line = format!("\n{}", " ".repeat(head.len()));
        } else if k > 0 {
            line.push(' ');
        }
        line.push_str(argument);
        line.push_str(end);
    }
    out + &line
}
