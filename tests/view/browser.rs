//! Chromium, driven by its DevTools protocol over two pipes: JSON messages that end with a zero byte.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use libtest_mimic::Failed;
use serde_json::{Value, json};

use super::check;

const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "chrome"];

/// In which every answer has to come.
const LIMIT: Duration = Duration::from_secs(240);

pub fn find() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let folders: Vec<PathBuf> = std::env::split_paths(&path).collect();
    BROWSERS.iter().flat_map(|b| folders.iter().map(move |f| f.join(b))).find(|p| p.is_file())
}

/// A browser with one page.
pub struct Browser {
    child: Child,
    to: File,
    from: Receiver<Value>,
    /// Of the last message sent.
    id: u64,
    session: Option<String>,
    /// What went wrong on the page.
    pub complaints: Vec<String>,
    _folder: tempfile::TempDir,
}

impl Browser {
    pub fn start(program: &Path) -> Result<Self, Failed> {
        let folder = tempfile::tempdir()?;
        let [to, from] = ["to", "from"].map(|name| folder.path().join(name));
        check("pipes", Command::new("mkfifo").args([&to, &from]).status()?.success())?;
        // Chromium reads messages from file 3 and writes them to file 4.
        let child = Command::new("sh")
            .args(["-c", "to=$1 from=$2; shift 2; exec \"$@\" 3<\"$to\" 4>\"$from\"", "sh"])
            .args([&to, &from])
            .arg(program)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe"])
            .arg(format!("--user-data-dir={}", folder.path().join("profile").display()))
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()?;
        let to = File::options().write(true).open(to)?;
        let reader = BufReader::new(File::open(from)?);
        let (sender, from) = channel();
        std::thread::spawn(move || {
            for message in reader.split(0).map_while(Result::ok) {
                let Ok(message) = serde_json::from_slice(&message) else { return };
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        let mut browser =
            Self { child, to, from, id: 0, session: None, complaints: Vec::new(), _folder: folder };
        let target =
            browser.call("Target.createTarget", json!({ "url": "about:blank" }))?["targetId"].clone();
        let attached =
            browser.call("Target.attachToTarget", json!({ "targetId": target, "flatten": true }))?;
        browser.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.call(domain, json!({}))?;
        }
        Ok(browser)
    }

    /// Calls a method of the protocol.
    pub fn call(&mut self, method: &str, parameters: Value) -> Result<Value, Failed> {
        self.id += 1;
        let mut message = json!({ "id": self.id, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = session.as_str().into();
        }
        self.to.write_all(message.to_string().as_bytes())?;
        self.to.write_all(&[0])?;
        let begun = Instant::now();
        loop {
            let left = LIMIT.saturating_sub(begun.elapsed());
            let answer = self.from.recv_timeout(left).map_err(|e| format!("{method}: {e}"))?;
            if answer["id"] == self.id {
                check(&format!("{method}: {}", answer["error"]), answer["error"].is_null())?;
                return Ok(answer["result"].clone());
            }
            let event = answer["method"].as_str().unwrap_or_default();
            // Warnings are about the test, which reads the canvas.
            let error = event == "Log.entryAdded" && answer["params"]["entry"]["level"] == "error";
            if error || event == "Runtime.exceptionThrown" {
                self.complaints.push(answer["params"].to_string());
            }
        }
    }

    /// The value of an expression on the page, of a promise when it is kept.
    pub fn value(&mut self, expression: &str) -> Result<Value, Failed> {
        let asked = json!({ "expression": expression, "awaitPromise": true, "returnByValue": true });
        let answer = self.call("Runtime.evaluate", asked)?;
        check(&format!("{expression}: {answer}"), answer["exceptionDetails"].is_null())?;
        Ok(answer["result"]["value"].clone())
    }

    /// Waits until an expression is true.
    pub fn until(&mut self, expression: &str) -> Result<(), Failed> {
        let begun = Instant::now();
        while self.value(&format!("Boolean({expression})"))? != true {
            let state =
                if begun.elapsed() < LIMIT { Value::Null } else { self.value("JSON.stringify(state)")? };
            check(&format!("waited too long for: {expression}; {state}"), begun.elapsed() < LIMIT)?;
            std::thread::sleep(Duration::from_millis(30));
        }
        Ok(())
    }

    /// The size of the window, and what the system's settings say of colours.
    pub fn look(&mut self, width: u32, height: u32, scheme: &str) -> Result<(), Failed> {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", size)?;
        let features = json!([{ "name": "prefers-color-scheme", "value": scheme }]);
        self.call("Emulation.setEmulatedMedia", json!({ "features": features }))?;
        Ok(())
    }

    /// The window as PNG.
    pub fn screenshot(&mut self, file: &Path) -> Result<(), Failed> {
        let shot = self.call("Page.captureScreenshot", json!({ "format": "png" }))?;
        let bytes = base64(shot["data"].as_str().ok_or("no screenshot")?).ok_or("no base64")?;
        Ok(std::fs::write(file, bytes)?)
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ended = self.child.kill();
        let _reaped = self.child.wait();
    }
}

fn base64(text: &str) -> Option<Vec<u8>> {
    let digit = |c: u8| match c {
        b'A'..=b'Z' => Some(c - b'A'),
        b'a'..=b'z' => Some(c - b'a' + 26),
        b'0'..=b'9' => Some(c - b'0' + 52),
        b'+' => Some(62),
        b'/' => Some(63),
        _ => None,
    };
    let mut out = Vec::new();
    for four in text.trim_end_matches('=').as_bytes().chunks(4) {
        let bits = four.iter().try_fold(0_u32, |bits, c| Some(bits << 6 | u32::from(digit(*c)?)))?;
        let bits = bits << (6 * (4 - four.len()));
        out.extend(&bits.to_be_bytes()[1..four.len()]);
    }
    Some(out)
}
