//! Exponentials of many numbers at once.
//!
//! An encoder of three layers and eight heads takes 24 n² exponentials. The functions here hold no branch and call nothing, so
//! that the compiler works on several numbers at once. Relative errors are below 3e-7, as the tests show.

/// 1.5 · 2²³: a number below 2²² added to it keeps no fraction. The exponent bias of a single rides along.
const ROUNDER: f32 = 12_582_912.0 + 127.0;
/// The natural logarithm of 2 as a sum: the first part has so few digits that products with small whole numbers are exact.
const LN_2_HIGH: f32 = 0.693_359_4;
const LN_2_LOW: f32 = -2.121_944_4e-4;
/// Reciprocals of factorials: the Taylor series of the exponential, highest degree first.
const TAYLOR: [f32; 8] = [1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0];
/// Where the exponential of a single is neither subnormal nor infinite.
const EXP_DOMAIN: (f32, f32) = (-87.0, 88.0);
/// Numbers that reductions work on at once.
const LANES: usize = 8;

/// `e` to the power of `x`, for `x` beyond -87 and 88 that at -87 and 88.
///
/// `x` is split into a multiple of ln 2, which becomes the exponent, and a rest of at most ln 2 / 2 (Cody and Waite, Software
/// Manual for the Elementary Functions, 1980).
#[inline]
pub(super) fn exp(x: f32) -> f32 {
    let x = x.clamp(EXP_DOMAIN.0, EXP_DOMAIN.1);
    let biased = x * std::f32::consts::LOG2_E + ROUNDER;
    let exponent = biased - ROUNDER;
    let rest = x - exponent * LN_2_HIGH - exponent * LN_2_LOW;
    let mut power = TAYLOR[0];
    for coefficient in &TAYLOR[1..] {
        power = power * rest + coefficient;
    }
    power * f32::from_bits(biased.to_bits() << 23)
}

/// The hyperbolic tangent, with an absolute error below 3e-7.
#[inline]
pub(super) fn tanh(x: f32) -> f32 {
    1.0 - 2.0 / (exp(2.0 * x) + 1.0)
}

/// Replaces every value by its exponential relative to the greatest one and returns their sum: shares once divided by it.
pub(super) fn exp_relative(values: &mut [f32]) -> f32 {
    let greatest = greatest(values);
    let mut sums = [0.0; LANES];
    let (chunks, rest) = values.as_chunks_mut::<LANES>();
    for chunk in chunks {
        for (value, sum) in chunk.iter_mut().zip(&mut sums) {
            *value = exp(*value - greatest);
            *sum += *value;
        }
    }
    let mut total = sums.iter().sum();
    for value in rest {
        *value = exp(*value - greatest);
        total += *value;
    }
    total
}

fn greatest(values: &[f32]) -> f32 {
    let greater = |a: f32, b: f32| if b > a { b } else { a };
    let mut lanes = [f32::NEG_INFINITY; LANES];
    let (chunks, rest) = values.as_chunks::<LANES>();
    for chunk in chunks {
        for (lane, &value) in lanes.iter_mut().zip(chunk) {
            *lane = greater(*lane, value);
        }
    }
    lanes.iter().chain(rest).copied().fold(f32::NEG_INFINITY, greater)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_that_of_the_library() {
        for step in -8_700..=8_800 {
            let x = step as f32 * 0.01;
            let exact = f64::from(x).exp();
            assert!((f64::from(exp(x)) / exact - 1.0).abs() < 3e-7, "{x}");
        }
        assert_eq!(exp(0.0), 1.0);
        assert_eq!((exp(-1e9), exp(f32::NEG_INFINITY)), (exp(-87.0), exp(-87.0)));
        assert!(exp(f32::INFINITY).is_finite());
    }

    #[test]
    fn the_tangent_is_that_of_the_library() {
        for step in -2_000..=2_000 {
            let x = step as f32 * 0.01;
            assert!((f64::from(tanh(x)) - f64::from(x).tanh()).abs() < 3e-7, "{x}");
        }
        assert_eq!((tanh(-200.0), tanh(0.0), tanh(200.0)), (-1.0, 0.0, 1.0));
    }

    #[test]
    fn shares_of_any_number_of_values() {
        for num_values in 1..40 {
            let mut values: Vec<f32> = (0..num_values).map(|index| ((index * 7) % 11) as f32 - 300.0).collect();
            let exact: Vec<f64> = values.iter().map(|&value| f64::from(value + 300.0).exp()).collect();
            let total = exp_relative(&mut values);
            for (value, expected) in values.iter().zip(&exact) {
                let share = f64::from(value / total);
                assert!((share - expected / exact.iter().sum::<f64>()).abs() < 1e-6);
            }
        }
    }
}
