//! Participating media: closed forms, conservation of energy, boundaries of all kinds.

mod boundaries;
mod closed_forms;
mod furnace;
mod panes;
mod photons;

use crate::support::{Estimate, Picture, assert_agree};

/// A homogeneous medium of Mitsuba 3, with `phase` inside.
pub fn fog(name: &str, sigma_t: &str, albedo: &str, phase: &str) -> String {
    format!(
        "<medium type='homogeneous' name='{name}'><rgb name='sigma_t' value='{sigma_t}'/>
         <rgb name='albedo' value='{albedo}'/>{phase}</medium>"
    )
}

/// The same scaled, because Mitsuba's RGB are at most 1.
fn dense_fog(name: &str, scale: f64, albedo: &str, phase: &str) -> String {
    format!(
        "<medium type='homogeneous' name='{name}'><rgb name='sigma_t' value='1,1,1'/>
         <float name='scale' value='{scale}'/><rgb name='albedo' value='{albedo}'/>{phase}</medium>"
    )
}

fn hg(g: f64) -> String {
    format!("<phase type='hg'><float name='g' value='{g}'/></phase>")
}

/// A box from −1 to 1 after `transform`, without a surface of its own, with media inside its element.
pub fn container(transform: &str, media: &str) -> String {
    format!(
        "<shape type='cube'><transform name='to_world'>{transform}</transform><bsdf type='null'/>{media}</shape>"
    )
}

/// A sensor at `origin` that looks along +z, with media inside its element.
fn eye(origin: &str, fov: f64, size: u32, media: &str) -> String {
    format!(
        "<sensor type='perspective'><float name='fov' value='{fov}'/>
         <transform name='to_world'><lookat origin='{origin}' target='0,0,1000' up='0,1,0'/></transform>
         {}{media}</sensor>",
        crate::support::film(size, size)
    )
}

/// Mitsuba's VOL file of so many values along the axes.
fn vol(size: [usize; 3], channels: usize, value: impl Fn([usize; 3]) -> Vec<f32>) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    for n in [1, size[0] as i32, size[1] as i32, size[2] as i32, channels as i32] {
        bytes.extend(n.to_le_bytes());
    }
    for x in [0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0] {
        bytes.extend(x.to_le_bytes());
    }
    for z in 0..size[2] {
        for y in 0..size[1] {
            for x in 0..size[0] {
                value([x, y, z]).into_iter().for_each(|v| bytes.extend(v.to_le_bytes()));
            }
        }
    }
    bytes
}

/// All channels of the mean over the picture against `exact`.
#[track_caller]
fn shows(what: &str, picture: &Picture, exact: [f64; 3], relative: f64) {
    for (channel, value) in exact.into_iter().enumerate() {
        assert_agree(
            &format!("{what}, channel {channel}"),
            picture.beauty(channel),
            Estimate::exact(value),
            relative,
        );
    }
}
