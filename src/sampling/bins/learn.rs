//! Growing the boxes.
//!
//! With n samples of density q, an estimate whose squared contribution has the integral M over a box has the variance
//! Σ M·V/(m·n) over boxes of volume V and probability m, and takes the time n·Σ m·c where a sample costs c. Their product
//! is least, (Σ√(M·V·c))², with m ∝ √(M·V/c). Boxes are split where that sum falls most.

use std::collections::BinaryHeap;

use super::{AXES, Bins, Node};

/// A sample of the cube and what it was worth.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Where.
    pub at: [f32; AXES],
    /// 1 over the density with which it was drawn.
    pub weight: f32,
    /// Square of what it contributes.
    pub value: f32,
    /// Time it took, in any unit.
    pub cost: f32,
}

/// Boxes whose probabilities are not settled yet.
#[derive(Debug)]
pub struct Grown {
    samples: Vec<Sample>,
    nodes: Vec<Node>,
    boxes: Vec<Open>,
}

/// Most boxes.
const MOST: usize = 1024;

/// Places along an axis where a box may be split.
const STEPS: usize = 32;

/// Splits that gain less than this share of the sum over all boxes are not made.
const LEAST_GAIN: f64 = 5e-4;

/// A box is split only where so many samples count.
const LEAST: f64 = 8.0;

/// Samples that a split is believed to be even by: few samples say little about where light goes.
const DOUBT: f64 = 2.0;

/// No sample counts more than so many times the mean of those that count at all.
const OUTLIER: f64 = 32.0;

/// Samples of a box, or of a part of it.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// Σ value·weight, and Σ of its squares.
    value: f64,
    square: f64,
    cost: f64,
    count: f64,
}

impl Sums {
    fn add(&mut self, sample: &Sample) {
        self.value += sample.value;
        self.square += sample.value * sample.value;
        self.cost += sample.cost;
        self.count += 1.0;
    }

    fn plus(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            square: self.square + other.square,
            cost: self.cost + other.cost,
            count: self.count + other.count,
        }
    }

    fn minus(self, other: Self) -> Self {
        Self {
            value: (self.value - other.value).max(0.0),
            square: (self.square - other.square).max(0.0),
            cost: self.cost - other.cost,
            count: self.count - other.count,
        }
    }

    /// Equally important samples that would say as much.
    fn effective(&self) -> f64 {
        if self.square > 0.0 { self.value * self.value / self.square } else { 0.0 }
    }

    /// Mean cost of a sample, near that of the box around.
    fn cost_in(&self, around: f64) -> f64 {
        (self.cost + 4.0 * around) / (self.count + 4.0)
    }
}

#[derive(Clone, Copy, Debug)]
struct Sample {
    at: [f32; AXES],
    value: f64,
    cost: f64,
}

/// A box that is not split yet.
#[derive(Debug)]
struct Open {
    node: usize,
    samples: std::ops::Range<usize>,
    low: [f32; AXES],
    high: [f32; AXES],
    sums: Sums,
    cost: f64,
    split: Option<Split>,
}

#[derive(Clone, Copy, Debug)]
struct Split {
    axis: usize,
    at: f32,
    gain: f64,
}

impl Open {
    fn volume(&self) -> f64 {
        (0..AXES).map(|i| f64::from(self.high[i] - self.low[i])).product()
    }

    /// Its share of the sum that is to become small.
    fn term(&self) -> f64 {
        (self.sums.value * self.volume() * self.cost).sqrt()
    }

    /// What it should get.
    fn mass(&self) -> f64 {
        (self.sums.value * self.volume() / self.cost).sqrt()
    }

    /// Finds its best split.
    fn prepare(mut self, samples: &[Sample]) -> Self {
        self.split = (0..AXES)
            .filter_map(|axis| self.along(axis, &samples[self.samples.clone()]))
            .max_by(|a, b| a.gain.total_cmp(&b.gain));
        self
    }

    /// Its best split along an axis.
    fn along(&self, axis: usize, samples: &[Sample]) -> Option<Split> {
        let (low, width) = (self.low[axis], self.high[axis] - self.low[axis]);
        let effective = self.sums.effective();
        if effective < LEAST || width <= 64.0 * f32::EPSILON {
            return None;
        }
        let mut steps = [Sums::default(); STEPS];
        for sample in samples {
            let step = ((sample.at[axis] - low) / width * STEPS as f32) as usize;
            steps[step.min(STEPS - 1)].add(sample);
        }
        let volume = self.volume();
        let whole = self.term();
        let mut below = Sums::default();
        let mut best: Option<Split> = None;
        for (i, step) in steps.iter().enumerate().take(STEPS - 1) {
            below = below.plus(*step);
            let above = self.sums.minus(below);
            let part = (i + 1) as f64 / STEPS as f64;
            // The share of the value, nearer to that of the volume by a standard deviation.
            let share = below.value / self.sums.value;
            let sigma = ((part * (1.0 - part) + 1.0 / effective) / effective).sqrt();
            let off = share - part;
            let share = part + off.signum() * (off.abs() - sigma).max(0.0);
            let term =
                |share: f64, part: f64, cost: f64| (self.sums.value * share * volume * part * cost).sqrt();
            let gain = whole
                - term(share, part, below.cost_in(self.cost))
                - term(1.0 - share, 1.0 - part, above.cost_in(self.cost));
            if gain > best.map_or(0.0, |b| b.gain) {
                best = Some(Split { axis, at: low + width * (part as f32), gain });
            }
        }
        best
    }
}

/// Orders boxes by what splitting them gains.
#[derive(Debug)]
struct ByGain(f64, usize);

impl PartialEq for ByGain {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for ByGain {}

impl PartialOrd for ByGain {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for ByGain {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0).then(other.1.cmp(&self.1))
    }
}

impl Grown {
    /// Boxes for the density with which samples like `found` would cost least for the same error.
    pub fn new(found: &[Found]) -> Self {
        let mut grown = Self::whole(found);
        grown.grow();
        grown
    }

    /// Σ√(M·V/c): what the whole cube should get, against other cubes.
    pub fn mass(&self) -> f64 {
        self.boxes.iter().map(Open::mass).sum()
    }

    fn whole(found: &[Found]) -> Self {
        let value = |f: &Found| f64::from(f.value) * f64::from(f.weight);
        let counting = found.iter().filter(|f| f.value > 0.0).count();
        let most = OUTLIER * found.iter().map(value).sum::<f64>() / counting.max(1) as f64;
        let sample = |f: &Found| Sample { at: f.at, value: value(f).min(most), cost: f64::from(f.cost) };
        let samples: Vec<Sample> = found.iter().map(sample).collect();
        let mut sums = Sums::default();
        samples.iter().for_each(|s| sums.add(s));
        let cost = sums.cost / sums.count.max(1.0);
        let (low, high) = ([0.0; AXES], [1.0; AXES]);
        let root = Open { node: 0, samples: 0..samples.len(), low, high, sums, cost, split: None };
        let boxes = vec![root.prepare(&samples)];
        Self { samples, nodes: Bins::even().nodes, boxes }
    }

    fn grow(&mut self) {
        let gain = |open: &Open| open.split.map_or(0.0, |s| s.gain);
        let mut sum = self.boxes[0].term();
        let mut queue = BinaryHeap::from([ByGain(gain(&self.boxes[0]), 0)]);
        while self.boxes.len() < MOST
            && let Some(ByGain(best, i)) = queue.pop()
            && best > LEAST_GAIN * sum
        {
            sum -= self.boxes[i].term();
            let next = self.boxes.len();
            self.split(i);
            for i in [i, next] {
                sum += self.boxes[i].term();
                queue.push(ByGain(gain(&self.boxes[i]), i));
            }
        }
    }

    /// Splits box `i`, whose lower half takes its place; the upper one is added.
    fn split(&mut self, i: usize) {
        let open = &self.boxes[i];
        let Some(Split { axis, at, .. }) = open.split else { return };
        let range = open.samples.clone();
        let part = &mut self.samples[range.clone()];
        // Keeps the order within the halves, so that sums are always added up in the same order.
        part.sort_by_key(|s| s.at[axis] >= at);
        let middle = range.start + part.partition_point(|s| s.at[axis] < at);
        let child = self.nodes.len();
        let leaf = self.nodes[0];
        self.nodes[open.node] = Node { split: at, share: 0.0, axis: axis as u32, child: child as u32 };
        self.nodes.extend([Node { child: 0, ..leaf }; 2]);
        let [lower, upper] = [range.start..middle, middle..range.end].map(|samples| {
            let mut sums = Sums::default();
            self.samples[samples.clone()].iter().for_each(|s| sums.add(s));
            let cost = sums.cost_in(open.cost);
            let (low, high) = (open.low, open.high);
            Open { node: child, samples, low, high, sums, cost, split: None }
        });
        let (mut lower, mut upper) = (lower, upper);
        lower.high[axis] = at;
        upper.low[axis] = at;
        upper.node = child + 1;
        self.boxes[i] = lower.prepare(&self.samples);
        self.boxes.push(upper.prepare(&self.samples));
    }

    /// The density, of which the share `even` is the same everywhere.
    pub fn close(mut self, even: f64) -> Bins {
        // By node: mass, volume, and samples that count.
        let mut of = vec![[0.0f64; 3]; self.nodes.len()];
        for open in &self.boxes {
            of[open.node] = [open.mass(), open.volume(), open.sums.effective()];
        }
        // Children stand behind their parents.
        for i in (0..self.nodes.len()).rev() {
            let child = self.nodes[i].child as usize;
            if child != 0 {
                of[i] = std::array::from_fn(|k| of[child][k] + of[child + 1][k]);
            }
        }
        let mut densities = vec![1.0f64; self.nodes.len()];
        for i in 0..self.nodes.len() {
            let child = self.nodes[i].child as usize;
            if child == 0 || of[i][0] <= 0.0 {
                continue;
            }
            let part = of[child][1] / of[i][1];
            let doubt = DOUBT / (of[i][2] + DOUBT);
            let share = (1.0 - doubt) * of[child][0] / of[i][0] + doubt * part;
            densities[child] = densities[i] * share / part;
            densities[child + 1] = densities[i] * (1.0 - share) / (1.0 - part);
        }
        let mixed = |i: usize| (1.0 - even) * densities[i] + even;
        // From the densities of the boxes, so that what is chosen and what is told agree.
        let mut masses = vec![0.0f64; self.nodes.len()];
        for i in (0..self.nodes.len()).rev() {
            let child = self.nodes[i].child as usize;
            if child == 0 {
                masses[i] = mixed(i) * of[i][1];
                self.nodes[i].share = mixed(i) as f32;
            } else {
                masses[i] = masses[child] + masses[child + 1];
                self.nodes[i].share = (masses[child] / masses[i]) as f32;
            }
        }
        Bins { nodes: self.nodes }
    }
}
