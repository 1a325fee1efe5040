//! What of a scene language is read, as its plugin tables say.

/// How one name of a language fares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Support {
    Full,
    /// Rendered as something else; the text says what.
    Approximated(&'static str),
    /// Reported as an error that names it.
    Refused,
}

/// A concept of a language (its shapes, its materials) and its names.
#[derive(Clone, Debug)]
pub struct Concept {
    pub name: &'static str,
    pub plugins: Vec<(&'static str, Support)>,
}
