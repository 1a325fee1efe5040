//! XML to be written.

pub(super) use crate::write::number;
use quick_xml::Writer;
use quick_xml::events::{BytesEnd, BytesStart, BytesText, Event};

use crate::ir::Transform;

/// An element with the comments that stand before it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Element {
    tag: &'static str,
    attributes: Vec<(&'static str, String)>,
    comments: Vec<String>,
    children: Vec<Element>,
}

impl Element {
    pub fn new(tag: &'static str) -> Self {
        Self { tag, attributes: Vec::new(), comments: Vec::new(), children: Vec::new() }
    }

    /// An object of a plugin.
    pub fn plugin(tag: &'static str, kind: &str) -> Self {
        Self::new(tag).with("type", kind)
    }

    pub fn with(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.attributes.push((name, value.into()));
        self
    }

    pub fn id(self, id: Option<&str>) -> Self {
        match id {
            Some(id) => self.with("id", id),
            None => self,
        }
    }

    pub fn child(mut self, child: Element) -> Self {
        self.children.push(child);
        self
    }

    pub fn children(mut self, children: impl IntoIterator<Item = Element>) -> Self {
        self.children.extend(children);
        self
    }

    pub fn comment(mut self, text: impl Into<String>) -> Self {
        self.comments.push(text.into());
        self
    }

    /// A checkerboard, and those within it, with its colours exchanged: as one number, Mitsuba takes each for the other.
    pub fn exchanged(mut self) -> Self {
        if !self.is_checkerboard() {
            return self;
        }
        let named = |child: &Self, name: &str| child.attributes.contains(&("name", name.to_owned()));
        for (name, default) in [("color0", 0.4), ("color1", 0.2)] {
            if !self.children.iter().any(|child| named(child, name)) {
                self = self.float(name, default);
            }
        }
        for child in &mut self.children {
            *child = child.clone().exchanged();
            for (_, value) in child.attributes.iter_mut().filter(|(attribute, _)| *attribute == "name") {
                match value.as_str() {
                    "color0" => *value = "color1".to_owned(),
                    "color1" => *value = "color0".to_owned(),
                    _ => {}
                }
            }
        }
        self
    }

    /// Whether it is that plugin.
    pub fn is_checkerboard(&self) -> bool {
        self.attributes.contains(&("type", "checkerboard".to_owned()))
    }

    /// Whether it has this tag.
    pub fn is(&self, tag: &str) -> bool {
        self.tag == tag
    }

    /// What stands in it.
    pub fn nested(&self) -> &[Self] {
        &self.children
    }

    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(known, _)| *known == name).map(|(_, value)| value.as_str())
    }

    /// Tag and attributes, but for the id.
    pub fn head(&self) -> String {
        let said = self.attributes.iter().filter(|(name, _)| *name != "id");
        said.fold(self.tag.to_owned(), |text, (name, value)| format!("{text} {name}={value:?}"))
    }

    pub fn is_reference(&self) -> bool {
        self.tag == "ref"
    }

    /// Whether it is an object of this plugin.
    pub fn is_a(&self, kind: &str) -> bool {
        self.attribute("type") == Some(kind)
    }

    /// Whether it has at most `limit` elements, itself included.
    pub fn is_within(&self, limit: usize) -> bool {
        self.left_of(limit).is_some()
    }

    fn left_of(&self, limit: usize) -> Option<usize> {
        self.children.iter().try_fold(limit.checked_sub(1)?, |left, child| child.left_of(left))
    }

    pub fn string(self, name: &str, value: &str) -> Self {
        self.scalar("string", name, value)
    }

    pub fn float(self, name: &str, value: f64) -> Self {
        self.scalar("float", name, &number(value))
    }

    /// Only when it differs from what the reader assumes.
    pub fn float_unless(self, name: &str, value: f64, default: f64) -> Self {
        if value == default { self } else { self.float(name, value) }
    }

    pub fn integer(self, name: &str, value: i64) -> Self {
        self.scalar("integer", name, &value.to_string())
    }

    pub fn boolean(self, name: &str, value: bool) -> Self {
        self.scalar("boolean", name, if value { "true" } else { "false" })
    }

    pub fn boolean_unless(self, name: &str, value: bool, default: bool) -> Self {
        if value == default { self } else { self.boolean(name, value) }
    }

    /// `point` or `vector`.
    pub fn triple(self, tag: &'static str, name: &str, value: [f64; 3]) -> Self {
        self.child(Element::new(tag).with("name", name).with("value", numbers(&value)))
    }

    /// Nothing for the identity; translations and scalings as such, others as a matrix.
    pub fn transform(self, name: &str, m: &Transform) -> Self {
        if *m == Transform::IDENTITY {
            return self;
        }
        let [tx, ty, tz] = [m.0[0][3], m.0[1][3], m.0[2][3]];
        let translation = Transform::translate([tx, ty, tz]);
        let scale = [m.0[0][0], m.0[1][1], m.0[2][2]];
        let xyz = |tag, v: [f64; 3]| Element::new(tag).with("value", numbers(&v));
        let mut element = Element::new("transform").with("name", name);
        if let Some([origin, target, up]) = as_look_at(m) {
            element.children.push(
                Element::new("lookat")
                    .with("origin", numbers(&origin))
                    .with("target", numbers(&target))
                    .with("up", numbers(&up)),
            );
        } else if translation.after(&Transform::scale(scale)) == *m {
            if scale != [1.0; 3] {
                element.children.push(xyz("scale", scale));
            }
            if [tx, ty, tz] != [0.0; 3] {
                element.children.push(xyz("translate", [tx, ty, tz]));
            }
        } else {
            let rows: Vec<String> = m.0.iter().map(|row| numbers(row)).collect();
            element.children.push(Element::new("matrix").with("value", rows.join(",  ")));
        }
        self.child(element)
    }

    fn scalar(self, tag: &'static str, name: &str, value: &str) -> Self {
        self.child(Element::new(tag).with("name", name).with("value", value))
    }
}

/// The three points of a `lookat` that is this matrix to the last bit, and no mere translation.
fn as_look_at(m: &Transform) -> Option<[[f64; 3]; 3]> {
    let column = |j: usize| [m.0[0][j], m.0[1][j], m.0[2][j]];
    let (origin, forward, up) = (column(3), column(2), column(1));
    if forward == [0.0, 0.0, 1.0] {
        return None;
    }
    let target = std::array::from_fn(|i| origin[i] + forward[i]);
    (Transform::look_at(origin, target, up)? == *m).then_some([origin, target, up])
}

pub(super) fn numbers(values: &[f64]) -> String {
    values.iter().map(|v| number(*v)).collect::<Vec<_>>().join(", ")
}

/// `root` as a document, indented by tabs.
pub(super) fn print(root: &Element) -> String {
    let mut writer = Writer::new_with_indent(Vec::new(), b'\t', 1);
    // Writing to memory does not fail.
    let _ = event(&mut writer, root);
    let mut bytes = writer.into_inner();
    bytes.push(b'\n');
    String::from_utf8_lossy(&bytes).into_owned()
}

fn event(writer: &mut Writer<Vec<u8>>, element: &Element) -> std::io::Result<()> {
    for comment in &element.comments {
        // Two hyphens would end it.
        let text = comment.replace("--", "- -");
        writer.write_event(Event::Comment(BytesText::from_escaped(format!(" {text} "))))?;
    }
    let mut start = BytesStart::new(element.tag);
    for (name, value) in &element.attributes {
        // A dollar sign would ask for a parameter.
        start.push_attribute((*name, value.replace('$', "\\$").as_str()));
    }
    if element.children.is_empty() {
        return writer.write_event(Event::Empty(start));
    }
    writer.write_event(Event::Start(start))?;
    for child in &element.children {
        event(writer, child)?;
    }
    writer.write_event(Event::End(BytesEnd::new(element.tag)))
}
