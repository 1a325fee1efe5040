//! Shapes, groups and instances.

use super::object::{Class, ObjectIndex, Value};
use super::props::{Nested, Props};
use super::reader::Reader;
use super::version::Dialect;
use crate::diagnostic::Diagnostic;
use crate::ir::{
    Bsdf, BsdfKind, Color, ColorInput, Id, MeshFile, MeshFormat, Origin, Shape, ShapeGroup, ShapeKind,
    Transform,
};
use crate::plugin::{Plugin, read, unsupported};

type ReadShape = for<'a> fn(&mut Reader<'a>, &mut Props<'a>) -> Option<ShapeKind>;

pub(super) const SHAPES: &[Plugin<ReadShape>] = &[
    read("obj", obj),
    read("ply", ply),
    read("serialized", serialized),
    read("sphere", sphere),
    read("rectangle", |_, _| Some(ShapeKind::Rectangle)),
    read("cube", |_, _| Some(ShapeKind::Cube)),
    read("disk", |_, _| Some(ShapeKind::Disk)),
    read("cylinder", cylinder),
    read("instance", instance),
    // `shape` reads groups, which are no shapes by themselves.
    read("shapegroup", |_, _| None),
    // So are the parts of `merge`.
    read("merge", |_, _| None),
    unsupported("linearcurve"),
    unsupported("bsplinecurve"),
    unsupported("sdfgrid"),
    unsupported("ellipsoids"),
    unsupported("ellipsoidsmesh"),
    unsupported("hair"),
    unsupported("heightfield"),
    unsupported("deformable"),
    unsupported("animatedinstance"),
];

/// Parameters of renderers that sample specular chains or glints and of differentiable ones; ignored.
const HARMLESS: &[&str] = &[
    "glinty",
    "silhouette_sampling_weight",
    "caustic_caster_single",
    "caustic_caster_multi",
    "caustic_receiver",
    "caustic_bouncer",
];

impl<'a> Reader<'a> {
    pub fn top_level_shape(&mut self, index: ObjectIndex) {
        match self.objects[index].plugin.as_str() {
            "shapegroup" => {
                self.group(index);
            }
            "merge" => {
                for part in self.parts(index) {
                    self.top_level_shape(part);
                }
            }
            _ => {
                let shapes = self.shapes_of(index);
                self.scene.shapes.extend(shapes);
            }
        }
    }

    /// The shapes of a `merge`, which joins meshes for speed and does not change the image.
    fn parts(&mut self, index: ObjectIndex) -> Vec<ObjectIndex> {
        let mut props = self.props(index);
        let mut parts = Vec::new();
        while let Some(nested) = props.child(Class::Shape) {
            parts.push(nested.index);
        }
        self.finish(props);
        parts
    }

    /// A shape, or those that an OBJ file with several materials is.
    fn shapes_of(&mut self, index: ObjectIndex) -> Vec<Shape> {
        let parts = self.obj_materials(index);
        if parts.is_none() && self.objects[index].plugin == "obj" {
            self.report_shape_index(index);
        }
        let Some(shape) = self.shape(index, parts.is_some()) else { return Vec::new() };
        match parts {
            Some(parts) => parts.apply(shape),
            None => vec![shape],
        }
    }

    fn report_shape_index(&mut self, index: ObjectIndex) {
        let entry = self.objects[index].entries.iter().find(|e| e.name.as_deref() == Some("shape_index"));
        if let Some(entry) = entry.filter(|e| matches!(e.value, Value::Integer(0..))) {
            let name = entry.spelling.as_deref().unwrap_or("shape_index");
            let text = format!("`{name}` of an obj file is not supported: all its objects are loaded");
            self.problems.push(Diagnostic::warning(text, Some(entry.name_span)));
        }
    }

    /// Reads a shape; `materials` are those of an OBJ file, which may have several bsdfs.
    fn shape(&mut self, index: ObjectIndex, materials: bool) -> Option<Shape> {
        let reader = self.plugin(SHAPES, index, "it is skipped")?;
        let mut props = self.props(index);
        let kind = reader(self, &mut props);
        let is_instance = props.object.plugin == "instance";
        let mut to_world = props.transform("to_world");
        if let Some(ShapeKind::Sphere { center, radius }) = kind
            && let Some((ball, real)) = ball(&to_world, center, radius)
        {
            let text =
                format!("a sphere stays a ball: its radius is the {real:.4} that its own x axis has here");
            let place = props.entry("to_world").map_or(props.object.span, |entry| entry.name_span);
            let problem = Diagnostic::warning(text, Some(place));
            props.problems.push(problem.help(
                "`to_world` stretches it, which all versions of Mitsuba ignore; an ellipsoid can be a mesh",
            ));
            to_world = ball;
        }
        props.ignore(HARMLESS);
        let media = self.media_of(&mut props);
        let sensors = props.has_child(Class::Sensor);
        while let Some(nested) = props.child(Class::Sensor) {
            self.sensor(nested.index);
        }
        while let Some(nested) = props.child(Class::Subsurface) {
            self.skip_unsupported(nested.index, "it is skipped");
        }
        // An instance has the materials of its group; what is left over is reported as unknown.
        let bsdf = match () {
            () if is_instance => None,
            () if materials => std::iter::from_fn(|| props.child(Class::Bsdf)).last(),
            () if self.dialect == Dialect::Old => last_bsdf(&mut props),
            () => props.only_child(Class::Bsdf),
        };
        let emitter = if is_instance { None } else { props.only_child(Class::Emitter) };
        let flip_normals = !is_instance && props.boolean("flip_normals", false);
        while props.child(Class::Null).is_some() {}
        let emission = emitter.and_then(|nested| self.shape_emitter(nested));
        // Any emitter makes a shape without bsdf black, whether or not its surface shines.
        let beside_light = emitter.is_some() && emission.is_none();
        let bare = bsdf.is_none() && !materials && !is_instance && emitter.is_none() && !sensors;
        let open = media.is_some() && bare && self.open_boundary(&mut props);
        let bsdf = match bsdf {
            Some(nested) => Some(self.bsdf(nested.index)),
            None if beside_light => Some(self.black()),
            None if open => Some(self.null()),
            None => None,
        };
        let shape = Shape {
            name: props.name(),
            origin: props.origin(),
            to_world,
            bsdf,
            emission,
            flip_normals,
            alpha: None,
            media,
            kind: ShapeKind::Cube,
        };
        if to_world.inverse().is_none() {
            props.complain("to_world", "`to_world` flattens the shape: it has no inverse");
        }
        self.finish(props);
        Some(Shape { kind: kind?, ..shape })
    }

    fn black(&mut self) -> Id<Bsdf> {
        let reflectance = ColorInput::Color(Color::Gray(0.0));
        let kind = BsdfKind::Diffuse { reflectance };
        self.scene.bsdfs.push(Bsdf { name: None, origin: Origin(None), kind })
    }

    fn null(&mut self) -> Id<Bsdf> {
        self.scene.bsdfs.push(Bsdf { name: None, origin: Origin(None), kind: BsdfKind::Null })
    }

    /// Whether light passes through a boundary of media that has no bsdf.
    fn open_boundary(&self, props: &mut Props<'a>) -> bool {
        let old = self.dialect == Dialect::Old;
        if !old {
            let text = "a shape with a medium and without bsdf is diffuse gray: no light enters the medium";
            let problem = Diagnostic::warning(text, Some(props.object.span));
            props.problems.push(problem.help("<bsdf type=\"null\"/> lets it through"));
        }
        old
    }

    fn group(&mut self, index: ObjectIndex) -> Id<ShapeGroup> {
        if let Some(id) = self.groups.get(&index) {
            return *id;
        }
        let mut props = self.props(index);
        let mut shapes = Vec::new();
        while let Some(nested) = props.child(Class::Shape) {
            let inner = &self.objects[nested.index];
            if matches!(inner.plugin.as_str(), "shapegroup" | "instance" | "merge") {
                let text = format!("a shapegroup may not contain a shape of type `{}`", inner.plugin);
                props.problems.push(Diagnostic::error(text, Some(nested.span)));
                continue;
            }
            let emitters = inner.entries.iter().filter_map(|entry| match entry.value {
                Value::Object(child) if self.objects[child].class == Class::Emitter => Some(child),
                _ => None,
            });
            for emitter in emitters {
                let text = "shapes of a shapegroup may not emit light";
                props.problems.push(Diagnostic::error(text, Some(self.objects[emitter].span)));
            }
            shapes.extend(self.shapes_of(nested.index));
        }
        let group = ShapeGroup { name: props.name(), origin: props.origin(), shapes };
        self.finish(props);
        let id = self.scene.groups.push(group);
        self.groups.insert(index, id);
        id
    }

    fn mesh(
        &mut self,
        props: &mut Props<'a>,
        format: MeshFormat,
        flip_by_default: bool,
    ) -> Option<ShapeKind> {
        let path = self.asset(props, "mesh");
        let face_normals = props.boolean("face_normals", false);
        let flip_tex_coords = match format {
            MeshFormat::Serialized { .. } => false,
            _ => props.boolean("flip_tex_coords", flip_by_default),
        };
        let max_smooth_angle = props.optional_float("max_smooth_angle");
        Some(ShapeKind::Mesh(MeshFile {
            path: path?,
            format,
            face_normals,
            authored_normals: false,
            flip_tex_coords,
            max_smooth_angle,
        }))
    }
}

/// The last nested bsdf, which is the one that counts in 0.6.
fn last_bsdf(props: &mut Props<'_>) -> Option<Nested> {
    let mut last = props.child(Class::Bsdf)?;
    while let Some(next) = props.child(Class::Bsdf) {
        let text = "a shape has one bsdf: this one is used instead of that before it";
        let problem = Diagnostic::warning(text, Some(next.span));
        props.problems.push(problem.label(last.span, "not used"));
        last = next;
    }
    Some(last)
}

fn obj<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<ShapeKind> {
    // `obj::materials` has read these.
    props.ignore(&["collapse", "load_materials", "shape_index"]);
    reader.mesh(props, MeshFormat::Obj, true)
}

fn ply<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<ShapeKind> {
    props.ignore(&["srgb"]);
    reader.mesh(props, MeshFormat::Ply, false)
}

fn serialized<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<ShapeKind> {
    let index = props.count("shape_index", 0, 0..=u32::MAX);
    reader.mesh(props, MeshFormat::Serialized { index }, false)
}

fn sphere<'a>(_: &mut Reader<'a>, props: &mut Props<'a>) -> Option<ShapeKind> {
    Some(ShapeKind::Sphere {
        center: props.triple("center").unwrap_or_default(),
        radius: props.positive("radius", 1.0),
    })
}

fn cylinder<'a>(_: &mut Reader<'a>, props: &mut Props<'a>) -> Option<ShapeKind> {
    let p0 = props.triple("p0").unwrap_or_default();
    let p1 = props.triple("p1").unwrap_or([0.0, 0.0, 1.0]);
    if p0 == p1 {
        props.complain("p1", "the ends of the cylinder are the same point");
    }
    Some(ShapeKind::Cylinder { p0, p1, radius: props.positive("radius", 1.0) })
}

fn instance<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<ShapeKind> {
    let group = props.only_child(Class::Shape);
    let Some(group) = group else {
        props.needs("a nested shapegroup");
        return None;
    };
    if reader.objects[group.index].plugin != "shapegroup" {
        let text = format!("instance expects a shapegroup, got `{}`", reader.objects[group.index].plugin);
        props.problems.push(Diagnostic::error(text, Some(group.span)));
        return None;
    }
    Some(ShapeKind::Instance { group: reader.group(group.index) })
}

/// What Mitsuba makes of a sphere that `m` does not keep round, and the radius: a ball about the same centre as
/// large as the image of the x axis. `None` for what keeps it round, or leaves nothing of it.
fn ball(m: &Transform, center: [f64; 3], radius: f64) -> Option<(Transform, f64)> {
    if m.is_similarity() || m.inverse().is_none() {
        return None;
    }
    let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let [x, y, z] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|axis| m.vector(axis));
    let scale = dot(x, x).sqrt();
    let unit = |v: [f64; 3]| v.map(|c| c / dot(v, v).sqrt());
    let x = unit(x);
    let y = unit([0, 1, 2].map(|i| y[i] - dot(x, y) * x[i]));
    let side =
        dot(x, [y[1] * z[2] - y[2] * z[1], y[2] * z[0] - y[0] * z[2], y[0] * z[1] - y[1] * z[0]]).signum();
    let z =
        [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]].map(|c| c * side);
    let at = m.point(center);
    let mut ball = Transform::IDENTITY;
    for i in 0..3 {
        let row = [x[i], y[i], z[i]].map(|c| c * scale);
        let offset = at[i] - dot(row, center);
        ball.0[i] = [row[0], row[1], row[2], offset];
    }
    Some((ball, radius.abs() * scale))
}
