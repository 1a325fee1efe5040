//! What the page does, without a browser.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use half::f16;
use libtest_mimic::Failed;
use serde_json::Value;

use super::check;

/// In which everything that is waited for has to happen.
const LIMIT: Duration = Duration::from_secs(240);

/// An answer.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

/// A page that is open.
#[derive(Clone, Debug)]
pub struct Client {
    /// Host and port.
    pub host: String,
    pub token: String,
    id: u64,
}

/// A layer as the page has it.
#[derive(Debug)]
pub struct Tiles {
    pub number: u32,
    pub size: [usize; 2],
    pub channels: usize,
    /// Half floats as bits, pixel by pixel.
    pub values: Vec<u16>,
    pub count: usize,
}

impl Client {
    pub fn of(address: &str) -> Result<Self, Failed> {
        let (host, token) = address
            .strip_prefix("http://")
            .and_then(|rest| rest.strip_suffix('/'))
            .and_then(|rest| rest.split_once('/'))
            .ok_or_else(|| format!("no address: {address}"))?;
        let id = u64::from(token.bytes().fold(0_u32, |id, b| id.wrapping_mul(31).wrapping_add(u32::from(b))));
        Ok(Self { host: host.to_owned(), token: token.to_owned(), id })
    }

    /// Another page of the same render.
    pub fn second(&self) -> Self {
        Self { id: self.id + 1, ..self.clone() }
    }

    /// Sends a request without waiting for the answer.
    pub fn send(&self, method: &str, path: &str, headers: &str) -> Result<TcpStream, Failed> {
        let mut stream = TcpStream::connect(&self.host)?;
        stream.set_read_timeout(Some(LIMIT))?;
        write!(stream, "{method} {path} HTTP/1.1\r\n{headers}\r\n")?;
        Ok(stream)
    }

    /// Any request, with the headers given.
    pub fn ask(&self, method: &str, path: &str, headers: &str) -> Result<Answer, Failed> {
        let mut bytes = Vec::new();
        self.send(method, path, headers)?.read_to_end(&mut bytes)?;
        let end = bytes.windows(4).position(|w| w == b"\r\n\r\n").ok_or("an answer without a head")?;
        let head = String::from_utf8(bytes[..end].to_vec())?;
        let status = head.split(' ').nth(1).and_then(|s| s.parse().ok()).ok_or("no status")?;
        Ok(Answer { status, head, body: bytes[end + 4..].to_vec() })
    }

    fn own(&self, method: &str, what: &str) -> Result<Answer, Failed> {
        let path = format!("/{}/{what}", self.token);
        self.ask(method, &path, &format!("Host: {}\r\n", self.host))
    }

    pub fn get(&self, what: &str) -> Result<Answer, Failed> {
        self.own("GET", what)
    }

    pub fn post(&self, what: &str) -> Result<(), Failed> {
        check(what, self.own("POST", what)?.status == 204)
    }

    /// The state; after `version` once it is another one.
    pub fn state(&self, version: Option<u64>) -> Result<Value, Failed> {
        let after = version.map_or_else(String::new, |v| format!("&after={v}"));
        let answer = self.get(&format!("state?client={}{after}", self.id))?;
        check("the state", answer.status == 200)?;
        Ok(serde_json::from_slice(&answer.body)?)
    }

    /// Looks until `seen` holds.
    pub fn until(&self, what: &str, seen: impl Fn(&Value) -> bool) -> Result<Value, Failed> {
        let begun = Instant::now();
        let mut state = self.state(None)?;
        while !seen(&state) {
            check(&format!("waited too long for: {what}; {state}"), begun.elapsed() < LIMIT)?;
            state = self.state(state["version"].as_u64())?;
        }
        Ok(state)
    }

    /// Goes, with all that it wanted.
    pub fn bye(&self) -> Result<(), Failed> {
        self.post(&format!("bye?client={}", self.id))
    }

    /// A layer, if the newest snapshot has it.
    pub fn tiles(&self, what: &str) -> Result<Option<Tiles>, Failed> {
        let answer = self.get(what)?;
        match answer.status {
            204 => Ok(None),
            200 => Ok(Some(decode(&answer.body)?)),
            status => Err(format!("{what}: {status}").into()),
        }
    }
}

fn decode(body: &[u8]) -> Result<Tiles, Failed> {
    let four = |at: usize| -> Result<[usize; 4], Failed> {
        let bytes = body.get(at..at + 16).ok_or("the tiles break off")?;
        let number = |i: usize| u32::from_le_bytes(bytes[4 * i..4 * i + 4].try_into().unwrap()) as usize;
        Ok([0, 1, 2, 3].map(number))
    };
    let [number, width, height, channels] = four(0)?;
    let mut values = vec![None; width * height * channels];
    let (mut at, mut count) = (16, 0);
    while at < body.len() {
        let [x, y, w, h] = four(at)?;
        at += 16;
        for row in y..y + h {
            for i in (row * width + x) * channels..(row * width + x + w) * channels {
                let bytes = body.get(at..at + 2).ok_or("a tile breaks off")?;
                let twice = values
                    .get_mut(i)
                    .ok_or("a tile is outside")?
                    .replace(u16::from_le_bytes([bytes[0], bytes[1]]));
                check("no value comes twice", twice.is_none())?;
                at += 2;
            }
        }
        count += 1;
    }
    let values: Option<Vec<u16>> = values.into_iter().collect();
    let values = values.ok_or("a pixel is in no tile")?;
    Ok(Tiles { number: number as u32, size: [width, height], channels, values, count })
}

/// The bits that the page gets for a value.
pub fn half(value: f32) -> u16 {
    let limit = f16::MAX.to_f32();
    f16::from_f32(value.clamp(-limit, limit)).to_bits()
}

/// The layer of this name.
pub fn index(client: &Client, name: &str) -> Result<usize, Failed> {
    let page = String::from_utf8(client.get("")?.body)?;
    let info = page.split_once("id=\"info\">").and_then(|(_, rest)| rest.split_once("</script>"));
    let info: Value = serde_json::from_str(info.ok_or("no info")?.0)?;
    let layers = info["layers"].as_array().ok_or("no layers")?;
    Ok(layers.iter().position(|layer| layer == name).ok_or_else(|| format!("no layer {name}"))?)
}
