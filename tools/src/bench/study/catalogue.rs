//! What is studied: one function per study, with its scene, variants and texts.

/// Settings to measure, and their place in plots.
#[derive(Clone, Debug)]
pub struct Variant {
    pub label: String,
    /// Place along the x axis.
    pub x: f64,
    /// The curve it belongs to.
    pub group: String,
    pub settings: Vec<(String, String)>,
    pub passes: u32,
    pub seeds: u64,
}

/// A study that has not been made yet.
#[derive(Clone, Debug)]
pub struct Study {
    pub name: &'static str,
    pub title: &'static str,
    /// What the document says, in short.
    pub observation: &'static str,
    pub setup: String,
    /// Name of the file in scenes/, without extension.
    pub scene: &'static str,
    pub x: &'static str,
    pub log_x: bool,
    /// Settings of the reference besides those of all studies.
    pub truth: &'static str,
    pub variants: Vec<Variant>,
}

/// The studies in the order of the page.
pub const NAMES: [&str; 7] = ["photons", "neighbours", "kernels", "roulette", "direct", "nee", "caustic-map"];

/// Size of a study: how much is rendered.
#[derive(Clone, Copy, Debug)]
pub struct Profile {
    pub side: usize,
    pub seeds: u64,
    /// Photons of studies that do not vary them.
    pub photons: u64,
    pub most_photons: u64,
    pub reference_passes: u32,
}

impl Profile {
    pub const FULL: Self =
        Self { side: 160, seeds: 3, photons: 500_000, most_photons: 10_000_000, reference_passes: 1000 };
    pub const QUICK: Self =
        Self { side: 96, seeds: 2, photons: 100_000, most_photons: 1_000_000, reference_passes: 250 };
}

const OWNER: &str = "cornell-owner";
const DIFFUSE: &str = "cornell-diffuse";

/// The document's algorithm: one map of all photons, direct light included, the nearest 100 within 0.05.
const CLASSIC: &str = "mode=classic lookup=nearest neighbours=100 caustic_neighbours=100 radius=0.05 \
                       caustic_radius=0.05 kernel=constant caustic_kernel=constant boundary=false nee=false \
                       caustic_map=false hide_emitters=true";

/// Parses settings `key=value` separated by blanks; a later one wins.
pub fn settings(parts: &[&str]) -> Vec<(String, String)> {
    let mut out: Vec<(String, String)> = Vec::new();
    for (key, value) in parts.iter().flat_map(|p| p.split_whitespace()).filter_map(|t| t.split_once('=')) {
        out.retain(|(k, _)| k != key);
        out.push((key.to_owned(), value.to_owned()));
    }
    out
}

fn variant(label: &str, x: f64, group: &str, changes: &str, passes: u32, seeds: u64) -> Variant {
    Variant {
        label: label.to_owned(),
        x,
        group: group.to_owned(),
        settings: settings(&[CLASSIC, changes]),
        passes,
        seeds,
    }
}

/// The study of a name; `None` for an unknown name.
pub fn study(name: &str, p: Profile) -> Option<Study> {
    match name {
        "photons" => Some(photons(p)),
        "neighbours" => Some(neighbours(p)),
        "kernels" => Some(kernels(p)),
        "roulette" => Some(roulette(p)),
        "direct" => Some(direct(p)),
        "nee" => Some(nee(p)),
        "caustic-map" => Some(caustic_map(p)),
        _ => None,
    }
}

fn photons(p: Profile) -> Study {
    let variants =
        [10_000u64, 100_000, 1_000_000, 10_000_000].into_iter().filter(|n| *n <= p.most_photons).map(|n| {
            // Two are enough where a render takes longest and has the least noise.
            let seeds = if n >= 10_000_000 { p.seeds.min(2) } else { p.seeds };
            variant(
                &n.to_string(),
                n as f64,
                "k = 100, radius ≤ 0.05",
                &format!("photons={n} caustic_photons={n}"),
                16,
                seeds,
            )
        });
    Study {
        name: "photons",
        title: "Number of photons",
        observation: "The picture gets much better and less biased with more photons, and the time of the \
                      camera pass grows polynomially with them (section 5.1).",
        setup:
            "One map of all photons, direct light from first photons, k = 100 nearest within 0.05, constant \
                kernel, 16 rays per pixel. The x axis counts light paths."
                .to_owned(),
        scene: OWNER,
        x: "light paths",
        log_x: true,
        truth: "",
        variants: variants.collect(),
    }
}

fn neighbours(p: Profile) -> Study {
    let of = |k: u32| {
        let change =
            format!("photons={0} caustic_photons={0} neighbours={k} caustic_neighbours={k}", p.photons);
        variant(&format!("k = {k}"), f64::from(k), "radius ≤ 0.05", &change, 16, p.seeds)
    };
    Study {
        name: "neighbours",
        title: "Number of neighbours",
        observation: "More neighbours do not make the picture better: 500 blur corners and shadows (bias), 100 \
                      leave spots (noise); the time hardly depends on them (section 5.2).",
        setup: format!("As above with {} light paths.", p.photons),
        scene: OWNER,
        x: "neighbours k",
        log_x: true,
        truth: "",
        variants: [5, 10, 20, 50, 100, 200, 500].map(of).to_vec(),
    }
}

/// The renderer's kernels.
pub const KERNELS: [&str; 9] = [
    "constant",
    "cone",
    "epanechnikov",
    "biweight",
    "triweight",
    "tricube",
    "gaussian",
    "logistic",
    "silverman",
];

fn kernels(p: Profile) -> Study {
    let n = p.photons / 5;
    let variants = KERNELS.iter().flat_map(|kernel| {
        [0.05, 0.075, 0.1, 0.15].map(|r| {
            let change = format!(
                "photons={n} caustic_photons={n} lookup=radius radius={r} caustic_radius={r} kernel={kernel} \
                 caustic_kernel={kernel}"
            );
            variant(&format!("{kernel}, r = {r}"), r, kernel, &change, 4, p.seeds)
        })
    });
    Study {
        name: "kernels",
        title: "Kernels",
        observation: "Gaussian, Epanechnikov, logistic and constant kernels smooth, biweight and cone keep \
                      detail; though Epanechnikov is optimal in theory, the Gaussian gives better pictures \
                      (section 7.1).",
        setup: format!(
            "All-diffuse box as in the document, {n} light paths, every photon within the radius, 4 rays per \
             pixel. Four radii, because kernels of one radius smooth differently: the standard deviation of a \
             constant kernel is about twice that of a Gaussian cut at 3σ."
        ),
        scene: DIFFUSE,
        x: "radius",
        log_x: true,
        truth: "",
        variants: variants.collect(),
    }
}

fn roulette(p: Profile) -> Study {
    let n = p.photons / 2;
    let variants = ["absorb", "retry", "renormalise"].iter().flat_map(|policy| {
        [1u32, 16].map(|rays| {
            let change = format!("photons={n} caustic_photons={n} roulette={policy}");
            variant(&format!("{policy}, {rays} rpp"), f64::from(rays), policy, &change, rays, p.seeds.max(4))
        })
    });
    Study {
        name: "roulette",
        title: "Russian roulette of camera paths",
        observation: "Absorption leaves black pixels at 1 ray per pixel and a darker picture at more; retrying \
                      and renormalising do not, and renormalising costs nothing (section 6).",
        setup: format!(
            "{n} light paths, otherwise as above. Camera paths only; photons are always absorbed as the \
             materials say."
        ),
        scene: OWNER,
        x: "rays a pixel",
        log_x: true,
        truth: "",
        variants: variants.collect(),
    }
}

/// Direct light alone.
const DIRECT: &str = "max_depth=2";

fn direct(p: Profile) -> Study {
    let first = [10u64, 1].map(|part| {
        let n = p.photons / part;
        let change = format!("photons={n} caustic_photons={n} {DIRECT}");
        variant(&format!("first photons, {n}"), n as f64, "first photons", &change, 16, p.seeds)
    });
    let sampled = variant("NEE", p.photons as f64, "NEE", &format!("nee=true {DIRECT}"), 16, p.seeds);
    Study {
        name: "direct",
        title: "Direct light alone: next event estimation against first photons",
        observation: "NEE takes much less time and converges better: sharp corners and shadows, even colours; \
                      its picture is somewhat darker (section 3, figures 3.1 to 3.3).",
        setup:
            "Light of at most one bounce, in the pictures and in the reference; k = 100 nearest within 0.05, \
                16 rays per pixel. NEE needs no light paths."
                .to_owned(),
        scene: OWNER,
        x: "light paths",
        log_x: true,
        truth: DIRECT,
        variants: first.into_iter().chain([sampled]).collect(),
    }
}

fn nee(p: Profile) -> Study {
    let variants = [10u64, 1].into_iter().flat_map(|part| {
        let n = p.photons / part;
        [("false", "first photons"), ("true", "NEE")].map(|(nee, group)| {
            let change = format!("photons={n} caustic_photons={n} nee={nee}");
            variant(&format!("{group}, {n}"), n as f64, group, &change, 16, p.seeds)
        })
    });
    Study {
        name: "nee",
        title: "All light: next event estimation against first photons",
        observation: "The same for pictures of all light, where photons carry the indirect light (section 3).",
        setup: "k = 100 nearest within 0.05, 16 rays per pixel, two numbers of light paths.".to_owned(),
        scene: OWNER,
        x: "light paths",
        log_x: true,
        truth: "",
        variants: variants.collect(),
    }
}

fn caustic_map(p: Profile) -> Study {
    let n = p.photons;
    let own = n / 10;
    // So many paths for the caustic map store as many caustic photons as the global paths do.
    let equal = n * 57 / 5000;
    let with = |label: &str, x: f64, paths: u64, change: &str| {
        let group = match (paths == own, change.contains("cap")) {
            (true, false) => "with caustic map",
            (true, true) => "with cap",
            (false, _) => "equal photons",
        };
        let change = format!("photons={n} caustic_photons={paths} caustic_map=true {change}");
        variant(label, x, group, &change, 16, p.seeds)
    };
    let alone = format!("photons={n} caustic_photons={n}");
    Study {
        name: "caustic-map",
        title: "Global map alone against global and caustic map",
        observation: "With a caustic map of its own radius 0.025 the picture is clearer and its shadows stand \
                      out; a cap on the number of caustic photons would improve it further (section 7.2).",
        setup: format!(
            "{n} light paths for the global map; {own} aimed at the spheres for the caustic map, or {equal}, \
             which store about as many caustic photons as the global paths do. k = 100, 16 rays per pixel."
        ),
        scene: OWNER,
        x: "caustic radius",
        log_x: true,
        truth: "",
        variants: vec![
            variant("global map alone", 0.05, "global map alone", &alone, 16, p.seeds),
            with("caustic r = 0.05", 0.05, own, "caustic_radius=0.05"),
            with("caustic r = 0.025", 0.025, own, "caustic_radius=0.025"),
            with("caustic r = 0.0125", 0.0125, own, "caustic_radius=0.0125"),
            with("caustic r = 0.025, cap 20", 0.025, own, "caustic_radius=0.025 caustic_cap=20"),
            with("caustic r = 0.025, equal photons", 0.025, equal, "caustic_radius=0.025"),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_later_setting_wins() {
        let s = settings(&["a=1 b=2", "a=3"]);
        assert_eq!(s, [("b".to_owned(), "2".to_owned()), ("a".to_owned(), "3".to_owned())]);
    }

    #[test]
    fn every_name_is_a_study_with_labels_of_its_own() {
        for name in NAMES {
            let study = study(name, Profile::FULL).unwrap();
            let mut labels: Vec<_> = study.variants.iter().map(|v| v.label.clone()).collect();
            labels.sort();
            labels.dedup();
            assert_eq!(labels.len(), study.variants.len(), "{name}");
        }
        assert!(study("nonsense", Profile::QUICK).is_none());
    }
}
