//! The product by AVX-512, one cache line at a time. Rust has these instructions from 1.89 on; `build.rs` then sets the
//! cfg `avx512`. With an older compiler the product uses AVX2, with equal bits.
#![allow(clippy::incompatible_msrv)]

use std::arch::is_x86_feature_detected;
use std::arch::x86_64::*;

use crate::linalg::dense::packed::kernel::{sum, Kernel};
use crate::linalg::dense::packed::x86::prefetch;
use crate::linalg::dense::packed::{Line, Tile, SIDE};

/// A value of this type proves that the processor has AVX-512F.
pub struct Avx512(());

impl Avx512 {
    pub fn detect() -> Option<Self> {
        is_x86_feature_detected!("avx512f").then_some(Self(()))
    }
}

impl Kernel for Avx512 {
    fn columns<const P: usize>(
        &self,
        tiles: [&[Tile]; P],
        x: &[Line],
        y: &mut [Line],
        factors: &[Line; P],
    ) -> [Line; P] {
        // SAFETY: only `detect` makes a value of `Avx512`, if the processor has AVX-512F
        unsafe { by_lines(tiles, x, y, factors) }
    }

    fn ask_for(&self, tiles: &[Tile]) {
        prefetch(tiles);
    }
}

#[target_feature(enable = "avx512f")]
fn by_lines<const P: usize>(
    tiles: [&[Tile]; P],
    x: &[Line],
    y: &mut [Line],
    factors: &[Line; P],
) -> [Line; P] {
    let mut terms = [[_mm512_setzero_pd(); SIDE]; P];
    let tiles = tiles.map(|tiles| &tiles[..x.len()]);
    for (at, (x, y)) in x.iter().zip(y).enumerate() {
        let (x, mut image) = (load(x), load(y));
        for p in 0..P {
            for k in 0..SIDE {
                let a = load(&tiles[p][at].0[k]);
                terms[p][k] = _mm512_add_pd(terms[p][k], _mm512_mul_pd(a, x));
                image = _mm512_add_pd(image, _mm512_mul_pd(a, _mm512_set1_pd(factors[p][k])));
            }
        }
        // SAFETY: a line is as long as the vector; no alignment is required
        unsafe { _mm512_storeu_pd(y.as_mut_ptr(), image) };
    }
    let mut products = [[0.0; SIDE]; P];
    for (terms, products) in terms.iter().zip(&mut products) {
        for (terms, product) in terms.iter().zip(products) {
            let mut line = [0.0; SIDE];
            // SAFETY: a line is as long as the vector; no alignment is required
            unsafe { _mm512_storeu_pd(line.as_mut_ptr(), *terms) };
            *product = sum(&line);
        }
    }
    products
}

#[target_feature(enable = "avx512f")]
fn load(line: &Line) -> __m512d {
    // SAFETY: a line is as long as the vector; no alignment is required
    unsafe { _mm512_loadu_pd(line.as_ptr()) }
}
