//! A rendered press as files, for the page of docs/track.md.

use std::io::Write;
use std::path::Path;

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

/// Writes `press.y4m` and `encoder.csv` to `../out/track`: a finger that presses, hidden by a hand for half a second, with a marker
/// beside it; the encoder has a resolution of 0.05 mm and a zero of its own.
#[test]
#[ignore = "writes files; docs/track.md says how to look at them"]
fn a_press_as_files() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../out/track");
    std::fs::create_dir_all(&folder).unwrap();
    let mut random = random(1);
    let (width, height) = (320, 200);
    let mut bytes = format!("YUV4MPEG2 W{width} H{height} F30:1 Cmono\n").into_bytes();
    let mut encoder = "time_s,height_mm\n".to_owned();
    let scene = Scene {
        size: (width, height),
        noise: 0.012,
        blur: 1.0,
        gradient: [0.3, 0.2],
        subsamples: 4,
        ..Scene::new(Shape::Skin(22.0))
    };
    let marker = Scene { size: (width, height), noise: 0.0, blur: 1.0, ..Scene::new(Shape::Disc(16.0)) };
    let marker = marker.frame([250.0, 60.0], &mut random);
    for i in 0..240 {
        let [x, y] = lower_end(i);
        let own = Scene { hidden: (150..165).contains(&i).then_some([60.0, 60.0, 130.0, 110.0, 0.4]), ..scene.clone() };
        // Shapes are placed by the middle of their round end.
        let frame = own.frame([x, y - 22.0], &mut random);
        bytes.extend(b"FRAME\n");
        let both = frame.pixels.iter().zip(&marker.pixels).enumerate();
        bytes.extend(both.map(|(at, (own, disc))| {
            let (column, row) = (at % width, at / width);
            let is_marker = column > 225 && row > 35 && row < 85 && column < 275;
            let value = if is_marker { own.max(*disc) } else { *own };
            let surface = if row as f64 >= SURFACE && own < &0.3 { 0.75 } else { 1.0 };
            (255.0 * value * surface).round() as u8
        }));
        let read = ((100.0 - MM_PER_PX * y) / 0.05).round() * 0.05;
        encoder.push_str(&format!("{:.4},{read:.2}\n", i as f64 / RATE));
    }
    std::fs::File::create(folder.join("press.y4m")).unwrap().write_all(&bytes).unwrap();
    std::fs::write(folder.join("encoder.csv"), encoder).unwrap();
}
