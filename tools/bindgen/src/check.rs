//! What both languages demand of an interface, checked before anything is printed, and the comparison with committed files.

use std::collections::HashMap;

use crate::doc::Direction;
use crate::model::{Api, Argument, Field, Type};

/// Longest name of Fortran 2003.
const LONGEST_NAME: usize = 63;

/// Types by position, names without case clashes and short enough for Fortran.
pub fn check(api: &Api) -> Result<(), String> {
    public_names(api)?;
    for function in &api.functions {
        signature(api, &function.name, &function.arguments)?;
        let is_text = matches!(&function.result, Type::Pointer { mutable: false, to } if **to == Type::Char);
        if !function.result.is_number() && !is_text {
            return Err(format!(
                "function `{}`: result type `{}` is not allowed",
                function.name, function.result
            ));
        }
    }
    for callback in &api.callbacks {
        signature(api, &callback.name, &callback.arguments)?;
        if !matches!(callback.result, Type::I32 | Type::Void) {
            return Err(format!(
                "type `{}`: a callback returns i32 or nothing, not {}",
                callback.name, callback.result
            ));
        }
    }
    for structure in &api.structs {
        let fields = structure.fields.as_deref().unwrap_or(&[]);
        for field in fields {
            field_type(api, &structure.name, field)?;
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
    let callbacks = api.callbacks.iter().map(|c| c.name.as_str());
    let functions = api.functions.iter().map(|f| f.name.as_str());
    let names = constants.chain(versions).chain(structs).chain(callbacks).chain(functions);
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

/// Names and types of the arguments of function or callback `name`.
fn signature(api: &Api, name: &str, arguments: &[Argument]) -> Result<(), String> {
    for argument in arguments {
        let place = format!("function `{name}`, argument `{}`", argument.name);
        if !is_argument_type(api, argument) {
            return Err(format!("{place}: type `{}` is not allowed", argument.ty));
        }
        let target = argument.ty.target();
        let handed_on = target.is_some_and(|target| api.is_opaque(target) || *target == Type::Void);
        if argument.direction() == Direction::In && argument.ty.is_mutable_pointer() && !handed_on {
            return Err(format!("{place}: documented as read, but its type is {}", argument.ty));
        }
    }
    let names = arguments.iter().map(|a| a.name.as_str());
    distinct_names(names, &format!("function `{name}`: arguments"))
}

/// A number or a callback by value, a pointer to void (constant for an array of bytes), or one or two pointers to a number, a character or a declared
/// struct.
fn is_argument_type(api: &Api, argument: &Argument) -> bool {
    let is_target = |ty: &Type| match ty {
        Type::Named(name) => api.find_struct(name).is_some(),
        Type::Void | Type::Pointer { .. } | Type::Array(..) => false,
        _ => true,
    };
    match &argument.ty {
        Type::Pointer { mutable, to } if **to == Type::Void => *mutable || !argument.is_scalar(),
        Type::Pointer { to, .. } => is_target(to.target().unwrap_or(to)),
        ty => ty.is_number() || api.is_callback(ty),
    }
}

/// A number, an array of numbers, characters or pointers to void, a pointer to one of them, or a callback.
fn field_type(api: &Api, owner: &str, field: &Field) -> Result<(), String> {
    let is_address = |ty: &Type| matches!(ty, Type::Pointer { mutable: true, to } if **to == Type::Void);
    let allowed = match &field.ty {
        Type::Array(of, n) => *n > 0 && (of.is_number() || **of == Type::Char || is_address(of)),
        Type::Pointer { to, .. } => to.is_number() || **to == Type::Char || is_address(&field.ty),
        ty => ty.is_number() || api.is_callback(ty),
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
