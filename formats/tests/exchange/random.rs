//! Random scenes of what each language can say.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use caustica_formats::files::Memory;
use caustica_formats::ir::{
    AreaEmission, Bitmap, Bsdf, BsdfKind, Coat, Color, ColorInput, Conductor, ConductorMaterial, Dielectric,
    Emitter, EmitterKind, EnvironmentMapping, FloatInput, Fov, FovAxis, Id, InlineMesh, Ior, LightImage,
    Mapping, MeshFile, MeshFormat, Microfacet, MicrofacetDistribution, Origin, PartialQuadric, Plastic,
    Projection, RoughnessRemap, Scalar, Scene, Setting, Shadowing, Shape, ShapeGroup, ShapeKind, SpotFalloff,
    Texture, TextureEncoding, TextureFilter, TextureKind, Transform, WrapMode, has_passages, uses_textures,
};
use caustica_formats::{Read, ReadOptions, read_scene};
use proptest::collection::vec;
use proptest::prelude::*;

use crate::random_media;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    Mitsuba,
    Pbrt,
}

impl Language {
    pub fn file(self) -> &'static str {
        match self {
            Self::Mitsuba => "copy.xml",
            Self::Pbrt => "copy.pbrt",
        }
    }
}

/// A scene with nothing but a camera and the sky.
pub fn empty(language: Language) -> Read {
    let (name, text) = match language {
        Language::Mitsuba => (
            "scene.xml",
            "<scene version='3.0.0'><integrator type='path'/><sensor type='perspective'>
             <float name='fov' value='40'/><film type='hdrfilm'><rfilter type='gaussian'/></film>
             </sensor><emitter type='constant'/></scene>",
        ),
        Language::Pbrt => (
            "scene.pbrt",
            "Integrator \"path\" Camera \"perspective\" Film \"rgb\" WorldBegin LightSource \"infinite\"",
        ),
    };
    let files = Memory([(PathBuf::from(name), text.as_bytes().to_vec())].into());
    read_scene(&files, Path::new(name), &ReadOptions::default()).unwrap_or_else(|e| panic!("{e}"))
}

/// Choices for things that refer to others: positions in lists, taken modulo their lengths.
type Pick = usize;

pub fn scene(language: Language) -> impl Strategy<Value = Scene> {
    let things = (
        vec(texture(language), 0..3),
        vec((material(language), any::<[Pick; 3]>(), any::<bool>()), 1..5),
        vec((shape(language), any::<Pick>(), proptest::option::of(light_color())), 0..5),
        vec((vec(shape(language), 1..3), any::<Pick>()), 0..2),
        vec(transform(), 0..3),
        vec(emitter(language), 0..4),
        random_media::filling(language),
    );
    (things, camera(language), prop_oneof![Just(-1), 1i64..9]).prop_map(move |(things, camera, depth)| {
        let (textures, materials, shapes, groups, instances, emitters, media) = things;
        let mut scene = empty(language).scene;
        for (i, kind) in textures.into_iter().enumerate() {
            scene.textures.push(Texture { name: Some(format!("texture {i}")), origin: Origin(None), kind });
        }
        let textures: Vec<_> = scene.textures.iter().map(|(id, _)| id).collect();
        let mut finished = Vec::new();
        for (i, (kind, picks, textured)) in materials.into_iter().enumerate() {
            let kind = if textured { with_texture(kind, &textures, picks[0]) } else { kind };
            let id = finish_material(&mut scene, language, kind, i, &finished, picks);
            finished.push(id);
        }
        let material = |pick: Pick| Some(finished[pick % finished.len()]);
        for (shape, pick, radiance) in shapes {
            let emission = radiance.map(|radiance| AreaEmission {
                origin: Origin(None),
                radiance: ColorInput::Color(radiance),
                scale: 1.0,
                two_sided: false,
                collimated: false,
                power: None,
            });
            let bsdf = material(pick);
            // pbrt's surfaces that light passes through do not shine.
            let passes = |id: Id<Bsdf>| matches!(scene.bsdfs[id].kind, BsdfKind::Null);
            let dark = language == Language::Pbrt && bsdf.is_some_and(passes);
            let shape = Shape { bsdf, emission: emission.filter(|_| !dark), ..shape };
            let shape = as_read(&scene, language, shape);
            scene.shapes.push(shape);
        }
        let mut ids = Vec::new();
        for (i, (shapes, pick)) in groups.into_iter().enumerate() {
            let with_material = |shape| Shape { bsdf: material(pick), ..shape };
            let shapes = shapes.into_iter().map(with_material);
            let shapes = shapes.map(|shape| as_read(&scene, language, shape)).collect();
            let name = Some(format!("group{i}"));
            ids.push(scene.groups.push(ShapeGroup { name, origin: Origin(None), shapes }));
        }
        for (i, to_world) in instances.into_iter().enumerate().filter(|_| !ids.is_empty()) {
            let kind = ShapeKind::Instance { group: ids[i % ids.len()] };
            scene.shapes.push(Shape { bsdf: None, ..plain_shape(kind, to_world) });
        }
        // Groups that nobody instances are no part of the picture, and none of the comparison.
        scene.emitters = emitters
            .into_iter()
            .map(|kind| Emitter { name: None, origin: Origin(None), kind, medium: None })
            .collect();
        // One environment at most.
        let mut seen = false;
        scene.emitters.retain(|emitter| {
            let infinite = emitter.kind.fills_the_sky();
            !(infinite && std::mem::replace(&mut seen, true))
        });
        if scene.emitters.is_empty() && scene.shapes.iter().all(|shape| shape.emission.is_none()) {
            let kind = EmitterKind::Point { position: [0.0; 3], intensity: Color::Rgb([1.0; 3]) };
            scene.emitters.push(Emitter { name: None, origin: Origin(None), kind, medium: None });
        }
        let sensor = &mut scene.sensors[0];
        (sensor.to_world, sensor.projection, sensor.film.width, sensor.film.height) = camera;
        let setting = Setting { origin: Origin(None), value: Scalar::Integer(depth) };
        random_media::fill(&mut scene, language, media);
        let passages = has_passages(&scene);
        if let Some(integrator) = &mut scene.integrator {
            integrator.settings.insert("max_depth".to_owned(), setting);
            if !scene.media.is_empty() || passages {
                integrator.plugin = "volpath".to_owned();
            }
        }
        scene
    })
}

/// pbrt's textured quadrics are kinds of their own: their uv differ from Mitsuba's.
fn as_read(scene: &Scene, language: Language, shape: Shape) -> Shape {
    if language == Language::Mitsuba || !uses_textures(scene, &shape) {
        return shape;
    }
    let kind = match shape.kind {
        ShapeKind::Sphere { radius, .. } => ShapeKind::Partial(PartialQuadric::Sphere {
            radius,
            z_min: -radius,
            z_max: radius,
            phi_max: 360.0,
        }),
        ShapeKind::Cylinder { p0, p1, radius } => ShapeKind::Partial(PartialQuadric::Cylinder {
            radius,
            z_min: p0[2],
            z_max: p1[2],
            phi_max: 360.0,
        }),
        ShapeKind::Disk => ShapeKind::Partial(PartialQuadric::Disk {
            height: 0.0,
            radius: 1.0,
            inner_radius: 0.0,
            phi_max: 360.0,
        }),
        kind => kind,
    };
    Shape { kind, ..shape }
}

/// Puts a material into the scene as its language's reader would.
fn finish_material(
    scene: &mut Scene,
    language: Language,
    kind: BsdfKind,
    index: usize,
    finished: &[Id<Bsdf>],
    picks: [Pick; 3],
) -> Id<Bsdf> {
    let name = Some(format!("material {index}"));
    let bsdf = |name, kind| Bsdf { name, origin: Origin(None), kind };
    let opaque = matches!(
        kind,
        BsdfKind::Diffuse { .. }
            | BsdfKind::Conductor(_)
            | BsdfKind::RoughConductor { .. }
            | BsdfKind::CoatedDiffuse { .. }
    );
    // Every third one blends two that are there.
    // pbrt mixes materials only, and its `interface` is none.
    let nothing = |id: Id<Bsdf>| matches!(scene.bsdfs[id].kind, BsdfKind::Null);
    let parts: Vec<_> =
        finished.iter().copied().filter(|id| language != Language::Pbrt || !nothing(*id)).collect();
    if picks[2].is_multiple_of(3) && !parts.is_empty() {
        let part = |pick: Pick| parts[pick % parts.len()];
        let weight = FloatInput::Value(0.25);
        let kind = BsdfKind::Blend { weight, first: part(picks[0]), second: part(picks[1]) };
        return scene.bsdfs.push(bsdf(name, kind));
    }
    match language {
        // What reflects only is two-sided in pbrt.
        Language::Pbrt if opaque => {
            let front = scene.bsdfs.push(bsdf(None, kind));
            scene.bsdfs.push(bsdf(name, BsdfKind::TwoSided { front, back: None }))
        }
        Language::Mitsuba if picks[2] % 3 == 1 && opaque => {
            let front = scene.bsdfs.push(bsdf(None, kind));
            scene.bsdfs.push(bsdf(name, BsdfKind::TwoSided { front, back: None }))
        }
        _ => scene.bsdfs.push(bsdf(name, kind)),
    }
}

fn with_texture(kind: BsdfKind, textures: &[Id<Texture>], pick: Pick) -> BsdfKind {
    match kind {
        BsdfKind::Diffuse { .. } if !textures.is_empty() => {
            BsdfKind::Diffuse { reflectance: ColorInput::Texture(textures[pick % textures.len()]) }
        }
        kind => kind,
    }
}

pub fn between(low: f64, high: f64) -> impl Strategy<Value = f64> + Clone {
    // Few digits shrink to readable cases; many digits test the writing of numbers.
    prop_oneof![
        (0..=8u32).prop_map(move |i| low + (high - low) * f64::from(i) / 8.0),
        (0.0..1.0f64).prop_map(move |t| low + (high - low) * t),
    ]
}

pub fn triple(low: f64, high: f64) -> impl Strategy<Value = [f64; 3]> + Clone {
    [between(low, high), between(low, high), between(low, high)]
}

pub fn albedo() -> impl Strategy<Value = Color> + Clone {
    triple(0.0, 1.0).prop_map(Color::Rgb)
}

pub fn light_color() -> impl Strategy<Value = Color> + Clone {
    triple(0.0, 50.0).prop_map(Color::Rgb)
}

/// Without mirroring.
pub fn transform() -> impl Strategy<Value = Transform> + Clone {
    let scale = prop_oneof![
        between(0.25, 2.0).prop_map(|s| [s; 3]),
        [between(0.25, 2.0), between(0.25, 2.0), between(0.25, 2.0)],
    ];
    (scale, triple(-1.0, 1.0), between(-180.0, 180.0), triple(-10.0, 10.0)).prop_map(
        |(scale, axis, angle, by)| {
            let turn = Transform::rotate(axis, angle).unwrap_or(Transform::IDENTITY);
            Transform::translate(by).after(&turn).after(&Transform::scale(scale))
        },
    )
}

/// With axes of one length.
fn evened(mut m: Transform) -> Transform {
    let length = |m: &Transform, j: usize| (0..3).map(|i| m.0[i][j] * m.0[i][j]).sum::<f64>().sqrt();
    let first = length(&m, 0);
    for j in 1..3 {
        let factor = first / length(&m, j);
        (0..3).for_each(|i| m.0[i][j] *= factor);
    }
    m
}

/// Of the same size along all axes.
fn even() -> impl Strategy<Value = Transform> + Clone {
    (between(0.25, 2.0), turned()).prop_map(|(scale, turned)| turned.after(&Transform::scale([scale; 3])))
}

/// Turned and moved.
fn turned() -> impl Strategy<Value = Transform> + Clone {
    (triple(-1.0, 1.0), between(-180.0, 180.0), triple(-10.0, 10.0)).prop_map(|(axis, angle, by)| {
        let turn = Transform::rotate(axis, angle).unwrap_or(Transform::IDENTITY);
        Transform::translate(by).after(&turn)
    })
}

type Camera = (Transform, Projection, u32, u32);

fn camera(language: Language) -> impl Strategy<Value = Camera> {
    let place = prop_oneof![
        Just(([0.0, 1.0, 5.0], [0.0; 3])),
        (triple(-5.0, -2.0), triple(2.0, 5.0)).prop_map(|(eye, target)| (eye, target)),
    ];
    (place, between(10.0, 100.0), 1u32..2000, 1u32..2000).prop_map(
        move |((eye, target), degrees, width, height)| {
            let to_world = Transform::look_at(eye, target, [0.0, 1.0, 0.0]).expect("looks ahead");
            // pbrt has the angle along the shorter side.
            let axis = if language == Language::Pbrt { FovAxis::Smaller } else { FovAxis::X };
            (to_world, Projection::Perspective { fov: Fov::Degrees(degrees), axis }, width, height)
        },
    )
}

fn plain_shape(kind: ShapeKind, to_world: Transform) -> Shape {
    Shape {
        name: None,
        origin: Origin(None),
        kind,
        to_world,
        bsdf: None,
        emission: None,
        flip_normals: false,
        alpha: None,
        media: None,
    }
}

fn mesh_file(path: &str, format: MeshFormat, authored_normals: bool) -> MeshFile {
    MeshFile {
        path: PathBuf::from(path),
        format,
        face_normals: false,
        authored_normals,
        flip_tex_coords: format == MeshFormat::Obj,
        max_smooth_angle: None,
    }
}

fn inline_mesh() -> impl Strategy<Value = ShapeKind> {
    vec([-5.0f32..5.0, -5.0..5.0, -5.0..5.0], 3..9).prop_map(|positions| {
        let count = positions.len() as u32;
        let triangles = (2..count).map(|i| [0, i - 1, i]).collect();
        let uvs = positions.iter().map(|p| [p[0], p[1]]).collect();
        let mesh = InlineMesh { positions, normals: Vec::new(), uvs, triangles, made_from: None };
        ShapeKind::Inline(Arc::new(mesh))
    })
}

fn shape(language: Language) -> BoxedStrategy<Shape> {
    let radius = || between(0.25, 4.0);
    let kind = match language {
        Language::Mitsuba => prop_oneof![
            (triple(-5.0, 5.0), radius()).prop_map(|(center, radius)| ShapeKind::Sphere { center, radius }),
            (triple(-5.0, -1.0), triple(1.0, 5.0), radius())
                .prop_map(|(p0, p1, radius)| ShapeKind::Cylinder { p0, p1, radius }),
            Just(ShapeKind::Rectangle),
            Just(ShapeKind::Cube),
            Just(ShapeKind::Disk),
            Just(ShapeKind::Mesh(mesh_file("mesh.obj", MeshFormat::Obj, false))),
            Just(ShapeKind::Mesh(mesh_file("smooth.ply", MeshFormat::Ply, false))),
        ]
        .boxed(),
        Language::Pbrt => prop_oneof![
            radius().prop_map(|radius| ShapeKind::Sphere { center: [0.0; 3], radius }),
            (radius(), -4.0..-1.0f64, 1.0..4.0f64).prop_map(|(radius, bottom, top)| {
                ShapeKind::Cylinder { p0: [0.0, 0.0, bottom], p1: [0.0, 0.0, top], radius }
            }),
            (radius(), 30.0..300.0f64).prop_map(|(radius, phi_max)| {
                let (z_min, z_max) = (-0.5 * radius, radius);
                ShapeKind::Partial(PartialQuadric::Sphere { radius, z_min, z_max, phi_max })
            }),
            Just(ShapeKind::Disk),
            inline_mesh(),
            Just(ShapeKind::Mesh(mesh_file("flat.ply", MeshFormat::Ply, true))),
            Just(ShapeKind::Mesh(mesh_file("smooth.ply", MeshFormat::Ply, true))),
        ]
        .boxed(),
    };
    (kind, transform(), any::<bool>())
        .prop_map(move |(kind, to_world, flip_normals)| {
            // In Mitsuba these stay round whatever the transform says.
            let round = matches!(kind, ShapeKind::Sphere { .. } | ShapeKind::Cylinder { .. });
            let to_world = if round && language == Language::Mitsuba { evened(to_world) } else { to_world };
            Shape { flip_normals, ..plain_shape(kind, to_world) }
        })
        .boxed()
}

fn microfacet(language: Language) -> impl Strategy<Value = Microfacet> + Clone {
    let pbrt = language == Language::Pbrt;
    (between(0.125, 0.5), between(0.125, 0.5), any::<bool>(), any::<bool>()).prop_map(
        move |(u, v, flag, even)| Microfacet {
            distribution: if pbrt || flag {
                MicrofacetDistribution::Ggx
            } else {
                MicrofacetDistribution::Beckmann
            },
            alpha_u: FloatInput::Value(u),
            // An anisotropic quadric of pbrt is another shape, as a textured one is.
            alpha_v: FloatInput::Value(if even || pbrt { u } else { v }),
            sample_visible: true,
            shadowing: if pbrt { Shadowing::HeightCorrelated } else { Shadowing::Separable },
            remap: if pbrt && flag { RoughnessRemap::Sqrt } else { RoughnessRemap::None },
        },
    )
}

const WHITE: ColorInput = ColorInput::Color(Color::Gray(1.0));

fn material(language: Language) -> BoxedStrategy<BsdfKind> {
    let diffuse = albedo().prop_map(|color| BsdfKind::Diffuse { reflectance: ColorInput::Color(color) });
    let interface = between(1.125, 2.0).prop_map(|eta| Dielectric {
        int_ior: Ior::Value(eta),
        ext_ior: Ior::Value(1.0),
        specular_reflectance: WHITE,
        specular_transmittance: WHITE,
    });
    let metal = (triple(0.125, 3.0), triple(1.0, 5.0)).prop_map(|(eta, k)| Conductor {
        material: ConductorMaterial::EtaK {
            eta: ColorInput::Color(Color::Rgb(eta)),
            k: ColorInput::Color(Color::Rgb(k)),
            ext_eta: None,
        },
        specular_reflectance: WHITE,
    });
    let both = prop_oneof![
        diffuse,
        interface.clone().prop_map(BsdfKind::Dielectric),
        interface.clone().prop_map(BsdfKind::ThinDielectric),
        (interface, microfacet(language))
            .prop_map(|(interface, microfacet)| BsdfKind::RoughDielectric { interface, microfacet }),
        metal.clone().prop_map(BsdfKind::Conductor),
        (metal, microfacet(language))
            .prop_map(|(conductor, microfacet)| BsdfKind::RoughConductor { conductor, microfacet }),
        Just(BsdfKind::Null),
    ];
    match language {
        Language::Mitsuba => {
            let plastic = (albedo(), any::<bool>()).prop_map(|(color, nonlinear)| {
                BsdfKind::Plastic(Plastic {
                    int_ior: Ior::Value(1.5),
                    ext_ior: Ior::Value(1.0),
                    diffuse_reflectance: ColorInput::Color(color),
                    specular_reflectance: WHITE,
                    nonlinear,
                })
            });
            let named = Just(BsdfKind::Conductor(Conductor {
                material: ConductorMaterial::Named { name: "Au".to_owned(), ext_eta: None },
                specular_reflectance: WHITE,
            }));
            prop_oneof![4 => both, 1 => plastic, 1 => named].boxed()
        }
        Language::Pbrt => {
            let coated =
                (albedo(), microfacet(language)).prop_map(|(color, microfacet)| BsdfKind::CoatedDiffuse {
                    reflectance: ColorInput::Color(color),
                    coat: Coat {
                        eta: Ior::Value(1.5),
                        microfacet,
                        thickness: FloatInput::Value(0.01),
                        albedo: ColorInput::Color(Color::Gray(0.0)),
                        g: FloatInput::Value(0.0),
                        max_depth: 10,
                        samples: 1,
                    },
                });
            let through = (albedo(), albedo()).prop_map(|(r, t)| BsdfKind::DiffuseTransmission {
                reflectance: ColorInput::Color(r),
                transmittance: ColorInput::Color(t),
            });
            prop_oneof![4 => both, 1 => coated, 1 => through].boxed()
        }
    }
}

fn to_uv() -> impl Strategy<Value = Transform> {
    (between(0.5, 8.0), between(0.5, 8.0), between(-1.0, 1.0))
        .prop_map(|(u, v, by)| Transform::translate([by, 0.25, 0.0]).after(&Transform::scale([u, v, 1.0])))
}

fn texture(language: Language) -> BoxedStrategy<TextureKind> {
    let checks = (albedo(), albedo(), to_uv()).prop_map(move |(a, b, to_uv)| {
        let (color0, color1) = (ColorInput::Color(a), ColorInput::Color(b));
        match language {
            Language::Mitsuba => TextureKind::Checkerboard { color0, color1, to_uv },
            Language::Pbrt => TextureKind::MappedCheckerboard { color0, color1, mapping: Mapping::Uv(to_uv) },
        }
    });
    match language {
        Language::Mitsuba => {
            let bitmap = (to_uv(), any::<bool>()).prop_map(|(to_uv, smooth)| {
                TextureKind::Bitmap(Bitmap {
                    path: PathBuf::from("picture.pfm"),
                    filter: if smooth { TextureFilter::Bilinear } else { TextureFilter::Nearest },
                    wrap_u: WrapMode::Repeat,
                    wrap_v: WrapMode::Repeat,
                    encoding: TextureEncoding::Auto,
                    channel: None,
                    mapping: Mapping::Uv(to_uv),
                    scale: 1.0,
                    invert: false,
                })
            });
            prop_oneof![checks, bitmap].boxed()
        }
        Language::Pbrt => {
            let dots = (albedo(), albedo(), to_uv()).prop_map(|(a, b, to_uv)| TextureKind::Dots {
                inside: ColorInput::Color(a),
                outside: ColorInput::Color(b),
                mapping: Mapping::Uv(to_uv),
            });
            prop_oneof![checks, dots].boxed()
        }
    }
}

fn emitter(language: Language) -> BoxedStrategy<EmitterKind> {
    let pbrt = language == Language::Pbrt;
    let point = (triple(-5.0, 5.0), light_color())
        .prop_map(|(position, intensity)| EmitterKind::Point { position, intensity });
    let directional = (triple(0.25, 1.0), light_color())
        .prop_map(|(direction, irradiance)| EmitterKind::Directional { direction, irradiance });
    let constant = light_color().prop_map(|radiance| EmitterKind::Constant { radiance });
    let spot = (even(), light_color(), 20.0..80.0f64).prop_map(move |(to_world, intensity, cutoff)| {
        EmitterKind::Spot {
            to_world,
            intensity,
            cutoff_angle: cutoff,
            beam_width: cutoff - 8.0,
            falloff: if pbrt { SpotFalloff::Smoothstep } else { SpotFalloff::Linear },
            texture: None,
        }
    });
    let environment = turned().prop_map(move |to_world| EmitterKind::Environment {
        to_world,
        image: LightImage {
            path: PathBuf::from("picture.pfm"),
            encoding: TextureEncoding::Auto,
            scale: 2.0,
            illuminance: None,
        },
        mapping: if pbrt { EnvironmentMapping::EqualArea } else { EnvironmentMapping::LatLong },
    });
    // Sun and sky become a picture of two million pixels in pbrt: `tests/mitsuba/sunsky.rs` writes and reads them.
    prop_oneof![point, directional, constant, spot, environment].boxed()
}

/// Names are no part of the picture, and are made up on the way.
pub fn without_names(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    macro_rules! forget {
        ($arena:ident) => {
            let ids: Vec<_> = scene.$arena.iter().map(|(id, _)| id).collect();
            ids.into_iter().for_each(|id| scene.$arena[id].name = None);
        };
    }
    forget!(bsdfs);
    forget!(textures);
    forget!(groups);
    forget!(media);
    scene
}

/// Equal up to rounding of numbers (matrices are inverted and composed on the way) and names of files.
pub fn assert_near(a: &Scene, b: &Scene, a_text: &str, b_text: &str) {
    let [a, b] = [a, b].map(|scene| serde_json::to_value(scene).unwrap());
    if let Some(difference) = difference(&a, &b, "scene") {
        panic!("{difference}\n{a_text}\n-----\n{b_text}");
    }
}

fn difference(a: &serde_json::Value, b: &serde_json::Value, at: &str) -> Option<String> {
    use serde_json::Value as V;
    match (a, b) {
        (V::Number(x), V::Number(y)) => {
            let (x, y) = (x.as_f64()?, y.as_f64()?);
            ((x - y).abs() > 1e-6 * x.abs().max(1.0)).then(|| format!("{at}: {x} and {y}"))
        }
        (V::Array(x), V::Array(y)) if x.len() == y.len() => {
            let mut pairs = x.iter().zip(y).enumerate();
            pairs.find_map(|(i, (x, y))| difference(x, y, &format!("{at}[{i}]")))
        }
        // Mitsuba has meshes in files of their own only; that those hold the mesh is a test of theirs.
        (V::Object(x), V::Object(y)) if x.contains_key("Inline") && y.contains_key("Mesh") => None,
        (V::Object(x), V::Object(y)) if x.keys().eq(y.keys()) => x
            .iter()
            .filter(|(name, _)| !matches!(name.as_str(), "path" | "made_from" | "name"))
            .find_map(|(name, x)| difference(x, &y[name], &format!("{at}.{name}"))),
        _ => (a != b).then(|| format!("{at}: {a} and {b}")),
    }
}
