//! Arithmetic that is total: no panics, no formatting code behind it.

/// `x` limited to `[low, high]`; `low` for NaN or an empty interval.
///
/// `f32::clamp` asserts `low <= high` with a message that prints floats, which costs 12 KB of image.
#[inline]
pub fn limit(x: f32, low: f32, high: f32) -> f32 {
    if x > high && high >= low {
        high
    } else if x > low {
        x
    } else {
        low
    }
}

/// The larger of two numbers; the second where one is none.
#[inline]
pub fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Square root, the FPU's instruction on the board.
#[inline]
pub fn sqrt(x: f32) -> f32 {
    libm::sqrtf(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limit_is_total() {
        assert_eq!(limit(2.0, 0.0, 1.0), 1.0);
        assert_eq!(limit(-2.0, 0.0, 1.0), 0.0);
        assert_eq!(limit(0.5, 0.0, 1.0), 0.5);
        assert_eq!(limit(f32::NAN, 0.0, 1.0), 0.0);
        assert_eq!(limit(f32::INFINITY, 0.0, 1.0), 1.0);
    }
}
