//! The HTML page in headless Chromium: it loads without errors, slider and keys change the picture,
//! and the numbers it shows are those of the JSON.

use caustica_formats::image::{ExrLayer, ExrOptions, write_exr};
use caustica_tools::compare::{CompareArgs, Status, run};
use libtest_mimic::{Arguments, Completion, Failed, Trial};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];
const INSTALL: &str = "no Chromium; install it with: apt-get install chromium";

fn main() -> ExitCode {
    let trial = |name: &str, test: fn(&Path) -> Result<(), Failed>| {
        Trial::ignorable_test(name, move || match browser() {
            Some(browser) => test(&browser).map(|()| Completion::Completed),
            None => Ok(Completion::ignored_with(INSTALL)),
        })
    };
    let trials = vec![
        trial("page_of_one_comparison_in_chromium", one_comparison),
        trial("page_of_two_folders_in_chromium", two_folders),
        trial("page_without_comparisons_in_chromium", no_comparison),
    ];
    libtest_mimic::run(&Arguments::from_args(), trials).exit_code()
}

fn browser() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    BROWSERS.iter().flat_map(|b| folders.iter().map(move |f| f.join(b))).find(|p| p.is_file())
}

fn one_comparison(browser: &Path) -> Result<(), Failed> {
    let root = tempfile::tempdir()?;
    let (image, reference) = (root.path().join("a.exr"), root.path().join("a.ref.exr"));
    picture(&image, 60, 40, 1.0)?;
    picture(&reference, 60, 40, 0.0)?;
    picture(&root.path().join("a.ref.var.exr"), 60, 40, 0.5)?;
    let args =
        CompareArgs { max_flip: Some(0.001), max_rmse: Some(10.0), ..CompareArgs::new(image, reference) };
    let (json, seen) = open(browser, root.path(), args, Status::FallsShort)?;
    let at = |path: &str| seen.pointer(path).unwrap_or(&Value::Null).clone();
    let sums = |name: &str| [at(&format!("/{name}/left")), at(&format!("/{name}/right"))];

    // The slider goes through the layers and wipes between them.
    check("image differs from reference", sums("image") != sums("slidReference"))?;
    check("reference differs from FLIP", sums("slidReference") != sums("slidFlip"))?;
    check("left of the divider is the reference", sums("slidHalf")[0] != sums("image")[0])?;
    check("right of the divider is the image", sums("slidHalf")[1] == sums("image")[1])?;
    check("the slider's place", at("/slidFlip/slider") == 2 && at("/slidFlip/label") == "LDR-FLIP")?;
    // Keys do the same.
    check("key 1", sums("keyImage") == sums("image") && at("/keyImage/slider") == 0)?;
    check("key 2", sums("keyReference") == sums("slidReference") && at("/keyReference/slider") == 1)?;
    check("space", sums("keySpace") == sums("image"))?;
    check("exposure brightens", at("/exposed/left").as_f64() > at("/keySpace/left").as_f64())?;
    check("exposure is shown", at("/stops") == "+2")?;
    check("read-out", at("/readout").as_str().is_some_and(|r| r.contains("pixel (30, 20)")))?;
    check("four panes side by side", at("/panes") == 4 && at("/shared") == 1)?;
    check("crops and histogram", at("/crops").as_u64() >= Some(3) && at("/bars").as_u64() >= Some(2))?;
    numbers(&json, &seen)
}

fn two_folders(browser: &Path) -> Result<(), Failed> {
    let root = tempfile::tempdir()?;
    let (images, references) = (root.path().join("images"), root.path().join("references"));
    for folder in [&images, &references] {
        std::fs::create_dir(folder)?;
    }
    for (name, width) in [("a.exr", 40), ("<b>&.exr", 70)] {
        picture(&images.join(name), width, 30, 1.0)?;
        picture(&references.join(name), width, 30, 0.0)?;
    }
    picture(&references.join("c.exr"), 8, 8, 0.0)?;
    let args = CompareArgs::new(images, references);
    let (json, seen) = open(browser, root.path(), args, Status::CouldNotCompare)?;
    check("two comparisons", json["comparisons"].as_array().is_some_and(|c| c.len() == 2))?;
    check("names", seen["comparisons"][0]["title"] == "<b>&" && seen["comparisons"][1]["title"] == "a")?;
    check("the failure is listed", seen["problems"].as_array().is_some_and(|p| p.len() == 1))?;
    numbers(&json, &seen)
}

fn no_comparison(browser: &Path) -> Result<(), Failed> {
    let root = tempfile::tempdir()?;
    let page = root.path().join("page.html");
    let args = CompareArgs { html: Some(page.clone()), ..CompareArgs::new("absent.exr", "absent.ref.exr") };
    let status = run(&args, &mut Vec::new());
    check("status", status == Status::CouldNotCompare)?;
    let document = load(browser, root.path(), &page)?;
    check(
        "says so",
        document.contains("nothing was compared") && document.contains("could not compare: absent.exr"),
    )
}

/// Writes the page, uses it in the browser; returns the JSON of the run and what was seen.
fn open(
    browser: &Path,
    folder: &Path,
    args: CompareArgs,
    expected: Status,
) -> Result<(Value, Value), Failed> {
    let page = folder.join("page.html");
    let args = CompareArgs { html: Some(page.clone()), json: Some(None), ..args };
    let mut json = Vec::new();
    let status = run(&args, &mut json);
    check("status of the run", status == expected)?;
    let text = std::fs::read_to_string(&page)?;
    let driver = format!("<script>{}</script>\n</body>", include_str!("page_driver.js"));
    let driven = folder.join("driven.html");
    std::fs::write(&driven, text.replacen("</body>", &driver, 1))?;
    let document = load(browser, folder, &driven)?;
    let seen = document
        .split_once("<pre id=\"seen\">")
        .and_then(|(_, rest)| rest.split_once("</pre>"))
        .ok_or("the driver did not finish")?
        .0;
    let seen =
        seen.replace("&lt;", "<").replace("&gt;", ">").replace("&nbsp;", "\u{a0}").replace("&amp;", "&");
    Ok((serde_json::from_slice(&json)?, serde_json::from_str(&seen)?))
}

/// The document after its scripts ran; fails on anything in the console.
fn load(browser: &Path, folder: &Path, page: &Path) -> Result<String, Failed> {
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu", "--window-size=1200,1000", "--dump-dom"])
        .args(["--enable-logging=stderr", "--virtual-time-budget=5000"])
        .arg(format!("--user-data-dir={}", folder.join("profile").display()))
        .arg(format!("file://{}", page.display()))
        .output()?;
    let log = String::from_utf8_lossy(&output.stderr);
    let console: Vec<&str> = log.lines().filter(|l| l.contains("CONSOLE")).collect();
    if !console.is_empty() {
        return Err(console.join("\n").into());
    }
    check("the browser's exit", output.status.success())?;
    Ok(String::from_utf8(output.stdout)?)
}

/// Every number shown is the JSON's, to the six digits shown.
fn numbers(json: &Value, seen: &Value) -> Result<(), Failed> {
    let comparisons = json["comparisons"].as_array().ok_or("no comparisons")?;
    for (i, comparison) in comparisons.iter().enumerate() {
        let shown = seen["comparisons"][i]["numbers"].as_object().ok_or("no numbers")?;
        check("all metrics are shown", shown.len() >= 28)?;
        for (metric, text) in shown {
            let exact = comparison
                .pointer(&format!("/{}", metric.replace('.', "/")))
                .and_then(Value::as_f64)
                .ok_or_else(|| format!("{metric} is not in the JSON"))?;
            let text = text.as_str().ok_or("text")?;
            let (number, unit) = text.strip_suffix(" %").map_or((text, 1.0), |t| (t, 0.01));
            let shown: f64 = number.parse::<f64>()? * unit;
            let close = (shown - exact).abs() <= 5.1e-6 * exact.abs();
            check(&format!("{metric}: page {text}, JSON {exact}"), close)?;
        }
    }
    Ok(())
}

fn check(what: &str, holds: bool) -> Result<(), Failed> {
    if holds { Ok(()) } else { Err(what.into()) }
}

/// A gradient; `k` adds a disc and a pattern.
fn picture(path: &Path, width: usize, height: usize, k: f32) -> Result<(), Failed> {
    let mut data = Vec::new();
    for y in 0..height {
        for x in 0..width {
            let disc = if (x / 2).pow(2) + y * y < 400 { 0.4 * k } else { 0.0 };
            let noise = ((x * 7 + y * 13) % 11) as f32 * 0.02 * k;
            data.extend([x as f32 / width as f32 + disc, 0.3 + noise, y as f32 / height as f32]);
        }
    }
    let layer = ExrLayer { name: "", channels: &["R", "G", "B"], data: &data };
    Ok(write_exr(path, width, height, &[layer], &[], ExrOptions::default())?)
}
