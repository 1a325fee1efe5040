//! Media of the IR → media.

mod check;
mod coefficients;
mod emission;
mod phase;
mod volumes;

pub use check::check;

use std::collections::HashMap;

use caustica_formats::ir::{self, Id};

use super::Compiler;
use crate::math::Color;
use crate::medium::{
    Boundary, Coefficients, Heterogeneous, Homogeneous, Medium, MediumId, Participate, Phase, Scattering,
    Volume,
};

/// The media that something stands in or borders on; others are never made.
#[derive(Default)]
pub struct MediumTable {
    media: Vec<Medium>,
    names: Vec<String>,
    known: HashMap<usize, Option<MediumId>>,
}

impl MediumTable {
    pub fn finish(self) -> (Vec<Medium>, Vec<String>) {
        (self.media, self.names)
    }
}

impl Compiler<'_> {
    /// The medium of the IR; `None` is vacuum. One that extinguishes nothing is vacuum too.
    pub(super) fn medium(&mut self, id: Option<Id<ir::Medium>>) -> Option<MediumId> {
        let id = id?;
        if let Some(known) = self.media.known.get(&id.index()) {
            return *known;
        }
        let ir = self.ir;
        let medium = &ir.media[id];
        // Written twice, it is still one medium, in which photons of both places are light.
        if let Some(known) = ir.media.iter().find_map(|(other, m)| {
            let known = self.media.known.get(&other.index())?;
            is_same(m, medium).then_some(*known)
        }) {
            self.media.known.insert(id.index(), known);
            return known;
        }
        let made = self.build_medium(medium).map(|built| {
            self.media.media.push(built);
            self.media
                .names
                .push(medium.name.clone().unwrap_or_else(|| format!("number {}", id.index() + 1)));
            MediumId(self.media.media.len() as u32 - 1)
        });
        self.media.known.insert(id.index(), made);
        made
    }

    /// What a shape parts.
    pub(super) fn boundary(&mut self, media: Option<ir::MediumInterface>) -> Option<Boundary> {
        let ir::MediumInterface { interior, exterior } = media?;
        Some(Boundary { inside: self.medium(interior), outside: self.medium(exterior) })
    }

    fn build_medium(&mut self, m: &ir::Medium) -> Option<Medium> {
        let (extinction, scattering) = self.coefficients(m)?;
        let radiance = match &m.emission {
            Some(emission) => Some(self.medium_emission(emission, m.origin)?),
            None => None,
        };
        let orientation = match &m.orientation {
            Some(volume) => Some(self.volume(volume, ir::ColorSlot::Unbounded, m.origin)?),
            None => None,
        };
        let phase = self.phase(&m.phase, orientation.as_ref(), m.origin)?;
        if extinction.largest() <= 0.0 {
            return None;
        }
        Some(assemble(extinction, scattering, radiance, phase))
    }
}

/// Whether the two differ in name and place at most.
fn is_same(a: &ir::Medium, b: &ir::Medium) -> bool {
    *b == ir::Medium { name: b.name.clone(), origin: b.origin, ..a.clone() }
}

/// Homogeneous where nothing varies.
fn assemble(extinction: Volume, scattering: Scattering, radiance: Option<Volume>, phase: Phase) -> Medium {
    let varies = |v: &Volume| !matches!(v, Volume::Constant(_));
    let (Scattering::Albedo(second) | Scattering::Coefficient(second)) = &scattering;
    let constant = !varies(&extinction) && !varies(second) && !radiance.as_ref().is_some_and(varies);
    let medium = Heterogeneous::new(extinction, scattering, radiance, phase);
    if constant && !medium.phase().has_area() {
        let coefficients: Coefficients = medium.mean();
        return Homogeneous::new(coefficients, medium.phase().clone()).into();
    }
    Medium::Heterogeneous(Box::new(medium))
}

/// Lane by lane a/b, 0 where b is 0.
fn ratio(a: Color, b: Color) -> Color {
    a.zip(b, |a, b| if b > 0.0 { (a / b).clamp(0.0, 1.0) } else { 0.0 })
}
