//! pbrt's named spectra, reduced to what an RGB renderer can use of them.

use super::conductor;

/// What a name of pbrt's library stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LibrarySpectrum {
    /// η or k of a metal, linear Rec.709 integrated without illuminant.
    Coefficient([f64; 3]),
    /// Index of a glass at the d line, 587.56 nm.
    Index(f64),
    /// CIE xy of an illuminant (CIE 15:2004, 2° observer).
    Illuminant([f64; 2]),
}

/// The d-line indices of the manufacturers' catalogues. pbrt's F5, F10 and F11 hold the data of the
/// SF glasses.
const GLASSES: [(&str, f64); 7] = [
    ("BK7", 1.516_80),
    ("BAF10", 1.670_03),
    ("FK51A", 1.486_56),
    ("LASF9", 1.850_25),
    ("F5", 1.672_70),
    ("F10", 1.728_25),
    ("F11", 1.784_72),
];

const ILLUMINANTS: [(&str, [f64; 2]); 16] = [
    ("stdillum-A", [0.447_58, 0.407_45]),
    ("stdillum-D50", [0.345_67, 0.358_50]),
    ("stdillum-D65", [0.312_72, 0.329_03]),
    ("stdillum-F1", [0.313_10, 0.337_27]),
    ("stdillum-F2", [0.372_08, 0.375_29]),
    ("stdillum-F3", [0.409_10, 0.394_30]),
    ("stdillum-F4", [0.440_18, 0.403_29]),
    ("stdillum-F5", [0.313_79, 0.345_31]),
    ("stdillum-F6", [0.377_90, 0.388_35]),
    ("stdillum-F7", [0.312_92, 0.329_33]),
    ("stdillum-F8", [0.345_88, 0.358_75]),
    ("stdillum-F9", [0.374_17, 0.372_81]),
    ("stdillum-F10", [0.346_09, 0.359_86]),
    ("stdillum-F11", [0.380_52, 0.377_13]),
    ("stdillum-F12", [0.436_95, 0.404_41]),
    ("illum-acesD60", [0.321_68, 0.337_67]),
];

/// Metals under pbrt's names and ours.
const METALS: [(&str, &str); 6] =
    [("Ag", "Ag"), ("Al", "Al"), ("Au", "Au"), ("Cu", "Cu"), ("MgO", "MgO"), ("TiO2", "TiO2")];

/// Brass at 650, 550 and 450 nm (Querry 1985): η, k.
const BRASS: [[f64; 3]; 2] = [[0.444, 0.527, 1.094], [3.695, 2.765, 1.829]];

/// The spectrum called `name`; pbrt's names tell upper from lower case.
pub fn library_spectrum(name: &str) -> Option<LibrarySpectrum> {
    if let Some(glass) = name.strip_prefix("glass-") {
        return GLASSES.iter().find(|row| row.0 == glass).map(|row| LibrarySpectrum::Index(row.1));
    }
    if let Some(metal) = name.strip_prefix("metal-") {
        let (metal, part) = metal.rsplit_once('-')?;
        let [eta, k] = match metal {
            "CuZn" => BRASS,
            _ => {
                let found = conductor(METALS.iter().find(|row| row.0 == metal)?.1)?;
                [found.eta, found.k]
            }
        };
        return match part {
            "eta" => Some(LibrarySpectrum::Coefficient(eta)),
            "k" => Some(LibrarySpectrum::Coefficient(k)),
            _ => None,
        };
    }
    ILLUMINANTS.iter().find(|row| row.0 == name).map(|row| LibrarySpectrum::Illuminant(row.1))
}

/// Every name [`library_spectrum`] knows.
pub fn library_names() -> impl Iterator<Item = String> {
    let metals = METALS.iter().map(|row| row.0).chain(["CuZn"]);
    let metals = metals.flat_map(|metal| ["eta", "k"].map(|part| format!("metal-{metal}-{part}")));
    let glasses = GLASSES.iter().map(|row| format!("glass-{}", row.0));
    metals.chain(glasses).chain(ILLUMINANTS.iter().map(|row| row.0.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_listed_name_resolves() {
        let names: Vec<_> = library_names().collect();
        assert_eq!(names.len(), 14 + 7 + 16);
        for name in &names {
            assert!(library_spectrum(name).is_some(), "{name}");
        }
        assert_eq!(library_spectrum("metal-cu-eta"), None);
        assert_eq!(library_spectrum("metal-Cu"), None);
        let gold = conductor("Au").expect("in the table");
        assert_eq!(library_spectrum("metal-Au-k"), Some(LibrarySpectrum::Coefficient(gold.k)));
    }
}
