//! Volumes for writers: their values, where those stand, and new files of them.

use super::mesh::stem;
use super::{Output, WriteError};
use crate::ir::{
    Coefficients, ColorSlot, GridSamples, Medium, Origin, Transform, Volume, VolumeData, VolumeFilter,
    VolumeGrid, WrapMode, rounded,
};
use crate::volume::{self, Grid};

/// A grid with its values at hand, which stand in the middle of its cells.
pub(crate) struct Field {
    pub grid: Grid,
    /// From the unit cube, which all cells fill, to the world.
    pub place: Transform,
    filter: VolumeFilter,
    wrap: WrapMode,
}

impl Field {
    /// Whether any of the outermost values is not zero: what lies beyond them matters.
    pub fn has_border(&self) -> bool {
        let [nx, ny, nz] = self.grid.resolution;
        let outer = |i: u32, n: u32| i == 0 || i + 1 == n;
        self.points().any(|p| {
            (outer(p[0], nx) || outer(p[1], ny) || outer(p[2], nz))
                && (0..self.grid.channels).any(|c| self.grid.value(p, c) != 0.0)
        })
    }

    /// x fastest.
    pub fn points(&self) -> impl Iterator<Item = [u32; 3]> + use<> {
        let [nx, ny, nz] = self.grid.resolution;
        (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
    }

    /// All values as they are stored.
    pub fn values(&self) -> Vec<f32> {
        let channels = self.grid.channels;
        self.points().flat_map(|p| (0..channels).map(move |c| self.grid.value(p, c))).collect()
    }

    /// Where a value stands.
    fn position(&self, point: [u32; 3]) -> [f64; 3] {
        let n = self.grid.resolution;
        self.place.point(std::array::from_fn(|i| (f64::from(point[i]) + 0.5) / f64::from(n[i])))
    }

    /// The colour of a point in the world, given in the space of the cells' cube.
    fn color(&self, unit: [f64; 3]) -> [f64; 3] {
        let shift = if self.filter == VolumeFilter::Nearest { 0.0 } else { 0.5 };
        let n = self.grid.resolution;
        let at: [f64; 3] = std::array::from_fn(|i| unit[i] * f64::from(n[i]) - shift);
        let base = at.map(f64::floor);
        let mut sum = [0.0; 3];
        for corner in 0..8 {
            let bits = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight: f64 = match self.filter {
                VolumeFilter::Nearest => f64::from(u8::from(corner == 0)),
                VolumeFilter::Trilinear => (0..3)
                    .map(|i| if bits[i] == 1 { at[i] - base[i] } else { 1.0 - (at[i] - base[i]) })
                    .product(),
            };
            let index: [Option<u32>; 3] =
                std::array::from_fn(|i| self.index(base[i] as i64 + i64::from(bits[i]), n[i]));
            if let [Some(x), Some(y), Some(z)] = index {
                for (c, total) in sum.iter_mut().enumerate() {
                    let channel = if self.grid.channels == 1 { 0 } else { c as u32 };
                    *total += weight * f64::from(self.grid.value([x, y, z], channel));
                }
            }
        }
        sum
    }

    /// The index that stands for one that may be beyond the grid; `None` is zero.
    fn index(&self, i: i64, n: u32) -> Option<u32> {
        let n = i64::from(n);
        let inside = match self.wrap {
            _ if (0..n).contains(&i) => i,
            WrapMode::Repeat => i.rem_euclid(n),
            WrapMode::Mirror => {
                let i = i.rem_euclid(2 * n);
                if i < n { i } else { 2 * n - 1 - i }
            }
            WrapMode::Clamp | WrapMode::One => i.clamp(0, n - 1),
            WrapMode::Zero => return None,
        };
        Some(inside as u32)
    }
}

/// A colour that may vary.
enum Source {
    Constant([f64; 3]),
    Field(Box<Field>, Option<Transform>),
}

impl Source {
    fn at(&self, world: [f64; 3]) -> [f64; 3] {
        match self {
            Self::Constant(rgb) => *rgb,
            Self::Field(field, Some(to_unit)) => field.color(to_unit.point(world)),
            Self::Field(_, None) => [0.0; 3],
        }
    }
}

/// The coefficients of a medium at each point of a grid, as linear Rec. 709.
pub(crate) struct Baked {
    pub resolution: [u32; 3],
    /// From the unit cube of the cells to the world.
    pub place: Transform,
    /// 1/length.
    pub sigma_a: Vec<[f64; 3]>,
    /// 1/length.
    pub sigma_s: Vec<[f64; 3]>,
}

impl Output<'_> {
    pub fn field(&self, grid: &VolumeGrid) -> Result<Field, WriteError> {
        let values = match &grid.data {
            VolumeData::Inline(values) => Grid::from(values.as_ref()),
            VolumeData::File(file) => {
                let broken = |e: volume::VolumeError| WriteError::Asset {
                    path: file.path.clone(),
                    reason: e.to_string(),
                };
                volume::read(&self.read(&file.path)?, &file.format).map_err(broken)?
            }
        };
        let unit = match grid.bounds {
            Some([min, max]) => {
                Transform::translate(min).after(&Transform::scale(std::array::from_fn(|i| max[i] - min[i])))
            }
            None => values.place.unwrap_or(Transform::IDENTITY),
        };
        let mut place = grid.to_world.after(&unit);
        if grid.samples == GridSamples::Corners {
            // The cells around the values reach half a cell further.
            let n = values.resolution.map(f64::from);
            let size = n.map(|n| if n > 1.0 { n / (n - 1.0) } else { 1.0 });
            let wider = Transform::translate(size.map(|s| (1.0 - s) / 2.0)).after(&Transform::scale(size));
            place = place.after(&wider);
        }
        Ok(Field { grid: values, place, filter: grid.filter, wrap: grid.wrap })
    }

    /// A `VOL` file of these values.
    pub fn make_vol(
        &mut self,
        key: &str,
        stem: &str,
        (resolution, channels): ([u32; 3], u32),
        values: impl FnOnce() -> Vec<f32>,
    ) -> Result<String, WriteError> {
        self.make(key, "volumes", stem, "vol", |_| {
            let mut bytes = b"VOL\x03\x01\0\0\0".to_vec();
            bytes.extend(resolution.into_iter().chain([channels]).flat_map(u32::to_le_bytes));
            bytes.extend([0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0].into_iter().flat_map(f32::to_le_bytes));
            bytes.extend(values().into_iter().flat_map(f32::to_le_bytes));
            Ok(bytes)
        })
    }

    /// What to call a new file of a volume.
    pub fn volume_stem(grid: &VolumeGrid) -> String {
        match &grid.data {
            VolumeData::File(file) => stem(&file.path),
            VolumeData::Inline(_) => "volume".to_owned(),
        }
    }

    fn source(&mut self, volume: &Volume, origin: Origin) -> Result<Option<Source>, WriteError> {
        Ok(match volume {
            Volume::Constant(color) => Some(Source::Constant(self.rgb(color, ColorSlot::Unbounded, origin))),
            Volume::Grid(grid) => {
                let field = self.field(grid)?;
                let to_unit = field.place.inverse();
                Some(Source::Field(Box::new(field), to_unit))
            }
            Volume::Direction(_) | Volume::Cloud(_) => None,
        })
    }

    /// σa and σs at the points of the finest grid of a medium; `None` where one of its volumes is not to be had.
    pub fn baked(&mut self, medium: &Medium) -> Result<Option<Baked>, WriteError> {
        let origin = medium.origin;
        let one = Volume::number(1.0);
        let [first, second] = medium.coefficients.volumes();
        let mut sources = Vec::new();
        for volume in [medium.density.as_ref().unwrap_or(&one), first, second] {
            let Some(source) = self.source(volume, origin)? else { return Ok(None) };
            sources.push(source);
        }
        let points = |field: &Field| field.grid.resolution.iter().map(|n| u64::from(*n)).product::<u64>();
        let fields = sources.iter().filter_map(|source| match source {
            Source::Field(field, _) => Some(field.as_ref()),
            Source::Constant(_) => None,
        });
        let Some(finest) = fields.max_by_key(|field| points(field)) else { return Ok(None) };
        let parts = matches!(medium.coefficients, Coefficients::Parts { .. });
        let mut baked = Baked {
            resolution: finest.grid.resolution,
            place: finest.place,
            sigma_a: Vec::new(),
            sigma_s: Vec::new(),
        };
        for point in finest.points() {
            let world = finest.position(point);
            let [density, first, second] = [0, 1, 2].map(|i| sources[i].at(world));
            let lane = |i: usize| {
                let factor = density[i] * medium.scale;
                match parts {
                    true => [factor * first[i], factor * second[i]],
                    false => [factor * first[i] * (1.0 - second[i]), factor * first[i] * second[i]],
                }
            };
            baked.sigma_a.push([0, 1, 2].map(|i| lane(i)[0].max(0.0)));
            baked.sigma_s.push([0, 1, 2].map(|i| lane(i)[1].max(0.0)));
        }
        Ok(Some(baked))
    }

    /// The extinction and the albedo of a medium whose coefficients are constant.
    pub fn constant_coefficients(&mut self, medium: &Medium) -> Option<[[f64; 3]; 2]> {
        let [Volume::Constant(first), Volume::Constant(second)] = medium.coefficients.volumes() else {
            return None;
        };
        let [first, second] =
            [first, second].map(|color| self.rgb(color, ColorSlot::Unbounded, medium.origin));
        Some(match medium.coefficients {
            Coefficients::Extinction { .. } => [first, second],
            Coefficients::Parts { .. } => {
                let sum = [0, 1, 2].map(|i| rounded(first[i] + second[i]));
                [sum, [0, 1, 2].map(|i| if sum[i] > 0.0 { rounded(second[i] / sum[i]) } else { 0.0 })]
            }
        })
    }
}
