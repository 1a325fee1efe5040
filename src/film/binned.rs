//! Sums that do not depend on the order of what is added, nor on how it is grouped (reproducible summation, after
//! Demmel and Nguyen: "Parallel Reproducible Summation", IEEE Trans. Comput. 64, 2015).
//!
//! With B = 2⁴⁰, every number x is written in balanced digits at fixed places, x = Σ d(k) Bᵏ/2²⁰, from the highest one
//! down: d(k) is what the digits above leave of x, divided by Bᵏ/2²⁰ and rounded to the nearest integer (of two to the even
//! one). d(k) depends on x and k alone, |d(k)| ≤ B/2, and the highest digit of x that is not 0 is at the least place T with
//! |x| ≤ Bᵀ⁺¹/2²¹: [`top`].
//!
//! A sum keeps the greatest T of all that was added, and the sums of the digits at the two places T and T − 1. When a
//! larger number comes, T grows, and digits that are then too low are dropped. So after any additions the sum is
//! T = max top(x), high = Σ d(T), low = Σ d(T − 1) over all numbers x that were added: for a number that came while T
//! was lower, the digits above that T are 0, and those which are still kept were kept all the time. Maximum and integer
//! sums have no order, so any permutation gives the same bits, and so does adding up two such sums
//! ([`BinnedSums::merge`]), whatever numbers they are of.
//!
//! Each number loses at most Bᵀ⁻¹/2²¹, and the largest is above Bᵀ/2²¹: the sum of n numbers is off by at most n · 2⁻⁴⁰
//! times the largest of them; on average over its place in its digit, by far less. All numbers between 2⁻²¹ and 2¹⁹, and so
//! nearly all of a picture, have the same T = 0, and lose at most 2⁻⁶¹. A digit is an `i64`, which takes 2²³ additions
//! ([`MOST_ADDITIONS`]).

use std::ops::Range;

use rayon::prelude::*;

use crate::math::simd::widest;

/// log₂ B.
const DIGIT: i64 = 40;

/// The unit of the digit at place 0 is 2 to the minus this: the border of two digits is far from what pictures hold.
const SHIFT: i64 = 20;

/// Top digits of numbers lie from here: what is below half the next one, 2⁻⁹⁸¹, is 0.
const LOWEST: i64 = -23;

/// The same for the largest numbers.
const HIGHEST: i64 = 26;

/// Places of top digits, which are counted from the lowest one: memory that is all 0 holds sums of nothing.
pub(super) const PLACES: u8 = (HIGHEST - LOWEST) as u8 + 1;

/// So many numbers may be added to a sum.
pub const MOST_ADDITIONS: u32 = 1 << 23;

/// Sums that are added to together, which is fast if they are of one size.
pub(super) const ROW: usize = 64;

/// Sums that are merged together: a unit of parallel work.
const CHUNK: usize = 1 << 14;

/// Adding this to a number below 2⁵¹ rounds it to an integer, which then stands in the low bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// 2ᵉ, infinite above the greatest exponent.
#[inline(always)]
fn power(e: i64) -> f64 {
    f64::from_bits(((1023 + e).min(2047) as u64) << 52)
}

/// The greatest number whose top digit is at this place.
#[inline(always)]
fn limit(top: i64) -> f64 {
    power(DIGIT * (top + 1) - SHIFT - 1)
}

/// What makes 1 of the unit of the digit below `top`.
#[inline(always)]
fn scale(top: i64) -> f64 {
    power(SHIFT - DIGIT * (top - 1))
}

/// The place of the highest digit of a finite number; the lowest place for 0.
#[inline(always)]
fn top(x: f64) -> i64 {
    /// What makes the exponent of any number positive: so many digits.
    const ABOVE: i64 = 30;
    let bits = x.abs().to_bits() as i64;
    // The least e with |x| ≤ 2ᵉ.
    let e = (bits >> 52) - 1023 + i64::from(bits << 12 != 0);
    // A fortieth, exact up to 2¹⁵.
    let place = ((e + SHIFT + (ABOVE + 1) * DIGIT) * 52_429) >> 21;
    (place - ABOVE - 1).clamp(LOWEST, HIGHEST)
}

/// The two digits of a number from the higher one on, of which `scale` is that of the place; it must not be below the
/// number's own.
#[inline(always)]
fn digits(x: f64, scale: f64) -> [i64; 2] {
    let integer = |rounded: f64| (rounded.to_bits() as i64).wrapping_sub(ROUND.to_bits() as i64);
    let scaled = x * scale;
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
    pub(super) top: Vec<u8>,
}

/// Some of them, to add to.
#[derive(Debug)]
pub struct Binned<'a> {
    high: &'a mut [i64],
    low: &'a mut [i64],
    top: &'a mut [u8],
}

impl BinnedSums {
    /// Bytes of a sum.
    pub const BYTES: usize = 2 * size_of::<i64>() + size_of::<i8>();

    /// So many sums of nothing.
    pub fn new(count: usize) -> Self {
        Self { high: vec![0; count], low: vec![0; count], top: vec![0; count] }
    }

    /// Makes it so many sums.
    pub fn resize(&mut self, count: usize) {
        self.high.resize(count, 0);
        self.low.resize(count, 0);
        self.top.resize(count, 0);
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
    #[inline]
    pub fn get(&self, at: usize) -> f64 {
        let unit = power(DIGIT * (i64::from(self.top[at]) + LOWEST - 1) - SHIFT);
        let [high, low] = [self.high[at], self.low[at]].map(|digit| digit as f64);
        (high * power(DIGIT) + low) * unit
    }

    /// Adds some of the sums, from `first` on, to as many numbers.
    #[inline]
    pub(super) fn add_to(&self, first: usize, numbers: &mut [f64]) {
        numbers.iter_mut().enumerate().for_each(|(i, number)| *number += self.get(first + i));
    }

    /// Adds copies of some of the sums of another row.
    pub(super) fn extend(&mut self, from: &Self, range: Range<usize>) {
        self.high.extend_from_slice(&from.high[range.clone()]);
        self.low.extend_from_slice(&from.low[range.clone()]);
        self.top.extend_from_slice(&from.top[range]);
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

    /// All of them.
    pub fn all(&mut self) -> Binned<'_> {
        Binned { high: &mut self.high, low: &mut self.low, top: &mut self.top }
    }

    /// In chunks of so many sums.
    pub fn par_chunks_mut(&mut self, size: usize) -> impl IndexedParallelIterator<Item = Binned<'_>> {
        let size = size.max(1);
        let digits = self.high.par_chunks_mut(size).zip(self.low.par_chunks_mut(size));
        digits.zip(self.top.par_chunks_mut(size)).map(|((high, low), top)| Binned { high, low, top })
    }
}

impl Binned<'_> {
    /// In chunks of so many sums.
    pub fn chunks(self, size: usize) -> impl Iterator<Item = Self> {
        let size = size.max(1);
        let digits = self.high.chunks_mut(size).zip(self.low.chunks_mut(size));
        digits.zip(self.top.chunks_mut(size)).map(|((high, low), top)| Binned { high, low, top })
    }

    /// Sums.
    pub fn len(&self) -> usize {
        self.top.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.top.is_empty()
    }

    /// Some of them.
    pub fn part(&mut self, range: Range<usize>) -> Binned<'_> {
        let [high, low] = [&mut *self.high, &mut *self.low].map(|digits| &mut digits[range.clone()]);
        Binned { high, low, top: &mut self.top[range] }
    }

    /// Adds a number to each of as many sums; what is not finite is left out.
    pub fn add(&mut self, values: &[f64]) {
        let Self { high, low, top } = self;
        let digits = high.chunks_mut(ROW).zip(low.chunks_mut(ROW));
        for ((values, top), (high, low)) in values.chunks(ROW).zip(top.chunks_mut(ROW)).zip(digits) {
            add_row(values, top, high, low);
        }
    }

    /// Adds a sum, of which `top` is the place of the first of the two digits.
    #[inline]
    fn merge_one(&mut self, at: usize, top: u8, digits: [i64; 2]) {
        let (high, low) = (&mut self.high[at], &mut self.low[at]);
        let new = self.top[at].max(top);
        [*high, *low] = lifted(i64::from(new - self.top[at]), [*high, *low]);
        self.top[at] = new;
        // What a damaged file holds may overflow, and is only wrong then.
        match self.top[at] - top {
            0 => (*high, *low) = (high.wrapping_add(digits[0]), low.wrapping_add(digits[1])),
            1 => *low = low.wrapping_add(digits[0]),
            _ => {}
        }
    }
}

/// The digits of a sum when its top is raised by so many places.
#[inline(always)]
fn lifted(by: i64, [high, low]: [i64; 2]) -> [i64; 2] {
    let [stay, fall] = [0, 1].map(|places| -i64::from(by == places));
    [high & stay, low & stay | high & fall]
}

fn add_row(values: &[f64], top: &mut [u8], high: &mut [i64], low: &mut [i64]) {
    widest!(
        row_added;
        values: &[f64] = values, top: &mut [u8] = top, high: &mut [i64] = high, low: &mut [i64] = low => ()
    );
}

/// Most rows are all 0 (a layer without light), or of one size.
#[inline(always)]
fn row_added(values: &[f64], top: &mut [u8], high: &mut [i64], low: &mut [i64]) {
    // Without branches for each, which seldom are of use.
    if values.iter().fold(0, |any, x| any | x.to_bits() << 1) == 0 {
        return;
    }
    let place = top.first().copied().unwrap_or(0);
    let of_all = LOWEST + i64::from(place);
    let (most, scale) = (limit(of_all), scale(of_all));
    let other = top.iter().fold(false, |other, top| other | (*top != place));
    // What is no number is no row of one size either.
    let large = values.iter().fold(false, |large, x| large | x.is_nan() | (x.abs() > most));
    if other | large {
        return mixed_row_added(values, top, high, low);
    }
    for ((x, high), low) in values.iter().zip(high).zip(low) {
        let digits = digits(*x, scale);
        *high = high.wrapping_add(digits[0]);
        *low = low.wrapping_add(digits[1]);
    }
}

/// Without branches too: all rows of a first pass are of this kind.
#[inline(always)]
fn mixed_row_added(values: &[f64], top: &mut [u8], high: &mut [i64], low: &mut [i64]) {
    for (((x, place), high), low) in values.iter().zip(top).zip(high).zip(low) {
        let x = if x.is_finite() { *x } else { 0.0 };
        let old = LOWEST + i64::from(*place);
        let new = self::top(x).max(old);
        let digits = digits(x, scale(new));
        let lifted = lifted(new - old, [*high, *low]);
        *high = lifted[0].wrapping_add(digits[0]);
        *low = lifted[1].wrapping_add(digits[1]);
        *place = (new - LOWEST) as u8;
    }
}

#[cfg(test)]
mod tests;
