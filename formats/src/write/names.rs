//! Names that are free.

use std::collections::{HashMap, HashSet};

/// The names that are taken. Finding a free one takes no longer when many like it are taken.
#[derive(Clone, Debug, Default)]
pub(crate) struct Names {
    taken: HashSet<String>,
    /// For what a name is made from: the number that is tried next.
    next: HashMap<String, usize>,
    /// Whether upper and lower case are the same, as for some file systems.
    fold: bool,
}

impl Names {
    pub fn folding_case() -> Self {
        Self { fold: true, ..Self::default() }
    }

    /// False when it was taken before.
    pub fn take(&mut self, name: &str) -> bool {
        let name = if self.fold { name.to_lowercase() } else { name.to_owned() };
        self.taken.insert(name)
    }

    /// The first free one of `name(0)`, `name(1)`, … which are all made from `base`.
    pub fn free(&mut self, base: &str, name: impl Fn(usize) -> String) -> String {
        let mut number = self.next.get(base).copied().unwrap_or(0);
        loop {
            let candidate = name(number);
            number += 1;
            if self.take(&candidate) {
                self.next.insert(base.to_owned(), number);
                return candidate;
            }
        }
    }

    /// `name` or, where that is taken, it with a number; without a name, `kind` with a number.
    pub fn free_or_numbered(&mut self, name: Option<&str>, kind: &str) -> String {
        match name.filter(|name| !name.is_empty()) {
            Some(name) => self.free(name, |n| if n == 0 { name.to_owned() } else { format!("{name}-{n}") }),
            None => self.free(kind, |n| format!("{kind}-{}", n + 1)),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use super::*;

    /// Each name is found after one look: what is taken already is not tried again.
    #[test]
    fn a_thousand_names_take_a_thousand_tries() {
        let (mut names, tries) = (Names::default(), Cell::new(0));
        names.take("mesh-7");
        for _ in 0..1000 {
            names.free("mesh", |n| {
                tries.set(tries.get() + 1);
                format!("mesh-{n}")
            });
        }
        assert_eq!(tries.get(), 1001);
    }

    #[test]
    fn names_are_kept_where_they_are_free() {
        let mut names = Names::folding_case();
        let mut free = |name| names.free_or_numbered(name, "material");
        let made = [free(Some("Red")), free(Some("red")), free(Some("red-1")), free(None), free(Some(""))];
        assert_eq!(made, ["Red", "red-1", "red-1-1", "material-1", "material-2"]);
    }
}
