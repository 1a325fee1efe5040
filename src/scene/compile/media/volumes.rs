//! Volumes of the IR → volumes.

use std::sync::Arc;

use caustica_formats::ir::{self, ColorSlot, GridSamples, Transform, VolumeData, VolumeFilter, WrapMode};
use caustica_formats::volume;

use super::super::Compiler;
use crate::math::{Affine, Color, Vec3};
use crate::medium::{Beyond, Bricks, Cloud, Grid, Nodes, Reading, Values, Volume};

/// Numbers of a grid before anything is made of them.
pub(super) struct Loaded {
    pub grid: Grid,
    /// Lengths of a cell's edges in the world, the shortest.
    pub cell: f64,
}

impl Compiler<'_> {
    /// A colour or a vector by the place.
    pub(super) fn volume(&mut self, v: &ir::Volume, slot: ColorSlot, origin: ir::Origin) -> Option<Volume> {
        Some(match v {
            ir::Volume::Constant(color) => Volume::Constant(self.color(color, slot, origin)),
            ir::Volume::Direction(d) => Volume::Constant(Color::from_lanes(d.map(|x| x as f32))),
            ir::Volume::Grid(grid) => {
                let mut grid = self.load_grid(grid, origin)?.grid;
                if slot == ColorSlot::Reflectance {
                    self.clean(&mut grid, 1.0, origin);
                }
                Volume::Grid(Arc::new(grid), Color::ONE)
            }
            ir::Volume::Cloud(_) => {
                self.refuse("a cloud anywhere but in the density of a medium", origin);
                return None;
            }
        })
    }

    /// pbrt's cloud, times a colour.
    pub(super) fn cloud(&mut self, cloud: &ir::Cloud, tint: Color, origin: ir::Origin) -> Option<Volume> {
        let [low, high] = cloud.bounds;
        let size = std::array::from_fn(|i| high[i] - low[i]);
        let to_ours = Transform::translate(self.origin.map(|x| -x)).after(&cloud.to_world);
        let boxed = to_ours.after(&Transform::translate(low)).after(&Transform::scale(size));
        let (Some(to_noise), Some(to_box)) = (to_ours.inverse(), boxed.inverse()) else {
            self.error("the box of this cloud is singular", origin);
            return None;
        };
        let cloud = Cloud {
            to_noise: affine(&to_noise),
            to_box: affine(&to_box),
            density: cloud.density as f32,
            wispiness: cloud.wispiness as f32,
            frequency: cloud.frequency as f32,
        };
        Some(Volume::Cloud(Box::new(cloud), tint))
    }

    /// Replaces what cannot be meant, and says so.
    pub(super) fn clean(&mut self, grid: &mut Grid, most: f32, origin: ir::Origin) {
        let cleaned = grid.clean(most);
        if cleaned > 0 {
            let text = format!(
                "{cleaned} numbers of a volume are negative or above {most:.3e}: they count as 0 or as that"
            );
            self.warn(text, origin);
        }
    }

    /// The grid with its place.
    pub(super) fn load_grid(&mut self, v: &ir::VolumeGrid, origin: ir::Origin) -> Option<Loaded> {
        let (size, channels, values, own) = match &v.data {
            VolumeData::Inline(v) => (v.resolution, v.channels, Values::Dense(v.values.clone()), None),
            VolumeData::File(file) => {
                let read = self.files.read(&file.path).map_err(|e| e.to_string());
                let read =
                    read.and_then(|bytes| volume::read(&bytes, &file.format).map_err(|e| e.to_string()));
                let grid = match read {
                    Ok(grid) => grid,
                    Err(e) => {
                        self.error(format!("{}: {e}", file.path.display()), origin);
                        return None;
                    }
                };
                (grid.resolution, grid.channels, values(grid.store), grid.place)
            }
        };
        let expected = size.iter().map(|n| u128::from(*n)).product::<u128>() * u128::from(channels);
        let numbers = values.dense().map_or(expected, |data| data.len() as u128);
        if expected == 0 || numbers != expected || !matches!(channels, 1 | 3 | 6) {
            let text = format!("{numbers} numbers do not fill a volume of {size:?} with {channels} channels");
            self.error(text, origin);
            return None;
        }
        let bounded = v.bounds.map(|[low, high]| {
            Transform::translate(low).after(&Transform::scale(std::array::from_fn(|i| high[i] - low[i])))
        });
        let placed = v.to_world.after(&bounded.or(own).unwrap_or(Transform::IDENTITY));
        let to_ours = Transform::translate(self.origin.map(|x| -x)).after(&placed);
        let Some(inverse) = to_ours.inverse() else {
            self.error("the to_world of this volume is singular", origin);
            return None;
        };
        let cell = (0..3)
            .map(|a| {
                let edge = to_ours.vector(std::array::from_fn(|b| f64::from(u8::from(a == b))));
                edge.iter().map(|x| x * x).sum::<f64>().sqrt() / f64::from(size[a])
            })
            .fold(f64::INFINITY, f64::min);
        let reading = Reading {
            to_local: affine(&inverse),
            nodes: match v.samples {
                GridSamples::Centers => Nodes::Centers,
                GridSamples::Corners => Nodes::Corners,
            },
            beyond: match v.wrap {
                WrapMode::Repeat => Beyond::Repeat,
                WrapMode::Mirror => Beyond::Mirror,
                WrapMode::Clamp => Beyond::Clamp,
                _ => Beyond::Zero,
            },
            clipped: v.wrap != WrapMode::Repeat && v.wrap != WrapMode::Mirror && v.wrap != WrapMode::Clamp,
            smooth: v.filter == VolumeFilter::Trilinear,
        };
        Some(Loaded { grid: Grid { size, channels, values, reading }, cell })
    }
}

fn values(store: volume::Store) -> Values {
    match store {
        volume::Store::Dense(data) => Values::Dense(data),
        volume::Store::Bricks(bricks) => {
            let volume::Bricks { offset, count, index, full, constants } = bricks;
            Values::Sparse(Bricks { offset, count, index, full, constants })
        }
    }
}

pub(super) fn affine(m: &Transform) -> Affine {
    let column = |c: usize| Vec3::new(m.0[0][c] as f32, m.0[1][c] as f32, m.0[2][c] as f32);
    Affine { matrix3: glam::Mat3A::from_cols(column(0), column(1), column(2)), translation: column(3) }
}
