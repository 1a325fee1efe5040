//! Sums as bytes, in files: without the zeros at the head of their digits.

use rayon::prelude::*;

use super::binned::{BinnedSums, PLACES};

/// Sums that are packed together.
const BLOCK: usize = 1 << 14;

/// A byte from here on stands for sums of nothing: for one, for two, ... Others at the begin of a sum are its place.
const NOTHING: u8 = 128;

/// Sums of nothing that a byte can stand for.
const MOST_NOTHING: usize = 128;

impl BinnedSums {
    /// Most bytes of a sum in [`BinnedSums::pack`].
    pub const PACKED: usize = 2 + 2 * size_of::<i64>();

    /// Adds the sums to `out`, as bytes that do not depend on the machine.
    pub fn pack(&self, out: &mut Vec<u8>) {
        let digits = self.high.par_chunks(BLOCK).zip(self.low.par_chunks(BLOCK));
        let blocks = digits.zip(self.top.par_chunks(BLOCK));
        let packed: Vec<Vec<u8>> = blocks.map(|((high, low), top)| packed(high, low, top)).collect();
        for block in packed {
            out.extend((block.len() as u32).to_le_bytes());
            out.extend(block);
        }
    }

    /// So many sums from the head of `bytes`, which lose them. `None` where they are not there.
    pub fn unpack(count: usize, bytes: &mut &[u8]) -> Option<Self> {
        let mut blocks = Vec::new();
        for first in (0..count).step_by(BLOCK) {
            let (size, rest) = bytes.split_at_checked(4)?;
            let size = u32::from_le_bytes(size.try_into().ok()?) as usize;
            let (block, rest) = rest.split_at_checked(size)?;
            blocks.push((block, BLOCK.min(count - first)));
            *bytes = rest;
        }
        let parts: Option<Vec<Self>> =
            blocks.into_par_iter().map(|(block, count)| unpacked(block, count)).collect();
        let mut all = Self::default();
        parts?.iter().for_each(|part| all.extend(part, 0..part.len()));
        Some(all)
    }
}

fn packed(high: &[i64], low: &[i64], top: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(high.len() * 8);
    let mut nothing = 0;
    for ((high, low), top) in high.iter().zip(low).zip(top) {
        if *top == 0 && *high == 0 && *low == 0 {
            nothing += 1;
            if nothing == MOST_NOTHING {
                end_of_nothing(&mut nothing, &mut out);
            }
            continue;
        }
        end_of_nothing(&mut nothing, &mut out);
        // The sign goes into the lowest bit.
        let digits = [*high, *low].map(|digit| ((digit << 1) ^ (digit >> 63)) as u64);
        let sizes = digits.map(|digit| 8 - digit.leading_zeros() as usize / 8);
        out.extend([*top, (sizes[0] << 4 | sizes[1]) as u8]);
        for (digit, size) in digits.iter().zip(sizes) {
            out.extend_from_slice(&digit.to_le_bytes()[..size]);
        }
    }
    end_of_nothing(&mut nothing, &mut out);
    out
}

fn end_of_nothing(count: &mut usize, out: &mut Vec<u8>) {
    if *count > 0 {
        out.push(NOTHING + (*count - 1) as u8);
        *count = 0;
    }
}

fn unpacked(bytes: &[u8], count: usize) -> Option<BinnedSums> {
    if bytes.len() < count.div_ceil(MOST_NOTHING) {
        return None;
    }
    let mut sums = BinnedSums::new(count);
    let mut rest = bytes;
    let mut at = 0;
    while let Some((&first, more)) = rest.split_first() {
        rest = more;
        if first >= NOTHING {
            at += usize::from(first - NOTHING) + 1;
            continue;
        }
        let (&sizes, more) = rest.split_first()?;
        rest = more;
        let mut digit = |size: u8| {
            let (head, tail) = rest.split_at_checked(usize::from(size))?;
            rest = tail;
            let mut bytes = [0; 8];
            bytes.get_mut(..head.len())?.copy_from_slice(head);
            let digit = u64::from_le_bytes(bytes);
            Some((digit >> 1) as i64 ^ -((digit & 1) as i64))
        };
        let (high, low) = (digit(sizes >> 4)?, digit(sizes & 15)?);
        *sums.high.get_mut(at)? = high;
        sums.low[at] = low;
        sums.top[at] = Some(first).filter(|top| *top < PLACES)?;
        at += 1;
    }
    (at == count).then_some(sums)
}
