//! The element tree of a file: names, attributes and where they stand.

use crate::diagnostic::Span;

/// Elements deeper than this are refused; recursion over a tree is safe below it.
pub(super) const MAX_DEPTH: usize = 256;

#[derive(Clone, Debug)]
pub(super) struct Attribute {
    pub name: String,
    pub name_span: Span,
    pub value: String,
    /// Inside the quotes.
    pub value_span: Span,
}

#[derive(Clone, Debug)]
pub(super) struct Element {
    pub tag: String,
    pub tag_span: Span,
    pub attributes: Vec<Attribute>,
    pub children: Vec<Element>,
    /// A problem of this element was reported already; its value is unknown.
    pub broken: bool,
}

impl Element {
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name == name)
    }

    pub fn value(&self, name: &str) -> Option<&str> {
        self.attribute(name).map(|a| a.value.as_str())
    }

    /// Where to point for attribute `name`: its value, or the tag when it is missing.
    pub fn place(&self, name: &str) -> Span {
        self.attribute(name).map_or(self.tag_span, |a| a.value_span)
    }
}
