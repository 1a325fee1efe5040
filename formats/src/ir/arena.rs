//! Typed indices instead of references: the scene stays a plain value.

use std::fmt;
use std::marker::PhantomData;

use serde::{Deserialize, Serialize};

/// Index of a `T` in its [`Arena`]. Only meaningful together with the arena that made it.
#[derive(Serialize, Deserialize)]
#[serde(transparent)]
pub struct Id<T> {
    index: u32,
    #[serde(skip)]
    marker: PhantomData<fn() -> T>,
}

impl<T> Id<T> {
    /// Position of the item in its arena.
    pub fn index(self) -> usize {
        self.index as usize
    }
}

impl<T> Clone for Id<T> {
    fn clone(&self) -> Self {
        *self
    }
}
impl<T> Copy for Id<T> {}
impl<T> PartialEq for Id<T> {
    fn eq(&self, other: &Self) -> bool {
        self.index == other.index
    }
}
impl<T> Eq for Id<T> {}
impl<T> std::hash::Hash for Id<T> {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.index.hash(state);
    }
}
impl<T> fmt::Debug for Id<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{}", self.index)
    }
}

/// The arenas of a scene, by what they hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Store {
    /// [`super::Scene::bsdfs`].
    Bsdfs,
    /// [`super::Scene::textures`].
    Textures,
    /// [`super::Scene::groups`].
    Groups,
    /// [`super::Scene::media`].
    Media,
}

/// What stands in an arena of the scene and can be referred to.
pub trait Stored {
    /// Its arena.
    const STORE: Store;
}

/// An [`Id`] whose type is known only when the program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Reference {
    store: Store,
    index: u32,
}

impl Reference {
    /// The arena it points into.
    pub fn store(self) -> Store {
        self.store
    }

    /// Position in that arena.
    pub fn index(self) -> usize {
        self.index as usize
    }

    /// The id, if it is one of a `T`.
    pub fn to<T: Stored>(self) -> Option<Id<T>> {
        (self.store == T::STORE).then_some(Id { index: self.index, marker: PhantomData })
    }
}

impl<T: Stored> From<Id<T>> for Reference {
    fn from(id: Id<T>) -> Self {
        Self { store: T::STORE, index: id.index }
    }
}

/// Grow-only store of `T` addressed by [`Id<T>`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Arena<T> {
    items: Vec<T>,
}

impl<T> Default for Arena<T> {
    fn default() -> Self {
        Self { items: Vec::new() }
    }
}

impl<T> Arena<T> {
    /// Adds an item and returns its id.
    pub fn push(&mut self, item: T) -> Id<T> {
        let index = u32::try_from(self.items.len()).expect("fewer than 2^32 objects of one kind");
        self.items.push(item);
        Id { index, marker: PhantomData }
    }

    /// Number of items.
    pub fn len(&self) -> usize {
        self.items.len()
    }

    /// True when nothing was pushed.
    pub fn is_empty(&self) -> bool {
        self.items.is_empty()
    }

    /// Items in the order they were pushed.
    pub fn iter(&self) -> impl Iterator<Item = (Id<T>, &T)> {
        self.items.iter().enumerate().map(|(i, item)| (Id { index: i as u32, marker: PhantomData }, item))
    }
}

impl<T> std::ops::Index<Id<T>> for Arena<T> {
    type Output = T;
    fn index(&self, id: Id<T>) -> &T {
        &self.items[id.index()]
    }
}

impl<T> std::ops::IndexMut<Id<T>> for Arena<T> {
    fn index_mut(&mut self, id: Id<T>) -> &mut T {
        &mut self.items[id.index()]
    }
}
