//! Valid inputs to begin from: the golden messages, tables of every form, experiments of every test.

use protocol::frame::{Decoder, MAX_FRAME, encode_report, encode_request};
use protocol::lut::{AxisSpec, Role, Scale, TableSpec, axis_name};
use protocol::rescue;

use super::SEPARATOR;
use super::frames::framed;
use crate::samples;

/// Frames as they go over the line: one of each message and of the rescue question, and all of them in a row.
pub fn frames() -> Vec<Vec<u8>> {
    let mut out = [0; MAX_FRAME];
    let mut all = Vec::new();
    // No sample is longer than a frame (golden bytes).
    for message in samples::requests() {
        all.extend(encode_request(&message, 0x0102, &mut out).map(<[u8]>::to_vec));
    }
    for message in samples::reports() {
        all.extend(encode_report(&message, 0x0102, &mut out).map(<[u8]>::to_vec));
    }
    all.extend(framed(rescue::KIND, 0x0102, &rescue::QUESTION));
    all.push(all.concat());
    all
}

/// The same without their frames: kind, length and body, as [`super::messages`] takes them.
pub fn messages() -> Vec<Vec<u8>> {
    let mut decoder = Decoder::new();
    frames()
        .iter()
        .map(|line| {
            let mut plain = Vec::new();
            for byte in line {
                if let Some(Ok(frame)) = decoder.push(*byte) {
                    plain.extend([frame.kind, frame.body.len() as u8]);
                    plain.extend(frame.body);
                }
            }
            plain
        })
        .collect()
}

/// The golden table: three heights and exponents, mu as factor, one material.
pub fn small_table() -> Vec<u8> {
    // Of a sample that every build writes (golden bytes).
    samples::small_table().to_bytes().unwrap_or_default()
}

/// Tables: mu as factor, mu as column axis, with rates, and one so small that little can be wrong with it.
pub fn tables() -> Vec<Vec<u8>> {
    let golden = samples::small_table();
    let axis = |name: &str, unit: &str, role, values: &[f64]| AxisSpec::new(name, unit, role, Scale::Listed, values);
    let rows = golden.axes[0].clone();
    let depths = rows.values.clone();
    let curve = |stiffness: f64| depths.iter().map(|d| stiffness * d).collect::<Vec<_>>();
    let with = |axes: Vec<AxisSpec>, columns: usize| TableSpec {
        columns: (0..columns).map(|i| curve(0.1 * (i + 1) as f64)).collect(),
        axes,
        ..golden.clone()
    };
    let mu = axis(axis_name::MU, "MPa", Role::Column, &[0.1, 0.2, 0.4]);
    let alpha = axis(axis_name::ALPHA, "", Role::Column, &[1.0, 2.0, 4.0, 8.0]);
    let height = axis(axis_name::HEIGHT, "mm", Role::Column, &[10.0, 20.0]);
    let rate = axis(axis_name::RATE, "mm/s", Role::Column, &[1.0, 2.0]);
    let large = with(vec![rows.clone(), height.clone(), alpha.clone(), mu.clone()], 24);
    let rated = with(
        vec![rows.clone(), rate, height, alpha.clone(), axis(axis_name::MU, "MPa", Role::Factor, &[0.1, 0.2])],
        16,
    );
    let tiny = TableSpec { library: Vec::new(), provenance: String::new(), ..with(vec![rows, alpha], 4) };
    [golden, large, rated, tiny].iter().filter_map(|spec| spec.to_bytes().ok()).collect()
}

/// Experiments: description, [`SEPARATOR`], data.
pub fn experiments() -> Vec<Vec<u8>> {
    EXPERIMENTS
        .iter()
        .map(|(description, data)| [description.as_bytes(), SEPARATOR, data.as_bytes()].concat())
        .collect()
}

/// One ball press, one with everything that a description can say, one display run, and files with segments and side by side.
const EXPERIMENTS: [(&str, &str); 5] = [
    (
        "name = \"EVA\"\n[specimen.eva]\nbase_law = \"hyperfoam\"\nterms = 1\nheight_mm = 12.7\nradius_mm = 25.0\nbase = \"bonded\"\n\
         [indenter.r4]\nradius_mm = 4.0\n[sensor]\nnoise_N = 0.002\n\
         [[run]]\nfile = \"a.csv\"\nspecimen = \"eva\"\nindenter = \"r4\"\n",
        "time_s,depth_mm,force_N\n0,0,0\n0.1,0.2,0.01\n0.2,0.4,0.03\n0.3,0.6,0.06\n0.4,0.8,0.1\n0.5,0.8,0.09\n0.6,0.4,0.02\n0.7,0,0\n",
    ),
    (
        "[columns]\ndepth_mm = { name = \"Weg\", scale = 1000.0, sign = -1 }\nforce_N = \"Kraft\"\n\
         [format]\ndelimiter = \";\"\ndecimal = \",\"\nskip_lines = 1\nencoding = \"latin1\"\n\
         [specimen.a]\nmaterial = \"m\"\nbase_law = \"ogden\"\nterms = 2\nheight_mm = \"unknown\"\nradius_mm = 12\nbase = \"sliding\"\n\
         [indenter.b]\nradius_mm = \"unknown\"\n\
         [[run]]\nfile = \"a.csv\"\ntest = \"indentation\"\nspecimen = \"a\"\nindenter = \"b\"\nspot = 1\ncycle = 2\norder = 3\nstart_s = 1.5\nhold_out = true\n\
         [[run]]\nfile = \"a.csv\"\ntest = \"air\"\n",
        "Pr\u{fc}fung\ntime_s;Weg;Kraft;T\n0,0;-0,0001;0,1;20\n0,1;-0,0002;0,2;x\n0,2;-0,0003;0,4;21\n\n",
    ),
    (
        "[[run]]\nfile = \"a.csv\"\ntest = \"display\"\n",
        "time_s,command_mm,position_mm,command_A,current_A,gap_mm\n0,1,0.9,0.5,0.45,1\n0.02,1.1,1.0,0.5,0.46,1\n",
    ),
    (
        "[format]\nunits_row = true\nfooter_lines = 1\nsegment = \"approach\"\nthousands = \"'\"\n\
         [specimen.a]\nheight_mm = 20\nradius_mm = 30\n[indenter.b]\nradius_mm = 4\n\
         [[run]]\nfile = \"a.csv\"\nspecimen = \"a\"\nindenter = \"b\"\nfrom_s = 0.5\nto_s = 2\nrepeats = \"A\"\n",
        "Machine,7\nSegment,approach\ntime_s,depth_mm,force_N\n(s),(mm),(N)\n12:00:00.5,0,NaN\n12:00:01.0,0.5,1'000.5\n\
         Segment,hold\ntime_s,depth_mm,force_N\n(s),(mm),(N)\n12:00:02.0,0.5,900\nMean,,950\n",
    ),
    (
        "[format]\ncolumns = \"by-number\"\ndelimiter = \"spaces\"\n[columns]\ndepth_mm = 3\nforce_N = { number = 4, sign = -1 }\n\
         [specimen.a]\nheight_mm = 20\nradius_mm = 30\n[indenter.b]\nradius_mm = 4\n\
         [[run]]\nfile = \"a.csv\"\nspecimen = \"a\"\nindenter = \"b\"\nrate_mm_per_s = 1.0\n",
        "d f d f\n0 0 0 0\n1 1 1 -1\n2 3 2 -3\n3 6\n",
    ),
];
