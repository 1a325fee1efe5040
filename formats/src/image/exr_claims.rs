//! Sizes that the chunks of an EXR file claim: their own, and for DWA compression those of their unpacked parts. The
//! decoder allocates what is claimed, so claims that the file cannot hold are refused first.

use std::io::Cursor;

use exr::block::chunk::{CompressedBlock, CompressedScanLineBlock, CompressedTileBlock, TileCoordinates};
use exr::math::Vec2;
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::Compression;

use super::ImageError;

/// Counters at the head of a chunk: eleven of eight bytes, in the file format's order.
const COUNTERS: usize = 11;

/// What a byte of a section can unpack to at most: deflate 1032 bytes; the Huffman coder of `ac` repeats a
/// symbol of two bytes 255 times for a code of a bit, the repeat's code of a bit and a count of eight.
const DEFLATED: u64 = 1032;
const HUFFMAN: u64 = 2 * 255;

/// Fails when a chunk of `bytes` claims more than it holds. Chunks are where the offset table says.
pub(super) fn check(bytes: &[u8]) -> Result<(), ImageError> {
    let mut cursor = Cursor::new(bytes);
    let meta = MetaData::read_from_buffered(&mut cursor, false).map_err(exr_error)?;
    let table = bytes.get(cursor.position() as usize..).unwrap_or(&[]);
    let count = meta.headers.iter().map(|header| header.chunk_count).sum();
    for offset in table.as_chunks::<8>().0.iter().take(count) {
        let offset = usize::try_from(u64::from_le_bytes(*offset)).unwrap_or(usize::MAX);
        let mut words =
            bytes.get(offset..).unwrap_or(&[]).as_chunks::<4>().0.iter().map(|w| i32::from_le_bytes(*w));
        let mut word = || words.next().unwrap_or(0);
        let multiple = meta.requirements.has_multiple_layers;
        let part = if multiple { word() } else { 0 };
        let Some(header) = usize::try_from(part).ok().and_then(|part| meta.headers.get(part)) else {
            continue;
        };
        let coordinates = match header.blocks {
            BlockDescription::ScanLines => 1,
            BlockDescription::Tiles(_) => 4,
        };
        let place: [i32; 4] = std::array::from_fn(|i| if i < coordinates { word() } else { 0 });
        let size = usize::try_from(word()).unwrap_or(0);
        let start = offset.saturating_add(4 * (usize::from(multiple) + coordinates + 1));
        let Some(chunk) = start.checked_add(size).and_then(|end| bytes.get(start..end)) else {
            return Err(ImageError::Invalid("EXR: a chunk claims to be larger than the file".into()));
        };
        let is_dwa = matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_));
        if is_dwa && !plausible(chunk) && chunk.len() != raw_size(header, place)? {
            return Err(ImageError::Invalid("EXR: a chunk claims more than it holds".into()));
        }
    }
    Ok(())
}

/// Bytes of the pixels of the chunk at `place`: one that compression would not make smaller is stored as
/// it is.
fn raw_size(header: &Header, place: [i32; 4]) -> Result<usize, ImageError> {
    let [x, y, level_x, level_y] = place.map(|i| usize::try_from(i).unwrap_or(0));
    let compressed_pixels_le = Vec::new();
    let block = match header.blocks {
        BlockDescription::ScanLines => CompressedBlock::ScanLine(CompressedScanLineBlock {
            y_coordinate: place[0],
            compressed_pixels_le,
        }),
        BlockDescription::Tiles(_) => {
            let coordinates = TileCoordinates { tile_index: Vec2(x, y), level_index: Vec2(level_x, level_y) };
            CompressedBlock::Tile(CompressedTileBlock { coordinates, compressed_pixels_le })
        }
    };
    let place = header.get_block_data_indices(&block).map_err(exr_error)?;
    let area = header.get_absolute_block_pixel_coordinates(place).map_err(exr_error)?.size;
    Ok(area.area().saturating_mul(header.channels.bytes_per_pixel))
}

fn plausible(chunk: &[u8]) -> bool {
    let (counters, _) = chunk.as_chunks::<8>();
    let Some(counters) = counters.first_chunk::<COUNTERS>() else {
        // Too short; the decoder says so.
        return true;
    };
    let [_, unknown, in_unknown, in_ac, in_dc, in_rle, rle, rle_raw, ac, dc, _] =
        counters.map(u64::from_le_bytes);
    let fits = |claim: u64, section: u64, ratio: u64| {
        section <= chunk.len() as u64 && claim <= section.saturating_mul(ratio)
    };
    fits(unknown, in_unknown, DEFLATED)
        && fits(ac, in_ac, (DEFLATED / 2).max(HUFFMAN))
        && fits(dc, in_dc, DEFLATED / 2)
        && fits(rle, in_rle, DEFLATED)
        // A run of 128 equal bytes takes two.
        && rle_raw <= rle.saturating_mul(64)
}

pub(super) fn exr_error(error: exr::error::Error) -> ImageError {
    match error {
        exr::error::Error::NotSupported(what) => ImageError::Unsupported(format!("EXR: {what}")),
        exr::error::Error::Invalid(what) => ImageError::Invalid(format!("EXR: {what}")),
        exr::error::Error::Io(error) => ImageError::Invalid(format!("EXR: {error}")),
        exr::error::Error::Aborted => ImageError::Invalid("EXR: reading was aborted".into()),
    }
}
