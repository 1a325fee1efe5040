//! Random valid files of every mesh and picture format read to what they say, byte for byte made here
//! from the formats' descriptions. (The scene languages have theirs in `exchange`.)
#![allow(clippy::unwrap_used)]

mod meshes;
mod pictures;
mod volumes;
