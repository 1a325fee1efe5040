//! Bump and normal maps: pbrt's materials have one of them, and a mix of materials has none.

use std::collections::HashMap;

use super::Writer;
use super::material::Said;
use super::text::Params;
use crate::ir::{Bsdf, BsdfKind, Id, Origin};
use crate::write::WriteError;

/// Mixes within each other whose parts are given the relief.
const DEEPEST: u32 = 32;

/// Adds the parameter of a relief.
type Add<'a> = &'a dyn Fn(Params) -> Params;

impl Writer<'_, '_> {
    /// A material with the parameter that `add` adds, or a mix of materials that have it.
    pub fn with_relief(&mut self, id: Id<Bsdf>, add: Add<'_>, origin: Origin) -> Result<Said, WriteError> {
        self.with_relief_below(id, add, origin, &mut HashMap::new(), DEEPEST)
    }

    fn with_relief_below(
        &mut self,
        id: Id<Bsdf>,
        add: Add<'_>,
        origin: Origin,
        made: &mut HashMap<Id<Bsdf>, String>,
        left: u32,
    ) -> Result<Said, WriteError> {
        let scene = self.scene;
        match &scene.bsdfs[id].kind {
            _ if self.nothing(id) => Ok(("interface", Params::default())),
            _ if left == 0 => {
                self.out.lose(origin, "a bump or normal map over a very deep mix", "the mix without it");
                self.said_of(id)
            }
            BsdfKind::TwoSided { front, .. } => self.with_relief_below(*front, add, origin, made, left - 1),
            BsdfKind::BumpMap { nested, .. } | BsdfKind::NormalMap { nested, .. } => {
                self.out.lose(origin, "a bump or normal map inside another one", "the outer one only");
                self.with_relief_below(*nested, add, origin, made, left - 1)
            }
            BsdfKind::Blend { weight, first, second } if !self.nothing(*first) && !self.nothing(*second) => {
                let mut names = Vec::new();
                for part in [*first, *second] {
                    if !made.contains_key(&part) {
                        let (plugin, p) = self.with_relief_below(part, add, origin, made, left - 1)?;
                        let name = self.free(&None, "material");
                        p.of_type(plugin).write(&mut self.definitions, "", "MakeNamedMaterial", &[&name]);
                        made.insert(part, name);
                    }
                    names.push(made[&part].clone());
                }
                let p = Params::default().strings("materials", &[&names[0], &names[1]]);
                Ok(("mix", self.float_input(p, "amount", weight)?))
            }
            _ => {
                let (plugin, p) = self.said_of(id)?;
                Ok((plugin, add(p)))
            }
        }
    }
}
