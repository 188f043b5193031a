use super::*;
use std::path::Path;

fn spec(text: &str) -> Result<Spec, String> {
    parse(Path::new("spec.toml"), text).map_err(|error| error.to_string())
}

const WHOLE: &str = "[specimen.eva]\nmu_MPa = 0.2\nalpha = 8\nheight_mm = 12.7\n[indenter.r4]\nradius_mm = 4\n\
                     [[run]]\nspecimen = \"eva\"\nindenter = \"r4\"\nrate_mm_s = 1\ndepth_mm = 3\n";

#[test]
fn the_example_is_a_specification() {
    let spec = spec(EXAMPLE).unwrap();
    assert_eq!((spec.runs.len(), spec.indenters.len(), spec.effects.len()), (2, 2, 1));
    assert_eq!(spec.effects[0], Effect::Relaxation(vec![PronyTerm::alike(0.2, 1.0)]));
    assert_eq!((spec.runs[0].cycles, spec.runs[0].replicates, spec.runs[1].rest_s), (3, 2, 30.0));
}

#[test]
fn the_documentation_shows_a_specification_and_names_every_effect() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/simulate.md");
    let text = std::fs::read_to_string(docs).unwrap();
    let example = text.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let spec = spec(example).unwrap();
    assert_eq!((spec.runs.len(), spec.effects.len(), spec.noise.contact_jitter_mm), (2, 1, 0.02));
    let error = self::spec(&format!("{WHOLE}[[effect]]\ncode = \"?\"\n")).unwrap_err();
    let codes: Vec<&str> =
        error.split("one of ").nth(1).unwrap().split(", ").map(|code| code.trim_matches('"')).collect();
    assert_eq!(codes.len(), 27);
    assert!(codes.iter().all(|code| text.contains(&format!("| `{code}` |"))), "{codes:?}");
}

#[test]
fn what_is_left_out_has_defaults() {
    let spec = spec(WHOLE).unwrap();
    assert_eq!((spec.name.as_str(), spec.seed, spec.sample_hz, spec.refinement), ("spec", 1, 50.0, FINER));
    assert_eq!((spec.noise, spec.session, spec.effects.len()), (Noise::default(), Session::default(), 0));
    let run = &spec.runs[0];
    assert_eq!((run.hold_s, run.unload, run.cycles, run.replicates, run.hold_out), (0.0, false, 1, 1, false));
}

/// Every effect is written as it is read.
#[test]
fn effects_survive_a_file() {
    let effects = [
        Effect::Relaxation(vec![PronyTerm::alike(0.2, 1.0), PronyTerm::alike(0.1, 10.0)]),
        Effect::Relaxation(vec![PronyTerm { g: 0.822, k: 0.003, tau_s: 0.999 }]),
        Effect::Poisson { nu: 0.1 },
        Effect::SecondTerm { mu2_ratio: 0.3, alpha2: -2.0 },
        Effect::Softening { r: 2.0, m_mpa: 0.01, beta: 0.1 },
        Effect::Thickness { height_error_mm: -1.0 },
        Effect::SlidingBase,
        Effect::Friction { coefficient: 0.3 },
        Effect::Adhesion { work_n_per_mm: 1e-3, range_mm: 0.05 },
        Effect::ContactOffset { offset_mm: 0.05 },
        Effect::DepthGain { gain: 1.02 },
        Effect::TimeGain { gain: 0.99 },
        Effect::Compliance { mm_per_n: 0.02 },
        Effect::Radius { indenter: "r4".to_owned(), error_mm: 0.1 },
        Effect::Lag { lag_s: 0.05 },
        Effect::RateLimit { rate_mm_s: 4.0 },
        Effect::SensorGain { gain: 1.05 },
        Effect::SensorNonlinearity { quadratic_per_n: 0.01 },
        Effect::SensorCreep { amplitude: 0.1, tau_s: 2.0 },
        Effect::SensorHysteresis { width: 0.02 },
        Effect::Drift { n_per_h: 0.1, thermal_n: 0.02, thermal_s: 300.0 },
        Effect::Numerics { mesh: Some(0.5), alpha_step: Some(4.0) },
        Effect::PowerLaw { amplitude: 0.4, t0_s: 0.1, beta: 0.3 },
        Effect::PlasticSet { share: 0.05 },
        Effect::StiffSkin { stiffness_n_per_mm2: 0.1 },
        Effect::Anisotropic { depth_power: 0.1, radius_power: -0.1 },
        Effect::Tilt { angle_deg: 5.0, distance_mm: 8.0 },
        Effect::Hum { amplitude_n: 0.01, frequency_hz: 49.7 },
        Effect::StickSlip { amplitude_n: 0.02, period_mm: 0.3 },
        Effect::Rest(Rest {
            along: Along::Depth,
            by: Some(Along::Spot),
            kernel: Kernel::Matern32,
            length: 0.3,
            amplitude: 0.01,
            of: ShareOf::Peak,
            draw: 3,
        }),
        Effect::Rest(Rest {
            along: Along::Time,
            by: None,
            kernel: Kernel::SquaredExponential,
            length: 2.0,
            amplitude: 0.0,
            of: ShareOf::Force,
            draw: 0,
        }),
        Effect::Placebo { variable: Variable::Cycle, amplitude: 0.03 },
    ];
    for effect in effects {
        let text = format!("{WHOLE}{}", effect.to_toml());
        assert_eq!(spec(&text).unwrap().effects, [effect]);
    }
}

#[test]
fn mistakes_are_named_with_key_value_and_expectation() {
    let cases = [
        (
            "",
            "spec.toml, line 1, column 1: the file lacks the key `run` (at least one [[run]] with specimen, indenter, rate_mm_s and depth_mm)",
        ),
        (
            &WHOLE.replace("mu_MPa = 0.2", "mu_MPa = -0.2"),
            "spec.toml, line 2, column 10: `mu_MPa` is -0.2; expected a shear modulus of 0.000001 to 10000 MPa",
        ),
        (
            &WHOLE.replace("\nindenter = \"r4\"", "\nindenter = \"r5\""),
            "spec.toml, line 9, column 12: `indenter` names \"r5\", which is not described; known: r4",
        ),
        (
            &WHOLE.replace("depth_mm = 3\n", ""),
            "spec.toml, line 7, column 1: [[run]] lacks the key `depth_mm` (a depth of 0.01 to 1000 mm)",
        ),
        (
            &format!("{WHOLE}[[effect]]\ncode = \"relaxation\"\ng1 = 0.2\ntau_s = 1.0\n"),
            "spec.toml, line 15, column 1: unknown key `tau_s` in [[effect]]; did you mean `tau1_s`?",
        ),
        (
            &format!("{WHOLE}[[effect]]\ncode = \"relaxation\"\ng1 = 0.7\ntau1_s = 1.0\ng2 = 0.4\n"),
            "spec.toml, line 12, column 1: the parts g1 and g2 add up to 1.1; expected less than 1",
        ),
        (
            &format!(
                "{WHOLE}[[effect]]\ncode = \"relaxation\"\ng1 = 0.1\nk1 = 0.7\ntau1_s = 1.0\ng2 = 0.1\nk2 = 0.4\n"
            ),
            "spec.toml, line 12, column 1: the parts k1 and k2 add up to 1.1; expected less than 1",
        ),
        (
            &format!("{WHOLE}[[effect]]\ncode = \"relaxation\"\ng1 = 0.2\nk1 = 1.5\ntau1_s = 1.0\n"),
            "spec.toml, line 15, column 6: `k1` is 1.5; expected a part of 0 to 0.95",
        ),
        (
            &format!("{WHOLE}[[effect]]\ncode = \"lag\"\n"),
            "spec.toml, line 12, column 1: [[effect]] has `lag_s` or `rate_limit_mm_s`; expected one of the two",
        ),
        (
            &format!("{WHOLE}[[effect]]\ncode = \"radius\"\nindenter = \"r9\"\nerror_mm = 0.1\n"),
            "spec.toml, line 14, column 12: `indenter` names \"r9\", which is not described; known: r4",
        ),
        (
            &format!("{WHOLE}[[effect]]\ncode = \"outside-rest\"\namplitude = 0.01\n"),
            "spec.toml, line 12, column 1: [[effect]] lacks the key `along` (such as \"depth\" or \"time\")",
        ),
        (
            &format!(
                "{WHOLE}[[effect]]\ncode = \"outside-rest\"\nalong = \"depth\"\nby = \"depth\"\namplitude = 0.01\n"
            ),
            "spec.toml, line 15, column 6: `by` is \"depth\"; expected another variable than that of `along`",
        ),
        (
            &format!("{WHOLE}[[effect]]\ncode = \"outside-rest\"\nalong = \"time\"\namplitude = 2\n"),
            "spec.toml, line 15, column 13: `amplitude` is 2; expected a share of the force, 0 to 1",
        ),
        (
            &format!("{WHOLE}[[effect]]\ncode = \"outside-rest\"\nalong = \"time\"\namplitude = 0.1\ndraw = 1.5\n"),
            "spec.toml, line 16, column 8: `draw` is 1.5; expected a whole number of 0 to 1000000",
        ),
        (
            &WHOLE.replace("specimen = \"eva\"", "test = \"confined\"\nspecimen = \"eva\""),
            "spec.toml, line 10, column 12: a coupon is compressed as a whole; `indenter` belongs to test = \"indentation\"",
        ),
        (
            "[specimen.block]\nlaw = \"rigid\"\nheight_mm = 10\n[[run]]\ntest = \"uniaxial\"\nspecimen = \"block\"\nrate_mm_s = 1\ndepth_mm = 1\n",
            "spec.toml, line 6, column 12: a rigid block cannot be compressed as a coupon; expected a specimen that is soft",
        ),
        (
            &WHOLE.replace("height_mm = 12.7", "height_mm = 12.7\nradius_mm = 9\narea_mm2 = 300"),
            "spec.toml, line 6, column 12: `area_mm2` and `radius_mm` say the same; state one of them",
        ),
        (
            &WHOLE.replace("height_mm = 12.7", "height_mm = 12.7\nthermal_strain = 5.0"),
            "spec.toml, line 5, column 18: `thermal_strain` is 5.0; expected a linear strain of -0.3 to 0.3",
        ),
        (
            &WHOLE.replace("mu_MPa = 0.2", "law = \"rigid\"\nthermal_strain = 0.01"),
            "spec.toml, line 3, column 18: a rigid block does not grow; `thermal_strain` belongs to a specimen that is soft",
        ),
        (
            &format!("{WHOLE}[noise]\nsensor_N = \"much\"\n"),
            "spec.toml, line 13, column 12: `sensor_N` is \"much\"; expected a standard deviation of 0 N or more",
        ),
        (
            &format!("{WHOLE}[session]\norder = \"shuffled\"\n"),
            "spec.toml, line 13, column 9: `order` is \"shuffled\"; expected one of \"random\", \"as-written\"",
        ),
    ];
    for (text, expected) in cases {
        assert_eq!(spec(text).unwrap_err(), expected);
    }
    let error = spec(&format!("{WHOLE}[[effect]]\ncode = \"creep\"\n")).unwrap_err();
    assert!(error.contains("`code` is \"creep\"; expected one of \"thickness\", \"relaxation\""), "{error}");
}
