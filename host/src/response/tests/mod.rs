#![allow(clippy::unwrap_used)]
mod bench;
use super::fit::*;
use super::law::*;
use super::motion::follow;
use bench::*;

fn exact(t: &Truth) -> Law {
    Law { structure: Structure::Mass, gain: t.gain, offset: t.rest_mm, frequency_rad_s: t.omega, damping: t.zeta, lag_s: 1.0,
        delay_s: t.dead_s, rate_mm_s: t.top_mm_s, friction_v: t.coulomb_v, play_mm: t.gap_mm, start_mm: t.rest_mm + t.gain*excitation(0.0), start_share: 0.0 }
}

/// The exact motion is what tiny steps come to: both err by less than nature's step of 20 us at 45 mm/s.
#[test]
fn motion_is_what_tiny_steps_come_to() {
    for seed in 0..6 {
        let mut truth = Truth::drawn(seed);
        truth.sd_mm = 0.0;
        truth.count_mm = 1e-9;
        let [time, asked, read] = truth.record(&excitation, EXCITED_S, 100.0, 1);
        let begin = std::time::Instant::now();
        let own = follow(&exact(&truth), &time, &asked);
        let spent = begin.elapsed();
        let worst = own.iter().zip(&read).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        println!("{seed} {worst:.2e} {spent:?} {truth:?}");
        assert!(worst < 5e-3, "{seed}: {worst} mm");
    }
}

fn truth_of(t: &Truth, p: Parameter) -> Option<f64> {
    Some(match p {
        Parameter::Gain => t.gain,
        Parameter::Offset => t.rest_mm,
        Parameter::Frequency => t.omega,
        Parameter::Damping => t.zeta,
        Parameter::Delay => t.dead_s,
        Parameter::Rate => t.top_mm_s,
        Parameter::Friction => t.coulomb_v,
        Parameter::Play => t.gap_mm,
        _ => return None,
    })
}

#[test]
#[ignore]
fn coverage() {
    use super::choose::*;
    use super::interval::*;
    use std::collections::BTreeMap;
    let from: u64 = std::env::var("FROM").map_or(0, |t| t.parse().unwrap());
    let to: u64 = std::env::var("TO").map_or(10, |t| t.parse().unwrap());
    let all = std::env::var("ALL").is_ok();
    let mut hit: BTreeMap<String, (u32, u32)> = BTreeMap::new();
    let (mut inside, mut count) = (0, 0);
    for seed in from..to {
        let truth = Truth::drawn(seed);
        let [time_s, command_v, position_mm] = truth.record(&excitation, EXCITED_S, 100.0, seed);
        let record = Record { time_s, command_v, position_mm };
        let begin = std::time::Instant::now();
        let structures: &[Structure] = if all { &Structure::ALL } else { &[Structure::Mass] };
        let (at, tried) = chosen(&record, structures, &|_| {}).unwrap();
        let best = &tried[at];
        let took = begin.elapsed();
        println!("{seed} ratio {:.2} took {took:?}", truth.sd_mm / truth.count_mm);
        for mode in ["wald"] {
            let known = intervals(&record, &best.fitted);
            for k in &known.parameters {
                let Some(t) = truth_of(&truth, k.parameter) else { continue };
                let ok = k.interval95.0 <= t && t <= k.interval95.1;
                let e = hit.entry(format!("{mode:8} {}", k.parameter.name(Structure::Mass))).or_default();
                e.1 += 1;
                e.0 += u32::from(ok);
                let e = hit.entry(format!("{mode:8} all")).or_default();
                e.1 += 1;
                e.0 += u32::from(ok);
            }
        }
        if !best.is_limited() {
            let bound = least_rate(&record, &best.fitted, intervals(&record, &best.fitted).sd_mm);
            println!("   no limit: bound {bound:.3} true {:.3}", truth.top_mm_s);
        }
    }
    let _ = (&mut inside, &mut count);
    for (name, (a, b)) in hit { println!("{name} {a}/{b} {:.3}", f64::from(a) / f64::from(b)); }
}

#[test]
#[ignore]
fn real() {
    use super::push::*;
    for name in ["KDN_3bar", "Circle_1bar"] {
        let text = std::fs::read_to_string(format!("/work/shared/data/linear_actuator_friction/{name}.csv")).unwrap();
        let mut p = Pushed::default();
        let mut b = Vec::new();
        let mut last = -1.0;
        for line in text.lines().skip(1) {
            let v: Vec<f64> = line.split(',').map(|c| c.parse().unwrap()).collect();
            if v[0] <= last { continue }
            last = v[0];
            p.time_s.push(v[0]); p.position_mm.push(v[1]); p.force_n.push(v[3]); b.push(v[2]);
        }
        for beside in [None, Some(b.clone())] {
            p.beside = beside;
            let begin = std::time::Instant::now();
            let f = push(&p).unwrap();
            println!("{name} {:?}", begin.elapsed());
            for (part, v, i) in &f.parts { println!("  {} {v:.4} {i:.4?}", part.name()); }
            println!("  turning {:?} run in {:?} R2 {:.5} sd {:.3} count {:.3} white {:?} corr {:?} alone {:?}", f.turning_mm, f.run_in_mm, f.explained, f.sd_n, f.count_n, f.whiteness, f.beside_correlation, f.friction_alone_n);
            println!("  acf {:.2?}", super::noise::autocorrelation(&f.residual_n, 10));
        }
    }
}
