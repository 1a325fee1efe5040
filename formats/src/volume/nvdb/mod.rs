//! NanoVDB files of version 32: each grid is a sparse tree of 4096³, 128³ and 8³ points. Little endian.

mod bytes;
mod tree;

use std::borrow::Cow;
use std::io::Read;

use flate2::read::ZlibDecoder;

use bytes::{Bytes, MAGIC, invalid};
use tree::Tree;

use super::{Grid, VolumeError};

const VERSION: u32 = 32;

const FILE_HEADER: usize = 16;
const META: usize = 176;

/// Deflate never expands further than this.
const MAX_RATIO: u64 = 1032;

/// A grid in the file.
struct Entry<'a> {
    name: String,
    codec: u16,
    /// Unpacked.
    size: u64,
    data: &'a [u8],
}

/// The names of the grids.
pub(super) fn names(bytes: &[u8]) -> Result<Vec<String>, VolumeError> {
    Ok(entries(bytes)?.into_iter().map(|entry| entry.name).collect())
}

/// Reads the grid called `name`.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<Grid, VolumeError> {
    let entries = entries(bytes)?;
    let Some(entry) = entries.iter().find(|entry| entry.name == name) else {
        let has = entries.iter().map(|entry| format!("`{}`", entry.name)).collect::<Vec<_>>().join(", ");
        return Err(VolumeError::NoGrid { asked: name.to_owned(), has });
    };
    let grid = entry.unpacked()?;
    Tree::of(&grid)?.read()
}

/// The grids of all segments.
fn entries(bytes: &[u8]) -> Result<Vec<Entry<'_>>, VolumeError> {
    if !bytes.starts_with(MAGIC) {
        return Err(VolumeError::Magic("NanoVDB"));
    }
    let all = Bytes(bytes);
    let mut entries = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        if !all.array::<8>(at)?.starts_with(MAGIC) {
            return Err(invalid(format!("no segment begins at byte {at}")));
        }
        if bytes[at + 7] == b'1' {
            return Err(VolumeError::Unsupported("that is a bare NanoVDB grid".to_owned()));
        }
        let version = all.u32(at + 8)? >> 21;
        if version != VERSION {
            return Err(VolumeError::Unsupported(format!("of NanoVDB version {version}")));
        }
        let (count, codec) = (all.u16(at + 12)?, all.u16(at + 14)?);
        at += FILE_HEADER;
        let mut metas = Vec::new();
        for _ in 0..count {
            let (size, packed) = (all.u64(at)?, all.u64(at + 8)?);
            let name_size = all.u32(at + 136)? as usize;
            let name = all.slice(at + META, name_size)?;
            let name = name.split(|b| *b == 0).next().unwrap_or_default();
            metas.push((String::from_utf8_lossy(name).into_owned(), size, packed));
            at += META + name_size;
        }
        for (name, size, packed) in metas {
            let packed = usize::try_from(packed).map_err(|_| invalid("a grid is too large"))?;
            entries.push(Entry { name, codec, size, data: all.slice(at, packed)? });
            at += packed;
        }
    }
    Ok(entries)
}

impl<'a> Entry<'a> {
    fn unpacked(&self) -> Result<Cow<'a, [u8]>, VolumeError> {
        match self.codec {
            0 => Ok(Cow::Borrowed(self.data)),
            1 => {
                let data = Bytes(self.data);
                let packed = usize::try_from(data.u64(0)?).map_err(|_| invalid("a grid is too large"))?;
                let packed = data.slice(8, packed)?;
                if self.size > packed.len() as u64 * MAX_RATIO {
                    return Err(invalid(format!(
                        "{} bytes cannot hold a grid of {}",
                        packed.len(),
                        self.size
                    )));
                }
                let mut grid = Vec::new();
                let read = ZlibDecoder::new(packed).take(self.size).read_to_end(&mut grid);
                read.map_err(|e| invalid(format!("the grid cannot be unpacked: {e}")))?;
                Ok(Cow::Owned(grid))
            }
            2 => Err(VolumeError::Unsupported("compressed by BLOSC".to_owned())),
            codec => Err(VolumeError::Unsupported(format!("with codec {codec}"))),
        }
    }
}
