//! Media, phase functions and volumes.

use super::Writer;
use super::color::rgb_element;
use super::element::{Element, number};
use crate::ir::{
    Coefficients, ColorSlot, GridSamples, Id, Medium, Origin, Phase, Shape, Transform, Volume, VolumeData,
    VolumeFile, VolumeFilter, VolumeFormat, VolumeGrid, WrapMode,
};
use crate::write::{Output, WriteError};

/// A coefficient as Mitsuba takes it: a number of any size, or a colour of at most 1, whose rest goes into `scale`.
fn within_one(name: &str, rgb: [f64; 3], scale: &mut f64) -> Element {
    if rgb == [rgb[0]; 3] {
        return color(name, rgb);
    }
    let most = rgb.into_iter().fold(1.0, f64::max);
    *scale *= most;
    color(name, rgb.map(|v| v / most))
}

impl Writer<'_, '_> {
    /// A medium in its place of use, under `name`.
    pub fn medium(&mut self, name: Option<&'static str>, id: Id<Medium>) -> Result<Element, WriteError> {
        let named = |element: Element| match name {
            Some(name) => element.with("name", name),
            None => element,
        };
        if let Some(id) = &self.ids.media[id.index()] {
            return Ok(named(Element::new("ref").with("id", id.clone())));
        }
        self.medium_element(id).map(named)
    }

    /// A medium of the top level.
    pub fn medium_definition(&mut self, id: Id<Medium>) -> Result<Element, WriteError> {
        let element = self.medium_element(id)?;
        Ok(element.id(self.ids.media[id.index()].as_deref()))
    }

    /// The media on both sides of a shape.
    pub fn media(&mut self, shape: &Shape) -> Result<Vec<Element>, WriteError> {
        let Some(media) = shape.media else { return Ok(Vec::new()) };
        let sides = [("interior", media.interior), ("exterior", media.exterior)];
        sides.into_iter().filter_map(|(name, id)| Some(self.medium(Some(name), id?))).collect()
    }

    fn medium_element(&mut self, id: Id<Medium>) -> Result<Element, WriteError> {
        let scene = self.scene;
        let medium = &scene.media[id];
        if medium.emission.is_some() {
            self.out.lose(medium.origin, "light that a medium emits", "a medium that emits none");
        }
        let element =
            if medium.is_homogeneous() { self.homogeneous(medium) } else { self.heterogeneous(medium)? };
        let phase = self.phase(&medium.phase, medium.origin)?;
        Ok(if medium.phase == Phase::Isotropic { element } else { element.child(phase) })
    }

    fn homogeneous(&mut self, medium: &Medium) -> Element {
        let origin = medium.origin;
        let element = Element::plugin("medium", "homogeneous");
        let mut scale = medium.scale;
        if let Some(Volume::Constant(color)) = &medium.density {
            scale *= self.rgb(color, ColorSlot::Unbounded, origin)[0];
        }
        let (sigma_t, albedo) = match &medium.coefficients {
            Coefficients::Extinction { sigma_t, albedo } => {
                let albedo = self.volume_color("albedo", albedo, origin);
                (self.extinction("sigma_t", sigma_t, &mut scale, origin), albedo)
            }
            Coefficients::Parts { .. } => {
                let [sigma_t, albedo] = self.out.constant_coefficients(medium).unwrap_or_default();
                (within_one("sigma_t", sigma_t, &mut scale), color("albedo", albedo))
            }
        };
        element.child(sigma_t).child(albedo).float_unless("scale", scale, 1.0)
    }

    fn extinction(&mut self, name: &str, volume: &Volume, scale: &mut f64, origin: Origin) -> Element {
        if let Volume::Constant(color) = volume {
            let rgb = self.rgb(color, ColorSlot::Unbounded, origin);
            if rgb.into_iter().any(|v| v > 1.0) {
                return within_one(name, rgb, scale);
            }
        }
        self.volume_color(name, volume, origin)
    }

    fn volume_color(&mut self, name: &str, volume: &Volume, origin: Origin) -> Element {
        match volume {
            Volume::Constant(color) => self.color(name, color, ColorSlot::Unbounded, origin),
            _ => color(name, [0.0; 3]),
        }
    }

    fn heterogeneous(&mut self, medium: &Medium) -> Result<Element, WriteError> {
        let element = Element::plugin("medium", "heterogeneous");
        let origin = medium.origin;
        match (&medium.coefficients, &medium.density) {
            // As Mitsuba has it.
            (Coefficients::Extinction { sigma_t: Volume::Grid(sigma_t), albedo }, None) => {
                let sigma_t = self.grid("sigma_t", sigma_t, origin)?;
                let albedo = self.volume("albedo", albedo, origin)?;
                return Ok(element.child(sigma_t).child(albedo).float_unless("scale", medium.scale, 1.0));
            }
            (
                Coefficients::Extinction { sigma_t: Volume::Constant(sigma_t), albedo },
                Some(Volume::Grid(grid)),
            ) if is_unit_cube(grid) => {
                let mut scale = medium.scale;
                let sigma_t = Volume::Constant(sigma_t.clone());
                let value = self.extinction("value", &sigma_t, &mut scale, origin);
                let sigma_t = Element::plugin("volume", "constvolume").with("name", "sigma_t");
                let sigma_t = sigma_t.child(value).transform("to_world", &grid.to_world);
                let albedo = self.volume("albedo", albedo, origin)?;
                return Ok(element.child(sigma_t).child(albedo).float_unless("scale", scale, 1.0));
            }
            _ => {}
        }
        if let (Some([sigma_t, albedo]), Some(Volume::Grid(density))) =
            (self.out.constant_coefficients(medium), &medium.density)
            && sigma_t == [sigma_t[0]; 3]
        {
            let density = self.grid("sigma_t", density, origin)?;
            let scale = medium.scale * sigma_t[0];
            return Ok(element
                .child(density)
                .child(color("albedo", albedo))
                .float_unless("scale", scale, 1.0));
        }
        self.baked(medium)
    }

    /// With a grid for each of extinction and albedo.
    fn baked(&mut self, medium: &Medium) -> Result<Element, WriteError> {
        let Some(baked) = self.out.baked(medium)? else {
            let what = "a medium of pbrt's procedural cloud";
            self.out.lose(medium.origin, what, "a medium that neither absorbs nor scatters");
            let vacuum = Element::plugin("medium", "homogeneous").float("sigma_t", 0.0);
            return Ok(vacuum.float("albedo", 0.0));
        };
        let what = "a medium whose coefficients vary in colour";
        let instead = "grids of extinction and albedo, between whose values it is interpolated instead";
        self.out.lose(medium.origin, what, instead);
        let pairs = baked.sigma_a.iter().zip(&baked.sigma_s);
        let sigma_t: Vec<f32> =
            pairs.clone().flat_map(|(a, s)| [0, 1, 2].map(|i| (a[i] + s[i]) as f32)).collect();
        let albedo = pairs.flat_map(|(a, s)| {
            [0, 1, 2].map(|i| if a[i] + s[i] > 0.0 { (s[i] / (a[i] + s[i])) as f32 } else { 0.0 })
        });
        let albedo: Vec<f32> = albedo.collect();
        let stem = medium.name.as_deref().unwrap_or("medium");
        let key = format!("medium {:p}", std::ptr::from_ref(medium));
        let size = (baked.resolution, 3);
        let grid = |name: &str, file: String| {
            let volume = Element::plugin("volume", "gridvolume").string("filename", &file);
            volume.with("name", name).transform("to_world", &baked.place)
        };
        let file = self.out.make_vol(&format!("{key} sigma_t"), stem, size, || sigma_t)?;
        let sigma_t = grid("sigma_t", file);
        let file = self.out.make_vol(&format!("{key} albedo"), stem, size, || albedo)?;
        Ok(Element::plugin("medium", "heterogeneous").child(sigma_t).child(grid("albedo", file)))
    }

    fn volume(&mut self, name: &str, volume: &Volume, origin: Origin) -> Result<Element, WriteError> {
        match volume {
            Volume::Grid(grid) => self.grid(name, grid, origin),
            _ => Ok(self.volume_color(name, volume, origin)),
        }
    }

    fn grid(&mut self, name: &str, grid: &VolumeGrid, origin: Origin) -> Result<Element, WriteError> {
        let wrap = match grid.wrap {
            WrapMode::Repeat => Some("repeat"),
            WrapMode::Mirror => Some("mirror"),
            WrapMode::Clamp | WrapMode::One => None,
            WrapMode::Zero => {
                if self.out.field(grid)?.has_border() {
                    let what = "a volume that ends at its outermost values";
                    self.out.lose(origin, what, "one whose outermost values last to the end of their cells");
                }
                None
            }
        };
        let kept = match &grid.data {
            VolumeData::File(file @ VolumeFile { format: VolumeFormat::Vol, .. })
                if grid.samples == GridSamples::Centers
                    && self.out.is("VOL of floats", &file.path, holds_floats)? =>
            {
                Some(self.out.carry(&file.path, "volumes"))
            }
            _ => None,
        };
        let element = Element::plugin("volume", "gridvolume").with("name", name);
        let element = match kept {
            Some(file) => {
                let place = match grid.bounds {
                    None => grid.to_world,
                    Some([min, max]) => {
                        let size = Transform::scale(std::array::from_fn(|i| max[i] - min[i]));
                        grid.to_world.after(&Transform::translate(min)).after(&size)
                    }
                };
                let element = element.string("filename", &file);
                element.transform("to_world", &place).boolean_unless(
                    "use_grid_bbox",
                    grid.bounds.is_none(),
                    false,
                )
            }
            None => {
                let field = self.out.field(grid)?;
                let size = (field.grid.resolution, field.grid.channels);
                let key = match &grid.data {
                    VolumeData::File(file) => format!("volume {file:?}"),
                    VolumeData::Inline(values) => format!("volume {:p}", std::sync::Arc::as_ptr(values)),
                };
                let file = self.out.make_vol(&key, &Output::volume_stem(grid), size, || field.values())?;
                element.string("filename", &file).transform("to_world", &field.place)
            }
        };
        let nearest = (grid.filter == VolumeFilter::Nearest).then_some("nearest");
        let text = |element: Element, name: &str, value: Option<&str>| match value {
            Some(value) => element.string(name, value),
            None => element,
        };
        Ok(text(text(element, "filter_type", nearest), "wrap_mode", wrap))
    }

    fn phase(&mut self, phase: &Phase, origin: Origin) -> Result<Element, WriteError> {
        let plugin = |kind: &str| Element::plugin("phase", kind);
        Ok(match phase {
            Phase::Isotropic => plugin("isotropic"),
            Phase::HenyeyGreenstein { g } => plugin("hg").float_unless("g", *g, 0.8),
            Phase::Rayleigh => plugin("rayleigh"),
            Phase::Tabulated { values } => {
                let values = values.iter().map(|v| number(*v)).collect::<Vec<_>>().join(", ");
                plugin("tabphase").string("values", &values)
            }
            Phase::Sggx { matrix } => plugin("sggx").child(self.volume("S", matrix, origin)?),
            Phase::Blend { weight, parts } => {
                let weight = self.volume("weight", weight, origin)?;
                let parts = [self.phase(&parts[0], origin)?, self.phase(&parts[1], origin)?];
                plugin("blendphase").child(weight).children(parts)
            }
            Phase::Mixture(parts) => {
                let sum: f64 = parts.iter().map(|(weight, _)| weight).sum();
                if sum < 1.0 - 1e-6 {
                    let what =
                        format!("a mixture of phase functions that loses {} of the light", number(1.0 - sum));
                    self.out.lose(origin, what, "one that loses nothing");
                }
                self.blends(parts, sum, origin)?
            }
            Phase::KajiyaKay { .. } | Phase::Microflake { .. } => {
                let what = format!("a phase function of fibres, `{}`", phase.name());
                self.out.lose(origin, what, "an isotropic one");
                plugin("isotropic")
            }
        })
    }

    /// Two by two: the first against all others.
    fn blends(&mut self, parts: &[(f64, Phase)], sum: f64, origin: Origin) -> Result<Element, WriteError> {
        let [(weight, first), others @ ..] = parts else { return Ok(Element::plugin("phase", "isotropic")) };
        let first = self.phase(first, origin)?;
        if others.is_empty() || sum <= *weight {
            return Ok(first);
        }
        let rest = self.blends(others, sum - weight, origin)?;
        let blend = Element::plugin("phase", "blendphase").float("weight", 1.0 - weight / sum);
        Ok(blend.child(first).child(rest))
    }
}

/// Whether it is what the extinction of Mitsuba's heterogeneous media is confined by.
fn is_unit_cube(grid: &VolumeGrid) -> bool {
    let one = match &grid.data {
        VolumeData::Inline(values) => values.resolution == [1; 3] && values.values == [1.0],
        VolumeData::File(_) => false,
    };
    one && grid.bounds == Some([[0.0; 3], [1.0; 3]]) && grid.wrap == WrapMode::Clamp
}

/// Mitsuba 3 reads no other encoding.
fn holds_floats(bytes: &[u8]) -> bool {
    bytes.get(4..8) == Some(&[1, 0, 0, 0])
}

fn color(name: &str, rgb: [f64; 3]) -> Element {
    match rgb {
        [r, g, b] if r == g && g == b => Element::new("float").with("name", name).with("value", number(r)),
        _ => rgb_element(name, rgb),
    }
}
