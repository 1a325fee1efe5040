//! Shapes, object definitions and instances.

mod bilinear;
mod mesh;
mod subdivision;

use std::sync::Arc;

use super::directive::{Directive, ParamType};
use super::params::Params;
use super::policy::Fault;
use super::reader::{Reader, text};
use super::state::{Graphics, Named};
use crate::diagnostic::{Diagnostic, Span};
use crate::ir::{
    FloatInput, Id, InlineMesh, MeshFile, MeshFormat, Origin, PartialQuadric, Shape, ShapeGroup, ShapeKind,
    Transform,
};
use crate::plugin::{Plugin, read, unsupported};

use ParamType as T;

type ReadShape = fn(&mut Reader<'_>, &mut Params) -> Option<Made>;

/// A shape, and how many of pbrt's shapes it is: each of them is a lamp of its own.
pub(super) struct Made {
    kind: ShapeKind,
    /// `None` where only its file tells.
    count: Option<usize>,
}

pub(super) const SHAPES: &[Plugin<ReadShape>] = &[
    read("trianglemesh", |_, p| mesh::triangles(p).map(triangles)),
    read("plymesh", ply),
    read("bilinearmesh", bilinear_mesh),
    read("loopsubdiv", |r, p| subdivided(r, p).map(triangles)),
    read("sphere", |_, p| sphere(p).map(one)),
    read("disk", |_, p| disk(p).map(one)),
    read("cylinder", |_, p| cylinder(p).map(one)),
    unsupported("curve"),
    // pbrt-v3.
    unsupported("cone"),
    unsupported("paraboloid"),
    unsupported("hyperboloid"),
    unsupported("heightfield"),
    unsupported("nurbs"),
];

/// Most levels of subdivision: one triangle becomes 4^8.
const MAX_LEVELS: u32 = 8;
/// Most triangles of all subdivided meshes of a scene together: about 5 GB while they are made.
const MAX_TRIANGLES: u64 = 1 << 24;

/// Parameters of materials of pbrt-v3, which shapes may give as well.
const OF_MATERIALS: &[&str] = &[
    "Kd",
    "Ks",
    "Kr",
    "Kt",
    "sigma",
    "roughness",
    "uroughness",
    "vroughness",
    "remaproughness",
    "opacity",
    "eta",
    "index",
    "k",
    "amount",
    "reflect",
    "transmit",
    "bumpmap",
];

impl Made {
    /// How often the shape has the area that pbrt knows of each lamp: of round ones it is the area before the transform.
    fn lamps(&self, to_world: &Transform) -> Option<f64> {
        let stretched = match self.kind {
            ShapeKind::Inline(_) | ShapeKind::Mesh(_) => 1.0,
            _ => to_world.determinant3().abs().powf(2.0 / 3.0),
        };
        Some(self.count? as f64 * stretched)
    }
}

fn triangles(mesh: InlineMesh) -> Made {
    Made { count: Some(mesh.triangles.len()), kind: ShapeKind::Inline(Arc::new(mesh)) }
}

fn one(kind: ShapeKind) -> Made {
    Made { kind, count: Some(1) }
}

impl Reader<'_> {
    pub fn shape(&mut self, mut p: Params) {
        let Some(reader) = self.plugin(SHAPES, &mut p, "it is skipped") else { return self.done(p) };
        let made = reader(self, &mut p);
        let alpha = self.alpha(&mut p);
        let to_world = self.state.ctm[0];
        if to_world.inverse().is_none() {
            let text = "the transform flattens this shape: it has no inverse";
            p.problems.push(Diagnostic::error(text, Some(p.span)));
        }
        let origin = p.origin();
        // In pbrt-v3 they are the material's.
        let others = if self.policy.is_three() { p.take_unread(OF_MATERIALS) } else { Vec::new() };
        self.done(p);
        let Some(made) = made else { return };
        let bsdf = Some(match others.is_empty() {
            true => self.current_material(origin),
            false => self.changed_material(others, origin),
        });
        let mut emission = self.area_emission(made.lamps(&to_world));
        if self.open_group.is_some()
            && let Some(dark) = emission.take()
        {
            let problem = Diagnostic::warning("shapes of an object do not emit light in pbrt", origin.0);
            let lamp = dark.origin.0.map(|span| (span, "by this light".to_owned()));
            self.problems.push(Diagnostic { labels: lamp.into_iter().collect(), ..problem });
        }
        let shape = Shape {
            name: None,
            origin,
            kind: made.kind,
            to_world,
            bsdf,
            emission,
            flip_normals: self.state.reverse,
            alpha,
            media: self.media_of_shape(),
        };
        match self.open_group {
            Some(group) => self.scene.groups[group].shapes.push(shape),
            None => self.scene.shapes.push(shape),
        }
    }

    fn alpha(&mut self, p: &mut Params) -> Option<FloatInput> {
        let alpha = self.optional_float_input(p, "alpha");
        if !self.policy.is_three() {
            return alpha.filter(|alpha| *alpha != FloatInput::Value(1.0));
        }
        // What is not 0 is opaque.
        let alpha = alpha.filter(|alpha| !matches!(alpha, FloatInput::Value(v) if *v != 0.0));
        let shadow = self.optional_float_input(p, "shadowalpha");
        let shadow = shadow.filter(|alpha| !matches!(alpha, FloatInput::Value(v) if *v != 0.0));
        if p.has("shadowalpha") && shadow != alpha {
            p.warn("shadowalpha", "`shadowalpha` is ignored: shadows are those of what is seen");
        }
        alpha
    }

    pub fn object_begin(&mut self, d: &Directive) {
        if self.open_group.is_some() {
            self.error("objects may not contain objects", d.span);
        }
        let (name, span) = (text(d, 0).to_owned(), d.arguments[0].span);
        self.open_object(d.span);
        let earlier = self.groups.get(&name).and_then(|named| named.defined);
        if earlier.is_some() {
            // Instances so far are of the earlier one.
            self.groups.remove(&name);
        }
        let id = self.group(&name, span);
        if let Some(named) = self.groups.get_mut(&name) {
            named.defined = Some(span);
        }
        self.redefined("object", &name, span, earlier);
        self.open_group = Some(id);
    }

    fn group(&mut self, name: &str, span: Span) -> Id<ShapeGroup> {
        if let Some(named) = self.groups.get(name) {
            return named.id;
        }
        let group =
            ShapeGroup { name: Some(name.to_owned()), origin: Origin(Some(span)), shapes: Vec::new() };
        let id = self.scene.groups.push(group);
        self.groups.insert(name.to_owned(), Named { id, defined: None, used: None });
        id
    }

    pub fn object_instance(&mut self, d: &Directive) {
        if self.open_group.is_some() {
            return self.fault(Fault::Mistake, "an object may not contain instances", d.span, LEFT_OUT);
        }
        let (name, span) = (text(d, 0), d.arguments[0].span);
        // In pbrt-v3 an object is defined before it is used.
        if self.policy.is_three() && !self.groups.contains_key(name) {
            return self.undefined_object(name, span);
        }
        let group = self.group(name, span);
        if let Some(named) = self.groups.get_mut(name) {
            named.used.get_or_insert(span);
        }
        let Graphics { ctm, .. } = &self.state;
        if ctm[0].inverse().is_none() {
            let text = "the transform flattens this instance: it has no inverse";
            return self.error(text, d.span);
        }
        self.scene.shapes.push(Shape {
            name: None,
            origin: Origin(Some(d.span)),
            kind: ShapeKind::Instance { group },
            to_world: ctm[0],
            bsdf: None,
            emission: None,
            flip_normals: false,
            alpha: None,
            media: None,
        });
    }

    /// Reports names that were used and never defined.
    pub fn check_objects(&mut self) {
        let used = self.groups.iter().filter(|(_, named)| named.defined.is_none());
        let missing: Vec<(String, Span)> =
            used.filter_map(|(name, named)| named.used.map(|span| (name.clone(), span))).collect();
        for (name, span) in missing {
            self.undefined_object(&name, span);
        }
    }

    fn undefined_object(&mut self, name: &str, span: Span) {
        if self.incomplete {
            return;
        }
        let defined = self.groups.iter().filter(|(_, named)| named.defined.is_some());
        let problem = Diagnostic::error(format!("no object named `{name}`"), Some(span));
        let problem = problem.suggest_or(name, defined.map(|(name, _)| name.as_str()), || {
            "ObjectBegin defines one".to_owned()
        });
        self.problems.push(self.policy.judge(Fault::Mistake, problem, LEFT_OUT));
    }
}

/// What becomes of an instance that cannot be made.
const LEFT_OUT: &str = "it is left out";

fn ply(r: &mut Reader<'_>, p: &mut Params) -> Option<Made> {
    let path = r.asset(p, "filename", "mesh");
    p.ignore(&["edgelength"]);
    if p.has("displacement") {
        r.unsupported("displacement of a plymesh", "the mesh is unchanged", p.span_of("displacement"));
        p.ignore(&["displacement"]);
    }
    let kind = ShapeKind::Mesh(MeshFile {
        path: path?,
        format: MeshFormat::Ply,
        face_normals: false,
        authored_normals: true,
        flip_tex_coords: false,
        max_smooth_angle: None,
    });
    Some(Made { kind, count: None })
}

fn bilinear_mesh(r: &mut Reader<'_>, p: &mut Params) -> Option<Made> {
    if p.has("emissionfilename") {
        let span = p.span_of("emissionfilename");
        r.unsupported("`emissionfilename`", "emission is constant over the patch", span);
        p.ignore(&["emissionfilename"]);
    }
    p.ignore(&["faceIndices"]);
    let cage = mesh::cage(p, 4)?;
    let count = Some(cage.indices.len() / 4);
    Some(Made { count, ..triangles(bilinear::tessellate(&cage)) })
}

fn subdivided(r: &mut Reader<'_>, p: &mut Params) -> Option<InlineMesh> {
    let levels = p.count("levels", 3, 0);
    p.ignore(&["scheme"]);
    let indices = mesh::required_indices(p)?;
    let positions = mesh::positions(p)?;
    let triangles = mesh::checked(p, &indices, positions.len(), 3)?.as_chunks::<3>().0.to_vec();
    let made = (triangles.len() as u64) << (2 * u64::from(levels.min(16)));
    if levels > MAX_LEVELS || r.subdivided + made > MAX_TRIANGLES {
        p.complain("levels", format!("{levels} levels of subdivision make too many triangles"));
        return None;
    }
    r.subdivided += made;
    match subdivision::subdivide(positions, triangles, levels) {
        Ok(mesh) => Some(mesh),
        Err(text) => {
            p.complain("indices", text);
            None
        }
    }
}

/// `phimax` in 0..=360.
fn phi_max(p: &mut Params) -> f64 {
    let phi = p.float("phimax", 360.0);
    if !(phi > 0.0 && phi <= 360.0) {
        p.complain("phimax", format!("`phimax` must lie between 0 and 360 degrees, not {phi}"));
        return 360.0;
    }
    phi
}

/// Whole ones become plain spheres when nothing depends on their uv; see `finish`.
fn sphere(p: &mut Params) -> Option<ShapeKind> {
    let radius = p.positive("radius", 1.0);
    let (a, b) = (p.float("zmin", -radius), p.float("zmax", radius));
    let (z_min, z_max) = (a.min(b).clamp(-radius, radius), a.max(b).clamp(-radius, radius));
    if z_min >= z_max {
        p.complain("zmin", "nothing is left of the sphere between `zmin` and `zmax`");
        return None;
    }
    Some(ShapeKind::Partial(PartialQuadric::Sphere { radius, z_min, z_max, phi_max: phi_max(p) }))
}

fn disk(p: &mut Params) -> Option<ShapeKind> {
    let radius = p.positive("radius", 1.0);
    let inner_radius = p.float("innerradius", 0.0);
    if !(0.0..radius).contains(&inner_radius) {
        p.complain(
            "innerradius",
            format!("`innerradius` must lie between 0 and {radius}, not {inner_radius}"),
        );
        return None;
    }
    let height = p.float("height", 0.0);
    Some(ShapeKind::Partial(PartialQuadric::Disk { height, radius, inner_radius, phi_max: phi_max(p) }))
}

fn cylinder(p: &mut Params) -> Option<ShapeKind> {
    let radius = p.positive("radius", 1.0);
    let (a, b) = (p.float("zmin", -1.0), p.float("zmax", 1.0));
    if a == b {
        p.complain("zmin", "the cylinder has no height: `zmin` and `zmax` are the same");
        return None;
    }
    let (z_min, z_max) = (a.min(b), a.max(b));
    Some(ShapeKind::Partial(PartialQuadric::Cylinder { radius, z_min, z_max, phi_max: phi_max(p) }))
}

/// Kind of normals and texture coordinates, for the meshes.
const NORMAL: ParamType = T::Normal;
const UV: ParamType = T::Point2;
