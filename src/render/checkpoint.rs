//! Checkpoints: the sums so far, and what they are sums of.

use std::io;
use std::path::Path;

use thiserror::Error;

use crate::film::{Doublings, Pixels, STRIDE};

/// A render that can go on.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// What must agree for a resumed render to be the same render: name and value, such as the scene's
    /// hash, the settings, the film and the program's version.
    pub identity: Vec<(String, String)>,
    /// Passes that are in the sums.
    pub passes: u32,
    /// Their sums.
    pub pixels: Pixels,
}

/// Why a render cannot go on from a checkpoint.
#[derive(Debug, Error)]
pub enum CheckpointError {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The bytes are no whole checkpoint; what is wrong with them.
    #[error("it is not a checkpoint, or it is damaged ({0})")]
    Invalid(&'static str),
    /// It is the checkpoint of another render.
    #[error("it belongs to another render: {name} was `{was}`, now it is `{now}`")]
    Different {
        /// What differs: a setting, the scene's hash, the film, the program's version.
        name: String,
        /// Its value in the checkpoint.
        was: String,
        /// Its value now.
        now: String,
    },
}

const MAGIC: &[u8; 8] = b"caustic3";

fn text(out: &mut Vec<u8>, s: &str) {
    out.extend((s.len() as u32).to_le_bytes());
    out.extend(s.as_bytes());
}

/// FNV-1a over words, then over what is left: a torn or damaged file is noticed, not trusted.
fn checksum(bytes: &[u8]) -> u64 {
    let step = |h: u64, w: u64| (h ^ w).wrapping_mul(0x0100_0000_01b3);
    let (words, rest) = bytes.as_chunks::<8>();
    let whole = words.iter().fold(0xcbf2_9ce4_8422_2325, |h, w| step(h, u64::from_le_bytes(*w)));
    rest.iter().fold(whole, |h, &b| step(h, u64::from(b)))
}

struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, n: usize) -> Result<&'a [u8], CheckpointError> {
        let (head, tail) = self.0.split_at_checked(n).ok_or(CheckpointError::Invalid("it ends too early"))?;
        self.0 = tail;
        Ok(head)
    }

    fn u32(&mut self) -> Result<u32, CheckpointError> {
        let bytes = self.take(4)?;
        Ok(u32::from_le_bytes(bytes.try_into().map_err(|_| CheckpointError::Invalid("it ends too early"))?))
    }

    /// So many f64.
    fn numbers(
        &mut self,
        count: usize,
    ) -> Result<impl Iterator<Item = f64> + Clone + use<'a>, CheckpointError> {
        let bytes = self.take(count.checked_mul(8).ok_or(CheckpointError::Invalid("its size is absurd"))?)?;
        Ok(bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)))
    }

    fn text(&mut self) -> Result<String, CheckpointError> {
        let n = self.u32()? as usize;
        String::from_utf8(self.take(n)?.to_vec()).map_err(|_| CheckpointError::Invalid("a text is not UTF-8"))
    }
}

impl Checkpoint {
    /// The bytes of a file.
    pub fn encode(identity: &[(String, String)], passes: u32, pixels: &Pixels) -> Vec<u8> {
        let mut out = Vec::with_capacity(4096 + size_of_val(pixels.as_slice()));
        out.extend(MAGIC);
        out.extend((identity.len() as u32).to_le_bytes());
        for (name, value) in identity {
            text(&mut out, name);
            text(&mut out, value);
        }
        out.extend(passes.to_le_bytes());
        out.extend((pixels.len() as u32).to_le_bytes());
        for value in pixels.as_slice().iter().flatten() {
            out.extend_from_slice(&value.to_le_bytes());
        }
        let (luminance, steps) = pixels.doublings().parts();
        for numbers in [luminance, steps] {
            out.extend((numbers.len() as u32).to_le_bytes());
            numbers.iter().for_each(|v| out.extend_from_slice(&v.to_le_bytes()));
        }
        if !pixels.aovs().is_empty() {
            out.extend(((pixels.aovs().len() / pixels.len()) as u32).to_le_bytes());
            pixels.aovs().iter().for_each(|v| out.extend_from_slice(&v.to_le_bytes()));
        }
        let sum = checksum(&out);
        out.extend(sum.to_le_bytes());
        out
    }

    /// A checkpoint from the bytes of a file.
    ///
    /// # Errors
    /// When the bytes are no whole checkpoint.
    pub fn decode(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let damaged = CheckpointError::Invalid("its checksum is wrong");
        let (payload, sum) = bytes
            .split_at_checked(bytes.len().saturating_sub(8))
            .ok_or(CheckpointError::Invalid("it is empty"))?;
        if payload.len() < MAGIC.len() || &payload[..MAGIC.len()] != MAGIC {
            return Err(CheckpointError::Invalid("its first bytes are not ours"));
        }
        if sum != checksum(payload).to_le_bytes() {
            return Err(damaged);
        }
        let mut r = Reader(&payload[MAGIC.len()..]);
        let fields = r.u32()?;
        let mut identity = Vec::new();
        for _ in 0..fields {
            identity.push((r.text()?, r.text()?));
        }
        let passes = r.u32()?;
        let count = r.u32()? as usize;
        let values = r.numbers(count.saturating_mul(STRIDE))?;
        if !values.clone().all(f64::is_finite) {
            return Err(CheckpointError::Invalid("a number in it is not finite"));
        }
        let mut pixels = Pixels::new(count);
        pixels.as_mut_slice().iter_mut().flatten().zip(values).for_each(|(to, from)| *to = from);
        let mut list = || {
            let count = r.u32()? as usize;
            Ok::<_, CheckpointError>(r.numbers(count)?.collect())
        };
        pixels.set_doublings(Doublings::from_parts(list()?, list()?));
        // Only where the render makes some.
        if !r.0.is_empty() {
            let numbers = r.u32()? as usize;
            let values = r.numbers(count.saturating_mul(numbers))?;
            if !values.clone().all(f64::is_finite) {
                return Err(CheckpointError::Invalid("a number in it is not finite"));
            }
            pixels.hold_aovs(numbers);
            pixels.parts_mut().1.iter_mut().zip(values).for_each(|(to, from)| *to = from);
        }
        Ok(Self { identity, passes, pixels })
    }

    /// A checkpoint from a file.
    ///
    /// # Errors
    /// When the file cannot be read or is no whole checkpoint.
    pub fn read(path: &Path) -> Result<Self, CheckpointError> {
        Self::decode(&std::fs::read(path)?)
    }

    /// Makes sure that this is a checkpoint of the render that `identity` describes.
    ///
    /// # Errors
    /// The first thing in which the two renders differ.
    pub fn check(&self, identity: &[(String, String)]) -> Result<(), CheckpointError> {
        for (name, now) in identity {
            let was = self.identity.iter().find(|(n, _)| n == name).map_or("absent", |(_, v)| v.as_str());
            if was != now {
                return Err(CheckpointError::Different {
                    name: name.clone(),
                    was: was.to_owned(),
                    now: now.clone(),
                });
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> Checkpoint {
        let mut pixels = Pixels::new(3);
        pixels.as_mut_slice()[1][2] = 0.1 + 0.2;
        pixels.pass_done(1);
        Checkpoint { identity: vec![("seed".into(), "7".into())], passes: 12, pixels }
    }

    #[test]
    fn reads_back_every_bit_and_refuses_damage() {
        survives(&example());
        let mut with_aovs = example();
        with_aovs.pixels.hold_aovs(2);
        with_aovs.pixels.parts_mut().1[3] = 0.7;
        survives(&with_aovs);
    }

    fn survives(c: &Checkpoint) {
        let bytes = Checkpoint::encode(&c.identity, c.passes, &c.pixels);
        assert_eq!(&Checkpoint::decode(&bytes).unwrap(), c);
        for n in 0..bytes.len() {
            assert!(Checkpoint::decode(&bytes[..n]).is_err());
            let mut broken = bytes.clone();
            broken[n] ^= 4;
            assert!(Checkpoint::decode(&broken).is_err());
        }
    }

    #[test]
    fn names_what_differs() {
        let other = [("seed".to_owned(), "8".to_owned())];
        let message = example().check(&other).unwrap_err().to_string();
        assert_eq!(message, "it belongs to another render: seed was `7`, now it is `8`");
    }
}
