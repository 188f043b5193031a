//! `palpate lut`.

mod coil;
mod displacement;
mod own;
mod told;

use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::{Args, ValueEnum};
use lut_gen::solid::contact::Ball;
use lut_gen::solid::law::PronyTerm;
use lut_gen::solid::model::Specimen;
use lut_gen::solid::solve::Base;
use lut_gen::table::{self, ForceGrid, Form, GridSpec};
use miette::{IntoDiagnostic, WrapErr, miette};
use protocol::lut::{MaterialSpec, Table};
use serde_json::json;

use crate::control::{Curves, actuator_only};
use crate::extended::{self, ExtendedModel};
use crate::report::number;
use crate::report::table::{middle_field, sample_curves};

use super::control_curve::recipe::Recipe;
use super::file::save;
use super::progress::Progress;
use super::sweep;
use own::Own;
use told::{described, print};

/// What table to make, or which one to explain.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true)]
pub struct Arguments {
    #[command(subcommand)]
    sweep: Option<sweep::Command>,
    /// Radius of the ball, mm
    #[arg(long, value_name = "MM", default_value_t = 4.0)]
    ball_mm: f64,
    /// Heights of the specimens, mm; one table section each [default: 12.7,19.05,25.4; with --material those of its files]
    #[arg(long, value_name = "MM,..", value_delimiter = ',')]
    height_mm: Vec<f64>,
    /// How the specimens rest on their table
    #[arg(long, value_enum, default_value_t = BaseArgument::Bonded)]
    base: BaseArgument,
    /// Coefficient of friction between ball and specimens
    #[arg(long, value_name = "MU", default_value_t = 0.0)]
    friction: f64,
    /// A relaxation that all materials of the table share: shear part, bulk part, time in s; may be repeated
    #[arg(long, value_name = "G,K,TAU", value_parser = relaxation)]
    relax: Vec<PronyTerm>,
    /// Rates of the indentation, mm/s; with relaxation one table section each, and they decide nothing without
    #[arg(long, value_name = "MM/S,..", value_delimiter = ',', default_values_t = [1.0])]
    rate_mm_s: Vec<f64>,
    /// Model file of `palpate diagnose --model`: the table is regenerated from the extended model
    #[arg(long, value_name = "FILE")]
    model: Option<PathBuf>,
    /// Own materials for the board to recognise and display, any number: model files of `palpate identify --save` or of
    /// `palpate diagnose`. They stand in the place of the thesis' foams
    #[arg(long, value_name = "FILE", num_args = 1.., conflicts_with = "model")]
    material: Vec<PathBuf>,
    /// Control curves of the display's coil, a file a material, for materials of the library by their names. The thesis'
    /// foams have curves of their own; a material without one is displayed by the actuator alone
    #[arg(long, value_name = "FILE", num_args = 1..)]
    control: Vec<PathBuf>,
    /// Displacement tables of `palpate displacement`, a file a material, for materials of the library by their names: the
    /// actuator displays them alone
    #[arg(long, value_name = "FILE", num_args = 1..)]
    displacement: Vec<PathBuf>,
    /// Make the control curves of own materials that have none by --control, with the options below: some minutes for each
    /// height of each material
    #[arg(long)]
    make_control: bool,
    #[command(flatten)]
    recipe: Recipe,
    /// Number of the press on its spot, for materials that soften: from 2 on the table is of a used spot
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..))]
    cycle: u8,
    /// rows: one row an exponent, mu continuous; columns: all pairs, as in the thesis
    #[arg(long, value_enum, default_value_t = FormArgument::Rows)]
    form: FormArgument,
    /// File to write; pictures of sample curves and of a specimen's inside are written beside it
    #[arg(long, value_name = "FILE", default_value = "out/lut.bin")]
    out: PathBuf,
    /// Print one JSON object on standard output
    #[arg(long)]
    json: bool,
    /// Explain an existing table instead: axes, provenance, error bound
    #[arg(long, value_name = "FILE")]
    explain: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum BaseArgument {
    Bonded,
    Sliding,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FormArgument {
    Rows,
    Columns,
}

/// Computes and writes a table, or explains one.
///
/// # Errors
/// Values out of range, a failing solve, a file that cannot be written or is no table.
pub fn run(arguments: &Arguments) -> miette::Result<()> {
    match (&arguments.sweep, &arguments.explain) {
        (Some(command), _) => sweep::run(command),
        (None, Some(file)) => explain(file, arguments.json),
        (None, None) => make(arguments),
    }
}

fn make(arguments: &Arguments) -> miette::Result<()> {
    let start = Instant::now();
    check("--ball-mm", arguments.ball_mm)?;
    arguments.recipe.check()?;
    for height in &arguments.height_mm {
        check("--height-mm", *height)?;
    }
    let model = arguments.model.as_deref().map(ExtendedModel::read).transpose()?;
    let own = Own::read(arguments)?;
    let curves = Curves::read(&arguments.control).into_diagnostic()?;
    let heights = match &own {
        Some(own) => own.heights_mm(),
        None => sorted(if arguments.height_mm.is_empty() { &USUAL_MM } else { &arguments.height_mm }),
    };
    let mut specs = specs(arguments, model.as_ref(), &heights)?;
    if let Some(own) = &own {
        specs.iter_mut().for_each(|spec| own.cover(spec));
    }
    let heights: Vec<f64> = specs.iter().map(|spec| spec.specimen.height_mm).collect();
    let rates = rates(arguments, specs.iter().any(|spec| !spec.relaxation.is_empty()))?;
    let progress = Progress::new();
    let mut grids = Vec::new();
    for (rate_mm_s, spec) in rates.iter().flat_map(|rate| specs.iter().map(move |spec| (rate, spec))) {
        let spec = GridSpec { rate_mm_s: *rate_mm_s, ..spec.clone() };
        let height_mm = spec.specimen.height_mm;
        let what = match rates.len() {
            1 => format!("height {} mm", number(height_mm)),
            _ => format!("height {} mm at {} mm/s", number(height_mm), number(*rate_mm_s)),
        };
        let grid = ForceGrid::build(&spec, &|done, total| progress.set(&what, done, total))
            .into_diagnostic()
            .wrap_err_with(|| format!("no table for a height of {height_mm} mm"))?;
        grids.push(grid);
    }
    let form = match arguments.form {
        FormArgument::Rows => Form::Factored,
        FormArgument::Columns => Form::Expanded,
    };
    let mut library = match &own {
        Some(own) => own.library(&grids, &rates)?,
        None => library(&grids, &heights, model.as_ref(), &curves)?,
    };
    curves.give(&mut library).into_diagnostic()?;
    if arguments.make_control {
        let files: Vec<&Path> = arguments.material.iter().chain(&arguments.model).map(AsRef::as_ref).collect();
        coil::make((&arguments.recipe, &files, arguments.model.is_some()), &curves, &mut library)?;
    }
    displacement::give(&arguments.displacement, &mut library)?;
    let alone = actuator_only(&library).join(", ");
    if !alone.is_empty() {
        errln!(
            "without control curve, displayed by the actuator alone: {alone}; --control gives curves, --make-control makes them"
        );
    }
    let bytes = table::write(&grids, form, library).into_diagnostic()?;
    save(&arguments.out, &bytes)?;
    let picture = arguments.out.with_extension("svg");
    save(&picture, sample_curves(&grids).as_bytes())?;
    let inside = arguments.out.with_extension("field.svg");
    save(&inside, middle_field(&grids[0]).into_diagnostic()?.as_bytes())?;
    let table = parsed(&arguments.out, &bytes)?;
    if arguments.json {
        let mut answer = described(&table, bytes.len());
        answer["file"] = json!(arguments.out.display().to_string());
        answer["picture"] = json!(picture.display().to_string());
        answer["field_picture"] = json!(inside.display().to_string());
        answer["fe_solves"] = json!(grids.iter().map(|grid| grid.solves).sum::<usize>());
        answer["seconds"] = json!(start.elapsed().as_secs_f64());
        outln!("{answer}");
    } else {
        print(&table, bytes.len());
        outln!("table       {}", arguments.out.display());
        outln!("picture     {}", picture.display());
        outln!("inside      {}", inside.display());
        outln!("time        {:.1} s", start.elapsed().as_secs_f64());
    }
    Ok(())
}

/// Heights of the thesis' foams, mm.
const USUAL_MM: [f64; 3] = [12.7, 19.05, 25.4];

/// Rising, and each once.
fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    sorted
}

/// The thesis' foams, and the material of a model beside them.
fn library(
    grids: &[ForceGrid],
    heights: &[f64],
    model: Option<&ExtendedModel>,
    curves: &Curves,
) -> miette::Result<Vec<MaterialSpec>> {
    // Only foams the table has a section for can be recognised with it.
    let mut foams = table::foams();
    foams.retain(|foam| heights.iter().any(|height| (height - foam.height_mm).abs() < 1e-6));
    let mut library = Vec::new();
    for grid in grids.iter().step_by(heights.len()) {
        library.extend(table::library(&foams, &grid.spec).into_diagnostic()?);
    }
    curves.give_built_in(&mut library).iter().for_each(|sentence| errln!("{sentence}"));
    if let Some(model) = model {
        let own = extended::board::library(model, grids).into_diagnostic()?;
        if own.is_empty() {
            let name = &model.material;
            errln!("{name} is not in the library: the table has none of its heights; --height-mm adds them");
        }
        library.retain(|one| own.iter().all(|other| one.name != other.name));
        library.extend(own);
    }
    Ok(library)
}

/// A grid as it is asked for, without a model.
fn declared(arguments: &Arguments, height_mm: f64) -> GridSpec {
    let base = match arguments.base {
        BaseArgument::Bonded => Base::Bonded,
        BaseArgument::Sliding => Base::Sliding,
    };
    let ball = Ball { radius_mm: arguments.ball_mm };
    GridSpec {
        friction: arguments.friction,
        relaxation: arguments.relax.clone(),
        ..GridSpec::thesis(Specimen { base, ..Specimen::of_height(height_mm) }, ball)
    }
}

/// One grid a height, rising, with the effects of a model: heights are those declared, and become the model's. Says
/// on standard error what of the model is in the table and what is not.
fn specs(arguments: &Arguments, model: Option<&ExtendedModel>, heights: &[f64]) -> miette::Result<Vec<GridSpec>> {
    let declared = heights.iter().map(|height_mm| declared(arguments, *height_mm));
    let Some(model) = model else { return Ok(declared.collect()) };
    let (mut specs, mut told) = (Vec::new(), Vec::new());
    for declared in declared {
        let height = number(declared.specimen.height_mm);
        let made = model.on_board(&declared, usize::from(arguments.cycle)).into_diagnostic()?;
        told.extend(made.kept.iter().map(|words| (format!("in the table      {words}"), height.clone())));
        told.extend(made.left_out.iter().map(|words| (format!("not in the table  {words}"), height.clone())));
        specs.push(made.spec);
    }
    let mut said: Vec<&String> = Vec::new();
    for (sentence, _) in &told {
        if said.contains(&sentence) {
            continue;
        }
        said.push(sentence);
        let of: Vec<&str> = told.iter().filter(|t| t.0 == *sentence).map(|t| t.1.as_str()).collect();
        let where_to = if of.len() < heights.len() { format!(" [height {} mm]", of.join(", ")) } else { String::new() };
        errln!("{sentence}{where_to}");
    }
    specs.sort_by(|a, b| a.specimen.height_mm.total_cmp(&b.specimen.height_mm));
    Ok(specs)
}

/// The rates that need a section: all with relaxation, rising and each once; the first without.
fn rates(arguments: &Arguments, relaxing: bool) -> miette::Result<Vec<f64>> {
    let mut rates = arguments.rate_mm_s.clone();
    if let Some(rate) = rates.iter().find(|rate| !(0.01..=100.0).contains(*rate)) {
        return Err(miette!("--rate-mm-s is {rate}; expected a rate of 0.01 to 100 mm/s"));
    }
    rates.sort_by(f64::total_cmp);
    rates.dedup();
    if !relaxing {
        rates.truncate(1);
    }
    Ok(rates)
}

/// `G,K,TAU`; its ranges are checked where the material is made.
fn relaxation(text: &str) -> Result<PronyTerm, String> {
    let parts: Result<Vec<f64>, _> = text.split(',').map(|x| x.trim().parse()).collect();
    match parts.as_deref() {
        Ok(&[g, k, tau_s]) => Ok(PronyTerm { g, k, tau_s }),
        _ => Err("expected three numbers G,K,TAU, such as 0.3,0.3,1.5".to_owned()),
    }
}

fn check(argument: &str, value_mm: f64) -> miette::Result<()> {
    if (0.5..=200.0).contains(&value_mm) {
        return Ok(());
    }
    Err(miette!("{argument} is {value_mm}; expected a length of 0.5 to 200 mm"))
}

fn parsed<'a>(file: &Path, bytes: &'a [u8]) -> miette::Result<Table<'a>> {
    Table::parse(bytes).map_err(|cause| miette!("{} is not a usable table: {cause}", file.display()))
}

fn explain(file: &Path, as_json: bool) -> miette::Result<()> {
    let bytes =
        std::fs::read(file).into_diagnostic().wrap_err_with(|| format!("cannot read the table {}", file.display()))?;
    if sweep::is_table(&bytes) {
        return sweep::explain(file, &bytes, as_json);
    }
    let table = parsed(file, &bytes)?;
    if as_json {
        outln!("{}", described(&table, bytes.len()));
    } else {
        print(&table, bytes.len());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use protocol::lut::{AxisSpec, CoilSpec, DisplaySpec, Role, Scale, TableSpec, axis_name};

    use super::*;

    fn small_table() -> Vec<u8> {
        small_spec().to_bytes().unwrap()
    }

    fn small_spec() -> TableSpec {
        let axis =
            |name: &str, unit: &str, role, values: &[f64]| AxisSpec::new(name, unit, role, Scale::Linear, values);
        TableSpec {
            axes: vec![
                axis(axis_name::DEPTH, "mm", Role::Row, &[1.0, 2.0, 3.0]),
                axis(axis_name::ALPHA, "", Role::Column, &[1.0, 5.0]),
                axis(axis_name::MU, "MPa", Role::Factor, &[0.1, 0.2, 0.3]),
            ],
            columns: vec![vec![1.0, 3.0, 6.0], vec![0.5, 1.0, 1.5]],
            library: Vec::new(),
            discretisation: 0.002,
            interpolation: 0.0005,
            provenance: "by hand".to_owned(),
        }
    }

    /// A material that a coil shows in part, and one that it does not show.
    fn table_of_two() -> Vec<u8> {
        let display = DisplaySpec::even(1.0, &[0.5, 1.0, 1.5]);
        let coil = CoilSpec { current_a: vec![0.0, 0.5, 1.0, 1.5], reachable_n: (0.5, 2.0), bound_a: 0.0625 };
        let material = |name: &str, display: DisplaySpec| MaterialSpec {
            name: name.to_owned(),
            mu_mpa: 0.1,
            alpha: 2.0,
            height_mm: 20.0,
            acceptance: 0.03,
            rate_mm_s: 0.0,
            force_n: vec![1.0, 2.0, 3.0],
            display,
        };
        let library =
            vec![material("ICF", DisplaySpec { coil: Some(coil), ..display.clone() }), material("granite", display)];
        TableSpec { library, ..small_spec() }.to_bytes().unwrap()
    }

    #[test]
    fn what_the_display_can_show_is_told_of_every_material() {
        let bytes = table_of_two();
        let table = parsed(Path::new("t"), &bytes).unwrap();
        let sentences: Vec<String> = table.materials().map(|material| told::display(&material)).collect();
        assert_eq!(
            sentences,
            [
                "shaft from 0 to 3 N; coil from 0.5 to 2 N within 0.0625 A, held at its limit beyond (unreachable)",
                "shaft from 0 to 3 N; no control curve: the actuator displays alone"
            ]
        );
        let described = described(&table, bytes.len());
        let display = |material: usize| &described["materials"][material]["display"];
        assert_eq!((&display(0)["reachable_N"], &display(0)["actuator_only"]), (&json!([0.5, 2.0]), &json!(false)));
        assert_eq!((&display(1)["reachable_N"], &display(1)["actuator_only"]), (&json!(null), &json!(true)));
        assert_eq!(described["version"], 2);
    }

    fn refusal(bytes: &[u8]) -> String {
        parsed(Path::new("out/lut.bin"), bytes).expect_err("refused").to_string()
    }

    #[test]
    fn a_good_table_is_described() {
        let bytes = small_table();
        let described = described(&parsed(Path::new("t"), &bytes).unwrap(), bytes.len());
        assert_eq!(described["axes"][1]["name"], "alpha");
        assert_eq!(described["axes"][2]["role"], "factor");
        assert_eq!(described["provenance"], "by hand");
        assert!((described["error_bound"]["discretisation"].as_f64().unwrap() - 0.002).abs() < 1e-6);
    }

    #[test]
    fn a_damaged_table_is_refused_with_its_reason() {
        let bytes = small_table();
        let cut = refusal(&bytes[..bytes.len() - 10]);
        assert!(cut.starts_with("out/lut.bin is not a usable table: "), "{cut}");
        assert!(cut.contains(&bytes.len().to_string()), "the expected length is named: {cut}");
        let mut other = bytes.clone();
        other[8] = 7;
        assert!(refusal(&other).contains("version"), "{}", refusal(&other));
        assert!(!refusal(b"P").is_empty() && !refusal(b"").is_empty());
    }
}
