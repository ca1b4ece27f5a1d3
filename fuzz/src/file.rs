//! Problem files: any bytes, or sections of any payload with right lengths and checksums.

use feti_contact::error::Kind;
use feti_contact::solver::Problem;

use super::bytes::Bytes;

const TAGS: [&[u8; 4]; 11] =
    [b"OPTS", b"BODY", b"STIF", b"NULL", b"COOR", b"COOF", b"FIXD", b"LOAD", b"ROWS", b"none", b"FRIC"];
/// Problems with more unknowns or rows are not solved.
const LARGEST: usize = 64;

/// CRC-32 as in gzip, bit by bit.
fn crc(bytes: &[u8]) -> [u8; 4] {
    let bit = |crc: u32| (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
    let byte = |crc: u32, byte: &u8| (0..8).fold(crc ^ u32::from(*byte), |crc, _| bit(crc));
    (!bytes.iter().fold(!0, byte)).to_le_bytes()
}

/// A file of the sections that the bytes describe: which, length in two bytes, payload.
fn sealed(bytes: &mut Bytes) -> Vec<u8> {
    let mut sections = Vec::new();
    while !bytes.used_up() {
        let tag = TAGS[bytes.below(TAGS.len())];
        let length = usize::from(bytes.byte()) + 256 * usize::from(bytes.byte());
        let payload = bytes.take(length);
        let start = sections.len();
        sections.extend_from_slice(tag);
        // The flag of the one that no reader knows.
        sections.extend_from_slice(&u32::from(tag == b"none").to_le_bytes());
        sections.extend_from_slice(&(payload.len() as u64).to_le_bytes());
        sections.extend_from_slice(payload);
        while sections.len() % 8 != 4 {
            sections.push(0);
        }
        let sum = crc(&sections[start..]);
        sections.extend_from_slice(&sum);
    }
    let mut file = b"\x89FETI\r\n\x1a\x01\0\0\0\x64\0\0\0".to_vec();
    file.extend_from_slice(&(sections.len() as u64 + 32).to_le_bytes());
    file.extend_from_slice(&[0; 4]);
    let sum = crc(&file);
    file.extend_from_slice(&sum);
    file.extend_from_slice(&sections);
    file
}

/// Reads, writes again, and solves what is small; nothing fails inside, and a written file reads back to the same bytes.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let file = if bytes.byte() & 7 == 7 { bytes.take(usize::MAX).to_vec() } else { sealed(&mut bytes) };
    let mut problem = Problem::new();
    if let Err(error) = problem.read_bytes(&file) {
        assert!(
            matches!(error.kind, Kind::Io | Kind::Unsupported | Kind::Memory),
            "{:?}: {error}",
            error.kind
        );
        let counts = problem.sizes();
        assert_eq!(counts.bodies + counts.rows + counts.equalities + counts.nodes, 0);
        return;
    }
    let written = problem.write_bytes().expect("a problem that was read is written");
    let mut back = Problem::new();
    back.read_bytes(&written).expect("what was written is read");
    assert!(back.write_bytes().expect("it is written again") == written, "other bytes");
    let counts = problem.sizes();
    if counts.dofs <= LARGEST && counts.rows + counts.equalities + counts.tangential <= LARGEST {
        solve(problem);
    }
}

/// A few steps, whatever the options of the file ask for.
fn solve(mut problem: Problem) {
    let few = [("threads", 1), ("max_steps", 50), ("paper_outer", 3), ("fault_injection", 0)];
    for (name, value) in few {
        problem.set_i64(name, value).expect("within the range");
    }
    if let Err(error) = problem.solve() {
        assert!(error.kind != Kind::Internal, "{error}");
    }
}
