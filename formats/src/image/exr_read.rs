//! OpenEXR files, through the `exr` crate.

use std::io::Cursor;

use exr::image::FlatSamples;
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{Compression, ReadChannels, ReadLayers};

use super::exr_claims::{self, exr_error};
use super::{Encoding, Image, ImageError, check_memory, check_size, guarded};

/// Most values (pixels times channels) read from one file.
const MAX_VALUES: u128 = 1 << 30;

pub(super) fn read(bytes: &[u8]) -> Result<Image, ImageError> {
    guarded(|| {
        let window = check_headers(bytes)?;
        exr_claims::check(bytes)?;
        let file = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .all_layers()
            .all_attributes()
            .non_parallel()
            .from_buffered(Cursor::new(bytes))
            .map_err(exr_error)?;
        Ok(assemble(&file, window))
    })
}

/// Text or whole number under this name in the first header that has one.
pub(super) fn attribute(bytes: &[u8], name: &str) -> Option<String> {
    let find = || {
        let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(exr_error)?;
        let all = meta
            .headers
            .iter()
            .flat_map(|header| header.own_attributes.other.iter().chain(&header.shared_attributes.other));
        let mut named = all.filter(|(key, _)| text(key) == name).filter_map(|(_, value)| match value {
            AttributeValue::Text(value) => Some(text(value)),
            AttributeValue::I32(value) => Some(value.to_string()),
            _ => None,
        });
        Ok(named.next())
    };
    guarded(find).ok().flatten()
}

/// Smallest rectangle around all data windows.
#[derive(Clone, Copy)]
struct Window {
    x: i64,
    y: i64,
    width: usize,
    height: usize,
}

/// Decides from the headers alone whether the pixels can and should be read.
fn check_headers(bytes: &[u8]) -> Result<Window, ImageError> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(exr_error)?;
    let (mut min, mut max) = ([i64::MAX; 2], [i64::MIN; 2]);
    let mut channels = 0_usize;
    let mut raw_bytes = 0_u128;
    let mut chunks = 0_u128;
    let mut ratio = 2048;
    for header in &meta.headers {
        if header.deep {
            return Err(ImageError::Unsupported("a deep EXR image".into()));
        }
        if header.channels.list.iter().any(|channel| channel.sampling != exr::math::Vec2(1, 1)) {
            return Err(ImageError::Unsupported("an EXR image with subsampled channels".into()));
        }
        // Of a flat block of 64 floats the discrete cosine codecs keep two numbers of two bytes, deflated.
        if matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_)) {
            ratio = 64 * 1032;
        }
        let position = header.own_attributes.layer_position;
        let size = header.layer_size;
        for (axis, (start, length)) in
            [(position.x(), size.width()), (position.y(), size.height())].into_iter().enumerate()
        {
            min[axis] = min[axis].min(i64::from(start));
            max[axis] = max[axis].max(i64::from(start).saturating_add_unsigned(length as u64));
        }
        channels += header.channels.list.len();
        let pixels = size.width() as u128 * size.height() as u128;
        raw_bytes += pixels * header.channels.bytes_per_pixel as u128;
        chunks += header.chunk_count as u128;
    }
    if meta.headers.is_empty() || channels == 0 {
        return Err(ImageError::Invalid("the EXR file has no channels".into()));
    }
    let extent = |axis: usize| usize::try_from(max[axis] - min[axis]).unwrap_or(usize::MAX);
    let size = [extent(0), extent(1)];
    check_size(size, raw_bytes, bytes.len(), ratio)?;
    // Every chunk needs an entry in the offset table and a head of its own.
    if chunks * 16 > bytes.len() as u128 {
        return Err(ImageError::Invalid("the EXR file is shorter than its offset table".into()));
    }
    let values = size[0] as u128 * size[1] as u128 * channels as u128;
    // Far apart windows of several parts would make an image much larger than the file's content.
    if values > MAX_VALUES || values > raw_bytes.saturating_mul(8) {
        return Err(ImageError::Unsupported(format!(
            "an EXR image of {} × {} pixels and {channels} channels",
            size[0], size[1]
        )));
    }
    check_memory(size, raw_bytes + 4 * values)?;
    Ok(Window { x: min[0], y: min[1], width: size[0], height: size[1] })
}

type Parts = exr::image::FlatImage;

fn assemble(file: &Parts, window: Window) -> Image {
    let several = file.layer_data.len() > 1;
    let mut sources = Vec::new();
    for (index, layer) in file.layer_data.iter().enumerate() {
        let part = layer.attributes.layer_name.as_ref().map(text);
        for channel in &layer.channel_data.list {
            let own = text(&channel.name);
            let name = match &part {
                // Writers of multi-part files often repeat the part's name in its channels.
                Some(part) if several && !own.starts_with(&format!("{part}.")) => {
                    format!("{part}.{own}")
                }
                None if several && index > 0 => format!("{index}.{own}"),
                _ => own,
            };
            sources.push((name, layer, &channel.sample_data));
        }
    }
    sources.sort_by_cached_key(|source| order(&source.0));
    let count = sources.len();
    let mut data = vec![0.0; window.width * window.height * count];
    for (slot, (_, layer, samples)) in sources.iter().enumerate() {
        let position = layer.attributes.layer_position;
        let left = (i64::from(position.x()) - window.x) as usize;
        let top = (i64::from(position.y()) - window.y) as usize;
        let place = Place { stride: window.width, left, top, width: layer.size.width() };
        match samples {
            FlatSamples::F16(values) => {
                place.copy(&mut data, count, slot, values.iter().map(|v| v.to_f32()));
            }
            FlatSamples::F32(values) => {
                place.copy(&mut data, count, slot, values.iter().copied());
            }
            FlatSamples::U32(values) => {
                place.copy(&mut data, count, slot, values.iter().map(|&v| v as f32));
            }
        }
    }
    Image {
        width: window.width,
        height: window.height,
        channels: sources.into_iter().map(|source| source.0).collect(),
        data,
        encoding: Encoding::Linear,
    }
}

/// Where a part lies within the image.
struct Place {
    stride: usize,
    left: usize,
    top: usize,
    width: usize,
}

impl Place {
    fn copy(&self, data: &mut [f32], channels: usize, slot: usize, values: impl Iterator<Item = f32>) {
        let mut start = (self.top * self.stride + self.left) * channels + slot;
        let mut target = start;
        let mut column = 0;
        for value in values {
            if column == self.width {
                start += self.stride * channels;
                target = start;
                column = 0;
            }
            data[target] = value;
            target += channels;
            column += 1;
        }
    }
}

/// Files store channels alphabetically; people expect plain layers first and R G B A within them.
fn order(name: &str) -> (String, usize, String) {
    let (layer, channel) = name.rsplit_once('.').unwrap_or(("", name));
    let rank = ["R", "G", "B", "A"].iter().position(|known| *known == channel).unwrap_or(4);
    (layer.to_owned(), rank, channel.to_owned())
}

/// The crate hands out bytes as Latin-1; writers today mean UTF-8.
fn text(text: &Text) -> String {
    let latin: String = text.to_string();
    let bytes: Option<Vec<u8>> = latin.chars().map(|c| u8::try_from(u32::from(c)).ok()).collect();
    bytes.and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or(latin)
}
