//! Who refers to whom.

use super::arena::{Arena, Id, Reference, Store, Stored};
use super::bsdf::Bsdf;
use super::medium::Medium;
use super::shape::ShapeGroup;
use super::table::Part;
use super::texture::Texture;
use super::{Scene, shape::Shape};

/// The scene with its arenas in the order of first use and without what nothing uses: two scenes
/// that mean the same and were written down in another order become equal.
pub fn canonical(scene: &Scene) -> Scene {
    let mut new = Scene {
        origin: scene.origin,
        spectrum_rule: scene.spectrum_rule,
        spectra_as: scene.spectra_as,
        hide_emitters: scene.hide_emitters,
        integrator: scene.integrator.clone(),
        sensors: Vec::new(),
        default_sensor: scene.default_sensor,
        shapes: Vec::new(),
        groups: Arena::default(),
        bsdfs: Arena::default(),
        textures: Arena::default(),
        media: Arena::default(),
        emitters: Vec::new(),
    };
    let mut moves = Moves {
        old: scene,
        groups: vec![None; scene.groups.len()],
        bsdfs: vec![None; scene.bsdfs.len()],
        textures: vec![None; scene.textures.len()],
        media: vec![None; scene.media.len()],
        new: &mut new,
    };
    let mut shapes = scene.shapes.clone();
    shapes.iter_mut().for_each(|shape| shape.references_mut(&mut |to| moves.follow(to)));
    let mut emitters = scene.emitters.clone();
    emitters.iter_mut().for_each(|emitter| emitter.references_mut(&mut |to| moves.follow(to)));
    let mut sensors = scene.sensors.clone();
    sensors.iter_mut().for_each(|sensor| sensor.medium.references_mut(&mut |to| moves.follow(to)));
    (new.shapes, new.emitters, new.sensors) = (shapes, emitters, sensors);
    new
}

struct Moves<'a> {
    old: &'a Scene,
    new: &'a mut Scene,
    groups: Vec<Option<Id<ShapeGroup>>>,
    bsdfs: Vec<Option<Id<Bsdf>>>,
    textures: Vec<Option<Id<Texture>>>,
    media: Vec<Option<Id<Medium>>>,
}

impl Moves<'_> {
    /// Moves what is referred to, unless it was moved before, and what it refers to before it: a reader
    /// meets them in this order.
    fn follow(&mut self, to: &mut Reference) {
        let index = to.index();
        if let Some(id) = to.to::<Bsdf>() {
            let moved = self.bsdfs[index].unwrap_or_else(|| {
                let mut moved = self.old.bsdfs[id].clone();
                moved.kind.references_mut(&mut |to| self.follow(to));
                self.new.bsdfs.push(moved)
            });
            self.bsdfs[index] = Some(moved);
            *to = moved.into();
        } else if let Some(id) = to.to::<Texture>() {
            let moved = self.textures[index].unwrap_or_else(|| {
                let mut moved = self.old.textures[id].clone();
                moved.kind.references_mut(&mut |to| self.follow(to));
                self.new.textures.push(moved)
            });
            self.textures[index] = Some(moved);
            *to = moved.into();
        } else if let Some(id) = to.to::<ShapeGroup>() {
            let moved = self.groups[index].unwrap_or_else(|| {
                let mut moved = self.old.groups[id].clone();
                let shapes = moved.shapes.iter_mut();
                shapes.for_each(|shape| shape.references_mut(&mut |to| self.follow(to)));
                self.new.groups.push(moved)
            });
            self.groups[index] = Some(moved);
            *to = moved.into();
        } else if let Some(id) = to.to::<Medium>() {
            let moved = self.media[index].unwrap_or_else(|| self.new.media.push(self.old.media[id].clone()));
            self.media[index] = Some(moved);
            *to = moved.into();
        }
    }
}

/// Everything in a scene that may refer to something or be read from a file: all shapes, also those of groups,
/// BSDFs, textures, emitters, media, and the media of sensors.
pub fn parts(scene: &Scene) -> impl Iterator<Item = &dyn Part> {
    let groups = scene.groups.iter().flat_map(|(_, group)| &group.shapes);
    let shapes = groups.chain(&scene.shapes).map(|shape: &Shape| shape as &dyn Part);
    let bsdfs = scene.bsdfs.iter().map(|(_, bsdf)| &bsdf.kind as &dyn Part);
    let textures = scene.textures.iter().map(|(_, texture)| &texture.kind as &dyn Part);
    let emitters = scene.emitters.iter().map(|emitter| emitter as &dyn Part);
    let media = scene.media.iter().map(|(_, medium)| medium as &dyn Part);
    let sensors = scene.sensors.iter().map(|sensor| &sensor.medium as &dyn Part);
    shapes.chain(bsdfs).chain(textures).chain(emitters).chain(media).chain(sensors)
}

/// How often each object of the arenas is referred to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Uses {
    bsdfs: Vec<usize>,
    textures: Vec<usize>,
    groups: Vec<usize>,
    media: Vec<usize>,
}

impl Uses {
    /// Counts the references of the whole scene, also those of objects that nothing uses.
    pub fn of(scene: &Scene) -> Self {
        let mut uses = Self {
            bsdfs: vec![0; scene.bsdfs.len()],
            textures: vec![0; scene.textures.len()],
            groups: vec![0; scene.groups.len()],
            media: vec![0; scene.media.len()],
        };
        for part in parts(scene) {
            part.references(&mut |to| uses.counts(to.store())[to.index()] += 1);
        }
        uses
    }

    /// References to one object.
    pub fn count<T: Stored>(&self, id: Id<T>) -> usize {
        let counts = match T::STORE {
            Store::Bsdfs => &self.bsdfs,
            Store::Textures => &self.textures,
            Store::Groups => &self.groups,
            Store::Media => &self.media,
        };
        counts[id.index()]
    }

    fn counts(&mut self, store: Store) -> &mut Vec<usize> {
        match store {
            Store::Bsdfs => &mut self.bsdfs,
            Store::Textures => &mut self.textures,
            Store::Groups => &mut self.groups,
            Store::Media => &mut self.media,
        }
    }
}
