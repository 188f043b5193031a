//! A tip that is hidden, leaves, jumps.

use super::render::{Scene, Shape, path};
use super::{Seen, follow};

fn scene(shape: Shape) -> Scene {
    Scene { noise: 0.02, blur: 1.0, ..Scene::new(shape) }
}

/// What is told as found is where the tip is: within 5 standard deviations and a tenth of a pixel.
fn check_found(name: &str, seen: &[Seen]) {
    for (i, s) in seen.iter().enumerate() {
        if let (Some(tip), Some(error)) = (s.tip, s.error()) {
            for axis in 0..2 {
                assert!(
                    error[axis].abs() < 0.1 + 5.0 * tip.sigma_px[axis],
                    "{name}, frame {}: {error:?} {tip:?}",
                    i + 1
                );
            }
        }
    }
}

/// Frames 20 to 39 are hidden by a plain sheet of any brightness: lost at 21 at the latest, found at 44 at the latest.
#[test]
fn a_hidden_tip_is_lost_within_two_frames_and_found_within_five() {
    for shape in Shape::ALL {
        for brightness in [0.2, 0.35, 0.5, 0.7, 0.95] {
            let name = format!("{shape:?} behind {brightness}");
            let seen = follow(&scene(shape), 60, 7, |i, scene| {
                scene.hidden = (20..40).contains(&i).then_some([30.0, 10.0, 100.0, 110.0, brightness]);
                path(i)
            });
            let lost = |i: usize| seen[i - 1].tip.is_none();
            assert!((1..20).all(|i| !lost(i)), "{name}: lost in plain sight");
            assert!((21..40).all(lost), "{name}: found behind the sheet");
            assert!((44..60).all(|i| !lost(i)), "{name}: not found again");
            check_found(&name, &seen[39..]);
        }
    }
}

/// A third behind a sheet: places stay right within what they state, or are not told.
#[test]
fn a_partly_hidden_tip_is_told_honestly() {
    for shape in Shape::ALL {
        let seen = follow(&scene(shape), 60, 8, |i, scene| {
            let place = path(i);
            scene.hidden = (20..40).contains(&i).then_some([0.0, 0.0, place[0] - 7.0, 130.0, 0.45]);
            place
        });
        check_found(&format!("{shape:?}"), &seen[..19]);
        check_found(&format!("{shape:?}"), &seen[39..]);
        let far = |s: &Seen| s.error().is_some_and(|e| e[0].hypot(e[1]) > 1.5);
        assert!(!seen.iter().any(far), "{shape:?}");
        assert!(seen[43..].iter().all(|s| s.tip.is_some()), "{shape:?}");
    }
}

/// Out of the frame at four pixels a frame, and back.
#[test]
fn a_tip_that_leaves_is_lost_and_found_when_it_is_back() {
    for shape in Shape::ALL {
        let seen = follow(&scene(shape), 70, 9, |i, _| {
            let turn = (i as f64 - 35.0).abs();
            [70.3 - 4.0 * (35.0 - turn), 60.6]
        });
        let name = format!("{shape:?}");
        let outside = |s: &&Seen| s.place[0] < -15.0;
        assert!(seen.iter().filter(outside).all(|s| s.tip.is_none()), "{name}: found outside");
        assert!(seen[..8].iter().chain(&seen[62..]).all(|s| s.tip.is_some()), "{name}");
        check_found(&name, &seen[..8]);
        check_found(&name, &seen[62..]);
    }
}

/// Forty pixels at once, every five frames: faster than any search around the last place reaches.
#[test]
fn jumps_are_followed() {
    for shape in Shape::ALL {
        let seen = follow(&scene(shape), 40, 10, |i, _| [50.3 + 45.0 * ((i / 5) % 2) as f64, 55.6 + 0.17 * i as f64]);
        assert!(seen.iter().all(|s| s.tip.is_some()), "{shape:?}");
        check_found(&format!("{shape:?}"), &seen);
    }
}
