//! Material libraries of OBJ files, read with `tobj`.

use super::parts::name;
use super::{Words, take_statement, text};
use crate::encoding::to_utf8;

/// A material as Mitsuba 0.6 takes it from a library; colours are encoded as sRGB.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjMaterial {
    /// As `usemtl` calls it.
    pub name: String,
    /// `Kd`, 0..1.
    pub diffuse: Option<[f32; 3]>,
    /// `Ks`, 0..1.
    pub specular: Option<[f32; 3]>,
    /// `Ns`.
    pub exponent: Option<f32>,
    /// `d`: 1 is opaque.
    pub opacity: Option<f32>,
    /// `illum`.
    pub model: u8,
    /// `map_Kd`.
    pub diffuse_map: Option<String>,
    /// `map_Ks`.
    pub specular_map: Option<String>,
    /// `bump`.
    pub bump_map: Option<String>,
    /// `map_d`.
    pub opacity_map: Option<String>,
}

/// Reads a material library. Statements that Mitsuba 0.6 does not know or that are malformed say nothing.
pub fn read_mtl(bytes: &[u8]) -> Vec<ObjMaterial> {
    let bytes = to_utf8(bytes);
    let text = text(&bytes);
    let (mut rest, mut mended) = (&*text, String::new());
    while !rest.is_empty() {
        let (statement, _) = take_statement(&mut rest);
        if let Some(line) = mend(statement) {
            mended.push_str(&line);
            mended.push('\n');
        }
    }
    // What is left are statements that `tobj` takes.
    let (materials, _) = tobj::load_mtl_buf(&mut mended.as_bytes()).unwrap_or_default();
    materials.into_iter().map(material).collect()
}

/// The statement as `tobj` reads it without failing; `None` for what says nothing.
fn mend(statement: &str) -> Option<String> {
    let mut words = Words::new(statement);
    let first = words.next()?;
    match first {
        "newmtl" | "map_Kd" | "map_Ks" | "map_d" | "bump" => {
            let name = name(statement);
            (!name.is_empty()).then(|| format!("{first} {name}"))
        }
        "Kd" | "Ks" => {
            let numbers: Vec<f32> = words.map_while(|word| word.parse().ok()).collect();
            let rgb = <[f32; 3]>::try_from(numbers.get(..3)?).ok()?;
            let [r, g, b] = rgb.map(|c| if c.is_finite() { c.clamp(0.0, 1.0) } else { 0.0 });
            Some(format!("{first} {r} {g} {b}"))
        }
        "Ns" | "d" => {
            // Before the number there may be an option.
            let number = words.filter_map(|word| word.parse::<f32>().ok()).last()?;
            number.is_finite().then(|| format!("{first} {number}"))
        }
        "illum" => words.next()?.parse::<u8>().ok().map(|model| format!("illum {model}")),
        _ => None,
    }
}

fn material(m: tobj::Material) -> ObjMaterial {
    ObjMaterial {
        name: m.name,
        diffuse: m.diffuse,
        specular: m.specular,
        exponent: m.shininess,
        opacity: m.dissolve,
        model: m.illumination_model.unwrap_or(0),
        diffuse_map: m.diffuse_texture,
        specular_map: m.specular_texture,
        bump_map: m.normal_texture,
        opacity_map: m.dissolve_texture,
    }
}
