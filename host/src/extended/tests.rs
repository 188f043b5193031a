#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;

use lut_gen::effect::{CATALOGUE, Owner, Spread};
use lut_gen::solid::law::PronyTerm;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;

use super::*;

fn parsed(text: &str) -> Result<ExtendedModel, String> {
    ExtendedModel::parse(Path::new("out/model.toml"), text).map_err(|e| e.to_string())
}

/// A model with a random subset of the catalogue, values all over their bounds, names that need quotes.
fn random(seed: u64) -> ExtendedModel {
    let mut chance = Pcg64::seed_from_u64(seed);
    let names = ["r4", "r 4.5 \"new\"", "kugel-ä\\", "a.b"];
    let mut name = || names[chance.random_range(0..names.len())].to_owned();
    let (ball, block, material) = (name(), name(), name());
    let mut model =
        ExtendedModel::base(&material, 10_f64.powf(chance.random_range(-5.0..3.0)), chance.random_range(1.0..30.0));
    model.intervals = [Some((0.1, 0.1 + chance.random::<f64>())), None];
    model.indenters.push(DeclaredBall { name: ball.clone(), radius_mm: chance.random_range(0.05..50.0) });
    model.specimens.push(DeclaredSpecimen {
        name: block.clone(),
        height_mm: chance.random_range(0.05..50.0),
        radius_mm: chance.random::<bool>().then_some(25.0),
        base: if chance.random() { Base::Bonded } else { Base::Sliding },
    });
    for effect in CATALOGUE {
        let twice = model.effects.iter().any(|a| a.effect.code == effect.code) && effect.code != "thickness";
        if twice || chance.random::<f64>() < 0.5 {
            continue;
        }
        let value = |q: &lut_gen::effect::Quantity, x: f64| match q.spread {
            // half of the range, so that two parts of a relaxation stay below 1
            Spread::Even => q.low + 0.5 * x * (q.high - q.low),
            Spread::Logarithmic => q.low * (q.high / q.low).powf(x),
        };
        let values: Vec<f64> = effect.quantities.iter().map(|q| value(q, chance.random())).collect();
        let intervals =
            values.iter().map(|v| chance.random::<bool>().then(|| (v - chance.random::<f64>(), *v))).collect();
        let owner = match effect.owner {
            Owner::All => None,
            Owner::Indenter => Some(ball.clone()),
            Owner::Specimen => Some(block.clone()),
        };
        let twins = if chance.random() { vec!["lag".to_owned(), "drift".to_owned()] } else { Vec::new() };
        model.effects.push(Added { effect, owner, values, intervals, ambiguous_with: twins });
    }
    model
}

/// What is written is read back to the bit, whatever is in it.
#[test]
fn what_is_written_is_read_back() {
    let mut effects = 0;
    for seed in 0..300 {
        let model = random(seed);
        effects += model.effects.len();
        let text = model.to_toml();
        assert_eq!(parsed(&text).unwrap(), model, "{text}");
    }
    assert!(effects > 1000, "the random models hold effects: {effects}");
}

const HEAD: &str = "material = \"eva\"\nlaw = \"hyperfoam\"\nmu_MPa = 0.1\nalpha = 8\n[indenter.r4]\nradius_mm = 4\n";

#[test]
fn mistakes_are_named_with_their_place() {
    let said = |text: &str| parsed(text).unwrap_err();
    let with = |effect: &str| parsed(&format!("{HEAD}[[effect]]\n{effect}")).unwrap_err();
    assert_eq!(
        said("material = \"eva\"\nlaw = \"hyperfoam\"\nalpha = 8"),
        "out/model.toml, line 1, column 1: the file lacks the key `mu_MPa` (a shear modulus of 0.000001 to 10000 MPa)"
    );
    assert_eq!(
        said("material = \"eva\"\nlaw = \"hyperfoam\"\nmu_MPa = -2\nalpha = 8"),
        "out/model.toml, line 3, column 10: `mu_MPa` is -2; expected a shear modulus of 0.000001 to 10000 MPa"
    );
    assert_eq!(
        said("material = \"eva\"\nlaw = \"ogden\""),
        "out/model.toml, line 2, column 7: `law` is \"ogden\"; expected one of \"hyperfoam\""
    );
    assert_eq!(
        with("code = \"relaxation\"\ng1 = 2.0\ntau1_s = 1.0"),
        "out/model.toml, line 9, column 6: `g1` is 2.0; expected a number from 0 to 0.9"
    );
    assert_eq!(
        with("code = \"relaxation\"\ng1 = 0.2"),
        "out/model.toml, line 7, column 1: [[effect]] lacks the key `tau1_s` (a number from 0.01 to 500)"
    );
    assert_eq!(
        with("code = \"drift\"\nN_per_h = 0.1\nper_day = 3"),
        "out/model.toml, line 10, column 1: unknown key `per_day` in [[effect]]; known keys: code, form, stage, \
         interval95, ambiguous_with, N_per_h"
    );
    assert_eq!(
        with("code = \"radius\"\nindenter = \"r5\"\nerror_mm = 0.1"),
        "out/model.toml, line 9, column 12: `indenter` names \"r5\", which is not described; known: r4"
    );
    let unknown = with("code = \"magic\"");
    let start = "out/model.toml, line 8, column 8: `code` is \"magic\"; expected one of \"thickness\", \"poisson\"";
    assert!(unknown.starts_with(start), "{unknown}");
    assert_eq!(
        with("code = \"lag\"\nform = \"spring\"\nlag_s = 0.1"),
        "out/model.toml, line 9, column 8: `form` is \"spring\"; expected one of \"filter\", \"rate-limit\""
    );
    assert_eq!(
        with("code = \"drift\"\nstage = \"sensor\"\nN_per_h = 0.1"),
        "out/model.toml, line 9, column 9: `stage` is \"sensor\"; expected one of \"clock\""
    );
    assert_eq!(
        with("code = \"drift\"\nN_per_h = 0.1\ninterval95 = { N_per_h = [0.2, 0.1] }"),
        "out/model.toml, line 10, column 26: `N_per_h` is an array; expected two numbers, the lower first"
    );
    assert_eq!(
        with("code = \"drift\"\nN_per_h = 0.1\n[[effect]]\ncode = \"drift\"\nN_per_h = 0.2"),
        "out/model.toml, line 10, column 1: [[effect]] drift is there twice; expected each effect once"
    );
    assert_eq!(
        with("code = \"relaxation\"\nform = \"two-term\"\ng1 = 0.6\ntau1_s = 1\ng2 = 0.6\ntau2_s = 9"),
        "out/model.toml, line 7, column 1: g1 and g2 of relaxation sum to 1.2; expected less than 1"
    );
    assert!(said("law = ").starts_with("out/model.toml, line 1, column 7: not valid TOML"), "{}", said("law = "));
}

fn added(code: &str, form: &str, owner: Option<&str>, values: &[f64]) -> Added {
    Added {
        effect: lut_gen::effect::find(code, Some(form)).unwrap(),
        owner: owner.map(str::to_owned),
        values: values.to_vec(),
        intervals: vec![None; values.len()],
        ambiguous_with: Vec::new(),
    }
}

fn model(effects: Vec<Added>) -> ExtendedModel {
    let mut model = ExtendedModel::base("eva", 0.22, 10.5);
    model.indenters.push(DeclaredBall { name: "r4".to_owned(), radius_mm: 4.0 });
    let name = "eva".to_owned();
    model.specimens.push(DeclaredSpecimen { name, height_mm: 12.7, radius_mm: Some(25.0), base: Base::Bonded });
    model.effects = effects;
    model
}

mod board {
    use lut_gen::solid::contact::Ball;
    use lut_gen::solid::model::Specimen;
    use lut_gen::solid::solve::Base as Bottom;
    use lut_gen::table::{GridSpec, SecondTerm, UsedSpot};

    use super::*;

    fn grid(height_mm: f64, ball_mm: f64) -> GridSpec {
        GridSpec::thesis(Specimen::of_height(height_mm), Ball { radius_mm: ball_mm })
    }

    /// The whole catalogue at once: what a board meets is in the grid, the rest is named with its reason.
    #[test]
    fn a_table_has_what_the_board_meets_and_nothing_of_the_rig() {
        let model = model(vec![
            added("thickness", "height", Some("eva"), &[-1.5]),
            added("thickness", "sliding-base", Some("eva"), &[0.9]),
            added("relaxation", "two-term", None, &[0.2, 0.3, 0.1, 5.0]),
            added("poisson", "ratio", None, &[0.1]),
            added("second-term", "superposed", None, &[0.3, 4.0]),
            added("softening", "ogden-roxburgh", None, &[0.25, 0.4]),
            added("friction", "coulomb", None, &[0.2]),
            added("adhesion", "dmt", None, &[1e-3]),
            added("contact-offset", "constant", None, &[0.05]),
            added("compliance", "linear", None, &[0.02]),
            added("radius", "one-ball", Some("r4"), &[0.1]),
            added("lag", "filter", None, &[0.03]),
            added("sensor-gain", "constant", None, &[1.1]),
            added("drift", "linear", None, &[0.1]),
            added("numerics", "smooth", None, &[0.001]),
        ]);
        let own = model.on_board(&grid(12.7, 4.0), 1).unwrap();
        assert_eq!((own.spec.specimen.height_mm, own.spec.specimen.base), (11.2, Bottom::Sliding));
        let parts: Vec<(f64, f64, f64)> = own.spec.relaxation.iter().map(|t| (t.g, t.k, t.tau_s)).collect();
        assert_eq!(parts, [(0.2, 0.2, 0.3), (0.1, 0.1, 5.0)]);
        assert_eq!((own.spec.nu, own.spec.friction, own.spec.ball.radius_mm), (0.1, 0.2, 4.1));
        assert_eq!(own.spec.second, Some(SecondTerm { mu_ratio: 0.3, alpha: 4.0 }));
        assert_eq!(own.spec.used, None, "a fresh spot");
        assert_eq!((own.kept.len(), own.left_out.len()), (7, 8));
        let rig = "it belongs to the rig that recorded the experiment, not to the board";
        assert!(own.left_out.contains(&format!("compliance (linear): mm_per_N 0.02: {rig}")), "{:?}", own.left_out);
        // the second press of a spot; another specimen and another ball
        let other = model.on_board(&grid(25.4, 6.0), 2).unwrap();
        assert_eq!(other.spec.used, Some(UsedSpot { loss: 0.25, scale: 0.4 }));
        assert_eq!((other.spec.specimen.height_mm, other.spec.ball.radius_mm), (25.4, 6.0));
        assert!(other.left_out.iter().any(|s| s.ends_with("the board's ball is another one")), "{:?}", other.left_out);
        // heights that are all wrong by the same are so on every specimen of the model, and on no other
        let all = super::model(vec![added("thickness", "every-height", None, &[-1.5])]);
        let height_mm = |declared_mm: f64| all.on_board(&grid(declared_mm, 4.0), 1).unwrap().spec.specimen.height_mm;
        assert_eq!((height_mm(12.7), height_mm(25.4)), (11.2, 25.4));
        let codes: Vec<&str> = model.rig().iter().map(|s| s.effect.code).collect();
        assert_eq!(codes, ["contact-offset", "compliance", "lag", "sensor-gain", "drift"]);
    }

    #[test]
    fn what_is_given_twice_is_refused() {
        let model = model(vec![added("friction", "coulomb", None, &[0.2])]);
        let twice = model.on_board(&GridSpec { friction: 0.1, ..grid(12.7, 4.0) }, 1).unwrap_err().to_string();
        assert_eq!(twice, "friction is in the model and given by --friction; expected it in one of them");
        let thin = super::model(vec![added("thickness", "height", Some("eva"), &[-4.0])]);
        let mut thin = thin;
        thin.specimens[0].height_mm = 4.2;
        let said = thin.on_board(&grid(4.2, 4.0), 1).unwrap_err().to_string();
        assert!(said.starts_with("the height is 0.2") && said.ends_with("expected 0.5 to 200 mm"), "{said}");
    }
}

mod truth {
    use crate::simulate::{Effect, Spec, parse};

    use super::*;

    fn spec() -> Spec {
        Spec::new("s", 1).foam("eva", 0.1, 8.0, 12.7).ball("r4", 4.0)
    }

    /// One catalogue entry after the other becomes the effect of the same code.
    #[test]
    fn every_effect_that_can_be_true_is() {
        for effect in CATALOGUE {
            let values: Vec<f64> = effect.quantities.iter().map(|q| q.plausible).collect();
            let owner = match effect.owner {
                Owner::All => None,
                Owner::Indenter => Some("r4"),
                Owner::Specimen => Some("eva"),
            };
            let mut spec = spec();
            let made =
                super::super::truth::apply(&model(vec![added(effect.code, effect.form, owner, &values)]), &mut spec);
            assert_eq!((spec.specimens[0].mu_mpa, spec.specimens[0].alpha), (0.22, 10.5));
            match (effect.code, effect.form) {
                ("numerics", _) => assert_eq!((made.unwrap().len(), spec.effects.len()), (1, 0)),
                _ => assert_eq!((made.unwrap().len(), spec.effects[0].code()), (0, effect.code)),
            }
        }
        let mut spec = spec();
        let softening = added("softening", "ogden-roxburgh", None, &[0.25, 0.4]);
        super::super::truth::apply(&model(vec![softening]), &mut spec).unwrap();
        // the law of the points that the diagnosis solved
        let (r, m, beta) = lut_gen::effect::softening::of_points(0.25, 0.4);
        assert_eq!(spec.effects, [Effect::Softening { r, m_mpa: m * 0.22, beta }]);
        assert!(r == 4.0 && (0.005..0.0325).contains(&m), "{r} {m}");
    }

    #[test]
    fn a_base_is_free_or_bonded() {
        for (share, effects) in [(0.3, 0), (0.7, 1)] {
            let mut spec = spec();
            let base = added("thickness", "sliding-base", Some("eva"), &[share]);
            let said = super::super::truth::apply(&model(vec![base]), &mut spec).unwrap();
            assert_eq!((said.len(), spec.effects.len()), (1, effects));
        }
    }

    #[test]
    fn what_does_not_go_together_is_refused() {
        let refused = |model: &ExtendedModel, mut spec: Spec| {
            super::super::truth::apply(model, &mut spec).unwrap_err().to_string()
        };
        let radius = model(vec![added("radius", "one-ball", Some("r6"), &[0.1])]);
        assert_eq!(
            refused(&radius, spec()),
            "the model's radius belongs to indenter \"r6\", which is not described; known: r4"
        );
        let twice = spec().with(Effect::Friction { coefficient: 0.1 });
        let friction = model(vec![added("friction", "coulomb", None, &[0.2])]);
        assert_eq!(
            refused(&friction, twice),
            "friction is in the specification and in the model; expected it in one of them"
        );
        assert_eq!(
            refused(&friction, Spec::new("s", 1)),
            "a model is given, but no specimen of the specification is of law \"hyperfoam\""
        );
        let height = model(vec![added("thickness", "height", Some("eva"), &[1.0])]);
        let said = refused(&height, spec().foam("other", 0.1, 5.0, 20.0));
        assert!(said.ends_with("this one has several specimens"), "{said}");
    }

    /// A specification that names a model file needs no parameters of its own.
    #[test]
    fn a_specification_may_name_a_model_file() {
        let folder = tempfile::tempdir().unwrap();
        let text = model(vec![added("relaxation", "one-term", None, &[0.3, 1.0])]).to_toml();
        std::fs::write(folder.path().join("model.toml"), text).unwrap();
        let spec = |head: &str| {
            let text = format!(
                "{head}[specimen.eva]\nheight_mm = 12.7\n[indenter.r4]\nradius_mm = 4\n\
                 [[run]]\nspecimen = \"eva\"\nindenter = \"r4\"\nrate_mm_s = 1\ndepth_mm = 2\n"
            );
            parse(&folder.path().join("spec.toml"), &text)
        };
        let made = spec("[model]\nfile = \"model.toml\"\n").unwrap();
        assert_eq!((made.specimens[0].mu_mpa, made.specimens[0].alpha), (0.22, 10.5));
        assert_eq!(made.effects, [Effect::Relaxation(vec![PronyTerm::alike(0.3, 1.0)])]);
        let missing = spec("").unwrap_err().to_string();
        assert!(missing.contains("[specimen.eva] lacks the key `alpha`"), "{missing}");
        let nowhere = spec("[model]\nfile = \"none.toml\"\n").unwrap_err().to_string();
        assert!(nowhere.contains("none.toml: no such file"), "{nowhere}");
    }
}
