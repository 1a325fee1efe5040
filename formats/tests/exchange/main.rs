//! What is read of scenes, what is said of bad ones, and what survives being written.
#![allow(clippy::unwrap_used)]

mod joined;
mod layers;
mod linear;
mod media;
mod random;
mod random_media;
mod round_trip;
mod shared;
mod snapshots;
