//! 8- and 16-bit images through the `image` crate: PNG, JPEG, BMP, TGA.

use std::io::Cursor;
use std::path::Path;

use image::{DynamicImage, ExtendedColorType, ImageDecoder, ImageEncoder, ImageFormat, ImageReader};

use super::{
    Encoding, Image, ImageError, MAX_PIXELS, Samples, atomic_write, check_data, check_memory, check_size,
    guarded,
};

pub(super) fn read(bytes: &[u8], format: ImageFormat) -> Result<Image<Samples>, ImageError> {
    if format == ImageFormat::Png && !has_whole_palette(bytes) {
        return Err(ImageError::Invalid("PNG: the palette is cut off within a colour".into()));
    }
    guarded(|| {
        let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
        let mut limits = image::Limits::default();
        limits.max_alloc = Some(MAX_PIXELS as u64 * 8);
        reader.limits(limits);
        let decoder = reader.into_decoder().map_err(decode_error)?;
        let (width, height) = decoder.dimensions();
        let size = [width as usize, height as usize];
        let pixels = u128::from(width) * u128::from(height);
        let (raw_bytes, ratio) = match format {
            ImageFormat::Png => (png_bytes(bytes, size), 1032),
            // Two bits can end an 8 × 8 block of one component; progressive files save more.
            ImageFormat::Jpeg => (pixels, 4096),
            _ => (pixels, 512),
        };
        check_size(size, raw_bytes, bytes.len(), ratio)?;
        // Integers and the floats made of them.
        let color = decoder.color_type();
        check_memory(
            size,
            pixels * u128::from(u16::from(color.bytes_per_pixel()) + 4 * u16::from(color.channel_count())),
        )?;
        DynamicImage::from_decoder(decoder).map_err(decode_error).and_then(convert)
    })
}

/// Whether the palette consists of colours of three bytes, which the decoder takes for granted.
fn has_whole_palette(bytes: &[u8]) -> bool {
    let mut rest = bytes.get(8..).unwrap_or(&[]);
    while let Some((head, body)) = rest.split_first_chunk::<8>() {
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        match &head[4..] {
            b"PLTE" if !length.is_multiple_of(3) => return false,
            b"IDAT" => break,
            _ => {}
        }
        // After the data of a chunk comes its checksum.
        rest = length.checked_add(4).and_then(|skip| body.get(skip..)).unwrap_or(&[]);
    }
    true
}

/// Whether `bytes` start like a TGA file, which has no magic number.
pub(super) fn looks_like_tga(bytes: &[u8]) -> bool {
    let Some(head) = bytes.get(..18) else { return false };
    let size = [u16::from_le_bytes([head[12], head[13]]), u16::from_le_bytes([head[14], head[15]])];
    let known_kind = match head[1] {
        0 => matches!(head[2], 2 | 3 | 10 | 11),
        1 => matches!(head[2], 1 | 2 | 9 | 10),
        _ => false,
    };
    known_kind && matches!(head[16], 8 | 15 | 16 | 24 | 32) && size[0] > 0 && size[1] > 0
}

/// Size of the filtered scan lines, from the header: bit depth at byte 24, colour type at 25.
fn png_bytes(bytes: &[u8], [width, height]: [usize; 2]) -> u128 {
    let samples = match bytes.get(25) {
        Some(2) => 3,
        Some(4) => 2,
        Some(6) => 4,
        _ => 1,
    };
    let depth = u128::from(bytes.get(24).copied().unwrap_or(8));
    (width as u128 * samples * depth).div_ceil(8) * height as u128
}

fn convert(image: DynamicImage) -> Result<Image<Samples>, ImageError> {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let eight = Samples::Bytes;
    let sixteen =
        |values: Vec<u16>| Samples::Floats(values.iter().map(|&v| f32::from(v) / 65535.0).collect());
    let (names, data): (&[&str], Samples) = match image {
        DynamicImage::ImageLuma8(pixels) => (&["Y"], eight(pixels.into_raw())),
        DynamicImage::ImageLumaA8(pixels) => (&["Y", "A"], eight(pixels.into_raw())),
        DynamicImage::ImageRgb8(pixels) => (&["R", "G", "B"], eight(pixels.into_raw())),
        DynamicImage::ImageRgba8(pixels) => (&["R", "G", "B", "A"], eight(pixels.into_raw())),
        DynamicImage::ImageLuma16(pixels) => (&["Y"], sixteen(pixels.into_raw())),
        DynamicImage::ImageLumaA16(pixels) => (&["Y", "A"], sixteen(pixels.into_raw())),
        DynamicImage::ImageRgb16(pixels) => (&["R", "G", "B"], sixteen(pixels.into_raw())),
        DynamicImage::ImageRgba16(pixels) => (&["R", "G", "B", "A"], sixteen(pixels.into_raw())),
        _ => return Err(ImageError::Unsupported("this pixel layout".into())),
    };
    let channels = names.iter().map(|name| (*name).to_owned()).collect();
    Ok(Image { width, height, channels, data, encoding: Encoding::Srgb })
}

/// An 8-bit PNG; `data` holds three (RGB) or four (RGBA) bytes per pixel, row 0 at the top.
///
/// # Errors
/// When `data` has the wrong length or a side is too long for the format.
pub fn encode_png(width: usize, height: usize, data: &[u8]) -> Result<Vec<u8>, ImageError> {
    let pixels = width.saturating_mul(height);
    let (channels, color) = if data.len() == pixels.saturating_mul(4) {
        (4, ExtendedColorType::Rgba8)
    } else {
        (3, ExtendedColorType::Rgb8)
    };
    check_data(width, height, channels, data.len())?;
    let (Ok(columns), Ok(rows)) = (u32::try_from(width), u32::try_from(height)) else {
        return Err(ImageError::Unsupported(format!("a PNG of {width} × {height} pixels")));
    };
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(data, columns, rows, color)
        .map_err(|error| ImageError::Invalid(format!("PNG: {error}")))?;
    Ok(bytes)
}

/// [`encode_png`] into a file that is replaced in one step.
///
/// # Errors
/// As [`encode_png`], and when the file cannot be written.
pub fn write_png(path: impl AsRef<Path>, width: usize, height: usize, data: &[u8]) -> Result<(), ImageError> {
    Ok(atomic_write(path, &encode_png(width, height, data)?)?)
}

fn decode_error(error: image::ImageError) -> ImageError {
    match error {
        image::ImageError::Unsupported(error) => ImageError::Unsupported(error.to_string()),
        image::ImageError::Limits(_) => ImageError::Unsupported("an image of this size".into()),
        error => ImageError::Invalid(error.to_string()),
    }
}
