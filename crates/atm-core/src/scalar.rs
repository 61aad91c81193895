//! The two number types that the algorithm runs in, with one maths backend for both.

use core::cmp::Ordering;

use nalgebra::RealField;

use crate::sweep::{Field, Found, Instructions, Probe, sweep, sweep_double};

/// What nobody else implements, so that nobody else can add a [`Scalar`].
pub(crate) mod sealed {
    use super::*;

    pub trait Sealed: Sized {
        /// Which arcs may cross: [`crate::sweep::sweep`] in the fastest way there is.
        fn sweep(
            _: Instructions,
            field: &Field<'_, Self>,
            first: usize,
            probe: &Probe<'_, Self>,
            found: &mut Found,
        ) -> u64
        where
            Self: Scalar;
    }
    impl Sealed for f32 {
        #[inline]
        fn sweep(
            _: Instructions,
            field: &Field<'_, f32>,
            first: usize,
            probe: &Probe<'_, f32>,
            found: &mut Found,
        ) -> u64 {
            sweep(field, first, probe, found)
        }
    }
    impl Sealed for f64 {
        #[inline]
        fn sweep(
            instructions: Instructions,
            field: &Field<'_, f64>,
            first: usize,
            probe: &Probe<'_, f64>,
            found: &mut Found,
        ) -> u64 {
            sweep_double(instructions, field, first, probe, found)
        }
    }
}

/// `f32` or `f64`.
///
/// Every function here is either exactly rounded (`square_root`) or comes from `libm`, so that a host, a
/// microcontroller and Python get the same bits. The names differ from those of [`RealField`] on purpose: that trait's
/// functions change backend with the features of the build.
pub trait Scalar: RealField + Copy + sealed::Sealed {
    /// 0.
    const ZERO: Self;
    /// ½.
    const HALF: Self;
    /// 0.9.
    const NINE_TENTHS: Self;
    /// 1.
    const ONE: Self;
    /// 2.
    const TWO: Self;
    /// 4.
    const FOUR: Self;
    /// π.
    const PI: Self;
    /// Not a number: what a slot without an arc holds, because every comparison with it fails.
    const NAN: Self;
    /// +∞.
    const INFINITY: Self;
    /// −∞.
    const NEGATIVE_INFINITY: Self;
    /// cos 30°.
    const COS_30_DEG: Self;
    /// cot 15° = 2 + √3.
    const COT_15_DEG: Self;
    /// Micrometres in a metre.
    const MICROMETRES: Self;
    /// How far from 1 the squared length of a heading may be before the pose is refused.
    const HEADING_SLACK: Self;

    /// √x, exactly rounded; NaN below 0.
    fn square_root(self) -> Self;
    /// |x|.
    fn magnitude(self) -> Self;
    /// Largest integer ≤ x.
    fn round_down(self) -> Self;
    /// Smallest integer ≥ x.
    fn round_up(self) -> Self;
    /// (sin x, cos x), x in radians.
    fn sine_cosine(self) -> (Self, Self);
    /// tan x, x in radians.
    fn tangent(self) -> Self;
    /// The angle of the vector (`x`, `self`), in (−π, π].
    fn arc_tangent_2(self, x: Self) -> Self;
    /// arccos x, in \[0, π\].
    fn arc_cosine(self) -> Self;
    /// eˣ.
    fn exponential(self) -> Self;
    /// ln x.
    fn logarithm(self) -> Self;
    /// ln Γ(x).
    fn log_gamma(self) -> Self;
    /// Neither infinite nor NaN.
    fn finite(self) -> bool;
    /// IEEE 754 total order.
    fn order(&self, other: &Self) -> Ordering;
    /// The nearest representable number.
    fn from_count(count: u32) -> Self;
    /// Rounded towards zero, saturating; 0 for NaN.
    fn to_count(self) -> u32;
}

macro_rules! scalar {
    ($float:ident, $sqrt:path, $floor:path, $ceil:path, $sincos:path, $tan:path, $atan2:path, $acos:path, $exp:path, $ln:path, $lgamma:path) => {
        impl Scalar for $float {
            const ZERO: Self = 0.0;
            const HALF: Self = 0.5;
            const NINE_TENTHS: Self = 0.9;
            const ONE: Self = 1.0;
            const TWO: Self = 2.0;
            const FOUR: Self = 4.0;
            const PI: Self = core::$float::consts::PI;
            const NAN: Self = $float::NAN;
            const INFINITY: Self = $float::INFINITY;
            const NEGATIVE_INFINITY: Self = $float::NEG_INFINITY;
            // The next two are rounded once from more digits than either type holds.
            #[allow(clippy::excessive_precision)]
            const COS_30_DEG: Self = 0.866_025_403_784_438_646_76;
            #[allow(clippy::excessive_precision)]
            const COT_15_DEG: Self = 3.732_050_807_568_877_293_53;
            const MICROMETRES: Self = 1e6;
            const HEADING_SLACK: Self = 1e-3;

            #[inline]
            fn square_root(self) -> Self {
                $sqrt(self)
            }
            #[inline]
            fn magnitude(self) -> Self {
                $float::abs(self)
            }
            #[inline]
            fn round_down(self) -> Self {
                $floor(self)
            }
            #[inline]
            fn round_up(self) -> Self {
                $ceil(self)
            }
            #[inline]
            fn sine_cosine(self) -> (Self, Self) {
                $sincos(self)
            }
            #[inline]
            fn tangent(self) -> Self {
                $tan(self)
            }
            #[inline]
            fn arc_tangent_2(self, x: Self) -> Self {
                $atan2(self, x)
            }
            #[inline]
            fn arc_cosine(self) -> Self {
                $acos(self)
            }
            #[inline]
            fn exponential(self) -> Self {
                $exp(self)
            }
            #[inline]
            fn logarithm(self) -> Self {
                $ln(self)
            }
            #[inline]
            fn log_gamma(self) -> Self {
                $lgamma(self)
            }
            #[inline]
            fn finite(self) -> bool {
                $float::is_finite(self)
            }
            #[inline]
            fn order(&self, other: &Self) -> Ordering {
                self.total_cmp(other)
            }
            #[inline]
            fn from_count(count: u32) -> Self {
                count as Self
            }
            #[inline]
            fn to_count(self) -> u32 {
                self as u32
            }
        }
    };
}

scalar!(
    f32,
    single_square_root,
    libm::floorf,
    libm::ceilf,
    libm::sincosf,
    libm::tanf,
    libm::atan2f,
    libm::acosf,
    libm::expf,
    libm::logf,
    libm::lgammaf
);
scalar!(
    f64,
    libm::sqrt,
    libm::floor,
    libm::ceil,
    libm::sincos,
    libm::tan,
    libm::atan2,
    libm::acos,
    libm::exp,
    libm::log,
    libm::lgamma
);

/// √x by the floating-point unit: one instruction, where `libm` computes for forty. Both are exactly rounded.
///
/// The hard-float ABI passes a number in s0 and returns it there, and says that there is a unit; each has the
/// instruction. Not inline assembly: that is refused the registers of a unit for single precision alone.
#[cfg(all(target_arch = "arm", target_abi = "eabihf"))]
#[allow(unsafe_code)]
// SAFETY: as declared, one number comes in s0 and one leaves in it; no other register and no memory is touched.
#[unsafe(naked)]
extern "C" fn single_square_root(x: f32) -> f32 {
    core::arch::naked_asm!(".fpu fpv4-sp-d16", "vsqrt.f32 s0, s0", "bx lr")
}

#[cfg(not(all(target_arch = "arm", target_abi = "eabihf")))]
use libm::sqrtf as single_square_root;

/// (sin x, cos x) for 0 ≤ x ≤ π/2, by a fixed polynomial.
///
/// Horner's scheme on the Taylor series up to x²¹ and x²²: below one unit in the last place of an `f64` over the domain,
/// and some twenty multiplications, where a general sine on a machine without double precision costs thousands of
/// instructions.
pub(crate) fn sine_cosine_in_quadrant<T: Scalar>(x: T) -> (T, T) {
    const LAST: u32 = 22;
    let square = x * x;
    let (mut sine, mut cosine) = (T::ONE, T::ONE);
    let mut k = LAST;
    while k >= 2 {
        // sin: 1 − x²/(2·3)(1 − x²/(4·5)(…)); cos: 1 − x²/(1·2)(1 − x²/(3·4)(…))
        sine = T::ONE - square / T::from_count(k * (k + 1)) * sine;
        cosine = T::ONE - square / T::from_count(k * (k - 1)) * cosine;
        k -= 2;
    }
    (x * sine, cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomial_matches_libm_over_the_quadrant() {
        for step in 0..=1000 {
            let x = f64::from(step) * core::f64::consts::FRAC_PI_2 / 1000.0;
            let (sine, cosine) = sine_cosine_in_quadrant(x);
            assert!((sine - libm::sin(x)).abs() < 5e-16, "sin {x}");
            assert!((cosine - libm::cos(x)).abs() < 5e-16, "cos {x}");
            let (sine, cosine) = sine_cosine_in_quadrant(x as f32);
            assert!((sine - libm::sinf(x as f32)).abs() < 3e-7, "sin {x} f32");
            assert!((cosine - libm::cosf(x as f32)).abs() < 3e-7, "cos {x} f32");
        }
    }
}
