//! What showing a render may cost: a share of the processor time of the render itself.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Work of one kind, which is put off while it has taken more than its share.
#[derive(Debug)]
pub struct Account {
    /// Of the processor time of the render.
    share: f64,
    /// Processors that render.
    processors: f64,
    /// Processor time of one piece of work, as long as none is measured.
    guess: Duration,
    /// Nanoseconds of processor time.
    spent: AtomicU64,
    pieces: AtomicU64,
}

impl Account {
    pub fn new(share: f64, processors: usize, guess: Duration) -> Self {
        let (spent, pieces) = (AtomicU64::new(0), AtomicU64::new(0));
        Self { share, processors: processors as f64, guess, spent, pieces }
    }

    /// Processor time spent so far.
    pub fn spent(&self) -> Duration {
        Duration::from_nanos(self.spent.load(Ordering::Relaxed))
    }

    /// How much may be spent in a render of this length.
    fn allowance(&self, elapsed: Duration) -> Duration {
        elapsed.mul_f64(self.share * self.processors)
    }

    /// Whether another piece of work, as long as those so far, stays within the share of a render of this length.
    pub fn affords(&self, elapsed: Duration) -> bool {
        let (spent, pieces) = (self.spent(), self.pieces.load(Ordering::Relaxed));
        let next = if pieces == 0 { self.guess } else { spent.div_f64(pieces as f64) };
        spent + next <= self.allowance(elapsed)
    }

    /// How much longer the render has to take until what was spent is within the share.
    pub fn debt(&self, elapsed: Duration) -> Duration {
        self.spent().saturating_sub(self.allowance(elapsed)).div_f64(self.share * self.processors)
    }

    /// A piece of work was done.
    pub fn pay_piece(&self, cost: Duration) {
        self.pieces.fetch_add(1, Ordering::Relaxed);
        self.pay(cost);
    }

    /// Something that belongs to the last piece was done.
    pub fn pay(&self, cost: Duration) {
        self.spent.fetch_add(u64::try_from(cost.as_nanos()).unwrap_or(u64::MAX), Ordering::Relaxed);
    }
}

/// Measures the processor time of this thread; the time itself where the system does not tell.
#[derive(Debug)]
pub struct Meter {
    begun: Instant,
    processor: Option<Duration>,
}

impl Meter {
    pub fn start() -> Self {
        Self { begun: Instant::now(), processor: thread_time() }
    }

    pub fn elapsed(&self) -> Duration {
        let spent = self.processor.zip(thread_time()).map(|(begun, now)| now.saturating_sub(begun));
        spent.unwrap_or_else(|| self.begun.elapsed())
    }
}

#[cfg(unix)]
fn thread_time() -> Option<Duration> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Some(Duration::new(u64::try_from(time.tv_sec).ok()?, u32::try_from(time.tv_nsec).ok()?))
}

#[cfg(not(unix))]
fn thread_time() -> Option<Duration> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn the_share_is_never_exceeded_by_work_as_long_as_the_last() {
        let account = Account::new(0.01, 2, Duration::from_millis(50));
        // One hundredth of two processors is 20 ms a second.
        assert!(!account.affords(2 * SECOND) && account.affords(3 * SECOND), "the guess counts at first");
        let (mut seconds, mut pieces) = (0, 0);
        while seconds < 1000 {
            seconds += 1;
            if account.affords(seconds * SECOND) {
                account.pay_piece(Duration::from_millis(30));
                pieces += 1;
            }
            assert!(account.spent() <= account.allowance(seconds * SECOND));
        }
        assert_eq!(pieces, 666);
    }

    #[test]
    fn debts_are_waited_for() {
        let account = Account::new(0.01, 1, Duration::ZERO);
        account.pay(Duration::from_millis(50));
        assert_eq!(account.debt(2 * SECOND), 3 * SECOND);
        assert_eq!(account.debt(5 * SECOND), Duration::ZERO);
    }
}
