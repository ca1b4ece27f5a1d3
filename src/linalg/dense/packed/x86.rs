//! The product by vector instructions of x86-64. A value of `Avx2` proves that the processor has them. Products and sums
//! are rounded separately and in the order of the plain loops: equal bits on any processor.

use std::arch::is_x86_feature_detected;
use std::arch::x86_64::*;

use crate::linalg::dense::packed::kernel::{sum, Kernel};
use crate::linalg::dense::packed::{Line, Tile, SIDE};

/// AVX2, which processes half a line at a time.
pub struct Avx2(());

impl Avx2 {
    pub fn detect() -> Option<Self> {
        is_x86_feature_detected!("avx2").then_some(Self(()))
    }
}

impl Kernel for Avx2 {
    fn columns<const P: usize>(
        &self,
        tiles: [&[Tile]; P],
        x: &[Line],
        y: &mut [Line],
        factors: &[Line; P],
    ) -> [Line; P] {
        // SAFETY: only `detect` makes a value of `Avx2`, if the processor has AVX2
        unsafe { by_halves(tiles, x, y, factors) }
    }

    fn ask_for(&self, tiles: &[Tile]) {
        prefetch(tiles);
    }
}

pub fn prefetch(tiles: &[Tile]) {
    for line in tiles.iter().flat_map(|tile| &tile.0) {
        // SAFETY: SSE is part of x86-64; nothing is read or written
        unsafe { _mm_prefetch::<_MM_HINT_T1>(line.as_ptr().cast()) };
    }
}

#[target_feature(enable = "avx2")]
unsafe fn by_halves<const P: usize>(
    tiles: [&[Tile]; P],
    x: &[Line],
    y: &mut [Line],
    factors: &[Line; P],
) -> [Line; P] {
    let mut terms = [[[_mm256_setzero_pd(); 2]; SIDE]; P];
    let tiles = tiles.map(|tiles| &tiles[..x.len()]);
    for (at, (x, y)) in x.iter().zip(y).enumerate() {
        let ([x_low, x_high], [mut low, mut high]) = (halves(x), halves(y));
        for p in 0..P {
            for k in 0..SIDE {
                let ([a_low, a_high], factor) = (halves(&tiles[p][at].0[k]), _mm256_set1_pd(factors[p][k]));
                let [to_low, to_high] = &mut terms[p][k];
                *to_low = _mm256_add_pd(*to_low, _mm256_mul_pd(a_low, x_low));
                *to_high = _mm256_add_pd(*to_high, _mm256_mul_pd(a_high, x_high));
                low = _mm256_add_pd(low, _mm256_mul_pd(a_low, factor));
                high = _mm256_add_pd(high, _mm256_mul_pd(a_high, factor));
            }
        }
        store(low, high, y);
    }
    let mut products = [[0.0; SIDE]; P];
    for (terms, products) in terms.iter().zip(&mut products) {
        for ([low, high], product) in terms.iter().zip(products) {
            let mut line = [0.0; SIDE];
            store(*low, *high, &mut line);
            *product = sum(&line);
        }
    }
    products
}

#[target_feature(enable = "avx2")]
unsafe fn store(low: __m256d, high: __m256d, line: &mut Line) {
    // SAFETY: a line is as long as two vectors; no alignment is required
    unsafe {
        _mm256_storeu_pd(line.as_mut_ptr(), low);
        _mm256_storeu_pd(line.as_mut_ptr().add(SIDE / 2), high);
    }
}

#[target_feature(enable = "avx2")]
unsafe fn halves(line: &Line) -> [__m256d; 2] {
    // SAFETY: a line is as long as two vectors; no alignment is required
    unsafe { [_mm256_loadu_pd(line.as_ptr()), _mm256_loadu_pd(line.as_ptr().add(SIDE / 2))] }
}
