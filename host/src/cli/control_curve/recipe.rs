//! How a control curve is made: magnet, finger, fluid, and what is assumed of them.

use clap::Args;
use lut_gen::pad::body::finger::Finger;
use miette::{IntoDiagnostic, WrapErr, miette};

use super::magnets;
use crate::cli::range::within;
use crate::control::ControlCurve;
use crate::control::compose::{Links, compose};
use crate::control::study::{Asked, FluidBody, Study, Told};
use crate::finger::Described;
use crate::finger::opposite::Block;

/// Options of every command that makes control curves.
#[derive(Debug, Args)]
#[command(next_help_heading = "Control curves")]
pub(in crate::cli) struct Recipe {
    /// The magnet: a magnet.toml, readings (.csv with current_A and flux_T), or the name of one that comes with the program
    #[arg(long, value_name = "FILE", default_value = "ring")]
    pub magnet: String,
    /// The finger: a finger.toml, or the name of one that comes with the program
    #[arg(long, value_name = "FILE", default_value = "round")]
    pub finger: String,
    /// The fluid: a fluid.toml, or the name of one that the program knows
    #[arg(long, value_name = "FILE", default_value = "MRF-122EG")]
    pub fluid: String,
    /// How far the finger's bone goes, mm
    #[arg(long, value_name = "MM", default_value_t = 4.0)]
    pub travel_mm: f64,
    /// Length of the finger's elements, mm
    #[arg(long, value_name = "MM", default_value_t = 0.4)]
    element_mm: f64,
    /// Height and radius of the fluid under the finger, mm
    #[arg(long, value_name = "MM,MM", value_delimiter = ',', default_values_t = [25.4, 25.0])]
    fluid_mm: Vec<f64>,
    /// Strain at which the fluid yields, and Poisson's ratio below it (assumed)
    #[arg(long, value_name = "STRAIN,NU", value_delimiter = ',', default_values_t = [0.01, 0.45])]
    fluid_elastic: Vec<f64>,
    /// Largest current of the driver, A
    #[arg(long, value_name = "A", default_value_t = 2.5)]
    current: f64,
    /// Largest loop gain of the display: 1 latches
    #[arg(long, value_name = "GAIN", default_value_t = 0.8)]
    loop_gain: f64,
    /// What the contact's area counts beside the force's 1; 0: the curve whose force is nearest
    #[arg(long, value_name = "WEIGHT", default_value_t = 0.5)]
    area_weight: f64,
    /// Do not search the best curve of twelve knots that the cubic is compared with: minutes less
    #[arg(long)]
    quick: bool,
}

/// A recipe whose files are read and whose magnet is computed.
pub(in crate::cli) struct Opened<'a> {
    recipe: &'a Recipe,
    /// The finger.
    pub finger: Described,
    /// Magnet and fluid.
    pub links: Links,
}

impl Recipe {
    /// Refuses what is out of range, before anything is computed.
    ///
    /// # Errors
    /// The option, its value and what was expected.
    pub fn check(&self) -> miette::Result<()> {
        within("--travel-mm", self.travel_mm, 0.5..=8.0, "mm")?;
        within("--element-mm", self.element_mm, 0.1..=1.0, "mm")?;
        within("--current", self.current, 0.1..=f64::from(protocol::lut::CURRENT_MAX_A), "A")?;
        within("--loop-gain", self.loop_gain, 0.1..=0.95, "")?;
        within("--area-weight", self.area_weight, 0.0..=10.0, "")?;
        for (name, list) in [("fluid-mm", &self.fluid_mm), ("fluid-elastic", &self.fluid_elastic)] {
            if list.len() != 2 {
                return Err(miette!("--{name} has {} numbers; expected two with a comma", list.len()));
            }
        }
        for (value, what) in self.fluid_mm.iter().zip(["height", "radius"]) {
            within(&format!("--fluid-mm ({what})"), *value, 2.0..=100.0, "mm")?;
        }
        within("--fluid-elastic (strain)", self.fluid_elastic[0], 1e-3..=0.2, "")?;
        within("--fluid-elastic (nu)", self.fluid_elastic[1], 0.0..=0.499, "")
    }

    /// Reads finger and fluid, and computes the magnet.
    ///
    /// # Errors
    /// A file with a mistake, a drawing that cannot be solved.
    pub fn opened(&self) -> miette::Result<Opened<'_>> {
        let finger = crate::finger::located(&self.finger)?;
        let fluid = crate::cli::magnet::fluid::found(&self.fluid)?;
        let links = magnets::links(&self.magnet, &fluid, self.current)?;
        Ok(Opened { recipe: self, finger, links })
    }

    /// How a curve was made, without what its file says already.
    fn provenance(&self) -> String {
        format!(
            "palpate {} control-curve: travel {} mm, elements {} mm, fluid {} mm high and {} mm of radius, yield \
             strain {} and nu {}, loop gain at most {}, area counts {}",
            env!("CARGO_PKG_VERSION"),
            self.travel_mm,
            self.element_mm,
            self.fluid_mm[0],
            self.fluid_mm[1],
            self.fluid_elastic[0],
            self.fluid_elastic[1],
            self.loop_gain,
            self.area_weight,
        )
    }
}

impl Opened<'_> {
    /// The study of a material, and its control curve.
    ///
    /// # Errors
    /// A material without law, a press without equilibrium, a curve that nothing reaches.
    pub fn make(&self, block: &Block, told: Told<'_>) -> miette::Result<(Study, ControlCurve)> {
        let what = || format!("the control curve of {}", block.name);
        let study = self.asked(block)?.study(told).into_diagnostic().wrap_err_with(what)?;
        let names = (block.name.as_str(), self.finger.title.as_str());
        let curve = compose(&study, &self.links, names, &self.recipe.provenance());
        Ok((study, curve.into_diagnostic().wrap_err_with(what)?))
    }

    fn asked(&self, block: &Block) -> miette::Result<Asked> {
        let recipe = self.recipe;
        let material = block.material().into_diagnostic().wrap_err_with(|| format!("the material {}", block.name))?;
        Ok(Asked {
            section: self.finger.section,
            finger: Finger { edge_mm: recipe.element_mm, ..self.finger.finger.clone() },
            material,
            height_mm: block.height_mm,
            fluid: FluidBody {
                height_mm: recipe.fluid_mm[0],
                radius_mm: recipe.fluid_mm[1],
                yield_strain: recipe.fluid_elastic[0],
                nu: recipe.fluid_elastic[1],
            },
            most_mm: recipe.travel_mm,
            best: !recipe.quick,
            most_gain: recipe.loop_gain,
            area_weight: recipe.area_weight,
        })
    }
}
