//! The bytes of a file that may be damaged or hostile: every length is compared with the remaining length of the file
//! before any memory is reserved.

use std::io::Read;

use crate::error::{Error, Kind, Result};
use crate::model::file::format::{
    self, padding, section_length, Crc, Tag, FORMAT, HEAD, HEADER, MAGIC, MAY_BE_SKIPPED,
};
use crate::platform::memory::reserved;

/// Bytes converted in one block.
const BLOCK: usize = 8192;

/// A file that is read sequentially.
pub struct Input<R> {
    source: R,
    /// Position of the next byte.
    at: u64,
    /// Bytes of the whole file.
    length: u64,
    /// Version of the library that wrote the file.
    library: u32,
    crc: Crc,
}

/// The section being read.
pub struct OpenSection {
    pub tag: Tag,
    flags: u32,
    /// Byte at which it begins.
    start: u64,
    /// Bytes of its payload, and bytes not read yet.
    payload: u64,
    left: u64,
}

impl OpenSection {
    /// "section STIF"
    fn name(&self) -> String {
        format!("section {}", self.tag.escape_ascii())
    }
}

impl<R: Read> Input<R> {
    /// Opens a file of `length` bytes and reads its header.
    pub fn new(source: R, length: u64) -> Result<Self> {
        let mut input = Self { source, at: 0, length, library: 0, crc: Crc::new() };
        input.header()?;
        Ok(input)
    }

    /// The whole file has been read.
    pub fn is_at_its_end(&self) -> bool {
        self.at >= self.length
    }

    fn header(&mut self) -> Result<()> {
        if self.length < HEADER {
            let what = format!("the file ends after {} bytes, inside its header of {HEADER}", self.length);
            return Err(damaged(self.length, what));
        }
        let magic: [u8; 8] = self.bytes()?;
        if magic != MAGIC {
            return Err(damaged(0, "this is not a problem file of feti-contact"));
        }
        let (format, library) = (u32::from_le_bytes(self.bytes()?), u32::from_le_bytes(self.bytes()?));
        let written = u64::from_le_bytes(self.bytes()?);
        let zero = u32::from_le_bytes(self.bytes()?);
        self.checksum(0, "the header")?;
        self.library = library;
        if format != FORMAT || zero != 0 {
            let (wrote, reads) = (format::named(library), format::named(format::library()));
            let what = format!("format {format}.{zero}, written by {wrote}; {reads} reads format {FORMAT}.0");
            return Err(Error::new(Kind::Unsupported, what).byte(8));
        }
        if written != self.length {
            let what = format!("the file has {} bytes, but {written} were written", self.length);
            return Err(damaged(self.length.min(written), what));
        }
        Ok(())
    }

    /// Reads the head of a section and checks that its length fits the file.
    pub fn open(&mut self) -> Result<OpenSection> {
        let start = self.at;
        if self.length - start < HEAD {
            return Err(damaged(start, "the file ends inside the head of a section"));
        }
        self.crc = Crc::new();
        let (tag, flags) = (self.bytes()?, u32::from_le_bytes(self.bytes()?));
        let payload = u64::from_le_bytes(self.bytes()?);
        let open = OpenSection { tag, flags, start, payload, left: payload };
        if section_length(payload).is_none_or(|whole| whole > self.length - start) {
            let what = format!("{} has {payload} bytes, but the file ends before", open.name());
            return Err(damaged(start, what));
        }
        Ok(open)
    }

    /// Checks that the payload is fully read, and the padding and the checksum.
    pub fn close(&mut self, open: &mut OpenSection) -> Result<()> {
        if open.left > 0 {
            return Err(damaged(self.at, format!("{} bytes too many in {}", open.left, open.name())));
        }
        self.trailer(open)
    }

    fn trailer(&mut self, open: &OpenSection) -> Result<()> {
        let mut zeros = [0; 8];
        let zeros = &mut zeros[..padding(open.payload) as usize];
        let at = self.at;
        self.fill(zeros)?;
        self.checksum(open.start, &open.name())?;
        if open.flags & !MAY_BE_SKIPPED != 0 || zeros.iter().any(|zero| *zero != 0) {
            return Err(damaged(at, format!("{} holds bits that are not zero", open.name())));
        }
        Ok(())
    }

    /// Skips a section that this library does not know, if its flag permits.
    pub fn skip(&mut self, open: &mut OpenSection) -> Result<()> {
        let mut block = [0; BLOCK];
        while open.left > 0 {
            let now = open.left.min(BLOCK as u64);
            self.fill(&mut block[..now as usize])?;
            open.left -= now;
        }
        self.trailer(open)?;
        if open.flags & MAY_BE_SKIPPED != 0 {
            return Ok(());
        }
        let (wrote, reads) = (format::named(self.library), format::named(format::library()));
        let what = format!("{} of a file written by {wrote} is not known to {reads}", open.name());
        Err(Error::new(Kind::Unsupported, what).byte(position(open.start)))
    }

    fn checksum(&mut self, start: u64, what: &str) -> Result<()> {
        let found = self.crc.value();
        let written = u32::from_le_bytes(self.bytes()?);
        if found == written {
            return Ok(());
        }
        let what = format!("{what} is damaged: its checksum is {found:08x}, but {written:08x} was written");
        Err(damaged(start, what))
    }

    fn bytes<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut bytes = [0; N];
        self.fill(&mut bytes)?;
        Ok(bytes)
    }

    fn fill(&mut self, bytes: &mut [u8]) -> Result<()> {
        self.source.read_exact(bytes).map_err(|error| damaged(self.at, format!("read: {error}")))?;
        self.crc.add(bytes);
        self.at += bytes.len() as u64;
        Ok(())
    }

    /// A number of a section.
    pub fn number(&mut self, open: &mut OpenSection) -> Result<u64> {
        self.take(open, 1, 8)?;
        Ok(u64::from_le_bytes(self.bytes()?))
    }

    /// A number that must be valid as an index or a size on this machine.
    pub fn size(&mut self, open: &mut OpenSection) -> Result<usize> {
        let at = self.at;
        let number = self.number(open)?;
        let fits = usize::try_from(number).ok().filter(|size| *size <= isize::MAX as usize / 8);
        fits.ok_or_else(|| damaged(at, format!("{number} in {}: no array has so many entries", open.name())))
    }

    /// `len` numbers of N bytes each.
    pub fn array<T, const N: usize>(
        &mut self,
        open: &mut OpenSection,
        len: usize,
        number: impl Fn([u8; N]) -> T,
    ) -> Result<Vec<T>> {
        self.take(open, len as u64, N as u64)?;
        let mut values = reserved(len, "a problem file")?;
        let mut block = [0; BLOCK];
        while values.len() < len {
            let now = (len - values.len()).min(BLOCK / N);
            let used = &mut block[..now * N];
            self.fill(used)?;
            let exact = used.chunks_exact(N).filter_map(|bytes| <[u8; N]>::try_from(bytes).ok());
            values.extend(exact.map(&number));
        }
        Ok(values)
    }

    /// A count, followed by this many numbers of N bytes each.
    pub fn counted<T, const N: usize>(
        &mut self,
        open: &mut OpenSection,
        number: impl Fn([u8; N]) -> T,
    ) -> Result<Vec<T>> {
        let len = self.size(open)?;
        self.array(open, len, number)
    }

    pub fn reals(&mut self, open: &mut OpenSection, len: usize) -> Result<Vec<f64>> {
        self.array(open, len, f64::from_le_bytes)
    }

    /// Row pointers: `rows` + 1 nondecreasing numbers from 0 to `entries`.
    pub fn pointers(&mut self, open: &mut OpenSection, rows: usize, entries: usize) -> Result<Vec<usize>> {
        let at = self.at;
        let pointers = self.array(open, rows + 1, saturated)?;
        if pointers[0] != 0 || pointers[rows] != entries {
            let what = format!("the rows of {} do not go from 0 to {entries}", open.name());
            return Err(damaged(at, what));
        }
        match pointers.windows(2).position(|pair| pair[0] > pair[1]) {
            Some(row) => {
                Err(damaged(at + 8 * row as u64, format!("a row of {} ends before it begins", open.name())))
            }
            None => Ok(pointers),
        }
    }

    /// The rest of the section as text.
    pub fn text(&mut self, open: &mut OpenSection) -> Result<String> {
        let at = self.at;
        let left = usize::try_from(open.left).unwrap_or(usize::MAX);
        let bytes = self.array(open, left, |[byte]: [u8; 1]| byte)?;
        String::from_utf8(bytes).map_err(|_| damaged(at, format!("{} is not UTF-8", open.name())))
    }

    /// An error about the content of a section, at the number read last.
    pub fn wrong(&self, open: &OpenSection, what: &str) -> Error {
        damaged(self.at.saturating_sub(8), format!("{}: {what}", open.name()))
    }

    /// Checks that the section still has `len` numbers.
    fn take(&self, open: &mut OpenSection, len: u64, each: u64) -> Result<()> {
        let wanted = len.checked_mul(each).filter(|wanted| *wanted <= open.left);
        open.left -= wanted.ok_or_else(|| {
            let what =
                format!("{} needs {len} numbers of {each} bytes, but has {} bytes", open.name(), open.left);
            damaged(self.at, what)
        })?;
        Ok(())
    }

    /// Converts an error of a call to an error about the file.
    pub fn refused(&self, mut error: Error, open: &OpenSection) -> Error {
        if error.kind == Kind::Memory {
            return error;
        }
        error.kind = Kind::Io;
        let (name, wrote) = (open.name(), format::named(self.library));
        error.what = format!("{name}, written by {wrote}: {}", error.what);
        error.byte(position(open.start))
    }
}

/// An index or a size; if it is too large for this machine, the largest value, which every call refuses.
pub fn saturated(bytes: [u8; 8]) -> usize {
    usize::try_from(u64::from_le_bytes(bytes)).unwrap_or(usize::MAX)
}

fn damaged(at: u64, what: impl Into<String>) -> Error {
    Error::new(Kind::Io, what).byte(position(at))
}

fn position(at: u64) -> usize {
    usize::try_from(at).unwrap_or(usize::MAX)
}
