//! Every setting of the table can be set by a scene, under the same name and in the same words as on the
//! command line.

use std::path::Path;

use caustica::session::Session;
use caustica::settings::{Count, Radius, SETTINGS, Settings};
use caustica_formats::files::Memory;

use crate::support::{box_camera, plain};

/// Of each of these a setting takes some.
const VALUES: [&str; 15] = [
    "path",
    "photonmap",
    "progressive",
    "classic",
    "radius",
    "7",
    "0.31",
    "0.05R",
    "stored:1000",
    "nearest",
    "cone",
    "absorb",
    "gather",
    "auto",
    "points",
];
const SWITCHES: [&str; 2] = ["true", "false"];

/// What a scene with this integrator asks for.
fn asked(plugin: &str, setting: &str) -> Settings {
    let text = format!(
        "<scene version='3.0.0'><integrator type='{plugin}'>{setting}</integrator>{}</scene>",
        box_camera(1)
    );
    let files = Memory([("scene.xml".into(), text.into_bytes())].into());
    let session = Session::open_in(&files, Path::new("scene.xml"), &plain());
    let session = session.unwrap_or_else(|e| panic!("{setting}: {e}"));
    assert!(session.warnings().is_empty(), "{setting}: {}", session.warnings());
    session.settings
}

#[test]
fn a_scene_sets_every_setting_by_its_name() {
    for plugin in ["path", "photonmapper", "ppm", "sppm"] {
        let base = asked(plugin, "");
        for row in SETTINGS {
            let mut changed = 0;
            for value in VALUES.into_iter().chain(SWITCHES) {
                let mut expected = base.clone();
                if expected.set(row.name, value).is_err() {
                    continue;
                }
                changed += usize::from(expected != base);
                let text = format!("<string name='{}' value='{value}'/>", row.name);
                assert_eq!(asked(plugin, &text), expected, "{plugin}: {text}");
            }
            assert!(changed > 0, "no value of this test changes `{}` of {plugin}", row.name);
        }
    }
}

/// Numbers and switches have types of their own in XML.
#[test]
fn typed_values_are_settings_too() {
    let base = asked("path", "");
    for (tag, values) in [("integer", &["7"][..]), ("float", &["0.31"]), ("boolean", &SWITCHES)] {
        let mut accepted = 0;
        for (row, value) in SETTINGS.iter().flat_map(|row| values.iter().map(move |value| (row, *value))) {
            let mut expected = base.clone();
            // What a whole number may be, a float may not, and the other way round.
            let fits = match tag {
                "integer" => row.expected.contains("whole number") || row.expected.contains("count"),
                "float" => row.expected.contains("length") || row.expected.contains("number between"),
                _ => row.expected == "true or false",
            };
            if fits && expected.set(row.name, value).is_ok() {
                accepted += 1;
                let text = format!("<{tag} name='{}' value='{value}'/>", row.name);
                assert_eq!(asked("path", &text), expected, "{text}");
            }
        }
        assert!(accepted > 2, "{tag}");
    }
}

/// The three that could not be said before.
#[test]
fn radii_counts_and_the_caustic_map_are_set_as_on_the_command_line() {
    let text = "<boolean name='caustic_map' value='false'/><string name='radius' value='0.05R'/>
        <string name='photons' value='stored:1000'/>";
    let settings = asked("photonmapper", text);
    assert!(!settings.caustic_map);
    assert_eq!(settings.radius, Radius::Relative(0.05));
    assert_eq!(settings.photons, Count::Stored(1000));
    // Mitsuba's own parameter of that name still counts photons.
    let own = asked("photonmapper", "<integer name='caustic_photons' value='500'/>");
    assert_eq!(own.caustic_photons, Count::Stored(500));
}
