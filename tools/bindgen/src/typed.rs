//! The signatures of the typed Fortran module, read from its sources: which subroutine calls which function of C.

use std::collections::{BTreeMap, BTreeSet};

/// A subroutine or function as the host sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Signature {
    /// Its name in module feti_contact.
    pub name: String,
    /// The statement and the declarations of its arguments, a line each.
    pub lines: Vec<String>,
}

struct Procedure {
    name: String,
    statement: String,
    dummies: Vec<String>,
    declarations: Vec<String>,
    /// Functions of C.
    calls: BTreeSet<String>,
    /// Lines that call a subroutine, maybe one of the same module.
    helpers: Vec<String>,
}

/// For every function of C the procedures that call it, with the interfaces of the host's functions that they take.
/// `sources`: the modules, feti_contact.f90 among them.
pub fn signatures(sources: &[String]) -> BTreeMap<String, Vec<Signature>> {
    let texts: Vec<Vec<String>> = sources.iter().map(|text| statements(text)).collect();
    // The names of the public face: name inside -> name outside.
    let faces = texts.iter().flatten().filter(|line| line.starts_with("use ")).flat_map(|line| renamed(line));
    let faces: BTreeMap<String, String> =
        faces.filter(|pair| pair.0.starts_with("feti_")).map(|(outside, inside)| (inside, outside)).collect();
    let modules: Vec<Vec<Procedure>> = texts.iter().map(|text| procedures(text)).collect();
    let mut found: BTreeMap<String, Vec<Signature>> = BTreeMap::new();
    for (text, procedures) in texts.iter().zip(&modules) {
        let generics = generics(text);
        for procedure in procedures {
            let inside = generics.get(&procedure.name).unwrap_or(&procedure.name);
            let Some(outside) = faces.get(inside) else { continue };
            let helpers = procedures.iter().filter(|helper| procedure.is_helped_by(helper));
            for function in helpers.flat_map(|helper| &helper.calls).chain(&procedure.calls) {
                found.entry(function.clone()).or_default().push(procedure.seen_as(outside, &modules));
            }
        }
    }
    found
}

impl Procedure {
    fn is_helped_by(&self, other: &Procedure) -> bool {
        self.helpers.iter().any(|line| line.contains(&format!("call {}(", other.name)))
    }

    fn seen_as(&self, outside: &str, modules: &[Vec<Procedure>]) -> Signature {
        let mut lines = self.lines();
        lines[0] = lines[0].replacen(&format!("{}(", self.name), &format!("{outside}("), 1);
        for interface in modules.iter().flatten().filter(|other| self.takes(other)) {
            lines.push(String::new());
            lines.extend(interface.lines());
        }
        Signature { name: outside.to_string(), lines }
    }

    /// Whether an argument is a function of the host with the interface `other`.
    fn takes(&self, other: &Procedure) -> bool {
        self.declarations.iter().any(|line| line.starts_with(&format!("procedure({})", other.name)))
    }

    /// The statement and the declarations.
    fn lines(&self) -> Vec<String> {
        let declarations = self.declarations.iter().map(|line| format!("  {line}"));
        std::iter::once(self.statement.clone()).chain(declarations).collect()
    }
}

/// Statements without comments, continued lines joined; every procedure of the faces is recursive, which need not be said.
pub fn statements(text: &str) -> Vec<String> {
    let mut statements = Vec::new();
    let mut open = String::new();
    for line in text.lines().map(str::trim).filter(|line| !line.starts_with('!')) {
        match line.strip_suffix('&') {
            Some(part) => open.push_str(part),
            None => {
                let statement = std::mem::take(&mut open) + line;
                statements.push(statement.trim_start_matches("recursive ").to_string());
            }
        }
    }
    statements
}

/// The pairs (a, b) of `a => b` in a statement.
fn renamed(statement: &str) -> Vec<(String, String)> {
    let list = statement.split_once("only:").map_or("", |(_, list)| list);
    let pairs = list.split(',').filter_map(|item| item.split_once("=>"));
    pairs.map(|(a, b)| (a.trim().to_string(), b.trim().to_string())).collect()
}

/// Specific name -> generic name.
fn generics(text: &[String]) -> BTreeMap<String, String> {
    let mut generics = BTreeMap::new();
    let mut generic = "";
    for line in text {
        if let Some(name) = line.strip_prefix("interface ") {
            generic = name.trim();
        } else if let Some(list) = line.strip_prefix("module procedure ") {
            generics.extend(list.split(',').map(|name| (name.trim().to_string(), generic.to_string())));
        }
    }
    generics
}

fn procedures(text: &[String]) -> Vec<Procedure> {
    let calls: Vec<(String, String)> = text.iter().flat_map(|line| renamed(line)).collect();
    let mut procedures: Vec<Procedure> = Vec::new();
    let mut open = false;
    for line in text {
        if line.starts_with("end subroutine") || line.starts_with("end function") {
            open = false;
        } else if let Some(procedure) = started(line) {
            procedures.push(procedure);
            open = true;
        } else if let Some(procedure) = procedures.last_mut().filter(|_| open) {
            procedure.read(line, &calls);
        }
    }
    procedures
}

/// A procedure that begins with this statement.
fn started(line: &str) -> Option<Procedure> {
    let (head, rest) = line.split_once('(')?;
    let mut words = head.split_whitespace().rev();
    let (name, keyword) = (words.next()?, words.next()?);
    if keyword != "subroutine" && keyword != "function" {
        return None;
    }
    let dummies = rest.split(')').next()?.split(',').map(|name| name.trim().to_string()).collect();
    Some(Procedure {
        name: name.to_string(),
        statement: line.to_string(),
        dummies,
        declarations: Vec::new(),
        calls: BTreeSet::new(),
        helpers: Vec::new(),
    })
}

impl Procedure {
    fn read(&mut self, line: &str, calls: &[(String, String)]) {
        if let Some((attributes, names)) = line.split_once("::") {
            let first: String =
                names.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let marks = ["intent(", "optional", "procedure("];
            let is_dummy = marks.iter().any(|mark| attributes.contains(mark));
            if is_dummy && self.dummies.contains(&first) {
                self.declarations.push(line.to_string());
            }
            return;
        }
        if line.contains("call ") {
            self.helpers.push(line.to_string());
        }
        let called = calls.iter().filter(|(inside, _)| line.contains(&format!("{inside}(")));
        self.calls.extend(called.map(|(_, function)| function.clone()).filter(|f| f.starts_with("feti_")));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_specific_procedure_is_seen_under_its_public_name() {
        let module = "module feti_contact_bodies\n  use feti_contact_c, only: FETI_OK, &\n    c_add => feti_body_add\n\
            interface body_add\n  module procedure add_int32, add_int64\nend interface\ncontains\n  !> Adds.\n\
            recursive subroutine add_int32(p, n, stat)\n type(feti_problem), intent(in) :: p\n integer, intent(in) :: n\n\
            integer, intent(out), optional :: stat\n integer :: local\n call help(p, n)\nend subroutine\n\
            subroutine help(p, n)\n status = c_add(handle(p), n)\nend subroutine\n\
            subroutine other(p)\n call nothing(p)\nend subroutine\nend module\n";
        let face = "module feti_contact\n  use feti_contact_bodies, only: &\n    feti_body_add => body_add, feti_other => other\n";
        let found = signatures(&[module.to_string(), face.to_string()]);
        assert_eq!(found.keys().collect::<Vec<_>>(), ["feti_body_add"]);
        let signature = &found["feti_body_add"][0];
        assert_eq!(signature.name, "feti_body_add");
        assert_eq!(signature.lines[0], "subroutine feti_body_add(p, n, stat)");
        assert_eq!(signature.lines.len(), 4, "{signature:?}");
    }

    #[test]
    fn functions_of_the_host_are_declared_and_their_interface_follows() {
        let module = "module feti_contact_base\nabstract interface\n  integer function hear(now, data)\n    import :: c_int\n\
            integer, intent(in) :: now\n class(*), intent(inout) :: data\n end function\n end interface\n\
            use feti_contact_c, only: c_on => feti_on\ncontains\n subroutine on(p, heard)\n\
            type(feti_problem), intent(in) :: p\n procedure(hear) :: heard\n status = c_on(p)\n end subroutine\nend module\n";
        let face = "module feti_contact\n  use feti_contact_base, only: feti_on => on\n";
        let found = signatures(&[module.to_string(), face.to_string()]);
        let lines = &found["feti_on"][0].lines;
        assert_eq!(
            lines[2..5],
            ["  procedure(hear) :: heard", "", "integer function hear(now, data)"],
            "{lines:?}"
        );
        assert_eq!(lines.len(), 7, "{lines:?}");
    }
}
