//! Writes the seeds of the fuzz targets (`tests::robustness::seeds`, and the descriptions in `tests/experiments`) into a corpus folder, one
//! folder a target: `cargo run -p tests --example fuzz_seeds -- tests/fuzz/corpus`. `tests/fuzz/run` calls it.

use std::path::{Path, PathBuf};

use tests::robustness::{SEPARATOR, seeds};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let corpus = std::env::args().nth(1).map(PathBuf::from).ok_or("name the corpus folder")?;
    let mut experiments = seeds::experiments();
    for folder in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("experiments"))? {
        let description = std::fs::read(folder?.path().join("experiment.toml"))?;
        experiments.push([&description, SEPARATOR].concat());
    }
    let targets = [
        ("frames", seeds::frames()),
        ("messages", seeds::messages()),
        ("table", seeds::tables()),
        ("experiment", experiments),
    ];
    for (target, seeds) in targets {
        let folder = corpus.join(target);
        std::fs::create_dir_all(&folder)?;
        for (number, seed) in seeds.iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{number:02}")), seed)?;
        }
        println!("{target}: {} seeds", seeds.len());
    }
    Ok(())
}
