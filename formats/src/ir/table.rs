//! The tables that say what a kind is. [`kinds`] makes an enum, the names of its kinds, its references and its
//! fields from one row each; [`record`] makes a struct with its references and fields.

use std::any::Any;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::arena::{Id, Reference, Stored};

/// Takes a field by its path, such as `microfacet.alpha_u`, and says whether to go into it.
pub type VisitField<'a> = dyn FnMut(&str, &mut dyn Any) -> bool + 'a;

/// A part of the scene that may refer to objects of the arenas.
pub trait Part: Any {
    /// Shows every reference, in the order of the fields.
    fn references(&self, visit: &mut dyn FnMut(Reference));

    /// Shows every reference, in the same order, and takes over what `visit` makes of it. The arena of a
    /// reference stays the same.
    fn references_mut(&mut self, visit: &mut dyn FnMut(&mut Reference));

    /// Shows the path of every file it is read from.
    fn files<'a>(&'a self, _visit: &mut dyn FnMut(&'a Path)) {}

    /// Shows itself and, where `visit` says so, its fields. Elements of a list add their number to the path; fields
    /// that scene languages do not name, and the one part of a kind, add nothing.
    fn fields(&mut self, path: &str, visit: &mut VisitField<'_>);

    /// Whether what it looks like depends on the direction of ∂p/∂u on the surface.
    fn anisotropic(&self) -> bool {
        false
    }
}

/// Fields whose own fields are named as if they stood in their place, as scene languages have it.
const OPEN: [&str; 5] = ["kind", "interface", "conductor", "plastic", "microfacet"];

/// The path of a field.
pub(super) fn joined(path: &str, field: &str) -> String {
    if OPEN.contains(&field) { path.to_owned() } else { format!("{path}.{field}") }
}

impl<T: Stored + 'static> Part for Id<T> {
    fn references(&self, visit: &mut dyn FnMut(Reference)) {
        visit((*self).into());
    }

    fn references_mut(&mut self, visit: &mut dyn FnMut(&mut Reference)) {
        let mut reference = (*self).into();
        visit(&mut reference);
        *self = reference.to().expect("a reference keeps its arena");
    }

    fn fields(&mut self, path: &str, visit: &mut VisitField<'_>) {
        visit(path, self);
    }
}

/// What holds any number of parts.
macro_rules! part_of_parts {
    ($([$($generic:tt)*] $type:ty, numbered: $numbered:literal);* $(;)?) => {
        $(impl<$($generic)*> Part for $type {
            fn references(&self, visit: &mut dyn FnMut(Reference)) {
                self.iter().for_each(|part| part.references(visit));
            }
            fn references_mut(&mut self, visit: &mut dyn FnMut(&mut Reference)) {
                self.iter_mut().for_each(|part| part.references_mut(visit));
            }
            fn files<'a>(&'a self, visit: &mut dyn FnMut(&'a Path)) {
                self.iter().for_each(|part| part.files(visit));
            }
            fn fields(&mut self, path: &str, visit: &mut VisitField<'_>) {
                if visit(path, self) {
                    for (i, part) in self.iter_mut().enumerate() {
                        let path = if $numbered { format!("{path}.{i}") } else { path.to_owned() };
                        part.fields(&path, visit);
                    }
                }
            }
            fn anisotropic(&self) -> bool {
                self.iter().any(Part::anisotropic)
            }
        })*
    };
}

part_of_parts! {
    [T: Part] Option<T>, numbered: false;
    [T: Part] Vec<T>, numbered: true;
    [T: Part, const N: usize] [T; N], numbered: true;
}

impl<T: Part> Part for Box<T> {
    fn references(&self, visit: &mut dyn FnMut(Reference)) {
        self.as_ref().references(visit);
    }
    fn references_mut(&mut self, visit: &mut dyn FnMut(&mut Reference)) {
        self.as_mut().references_mut(visit);
    }
    fn files<'a>(&'a self, visit: &mut dyn FnMut(&'a Path)) {
        self.as_ref().files(visit);
    }
    fn fields(&mut self, path: &str, visit: &mut VisitField<'_>) {
        self.as_mut().fields(path, visit);
    }
    fn anisotropic(&self) -> bool {
        self.as_ref().anisotropic()
    }
}

/// A weight and what it weighs.
impl<T: Part> Part for (f64, T) {
    fn references(&self, visit: &mut dyn FnMut(Reference)) {
        self.1.references(visit);
    }
    fn references_mut(&mut self, visit: &mut dyn FnMut(&mut Reference)) {
        self.1.references_mut(visit);
    }
    fn files<'a>(&'a self, visit: &mut dyn FnMut(&'a Path)) {
        self.1.files(visit);
    }
    fn fields(&mut self, path: &str, visit: &mut VisitField<'_>) {
        self.0.fields(&format!("{path}.weight"), visit);
        self.1.fields(path, visit);
    }
    fn anisotropic(&self) -> bool {
        self.1.anisotropic()
    }
}

impl<T: 'static> Part for Arc<T> {
    fn references(&self, _: &mut dyn FnMut(Reference)) {}
    fn references_mut(&mut self, _: &mut dyn FnMut(&mut Reference)) {}
    fn fields(&mut self, path: &str, visit: &mut VisitField<'_>) {
        visit(path, self);
    }
}

/// Types that refer to nothing.
macro_rules! plain {
    ($($type:ty),* $(,)?) => {
        $(impl $crate::ir::table::Part for $type {
            fn references(&self, _: &mut dyn FnMut($crate::ir::arena::Reference)) {}
            fn references_mut(&mut self, _: &mut dyn FnMut(&mut $crate::ir::arena::Reference)) {}
            fn fields(&mut self, path: &str, visit: &mut $crate::ir::table::VisitField<'_>) {
                visit(path, self);
            }
        })*
    };
}

plain! { bool, u32, f64, String, PathBuf }

/// Structs with a `path`: a file that must be there, and no references.
macro_rules! file {
    ($($type:ty),* $(,)?) => {
        $(impl $crate::ir::table::Part for $type {
            fn references(&self, _: &mut dyn FnMut($crate::ir::arena::Reference)) {}
            fn references_mut(&mut self, _: &mut dyn FnMut(&mut $crate::ir::arena::Reference)) {}
            fn files<'a>(&'a self, visit: &mut dyn FnMut(&'a std::path::Path)) {
                visit(&self.path);
            }
            fn fields(&mut self, path: &str, visit: &mut $crate::ir::table::VisitField<'_>) {
                visit(path, self);
            }
        })*
    };
}

/// An enum of kinds, one row each: `"name" => Kind`, with fields in braces or one part as `(name: Type)`. With
/// `says fact: Type` in the head, each row has its fact in brackets after the name.
macro_rules! kinds {
    (
        $(#[$attribute:meta])*
        pub enum $Enum:ident {
            $($(#[$doc:meta])* $name:literal => $Kind:ident
                $(($(#[$part_doc:meta])* $part:ident: $Part:ty))?
                $({ $($(#[$field_doc:meta])* $field:ident: $Field:ty),* $(,)? })?
            ),* $(,)?
        }
    ) => {
        $(#[$attribute])*
        pub enum $Enum {
            $($(#[$doc])* $Kind $(($Part))? $({ $($(#[$field_doc])* $field: $Field),* })?,)*
        }

        impl $Enum {
            /// What messages call the kind.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Self::$Kind { .. } => $name,)*
                }
            }
        }

        #[allow(unused_variables, reason = "kinds without parts")]
        impl $crate::ir::table::Part for $Enum {
            fn references(&self, visit: &mut dyn FnMut($crate::ir::arena::Reference)) {
                match self {
                    $(Self::$Kind $(($part))? $({ $($field),* })? => {
                        $($crate::ir::table::Part::references($part, visit);)?
                        $($($crate::ir::table::Part::references($field, visit);)*)?
                    })*
                }
            }

            fn references_mut(&mut self, visit: &mut dyn FnMut(&mut $crate::ir::arena::Reference)) {
                match self {
                    $(Self::$Kind $(($part))? $({ $($field),* })? => {
                        $($crate::ir::table::Part::references_mut($part, visit);)?
                        $($($crate::ir::table::Part::references_mut($field, visit);)*)?
                    })*
                }
            }

            fn files<'a>(&'a self, visit: &mut dyn FnMut(&'a std::path::Path)) {
                match self {
                    $(Self::$Kind $(($part))? $({ $($field),* })? => {
                        $($crate::ir::table::Part::files($part, visit);)?
                        $($($crate::ir::table::Part::files($field, visit);)*)?
                    })*
                }
            }

            fn fields(&mut self, path: &str, visit: &mut $crate::ir::table::VisitField<'_>) {
                if !visit(path, self) {
                    return;
                }
                match self {
                    $(Self::$Kind $(($part))? $({ $($field),* })? => {
                        $($crate::ir::table::Part::fields($part, path, visit);)?
                        $($(
                            let field_path = $crate::ir::table::joined(path, stringify!($field));
                            $crate::ir::table::Part::fields($field, &field_path, visit);
                        )*)?
                    })*
                }
            }

            fn anisotropic(&self) -> bool {
                match self {
                    $(Self::$Kind $(($part))? $({ $($field),* })? => {
                        false
                            $(|| $crate::ir::table::Part::anisotropic($part))?
                            $($(|| $crate::ir::table::Part::anisotropic($field))*)?
                    })*
                }
            }
        }
    };
    (
        $(#[$attribute:meta])*
        pub enum $Enum:ident says $(#[$fact_doc:meta])* $says:ident: $Fact:ty {
            $($(#[$doc:meta])* $name:literal [$fact:expr] => $Kind:ident
                $(($(#[$part_doc:meta])* $part:ident: $Part:ty))?
                $({ $($(#[$field_doc:meta])* $field:ident: $Field:ty),* $(,)? })?
            ),* $(,)?
        }
    ) => {
        $crate::ir::table::kinds! {
            $(#[$attribute])*
            pub enum $Enum {
                $($(#[$doc])* $name => $Kind
                    $(($(#[$part_doc])* $part: $Part))?
                    $({ $($(#[$field_doc])* $field: $Field),* })?
                ),*
            }
        }

        impl $Enum {
            $(#[$fact_doc])*
            pub fn $says(&self) -> $Fact {
                match self {
                    $(Self::$Kind { .. } => $fact,)*
                }
            }
        }
    };
}

/// A struct whose references are those of its fields.
macro_rules! record {
    (
        $(#[$attribute:meta])*
        pub struct $Struct:ident {
            $($(#[$doc:meta])* pub $field:ident: $Field:ty),* $(,)?
        }
    ) => {
        $(#[$attribute])*
        pub struct $Struct {
            $($(#[$doc])* pub $field: $Field,)*
        }

        impl $crate::ir::table::Part for $Struct {
            fn references(&self, visit: &mut dyn FnMut($crate::ir::arena::Reference)) {
                $($crate::ir::table::Part::references(&self.$field, visit);)*
            }

            fn references_mut(&mut self, visit: &mut dyn FnMut(&mut $crate::ir::arena::Reference)) {
                $($crate::ir::table::Part::references_mut(&mut self.$field, visit);)*
            }

            fn files<'a>(&'a self, visit: &mut dyn FnMut(&'a std::path::Path)) {
                $($crate::ir::table::Part::files(&self.$field, visit);)*
            }

            fn fields(&mut self, path: &str, visit: &mut $crate::ir::table::VisitField<'_>) {
                if visit(path, self) {
                    $(
                        let field_path = $crate::ir::table::joined(path, stringify!($field));
                        $crate::ir::table::Part::fields(&mut self.$field, &field_path, visit);
                    )*
                }
            }

            fn anisotropic(&self) -> bool {
                false $(|| $crate::ir::table::Part::anisotropic(&self.$field))*
            }
        }
    };
}

pub(super) use {file, kinds, plain, record};
