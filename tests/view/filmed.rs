//! One render, watched in Chromium from its first pass to the file that it leaves, against a picture by Mitsuba.

use std::path::Path;

use libtest_mimic::Failed;
use serde_json::{Value, json};

use super::browser::Browser;
use super::client::half;
use super::program::{ENDLESS, Render, picture, root, values};
use super::{check, equal};

const SCENE: &str = "scenes/cornell-glass.xml";
const REFERENCE: &str = "reference/cornell-glass.exr";

/// Sums of the canvas's bytes in its left and in its right half.
const HALVES: &str = "(() => {
  const c = document.querySelector('.pane canvas'), half = Math.floor(c.width / 2);
  return [0, 1].map(side => c.getContext('2d').getImageData(side * half, 0, half, c.height).data.reduce((a, b) => a + b, 0));
})()";

/// Where the picture begins.
const TOP: &str = "Math.round(byId('panes').getBoundingClientRect().top + scrollY)";

fn slide(id: &str, value: f64) -> String {
    format!("byId('{id}').value = {value}, byId('{id}').dispatchEvent(new Event('input'))")
}

fn key(name: &str) -> String {
    format!("window.dispatchEvent(new KeyboardEvent('keydown', {{ key: '{name}', cancelable: true }}))")
}

pub fn page(program: &Path) -> Result<(), Failed> {
    let screens = root().join("target/live-view");
    std::fs::create_dir_all(&screens)?;
    let reference = root().join(REFERENCE).display().to_string();
    let film: &[&str] = &["--size", "96x96", "--filter", "box", "--view", "--reference", &reference];
    let mut render = Render::start(SCENE, &[film, ENDLESS])?;
    let mut browser = Browser::start(program)?;
    browser.look(1600, 1000, "light")?;
    browser.call("Page.navigate", json!({ "url": render.address()? }))?;

    loads(&mut browser)?;
    browser.screenshot(&screens.join("1-light-1600-first.png"))?;
    let spread = "(() => { const all = [...byId('toolbar').children].map(e => e.getBoundingClientRect());
        const middles = all.map(r => (r.top + r.bottom) / 2); return Math.max(...middles) - Math.min(...middles); })()";
    // Of buttons, of which another row would be 30 pixels below.
    check("the toolbar is one row", browser.value(spread)?.as_f64() <= Some(10.0))?;
    check(
        "the time goes on between passes",
        browser.value("(tick(), byId('time').textContent.length > 0)")? == true,
    )?;
    wipes(&mut browser)?;
    browser.look(1600, 1000, "dark")?;
    browser.until("Number(byId('slider').value) === 0.4")?;
    browser.screenshot(&screens.join("2-dark-1600-wipe.png"))?;
    browser.value(&slide("slider", 2.0))?;
    browser.look(800, 1100, "dark")?;
    browser.until("flip.data && flip.canvas")?;
    scaled(&mut browser)?;
    browser.screenshot(&screens.join("3-dark-800-flip.png"))?;
    fits(&mut browser, 800)?;
    let top = browser.value(TOP)?;
    pauses_and_saves(&mut browser, &render)?;
    equal("the picture stays where it is", browser.value(TOP)?, top.clone())?;
    browser.look(800, 1100, "light")?;
    browser.value("viewer.zoomTo(46, 62, 8, 8)")?;
    browser.screenshot(&screens.join("4-light-800-values.png"))?;
    stops(&mut browser)?;
    equal("the picture is still where it was", browser.value(TOP)?, top)?;
    equal("why", browser.value("byId('phase').textContent")?, Value::from("ended: stopped"))?;
    browser.screenshot(&screens.join("6-light-800-ended.png"))?;
    browser.look(1600, 1000, "dark")?;
    browser.screenshot(&screens.join("5-dark-1600-ended.png"))?;
    fits(&mut browser, 1600)?;

    let ended = render.wait()?;
    equal("status", ended.status, Some(0))?;
    check("the files are there", ended.file("out.exr").is_file() && ended.file("out.checkpoint").is_file())?;
    equal("complaints of the page", &browser.complaints, &Vec::new())
}

/// The page shows the first picture, then newer ones.
fn loads(browser: &mut Browser) -> Result<(), Failed> {
    browser.until("typeof parts !== 'undefined' && parts[0].data && reference.data")?;
    let first = browser.value("parts[0].number")?;
    let black = browser.value("parts[0].data.every(v => v === 0)")?;
    check("the picture is not black", black == false)?;
    browser.until(&format!("parts[0].number > {first}"))?;
    equal("the phase", browser.value("byId('phase').textContent")?, Value::from("rendering"))?;
    browser.until("state.curve.length > 0")?;
    let rows = browser.value("byId('statistics').textContent")?;
    check(
        "statistics",
        ["passes", "rays", "photons", "RMSE"]
            .iter()
            .all(|name| rows.as_str().is_some_and(|r| r.contains(name))),
    )
}

/// The slider goes from the picture to the reference and on to the error map.
fn wipes(browser: &mut Browser) -> Result<(), Failed> {
    // Nothing new is to be drawn while the halves are compared.
    browser.value(&key("p"))?;
    browser.until("state.phase === 'paused' && state.snapshot.passes === state.statistics.passes && parts[0].number === state.snapshot.number && flip.data && flip.number === state.flip")?;
    let mut look = |position: f64| -> Result<[Value; 2], Failed> {
        browser.value(&slide("slider", position))?;
        let halves = browser.value(HALVES)?;
        Ok([halves[0].clone(), halves[1].clone()])
    };
    let (image, truth, map) = (look(0.0)?, look(1.0)?, look(2.0)?);
    check("three pictures", image != truth && truth != map)?;
    let between = look(0.4)?;
    check("left of the divider is the reference", between[0] != image[0])?;
    check("right of it is the picture", between[1] == image[1])?;
    browser.value(&slide("exposure", 2.0))?;
    let bright = browser.value(HALVES)?;
    check("exposure brightens", bright[1].as_f64() > between[1].as_f64())?;
    browser.value(&slide("exposure", 0.0))?;
    browser.value("byId('curve').value = 'filmic', byId('curve').dispatchEvent(new Event('change'))")?;
    let filmic = browser.value(HALVES)?;
    check("the tone curve changes it", filmic[1] != between[1])?;
    browser.value("byId('curve').value = 'sRGB', byId('curve').dispatchEvent(new Event('change'))")?;
    equal("and back", browser.value(HALVES)?[1].clone(), between[1].clone())?;
    browser.value(&key("p"))?;
    browser.until("state.phase === 'rendering'")
}

/// The colours of the error map end where 99 % of its values do, and a legend says where that is.
fn scaled(browser: &mut Browser) -> Result<(), Failed> {
    let share = browser.value(
        "(() => { const v = [...flip.data].map(h => halfValue[h]);
        return [v.filter(v => v <= flip.scale).length / v.length, flip.scale]; })()",
    )?;
    check(&format!("{share}"), share[0].as_f64() >= Some(0.989))?;
    let bright = "Math.max(...flip.canvas.getContext('2d').getImageData(0, 0, width, height).data.filter((_, i) => i % 4 === 0))";
    // Half of the scale is in the upper half of the 99 % at least, which magma shows as 182 and more in red.
    check("it is bright", browser.value(bright)?.as_u64() >= Some(150))?;
    let legend = browser
        .value("document.querySelector('.legend').hidden || document.querySelector('.legend').textContent")?;
    equal("the legend", legend, browser.value("flip.scale < 1 ? `0${flip.scale} and more` : '01'")?)?;
    browser.value("viewer.moveTo(0)")?;
    check("only for maps", browser.value("document.querySelector('.legend').hidden")? == true)?;
    browser.value(&slide("slider", 2.0))?;
    Ok(())
}

/// Nothing is wider than the window.
fn fits(browser: &mut Browser, width: u32) -> Result<(), Failed> {
    let wide = browser.value("document.documentElement.scrollWidth")?;
    check(&format!("{wide} of {width} pixels"), wide.as_u64() <= Some(u64::from(width)))
}

/// The page's values are those of the file that it lets write.
fn pauses_and_saves(browser: &mut Browser, render: &Render) -> Result<(), Failed> {
    let passes = browser.value("state.statistics.passes")?;
    browser.until(&format!("state.statistics.passes > {passes}"))?;
    browser.value("byId('pause').click()")?;
    browser.until("state.phase === 'paused' && parts[0].number === state.snapshot.number && state.snapshot.passes === state.statistics.passes")?;
    browser.value("byId('save').click()")?;
    browser.until("state.saved.number === 1")?;
    let said = browser.value("byId('saved').textContent")?;
    check("it says where", said.as_str().is_some_and(|t| t.starts_with("wrote out.exr")))?;
    let file = picture(&render.folder.path().join("out.exr"))?;
    let shown = browser.value("Array.from(parts[0].data)")?;
    let expected: Vec<u16> = values(&file, &["R", "G", "B"])?.into_iter().map(half).collect();
    check("the file is what is shown", shown == json!(expected))?;
    // Another layer comes in a pause, too.
    browser.value("viewer.moveTo(0)")?;
    browser.value(&key("l"))?;
    browser.until("part === 1 && parts[1].data")?;
    equal(
        "its name",
        browser.value("document.querySelector('.pane span').textContent")?,
        Value::from("emission"),
    )?;
    browser.value("choose(0)")?;
    // The read-out of a pixel.
    let read = "(() => { const c = document.querySelector('.pane canvas'), r = c.getBoundingClientRect();
        viewer.refit(); viewer.moveTo(0);
        c.dispatchEvent(new PointerEvent('pointermove', { clientX: r.x + r.width / 2 + 3, clientY: r.y + r.height / 2 + 3, pointerId: 1 }));
        return byId('readout').textContent; })()";
    let text = browser.value(read)?;
    let text = text.as_str().unwrap_or_default();
    check(text, text.starts_with("pixel (48, 48)") && text.contains("picture") && text.contains("LDR-FLIP"))?;
    browser.value("byId('pause').click()")?;
    browser.until("state.phase === 'rendering'")
}

/// The curve has fallen, the render ends, and the page goes on without it.
fn stops(browser: &mut Browser) -> Result<(), Failed> {
    browser.until("state.curve.length >= 5 && state.curve.at(-1).passes >= 8 * state.curve[0].passes")?;
    let fall = browser.value("state.curve[0].rmse / state.curve.at(-1).rmse")?;
    // Errors fall as 1/√n or, with the bias of photon maps, more slowly; eight times the passes halve them at least.
    check(&format!("the curve falls by {fall}"), fall.as_f64() >= Some(2.0))?;
    check(
        "it is drawn",
        browser.value("document.querySelectorAll('#chart circle').length")?.as_u64() >= Some(10),
    )?;
    browser.value("byId('stop').click()")?;
    browser.until("state.phase === 'ended' && byId('phase').dataset.phase === 'ended'")?;
    browser.until("parts.every((layer, i) => !state.ready[i] || layer.number === state.snapshot.number)")?;
    let said = browser.value("byId('saved').textContent")?;
    equal("what was saved", said, Value::from("wrote out.exr, wrote out.checkpoint (checkpoint)"))?;
    check("no more to press", browser.value("byId('stop').disabled")? == true)?;
    equal(
        "the curve ends with the picture",
        browser.value("state.curve.at(-1).passes")?,
        browser.value("state.statistics.passes")?,
    )?;
    browser.value("choose(2), viewer.refit(), viewer.moveTo(0)")?;
    equal(
        "other layers are still there",
        browser.value("document.querySelector('.pane span').textContent")?,
        Value::from("direct"),
    )
}
