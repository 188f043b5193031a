//! What is told of control curves.

use serde_json::{Value, json};

use super::Made;
use crate::control::compose::{Links, UNIAXIAL};
use crate::control::study::Tried;
use crate::report::number;

/// Above the page.
pub(super) fn subtitle(links: &Links) -> String {
    format!(
        "Magnet {}, at most {} A: {} of {} yields at {} kPa. Simulated.",
        links.magnet,
        number(links.most_a),
        "the fluid",
        links.fluid,
        number(links.most_kpa())
    )
}

/// Percent.
fn percent(part: f64) -> String {
    format!("{:.1} %", 100.0 * part)
}

/// The answer first, then what it rests on.
pub(super) fn sentences(made: &Made, links: &Links) -> Vec<String> {
    let asked_mm = made.asked_mm;
    let Made { block, study, curve, .. } = made;
    let (from, to) = curve.reachable_n;
    let last = curve.rows.last().map_or(0.0, |row| row.force_n);
    let reach = if from <= 0.0 && to >= last {
        format!("{} can be shown up to {} N, the whole curve.", block.name, number(last))
    } else {
        let most = links.most_kpa() * UNIAXIAL;
        format!(
            "{} can be shown from {} to {} N of {} N: beyond, the magnet cannot make the yield stress ({} kPa at most).",
            block.name,
            number(from),
            number(to),
            number(last),
            number(most)
        )
    };
    let error = study.cubic.error;
    let mut lines = vec![reach];
    let deepest = study.wanted.travel_mm.last().copied().unwrap_or(0.0);
    if deepest < asked_mm - 1e-9 {
        lines.push(format!(
            "It ends at {} mm of travel of {} mm: farther down the fluid closes round the finger and no equilibrium was found.",
            number(deepest),
            number(asked_mm)
        ));
    }
    lines.push(format!(
        "Cubic curve: force is off by {}, area by {}, together {}.",
        percent(error.force),
        percent(error.area),
        percent(error.combined())
    ));
    if let Some(off) = study.cubic.felt.area_at_force(&study.wanted) {
        lines.push(format!("At the same force the area is off by {}.", percent(off)));
    }
    if let Some(best) = &study.best {
        let (own, least) = (error.combined(), best.error.combined());
        lines.push(format!(
            "The best curve of {} knots leaves {} of force and {} of area, together {}: the cubic is {} times as far off. \
             What is left no yield stress can take away: the fluid keeps its volume and the foam does not.",
            crate::control::study::PLACES,
            percent(best.error.force),
            percent(best.error.area),
            percent(least),
            number(own / least.max(f64::MIN_POSITIVE))
        ));
    }
    for Tried { name, felt, .. } in &study.tried {
        lines.push(match felt {
            Some((_, error)) => format!(
                "The {name} of the foam's stress: force {}, area {}, together {}.",
                percent(error.force),
                percent(error.area),
                percent(error.combined())
            ),
            None => format!("The {name} of the foam's stress: no equilibrium up to the last travel."),
        });
    }
    let most = study.gains.iter().copied().fold(0.0, f64::max);
    let cut = study.cut.iter().filter(|cut| **cut).count();
    lines.push(format!(
        "Loop gain: at most {}{}.",
        number(most),
        if cut > 0 { format!("; the curve was made less steep at {cut} travels for it") } else { String::new() }
    ));
    let mesh = if study.mesh_n.is_some() { "" } else { ", without that of the mesh: a finer one found no equilibrium" };
    lines.push(format!("Error of the current: at most {} A{mesh}.", number(curve.bound_a)));
    if study.cycle.is_none() {
        lines
            .push("The way up again was not computed: a fluid that follows the force found no equilibrium.".to_owned());
    }
    lines.push(format!("Below yield the fluid has a Young's modulus of {} MPa (assumed).", number(study.young_mpa)));
    lines
}

/// On the terminal.
pub(super) fn print(made: &Made, links: &Links) {
    outln!("{}", made.block.name);
    for line in sentences(made, links) {
        outln!("  {line}");
    }
    for left_out in &made.block.left_out {
        outln!("  Not in the finger's press: {left_out}.");
    }
    outln!("");
    outln!(
        "  {:>8}  {:>9}  {:>9}  {:>8}  {:>9}  {:>8}  {:>9}  {:>9}",
        "force N",
        "travel mm",
        "area mm2",
        "shaft mm",
        "yield kPa",
        "flux T",
        "current A",
        "loop gain"
    );
    let step = (made.curve.rows.len() / 12).max(1);
    for row in made.curve.rows.iter().step_by(step) {
        let reached = row.force_n >= made.curve.reachable_n.0 && row.force_n <= made.curve.reachable_n.1;
        outln!(
            "  {:>8.3}  {:>9.2}  {:>9.1}  {:>8.2}  {:>9.3}  {:>8.4}  {:>9.3}  {:>9.2}{}",
            row.force_n,
            row.travel_mm,
            row.area_mm2,
            row.shaft_mm,
            row.yield_kpa,
            row.flux_t,
            row.current_a,
            row.loop_gain,
            if reached { "" } else { "  unreachable" }
        );
    }
    outln!("");
}

/// As JSON.
pub(super) fn summary(made: &Made, links: &Links) -> Value {
    let Made { block, study, curve, .. } = made;
    let error = |error: lut_gen::pad::control::felt::Error| json!({"force": error.force, "area": error.area, "combined": error.combined()});
    let tried: serde_json::Map<String, Value> = study
        .tried
        .iter()
        .map(|own| (own.name.to_owned(), own.felt.as_ref().map_or(Value::Null, |(_, of)| error(*of))))
        .collect();
    let rows = curve.rows.iter().map(|row| {
        json!({"force_N": row.force_n, "travel_mm": row.travel_mm, "area_mm2": row.area_mm2, "shaft_mm": row.shaft_mm,
               "yield_kPa": row.yield_kpa, "flux_T": row.flux_t, "current_A": row.current_a,
               "loop_gain": row.loop_gain})
    });
    json!({
        "material": block.name,
        "reachable_N": [curve.reachable_n.0, curve.reachable_n.1],
        "bound_A": curve.bound_a,
        "bound_holds_mesh": study.mesh_n.is_some(),
        "young_MPa": study.young_mpa,
        "deepest_mm": study.wanted.travel_mm.last(),
        "most_yield_kPa": links.most_kpa(),
        "cubic": error(study.cubic.error),
        "area_at_force": study.cubic.felt.area_at_force(&study.wanted),
        "cubic_settled": study.cubic.settled,
        "best": study.best.as_ref().map(|best| error(best.error)),
        "averages": tried,
        "largest_loop_gain": study.gains.iter().copied().fold(0.0, f64::max),
        "limited_places": study.cut.iter().filter(|cut| **cut).count(),
        "curve": rows.collect::<Vec<_>>(),
    })
}
