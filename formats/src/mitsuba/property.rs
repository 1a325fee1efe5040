//! Property elements to values: `<float>`, `<rgb>`, `<transform>` and the rest.

use std::path::PathBuf;

use super::expand::check_attributes;
use super::number::{self, floats};
use super::object::Value;
use super::tree::Element;
use super::version::Dialect;
use crate::diagnostic::{Diagnostic, Span};
use crate::files::Files;
use crate::ir::{Color, Transform};
use crate::missing::{find, not_found};
use crate::spectrum::parse_spd;

/// Elements that are parameters rather than objects.
pub(super) const PROPERTY_TAGS: &[&str] = &[
    "boolean",
    "integer",
    "float",
    "string",
    "point",
    "vector",
    "rgb",
    "srgb",
    "blackbody",
    "spectrum",
    "transform",
    "animation",
];

pub(super) struct PropertyReader<'a> {
    pub files: &'a dyn Files,
    /// Searched for `.spd` files.
    pub folders: Vec<PathBuf>,
    /// Of the file the element stands in.
    pub dialect: Dialect,
    pub problems: &'a mut Vec<Diagnostic>,
}

impl PropertyReader<'_> {
    /// The value of a property element; [`Value::Broken`] after reporting a problem.
    pub fn value(&mut self, element: &Element) -> Value {
        if element.broken {
            return Value::Broken;
        }
        self.read(element).unwrap_or(Value::Broken)
    }

    fn read(&mut self, element: &Element) -> Option<Value> {
        let tag = element.tag.as_str();
        if !matches!(tag, "transform" | "animation")
            && let Some(child) = element.children.first()
        {
            self.error::<()>(format!("<{tag}> may not contain other elements"), child.tag_span);
        }
        match tag {
            "transform" => {
                check_attributes(element, &["name", "time"], self.problems);
                self.transform(element).map(Value::Transform)
            }
            "animation" => self.animation(element),
            "point" | "vector" => {
                check_attributes(element, &["name", "value", "x", "y", "z"], self.problems);
                let xyz = self.triple(element, None)?;
                Some(if tag == "point" { Value::Point(xyz) } else { Value::Vector(xyz) })
            }
            "rgb" | "srgb" => {
                check_attributes(element, &["name", "value", "intent"], self.problems);
                self.rgb(element)
            }
            "spectrum" => {
                check_attributes(element, &["name", "value", "filename", "intent"], self.problems);
                self.spectrum(element).map(|color| Value::Color { color, tag: "spectrum" })
            }
            "blackbody" => {
                check_attributes(element, &["name", "temperature", "scale"], self.problems);
                self.blackbody(element)
            }
            _ => {
                check_attributes(element, &["name", "value"], self.problems);
                self.scalar(element)
            }
        }
    }

    fn scalar(&mut self, element: &Element) -> Option<Value> {
        let text = self.attribute(element, "value")?;
        let span = element.place("value");
        match element.tag.as_str() {
            "boolean" => {
                let word = text.trim();
                let exact = self.dialect == Dialect::Old;
                let is =
                    |wanted: &str| if exact { word == wanted } else { word.eq_ignore_ascii_case(wanted) };
                if is("true") {
                    Some(Value::Boolean(true))
                } else if is("false") {
                    Some(Value::Boolean(false))
                } else {
                    self.error(format!("`{text}` is not a boolean; write `true` or `false`"), span)
                }
            }
            "integer" => match number::integer(text) {
                Some(value) => Some(Value::Integer(value)),
                None => self.error(format!("`{text}` is not an integer"), span),
            },
            "float" => self.float(text, span).map(Value::Float),
            _ => Some(Value::String(text.to_owned())),
        }
    }

    fn rgb(&mut self, element: &Element) -> Option<Value> {
        let text = self.attribute(element, "value")?;
        let span = element.place("value");
        let (components, hex) = match text.trim().strip_prefix('#') {
            Some(digits) => match number::hex(digits) {
                Some(components) => (components, true),
                None => return self.error(format!("`{text}` is not a colour; `#` expects six digits"), span),
            },
            None => (self.one_or_three(text, span)?, false),
        };
        if hex && self.dialect != Dialect::Old {
            self.problems.push(Diagnostic::warning("`#rrggbb` is rejected by Mitsuba 2 and 3", Some(span)));
        }
        Some(if element.tag == "srgb" {
            Value::Color { color: Color::Srgb(components), tag: "srgb" }
        } else {
            Value::Color { color: Color::Rgb(components), tag: "rgb" }
        })
    }

    fn spectrum(&mut self, element: &Element) -> Option<Color> {
        if let Some(name) = element.value("filename") {
            let span = element.place("filename");
            if element.attribute("value").is_some() {
                return self.error("<spectrum> takes either `value` or `filename`", element.tag_span);
            }
            let Some(path) = find(self.files, name, &self.folders) else {
                self.problems.push(not_found(self.files, "spectrum file", name, span, &self.folders));
                return None;
            };
            let bytes = self.files.read(&path).map_err(|e| e.to_string());
            let samples =
                bytes.and_then(|b| parse_spd(&b).map_err(|e| e.to_string())).and_then(number::ascending);
            return match samples {
                Ok(samples) => Some(Color::Samples(samples)),
                Err(reason) => self.error(format!("{}: {reason}", path.display()), span),
            };
        }
        let text = self.attribute(element, "value")?;
        let span = element.place("value");
        if text.contains(':') {
            return match number::wavelengths(text) {
                Ok(samples) => Some(Color::Samples(samples)),
                Err(reason) => self.error(reason, span),
            };
        }
        match floats(text).as_deref() {
            Some([value]) => Some(Color::UniformSpectrum(*value)),
            Some([r, g, b]) => {
                if self.dialect != Dialect::Old {
                    self.problems.push(
                        Diagnostic::warning(
                            "<spectrum> with three numbers is read as linear RGB",
                            Some(span),
                        )
                        .help("write <rgb>"),
                    );
                }
                Some(Color::Rgb([*r, *g, *b]))
            }
            _ => self.error("<spectrum> expects one number, or `wavelength:value` pairs", span),
        }
    }

    fn blackbody(&mut self, element: &Element) -> Option<Value> {
        let text = self.attribute(element, "temperature")?;
        let number = text.trim().trim_end_matches("[K]").trim_end_matches(['K', 'k']);
        let kelvin = self.float(number, element.place("temperature"))?;
        let scale = match element.value("scale") {
            Some(text) => self.float(text, element.place("scale"))?,
            None => 1.0,
        };
        if kelvin <= 0.0 {
            return self.error("a blackbody needs a positive temperature", element.place("temperature"));
        }
        Some(Value::Color { color: Color::Blackbody { kelvin, scale }, tag: "blackbody" })
    }

    fn animation(&mut self, element: &Element) -> Option<Value> {
        check_attributes(element, &["name"], self.problems);
        let key = |e: &Element| e.value("time").and_then(number::float).unwrap_or(0.0);
        let first =
            element.children.iter().filter(|c| c.tag == "transform").min_by(|a, b| key(a).total_cmp(&key(b)));
        let Some(first) = first else {
            return self.error("<animation> needs a <transform>", element.tag_span);
        };
        if element.children.len() > 1 {
            self.problems.push(Diagnostic::warning(
                "motion is not rendered: only the first key frame of the animation is used",
                Some(element.tag_span),
            ));
        }
        self.transform(first).map(Value::Transform)
    }

    fn transform(&mut self, element: &Element) -> Option<Transform> {
        let mut all = Some(Transform::IDENTITY);
        for child in &element.children {
            let step = if child.broken { None } else { self.step(child) };
            all = all.zip(step).map(|(before, step)| step.after(&before));
        }
        all
    }

    fn step(&mut self, element: &Element) -> Option<Transform> {
        match element.tag.as_str() {
            "translate" => {
                check_attributes(element, &["value", "x", "y", "z"], self.problems);
                self.triple(element, Some(0.0)).map(Transform::translate)
            }
            "scale" => {
                check_attributes(element, &["value", "x", "y", "z"], self.problems);
                self.triple(element, Some(1.0)).map(Transform::scale)
            }
            "rotate" => {
                check_attributes(element, &["value", "x", "y", "z", "angle"], self.problems);
                let axis = self.triple(element, Some(0.0))?;
                let angle = self.attribute(element, "angle")?;
                let angle = self.float(angle, element.place("angle"))?;
                self.rotation(element, axis, angle)
            }
            "lookat" => {
                check_attributes(element, &["origin", "target", "up"], self.problems);
                self.look_at(element)
            }
            "matrix" => {
                check_attributes(element, &["value"], self.problems);
                self.matrix(element)
            }
            other => {
                let known = ["translate", "rotate", "scale", "lookat", "matrix"];
                let problem = Diagnostic::error(
                    format!("<{other}> is not part of a transform"),
                    Some(element.tag_span),
                );
                self.problems.push(problem.help(format!("a transform takes: {}", known.join(", "))));
                None
            }
        }
    }

    /// 0.x turns about any axis; later versions take an axis that is no unit vector as it is.
    fn rotation(&mut self, element: &Element, axis: [f64; 3], angle: f64) -> Option<Transform> {
        let Some(proper) = Transform::rotate(axis, angle) else {
            let text = "the axis of <rotate> is zero";
            if angle != 0.0 {
                return self.error(text, element.tag_span);
            }
            let text = format!("{text}, and so is the angle: nothing is turned");
            let problem = Diagnostic::warning(text, Some(element.tag_span));
            self.problems.push(problem.help("Mitsuba 3 rejects this; remove it"));
            return Some(Transform::IDENTITY);
        };
        if self.dialect == Dialect::Old {
            return Some(proper);
        }
        let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        let bent = Transform::rodrigues(axis, angle);
        // Axes written with three digits are meant as they are.
        let text = "the axis of <rotate> is not a unit vector";
        let said = self
            .problems
            .iter()
            .any(|p| p.message.starts_with(text) && p.span.is_some_and(|s| s.file == element.tag_span.file));
        if (length - 1.0).abs() > 5e-3 && angle != 0.0 && !said {
            let volume = bent.determinant3();
            let unit = axis.map(|x| format!("{:.4}", x / length)).join(", ");
            self.problems.push(
                Diagnostic::warning(
                    format!("{text}: Mitsuba 2 and 3 shear and scale by it (volume × {volume:.3})"),
                    Some(element.tag_span),
                )
                .help(format!("for a rotation, as in Mitsuba 0.6, write the axis {unit}"))
                .help("said once for each file"),
            );
        }
        Some(bent)
    }

    fn look_at(&mut self, element: &Element) -> Option<Transform> {
        let mut point = |name: &str| {
            let text = self.attribute(element, name)?;
            self.three(text, element.place(name))
        };
        let (origin, target) = (point("origin")?, point("target")?);
        let up = match element.attribute("up") {
            Some(_) => point("up")?,
            None => {
                // Any direction that is not the view direction.
                let d = [0, 1, 2].map(|i| (target[i] - origin[i]).abs());
                if d[0] <= d[1] { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] }
            }
        };
        let frame = Transform::look_at(origin, target, up);
        frame.or_else(|| {
            let text = "<lookat> gives no frame: the target is the origin, or `up` points along the view";
            self.error(text, element.tag_span)
        })
    }

    fn matrix(&mut self, element: &Element) -> Option<Transform> {
        let text = self.attribute(element, "value")?;
        let span = element.place("value");
        let Some(numbers) = floats(text) else {
            return self.error("<matrix> expects numbers", span);
        };
        let mut m = Transform::IDENTITY;
        let size = match numbers.len() {
            16 => 4,
            9 => 3,
            n => return self.error(format!("<matrix> expects 16 (or 9) numbers, got {n}"), span),
        };
        for (i, number) in numbers.into_iter().enumerate() {
            m.0[i / size][i % size] = number;
        }
        Some(m)
    }

    /// `value` with one or three numbers, or `x y z`. Without a default all three are required.
    fn triple(&mut self, element: &Element, default: Option<f64>) -> Option<[f64; 3]> {
        let axes = ["x", "y", "z"];
        let any = axes.iter().any(|axis| element.attribute(axis).is_some());
        if let Some(text) = element.value("value") {
            if any {
                let text = format!("<{}> takes either `value` or `x`, `y`, `z`", element.tag);
                return self.error(text, element.tag_span);
            }
            return self.one_or_three(text, element.place("value"));
        }
        let mut out = [0.0; 3];
        for (axis, slot) in axes.iter().zip(&mut out) {
            *slot = match (element.value(axis), default) {
                (Some(text), _) => self.float(text, element.place(axis))?,
                (None, Some(default)) => default,
                (None, None) => {
                    return self.error(format!("<{}> needs `x`, `y` and `z`", element.tag), element.tag_span);
                }
            };
        }
        Some(out)
    }

    fn one_or_three(&mut self, text: &str, span: Span) -> Option<[f64; 3]> {
        match floats(text).as_deref() {
            Some([v]) => Some([*v; 3]),
            Some([x, y, z]) => Some([*x, *y, *z]),
            _ => self.error(format!("`{text}` is neither one number nor three"), span),
        }
    }

    fn three(&mut self, text: &str, span: Span) -> Option<[f64; 3]> {
        match floats(text).as_deref() {
            Some([x, y, z]) => Some([*x, *y, *z]),
            _ => self.error(format!("`{text}` is not three numbers"), span),
        }
    }

    fn float(&mut self, text: &str, span: Span) -> Option<f64> {
        number::float(text).or_else(|| self.error(format!("`{text}` is not a number"), span))
    }

    fn attribute<'e>(&mut self, element: &'e Element, name: &str) -> Option<&'e str> {
        let value = element.value(name);
        value.or_else(|| {
            self.error(format!("<{}> needs the attribute `{name}`", element.tag), element.tag_span)
        })
    }

    fn error<T>(&mut self, text: impl Into<String>, span: Span) -> Option<T> {
        self.problems.push(Diagnostic::error(text, Some(span)));
        None
    }
}
