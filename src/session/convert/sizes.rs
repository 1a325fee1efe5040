//! How much light a loss of `convert` gains or takes, where a material is what changed.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use caustica_formats::files::Files;
use caustica_formats::ir::{
    self, Bsdf, Color, Emitter, EmitterKind, Filter, Fov, FovAxis, Id, Origin, Projection, Shape, ShapeKind,
    Transform, canonical,
};
use caustica_formats::{Content, Read, ReadOptions, Written, read_scene, write_scene};

use super::super::beside::Beside;
use super::super::{Options, Session};
use crate::render::Budget;

/// Pixels of a side, and samples in each: the mean of a material that reflects half errs by less than 1 %.
const SIDE: u32 = 24;
const PASSES: u32 = 16;

/// Gives each loss that names a material its size: the light of a ball of it in even light, afterwards against
/// before. Losses of other things keep none.
pub fn measure(read: &Read, files: &dyn Files, written: &mut Written) {
    let Some(mut stage) = stage(&read.scene) else { return };
    // By the place of a material, and by what it is: exporters repeat them.
    let mut known: BTreeMap<String, Option<f64>> = BTreeMap::new();
    let mut alike: BTreeMap<String, Option<f64>> = BTreeMap::new();
    let places: BTreeMap<String, Id<Bsdf>> = read
        .scene
        .bsdfs
        .iter()
        .filter_map(|(id, bsdf)| Some((read.sources.location(bsdf.origin.0?), id)))
        .collect();
    let folder = read.sources.paths().next().and_then(Path::parent).unwrap_or(Path::new(""));
    let extension = written.path.extension().unwrap_or_default();
    let path = folder.join("caustica-ball").with_extension(extension);
    // The ball shows its front.
    for loss in written.losses.iter_mut().filter(|loss| !loss.what.contains("on its back")) {
        let Some((place, id)) = loss.place.as_ref().and_then(|place| places.get_key_value(place)) else {
            continue;
        };
        loss.size = *known.entry(place.clone()).or_insert_with(|| {
            let ball = ball(&mut stage, *id)?;
            *alike.entry(ball.to_string()).or_insert_with(|| size(ball, files, &path))
        });
    }
}

/// Relative change of the light; `None` where one of the balls cannot be rendered or is black.
fn size(ball: serde_json::Value, files: &dyn Files, path: &Path) -> Option<f64> {
    let scene: ir::Scene = serde_json::from_value(ball).ok()?;
    let options = Options { spectrum_rule: scene.spectra_as, ..options() };
    let before = mean(&Session::of(scene.clone(), files, path, &options).ok()?);
    let read = Read { scene, warnings: Vec::new(), sources: Default::default() };
    let written = write_scene(&read, files, path).ok()?;
    let made = files_of(&written, files);
    let files = Beside { below: files, made: &made };
    let after = read_scene(&files, path, &ReadOptions::default()).ok()?;
    let after = mean(&Session::of(after.scene, &files, path, &options).ok()?);
    (before > 0.0).then(|| after / before - 1.0)
}

fn options() -> Options {
    let settings = [("integrator", "path"), ("max_depth", "20"), ("seed", "1")];
    Options {
        spectrum_rule: None,
        settings: settings.map(|(name, value)| (name.to_owned(), value.to_owned())).to_vec(),
        ..Options::default()
    }
}

fn mean(session: &Session) -> f64 {
    let pixels = session.render(Budget::passes(PASSES), &mut |_| {}).pixels;
    let sum: f64 = pixels.beauties(PASSES).map(caustica_formats::spectrum::luminance).sum();
    sum / pixels.len().max(1) as f64
}

/// A scene of one ball that fills the film, with light of 1 from everywhere and all materials of `scene`.
fn stage(scene: &ir::Scene) -> Option<ir::Scene> {
    let mut sensor = scene.sensors.get(scene.default_sensor)?.clone();
    sensor.to_world = Transform::look_at([0.0, -4.0, 0.0], [0.0; 3], [0.0, 0.0, 1.0])?;
    sensor.projection = Projection::Perspective { fov: Fov::Degrees(19.5), axis: FovAxis::X };
    (sensor.screen_window, sensor.lens) = (None, None);
    sensor.principal_point_offset = [0.0; 2];
    (sensor.near_clip, sensor.far_clip) = (0.01, 10_000.0);
    (sensor.film.width, sensor.film.height, sensor.film.crop) = (SIDE, SIDE, None);
    sensor.film.filter = Filter::Box { radius: 0.5 };
    (sensor.film.imaging_ratio, sensor.film.white_balance) = (1.0, None);
    let ball = Shape {
        name: None,
        origin: Origin(None),
        kind: ShapeKind::Sphere { center: [0.0; 3], radius: 1.0 },
        to_world: Transform::IDENTITY,
        bsdf: None,
        emission: None,
        flip_normals: false,
        alpha: None,
        media: None,
    };
    let kind = EmitterKind::Constant { radiance: Color::Gray(1.0) };
    let light = Emitter { name: None, origin: Origin(None), kind, medium: None };
    Some(ir::Scene {
        origin: scene.origin,
        spectrum_rule: scene.spectrum_rule,
        spectra_as: scene.spectra_as,
        hide_emitters: scene.hide_emitters,
        integrator: None,
        sensors: vec![sensor],
        default_sensor: 0,
        shapes: vec![ball],
        groups: Default::default(),
        bsdfs: scene.bsdfs.clone(),
        textures: scene.textures.clone(),
        media: Default::default(),
        emitters: vec![light],
    })
}

/// The stage with a ball of this material and no other, as JSON: places in files, which nobody asks for here, do not
/// survive, and equal balls are equal.
fn ball(stage: &mut ir::Scene, id: Id<Bsdf>) -> Option<serde_json::Value> {
    stage.shapes[0].bsdf = Some(id);
    let mut scene = canonical(stage);
    let bsdfs: Vec<_> = scene.bsdfs.iter().map(|(id, _)| id).collect();
    bsdfs.into_iter().for_each(|id| scene.bsdfs[id].name = None);
    let textures: Vec<_> = scene.textures.iter().map(|(id, _)| id).collect();
    textures.into_iter().for_each(|id| scene.textures[id].name = None);
    serde_json::to_value(scene).ok()
}

/// The files of a scene that was written in memory.
fn files_of(written: &Written, below: &dyn Files) -> BTreeMap<PathBuf, Vec<u8>> {
    let folder = written.path.parent().unwrap_or(Path::new(""));
    let bytes = |content: &Content| match content {
        Content::Bytes(bytes) => Some(bytes.clone()),
        Content::Copy(path) => below.read(path).ok(),
    };
    let assets = written.assets.iter();
    let mut made: BTreeMap<PathBuf, Vec<u8>> =
        assets.filter_map(|asset| Some((folder.join(&asset.path), bytes(&asset.content)?))).collect();
    made.insert(written.path.clone(), written.text.clone().into_bytes());
    made
}
