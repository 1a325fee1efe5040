//! `caustica inspect`: the scene, its statistics and the plan.

use clap::Args;

use super::load::{Loaded, SceneArgs};
use super::report::{self, count, megabytes};

#[derive(Debug, Args)]
pub struct InspectArgs {
    #[command(flatten)]
    scene: SceneArgs,
}

pub fn run(args: &InspectArgs) -> Result<u8, String> {
    let loaded = args.scene.load(false)?;
    report::data(&describe(&loaded))?;
    Ok(0)
}

fn describe(l: &Loaded) -> String {
    let scene = &l.scene;
    let levels = std::iter::once(&scene.geometry.world).chain(&scene.geometry.groups);
    let primitives: usize = levels.map(|level| level.primitives).sum();
    let [_, _, w, h] = scene.film.crop;
    let [x, y, z] = scene.origin;
    let mut out = String::new();
    let mut row = |name: &str, value: String| out.push_str(&format!("{name:<20} {value}\n"));
    row("scene", l.path.display().to_string());
    row("film", format!("{w}×{h}"));
    row("shapes", scene.shapes.len().to_string());
    row("primitives", count(primitives as f64));
    row("instances", scene.geometry.instances.len().to_string());
    row("materials", scene.materials.len().to_string());
    row("textures", format!("{} ({})", scene.textures.0.len(), megabytes(scene.textures.bytes() as u64)));
    row("emitters", scene.emitters.len().to_string());
    row("emitted power", format!("{:.4} W", scene.power()));
    row("middle, radius", format!("({x:.4}, {y:.4}, {z:.4}), {:.4}", scene.sphere.radius));
    row("acceleration", megabytes(scene.geometry.bytes() as u64));
    out.push_str(&format!("{}\n\nsettings\n", l.plan));
    for (name, value) in l.settings.values() {
        out.push_str(&format!("  {name:<18} {value}\n"));
    }
    out.trim_end().to_owned()
}
