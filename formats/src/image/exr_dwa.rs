//! What the chunks of a DWA-compressed EXR file claim to unpack to. The decoder allocates what they
//! claim, so claims that their bytes cannot hold are refused before it sees them.

use std::io::Cursor;

use exr::block::chunk::CompressedBlock;
use exr::prelude::Compression;

use super::ImageError;
use super::exr_read::exr_error;

/// Counters at the head of a chunk: eleven of eight bytes, in the file format's order.
const COUNTERS: usize = 11;

/// What a byte of a section can unpack to at most: deflate 1032 bytes; the Huffman coder of `ac` repeats a
/// symbol of two bytes 255 times for a code of a bit, the repeat's code of a bit and a count of eight.
const DEFLATED: u64 = 1032;
const HUFFMAN: u64 = 2 * 255;

/// Fails when a chunk of `bytes` claims more than it holds.
pub(super) fn check(bytes: &[u8]) -> Result<(), ImageError> {
    let reader = exr::block::read(Cursor::new(bytes), false).map_err(exr_error)?;
    let headers = reader.headers().to_vec();
    let is_dwa = |c: Compression| matches!(c, Compression::DWAA(_) | Compression::DWAB(_));
    if !headers.iter().any(|header| is_dwa(header.compression)) {
        return Ok(());
    }
    for chunk in reader.all_chunks(false).map_err(exr_error)? {
        let chunk = chunk.map_err(exr_error)?;
        let Some(header) = headers.get(chunk.layer_index).filter(|header| is_dwa(header.compression)) else {
            continue;
        };
        let place = header.get_block_data_indices(&chunk.compressed_block).map_err(exr_error)?;
        let area = header.get_absolute_block_pixel_coordinates(place).map_err(exr_error)?.size;
        let (CompressedBlock::ScanLine(exr::block::chunk::CompressedScanLineBlock {
            compressed_pixels_le,
            ..
        })
        | CompressedBlock::Tile(exr::block::chunk::CompressedTileBlock { compressed_pixels_le, .. })) =
            &chunk.compressed_block
        else {
            continue;
        };
        // Chunks that compression would not make smaller are stored as they are.
        let raw = area.area().saturating_mul(header.channels.bytes_per_pixel);
        if compressed_pixels_le.len() != raw && !plausible(compressed_pixels_le) {
            return Err(ImageError::Invalid("EXR: a chunk claims more than it holds".into()));
        }
    }
    Ok(())
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
