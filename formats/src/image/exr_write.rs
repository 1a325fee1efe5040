//! OpenEXR output: one scan-line part, ZIP compression, the same bytes for the same input.
//!
//! Written by hand because the `exr` crate stores attributes in the order of a hash map. Layout:
//! <https://openexr.com/en/latest/OpenEXRFileLayout.html>.

use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use half::f16;

use super::{ImageError, atomic_write, check_data};

/// Channels of one layer.
#[derive(Clone, Copy, Debug)]
pub struct ExrLayer<'a> {
    /// Prefix of the channel names; empty for the layer that viewers show first.
    pub name: &'a str,
    /// E.g. `R G B`.
    pub channels: &'a [&'a str],
    /// Interleaved, `width · height · channels.len()` values, row 0 at the top.
    pub data: &'a [f32],
}

/// How pixels are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExrOptions {
    /// 16-bit floats instead of 32-bit ones.
    pub half: bool,
}

/// [`encode_exr`] into a file that is replaced in one step.
///
/// # Errors
/// As [`encode_exr`], and when the file cannot be written.
pub fn write_exr(
    path: impl AsRef<Path>,
    width: usize,
    height: usize,
    layers: &[ExrLayer<'_>],
    metadata: &[(String, String)],
    options: ExrOptions,
) -> Result<(), ImageError> {
    let bytes = encode_exr(width, height, layers, metadata, options)?;
    Ok(atomic_write(path, &bytes)?)
}

/// An EXR file with the channels of all `layers` and `metadata` as text attributes in the order
/// given.
///
/// # Errors
/// When names are repeated or unusable, or when data has the wrong length.
pub fn encode_exr(
    width: usize,
    height: usize,
    layers: &[ExrLayer<'_>],
    metadata: &[(String, String)],
    options: ExrOptions,
) -> Result<Vec<u8>, ImageError> {
    for layer in layers {
        check_data(width, height, layer.channels.len(), layer.data.len())?;
    }
    let (Ok(_), Ok(lines)) = (i32::try_from(width), i32::try_from(height)) else {
        return Err(ImageError::Unsupported(format!("an EXR image of {width} × {height} pixels")));
    };
    let channels = sorted_channels(layers)?;
    let mut bytes = header(width, height, &channels, metadata, options)?;
    let blocks = compress_blocks(width, height, &channels, options);
    let mut offset = bytes.len() + 8 * blocks.len();
    for block in &blocks {
        bytes.extend((offset as u64).to_le_bytes());
        offset += 8 + block.len();
    }
    for (block, line) in blocks.iter().zip((0..lines).step_by(LINES_PER_BLOCK)) {
        let length = i32::try_from(block.len())
            .map_err(|_| ImageError::Unsupported("an EXR image of this width".into()))?;
        bytes.extend(line.to_le_bytes());
        bytes.extend(length.to_le_bytes());
        bytes.extend(block);
    }
    Ok(bytes)
}

/// Fixed by the ZIP compression of the format.
const LINES_PER_BLOCK: usize = 16;

/// Level of the reference library.
const ZIP_LEVEL: u32 = 4;

/// One channel within the interleaved data of its layer.
struct Channel<'a> {
    name: String,
    data: &'a [f32],
    offset: usize,
    stride: usize,
}

/// All channels by name, in the byte order the format demands.
fn sorted_channels<'a>(layers: &[ExrLayer<'a>]) -> Result<Vec<Channel<'a>>, ImageError> {
    let mut channels = Vec::new();
    for layer in layers {
        for (offset, channel) in layer.channels.iter().enumerate() {
            let name = match layer.name {
                "" => (*channel).to_owned(),
                layer => format!("{layer}.{channel}"),
            };
            check_name(&name)?;
            channels.push(Channel { name, data: layer.data, offset, stride: layer.channels.len() });
        }
    }
    if channels.is_empty() {
        return Err(ImageError::Invalid("an EXR image needs at least one channel".into()));
    }
    channels.sort_by(|a, b| a.name.as_bytes().cmp(b.name.as_bytes()));
    match channels.windows(2).find(|pair| pair[0].name == pair[1].name) {
        Some(pair) => Err(ImageError::Invalid(format!("two channels are called {}", pair[0].name))),
        None => Ok(channels),
    }
}

fn check_name(name: &str) -> Result<(), ImageError> {
    if name.is_empty() || name.len() > 255 || name.contains('\0') {
        return Err(ImageError::Invalid(format!("\"{name}\" cannot name a channel or attribute")));
    }
    Ok(())
}

/// Attributes whose meaning the format fixes; text under these names would break readers.
const RESERVED: [&str; 14] = [
    "channels",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "tiles",
    "type",
    "version",
    "chunkCount",
    "maxSamplesPerPixel",
    "chromaticities",
];

fn header(
    width: usize,
    height: usize,
    channels: &[Channel<'_>],
    metadata: &[(String, String)],
    options: ExrOptions,
) -> Result<Vec<u8>, ImageError> {
    const LONG_NAMES: u32 = 0x400;
    let names = channels.iter().map(|c| &c.name).chain(metadata.iter().map(|(name, _)| name));
    let flags = if names.into_iter().any(|name| name.len() > 31) { LONG_NAMES } else { 0 };
    let mut bytes = vec![0x76, 0x2f, 0x31, 0x01];
    bytes.extend((2 | flags).to_le_bytes());

    let mut list = Vec::new();
    for channel in channels {
        list.extend(channel.name.as_bytes());
        list.push(0);
        let pixel_type: i32 = if options.half { 1 } else { 2 };
        list.extend(pixel_type.to_le_bytes());
        list.extend([0; 4]); // not for perceptually linear codecs, three bytes reserved
        list.extend([1, 0, 0, 0, 1, 0, 0, 0]); // no subsampling
    }
    list.push(0);
    attribute(&mut bytes, "channels", "chlist", &list);
    attribute(&mut bytes, "compression", "compression", &[3]);
    let corner = [0, 0, width as i32 - 1, height as i32 - 1];
    let window: Vec<u8> = corner.iter().flat_map(|v| v.to_le_bytes()).collect();
    attribute(&mut bytes, "dataWindow", "box2i", &window);
    attribute(&mut bytes, "displayWindow", "box2i", &window);
    attribute(&mut bytes, "lineOrder", "lineOrder", &[0]);
    attribute(&mut bytes, "pixelAspectRatio", "float", &1_f32.to_le_bytes());
    attribute(&mut bytes, "screenWindowCenter", "v2f", &[0; 8]);
    attribute(&mut bytes, "screenWindowWidth", "float", &1_f32.to_le_bytes());
    for (index, (name, value)) in metadata.iter().enumerate() {
        check_name(name)?;
        let taken = metadata[..index].iter().any(|(other, _)| other == name);
        if taken || RESERVED.contains(&name.as_str()) {
            return Err(ImageError::Invalid(format!("the EXR attribute {name} is already used")));
        }
        attribute(&mut bytes, name, "string", value.as_bytes());
    }
    bytes.push(0);
    Ok(bytes)
}

fn attribute(bytes: &mut Vec<u8>, name: &str, kind: &str, value: &[u8]) {
    bytes.extend(name.as_bytes());
    bytes.push(0);
    bytes.extend(kind.as_bytes());
    bytes.push(0);
    bytes.extend((value.len() as u32).to_le_bytes());
    bytes.extend(value);
}

/// The compressed blocks from top to bottom; each is compressed on its own, so threads may share
/// the work without changing a byte.
fn compress_blocks(
    width: usize,
    height: usize,
    channels: &[Channel<'_>],
    options: ExrOptions,
) -> Vec<Vec<u8>> {
    let count = height.div_ceil(LINES_PER_BLOCK);
    let mut blocks = vec![Vec::new(); count];
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get()).min(count);
    let share = count.div_ceil(threads);
    std::thread::scope(|scope| {
        for (part, slots) in blocks.chunks_mut(share).enumerate() {
            scope.spawn(move || {
                for (index, slot) in slots.iter_mut().enumerate() {
                    let first = (part * share + index) * LINES_PER_BLOCK;
                    let lines = first..(first + LINES_PER_BLOCK).min(height);
                    *slot = compress(&raw_block(width, lines, channels, options));
                }
            });
        }
    });
    blocks
}

/// Line after line, channel after channel.
fn raw_block(
    width: usize,
    lines: std::ops::Range<usize>,
    channels: &[Channel<'_>],
    options: ExrOptions,
) -> Vec<u8> {
    let mut raw = Vec::with_capacity(lines.len() * width * channels.len() * 4);
    for y in lines {
        for channel in channels {
            let line = &channel.data[y * width * channel.stride..][..width * channel.stride];
            for &value in line[channel.offset..].iter().step_by(channel.stride) {
                if options.half {
                    raw.extend(f16::from_f32(value).to_le_bytes());
                } else {
                    raw.extend(value.to_le_bytes());
                }
            }
        }
    }
    raw
}

/// Even bytes before odd ones, then differences, then zlib; stored raw when that does not help.
fn compress(raw: &[u8]) -> Vec<u8> {
    let evens = raw.iter().step_by(2);
    let odds = raw.iter().skip(1).step_by(2);
    let mut filtered: Vec<u8> = evens.chain(odds).copied().collect();
    let mut previous = filtered.first().copied().unwrap_or(0);
    for byte in filtered.iter_mut().skip(1) {
        let current = *byte;
        *byte = current.wrapping_sub(previous).wrapping_add(128);
        previous = current;
    }
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(ZIP_LEVEL));
    let written = encoder.write_all(&filtered).and_then(|()| encoder.finish());
    match written {
        Ok(zipped) if zipped.len() < raw.len() => zipped,
        _ => raw.to_vec(),
    }
}
