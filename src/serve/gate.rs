//! Who is let in: whoever has the token, and comes from the page itself.

use std::net::{IpAddr, SocketAddr};

use super::http::Request;

/// What a request must have.
#[derive(Clone, Debug)]
pub struct Gate {
    bound: SocketAddr,
    token: String,
}

impl Gate {
    /// With a new token of 128 random bits.
    pub fn new(bound: SocketAddr) -> Self {
        Self { bound, token: format!("{:032x}", rand::random::<u128>()) }
    }

    /// Where the page is. An address that stands for every interface is shown as this machine.
    pub fn address(&self) -> String {
        let ip = self.bound.ip();
        let shown = match ip {
            IpAddr::V4(_) if ip.is_unspecified() => IpAddr::from([127, 0, 0, 1]),
            IpAddr::V6(_) if ip.is_unspecified() => IpAddr::from([0, 0, 0, 0, 0, 0, 0, 1]),
            _ => ip,
        };
        format!("http://{}/{}/", SocketAddr::new(shown, self.bound.port()), self.token)
    }

    /// What is asked for behind the token; `None` for a stranger.
    pub fn admit<'a>(&self, request: &'a Request) -> Option<&'a str> {
        let (token, rest) = request.path.strip_prefix('/')?.split_once('/')?;
        let known = request.host.as_deref().is_some_and(|host| self.serves(host));
        // Browsers say where a request comes from that may change something.
        let own = match request.origin.as_deref() {
            None => true,
            Some(origin) => origin.strip_prefix("http://").is_some_and(|host| self.serves(host)),
        };
        (same(token.as_bytes(), self.token.as_bytes()) && known && own).then_some(rest)
    }

    /// Whether this is the name of our address. A name of somebody else's may lead here, too, so that a page of theirs
    /// would be of our origin (DNS rebinding): only addresses and `localhost` are accepted.
    fn serves(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if port.chars().all(|c| c.is_ascii_digit()) => (name, port.parse().ok()),
            _ => (host, Some(80)),
        };
        let name = name.strip_prefix('[').and_then(|n| n.strip_suffix(']')).unwrap_or(name);
        let named = match name.parse::<IpAddr>() {
            Ok(ip) => ip == self.bound.ip() || self.bound.ip().is_unspecified(),
            Err(_) => name == "localhost",
        };
        named && port == Some(self.bound.port())
    }
}

/// Compares in a time that says nothing of where two texts differ.
fn same(a: &[u8], b: &[u8]) -> bool {
    a.len() == b.len() && a.iter().zip(b).fold(0, |differs, (x, y)| differs | (x ^ y)) == 0
}

#[cfg(test)]
mod tests {
    use super::super::http::Method;
    use super::*;

    #[test]
    fn names_of_others_are_not_ours() {
        let serves = |bound: &str, host: &str| Gate::new(bound.parse().unwrap()).serves(host);
        for host in ["127.0.0.1:81", "localhost:81"] {
            assert!(serves("127.0.0.1:81", host), "{host}");
        }
        for host in ["127.0.0.1", "127.0.0.1:80", "evil.example:81", "127.0.0.1.evil.example:81", "", ":81"] {
            assert!(!serves("127.0.0.1:81", host), "{host}");
        }
        assert!(!serves("127.0.0.1:81", "10.0.0.1:81") && serves("0.0.0.0:81", "10.0.0.1:81"));
        assert!(serves("[::1]:81", "[::1]:81") && serves("127.0.0.1:80", "localhost"));
        assert!(!serves("0.0.0.0:81", "evil.example:81"));
    }

    #[test]
    fn tokens_are_long_and_differ() {
        let gate = || Gate::new("127.0.0.1:81".parse().unwrap());
        let (one, two) = (gate(), gate());
        assert!(one.token.len() == 32 && one.token != two.token);
        let request = |path: String, origin: Option<&str>| Request {
            method: Method::Post,
            path,
            query: String::new(),
            host: Some("localhost:81".to_owned()),
            origin: origin.map(str::to_owned),
        };
        let admitted = |path: &str, origin| {
            let request = request(path.replace("TOKEN", &one.token), origin);
            one.admit(&request).map(str::to_owned)
        };
        assert_eq!(admitted("/TOKEN/stop", None).as_deref(), Some("stop"));
        assert_eq!(admitted("/TOKEN/", Some("http://127.0.0.1:81")).as_deref(), Some(""));
        assert_eq!(admitted("/TOKEN/stop", Some("http://evil.example")), None);
        assert_eq!(admitted("/TOKEN/stop", Some("null")), None);
        assert_eq!(admitted(&format!("/{}/", two.token), None), None);
        assert_eq!(admitted("/TOKEN", None), None);
        assert_eq!(admitted("//", None), None);
    }
}
