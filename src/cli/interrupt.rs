//! Ctrl-C and SIGTERM: the first signal ends the render cleanly, the second one ends the program.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// What the signals set.
#[derive(Debug)]
pub struct Interrupt {
    /// True while a signal ends the program at once: before there is anything to write, and after the
    /// first signal.
    stop: Arc<AtomicBool>,
    signal: Arc<AtomicUsize>,
}

impl Interrupt {
    /// Signals end the program, with the status that stands for them, until [`Self::watch`].
    ///
    /// # Errors
    /// When a handler cannot be installed.
    pub fn begin() -> Result<Self, String> {
        let watched = Self { stop: Arc::new(AtomicBool::new(true)), signal: Arc::default() };
        for signal in [SIGINT, SIGTERM] {
            watched.register(signal).map_err(|e| format!("cannot watch for signal {signal}: {e}"))?;
        }
        // A file that grows beyond `ulimit -f` would end the program; caught, it is an error of writing.
        #[cfg(unix)]
        flag::register(signal_hook::consts::SIGXFSZ, Arc::default())
            .map_err(|e| format!("cannot watch the size of files: {e}"))?;
        Ok(watched)
    }

    fn register(&self, signal: i32) -> Result<(), std::io::Error> {
        // In this order: the exit looks at the flag before the same signal sets it.
        flag::register_conditional_shutdown(signal, 128 + signal, self.stop.clone())?;
        flag::register_usize(signal, self.signal.clone(), signal as usize)?;
        flag::register(signal, self.stop.clone())?;
        Ok(())
    }

    /// From now on the first signal sets the flag only.
    pub fn watch(&self) {
        self.stop.store(false, Ordering::Relaxed);
    }

    pub fn flag(&self) -> &AtomicBool {
        &self.stop
    }

    /// Exit status that shells expect after the signal: 130 or 143.
    pub fn status(&self) -> u8 {
        128 + self.signal.load(Ordering::Relaxed) as u8
    }
}
