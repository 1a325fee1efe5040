//! How much a medium absorbs and scatters.

use std::sync::Arc;

use caustica_formats::ir::{self, ColorSlot};

use super::super::Compiler;
use super::ratio;
use super::volumes::Loaded;
use crate::math::Color;
use crate::medium::{Grid, Scattering, Values, Volume};

/// Optical depth of a cell above which it is as good as a wall: a grid's extinction is cut there, because flights take
/// as many steps as the optical depth has units.
const DEEPEST_CELL: f64 = 1e4;

impl Compiler<'_> {
    /// The extinction, and what is scattered of it.
    pub(super) fn coefficients(&mut self, m: &ir::Medium) -> Option<(Volume, Scattering)> {
        let at = m.origin;
        if !(m.scale.is_finite() && m.scale >= 0.0) {
            self.error(format!("the scale of a medium is {}, not a finite number from 0", m.scale), at);
            return None;
        }
        let scale = m.scale as f32;
        match &m.coefficients {
            ir::Coefficients::Extinction { sigma_t, albedo } => {
                let extinction = self.dense(sigma_t, m.density.as_ref(), scale, at)?;
                let albedo = self.volume(albedo, ColorSlot::Reflectance, at)?;
                Some((extinction, Scattering::Albedo(albedo)))
            }
            ir::Coefficients::Parts { sigma_a, sigma_s } => match [sigma_a, sigma_s] {
                [ir::Volume::Constant(a), ir::Volume::Constant(s)] => {
                    let [a, s] = [a, s].map(|c| self.coefficient(c, at));
                    let extinction = self.thickened(a + s, m.density.as_ref(), scale, at)?;
                    Some((extinction, Scattering::Albedo(Volume::Constant(ratio(s, a + s)))))
                }
                volumes => self.sum(volumes, m.density.as_ref(), scale, at),
            },
        }
    }

    /// A coefficient, which is never below 0.
    fn coefficient(&mut self, color: &ir::Color, at: ir::Origin) -> Color {
        let c = self.color(color, ColorSlot::Unbounded, at);
        if c.min_element() < 0.0 || !c.is_finite() {
            self.error(format!("a coefficient of a medium is {c}, not a finite number from 0"), at);
            return Color::ZERO;
        }
        c
    }

    /// A coefficient by the place, times a density.
    fn dense(
        &mut self,
        sigma: &ir::Volume,
        density: Option<&ir::Volume>,
        scale: f32,
        at: ir::Origin,
    ) -> Option<Volume> {
        match sigma {
            ir::Volume::Constant(color) => {
                let color = self.coefficient(color, at);
                self.thickened(color, density, scale, at)
            }
            ir::Volume::Grid(grid) => {
                let scale = self.even(density, at)? * scale;
                let loaded = self.load_grid(grid, at)?;
                Some(Volume::Grid(Arc::new(self.confined(loaded, scale, at)), Color::splat(scale)))
            }
            _ => {
                self.refuse("a medium with such a coefficient", at);
                None
            }
        }
    }

    /// A colour times a density.
    fn thickened(
        &mut self,
        color: Color,
        density: Option<&ir::Volume>,
        scale: f32,
        at: ir::Origin,
    ) -> Option<Volume> {
        match density {
            Some(ir::Volume::Grid(grid)) => {
                let loaded = self.load_grid(grid, at)?;
                let tint = color * scale;
                Some(Volume::Grid(Arc::new(self.confined(loaded, tint.max_element(), at)), tint))
            }
            Some(ir::Volume::Cloud(cloud)) => self.cloud(cloud, color * scale, at),
            density => Some(Volume::Constant(color * (self.even(density, at)? * scale))),
        }
    }

    /// A density that is the same everywhere.
    fn even(&mut self, density: Option<&ir::Volume>, at: ir::Origin) -> Option<f32> {
        match density {
            None => Some(1.0),
            Some(ir::Volume::Constant(color)) => Some(self.coefficient(color, at).lanes()[0]),
            Some(_) => {
                self.refuse("a density that varies, of coefficients that vary themselves,", at);
                None
            }
        }
    }

    /// A grid of an extinction: nothing beyond its box, and no cell deeper than matters.
    fn confined(&mut self, loaded: Loaded, scale: f32, at: ir::Origin) -> Grid {
        let Loaded { mut grid, cell } = loaded;
        grid.reading.clipped = true;
        let most = DEEPEST_CELL / (cell * f64::from(scale).max(f64::from(f32::MIN_POSITIVE)));
        self.clean(&mut grid, most.min(f64::from(f32::MAX)) as f32, at);
        grid
    }

    /// σa + σs where one of them is a grid at least, and σs.
    fn sum(
        &mut self,
        volumes: [&ir::Volume; 2],
        density: Option<&ir::Volume>,
        scale: f32,
        at: ir::Origin,
    ) -> Option<(Volume, Scattering)> {
        let scale = self.even(density, at)? * scale;
        let mut parts = Vec::new();
        for volume in volumes {
            parts.push(match volume {
                ir::Volume::Constant(color) => Ok(self.coefficient(color, at)),
                ir::Volume::Grid(grid) => {
                    let grid = self.load_grid(grid, at)?;
                    if grid.grid.values.dense().is_none() {
                        self.refuse("a medium whose coefficients are sparse grids", at);
                        return None;
                    }
                    Err(Box::new(self.confined(grid, scale, at)))
                }
                _ => {
                    self.refuse("a medium with such a coefficient", at);
                    return None;
                }
            });
        }
        let scattered = match &parts[1] {
            Ok(color) => Volume::Constant(*color * scale),
            Err(grid) => Volume::Grid(Arc::new(Grid::clone(grid)), Color::splat(scale)),
        };
        let place = |grid: &Grid| (grid.size, grid.reading.to_local.to_cols_array());
        if let [Err(a), Err(s)] = parts.as_slice()
            && place(a) != place(s)
        {
            self.refuse("a medium whose two grids differ in size or place", at);
            return None;
        }
        let whole = parts.into_iter().reduce(add)?.err()?;
        Some((Volume::Grid(whole.into(), Color::splat(scale)), Scattering::Coefficient(scattered)))
    }
}

/// The sum of colours and grids of the same size, which are dense.
fn add(a: Result<Color, Box<Grid>>, b: Result<Color, Box<Grid>>) -> Result<Color, Box<Grid>> {
    let (grid, other) = match (a, b) {
        (Ok(a), Ok(b)) => return Ok(a + b),
        (Err(grid), other) | (other, Err(grid)) => (grid, other),
    };
    let value = |grid: &Grid, i: usize| -> Color {
        let (n, data) = (grid.channels as usize, grid.values.dense().unwrap_or_default());
        Color::from_lanes(std::array::from_fn(|c| data[i * n + c.min(n - 1)]))
    };
    let count = grid.size.iter().map(|n| *n as usize).product();
    let data = (0..count).flat_map(|i| {
        let more = match &other {
            Ok(color) => *color,
            Err(other) => value(other, i),
        };
        (value(&grid, i) + more).lanes()
    });
    let values = Values::Dense(data.collect());
    Err(Box::new(Grid { channels: 3, values, ..*grid }))
}
