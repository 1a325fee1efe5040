//! Takes connections, each in a thread of its own and not too many.

use std::io;
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use super::account::Meter;
use super::http::{self, Response};
use super::routes::Routes;

/// Connections at once. Further ones are closed.
const MOST: usize = 48;

/// Processor time of accepting a connection and of starting and ending its thread, about, which no thread sees.
const THREAD: Duration = Duration::from_micros(100);

/// Serves until it is dropped.
#[derive(Debug)]
pub struct Server {
    address: String,
    /// Where it listens.
    bound: SocketAddr,
    closing: Arc<AtomicBool>,
}

impl Server {
    /// Listens on `bind`; `routes` answers what comes to the address that was bound.
    ///
    /// # Errors
    /// When the address cannot be bound, or no thread can be started.
    pub fn start(bind: SocketAddr, routes: impl FnOnce(SocketAddr) -> Routes) -> io::Result<Self> {
        let listener = TcpListener::bind(bind)?;
        let bound = listener.local_addr()?;
        let routes = Arc::new(routes(bound));
        let address = routes.gate.address();
        let closing = Arc::new(AtomicBool::new(false));
        let closes = Arc::clone(&closing);
        let accept = move || accept(&listener, &routes, &closes);
        std::thread::Builder::new().name("view".to_owned()).spawn(accept)?;
        Ok(Self { address, bound, closing })
    }

    /// Of the page, with its token.
    pub fn address(&self) -> &str {
        &self.address
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.closing.store(true, Ordering::Release);
        // Wakes the thread that accepts.
        let _refused = TcpStream::connect_timeout(&self.bound, Duration::from_millis(200));
    }
}

fn accept(listener: &TcpListener, routes: &Arc<Routes>, closing: &AtomicBool) {
    let open = Arc::new(AtomicUsize::new(0));
    for stream in listener.incoming() {
        if closing.load(Ordering::Acquire) {
            return;
        }
        let Ok(stream) = stream else {
            // Such as too many open files: it may pass.
            std::thread::sleep(Duration::from_millis(50));
            continue;
        };
        if open.fetch_add(1, Ordering::AcqRel) >= MOST {
            open.fetch_sub(1, Ordering::AcqRel);
            continue;
        }
        let (routes, theirs) = (Arc::clone(routes), Arc::clone(&open));
        let serve = move || {
            let meter = Meter::start();
            serve(stream, &routes);
            routes.pay(THREAD + meter.elapsed());
            theirs.fetch_sub(1, Ordering::AcqRel);
        };
        if std::thread::Builder::new().name("view page".to_owned()).spawn(serve).is_err() {
            open.fetch_sub(1, Ordering::AcqRel);
        }
    }
}

/// One request and its answer. What a page does not take is lost to that page only.
fn serve(mut stream: TcpStream, routes: &Routes) {
    let _slower = stream.set_nodelay(true);
    let sent = match http::read(&mut stream) {
        Ok(Some(request)) => routes.answer(&request, &mut stream),
        Ok(None) => return,
        Err(status) => Response::status(status).write(&mut stream),
    };
    if sent.is_ok() {
        let _closed = stream.shutdown(Shutdown::Write);
    }
}
