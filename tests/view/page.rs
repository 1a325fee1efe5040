//! The page's protocol.

use std::net::TcpStream;
use std::process::Command;
use std::time::Duration;

use libtest_mimic::Failed;
use serde_json::Value;

use super::client::{half, index};
use super::program::{ENDLESS, Render, SCENE, SMALL, picture, root, unseen, values};
use super::{check, equal};

fn paused(state: &Value) -> bool {
    state["phase"] == "paused"
}

pub fn token() -> Result<(), Failed> {
    let (mut render, client) = Render::viewed(&[SMALL, ENDLESS])?;
    let (ip, port) = client.host.split_once(':').ok_or("no port")?;
    equal("the interface", ip, "127.0.0.1")?;
    check("128 bits of token", client.token.len() == 32)?;
    // Another address of this machine leads nowhere.
    check("no other interface", TcpStream::connect(format!("127.0.0.2:{port}")).is_err())?;

    let (own, host) = (format!("/{}/", client.token), format!("Host: {}\r\n", client.host));
    let status =
        |method: &str, path: &str, headers: &str| client.ask(method, path, headers).map(|a| a.status);
    let wrong = format!("/{}/", "0".repeat(32));
    for path in ["/", "/favicon.ico", wrong.as_str(), &format!("{wrong}state"), &own[..own.len() - 1]] {
        equal(path, status("GET", path, &host)?, 403)?;
    }
    equal("a wrong token stops nothing", status("POST", &format!("{wrong}stop"), &host)?, 403)?;
    // A name that an attacker lets point here, and none at all.
    for headers in [&format!("Host: evil.example:{port}\r\n"), "Host: 127.0.0.1\r\n", ""] {
        equal(headers, status("GET", &own, headers)?, 403)?;
    }
    equal("localhost", status("GET", &own, &format!("Host: localhost:{port}\r\n"))?, 200)?;
    // Another page cannot act, even one that has found out the token.
    let foreign = format!("{host}Origin: http://evil.example\r\n");
    equal("a foreign page", status("POST", &format!("{own}stop"), &foreign)?, 403)?;
    equal("an unknown act", status("POST", &format!("{own}dance"), &host)?, 404)?;
    equal("another method", status("DELETE", &own, &host)?, 405)?;

    let page = client.get("")?;
    equal("the page", page.status, 200)?;
    let head = page.head.to_ascii_lowercase();
    check("no CORS", !head.contains("access-control"))?;
    for header in [
        "content-security-policy: default-src 'none'",
        "referrer-policy: no-referrer",
        "cache-control: no-store",
    ] {
        check(header, head.contains(header))?;
    }
    let text = String::from_utf8(page.body)?;
    check("the page names its scene", text.contains("cornell-diffuse.xml") && text.ends_with("</html>\n"))?;
    check("the render goes on", render.is_running()?)
}

/// Paused, so that the page and the saved file show the same passes.
pub fn tiles() -> Result<(), Failed> {
    let big: &[&str] = &["--size", "160x130", "--integrator", "path"];
    let (render, client) = Render::viewed(&[big, ENDLESS])?;
    client.until("a pass", |state| state["snapshot"].is_object())?;
    client.post("pause")?;
    client.until("the pause", |state| {
        paused(state) && state["snapshot"]["passes"] == state["statistics"]["passes"]
    })?;
    client.post("save")?;
    let state = client.until("the files", |state| state["saved"]["number"] == 1)?;
    check("it says where", state["saved"]["text"].as_str().is_some_and(|t| t.contains("wrote out.exr")))?;
    let file = picture(&render.folder.path().join("out.exr"))?;
    let layers = [("picture", ["R", "G", "B"]), ("direct", ["direct.R", "direct.G", "direct.B"])];
    for (name, channels) in layers {
        let layer = index(&client, name)?;
        let what = format!("tiles?layer={layer}");
        // Asked for in a pause, it is there at once.
        client.tiles(&what)?;
        let state = client.until("the layer", |state| state["ready"][layer] == true)?;
        let tiles = client.tiles(&what)?.ok_or("no tiles")?;
        equal("size", (tiles.size, tiles.channels), ([160, 130], 3))?;
        check("several tiles", tiles.count > 1)?;
        equal("of the snapshot", Value::from(tiles.number), state["snapshot"]["number"].clone())?;
        let expected: Vec<u16> = values(&file, &channels)?.into_iter().map(half).collect();
        check(&format!("{name}: every value is the file's, as a half float"), tiles.values == expected)?;
        check("it is not black", expected.iter().any(|v| *v > 0))?;
    }
    equal("no layer", client.get("tiles?layer=99")?.status, 404)?;
    equal("no reference", client.get("reference")?.status, 404)
}

pub fn on_demand() -> Result<(), Failed> {
    let layers: &[&str] = &["--layers", "direct,depth,variance"];
    let (_render, client) = Render::viewed(&[SMALL, ENDLESS, layers])?;
    let depth = index(&client, "depth")?;
    let state = client.until("a pass", |state| state["snapshot"].is_object())?;
    equal(
        "the picture is there, layers that nobody looked at are not",
        state["ready"].clone(),
        serde_json::json!([true, false, false, false]),
    )?;
    let what = format!("tiles?layer={depth}");
    check("not yet", client.tiles(&what)?.is_none())?;
    // Asked for, it is in the next snapshot; in a pause at once.
    client.post("pause")?;
    client.until("the pause", |state| paused(state) && state["ready"][depth] == true)?;
    let tiles = client.tiles(&what)?.ok_or("no depth")?;
    let gray = tiles.values.chunks_exact(3).all(|p| p[0] == p[1] && p[1] == p[2]);
    check("one number is gray", gray && tiles.values.iter().all(|v| *v > half(1.0)))
}

/// The pause is longer than the time that the render has, and passes follow it.
pub fn pause() -> Result<(), Failed> {
    let (render, client) = Render::viewed(&[SMALL, &["--time", "1.5"]])?;
    client.post("pause")?;
    let before = client.until("the pause", paused)?;
    std::thread::sleep(Duration::from_secs(2));
    let after = client.state(None)?;
    equal("no pass in a pause", &after["statistics"]["passes"], &before["statistics"]["passes"])?;
    equal("no time passes", &after["seconds"], &before["seconds"])?;
    client.post("resume")?;
    let state = client.until("the end", |state| state["phase"] == "ended")?;
    client.bye()?;
    let ended = render.wait()?;
    equal("status", ended.status, Some(0))?;
    let passes = before["statistics"]["passes"].as_u64().ok_or("no passes")?;
    check("passes after the pause", ended.passes()? > passes)?;
    equal("why it ended", &ended.statistics()?["stop"], &Value::from("Time"))?;
    equal("the page says it", &state["reason"], &Value::from("the time is up"))
}

pub fn stop() -> Result<(), Failed> {
    let (render, client) = Render::viewed(&[SMALL, ENDLESS])?;
    client.until("a pass", |state| state["snapshot"].is_object())?;
    client.post("stop")?;
    let state = client.until("the end", |state| state["phase"] == "ended")?;
    let said = state["saved"]["text"].as_str().unwrap_or_default();
    equal("what was saved", said, "wrote out.exr\nwrote out.checkpoint (checkpoint)")?;
    equal("the last picture", &state["snapshot"]["passes"], &state["statistics"]["passes"])?;
    check("it can be had", client.tiles("tiles?layer=0")?.is_some())?;
    let direct = index(&client, "direct")?;
    check("so can its parts, which nobody looked at", state["ready"][direct] == true)?;
    equal("why it ended", &state["reason"], &Value::from("stopped"))?;
    client.bye()?;
    let ended = render.wait()?;
    let error = ended.statistics()?["relative_standard_error"].clone();
    let told = if error.is_null() { Value::Null } else { serde_json::json!([error, ended.passes()?]) };
    equal("the error is that of the statistics", &state["error"], &told)?;
    equal("status", ended.status, Some(0))?;
    check("a checkpoint", ended.file("out.checkpoint").is_file())?;
    let passes = ended.passes()?.to_string();
    let same = unseen(&[SMALL, &["--passes", &passes]])?;
    check("the picture is that of its passes", ended.bytes()? == same)
}

pub fn curve() -> Result<(), Failed> {
    let truth = Render::start(SCENE, &[SMALL, &["--passes", "512", "--seed", "7"]])?.wait()?;
    let reference = truth.file("out.exr").display().to_string();
    let (render, client) = Render::viewed(&[SMALL, &["--passes", "512", "--reference", &reference]])?;
    let coded = client.tiles("reference")?.ok_or("no reference")?;
    let expected = values(&picture(&truth.file("out.exr"))?, &["R", "G", "B"])?;
    check("the reference", coded.values == expected.into_iter().map(half).collect::<Vec<_>>())?;
    let state = client.until("the end", |state| state["phase"] == "ended")?;
    let map = client.tiles("flip")?.ok_or("no map")?;
    client.bye()?;
    let ended = render.wait()?;
    let points = state["curve"].as_array().ok_or("no curve")?;
    equal("why it ended", &state["reason"], &Value::from("all passes are done"))?;
    let (first, last) = (points.first().ok_or("empty")?, points.last().ok_or("empty")?);
    equal("the curve ends with the picture", &last["passes"], &Value::from(512))?;
    let error = |point: &Value| point["rmse"].as_f64().unwrap_or(f64::NAN);
    let passes = first["passes"].as_u64().ok_or("passes")? as f64;
    // The variance of independent passes falls as 1/n, and the reference has that of its own 512. Half of the fall
    // allows for what is not independent: passes are stratified among each other.
    let variance = |n: f64| 1.0 / n + 1.0 / 512.0;
    let falls = 1.0 + ((variance(passes) / variance(512.0)).sqrt() - 1.0) / 2.0;
    check(&format!("the error falls: {points:?}"), error(first) / error(last) >= falls && passes <= 256.0)?;

    let compared = Command::new(env!("CARGO_BIN_EXE_caustica"))
        .arg("compare")
        .args([ended.file("out.exr"), truth.file("out.exr")])
        .arg("--json")
        .output()?;
    let compared: Value = serde_json::from_slice(&compared.stdout)?;
    let compared = &compared["comparisons"][0];
    equal("RMSE", &last["rmse"], &compared["rmse_all"])?;
    equal("relMSE", &last["relmse"], &compared["relmse"])?;
    equal("FLIP", &last["flip"], &compared["flip_ldr"]["mean"])?;
    let mean =
        map.values.iter().map(|v| f64::from(half::f16::from_bits(*v))).sum::<f64>() / map.values.len() as f64;
    let flip = last["flip"].as_f64().ok_or("no FLIP")?;
    // Half floats have eleven bits.
    check("the map is that of the mean", map.channels == 1 && (mean - flip).abs() <= flip / 2048.0)
}

/// A picture costs little of a pass that takes microseconds a pixel, and so do its errors: there are some of each from
/// the beginning, although FLIP, which takes as long as a microsecond a pixel, must wait.
pub fn early() -> Result<(), Failed> {
    let size: &[&str] = &["--size", "256x256", "--passes", "24"];
    let reference = tempfile::tempdir()?;
    let truth = reference.path().join("truth.pfm").display().to_string();
    caustica_formats::image::write_pfm(&truth, 256, 256, &vec![0.5; 3 * 256 * 256])?;
    let (_render, client) = Render::viewed(&[size, &["--reference", &truth]])?;
    let mut shown = Vec::new();
    let mut state = client.state(None)?;
    while state["phase"] != "ended" {
        if let Some(passes) = state["snapshot"]["passes"].as_u64() {
            shown.push(passes);
            client.tiles("tiles?layer=0")?.ok_or("no tiles")?;
        }
        state = client.state(state["version"].as_u64())?;
    }
    client.bye()?;
    shown.dedup();
    let judged: Vec<u64> =
        state["curve"].as_array().ok_or("no curve")?.iter().filter_map(|p| p["passes"].as_u64()).collect();
    // The first pass may be over before this client has asked for anything.
    let early = |passes: &[u64]| passes.len() >= 3 && passes[0] <= 4;
    check(&format!("pictures after {shown:?}, points after {judged:?}"), early(&shown) && early(&judged))
}

pub fn wrong_reference() -> Result<(), Failed> {
    let reference = root().join("reference/cornell-diffuse.exr").display().to_string();
    let ended = Render::start(SCENE, &[SMALL, ENDLESS, &["--view", "--reference", &reference]])?.wait()?;
    equal("status", ended.status, Some(1))?;
    let expected = format!(
        "error: {reference}: it has 96×96 pixels, and the picture 64×48; render with `--size 96x96` to compare them\n"
    );
    equal("message", ended.said, expected)?;
    let alone = Render::start(SCENE, &[SMALL, ENDLESS, &["--reference", &reference]])?.wait()?;
    equal("status", alone.status, Some(2))?;
    equal("message", alone.said.as_str(), "error: --reference is for --view or --display\n")
}
