//! Phase functions.

use super::number;
use super::object::{Class, ObjectIndex};
use super::props::Props;
use super::reader::Reader;
use crate::diagnostic::Diagnostic;
use crate::ir::{Phase, Volume};
use crate::plugin::{Plugin, read};

type ReadPhase = for<'a> fn(&mut Reader<'a>, &mut Props<'a>) -> Option<Phase>;

pub(super) const PHASES: &[Plugin<ReadPhase>] = &[
    read("isotropic", |_, _| Some(Phase::Isotropic)),
    read("hg", henyey_greenstein),
    read("rayleigh", |_, _| Some(Phase::Rayleigh)),
    read("kkay", kajiya_kay),
    read("mixturephase", mixture),
    read("blendphase", blend),
    read("tabphase", tabulated),
    read("sggx", sggx),
    read("microflake", microflake),
];

/// A phase function is a value: what several mixtures share stands in each of them. More parts than these come from
/// sharing over many levels only.
const MOST_PARTS: u32 = 1000;

impl<'a> Reader<'a> {
    /// The phase function at `index`; `None` after reporting why there is none.
    pub fn phase(&mut self, index: ObjectIndex) -> Option<Phase> {
        self.phase_parts = 0;
        self.nested_phase(index)
    }

    fn nested_phase(&mut self, index: ObjectIndex) -> Option<Phase> {
        self.phase_parts += 1;
        if self.phase_parts > MOST_PARTS {
            if self.phase_parts == MOST_PARTS + 1 {
                let text = format!("a phase function has more than {MOST_PARTS} parts");
                self.problems.push(Diagnostic::error(text, Some(self.objects[index].span)));
            }
            return None;
        }
        let reader = self.plugin(PHASES, index, "isotropic is used")?;
        let mut props = self.props(index);
        let phase = reader(self, &mut props);
        self.finish(props);
        phase
    }
}

fn henyey_greenstein<'a>(_: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Phase> {
    let g = props.float("g", 0.8);
    if !(-1.0 < g && g < 1.0) {
        props.complain("g", format!("`g` must lie between -1 and 1, not {g}"));
    }
    Some(Phase::HenyeyGreenstein { g })
}

fn kajiya_kay<'a>(_: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Phase> {
    let [ks, kd, exponent] =
        [("ks", 0.4), ("kd", 0.2), ("exponent", 4.0)].map(|(name, default)| props.float(name, default));
    for (name, value) in [("ks", ks), ("kd", kd), ("exponent", exponent)] {
        if value < 0.0 {
            props.complain(name, format!("`{name}` must not be negative, but is {value}"));
        }
    }
    if ks + kd > 1.0 {
        let text = "`ks` and `kd` sum to more than 1: more light may leave than comes";
        props.problems.push(Diagnostic::warning(text, Some(props.object.span)));
    }
    Some(Phase::KajiyaKay { ks, kd, exponent })
}

fn mixture<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Phase> {
    let Some((text, span)) = props.optional_string("weights") else {
        props.needs("the parameter `weights`");
        return None;
    };
    let mut nested = Vec::new();
    let mut complete = true;
    while let Some(child) = props.child(Class::Phase) {
        let phase = reader.nested_phase(child.index);
        complete &= phase.is_some();
        nested.push(phase.unwrap_or(Phase::Isotropic));
    }
    let words = text.split(|c: char| matches!(c, ',' | ';') || c.is_whitespace()).filter(|w| !w.is_empty());
    let weights: Option<Vec<f64>> = words.map(|w| number::float(w).filter(|w| *w >= 0.0)).collect();
    let Some(weights) = weights.filter(|w| w.len() == nested.len() && w.iter().sum::<f64>() > 0.0) else {
        let text =
            format!("`weights` must be {} numbers from 0, one for each nested phase function", nested.len());
        props.problems.push(Diagnostic::error(text, Some(span)));
        return None;
    };
    let sum: f64 = weights.iter().sum();
    let scale = if sum > 1.0 {
        let text = "the weights sum to more than 1: they are scaled down";
        props.problems.push(Diagnostic::warning(text, Some(span)));
        sum
    } else {
        1.0
    };
    complete.then(|| Phase::Mixture(weights.into_iter().map(|w| w / scale).zip(nested).collect()))
}

fn blend<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Phase> {
    if !props.has("weight") {
        props.needs("the parameter `weight`");
    }
    let weight = reader.volume_or(props, "weight", 0.5);
    let (Some(first), Some(second)) = (props.child(Class::Phase), props.child(Class::Phase)) else {
        props.needs("two nested phase functions");
        return None;
    };
    let parts = [reader.nested_phase(first.index)?, reader.nested_phase(second.index)?];
    Some(Phase::Blend { weight, parts: Box::new(parts) })
}

fn tabulated<'a>(_: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Phase> {
    let Some((text, _)) = props.optional_string("values") else {
        props.needs("the parameter `values`");
        return None;
    };
    let sound = |values: &Vec<f64>| {
        values.len() >= 2 && values.iter().all(|v| *v >= 0.0) && values.iter().any(|v| *v > 0.0)
    };
    let Some(values) = number::floats(text).filter(sound) else {
        props.complain("values", "`values` must be two or more numbers from 0, not all of them 0");
        return None;
    };
    Some(Phase::Tabulated { values })
}

fn sggx<'a>(reader: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Phase> {
    let name = if props.has("S") { "S" } else { "s" };
    if !props.has(name) {
        props.needs("a volume `S`");
        return None;
    }
    match reader.volume(props, name)? {
        matrix @ Volume::Grid(_) => Some(Phase::Sggx { matrix }),
        _ => {
            props.complain(name, "`S` must be a gridvolume with six channels");
            None
        }
    }
}

fn microflake<'a>(_: &mut Reader<'a>, props: &mut Props<'a>) -> Option<Phase> {
    if !props.has("stddev") {
        props.needs("the parameter `stddev`");
        return None;
    }
    Some(Phase::Microflake { stddev: props.positive("stddev", 1.0) })
}
