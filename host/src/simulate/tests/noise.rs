use super::*;

fn ramps(replicates: usize) -> Spec {
    let mut spec = press();
    spec.runs[0] = RunTemplate { replicates, ..RunTemplate::ramp("foam", "r4", 2.0, 4.0) };
    spec
}

fn deviation(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (values.len() - 1) as f64).sqrt()
}

/// The sample deviation of 200 draws scatters by 5 %.
#[test]
fn spots_differ_by_jitter_of_the_asked_size() {
    let mut spec = ramps(200);
    spec.noise.contact_jitter_mm = 0.02;
    let clean = &made(&ramps(1)).runs[0];
    let (low, high) = (clean.exact_n[20], clean.exact_n[22]);
    let slope = (high - low) / (clean.depth_mm[22] - clean.depth_mm[20]);
    let shifts: Vec<f64> = made(&spec).runs.iter().map(|run| (run.exact_n[21] - clean.exact_n[21]) / slope).collect();
    assert!((deviation(&shifts) / 0.02 - 1.0).abs() < 0.2, "{}", deviation(&shifts));
    spec.noise.contact_jitter_mm = 0.0;
    spec.noise.gain_jitter = 0.01;
    let gains: Vec<f64> = made(&spec).runs.iter().map(|run| run.exact_n[25] / clean.exact_n[25]).collect();
    assert!((deviation(&gains) / 0.01 - 1.0).abs() < 0.2, "{}", deviation(&gains));
}

#[test]
fn the_sensor_s_noise_is_as_large_as_asked_and_readings_are_steps() {
    let mut spec = ramps(20);
    spec.noise.sensor_n = 0.01;
    spec.noise.quantum_n = 0.002;
    let made = made(&spec);
    let misses: Vec<f64> =
        made.runs.iter().flat_map(|r| r.force_n.iter().zip(&r.exact_n).map(|(a, b)| a - b)).collect();
    // 520 samples scatter by 3 %
    assert!((deviation(&misses) / 0.01 - 1.0).abs() < 0.15, "{}", deviation(&misses));
    let steps = made.runs.iter().flat_map(|run| &run.force_n).map(|f| f / 0.002);
    assert!(steps.into_iter().all(|s| (s - s.round()).abs() < 1e-4));
}

#[test]
fn cycles_of_a_spot_share_its_jitter_and_its_place_in_the_session() {
    let mut spec = press();
    (spec.runs[0].cycles, spec.runs[0].replicates, spec.runs[0].rest_s) = (3, 4, 7.0);
    spec.session.random_order = true;
    spec.noise.contact_jitter_mm = 0.02;
    let made = made(&spec);
    let orders: Vec<(i64, i64)> = made.runs.iter().map(|run| (run.spot.unwrap(), run.cycle.unwrap())).collect();
    for three in made.runs.chunks(3) {
        assert!(three.iter().all(|run| run.spot == three[0].spot && run.exact_n == three[0].exact_n));
        // the press lasts 5 s
        assert!((three[1].start_s - three[0].start_s - 12.0).abs() < 1e-6);
    }
    let spots: Vec<i64> = orders.iter().step_by(3).map(|(spot, _)| *spot).collect();
    assert!(spots != [1, 2, 3, 4] && orders.iter().map(|(_, cycle)| *cycle).take(3).eq([1, 2, 3]), "{orders:?}");
}

/// The logarithm of what 200 spots lose in a hold scatters by 0.1, known to 5 %; a spot that differs in nothing else loses nothing where nothing relaxes.
#[test]
fn places_relax_more_and_less() {
    let mut spec = press();
    (spec.runs[0].unload, spec.runs[0].replicates) = (false, 200);
    spec.noise.memory_jitter = 0.1;
    let elastic = made(&spec).runs;
    assert!(elastic.iter().all(|run| run.exact_n == elastic[0].exact_n));
    let relaxing = made(&spec.with(Effect::Relaxation(vec![PronyTerm::alike(0.2, 1.0)]))).runs;
    let last = elastic[0].exact_n.len() - 1;
    let lost: Vec<f64> = relaxing.iter().map(|run| (1.0 - run.exact_n[last] / elastic[0].exact_n[last]).ln()).collect();
    assert!((deviation(&lost) / 0.1 - 1.0).abs() < 0.2, "{}", deviation(&lost));
}
