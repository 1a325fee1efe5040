//! The integrator a scene asks for, with its settings by name.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Aov, Origin};

/// The integrator of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Integrator {
    /// Where it was written.
    pub origin: Origin,
    /// The plugin as written (`path`, `photonmapper`, `sppm`, …); a wrapping `moment` or `aov` is removed, see `aovs`.
    pub plugin: String,
    /// snake_case parameter name → value. The reader has checked names and types against the plugin's row.
    pub settings: BTreeMap<String, Setting>,
    /// Layers that the scene asks for beside the picture, in order; no two have one name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub aovs: Vec<Aov>,
}

/// A value of a setting.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// Where it was written.
    pub origin: Origin,
    /// What it is set to.
    pub value: Scalar,
}

/// A value of one of the types that settings have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Scalar {
    /// `true` or `false`.
    Boolean(bool),
    /// A whole number.
    Integer(i64),
    /// Any finite number.
    Float(f64),
    /// A word or path.
    String(String),
}

/// What a setting may hold. A float setting takes an integer as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ScalarType {
    /// `true` or `false`.
    Boolean,
    /// A whole number.
    Integer,
    /// Any finite number.
    Float,
    /// A word or path.
    String,
}

/// Settings of ours that `path`, `photonmapper`, `ppm` and `sppm` accept beside their own: all that the
/// renderer knows. Each may also be written as a string, in the words of the command line.
pub const INTEGRATOR_SETTINGS: &[(&str, ScalarType)] = &[
    ("integrator", ScalarType::String),
    ("mode", ScalarType::String),
    ("nee", ScalarType::Boolean),
    ("indirect", ScalarType::String),
    ("gather_rays", ScalarType::Integer),
    ("gather_radius", ScalarType::Float),
    ("kernel", ScalarType::String),
    ("caustic_kernel", ScalarType::String),
    ("roulette", ScalarType::String),
    ("lookup", ScalarType::String),
    ("photons", ScalarType::Integer),
    ("caustic_photons", ScalarType::Integer),
    ("volume_photons", ScalarType::Integer),
    ("volume_neighbours", ScalarType::Integer),
    ("volume_radius", ScalarType::Float),
    ("volume_alpha", ScalarType::Float),
    ("beams", ScalarType::String),
    ("neighbours", ScalarType::Integer),
    ("caustic_neighbours", ScalarType::Integer),
    ("caustic_cap", ScalarType::Integer),
    ("passes", ScalarType::Integer),
    ("camera_samples", ScalarType::Integer),
    ("radius", ScalarType::Float),
    ("caustic_radius", ScalarType::Float),
    ("alpha", ScalarType::Float),
    ("caustic_alpha", ScalarType::Float),
    ("caustic_map", ScalarType::Boolean),
    ("glossy", ScalarType::Float),
    ("boundary", ScalarType::Boolean),
    ("max_depth", ScalarType::Integer),
    ("rr_depth", ScalarType::Integer),
    ("hide_emitters", ScalarType::Boolean),
    ("samples", ScalarType::Integer),
    ("seed", ScalarType::Integer),
];
