//! Named conductors: η and k as linear Rec.709 triples.
//!
//! The values are those Mitsuba 3.9.1 derives in its RGB modes from the published spectra
//! (integrated without illuminant, negative results clamped to zero); 0.6 integrates the same
//! data. Names are file names there and therefore case-sensitive.

/// Complex index of refraction of a conductor, η − ik, against vacuum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metal {
    /// Real part of the index.
    pub eta: [f64; 3],
    /// Imaginary part of the index.
    pub k: [f64; 3],
}

/// The conductor called `name`. `none` is a perfect mirror; `X_palik` is accepted as a second name
/// where the data of `X` are Palik's.
pub fn conductor(name: &str) -> Option<Metal> {
    if name == "none" {
        return Some(Metal { eta: [0.0; 3], k: [1.0; 3] });
    }
    let base = match name.strip_suffix("_palik") {
        Some(base) if PALIK_ALIASES.contains(&base) => base,
        _ => name,
    };
    METALS
        .iter()
        .find(|metal| metal.0 == base)
        .map(|&(_, eta, k)| Metal { eta: eta.map(f64::from), k: k.map(f64::from) })
}

/// Every name [`conductor`] knows, aliases last.
pub fn conductor_names() -> impl Iterator<Item = String> {
    let own = METALS.iter().map(|metal| metal.0.to_owned());
    let aliases = PALIK_ALIASES.iter().map(|base| format!("{base}_palik"));
    std::iter::once("none".to_owned()).chain(own).chain(aliases)
}

/// Metals whose `_palik` name means the same data.
#[rustfmt::skip]
const PALIK_ALIASES: [&str; 30] = [
    "AlAs", "AlSb", "Be", "CsI", "Cu2O", "CuO", "HgTe", "Hg", "Ir", "K",
    "Li", "MgO", "Mo", "Nb", "Rh", "Se-e", "Se", "SiC", "SnTe", "Ta",
    "Te-e", "Te", "ThF4", "TiC", "TiN", "TiO2-e", "TiO2", "VC", "VN", "d-C",
];

#[rustfmt::skip]
const METALS: [(&str, [f32; 3], [f32; 3]); 41] = [
    ("Ag", [0.1552762, 0.116727956, 0.13838764], [4.8283544, 3.1222224, 2.1469011]),
    ("Al", [1.6575009, 0.8804047, 0.52124447], [9.223811, 6.269502, 4.837004]),
    ("AlAs", [3.605296, 3.2329378, 2.2163186], [0.0006794373, 0.0, 0.007512709]),
    ("AlSb", [0.0, 4.1393747, 4.6692543], [0.0, 0.09400908, 1.30057]),
    ("Au", [0.14303598, 0.37530708, 1.4420453], [3.982997, 2.3855565, 1.6033592]),
    ("Be", [4.1850123, 3.1850293, 2.7840612], [3.835466, 3.0101223, 2.868994]),
    ("Cr", [4.3696675, 2.9165053, 1.6549046], [5.206547, 4.231306, 3.7546988]),
    ("CsI", [2.1448996, 1.7023189, 1.6624272], [0.0, 0.0, 0.0]),
    ("Cu", [0.20100547, 0.9237495, 1.1022154], [3.9132621, 2.4530451, 2.1420898]),
    ("Cu2O", [3.5517726, 2.9498696, 2.7518754], [0.11420702, 0.19389686, 0.6061339]),
    ("CuO", [3.247541, 2.4478052, 2.2102196], [0.52108955, 0.57003075, 0.72217894]),
    ("Cu_palik", [0.21322851, 0.9197154, 1.1024108], [3.9218733, 2.4573317, 2.136584]),
    ("Hg", [2.3989387, 1.440028, 0.9095704], [6.327587, 4.371925, 3.4217637]),
    ("HgTe", [4.77904, 3.2311962, 2.6599011], [1.6316127, 1.5808104, 1.7292874]),
    ("Ir", [3.0863, 2.0821905, 1.6179146], [5.592153, 4.067088, 3.267312]),
    ("K", [0.06404319, 0.046409767, 0.038184915], [2.1041996, 1.34894, 0.9131259]),
    ("Li", [0.26579094, 0.19561832, 0.22094862], [3.540155, 2.3111234, 1.6686072]),
    ("MgO", [2.0895839, 1.6507235, 1.594879], [4.3326952e-12, 0.0, 2.4986457e-11]),
    ("Mo", [4.483974, 3.5251307, 2.7763104], [4.1114373, 3.420827, 3.1506073]),
    ("Na_palik", [0.060269356, 0.056140948, 0.061988432], [3.1792734, 2.1124904, 1.5790411]),
    ("Nb", [3.420074, 2.7900932, 2.3956294], [3.4413946, 2.7376661, 2.5797458]),
    ("Ni_palik", [2.3673046, 1.6633731, 1.4670781], [4.4988117, 3.050153, 2.3454392]),
    ("Rh", [2.5857935, 1.8602164, 1.5542634], [6.7822604, 4.702987, 3.976073]),
    ("Se", [4.0583115, 2.842935, 2.8208535], [0.75404954, 0.6384435, 0.52180755]),
    ("Se-e", [5.722849, 4.165736, 4.0813384], [0.8711363, 1.1051575, 1.5653203]),
    ("SiC", [3.1723416, 2.5259717, 2.4793706], [7.5376636e-07, 0.0, 0.000010192531]),
    ("SnTe", [4.5242496, 1.981645, 1.2815913], [0.0, 0.0, 0.0]),
    ("Ta", [2.062721, 2.3929389, 2.6279287], [2.4083598, 1.7414864, 1.9470278]),
    ("Te", [7.3902335, 4.482105, 2.637106], [3.2560222, 3.5270588, 3.2920542]),
    ("Te-e", [7.508907, 4.2964287, 2.3699877], [5.5839286, 4.947205, 3.9975922]),
    ("ThF4", [1.8307136, 1.4422286, 1.3876476], [0.0, 0.0, 0.0]),
    ("TiC", [3.7005284, 2.8374221, 2.582287], [3.265635, 2.3515892, 2.1727905]),
    ("TiN", [1.6484497, 1.150516, 1.3798234], [3.368328, 1.9434981, 1.1020677]),
    ("TiO2", [3.45661, 2.8017359, 2.905175], [0.00010526484, 0.0, 0.0006528865]),
    ("TiO2-e", [3.1065645, 2.5131683, 2.5824444], [0.000029751605, 0.0, 0.00018269809]),
    ("VC", [3.657566, 2.752736, 2.532672], [3.0683007, 2.1986873, 1.9631927]),
    ("VN", [2.8656023, 2.119189, 1.9400911], [3.0322425, 2.0561156, 1.6163063]),
    ("V_palik", [4.277582, 3.5129488, 2.7610714], [3.4913008, 2.8894548, 3.111522]),
    ("W", [4.3708167, 3.3002465, 2.9984074], [3.5006406, 2.604874, 2.2732332]),
    ("a-C", [2.9440458, 2.2271364, 1.9681617], [0.8874649, 0.7992985, 0.81529]),
    ("d-C", [2.7087197, 2.3188257, 2.2288976], [0.0, 0.0, 0.0]),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gold_and_mirror() {
        let gold = conductor("Au").expect("in the table");
        assert_eq!(gold.eta[0], f64::from(0.143_035_98_f32));
        assert_eq!(gold.k[2], f64::from(1.603_359_2_f32));
        assert_eq!(conductor("none"), Some(Metal { eta: [0.0; 3], k: [1.0; 3] }));
        assert_eq!(conductor("au"), None, "names are case-sensitive");
    }

    #[test]
    fn palik_names() {
        assert_eq!(conductor("Hg_palik"), conductor("Hg"));
        assert!(conductor("Cu_palik").is_some());
        assert_ne!(conductor("Cu_palik"), conductor("Cu"));
        assert_eq!(conductor("Au_palik"), None);
        assert_eq!(conductor("none_palik"), None);
    }

    #[test]
    fn every_listed_name_resolves() {
        let names: Vec<_> = conductor_names().collect();
        assert_eq!(names.len(), 72);
        assert!(names.iter().all(|name| conductor(name).is_some()));
    }
}
