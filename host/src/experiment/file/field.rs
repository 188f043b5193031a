//! Which cells of a row are read, and as what.

use std::collections::BTreeMap;

use super::super::error::Problem;
use super::super::format::{Mapping, Source};
use super::need::Need;
use super::table::Row;

/// A column of the file that is read: its place, its names and its conversion.
#[derive(Debug, Clone)]
pub(crate) struct Field {
    /// Place in the row, from 0.
    pub index: usize,
    /// Name in the header, or what is wanted of it where there is no header.
    pub header: String,
    /// Name in the contract.
    pub wanted: String,
    /// Scale and sign.
    pub factor: f64,
    /// The description states the scale: what the file says of its unit does not matter.
    pub scale_is_stated: bool,
    /// Every cell must hold a number.
    pub required: bool,
}

/// A wanted column with its mapping, and why it is needed if it is.
type Wanted<'a> = (&'a str, Mapping, Option<&'static str>);

/// All columns of a file: those that the run needs, those that are mapped, and the others by their names.
/// Without a header (`None`) only what is mapped by number.
pub(crate) fn fields(
    header: Option<Row<'_>>,
    width: usize,
    need: &Need,
    columns: &BTreeMap<String, Mapping>,
) -> Result<Vec<Field>, Problem> {
    let mut fields: Vec<Field> = Vec::new();
    for (wanted, mapping, why) in wanted(need, columns) {
        let Some(index) = place(header, width, &mapping, wanted, why)? else { continue };
        let name = header.map_or("", |row| row.cell(index));
        fields.push(Field {
            index,
            header: if name.is_empty() { wanted } else { name }.to_owned(),
            wanted: wanted.to_owned(),
            factor: mapping.factor(),
            scale_is_stated: mapping.scale.is_some(),
            required: why.is_some(),
        });
    }
    for (index, name) in header.into_iter().flat_map(Row::cells).enumerate() {
        let is_time = need.pace.is_some() && name == "time_s";
        if name.is_empty() || is_time || fields.iter().any(|field| field.index == index) {
            continue;
        }
        let header = name.to_owned();
        fields.push(Field {
            index,
            wanted: free(&header, &fields),
            header,
            factor: 1.0,
            scale_is_stated: false,
            required: false,
        });
    }
    for field in &mut fields {
        field.required |= need.numbers.contains(&field.wanted.as_str());
    }
    Ok(fields)
}

/// The needed columns, then those that are only mapped.
fn wanted<'a>(need: &Need, columns: &'a BTreeMap<String, Mapping>) -> Vec<Wanted<'a>> {
    let needed = need
        .columns
        .iter()
        .map(|(name, why)| (*name, columns.get(*name).cloned().unwrap_or_else(|| Mapping::named(name)), Some(*why)));
    // The time of a file whose pace is stated is not read.
    let unused = |name: &str| need.includes(name) || (need.pace.is_some() && name == "time_s");
    let mapped =
        columns.iter().filter(|(name, _)| !unused(name)).map(|(name, mapping)| (name.as_str(), mapping.clone(), None));
    needed.chain(mapped).collect()
}

/// A name that no field has yet: names in a header may repeat.
fn free(name: &str, fields: &[Field]) -> String {
    let taken = |name: &str| fields.iter().any(|field| field.wanted == name);
    if !taken(name) {
        return name.to_owned();
    }
    (2..).map(|nth| format!("{name} {nth}")).find(|name| !taken(name)).unwrap_or_default()
}

/// Where the column is; `None` if one is missing that the run can do without.
fn place(
    header: Option<Row<'_>>,
    width: usize,
    mapping: &Mapping,
    wanted: &str,
    why: Option<&'static str>,
) -> Result<Option<usize>, Problem> {
    let named = || header.into_iter().flat_map(Row::cells).map(str::to_owned).collect::<Vec<_>>();
    match &mapping.source {
        Source::Number(number) if (1..=width).contains(number) => Ok(Some(number - 1)),
        Source::Number(number) => match why {
            Some(_) => Err(Problem::NoSuchColumn { wanted: wanted.to_owned(), number: *number, width }),
            None => Ok(None),
        },
        Source::Name { name, .. } if header.is_none() => match why {
            Some(_) => Err(Problem::NoNumber { wanted: wanted.to_owned(), name: name.clone() }),
            None => Ok(None),
        },
        Source::Name { name, nth } => {
            let all: Vec<usize> = named().iter().enumerate().filter(|(_, n)| *n == name).map(|(at, _)| at).collect();
            match (nth, &all[..]) {
                (None, [index]) => Ok(Some(*index)),
                (None, [_, _, ..]) => Err(Problem::DuplicateColumn(name.clone())),
                (Some(nth), [_, ..]) if (1..=all.len()).contains(nth) => Ok(all.get(nth - 1).copied()),
                _ => match why {
                    Some(why) => {
                        let name =
                            nth.filter(|_| !all.is_empty()).map_or(name.clone(), |nth| format!("{name} ({nth})"));
                        Err(Problem::MissingColumn { name, why: why.to_owned(), header: named() })
                    }
                    None => Ok(None),
                },
            }
        }
    }
}
