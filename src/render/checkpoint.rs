//! Checkpoints: the sums of some passes, and what they are sums of.

use std::collections::BTreeMap;
use std::io::{self, Read};
use std::path::Path;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::film::{BinnedSums, Common, Counts, Doublings, Pixels, STRIDE};

/// What a checkpoint says of its sums, before them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// What must agree for two checkpoints to be of one render: name and value, such as the scene's hash, the settings,
    /// the film and the program's version.
    pub identity: Vec<(String, String)>,
    /// What writing the picture takes beside the sums, in the words of who wrote the checkpoint.
    pub about: String,
    /// The first pass that is in the sums, from 0.
    pub first: u32,
    /// How many passes are in the sums.
    pub passes: u32,
    /// The pass after the last one of the range that was asked for; 0 where none was.
    pub until: u32,
    /// Passes that the whole render is to have; 0 where that is not known.
    pub whole: u32,
}

/// A render that can go on, or be merged with others.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    /// What it is.
    pub head: Head,
    /// Sums of its passes.
    pub pixels: Pixels,
}

/// Why a checkpoint is of no use.
#[derive(Debug, Error)]
pub enum CheckpointError {
    /// The file cannot be read.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The bytes are no whole checkpoint; what is wrong with them.
    #[error("it is not a checkpoint, or it is damaged ({0})")]
    Invalid(&'static str),
    /// It was written by another version of the program, in another format.
    #[error("it was written by another version of caustica; render it again with this one")]
    OtherVersion,
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
    /// Its passes are not those that are wanted.
    #[error("it holds passes {}..{}, and {wanted} were asked for", .held[0], .held[1])]
    OtherPasses {
        /// The first one, and the one after the last.
        held: [u32; 2],
        /// In words.
        wanted: String,
    },
}

const MAGIC: &[u8; 8] = b"caustic6";

/// What all versions begin with.
const FAMILY: usize = 7;

/// FNV-1a over words, then over what is left: a torn or damaged file is noticed, not trusted.
fn checksum(bytes: &[u8]) -> u64 {
    let step = |h: u64, w: u64| (h ^ w).wrapping_mul(0x0100_0000_01b3);
    let (words, rest) = bytes.as_chunks::<8>();
    let whole = words.iter().fold(0xcbf2_9ce4_8422_2325, |h, w| step(h, u64::from_le_bytes(*w)));
    rest.iter().fold(whole, |h, &b| step(h, u64::from(b)))
}

fn early() -> CheckpointError {
    CheckpointError::Invalid("it ends too early")
}

struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, n: usize) -> Result<&'a [u8], CheckpointError> {
        let (head, tail) = self.0.split_at_checked(n).ok_or_else(early)?;
        self.0 = tail;
        Ok(head)
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], CheckpointError> {
        self.take(N)?.try_into().map_err(|_| early())
    }

    fn u32(&mut self) -> Result<u32, CheckpointError> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    fn sums(&mut self, count: usize) -> Result<BinnedSums, CheckpointError> {
        BinnedSums::unpack(count, &mut self.0).ok_or_else(early)
    }

    /// Of a list that a number of items precedes.
    fn list<T>(
        &mut self,
        mut item: impl FnMut(&mut Self) -> Result<T, CheckpointError>,
    ) -> Result<Vec<T>, CheckpointError> {
        (0..self.u32()?).map(|_| item(self)).collect()
    }
}

impl Head {
    /// The pass after the last one that is in the sums.
    pub fn end(&self) -> u32 {
        self.first.saturating_add(self.passes)
    }

    /// Of a file, without its sums. What is damaged may be noticed by [`Checkpoint::read`] only.
    ///
    /// # Errors
    /// When the file cannot be read or does not begin as a checkpoint.
    pub fn read(path: &Path) -> Result<Self, CheckpointError> {
        let mut file = std::fs::File::open(path)?;
        let mut bytes = Vec::new();
        let most = |n: usize| u64::try_from(n).unwrap_or(u64::MAX);
        file.by_ref().take(most(MAGIC.len() + 4)).read_to_end(&mut bytes)?;
        let mut r = Reader(&bytes);
        begin(&mut r)?;
        let size = r.u32()? as usize;
        let mut text = Vec::new();
        file.take(most(size)).read_to_end(&mut text)?;
        Self::of(&text)
    }

    fn of(text: &[u8]) -> Result<Self, CheckpointError> {
        let head: Self =
            serde_json::from_slice(text).map_err(|_| CheckpointError::Invalid("its head is not ours"))?;
        let ends = head.first.checked_add(head.passes).is_some();
        if ends { Ok(head) } else { Err(CheckpointError::Invalid("its passes are too many")) }
    }

    /// Makes sure that this is of the render that `identity` describes.
    ///
    /// # Errors
    /// The first thing in which the two renders differ.
    pub fn check(&self, identity: &[(String, String)]) -> Result<(), CheckpointError> {
        let value = |rows: &[(String, String)], name: &str| {
            rows.iter().find(|(n, _)| n == name).map_or_else(|| "absent".to_owned(), |(_, v)| v.clone())
        };
        for (name, _) in identity.iter().chain(&self.identity) {
            let (was, now) = (value(&self.identity, name), value(identity, name));
            if was != now {
                return Err(CheckpointError::Different { name: name.clone(), was, now });
            }
        }
        Ok(())
    }
}

/// Reads what every checkpoint begins with.
fn begin(r: &mut Reader<'_>) -> Result<(), CheckpointError> {
    let magic = r.take(MAGIC.len()).map_err(|_| CheckpointError::Invalid("its first bytes are not ours"))?;
    match magic {
        _ if magic == MAGIC => Ok(()),
        _ if magic[..FAMILY] == MAGIC[..FAMILY] => Err(CheckpointError::OtherVersion),
        _ => Err(CheckpointError::Invalid("its first bytes are not ours")),
    }
}

impl Checkpoint {
    /// The bytes of a file.
    pub fn encode(head: &Head, pixels: &Pixels) -> Vec<u8> {
        let mut out = Vec::with_capacity(4096 + pixels.bytes() / 2);
        out.extend(MAGIC);
        let text = serde_json::to_vec(head).expect("texts and numbers are JSON");
        out.extend((text.len() as u32).to_le_bytes());
        out.extend(text);
        out.extend((pixels.len() as u32).to_le_bytes());
        out.extend(pixels.common.samples_a_pass.to_le_bytes());
        out.extend(pixels.common.even_passes.to_le_bytes());
        pixels.common.first_radii.iter().for_each(|radius| out.extend(radius.to_le_bytes()));
        let Counts { each, gain } = pixels.counts();
        out.extend(gain.to_le_bytes());
        out.extend((each.len() as u32).to_le_bytes());
        each.iter().for_each(|count| out.extend(count.to_le_bytes()));
        let [light, aovs] = pixels.sums();
        light.pack(&mut out);
        out.extend((aovs.len() as u32).to_le_bytes());
        aovs.pack(&mut out);
        let (steps, marks) = pixels.doublings().parts();
        // What ends with the sums follows from them.
        let marks: Vec<_> = marks.iter().filter(|(power, _)| **power != head.end()).collect();
        out.extend((steps.len() as u32).to_le_bytes());
        steps.iter().for_each(|step| out.extend(step.to_le_bytes()));
        out.extend((marks.len() as u32).to_le_bytes());
        for (power, sums) in marks {
            out.extend(power.to_le_bytes());
            sums.pack(&mut out);
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
        begin(&mut Reader(bytes))?;
        let (payload, sum) = bytes
            .split_at_checked(bytes.len().saturating_sub(8))
            .ok_or(CheckpointError::Invalid("it is empty"))?;
        if sum != checksum(payload).to_le_bytes() {
            return Err(CheckpointError::Invalid("its checksum is wrong"));
        }
        let mut r = Reader(payload);
        begin(&mut r)?;
        let size = r.u32()? as usize;
        let head = Head::of(r.take(size)?)?;
        let count = r.u32()? as usize;
        let samples_a_pass = r.u32()?;
        let even_passes = r.u32()?;
        let first_radii = [f32::from_le_bytes(r.array()?), f32::from_le_bytes(r.array()?)];
        let gain = f32::from_le_bytes(r.array()?);
        let each = r.list(|r| Ok(u16::from_le_bytes(r.array()?)))?;
        if !(each.is_empty() || each.len() == count) || each.contains(&0) || !gain.is_normal() {
            return Err(CheckpointError::Invalid("its samples do not fit its picture"));
        }
        let light = r.sums(Pixels::sums_of_light(count))?;
        let aovs = r.u32()? as usize;
        let aovs = r.sums(aovs)?;
        let steps = r.list(|r| Ok(f64::from_le_bytes(r.array()?)))?;
        let marked = light.len() / STRIDE;
        let marks = r.list(|r| Ok((r.u32()?, r.sums(marked)?)))?;
        let doublings = Doublings::from_parts(steps, BTreeMap::from_iter(marks));
        let common = Common { samples_a_pass, even_passes, first_radii };
        let mut pixels = Pixels::from_parts(count, [light, aovs], doublings, common, Counts { each, gain });
        pixels.mark_end(head.end());
        Ok(Self { head, pixels })
    }

    /// A checkpoint from a file.
    ///
    /// # Errors
    /// When the file cannot be read or is no whole checkpoint.
    pub fn read(path: &Path) -> Result<Self, CheckpointError> {
        Self::decode(&std::fs::read(path)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::{Mean, PassSums, Radiance, Rejected};
    use crate::math::Color;

    fn example() -> Checkpoint {
        let mut pixels = Pixels::new(3);
        pixels.set_counts(Counts { each: vec![1, 2, 300], gain: 1.5 });
        pixels.hold_aovs(2);
        let mut mean = Mean::default();
        let layers = [0.1f32, 2e-20, 7e30, 0.0, -0.25].map(Color::splat);
        mean.add(&Radiance { layers, alpha: 1.0 }, 0.7, &mut Rejected::default());
        let pass = PassSums {
            means: [mean, Mean::default(), mean].map(|mean| mean.stored(1.0)).to_vec(),
            aovs: vec![0.7; 6],
        };
        for done in 1..=12 {
            pixels.add(std::slice::from_ref(&pass));
            pixels.pass_done(5, 5 + done);
        }
        let identity = vec![("seed".to_owned(), "7".to_owned())];
        let about = "{}".to_owned();
        Checkpoint { head: Head { identity, about, first: 5, passes: 12, until: 64, whole: 64 }, pixels }
    }

    #[test]
    fn reads_back_every_bit_and_refuses_damage() {
        let c = example();
        let bytes = Checkpoint::encode(&c.head, &c.pixels);
        assert_eq!(Checkpoint::decode(&bytes).unwrap(), c);
        for n in 0..bytes.len() {
            assert!(Checkpoint::decode(&bytes[..n]).is_err());
            let mut broken = bytes.clone();
            broken[n] ^= 4;
            assert!(Checkpoint::decode(&broken).is_err());
        }
    }

    /// Whoever makes the checksum right meets no panic either.
    #[test]
    fn damage_with_a_right_checksum_is_no_panic() {
        let c = example();
        let bytes = Checkpoint::encode(&c.head, &c.pixels);
        let payload = &bytes[..bytes.len() - 8];
        for n in 0..payload.len() {
            for flip in [1, 0x80, 0xff] {
                let mut broken = payload.to_vec();
                broken[n] ^= flip;
                let sum = checksum(&broken);
                broken.extend(sum.to_le_bytes());
                let _any = Checkpoint::decode(&broken);
            }
        }
    }

    #[test]
    fn names_what_differs() {
        let now = |value: &str| vec![("seed".to_owned(), value.to_owned())];
        let message = example().head.check(&now("8")).unwrap_err().to_string();
        assert_eq!(message, "it belongs to another render: seed was `7`, now it is `8`");
        let message = example().head.check(&[]).unwrap_err().to_string();
        assert_eq!(message, "it belongs to another render: seed was `7`, now it is `absent`");
        assert!(example().head.check(&now("7")).is_ok());
    }

    #[test]
    fn checkpoints_of_other_versions_are_told_from_other_files() {
        let of = |bytes: &[u8]| Checkpoint::decode(bytes).unwrap_err().to_string();
        assert!(of(b"caustic3 and all the rest").contains("another version of caustica"));
        assert!(of(b"something else entirely").contains("not a checkpoint"));
    }
}
