//! Numbers moved within vectors: what x86 has one instruction for, and portable vectors do not name.

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64 as arch;

#[cfg(target_arch = "x86_64")]
use fearless_simd::{Avx2, kernel};
use fearless_simd::{Simd, f32x4, f32x8, f64x4, prelude::*, u32x8};

/// The numbers of a row at these places, of each of which the lowest three bits count.
#[inline(always)]
pub(super) fn picked<S: Simd>(simd: S, row: &[f32; 8], places: u32x8<S>) -> f32x8<S> {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        let row = f32x8::load_array_ref(avx2, row);
        let places = u32x8::load_array(avx2, places.to_array());
        return f32x8::load_array(simd, permuted(avx2, row, places).to_array());
    }
    let places = places.to_array();
    f32x8::load_array(simd, places.map(|place| row[place as usize % 8]))
}

/// Four rows to four columns, in both halves.
#[inline(always)]
pub(super) fn transposed<S: Simd>(simd: S, r: [f32x8<S>; 4]) -> [f32x8<S>; 4] {
    let ([a, c], [b, d]) = (zip(simd, r[0], r[2]), zip(simd, r[1], r[3]));
    let ([p, q], [r, s]) = (zip(simd, a, b), zip(simd, c, d));
    [p, q, r, s]
}

/// Takes numbers of both in turn, in both halves: from their first two, then from their last two.
#[inline(always)]
fn zip<S: Simd>(simd: S, a: f32x8<S>, b: f32x8<S>) -> [f32x8<S>; 2] {
    #[cfg(target_arch = "x86_64")]
    if let Some(avx2) = simd.level().as_avx2() {
        let a = f32x8::load_array(avx2, a.to_array());
        let b = f32x8::load_array(avx2, b.to_array());
        let (first, last) = (zipped_first(avx2, a, b), zipped_last(avx2, a, b));
        return [
            f32x8::load_array(simd, first.to_array()),
            f32x8::load_array(simd, last.to_array()),
        ];
    }
    let (first, last) = (
        simd.zip_low_f32x8(a, b).split(),
        simd.zip_high_f32x8(a, b).split(),
    );
    [first.0.combine(last.0), first.1.combine(last.1)]
}

/// Four columns to four rows, rounded.
#[inline(always)]
pub(super) fn rows<S: Simd>(simd: S, [a, b, c, d]: [f64x4<S>; 4]) -> [[f32; 4]; 4] {
    let (a, b) = (rounded(simd, a), rounded(simd, b));
    let (c, d) = (rounded(simd, c), rounded(simd, d));
    let (ac, bd) = (a.zip_low(c), b.zip_low(d));
    let (ca, db) = (a.zip_high(c), b.zip_high(d));
    [
        ac.zip_low(bd).to_array(),
        ac.zip_high(bd).to_array(),
        ca.zip_low(db).to_array(),
        ca.zip_high(db).to_array(),
    ]
}

/// To f32.
#[inline(always)]
fn rounded<S: Simd>(simd: S, v: f64x4<S>) -> f32x4<S> {
    f32x4::load_array(simd, v.to_array().map(|v| v as f32))
}

#[cfg(target_arch = "x86_64")]
kernel!(
    #[inline]
    fn permuted(avx2: Avx2, row: f32x8<Avx2>, places: u32x8<Avx2>) -> f32x8<Avx2> {
        arch::_mm256_permutevar8x32_ps(row.into(), places.into()).simd_into(avx2)
    }
);

#[cfg(target_arch = "x86_64")]
kernel!(
    #[inline]
    fn zipped_first(avx2: Avx2, a: f32x8<Avx2>, b: f32x8<Avx2>) -> f32x8<Avx2> {
        arch::_mm256_unpacklo_ps(a.into(), b.into()).simd_into(avx2)
    }
);

#[cfg(target_arch = "x86_64")]
kernel!(
    #[inline]
    fn zipped_last(avx2: Avx2, a: f32x8<Avx2>, b: f32x8<Avx2>) -> f32x8<Avx2> {
        arch::_mm256_unpackhi_ps(a.into(), b.into()).simd_into(avx2)
    }
);

#[cfg(test)]
mod tests {
    use fearless_simd::{Level, dispatch};

    use super::*;

    #[inline(always)]
    fn all<S: Simd>(simd: S) -> ([f32; 8], [[f32; 8]; 4], [[f32; 4]; 4]) {
        let row = std::array::from_fn(|k| k as f32);
        let places = u32x8::load_array(simd, [7, 0, 3, 3, 12, u32::MAX, 6, 1]);
        let tens = [0.0, 10.0, 20.0, 30.0];
        let eight = tens.map(|v| f32x8::load_array(simd, row.map(|k: f32| k + v)));
        let columns = [0.0, 10.0, 20.0, 30.0];
        let columns =
            columns.map(|v: f64| f64x4::load_array(simd, [0.0, 1.0, 2.0, 3.1].map(|k| k + v)));
        let [a, b, c, d] = transposed(simd, eight);
        (
            picked(simd, &row, places).to_array(),
            [a.to_array(), b.to_array(), c.to_array(), d.to_array()],
            rows(simd, columns),
        )
    }

    #[test]
    fn numbers_go_where_they_should() {
        let want = (
            [7.0, 0.0, 3.0, 3.0, 4.0, 7.0, 6.0, 1.0],
            [
                [0.0, 10.0, 20.0, 30.0, 4.0, 14.0, 24.0, 34.0],
                [1.0, 11.0, 21.0, 31.0, 5.0, 15.0, 25.0, 35.0],
                [2.0, 12.0, 22.0, 32.0, 6.0, 16.0, 26.0, 36.0],
                [3.0, 13.0, 23.0, 33.0, 7.0, 17.0, 27.0, 37.0],
            ],
            [
                [0.0, 10.0, 20.0, 30.0],
                [1.0, 11.0, 21.0, 31.0],
                [2.0, 12.0, 22.0, 32.0],
                [3.1, 13.1, 23.1, 33.1],
            ],
        );
        for level in [Level::new(), Level::baseline()] {
            assert_eq!(dispatch!(level, simd => all(simd)), want, "{level:?}");
        }
    }
}
