//! A viewer that speaks tev's protocol, and takes nothing for granted.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Read};
use std::net::{TcpListener, TcpStream};

use libtest_mimic::Failed;

use super::harm::LARGE;
use super::program::{Render, SCENE, picture, unseen, values};
use super::{check, equal};

/// What tev would show.
#[derive(Debug, Default)]
struct Image {
    name: String,
    size: [usize; 2],
    /// By name: the values, row by row.
    channels: BTreeMap<String, Vec<Option<f32>>>,
    updates: usize,
    opened: Vec<String>,
}

/// The rest of a packet.
struct Rest<'a>(&'a [u8]);

impl Rest<'_> {
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Failed> {
        let (head, rest) = self.0.split_at_checked(N).ok_or("a packet is too short")?;
        self.0 = rest;
        Ok(head.try_into()?)
    }

    fn truth(&mut self) -> Result<bool, Failed> {
        match self.bytes()? {
            [0] => Ok(false),
            [1] => Ok(true),
            [b] => Err(format!("a truth value of {b}").into()),
        }
    }

    fn int(&mut self) -> Result<usize, Failed> {
        Ok(usize::try_from(i32::from_le_bytes(self.bytes()?))?)
    }

    fn longs(&mut self, count: usize) -> Result<Vec<usize>, Failed> {
        (0..count).map(|_| Ok(usize::try_from(i64::from_le_bytes(self.bytes()?))?)).collect()
    }

    fn text(&mut self) -> Result<String, Failed> {
        let end = self.0.iter().position(|b| *b == 0).ok_or("a text without an end")?;
        let text = String::from_utf8(self.0[..end].to_vec())?;
        self.0 = &self.0[end + 1..];
        Ok(text)
    }

    fn texts(&mut self, count: usize) -> Result<Vec<String>, Failed> {
        (0..count).map(|_| self.text()).collect()
    }
}

impl Image {
    fn take(&mut self, packet: &[u8]) -> Result<(), Failed> {
        let mut rest = Rest(packet);
        let [kind] = rest.bytes()?;
        let _focus = rest.truth()?;
        let name = rest.text()?;
        match kind {
            4 => {
                check("the image is made once", self.channels.is_empty())?;
                self.name = name;
                self.size = [rest.int()?, rest.int()?];
                let count = rest.int()?;
                let pixels = self.size[0] * self.size[1];
                let names = rest.texts(count)?.into_iter();
                self.channels = names.map(|channel| (channel, vec![None; pixels])).collect();
                equal("channels have different names", self.channels.len(), count)?;
            }
            6 => self.update(&name, &mut rest)?,
            7 => {
                self.opened.push(name);
                equal("all channels", rest.text()?, String::new())?;
            }
            _ => return Err(format!("a packet of type {kind}").into()),
        }
        equal("bytes left over", rest.0.len(), 0)
    }

    fn update(&mut self, name: &str, rest: &mut Rest<'_>) -> Result<(), Failed> {
        equal("of the image that was made", name, self.name.as_str())?;
        let count = rest.int()?;
        let channels = rest.texts(count)?;
        let [x, y, w, h] = [rest.int()?, rest.int()?, rest.int()?, rest.int()?];
        let (firsts, strides) = (rest.longs(count)?, rest.longs(count)?);
        check("within the image", x + w <= self.size[0] && y + h <= self.size[1] && w * h > 0)?;
        // tev takes all channels out of one list, which is as long as the last of their values asks for.
        let last = |c: usize| firsts[c] + (w * h - 1) * strides[c] + 1;
        let length = (0..count).map(last).max().ok_or("no channels")?;
        equal("numbers of the rectangle", rest.0.len(), 4 * length)?;
        let value = |i: usize| f32::from_le_bytes(rest.0[4 * i..4 * i + 4].try_into().unwrap());
        for (c, channel) in channels.iter().enumerate() {
            let all = self.channels.get_mut(channel).ok_or_else(|| format!("no channel {channel}"))?;
            for i in 0..w * h {
                all[(y + i / w) * self.size[0] + x + i % w] = Some(value(firsts[c] + i * strides[c]));
            }
        }
        rest.0 = &[];
        self.updates += 1;
        Ok(())
    }
}

/// Takes packets until the connection is closed between two of them.
fn listen(listener: &TcpListener) -> Result<Image, Failed> {
    let (mut stream, _) = listener.accept()?;
    let mut image = Image::default();
    loop {
        let mut length = [0; 4];
        match stream.read_exact(&mut length) {
            Err(e) if e.kind() == ErrorKind::UnexpectedEof => return Ok(image),
            read => read?,
        }
        // The length counts itself.
        let length = u32::from_le_bytes(length) as usize;
        check("a length", (6..1 << 24).contains(&length))?;
        let mut packet = vec![0; length - 4];
        stream.read_exact(&mut packet)?;
        image.take(&packet)?;
    }
}

pub fn packets() -> Result<(), Failed> {
    let listener = TcpListener::bind("127.0.0.1:0")?;
    let address = listener.local_addr()?.to_string();
    let viewer = std::thread::spawn(move || listen(&listener));
    let small: &[&str] = &["--size", "160x130", "--integrator", "path", "--passes", "6"];
    let reference = Render::start(SCENE, &[small, &["--seed", "7"]])?.wait()?;
    let path = reference.file("out.exr").canonicalize()?.display().to_string();
    let render = Render::start(SCENE, &[small, &["--display", &address, "--reference", &path]])?;
    let ended = render.wait()?;
    equal("status", ended.status, Some(0))?;
    let image = viewer.join().map_err(|_| "the viewer failed")??;
    equal("name", image.name.as_str(), "cornell-diffuse (caustica)")?;
    equal("size", image.size, [160, 130])?;
    equal("the reference is opened", image.opened, vec![path])?;
    check("tiles", image.updates >= 2)?;
    let names: Vec<&str> = image.channels.keys().map(String::as_str).collect();
    let file = picture(&ended.file("out.exr"))?;
    check(
        "the picture and its parts",
        ["R", "G", "B", "direct.R", "indirect.B", "caustic.G"].iter().all(|n| names.contains(n)),
    )?;
    for (name, shown) in &image.channels {
        let shown: Option<Vec<f32>> = shown.iter().copied().collect();
        let shown = shown.ok_or_else(|| format!("{name}: a pixel was never sent"))?;
        check(&format!("{name}: the last values are those of the file"), shown == values(&file, &[name])?)?;
    }
    Ok(())
}

pub fn absent() -> Result<(), Failed> {
    let alone = unseen(&[LARGE])?;
    // A port that was just free, where nobody listens.
    let free = TcpListener::bind("127.0.0.1:0")?.local_addr()?.to_string();
    let ended = Render::start(SCENE, &[LARGE, &["--display", &free]])?.wait()?;
    equal("status", ended.status, Some(0))?;
    let lines: Vec<&str> = ended.said.lines().filter(|line| line.starts_with("warning: --display")).collect();
    check(
        &format!("one warning: {}", ended.said),
        lines.len() == 1 && lines[0].ends_with("; rendering goes on"),
    )?;
    check("same bytes", ended.bytes()? == alone)?;
    // One that accepts and never reads.
    let listener = TcpListener::bind("127.0.0.1:0")?;
    let address = listener.local_addr()?.to_string();
    let held = std::thread::spawn(move || -> Result<TcpStream, Failed> { Ok(listener.accept()?.0) });
    let ended = Render::start(SCENE, &[LARGE, &["--display", &address]])?.wait()?;
    equal("status", ended.status, Some(0))?;
    check("same bytes", ended.bytes()? == alone)?;
    drop(held.join());
    Ok(())
}
