//! What showing a render may cost: a share of the processor time of the render itself.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Work of one kind, which is put off while it has taken more than its share.
#[derive(Debug)]
pub struct Account {
    /// Of the processor time of the render.
    share: f64,
    /// Processor time of one piece of work, as long as none is measured.
    guess: Duration,
    /// Nanoseconds of processor time.
    spent: AtomicU64,
    pieces: AtomicU64,
}

impl Account {
    pub fn new(share: f64, guess: Duration) -> Self {
        Self { share, guess, spent: AtomicU64::new(0), pieces: AtomicU64::new(0) }
    }

    /// Processor time spent so far.
    pub fn spent(&self) -> Duration {
        Duration::from_nanos(self.spent.load(Ordering::Relaxed))
    }

    /// Whether another piece of work, as long as those so far, stays within so many shares of a render that has taken
    /// this much processor time.
    pub fn affords(&self, work: Duration, shares: f64) -> bool {
        let (spent, pieces) = (self.spent(), self.pieces.load(Ordering::Relaxed));
        let next = if pieces == 0 { self.guess } else { spent.div_f64(pieces as f64) };
        spent + next <= work.mul_f64(shares * self.share)
    }

    /// How much more processor time the render has to take until what was spent is within so many shares.
    pub fn debt(&self, work: Duration, shares: f64) -> Duration {
        let share = shares * self.share;
        self.spent().saturating_sub(work.mul_f64(share)).div_f64(share)
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

/// Processor time of a render.
#[derive(Debug)]
pub struct Work {
    begun: Instant,
    /// Threads that render.
    threads: usize,
    processor: Option<Duration>,
}

impl Work {
    pub fn start(threads: usize) -> Self {
        Self { begun: Instant::now(), threads, processor: process_time() }
    }

    /// So far; where the system does not tell, as if nothing else ran.
    pub fn elapsed(&self) -> Duration {
        let spent = self.processor.zip(process_time()).map(|(begun, now)| now.saturating_sub(begun));
        spent.unwrap_or_else(|| self.begun.elapsed().mul_f64(self.threads as f64))
    }

    /// Wall-clock time in which the render takes this much processor time, if nothing else runs.
    pub fn wall(&self, work: Duration) -> Duration {
        work.div_f64(self.threads.max(1) as f64)
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
fn time_of(clock: rustix::time::ClockId) -> Option<Duration> {
    let time = rustix::time::clock_gettime(clock);
    Some(Duration::new(u64::try_from(time.tv_sec).ok()?, u32::try_from(time.tv_nsec).ok()?))
}

#[cfg(unix)]
fn thread_time() -> Option<Duration> {
    time_of(rustix::time::ClockId::ThreadCPUTime)
}

#[cfg(unix)]
fn process_time() -> Option<Duration> {
    time_of(rustix::time::ClockId::ProcessCPUTime)
}

#[cfg(not(unix))]
fn thread_time() -> Option<Duration> {
    None
}

#[cfg(not(unix))]
fn process_time() -> Option<Duration> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn the_share_is_never_exceeded_by_work_as_long_as_the_last() {
        let account = Account::new(0.02, Duration::from_millis(50));
        // One fiftieth of a second is 20 ms.
        assert!(
            !account.affords(2 * SECOND, 1.0) && account.affords(3 * SECOND, 1.0),
            "the guess counts at first"
        );
        assert!(account.affords(3 * SECOND / 2, 2.0) && !account.affords(SECOND, 2.0));
        let mut pieces = 0;
        for seconds in 1..=1000 {
            if account.affords(seconds * SECOND, 1.0) {
                account.pay_piece(Duration::from_millis(30));
                pieces += 1;
            }
            assert!(account.spent() <= seconds * Duration::from_millis(20));
        }
        assert_eq!(pieces, 666);
    }

    #[test]
    fn debts_are_waited_for() {
        let account = Account::new(0.01, Duration::ZERO);
        account.pay(Duration::from_millis(50));
        assert_eq!(account.debt(2 * SECOND, 1.0), 3 * SECOND);
        assert_eq!(account.debt(2 * SECOND, 2.0), SECOND / 2);
        assert_eq!(account.debt(5 * SECOND, 1.0), Duration::ZERO);
    }

    #[test]
    fn idle_threads_take_no_processor_time() {
        let (meter, work) = (Meter::start(), Work::start(1));
        std::thread::sleep(Duration::from_millis(50));
        // Where the system does not tell, the time itself counts.
        assert!(!cfg!(unix) || meter.elapsed() < Duration::from_millis(40));
        assert!(work.wall(SECOND) == SECOND && Work::start(4).wall(SECOND) == SECOND / 4);
    }
}
