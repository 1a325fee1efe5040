//! Shows the render in a viewer that speaks tev's protocol, from a thread of its own: one that is absent or hangs
//! harms nothing.

mod packet;

use std::io::{self, Write};
use std::net::{IpAddr, TcpStream, ToSocketAddrs};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::Error;
use super::account::Meter;
use super::live::{Phase, Shared};
use super::snapshot::{Snapshot, Tile};

/// In which a viewer has to accept a connection.
const CONNECT: Duration = Duration::from_secs(2);

/// In which it has to take a piece of a packet.
const PIECE: Duration = Duration::from_secs(3);

/// After which one that could not be reached is tried again.
const AGAIN: Duration = Duration::from_secs(10);

/// Numbers of a layer that the viewer gets.
const CHANNELS: usize = 3;

/// What is shown, and where.
#[derive(Debug)]
pub struct Display {
    /// Host and port.
    pub address: String,
    /// Of the image.
    pub name: String,
    pub size: [usize; 2],
    /// Shown beside it, where the viewer is on this machine.
    pub reference: Option<PathBuf>,
    pub shared: Arc<Shared>,
    /// Says what is wrong, once for failures in a row.
    pub warn: fn(&str),
}

impl Display {
    /// Begins to show the render.
    ///
    /// # Errors
    /// When no thread can be started.
    pub fn start(self) -> Result<(), Error> {
        // Counts as a viewer until it is known that there is none, so that a short render does not end before.
        self.shared.lock().display = true;
        let thread = std::thread::Builder::new().name("display".to_owned());
        thread.spawn(move || self.run()).map(drop).map_err(|e| Error::Thread(e.to_string()))
    }

    /// Until the render has ended: connects, sends, and does so again after a failure.
    fn run(&self) {
        let mut warned = false;
        loop {
            let problem = match self.connect() {
                Ok(stream) => {
                    self.shared.lock().display = true;
                    warned = false;
                    self.feed(stream).err()
                }
                Err(problem) => Some(problem),
            };
            self.shared.tell(|live| live.display = false);
            let Some(problem) = problem else { return };
            if !warned {
                (self.warn)(&format!("warning: --display {}: {problem}; rendering goes on", self.address));
                warned = true;
            }
            let retry = Instant::now() + AGAIN;
            while Instant::now() < retry {
                if self.ended() {
                    return;
                }
                std::thread::sleep(Duration::from_millis(100));
            }
        }
    }

    fn ended(&self) -> bool {
        self.shared.lock().phase == Phase::Ended
    }

    fn connect(&self) -> io::Result<TcpStream> {
        let mut problem = io::Error::new(io::ErrorKind::NotFound, "there is no such host");
        for address in self.address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&address, CONNECT) {
                Ok(stream) => {
                    stream.set_write_timeout(Some(PIECE))?;
                    return Ok(stream);
                }
                Err(e) => problem = e,
            }
        }
        Err(problem)
    }

    /// Sends snapshots until the render has ended.
    fn feed(&self, mut stream: TcpStream) -> io::Result<()> {
        if let Some(path) = self.reference.as_ref().filter(|_| here(&stream)) {
            stream.write_all(&packet::open_image(&path.display().to_string()))?;
        }
        let names: Vec<String> = self.channels(0).into_iter().map(|(name, ..)| name).collect();
        stream.write_all(&packet::create_image(&self.name, self.size, &names))?;
        let mut sent = 0;
        loop {
            let live = self.shared.lock();
            let number = |snapshot: Option<&Arc<Snapshot>>| snapshot.map_or(0, |s| s.number);
            let (live, _) = self.shared.wait(live, Duration::from_secs(1), |live| {
                number(live.snapshot.as_ref()) > sent || live.phase == Phase::Ended
            });
            let (phase, snapshot) = (live.phase, live.snapshot.clone());
            drop(live);
            if let Some(snapshot) = snapshot.filter(|s| s.number > sent) {
                let meter = Meter::start();
                for tile in &snapshot.tiles {
                    stream.write_all(&self.tile(tile))?;
                }
                sent = snapshot.number;
                if phase == Phase::Rendering {
                    self.shared.pictures.pay(meter.elapsed());
                }
            }
            if phase == Phase::Ended {
                return stream.shutdown(std::net::Shutdown::Write);
            }
        }
    }

    /// The channels of the picture and of its parts, with the place of the first number and the distance to
    /// the next in the data of a tile of so many pixels.
    fn channels(&self, pixels: usize) -> Vec<(String, usize, usize)> {
        let light = self.shared.layers.iter().filter(|layer| layer.is_light());
        let mut all = Vec::new();
        for (l, layer) in light.enumerate() {
            for (c, channel) in layer.channels.iter().take(CHANNELS).enumerate() {
                let name = if l == 0 { (*channel).to_owned() } else { format!("{}.{channel}", layer.name) };
                all.push((name, l * pixels * CHANNELS + c, CHANNELS));
            }
        }
        all
    }

    fn tile(&self, tile: &Tile) -> Vec<u8> {
        let width = self.size[0];
        let light = self.shared.layers.iter().zip(&tile.layers).filter(|(layer, _)| layer.is_light());
        let numbers = light.filter_map(|(layer, numbers)| Some((layer.channels.len(), numbers.as_ref()?)));
        let data: Vec<f32> = numbers
            .flat_map(|(channels, numbers)| numbers.chunks_exact(channels).flat_map(|p| &p[..CHANNELS]))
            .copied()
            .collect();
        let place = [0, tile.top, width, tile.rows];
        packet::update_image(&self.name, &self.channels(width * tile.rows), place, &data)
    }
}

/// Whether the viewer is on this machine.
fn here(stream: &TcpStream) -> bool {
    stream.peer_addr().is_ok_and(|peer| match peer.ip() {
        IpAddr::V4(ip) => ip.is_loopback(),
        IpAddr::V6(ip) => ip.is_loopback(),
    })
}
