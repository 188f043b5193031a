//! What a diagnosis could be wrong about.

use crate::diagnose::noise::Source;
use crate::diagnose::search::form_error_range;
use crate::diagnose::whiten::SIMULATED;
use crate::diagnose::{Diagnosis, Evidence};
use crate::report::{Page, number};

/// The section; without evidence there is nothing to doubt, only notes.
pub(super) fn section(page: &mut Page, found: &Diagnosis, evidence: Option<&Evidence>) {
    if let Some(evidence) = evidence {
        page.section("What this could be wrong about");
        noise(page, evidence);
        let mut list = vec![source(evidence), zero(evidence)];
        list.extend(accuracy());
        list.extend(ASSUMPTIONS.map(str::to_owned));
        page.list(&list);
        if let Some(warning) = moved(evidence) {
            page.warning(&warning);
        }
    }
    // faults and reasons stand at the top of the page already
    let others: Vec<String> = found.notes().map(str::to_owned).collect();
    if !others.is_empty() {
        page.section("Notes on these data");
        page.list(&others);
    }
}

/// What forces and effects are taken to be right to.
fn accuracy() -> [String; 2] {
    let percent = |share: f64| number(100.0 * share);
    let (forth, back) = form_error_range();
    [
        format!(
            "The simulated force is taken to be right to {} % along smooth shapes over depth (docs/verification.md). An error of the simulation that is larger, or not smooth, would look like an effect.",
            percent(SIMULATED)
        ),
        format!(
            "Each effect acts in its simplest form, which is taken to be within {} to {} % of what it adds ({} to {} % on the way back), by effect. A real cause of another form can be named after the nearest one, or be 'unknown'.",
            percent(forth.0),
            percent(forth.1),
            percent(back.0),
            percent(back.1)
        ),
    ]
}

/// What else is assumed of every experiment.
const ASSUMPTIONS: [&str; 4] = [
    "Spots are independent of each other: what neighbouring spots share, and what the whole session shares, is not noise here but a discrepancy.",
    "Runs that agree in specimen, ball, rate, motion and cycle are taken to repeat one condition, and the declared labels (cycle, spot, clock) to be right.",
    "Intervals hold for the extended model as named. They do not contain the chance that the name is wrong.",
    "At most three effects at once are looked for, and effects of opposite sign can cancel.",
];

fn source(evidence: &Evidence) -> String {
    let noise = &evidence.noise;
    match noise.source {
        Source::Replicates => format!(
            "The noise was estimated from what repeats of one condition differ by, with {} degrees of freedom for the scatter between spots{} and {} for the sensor. The thresholds contain that uncertainty; that the noise of other conditions is of the same kind is assumed.",
            number(noise.posterior.freedom.round()),
            if noise.posterior.freedom < 6.0 { ", which is few," } else { "" },
            number(noise.sensor_freedom.round()),
        ),
        Source::Stated => format!(
            "The noise was stated, not measured ({} N): no condition repeats. Every verdict here rests on that number, and on an assumed scatter of {} mm of contact point and {} % of gain between spots.",
            number(noise.sensor.sigma_n),
            number(noise.jitter.contact_mm),
            number(100.0 * noise.jitter.gain),
        ),
    }
}

fn zero(evidence: &Evidence) -> String {
    if evidence.design.zero_is_contact {
        "The recorded depth was meant to be zero at the contact. Each spot's contact point is fitted within its scatter; an offset that all runs share would be an effect.".to_owned()
    } else {
        "The recorded depth was not zeroed at the contact: a common contact point is fitted, and one for each spot about it. An offset that all runs share cannot be seen.".to_owned()
    }
}

fn noise(page: &mut Page, evidence: &Evidence) {
    let (sensor, jitter) = (evidence.noise.sensor, evidence.noise.jitter);
    let row = |name: &str, value: String| vec![name.to_owned(), value];
    // what a set that is not named would leave of it is another one, which notes may refer to
    let about =
        if evidence.held.is_empty() { "noise of these data, as the base sees it" } else { "noise of these data" };
    page.table(
        &[about, "standard deviation"],
        &[
            row("one sample of the force (N)", number(sensor.sigma_n)),
            row("  of its variance: white (%)", number(100.0 * sensor.white)),
            row("  correlation time of the rest (s)", number(sensor.correlation_s)),
            row("  added in proportion to the force (%)", number(100.0 * sensor.relative)),
            row("contact point, from spot to spot (mm)", number(jitter.contact_mm)),
            row("gain, from spot to spot (%)", number(100.0 * jitter.gain)),
            row("zero, from run to run (N)", number(jitter.zero_n)),
            row("contact points as the base fit sees them (mm)", contacts(evidence)),
        ],
    );
}

/// Contact points further out than this many times their scatter were moved by something else.
const FAR: f64 = 4.0;

/// A warning when the base's error has moved the contact points, from which explanations are judged.
fn moved(evidence: &Evidence) -> Option<String> {
    let farthest = evidence.contacts_mm.iter().map(|c| c.abs()).fold(0.0, f64::max);
    let scatter = evidence.noise.jitter.contact_mm;
    (farthest > FAR * scatter).then(|| {
        format!(
            "The base fit puts a contact point at {} mm, {} times the scatter between spots: it makes up there for what it gets wrong elsewhere. \
             Explanations are compared to first order about these points; take small effects that are named beside a large one with caution.",
            number((1000.0 * farthest).round() / 1000.0),
            number((farthest / scatter).round()),
        )
    })
}

/// Range of the fitted contact points.
fn contacts(evidence: &Evidence) -> String {
    let (low, high) =
        evidence.contacts_mm.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), c| (l.min(*c), h.max(*c)));
    format!("from {low:.3} to {high:.3}")
}
