//! Third pass: old names become current ones. Changes of meaning are left to the readers of the concepts, which
//! know the dialect.

use super::tree::{Attribute, Element};
use super::version::{Dialect, Version};

/// Renames throughout `root`; `versions` is indexed by file number.
pub(super) fn upgrade(root: &mut Element, versions: &[Version]) {
    let version = versions[root.tag_span.file as usize];
    if root.tag == "lookAt" {
        root.tag = "lookat".to_owned();
    }
    if let Some(kind) = root.attributes.iter_mut().find(|a| a.name == "type") {
        kind.value = kind.value.to_ascii_lowercase();
    }
    if version.dialect() == Dialect::Old {
        if version < Version(0, 4, 0) {
            before_0_4(root);
        }
        if version < Version(0, 3, 0) {
            before_0_3(root);
        }
        if version < Version(0, 5, 0) {
            set_plugin(root, &[("bump", "bumpmap")]);
        }
        if let Some(name) = root.attributes.iter_mut().find(|a| a.name == "name") {
            name.value = snake_case(&name.value);
        }
    }
    // The bsdfs of an OBJ file have the names of its materials, which are the author's.
    let is_obj = root.tag == "shape" && root.value("type") == Some("obj");
    for child in &mut root.children {
        let own = child.value("name").filter(|_| is_obj && matches!(child.tag.as_str(), "bsdf" | "ref"));
        let own = own.map(str::to_owned);
        upgrade(child, versions);
        if let (Some(own), Some(name)) = (own, child.attributes.iter_mut().find(|a| a.name == "name")) {
            name.value = own;
        }
    }
}

/// `toWorld` → `to_world`, `intIOR` → `int_ior`: an underscore before each run of capitals.
pub(super) fn snake_case(name: &str) -> String {
    if name.contains('[') {
        return name.to_owned();
    }
    let mut out = String::with_capacity(name.len() + 4);
    let mut before: Option<char> = None;
    for c in name.chars() {
        if c.is_ascii_uppercase() && before.is_some_and(|b| b.is_ascii_lowercase() || b.is_ascii_digit()) {
            out.push('_');
        }
        out.push(c.to_ascii_lowercase());
        before = Some(c);
    }
    out
}

/// The inverse of [`snake_case`], for suggestions in old files.
pub(super) fn camel_case(name: &str) -> String {
    let mut out = String::with_capacity(name.len());
    for (i, part) in name.split('_').enumerate() {
        match part {
            "ior" if i > 0 => out.push_str("IOR"),
            _ if i > 0 && !part.is_empty() => {
                out.push_str(&part[..1].to_ascii_uppercase());
                out.push_str(&part[1..]);
            }
            _ => out.push_str(part),
        }
    }
    out
}

fn before_0_4(element: &mut Element) {
    match element.tag.as_str() {
        "camera" => element.tag = "sensor".to_owned(),
        "luminaire" => element.tag = "emitter".to_owned(),
        _ => {}
    }
    set_plugin(element, &[("errctrl", "adaptive"), ("exrfilm", "hdrfilm"), ("pngfilm", "ldrfilm")]);
    let plugin = element.value("type").unwrap_or_default().to_owned();
    match (element.tag.as_str(), plugin.as_str()) {
        ("emitter", "area" | "constant") => rename(element, &[("intensity", "radiance")]),
        ("emitter", "directional") => rename(element, &[("intensity", "irradiance")]),
        ("sensor", _) => {
            rename(element, &[("focusDepth", "focusDistance"), ("mapSmallerSide", "fovAxis")]);
            named(element, "fovAxis").for_each(|child| choice(child, "fovAxis", ["smaller", "larger"]));
            mirror_sensor(element);
        }
        ("film", _) => {
            named(element, "alpha").for_each(|child| choice(child, "pixelFormat", ["rgba", "rgb"]));
        }
        ("sampler", _) => rename(element, &[("depth", "dimension")]),
        ("blackbody", _) => {
            for attribute in element.attributes.iter_mut().filter(|a| a.name == "multiplier") {
                attribute.name = "scale".to_owned();
            }
        }
        _ => {}
    }
    if element.tag == "emitter" {
        rename(element, &[("intensityScale", "scale")]);
    }
    rename(element, &[("luminaireSamples", "emitterSamples")]);
}

/// Makes a boolean a string called `name`, with one of two words: the first for `true`.
fn choice(child: &mut Element, name: &str, [yes, no]: [&str; 2]) {
    if child.tag != "boolean" {
        return;
    }
    child.tag = "string".to_owned();
    for attribute in &mut child.attributes {
        match attribute.name.as_str() {
            "name" => attribute.value = name.to_owned(),
            "value" => attribute.value = if attribute.value.trim() == "true" { yes } else { no }.to_owned(),
            _ => {}
        }
    }
}

fn before_0_3(element: &mut Element) {
    let is_mirror = element.tag == "bsdf" && element.value("type") == Some("mirror");
    set_plugin(
        element,
        &[
            ("lambertian", "diffuse"),
            ("mirror", "conductor"),
            ("microfacet", "roughplastic"),
            ("roughmetal", "roughconductor"),
            ("roughglass", "roughdielectric"),
            ("composite", "mixturebsdf"),
            ("exrtexture", "bitmap"),
            ("ldrtexture", "bitmap"),
        ],
    );
    if is_mirror {
        let none = made(element, "string", &[("name", "material"), ("value", "none")]);
        element.children.push(none);
    }
    let plugin = element.value("type").unwrap_or_default().to_owned();
    match plugin.as_str() {
        "sphere" => rename(element, &[("inverted", "flipNormals")]),
        "cylinder" => rename(element, &[("p1", "p0"), ("p2", "p1")]),
        "checkerboard" | "gridtexture" => {
            rename(element, &[("brightColor", "color0"), ("darkColor", "color1")]);
        }
        "ward" => rename(element, &[("alphaX", "alphaU"), ("alphaY", "alphaV")]),
        "obj" if named(element, "flipTexCoords").next().is_none() => {
            let upright = made(element, "boolean", &[("name", "flipTexCoords"), ("value", "false")]);
            element.children.push(upright);
        }
        _ => {}
    }
    if element.tag == "transform" {
        nine_number_look_at(element);
    }
}

/// `lookAt ox oy oz tx ty tz ux uy uz` is mirrored against the one with three points.
fn nine_number_look_at(transform: &mut Element) {
    let Some(at) = transform.children.iter().position(|c| c.attribute("ox").is_some()) else { return };
    let old = &transform.children[at];
    let triple = |axis: char| {
        let part = |c: char| old.value(&format!("{axis}{c}")).unwrap_or("0").to_owned();
        format!("{}, {}, {}", part('x'), part('y'), part('z'))
    };
    let points = [("origin", triple('o')), ("target", triple('t')), ("up", triple('u'))];
    let points: Vec<_> = points.iter().map(|(name, value)| (*name, value.as_str())).collect();
    let look_at = made(old, "lookat", &points);
    let mirror = made(old, "scale", &[("x", "-1")]);
    transform.children.splice(at..=at, [mirror, look_at]);
}

/// Before 0.4 the camera's +X was on the other side of the picture.
fn mirror_sensor(sensor: &mut Element) {
    let mirror = made(sensor, "scale", &[("x", "-1")]);
    if let Some(transform) = named(sensor, "toWorld").find(|c| c.tag == "transform") {
        transform.children.insert(0, mirror);
        return;
    }
    let mut transform = made(sensor, "transform", &[("name", "toWorld")]);
    transform.children.push(mirror);
    sensor.children.push(transform);
}

fn named<'a>(element: &'a mut Element, name: &'a str) -> impl Iterator<Item = &'a mut Element> {
    element.children.iter_mut().filter(move |c| c.value("name") == Some(name))
}

fn rename(element: &mut Element, table: &[(&str, &str)]) {
    for child in &mut element.children {
        if let Some(name) = child.attributes.iter_mut().find(|a| a.name == "name")
            && let Some((_, new)) = table.iter().find(|(old, _)| *old == name.value)
        {
            name.value = (*new).to_owned();
        }
    }
}

fn set_plugin(element: &mut Element, table: &[(&str, &str)]) {
    if let Some(kind) = element.attributes.iter_mut().find(|a| a.name == "type")
        && let Some((_, new)) = table.iter().find(|(old, _)| *old == kind.value)
    {
        kind.value = (*new).to_owned();
    }
}

/// A new element that stands where `place` stands.
fn made(place: &Element, tag: &str, attributes: &[(&str, &str)]) -> Element {
    let span = place.tag_span;
    let attribute = |(name, value): &(&str, &str)| Attribute {
        name: (*name).to_owned(),
        name_span: span,
        value: (*value).to_owned(),
        value_span: span,
    };
    Element {
        tag: tag.to_owned(),
        tag_span: span,
        attributes: attributes.iter().map(attribute).collect(),
        children: Vec::new(),
        broken: false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_go_both_ways() {
        for (old, new) in [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("wrapModeU", "wrap_mode_u"),
            ("p0", "p0"),
            ("maxSmoothAngle", "max_smooth_angle"),
        ] {
            assert_eq!(snake_case(old), new);
            assert_eq!(camel_case(new), old);
        }
        assert_eq!(snake_case("metadata['someKey']"), "metadata['someKey']");
    }
}
