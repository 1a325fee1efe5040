//! Bytes that may not be there.

use crate::volume::VolumeError;

/// `NanoVDB0` and `NanoVDB2` begin a file, `NanoVDB0` and `NanoVDB1` a grid in it.
pub(super) const MAGIC: &[u8] = b"NanoVDB";

fn short(needed: usize, found: usize) -> VolumeError {
    VolumeError::Short { needed: needed as u64, found: found as u64 }
}

pub(super) fn invalid(text: impl Into<String>) -> VolumeError {
    VolumeError::Invalid(text.into())
}

/// Bytes of which any may be missing.
#[derive(Clone, Copy)]
pub(super) struct Bytes<'a>(pub &'a [u8]);

impl<'a> Bytes<'a> {
    pub fn slice(self, at: usize, count: usize) -> Result<&'a [u8], VolumeError> {
        let end = at.checked_add(count).ok_or_else(|| short(usize::MAX, self.0.len()))?;
        self.0.get(at..end).ok_or_else(|| short(end, self.0.len()))
    }

    pub fn array<const N: usize>(self, at: usize) -> Result<[u8; N], VolumeError> {
        Ok(self.slice(at, N)?.try_into().expect("a slice of N bytes"))
    }

    pub fn u16(self, at: usize) -> Result<u16, VolumeError> {
        self.array(at).map(u16::from_le_bytes)
    }

    pub fn u32(self, at: usize) -> Result<u32, VolumeError> {
        self.array(at).map(u32::from_le_bytes)
    }

    pub fn u64(self, at: usize) -> Result<u64, VolumeError> {
        self.array(at).map(u64::from_le_bytes)
    }

    pub fn f32(self, at: usize) -> Result<f32, VolumeError> {
        self.array(at).map(f32::from_le_bytes)
    }

    pub fn coordinate(self, at: usize) -> Result<[i32; 3], VolumeError> {
        Ok([self.u32(at)?.cast_signed(), self.u32(at + 4)?.cast_signed(), self.u32(at + 8)?.cast_signed()])
    }

    /// `from` plus the signed offset that stands at `at`.
    pub fn target(self, from: usize, at: usize) -> Result<usize, VolumeError> {
        let offset = self.u64(at)?.cast_signed();
        let target = isize::try_from(offset).ok().and_then(|offset| from.checked_add_signed(offset));
        target.filter(|target| *target < self.0.len()).ok_or_else(|| invalid("a node points out of its grid"))
    }
}
