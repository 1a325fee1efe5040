//! The photon map: structure of arrays sorted by grid cell. Knows no BSDF.
//!
//! Cells are numbered x-fastest, so that the cells of one query in a row are one run of photons. A
//! query reads its runs front to back; nothing is followed by pointer.

use rayon::prelude::*;

use super::PathClass;
use crate::transport::Smallness;
use crate::math::{Bounds, Color, Vec3, encode_direction};

/// A photon as traced.
#[derive(Clone, Copy, Debug)]
pub struct Photon {
    /// In the world.
    pub p: Vec3,
    /// W per channel.
    pub flux: Color,
    /// Unit, back towards where it came from.
    pub wi: Vec3,
    /// Unit geometric normal of the side it arrived at.
    pub n: Vec3,
    /// Of the light path that left it.
    pub class: PathClass,
    /// Path segments from the lamp, saturating.
    pub depth: u8,
    /// Of the lamp, as the first surface saw it; counts for glints only.
    pub smallness: Smallness,
}

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
    /// Path class in the lowest two bits, smallness of the lamp above.
    class: Vec<u8>,
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

/// Most cells of a grid for `n` photons: more take longer to clear than they save.
fn cell_budget(n: usize) -> f32 {
    (16 * n).clamp(1 << 12, 1 << 27) as f32
}

impl PhotonMap {
    /// Sorts photons into cells of about `cell`, which for a fixed-radius query is best twice the radius.
    /// The result depends on the order of `photons` only through ties of position.
    pub fn build(photons: &[Photon], cell: f32) -> Self {
        let bounds = Bounds::of(photons.iter().map(|p| p.p));
        if photons.is_empty() {
            return Self { starts: vec![0, 0], dims: [1; 3], inverse_cell: 0.0, ..Self::default() };
        }
        let extent = bounds.extent();
        let mut cell = cell.max(extent.max_element() / 1e6).max(f32::MIN_POSITIVE);
        let dims = loop {
            let d = (extent / cell).floor() + Vec3::ONE;
            if d.x * d.y * d.z <= cell_budget(photons.len()) {
                break [d.x as usize, d.y as usize, d.z as usize];
            }
            cell *= 1.1;
        };
        let mut map = Self {
            origin: bounds.min,
            inverse_cell: 1.0 / cell,
            dims,
            count: photons.len(),
            deepest: photons.iter().map(|p| p.depth).max().unwrap_or(0),
            ..Self::default()
        };
        let first = photons[0].class;
        map.uniform_class = photons.iter().all(|p| p.class == first).then_some(first);

        let mut order: Vec<u64> = photons
            .par_iter()
            .with_min_len(1 << 14)
            .enumerate()
            .map(|(i, p)| (map.cell_of(p.p) as u64) << 32 | i as u64)
            .collect();
        order.par_sort_unstable();
        map.starts = vec![0; dims.iter().product::<usize>() + 1];
        let mut next = 0;
        for (i, key) in order.iter().enumerate() {
            let c = (key >> 32) as usize;
            // Cells between the last photon's and this one's start here too.
            if c >= next {
                map.starts[next..=c].fill(i as u32);
                next = c + 1;
            }
        }
        map.starts[next..].fill(photons.len() as u32);

        // Every photon is read once, where it lies: that is the cache miss that costs.
        let parts: Vec<Columns> = order
            .par_chunks(1 << 16)
            .map(|keys| {
                let mut part = Columns::default();
                keys.iter().for_each(|key| part.push(&photons[(key & 0xffff_ffff) as usize]));
                part
            })
            .collect();
        drop(order);
        for part in parts {
            for c in 0..3 {
                map.position[c].extend(&part.position[c]);
                map.flux[c].extend(&part.flux[c]);
                map.normal[c].extend(&part.normal[c]);
            }
            map.direction.extend(&part.direction);
            map.class.extend(&part.class);
            map.depth.extend(&part.depth);
        }
        for c in 0..3 {
            // Padding is never within any radius, and its zero flux keeps 0·inf away.
            map.position[c].extend([f32::INFINITY; LANES]);
            map.flux[c].extend([0.0; LANES]);
            map.normal[c].extend([0; LANES]);
        }
        map
    }

    /// Cell size for k-nearest queries: about as large as the disc that holds `k` photons, found from
    /// how many photons share an occupied cell of a trial grid.
    pub fn build_for_nearest(photons: &[Photon], k: usize, max_radius: f32) -> Self {
        let bounds = Bounds::of(photons.iter().map(|p| p.p));
        if photons.is_empty() {
            return Self::build(photons, max_radius);
        }
        // A sample is enough to see how crowded the surfaces are.
        let step = photons.len().div_ceil(SAMPLE);
        let sample: Vec<Photon> = photons.iter().step_by(step).copied().collect();
        let trial_cell =
            (bounds.extent().max_element() / (sample.len() as f32).cbrt()).max(f32::MIN_POSITIVE);
        let trial = Self::build(&sample, trial_cell);
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
        self.count * Self::PHOTON_BYTES + LANES * (6 * 4 + 3) + self.starts.len() * size_of::<u32>()
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
        PathClass::from_tag(self.class[i] & 3)
    }

    /// How small the lamp of photon `i` is.
    #[inline(always)]
    pub(super) fn smallness(&self, i: usize) -> Smallness {
        Smallness::from_bits(self.class[i] >> 2)
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
}

/// Columns of a part of the sorted photons.
#[derive(Default)]
struct Columns {
    position: [Vec<f32>; 3],
    flux: [Vec<f32>; 3],
    normal: [Vec<i8>; 3],
    direction: Vec<u32>,
    class: Vec<u8>,
    depth: Vec<u8>,
}

impl Columns {
    fn push(&mut self, photon: &Photon) {
        let flux = photon.flux.lanes();
        for (c, flux) in flux.into_iter().enumerate() {
            self.position[c].push(photon.p[c]);
            self.flux[c].push(flux);
            self.normal[c].push((photon.n[c] * 127.0).round() as i8);
        }
        self.direction.push(encode_direction(photon.wi));
        self.class.push(photon.class as u8 | photon.smallness.bits() << 2);
        self.depth.push(photon.depth);
    }
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
