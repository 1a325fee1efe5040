//! Packets of tev's protocol (github.com/Tom94/tev): a length of four bytes that counts itself, a type of one, then
//! numbers with the least byte first, truth values of one byte, and texts that end with a zero byte.

/// Types of packets.
const CREATE_IMAGE: u8 = 4;
const UPDATE_IMAGE: u8 = 6;
const OPEN_IMAGE: u8 = 7;

/// A packet in the making.
#[derive(Debug)]
struct Packet(Vec<u8>);

impl Packet {
    /// The viewer shows the image, if `focus`.
    fn new(kind: u8, focus: bool) -> Self {
        Self(vec![0, 0, 0, 0, kind, u8::from(focus)])
    }

    fn text(mut self, text: &str) -> Self {
        // A zero byte would end it.
        self.0.extend(text.bytes().filter(|b| *b != 0));
        self.0.push(0);
        self
    }

    fn int(mut self, value: usize) -> Self {
        self.0.extend((value as i32).to_le_bytes());
        self
    }

    fn long(mut self, value: usize) -> Self {
        self.0.extend((value as i64).to_le_bytes());
        self
    }

    fn finish(mut self) -> Vec<u8> {
        let length = self.0.len() as u32;
        self.0[..4].copy_from_slice(&length.to_le_bytes());
        self.0
    }
}

/// Makes an image of these channels, in place of one of the same name.
pub fn create_image(name: &str, [width, height]: [usize; 2], channels: &[String]) -> Vec<u8> {
    let packet = Packet::new(CREATE_IMAGE, true).text(name).int(width).int(height).int(channels.len());
    channels.iter().fold(packet, |packet, channel| packet.text(channel)).finish()
}

/// Opens a file.
pub fn open_image(path: &str) -> Vec<u8> {
    // Of all its channels.
    Packet::new(OPEN_IMAGE, false).text(path).text("").finish()
}

/// Numbers for a rectangle of an image. Each channel names its first number in `data` and the distance from there to
/// its next one; `place` is column, row, width and height.
pub fn update_image(
    name: &str,
    channels: &[(String, usize, usize)],
    place: [usize; 4],
    data: &[f32],
) -> Vec<u8> {
    let packet = Packet::new(UPDATE_IMAGE, false).text(name).int(channels.len());
    let packet = channels.iter().fold(packet, |packet, (channel, ..)| packet.text(channel));
    let packet = place.into_iter().fold(packet, Packet::int);
    let packet = channels.iter().fold(packet, |packet, (_, first, _)| packet.long(*first));
    let mut packet = channels.iter().fold(packet, |packet, (.., stride)| packet.long(*stride));
    packet.0.reserve(4 * data.len());
    packet.0.extend(data.iter().flat_map(|v| v.to_le_bytes()));
    packet.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_those_of_the_protocol() {
        let names = ["R", "G"].map(str::to_owned);
        assert_eq!(
            create_image("a", [3, 2], &names),
            [24, 0, 0, 0, 4, 1, b'a', 0, 3, 0, 0, 0, 2, 0, 0, 0, 2, 0, 0, 0, b'R', 0, b'G', 0]
        );
        assert_eq!(open_image("/b"), [10, 0, 0, 0, 7, 0, b'/', b'b', 0, 0]);
        let update = update_image("a", &[("R".to_owned(), 1, 2)], [5, 6, 1, 2], &[0.0, 1.0, 0.0, 2.0]);
        let expected: Vec<u8> = [
            &[62, 0, 0, 0, 6, 0, b'a', 0, 1, 0, 0, 0, b'R', 0][..],
            &[5, 0, 0, 0, 6, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0],
            &[1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 0, 0],
            &[0, 0, 0, 0, 0, 0, 128, 63, 0, 0, 0, 0, 0, 0, 0, 64],
        ]
        .concat();
        assert_eq!(update, expected);
    }
}
