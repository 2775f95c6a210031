//! What a Rust file defines: its items by path, which of them are tests, and which modules it declares elsewhere.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{LexError, TokenStream, TokenTree};
use syn::{
    Attribute, Expr, ExprLit, ImplItem, Item, ItemImpl, Lit, Meta, TraitItem, Type, Visibility,
};

/// An item of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Defined {
    /// `pub` without restriction, or part of a trait.
    pub(crate) public: bool,
    /// `cargo test` runs it.
    pub(crate) test: bool,
}

/// A module whose items stand in another file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct DeclaredModule {
    pub(crate) name: String,
    /// The file of its attribute `path`, from the folder of the file that declares it.
    pub(crate) path: Option<String>,
}

/// A parsed file.
#[derive(Debug, Clone, Default)]
pub(crate) struct SourceFile {
    /// By path within the file: `function`, `Type`, `Type::method`, `Enum::Variant`, `module::function`.
    pub(crate) items: BTreeMap<String, Defined>,
    pub(crate) modules: Vec<DeclaredModule>,
    /// Every string literal, macro calls included.
    pub(crate) strings: BTreeSet<String>,
}

impl SourceFile {
    /// Parses `text`; the error is that of the parser, without a place: what does not parse does not compile either.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let tokens: TokenStream = text.parse().map_err(|error: LexError| error.to_string())?;
        let mut file = Self::default();
        file.collect_strings(tokens.clone());
        let parsed: syn::File = syn::parse2(tokens).map_err(|error| error.to_string())?;
        file.collect("", &parsed.items);
        Ok(file)
    }

    fn add(&mut self, prefix: &str, name: impl ToString, public: bool, test: bool) {
        self.items.insert(
            prefix.to_owned() + &name.to_string(),
            Defined { public, test },
        );
    }

    fn collect(&mut self, prefix: &str, items: &[Item]) {
        for item in items {
            match item {
                Item::Fn(item) => self.add(
                    prefix,
                    &item.sig.ident,
                    is_public(&item.vis),
                    item.attrs.iter().any(is_test),
                ),
                Item::Struct(item) => self.add(prefix, &item.ident, is_public(&item.vis), false),
                Item::Union(item) => self.add(prefix, &item.ident, is_public(&item.vis), false),
                Item::Const(item) => self.add(prefix, &item.ident, is_public(&item.vis), false),
                Item::Static(item) => self.add(prefix, &item.ident, is_public(&item.vis), false),
                Item::Type(item) => self.add(prefix, &item.ident, is_public(&item.vis), false),
                Item::Enum(item) => {
                    let public = is_public(&item.vis);
                    self.add(prefix, &item.ident, public, false);
                    for variant in &item.variants {
                        let name = format!("{}::{}", item.ident, variant.ident);
                        self.add(prefix, name, public, false);
                    }
                }
                Item::Trait(item) => {
                    let public = is_public(&item.vis);
                    self.add(prefix, &item.ident, public, false);
                    for member in &item.items {
                        let name = match member {
                            TraitItem::Fn(member) => &member.sig.ident,
                            TraitItem::Const(member) => &member.ident,
                            TraitItem::Type(member) => &member.ident,
                            _ => continue,
                        };
                        self.add(prefix, format!("{}::{name}", item.ident), public, false);
                    }
                }
                Item::Impl(item) => self.collect_impl(prefix, item),
                Item::Mod(item) => match &item.content {
                    Some((_, items)) => self.collect(&format!("{prefix}{}::", item.ident), items),
                    None => self.modules.push(DeclaredModule {
                        name: item.ident.to_string(),
                        path: item.attrs.iter().find_map(path_attribute),
                    }),
                },
                Item::Macro(item)
                    if item
                        .mac
                        .path
                        .segments
                        .last()
                        .is_some_and(|segment| segment.ident == "proptest") =>
                {
                    self.collect_properties(prefix, item.mac.tokens.clone());
                }
                _ => {}
            }
        }
    }

    fn collect_impl(&mut self, prefix: &str, item: &ItemImpl) {
        let Some(name) = type_name(&item.self_ty) else {
            return;
        };
        let of_trait = item.trait_.is_some();
        for member in &item.items {
            let (ident, visibility) = match member {
                ImplItem::Fn(member) => (&member.sig.ident, &member.vis),
                ImplItem::Const(member) => (&member.ident, &member.vis),
                ImplItem::Type(member) => (&member.ident, &member.vis),
                _ => continue,
            };
            let public = of_trait || is_public(visibility);
            self.add(prefix, format!("{name}::{ident}"), public, false);
        }
    }

    /// The functions of a `proptest!` block, whose arguments are no Rust: `#[test] fn name(x in 0..1) { }`.
    fn collect_properties(&mut self, prefix: &str, tokens: TokenStream) {
        let mut test = false;
        let mut tokens = tokens.into_iter().peekable();
        while let Some(token) = tokens.next() {
            match (&token, tokens.peek()) {
                (TokenTree::Punct(hash), Some(TokenTree::Group(group)))
                    if hash.as_char() == '#' =>
                {
                    test |= group.stream().to_string() == "test";
                }
                (TokenTree::Ident(keyword), Some(TokenTree::Ident(name))) if keyword == "fn" => {
                    self.add(prefix, name, false, test);
                    test = false;
                }
                _ => {}
            }
        }
    }

    fn collect_strings(&mut self, tokens: TokenStream) {
        for token in tokens {
            match token {
                TokenTree::Group(group) => self.collect_strings(group.stream()),
                TokenTree::Literal(literal) => {
                    if let Lit::Str(text) = Lit::new(literal) {
                        self.strings.insert(text.value());
                    }
                }
                _ => {}
            }
        }
    }
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

fn is_test(attribute: &Attribute) -> bool {
    attribute.path().is_ident("test")
}

fn path_attribute(attribute: &Attribute) -> Option<String> {
    match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("path") => match &pair.value {
            Expr::Lit(ExprLit {
                lit: Lit::Str(text),
                ..
            }) => Some(text.value()),
            _ => None,
        },
        _ => None,
    }
}

/// The name of the type that an impl is for; none for tuples, slices and the like.
fn type_name(of: &Type) -> Option<String> {
    match of {
        Type::Path(path) => path
            .path
            .segments
            .last()
            .map(|segment| segment.ident.to_string()),
        Type::Reference(reference) => type_name(&reference.elem),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"
pub struct Rod { length: f64 }
impl Rod {
    pub fn length(&self) -> f64 { self.length }
    fn half(&self) -> f64 { 0.5 * self.length }
}
impl Law for Rod { fn modulus(&self) -> f64 { 1.0 } }
pub trait Law { fn modulus(&self) -> f64; const NAME: &str = "a \"law\""; }
pub(crate) enum End { Free }
mod other;
#[path = "there/elsewhere.rs"]
mod elsewhere;
fn written() -> Vec<&'static str> { vec!["figure-1.svg"] }
// fn commented_out() {}
#[cfg(test)]
mod tests {
    #[test]
    fn a_test() {}
    fn not_a_test() { let text = "fn in_a_string() {}"; }
    proptest! {
        #![proptest_config(ProptestConfig::with_cases(8))]
        /// Holds everywhere.
        #[test]
        fn a_property(x in 0.0..1.0_f64) { let f = |fn_like: f64| fn_like; }
        fn no_property(x in 0..1) {}
    }
}
"#;

    fn parsed() -> SourceFile {
        SourceFile::parse(TEXT).unwrap()
    }

    #[test]
    fn items_have_their_paths_and_nothing_else_is_an_item() {
        let file = parsed();
        assert_eq!(
            file.items.keys().collect::<Vec<_>>(),
            [
                "End",
                "End::Free",
                "Law",
                "Law::NAME",
                "Law::modulus",
                "Rod",
                "Rod::half",
                "Rod::length",
                "Rod::modulus",
                "tests::a_property",
                "tests::a_test",
                "tests::no_property",
                "tests::not_a_test",
                "written",
            ]
        );
    }

    #[test]
    fn visibility_and_the_attribute_of_tests_are_seen() {
        let file = parsed();
        let public = |name: &str| file.items[name].public;
        assert!(public("Rod") && public("Rod::length") && public("Rod::modulus"));
        assert!(!public("Rod::half") && !public("End") && !public("written"));
        let tests: Vec<&str> = file
            .items
            .iter()
            .filter(|(_, defined)| defined.test)
            .map(|(name, _)| name.as_str())
            .collect();
        assert_eq!(tests, ["tests::a_property", "tests::a_test"]);
    }

    #[test]
    fn modules_elsewhere_and_strings_in_macros_are_found() {
        let file = parsed();
        let modules: Vec<(&str, Option<&str>)> = file
            .modules
            .iter()
            .map(|module| (module.name.as_str(), module.path.as_deref()))
            .collect();
        assert_eq!(
            modules,
            [("other", None), ("elsewhere", Some("there/elsewhere.rs"))]
        );
        assert!(file.strings.contains("figure-1.svg") && file.strings.contains("a \"law\""));
    }

    #[test]
    fn what_is_no_rust_says_so() {
        let error = SourceFile::parse("fn a() {}\nfn fn() {}\n").unwrap_err();
        assert_eq!(error, "expected identifier, found keyword `fn`");
    }
}
