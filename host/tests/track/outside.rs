//! What comes from outside: never a panic, and errors that say where.

use palpate::track::source::Y4m;
use palpate::track::{Frame, Roi, TrackError, Tracker};
use rand::{Rng, RngCore};

use super::around;
use super::render::{Scene, Shape, path, random};

/// Streams that are sound, changed in some bytes, and cut.
#[test]
fn any_bytes_end_in_frames_or_an_error() {
    let heads = ["W16 H9 F60:1 C420jpeg", "W5 H7 Cmono10", "W3 H3 C444alpha Xa=b", "W1 H1 C411"];
    let (mut frames, mut errors) = (0, 0);
    for seed in 0..4000_u64 {
        let mut random = random(seed);
        let head = heads[random.random_range(0..heads.len())];
        let mut bytes = format!("YUV4MPEG2 {head}\n").into_bytes();
        for _ in 0..random.random_range(0..4) {
            bytes.extend(b"FRAME\n");
            let mut plane = vec![0; random.random_range(0..300)];
            random.fill_bytes(&mut plane);
            bytes.extend(plane);
        }
        for _ in 0..random.random_range(0..6) {
            let at = random.random_range(0..bytes.len());
            bytes[at] = random.random();
        }
        bytes.truncate(random.random_range(0..=bytes.len()));
        match Y4m::open("any", &bytes[..]) {
            Ok(stream) => stream.for_each(|frame| match frame {
                Ok(frame) => {
                    assert_eq!(frame.pixels.len(), frame.width * frame.height);
                    frames += 1;
                }
                Err(_) => errors += 1,
            }),
            Err(_) => errors += 1,
        }
    }
    // Neither all sound nor all refused: else nothing would have been tried.
    assert!(frames > 100 && errors > 100, "{frames} {errors}");
}

/// Frames that no camera makes, and regions at their borders.
#[test]
fn odd_frames_and_regions_do_not_panic() {
    let mut random = random(1);
    let sizes = [(8, 8), (9, 200), (200, 8), (33, 31), (64, 48)];
    for (width, height) in sizes {
        for kind in 0..5 {
            let mut frame = || {
                let value = |i: usize, random: &mut rand_pcg::Pcg64Mcg| match kind {
                    0 => 0.5,
                    1 => random.random::<f32>(),
                    2 => ((i % width) / 4 % 2) as f32,
                    3 => f32::from(i as u16 == 77),
                    _ => (i % width) as f32 / width as f32,
                };
                let pixels = (0..width * height).map(|i| value(i, &mut random)).collect();
                Frame { width, height, pixels, step: 1.0 / 255.0 }
            };
            let first = frame();
            for roi in [
                Roi { x: 0, y: 0, width, height },
                Roi { x: width - 8, y: height - 8, width: 8, height: 8 },
                Roi { x: 0, y: 0, width: 8, height: 8 },
            ] {
                if let Ok(mut tracker) = Tracker::new(&first, roi, None) {
                    for _ in 0..4 {
                        if let Some(tip) = tracker.step(&frame()).unwrap() {
                            assert!(tip.place_px.iter().all(|p| p.is_finite()), "{tip:?}");
                            assert!(tip.sigma_px.iter().all(|s| *s > 0.0), "{tip:?}");
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn bad_regions_and_frames_are_named() {
    let scene = Scene::new(Shape::Disc(14.0));
    let frame = scene.frame(path(0), &mut random(1));
    let refused = |roi| Tracker::new(&frame, roi, None).unwrap_err();
    let outside = refused(Roi { x: 140, y: 10, width: 20, height: 20 });
    assert_eq!(outside.to_string(), "the region 140,10,20,20 is not inside the frames of 150 x 130 pixels");
    assert!(refused(Roi { x: usize::MAX, y: 1, width: 9, height: 9 }).to_string().contains("is not inside"));
    let small = refused(Roi { x: 10, y: 10, width: 7, height: 20 });
    assert_eq!(small.to_string(), "the region 10,10,7,20 is too small; expected at least 8 x 8 pixels");
    let flat = refused(Roi { x: 0, y: 90, width: 20, height: 20 });
    assert!(matches!(flat, TrackError::Flat { .. }) && flat.to_string().contains("nothing to follow"), "{flat}");
    assert!(flat.advice().contains("--roi"));
    let mut tracker = Tracker::new(&frame, around(path(0), 20), None).unwrap();
    let other = Scene { size: (64, 48), ..scene }.frame([30.0, 20.0], &mut random(1));
    let size = tracker.step(&other).unwrap_err().to_string();
    assert_eq!(size, "the frame has 64 x 48 pixels; expected 150 x 130 as the first");
}
