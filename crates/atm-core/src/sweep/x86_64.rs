//! The sweep in double precision on x86-64: the same tests on 2, 4 or 8 arcs at a time.
//!
//! The only file of the core with `unsafe` for speed: without it every reading takes longer (docs/performance.md).
#![allow(unsafe_code)]

use core::arch::x86_64::*;

use super::{BLOCK, Block, Boxes, Field, Found, Level, Probe};

/// [`super::sweep`] with the instructions of `level`.
#[inline]
pub(super) fn sweep(
    level: Level,
    field: &Field<'_, f64>,
    first: usize,
    probe: &Probe<'_, f64>,
    found: &mut Found,
) -> u64 {
    match level {
        // SAFETY: every x86-64 has SSE2.
        Level::Baseline => unsafe { sse2::sweep(field, first, probe, found) },
        // SAFETY: this level is made only where the processor was found to have AVX.
        Level::Avx => unsafe { avx::sweep(field, first, probe, found) },
        // SAFETY: this level is made only where the processor was found to have AVX-512F.
        Level::Avx512 => unsafe { avx512::sweep(field, first, probe, found) },
    }
}

/// A module with the sweep for one kind of vector. `at_most!(a, b)` is a bit for each lane where a ≤ b.
macro_rules! level {
    (
        $name:ident, $features:literal, $vector:ty, $lanes:literal, $load:ident, $all:ident,
        $add:ident, $sub:ident, $mul:ident, $max:ident, $without_sign:expr, $at_most:expr
    ) => {
        mod $name {
            use super::*;

            #[inline]
            #[target_feature(enable = $features)]
            fn part(column: &[f64; BLOCK], part: usize) -> $vector {
                let (parts, _) = column.as_chunks::<$lanes>();
                match parts.get(part) {
                    // SAFETY: reads as many numbers as the array has.
                    Some(part) => unsafe { $load(part.as_ptr()) },
                    None => $all(f64::NAN),
                }
            }

            /// x² + y² ≤ reach².
            #[inline]
            #[target_feature(enable = $features)]
            fn is_within(x: $vector, y: $vector, reach: $vector) -> u8 {
                $at_most($add($mul(x, x), $mul(y, y)), $mul(reach, reach))
            }

            /// See [`super::super::near_boxes`]. Of `max`, the second operand is the result where one is NaN.
            #[inline]
            #[target_feature(enable = $features)]
            fn near_boxes(boxes: &Boxes<f64>, probe: &Probe<'_, f64>) -> u8 {
                let arc = probe.arc;
                let (x, y, reach) = ($all(arc.middle.x), $all(arc.middle.y), $all(arc.reach));
                let zero = $all(0.0);
                let mut bits = 0;
                for lanes in 0..BLOCK / $lanes {
                    let west = $sub(part(&boxes.low_x, lanes), x);
                    let east = $sub(x, part(&boxes.high_x, lanes));
                    let south = $sub(part(&boxes.low_y, lanes), y);
                    let north = $sub(y, part(&boxes.high_y, lanes));
                    let both = $add(part(&boxes.reach, lanes), reach);
                    let (x, y) = ($max(west, $max(east, zero)), $max(south, $max(north, zero)));
                    bits |= is_within(x, y, both) << (lanes * $lanes);
                }
                bits
            }

            /// See [`super::super::transversal`].
            #[inline]
            #[target_feature(enable = $features)]
            fn transversal(block: &Block<'_, f64>, probe: &Probe<'_, f64>) -> u8 {
                let (arc, cos) = (probe.arc, probe.min_angle.cos());
                let mut near = 0;
                for lanes in 0..BLOCK / $lanes {
                    let x = $sub(part(block.middle_x, lanes), $all(arc.middle.x));
                    let y = $sub(part(block.middle_y, lanes), $all(arc.middle.y));
                    near |= is_within(x, y, $add(part(block.reach, lanes), $all(arc.reach))) << (lanes * $lanes);
                }
                if near == 0 {
                    return 0;
                }
                let mut steep = 0;
                for lanes in 0..BLOCK / $lanes {
                    let x = $sub(part(block.sensor_x, lanes), $all(arc.sensor.x));
                    let y = $sub(part(block.sensor_y, lanes), $all(arc.sensor.y));
                    let radius = part(block.radius, lanes);
                    let distance_squared = $add($mul(x, x), $mul(y, y));
                    let squares = $add($all(arc.radius * arc.radius), $mul(radius, radius));
                    let twice_product = $mul($all(2.0), $mul($all(arc.radius), radius));
                    let numerator = $sub(squares, distance_squared);
                    steep |= $at_most($without_sign(numerator), $mul(twice_product, $all(cos))) << (lanes * $lanes);
                }
                near & steep
            }

            /// See [`super::super::sweep`].
            #[target_feature(enable = $features)]
            pub(super) fn sweep(
                field: &Field<'_, f64>,
                first: usize,
                probe: &Probe<'_, f64>,
                found: &mut Found,
            ) -> u64 {
                let (mut near, mut hit) = (0u64, 0u64);
                for (row, boxes) in field.boxes(first).iter().enumerate() {
                    near |= u64::from(near_boxes(boxes, probe)) << (row * BLOCK);
                }
                while near != 0 {
                    let index = near.trailing_zeros() as usize;
                    near &= near - 1;
                    if let (Some(block), Some(byte)) = (field.block(first + index), found.get_mut(index)) {
                        *byte = transversal(&block, probe);
                        hit |= u64::from(*byte != 0) << index;
                    }
                }
                hit
            }
        }
    };
}

level!(
    sse2,
    "sse2",
    __m128d,
    2,
    _mm_loadu_pd,
    _mm_set1_pd,
    _mm_add_pd,
    _mm_sub_pd,
    _mm_mul_pd,
    _mm_max_pd,
    |x| _mm_andnot_pd(_mm_set1_pd(-0.0), x),
    |a, b| _mm_movemask_pd(_mm_cmple_pd(a, b)) as u8
);
level!(
    avx,
    "avx",
    __m256d,
    4,
    _mm256_loadu_pd,
    _mm256_set1_pd,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    _mm256_max_pd,
    |x| _mm256_andnot_pd(_mm256_set1_pd(-0.0), x),
    |a, b| _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(a, b)) as u8
);
level!(
    avx512,
    "avx512f",
    __m512d,
    8,
    _mm512_loadu_pd,
    _mm512_set1_pd,
    _mm512_add_pd,
    _mm512_sub_pd,
    _mm512_mul_pd,
    _mm512_max_pd,
    |x| _mm512_abs_pd(x),
    |a, b| _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b)
);
