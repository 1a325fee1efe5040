//! What the objects of a scene are called: by the author's id, or else by who refers to them, or by their number.

use std::any::Any;
use std::collections::{BTreeSet, VecDeque};

use caustica_formats::ir::{Bsdf, BsdfKind, Id, Part, Reference, Scene, Texture, VisitField};

/// A name for every object that is seen, each once.
#[derive(Clone, Debug, Default)]
pub struct Names {
    taken: BTreeSet<String>,
    sensors: Vec<String>,
    emitters: Vec<String>,
    shapes: Vec<String>,
    /// Of the shapes of each group.
    groups: Vec<Vec<String>>,
    media: Vec<String>,
    /// Nothing for what no one refers to.
    bsdfs: Vec<Option<String>>,
    textures: Vec<Option<String>>,
}

impl Names {
    /// For the objects of a scene.
    pub fn of(scene: &Scene) -> Self {
        let mut names = Self::default();
        names.shapes = names.list("shape", scene.shapes.iter().map(|s| &s.name));
        names.bsdfs = scene.bsdfs.iter().map(|(_, b)| Some(names.claim(b.name.as_ref()?))).collect();
        names.textures = scene.textures.iter().map(|(_, t)| Some(names.claim(t.name.as_ref()?))).collect();
        names.emitters = names.list("emitter", scene.emitters.iter().map(|e| &e.name));
        names.media = names.list("medium", scene.media.iter().map(|(_, m)| &m.name));
        names.sensors = names.list("sensor", scene.sensors.iter().map(|s| &s.name));
        for (number, (_, group)) in scene.groups.iter().enumerate() {
            let group_name = group.name.clone().unwrap_or_else(|| format!("group_{number}"));
            let stem = format!("{group_name}.shape");
            let shapes = names.list(&stem, group.shapes.iter().map(|s| &s.name));
            names.groups.push(shapes);
        }
        names.follow(scene);
        names
    }

    /// The authors' names, or the word with the number in the list.
    fn list<'a>(&mut self, word: &str, own: impl Iterator<Item = &'a Option<String>>) -> Vec<String> {
        let name = |(i, own): (usize, &Option<String>)| match own {
            Some(name) => self.claim(name),
            None => self.claim(&format!("{word}_{i}")),
        };
        own.enumerate().map(name).collect()
    }

    /// The name, or where it is taken the name with a number.
    fn claim(&mut self, name: &str) -> String {
        let mut free = name.to_owned();
        let mut number = 2;
        while !self.taken.insert(free.clone()) {
            free = format!("{name}_{number}");
            number += 1;
        }
        free
    }

    /// Names what has no id by the first field that refers to it. The one model of `twosided`, which has no values
    /// itself, is called as that is.
    fn follow(&mut self, scene: &Scene) {
        // Fields are shown to be changed: those of a copy.
        let mut copy = scene.clone();
        let mut found = VecDeque::new();
        walk(&mut copy, self, None, &mut |path, field| note(path, field, &mut found));
        while let Some((path, reference, shares)) = found.pop_front() {
            let mut note = |path: &str, field: &mut dyn Any| note(path, field, &mut found);
            if let Some(id) = reference.to::<Bsdf>()
                && self.bsdfs[id.index()].is_none()
            {
                let name = if shares { path } else { self.claim(&path) };
                copy.bsdfs[id].kind.fields(&name, &mut note);
                self.bsdfs[id.index()] = Some(name);
            } else if let Some(id) = reference.to::<Texture>()
                && self.textures[id.index()].is_none()
            {
                let name = self.claim(&path);
                copy.textures[id].kind.fields(&name, &mut note);
                self.textures[id.index()] = Some(name);
            }
        }
    }

    /// A texture was added to the scene for this field.
    pub fn add_texture(&mut self, path: &str) {
        let name = self.claim(path);
        self.textures.push(Some(name));
    }

    /// The name of a texture.
    pub fn texture(&self, id: Id<Texture>) -> &str {
        self.textures[id.index()].as_deref().unwrap_or_default()
    }
}

/// A path, what is referred to there, and whether that may be called by the path although it is taken.
type Found = VecDeque<(String, Reference, bool)>;

fn note(path: &str, field: &mut dyn Any, found: &mut Found) -> bool {
    if let Some(id) = field.downcast_ref::<Id<Bsdf>>() {
        found.push_back((path.to_owned(), (*id).into(), false));
    } else if let Some(id) = field.downcast_ref::<Id<Texture>>() {
        found.push_back((path.to_owned(), (*id).into(), false));
    } else if let Some(BsdfKind::TwoSided { front, back: None }) = field.downcast_ref() {
        found.push_back((path.to_owned(), (*front).into(), true));
        return false;
    }
    true
}

/// Shows the fields of all objects, or of those whose name `key` begins with.
pub fn walk(scene: &mut Scene, names: &Names, key: Option<&str>, visit: &mut VisitField<'_>) {
    let wanted =
        |name: &str| key.is_none_or(|key| key.strip_prefix(name).is_some_and(|r| r.starts_with('.')));
    let sensors = scene.sensors.iter_mut().zip(&names.sensors);
    for (sensor, name) in sensors.filter(|(_, name)| wanted(name)) {
        sensor.to_world.fields(&format!("{name}.to_world"), visit);
    }
    let mut show = |name: &str, part: &mut dyn Part| {
        if wanted(name) {
            part.fields(name, visit);
        }
    };
    scene.emitters.iter_mut().zip(&names.emitters).for_each(|(emitter, name)| show(name, emitter));
    scene.shapes.iter_mut().zip(&names.shapes).for_each(|(shape, name)| show(name, shape));
    let ids: Vec<_> = scene.groups.iter().map(|(id, _)| id).collect();
    for (id, names) in ids.into_iter().zip(&names.groups) {
        scene.groups[id].shapes.iter_mut().zip(names).for_each(|(shape, name)| show(name, shape));
    }
    let ids: Vec<_> = scene.bsdfs.iter().map(|(id, _)| id).collect();
    for (id, name) in ids.into_iter().zip(&names.bsdfs) {
        name.iter().for_each(|name| show(name, &mut scene.bsdfs[id].kind));
    }
    let ids: Vec<_> = scene.textures.iter().map(|(id, _)| id).collect();
    for (id, name) in ids.into_iter().zip(&names.textures) {
        name.iter().for_each(|name| show(name, &mut scene.textures[id].kind));
    }
    let ids: Vec<_> = scene.media.iter().map(|(id, _)| id).collect();
    for (id, name) in ids.into_iter().zip(&names.media) {
        show(name, &mut scene.media[id]);
    }
}
