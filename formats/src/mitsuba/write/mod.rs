//! The scene as a Mitsuba 3 file: one module per concept, as for reading.
//!
//! Objects that have a name, or that several others refer to, stand at the top level with an id;
//! the rest is nested where it is used.

mod bsdf;
mod color;
mod element;
mod emitter;
mod film;
mod integrator;
mod interface;
mod joined;
mod lobes;
mod medium;
mod plain;
mod relief;
mod sensor;
mod shape;
mod substitute;
mod sunsky;
mod texture;

use std::collections::{HashMap, HashSet};

use element::{Element, print};
use texture::Said;

use crate::ir::{Id, Origin, Query, Scene, Shape, Texture, Uses};
use crate::write::{Names, Output, WriteError};

/// Version of the written files.
const VERSION: &str = "3.0.0";

pub(crate) fn write(output: &mut Output<'_>) -> Result<String, WriteError> {
    let plain = Writer::new(output, HashSet::new()).document()?;
    let torn = joined::torn(&plain);
    if torn.is_empty() {
        return Ok(print(&plain));
    }
    output.start_over();
    Writer::new(output, torn).document().map(|root| print(&root))
}

struct Writer<'o, 'a> {
    out: &'o mut Output<'a>,
    scene: &'a Scene,
    ids: Ids,
    query: Query,
    /// Textures that were written, by the bits of their factor.
    said: HashMap<(Id<Texture>, [u64; 3]), Said>,
    /// Backs of lamps: a mesh is known by its address, which must not be that of another one later.
    backs: Vec<Shape>,
    /// Factor on all light, in place of the film's imaging ratio.
    light: f64,
    /// Shapes to be reversed instead of having `flip_normals`, by their place among those of the top level.
    reversed: HashSet<usize>,
}

/// Names of the objects of the top level, by arena index.
struct Ids {
    bsdfs: Vec<Option<String>>,
    textures: Vec<Option<String>>,
    groups: Vec<Option<String>>,
    media: Vec<Option<String>>,
    taken: Names,
}

impl Ids {
    fn new(scene: &Scene) -> Self {
        let uses = Uses::of(scene);
        let mut ids = Self {
            bsdfs: Vec::new(),
            textures: Vec::new(),
            groups: Vec::new(),
            media: Vec::new(),
            taken: Names::default(),
        };
        let sensors = scene.sensors.iter().filter_map(|sensor| sensor.name.clone());
        let shapes = scene.shapes.iter().filter_map(|shape| shape.name.clone());
        let emitters = scene.emitters.iter().filter_map(|emitter| emitter.name.clone());
        sensors.chain(shapes).chain(emitters).for_each(|name| _ = ids.taken.take(&name));
        let shared = |name: &Option<String>, uses: usize| name.is_some() || uses > 1;
        for (id, bsdf) in scene.bsdfs.iter() {
            let id = shared(&bsdf.name, uses.count(id)).then(|| ids.free(&bsdf.name, "material"));
            ids.bsdfs.push(id);
        }
        for (id, texture) in scene.textures.iter() {
            let id = shared(&texture.name, uses.count(id)).then(|| ids.free(&texture.name, "texture"));
            ids.textures.push(id);
        }
        for (_, group) in scene.groups.iter() {
            let id = ids.free(&group.name, "group");
            ids.groups.push(Some(id));
        }
        for (id, medium) in scene.media.iter() {
            let id = shared(&medium.name, uses.count(id)).then(|| ids.free(&medium.name, "medium"));
            ids.media.push(id);
        }
        ids
    }

    /// `name`, or one made from it or from `kind` that is not taken. pbrt has a name space for each
    /// kind of thing; Mitsuba has one for all.
    fn free(&mut self, name: &Option<String>, kind: &str) -> String {
        self.taken.free_or_numbered(name.as_deref(), kind)
    }
}

impl<'o, 'a> Writer<'o, 'a> {
    fn new(out: &'o mut Output<'a>, reversed: HashSet<usize>) -> Self {
        let scene = out.scene;
        let film = scene.sensors.get(scene.default_sensor).map(|sensor| sensor.film.imaging_ratio);
        Self {
            out,
            scene,
            ids: Ids::new(scene),
            query: Query::default(),
            said: HashMap::new(),
            backs: Vec::new(),
            light: film.unwrap_or(1.0),
            reversed,
        }
    }

    fn document(mut self) -> Result<Element, WriteError> {
        let scene = self.scene;
        let mut root = Element::new("scene").with("version", VERSION);
        if let Some(title) = self.out.title() {
            root = root.comment(format!("Converted from {title} by caustica {}.", env!("CARGO_PKG_VERSION")));
        }
        let integrator = scene.integrator.as_ref();
        root = match integrator {
            Some(i) => root.children(self.commented(i.origin, |w| Ok(Some(w.integrator(integrator))))?),
            None => root.child(self.integrator(None)),
        };
        for (id, medium) in scene.media.iter() {
            if self.ids.media[id.index()].is_some() {
                let element = self.commented(medium.origin, |w| w.medium_definition(id).map(Some))?;
                root = root.children(element);
            }
        }
        // The first one renders.
        let first = scene.sensors.get(scene.default_sensor).into_iter();
        let others = scene.sensors.iter().enumerate().filter(|(i, _)| *i != scene.default_sensor);
        for sensor in first.chain(others.map(|(_, sensor)| sensor)) {
            root = root.children(self.commented(sensor.origin, |w| w.sensor(sensor).map(Some))?);
        }
        for (id, texture) in scene.textures.iter() {
            if self.ids.textures[id.index()].is_some() {
                let element = self.commented(texture.origin, |w| w.texture_definition(id))?;
                root = root.children(element);
            }
        }
        for (id, bsdf) in scene.bsdfs.iter() {
            if self.ids.bsdfs[id.index()].is_some() {
                let element = self.commented(bsdf.origin, |w| w.bsdf_definition(id).map(Some))?;
                root = root.children(element);
            }
        }
        let mut shapes = 0;
        for (id, group) in scene.groups.iter() {
            let element = self.commented(group.origin, |w| w.group(id))?;
            shapes += usize::from(element.is_some());
            root = root.children(element);
        }
        for shape in &scene.shapes {
            for side in self.sides(shape)? {
                let reversed = self.reversed.contains(&shapes);
                let element = self.commented(shape.origin, |w| w.shape(&side, reversed))?;
                shapes += usize::from(element.is_some());
                root = root.children(element);
            }
        }
        let mut filled = false;
        for emitter in &scene.emitters {
            if emitter.kind.fills_the_sky() && std::mem::replace(&mut filled, true) {
                self.out.lose(emitter.origin, "a second environment light", "nothing: Mitsuba has one");
                continue;
            }
            let around = emitter.medium.filter(|_| !emitter.kind.is_far());
            let element = self.commented(emitter.origin, |w| {
                let Some(element) = w.emitter(emitter)? else { return Ok(None) };
                Ok(Some(element.children(around.map(|id| w.medium(None, id)).transpose()?)))
            })?;
            root = root.children(element);
        }
        Ok(root)
    }

    /// The element from `make`, with comments about its source and losses.
    fn commented(
        &mut self,
        origin: Origin,
        make: impl FnOnce(&mut Self) -> Result<Option<Element>, WriteError>,
    ) -> Result<Option<Element>, WriteError> {
        let before = self.out.losses().len();
        let Some(mut element) = make(self)? else { return Ok(None) };
        if let Some(place) = self.out.place(origin) {
            element = element.comment(place);
        }
        for loss in &self.out.losses()[before..] {
            element = element.comment(format!("lost: {}; instead: {}", loss.what, loss.instead));
        }
        Ok(Some(element))
    }
}
