//! Participating media: recognised, but not rendered.

use super::directive::{Directive, Param};
use super::policy::Fault;
use super::reader::{Reader, text};
use crate::diagnostic::Diagnostic;
use crate::plugin::{Plugin, read};

type Names = &'static [&'static str];

/// The parameters each type has.
const MEDIA: &[Plugin<Names>] = &[
    read("homogeneous", &["preset", "sigma_a", "sigma_s", "Le", "Lescale", "scale", "g"]),
    read(
        "uniformgrid",
        &[
            "density",
            "temperature",
            "nx",
            "ny",
            "nz",
            "Le",
            "Lescale",
            "p0",
            "p1",
            "g",
            "sigma_a",
            "sigma_s",
            "scale",
            "temperatureoffset",
            "temperaturecutoff",
            "temperaturescale",
        ],
    ),
    read("rgbgrid", &["sigma_a", "sigma_s", "Le", "nx", "ny", "nz", "p0", "p1", "Lescale", "g", "scale"]),
    read("cloud", &["density", "g", "wispiness", "frequency", "sigma_a", "sigma_s", "p0", "p1"]),
    read(
        "nanovdb",
        &[
            "filename",
            "gridname",
            "temperaturename",
            "Lescale",
            "temperatureoffset",
            "temperaturecutoff",
            "temperaturescale",
            "g",
            "sigma_a",
            "sigma_s",
            "scale",
        ],
    ),
];

impl Reader<'_> {
    pub fn medium(&mut self, d: &Directive, params: Vec<Param>) {
        let (name, span) = (text(d, 0).to_owned(), d.arguments[0].span);
        let Some(mut p) = self.named_entity("medium", d, params) else { return };
        if let Some(names) = self.plugin(MEDIA, &mut p, "it is skipped") {
            p.ignore(names);
        }
        self.done(p);
        let earlier = self.media.insert(name.clone(), span);
        self.redefined("medium", &name, span, earlier);
    }

    /// Notes the names; `""` is vacuum.
    pub fn medium_interface(&mut self, d: &Directive) {
        for index in 0..d.arguments.len() {
            let (name, span) = (text(d, index), d.arguments[index].span);
            if !name.is_empty() && self.used_media.iter().all(|(known, _)| known != name) {
                self.used_media.push((name.to_owned(), span));
            }
        }
    }

    /// Everything is in vacuum.
    pub fn check_media(&mut self) {
        for (name, span) in std::mem::take(&mut self.used_media) {
            if self.media.contains_key(&name) {
                self.unsupported(&format!("participating medium `{name}`"), "vacuum is used", span);
            } else if !self.incomplete {
                let problem = Diagnostic::error(format!("no medium named `{name}`"), Some(span));
                let problem = problem.suggest_or(&name, self.media.keys().map(String::as_str), || {
                    "MakeNamedMedium defines one".to_owned()
                });
                self.problems.push(self.policy.judge(Fault::Mistake, problem, "vacuum is used"));
            }
        }
    }
}
