//! Whatever a file holds, it is read or refused; what was written is read again.

use proptest::prelude::*;
use std::fs;

use super::case::folder;
use palpate::experiment;

/// Keys in any combination.
fn keys() -> impl Strategy<Value = String> {
    let one_of = |lines: &'static [&'static str]| prop::sample::select(lines);
    (
        one_of(&["", "delimiter = \";\"\n", "delimiter = \"\\t\"\n", "delimiter = \"spaces\"\n"]),
        one_of(&["", "thousands = \"'\"\n", "encoding = \"utf-16le\"\n", "encoding = \"latin1\"\n"]),
        one_of(&["", "units_row = true\n", "footer_lines = 2\n", "skip_lines = 1\n"]),
        one_of(&["", "segment = 2\n", "segment = \"a\"\n", "sheet = 1\n"]),
        one_of(&["", "columns = \"by-number\"\n[columns]\ntime_s = 1\ndepth_mm = 2\nforce_N = 3\n"]),
    )
        .prop_map(|(a, b, c, d, e)| format!("[format]\n{a}{b}{c}{d}{e}"))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_bytes_panic(
        bytes in prop::collection::vec(any::<u8>(), 0..300),
        magic in prop::sample::select(vec![&b""[..], b"PK\x03\x04", &[0xd0, 0xcf, 0x11, 0xe0, 0xa1, 0xb1, 0x1a, 0xe1], &[0xff, 0xfe]]),
        keys in keys(),
    ) {
        let made = folder("a.csv", &[magic, &bytes].concat(), &keys, "to_s = 1.0");
        let _ = experiment::read(made.path());
        let _ = palpate::init::look(&[made.path().join("a.csv")], &palpate::init::Options::default());
    }

    #[test]
    fn no_cells_panic(
        csv in "(time_s|depth_mm|force_N|\\(s\\)|segment a|[,;\t\n\r\"]|12:00:0[0-9]|[-+0-9.eE',nN]{0,6}){0,60}",
        keys in keys(),
    ) {
        let made = folder("a.csv", format!("time_s,depth_mm,force_N\n{csv}").as_bytes(), &keys, "from_s = 0.0");
        let _ = experiment::read(made.path());
        let _ = palpate::init::look(&[made.path().join("a.csv")], &palpate::init::Options::default());
    }

    /// Numbers come back as they were written, whatever stands between them.
    #[test]
    fn tables_come_back(
        table in prop::collection::vec((0.0_f64..10.0, -5.0_f64..5.0, -1e3_f64..1e3), 1..60),
        (delimiter, key) in prop::sample::select(vec![(',', ","), (';', ";"), ('\t', "\\t"), ('|', "|"), (' ', "spaces")]),
        comma in any::<bool>(),
        quoted in any::<bool>(),
        wide in any::<bool>(),
        preamble in 0_usize..4,
    ) {
        prop_assume!(!(comma && delimiter == ','));
        let mut time_s = 0.0;
        let mut text = "about the machine\n".repeat(preamble) + &["time_s", "depth_mm", "force_N"].join(&delimiter.to_string()) + "\n";
        let mut expected = Vec::new();
        for (step, depth, force) in &table {
            time_s += step;
            expected.push([time_s, *depth, *force]);
            let cells = [time_s, *depth, *force].map(|x| {
                let text = if comma { x.to_string().replace('.', ",") } else { x.to_string() };
                if quoted { format!("\"{text}\"") } else { text }
            });
            text += &(cells.join(&delimiter.to_string()) + "\r\n");
        }
        let bytes = if wide { text.encode_utf16().flat_map(u16::to_le_bytes).collect() } else { text.into_bytes() };
        let keys = format!(
            "[format]\ndelimiter = \"{key}\"\nskip_lines = {preamble}\ndecimal = \"{}\"\nencoding = \"{}\"\n",
            if comma { "," } else { "." },
            if wide { "utf-16le" } else { "utf-8" },
        );
        // without a specimen, so that nothing is asked of what the numbers mean
        let read = super::case::recording(&folder("a.csv", &bytes, &keys, "test = \"air\""));
        let found: Vec<[f64; 3]> =
            (0..read.len()).map(|at| [read.time_s[at], read.depth_mm[at], read.force_n[at]]).collect();
        prop_assert_eq!(found, expected);
        prop_assert_eq!(read.line.first().copied(), Some(preamble + 2));
    }
}

/// 1.4 million rows of a run of four columns are read within seconds also where nothing is optimised across crates.
#[test]
fn a_million_rows() {
    let mut text = "time_s,depth_mm,force_N,temperature\n".to_owned();
    for i in 0..1_400_000_u32 {
        let t = f64::from(i) * 1e-3;
        text += &format!("{t:.4},{:.5},{:.5},21.{}\n", t * 1e-3, t * 1e-4, i % 10);
    }
    let made = folder("a.csv", text.as_bytes(), "", "");
    let started = std::time::Instant::now();
    let read = super::case::recording(&made);
    let seconds = started.elapsed().as_secs_f64();
    println!(
        "{} rows of {} bytes in {seconds:.2} s",
        read.len(),
        fs::metadata(made.path().join("a.csv")).unwrap().len()
    );
    assert_eq!((read.len(), read.line[1_399_999]), (1_400_000, 1_400_001));
    // A hundred times what it takes: a machine may be busy.
    assert!(seconds < 60.0, "{seconds} s");
}
