use caustica_formats::image::{ExrLayer, ExrOptions, encode_exr, encode_hdr, encode_pfm, encode_png, read};
use proptest::collection::vec;
use proptest::prelude::*;

/// Width, height and so many values of a strategy a pixel.
fn texels<T: std::fmt::Debug>(
    channels: usize,
    value: impl Strategy<Value = T> + Clone,
) -> impl Strategy<Value = (usize, usize, Vec<T>)> {
    (1usize..40, 1usize..20).prop_flat_map(move |(width, height)| {
        (Just(width), Just(height), vec(value.clone(), width * height * channels))
    })
}

fn finite() -> impl Strategy<Value = f32> + Clone {
    any::<f32>().prop_filter("finite", |v| v.is_finite())
}

/// An uncompressed TGA of colours, rows from the bottom or the top.
fn tga(width: usize, height: usize, rgb: &[u8], from_top: bool) -> Vec<u8> {
    let mut bytes = vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    bytes.extend((width as u16).to_le_bytes());
    bytes.extend((height as u16).to_le_bytes());
    bytes.extend([24, if from_top { 0x20 } else { 0 }]);
    let mut rows: Vec<&[u8]> = rgb.chunks(width * 3).collect();
    if !from_top {
        rows.reverse();
    }
    rows.iter().for_each(|row| row.chunks(3).for_each(|p| bytes.extend([p[2], p[1], p[0]])));
    bytes
}

/// A 24-bit BMP: rows from the bottom, each padded to four bytes.
fn bmp(width: usize, height: usize, rgb: &[u8]) -> Vec<u8> {
    let padded = (width * 3).next_multiple_of(4);
    let size = padded * height;
    let mut bytes = b"BM".to_vec();
    for word in
        [54 + size as u32, 0, 54, 40, width as u32, height as u32, (24 << 16) | 1, 0, size as u32, 0, 0, 0, 0]
    {
        bytes.extend(word.to_le_bytes());
    }
    for row in rgb.chunks(width * 3).rev() {
        row.chunks(3).for_each(|p| bytes.extend([p[2], p[1], p[0]]));
        bytes.resize(bytes.len() + padded - width * 3, 0);
    }
    bytes
}

fn eight_bit(bytes: &[u8], width: usize, height: usize, channels: usize, said: &[u8]) {
    let picture = read(bytes).unwrap();
    assert_eq!((picture.width, picture.height, picture.channels.len()), (width, height, channels));
    let expected: Vec<f32> = said.iter().map(|&v| f32::from(v) / 255.0).collect();
    assert_eq!(picture.data, expected);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn pfm_files_read_to_what_they_say((width, height, values) in texels(3, finite())) {
        let picture = read(&encode_pfm(width, height, &values).unwrap()).unwrap();
        prop_assert_eq!((picture.width, picture.height), (width, height));
        prop_assert_eq!(picture.data, values);
    }

    #[test]
    fn exr_files_read_to_what_they_say((width, height, values) in texels(4, finite())) {
        let layers = [
            ExrLayer { name: "", channels: &["R", "G", "B", "A"], data: &values },
            ExrLayer { name: "far", channels: &["Y"], data: &values[..width * height] },
        ];
        let bytes = encode_exr(width, height, &layers, &[], ExrOptions { half: false }).unwrap();
        let picture = read(&bytes).unwrap();
        prop_assert_eq!((picture.width, picture.height), (width, height));
        let at = |name: &str| picture.channel(name).unwrap();
        let places = [at("R"), at("G"), at("B"), at("A")];
        for (i, said) in values.chunks(4).enumerate() {
            let found = picture.pixel(i % width, i / width);
            prop_assert_eq!(&places.map(|p| found[p])[..], said);
            prop_assert_eq!(found[at("far.Y")], values[i]);
        }
    }

    /// A shared exponent keeps 8 bits of the largest channel: half a step of 1/128 or less, of it.
    #[test]
    fn hdr_files_read_to_what_they_say((width, height, values) in texels(3, 0f32..1e6)) {
        let picture = read(&encode_hdr(width, height, &values).unwrap()).unwrap();
        prop_assert_eq!((picture.width, picture.height), (width, height));
        for (found, said) in picture.data.chunks(3).zip(values.chunks(3)) {
            let largest = said.iter().copied().fold(0.0, f32::max);
            prop_assert!(found.iter().zip(said).all(|(f, s)| (f - s).abs() <= largest / 128.0), "{found:?} {said:?}");
        }
    }

    #[test]
    fn png_files_read_to_what_they_say((width, height, values) in texels(4, any::<u8>())) {
        eight_bit(&encode_png(width, height, &values).unwrap(), width, height, 4, &values);
        let rgb = &values[..width * height * 3];
        eight_bit(&encode_png(width, height, rgb).unwrap(), width, height, 3, rgb);
    }

    #[test]
    fn tga_and_bmp_files_read_to_what_they_say((width, height, values) in texels(3, any::<u8>()), top in any::<bool>()) {
        eight_bit(&tga(width, height, &values, top), width, height, 3, &values);
        eight_bit(&bmp(width, height, &values), width, height, 3, &values);
    }
}
