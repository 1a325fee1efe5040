use super::*;

fn gradient(width: usize, height: usize, channels: usize) -> Vec<f32> {
    (0..width * height * channels).map(|i| i as f32 * 0.37 - 3.0).collect()
}

fn layered_exr(half: bool) -> Vec<u8> {
    let (main, depth) = (gradient(5, 37, 4), gradient(5, 37, 1));
    let layers = [
        ExrLayer { name: "", channels: &["R", "G", "B", "A"], data: &main },
        ExrLayer { name: "depth", channels: &["T"], data: &depth },
    ];
    let metadata = [("command".to_owned(), "render größe.xml".to_owned())];
    encode_exr(5, 37, &layers, &metadata, ExrOptions { half }).expect("valid layers")
}

#[test]
fn exr_layers_survive_a_round_trip() {
    let image = read(&layered_exr(false)).expect("own output");
    assert_eq!((image.width, image.height), (5, 37));
    assert_eq!(image.channels, ["R", "G", "B", "A", "depth.T"]);
    assert_eq!(image.encoding, Encoding::Linear);
    assert_eq!(image.rgb(), Some([0, 1, 2]));
    let (main, depth) = (gradient(5, 37, 4), gradient(5, 37, 1));
    for y in 0..37 {
        for x in 0..5 {
            let at = y * 5 + x;
            assert_eq!(image.pixel(x, y)[..4], main[at * 4..at * 4 + 4]);
            assert_eq!(image.pixel(x, y)[4], depth[at]);
        }
    }
}

#[test]
fn half_exr_rounds_to_half() {
    let image = read(&layered_exr(true)).expect("own output");
    for (got, want) in image.data.chunks(5).zip(gradient(5, 37, 4).chunks(4)) {
        for (got, want) in got.iter().zip(want) {
            assert_eq!(*got, half::f16::from_f32(*want).to_f32());
        }
    }
}

#[test]
fn exr_bytes_are_deterministic() {
    assert_eq!(layered_exr(false), layered_exr(false));
}

#[test]
fn exr_keeps_special_values() {
    let data = [f32::INFINITY, f32::NEG_INFINITY, -0.0, 1e-40];
    let layer = ExrLayer { name: "", channels: &["Y"], data: &data };
    let bytes = encode_exr(2, 2, &[layer], &[], ExrOptions::default()).expect("valid");
    let image = read(&bytes).expect("own output");
    let bits = |values: &[f32]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&image.data), bits(&data));
    assert_eq!(image.rgb(), Some([0; 3]));
}

#[test]
fn exr_refuses_bad_names() {
    let layer = ExrLayer { name: "", channels: &["Y"], data: &[0.0] };
    let options = ExrOptions::default();
    assert!(encode_exr(1, 1, &[layer, layer], &[], options).is_err());
    let reserved = [("dataWindow".to_owned(), String::new())];
    assert!(encode_exr(1, 1, &[layer], &reserved, options).is_err());
    assert!(encode_exr(1, 1, &[], &[], options).is_err());
    assert!(encode_exr(2, 1, &[layer], &[], options).is_err());
}

/// Files of the `exr` crate, with the compression methods and layouts others write.
mod exr_variants {
    use std::io::Cursor;

    use exr::prelude::*;

    use super::super::read as read_image;

    fn file(encoding: Encoding, position: Vec2<i32>) -> Vec<u8> {
        let values = |offset: f32| -> Vec<f32> { (0..40 * 35).map(|i| (i % 40) as f32 + offset).collect() };
        let list = AnyChannels::sort(
            [
                AnyChannel::new("R", FlatSamples::F32(values(0.0))),
                AnyChannel::new("G", FlatSamples::F16(values(0.5).into_iter().map(f16::from_f32).collect())),
                AnyChannel::new("id", FlatSamples::U32((0..40 * 35).collect())),
            ]
            .into_iter()
            .collect(),
        );
        let mut attributes = LayerAttributes::named("main");
        attributes.layer_position = position;
        let layer = Layer::new((40, 35), attributes, encoding, list);
        let mut bytes = Cursor::new(Vec::new());
        let image = Image::from_layer(layer);
        image.write().non_parallel().to_buffered(&mut bytes).expect("writable");
        bytes.into_inner()
    }

    fn encoding(compression: Compression, tiles: bool) -> Encoding {
        Encoding {
            compression,
            blocks: if tiles { Blocks::Tiles(Vec2(16, 16)) } else { Blocks::ScanLines },
            line_order: LineOrder::Increasing,
        }
    }

    #[test]
    fn lossless_methods_scan_lines_and_tiles() {
        use Compression::{PIZ, RLE, Uncompressed, ZIP1, ZIP16};
        for method in [Uncompressed, RLE, ZIP1, ZIP16, PIZ] {
            for tiles in [false, true] {
                let bytes = file(encoding(method, tiles), Vec2(-3, 12));
                let image = read_image(&bytes).expect("readable");
                assert_eq!((image.width, image.height), (40, 35));
                assert_eq!(image.channels, ["R", "G", "id"]);
                for y in 0..35 {
                    for x in 0..40 {
                        let expected = [x as f32, x as f32 + 0.5, (y * 40 + x) as f32];
                        assert_eq!(image.pixel(x, y), expected);
                    }
                }
            }
        }
    }

    #[test]
    fn hostile_variants_do_not_panic() {
        use Compression::{B44, PIZ, PXR24, RLE, Uncompressed, ZIP16};
        for method in [Uncompressed, RLE, ZIP16, PIZ, PXR24, B44] {
            let bytes = file(encoding(method, method == ZIP16), Vec2(0, 0));
            super::mutate(&bytes, 97, 400);
        }
    }
}

#[test]
fn png_variants() {
    let encode = |color, data: &[u8]| {
        let mut bytes = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
        image::ImageEncoder::write_image(encoder, data, 2, 1, color).expect("encodable");
        read(&bytes).expect("readable")
    };
    let gray = encode(image::ExtendedColorType::L8, &[0, 255]);
    assert_eq!((gray.channels, gray.data), (vec!["Y".to_owned()], vec![0.0, 1.0]));
    assert_eq!(gray.encoding, Encoding::Srgb);
    let gray_alpha = encode(image::ExtendedColorType::La8, &[0, 255, 51, 0]);
    assert_eq!(gray_alpha.data, [0.0, 1.0, 0.2, 0.0]);
    let rgba = encode(image::ExtendedColorType::Rgba8, &[255; 8]);
    assert_eq!(rgba.channels, ["R", "G", "B", "A"]);
    let deep: Vec<u8> = [0_u16, 65535, 32768, 1, 2, 3].iter().flat_map(|v| v.to_ne_bytes()).collect();
    let rgb16 = encode(image::ExtendedColorType::Rgb16, &deep);
    assert_eq!(rgb16.data[..3], [0.0, 1.0, 32768.0 / 65535.0]);
}

#[test]
fn png_round_trip() {
    for channels in [3, 4] {
        let data: Vec<u8> = (0..6 * channels).collect();
        let bytes = encode_png(3, 2, &data).expect("encodable");
        let image = read(&bytes).expect("own output");
        let back: Vec<u8> = image.data.iter().map(|v| (v * 255.0).round() as u8).collect();
        assert_eq!(back, data);
        assert_eq!(bytes, encode_png(3, 2, &data).expect("encodable"));
    }
    assert!(encode_png(3, 2, &[0; 7]).is_err());
}

fn raster(format: image::ImageFormat) -> Vec<u8> {
    let pixels = image::RgbImage::from_fn(9, 5, |x, y| image::Rgb([(x * 20) as u8, y as u8, 7]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    image::DynamicImage::ImageRgb8(pixels).write_to(&mut bytes, format).expect("encodable");
    bytes.into_inner()
}

#[test]
fn formats_are_told_apart() {
    use image::ImageFormat::{Bmp, Jpeg, Tga};
    for format in [Bmp, Tga, Jpeg] {
        let image = read(&raster(format)).expect("readable");
        assert_eq!((image.width, image.height), (9, 5));
        let tolerance = if format == Jpeg { 0.1 } else { 1e-6 };
        assert!((image.pixel(8, 0)[0] - 160.0 / 255.0).abs() < tolerance);
        assert!(image.pixel(0, 0)[0].abs() < tolerance);
    }
    assert!(matches!(read(b"hello"), Err(ImageError::Invalid(_))));
    assert!(matches!(read(b"\x00\x01\xff hello"), Err(ImageError::Unsupported(_))));
    assert!(read(b"").is_err());
}

#[test]
fn pfm_round_trip_and_byte_orders() {
    let data = gradient(3, 2, 3);
    let image = read(&encode_pfm(3, 2, &data).expect("encodable")).expect("own output");
    assert_eq!((image.data, image.encoding), (data, Encoding::Linear));
    let mut big = b"Pf\n1 2\n2.0\n".to_vec();
    big.extend(1.5_f32.to_be_bytes());
    big.extend(2.5_f32.to_be_bytes());
    let image = read(&big).expect("valid");
    assert_eq!((image.channels, image.data), (vec!["Y".to_owned()], vec![5.0, 3.0]));
    assert!(read(&big[..big.len() - 1]).is_err());
    assert!(read(b"PF\n4294967295 4294967295\n-1\n").is_err());
}

#[test]
fn hdr_round_trip() {
    let data: Vec<f32> = (0..16 * 2 * 3).map(|i| 0.5 + (i % 7) as f32).collect();
    let image = read(&encode_hdr(16, 2, &data).expect("encodable")).expect("own output");
    assert_eq!((image.width, image.height), (16, 2));
    for (pixel, want) in image.data.chunks(3).zip(data.chunks(3)) {
        let brightest = want.iter().fold(0.0_f32, |a, &b| a.max(b));
        for (got, want) in pixel.iter().zip(want) {
            assert!((got - want).abs() <= brightest / 128.0, "{pixel:?} {want}");
        }
    }
}

#[test]
fn files_replace_each_other() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("image");
    write_png(&path, 1, 1, &[1, 2, 3]).expect("writable");
    write_pfm(&path, 1, 1, &[0.5]).expect("writable");
    atomic_write(&path, &encode_hdr(1, 1, &[0.5; 3]).expect("valid")).expect("writable");
    let layer = ExrLayer { name: "", channels: &["Y"], data: &[0.25] };
    write_exr(&path, 1, 1, &[layer], &[], ExrOptions::default()).expect("writable");
    let image = read(&std::fs::read(&path).expect("readable")).expect("the last one");
    assert_eq!(image.data, [0.25]);
}

#[test]
fn hostile_files_neither_panic_nor_allocate() {
    use image::ImageFormat::{Bmp, Jpeg, Png, Tga};
    let mut files: Vec<Vec<u8>> = [Bmp, Jpeg, Png, Tga].into_iter().map(raster).collect();
    files.push(layered_exr(false));
    files.push(encode_pfm(3, 2, &gradient(3, 2, 3)).expect("encodable"));
    files.push(encode_hdr(16, 2, &[0.5; 96]).expect("encodable"));
    for bytes in files {
        for end in 0..bytes.len() {
            let _ = read(&bytes[..end]);
        }
        mutate(&bytes, 1, 2000);
    }
}

/// Flips bytes at pseudo-random places and reads the result; only finishing counts.
fn mutate(bytes: &[u8], seed: u64, rounds: u32) {
    let mut state = seed;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for _ in 0..rounds {
        let mut copy = bytes.to_vec();
        for _ in 0..=random(4) {
            // Heads decide most: half of the flips go there.
            let range = if random(2) == 0 { copy.len() } else { copy.len().min(400) };
            copy[random(range)] = random(256) as u8;
        }
        if let Ok(image) = read(&copy) {
            assert_eq!(image.data.len(), image.width * image.height * image.channels.len());
        }
    }
}
