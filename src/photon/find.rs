//! Queries of the photon map: all photons of a disc, or the nearest.

use super::scan;
use super::store::{PhotonMap, Query};

impl PhotonMap {
    /// Calls `found(index, squared distance)` for every photon of the disc, in storage order.
    #[inline]
    pub fn within(&self, q: &Query, found: &mut impl FnMut(u32, f32)) {
        if !self.is_empty() {
            scan::visit(self, q, found);
        }
    }

    /// The `k` nearest photons of the disc (fewer if it holds fewer) as (squared distance, index) in
    /// `out`, unordered. Ties go to the lower index, so the set does not depend on how it is searched.
    /// `hint` is where to start; it is updated and affects speed only.
    pub fn nearest(&self, q: &Query, k: usize, hint: &mut f32, out: &mut Vec<(f32, u32)>) {
        out.clear();
        if self.is_empty() || k == 0 {
            return;
        }
        let mut radius =
            if *hint > 0.0 { hint.min(q.radius) } else { (1.0 / self.inverse_cell).min(q.radius) };
        loop {
            out.clear();
            self.within(&Query { radius, ..*q }, &mut |i, d2| out.push((d2, i)));
            if out.len() >= k || radius >= q.radius {
                break;
            }
            let growth = if out.len() > 8 { (k as f32 / out.len() as f32).sqrt() * 1.1 } else { 2.0 };
            radius = (radius * growth.clamp(1.1, 2.0)).min(q.radius);
        }
        if out.len() > k {
            let by_distance = |a: &(f32, u32), b: &(f32, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
            out.select_nth_unstable_by(k - 1, by_distance);
            out.truncate(k);
            // A tenth more than this query needed: its neighbour will need about as much.
            *hint = out[k - 1].0.sqrt() * 1.1;
        } else {
            *hint = radius;
        }
    }
}
