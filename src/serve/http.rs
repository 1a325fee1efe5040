//! As much of HTTP/1.1 as a page needs: one request and one response a connection, both within a time.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Of the head of a request.
const MOST_BYTES: usize = 8192;
const MOST_HEADERS: usize = 64;

/// In which a request has to arrive.
const HEAD: Duration = Duration::from_secs(5);

/// In which some of a response has to be taken, and all of it.
const PIECE: Duration = Duration::from_secs(5);
const WHOLE: Duration = Duration::from_secs(60);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    Get,
    Post,
}

/// What was asked for.
#[derive(Debug)]
pub struct Request {
    pub method: Method,
    /// Begins with `/`; without the query.
    pub path: String,
    /// After the `?`.
    pub query: String,
    pub host: Option<String>,
    pub origin: Option<String>,
}

impl Request {
    /// The whole number of this name in the query.
    pub fn number(&self, name: &str) -> Option<u64> {
        let pairs = self.query.split('&').filter_map(|pair| pair.split_once('='));
        pairs.filter(|(n, _)| *n == name).find_map(|(_, value)| value.parse().ok())
    }
}

/// Reads a request; `None` when it did not arrive, else the status of a refusal.
///
/// # Errors
/// The status that says what is wrong.
pub fn read(stream: &mut TcpStream) -> Result<Option<Request>, u16> {
    let begun = Instant::now();
    let mut bytes = Vec::new();
    loop {
        if let Some(request) = parse(&bytes)? {
            return Ok(Some(request));
        }
        let left = HEAD.saturating_sub(begun.elapsed());
        if left.is_zero() || stream.set_read_timeout(Some(left)).is_err() {
            return Ok(None);
        }
        let mut piece = [0; 2048];
        match stream.read(&mut piece) {
            Ok(0) => return Ok(None),
            Ok(n) => bytes.extend_from_slice(&piece[..n]),
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            Err(_) => return Ok(None),
        }
    }
}

/// The request, once its head is complete.
fn parse(bytes: &[u8]) -> Result<Option<Request>, u16> {
    let mut headers = [httparse::EMPTY_HEADER; MOST_HEADERS];
    let mut parsed = httparse::Request::new(&mut headers);
    match parsed.parse(bytes) {
        Ok(httparse::Status::Partial) if bytes.len() < MOST_BYTES => return Ok(None),
        Ok(httparse::Status::Partial) | Err(httparse::Error::TooManyHeaders) => return Err(431),
        Ok(httparse::Status::Complete(_)) => {}
        Err(_) => return Err(400),
    }
    let method = match parsed.method {
        Some("GET") => Method::Get,
        Some("POST") => Method::Post,
        _ => return Err(405),
    };
    let target = parsed.path.filter(|path| path.starts_with('/')).ok_or(400_u16)?;
    let (path, query) = target.split_once('?').unwrap_or((target, ""));
    let header = |name: &str| {
        let mut values = parsed.headers.iter().filter(|header| header.name.eq_ignore_ascii_case(name));
        let first = values.next().map(|header| String::from_utf8_lossy(header.value).trim().to_owned());
        // Two hosts are none.
        if values.next().is_some() { Err(400_u16) } else { Ok(first) }
    };
    let (host, origin) = (header("host")?, header("origin")?);
    Ok(Some(Request { method, path: path.to_owned(), query: query.to_owned(), host, origin }))
}

/// What is answered.
#[derive(Debug)]
pub struct Response {
    pub status: u16,
    kind: &'static str,
    body: Arc<Vec<u8>>,
}

impl Response {
    /// Nothing but a status.
    pub fn status(status: u16) -> Self {
        Self { status, kind: "text/plain; charset=utf-8", body: Arc::new(reason(status).as_bytes().to_vec()) }
    }

    pub fn html(text: &str) -> Self {
        Self { status: 200, kind: "text/html; charset=utf-8", body: Arc::new(text.as_bytes().to_vec()) }
    }

    pub fn json(value: &serde_json::Value) -> Self {
        Self { status: 200, kind: "application/json", body: Arc::new(value.to_string().into_bytes()) }
    }

    pub fn bytes(body: Arc<Vec<u8>>) -> Self {
        Self { status: 200, kind: "application/octet-stream", body }
    }

    /// Sends it. Who does not take it in time does not get it.
    ///
    /// # Errors
    /// When it was not taken.
    pub fn write(&self, stream: &mut TcpStream) -> io::Result<()> {
        stream.set_write_timeout(Some(PIECE))?;
        let begun = Instant::now();
        let body: &[u8] = if self.status == 204 { &[] } else { &self.body };
        stream.write_all(self.head(body.len()).as_bytes())?;
        for piece in body.chunks(1 << 16) {
            if begun.elapsed() > WHOLE {
                return Err(io::ErrorKind::TimedOut.into());
            }
            stream.write_all(piece)?;
        }
        stream.flush()
    }

    /// Nothing may keep, frame or sniff what comes from here, or ask for it from another page.
    fn head(&self, length: usize) -> String {
        format!(
            "HTTP/1.1 {} {}\r\nContent-Type: {}\r\nContent-Length: {length}\r\nConnection: close\r\n\
             Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
             Cross-Origin-Resource-Policy: same-origin\r\nContent-Security-Policy: default-src 'none'; \
             script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data:; connect-src 'self'; \
             base-uri 'none'; form-action 'none'; frame-ancestors 'none'\r\n\r\n",
            self.status,
            reason(self.status),
            self.kind,
        )
    }
}

fn reason(status: u16) -> &'static str {
    match status {
        200 => "OK",
        204 => "No Content",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        431 => "Request Header Fields Too Large",
        _ => "Bad Request",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_are_read_once_they_are_complete() {
        let whole = b"GET /t/tiles?layer=3&n=x HTTP/1.1\r\nHost: 127.0.0.1:80\r\nOrigin:  a \r\n\r\n";
        for end in 0..whole.len() {
            assert!(matches!(parse(&whole[..end]), Ok(None)), "{end}");
        }
        let request = parse(whole).unwrap().unwrap();
        assert_eq!((request.method, request.path.as_str()), (Method::Get, "/t/tiles"));
        assert_eq!(
            (request.number("layer"), request.number("n"), request.number("m")),
            (Some(3), None, None)
        );
        assert_eq!((request.host.as_deref(), request.origin.as_deref()), (Some("127.0.0.1:80"), Some("a")));
    }

    #[test]
    fn what_is_no_request_for_a_page_is_refused() {
        let status = |text: &[u8]| parse(text).err();
        assert_eq!(status(b"PUT / HTTP/1.1\r\n\r\n"), Some(405));
        assert_eq!(status(b"GET http://a/ HTTP/1.1\r\n\r\n"), Some(400));
        assert_eq!(status(b"\x16\x03\x01\x02\x00\x01\x00"), Some(400));
        assert_eq!(status(b"GET / HTTP/1.1\r\nHost: a\r\nhost: b\r\n\r\n"), Some(400));
        let long = [b"GET /".as_slice(), &[b'a'; MOST_BYTES]].concat();
        assert_eq!(status(&long), Some(431));
        let headers = "A: b\r\n".repeat(MOST_HEADERS + 1);
        assert_eq!(status(format!("GET / HTTP/1.1\r\n{headers}\r\n").as_bytes()), Some(431));
    }
}
