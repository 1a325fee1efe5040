//! Versions of the language and the dialects they belong to.

use super::tree::Element;
use crate::ir::{HideEmitters, SpectrumRule};

/// `version` of a scene's root element.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Version(pub u32, pub u32, pub u32);

/// The groups of versions between which the meaning of a scene differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Dialect {
    /// Up to 0.6: camelCase.
    Old,
    /// 2.x.
    Two,
    /// 3.x and later.
    Three,
}

impl Version {
    /// `a.b.c` where the later numbers may be missing and a suffix (`0.6.0a`) is ignored.
    pub fn parse(text: &str) -> Option<Self> {
        let mut numbers = [0; 3];
        let mut parts = text.trim().split('.');
        for (i, number) in numbers.iter_mut().enumerate() {
            let Some(part) = parts.next() else { break };
            let digits = part.len() - part.trim_start_matches(|c: char| c.is_ascii_digit()).len();
            let suffix_allowed = i > 0;
            if digits == 0 || (digits < part.len() && !suffix_allowed) {
                return None;
            }
            *number = part[..digits].parse().ok()?;
        }
        parts.next().is_none().then_some(Self(numbers[0], numbers[1], numbers[2]))
    }

    /// The version to assume for a tree without one.
    pub fn guess(root: &Element) -> Self {
        if has_old_names(root) { Self(0, 5, 0) } else { Self(3, 0, 0) }
    }

    pub fn dialect(self) -> Dialect {
        match self.0 {
            0 | 1 => Dialect::Old,
            2 => Dialect::Two,
            _ => Dialect::Three,
        }
    }
}

impl Dialect {
    pub fn spectrum_rule(self) -> SpectrumRule {
        match self {
            Self::Old => SpectrumRule::Mitsuba06,
            Self::Two => SpectrumRule::Mitsuba2,
            Self::Three => SpectrumRule::Mitsuba3,
        }
    }

    /// A 3.x file is read as the latest 3.x reads it, whatever its minor version.
    pub fn hide_emitters(self) -> HideEmitters {
        match self {
            Self::Old | Self::Two => HideEmitters::Emission,
            Self::Three => HideEmitters::Surface,
        }
    }
}

fn has_old_names(element: &Element) -> bool {
    let camel = |name: &str| name.len() > 1 && name.contains(|c: char| c.is_ascii_uppercase());
    matches!(element.tag.as_str(), "lookAt" | "camera" | "luminaire")
        || element.tag != "default" && element.value("name").is_some_and(camel)
        || element.children.iter().any(has_old_names)
}
