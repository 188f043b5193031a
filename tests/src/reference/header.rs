//! The two header forms of the reference files.

use std::collections::BTreeMap;

use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::{Hyperfoam, Term};
use lut_gen::solid::model::Specimen;
use lut_gen::solid::solve::Base;

use super::Reference;

/// Block radius where a header states none (mm).
const BLOCK_RADIUS_MM: f64 = 25.0;
/// Names under which headers give the coefficient of friction.
const FRICTION: [&str; 7] = ["friction", "fric", "mu_f", "mu_c", "muf", "mu_fric", "coulomb"];
/// Uncertainty of a CalculiX curve with a single finished mesh (percent): the larger of those the
/// headers of the others state from 0.5 mm on (EVA, 0.23 %), rounded up.
const ONE_MESH_PERCENT: f64 = 0.25;

/// `key=value` pairs and bare words of a part of the header.
struct Fields {
    part: &'static str,
    values: BTreeMap<String, String>,
}

impl Fields {
    fn of(part: &'static str, text: &str) -> Self {
        let text = text.replace(" =", "=").replace("= ", "=");
        let words = text.split(|c: char| c.is_whitespace() || matches!(c, ',' | ';' | '(' | ')'));
        let pairs = words.filter_map(|w| w.split_once('='));
        Self { part, values: pairs.map(|(key, value)| (key.to_owned(), value.to_owned())).collect() }
    }

    /// Takes the number of the first of `keys` that is there.
    fn take(&mut self, keys: &[&str]) -> Result<Option<f64>, String> {
        let Some((key, value)) = keys.iter().find_map(|k| Some((*k, self.values.remove(*k)?))) else {
            return Ok(None);
        };
        number(key, &value).map(Some)
    }

    fn need(&mut self, keys: &[&str]) -> Result<f64, String> {
        self.take(keys)?.ok_or_else(|| format!("{} states no {}=", self.part, keys[0]))
    }

    /// Refuses what is left: an unknown parameter may change the physics.
    fn nothing_else(&self) -> Result<(), String> {
        match self.values.iter().next() {
            None => Ok(()),
            Some((key, value)) => Err(format!("{} has {key}={value}, which is not understood", self.part)),
        }
    }
}

fn number(what: &str, text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(v) if v.is_finite() => Ok(v),
        _ => Err(format!("{what} = {text:?} is not a finite number")),
    }
}

/// The text after `from` up to `to` (or the end of the text).
fn between<'a>(text: &'a str, from: &str, to: &str) -> Option<&'a str> {
    let rest = &text[text.find(from)? + from.len()..];
    Some(rest.find(to).map_or(rest, |end| &rest[..end]))
}

pub(super) fn parse(name: &str, text: &str) -> Result<Reference, String> {
    let header: Vec<&str> = text.lines().filter_map(|l| l.trim().strip_prefix('#')).map(str::trim).collect();
    let rows = rows(text)?;
    let line = |start: &str| header.iter().find_map(|l| l.strip_prefix(start)).map(str::trim);
    let mut out = if let Some(material) = line("material:") {
        calculix(&header, material, &line)?
    } else if let Some(parameters) = header.iter().find(|l| l.starts_with("mu=") || l.contains(" mu=")) {
        independent(&header, parameters)?
    } else {
        return Err("the header has neither a line with mu= nor a line material:".into());
    };
    if out.friction < 0.0 {
        return Err(format!("friction = {} must not be negative", out.friction));
    }
    name.clone_into(&mut out.name);
    out.rows = rows;
    Ok(out)
}

/// The form of the independent code: one line of parameters, a bracket of remarks.
fn independent(header: &[&str], line: &str) -> Result<Reference, String> {
    let (parameters, remarks) = line.split_once('[').unwrap_or((line, ""));
    let mut fields = Fields::of("the line of parameters", parameters);
    let law = law(numbered_terms(&mut fields)?)?;
    let told = match fields.take(&["sliding"])? {
        Some(v) => Some(if v == 0.0 { Base::Bonded } else { Base::Sliding }),
        None => fields.values.remove("base").map(|w| base(&w)).transpose()?,
    };
    let remarked = between(remarks, "base ", ";").map(|w| base(w.split(']').next().unwrap_or(w))).transpose()?;
    let base = match (told, remarked) {
        (Some(a), Some(b)) if a != b => {
            return Err(format!("its base is {a:?} by the parameters, but {b:?} by the remark"));
        }
        (a, b) => a.or(b).ok_or("it does not say how its base is held (sliding=1, or base bonded)")?,
    };
    let radius = match fields.take(&["W", "Rb", "block_radius"])? {
        Some(radius) => Some(radius),
        None => between(remarks, "block radius ", " mm").map(|v| number("block radius", v)).transpose()?,
    };
    let reference = Reference {
        name: String::new(),
        law,
        specimen: Specimen {
            height_mm: fields.need(&["h", "H", "height_mm"])?,
            radius_mm: radius.unwrap_or(BLOCK_RADIUS_MM),
            base,
        },
        ball: Ball { radius_mm: fields.need(&["R", "radius_mm"])? },
        friction: fields.take(&FRICTION)?.unwrap_or(0.0),
        uncertainty_percent: stated(header)?,
        rows: Vec::new(),
    };
    fields.nothing_else()?;
    Ok(reference)
}

/// `mu=, alpha=, nu=` and `mu2=, alpha2=, nu2=` and so on; a term without nu has the first one's.
fn numbered_terms(fields: &mut Fields) -> Result<Vec<Term>, String> {
    let nu = fields.take(&["nu"])?.or(fields.take(&["nu1"])?).unwrap_or(0.0);
    let mut terms = vec![Term { mu_mpa: fields.need(&["mu", "mu1"])?, alpha: fields.need(&["alpha", "alpha1"])?, nu }];
    for i in 2.. {
        let Some(mu_mpa) = fields.take(&[&format!("mu{i}")])? else { break };
        let alpha = fields.need(&[&format!("alpha{i}")])?;
        terms.push(Term { mu_mpa, alpha, nu: fields.take(&[&format!("nu{i}")])?.unwrap_or(nu) });
    }
    Ok(terms)
}

/// `uncertainty from 0.5 mm on: 0.09 %`.
fn stated(header: &[&str]) -> Result<f64, String> {
    let line = header.iter().find(|l| l.contains("uncertainty")).ok_or("the header states no uncertainty")?;
    let rest = between(line, "uncertainty", "%").unwrap_or_default();
    let value = rest.rsplit(':').next().unwrap_or_default();
    positive("uncertainty", number("uncertainty", value)?)
}

fn positive(what: &str, value: f64) -> Result<f64, String> {
    if value >= 0.0 { Ok(value) } else { Err(format!("{what} = {value} must not be negative")) }
}

/// The form of the CalculiX runs: one line a subject.
fn calculix<'a>(header: &[&str], material: &str, line: &impl Fn(&str) -> Option<&'a str>) -> Result<Reference, String> {
    if !material.starts_with("hyperfoam") {
        return Err(format!("material {:?} is not a hyperfoam", material.split(' ').next().unwrap_or_default()));
    }
    let list = between(material, "[[", "]]").ok_or("the line material: has no list of terms [[mu, alpha, nu], ..]")?;
    let mut block = Fields::of("the line block:", line("block:").ok_or("the header has no line block:")?);
    let held = block.values.remove("base").ok_or("the line block: states no base=")?;
    let specimen = Specimen {
        height_mm: block.need(&["height_mm"])?,
        radius_mm: block.take(&["radius_mm"])?.unwrap_or(BLOCK_RADIUS_MM),
        base: base(&held)?,
    };
    for side in ["side", "top"] {
        match block.values.remove(side).as_deref() {
            None | Some("free") => {}
            Some(other) => return Err(format!("the line block: has {side}={other}, which is not understood")),
        }
    }
    // what follows base= in brackets says which displacements are zero or free
    block.values.retain(|key, value| !(matches!(key.as_str(), "u_z" | "u_r") && value == "0"));
    block.nothing_else()?;
    let mut contact = Fields::of("the line friction:", line("friction:").unwrap_or_default());
    let friction = contact.take(&FRICTION)?.unwrap_or(0.0);
    contact.nothing_else()?;
    let radius = line("indenter_R_mm:").ok_or("the header has no line indenter_R_mm:")?;
    Ok(Reference {
        name: String::new(),
        law: law(listed_terms(list)?)?,
        specimen,
        ball: Ball { radius_mm: number("indenter_R_mm", radius)? },
        friction,
        uncertainty_percent: spread(header)?,
        rows: Vec::new(),
    })
}

/// `mu, alpha, nu], [mu, alpha, nu`.
fn listed_terms(list: &str) -> Result<Vec<Term>, String> {
    list.split("],")
        .map(|term| {
            let values: Vec<&str> = term.trim_matches([' ', '[', ']']).split(',').collect();
            let [mu, alpha, nu] = values.as_slice() else {
                return Err(format!("the term [{term}] has not the three values mu, alpha, nu"));
            };
            Ok(Term { mu_mpa: number("mu", mu)?, alpha: number("alpha", alpha)?, nu: number("nu", nu)? })
        })
        .collect()
}

/// Range of the meshes that ended well, relative to the lowest, worst over the depths they list.
fn spread(header: &[&str]) -> Result<f64, String> {
    let mut meshes: Vec<Vec<f64>> = Vec::new();
    for line in header.iter().filter(|l| l.starts_with("mesh ") && l.contains("ended ok")) {
        let list = between(line, ") = ", " N").ok_or_else(|| format!("no forces in the line {line:?}"))?;
        meshes.push(list.split_whitespace().map(|v| number("force of a mesh", v)).collect::<Result<_, _>>()?);
    }
    if meshes.len() < 2 {
        return Ok(ONE_MESH_PERCENT);
    }
    let depths = meshes.iter().map(Vec::len).min().unwrap_or(0);
    let at = |k: usize| {
        let forces = meshes.iter().map(|m| m[k]);
        let (low, high) = (forces.clone().fold(f64::INFINITY, f64::min), forces.fold(0.0, f64::max));
        100.0 * (high - low) / low
    };
    positive("spread of the meshes", (0..depths).map(at).fold(0.0, f64::max))
}

fn base(word: &str) -> Result<Base, String> {
    match word.trim() {
        "bonded" | "stuck" | "fixed" | "glued" => Ok(Base::Bonded),
        "sliding" | "roller" => Ok(Base::Sliding),
        other => Err(format!("base {other:?} is neither bonded (stuck, fixed) nor sliding (roller)")),
    }
}

fn law(terms: Vec<Term>) -> Result<Hyperfoam, String> {
    Hyperfoam::new(terms).map_err(|e| e.to_string())
}

/// `depth_mm,force_N` and the rows below it.
fn rows(text: &str) -> Result<Vec<(f64, f64)>, String> {
    let mut rows: Vec<(f64, f64)> = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') || line.starts_with("depth_mm,") {
            continue;
        }
        let at = format!("line {}", i + 1);
        let (depth, force) = line.split_once(',').ok_or_else(|| format!("{at}: {line:?} is not depth,force"))?;
        let row = (number(&format!("{at}: depth"), depth)?, number(&format!("{at}: force"), force)?);
        if rows.last().is_some_and(|before| before.0 >= row.0) {
            return Err(format!("{at}: depth = {} mm must exceed that of the row before", row.0));
        }
        rows.push(row);
    }
    match rows.last() {
        Some(last) if last.0 >= super::FROM_MM => Ok(rows),
        Some(last) => Err(format!("it ends at {} mm, before {} mm", last.0, super::FROM_MM)),
        None => Err("it has no rows".into()),
    }
}
