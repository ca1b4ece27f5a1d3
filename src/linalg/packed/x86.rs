//! The product by vector instructions of x86-64. A value of `Avx2` or `Avx512` is the proof that the processor has them.

use std::arch::is_x86_feature_detected;
use std::arch::x86_64::*;

use crate::linalg::packed::product::Kernel;
use crate::linalg::packed::{Line, Tile, SIDE};

/// AVX2 with fused multiply-add: half a line at a time.
pub struct Avx2(());

/// AVX-512: a line at a time.
pub struct Avx512(());

impl Avx2 {
    pub fn detect() -> Option<Self> {
        (is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")).then_some(Self(()))
    }
}

impl Avx512 {
    pub fn detect() -> Option<Self> {
        is_x86_feature_detected!("avx512f").then_some(Self(()))
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
        // SAFETY: `detect` alone makes a value of `Avx2`, where the processor has AVX2 and FMA
        unsafe { by_halves(tiles, x, y, factors) }
    }

    fn ask_for(&self, tiles: &[Tile]) {
        prefetch(tiles);
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
        // SAFETY: `detect` alone makes a value of `Avx512`, where the processor has AVX-512F
        unsafe { by_lines(tiles, x, y, factors) }
    }

    fn ask_for(&self, tiles: &[Tile]) {
        prefetch(tiles);
    }
}

fn prefetch(tiles: &[Tile]) {
    for line in tiles.iter().flat_map(|tile| &tile.0) {
        // SAFETY: SSE is part of x86-64; nothing is read or written
        unsafe { _mm_prefetch::<_MM_HINT_T1>(line.as_ptr().cast()) };
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
        let (x, mut sum) = (load(x), load(y));
        for p in 0..P {
            for k in 0..SIDE {
                let a = load(&tiles[p][at].0[k]);
                terms[p][k] = _mm512_fmadd_pd(a, x, terms[p][k]);
                sum = _mm512_fmadd_pd(a, _mm512_set1_pd(factors[p][k]), sum);
            }
        }
        // SAFETY: a line is as long as the vector; no alignment is asked for
        unsafe { _mm512_storeu_pd(y.as_mut_ptr(), sum) };
    }
    let mut products = [[0.0; SIDE]; P];
    for (terms, products) in terms.iter().zip(&mut products) {
        terms.iter().zip(products).for_each(|(terms, product)| *product = _mm512_reduce_add_pd(*terms));
    }
    products
}

#[target_feature(enable = "avx512f")]
fn load(line: &Line) -> __m512d {
    // SAFETY: a line is as long as the vector; no alignment is asked for
    unsafe { _mm512_loadu_pd(line.as_ptr()) }
}

#[target_feature(enable = "avx2,fma")]
fn by_halves<const P: usize>(
    tiles: [&[Tile]; P],
    x: &[Line],
    y: &mut [Line],
    factors: &[Line; P],
) -> [Line; P] {
    let mut terms = [[_mm256_setzero_pd(); SIDE]; P];
    let tiles = tiles.map(|tiles| &tiles[..x.len()]);
    for (at, (x, y)) in x.iter().zip(y).enumerate() {
        let ([x_low, x_high], [mut low, mut high]) = (halves(x), halves(y));
        for p in 0..P {
            for k in 0..SIDE {
                let ([a_low, a_high], factor) = (halves(&tiles[p][at].0[k]), _mm256_set1_pd(factors[p][k]));
                terms[p][k] = _mm256_fmadd_pd(a_low, x_low, terms[p][k]);
                low = _mm256_fmadd_pd(a_low, factor, low);
                terms[p][k] = _mm256_fmadd_pd(a_high, x_high, terms[p][k]);
                high = _mm256_fmadd_pd(a_high, factor, high);
            }
        }
        // SAFETY: a line is as long as two vectors; no alignment is asked for
        unsafe {
            _mm256_storeu_pd(y.as_mut_ptr(), low);
            _mm256_storeu_pd(y.as_mut_ptr().add(SIDE / 2), high);
        }
    }
    let mut products = [[0.0; SIDE]; P];
    for (terms, products) in terms.iter().zip(&mut products) {
        terms.iter().zip(products).for_each(|(terms, product)| *product = sum(*terms));
    }
    products
}

#[target_feature(enable = "avx2,fma")]
fn halves(line: &Line) -> [__m256d; 2] {
    // SAFETY: a line is as long as two vectors; no alignment is asked for
    unsafe { [_mm256_loadu_pd(line.as_ptr()), _mm256_loadu_pd(line.as_ptr().add(SIDE / 2))] }
}

#[target_feature(enable = "avx2,fma")]
fn sum(terms: __m256d) -> f64 {
    let pairs = _mm_add_pd(_mm256_castpd256_pd128(terms), _mm256_extractf128_pd::<1>(terms));
    _mm_cvtsd_f64(_mm_add_sd(pairs, _mm_unpackhi_pd(pairs, pairs)))
}
