//! Ctrl-C and SIGTERM: the first signal ends the work cleanly, and one that comes more than a second later ends
//! the program at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::time::{Duration, Instant};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

/// Signals within this time are one wish: `timeout` and some shells signal a process and then its group, too.
const ONE_WISH: Duration = Duration::from_secs(1);

/// What the signals set.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    /// Until it is set, a signal ends the program: there is nothing to write.
    watched: Arc<AtomicBool>,
    stop: Arc<AtomicBool>,
    signal: Arc<AtomicI32>,
}

impl Interrupt {
    /// Signals end the program, with the status that stands for them, until [`Self::watch`].
    ///
    /// # Errors
    /// When a handler cannot be installed.
    pub fn begin() -> Result<Self, String> {
        let interrupt = Self::default();
        let problem = |e: std::io::Error| format!("cannot watch for signals: {e}");
        let signals = Signals::new([SIGINT, SIGTERM]).map_err(problem)?;
        let theirs = interrupt.clone();
        std::thread::Builder::new()
            .name("signals".to_owned())
            .spawn(move || theirs.answer(signals))
            .map_err(problem)?;
        // A file that grows beyond `ulimit -f` would end the program; caught, it is an error of writing.
        #[cfg(unix)]
        signal_hook::flag::register(signal_hook::consts::SIGXFSZ, Arc::default())
            .map_err(|e| format!("cannot watch the size of files: {e}"))?;
        Ok(interrupt)
    }

    fn answer(&self, mut signals: Signals) {
        let mut first: Option<Instant> = None;
        for signal in signals.forever() {
            let again = first.is_some_and(|first| first.elapsed() > ONE_WISH);
            if again || !self.watched.load(Ordering::Acquire) {
                std::process::exit(128 + signal);
            }
            if first.is_none() {
                first = Some(Instant::now());
                self.signal.store(signal, Ordering::Release);
                self.stop.store(true, Ordering::Release);
            }
        }
    }

    /// From now on the first signal sets the flag only.
    pub fn watch(&self) {
        self.watched.store(true, Ordering::Release);
    }

    /// True after the first signal.
    pub fn flag(&self) -> &Arc<AtomicBool> {
        &self.stop
    }

    /// Exit status that shells expect after the signal: 130 or 143. Without a signal, somebody has stopped the render
    /// from its page, and all is well: 0.
    pub fn status(&self) -> u8 {
        match self.signal.load(Ordering::Acquire) {
            0 => 0,
            signal => 128 + signal as u8,
        }
    }
}
