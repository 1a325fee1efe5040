//! Named indices of refraction, the list that Mitsuba 0.6 and 3 share.

const INDICES: [(&str, f64); 23] = [
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.3330),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.520_45),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.470),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.5750),
    ("diamond", 2.419),
];

/// Index of refraction of a named medium, whatever the case of the letters.
pub fn ior(name: &str) -> Option<f64> {
    INDICES.iter().find(|entry| entry.0.eq_ignore_ascii_case(name)).map(|entry| entry.1)
}

/// Every name [`ior`] knows, for messages.
pub fn ior_names() -> impl Iterator<Item = &'static str> {
    INDICES.iter().map(|entry| entry.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_ignore_case() {
        assert_eq!(ior("BK7"), Some(1.5046));
        assert_eq!(ior("Acrylic Glass"), Some(1.49));
        assert_eq!(ior("glass"), None);
        assert_eq!(ior_names().count(), 23);
    }
}
