//! From what is believed of effects to a verdict.

use super::Belief;

/// What is said of data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Nothing is wrong.
    Clean,
    /// Each finding has one name.
    Named,
    /// Some finding has several.
    Ambiguous,
    /// Something is wrong that has no name.
    Unknown,
}

/// Probability from which the first effect has its name, and each further one; below which an
/// effect is of no account.
const NAMED: f64 = 0.99;
const NAMED_TOO: f64 = 0.999;
const NO_ACCOUNT: f64 = 0.5;
/// Share of the misfit that what is named must explain, and what each further name must add:
/// evidence alone is not importance.
const EXPLAINS: f64 = 0.5;
const ADDS: f64 = 0.05;
/// Names that may stand for one cause.
const MOST_TWINS: usize = 3;

/// What is said of what is believed.
#[derive(Debug, PartialEq)]
pub(super) struct Conclusion<N> {
    pub outcome: Outcome,
    /// Names that hold, each with its twins.
    pub findings: Vec<Vec<N>>,
    /// The same of what is there and explains too little.
    pub partly: Vec<Vec<N>>,
    pub explains: Option<f64>,
}

/// The verdict of what is believed, the likeliest first. `share` is what the best set of some
/// effects explains of the misfit, `any` the probability that one of them is there; `is_wrong`
/// where something is wrong for certain.
pub(super) fn concluded<N: Copy + Eq>(
    told: &[Belief<N>],
    is_wrong: bool,
    share: impl Fn(&[N]) -> Option<f64>,
    any: impl Fn(&[N]) -> f64,
) -> Conclusion<N> {
    let mut found: Vec<Vec<N>> = certain(told);
    let least = if found.is_empty() { NAMED } else { NAMED_TOO };
    found.extend(twins(told, least, any));
    let of = |sets: &[Vec<N>]| share(&sets.concat()).unwrap_or(0.0);
    drop_small(&mut found, of);
    let explains = share(&found.concat());
    if found.is_empty() {
        let likely = told.first().is_some_and(|b| b.probability > NO_ACCOUNT);
        let outcome = if likely || is_wrong { Outcome::Unknown } else { Outcome::Clean };
        return Conclusion { outcome, findings: Vec::new(), partly: Vec::new(), explains: None };
    }
    if explains.is_none_or(|share| share < EXPLAINS) {
        return Conclusion { outcome: Outcome::Unknown, findings: Vec::new(), partly: found, explains };
    }
    let outcome = if found.iter().all(|set| set.len() == 1) { Outcome::Named } else { Outcome::Ambiguous };
    Conclusion { outcome, findings: found, partly: Vec::new(), explains }
}

/// Effects that are there, what explains most alone first.
fn certain<N: Copy>(told: &[Belief<N>]) -> Vec<Vec<N>> {
    let mut believed: Vec<&Belief<N>> = told.iter().filter(|b| b.probability > NAMED).collect();
    believed.sort_by(|a, b| b.explains.unwrap_or(0.0).total_cmp(&a.explains.unwrap_or(0.0)));
    let is_named = |(at, b): &(usize, &Belief<N>)| *at == 0 || b.probability > NAMED_TOO;
    believed.into_iter().enumerate().filter(is_named).map(|(_, b)| vec![b.name]).collect()
}

/// The fewest effects of which one is there, though none for certain: the likeliest, and those that
/// are there where it is not.
fn twins<N: Copy + Eq>(told: &[Belief<N>], least: f64, any: impl Fn(&[N]) -> f64) -> Option<Vec<N>> {
    let uncertain: Vec<N> = told.iter().filter(|b| b.probability <= NAMED).map(|b| b.name).collect();
    let mut few = vec![*uncertain.first()?];
    while few.len() < MOST_TWINS {
        let with = |name: N| few.iter().copied().chain([name]).collect::<Vec<_>>();
        let others = uncertain.iter().filter(|name| !few.contains(*name)).map(|name| with(*name));
        // of equals the likelier
        few = others.reduce(|best, other| if any(&other) > any(&best) { other } else { best })?;
        if any(&few) > least {
            return Some(few);
        }
    }
    None
}

/// Takes out findings behind the first that add next to nothing, or less than what stays without a
/// name: what has no name may be any of that size.
fn drop_small<N: Copy>(found: &mut Vec<Vec<N>>, share: impl Fn(&[Vec<N>]) -> f64) {
    while found.len() > 1 {
        let whole = share(found);
        let adds = |at: usize| {
            let others: Vec<_> =
                found.iter().enumerate().filter(|(i, _)| *i != at).map(|(_, set)| set.clone()).collect();
            whole - share(&others)
        };
        let least = (1..found.len()).map(|at| (at, adds(at))).min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((at, _)) = least.filter(|(_, adds)| *adds < ADDS.max(1.0 - whole)) else { return };
        found.remove(at);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn belief(code: &'static str, probability: f64) -> Belief<&'static str> {
        Belief { name: code, probability, explains: None }
    }

    #[test]
    fn names_need_belief_and_a_share() {
        let lag = [belief("lag", 0.999), belief("drift", 0.1)];
        let said = |told: &[Belief<&'static str>], share: f64, any: f64| {
            let found = concluded(told, false, |of| (!of.is_empty()).then_some(share), |_| any);
            (found.outcome, found.findings, found.partly)
        };
        assert_eq!(said(&lag, 0.9, 0.5), (Outcome::Named, vec![vec!["lag"]], vec![]));
        assert_eq!(said(&lag, 0.4, 0.5), (Outcome::Unknown, vec![], vec![vec!["lag"]]));
        let twins = [belief("lag", 0.6), belief("drift", 0.395), belief("radius", 0.001)];
        assert_eq!(said(&twins, 0.9, 0.999), (Outcome::Ambiguous, vec![vec!["lag", "drift"]], vec![]));
        assert_eq!(said(&twins, 0.9, 0.98).0, Outcome::Unknown);
    }

    #[test]
    fn a_further_name_adds_more_than_stays_without_one() {
        let two = [belief("lag", 0.9999), belief("drift", 0.9999)];
        let of = |first: f64, second: f64| {
            let share = move |of: &[&str]| {
                let each = of.iter().map(|code| if *code == "lag" { first } else { second });
                Some(each.sum::<f64>())
            };
            concluded(&two, false, share, |_| 0.0).findings.len()
        };
        assert_eq!(of(0.45, 0.45), 2);
        // evidence is not importance
        assert_eq!(of(0.95, 0.02), 1);
        // a fifth of the misfit has no name
        assert_eq!(of(0.72, 0.08), 1);
    }

    #[test]
    fn one_may_be_certain_beside_twins() {
        let told = [belief("relaxation", 1.0), belief("lag", 0.6), belief("drift", 0.3999)];
        let share = |of: &[&str]| Some(0.3 + 0.3 * of.len() as f64);
        let found = concluded(&told, false, share, |_| 0.9999);
        assert_eq!(found.outcome, Outcome::Ambiguous);
        assert_eq!(found.findings, [vec!["relaxation"], vec!["lag", "drift"]]);
    }

    #[test]
    fn without_a_likely_effect_the_remainder_decides() {
        let none = [belief("lag", 0.2)];
        let said = |told: &[Belief<&'static str>], is_wrong| concluded(told, is_wrong, |_| None, |_| 0.0).outcome;
        assert_eq!(said(&none, false), Outcome::Clean);
        assert_eq!(said(&none, true), Outcome::Unknown);
        assert_eq!(said(&[], false), Outcome::Clean);
    }
}
