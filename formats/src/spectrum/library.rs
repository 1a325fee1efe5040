//! pbrt's named spectra, reduced to what an RGB renderer can use of them.

/// What a name of pbrt's library stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LibrarySpectrum {
    /// η or k of a metal, by channel of linear Rec. 709.
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

/// η and k of pbrt's metals. They are fitted, channel by channel and over all angles, to the colour under D65 of the
/// reflectance that pbrt computes wavelength by wavelength; the means of η and k themselves miss it by up to 5 % (copper in
/// blue). What is left is below 0.6 %, but 2 % in the red of gold, which is more than 1 in Rec. 709.
const METALS: [(&str, [f64; 3], [f64; 3]); 7] = [
    ("Ag", [0.129_321, 0.125_351, 0.151_320], [4.110_326, 3.351_636, 2.412_805]),
    ("Al", [1.427_481, 0.929_469, 0.591_537], [7.736_090, 6.605_752, 5.364_732]),
    ("Au", [0.157_503, 0.406_203, 1.572_876], [100.0, 2.346_538, 1.719_932]),
    ("Cu", [0.168_669, 0.976_512, 1.211_377], [3.644_191, 2.621_103, 2.366_346]),
    ("CuZn", [0.467_915, 0.523_520, 1.126_415], [4.274_902, 2.668_051, 1.811_441]),
    ("MgO", [1.733_702, 1.740_932, 1.753_536], [0.003_741, 0.003_503, 0.003_474]),
    ("TiO2", [2.860_273, 2.956_911, 3.185_648], [0.016_588, 0.000_001, 0.013_528]),
];

/// The spectrum called `name`; pbrt's names tell upper from lower case.
pub fn library_spectrum(name: &str) -> Option<LibrarySpectrum> {
    if let Some(glass) = name.strip_prefix("glass-") {
        return GLASSES.iter().find(|row| row.0 == glass).map(|row| LibrarySpectrum::Index(row.1));
    }
    if let Some(metal) = name.strip_prefix("metal-") {
        let (metal, part) = metal.rsplit_once('-')?;
        let &(_, eta, k) = METALS.iter().find(|row| row.0 == metal)?;
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
    let metals = METALS
        .iter()
        .map(|row| row.0)
        .flat_map(|metal| ["eta", "k"].map(|part| format!("metal-{metal}-{part}")));
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
    }

    /// The colour of what pbrt's metals reflect, wavelength by wavelength, at normal incidence and at 60°, from its tables.
    #[test]
    fn metals_have_the_colour_of_their_spectra() {
        let reflectance = |cos: f64, eta: f64, k: f64| {
            let (c2, s2) = (cos * cos, 1.0 - cos * cos);
            let t = eta * eta - k * k - s2;
            let ab = (t * t + 4.0 * eta * eta * k * k).sqrt();
            let a = (2.0 * (ab + t)).sqrt() * cos;
            let s = (ab + c2 - a) / (ab + c2 + a);
            let b = a * s2;
            let p = s * (c2 * ab + s2 * s2 - b) / (c2 * ab + s2 * s2 + b);
            0.5 * (s + p)
        };
        let colours = [
            ("Ag", [0.9715, 0.9599, 0.9153], [0.9676, 0.9559, 0.9150]),
            ("Al", [0.9132, 0.9215, 0.9245], [0.8969, 0.9074, 0.9122]),
            ("Au", [1.0219, 0.7825, 0.3434], [1.0066, 0.7874, 0.3802]),
            ("Cu", [0.9553, 0.6376, 0.5382], [0.9467, 0.6380, 0.5485]),
            ("CuZn", [0.9096, 0.7783, 0.4228], [0.8948, 0.7749, 0.4633]),
            ("MgO", [0.0720, 0.0731, 0.0749], [0.1252, 0.1263, 0.1281]),
            ("TiO2", [0.2322, 0.2446, 0.2727], [0.2581, 0.2676, 0.2893]),
        ];
        for ((metal, normal, oblique), (name, eta, k)) in colours.into_iter().zip(METALS) {
            assert_eq!(metal, name);
            for (cos, colour) in [(1.0, normal), (0.5, oblique)] {
                for c in 0..3 {
                    // The bound is that of the fit; nothing reflects more than 1.
                    let error = reflectance(cos, eta[c], k[c]) / f64::min(colour[c], 1.0) - 1.0;
                    assert!(error.abs() < 0.006, "{metal} at {cos}, channel {c}: {error}");
                }
            }
        }
    }
}
