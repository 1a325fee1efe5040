//! Runs the program.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, Command, Stdio};

use caustica_formats::image::{self, Image};
use libtest_mimic::Failed;

use super::client::Client;

/// A small scene, and a picture of it that has few pixels.
pub const SCENE: &str = "scenes/cornell-diffuse.xml";
pub const SMALL: &[&str] = &["--size", "64x48", "--integrator", "path", "--threads", "1"];

/// More passes than any test waits for.
pub const ENDLESS: &[&str] = &["--passes", "1000000"];

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A running render, which is ended with the test.
pub struct Render {
    child: Child,
    said: BufReader<ChildStderr>,
    pub folder: tempfile::TempDir,
}

pub struct Ended {
    pub status: Option<i32>,
    pub said: String,
    pub folder: tempfile::TempDir,
}

impl Render {
    /// Renders `scene` into `out.exr` and `stats.json` of a new folder. No browser is opened.
    pub fn start(scene: &str, arguments: &[&[&str]]) -> Result<Self, Failed> {
        Self::run(scene, arguments, |_| ())
    }

    fn run(scene: &str, arguments: &[&[&str]], more: impl FnOnce(&mut Command)) -> Result<Self, Failed> {
        let folder = tempfile::tempdir()?;
        let mut command = Command::new(env!("CARGO_BIN_EXE_caustica"));
        command
            .arg("render")
            .arg(root().join(scene))
            .args(["-o", "out.exr", "--stats", "stats.json", "--quiet"])
            .args(arguments.concat())
            .current_dir(folder.path())
            .env_remove("DISPLAY")
            .env_remove("WAYLAND_DISPLAY")
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        more(&mut command);
        let mut child = command.spawn()?;
        let said = BufReader::new(child.stderr.take().ok_or("no stderr")?);
        Ok(Self { child, said, folder })
    }

    /// The same where there is a screen, and `folder` holds the program that opens pages.
    #[cfg(all(unix, not(target_os = "macos")))]
    fn on_screen(folder: &Path, arguments: &[&[&str]]) -> Result<Self, Failed> {
        let arguments = [arguments, &[&["--view"]]].concat();
        Self::run(SCENE, &arguments, |command| {
            command.env("DISPLAY", ":0").env("PATH", folder);
        })
    }

    /// The address that the program prints.
    pub fn address(&mut self) -> Result<String, Failed> {
        let mut line = String::new();
        self.said.read_line(&mut line)?;
        let address = line.trim().strip_prefix("view: ").ok_or_else(|| format!("no address: {line}"))?;
        Ok(address.to_owned())
    }

    /// Starts a render with a page, and something that reads it.
    pub fn viewed(arguments: &[&[&str]]) -> Result<(Self, Client), Failed> {
        let mut render = Self::start(SCENE, &[arguments, &[&["--view"]]].concat())?;
        let client = Client::of(&render.address()?)?;
        Ok((render, client))
    }

    pub fn wait(mut self) -> Result<Ended, Failed> {
        let mut said = String::new();
        self.said.read_to_string(&mut said)?;
        let status = self.child.wait()?.code();
        let folder = std::mem::replace(&mut self.folder, tempfile::tempdir()?);
        Ok(Ended { status, said, folder })
    }

    pub fn is_running(&mut self) -> Result<bool, Failed> {
        Ok(self.child.try_wait()?.is_none())
    }
}

impl Drop for Render {
    fn drop(&mut self) {
        let _ended = self.child.kill();
        let _reaped = self.child.wait();
    }
}

impl Ended {
    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub fn bytes(&self) -> Result<Vec<u8>, Failed> {
        Ok(std::fs::read(self.file("out.exr"))?)
    }

    pub fn statistics(&self) -> Result<serde_json::Value, Failed> {
        Ok(serde_json::from_slice(&std::fs::read(self.file("stats.json"))?)?)
    }

    pub fn passes(&self) -> Result<u64, Failed> {
        Ok(self.statistics()?["render"]["passes"].as_u64().ok_or("no passes")?)
    }
}

/// Where systems open pages with a program of the path.
#[cfg(all(unix, not(target_os = "macos")))]
pub fn opens() -> Result<(), Failed> {
    use std::os::unix::fs::PermissionsExt;
    use std::time::Duration;

    let folder = tempfile::tempdir()?;
    let opened = folder.path().join("opened");
    let opener = folder.path().join("xdg-open");
    std::fs::write(&opener, format!("#!/bin/sh\necho \"$1\" > '{}'\n", opened.display()))?;
    std::fs::set_permissions(&opener, std::fs::Permissions::from_mode(0o755))?;
    let mut silent = Render::on_screen(folder.path(), &[SMALL, ENDLESS, &["--view-no-open"]])?;
    let client = Client::of(&silent.address()?)?;
    client.until("a pass", |state| state["snapshot"].is_object())?;
    let was_opened = opened.exists();
    let mut render = Render::on_screen(folder.path(), &[SMALL, ENDLESS])?;
    let address = render.address()?;
    let read = || std::fs::read_to_string(&opened).unwrap_or_default();
    for _ in 0..2000 {
        if read().trim() == address {
            break;
        }
        std::thread::sleep(Duration::from_millis(30));
    }
    super::equal("the page", read().trim(), &*address)?;
    super::check("it was opened although nobody wanted it", !was_opened)
}

/// Elsewhere the system opens them, which cannot be seen.
#[cfg(not(all(unix, not(target_os = "macos"))))]
pub fn opens() -> Result<(), Failed> {
    Ok(())
}

/// The bytes of a render that nobody looks at.
pub fn unseen(arguments: &[&[&str]]) -> Result<Vec<u8>, Failed> {
    Render::start(SCENE, arguments)?.wait()?.bytes()
}

pub fn picture(path: &Path) -> Result<Image, Failed> {
    Ok(image::read(&std::fs::read(path)?)?)
}

/// The values of channels of a picture, pixel by pixel.
pub fn values(image: &Image, channels: &[&str]) -> Result<Vec<f32>, Failed> {
    let at = |name: &&str| image.channels.iter().position(|c| c == name).ok_or_else(|| format!("no {name}"));
    let places = channels.iter().map(at).collect::<Result<Vec<_>, _>>()?;
    let pixels = image.data.chunks_exact(image.channels.len());
    Ok(pixels.flat_map(|pixel| places.iter().map(|place| pixel[*place])).collect())
}
