//! Whether two scenes of one language are the same, however their meshes and pictures are kept.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;

use caustica_formats::files::Files;
use caustica_formats::image::{self, Encoding};
use caustica_formats::ir::{
    Bitmap, Color, ColorSlot, Fov, FovAxis, InlineMesh, Integrator, LightImage, MeshFile, Origin, Projection,
    RoughnessRemap, Scalar, Scene, Sensor, SpectrumRule, TextureEncoding, Transform, canonical,
};
use caustica_formats::mesh::{self, Mesh, MeshOptions, builtin};
use caustica_formats::spectrum::{conductor, ior, srgb_to_linear, to_linear_rgb};
use serde_json::{Value, json};

/// The scene as JSON without names and with one form for what can be said in several: colours are linear RGB, meshes
/// and pictures what they hold.
pub fn plain(scene: &Scene, files: &dyn Files) -> Value {
    let mut scene = canonical(scene);
    let integrator = scene.integrator.get_or_insert_with(|| Integrator {
        origin: Origin(None),
        plugin: "path".to_owned(),
        settings: BTreeMap::new(),
        aovs: Default::default(),
    });
    integrator.settings.retain(|name, setting| {
        let idle = [("max_depth", Scalar::Integer(-1)), ("hide_emitters", Scalar::Boolean(false))];
        !idle.iter().any(|(known, value)| known == name && *value == setting.value)
    });
    let hides = integrator.settings.contains_key("hide_emitters");
    scene.sensors.iter_mut().for_each(widen);
    let rule = scene.spectrum_rule;
    let mut value = serde_json::to_value(scene).unwrap_or(Value::Null);
    if let Value::Object(fields) = &mut value {
        fields.remove("spectrum_rule");
        if !hides {
            fields.remove("hide_emitters");
        }
    }
    simplify(&mut value, ColorSlot::Reflectance, rule, files);
    value
}

/// Gives a camera's angle across the width.
fn widen(sensor: &mut Sensor) {
    let Projection::Perspective { fov: Fov::Degrees(degrees), axis } = sensor.projection else { return };
    let (width, height) = (f64::from(sensor.film.width), f64::from(sensor.film.height));
    let along = match axis {
        FovAxis::X => width,
        FovAxis::Y => height,
        FovAxis::Diagonal => width.hypot(height),
        FovAxis::Smaller => width.min(height),
        FovAxis::Larger => width.max(height),
    };
    let tangent = (0.5 * degrees).to_radians().tan() * width / along;
    let fov = Fov::Degrees(2.0 * tangent.atan().to_degrees());
    sensor.projection = Projection::Perspective { fov, axis: FovAxis::X };
}

/// What a colour with this name is.
fn slot_of(name: &str) -> Option<ColorSlot> {
    Some(match name {
        "radiance" | "intensity" | "irradiance" => ColorSlot::Emission,
        "eta" | "k" | "sigma_a" | "sigma_s" | "sigma_t" => ColorSlot::Unbounded,
        name if name.contains("reflectance") || name.contains("transmittance") => ColorSlot::Reflectance,
        _ => return None,
    })
}

/// The linear RGB of a colour, for a value that is one.
fn rgb(value: &Value, slot: ColorSlot, rule: SpectrumRule) -> Option<Value> {
    let color: Color = serde_json::from_value(value.clone()).ok()?;
    to_linear_rgb(&color, slot, rule).ok().map(|rgb| json!({ "rgb": rgb }))
}

fn colors(v: [f64; 3]) -> Value {
    json!({ "Color": { "rgb": v } })
}

/// η and k for metals that are given by names, which are no names of objects.
fn named_metal(fields: &mut serde_json::Map<String, Value>) {
    if let Some(Value::Object(named)) = fields.get("Named")
        && let Some(metal) = named.get("name").and_then(Value::as_str).and_then(conductor)
    {
        let outside = named.get("ext_eta").cloned().unwrap_or(Value::Null);
        let metal = json!({ "eta": colors(metal.eta), "k": colors(metal.k), "ext_eta": outside });
        fields.remove("Named");
        fields.insert("EtaK".to_owned(), metal);
    }
}

/// α of a roughness that is a number.
fn roughness(fields: &mut serde_json::Map<String, Value>) {
    let Some(remap) =
        fields.get("remap").and_then(|v| serde_json::from_value::<RoughnessRemap>(v.clone()).ok())
    else {
        return;
    };
    let number = |v: Option<&Value>| v.and_then(|v| v.get("Value")).and_then(Value::as_f64);
    if let [Some(u), Some(v)] = ["alpha_u", "alpha_v"].map(|name| number(fields.get(name))) {
        for (name, rough) in [("alpha_u", u), ("alpha_v", v)] {
            fields.insert(name.to_owned(), json!({ "Value": remap.alpha(rough) }));
        }
        fields.insert("remap".to_owned(), json!(RoughnessRemap::None));
    }
}

/// η and k in air, for metals that are given by colours.
fn metal(fields: &mut serde_json::Map<String, Value>) {
    let three = |value: &Value| -> Option<[f64; 3]> {
        serde_json::from_value(value.get("Color")?.get("rgb")?.clone()).ok()
    };
    if let Some(r) = fields.get("Reflectance").and_then(three) {
        let k = r.map(|r| r.clamp(0.0, 0.9999)).map(|r| 2.0 * (r / (1.0 - r)).sqrt());
        fields.remove("Reflectance");
        fields.insert("EtaK".to_owned(), json!({ "eta": colors([1.0; 3]), "k": colors(k), "ext_eta": null }));
    }
    let Some(Value::Object(metal)) = fields.get_mut("EtaK") else { return };
    let outside = metal.get("ext_eta").and_then(|outside| match outside.get("Named") {
        Some(name) => ior(name.as_str()?),
        None => outside.get("Value")?.as_f64(),
    });
    if let Some(outside) = outside
        && let (Some(eta), Some(k)) = (metal.get("eta").and_then(three), metal.get("k").and_then(three))
    {
        metal.insert("eta".to_owned(), colors(eta.map(|v| v / outside)));
        metal.insert("k".to_owned(), colors(k.map(|v| v / outside)));
        metal.insert("ext_eta".to_owned(), Value::Null);
    }
}

/// σa and σs of a homogeneous medium, with its scale, to as many digits as survive a change of their form.
fn medium(fields: &mut serde_json::Map<String, Value>) {
    let three = |of: &Value, name: &str| -> Option<[f64; 3]> {
        serde_json::from_value(of.get(name)?.get("Constant")?.get("rgb")?.clone()).ok()
    };
    let (Some(scale), Some(of)) = (fields.get("scale").and_then(Value::as_f64), fields.get("coefficients"))
    else {
        return;
    };
    let pair = |of: Option<&Value>, names: [&str; 2]| Some([three(of?, names[0])?, three(of?, names[1])?]);
    let parts = match pair(of.get("Extinction"), ["sigma_t", "albedo"]) {
        Some([t, albedo]) => {
            let part = |share: fn(f64) -> f64| [0, 1, 2].map(|c| t[c] * share(albedo[c]));
            Some([part(|albedo| 1.0 - albedo), part(|albedo| albedo)])
        }
        None => pair(of.get("Parts"), ["sigma_a", "sigma_s"]),
    };
    if let Some(parts) = parts {
        let short = parts.map(|part| part.map(|v| format!("{:.6e}", v * scale + 0.0)));
        fields.insert("coefficients".to_owned(), json!(short));
        fields.insert("scale".to_owned(), json!(1.0));
    }
}

fn simplify(value: &mut Value, slot: ColorSlot, rule: SpectrumRule, files: &dyn Files) {
    if let Some(rgb) = rgb(value, slot, rule) {
        *value = rgb;
        return;
    }
    match value {
        Value::Array(items) => items.iter_mut().for_each(|item| simplify(item, slot, rule, files)),
        Value::Object(fields) => {
            named_metal(fields);
            roughness(fields);
            fields.remove("name");
            fields.remove("origin");
            if fields.get("kind") == Some(&json!("Cube")) {
                fields.insert(
                    "kind".to_owned(),
                    json!({ "Triangles": triangles(false, Some(builtin::cube())) }),
                );
            }
            if let Some(mesh) = fields.remove("Mesh") {
                fields.insert("Triangles".to_owned(), mesh_of_file(mesh, files));
            } else if let Some(mesh) = fields.remove("Inline") {
                fields.insert("Triangles".to_owned(), inline(mesh));
            }
            if fields.contains_key("path") && fields.contains_key("encoding") {
                picture(fields, files);
            }
            for (name, item) in fields.iter_mut() {
                simplify(item, slot_of(name).unwrap_or(slot), rule, files);
            }
            face_about(fields);
            metal(fields);
            medium(fields);
        }
        _ => {}
    }
}

fn hash(words: impl Iterator<Item = u32>) -> String {
    let mut hasher = DefaultHasher::new();
    words.for_each(|word| word.hash(&mut hasher));
    format!("{:016x}", hasher.finish())
}

fn described(mesh: &Mesh) -> Value {
    let floats = |values: &[f32]| hash(values.iter().map(|v| (v + 0.0).to_bits()));
    json!({
        "positions": floats(mesh.positions.as_flattened()),
        "normals": [mesh.normals.len(), mean(&mesh.normals)],
        "uvs": floats(mesh.uvs.as_flattened()),
        "triangles": hash(mesh.triangles.as_flattened().iter().copied()),
    })
}

/// Writes a mesh or rectangle with `flip_normals` as one that faces the other way.
fn face_about(fields: &mut serde_json::Map<String, Value>) {
    let Some(flipped) = fields.get("flip_normals").map(|flipped| *flipped == json!(true)) else { return };
    if let Some(Value::Object(mesh)) = fields.get_mut("kind").and_then(|kind| kind.get_mut("Triangles")) {
        let reversed = mesh.remove("reversed").unwrap_or(Value::Null);
        if flipped {
            mesh.insert("mesh".to_owned(), reversed);
            fields.insert("flip_normals".to_owned(), json!(false));
        }
        return;
    }
    if flipped
        && fields.get("kind") == Some(&json!("Rectangle"))
        && let Some(m) =
            fields.get("to_world").and_then(|m| serde_json::from_value::<Transform>(m.clone()).ok())
    {
        fields.insert("to_world".to_owned(), json!(m.after(&Transform::scale([1.0, 1.0, -1.0]))));
        fields.insert("flip_normals".to_owned(), json!(false));
    }
}

fn triangles(by_file: bool, mesh: Option<Mesh>) -> Value {
    let Some(mut mesh) = mesh else { return json!({ "by_file": by_file, "mesh": null, "reversed": null }) };
    let front = described(&mesh);
    mesh.normals.as_flattened_mut().iter_mut().for_each(|v| *v = -*v);
    mesh.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    json!({ "by_file": by_file, "mesh": front, "reversed": described(&mesh) })
}

/// A weighted mean: a direction that is made to length 1 once more may differ in its last bit.
fn mean(normals: &[[f32; 3]]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (i, normal) in normals.iter().enumerate() {
        let weight = (i as f64 * 0.618).fract() / normals.len() as f64;
        sum = std::array::from_fn(|c| sum[c] + weight * f64::from(normal[c]));
    }
    sum
}

fn inline(mesh: Value) -> Value {
    let Ok(m) = serde_json::from_value::<InlineMesh>(mesh) else { return Value::Null };
    let InlineMesh { positions, normals, uvs, triangles: corners, .. } = m;
    triangles(true, Some(Mesh { positions, normals, uvs, triangles: corners, ..Mesh::default() }))
}

fn mesh_of_file(file: Value, files: &dyn Files) -> Value {
    let Ok(file) = serde_json::from_value::<MeshFile>(file) else { return Value::Null };
    let options = MeshOptions {
        face_normals: file.face_normals,
        authored_normals: file.authored_normals,
        flip_tex_coords: file.flip_tex_coords,
        max_smooth_angle: file.max_smooth_angle,
    };
    let mesh = files.read(&file.path).ok().and_then(|bytes| mesh::read(file.format, &bytes, &options).ok());
    triangles(file.authored_normals, mesh)
}

/// Replaces what says how a picture is kept by its values.
fn picture(fields: &mut serde_json::Map<String, Value>, files: &dyn Files) {
    let whole = Value::Object(fields.clone());
    let (path, encoding, channel, tone) = match serde_json::from_value::<Bitmap>(whole.clone()) {
        Ok(b) => (b.path, b.encoding, b.channel, [b.scale, f64::from(u8::from(b.invert))]),
        Err(_) => match serde_json::from_value::<LightImage>(whole) {
            Ok(light) => (light.path, light.encoding, None, [1.0, 0.0]),
            Err(_) => return,
        },
    };
    for name in ["path", "encoding", "channel", "scale", "invert"] {
        fields.remove(name);
    }
    let values = values(path, encoding, channel, tone, files);
    fields.insert("values".to_owned(), values.map_or(Value::Null, Value::Array));
}

fn values(
    path: PathBuf,
    encoding: TextureEncoding,
    channel: Option<char>,
    [scale, inverted]: [f64; 2],
    files: &dyn Files,
) -> Option<Vec<Value>> {
    let image = image::read(&files.read(&path).ok()?).ok()?;
    let named = channel.and_then(|c| image.channel(&c.to_ascii_uppercase().to_string()));
    let places = named.map_or_else(|| image.rgb().unwrap_or([0; 3]), |place| [place; 3]);
    let decode = |v: f32| match encoding {
        TextureEncoding::Auto if image.encoding == Encoding::Linear => f64::from(v),
        TextureEncoding::Linear => f64::from(v),
        TextureEncoding::Auto | TextureEncoding::Srgb => srgb_to_linear(f64::from(v)),
        TextureEncoding::Gamma(gamma) => f64::from(v).max(0.0).powf(gamma),
    };
    let toned = |v: f64| if inverted > 0.5 { (1.0 - v * scale).max(0.0) } else { v * scale };
    // A few pixels tell one picture from another.
    let pixels = image.data.chunks_exact(image.channels.len().max(1)).take(64);
    Some(pixels.flat_map(|pixel| places.map(|place| toned(decode(pixel[place])))).map(Value::from).collect())
}

/// Where two values differ by more than rounding, without indices.
pub fn differences(a: &Value, b: &Value, at: &str, tolerance: f64, found: &mut Vec<String>) {
    match (a, b) {
        (Value::Number(x), Value::Number(y)) => {
            let (x, y) = (x.as_f64().unwrap_or(f64::NAN), y.as_f64().unwrap_or(f64::NAN));
            if (x - y).abs() > tolerance * x.abs().max(1.0) {
                found.push(at.to_owned());
            }
        }
        (Value::Array(x), Value::Array(y)) if x.len() == y.len() => {
            // Numbers of one list are one thing.
            let mut inside = Vec::new();
            x.iter().zip(y).for_each(|(x, y)| differences(x, y, at, tolerance, &mut inside));
            inside.dedup();
            found.extend(inside);
        }
        (Value::Array(x), Value::Array(y)) => found.push(format!("{at}: {} against {}", x.len(), y.len())),
        (Value::Object(x), Value::Object(y)) if x.keys().eq(y.keys()) => {
            for (name, x) in x {
                differences(x, &y[name], &format!("{at}.{name}"), tolerance, found);
            }
        }
        _ if a == b => {}
        _ => found.push(format!("{at}: {} against {}", head(a), head(b))),
    }
}

/// The outermost word of a value.
fn head(value: &Value) -> String {
    match value {
        Value::Object(fields) => fields.keys().next().cloned().unwrap_or_default(),
        Value::Array(_) => "a list".to_owned(),
        Value::Number(_) => "a number".to_owned(),
        other => other.to_string(),
    }
}
