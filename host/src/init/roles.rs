//! Which columns of a block are time, depth and force, in which unit and direction.

use crate::experiment::file::number::Digits;
use crate::experiment::file::table::Table;

use super::block::Block;
use super::channels::Channel;
use crate::experiment::signal::{extent, median};
use crate::experiment::unit::{Quantity, named, parted, unit};

/// A column that may be wanted.
#[derive(Debug, Clone)]
pub(super) struct Column {
    /// Place in the row, from 0.
    pub index: usize,
    /// Name in the header, if there is one.
    pub name: Option<String>,
    /// What it measures.
    pub quantity: Quantity,
    /// 0: the contract's own name; 3: by its unit or its numbers alone.
    pub rank: u8,
    /// Factor to mm, N or s.
    pub scale: f64,
    /// Why.
    pub why: String,
}

/// The columns of one recording.
#[derive(Debug, Clone)]
pub(super) struct Roles {
    pub time: Option<Column>,
    pub depth: Column,
    pub force: Column,
    /// +1 or -1 by which force rises and depth grows with it.
    pub force_sign: f64,
    pub depth_sign: f64,
}

/// The recordings that lie side by side in a block; none if it has no depth or no force.
pub(super) fn roles(table: &Table, block: &Block, digits: Digits, channels: &[Channel]) -> Vec<Roles> {
    let all = match block.header {
        Some(header) => by_names(table, block, header, channels),
        None => by_numbers(table, block, digits),
    };
    let varies = |column: &Column| {
        let values = values(table, block, digits, column.index);
        let (low, high) = ends(&values);
        2 * values.iter().filter(|v| v.is_finite()).count() >= values.len().min(20) && high > low
    };
    let of = |quantity| all.iter().filter(|c| c.quantity == quantity && varies(c)).cloned().collect::<Vec<_>>();
    let (times, depths, forces) = (of(Quantity::Time), of(Quantity::Depth), of(Quantity::Force));
    let with_signs = |time: Option<Column>, depth: Column, force: Column| {
        let (force_sign, depth_sign) =
            signs(&values(table, block, digits, depth.index), &values(table, block, digits, force.index));
        Roles { time, depth, force, force_sign, depth_sign }
    };
    let count = forces.len();
    let alike = |columns: &[Column]| columns.windows(2).all(|pair| stem(&pair[0]) == stem(&pair[1]));
    if count > 1 && depths.len() == count && alike(&depths) && alike(&forces) {
        let time = |at: usize| if times.len() == count { times.get(at) } else { times.first() }.cloned();
        return (0..count).map(|at| with_signs(time(at), depths[at].clone(), forces[at].clone())).collect();
    }
    let best = |columns: Vec<Column>| columns.into_iter().min_by_key(|column| (column.rank, column.index));
    match (best(depths), best(forces)) {
        (Some(depth), Some(force)) => vec![with_signs(best(times), depth, force)],
        _ => Vec::new(),
    }
}

/// A name without what numbers or letters specimens: "Load 2", "Load_B".
fn stem(column: &Column) -> String {
    let name = column.name.as_deref().unwrap_or_default();
    let bare = parted(name).0.to_lowercase();
    let cut = bare.rsplit_once([' ', '_', '-', '.']).filter(|(_, tail)| tail.len() == 1 || tail.parse::<u32>().is_ok());
    cut.map_or(bare.as_str(), |(head, _)| head).trim_end_matches(|c: char| c.is_ascii_digit()).to_owned()
}

fn by_names(table: &Table, block: &Block, header: usize, channels: &[Channel]) -> Vec<Column> {
    let row = table.row(header);
    let mut found = Vec::new();
    for (index, name) in row.cells().enumerate().filter(|(_, name)| !name.is_empty()) {
        let channel = channels.get(index).cloned().unwrap_or_default();
        let (bare, mut text) = parted(name);
        let mut where_ = "in its name";
        if let Some(units) = block.units.map(|at| table.row(at).cell(index)).filter(|cell| !cell.is_empty()) {
            (text, where_) = (Some(units.to_owned()), "in the units row");
        } else if let Some(stated) = channel.unit.filter(|_| text.is_none()) {
            (text, where_) = (Some(stated), "in the preamble");
        }
        let known = text.as_deref().and_then(unit);
        let (quantity, rank) = match (named(name, &bare), known) {
            (Some((quantity, _)), Some((other, _))) if quantity != other => continue,
            (Some((quantity, rank)), _) => (quantity, rank),
            (None, Some((quantity, _))) if !is_other(&bare) => (quantity, 3),
            (None, _) => continue,
        };
        let scale = known.map_or(1.0, |(_, scale)| scale) * channel.scale.filter(|scale| *scale > 0.0).unwrap_or(1.0);
        let plain = ["s", "mm", "N"][quantity as usize];
        let why = match (&text, known) {
            (Some(text), Some(_)) => format!("{} {where_}", text.trim_matches(['(', ')', '[', ']'])),
            (Some(text), None) => format!("GUESS: {plain}; its unit \"{text}\" is not known"),
            (None, _) if rank == 0 => String::new(),
            (None, _) => format!("GUESS: {plain}, no unit is stated"),
        };
        found.push(Column { index, name: Some(name.to_owned()), quantity, rank, scale, why });
    }
    found
}

/// A name that says something else than its unit does, as a strain in mm/mm.
fn is_other(bare: &str) -> bool {
    ["strain", "stress", "dehnung", "radius", "width", "diameter", "durchmesser", "breite"]
        .iter()
        .any(|word| bare.to_lowercase().contains(word))
}

/// Without names only three columns say enough: time grows evenly, and depth is smoother than force.
fn by_numbers(table: &Table, block: &Block, digits: Digits) -> Vec<Column> {
    let width = block.rows.clone().map(|at| table.row(at).len()).max().unwrap_or(0);
    if width != 3 {
        return Vec::new();
    }
    let all: Vec<Vec<f64>> = (0..3).map(|index| values(table, block, digits, index)).collect();
    let rises = |values: &[f64]| values.windows(2).all(|pair| pair[1] > pair[0]);
    let Some(time) = (0..3).find(|index| rises(&all[*index])) else { return Vec::new() };
    let rough = |index: usize| {
        let (low, high) = ends(&all[index]);
        let bends: f64 = all[index].windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs()).sum();
        bends / (high - low)
    };
    let mut rest: Vec<usize> = (0..3).filter(|index| *index != time).collect();
    rest.sort_by(|a, b| rough(*a).total_cmp(&rough(*b)));
    let column = |index, quantity, why: &str| Column {
        index,
        name: None,
        quantity,
        rank: 3,
        scale: 1.0,
        why: format!("GUESS: {why}, the file has no names"),
    };
    vec![
        column(time, Quantity::Time, "s, it rises evenly"),
        column(rest[0], Quantity::Depth, "mm, the smoother column"),
        column(rest[1], Quantity::Force, "N, the rougher column"),
    ]
}

/// The numbers of a column; NaN where there is none.
pub(super) fn values(table: &Table, block: &Block, digits: Digits, index: usize) -> Vec<f64> {
    let cell = |at| table.row(at).cell(index);
    if digits.number(cell(block.rows.start)).is_err()
        && crate::experiment::file::clock::is_clock(cell(block.rows.start))
    {
        let mut clock = crate::experiment::file::clock::Clock::default();
        return block.rows.clone().map(|at| clock.seconds(cell(at)).unwrap_or(f64::NAN)).collect();
    }
    block.rows.clone().map(|at| digits.number(cell(at)).unwrap_or(f64::NAN)).collect()
}

/// Lowest and highest.
pub(super) fn ends(values: &[f64]) -> (f64, f64) {
    extent(values.iter().copied().filter(|v| v.is_finite()))
}

/// Signs of force and depth: force leaves its first value mostly upwards, and where it is farthest from it depth is large.
fn signs(depth: &[f64], force: &[f64]) -> (f64, f64) {
    let rest = median(force.iter().copied().filter(|f| f.is_finite()).take(force.len() / 20 + 1));
    let (low, high) = ends(force);
    // A force that never changes its sign was preloaded, or its sensor was not zeroed.
    let upwards = if low >= 0.0 || high <= 0.0 { low >= 0.0 } else { high - rest >= rest - low };
    let force_sign = if upwards { 1.0 } else { -1.0 };
    let top = 0.8 * (high - rest).max(rest - low);
    let mean = |large: bool| {
        let chosen = depth
            .iter()
            .zip(force)
            .filter(|(d, f)| d.is_finite() && f.is_finite() && (force_sign * (**f - rest) >= top) == large);
        let (sum, count) = chosen.fold((0.0, 0.0), |(sum, count), (d, _)| (sum + d, count + 1.0));
        sum / count
    };
    (force_sign, if mean(true) < mean(false) { -1.0 } else { 1.0 })
}
