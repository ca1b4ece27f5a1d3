//! Reads the `extern "C"` items of the given Rust files, once, into an [`Api`].

use quote::ToTokens;

use crate::doc::{Direction, Doc};
use crate::model::{Api, Argument, Callback, Constant, Field, Function, Struct, Type};

/// `sources`: (path from c/src, text), in the order in which the items are printed.
pub fn parse(sources: &[(String, String)], version: [u32; 3]) -> Result<Api, String> {
    let mut api = Api { version, ..Api::default() };
    for (name, text) in sources {
        let file = syn::parse_file(text).map_err(|e| format!("{name}: {e}"))?;
        for item in &file.items {
            add_item(&mut api, item).map_err(|e| format!("{name}: {e}"))?;
        }
        let functions = api.functions.iter_mut().map(|function| &mut function.source);
        let constants = api.constants.iter_mut().map(|constant| &mut constant.source);
        functions
            .chain(constants)
            .filter(|source| source.is_empty())
            .for_each(|source| source.clone_from(name));
    }
    Ok(api)
}

fn add_item(api: &mut Api, item: &syn::Item) -> Result<(), String> {
    match item {
        syn::Item::Const(item) if is_public(&item.vis) && is_interface_name(&item.ident) => {
            api.constants.push(constant(item)?);
        }
        syn::Item::Struct(item) if is_public(&item.vis) && has_word(&item.attrs, "repr", "C") => {
            api.structs.push(structure(item)?);
        }
        syn::Item::Type(item) if is_public(&item.vis) && is_interface_name(&item.ident) => {
            api.callbacks.push(callback(item)?);
        }
        syn::Item::Fn(item) => api.functions.extend(function(item)?),
        syn::Item::Macro(item) if item.mac.path.is_ident("macro_rules") => {}
        syn::Item::Macro(item) if item.mac.path.is_ident("twins") => {
            let twins: Twins = item.mac.parse_body().map_err(|e| format!("twins: {e}"))?;
            api.functions.extend(twins.functions()?);
        }
        syn::Item::Macro(_) | syn::Item::Mod(_) if text(item).contains("no_mangle") => {
            return Err("an exported function inside a macro or an inner module is not seen".to_string());
        }
        _ => {}
    }
    Ok(())
}

fn constant(item: &syn::ItemConst) -> Result<Constant, String> {
    let name = item.ident.to_string();
    let ty = read_type(&item.ty).filter(|ty| matches!(ty, Type::I32 | Type::I64));
    let ty =
        ty.ok_or_else(|| format!("constant `{name}`: type {} is neither i32 nor i64", text(&item.ty)))?;
    let value = integer(&item.expr);
    let value =
        value.ok_or_else(|| format!("constant `{name}`: {} is not an integer literal", text(&item.expr)))?;
    let doc = documentation(&item.attrs).map_err(|e| format!("constant `{name}`: {e}"))?;
    Ok(Constant { name, ty, value, doc, source: String::new() })
}

/// A literal, possibly with a minus sign.
fn integer(expr: &syn::Expr) -> Option<i64> {
    match expr {
        syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Int(int), .. }) => int.base10_parse().ok(),
        syn::Expr::Unary(syn::ExprUnary { op: syn::UnOp::Neg(_), expr, .. }) => {
            integer(expr).map(|value| -value)
        }
        _ => None,
    }
}

fn structure(item: &syn::ItemStruct) -> Result<Struct, String> {
    let name = item.ident.to_string();
    let doc = documentation(&item.attrs).map_err(|e| format!("struct `{name}`: {e}"))?;
    if item.fields.iter().all(|field| !is_public(&field.vis)) {
        return Ok(Struct { name, fields: None, doc });
    }
    let fields = item.fields.iter().map(|item| field(&name, item)).collect::<Result<_, _>>()?;
    Ok(Struct { name, fields: Some(fields), doc })
}

fn field(owner: &str, item: &syn::Field) -> Result<Field, String> {
    let Some(ident) = &item.ident else {
        return Err(format!("struct `{owner}`: a field without a name"));
    };
    let place = format!("struct `{owner}`, field `{ident}`");
    if !is_public(&item.vis) {
        return Err(format!("{place}: private, so hosts cannot know the layout"));
    }
    let ty = read_type(&item.ty).ok_or_else(|| format!("{place}: type {} is not allowed", text(&item.ty)))?;
    let doc = documentation(&item.attrs).map_err(|e| format!("{place}: {e}"))?;
    Ok(Field { name: name_of(ident), ty, doc })
}

/// None for a function that is not exported.
fn function(item: &syn::ItemFn) -> Result<Option<Function>, String> {
    let name = item.sig.ident.to_string();
    let exported = has_path(&item.attrs, "no_mangle") || has_word(&item.attrs, "unsafe", "no_mangle");
    let abi = item.sig.abi.as_ref().map(|abi| abi.name.as_ref().map_or("C".to_string(), syn::LitStr::value));
    let visible = is_public(&item.vis) && abi.as_deref() == Some("C");
    match (exported, visible) {
        (false, true) if is_interface_name(&item.sig.ident) => {
            return Err(format!("function `{name}`: pub extern \"C\" without #[no_mangle]"));
        }
        (false, _) => return Ok(None),
        (true, false) => return Err(format!("function `{name}`: #[no_mangle] without pub extern \"C\"")),
        (true, true) => {}
    }
    exported_function(&item.sig, &item.attrs).map(Some)
}

fn exported_function(sig: &syn::Signature, attrs: &[syn::Attribute]) -> Result<Function, String> {
    let name = sig.ident.to_string();
    let named = sig.inputs.iter().map(|input| match input {
        syn::FnArg::Typed(typed) => match typed.pat.as_ref() {
            syn::Pat::Ident(ident) => Ok((name_of(&ident.ident), typed.ty.as_ref())),
            _ => Err(text(input)),
        },
        syn::FnArg::Receiver(_) => Err(text(input)),
    });
    let (arguments, result, doc) = signature(&name, named, &sig.output, attrs)?;
    let result = result.ok_or_else(|| format!("function `{name}`: result type () is not allowed"))?;
    Ok(Function { name, arguments, result, doc, source: String::new(), is_twin: false })
}

/// `twins! { /// ... fn feti_x_i32, feti_x_i64(list: *const I) |call| { ... } }`.
struct Twins {
    attrs: Vec<syn::Attribute>,
    names: [syn::Ident; 2],
    inputs: proc_macro2::TokenStream,
}

impl syn::parse::Parse for Twins {
    fn parse(input: syn::parse::ParseStream) -> syn::Result<Self> {
        let attrs = input.call(syn::Attribute::parse_outer)?;
        input.parse::<syn::Token![fn]>()?;
        let narrow = input.parse()?;
        input.parse::<syn::Token![,]>()?;
        let names = [narrow, input.parse()?];
        let inside;
        syn::parenthesized!(inside in input);
        let inputs = inside.parse()?;
        input.parse::<proc_macro2::TokenStream>()?;
        Ok(Twins { attrs, names, inputs })
    }
}

impl Twins {
    /// What the macro makes of it.
    fn functions(&self) -> Result<[Function; 2], String> {
        let [mut narrow, mut wide] =
            [(&self.names[0], "i32"), (&self.names[1], "i64")].map(|(name, index)| {
                let inputs = self.inputs.to_string().replace("* const I", &format!("* const {index}"));
                let sig = syn::parse_str(&format!("fn {name}({inputs}) -> i32"));
                exported_function(&sig.map_err(|e| format!("function `{name}`: {e}"))?, &self.attrs)
            });
        if let (Ok(narrow), Ok(wide)) = (&mut narrow, &mut wide) {
            wide.doc = Doc::of(format!("As {}, with 64-bit indices.", narrow.name));
            wide.is_twin = true;
        }
        Ok([narrow?, wide?])
    }
}

/// A type alias of the interface must be a function of the host that may be NULL.
fn callback(item: &syn::ItemType) -> Result<Callback, String> {
    let name = item.ident.to_string();
    let Some(pointer) = optional_function(&item.ty) else {
        return Err(format!("type `{name}`: {} is not Option<unsafe extern \"C\" fn>", text(&item.ty)));
    };
    let named = pointer.inputs.iter().map(|input| {
        let ident = input.name.as_ref().ok_or_else(|| text(input))?;
        Ok((name_of(&ident.0), &input.ty))
    });
    let (arguments, result, doc) = signature(&name, named, &pointer.output, &item.attrs)?;
    Ok(Callback { name, arguments, result: result.unwrap_or(Type::Void), doc })
}

/// The function inside `Option<unsafe extern "C" fn(...) -> ...>`.
fn optional_function(ty: &syn::Type) -> Option<&syn::TypeBareFn> {
    let syn::Type::Path(path) = ty else { return None };
    let option = path.path.segments.last().filter(|segment| segment.ident == "Option")?;
    let syn::PathArguments::AngleBracketed(inside) = &option.arguments else { return None };
    let Some(syn::GenericArgument::Type(syn::Type::BareFn(function))) = inside.args.first() else {
        return None;
    };
    let is_c = function.abi.as_ref()?.name.as_ref()?.value() == "C";
    (is_c && function.unsafety.is_some() && inside.args.len() == 1).then_some(function)
}

/// Arguments with their rows of the table, result and documentation of a function or callback.
fn signature<'a>(
    name: &str,
    named: impl Iterator<Item = Result<(String, &'a syn::Type), String>>,
    output: &syn::ReturnType,
    attrs: &[syn::Attribute],
) -> Result<(Vec<Argument>, Option<Type>, Doc), String> {
    let mut doc = documentation(attrs).map_err(|e| format!("function `{name}`: {e}"))?;
    let mut arguments = Vec::new();
    for input in named {
        let input = input.map_err(|e| format!("function `{name}`: argument {e} has no plain name"))?;
        arguments.push(argument(name, input, &doc)?);
    }
    if let Some(row) = doc.rows.iter().find(|row| arguments.iter().all(|a| a.name != row.argument)) {
        return Err(format!("function `{name}`: the table lists `{}`, which is no argument", row.argument));
    }
    doc.rows = arguments.iter().map(|argument| argument.row.clone()).collect();
    let result = match output {
        syn::ReturnType::Type(_, ty) => Some(
            read_type(ty)
                .ok_or_else(|| format!("function `{name}`: result type {} is not allowed", text(ty)))?,
        ),
        syn::ReturnType::Default => None,
    };
    Ok((arguments, result, doc))
}

fn argument(function: &str, (name, ty): (String, &syn::Type), doc: &Doc) -> Result<Argument, String> {
    let place = format!("function `{function}`, argument `{name}`");
    let ty = read_type(ty).ok_or_else(|| format!("{place}: type {} is not allowed", text(ty)))?;
    let row = doc.rows.iter().find(|row| row.argument == name).cloned();
    let row = row.ok_or_else(|| format!("{place}: no row in the argument table"))?;
    if row.direction != Direction::In && !ty.is_mutable_pointer() {
        return Err(format!("{place}: documented as written, but its type is {ty}"));
    }
    Ok(Argument { name, ty, row })
}

/// None for anything that is not i32, i64, f64, c_char, c_void, a `feti_` type, or pointers to and arrays of those.
fn read_type(ty: &syn::Type) -> Option<Type> {
    match ty {
        syn::Type::Path(path) if path.qself.is_none() => named_type(path.path.segments.last()?),
        syn::Type::Ptr(pointer) => Some(Type::Pointer {
            mutable: pointer.mutability.is_some(),
            to: Box::new(read_type(&pointer.elem)?),
        }),
        syn::Type::Array(array) => {
            let length = integer(&array.len).and_then(|n| usize::try_from(n).ok())?;
            Some(Type::Array(Box::new(read_type(&array.elem)?), length))
        }
        _ => None,
    }
}

fn named_type(segment: &syn::PathSegment) -> Option<Type> {
    if !segment.arguments.is_none() {
        return None;
    }
    match segment.ident.to_string().as_str() {
        "i32" => Some(Type::I32),
        "i64" => Some(Type::I64),
        "f64" => Some(Type::F64),
        "c_char" => Some(Type::Char),
        "c_void" => Some(Type::Void),
        name if name.starts_with("feti_") => Some(Type::Named(name.to_string())),
        _ => None,
    }
}

fn documentation(attrs: &[syn::Attribute]) -> Result<Doc, String> {
    let mut lines = Vec::new();
    for attr in attrs.iter().filter(|attr| attr.path().is_ident("doc")) {
        let syn::Meta::NameValue(pair) = &attr.meta else {
            continue;
        };
        if let syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Str(line), .. }) = &pair.value {
            let line = line.value();
            lines.extend(line.lines().map(|l| l.strip_prefix(' ').unwrap_or(l).trim_end().to_string()));
            if line.is_empty() {
                lines.push(String::new());
            }
        }
    }
    Doc::parse(&lines)
}

fn is_public(vis: &syn::Visibility) -> bool {
    matches!(vis, syn::Visibility::Public(_))
}

fn is_interface_name(ident: &syn::Ident) -> bool {
    ident.to_string().to_ascii_lowercase().starts_with("feti_")
}

/// The name in C: `r#type` is `type`.
fn name_of(ident: &syn::Ident) -> String {
    let name = ident.to_string();
    name.strip_prefix("r#").unwrap_or(&name).to_string()
}

/// `#[path]`
fn has_path(attrs: &[syn::Attribute], path: &str) -> bool {
    attrs.iter().any(|attr| attr.path().is_ident(path))
}

/// `#[path(word, ...)]`
fn has_word(attrs: &[syn::Attribute], path: &str, word: &str) -> bool {
    attrs.iter().filter(|attr| attr.path().is_ident(path)).any(|attr| match &attr.meta {
        syn::Meta::List(list) => {
            text(&list.tokens).split(|c: char| !c.is_alphanumeric() && c != '_').any(|w| w == word)
        }
        _ => false,
    })
}

fn text(tokens: &impl ToTokens) -> String {
    let spaced = tokens.to_token_stream().to_string();
    format!("`{spaced}`").replace("* ", "*").replace(" :: ", "::").replace(" < ", "<").replace(" >", ">")
}
