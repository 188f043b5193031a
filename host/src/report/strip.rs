//! Rows of dots over a logarithmic axis: how each of several things is distributed.

use std::fmt::Write;

use super::escaped;
use super::figure::{Axis, open};
use super::scale::{Scale, number};

/// One row.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Written to its left.
    pub name: String,
    /// Values; those that are not positive are left out.
    pub dots: Vec<f64>,
    /// One value set apart.
    pub mark: Option<f64>,
    /// Written to its right.
    pub note: String,
}

/// Rows over a common axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Strip {
    /// Above the plot.
    pub title: String,
    /// Quantity and unit.
    pub axis: String,
    /// Head of the notes.
    pub note: String,
    /// Rows, the first on top.
    pub rows: Vec<Row>,
}

const ROW_PX: f64 = 26.0;
const WIDTH_PX: f64 = 720.0;
const LEFT_PX: f64 = 200.0;
const RIGHT_PX: f64 = 70.0;
const TOP_PX: f64 = 44.0;

impl Strip {
    /// The picture as an `<svg>` element.
    pub fn svg(&self) -> String {
        let height = TOP_PX + ROW_PX * self.rows.len() as f64 + 46.0;
        let values = self.rows.iter().flat_map(|row| row.dots.iter().copied().chain(row.mark));
        let x = Scale::fitting(&Axis::new(&self.axis).logarithmic(), values, (LEFT_PX, WIDTH_PX - RIGHT_PX));
        let mut svg = open(WIDTH_PX, height, &self.title);
        let floor = TOP_PX + ROW_PX * self.rows.len() as f64;
        for tick in x.ticks() {
            let at = x.px(tick);
            let _ = write!(
                svg,
                "<path d=\"M{at:.1} {TOP_PX}V{floor:.1}\" stroke=\"#e4e4e4\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
                floor + 17.0,
                number(tick)
            );
        }
        for (at, row) in self.rows.iter().enumerate() {
            draw(&mut svg, row, TOP_PX + ROW_PX * (at as f64 + 0.5), &x);
        }
        let _ = write!(
            svg,
            "<path d=\"M{LEFT_PX} {floor:.1}H{:.1}\" stroke=\"#333\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text></svg>",
            x.high_px,
            0.5 * (x.low_px + x.high_px),
            floor + 36.0,
            escaped(&self.axis),
            WIDTH_PX - 10.0,
            TOP_PX - 8.0,
            escaped(&self.note)
        );
        svg.push('\n');
        svg
    }
}

fn draw(svg: &mut String, row: &Row, middle: f64, x: &Scale) {
    let _ = write!(
        svg,
        "<path d=\"M{:.1} {middle:.1}H{:.1}\" stroke=\"#e4e4e4\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
        x.low_px,
        x.high_px,
        x.low_px - 10.0,
        middle + 4.0,
        escaped(&row.name),
        WIDTH_PX - 10.0,
        middle + 4.0,
        escaped(&row.note)
    );
    let shown = row.dots.iter().filter(|value| value.is_finite() && **value > 0.0);
    for (at, value) in shown.enumerate() {
        // Equal values stay visible beside each other.
        let lift = [0.0, 3.5, -3.5, 7.0, -7.0][at % 5];
        let _ = write!(
            svg,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.6\" fill=\"#15364f\" fill-opacity=\"0.45\"/>",
            x.px(*value),
            middle + lift
        );
    }
    if let Some(mark) = row.mark.filter(|mark| mark.is_finite() && *mark > 0.0) {
        let at = x.px(mark);
        let _ = write!(svg, "<path d=\"M{at:.1} {:.1}v20\" stroke=\"#b4481e\" stroke-width=\"2.5\"/>", middle - 10.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_without_dots_and_odd_values_are_drawn() {
        let row = |dots: Vec<f64>, mark| Row { name: "a < b".to_owned(), dots, mark, note: "0 %".to_owned() };
        let rows = vec![row(vec![10.0, 100.0, f64::NAN, -1.0], Some(50.0)), row(vec![], None)];
        let svg = Strip { title: "t".to_owned(), axis: "n".to_owned(), note: "s".to_owned(), rows }.svg();
        assert_eq!(svg.matches("<circle").count(), 2);
        assert!(svg.contains("a &lt; b") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
