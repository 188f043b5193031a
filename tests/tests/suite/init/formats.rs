//! One press, written as machines and laboratories write it.

use std::io::Write as _;

use palpate::experiment::Recording;
use rust_xlsxwriter::Workbook;

/// A ball of 5 mm at 1 mm/s from 0.6 mm above a half-space of 0.1 MPa (plane-strain modulus) to 2.4 mm, and back to 1.8 mm: force after
/// Hertz, in N; every 50 ms.
pub fn press() -> Recording {
    let time: Vec<f64> = (0..73).map(|i| f64::from(i) * 0.05).collect();
    let depth: Vec<f64> = time.iter().map(|t| if *t <= 3.0 { t - 0.6 } else { 5.4 - t }).collect();
    let force = depth.iter().map(|d| 4.0 / 3.0 * 0.1 * 5.0_f64.sqrt() * d.max(0.0).powf(1.5)).collect();
    Recording::from_samples(time, depth, force)
}

/// A file, and what a reader must know of it.
pub struct Written {
    /// Its name.
    pub name: &'static str,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// Runs in it; the first is the press.
    pub runs: usize,
}

fn written(name: &'static str, text: &str) -> Written {
    Written { name, bytes: text.as_bytes().to_vec(), runs: 1 }
}

/// Rows of time, depth and force with factors.
fn rows(scale: [f64; 3], delimiter: &str, decimal: &str) -> Vec<String> {
    let press = press();
    (0..press.len())
        .map(|at| {
            let values = [press.time_s[at], press.depth_mm[at], press.force_n[at]];
            let cells = values.iter().zip(scale).map(|(x, scale)| format!("{:.9}", x * scale).replace('.', decimal));
            cells.collect::<Vec<_>>().join(delimiter)
        })
        .collect()
}

fn text(header: &str, scale: [f64; 3], delimiter: &str, decimal: &str) -> String {
    format!("{header}\n{}\n", rows(scale, delimiter, decimal).join("\n"))
}

/// The press in all formats.
pub fn all() -> Vec<Written> {
    const ONE: [f64; 3] = [1.0; 3];
    let german = text("Prüfzeit [s];Traversenweg [µm];Standardkraft [mN]", [1.0, 1e3, 1e3], ";", ",");
    let tabs = text("Zeit\tWeg\tKraft", ONE, "\t", ",");
    let back = rows([1.0, -1.0, 0.5], ",", ".").join("\n");
    vec![
        written("comma.csv", &text("time_s,depth_mm,force_N", ONE, ",", ".")),
        written("semicolon.csv", &text("Zeit in s;Eindringtiefe in mm;Kraft in N", ONE, ";", ",")),
        written(
            "units-row.txt",
            &format!(
                "Machine 7\nSpecimen\tfoam A\n\n{}",
                text("Elapsed\tDisplacement\tForce\n(ms)\t(mm)\t(gf)", [1e3, 1.0, 1e3 / 9.80665], "\t", ".")
            ),
        ),
        Written {
            bytes: [0xff, 0xfe].into_iter().chain(tabs.encode_utf16().flat_map(u16::to_le_bytes)).collect(),
            ..written("utf16-marked.txt", "")
        },
        Written { bytes: tabs.encode_utf16().flat_map(u16::to_le_bytes).collect(), ..written("utf16.txt", "") },
        Written {
            bytes: german.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap()).collect(),
            ..written("latin1.csv", "")
        },
        Written { bytes: xlsx(), ..written("book.xlsx", "") },
        Written { bytes: ods(), ..written("book.ods", "") },
        Written { runs: 2, ..written("beside.csv", &beside()) },
        Written {
            runs: 2,
            ..written(
                "segments.csv",
                &format!(
                    "Segment,1\n{}Segment,2\ntime (s),position (mm),load (N)\n{back}\nMaximum,,9.9\n",
                    text("time (s),position (mm),load (N)", ONE, ",", ".")
                ),
            )
        },
        written("no-time.csv", &no_time()),
        written("negative.csv", &text("Time (min),Extension (m),Load (kN)", [1.0 / 60.0, -1e-3, -1e-3], ",", ".")),
        written("clock.csv", &clock()),
        written("blanks.txt", &text("t d F", ONE, "   ", ".").replace("t d F\n", "")),
        written("quoted.csv", &quoted()),
    ]
}

fn beside() -> String {
    let (one, other) = (rows([1.0; 3], ",", "."), rows([1.0, 1.0, 1.1], ",", "."));
    let mut text = "Time,Disp,Load,Time,Disp,Load\n(s),(mm),(N),(s),(mm),(N)\n".to_owned();
    for (at, row) in one.iter().enumerate() {
        text += &format!("{row},{}\n", if at < 50 { &other[at] } else { ",," });
    }
    text
}

fn no_time() -> String {
    let rows: Vec<String> =
        rows([1.0; 3], ";", ".").iter().map(|row| row.split_once(';').unwrap().1.to_owned()).collect();
    format!("Test speed: 1 mm/s\nDistance (mm);Force (N)\n{}\n", rows.join("\n"))
}

fn clock() -> String {
    let press = press();
    let row = |at: usize| {
        format!(
            "2024-05-01 23:59:{:09.6},{:.6},{:.6}\n",
            56.4 + press.time_s[at],
            press.depth_mm[at],
            press.force_n[at]
        )
    };
    format!("timestamp,depth,force\n{}", (0..press.len()).map(row).collect::<String>())
        .replace("2024-05-01 23:59:60", "2024-05-02 00:00:00")
}

fn quoted() -> String {
    let rows: Vec<String> = rows([1.0; 3], "\",\"", ".").iter().map(|row| format!("\"\",\"{row}\"")).collect();
    format!("Results Table 1\n\n1,Time,Displacement,Force\n,(s),(mm),(N)\n{}\n", rows.join("\n"))
}

fn xlsx() -> Vec<u8> {
    let press = press();
    let mut book = Workbook::new();
    let sheet = book.add_worksheet().set_name("Summary").unwrap();
    sheet.write_string(0, 0, "Operator").unwrap().write_string(0, 1, "A").unwrap();
    let sheet = book.add_worksheet().set_name("Specimen 1").unwrap();
    for (column, name) in ["Time (s)", "Displacement (mm)", "Force (N)"].iter().enumerate() {
        sheet.write_string(2, column as u16, *name).unwrap();
    }
    for at in 0..press.len() {
        for (column, value) in [press.time_s[at], press.depth_mm[at], press.force_n[at]].iter().enumerate() {
            sheet.write_number(at as u32 + 3, column as u16, *value).unwrap();
        }
    }
    book.save_to_buffer().unwrap()
}

/// An OpenDocument sheet of as little as its readers need.
fn ods() -> Vec<u8> {
    let press = press();
    let words = |names: [&str; 3]| {
        let cell = |name: &str| {
            format!("<table:table-cell office:value-type=\"string\"><text:p>{name}</text:p></table:table-cell>")
        };
        format!("<table:table-row>{}</table:table-row>", names.map(cell).concat())
    };
    let mut rows = words(["Zeit (s)", "Weg (mm)", "Kraft (N)"]);
    for at in 0..press.len() {
        let cell = |x: f64| {
            format!(
                "<table:table-cell office:value-type=\"float\" office:value=\"{x}\"><text:p>{x:.2}</text:p></table:table-cell>"
            )
        };
        let cells = [press.time_s[at], press.depth_mm[at], press.force_n[at]].map(cell).concat();
        rows += &format!("<table:table-row>{cells}</table:table-row>");
    }
    let names = ["office", "table", "text"]
        .map(|n| format!(" xmlns:{n}=\"urn:oasis:names:tc:opendocument:xmlns:{n}:1.0\""))
        .concat();
    let content = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?><office:document-content{names}><office:body><office:spreadsheet>\
         <table:table table:name=\"Tabelle1\">{rows}</table:table></office:spreadsheet></office:body></office:document-content>"
    );
    let kind = "application/vnd.oasis.opendocument.spreadsheet";
    let manifest = format!(
        "<?xml version=\"1.0\"?><manifest:manifest xmlns:manifest=\"urn:oasis:names:tc:opendocument:xmlns:manifest:1.0\">\
         <manifest:file-entry manifest:full-path=\"/\" manifest:media-type=\"{kind}\"/></manifest:manifest>"
    );
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let stored = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
    for (name, text) in [("mimetype", kind), ("content.xml", &content), ("META-INF/manifest.xml", &manifest)] {
        archive.start_file(name, stored).unwrap();
        archive.write_all(text.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}
