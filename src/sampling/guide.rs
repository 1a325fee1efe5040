/// Where to begin in lists of ascending sums to find the first that is greater than a number in [0, 1): the interval in
/// equal parts, and for each part how many sums of a list lie below it (Chen and Asau 1974). A search takes a few steps
/// on average, however the sums are spread.
#[derive(Clone, Debug)]
pub struct Guide {
    /// Sums of each list.
    length: usize,
    /// Parts of the interval; a power of two, so that the part of a number is exact.
    parts: usize,
    /// Of each list and part.
    starts: Vec<u32>,
}

/// Sums for each part.
const SUMS: usize = 4;

impl Guide {
    /// For lists of `length` sums, one after the other in `sums`, each sorted.
    pub fn new<T: Copy + Into<f64>>(sums: &[T], length: usize) -> Self {
        let parts = (length / SUMS).next_power_of_two();
        let mut starts = Vec::with_capacity(sums.len().div_ceil(length.max(1)) * parts);
        for list in sums.chunks(length.max(1)) {
            let mut below = 0;
            for part in 0..parts {
                let low = part as f64 / parts as f64;
                while below < list.len() && list[below].into() <= low {
                    below += 1;
                }
                starts.push(below as u32);
            }
        }
        Self { length, parts, starts }
    }

    /// How many of the sums of list `number` are not greater than `u`; `sums` are those that it was made for.
    #[inline]
    pub fn count<T: Copy + Into<f64>>(&self, sums: &[T], number: usize, u: f32) -> usize {
        let list = &sums[number * self.length..(number + 1) * self.length];
        // The cast saturates: numbers outside of the interval are counted as well.
        let part = ((u * self.parts as f32) as usize).min(self.parts - 1);
        let mut count = self.starts[number * self.parts + part] as usize;
        let u = f64::from(u);
        while count < list.len() && list[count].into() <= u {
            count += 1;
        }
        count
    }

    /// Memory.
    pub fn bytes(&self) -> usize {
        size_of_val(self.starts.as_slice())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_counts_as_a_search_does() {
        let lists: [fn(f64) -> f64; 3] = [|t| t, |t| t.powi(40), |t| (t * 5.0).floor() / 5.0];
        for length in [1, 3, 4, 100, 1000] {
            let sums: Vec<f64> = lists
                .iter()
                .flat_map(|list| (0..length).map(move |i| list(f64::from(i + 1) / f64::from(length))))
                .collect();
            let length = length as usize;
            let guide = Guide::new(&sums, length);
            for (number, list) in sums.chunks(length).enumerate() {
                let ends = list.iter().map(|&sum| sum as f32);
                let below_one = 1.0 - f32::EPSILON / 2.0;
                for u in (0..4096).map(|i| i as f32 / 4096.0).chain(ends).chain([below_one]) {
                    let searched = list.partition_point(|&sum| sum <= f64::from(u));
                    assert_eq!(guide.count(&sums, number, u), searched, "{length} {number} {u}");
                }
            }
        }
    }
}
