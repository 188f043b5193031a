//! `palpate track`.

mod encoder;
mod files;
mod told;
mod tracked;

use std::fs::OpenOptions;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use clap::{Args, ValueEnum};
use miette::{IntoDiagnostic, WrapErr, miette};

use crate::signals;
use crate::track::source::{Ending, Frames};
use crate::track::{Frame, Marker, Measure, Position, Positions, Roi, Scale};
use encoder::Encoder;
use tracked::Tracked;

/// A tip in recorded frames.
#[derive(Debug, Args)]
#[command(
    after_help = "Without --out every position goes to standard output as soon as its frame is read, as a line of CSV:\n  \
ffmpeg -i press.mp4 -f yuv4mpegpipe - | palpate track - --roi 300,180,60,60\n\
Columns: place and its standard deviation (with that of the first frame; own_sigma is this frame's part alone), lost (1 or 0), correlation \
with the first frame, part of the tip that is seen, contrast over that of the first frame. Places of lost frames are empty."
)]
pub struct Arguments {
    /// Folder of PNG files in the order of their numbers, a .y4m file or pipe, or - for a .y4m stream on standard input
    #[arg(value_name = "FRAMES")]
    frames: PathBuf,
    /// Rectangle that encloses the tip in the first frame, closely; pixels from the upper left corner
    #[arg(long, value_name = "X,Y,WIDTH,HEIGHT")]
    roi: Roi,
    /// Point of the tip whose place is told, in the first frame; without it the rectangle's middle
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true)]
    tip: Option<String>,
    /// Frames a second, instead of the recording's own; PNG files have none
    #[arg(long, value_name = "HZ")]
    fps: Option<f64>,
    /// Length of a pixel, mm
    #[arg(long, value_name = "MM", conflicts_with = "marker")]
    mm_per_px: Option<f64>,
    /// Rectangle of the first frame with a filled marker alone on plain ground, by which the length of a pixel is measured
    #[arg(long, value_name = "X,Y,WIDTH,HEIGHT", requires = "marker_mm")]
    marker: Option<Roi>,
    /// Diameter of the marker, or side of a square one, mm
    #[arg(long, value_name = "MM", requires = "marker")]
    marker_mm: Option<f64>,
    /// What the marker is
    #[arg(long, value_name = "SHAPE", default_value = "disc")]
    marker_shape: Shape,
    /// Row of the display's surface, pixels: adds how far the tip is below it
    #[arg(long, value_name = "Y", allow_hyphen_values = true)]
    surface: Option<f64>,
    /// Positions of an encoder to compare with, CSV of time (s) and height (mm, up); needs a scale and a frame rate
    #[arg(long, value_name = "FILE.csv")]
    encoder: Option<PathBuf>,
    /// Keep waiting for frames when the recording ends, until Ctrl-C
    #[arg(long)]
    follow: bool,
    /// Write the positions to this file, which must not exist
    #[arg(long, value_name = "FILE.csv")]
    out: Option<PathBuf>,
    /// Replace the file of --out
    #[arg(long, requires = "out")]
    force: bool,
    /// Folder for a page with figures: still frame, height over time, uncertainty
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Print one JSON object on standard output, after the last frame
    #[arg(long)]
    json: bool,
}

/// A marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Shape {
    /// Filled, by its diameter
    Disc,
    /// Filled, by its side
    Square,
}

/// Follows, tells positions as they come, and sums them up.
///
/// # Errors
/// Frames that cannot be read, a region without a tip, a file that exists.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    let stop = Arc::new(AtomicBool::new(false));
    if arguments.follow || arguments.frames == Path::new("-") {
        signals::stop_on_signals(&stop).into_diagnostic()?;
    }
    check(arguments)?;
    let mut encoder = arguments.encoder.as_deref().map(Encoder::read).transpose()?;
    let ending = if arguments.follow { Ending::Until(&stop) } else { Ending::Final };
    let frames = Frames::open(&arguments.frames, ending)?;
    let tip = arguments.tip.as_deref().map(point).transpose()?;
    let (mut found, first) = Positions::open(frames, arguments.roi, tip, arguments.fps)?;
    let measure = Measure { scale: scale(arguments, &first)?, surface_px: arguments.surface };
    let rate_hz = found.rate_hz();
    if encoder.is_some() && (rate_hz.is_none() || measure.scale.is_none()) {
        let what = if rate_hz.is_none() { "a frame rate: --fps" } else { "a scale: --mm-per-px or --marker" };
        return Err(miette!("--encoder needs {what}"));
    }
    let mut sink = Sink::open(arguments)?;
    sink.line(&measure.head())?;
    let start = Instant::now();
    let (positions, ended) = followed(&mut found, &measure, &mut sink, &stop)?;
    let seconds = start.elapsed().as_secs_f64();
    if let Some(encoder) = &mut encoder {
        encoder.compare(&positions, &measure);
    }
    let tracked = Tracked { first, roi: arguments.roi, measure, rate_hz, positions, encoder, seconds };
    let page = match &arguments.report {
        Some(folder) => Some(files::write(folder, &tracked)?),
        None => None,
    };
    tell(arguments, &tracked, page.as_deref());
    let whole = tracked.positions.len();
    ended.map_err(|cause| cause.wrap_err(format!("the positions of {whole} frames were told")))
}

/// Positions until the last frame, an error of a frame, or a signal.
fn followed(
    found: &mut Positions<'_>,
    measure: &Measure,
    sink: &mut Sink,
    stop: &AtomicBool,
) -> miette::Result<(Vec<Position>, miette::Result<()>)> {
    let mut positions = Vec::new();
    for position in found {
        match position {
            Ok(position) => {
                sink.line(&measure.row(&position))?;
                positions.push(position);
            }
            // A stream that is broken off by a signal has not failed.
            Err(_) if stop.load(Ordering::Relaxed) => break,
            Err(cause) => return Ok((positions, Err(cause.into()))),
        }
        if stop.load(Ordering::Relaxed) {
            break;
        }
    }
    Ok((positions, Ok(())))
}

fn tell(arguments: &Arguments, tracked: &Tracked, page: Option<&Path>) {
    if arguments.json {
        outln!("{}", told::json(tracked, arguments.out.as_deref(), page));
        return;
    }
    let lines = told::lines(tracked, arguments.out.as_deref(), page);
    for line in lines {
        // Where positions go to standard output, nothing else does.
        if arguments.out.is_some() {
            outln!("{line}");
        } else {
            errln!("{line}");
        }
    }
}

/// Where rows go.
enum Sink {
    File(PathBuf, std::fs::File),
    Output,
    Nowhere,
}

impl Sink {
    fn open(arguments: &Arguments) -> miette::Result<Self> {
        let Some(path) = &arguments.out else {
            return Ok(if arguments.json { Self::Nowhere } else { Self::Output });
        };
        let cannot = || format!("--out: cannot write {}", path.display());
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            std::fs::create_dir_all(folder).into_diagnostic().wrap_err_with(cannot)?;
        }
        let mut options = OpenOptions::new();
        options.write(true);
        let options = if arguments.force { options.create(true).truncate(true) } else { options.create_new(true) };
        let file = options.open(path).into_diagnostic().wrap_err_with(cannot)?;
        Ok(Self::File(path.clone(), file))
    }

    /// Writes a row at once: somebody may wait for it.
    fn line(&mut self, text: &str) -> miette::Result<()> {
        match self {
            Self::File(path, file) => {
                let cannot = || format!("--out: cannot write {}", path.display());
                file.write_all(format!("{text}\n").as_bytes()).into_diagnostic().wrap_err_with(cannot)?;
            }
            Self::Output => outln!("{text}"),
            Self::Nowhere => {}
        }
        Ok(())
    }
}

/// Refuses what cannot be meant, before a frame is read.
fn check(arguments: &Arguments) -> miette::Result<()> {
    let positive = |option: &str, value: Option<f64>, most: f64| match value {
        Some(value) if !(value > 0.0 && value <= most) => {
            Err(miette!("{option} is {value}; expected more than 0 and at most {most}"))
        }
        _ => Ok(()),
    };
    positive("--fps", arguments.fps, 1e6)?;
    positive("--mm-per-px", arguments.mm_per_px, 1e4)?;
    positive("--marker-mm", arguments.marker_mm, 1e5)?;
    if let Some(surface) = arguments.surface.filter(|surface| surface.is_nan() || surface.abs() > 1e6) {
        return Err(miette!("--surface is {surface}; expected a row in pixels"));
    }
    if let Some(out) = arguments.out.as_ref().filter(|out| !arguments.force && out.exists()) {
        return Err(miette!("--out: {} exists and is kept; --force replaces it", out.display()));
    }
    Ok(())
}

fn point(text: &str) -> miette::Result<[f64; 2]> {
    let parts: Vec<Option<f64>> = text.split(',').map(|part| part.trim().parse().ok()).collect();
    match parts.as_slice() {
        [Some(x), Some(y)] if x.is_finite() && y.is_finite() => Ok([*x, *y]),
        _ => Err(miette!("--tip is {text}; expected X,Y in pixels of the first frame, such as 150.5,92")),
    }
}

fn scale(arguments: &Arguments, first: &Frame) -> miette::Result<Option<Scale>> {
    let Some((roi, length_mm)) = arguments.marker.zip(arguments.marker_mm) else {
        return Ok(arguments.mm_per_px.map(Scale::told));
    };
    let marker = match arguments.marker_shape {
        Shape::Disc => Marker::Disc,
        Shape::Square => Marker::Square,
    };
    let found = Scale::of_marker(first, roi, marker, length_mm);
    found.map(Some).map_err(|cause| miette!("--marker: {cause}"))
}

#[cfg(test)]
mod tests;
