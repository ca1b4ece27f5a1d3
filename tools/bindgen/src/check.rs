//! What both languages demand of an interface, checked before anything is printed, and the comparison with committed files.

use std::collections::HashMap;

use crate::doc::Direction;
use crate::model::{Api, Argument, Field, Function, Type};

/// Longest name of Fortran 2003.
const LONGEST_NAME: usize = 63;

/// Types by position, names without case clashes and short enough for Fortran.
pub fn check(api: &Api) -> Result<(), String> {
    public_names(api)?;
    for function in &api.functions {
        function_types(api, function)?;
        let names = function.arguments.iter().map(|a| a.name.as_str());
        distinct_names(names, &format!("function `{}`: arguments", function.name))?;
    }
    for structure in &api.structs {
        let fields = structure.fields.as_deref().unwrap_or(&[]);
        for field in fields {
            field_type(&structure.name, field)?;
        }
        distinct_names(
            fields.iter().map(|f| f.name.as_str()),
            &format!("struct `{}`: fields", structure.name),
        )?;
    }
    Ok(())
}

fn public_names(api: &Api) -> Result<(), String> {
    let constants = api.constants.iter().map(|c| c.name.as_str());
    let versions = api.version_constants().map(|(name, _)| name);
    let structs = api.structs.iter().map(|s| s.name.as_str());
    let functions = api.functions.iter().map(|f| f.name.as_str());
    let names = constants.chain(versions).chain(structs).chain(functions);
    distinct_names(names.chain([crate::fortran::MODULE]), "public names")
}

/// Fortran does not see case: two names that differ only by it are one name there.
fn distinct_names<'a>(names: impl Iterator<Item = &'a str>, what: &str) -> Result<(), String> {
    let mut seen: HashMap<String, &str> = HashMap::new();
    for name in names {
        if name.len() > LONGEST_NAME || !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
            return Err(format!(
                "{what}: `{name}` is no Fortran name (a letter first, at most {LONGEST_NAME} characters)"
            ));
        }
        if let Some(other) = seen.insert(name.to_ascii_lowercase(), name) {
            return Err(format!(
                "{what}: `{other}` and `{name}` are one name in Fortran, which does not see case"
            ));
        }
    }
    Ok(())
}

fn function_types(api: &Api, function: &Function) -> Result<(), String> {
    for argument in &function.arguments {
        if !is_argument_type(api, argument) {
            return Err(format!(
                "function `{}`, argument `{}`: type `{}` is not allowed",
                function.name, argument.name, argument.ty
            ));
        }
        let handle = argument.ty.target().is_some_and(|target| api.is_opaque(target));
        if argument.direction() == Direction::In && argument.ty.is_mutable_pointer() && !handle {
            return Err(format!(
                "function `{}`, argument `{}`: documented as read, but its type is {}",
                function.name, argument.name, argument.ty
            ));
        }
    }
    let result = &function.result;
    let is_text = matches!(result, Type::Pointer { mutable: false, to } if **to == Type::Char);
    if result.is_number() || is_text {
        return Ok(());
    }
    Err(format!("function `{}`: result type `{result}` is not allowed", function.name))
}

/// A number by value, or one or two pointers to a number, a character or a declared struct.
fn is_argument_type(api: &Api, argument: &Argument) -> bool {
    let is_target = |ty: &Type| match ty {
        Type::Struct(name) => api.find_struct(name).is_some(),
        Type::Pointer { .. } | Type::Array(..) => false,
        _ => true,
    };
    match &argument.ty {
        Type::Pointer { to, .. } => is_target(to.target().unwrap_or(to)),
        ty => ty.is_number(),
    }
}

/// A number, an array of numbers or characters, or a pointer to one of them.
fn field_type(owner: &str, field: &Field) -> Result<(), String> {
    let allowed = match &field.ty {
        Type::Array(of, n) => *n > 0 && (of.is_number() || **of == Type::Char),
        Type::Pointer { to, .. } => to.is_number() || **to == Type::Char,
        ty => ty.is_number(),
    };
    if allowed {
        return Ok(());
    }
    Err(format!("struct `{owner}`, field `{}`: type `{}` is not allowed", field.name, field.ty))
}

/// The first line in which a committed file and the generated text differ.
pub fn first_difference(name: &str, committed: &str, generated: &str) -> Option<String> {
    if committed == generated {
        return None;
    }
    let mut old = committed.split('\n');
    let mut new = generated.split('\n');
    let mut line = 1;
    loop {
        let (a, b) = (old.next(), new.next());
        if a != b {
            let shown = |text: Option<&str>| text.map_or("end of file".to_string(), |t| format!("\"{t}\""));
            return Some(format!("{name}:{line}: committed {}, generated {}", shown(a), shown(b)));
        }
        line += 1;
    }
}
