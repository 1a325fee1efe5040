//! Meshes that Mitsuba joins when it loads a scene: those of equal materials, however these are named. It stops
//! where `flip_normals` differs among them.

use std::collections::{HashMap, HashSet};

use super::element::Element;

/// Plugins that are meshes to Mitsuba.
const MESHES: [&str; 5] = ["obj", "ply", "serialized", "cube", "rectangle"];

/// The places, among the shapes of the top level, of those with `flip_normals` that would be joined with one without.
pub(super) fn torn(root: &Element) -> HashSet<usize> {
    let shapes = root.nested().iter().filter(|element| element.is("shape")).enumerate();
    let meshes: Vec<_> = shapes.filter(|(_, shape)| may_be_joined(shape)).collect();
    let (flipped, others): (Vec<_>, Vec<_>) = meshes.into_iter().partition(|(_, shape)| is_flipped(shape));
    if flipped.is_empty() {
        return HashSet::new();
    }
    let mut materials = Materials::of(root);
    let front: HashSet<usize> = others.iter().filter_map(|(_, shape)| materials.of_shape(shape)).collect();
    let mut joined = |shape| materials.of_shape(shape).is_some_and(|material| front.contains(&material));
    flipped.into_iter().filter(|(_, shape)| joined(shape)).map(|(place, _)| place).collect()
}

/// Each lamp has an emitter of its own, which keeps it apart.
fn may_be_joined(shape: &Element) -> bool {
    MESHES.iter().any(|mesh| shape.is_a(mesh)) && !shape.nested().iter().any(|child| child.is("emitter"))
}

fn is_flipped(shape: &Element) -> bool {
    shape.nested().iter().any(|child| child.attribute("name") == Some("flip_normals"))
}

/// A number for all materials that say the same, whatever their names.
#[derive(Default)]
struct Materials<'a> {
    named: HashMap<&'a str, &'a Element>,
    numbers: HashMap<String, usize>,
    /// Of what has a name.
    known: HashMap<&'a str, usize>,
}

impl<'a> Materials<'a> {
    fn of(root: &'a Element) -> Self {
        let mut materials = Self::default();
        materials.name(root);
        materials
    }

    fn name(&mut self, element: &'a Element) {
        if let Some(id) = element.attribute("id").filter(|_| !element.is_reference()) {
            self.named.insert(id, element);
        }
        element.nested().iter().for_each(|child| self.name(child));
    }

    /// `None` without one: Mitsuba then gives each shape its own.
    fn of_shape(&mut self, shape: &'a Element) -> Option<usize> {
        let material = shape.nested().iter().find(|child| child.is("bsdf") || child.is_reference())?;
        Some(self.number(material))
    }

    fn number(&mut self, element: &'a Element) -> usize {
        let target = element.attribute("id").filter(|_| element.is_reference());
        if let Some(id) = target
            && let Some(object) = self.named.get(id).copied()
        {
            return match self.known.get(id) {
                Some(number) => *number,
                None => {
                    let number = self.number(object);
                    self.known.insert(id, number);
                    number
                }
            };
        }
        // Mitsuba takes no notice of the order.
        let mut nested: Vec<usize> = element.nested().iter().map(|child| self.number(child)).collect();
        nested.sort_unstable();
        let next = self.numbers.len();
        *self.numbers.entry(format!("{} {nested:?}", element.head())).or_insert(next)
    }
}
