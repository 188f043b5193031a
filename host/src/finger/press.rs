//! A finger's press by finite elements, with the mesh that its states are drawn on.

use lut_gen::pad::body::Body;
use lut_gen::pad::body::block::Block as Meshed;
use lut_gen::pad::body::finger::Finger;
use lut_gen::pad::body::section::{Rule, Section};
use lut_gen::pad::contact::friction::Friction;
use lut_gen::pad::contact::rigid::{Rigid, Shape};
use lut_gen::pad::error::PadError;
use lut_gen::pad::press::{Now, Press, Side};
use lut_gen::pad::state::State;

use super::Described;
use super::opposite::Opposite;

/// A press that is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// The finger.
    pub finger: Described,
    /// What it is pressed on.
    pub on: Opposite,
    /// Travels of the bone, mm, rising from 0.
    pub travels_mm: Vec<f64>,
    /// How fast it moves, mm/s; tells only where something relaxes.
    pub speed_mm_s: f64,
    /// Coefficient of friction, 0 to 2.
    pub friction: f64,
    /// Radius of the block, in the plane its half width, mm.
    pub radius_mm: f64,
    /// The block's base slides instead of being bonded.
    pub slides: bool,
}

/// Shear at which friction is whole, as a slip (mm): far below what meshes leave.
const CREEP_MM: f64 = 1e-4;
/// Elements of the block over those of the finger: its surface is flat.
const BLOCK_EDGE: f64 = 1.5;
/// Longest step in travel (mm), and the part of the shortest time constant that a step may last.
const STEP_MM: f64 = 0.25;

/// States of a press, and the mesh of both bodies.
#[derive(Debug, Clone)]
pub struct Pressed {
    /// What was asked for.
    pub section: Section,
    /// One a travel.
    pub states: Vec<State>,
    /// Positions of the nodes at rest, mm: the finger's, then the block's.
    pub nodes: Vec<[f64; 2]>,
    /// Elements of both.
    pub elements: Vec<[usize; 8]>,
    /// Layer of every element: 0 skin, 1 tissue, 2 block.
    pub layer: Vec<usize>,
    /// Number of the block's first node; the number of all on a plate.
    pub lower: usize,
    /// Length of the elements in the pad, mm.
    pub edge_mm: f64,
    /// Part of its body's volume at rest that a node of the block stands for.
    pub share: Vec<f64>,
}

impl Asked {
    /// Presses, with all elements `coarser` times as long; `told` hears how many travels are done.
    ///
    /// # Errors
    /// [`PadError`]: measures that make no bodies, or no equilibrium.
    pub fn press(&self, coarser: f64, told: &mut dyn FnMut(usize)) -> Result<Pressed, PadError> {
        let finger = Finger { edge_mm: coarser * self.finger.finger.edge_mm, ..self.finger.finger.clone() };
        let upper = finger.body()?;
        let lower = match &self.on {
            Opposite::Plate => None,
            Opposite::Block(block) => Some(
                Meshed {
                    height_mm: block.height_mm,
                    radius_mm: self.radius_mm,
                    top_mm: -finger.height_mm,
                    bonded: !self.slides,
                    material: block.material()?,
                    edge_mm: BLOCK_EDGE * finger.edge_mm,
                    fine_mm: finger.half_width_mm.min(self.radius_mm),
                }
                .body()?,
            ),
        };
        let mut pressed = Pressed::of(self.finger.section, finger.edge_mm, &upper, lower.as_ref());
        let below = match lower {
            Some(body) => Side::Soft(body),
            None => Side::Rigid(Rigid { shape: Shape::Plate, tip_mm: -finger.height_mm }),
        };
        let mut press = Press::new(self.finger.section, Side::Soft(upper), below);
        press.step_mm = STEP_MM;
        press.friction = (self.friction > 0.0).then_some(Friction { coefficient: self.friction, creep_mm: CREEP_MM });
        let at = |&travel_mm: &f64| Now { time_s: travel_mm / self.speed_mm_s, travel_mm, force_n: 0.0 };
        let motion: Vec<Now> = self.travels_mm.iter().map(at).collect();
        let mut done = 0;
        pressed.states = press.follow_telling(&motion, &mut |_| {
            done += 1;
            told(done);
        })?;
        Ok(pressed)
    }
}

impl Pressed {
    fn of(section: Section, edge_mm: f64, upper: &Body, lower: Option<&Body>) -> Self {
        let first = upper.nodes.len();
        let mut own = Pressed {
            section,
            states: Vec::new(),
            nodes: upper.nodes.clone(),
            elements: upper.elements.clone(),
            layer: upper.of.clone(),
            lower: first,
            edge_mm,
            share: Vec::new(),
        };
        let Some(lower) = lower else { return own };
        own.nodes.extend(&lower.nodes);
        own.elements.extend(lower.elements.iter().map(|e| e.map(|n| n + first)));
        own.layer.extend(lower.elements.iter().map(|_| 2));
        own.share = shares(section, lower);
        own
    }

    /// How many equations were solved at every step, about.
    pub fn unknowns(&self) -> usize {
        2 * self.nodes.len()
    }
}

/// Parts of a body's volume that its nodes stand for: an eighth of every element's.
fn shares(section: Section, body: &Body) -> Vec<f64> {
    let mut share = vec![0.0; body.nodes.len()];
    for nodes in &body.elements {
        let at = nodes.map(|n| body.nodes[n]);
        let volume = section.element(Rule::Full, *nodes, &at).map_or(0.0, |e| e.volumes().sum::<f64>());
        nodes.iter().for_each(|n| share[*n] += volume / 8.0);
    }
    let whole: f64 = share.iter().sum();
    share.iter_mut().for_each(|part| *part /= whole);
    share
}
