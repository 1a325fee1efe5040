//! What the page asks for.

use std::io;
use std::net::{SocketAddr, TcpStream};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use serde_json::{Value, json};

use super::EARLY;
use super::gate::Gate;
use super::http::{Method, Request, Response};
use super::live::{Live, Phase, Shared};

/// How long a request for news waits for them.
const PATIENCE: Duration = Duration::from_secs(10);

/// How long tiles wait at most for their share of the processor.
const PUT_OFF: Duration = Duration::from_secs(2);

/// Answers requests.
#[derive(Debug)]
pub struct Routes {
    pub gate: Gate,
    page: String,
    /// In the form for the page.
    reference: Option<Arc<Vec<u8>>>,
    shared: Arc<Shared>,
}

impl Routes {
    pub fn new(
        bound: SocketAddr,
        page: String,
        reference: Option<Arc<Vec<u8>>>,
        shared: Arc<Shared>,
    ) -> Self {
        Self { gate: Gate::new(bound), page, reference, shared }
    }

    /// Answers a request.
    ///
    /// # Errors
    /// When the answer was not taken.
    pub fn answer(&self, request: &Request, stream: &mut TcpStream) -> io::Result<()> {
        let Some(what) = self.gate.admit(request) else {
            return Response::status(403).write(stream);
        };
        let sent = self.respond(request, what).write(stream);
        if (request.method, what) == (Method::Post, "bye") {
            // After the answer, since the program may be waiting for nothing else.
            let id = request.number("client").unwrap_or_default();
            self.shared.tell(|live| live.part(id));
        }
        sent
    }

    /// Pays for a connection. What viewers cost while the render waits is not taken from it.
    pub fn pay(&self, cost: Duration) {
        if self.shared.lock().phase == Phase::Rendering {
            self.shared.pictures.pay(cost);
        }
    }

    fn respond(&self, request: &Request, what: &str) -> Response {
        match (request.method, what) {
            (Method::Get, "") => Response::html(&self.page),
            (Method::Get, "state") => self.news(request),
            (Method::Get, "tiles") => self.tiles(request),
            (Method::Get, "reference") => match &self.reference {
                Some(reference) => Response::bytes(Arc::clone(reference)),
                None => Response::status(404),
            },
            (Method::Get, "flip") => match &self.shared.lock().flip {
                Some((_, map)) => Response::bytes(Arc::clone(map)),
                None => Response::status(204),
            },
            (Method::Post, _) => self.act(what),
            _ => Response::status(404),
        }
    }

    /// A layer of the newest snapshot, or 204 and the layer in the next one.
    fn tiles(&self, request: &Request) -> Response {
        let layer = request.number("layer").and_then(|n| usize::try_from(n).ok());
        let Some((layer, shown)) = layer.and_then(|n| Some((n, self.shared.layers.get(n)?))) else {
            return Response::status(404);
        };
        self.put_off();
        let snapshot = {
            let mut live = self.shared.lock();
            if let Some(wanted) = live.wanted.get_mut(layer) {
                *wanted = true;
            }
            live.snapshot.clone()
        };
        let coded = snapshot.and_then(|snapshot| snapshot.coded(layer, shown.channels.len()));
        coded.map_or_else(|| Response::status(204), Response::bytes)
    }

    /// Waits while viewers have taken more than their share.
    fn put_off(&self) {
        if self.shared.lock().phase != Phase::Rendering {
            return;
        }
        let Shared { work, pictures, .. } = &*self.shared;
        let debt = work.wall(pictures.debt(work.elapsed(), EARLY)).min(PUT_OFF);
        std::thread::sleep(debt);
    }

    fn act(&self, what: &str) -> Response {
        match what {
            "pause" => self.shared.tell(|live| live.wishes.pause = true),
            "resume" => self.shared.tell(|live| live.wishes.pause = false),
            "save" => self.shared.tell(|live| live.wishes.save = true),
            "stop" => self.shared.tell(|live| {
                live.wishes.stop = true;
                self.shared.interrupt.store(true, Ordering::Release);
            }),
            "bye" => {}
            _ => return Response::status(404),
        }
        Response::status(204)
    }

    /// The state of the render, once it is another one than the page knows.
    fn news(&self, request: &Request) -> Response {
        let (known, id) = (request.number("after"), request.number("client").unwrap_or_default());
        let mut live = self.shared.lock();
        live.meet(id, true);
        let newer = |live: &Live| known.is_none_or(|known| live.version != known);
        let (mut live, _) = self.shared.wait(live, PATIENCE, newer);
        live.meet(id, false);
        let state = self.state(&live);
        drop(live);
        Response::json(&state)
    }

    fn state(&self, live: &Live) -> Value {
        let snapshot = live.snapshot.as_ref();
        let work = self.shared.work.elapsed().as_secs_f64();
        json!({
            "version": live.version,
            "phase": live.phase,
            "reason": live.reason,
            "pausing": live.wishes.pause,
            "stopping": live.wishes.stop,
            "saving": live.wishes.save,
            "snapshot": snapshot.map(|s| json!({ "number": s.number, "passes": s.passes, "seconds": s.seconds })),
            "ready": (0..self.shared.layers.len())
                .map(|layer| snapshot.is_some_and(|s| s.has(layer)))
                .collect::<Vec<_>>(),
            "statistics": live.statistics,
            "seconds": live.elapsed().as_secs_f64(),
            "error": live.error.filter(|(error, _)| error.is_finite()),
            "curve": live.curve,
            "flip": live.flip.as_ref().map(|(number, _)| number),
            "saved": { "number": live.saved.0, "text": live.saved.1 },
            "load": if work > 0.0 { self.shared.spent().as_secs_f64() / work } else { 0.0 },
        })
    }
}
