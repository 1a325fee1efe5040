//! Counter-based random numbers: the n-th number of a stream is a hash of (key, n), so work can be split among
//! threads in any way.

/// The SplitMix64 finaliser (Steele, Lea and Flood 2014): a bijection of u64 with full avalanche.
#[inline(always)]
pub fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// The increment of SplitMix64: 2⁶⁴ divided by the golden ratio, made odd.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A SplitMix64 stream.
#[derive(Clone, Copy, Debug)]
pub struct CounterRng {
    state: u64,
}

impl CounterRng {
    /// The stream of (`key`, `index`); distinct pairs give independent streams.
    pub fn new(key: u64, index: u64) -> Self {
        Self { state: mix(key ^ mix(index.wrapping_add(GOLDEN))) }
    }

    /// Uniform over all 64-bit values.
    #[inline]
    pub fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(GOLDEN);
        mix(self.state)
    }

    /// Uniform in [0, 1).
    #[inline]
    pub fn next_f32(&mut self) -> f32 {
        unit_float((self.next_u64() >> 32) as u32)
    }

    /// Two independent numbers, uniform in [0, 1), from the two halves of one draw.
    #[inline]
    pub fn next_2d(&mut self) -> [f32; 2] {
        let x = self.next_u64();
        [unit_float((x >> 32) as u32), unit_float(x as u32)]
    }
}

/// The top 24 bits as a float in [0, 1); exact, so never rounded up to 1.
#[inline(always)]
pub fn unit_float(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

impl rand::rand_core::TryRng for CounterRng {
    type Error = std::convert::Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Self::Error> {
        Ok((self.next_u64() >> 32) as u32)
    }

    fn try_next_u64(&mut self) -> Result<u64, Self::Error> {
        Ok(self.next_u64())
    }

    fn try_fill_bytes(&mut self, dst: &mut [u8]) -> Result<(), Self::Error> {
        for chunk in dst.chunks_mut(8) {
            chunk.copy_from_slice(&self.next_u64().to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}
