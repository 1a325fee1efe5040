//! Sensor and film.

use caustica_formats::diagnostic::Diagnostic;
use caustica_formats::ir;
use caustica_formats::spectrum::white_balance;

use super::Compiler;
use crate::film::filter::{Box, Cubic, Gaussian, Lanczos, Shape, Sinc, Stretched, Tent, Truncated};
use crate::film::{FilmSize, Filter, Response};
use crate::math::{Vec2, Vec3};
use crate::sensor::{Axis, Orthographic, Perspective, Projection, Radiancemeter, Sensor, ThinLens, Window};
use crate::spectrum::rgb;

/// Diagonal of the 36 × 24 mm frame that focal lengths refer to.
const FRAME_DIAGONAL: f64 = 43.266_615_305_567_87;

/// The sensor to render.
pub fn choose<'a>(b: &mut Compiler<'a>) -> Option<&'a ir::Sensor> {
    let ir: &'a ir::Scene = b.ir;
    let index = b.options.sensor.unwrap_or(ir.default_sensor);
    let sensor = ir.sensors.get(index);
    if sensor.is_none() {
        b.diagnostics.push(if ir.sensors.is_empty() {
            Diagnostic::error("the scene has no sensor", ir.origin.0)
                .help("add <sensor type=\"perspective\"> with a to_world transform")
        } else {
            Diagnostic::error(
                format!("there is no sensor {index}: the scene has {}", ir.sensors.len()),
                ir.origin.0,
            )
        });
    }
    sensor
}

pub fn build(b: &mut Compiler<'_>, s: &ir::Sensor, origin: [f64; 3]) -> (Sensor, FilmSize, Filter) {
    let film = film_size(b, &s.film);
    let aspect = f64::from(film.width) / f64::from(film.height);
    let projection = projection(b, s, aspect);
    let orthographic = matches!(projection, Projection::Orthographic(_));
    if !(s.near_clip >= 0.0 && s.far_clip > s.near_clip) {
        b.error("the clipping planes must satisfy 0 <= near_clip < far_clip", s.origin);
    }
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|a| s.to_world.vector(a));
    let lengths = columns.map(|v| v.iter().map(|x| x * x).sum::<f64>().sqrt());
    if lengths.iter().any(|l| !l.is_normal()) {
        b.error("the sensor's to_world is singular", s.origin);
    } else if !orthographic && lengths.iter().any(|l| (l - 1.0).abs() > 1e-3) {
        b.warn("the sensor's to_world scales; the scale is removed", s.origin);
    }
    let axes = std::array::from_fn(|i| {
        let keep = orthographic && i < 2;
        let v = columns[i].map(|x| if keep { x } else { x / lengths[i] } as f32);
        Vec3::from(v)
    });
    // An orthographic camera may be scaled along its axis as well: its near plane then moves, but not
    // the distance between the planes (Mitsuba 3).
    let near = s.near_clip * if orthographic { lengths[2] } else { 1.0 };
    let p = s.to_world.point([0.0; 3]);
    let lens = s.lens.map(|l| ThinLens {
        aperture_radius: l.aperture_radius as f32,
        focus_distance: l.focus_distance as f32,
    });
    let [ox, oy] = s.principal_point_offset;
    let sensor = Sensor {
        projection,
        lens,
        axes,
        position: Vec3::new((p[0] - origin[0]) as f32, (p[1] - origin[1]) as f32, (p[2] - origin[2]) as f32),
        near: near as f32,
        far: (near + (s.far_clip - s.near_clip)) as f32,
        principal_point_offset: Vec2::new(ox as f32, oy as f32),
    };
    (sensor, film, filter(&s.film.filter))
}

pub fn response(film: &ir::Film) -> Response {
    let Some(kelvin) = film.white_balance else {
        return Response::Ratio(film.imaging_ratio as f32);
    };
    let rows = white_balance(kelvin);
    let image = |c: usize| rgb(rows.map(|row| (row[c] * film.imaging_ratio) as f32));
    Response::Colors([image(0), image(1), image(2)])
}

fn projection(b: &mut Compiler<'_>, s: &ir::Sensor, aspect: f64) -> Projection {
    if let Some([x0, x1, y0, y1]) = s.screen_window
        && !(x0 < x1 && y0 < y1)
    {
        b.error("the screen window is empty", s.origin);
    }
    let window = s.screen_window.map(Window::from_screen);
    let (fov, axis) = match s.projection {
        ir::Projection::Perspective { fov, axis } => field_of_view(fov, axis),
        ir::Projection::Orthographic => {
            let plain = Orthographic::new(aspect);
            return Projection::Orthographic(Orthographic { window: window.unwrap_or(plain.window) });
        }
        ir::Projection::Ray => return Projection::Radiancemeter(Radiancemeter),
    };
    if !(fov > 0.0 && fov < 180.0) {
        b.error(format!("the field of view must lie between 0 and 180 degrees, not {fov}"), s.origin);
    }
    let plain = Perspective::new(fov, axis, aspect);
    // A window of ±1 spans the angle.
    let tangent = (fov.to_radians() * 0.5).tan() as f32;
    Projection::Perspective(Perspective { window: window.map_or(plain.window, |w| w.scaled(tangent)) })
}

/// Largest film, in pixels: 2³⁰ of them need 112 GB of sums.
pub const MAX_PIXELS: u64 = 1 << 30;

fn film_size(b: &mut Compiler<'_>, f: &ir::Film) -> FilmSize {
    if f.width == 0 || f.height == 0 || u64::from(f.width) * u64::from(f.height) > MAX_PIXELS {
        b.refuse(format!("a film of {}×{} pixels", f.width, f.height), f.origin);
        return FilmSize::full(1, 1);
    }
    let mut size = FilmSize::full(f.width, f.height);
    if let Some(c) = f.crop {
        let fits = |o: u32, n: u32, full: u32| n > 0 && o.checked_add(n).is_some_and(|end| end <= full);
        if !fits(c.x, c.width, f.width) || !fits(c.y, c.height, f.height) {
            b.error(
                format!(
                    "the crop {}×{} at {},{} does not lie within the film of {}×{}",
                    c.width, c.height, c.x, c.y, f.width, f.height
                ),
                f.origin,
            );
        } else {
            size.crop = [c.x, c.y, c.width, c.height];
        }
    }
    size
}

/// Angle in degrees, and what it spans: a focal length speaks of the diagonal.
pub fn field_of_view(fov: ir::Fov, axis: ir::FovAxis) -> (f64, Axis) {
    match fov {
        ir::Fov::Degrees(d) => (d, fov_axis(axis)),
        ir::Fov::FocalLength(mm) => (2.0 * (FRAME_DIAGONAL * 0.5 / mm).atan().to_degrees(), Axis::Diagonal),
    }
}

fn fov_axis(axis: ir::FovAxis) -> Axis {
    match axis {
        ir::FovAxis::X => Axis::X,
        ir::FovAxis::Y => Axis::Y,
        ir::FovAxis::Diagonal => Axis::Diagonal,
        ir::FovAxis::Smaller => Axis::Smaller,
        ir::FovAxis::Larger => Axis::Larger,
    }
}

fn filter(f: &ir::Filter) -> Filter {
    let wide = |radius: [f64; 2], shape: &dyn Fn(f64) -> Shape| {
        Filter::separable(shape(radius[0]), shape(radius[1]))
    };
    Filter::new(match *f {
        ir::Filter::Box { radius } => Shape::Box(Box { radius }),
        ir::Filter::Tent { radius } => Shape::Tent(Tent { radius }),
        ir::Filter::Gaussian { stddev } => Shape::Gaussian(Gaussian { stddev }),
        ir::Filter::Mitchell { b, c } => Shape::Cubic(Cubic { b, c }),
        ir::Filter::CatmullRom => Shape::Cubic(Cubic { b: 0.0, c: 0.5 }),
        ir::Filter::Lanczos { lobes } => Shape::Lanczos(Lanczos { lobes }),
        ir::Filter::WideBox { radius } => return wide(radius, &|radius| Shape::Box(Box { radius })),
        ir::Filter::WideTent { radius } => return wide(radius, &|radius| Shape::Tent(Tent { radius })),
        ir::Filter::TruncatedGaussian { sigma, radius } => {
            return wide(radius, &|radius| Shape::Truncated(Truncated { sigma, radius }));
        }
        ir::Filter::ScaledMitchell { b, c, radius } => {
            return wide(radius, &|radius| Shape::Stretched(Stretched { cubic: Cubic { b, c }, radius }));
        }
        ir::Filter::WindowedSinc { tau, radius } => {
            return wide(radius, &|radius| Shape::Sinc(Sinc { tau, radius }));
        }
    })
}
