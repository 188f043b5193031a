//! Prototype.
use protocol::lut::Table;
use tests::palpations::*;
use tests::thousand::*;
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let t0 = std::time::Instant::now();
    let thousand = Thousand::new()?;
    eprintln!("thousand {:?}", t0.elapsed());
    for _ in 0..3 {
        let v = fastest(3, || thousand.variance())?;
        let mut e: Vec<f64> = v.found.iter().zip(&thousand.truth).map(|(f, t)| (f.1 - t.1).abs()).collect();
        e.sort_by(f64::total_cmp);
        eprintln!("variance {} s; alpha error median {} 90 % {}", v.seconds, e[500], e[900]);
    }
    let t0 = std::time::Instant::now();
    let bytes = tables(lut_gen::model::Resolution::Standard, &|_, _| ())?;
    eprintln!("tables {:?}", t0.elapsed());
    let foams = pressed_foams()?;
    eprintln!("solved {:?}", t0.elapsed());
    let sessions: usize = std::env::args().nth(1).map_or(1, |s| s.parse().unwrap_or(1));
    for (name, conditions) in [("default", Conditions::default())] {
        for rate in 0..3 {
            let table = Table::parse(&bytes[rate]).map_err(|e| e.to_string())?;
            let study = Study::run(&foams, &table, rate, (sessions, &THESIS_COUNTS), &conditions, &mut || ());
            println!("{name} {} mm/s: {:?} % board, {:?} % threshold   [{:?}]", RATES_MM_S[rate], study.recognised(&foams, None), study.recognised_by_threshold(&foams, None), t0.elapsed());
            for (i, foam) in foams.iter().enumerate() {
                println!("    {:4} {:.1} {:.1}  ours {:?} threshold {:?}", foam.name, study.recognised(&foams, Some(i)).percent(), study.recognised_by_threshold(&foams, Some(i)).percent(), study.alpha(i), study.alpha_by_threshold(i));
            }
        }
    }
    Ok(())
}
