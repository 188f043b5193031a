//! A colour ramp whose steps look equally large, and that stays a ramp in black and white.

use std::fmt;

/// A colour of the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Colour(pub [u8; 3]);

impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

/// Lightness at both ends of the ramp, in Oklab.
const LIGHTNESS: (f64, f64) = (0.975, 0.27);
/// Hue at the light end, in the middle and at the dark end, degrees: straw, vermilion, plum.
const HUE: (f64, f64, f64) = (95.0, 42.0, -32.0);
/// Chroma at the light end, in the middle and at the dark end.
const CHROMA: (f64, f64, f64) = (0.025, 0.165, 0.085);

/// Colour of a share in 0 to 1 (clamped): from light to dark, linear in lightness.
pub fn ramp(share: f64) -> Colour {
    let t = share.clamp(0.0, 1.0);
    let through = |(start, middle, end): (f64, f64, f64)| {
        (1.0 - t) * (1.0 - 2.0 * t) * start + 4.0 * t * (1.0 - t) * middle + t * (2.0 * t - 1.0) * end
    };
    let (hue, chroma) = (through(HUE).to_radians(), through(CHROMA));
    let lightness = LIGHTNESS.0 + t * (LIGHTNESS.1 - LIGHTNESS.0);
    Colour(
        linear_rgb([lightness, chroma * hue.cos(), chroma * hue.sin()])
            .map(|c| (255.0 * gamma(c.clamp(0.0, 1.0))).round() as u8),
    )
}

/// Linear sRGB of an Oklab colour (B. Ottosson, "A perceptual color space for image processing", 2020).
fn linear_rgb([l, a, b]: [f64; 3]) -> [f64; 3] {
    let cone = [
        l + 0.396_337_777_4 * a + 0.215_803_757_3 * b,
        l - 0.105_561_345_8 * a - 0.063_854_172_8 * b,
        l - 0.089_484_177_5 * a - 1.291_485_548_0 * b,
    ]
    .map(|c| c.powi(3));
    let [l, m, s] = cone;
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

/// The transfer curve of sRGB (IEC 61966-2-1).
fn gamma(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a grey printer makes of a colour: its luminance (Rec. 709 weights), as lightness CIE L*.
    fn grey(colour: Colour) -> f64 {
        let linear = colour.0.map(|c| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        116.0 * (0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]).cbrt() - 16.0
    }

    #[test]
    fn steps_are_as_even_in_grey_as_an_eye_can_tell() {
        let steps: Vec<f64> =
            (0..10).map(|i| grey(ramp(f64::from(i) / 10.0)) - grey(ramp(f64::from(i + 1) / 10.0))).collect();
        let (least, most) = steps.iter().fold((f64::MAX, 0.0_f64), |(l, m), s| (l.min(*s), m.max(*s)));
        // about 8 of 100 each; 2 is what the eye just sees
        assert!(least > 5.0 && most < 11.0, "{steps:?}");
    }

    #[test]
    fn the_ramp_lies_inside_what_a_screen_can_show() {
        for i in 0..=20 {
            let Colour(rgb) = ramp(f64::from(i) / 20.0);
            // a channel at its limit would have been cut
            assert!(rgb.iter().all(|c| (1..255).contains(c)), "{i}: {rgb:?}");
        }
        assert_eq!(ramp(-1.0), ramp(0.0));
        assert_eq!(ramp(2.0).to_string(), ramp(1.0).to_string());
    }
}
