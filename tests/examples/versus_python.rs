//! The Rust side of `bench/versus-python/run`: writes the data of a thousand identifications into a folder, and what the
//! firmware's search finds in them and how fast.

use std::path::{Path, PathBuf};

use firmware::kalman::Bounding;
use tests::palpations::Conditions;
use tests::thousand::{Thousand, fastest};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("usage: versus_python FOLDER")?);
    std::fs::create_dir_all(&folder)?;
    let thousand = Thousand::new()?;
    write_data(&folder, &thousand)?;
    let variance = fastest(5, || thousand.variance())?;
    let columns: Vec<String> = variance.column.iter().map(usize::to_string).collect();
    std::fs::write(folder.join("columns.txt"), columns.join("\n"))?;
    println!("variance_s {:.4}", variance.seconds);
    println!("fast_s {:.4}", fastest(5, || thousand.fast())?.seconds);
    let start = thousand.region()?.middle();
    std::fs::write(folder.join("start.txt"), format!("{} {}", start[1], start[0]))?;
    let kalman = fastest(5, || thousand.kalman(Bounding::Projection, 1))?;
    let lines: Vec<String> = kalman.found.iter().map(|(mu_mpa, alpha)| format!("{alpha} {mu_mpa}")).collect();
    std::fs::write(folder.join("kalman.txt"), lines.join("\n"))?;
    println!("kalman_s {:.4}", kalman.seconds);
    for (name, bounding, passes) in [
        ("projection", Bounding::Projection, 1),
        ("projection 3 passes", Bounding::Projection, 3),
        ("constrained 1", Bounding::Constrained { linearisations: 1 }, 1),
        ("constrained 3", Bounding::Constrained { linearisations: 3 }, 1),
        ("constrained 1, 2 passes", Bounding::Constrained { linearisations: 1 }, 2),
        ("constrained 2, 3 passes", Bounding::Constrained { linearisations: 2 }, 3),
    ] {
        let run = fastest(3, || thousand.kalman(bounding, passes))?;
        let mut off: Vec<f64> = run.found.iter().zip(&thousand.truth).map(|(f, t)| (f.1 - t.1).abs()).collect();
        off.sort_by(f64::total_cmp);
        eprintln!("{name}: {:.4} s, alpha off median {:.4} 90 % {:.4}", run.seconds, off[500], off[900]);
    }
    let run = thousand.fast()?;
    let mut off: Vec<f64> = run.found.iter().zip(&thousand.truth).map(|(f, t)| (f.1 - t.1).abs()).collect();
    off.sort_by(f64::total_cmp);
    eprintln!("fast: alpha off median {:.4} 90 % {:.4}", off[500], off[900]);
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
