//! Layout of a problem file; docs/file_format.md describes it byte by byte.
//!
//! ```text
//! header 32 bytes | section | section | ...
//! section: tag 4, flags 4, length 8 | payload | 0 to 7 zero bytes | CRC-32 4      (a multiple of 8 bytes)
//! ```

/// A byte that no text begins with, the name, and line ends that a transfer in text mode would change.
pub const MAGIC: [u8; 8] = *b"\x89FETI\r\n\x1a";
/// The format that is written; it is the only one.
pub const FORMAT: u32 = 1;
/// Bytes of the header: magic, format, library, length of the file, zero, CRC-32 of these.
pub const HEADER: u64 = 32;
/// Bytes of the head of a section.
pub const HEAD: u64 = 16;
/// Bytes of a checksum.
pub const CHECKSUM: u64 = 4;
/// Flag of a section: a reader that does not know the section may skip it.
pub const MAY_BE_SKIPPED: u32 = 1;

pub type Tag = [u8; 4];

pub const OPTIONS: Tag = *b"OPTS";
pub const BODY: Tag = *b"BODY";
pub const STIFFNESS: Tag = *b"STIF";
pub const PIECES: Tag = *b"PIEC";
pub const NULL_SPACE: Tag = *b"NULL";
pub const COORDINATES: Tag = *b"COOR";
pub const COORDINATES_FLAGS: Tag = *b"COOF";
pub const FIXING: Tag = *b"FIXD";
pub const LOAD: Tag = *b"LOAD";
pub const NUMBERING: Tag = *b"NUMB";
pub const ROWS: Tag = *b"ROWS";
pub const FRICTION: Tag = *b"FRIC";

/// Zero bytes between a payload of this length and its checksum.
pub fn padding(length: u64) -> u64 {
    (8 - (length % 8 + CHECKSUM) % 8) % 8
}

/// Bytes of a whole section; none if the sum overflows.
pub fn section_length(payload: u64) -> Option<u64> {
    payload.checked_add(HEAD + CHECKSUM + padding(payload))
}

/// 10000 major + 100 minor + patch of this library.
pub fn library() -> u32 {
    let number = |text: &str| text.parse().unwrap_or(0);
    10_000 * number(env!("CARGO_PKG_VERSION_MAJOR"))
        + 100 * number(env!("CARGO_PKG_VERSION_MINOR"))
        + number(env!("CARGO_PKG_VERSION_PATCH"))
}

/// "feti-contact 0.2.0"
pub fn named(library: u32) -> String {
    format!("feti-contact {}.{}.{}", library / 10_000, library / 100 % 100, library % 100)
}

/// CRC-32 of ISO-HDLC (as in gzip and PNG): polynomial 0x04C11DB7, reflected, initial value and final xor 0xFFFFFFFF.
#[derive(Debug, Clone, Copy)]
pub struct Crc(u32);

impl Crc {
    pub fn new() -> Self {
        Self(!0)
    }

    /// Processes eight bytes at a time: `TABLE[k]` is for a byte followed by k more bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        let mut crc = self.0;
        let mut words = bytes.chunks_exact(8);
        for word in &mut words {
            let first = crc.to_le_bytes();
            let entry = |k: usize| {
                let byte = if k < 4 { word[k] ^ first[k] } else { word[k] };
                TABLE[7 - k][usize::from(byte)]
            };
            crc = (0..8).fold(0, |sum, k| sum ^ entry(k));
        }
        for byte in words.remainder() {
            crc = TABLE[0][usize::from(byte ^ crc.to_le_bytes()[0])] ^ (crc >> 8);
        }
        self.0 = crc;
    }

    pub fn value(self) -> u32 {
        !self.0
    }
}

const TABLE: [[u32; 256]; 8] = tables();

const fn tables() -> [[u32; 256]; 8] {
    let mut tables = [[0; 256]; 8];
    let mut byte = 0;
    while byte < 256 {
        let (mut crc, mut bit) = (byte as u32, 0);
        while bit < 8 {
            crc = (crc >> 1) ^ (0xEDB8_8320 & (0_u32.wrapping_sub(crc & 1)));
            bit += 1;
        }
        tables[0][byte] = crc;
        byte += 1;
    }
    let mut k = 1;
    while k < 8 {
        let mut byte = 0;
        while byte < 256 {
            let before = tables[k - 1][byte];
            tables[k][byte] = (before >> 8) ^ tables[0][(before & 0xFF) as usize];
            byte += 1;
        }
        k += 1;
    }
    tables
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value from the catalogue of CRCs, and the sum computed bit by bit.
    #[test]
    fn the_checksum_is_the_one_of_gzip() {
        let mut crc = Crc::new();
        crc.add(b"123456789");
        assert_eq!(crc.value(), 0xCBF4_3926);
        let bytes: Vec<u8> = (0..1000_u32).map(|k| ((k * k) >> 3) as u8).collect();
        let mut by_bit = !0_u32;
        for byte in &bytes {
            by_bit ^= u32::from(*byte);
            (0..8).for_each(|_| by_bit = (by_bit >> 1) ^ if by_bit & 1 == 1 { 0xEDB8_8320 } else { 0 });
        }
        for cut in [0, 1, 7, 8, 9, 500, 1000] {
            let mut crc = Crc::new();
            crc.add(&bytes[..cut]);
            crc.add(&bytes[cut..]);
            assert_eq!(crc.value(), !by_bit, "cut at {cut}");
        }
    }

    #[test]
    fn every_section_is_a_multiple_of_eight_bytes() {
        for payload in 0..40 {
            assert!(padding(payload) < 8);
            assert_eq!(section_length(payload).unwrap() % 8, 0);
        }
        assert_eq!(section_length(u64::MAX), None);
    }
}
