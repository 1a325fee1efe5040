//! The integrator a scene asks for, with its settings by name.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Origin;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Integrator {
    pub origin: Origin,
    /// The plugin as written (`path`, `photonmapper`, `sppm`, …); a wrapping `moment` or `aov` is removed.
    pub plugin: String,
    /// snake_case parameter name → value. The reader has checked names and types against the plugin's row.
    pub settings: BTreeMap<String, Setting>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    pub origin: Origin,
    pub value: Scalar,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Scalar {
    Boolean(bool),
    Integer(i64),
    Float(f64),
    String(String),
}
