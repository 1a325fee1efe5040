//! Mitsuba's `VOL` files, version 3, of all encodings. Little endian.

use half::f16;

use super::{Grid, Store, VolumeError};
use crate::ir::Transform;

const HEADER: usize = 48;

/// Reads the file. Takes at most six times as much memory as it is long.
pub(super) fn read(bytes: &[u8]) -> Result<Grid, VolumeError> {
    if !bytes.starts_with(b"VOL") {
        return Err(VolumeError::Magic("VOL"));
    }
    let short = |needed: u64| VolumeError::Short { needed, found: bytes.len() as u64 };
    let (header, body) = bytes.split_at_checked(HEADER).ok_or_else(|| short(HEADER as u64))?;
    let word = |at: usize| [header[at], header[at + 1], header[at + 2], header[at + 3]];
    if header[3] != 3 {
        return Err(VolumeError::Unsupported(format!("of version {}", header[3])));
    }
    let encoding = Encoding::of(i32::from_le_bytes(word(4)))?;
    let counts = [8, 12, 16].map(|at| i32::from_le_bytes(word(at)));
    let [Ok(nx), Ok(ny), Ok(nz)] = counts.map(u32::try_from) else {
        return Err(VolumeError::Invalid(format!("the file has {counts:?} points along its axes")));
    };
    let resolution = [nx, ny, nz];
    let channels = i32::from_le_bytes(word(20));
    let Some(channels) = u32::try_from(channels).ok().filter(|n| encoding.channels().contains(n)) else {
        return Err(VolumeError::Unsupported(format!("of {channels} channels in its encoding")));
    };
    let place = place([24, 28, 32, 36, 40, 44].map(|at| f64::from(f32::from_le_bytes(word(at)))));
    let points = resolution.iter().try_fold(1u64, |product, &n| product.checked_mul(u64::from(n)));
    let size = points.and_then(|points| points.checked_mul(encoding.bytes(channels)));
    let (Some(points @ 1..), Some(size)) = (points, size) else {
        return Err(VolumeError::Invalid(format!("the file has {resolution:?} points along its axes")));
    };
    if (body.len() as u64) < size {
        return Err(short(size.saturating_add(HEADER as u64)));
    }
    let values = encoding.decode(&body[..size as usize]);
    debug_assert_eq!(values.len() as u64, points * u64::from(channels));
    if let Some(at) = values.iter().position(|v| !v.is_finite()) {
        return Err(VolumeError::Invalid(format!("value {at} of the file is {}", values[at])));
    }
    Ok(Grid { resolution, channels, place, store: Store::Dense(values) })
}

/// From the unit cube to the box of the file. Mitsuba 2 and 3 seldom use it, so that many files have none.
fn place(bounds: [f64; 6]) -> Option<Transform> {
    let [x0, y0, z0, x1, y1, z1] = bounds;
    let size = [x1 - x0, y1 - y0, z1 - z0];
    let sound = bounds.iter().all(|c| c.is_finite()) && size.iter().all(|s| *s > 0.0);
    sound.then(|| Transform::translate([x0, y0, z0]).after(&Transform::scale(size)))
}

#[derive(Clone, Copy)]
enum Encoding {
    Float32,
    Float16,
    /// 0..=255 stand for 0..=1.
    Byte,
    /// Polar angle and azimuth in a byte each, in steps of π/255 and 2π/255; 255 is the zero vector.
    Directions,
}

impl Encoding {
    fn of(code: i32) -> Result<Self, VolumeError> {
        match code {
            1 => Ok(Self::Float32),
            2 => Ok(Self::Float16),
            3 => Ok(Self::Byte),
            4 => Ok(Self::Directions),
            _ => Err(VolumeError::Unsupported(format!("of encoding {code}"))),
        }
    }

    /// The numbers of channels that readers of it take.
    fn channels(self) -> &'static [u32] {
        match self {
            Self::Directions => &[3],
            _ => &[1, 3, 6],
        }
    }

    /// Of one point.
    fn bytes(self, channels: u32) -> u64 {
        match self {
            Self::Float32 => 4 * u64::from(channels),
            Self::Float16 => 2 * u64::from(channels),
            Self::Byte => u64::from(channels),
            Self::Directions => 2,
        }
    }

    fn decode(self, bytes: &[u8]) -> Vec<f32> {
        match self {
            Self::Float32 => bytes.as_chunks::<4>().0.iter().map(|b| f32::from_le_bytes(*b)).collect(),
            Self::Float16 => {
                bytes.as_chunks::<2>().0.iter().map(|b| f16::from_le_bytes(*b).to_f32()).collect()
            }
            Self::Byte => bytes.iter().map(|b| f32::from(*b) / 255.0).collect(),
            Self::Directions => {
                bytes.as_chunks::<2>().0.iter().flat_map(|angles| direction(*angles)).collect()
            }
        }
    }
}

fn direction([polar, azimuth]: [u8; 2]) -> [f32; 3] {
    if polar == u8::MAX || azimuth == u8::MAX {
        return [0.0; 3];
    }
    let (sin, cos) = (f32::from(polar) * std::f32::consts::PI / 255.0).sin_cos();
    let (y, x) = (f32::from(azimuth) * std::f32::consts::TAU / 255.0).sin_cos();
    [x * sin, y * sin, cos]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::VolumeFormat;
    use crate::volume;

    fn file(encoding: i32, resolution: [i32; 3], channels: i32, bounds: [f32; 6], body: &[u8]) -> Vec<u8> {
        let mut file = b"VOL\x03".to_vec();
        let numbers = [encoding, resolution[0], resolution[1], resolution[2], channels];
        file.extend(numbers.into_iter().flat_map(i32::to_le_bytes));
        file.extend(bounds.into_iter().flat_map(f32::to_le_bytes));
        file.extend(body);
        file
    }

    const UNIT: [f32; 6] = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];

    #[test]
    fn x_is_fastest_and_channels_stand_together() {
        let body: Vec<u8> = (0..36).flat_map(|i| (i as f32).to_le_bytes()).collect();
        let bytes = file(1, [2, 3, 2], 3, [-1.0, 0.0, 2.0, 1.0, 4.0, 3.0], &body);
        let grid = volume::read(&bytes, &VolumeFormat::Vol).unwrap();
        assert_eq!((grid.resolution, grid.channels), ([2, 3, 2], 3));
        assert_eq!(grid.value([1, 0, 0], 0), 3.0);
        assert_eq!(grid.value([0, 1, 0], 2), 8.0);
        assert_eq!(grid.value([1, 2, 1], 1), 34.0);
        let place = grid.place.unwrap();
        assert_eq!(place.point([0.0; 3]), [-1.0, 0.0, 2.0]);
        assert_eq!(place.point([1.0; 3]), [1.0, 4.0, 3.0]);
    }

    #[test]
    fn all_encodings_are_read() {
        let half = f16::from_f32(0.25).to_le_bytes();
        let value =
            |bytes: &[u8], channel| volume::read(bytes, &VolumeFormat::Vol).unwrap().value([0; 3], channel);
        assert_eq!(value(&file(2, [1; 3], 1, UNIT, &half), 0), 0.25);
        assert_eq!(value(&file(3, [1; 3], 1, UNIT, &[51]), 0), 0.2);
        // A quarter of the way round from +x, on the equator within half a step of π/255.
        let across = file(4, [1; 3], 3, UNIT, &[128, 64]);
        let expected = [0.0, 1.0, 0.0];
        for (channel, wanted) in expected.into_iter().enumerate() {
            assert!((value(&across, channel as u32) - wanted).abs() < 0.01, "{channel}");
        }
        let none = file(4, [1; 3], 3, UNIT, &[255, 255]);
        assert_eq!([0, 1, 2].map(|channel| value(&none, channel)), [0.0; 3]);
    }

    #[test]
    fn faults_are_named() {
        let read = |bytes: &[u8]| volume::read(bytes, &VolumeFormat::Vol).unwrap_err().to_string();
        insta::assert_snapshot!([
            read(b"PK"),
            read(b"VOL\x02"),
            read(&[b"VOL\x02".as_slice(), &[0; 44]].concat()),
            read(&file(5, [1; 3], 1, UNIT, &[])),
            read(&file(1, [1; 3], 2, UNIT, &[])),
            read(&file(1, [i32::MAX; 3], 6, UNIT, &[])),
            read(&file(1, [0, 1, 1], 1, UNIT, &[])),
            read(&file(1, [-1, 1, 1], 1, UNIT, &[])),
            read(&file(1, [2, 1, 1], 1, UNIT, &[0; 7])),
            read(&file(1, [1; 3], 1, UNIT, &f32::NAN.to_le_bytes())),
        ].join("\n"), @r"
        not a volume file: it does not begin with VOL
        the file ends early: 48 bytes are needed, 4 are there
        a volume file of version 2 is not supported
        a volume file of encoding 5 is not supported
        a volume file of 2 channels in its encoding is not supported
        the file has [2147483647, 2147483647, 2147483647] points along its axes
        the file has [0, 1, 1] points along its axes
        the file has [-1, 1, 1] points along its axes
        the file ends early: 56 bytes are needed, 55 are there
        value 0 of the file is NaN
        ");
    }

    #[test]
    fn a_box_of_no_size_is_none() {
        let bytes = file(3, [1; 3], 1, [0.0; 6], &[1]);
        assert_eq!(volume::read(&bytes, &VolumeFormat::Vol).unwrap().place, None);
    }
}
