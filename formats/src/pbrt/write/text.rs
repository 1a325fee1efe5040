//! Directives as text.

use std::fmt::Write;

use crate::ir::Transform;
use crate::write::number;

/// A list of typed parameters.
#[derive(Clone, Debug, Default)]
pub struct Params(Vec<String>);

impl Params {
    fn add(mut self, kind: &str, name: &str, value: impl AsRef<str>) -> Self {
        self.0.push(format!("\"{kind} {name}\" {}", value.as_ref()));
        self
    }

    pub fn float(self, name: &str, v: f64) -> Self {
        self.add("float", name, number(v))
    }

    pub fn float_unless(self, name: &str, v: f64, default: f64) -> Self {
        if v == default { self } else { self.float(name, v) }
    }

    pub fn integer(self, name: &str, v: i64) -> Self {
        self.add("integer", name, v.to_string())
    }

    pub fn integers(self, name: &str, v: impl IntoIterator<Item = u32>) -> Self {
        self.add("integer", name, list(v.into_iter().map(|v| v.to_string())))
    }

    pub fn boolean_unless(self, name: &str, v: bool, default: bool) -> Self {
        if v == default { self } else { self.add("bool", name, v.to_string()) }
    }

    pub fn string(self, name: &str, v: &str) -> Self {
        self.add("string", name, quoted(v))
    }

    /// What a named material is, before its parameters.
    pub fn of_type(mut self, plugin: &str) -> Self {
        self.0.insert(0, format!("\"string type\" {}", quoted(plugin)));
        self
    }

    pub fn strings(self, name: &str, v: &[&str]) -> Self {
        self.add("string", name, list(v.iter().map(|v| quoted(v))))
    }

    pub fn texture(self, name: &str, texture: &str) -> Self {
        self.add("texture", name, quoted(texture))
    }

    pub fn spectrum(self, name: &str, library: &str) -> Self {
        self.add("spectrum", name, quoted(library))
    }

    pub fn rgb(self, name: &str, rgb: [f64; 3]) -> Self {
        self.add("rgb", name, list(rgb.map(number)))
    }

    pub fn numbers(self, kind: &str, name: &str, v: impl IntoIterator<Item = f64>) -> Self {
        self.add(kind, name, list(v.into_iter().map(number)))
    }

    /// Many numbers in the precision they are kept in.
    pub fn singles(self, kind: &str, name: &str, v: impl IntoIterator<Item = f32>) -> Self {
        self.add(kind, name, list(v.into_iter().map(|v| v.to_string())))
    }

    /// Coordinates in the precision they are kept in.
    pub fn coordinates<const N: usize>(self, kind: &str, name: &str, v: &[[f32; N]]) -> Self {
        if v.is_empty() { self } else { self.add(kind, name, list(v.iter().flatten().map(f32::to_string))) }
    }

    /// `directive` with its names and these parameters; long ones take a line each.
    pub fn write(&self, text: &mut String, indent: &str, directive: &str, names: &[&str]) {
        let _ = write!(text, "{indent}{directive}");
        for name in names {
            let _ = write!(text, " {}", quoted(name));
        }
        let length: usize = self.0.iter().map(|p| p.len() + 1).sum();
        for p in &self.0 {
            let _ = if length > 90 { write!(text, "\n{indent}\t{p}") } else { write!(text, " {p}") };
        }
        text.push('\n');
    }
}

fn list(items: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", items.into_iter().collect::<Vec<_>>().join(" "))
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "/").replace('"', "'"))
}

/// Sets the transform, in pbrt's order: column after column.
pub fn transform(text: &mut String, indent: &str, m: &Transform) {
    let columns = (0..4).flat_map(|c| (0..4).map(move |r| number(m.0[r][c])));
    let _ = writeln!(text, "{indent}Transform {}", list(columns));
}
