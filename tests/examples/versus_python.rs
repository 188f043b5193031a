//! The Rust side of `bench/versus-python/run`: writes the data of a thousand identifications into a folder, and what the
//! firmware's search finds in them and how fast.

use std::path::{Path, PathBuf};

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
    put("shape", table.slice(0).flat_map(shape).collect())?;
    put("measured", thousand.force_n.iter().flatten().copied().collect())?;
    put("noise", vec![Conditions::default().noise_n as f32])?;
    Ok(())
}
