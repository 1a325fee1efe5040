//! Sums that do not depend on the order of what is added, nor on how it is grouped (reproducible summation, after
//! Demmel and Nguyen: "Parallel Reproducible Summation", IEEE Trans. Comput. 64, 2015).
//!
//! With B = 2⁴⁰, every number x is written in balanced digits at fixed places, x = Σ d(k) Bᵏ, from the highest one down:
//! d(k) is what the digits above leave of x, divided by Bᵏ and rounded to the nearest integer (of two to the even one).
//! d(k) depends on x and k alone, |d(k)| ≤ B/2, and the highest digit of x that is not 0 is at the least place T with
//! |x| ≤ Bᵀ⁺¹/2: [`top`].
//!
//! A sum keeps the greatest T of all that was added, and the sums of the digits at the two places T and T − 1. When a
//! larger number comes, T grows, and digits that are then too low are dropped. So after any additions the sum is
//! T = max top(x), high = Σ d(T), low = Σ d(T − 1) over all numbers x that were added: for a number that came while T
//! was lower, the digits above that T are 0, and those which are still kept were kept all the time. Maximum and integer
//! sums have no order, so any permutation gives the same bits, and so does adding up two such sums ([`Binned::merge`]),
//! whatever numbers they are of.
//!
//! Each number loses at most Bᵀ⁻¹/2, and the largest is above Bᵀ/2: the sum of n numbers is off by at most n · 2⁻⁴⁰ times
//! the largest of them; on average over its place in its digit, by far less. An `i64` takes 2²³ additions of numbers and
//! 2²⁴ are safe ([`MOST_ADDITIONS`]).

use rayon::prelude::*;

use crate::math::simd::widest;

/// log₂ B.
const DIGIT: i32 = 40;

/// Top digits of numbers lie from here ...
pub(super) const LOWEST: i8 = -24;

/// ... to here. What is below B²⁵ᐟ² of the lowest, 2⁻¹⁰⁰⁰, is 0.
pub(super) const HIGHEST: i8 = 25;

/// So many numbers may be added to a sum before it may overflow.
pub const MOST_ADDITIONS: u32 = 1 << 23;

/// Numbers that are added together: a unit of parallel work.
const CHUNK: usize = 1 << 14;

/// Adding this to a number below 2⁵¹ rounds it to an integer, which then stands in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// 2ᵉ, infinite above the greatest exponent.
#[inline(always)]
fn power(e: i32) -> f64 {
    f64::from_bits(((1023 + e).min(2047) as u64) << 52)
}

/// The greatest number whose top digit is at this place.
#[inline(always)]
fn limit(top: i8) -> f64 {
    power(DIGIT * (i32::from(top) + 1) - 1)
}

/// The place of the highest digit of a number that is not 0.
fn top(x: f64) -> i8 {
    let (mut low, mut high) = (LOWEST, HIGHEST);
    while low < high {
        let middle = low + (high - low) / 2;
        if x.abs() <= limit(middle) { high = middle } else { low = middle + 1 }
    }
    low
}

/// The digits of a number at the places `top`, which must not be below its own, and `top` − 1.
#[inline(always)]
fn digits(x: f64, top: i8) -> [i64; 2] {
    let integer = |rounded: f64| (rounded.to_bits() as i64).wrapping_sub(ROUND.to_bits() as i64);
    let scaled = x * power(-DIGIT * (i32::from(top) - 1));
    let high = scaled * power(-DIGIT) + ROUND;
    // Exact: a multiple of the last bit of `scaled`, and below 2⁵² of them.
    let rest = scaled - (high - ROUND) * power(DIGIT);
    [integer(high), integer(rest + ROUND)]
}

/// A row of sums.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BinnedSums {
    pub(super) high: Vec<i64>,
    pub(super) low: Vec<i64>,
    pub(super) top: Vec<i8>,
}

/// Some of them, to add to.
#[derive(Debug)]
pub struct Binned<'a> {
    high: &'a mut [i64],
    low: &'a mut [i64],
    top: &'a mut [i8],
}

impl BinnedSums {
    /// Bytes of a sum.
    pub const BYTES: usize = 2 * size_of::<i64>() + size_of::<i8>();

    /// So many sums of nothing.
    pub fn new(count: usize) -> Self {
        Self { high: vec![0; count], low: vec![0; count], top: vec![LOWEST; count] }
    }

    /// Makes it so many sums.
    pub fn resize(&mut self, count: usize) {
        self.high.resize(count, 0);
        self.low.resize(count, 0);
        self.top.resize(count, LOWEST);
    }

    /// Sums.
    pub fn len(&self) -> usize {
        self.top.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.top.is_empty()
    }

    /// Bytes of memory.
    pub fn bytes(&self) -> usize {
        self.len() * Self::BYTES
    }

    /// A sum.
    pub fn get(&self, at: usize) -> f64 {
        let place = DIGIT * (i32::from(self.top[at]) - 1);
        let [high, low] = [self.high[at], self.low[at]].map(|digit| digit as f64);
        (high * power(DIGIT) + low) * power(place)
    }

    /// The sums at the places `first`, `first + step` and so on.
    #[must_use]
    pub fn every(&self, first: usize, step: usize) -> Self {
        let places = || (first..self.len()).step_by(step.max(1));
        Self {
            high: places().map(|i| self.high[i]).collect(),
            low: places().map(|i| self.low[i]).collect(),
            top: places().map(|i| self.top[i]).collect(),
        }
    }

    /// Adds what is in another row, sum by sum.
    ///
    /// # Panics
    /// When the rows are not equally long.
    pub fn merge(&mut self, other: &Self) {
        assert_eq!(self.len(), other.len(), "rows of sums are equally long");
        let theirs = other.high.par_chunks(CHUNK).zip(other.low.par_chunks(CHUNK));
        let theirs = theirs.zip(other.top.par_chunks(CHUNK));
        self.par_chunks_mut(CHUNK).zip(theirs).for_each(|(mut ours, ((high, low), top))| {
            for (i, ((high, low), top)) in high.iter().zip(low).zip(top).enumerate() {
                ours.merge_one(i, *top, [*high, *low]);
            }
        });
    }

    /// In chunks of so many sums.
    pub fn par_chunks_mut(&mut self, size: usize) -> impl IndexedParallelIterator<Item = Binned<'_>> {
        let size = size.max(1);
        let digits = self.high.par_chunks_mut(size).zip(self.low.par_chunks_mut(size));
        digits.zip(self.top.par_chunks_mut(size)).map(|((high, low), top)| Binned { high, low, top })
    }
}

impl Binned<'_> {
    /// Adds a number to each of as many sums; what is not finite is left out.
    pub fn add(&mut self, values: &[f64]) {
        let Self { high, low, top } = self;
        if any_above(values, top) {
            raise(values, top, high, low);
        }
        add_digits(values, top, high, low);
    }

    /// Adds a sum, of which `top` is the place of the first of the two digits.
    #[inline]
    fn merge_one(&mut self, at: usize, top: i8, digits: [i64; 2]) {
        let (high, low) = (&mut self.high[at], &mut self.low[at]);
        if top > self.top[at] {
            lift(top, &mut self.top[at], high, low);
        }
        // What a damaged file holds may overflow, and is only wrong then.
        match self.top[at] - top {
            0 => (*high, *low) = (high.wrapping_add(digits[0]), low.wrapping_add(digits[1])),
            1 => *low = low.wrapping_add(digits[0]),
            _ => {}
        }
    }
}

#[inline(always)]
fn row<'a>(
    top: &'a mut [i8],
    high: &'a mut [i64],
    low: &'a mut [i64],
    values: &'a [f64],
) -> impl Iterator<Item = (&'a mut i8, &'a mut i64, &'a mut i64, &'a f64)> {
    top.iter_mut().zip(high).zip(low).zip(values).map(|(((top, high), low), x)| (top, high, low, x))
}

/// Makes room for numbers that are larger than any before.
#[cold]
fn raise(values: &[f64], tops: &mut [i8], high: &mut [i64], low: &mut [i64]) {
    for (place, high, low, x) in row(tops, high, low, values) {
        if x.is_finite() && x.abs() > limit(*place) {
            lift(top(*x), place, high, low);
        }
    }
}

/// Moves the digits of a sum to a higher place.
fn lift(to: i8, top: &mut i8, high: &mut i64, low: &mut i64) {
    *low = if to == *top + 1 { *high } else { 0 };
    *high = 0;
    *top = to;
}

/// Whether a number is too large for its sum as it is, or not finite.
fn any_above(values: &[f64], top: &[i8]) -> bool {
    widest!(is_any_above; values: &[f64] = values, top: &[i8] = top => bool)
}

#[inline(always)]
fn is_any_above(values: &[f64], top: &[i8]) -> bool {
    // Without a branch for each: it seldom is.
    values.iter().zip(top).fold(false, |any, (x, top)| any | !(x.abs() <= limit(*top)))
}

fn add_digits(values: &[f64], top: &mut [i8], high: &mut [i64], low: &mut [i64]) {
    widest!(
        digits_added;
        values: &[f64] = values, top: &mut [i8] = top, high: &mut [i64] = high, low: &mut [i64] = low => ()
    );
}

#[inline(always)]
fn digits_added(values: &[f64], top: &mut [i8], high: &mut [i64], low: &mut [i64]) {
    for (top, high, low, x) in row(top, high, low, values) {
        let x = if x.is_finite() { *x } else { 0.0 };
        let [h, l] = digits(x, *top);
        *high = high.wrapping_add(h);
        *low = low.wrapping_add(l);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The sum of one number after another.
    fn summed(values: &[f64]) -> BinnedSums {
        let mut sums = BinnedSums::new(1);
        values.iter().for_each(|x| sums.par_chunks_mut(1).for_each(|mut sum| sum.add(&[*x])));
        sums
    }

    /// Numbers of all sizes, of nearly one size, and those on the border of two digits.
    fn number() -> impl Strategy<Value = f64> {
        let border = (-24i32..25, -3i64..4, any::<bool>()).prop_map(|(place, off, negative)| {
            let x = f64::from_bits((power(DIGIT * place - 1).to_bits() as i64 + off) as u64);
            if negative { -x } else { x }
        });
        prop_oneof![
            any::<f64>().prop_filter("finite", |x| x.is_finite() && x.abs() < 1e300),
            -1.0..1.0f64,
            border,
            any::<f32>().prop_filter("finite", |x| x.is_finite()).prop_map(f64::from),
            Just(0.0),
        ]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// Any order and any grouping give the same bits.
        #[test]
        fn sums_have_no_order(
            values in prop::collection::vec(number(), 1..40),
            seed in any::<u64>(),
            cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..4),
        ) {
            let whole = summed(&values);
            let mut shuffled = values.clone();
            let key = |x: &f64| crate::sampling::mix(x.to_bits() ^ seed);
            shuffled.sort_by_key(key);
            prop_assert_eq!(&whole, &summed(&shuffled));
            let mut cuts: Vec<usize> = cuts.iter().map(|cut| cut.index(values.len())).collect();
            cuts.extend([0, values.len()]);
            cuts.sort_unstable();
            let mut parts: Vec<BinnedSums> =
                cuts.windows(2).map(|cut| summed(&shuffled[cut[0]..cut[1]])).collect();
            parts.reverse();
            let mut merged = BinnedSums::new(1);
            parts.iter().for_each(|part| merged.merge(part));
            prop_assert_eq!(&whole, &merged);
        }

        /// Off by 2⁻⁴⁰ of the largest for each number at most. Multiples of 2⁻⁵⁰ below 2²⁰ are added exactly as integers
        /// here; reading the sum rounds it to f64, which 2⁻⁵² of it allows for.
        #[test]
        fn sums_are_as_exact_as_they_say(
            values in prop::collection::vec((-(1i64 << 52)..1 << 52, 0u32..50), 1..40),
        ) {
            let values: Vec<i64> = values.into_iter().map(|(x, shift)| x >> shift).collect();
            let unit = power(-50);
            let exact = values.iter().map(|x| i128::from(*x)).sum::<i128>() as f64 * unit;
            let numbers: Vec<f64> = values.iter().map(|x| *x as f64 * unit).collect();
            let largest = numbers.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            let bound = numbers.len() as f64 * power(-40) * largest + exact.abs() * power(-52);
            let sum = summed(&numbers).get(0);
            prop_assert!((sum - exact).abs() <= bound, "{} against {}", sum, exact);
        }

        /// Bytes give the sums again.
        #[test]
        fn packed_sums_are_the_same(rows in prop::collection::vec(prop::collection::vec(number(), 0..5), 1..300)) {
            let mut sums = BinnedSums::new(rows.len());
            for add in 0..5 {
                let values: Vec<f64> = rows.iter().map(|row| row.get(add).copied().unwrap_or(0.0)).collect();
                sums.par_chunks_mut(rows.len()).for_each(|mut sums| sums.add(&values));
            }
            let mut bytes = Vec::new();
            sums.pack(&mut bytes);
            prop_assert!(bytes.len() <= 4 + sums.len() * BinnedSums::PACKED);
            let mut rest = &bytes[..];
            let again = BinnedSums::unpack(sums.len(), &mut rest);
            prop_assert_eq!(again.as_ref(), Some(&sums));
            prop_assert!(rest.is_empty());
        }
    }

    /// As many of the largest digits as may be added do not overflow.
    #[test]
    fn the_largest_digits_do_not_overflow() {
        let x = power(DIGIT - 1);
        let mut sums = summed(&[x]);
        assert_eq!(sums.high, [1 << (DIGIT - 1)]);
        for doubled in 1..=23 {
            let same = sums.clone();
            sums.merge(&same);
            assert_eq!(sums.get(0), x * power(doubled));
        }
        assert_eq!(MOST_ADDITIONS, 1 << 23);
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        let odd = [1.5, f64::NAN, f64::INFINITY, -0.25, f64::NEG_INFINITY];
        assert_eq!(summed(&odd), summed(&[-0.25, 1.5]));
        assert_eq!(summed(&odd).get(0), 1.25);
    }

    /// What f64 sums would lose: the small ones beside the large one, which then goes.
    #[test]
    fn a_large_number_that_is_taken_back_leaves_the_small_ones() {
        assert_eq!(summed(&[1e9, 1e-9, -1e9]).get(0), summed(&[1e-9, 1e9, -1e9]).get(0));
        assert!((summed(&[1e9, 1e-9, -1e9]).get(0) - 1e-9).abs() <= 3.0 * power(-40) * 1e9);
    }
}
