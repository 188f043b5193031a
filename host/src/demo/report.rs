//! The demo's report.

use std::fmt::Write;

use lut_gen::solid::contact::Ball;
use lut_gen::solid::field::FieldError;
use lut_gen::solid::law::Hyperfoam;
use lut_gen::solid::model::{Indentation, Resolution, Specimen};
use lut_gen::solid::solve::SolveError;
use protocol::lut::Table;

use super::figures::{
    both_over_time, display_over_time, felt_softness, force_over_depth, palpation_over_time, parameter_plane,
    search_over_depth,
};
use super::summary::{HEAD, HOST_TIME, STANDARD_ERROR};
use super::{OVERVIEW, REPORT, Summary};
use crate::ownership::OwnFolder;
use crate::plant::Foam;
use crate::report::{Page, field};

/// Writes `report.html` and `overview.svg` into the demo's folder.
pub(super) fn write(
    summary: &Summary,
    foams: &[Foam],
    table: &Table<'_>,
    folder: &mut OwnFolder,
) -> std::io::Result<()> {
    folder.write(OVERVIEW, overview_svg(summary, foams, table).as_bytes())?;
    folder.write(REPORT, page(summary, foams, table).html().as_bytes())?;
    Ok(())
}

/// The picture of the README: palpations on the left, the plane of the parameters on the right.
pub fn overview_svg(summary: &Summary, foams: &[Foam], table: &Table<'_>) -> String {
    let (width, height) = (600.0, 360.0);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {height}\" width=\"{0}\" height=\"{height}\">",
        2.0 * width
    );
    let figures = [force_over_depth(summary, foams, table), parameter_plane(summary, foams, table)];
    for (i, mut figure) in figures.into_iter().enumerate() {
        figure.size = (width, height);
        let _ = write!(out, "<g transform=\"translate({} 0)\">{}</g>", i as f64 * width, figure.svg());
    }
    out.push_str("</svg>\n");
    out
}

fn page(summary: &Summary, foams: &[Foam], table: &Table<'_>) -> Page {
    let right = summary.palpated.iter().filter(|p| p.recognised()).count();
    let mut page = Page::new(
        "Palpate: the whole chain",
        &format!(
            "{} palpations of {} foams at {} mm/s: {right} recognised ({:.1} %). Seed {}, simulated board, virtual time.",
            summary.palpated.len(),
            foams.len(),
            summary.options.rate_mm_s,
            100.0 * summary.recognised(),
            summary.options.seed,
        ),
    );
    if right < summary.palpated.len() {
        page.warning(&format!(
            "{} of {} palpations were not recognised; the confusion table below shows which.",
            summary.palpated.len() - right,
            summary.palpated.len()
        ));
    }
    page.figure(
        &force_over_depth(summary, foams, table).svg(),
        "Circles: load cell over the true depth, 50 a second while the board knew of contact. Lines: the library curve it chose. The force on \
         the ball comes from finer solves than the table's.",
    );
    identification(&mut page, summary, foams, table);
    display(&mut page, summary);
    together(&mut page, summary);
    felt(&mut page, summary);
    inside(&mut page, foams, table);
    conditions(&mut page, summary, foams, table);
    page
}

/// The stiffest foam under the ball, at the largest depth of the table: what its curve is made from.
fn inside(page: &mut Page, foams: &[Foam], table: &Table<'_>) {
    let Some(foam) = foams.iter().max_by(|a, b| a.curve.peak_n().total_cmp(&b.curve.peak_n())) else { return };
    let depth_mm = f64::from(table.depth_max_mm());
    let solved = Hyperfoam::one_term(foam.mu_mpa, foam.alpha)
        .map_err(SolveError::from)
        .map_err(FieldError::from)
        .and_then(|law| {
            let (specimen, ball) = (Specimen::of_height(foam.height_mm), Ball { radius_mm: super::BALL_RADIUS_MM });
            Indentation { law, specimen, ball, depth_mm, resolution: Resolution::Standard }.fields_at(&[depth_mm])
        });
    page.section("Inside a foam");
    match solved {
        Ok(fields) => {
            for one in &fields {
                page.figure(&field::mises(&format!("{} under the ball", foam.name), one), &field::caption(one));
            }
        }
        Err(cause) => page.warning(&format!("The inside of {} is not shown: {cause}.", foam.name)),
    }
}

fn identification(page: &mut Page, summary: &Summary, foams: &[Foam], table: &Table<'_>) {
    page.section("Identification");
    page.figure(
        &parameter_plane(summary, foams, table).svg(),
        "Crosses: true parameters. Circles: what the board states, bars: one standard error to either side. mu and alpha trade against each \
         other along a curve, which is why a material is recognised by its own curve and not by its parameters.",
    );
    page.figure(
        &search_over_depth(summary, foams).svg(),
        "Mean absolute difference (Eq. 17) of the best column, at the first estimate of the contact point; it is refined after the \
         palpation.",
    );
    let rows = summary.rows();
    page.table(&HEAD, &rows);
    let (all, mu, alpha) = summary.within_two_errors();
    page.paragraph(&format!("{STANDARD_ERROR}. Within two of them lie mu {mu} and alpha {alpha} of {all} times."));
    page.paragraph(HOST_TIME);
    page.section("Confusion");
    let confusion = summary.confusion();
    let mut head = vec!["true \\ identified"];
    head.extend(confusion.answers.iter().map(String::as_str));
    let rows: Vec<Vec<String>> = confusion
        .truths
        .iter()
        .zip(&confusion.counts)
        .map(|(truth, counts)| std::iter::once(truth.clone()).chain(counts.iter().map(usize::to_string)).collect())
        .collect();
    page.table(&head, &rows);
    if let Some(palpated) = summary.palpated.last() {
        page.section("One palpation over time");
        for figure in palpation_over_time(palpated) {
            page.figure(&figure.svg(), "Truth, sensor and belief are separate signals, here and in the logs.");
        }
    }
}

fn display(page: &mut Page, summary: &Summary) {
    page.section("Display");
    page.paragraph(&format!(
        "{} displayed to a simulated finger: the last foam recognised whose displacement under this hand the display's stroke allows. \
         The shaft follows its target within {:.2} mm rms.",
        summary.displayed.material,
        summary.displayed.tracking_rms_mm()
    ));
    page.paragraph(&format!("{}. {}.", summary.displayed.ticks, summary.displayed.limits()));
    let captions = [
        "Force of a hand with tremor, and what the FSR makes of it (hysteresis, creep, and a calibration rounded as in the thesis).",
        "Material: the position the table asks for under the true force. Target: what the controller asks for under the \
         force it reads.",
        "The table's control curve from force to current. A material without one is displayed by the actuator alone.",
    ];
    for (figure, caption) in display_over_time(summary).iter().zip(captions) {
        page.figure(&figure.svg(), caption);
    }
    page.figure(&felt_softness(summary).svg(), "Force over position, both true: display against material.");
}

fn together(page: &mut Page, summary: &Summary) {
    page.section("Palpate here, feel there");
    page.paragraph(&format!("{}.", summary.together.sentence()));
    let captions = [
        "Every foam is pressed once. Circles: the board's verdicts.",
        "Meanwhile a finger presses the display with 1 N every 2 s. After a verdict the display goes over to the curve of the material \
         that was named, within a second.",
    ];
    for (figure, caption) in both_over_time(summary).iter().zip(captions) {
        page.figure(&figure.svg(), caption);
    }
}

fn felt(page: &mut Page, summary: &Summary) {
    if summary.felt.is_empty() {
        return;
    }
    page.section("Under a hand");
    page.paragraph(
        "A simulated hand presses the displays; truth, from 0.2 N on, in loading. `palpate feel` does it for all materials.",
    );
    page.list(&super::felt::sentences(&summary.felt));
    for felt in &summary.felt {
        if let Some((_, figure, caption)) = crate::report::feel::figures(felt).first() {
            page.figure(&figure.svg(), caption);
        }
    }
}

fn conditions(page: &mut Page, summary: &Summary, foams: &[Foam], table: &Table<'_>) {
    page.section("Conditions");
    let jitter = summary.options.jitter;
    let t = &summary.traffic;
    page.list(&[
        format!(
            "Bench: force noise {} % of each foam's peak (white, 50 Hz), gain jitter {} %, contact jitter {} mm, ball of {} mm radius.",
            100.0 * jitter.force,
            100.0 * jitter.gain,
            jitter.surface_mm,
            super::BALL_RADIUS_MM
        ),
        format!(
            "Table: {} bytes in slot {:?}, error bound {:.2} % of a curve's peak. {}",
            summary.table_bytes,
            summary.slot,
            100.0 * summary.error_bound,
            table.provenance()
        ),
        format!(
            "Link: {} of {} telemetry records lost, {} of {} frames lost, {} damaged, {} requests repeated.",
            t.telemetry_lost,
            t.telemetry_received + t.telemetry_lost,
            t.frames_lost,
            t.frames_received + t.frames_lost,
            t.frames_damaged,
            t.requests_repeated
        ),
        format!(
            "Time: {:.1} s, of which finite elements {:.1} s; {:.0} s of board time.",
            summary.seconds, summary.solved_s, summary.virtual_s
        ),
        "Logs: telemetry.csv and log.mcap in the same folder.".into(),
    ]);
    let rows: Vec<Vec<String>> = foams
        .iter()
        .map(|f| {
            vec![
                f.name.clone(),
                format!("{}", f.mu_mpa),
                format!("{}", f.alpha),
                format!("{}", f.height_mm),
                format!("{:.3}", f.curve.peak_n()),
            ]
        })
        .collect();
    page.table(&["foam", "mu (MPa)", "alpha", "height (mm)", "peak force (N)"], &rows);
}
