//! What light paths and camera paths share: the walk from one vertex to the next, the straight way
//! through masks and media, Russian roulette, and the table of path classes.

mod class;
mod glint;
pub mod media;
pub mod roulette;
mod vertex;
mod visibility;
pub mod walk;

pub use class::{Owner, PathClass};
pub use glint::{Chain, Smallness};
pub use vertex::Vertex;
pub use visibility::{passage, shadow_ray, transparency, visibility};
