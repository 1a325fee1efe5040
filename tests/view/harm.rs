//! Viewers that behave badly.

use std::io::Read;
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use libtest_mimic::Failed;

use super::client::Client;
use super::program::{ENDLESS, Render, unseen};
use super::{check, equal};

/// A layer of this size, 7 MB, is more than the buffers of a connection that nobody reads from hold.
pub const LARGE: &[&str] =
    &["--size", "1200x1000", "--integrator", "path", "--max-depth", "2", "--passes", "5"];

/// Asks for a layer and never reads it.
fn never_reads(client: &Client) -> Result<TcpStream, Failed> {
    let path = format!("/{}/tiles?layer=0", client.token);
    client.send("GET", &path, &format!("Host: {}\r\n", client.host))
}

/// Reads a little now and then.
fn slow(mut stream: TcpStream, over: &AtomicBool) {
    let mut piece = [0; 1000];
    while !over.load(Ordering::Acquire) && matches!(stream.read(&mut piece), Ok(n) if n > 0) {
        std::thread::sleep(Duration::from_millis(50));
    }
}

pub fn clients() -> Result<(), Failed> {
    let alone = unseen(&[LARGE])?;
    let (render, client) = Render::viewed(&[LARGE])?;
    let over = AtomicBool::new(false);
    let ended = std::thread::scope(|scope| -> Result<_, Failed> {
        client.until("a pass", |state| state["snapshot"].is_object())?;
        let deaf = (0..10).map(|_| never_reads(&client)).collect::<Result<Vec<_>, _>>()?;
        let dripping = never_reads(&client)?;
        scope.spawn(|| slow(dripping, &over));
        // One that says nothing, one that hangs up in the middle.
        let silent = TcpStream::connect(&client.host)?;
        drop(never_reads(&client)?);
        // Two good ones see the end.
        let other = client.second();
        let looks = scope.spawn(move || -> Result<_, Failed> {
            let state = other.until("the end", |state| state["phase"] == "ended")?;
            let tiles = other.tiles("tiles?layer=0")?.ok_or("no tiles")?;
            other.bye()?;
            Ok((state["snapshot"]["passes"].clone(), tiles.values))
        });
        let state = client.until("the end", |state| state["phase"] == "ended")?;
        let tiles = client.tiles("tiles?layer=0")?.ok_or("no tiles")?;
        client.bye()?;
        let second = looks.join().map_err(|_| "the second page failed")??;
        equal("both see the last pass", &second.0, &state["snapshot"]["passes"])?;
        check("both see the same picture", second.1 == tiles.values)?;
        // The program ends although some still have not read.
        let ended = render.wait();
        over.store(true, Ordering::Release);
        drop((deaf, silent));
        ended
    })?;
    equal("status", ended.status, Some(0))?;
    check("same bytes as without viewers", ended.bytes()? == alone)
}

/// The program's own account of what viewing costs. (That it is right is measured in docs/live-view.md.)
pub fn share() -> Result<(), Failed> {
    let size: &[&str] = &["--size", "256x256", "--integrator", "path"];
    let (_render, client) = Render::viewed(&[size, ENDLESS])?;
    let mut version = None;
    let mut pictures = 0;
    let mut shown = 0;
    let (mut news, mut known) = (0, 0);
    while pictures < 5 || news == 0 {
        let (state, asked) = (client.state(version)?, version);
        version = state["version"].as_u64();
        let number = state["snapshot"]["number"].as_u64().unwrap_or(0);
        // Pages hear of passes that they get no picture of.
        let done = state["statistics"]["passes"].as_u64().unwrap_or(0);
        news += u64::from(number == shown && shown > 0 && done > known && asked != version);
        known = done;
        if number > shown {
            (shown, pictures) = (number, pictures + 1);
            client.tiles("tiles?layer=0")?.ok_or("no tiles")?;
        }
        let (load, passes) =
            (state["load"].as_f64().ok_or("no load")?, state["statistics"]["passes"].as_u64());
        // Before, sending the page itself may be more.
        check(&format!("{load} of the render"), load <= 0.02 || passes < Some(20))?;
    }
    Ok(())
}
