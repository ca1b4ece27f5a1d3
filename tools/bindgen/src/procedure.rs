//! One procedure of the typed Fortran modules.

use std::fmt::Write;

use crate::doc::Direction;
use crate::fortran::{continued, write_doc};
use crate::model::{Api, Argument, Function, Type};
use crate::rules::described;
use crate::statuses::upper;
use crate::typed_table::{counted, Dummy, Entry, Kind};

pub fn dummies(entry: &Entry) -> Vec<&'static str> {
    entry.arguments.iter().map(|token| Dummy::read(token).name).collect()
}

/// The first sentences of a function of C.
pub fn summary(api: &Api, name: &str) -> String {
    api.function(name)
        .doc
        .summary()
        .replace(", with 32-bit indices", "")
        .replace(", with 32-bit integers", "")
}

/// The structs that the procedures take, which hosts declare.
pub fn types(api: &Api, entries: &[Entry]) -> Vec<String> {
    let mut names = Vec::new();
    for argument in entries.iter().flat_map(|entry| &api.function(entry.function).arguments) {
        if let Some(Type::Named(name)) = argument.ty.target().filter(|ty| !api.is_opaque(ty)) {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
    }
    names
}

#[derive(Default)]
struct Parts {
    declared: Vec<(String, String)>,
    before: Vec<String>,
    passed: Vec<String>,
    /// If the call succeeded, and in any case.
    written: Vec<String>,
    after: Vec<String>,
}

pub fn text(api: &Api, entry: &Entry, specific: &str, kind: Option<Kind>) -> String {
    let of_c = api.function(entry.function);
    let dummies: Vec<Dummy> = entry.arguments.iter().map(|token| Dummy::read(token)).collect();
    let mut parts = Parts::default();
    for dummy in &dummies {
        if let Some(argument) = of_c.arguments.iter().find(|a| a.name == dummy.of_c) {
            parts.declare(api, dummy, argument, kind);
        }
    }
    parts.declared.push(("integer, intent(out), optional".to_string(), "stat".to_string()));
    parts.declared.push(("character(len=*), intent(inout), optional".to_string(), "errmsg".to_string()));
    for argument in &of_c.arguments {
        let passed = match dummies.iter().find(|dummy| dummy.of_c == argument.name) {
            Some(dummy) => parts.passed(api, dummy, argument, kind),
            None => not_given(entry, &dummies, of_c, argument),
        };
        parts.passed.push(passed);
    }
    let general = entry.function.strip_suffix("_i32").unwrap_or(entry.function);
    let called = match kind {
        Some(kind) if general != entry.function => format!("{general}_{}", kind.name().replace("int", "i")),
        _ => entry.function.to_string(),
    };
    let call = format!("{called}({})", parts.passed.join(", "));
    let mut out = String::new();
    match (entry.generic == entry.name, kind) {
        (true, _) => {
            let described = described(api, &[entry]).unwrap_or_default();
            write_doc(
                &mut out,
                "  ",
                &[summary(api, entry.function).as_str(), entry.note, &described].join(" "),
            );
        }
        (false, Some(kind)) => write_doc(&mut out, "  ", &format!("{}.", kind.name())),
        (false, None) => write_doc(&mut out, "  ", &upper(entry.note)),
    }
    let names: Vec<_> = dummies.iter().map(|dummy| dummy.name).collect();
    let _ = writeln!(out, "  recursive subroutine {specific}({}, stat, errmsg)", names.join(", "));
    parts.write(&mut out, entry, &call);
    out + "  end subroutine\n"
}

/// An argument of C that follows from the arrays of the host, or is the same in every call.
fn not_given(entry: &Entry, dummies: &[Dummy], of_c: &Function, argument: &Argument) -> String {
    let kind = if argument.ty == Type::I32 { "c_int32_t" } else { "c_int64_t" };
    if let Some((_, value)) = entry.given.iter().find(|(name, _)| *name == argument.name) {
        return if value.starts_with("FETI_") { value.to_string() } else { format!("int({value}, {kind})") };
    }
    let name = argument.name.as_str();
    let arrays = dummies.iter().filter(|dummy| !dummy.shape.is_empty() && !dummy.is_optional);
    let arrays: Vec<_> = arrays
        .filter_map(|dummy| {
            Some((dummy, of_c.arguments.iter().find(|a| a.name == dummy.of_c)?.row.shape.as_str()))
        })
        .collect();
    let found = |sized: &dyn Fn(&Dummy, &str) -> Option<String>| {
        arrays.iter().find_map(|(dummy, shape)| sized(dummy, shape))
    };
    let whole =
        |dummy: &Dummy, shape: &str| (shape == name).then(|| format!("size({}, kind={kind})", dummy.name));
    let side = |dummy: &Dummy, shape: &str| {
        let side = shape.split(" * ").position(|extent| extent == name).filter(|_| dummy.rank() == 2)?;
        Some(format!("size({}, {}, {kind})", dummy.name, side + 1))
    };
    let one_less = |dummy: &Dummy, shape: &str| {
        (shape == format!("{name} + 1")).then(|| format!("size({}, kind={kind}) - 1", dummy.name))
    };
    if let Some(size) = found(&whole).or_else(|| found(&side)).or_else(|| found(&one_less)) {
        return size;
    }
    match name {
        "base" => "1_c_int32_t",
        "flags" => "FETI_COPY",
        "body" if argument.ty == Type::I64 => "FETI_ALL",
        _ => "c_null_ptr",
    }
    .to_string()
}

impl Parts {
    fn local(&mut self, attributes: &str, name: &str) {
        self.declared.push((attributes.to_string(), name.to_string()));
    }

    fn declare(&mut self, api: &Api, dummy: &Dummy, argument: &Argument, kind: Option<Kind>) {
        let optional = if dummy.is_optional { ", optional" } else { "" };
        let input = argument.direction() == Direction::In;
        let intent = match () {
            () if input => "in",
            () if dummy.is_optional && argument.is_scalar() && argument.direction() == Direction::Out => {
                "out"
            }
            () if dummy.is_zero_after_failure => "out",
            () => "inout",
        };
        let target = if argument.is_nullable()
            && (!argument.is_scalar() || argument.direction() == Direction::InOut)
        {
            ", target"
        } else {
            ""
        };
        let integer = kind.map_or("int32", Kind::name);
        let attributes = match argument.ty.target() {
            None if argument.ty == Type::I32 => "integer(c_int32_t), intent(in)".to_string(),
            None if argument.ty == Type::F64 => "real(real64), intent(in)".to_string(),
            None => "integer, intent(in)".to_string(),
            Some(ty) if api.is_opaque(ty) => "type(feti_problem), intent(in)".to_string(),
            Some(Type::Named(record)) => format!("type({record}), intent({intent}){optional}{target}"),
            Some(Type::Char) => "character(len=*), intent(in)".to_string(),
            Some(Type::F64) if argument.is_scalar() => format!("real(real64), intent({intent})"),
            Some(Type::F64) if dummy.is_pointer => {
                "real(real64), pointer, contiguous, intent(in)".to_string()
            }
            Some(Type::F64) => format!("real(real64), intent({intent}), contiguous{optional}{target}"),
            Some(_)
                if argument.is_scalar() && !dummy.is_raised && !dummy.is_optional && intent == "inout" =>
            {
                "integer(c_int64_t), intent(inout)".to_string()
            }
            Some(_) if argument.is_scalar() => format!("integer, intent({intent}){optional}"),
            Some(_) if input => format!("integer({integer}), intent(in), contiguous{target}"),
            Some(Type::I32) if kind == Some(Kind::Int32) => {
                "integer(int32), intent(inout), contiguous".to_string()
            }
            Some(Type::I32) => "integer(int64), intent(inout)".to_string(),
            Some(_) => "integer, intent(inout)".to_string(),
        };
        self.declared.push((attributes, format!("{}{}", dummy.name, dummy.shape.replace(',', ", "))));
    }

    fn passed(&mut self, api: &Api, dummy: &Dummy, argument: &Argument, kind: Option<Kind>) -> String {
        let (name, rule) = (dummy.name, argument.row.rule.as_str());
        let Some(target) = argument.ty.target() else {
            return match argument.ty {
                Type::I32 | Type::F64 => name.to_string(),
                _ if rule.ends_with("or FETI_ALL") => format!("body_index({name})"),
                _ if rule.contains("from 0") => format!("int({name} - 1, c_int64_t)"),
                _ => format!("int({name}, c_int64_t)"),
            };
        };
        match target {
            ty if api.is_opaque(ty) => format!("handle_of({name})"),
            Type::Char => format!("c_text({name})"),
            Type::Named(record) => self.record(dummy, record),
            _ if argument.is_scalar() => self.number_out(dummy, target),
            Type::F64 if dummy.is_optional => format!("address_of({name})"),
            _ if argument.direction() == Direction::In && argument.is_nullable() => {
                self.local("type(c_ptr)", "address");
                self.before.push("address = c_null_ptr".to_string());
                self.before.push(format!("if (size({name}) > 0) address = c_loc({name})"));
                "address".to_string()
            }
            Type::F64 => name.to_string(),
            _ if argument.direction() == Direction::In
                || *target == Type::I32 && kind == Some(Kind::Int32) =>
            {
                name.to_string()
            }
            _ => {
                let kind = if *target == Type::I32 { "c_int32_t" } else { "c_int64_t" };
                self.local(&format!("integer({kind}), allocatable"), "found(:)");
                self.before.push(format!("allocate (found(size({name})))"));
                let value = if dummy.is_raised { "int(found) + 1" } else { "found" };
                self.written.push(format!("if (status >= FETI_OK) {name} = {value}"));
                "found".to_string()
            }
        }
    }

    fn number_out(&mut self, dummy: &Dummy, target: &Type) -> String {
        let name = dummy.name;
        let kind = if *target == Type::I32 { "c_int32_t" } else { "c_int64_t" };
        let raised = if dummy.is_raised { " + 1" } else { "" };
        if dummy.is_optional {
            let found = format!("found_{name}");
            self.local(&format!("integer({kind}), target"), &found);
            self.before.push(format!("{found} = {}", if dummy.is_raised { "-1" } else { "0" }));
            self.after.push(format!("if (present({name})) {name} = int({found}){raised}"));
            return format!("c_loc({found})");
        }
        if dummy.is_zero_after_failure {
            self.before.push(format!("{name} = 0"));
        } else if !dummy.is_raised {
            return name.to_string();
        }
        self.local(&format!("integer({kind})"), "found");
        self.written.push(format!("if (status == FETI_OK) {name} = int(found){raised}"));
        "found".to_string()
    }

    fn record(&mut self, dummy: &Dummy, record: &str) -> String {
        let name = dummy.name;
        let size = format!("{name}%struct_size = c_sizeof({name})");
        if dummy.is_optional {
            self.local("type(c_ptr)", "address");
            self.before.push("address = c_null_ptr".to_string());
            self.before.push(format!("if (present({name})) {size}"));
            self.before.push(format!("if (present({name})) address = c_loc({name})"));
            return "address".to_string();
        }
        self.before.push(size);
        let members = counted(record);
        if !members.is_empty() {
            self.written.push("if (status >= FETI_OK) then".to_string());
            self.written
                .extend(members.iter().map(|member| format!("  {name}%{member} = {name}%{member} + 1")));
            self.written.push("end if".to_string());
        }
        name.to_string()
    }

    fn write(mut self, out: &mut String, entry: &Entry, call: &str) {
        let mut made = Vec::new();
        if self.written.is_empty() {
            made.push(format!("call finish({call}, stat, errmsg)"));
        } else {
            self.local("integer(c_int32_t)", "status");
            made.push(format!("status = {call}"));
            made.append(&mut self.written);
            made.push("call finish(status, stat, errmsg)".to_string());
        }
        let mut declared: Vec<(String, Vec<String>)> = Vec::new();
        for (attributes, name) in self.declared {
            match declared.iter_mut().find(|(same, _)| *same == attributes) {
                Some((_, names)) => names.push(name),
                None => declared.push((attributes, vec![name])),
            }
        }
        for (attributes, names) in declared {
            out.push_str(&continued("    ", &format!("{attributes} :: {}", names.join(", "))));
        }
        out.push('\n');
        self.before.iter().for_each(|statement| out.push_str(&continued("    ", statement)));
        for (number, (k, condition, text)) in entry.checks.iter().enumerate() {
            let word = if number == 0 { "if" } else { "else if" };
            out.push_str(&continued("    ", &format!("{word} ({condition}) then")));
            let refusal = format!("call refuse({k}, 'feti_{}: {text}', stat, errmsg)", entry.generic);
            out.push_str(&format!("      {refusal}\n"));
        }
        let indent = if entry.checks.is_empty() { "    " } else { "      " };
        if !entry.checks.is_empty() {
            out.push_str("    else\n");
        }
        for statement in &made {
            let inner = statement.len() - statement.trim_start().len();
            out.push_str(&continued(&format!("{indent}{}", " ".repeat(inner)), statement.trim_start()));
        }
        if !entry.checks.is_empty() {
            out.push_str("    end if\n");
        }
        self.after.iter().for_each(|statement| out.push_str(&continued("    ", statement)));
    }
}
