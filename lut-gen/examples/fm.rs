#![allow(missing_docs, clippy::unwrap_used)]
use lut_gen::{contact::*, model::*};
fn main() {
    let a: Vec<f64> = std::env::args().skip(1).map(|x| x.parse().unwrap()).collect();
    let n = a[0] as usize;
    let mut s = ModelSpec::new(Specimen::of_height(a[1]), Ball { radius_mm: 4.0 }, 4.0);
    s.alpha_nodes = n;
    if a.len() > 2 { s.heights_mm = Some((5.0, 25.4, a[2] as usize)); }
    let t = std::time::Instant::now();
    let m = ForceModel::build(&s, &|_, _| {}).unwrap();
    println!("nodes {n}: {:?} solves {} {:.2} s", m.error(), m.solves(), t.elapsed().as_secs_f64());
    let t = std::time::Instant::now();
    let mut sum = 0.0;
    for i in 0..100_000 { sum += m.gradient(0.1, 1.0 + 23.0 * (i as f64) / 1e5, 4.0 * (i % 100) as f64 / 100.0).d_alpha; }
    println!("{:.3} us {sum}", t.elapsed().as_secs_f64() * 10.0);
}
