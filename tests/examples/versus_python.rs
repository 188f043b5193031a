//! The Rust side of `bench/versus-python/run`: writes the data of a thousand identifications into a folder, and what the
//! firmware's search finds in them and how fast.

use std::path::{Path, PathBuf};

use firmware::kalman::Bounding;
use tests::palpations::Conditions;
use tests::thousand::{Thousand, Timed, fastest};

/// Boundings and passes that are timed: the thesis' filter, which Python runs as well, and the board's.
const KALMAN: [(&str, Bounding, u8); 3] = [
    ("projection", Bounding::Projection, 1),
    ("constrained", Bounding::Constrained { linearisations: 1 }, 1),
    ("three_passes", Bounding::Constrained { linearisations: 1 }, 3),
];

/// Median and 90 % quantile of the error of alpha.
fn off(thousand: &Thousand, run: &Timed) -> [f64; 2] {
    let mut off: Vec<f64> = run.found.iter().zip(&thousand.truth).map(|(f, t)| (f.1 - t.1).abs()).collect();
    off.sort_by(f64::total_cmp);
    [off.len() / 2, off.len() * 9 / 10].map(|i| off.get(i).copied().unwrap_or(f64::NAN))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("usage: versus_python FOLDER")?);
    std::fs::create_dir_all(&folder)?;
    let thousand = Thousand::new()?;
    write_data(&folder, &thousand)?;
    let variance = fastest(5, || thousand.variance())?;
    let columns: Vec<String> = variance.column.iter().map(usize::to_string).collect();
    std::fs::write(folder.join("columns.txt"), columns.join("\n"))?;
    println!("variance_s {:.4}", variance.seconds);
    let truth: Vec<String> = thousand.truth.iter().map(|(_, alpha)| alpha.to_string()).collect();
    std::fs::write(folder.join("truth.txt"), truth.join("\n"))?;
    let start = thousand.region()?.middle();
    std::fs::write(folder.join("start.txt"), format!("{} {}", start[1], start[0]))?;
    let kalman = fastest(5, || thousand.kalman(Bounding::Projection, 1))?;
    let lines: Vec<String> = kalman.found.iter().map(|(mu_mpa, alpha)| format!("{alpha} {mu_mpa}")).collect();
    std::fs::write(folder.join("kalman.txt"), lines.join("\n"))?;
    for (name, bounding, passes) in KALMAN {
        let run = fastest(5, || thousand.kalman(bounding, passes))?;
        let [median, most] = off(&thousand, &run);
        println!("kalman_{name}_s {:.4}\nkalman_{name}_median {median:.3}\nkalman_{name}_most {most:.3}", run.seconds);
    }
    let fast = fastest(5, || thousand.fast())?;
    println!("fast_s {:.4}", fast.seconds);
    for (name, run) in [("variance", &variance), ("fast", &fast)] {
        let [median, most] = off(&thousand, run);
        println!("{name}_median {median:.3}\n{name}_most {most:.3}");
    }
    Ok(())
}

fn write_data(folder: &Path, thousand: &Thousand) -> Result<(), Box<dyn std::error::Error>> {
    let table = thousand.table()?;
    let put = |name: &str, values: Vec<f32>| {
        let bytes: Vec<u8> = values.into_iter().flat_map(f32::to_le_bytes).collect();
        std::fs::write(folder.join(format!("{name}.f32")), bytes)
    };
    for name in ["alpha", "mu"] {
        put(name, table.axis(name).ok_or("the table has no such axis")?.values().collect())?;
    }
    put("depth", thousand.depth_mm.clone())?;
    // As the board reads them: what the counts of the table mean.
    let positions = thousand.depth_mm.iter().map(|d| table.locate(*d)).collect::<Option<Vec<_>>>().ok_or("a depth")?;
    let shape = |column: usize| positions.iter().map(|p| table.force_n(*p, column)).collect::<Vec<f32>>();
    put("shape", table.slice(0, 0).flat_map(shape).collect())?;
    put("measured", thousand.force_n.iter().flatten().copied().collect())?;
    put("noise", vec![Conditions::default().noise_n as f32])?;
    Ok(())
}
