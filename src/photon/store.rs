//! The photon map: structure of arrays sorted by grid cell. Knows no BSDF.
//!
//! Cells are numbered x-fastest, so that the cells of one query in a row are one run of photons. A
//! query reads its runs front to back; nothing is followed by pointer.

use rayon::prelude::*;

use super::sort::{PART, by_cell};
use super::stored::{Rest, Stored};
use super::{PathClass, Smallness};
use crate::math::{Bounds, Color, Vec3};

/// A disc on a surface.
#[derive(Clone, Copy, Debug)]
pub struct Query {
    /// In the world.
    pub p: Vec3,
    /// Unit geometric normal of the side whose photons are wanted.
    pub n: Vec3,
    /// Rounding of positions at this place: photons this near to the tangent plane always count.
    pub lift: f32,
    /// In scene units.
    pub radius: f32,
}

/// Photons tested together; the columns of a map are padded by as many.
pub const LANES: usize = 16;
/// Smallest cosine between the normals of photon and query for the two to be on one surface.
pub const NORMAL_AGREEMENT: f32 = 0.6;
/// Height over the tangent plane, as a share of the distance, up to which a photon is on the surface.
/// Spheres of radius R keep all photons nearer than 0.6·R.
pub const HEIGHT: f32 = 0.3;

/// Sorted photons and the grid that finds them.
#[derive(Clone, Debug, Default)]
pub struct PhotonMap {
    pub(super) position: [Vec<f32>; 3],
    pub(super) flux: [Vec<f32>; 3],
    pub(super) normal: [Vec<i8>; 3],
    pub(super) direction: Vec<u32>,
    /// As in [`Rest`].
    tag: Vec<u8>,
    pub(super) depth: Vec<u8>,
    count: usize,
    /// First photon of each cell, and the count at the end.
    starts: Vec<u32>,
    origin: Vec3,
    pub(super) inverse_cell: f32,
    dims: [usize; 3],
    /// All photons are of this class.
    pub uniform_class: Option<PathClass>,
    /// Path segments of the deepest photon.
    pub deepest: u8,
}

/// Size of the sample of photons that decides the cell size of a map for k-nearest queries.
const SAMPLE: usize = 1 << 17;

/// Most cells of a grid for `n` photons: more take longer to clear than they save. Of many photons each has memory for
/// two.
fn cell_budget(n: usize) -> f32 {
    (16 * n).min((2 * n).max(1 << 22)).clamp(1 << 12, 1 << 27) as f32
}

impl PhotonMap {
    /// Sorts photons into cells of about `cell`, which for a fixed-radius query is best twice the radius.
    /// The result depends on the order of `photons` only through ties of position.
    pub fn build(photons: impl Into<Stored>, cell: f32) -> Self {
        let Stored { places, fluxes, rest } = photons.into();
        let bounds = Bounds::of(places.iter().map(|&p| p.into()));
        if places.is_empty() {
            return Self { starts: vec![0, 0], dims: [1; 3], inverse_cell: 0.0, ..Self::default() };
        }
        let extent = bounds.extent();
        let mut cell = cell.max(extent.max_element() / 1e6).max(f32::MIN_POSITIVE);
        let dims = loop {
            let d = (extent / cell).floor() + Vec3::ONE;
            if d.x * d.y * d.z <= cell_budget(places.len()) {
                break [d.x as usize, d.y as usize, d.z as usize];
            }
            cell *= 1.1;
        };
        let class = Rest::class(rest[0].tag);
        let mut map = Self {
            origin: bounds.min,
            inverse_cell: 1.0 / cell,
            dims,
            count: places.len(),
            deepest: rest.iter().map(|r| r.depth).max().unwrap_or(0),
            uniform_class: rest.iter().all(|r| Rest::class(r.tag) == class).then_some(class),
            ..Self::default()
        };
        let cells = dims.iter().product();
        let (order, starts) = by_cell(places.len(), cells, |i| map.cell_of(places[i].into()));
        map.starts = starts;
        // Padding is never within any radius, and its zero flux keeps 0·inf away.
        map.position = columns(&order, f32::INFINITY, |i| places[i]);
        drop(places);
        map.flux = columns(&order, 0.0, |i| fluxes[i]);
        drop(fluxes);
        map.normal = columns(&order, 0, |i| rest[i].normal);
        [map.direction] = columns(&order, 0, |i| [rest[i].direction]);
        [map.tag, map.depth] = columns(&order, 0, |i| [rest[i].tag, rest[i].depth]);
        map
    }

    /// Cell size for k-nearest queries: about as large as the disc that holds `k` photons, found from
    /// how many photons share an occupied cell of a trial grid.
    pub fn build_for_nearest(photons: impl Into<Stored>, k: usize, max_radius: f32) -> Self {
        let photons = photons.into();
        if photons.is_empty() {
            return Self::build(photons, max_radius);
        }
        let bounds = Bounds::of(photons.places.iter().map(|&p| p.into()));
        // A sample is enough to see how crowded the surfaces are.
        let step = photons.len().div_ceil(SAMPLE);
        let sample: Stored = photons.every(step);
        let trial_cell =
            (bounds.extent().max_element() / (sample.len() as f32).cbrt()).max(f32::MIN_POSITIVE);
        let trial = Self::build(sample, trial_cell);
        let occupied = trial.starts.windows(2).filter(|w| w[1] > w[0]).count().max(1);
        let per_cell = photons.len() as f32 / occupied as f32;
        let cell = (k as f32 / per_cell).sqrt() / trial.inverse_cell;
        Self::build(photons, cell.min(2.0 * max_radius))
    }

    /// Photons stored.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Memory of one photon in a map: position and flux, normal, direction, path and depth.
    pub const PHOTON_BYTES: usize = 6 * size_of::<f32>() + 3 + size_of::<u32>() + 2;

    /// Memory of all columns and of the grid.
    pub fn bytes(&self) -> usize {
        (self.count + LANES) * Self::PHOTON_BYTES + self.starts.len() * size_of::<u32>()
    }

    /// Where photon `i` lies.
    pub fn photon_position(&self, i: usize) -> Vec3 {
        Vec3::new(self.position[0][i], self.position[1][i], self.position[2][i])
    }

    /// The unit normal of photon `i`, to the precision of its three bytes.
    pub fn photon_normal(&self, i: usize) -> Vec3 {
        let n = |c: usize| f32::from(self.normal[c][i]);
        Vec3::new(n(0), n(1), n(2)).normalize_or(Vec3::Z)
    }

    /// Class of the path of photon `i`.
    #[inline(always)]
    pub(super) fn class(&self, i: usize) -> PathClass {
        Rest::class(self.tag[i])
    }

    /// How small the lamp of photon `i` is.
    #[inline(always)]
    pub(super) fn smallness(&self, i: usize) -> Smallness {
        Rest::smallness(self.tag[i])
    }

    #[inline(always)]
    fn coordinate(&self, x: f32, axis: usize) -> usize {
        // The cast saturates: positions outside the box fall into its border cells, so that a query
        // outside still reaches every neighbour inside.
        (((x - self.origin[axis]) * self.inverse_cell) as usize).min(self.dims[axis] - 1)
    }

    fn cell_of(&self, p: Vec3) -> usize {
        let [nx, ny, _] = self.dims;
        (self.coordinate(p.z, 2) * ny + self.coordinate(p.y, 1)) * nx + self.coordinate(p.x, 0)
    }

    /// Runs of photons in the cells that the cube around the query touches.
    #[inline(always)]
    pub(super) fn runs(&self, q: &Query) -> Runs<'_> {
        let (lo, hi) = (q.p - q.radius, q.p + q.radius);
        let y = [self.coordinate(lo.y, 1), self.coordinate(hi.y, 1)];
        let z = [self.coordinate(lo.z, 2), self.coordinate(hi.z, 2)];
        Runs { map: self, x: [self.coordinate(lo.x, 0), self.coordinate(hi.x, 0)], y, z, at: [y[0], z[0]] }
    }

    /// Where photon `i` lies.
    #[inline]
    pub fn place(&self, i: u32) -> Vec3 {
        Vec3::from_array(self.position.each_ref().map(|axis| axis[i as usize]))
    }

    /// Flux of photon `i`.
    #[inline(always)]
    pub fn flux_of(&self, i: usize) -> Color {
        Color::from_lanes([self.flux[0][i], self.flux[1][i], self.flux[2][i]])
    }
}

/// Columns of the photons in this order, padded by [`LANES`] times `pad`.
fn columns<T: Copy + Default + Send, const N: usize>(
    order: &[u32],
    pad: T,
    of: impl Fn(usize) -> [T; N] + Sync,
) -> [Vec<T>; N] {
    let mut columns: [Vec<T>; N] = std::array::from_fn(|_| vec![T::default(); order.len() + LANES]);
    let mut left = columns.each_mut().map(|column| column.chunks_mut(PART));
    let parts: Vec<_> = order
        .chunks(PART)
        .map(|order| (order, left.each_mut().map(|parts| parts.next().unwrap_or_default())))
        .collect();
    parts.into_par_iter().for_each(|(order, mut parts)| {
        for (at, &i) in order.iter().enumerate() {
            parts.iter_mut().zip(of(i as usize)).for_each(|(column, value)| column[at] = value);
        }
    });
    columns.iter_mut().for_each(|column| column[order.len()..].fill(pad));
    columns
}

/// Rows of cells, each a run of photons.
pub(super) struct Runs<'a> {
    map: &'a PhotonMap,
    x: [usize; 2],
    y: [usize; 2],
    z: [usize; 2],
    at: [usize; 2],
}

impl Runs<'_> {
    /// First photon of the next run, and one past its last; runs may be empty.
    #[inline(always)]
    pub fn next(&mut self) -> Option<(usize, usize)> {
        let [y, z] = self.at;
        if z > self.z[1] {
            return None;
        }
        self.at = if y < self.y[1] { [y + 1, z] } else { [self.y[0], z + 1] };
        let row = (z * self.map.dims[1] + y) * self.map.dims[0];
        let starts = &self.map.starts;
        Some((starts[row + self.x[0]] as usize, starts[row + self.x[1] + 1] as usize))
    }
}
