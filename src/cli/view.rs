//! Options of `render` that show it while it goes on.

use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::failure::Failure;
use super::interrupt::Interrupt;
use super::report;
use crate::serve::{self, View};
use crate::session::{Budget, Session};

/// The options.
#[derive(Debug, Args)]
pub struct ViewArgs {
    /// Serve a page on this machine that shows the render, and open it in the browser
    #[arg(long)]
    view: bool,
    /// Do not open the browser: print the address of the page only
    #[arg(long, requires = "view")]
    view_no_open: bool,
    /// Serve the page on this address, for other machines too [default: 127.0.0.1 and a free port]
    #[arg(long, value_name = "ADDR[:PORT]", requires = "view", value_parser = bind)]
    view_bind: Option<SocketAddr>,
    /// Compare with this picture on the page: wipe, FLIP map and error against time
    #[arg(long, value_name = "FILE")]
    reference: Option<PathBuf>,
    /// Show the render in tev, which listens on 127.0.0.1:14158 unless told otherwise
    #[arg(long, value_name = "HOST:PORT", value_parser = host)]
    display: Option<String>,
}

/// An address, or an address with a port.
fn bind(text: &str) -> Result<SocketAddr, String> {
    let address = text.parse::<SocketAddr>().ok();
    let bare = || text.trim_matches(['[', ']']).parse::<IpAddr>().ok().map(|ip| SocketAddr::new(ip, 0));
    address.or_else(bare).ok_or_else(|| "expected an address, such as 0.0.0.0 or 192.168.1.7:8080".to_owned())
}

/// HOST:PORT.
fn host(text: &str) -> Result<String, String> {
    let split = text.rsplit_once(':').filter(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok());
    split.map(|_| text.to_owned()).ok_or_else(|| "expected HOST:PORT, such as 127.0.0.1:14158".to_owned())
}

impl ViewArgs {
    /// Opens the view that is asked for, if any, and says where it is.
    ///
    /// # Errors
    /// When the options do not go together, or the view cannot be opened.
    pub fn open(
        &self,
        session: &Session,
        budget: &Budget<'_>,
        exposure: f64,
        interrupt: &Interrupt,
    ) -> Result<Option<View>, Failure> {
        if !self.view && self.display.is_none() {
            return match &self.reference {
                Some(_) => Err(Failure::Usage("--reference is for --view or --display".to_owned())),
                None => Ok(None),
            };
        }
        let here = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 0);
        let options = serve::Options {
            page: self.view.then(|| self.view_bind.unwrap_or(here)),
            display: self.display.clone(),
            reference: self.reference.clone(),
            exposure,
            interrupt: Arc::clone(interrupt.flag()),
            warn: report::line,
        };
        let view = View::start(&options, session, budget).map_err(|e| Failure::Work(e.to_string()))?;
        if let Some(address) = view.address() {
            report::line(&format!("view: {address}"));
            if !self.view_no_open {
                browse(address.to_owned());
            }
        }
        Ok(Some(view))
    }
}

/// Opens the page where there is a screen. That it could not be opened needs no message: the address is printed.
fn browse(address: String) {
    let screen = ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some());
    if screen || !cfg!(all(unix, not(target_os = "macos"))) {
        // In a thread: some systems wait for the browser.
        let _refused = std::thread::Builder::new()
            .name("browser".to_owned())
            .spawn(move || open::that_detached(address).is_ok());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_may_leave_the_port_to_the_system() {
        let read = |text: &str| bind(text).map(|address| address.to_string());
        assert_eq!(read("0.0.0.0").as_deref(), Ok("0.0.0.0:0"));
        assert_eq!(read("::1").as_deref(), Ok("[::1]:0"));
        assert_eq!(read("[::1]").as_deref(), Ok("[::1]:0"));
        assert_eq!(read("10.0.0.1:81").as_deref(), Ok("10.0.0.1:81"));
        assert!(read("example.org").is_err() && read("").is_err());
        assert!(host("tev.example:14158").is_ok() && host("[::1]:1").is_ok());
        assert!(host("14158").is_err() && host(":14158").is_err() && host("a:b").is_err());
    }
}
