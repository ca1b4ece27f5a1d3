//! What precedes every message.

use crate::ranks::wire::wire_struct;

/// 64 bytes before every message.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// `MAGIC`: the sender is this library, little-endian.
    pub magic: u32,
    /// `build()` of the sender.
    pub build: u32,
    /// Number of the request; an answer has that of its request.
    pub serial: u64,
    /// The question.
    pub question: u32,
    /// 1: the message is an error.
    pub failed: u32,
    /// Length of the message.
    pub bytes: u64,
    /// Time left for the answer, infinite without limit.
    pub seconds_left: f64,
    /// Of an answer: 1 if the host has cancelled the call on its rank.
    pub cancelled: u64,
    pub reserved: (u64, u64),
}

pub const FRAME: usize = 64;

/// "FETI"
const MAGIC: u32 = 0x4954_4546;

wire_struct!(Frame { magic, build, serial, question, failed, bytes, seconds_left, cancelled, reserved });

impl Frame {
    pub fn new(serial: u64, question: u32, failed: bool, bytes: usize, seconds_left: f64) -> Self {
        let (failed, bytes) = (u32::from(failed), bytes as u64);
        let (magic, build, cancelled, reserved) = (MAGIC, build(), 0, (0, 0));
        Self { magic, build, serial, question, failed, bytes, seconds_left, cancelled, reserved }
    }

    /// The sender is the same build of this library.
    pub fn is_ours(&self) -> bool {
        self.magic == MAGIC && self.build == build()
    }
}

/// A number of this build: all ranks must have the same.
fn build() -> u32 {
    let text = concat!(env!("CARGO_PKG_VERSION"), env!("CARGO_PKG_NAME"));
    // FNV-1a
    text.bytes().fold(0x811c_9dc5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ranks::wire::{message, value};

    #[test]
    fn a_frame_has_64_bytes_and_tells_another_library() {
        let frame = Frame::new(7, 3, true, 1 << 40, f64::INFINITY);
        let bytes = message(&frame);
        assert_eq!(bytes.len(), FRAME);
        let sent: Frame = value(&bytes).unwrap();
        assert!(sent == frame && sent.is_ours());
        assert!(!Frame { build: 1, ..frame }.is_ours());
    }
}
