//! Sweeps over a closed-form stand-in for the finite elements: journals, merging, interpolation, refusals.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;

use lut_gen::solid::solve::SolveError;
use lut_gen::sweep::{
    Finished, Forces, Journal, JournalError, JournalHead, MergeError, Parameter, Point, Shard, Spacing, SweepAxis,
    SweepLaw, SweepMotion, SweepSpec, SweepTable, TableError, merge, run,
};

const ENGINE: &str = "stand-in";

/// The thesis' six parameters of liver (section 2.11), three values each, at three rates.
fn liver() -> SweepSpec {
    use Spacing::{Linear, Logarithmic};
    let mut spec = SweepSpec::new("liver", SweepLaw::Ogden)
        .over(SweepAxis::even(Parameter::Mu, 1e-4, 1e-2, 3, Logarithmic))
        .over(SweepAxis::even(Parameter::Alpha, 2.0, 24.0, 3, Linear))
        .over(SweepAxis::even(Parameter::D, 0.5, 8.0, 3, Logarithmic))
        .over(SweepAxis::even(Parameter::G, 0.2, 0.8, 3, Linear))
        .over(SweepAxis::even(Parameter::K, 0.0, 0.4, 3, Linear))
        .over(SweepAxis::even(Parameter::Tau, 0.1, 10.0, 3, Logarithmic));
    let depths_mm = vec![1.0, 2.0, 4.0];
    spec.motion = SweepMotion { rates_mm_s: vec![0.1, 1.0, 10.0], depths_mm, holds_s: vec![10.0] };
    spec.fixed.insert(Parameter::Height, 30.0);
    spec.checks = 4;
    spec
}

/// A force with the right dependences and of no accuracy: a power law of the depth, relaxing with the time it takes.
/// On a finer mesh it is smaller by 0.1 % per half refinement.
fn closed_form(spec: &SweepSpec, point: &Point) -> Result<Forces, SolveError> {
    let get = |p| point.get(p).unwrap();
    let relaxed = |t: f64| 1.0 - get(Parameter::G) * (1.0 - (-t / get(Parameter::Tau)).exp());
    let bulk = (1.0 + get(Parameter::K)) / (1.0 + get(Parameter::D) * get(Parameter::Mu));
    let ramp = |d: f64| get(Parameter::Mu) * d.powf(1.5 + 0.1 * get(Parameter::Alpha)) * bulk;
    let mesh = 1.0 - 0.002 * (point.refinement - 1.0);
    let motion = &spec.motion;
    let curve = |&v: &f64| {
        let end = motion.depth_mm() / v;
        let mut forces: Vec<f64> = motion.depths_mm.iter().map(|&d| mesh * ramp(d) * relaxed(d / v)).collect();
        forces.extend(motion.holds_s.iter().map(|t| mesh * ramp(motion.depth_mm()) * relaxed(end + t)));
        forces
    };
    Ok(motion.rates_mm_s.iter().map(curve).collect())
}

fn journal_of(spec: &SweepSpec, shard: &str, threads: usize) -> Journal {
    let bytes = journal_bytes(spec, shard, threads, &|p| closed_form(spec, p));
    Journal::parse(&bytes).unwrap()
}

fn journal_bytes(
    spec: &SweepSpec,
    shard: &str,
    threads: usize,
    solve: &(dyn Fn(&Point) -> Result<Forces, SolveError> + Sync),
) -> Vec<u8> {
    let shard: Shard = shard.parse().unwrap();
    let jobs: Vec<usize> = (0..spec.jobs()).filter(|j| shard.holds(*j)).collect();
    let mut bytes = JournalHead { spec: spec.clone(), engine: ENGINE.to_owned(), shard }.bytes();
    run(spec, &jobs, threads, &solve, |f| appended(&mut bytes, &f)).unwrap();
    bytes
}

fn appended(bytes: &mut Vec<u8>, finished: &Finished) -> Result<(), ()> {
    bytes.extend(finished.record());
    Ok(())
}

fn named(journals: Vec<Journal>) -> Vec<(String, Journal)> {
    journals.into_iter().enumerate().map(|(i, j)| (format!("journal {i}"), j)).collect()
}

#[test]
fn the_table_is_the_same_however_the_work_is_divided() {
    let spec = liver();
    spec.check().unwrap();
    assert_eq!((spec.grid(), spec.jobs()), (729, 737));
    let whole = merge(&spec, &named(vec![journal_of(&spec, "1/1", 1)])).unwrap();
    let bytes = whole.bytes();
    for order in [["1/3", "2/3", "3/3"], ["3/3", "1/3", "2/3"]] {
        let parts = order.iter().enumerate().map(|(i, s)| journal_of(&spec, s, i + 1)).collect();
        assert_eq!(merge(&spec, &named(parts)).unwrap().bytes(), bytes);
    }
    // Shards of two divisions overlap; they agree, so it does not matter.
    let overlapping = ["1/2", "2/3", "2/2"].map(|s| journal_of(&spec, s, 2)).to_vec();
    assert_eq!(merge(&spec, &named(overlapping)).unwrap().bytes(), bytes);
    assert_eq!(SweepTable::parse(&bytes).unwrap(), whole);
}

#[test]
fn a_journal_cut_anywhere_loses_at_most_the_record_it_was_cut_in() {
    let mut spec = liver();
    spec.axes.truncate(2);
    spec.fixed.extend([(Parameter::D, 1.0), (Parameter::G, 0.5), (Parameter::K, 0.0), (Parameter::Tau, 1.0)]);
    spec.checks = 0;
    let bytes = journal_bytes(&spec, "1/1", 1, &|p| closed_form(&spec, p));
    let head = JournalHead { spec: spec.clone(), engine: ENGINE.to_owned(), shard: Shard::WHOLE }.bytes().len();
    let record = (bytes.len() - head) / 9;
    for cut in 0..bytes.len() {
        match Journal::parse(&bytes[..cut]) {
            Ok(journal) => {
                let whole = (cut - head) / record;
                assert_eq!(journal.outcomes.len(), whole);
                assert_eq!((journal.whole, journal.torn), (head + whole * record, (cut - head) % record));
            }
            Err(error) => assert_eq!((error, cut < head), (JournalError::Begun(cut), true)),
        }
    }
}

#[test]
fn a_changed_byte_in_a_journal_is_never_believed() {
    let mut spec = liver();
    spec.axes.truncate(1);
    spec.fixed.extend([(Parameter::Alpha, 8.0), (Parameter::D, 1.0), (Parameter::G, 0.5)]);
    spec.fixed.extend([(Parameter::K, 0.0), (Parameter::Tau, 1.0)]);
    let bytes = journal_bytes(&spec, "1/1", 1, &|p| closed_form(&spec, p));
    let good = Journal::parse(&bytes).unwrap();
    for at in 0..bytes.len() {
        let mut bad = bytes.clone();
        bad[at] ^= 0x10;
        if let Ok(journal) = Journal::parse(&bad) {
            assert!(journal.torn > 0 && journal.outcomes.len() < good.outcomes.len(), "byte {at}");
            assert!(journal.outcomes.iter().all(|(job, o)| good.outcomes[job] == *o), "byte {at}");
        }
    }
}

#[test]
fn what_fails_is_kept_with_its_reason_and_can_be_solved_later() {
    let mut spec = liver();
    spec.axes.truncate(2);
    spec.fixed.extend([(Parameter::D, 1.0), (Parameter::G, 0.5), (Parameter::K, 0.0), (Parameter::Tau, 1.0)]);
    spec.checks = 0;
    let moody = |p: &Point| {
        let alpha = p.get(Parameter::Alpha).unwrap();
        let mut forces = closed_form(&spec, p)?;
        match (p.get(Parameter::Mu).unwrap(), alpha) {
            (1e-4, 2.0) => {
                Err(SolveError::Parameter { parameter: "alpha", value: alpha, expected: "is not liked".to_owned() })
            }
            (1e-4, 13.0) => {
                forces[1][2] = f64::NAN;
                Ok(forces)
            }
            (1e-4, 24.0) => {
                forces.pop();
                Ok(forces)
            }
            (1e-2, 24.0) => panic!("on purpose: a numerical library breaks off"),
            _ => Ok(forces),
        }
    };
    let bytes = journal_bytes(&spec, "1/1", 2, &moody);
    let journal = Journal::parse(&bytes).unwrap();
    let table = merge(&spec, &named(vec![journal.clone()])).unwrap();
    let expected = BTreeMap::from([
        (0, "alpha = 2 is not liked".to_owned()),
        (1, "the force of sample 3 at 1 mm/s is NaN".to_owned()),
        (2, "the solver did not return 3 curves of 4 forces".to_owned()),
        (8, "the solver broke off in the middle (a defect; its message is above)".to_owned()),
    ]);
    assert_eq!(table.failed, expected);
    assert_eq!(SweepTable::parse(&table.bytes()).unwrap(), table);
    assert_eq!(
        table.forces_at(&[1e-4, 2.0]).unwrap_err().to_string(),
        "the table has no curve at mu_MPa 0.0001, alpha 2: alpha = 2 is not liked"
    );
    assert!(table.forces_at(&[1e-3, 13.0]).is_ok(), "a cell's corner of no weight may have failed");

    // Solved again in a journal of its own, or appended to the first: the failures are gone, in either order.
    let whole = journal_of(&spec, "1/1", 1);
    let complete = merge(&spec, &named(vec![whole.clone()])).unwrap();
    assert!(complete.failed.is_empty());
    assert_eq!(merge(&spec, &named(vec![journal.clone(), whole.clone()])).unwrap(), complete);
    assert_eq!(merge(&spec, &named(vec![whole, journal])).unwrap(), complete);
    let mut more = bytes;
    run(&spec, &[0, 1, 2, 8], 1, &|p| closed_form(&spec, p), |f| appended(&mut more, &f)).unwrap();
    assert_eq!(merge(&spec, &named(vec![Journal::parse(&more).unwrap()])).unwrap(), complete);
}

#[test]
fn journals_that_do_not_belong_together_are_refused() {
    let spec = liver();
    let text = |journals: Vec<Journal>| merge(&spec, &named(journals)).unwrap_err().to_string();
    assert_eq!(merge(&spec, &[]).unwrap_err(), MergeError::Nothing);

    let mut other = liver();
    other.refinement = 1.25;
    assert_eq!(
        text(vec![journal_of(&other, "1/3", 1)]),
        "journal 0 belongs to another sweep: its `refinement` is 1.25, here 1.0"
    );
    let mut newer = journal_of(&spec, "2/2", 1);
    newer.head.engine = "stand-in 2".to_owned();
    assert_eq!(
        text(vec![journal_of(&spec, "1/2", 1), newer]),
        "journal 1 belongs to another sweep: its engine is \"stand-in 2\", here \"stand-in\""
    );
    assert_ne!(other.identity(ENGINE), spec.identity(ENGINE));
    assert_ne!(spec.identity("stand-in 2"), spec.identity(ENGINE));

    let missing = text(vec![journal_of(&spec, "1/3", 1), journal_of(&spec, "3/3", 1)]);
    let start =
        "246 of 737 points are not solved yet: 1 (mu_MPa 0.0001, alpha 2, D_per_MPa 0.5, g 0.2, k 0, tau_s 1); 4 (";
    assert!(missing.starts_with(start), "{missing}");
    assert!(missing.ends_with("; and 241 more. Run the sweep again for: shard 2/3"), "{missing}");

    let mut wrong = journal_of(&spec, "1/1", 1);
    wrong.outcomes.get_mut(&5).unwrap().as_mut().unwrap()[0][0] *= 1.0 + 1e-15;
    let disagree = text(vec![journal_of(&spec, "1/1", 1), wrong]);
    assert!(disagree.starts_with("journal 0 and journal 1 differ in point 5 (mu_MPa 0.0001, "), "{disagree}");
}

#[test]
fn the_table_interpolates_and_states_its_error() {
    let spec = liver();
    let table = merge(&spec, &named(vec![journal_of(&spec, "1/1", 2)])).unwrap();
    // The stand-in's finer mesh differs by 0.1 %; both are divided by the finer peak.
    assert!((table.error.discretisation.unwrap() - 0.001 / 0.999).abs() < 1e-9);
    assert_eq!((table.error.finer, table.error.between), (4, 4));
    // At a point it is the solve; between two points of a power law in mu and an exponential in alpha, exact.
    let point = spec.point(364).unwrap();
    let values: Vec<f64> = spec.axes.iter().map(|a| point.get(a.parameter).unwrap()).collect();
    assert_eq!(table.forces_at(&values).unwrap(), *table.points[364].as_ref().unwrap());
    let mut off = values.clone();
    off[1] = 15.75;
    let (at, exact) = (table.forces_at(&off).unwrap(), |d: f64| d.powf(0.1 * 2.75));
    for (i, d) in spec.motion.depths_mm.iter().enumerate() {
        let from_point = table.points[364].as_ref().unwrap()[1][i] * exact(*d);
        assert!((at[1][i] / from_point - 1.0).abs() < 1e-12);
    }
    // The stated interpolation error holds at a cell's middle that was not among the checks: same order.
    let middle: Vec<f64> = spec.axes.iter().map(|a| a.spacing.middle(a.values[0], a.values[1])).collect();
    let mut probe = SweepSpec { axes: Vec::new(), ..spec.clone() };
    probe.fixed.extend(spec.axes.iter().zip(&middle).map(|(a, v)| (a.parameter, *v)));
    let solved = closed_form(&probe, &probe.point(0).unwrap()).unwrap();
    let told = table.forces_at(&middle).unwrap();
    let worst = (0..3).map(|r| (told[r][2] / solved[r][2] - 1.0).abs()).fold(0.0, f64::max);
    assert!(worst < 2.0 * table.error.interpolation.unwrap(), "{worst} {:?}", table.error);

    off[5] = 10.5;
    let outside = table.forces_at(&off).unwrap_err();
    assert_eq!(outside.to_string(), "tau_s = 10.5 lies outside the table, which covers 0.1 to 10");
    assert_eq!(table.forces_at(&[1.0]).unwrap_err().to_string(), "1 values for a table of 6 axes");
}

#[test]
fn a_changed_byte_in_a_table_is_refused() {
    let mut spec = liver();
    spec.axes.truncate(1);
    spec.fixed.extend([(Parameter::Alpha, 8.0), (Parameter::D, 1.0), (Parameter::G, 0.5)]);
    spec.fixed.extend([(Parameter::K, 0.0), (Parameter::Tau, 1.0)]);
    let bytes = merge(&spec, &named(vec![journal_of(&spec, "1/1", 1)])).unwrap().bytes();
    for at in 0..bytes.len() {
        let mut bad = bytes.clone();
        bad[at] ^= 0x01;
        let foreign = at < 8;
        assert_eq!(SweepTable::parse(&bad) == Err(TableError::Foreign), foreign);
        assert!(SweepTable::parse(&bad).is_err());
        assert!(SweepTable::parse(&bytes[..at]).is_err());
    }
}

#[test]
fn a_run_ends_at_the_first_record_that_cannot_be_kept() {
    let spec = liver();
    let jobs: Vec<usize> = (0..spec.jobs()).collect();
    let mut kept = 0;
    let outcome = run(&spec, &jobs, 4, &|p| closed_form(&spec, p), |_: Finished| {
        kept += 1;
        if kept < 10 { Ok(()) } else { Err("disk full") }
    });
    assert_eq!((outcome, kept), (Err("disk full"), 10));
}

/// A change that makes a good specification bad, and what is said of it.
type Refused<'a> = (&'a dyn Fn(&mut SweepSpec), &'a str);

#[test]
fn specifications_that_make_no_sense_are_refused() {
    let text = |change: &dyn Fn(&mut SweepSpec)| {
        let mut spec = liver();
        change(&mut spec);
        spec.check().expect_err("refused").to_string()
    };
    let cases: [Refused; 14] = [
        (&|s| s.axes[1].values = vec![2.0, 1.0], "axis alpha: values is 1 after 2; expected a strictly rising list"),
        (&|s| s.axes[3].values[2] = 1.0, "axis g: a value is 1; expected a relative modulus from 0 to below 1"),
        (
            &|s| s.axes[0].values[0] = f64::NAN,
            "axis mu_MPa: a value is NaN; expected a modulus above 0 and at most 10000 MPa",
        ),
        (&|s| s.axes[4].spacing = Spacing::Logarithmic, "axis k: a value is 0; expected above 0 on a logarithmic axis"),
        (&|s| s.axes[2].values.clear(), "axis D_per_MPa: the number of values is 0; expected at least 1"),
        (&|s| s.axes.push(s.axes[5].clone()), "axis tau_s: the axis is given twice; expected one axis a parameter"),
        (
            &|s| s.fixed.extend([(Parameter::G, 0.1)]),
            "axis g: a fixed value is given as well; expected either of the two",
        ),
        (&|s| drop(s.axes.remove(5)), "the ogden law: tau_s is missing; expected a fixed value or an axis"),
        (
            &|s| s.fixed.extend([(Parameter::Nu, 0.1)]),
            "the ogden law: nu is given; expected only parameters of that law",
        ),
        (
            &|s| s.fixed.extend([(Parameter::DMu, 0.1)]),
            "the ogden law: D_per_MPa is given beside D_mu; expected one of the two",
        ),
        (
            &|s| s.axes[0].factor = true,
            "axis mu_MPa: factor is true; expected false: only mu_MPa is a factor of the force, with hyperfoam, or with ogden at given D_mu",
        ),
        (&|s| s.motion.rates_mm_s.clear(), "motion: rates_mm_s is empty; expected at least one value"),
        (
            &|s| s.motion.depths_mm.push(29.0),
            "motion: the largest depth is 29 mm; expected below 95 % of the least height, 30 mm",
        ),
        (
            &|s| s.axes[0].values = (1..=20_000_000).map(|i| 1e-7 * f64::from(i)).collect(),
            "the axes: the number of points is 20000000 x 3 x 3 x 3 x 3 x 3; expected at most 10000000 points and 1073741824 forces in all",
        ),
    ];
    for (change, expected) in cases {
        assert_eq!(text(change), expected);
    }
}
