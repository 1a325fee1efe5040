//! How many passes take a given CPU time, from what other numbers of passes took.

/// Share of a budget that a render must take to tell the passes of the whole.
const SHARE: f64 = 0.25;
/// Most passes of a measurement that is made only to know the cost.
const MOST_MEASURED: u64 = 1 << 16;
/// Most passes that are planned: a renderer whose passes seem to cost nothing would get endlessly many.
const MOST: f64 = 1e6;

/// Passes and their CPU seconds, of one configuration on one scene.
#[derive(Clone, Debug, Default)]
pub struct Costs(Vec<(u64, f64)>);

impl Costs {
    /// Adds a render.
    pub fn add(&mut self, passes: u64, cpu_seconds: f64) {
        self.0.push((passes, cpu_seconds));
    }

    /// The render of the most passes, and what a pass of it costs. What is done once, such as a pilot, shows in the
    /// render of the fewest passes.
    fn largest(&self) -> Option<(u64, f64, f64)> {
        let (n, all) = self.0.iter().copied().max_by_key(|(passes, _)| *passes)?;
        let few = self.0.iter().filter(|(passes, _)| 2 * passes <= n).min_by_key(|(passes, _)| *passes);
        let slope = few.map(|(k, some)| (all - some) / (n - k) as f64).filter(|slope| *slope > 0.0);
        let mean = all / n as f64;
        Some((n, all, slope.map_or(mean, |slope| slope.min(mean))))
    }

    /// How many passes come nearest to `seconds`; `None` until the renders are long enough to tell.
    pub fn passes(&self, seconds: f64) -> Option<u32> {
        let (n, all, each) = self.largest()?;
        let several = self.0.iter().any(|(passes, _)| 2 * passes <= n);
        let enough = several && each * n as f64 >= SHARE * seconds;
        if !enough && all < seconds && n < MOST_MEASURED {
            return None;
        }
        let once = all - each * n as f64;
        // Passes that cost nothing make this infinite.
        Some((((seconds - once) / each).round().clamp(1.0, MOST) as u32).max(1))
    }

    /// The number of passes to measure next, if [`Self::passes`] knows none.
    pub fn next(&self, seconds: f64) -> u32 {
        let Some((n, _, each)) = self.largest() else { return 1 };
        let factor = (1.5 * SHARE * seconds / (each * n as f64)).ceil().clamp(2.0, 16.0) as u64;
        (n * factor).min(MOST_MEASURED) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The passes for a budget, and how many renders it took to find them.
    fn plan(seconds: f64, cost: impl Fn(u32) -> f64) -> (u32, usize) {
        let mut costs = Costs::default();
        for renders in 0..10 {
            if let Some(n) = costs.passes(seconds) {
                return (n, renders);
            }
            let n = costs.next(seconds);
            costs.add(u64::from(n), cost(n));
        }
        panic!("no number of passes after 10 renders")
    }

    #[test]
    fn the_budget_is_met() {
        assert_eq!(plan(15.0, |n| 0.01 * f64::from(n)).0, 1500);
        // A pilot of two seconds: 13 s are left.
        assert_eq!(plan(15.0, |n| 2.0 + 0.1 * f64::from(n)).0, 130);
        // A pass longer than the budget.
        assert_eq!(plan(1.0, |n| 3.0 * f64::from(n)), (1, 1));
    }

    #[test]
    fn passes_that_cost_nothing_have_an_end() {
        assert_eq!(plan(15.0, |_| 0.0).0, 1_000_000);
        assert!(plan(1e9, |n| 0.01 * f64::from(n)).0 == 1_000_000);
    }
}
