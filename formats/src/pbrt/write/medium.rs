//! Media and the interfaces between them.

use super::Writer;
use super::text::{Params, transform};
use crate::ir::{
    Coefficients, Color, ColorSlot, GridSamples, Id, Medium, MediumEmission, MediumInterface, Origin, Phase,
    Transform, Volume, VolumeData, VolumeFile, VolumeFilter, VolumeFormat, VolumeGrid, WrapMode, rounded,
};
use crate::pbrt::medium::Y_INTEGRAL;
use crate::write::{Names, WriteError};

/// Plugin, parameters and the transform of its space.
type Said = (&'static str, Params, Transform);

impl Writer<'_, '_> {
    /// Sets the media inside and outside of what follows.
    pub fn medium_interface(&mut self, text: &mut String, indent: &str, media: MediumInterface) {
        let names =
            [media.interior, media.exterior].map(|id| id.map_or("", |id| self.media[id.index()].as_str()));
        Params::default().write(text, indent, "MediumInterface", &names);
    }

    /// Around what follows.
    pub fn around(&mut self, text: &mut String, indent: &str, medium: Option<Id<Medium>>) {
        self.medium_interface(text, indent, MediumInterface { interior: None, exterior: medium });
    }

    /// Names all media.
    pub fn name_media(&mut self) {
        let mut taken = Names::default();
        let names = self.scene.media.iter();
        self.media =
            names.map(|(_, medium)| taken.free_or_numbered(medium.name.as_deref(), "medium")).collect();
    }

    /// Defines all media. pbrt wants that before WorldBegin if the camera is in one, and after Camera if one has a
    /// place.
    pub fn define_media(&mut self, text: &mut String) -> Result<(), WriteError> {
        let scene = self.scene;
        for (id, medium) in scene.media.iter() {
            let (plugin, p, place) = self.said_medium(medium)?;
            let p = p.float_unless("g", self.mean_cosine(medium), 0.0).of_type(plugin);
            self.place(text, "", medium.origin);
            transform(text, "", &place);
            let name = self.media[id.index()].clone();
            p.write(text, "", "MakeNamedMedium", &[&name]);
        }
        Ok(())
    }

    /// The mean cosine of the phase function that stands for a medium's.
    fn mean_cosine(&mut self, medium: &Medium) -> f64 {
        match &medium.phase {
            Phase::Isotropic => 0.0,
            Phase::HenyeyGreenstein { g } => *g,
            other => {
                let g = mean_cosine(other).clamp(-0.999, 0.999);
                let what = format!("a phase function of kind `{}`", other.name());
                self.out.lose(
                    medium.origin,
                    what,
                    format!("Henyey-Greenstein's of the same mean cosine, {g:.4}"),
                );
                g
            }
        }
    }

    fn said_medium(&mut self, medium: &Medium) -> Result<Said, WriteError> {
        let origin = medium.origin;
        if medium.is_homogeneous() {
            let p = self.parts(Params::default(), medium);
            let mut scale = medium.scale;
            if let Some(Volume::Constant(color)) = &medium.density {
                scale *= self.out.rgb(color, ColorSlot::Unbounded, origin)[0];
            }
            let p = self.emitted(p.float_unless("scale", scale, 1.0), medium);
            return Ok(("homogeneous", p, Transform::IDENTITY));
        }
        let [first, second] = medium.coefficients.volumes();
        let constant = matches!([first, second], [Volume::Constant(_), Volume::Constant(_)]);
        match &medium.density {
            Some(Volume::Cloud(cloud)) if constant => {
                let mut p = self.parts(Params::default(), medium);
                if medium.scale != 1.0 {
                    let [sigma_a, sigma_s] = self.parts_times(medium, medium.scale);
                    p = Params::default().rgb("sigma_a", sigma_a).rgb("sigma_s", sigma_s);
                }
                let p = p
                    .float_unless("density", cloud.density, 1.0)
                    .float_unless("wispiness", cloud.wispiness, 1.0)
                    .float_unless("frequency", cloud.frequency, 5.0);
                return Ok(("cloud", bounded(p, cloud.bounds), cloud.to_world));
            }
            Some(Volume::Grid(grid)) if constant => {
                let p = self.parts(Params::default(), medium).float_unless("scale", medium.scale, 1.0);
                return self.uniform_grid(p, grid, medium);
            }
            None => {
                if let Coefficients::Extinction {
                    sigma_t: Volume::Grid(grid),
                    albedo: Volume::Constant(albedo),
                } = &medium.coefficients
                    && self.out.field(grid)?.grid.channels == 1
                {
                    let albedo = self.out.rgb(albedo, ColorSlot::Unbounded, origin);
                    let p = Params::default().rgb("sigma_a", albedo.map(|a| rounded(1.0 - a).max(0.0)));
                    let p = p.rgb("sigma_s", albedo).float_unless("scale", medium.scale, 1.0);
                    return self.uniform_grid(p, grid, medium);
                }
            }
            _ => {}
        }
        self.rgb_grid(medium)
    }

    fn uniform_grid(&mut self, p: Params, grid: &VolumeGrid, medium: &Medium) -> Result<Said, WriteError> {
        if let VolumeData::File(VolumeFile { path, format: VolumeFormat::NanoVdb { grid: name } }) =
            &grid.data
            && grid.bounds.is_none()
        {
            let file = self.out.carry(path, "volumes");
            let p = p.string("filename", &file);
            let p = if name == "density" { p } else { p.string("gridname", name) };
            return Ok(("nanovdb", self.heat(p, medium), grid.to_world));
        }
        let (p, place) = self.values(p, "density", grid, medium.origin)?;
        let p = match &medium.emission {
            None => p,
            Some(MediumEmission::Radiance { radiance: Volume::Constant(radiance), scale }) => {
                let p = self.color(p, "Le", radiance, ColorSlot::Emission, medium.origin);
                self.emission_scale(p, scale, medium.origin)?
            }
            Some(MediumEmission::Temperature {
                kelvin: Volume::Grid(kelvin), offset, factor, scale, ..
            }) => {
                let (p, _) = self.numbers(p, "temperature", kelvin, medium.origin)?;
                let p = p.float_unless("temperatureoffset", *offset, 0.0);
                let p = p.float_unless("temperaturescale", *factor, 1.0);
                self.emission_scale(p, scale, medium.origin)?
            }
            Some(_) => self.no_emission(p, medium.origin),
        };
        Ok(("uniformgrid", p, place))
    }

    fn no_emission(&mut self, p: Params, origin: Origin) -> Params {
        self.out.lose(origin, "light of a medium that varies in this way", "a medium that emits none");
        p
    }

    fn emission_scale(&mut self, p: Params, scale: &Volume, origin: Origin) -> Result<Params, WriteError> {
        Ok(match scale {
            Volume::Grid(grid) if is_tent(grid) => p,
            Volume::Grid(grid) => self.numbers(p, "Lescale", grid, origin)?.0,
            _ => self.no_emission(p, origin),
        })
    }

    /// Emission by a temperature in the same file as the density.
    fn heat(&mut self, p: Params, medium: &Medium) -> Params {
        let Some(emission) = &medium.emission else { return p };
        if let MediumEmission::Temperature {
            kelvin: Volume::Grid(VolumeGrid { data: VolumeData::File(file), .. }),
            offset,
            factor,
            scale: Volume::Constant(Color::Gray(scale)),
            ..
        } = emission
            && let VolumeFormat::NanoVdb { grid } = &file.format
        {
            let p = if grid == "temperature" { p } else { p.string("temperaturename", grid) };
            let p = p.float_unless("temperatureoffset", *offset, 0.0);
            return p.float_unless("temperaturescale", *factor, 1.0).float_unless("Lescale", *scale, 1.0);
        }
        self.no_emission(p, medium.origin)
    }

    /// The emission of a medium that is the same everywhere.
    fn emitted(&mut self, p: Params, medium: &Medium) -> Params {
        match &medium.emission {
            None => p,
            Some(MediumEmission::Radiance {
                radiance: Volume::Constant(radiance),
                scale: Volume::Constant(Color::Gray(scale)),
            }) => {
                let p = self.color(p, "Le", radiance, ColorSlot::Emission, medium.origin);
                p.float_unless("Lescale", *scale, 1.0)
            }
            Some(_) => self.no_emission(p, medium.origin),
        }
    }

    /// σa and σs of constant coefficients, without the scale.
    fn parts(&mut self, p: Params, medium: &Medium) -> Params {
        let (origin, slot) = (medium.origin, ColorSlot::Unbounded);
        if let Coefficients::Parts { sigma_a: Volume::Constant(a), sigma_s: Volume::Constant(s) } =
            &medium.coefficients
        {
            let p = self.color(p, "sigma_a", a, slot, origin);
            return self.color(p, "sigma_s", s, slot, origin);
        }
        let [absorbed, scattered] = self.parts_times(medium, 1.0);
        p.rgb("sigma_a", absorbed).rgb("sigma_s", scattered)
    }

    /// Absorption and scattering times `scale`.
    fn parts_times(&mut self, medium: &Medium, scale: f64) -> [[f64; 3]; 2] {
        let [sigma_t, albedo] = self.out.constant_coefficients(medium).unwrap_or_default();
        let scattered = [0, 1, 2].map(|i| rounded(sigma_t[i] * albedo[i] * scale));
        [[0, 1, 2].map(|i| rounded(sigma_t[i] * scale - scattered[i]).max(0.0)), scattered]
    }

    /// A grid of numbers with its size and box, and the transform of that box.
    fn values(
        &mut self,
        p: Params,
        name: &str,
        grid: &VolumeGrid,
        origin: Origin,
    ) -> Result<(Params, Transform), WriteError> {
        let (p, resolution) = self.numbers(p, name, grid, origin)?;
        let p = sized(p, resolution);
        Ok(match grid.bounds {
            Some(bounds) if grid.samples == GridSamples::Centers => (bounded(p, bounds), grid.to_world),
            _ => (p, self.out.field(grid)?.place),
        })
    }

    fn numbers(
        &mut self,
        p: Params,
        name: &str,
        grid: &VolumeGrid,
        origin: Origin,
    ) -> Result<(Params, [u32; 3]), WriteError> {
        let field = self.out.field(grid)?;
        if grid.wrap != WrapMode::Zero && field.has_border() {
            let what = "a volume whose outermost values last to the end of their cells";
            self.out.lose(origin, what, "one that falls to zero there");
        }
        if grid.filter == VolumeFilter::Nearest && field.grid.resolution != [1; 3] {
            self.out.lose(origin, "a volume without interpolation", "an interpolated one");
        }
        let values = field.values();
        let negative = values.iter().filter(|v| **v < 0.0).count();
        if negative > 0 {
            self.out.lose(origin, format!("{negative} negative values of a volume"), "zeros");
        }
        Ok((p.singles("float", name, values.into_iter().map(|v| v.max(0.0))), field.grid.resolution))
    }

    fn rgb_grid(&mut self, medium: &Medium) -> Result<Said, WriteError> {
        let origin = medium.origin;
        if let (Coefficients::Parts { sigma_a, sigma_s }, None) = (&medium.coefficients, &medium.density)
            && let Some(said) = self.as_rgb_grid(medium, sigma_a, sigma_s)?
        {
            return Ok(said);
        }
        let Some(baked) = self.out.baked(medium)? else {
            self.out.lose(origin, "a medium of a cloud that varies in colour", "a medium that does nothing");
            let p = Params::default().rgb("sigma_a", [0.0; 3]).rgb("sigma_s", [0.0; 3]);
            return Ok(("homogeneous", p, Transform::IDENTITY));
        };
        let what = "a medium whose extinction and albedo vary";
        self.out.lose(
            origin,
            what,
            "a grid of its coefficients, which are zero beyond their outermost values",
        );
        let p = sized(Params::default(), baked.resolution);
        let singles = |v: &[[f64; 3]]| v.as_flattened().iter().map(|v| *v as f32).collect::<Vec<_>>();
        let p = p.singles("rgb", "sigma_a", singles(&baked.sigma_a));
        let p = p.singles("rgb", "sigma_s", singles(&baked.sigma_s));
        let p = if medium.emission.is_some() { self.no_emission(p, origin) } else { p };
        Ok(("rgbgrid", p, baked.place))
    }

    /// As pbrt has it: grids of three channels in one box.
    fn as_rgb_grid(
        &mut self,
        medium: &Medium,
        sigma_a: &Volume,
        sigma_s: &Volume,
    ) -> Result<Option<Said>, WriteError> {
        let is_one = |volume: &Volume| *volume == Volume::number(1.0);
        let of = |volume: &Volume| match volume {
            Volume::Grid(grid) if fits(grid) => Some(grid.clone()),
            _ => None,
        };
        let (a, s) = (of(sigma_a), of(sigma_s));
        let (Some(grid), true, true) =
            (a.as_ref().or(s.as_ref()), a.is_some() || is_one(sigma_a), s.is_some() || is_one(sigma_s))
        else {
            return Ok(None);
        };
        let same = |other: &VolumeGrid| {
            other.bounds == grid.bounds && other.to_world == grid.to_world && size(other) == size(grid)
        };
        if ![&a, &s].into_iter().flatten().all(same) {
            return Ok(None);
        }
        let (bounds, place) = (grid.bounds.unwrap_or([[0.0; 3], [1.0; 3]]), grid.to_world);
        let mut p = bounded(sized(Params::default(), size(grid).unwrap_or([1; 3])), bounds);
        for (name, grid) in [("sigma_a", &a), ("sigma_s", &s)] {
            if let Some(grid) = grid {
                p = p.singles("rgb", name, self.out.field(grid)?.values());
            }
        }
        p = p.float_unless("scale", medium.scale, 1.0);
        p = match &medium.emission {
            None => p,
            Some(MediumEmission::Radiance {
                radiance: Volume::Grid(radiance),
                scale: Volume::Constant(Color::Gray(scale)),
            }) if fits(radiance) && same(radiance) && a.is_some() => {
                let p = p.singles("rgb", "Le", self.out.field(radiance)?.values());
                p.float_unless("Lescale", scale / Y_INTEGRAL, 1.0)
            }
            Some(_) => self.no_emission(p, medium.origin),
        };
        Ok(Some(("rgbgrid", p, place)))
    }
}

/// What pbrt has where no `Lescale` is given.
fn is_tent(grid: &VolumeGrid) -> bool {
    matches!(&grid.data, VolumeData::Inline(values) if values.resolution == [1; 3] && values.values == [1.0])
}

/// Whether pbrt's grid of colours is the same.
fn fits(grid: &VolumeGrid) -> bool {
    let colours = matches!(&grid.data, VolumeData::Inline(values) if values.channels == 3);
    let plain = grid.filter == VolumeFilter::Trilinear && grid.samples == GridSamples::Centers;
    colours && plain && grid.wrap == WrapMode::Zero && grid.bounds.is_some()
}

fn size(grid: &VolumeGrid) -> Option<[u32; 3]> {
    match &grid.data {
        VolumeData::Inline(values) => Some(values.resolution),
        VolumeData::File(_) => None,
    }
}

fn sized(p: Params, [x, y, z]: [u32; 3]) -> Params {
    p.integer("nx", x.into()).integer("ny", y.into()).integer("nz", z.into())
}

fn bounded(p: Params, [min, max]: [[f64; 3]; 2]) -> Params {
    p.numbers("point3", "p0", min).numbers("point3", "p1", max)
}

/// The mean cosine of the scattering angle; blends count by their weight where it is constant.
fn mean_cosine(phase: &Phase) -> f64 {
    match phase {
        Phase::HenyeyGreenstein { g } => *g,
        Phase::Mixture(parts) => {
            let sum: f64 = parts.iter().map(|(weight, _)| weight).sum();
            if sum > 0.0 {
                parts.iter().map(|(w, part)| w * mean_cosine(part)).sum::<f64>() / sum
            } else {
                0.0
            }
        }
        Phase::Blend { weight, parts } => {
            let w = match weight {
                Volume::Constant(Color::Gray(w)) => w.clamp(0.0, 1.0),
                _ => 0.5,
            };
            (1.0 - w) * mean_cosine(&parts[0]) + w * mean_cosine(&parts[1])
        }
        Phase::Tabulated { values } => {
            // The integrals of a line through two values, times 1 and times the cosine.
            let step = 2.0 / (values.len().max(2) - 1) as f64;
            let pairs = values.windows(2).enumerate();
            let (mut total, mut first) = (0.0, 0.0);
            for (i, pair) in pairs {
                let (left, right) = (-1.0 + step * i as f64, -1.0 + step * (i + 1) as f64);
                total += 0.5 * step * (pair[0] + pair[1]);
                first += step / 6.0 * (pair[0] * (2.0 * left + right) + pair[1] * (left + 2.0 * right));
            }
            if total > 0.0 { first / total } else { 0.0 }
        }
        _ => 0.0,
    }
}
