//! The renderer through its public interface: physics, reproducibility, messages, and the layout rules.
//!
//! Every tolerance is given with its reason: noise is measured (see `support`), bias is bounded.
// Measured values are printed; `--nocapture` shows them.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

mod support;

mod aims;
mod aovs;
mod as_pbrt;
mod bench;
mod bsdf;
mod camera;
mod checks;
mod clearance;
mod cli;
mod convergence;
mod conversion;
mod convert;
mod depth;
mod determinism;
mod documents;
mod effort;
mod environment;
mod estimators;
mod faults;
mod few_lamps;
mod flux;
mod focused;
mod furnace;
mod glints;
mod hard;
mod hostile;
mod images;
mod imports;
mod inspect;
mod installing;
mod laws;
mod layers;
mod light_tracing;
mod lights;
mod map;
mod media;
mod merging;
mod nee;
mod noise;
mod normals;
mod readme;
mod roulette;
mod settings;
mod sharing;
mod submit;
mod tidy;
mod transmission;
mod twins;
mod verdict;
mod volume;
mod watertight;
