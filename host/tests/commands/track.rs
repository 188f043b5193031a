//! `palpate track` as people and other programs call it.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Output, Stdio};

const SIZE: (usize, usize) = (97, 75);
const ROI: &str = "28,18,29,29";

fn palpate(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_palpate"));
    command.arg("track").args(arguments).stdin(Stdio::null());
    command
}

fn output(arguments: &[&str]) -> Output {
    palpate(arguments).output().unwrap()
}

/// Standard error without the frame that the terminal gets.
fn told(output: &Output) -> String {
    let text = String::from_utf8_lossy(&output.stderr).replace('│', " ");
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Where the tip is in a frame.
fn place(frame: usize) -> [f64; 2] {
    let t = frame as f64;
    [42.0 + 0.73 * t, 32.0 + 9.0 * (1.0 - (0.3 * t).cos())]
}

/// A soft round spot, as grey values up to `full`; frames 8 to 11 show the ground alone.
fn grey(frame: usize, full: f64) -> Vec<f64> {
    let [x, y] = place(frame);
    let value = |i: usize| {
        let (u, v) = ((i % SIZE.0) as f64 - x, (i / SIZE.0) as f64 - y);
        let spot = if (8..12).contains(&frame) { 0.0 } else { (-(u * u + v * v) / 50.0).exp() };
        (full * (0.2 + 0.6 * spot)).round()
    };
    (0..SIZE.0 * SIZE.1).map(value).collect()
}

fn stream(frames: usize, sampling: &str, colours: usize) -> Vec<u8> {
    let mut bytes = format!("YUV4MPEG2 W{} H{} F50:1 C{sampling}\n", SIZE.0, SIZE.1).into_bytes();
    for frame in 0..frames {
        bytes.extend(b"FRAME\n");
        bytes.extend(grey(frame, 255.0).iter().map(|v| *v as u8));
        bytes.extend(vec![128; colours]);
    }
    bytes
}

/// A PNG file of 8 or 16 bits, grey or in colour.
fn still(file: &Path, frame: usize, colour: png::ColorType, depth: png::BitDepth) {
    let mut encoder = png::Encoder::new(std::fs::File::create(file).unwrap(), SIZE.0 as u32, SIZE.1 as u32);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    let wide = depth == png::BitDepth::Sixteen;
    let samples = colour.samples();
    let mut bytes = Vec::new();
    for value in grey(frame, if wide { 65535.0 } else { 255.0 }) {
        for _ in 0..samples {
            if wide {
                bytes.extend((value as u16).to_be_bytes());
            } else {
                bytes.push(value as u8);
            }
        }
    }
    encoder.write_header().unwrap().write_image_data(&bytes).unwrap();
}

/// Rows of a table by the names of its columns.
fn rows(csv: &str) -> Vec<std::collections::HashMap<String, String>> {
    let mut lines = csv.lines();
    let head: Vec<String> = lines.next().unwrap().split(',').map(str::to_owned).collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), head.len(), "{line}");
        head.iter().cloned().zip(cells.into_iter().map(str::to_owned)).collect()
    };
    lines.map(row).collect()
}

/// Places are within 0.02 px of the truth (grey values of 8 bits leave thousandths), and lost where nothing is shown.
fn check(csv: &str, frames: usize) {
    let rows = rows(csv);
    assert_eq!(rows.len(), frames);
    for (frame, row) in rows.iter().enumerate() {
        assert_eq!(row["frame"], frame.to_string());
        let is_lost = (8..12).contains(&frame);
        assert_eq!(row["lost"], if is_lost { "1" } else { "0" }, "{row:?}");
        if is_lost {
            assert_eq!((row["x_px"].as_str(), row["sigma_x_px"].as_str()), ("", ""));
            continue;
        }
        for (axis, name) in ["x_px", "y_px"].into_iter().enumerate() {
            let found: f64 = row[name].parse().unwrap();
            assert!((found - place(frame)[axis]).abs() < 0.02, "frame {frame}: {row:?}");
        }
    }
}

#[test]
fn streams_of_all_samplings_are_followed_from_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let half = SIZE.0.div_ceil(2) * SIZE.1.div_ceil(2);
    for (sampling, colours) in [("420jpeg", 2 * half), ("444", 2 * SIZE.0 * SIZE.1), ("mono", 0)] {
        let file = folder.path().join(format!("{sampling}.y4m"));
        std::fs::write(&file, stream(20, sampling, colours)).unwrap();
        let out = folder.path().join(format!("{sampling}.csv"));
        let (file, path) = (file.to_str().unwrap(), out.to_str().unwrap());
        let done = output(&[file, "--roi", ROI, "--out", path]);
        assert!(done.status.success(), "{}", told(&done));
        let text = String::from_utf8_lossy(&done.stdout).into_owned();
        assert!(text.starts_with("tip        found in 16 of 20 frames, lost in 4 (frame 8 to 11)"), "{text}");
        let csv = std::fs::read_to_string(&out).unwrap();
        check(&csv, 20);
        assert_eq!(rows(&csv)[10]["time_s"], "0.200000");
        let again = output(&[file, "--roi", ROI, "--out", path]);
        assert_eq!(again.status.code(), Some(2));
        assert!(told(&again).contains("exists and is kept; --force replaces it"), "{}", told(&again));
        assert!(output(&[file, "--roi", ROI, "--out", path, "--force"]).status.success());
    }
}

#[test]
fn stills_of_all_kinds_are_followed_in_the_order_of_their_numbers() {
    use png::{BitDepth, ColorType};
    let kinds = [
        (ColorType::Grayscale, BitDepth::Eight),
        (ColorType::Grayscale, BitDepth::Sixteen),
        (ColorType::Rgb, BitDepth::Eight),
        (ColorType::Rgba, BitDepth::Sixteen),
    ];
    for (colour, depth) in kinds {
        let folder = tempfile::tempdir().unwrap();
        for frame in 0..14 {
            still(&folder.path().join(format!("frame{frame}.png")), frame, colour, depth);
        }
        let done = output(&[folder.path().to_str().unwrap(), "--roi", ROI]);
        assert!(done.status.success(), "{}", told(&done));
        let csv = String::from_utf8(done.stdout.clone()).unwrap();
        check(&csv, 14);
        assert_eq!(rows(&csv)[3]["time_s"], "", "no rate is known");
        assert!(told(&done).contains("time unknown"), "{}", told(&done));
    }
}

/// Every position is there before the next frame is sent.
#[test]
fn a_stream_on_standard_input_is_answered_frame_by_frame() {
    let mut child = palpate(&["-", "--roi", ROI])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let mut input = child.stdin.take().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let bytes = stream(6, "mono", 0);
    let frame = SIZE.0 * SIZE.1 + 6;
    let head = bytes.len() - 6 * frame;
    input.write_all(&bytes[..head]).unwrap();
    for i in 0..6 {
        input.write_all(&bytes[head + i * frame..head + (i + 1) * frame]).unwrap();
        input.flush().unwrap();
        if i == 0 {
            assert!(lines.next().unwrap().unwrap().starts_with("frame,time_s,x_px,y_px,sigma_x_px"));
        }
        assert!(lines.next().unwrap().unwrap().starts_with(&format!("{i},")));
    }
    drop(input);
    assert!(lines.next().is_none() && child.wait().unwrap().success());
}

/// A file that grows, until a signal.
#[test]
#[cfg(target_os = "linux")]
fn a_growing_file_is_followed_until_a_signal() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("live.y4m");
    let bytes = stream(4, "mono", 0);
    let cut = bytes.len() - 2 * (SIZE.0 * SIZE.1) + 100;
    std::fs::write(&file, &bytes[..cut]).unwrap();
    let arguments = [file.to_str().unwrap(), "--roi", ROI, "--follow"];
    let mut child = palpate(&arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    for start in ["frame,", "0,", "1,"] {
        assert!(lines.next().unwrap().unwrap().starts_with(start));
    }
    let mut grown = std::fs::OpenOptions::new().append(true).open(&file).unwrap();
    grown.write_all(&bytes[cut..]).unwrap();
    for start in ["2,", "3,"] {
        assert!(lines.next().unwrap().unwrap().starts_with(start));
    }
    let id = child.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &id]).status().unwrap().success());
    let done = child.wait_with_output().unwrap();
    assert!(done.status.success(), "{}", told(&done));
    assert!(told(&done).contains("found in 4 of 4 frames"), "{}", told(&done));
}

#[test]
fn scale_surface_encoder_and_page() {
    let folder = tempfile::tempdir().unwrap();
    let named = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(named("a.y4m"), stream(40, "mono", 0)).unwrap();
    let encoder: String =
        (0..60).map(|i| format!("{},{}\n", 0.02 * f64::from(i), 3.0 - 0.1 * place(i as usize)[1])).collect();
    std::fs::write(named("encoder.csv"), format!("time_s,height_mm\n{encoder}")).unwrap();
    let (file, encoder, report, out) = (named("a.y4m"), named("encoder.csv"), named("report"), named("a.csv"));
    let words = [
        &file[..],
        "--roi",
        ROI,
        "--mm-per-px",
        "0.1",
        "--surface",
        "40.5",
        "--encoder",
        &encoder,
        "--report",
        &report,
        "--out",
        &out,
        "--json",
    ];
    let done = output(&words);
    assert!(done.status.success(), "{}", told(&done));
    let answer: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    assert_eq!(answer["lost"], serde_json::json!([[8, 11]]));
    // 0.02 px of 0.1 mm
    assert!(answer["encoder_rms_mm"].as_f64().unwrap() < 0.002, "{}", answer["encoder_rms_mm"]);
    assert_eq!(answer["positions"].as_array().unwrap().len(), 40);
    let below = |frame: usize| place(frame)[1] > 40.5 && !(8..12).contains(&frame);
    let first = (0..40).find(|frame| below(*frame)).unwrap();
    assert_eq!(answer["below_surface"][0][0], first);
    let rows = rows(&std::fs::read_to_string(&out).unwrap());
    let deep: f64 = rows[14]["below_surface_mm"].parse().unwrap();
    assert!((deep - 0.1 * (place(14)[1] - 40.5)).abs() < 0.002, "{deep}");
    for picture in ["track.html", "still.svg", "height.svg", "across.svg", "uncertainty.svg", "likeness.svg"] {
        let text = std::fs::read_to_string(folder.path().join("report").join(picture)).unwrap();
        assert!(!text.contains("NaN") && !text.contains("inf "), "{picture}");
        assert_eq!(text.matches("<svg").count(), text.matches("</svg>").count(), "{picture}");
    }
}

#[test]
fn what_is_wrong_with_frames_is_told_by_file_frame_and_value() {
    let folder = tempfile::tempdir().unwrap();
    let named = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let bytes = stream(3, "mono", 0);
    std::fs::write(named("cut.y4m"), &bytes[..bytes.len() - 1000]).unwrap();
    let done = output(&[&named("cut.y4m"), "--roi", ROI]);
    assert_eq!(done.status.code(), Some(2));
    assert_eq!(String::from_utf8_lossy(&done.stdout).lines().count(), 3, "the frames before are told");
    let text = told(&done);
    assert!(text.contains("cut.y4m, frame 2: ends after 6275 of 7275 bytes"), "{text}");
    assert!(text.contains("the positions of 2 frames were told"), "{text}");

    std::fs::write(named("odd.y4m"), "YUV4MPEG2 W0 H10 F1:1\n").unwrap();
    let text = told(&output(&[&named("odd.y4m"), "--roi", ROI]));
    assert!(text.contains("the width W is \"0\"; expected a whole number of at least 1"), "{text}");

    std::fs::write(named("none.png"), "no picture").unwrap();
    let text = told(&output(&[&named("none.png"), "--roi", ROI]));
    assert!(text.contains("none.png") && text.contains("expected a PNG file"), "{text}");

    let stills = folder.path().join("stills");
    std::fs::create_dir(&stills).unwrap();
    still(&stills.join("a1.png"), 0, png::ColorType::Grayscale, png::BitDepth::Eight);
    let other = std::fs::File::create(stills.join("a2.png")).unwrap();
    let mut encoder = png::Encoder::new(other, 4, 4);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&[0; 16]).unwrap();
    let text = told(&output(&[stills.to_str().unwrap(), "--roi", ROI]));
    assert!(text.contains("a2.png: the frame has 4 x 4 pixels; expected 97 x 75 as the first"), "{text}");

    let text = told(&output(&[stills.to_str().unwrap(), "--roi", "90,10,20,20"]));
    assert!(text.contains("the region 90,10,20,20 is not inside the frames of 97 x 75 pixels"), "{text}");
}
