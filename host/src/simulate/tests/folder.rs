use super::*;
use crate::experiment;

fn noisy() -> Spec {
    let mut spec = press().foam("block \"b\"", 0.1, 8.0, 12.7).with(Effect::SensorCreep { amplitude: 0.1, tau_s: 1.0 });
    (spec.runs[0].cycles, spec.runs[0].replicates, spec.runs[0].rest_s) = (2, 2, 7.0);
    let second = RunTemplate { hold_out: true, ..RunTemplate::ramp("block \"b\"", "r4", 1.0, 1.0) };
    let air =
        RunTemplate { test: experiment::Test::Air, specimen: None, indenter: None, hold_s: 2.0, ..second.clone() };
    let mass = RunTemplate { test: experiment::Test::Mass, load_n: 1.5, ..air.clone() };
    spec.runs.extend([second, air, mass]);
    spec.session.random_order = true;
    spec.noise = Noise {
        sensor_n: 0.01,
        correlation_s: 0.1,
        contact_jitter_mm: 0.02,
        gain_jitter: 0.01,
        memory_jitter: 0.1,
        quantum_n: 0.001,
        drift_n_per_h: 0.02,
        heavy_tails: true,
        proportional: 0.01,
    };
    spec.state_noise = true;
    spec
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_one_other_data() {
    let text = |spec: &Spec, solver: &Solver| {
        let made = simulate(spec, solver, &|_, _, _| {}).unwrap();
        let files: Vec<String> = made.runs.iter().map(SimulatedRun::csv).collect();
        (made.description(), files)
    };
    let first = text(&noisy(), &SOLVER);
    assert_eq!(first, text(&noisy(), &Solver::new()));
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(first, one.install(|| text(&noisy(), &Solver::new())));
    let mut other = noisy();
    other.seed = 8;
    assert_ne!(first.1, text(&other, &SOLVER).1);
}

#[test]
fn an_experiment_that_simulate_did_not_write_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    let made = made(&noisy());
    let file = folder.path().join("experiment.toml");
    std::fs::write(&file, "name = \"a month of work\"\n").unwrap();
    let told = made.write(folder.path()).unwrap_err().to_string();
    assert!(told.starts_with(&format!("{} exists", file.display())) && told.contains("--out"), "{told}");
    assert_eq!(std::fs::read_to_string(&file).unwrap(), "name = \"a month of work\"\n");
    // Nothing else was written either.
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    std::fs::remove_file(&file).unwrap();
    made.write(folder.path()).unwrap();
    made.write(folder.path()).unwrap();
}

#[test]
fn a_written_folder_reads_back_to_the_same_experiment() {
    let folder = tempfile::tempdir().unwrap();
    let mut spec = noisy();
    // Single readings of long tails are left out where a folder is read.
    spec.noise.heavy_tails = false;
    let made = made(&spec);
    made.write(folder.path()).unwrap();
    let read = experiment::read(folder.path()).unwrap_or_else(|error| panic!("{error}"));
    let memory = made.experiment_in(folder.path());
    assert_eq!((&read.name, &read.specimens, &read.indenters), (&memory.name, &memory.specimens, &memory.indenters));
    assert_eq!((&read.sensor, &read.folder, read.runs.len()), (&memory.sensor, &memory.folder, memory.runs.len()));
    for (a, b) in read.runs.iter().zip(&memory.runs) {
        let labels = |r: &experiment::Run| {
            (
                r.file.clone(),
                r.path.clone(),
                r.specimen,
                r.indenter,
                r.test,
                (r.spot, r.place_mm),
                r.cycle,
                r.order,
                r.start_s,
                r.hold_out,
            )
        };
        assert_eq!(labels(a), labels(b));
        assert_eq!(a.recording.time_s, b.recording.time_s);
        assert_eq!(a.recording.depth_mm, b.recording.depth_mm);
        assert_eq!(a.recording.force_n, b.recording.force_n);
        assert_eq!((&a.recording.line, &a.recording.others), (&b.recording.line, &b.recording.others));
    }
    for file in std::fs::read_dir(folder.path()).unwrap() {
        let text = std::fs::read_to_string(file.unwrap().path()).unwrap();
        assert!(!text.contains("creep") && !text.contains("effect"), "{text}");
    }
    assert!(made.truth_toml().contains("code = \"sensor-creep\"\namplitude = 0.1\ntau_s = 1.0\n"));
}

#[test]
fn a_mass_and_the_air_are_measured_through_the_sensor() {
    let mut spec = noisy();
    spec.noise = Noise::default();
    let made = made(&spec);
    let of = |test| made.runs.iter().find(|run| run.test == test).unwrap();
    assert!(of(experiment::Test::Air).exact_n.iter().all(|f| f.abs() < 0.2));
    let mass = of(experiment::Test::Mass);
    assert!(mass.exact_n[0] >= 1.5 && mass.exact_n[100] > mass.exact_n[0] && mass.exact_n[100] < 1.66);
    assert!(mass.depth_mm.is_empty() && mass.time_s.len() == 101);
}

#[test]
fn what_cannot_be_is_named() {
    let fails = |change: &dyn Fn(&mut Spec)| {
        let mut spec = press();
        change(&mut spec);
        simulate(&spec, &SOLVER, &|_, _, _| {}).unwrap_err().to_string()
    };
    assert_eq!(
        fails(&|s| s.runs[0].specimen = Some("eva".to_owned())),
        "[[run]] 1: there is no specimen \"eva\"; known: foam"
    );
    assert_eq!(
        fails(&|s| s.runs[0].depth_mm = 12.0),
        "specimen \"foam\" under ball \"r4\": depth_mm with offset and jitter = 12.05; expected at most 11.43 mm, 90 % of the true height"
    );
    assert_eq!(fails(&|s| s.runs.clear()), "there is no [[run]]; expected at least one");
    assert_eq!(
        fails(&|s| s.noise.sensor_n = f64::NAN),
        "[noise]: sensor_N = NaN; expected a standard deviation of 0 N or more"
    );
    assert_eq!(
        fails(&|s| s.effects.push(Effect::Thickness { height_error_mm: -20.0 })),
        "specimen \"foam\" under ball \"r4\": true height_mm = -7.300000000000001; expected a length above 0.05 mm after the effect's error"
    );
    let error = fails(&|s| s.effects.push(Effect::Relaxation(vec![PronyTerm::alike(1.5, 1.0)])));
    assert!(error.starts_with("specimen \"foam\" under ball \"r4\": "), "{error}");
}
