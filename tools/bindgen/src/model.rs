//! What a host sees of the library: constants, structs and functions, independent of the language they are printed in.

use std::fmt;

use crate::doc::{Direction, Doc, Row};

/// The types a signature or a struct may hold. Display gives the Rust spelling.
#[derive(Clone, Debug, PartialEq)]
pub enum Type {
    I32,
    I64,
    F64,
    /// `c_char`: only behind a pointer or inside an array.
    Char,
    /// `c_void`: only behind a pointer.
    Void,
    /// A `#[repr(C)]` struct or a callback of the interface, by name.
    Named(String),
    Array(Box<Type>, usize),
    Pointer {
        mutable: bool,
        to: Box<Type>,
    },
}

impl Type {
    /// A number passed by value: i32, i64 or f64.
    pub fn is_number(&self) -> bool {
        matches!(self, Type::I32 | Type::I64 | Type::F64)
    }

    pub fn target(&self) -> Option<&Type> {
        match self {
            Type::Pointer { to, .. } => Some(to),
            _ => None,
        }
    }

    pub fn is_mutable_pointer(&self) -> bool {
        matches!(self, Type::Pointer { mutable: true, .. })
    }
}

impl fmt::Display for Type {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Type::I32 => write!(f, "i32"),
            Type::I64 => write!(f, "i64"),
            Type::F64 => write!(f, "f64"),
            Type::Char => write!(f, "c_char"),
            Type::Void => write!(f, "c_void"),
            Type::Named(name) => write!(f, "{name}"),
            Type::Array(of, n) => write!(f, "[{of}; {n}]"),
            Type::Pointer { mutable: true, to } => write!(f, "*mut {to}"),
            Type::Pointer { mutable: false, to } => write!(f, "*const {to}"),
        }
    }
}

/// `pub const FETI_X: i32` or `i64`.
#[derive(Debug)]
pub struct Constant {
    pub name: String,
    pub ty: Type,
    pub value: i64,
    pub doc: Doc,
    /// Name of the file it stands in.
    pub source: String,
}

#[derive(Debug)]
pub struct Field {
    pub name: String,
    pub ty: Type,
    pub doc: Doc,
}

/// A `#[repr(C)]` struct; `fields` is None for an opaque handle.
#[derive(Debug)]
pub struct Struct {
    pub name: String,
    pub fields: Option<Vec<Field>>,
    pub doc: Doc,
}

impl Struct {
    /// Whether one of these functions of the host is a member.
    pub fn has_function(&self, of: &[&Callback]) -> bool {
        let is_one = |ty: &Type| of.iter().any(|callback| *ty == Type::Named(callback.name.clone()));
        self.fields.iter().flatten().any(|field| is_one(&field.ty))
    }
}

#[derive(Debug)]
pub struct Argument {
    pub name: String,
    pub ty: Type,
    /// The argument's row in the documentation table.
    pub row: Row,
}

impl Argument {
    pub fn is_nullable(&self) -> bool {
        self.row.is_nullable()
    }

    pub fn is_scalar(&self) -> bool {
        self.row.shape == "scalar"
    }

    pub fn direction(&self) -> Direction {
        self.row.direction
    }
}

#[derive(Debug)]
pub struct Function {
    pub name: String,
    pub arguments: Vec<Argument>,
    pub result: Type,
    pub doc: Doc,
    /// Name of the file it stands in.
    pub source: String,
    /// Whether another function has its description: that for indices of 32 bits.
    pub is_twin: bool,
}

impl Function {
    /// Whether the result is a status: all but those that never fail.
    pub fn has_status(&self) -> bool {
        !self.says("Never fails")
    }

    /// Whether it may be called while another call on the problem runs.
    pub fn is_never_busy(&self) -> bool {
        self.says("May be called") && self.says("while another call on the problem runs")
    }

    /// Whether the documentation holds these words.
    pub fn says(&self, words: &str) -> bool {
        self.doc.render(usize::MAX).join(" ").contains(words)
    }
}

/// `pub type feti_x_fn = Option<unsafe extern "C" fn(...) -> i32>`: a function of the host.
#[derive(Debug)]
pub struct Callback {
    pub name: String,
    pub arguments: Vec<Argument>,
    pub result: Type,
    pub doc: Doc,
}

/// The whole interface, items in the order of the source (files by name).
#[derive(Debug, Default)]
pub struct Api {
    pub version: [u32; 3],
    pub constants: Vec<Constant>,
    pub structs: Vec<Struct>,
    pub callbacks: Vec<Callback>,
    pub functions: Vec<Function>,
}

impl Api {
    pub fn find_struct(&self, name: &str) -> Option<&Struct> {
        self.structs.iter().find(|s| s.name == name)
    }

    /// A function that is known to exist.
    pub fn function(&self, name: &str) -> &Function {
        self.functions.iter().find(|function| function.name == name).expect("a function of C")
    }

    pub fn is_callback(&self, ty: &Type) -> bool {
        matches!(ty, Type::Named(name) if self.callbacks.iter().any(|callback| callback.name == *name))
    }

    /// True for an opaque handle such as `feti_problem`.
    pub fn is_opaque(&self, ty: &Type) -> bool {
        match ty {
            Type::Named(name) => self.find_struct(name).is_some_and(|s| s.fields.is_none()),
            _ => false,
        }
    }

    /// The version macros, with their values.
    pub fn version_constants(&self) -> [(&'static str, u32); 3] {
        let [major, minor, patch] = self.version;
        [
            ("FETI_CONTACT_VERSION_MAJOR", major),
            ("FETI_CONTACT_VERSION_MINOR", minor),
            ("FETI_CONTACT_VERSION_PATCH", patch),
        ]
    }
}
