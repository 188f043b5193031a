//! A rendered press as files, for the page of docs/track.md.

use std::io::Write;
use std::ops::Range;
use std::path::Path;

use palpate::track::{Frame, Roi, Tracker};

use super::render::{Scene, Shape, random};

/// Frames a second.
const RATE: f64 = 30.0;
/// Row of the surface.
const SURFACE: f64 = 150.0;
/// Length of a pixel, mm: the marker of 5 mm has 32 px.
const MM_PER_PX: f64 = 5.0 / 32.0;

/// Lower end of the finger, pixels: three presses, each deeper.
fn lower_end(i: usize) -> [f64; 2] {
    let t = i as f64 / RATE;
    [120.0 + 1.5 * (0.9 * t).sin(), 128.0 + (8.0 + 5.0 * t.min(8.0)) * (1.0 - (2.1 * t).cos()) / 2.0]
}

/// Frames in which a hand hides the finger.
const HIDDEN: Range<usize> = 150..165;
/// Of which there are so many.
const FRAMES: usize = 240;
/// Columns and rows.
const SIZE: (usize, usize) = (320, 200);

/// A finger that presses, hidden by a hand for half a second, with a marker beside it. Above the hand the finger's shaft is seen.
fn frames(seed: u64, hand: [f64; 5]) -> impl Iterator<Item = Frame> {
    let mut random = random(seed);
    let scene = Scene {
        size: SIZE,
        noise: 0.012,
        blur: 1.0,
        gradient: [0.3, 0.2],
        subsamples: 4,
        ..Scene::new(Shape::Skin(22.0))
    };
    let marker = Scene { size: SIZE, noise: 0.0, blur: 1.0, ..Scene::new(Shape::Disc(16.0)) };
    let marker = marker.frame([250.0, 60.0], &mut random);
    (0..FRAMES).map(move |i| {
        let [x, y] = lower_end(i);
        let own = Scene { hidden: HIDDEN.contains(&i).then_some(hand), ..scene.clone() };
        // Shapes are placed by the middle of their round end.
        let mut frame = own.frame([x, y - 22.0], &mut random);
        for (at, (own, disc)) in frame.pixels.iter_mut().zip(&marker.pixels).enumerate() {
            let (column, row) = (at % SIZE.0, at / SIZE.0);
            let is_marker = column > 225 && row > 35 && row < 85 && column < 275;
            let value = if is_marker { own.max(*disc) } else { *own };
            let surface = if row as f64 >= SURFACE && *own < 0.3 { 0.75 } else { 1.0 };
            *own = (255.0 * value * surface).round() / 255.0;
        }
        frame
    })
}

/// A hand of several kinds: as the page shows it; as bright as the ground, so that the shaft looks like a shorter finger; higher up.
#[test]
fn the_shaft_above_a_hand_is_not_taken_for_the_tip() {
    let hands = [[60.0, 60.0, 130.0, 110.0, 0.4], [60.0, 60.0, 130.0, 110.0, 0.2], [40.0, 75.0, 160.0, 120.0, 0.6]];
    for (seed, hand) in (21..).zip(hands) {
        let mut tracker = None;
        for (i, frame) in frames(seed, hand).enumerate().skip(100).take(80) {
            let [x, y] = lower_end(i);
            let Some(tracker) = &mut tracker else {
                let roi = Roi { x: x as usize - 28, y: y as usize - 52, width: 56, height: 60 };
                tracker = Some(Tracker::new(&frame, roi, Some([x, y])).unwrap());
                continue;
            };
            let tip = tracker.step(&frame).unwrap();
            if HIDDEN.contains(&i) {
                assert!(tip.is_none(), "{hand:?}, frame {i}: {tip:?}");
            } else if !(HIDDEN.end..HIDDEN.end + 5).contains(&i) {
                let tip = tip.unwrap_or_else(|| panic!("{hand:?}, frame {i}: lost in plain sight"));
                let off = (tip.place_px[0] - x).hypot(tip.place_px[1] - y);
                assert!(off < 0.3, "{hand:?}, frame {i}: {off} px off");
            }
        }
    }
}

/// Writes `press.y4m` and `encoder.csv` to `../out/track`; the encoder has a resolution of 0.05 mm and a zero of its own.
#[test]
#[ignore = "writes files; docs/track.md says how to look at them"]
fn a_press_as_files() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../out/track");
    std::fs::create_dir_all(&folder).unwrap();
    let mut bytes = format!("YUV4MPEG2 W{} H{} F30:1 Cmono\n", SIZE.0, SIZE.1).into_bytes();
    let mut encoder = "time_s,height_mm\n".to_owned();
    for (i, frame) in frames(1, [60.0, 60.0, 130.0, 110.0, 0.4]).enumerate() {
        bytes.extend(b"FRAME\n");
        bytes.extend(frame.pixels.iter().map(|value| (255.0 * value).round() as u8));
        let read = ((100.0 - MM_PER_PX * lower_end(i)[1]) / 0.05).round() * 0.05;
        encoder.push_str(&format!("{:.4},{read:.2}\n", i as f64 / RATE));
    }
    std::fs::File::create(folder.join("press.y4m")).unwrap().write_all(&bytes).unwrap();
    std::fs::write(folder.join("encoder.csv"), encoder).unwrap();
}
