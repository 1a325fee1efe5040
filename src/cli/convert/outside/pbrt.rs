//! pbrt-v4, as `pbrt`.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use caustica_formats::image;

use super::installed::{Rendered, SEEDS, skipped};
use crate::cli::convert::check::{PASSES, SIDE};
use crate::cli::failure::Failure;

/// Pictures of a scene that `convert` wrote, one a seed.
///
/// # Errors
/// When pbrt refuses the scene.
pub fn render(scene: &Path, out: &Path) -> Result<Rendered, Failure> {
    let text = std::fs::read_to_string(scene).map_err(|e| e.to_string())?;
    // Beside the scene, for the names of its files.
    let folder = scene.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let copy = tempfile::Builder::new().prefix(".check-").suffix(".pbrt").tempfile_in(folder);
    let mut copy = copy.map_err(|e| e.to_string())?;
    copy.write_all(shrunk(&text).as_bytes()).map_err(|e| e.to_string())?;
    let mut pictures = Vec::new();
    for seed in 1..=SEEDS {
        let mut command = Command::new("pbrt");
        command.args(["--quiet", "--spp", &PASSES.to_string(), "--seed", &seed.to_string(), "--outfile"]);
        let Ok(run) = command.arg(out).arg(copy.path()).stdin(Stdio::null()).output() else {
            return skipped(
                "pbrt",
                "build it from https://github.com/mmp/pbrt-v4 and put `pbrt` on the PATH",
            );
        };
        if !run.status.success() {
            let said = String::from_utf8_lossy(&run.stderr).trim().to_owned();
            return Err(Failure::Work(format!("pbrt refuses {}:\n{said}", scene.display())));
        }
        let bytes = std::fs::read(out).map_err(|e| e.to_string())?;
        let picture = image::read(&bytes).map_err(|e| e.to_string())?;
        let places = picture.rgb().unwrap_or([0; 3]);
        let pixels = picture.data.chunks_exact(picture.channels.len().max(1));
        pictures.push(pixels.map(|pixel| places.map(|place| pixel[place])).collect());
    }
    Ok(Some(("pbrt".to_owned(), pictures)))
}

/// A scene of ours with a small film of 32-bit floats, a sampler that follows `--seed`, and paths instead of photons,
/// whose means have no bias.
fn shrunk(text: &str) -> String {
    let (head, world) = text.split_once("\nWorldBegin").unwrap_or((text, ""));
    let mut out = String::new();
    for statement in head.replace("\n\t", " ").lines() {
        match statement.split(' ').next() {
            Some("Film") => out += &film(statement),
            Some("Sampler") => out += "Sampler \"independent\"",
            Some("Integrator") => {
                let depth = value(statement, "\"integer maxdepth\" ").unwrap_or("5");
                out += &format!("Integrator \"volpath\" \"integer maxdepth\" {depth}");
            }
            _ => out += statement,
        }
        out.push('\n');
    }
    format!("{out}\nWorldBegin{world}")
}

/// As our own picture is shrunk: with the whole film where it was larger.
fn film(statement: &str) -> String {
    let mut film = without(statement, "\"bool savefp16\" ");
    let sizes = ["\"integer xresolution\" ", "\"integer yresolution\" "];
    let read = |key| value(statement, key).and_then(|v| v.parse::<u64>().ok()).unwrap_or(1);
    let [width, height] = sizes.map(read);
    let longest = width.max(height);
    if longest > u64::from(SIDE) {
        film = without(&film, "\"integer pixelbounds\" ");
        for (key, size) in sizes.iter().zip([width, height]) {
            let new = (size * u64::from(SIDE) / longest).max(1);
            film = film.replace(&format!("{key}{size}"), &format!("{key}{new}"));
        }
    }
    film + " \"bool savefp16\" false"
}

/// The value that stands after `key`: a word, or a list in brackets.
fn value<'a>(statement: &'a str, key: &str) -> Option<&'a str> {
    let rest = statement.split_once(key)?.1;
    let end = if rest.starts_with('[') { rest.find(']').map(|i| i + 1) } else { rest.find(' ') };
    Some(&rest[..end.unwrap_or(rest.len())])
}

fn without(statement: &str, key: &str) -> String {
    match value(statement, key) {
        Some(value) => statement.replace(&format!(" {key}{value}"), ""),
        None => statement.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pbrt_is_given_a_small_scene_whose_seed_it_sets() {
        let text = "# a.xml\nIntegrator \"sppm\" \"float radius\" 0.1 \"integer maxdepth\" 7\nCamera \"perspective\"\n\
                    Film \"rgb\"\n\t\"integer xresolution\" 1920\n\t\"integer yresolution\" 1080\n\t\"integer pixelbounds\" \
                    [0 10 0 10]\n\t\"bool savefp16\" true\nPixelFilter \"box\"\nSampler \"zsobol\" \"integer seed\" 3\n\n\
                    WorldBegin\n\tShape \"sphere\"\n";
        let small = "# a.xml\nIntegrator \"volpath\" \"integer maxdepth\" 7\nCamera \"perspective\"\nFilm \"rgb\" \"integer \
                     xresolution\" 96 \"integer yresolution\" 54 \"bool savefp16\" false\nPixelFilter \"box\"\nSampler \
                     \"independent\"\n\nWorldBegin\n\tShape \"sphere\"\n";
        assert_eq!(shrunk(text), small);
        // A film that is small already keeps its window.
        let film = film(
            "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 4 \"integer pixelbounds\" [0 4 0 4]",
        );
        assert!(film.contains("[0 4 0 4]") && film.contains("xresolution\" 8 "), "{film}");
    }
}
