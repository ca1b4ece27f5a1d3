//! Sparse matrices on their way to another rank.

use crate::error::Result;
use crate::linalg::{Csr, Symmetric};
use crate::ranks::{put_all, wire_struct, Wire};

wire_struct!(Csr { cols, ptr, col, val });

impl Wire for Symmetric {
    fn put(&self, to: &mut Vec<u8>) {
        self.ptr.put(to);
        put_all(&self.col, to);
        put_all(&self.val, to);
    }

    fn take(from: &mut &[u8]) -> Result<Self> {
        Ok(Self::new(Wire::take(from)?, Vec::take(from)?, Vec::take(from)?))
    }
}
