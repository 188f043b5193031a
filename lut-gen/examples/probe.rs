#![allow(missing_docs, clippy::unwrap_used)]
use lut_gen::{contact::*, element::*, law::*, mesh::*, solve::*};
fn main() {
    let a: Vec<f64> = std::env::args().skip(1).map(|x| x.parse().unwrap()).collect();
    // refinement axis growth_under near growth_far surface growth_down kappa per_edge quad alpha h R largest
    let d = [1.0, 0.05, 0.06, 1.1, 0.4, 0.05, 0.25, 400.0, 8.0, 2.0, 10.526, 12.7, 4.0, 0.06, 0.0];
    let g = |i: usize| a.get(i).copied().unwrap_or(d[i]);
    let ball = Ball { radius_mm: g(12) };
    let sizes = Sizes { axis: g(1), growth_under: g(2), near: g(3), growth_far: g(4), surface: g(5), growth_down: g(6), refinement: g(0) };
    let law = Hyperfoam::one_term(1.0, g(10)).unwrap();
    let t = std::time::Instant::now();
    let mesh = BlockMesh::new(25.0, g(11), ball.radius_mm, &sizes);
    let surface = Surface::new(&mesh.nodes, &mesh.top, 2.5 * ball.radius_mm, g(8) as usize, g(7) / ball.radius_mm);
    let sys = System::new(&mesh, if g(14) == 1.0 { Base::Sliding } else { Base::Bonded }, ball, surface, if g(9) == 2.0 { Quadrature::Reduced } else { Quadrature::Full });
    let t1 = t.elapsed().as_secs_f64();
    let step = Stepping { largest: g(13), ..Default::default() };
    let p = step.follow(&sys, &law, &Newton::default(), ball.radius_mm, 4.0, "x").unwrap();
    let s = &p.stations;
    let n = s.len();
    println!("n={} el={} top={} steps={} it={} cuts={} setup {:.3} total {:.3} s", sys.unknowns(), mesh.elements.len(), mesh.top.len(), n, p.iterations, p.cuts, t1, t.elapsed().as_secs_f64());
    let ec = |i: usize| {
        let (a, b, c) = (&s[i - 1], &s[i], &s[(i + 1).min(n - 1)]);
        if i + 1 < n { (c.penalty_energy - a.penalty_energy) / (c.depth_mm - a.depth_mm) } else { (b.penalty_energy - a.penalty_energy) / (b.depth_mm - a.depth_mm) }
    };
    for i in 1..n {
        let (x, y) = (&s[i - 1], &s[i]);
        for d in [0.1, 0.25, 0.5, 1.0, 2.0, 3.0, 4.0] {
            if x.depth_mm < d && d <= y.depth_mm + 1e-9 {
                let h = y.depth_mm - x.depth_mm;
                let q = (d - x.depth_mm) / h;
                let f = |f0: f64, f1: f64| {
                    let (g0, g1) = (x.slope * h, y.slope * h);
                    (1.0 + 2.0 * q) * (1.0 - q) * (1.0 - q) * f0 + q * (1.0 - q) * (1.0 - q) * g0 + q * q * (3.0 - 2.0 * q) * f1 + q * q * (q - 1.0) * g1
                };
                let raw = f(x.force_n, y.force_n);
                let c = ec(i) * q + if i > 1 { ec(i - 1) * (1.0 - q) } else { 0.0 };
                println!("{d:5} raw {raw:.5} corr {:.5} base/contact-1 {:.1e} a {:.3}", raw + c, y.base_force_n / y.force_n - 1.0, y.contact_radius_mm);
            }
        }
    }
}
