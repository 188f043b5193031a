//! The whole bench: palpation arm with load cell over a foam, and display under a finger.

use firmware::board::Outputs;
use firmware::sensor::RawSamples;

use super::{
    Actuator, Arm, Broken, Built, Coil, Constants, Converter, Finger, Fluid, Foam, Fsr, FsrFlaws, Hand, Input, Jitter,
    LoadCell, Noise, OVERSAMPLED, Placed, Potentiometer, Press, STEP_S, Source, Touch, Transducer, Truth, Under,
};

/// Height of the arm's home above the specimen, mm: the approach in which the board learns the force's zero.
const HOME_MM: f64 = 4.0;

/// Home without a specimen, mm.
const EMPTY_HOME_MM: f64 = 30.0;

/// Rate of the arm on its way home, mm/s.
const RETURN_MM_S: f64 = 10.0;

/// Supply of the coil, V.
const COIL_SUPPLY_V: f64 = 15.0;

/// Shunt amplifier of the coil: reading without current, and A for the full reference.
const SHUNT: (f64, f64) = (0.05, 3.3);

/// Line of the FSR at no force, mS, and its fixed resistor, kOhm.
const FSR_OFFSET_MS: f64 = -0.016;
const FSR_DIVIDER_KOHM: f64 = 10.0;

/// Analog inputs of the board.
const INPUTS: usize = 5;

/// Everything around the board.
#[derive(Debug, Clone)]
pub struct Bench {
    seed: u64,
    jitter: Jitter,
    gain: Noise,
    surface: Noise,
    placements: u64,
    arm: Arm,
    home_mm: f64,
    placed: Option<Placed>,
    load_cell: LoadCell,
    transducer: Transducer,
    finger: Finger,
    /// In the finger's place: a hand that moves a bone.
    hand: Option<Hand>,
    fsr: Fsr,
    actuator: Actuator,
    potentiometer: Potentiometer,
    coil: Coil,
    fluid: Fluid,
    converter: Converter,
    broken: [Option<Broken>; INPUTS],
    /// What the pins hold, as fractions of the reference.
    pins: [f64; INPUTS],
    /// A known force on the display's force sensor, N.
    weight_n: Option<f64>,
    /// The display's potentiometer rides on the finger instead of the shaft.
    rides: bool,
}

impl Bench {
    /// An empty bench at rest. The sensors follow the laws that the board is calibrated for, but
    /// not exactly: the load cell's zero lies 0.03 N off until it is tared and its sensitivity 0.5
    /// % high, the probe's transducer is 0.2 % short, and the FSR follows the thesis' rounded line,
    /// not the least-squares one of Table 7. The potentiometer is as the board believes; the coil
    /// is that of the magnet's file, with the heat of its varnish.
    pub fn new(seed: u64, jitter: Jitter) -> Self {
        Bench {
            seed,
            jitter,
            gain: Noise::new(seed, Source::Gain),
            surface: Noise::new(seed, Source::Surface),
            placements: 0,
            arm: Arm::new(EMPTY_HOME_MM),
            home_mm: EMPTY_HOME_MM,
            placed: None,
            load_cell: LoadCell { zero_ratio: 0.103, n_per_ratio: 10.05 },
            transducer: Transducer { zero_ratio: 0.1, mm_per_ratio: 99.8 },
            finger: Finger::new(seed),
            hand: None,
            fsr: Fsr::new(0.079, FSR_OFFSET_MS, FSR_DIVIDER_KOHM, seed),
            actuator: Actuator::new(0.0),
            potentiometer: Potentiometer { slope_kohm_mm: -0.080_279, offset_kohm: 2.5829, divider_kohm: 1.6 },
            coil: Coil::default(),
            fluid: Fluid::default(),
            converter: Converter::new(seed),
            broken: [None; INPUTS],
            pins: [0.0; INPUTS],
            weight_n: None,
            rides: false,
        }
    }

    /// The same with a display of these constants under a hand: `under` is what the finger presses, `fluid` the fluid of a
    /// built display. Beside a fluid the force sensor has no threshold and no flaws but its noise: in the thesis it is a load
    /// cell there (section 4.4).
    #[must_use]
    pub fn with(self, constants: &Constants, under: Under, fluid: Option<Built>) -> Self {
        let slope_ms = constants.fsr_slope_ms;
        let fsr = match &under {
            Under::Cap => Fsr::new(slope_ms, FSR_OFFSET_MS, FSR_DIVIDER_KOHM, self.seed).with(constants.fsr),
            Under::Fluid(_) => Fsr::new(slope_ms, 0.0, FSR_DIVIDER_KOHM, self.seed)
                .with(FsrFlaws { noise: constants.fsr.noise, ..FsrFlaws::NONE }),
        };
        Bench {
            hand: Some(Hand::new(constants.hand, constants.pulp.clone(), under, self.seed)),
            fsr,
            actuator: Actuator::with(0.0, constants.law, constants.actuator),
            fluid: fluid.map_or_else(Fluid::default, Fluid::built),
            ..self
        }
    }

    /// Begins a press of the hand, where there is one.
    pub fn press(&mut self, press: Press) {
        if let Some(hand) = &mut self.hand {
            hand.press(press);
        }
    }

    /// Place of the finger's tip, were it not compressed, below the surface, mm; without a hand 0.
    pub fn bone_mm(&self) -> f64 {
        self.hand.as_ref().map_or(0.0, Hand::bone_mm)
    }

    /// Lets the display's potentiometer ride on the hand's finger instead of the shaft, or takes it off.
    pub fn ride(&mut self, rides: bool) {
        self.rides = rides;
    }

    /// Loads the force sensor with a known force, N, in place of the finger; `None` takes it off.
    pub fn weigh(&mut self, force_n: Option<f64>) {
        self.weight_n = force_n;
    }

    /// Force of the finger, or of a weight, on the display, N.
    fn finger_n(&self) -> f64 {
        let finger_n = self.hand.as_ref().map_or_else(|| self.finger.force_n(), Hand::force_n);
        self.weight_n.unwrap_or(finger_n)
    }

    /// Lays a foam under the probe and sets the arm's home above it, as an operator does between palpations.
    pub fn place(&mut self, foam: Foam) {
        self.placements += 1;
        self.home_mm = foam.height_mm + HOME_MM;
        self.arm = Arm::new(self.home_mm);
        // A stream of force noise of its own for every palpation.
        let seed = self.seed.wrapping_add(self.placements << 32);
        self.placed = Some(Placed::new(foam, self.jitter, &mut self.gain, &mut self.surface, seed));
    }

    /// Clears the bench.
    pub fn clear(&mut self) {
        self.placed = None;
    }

    /// The foam under the probe.
    pub fn placed(&self) -> Option<&Placed> {
        self.placed.as_ref()
    }

    /// Starts pressing the display, or lifts the finger.
    pub fn touch(&mut self, touch: Option<Touch>) {
        self.finger.set(touch);
    }

    /// Draws what is new with every 50 Hz sample.
    pub fn next_sample(&mut self) {
        self.fsr.next_sample();
        if let Some(placed) = &mut self.placed {
            placed.next_sample();
        }
    }

    /// Breaks the sensor of an input, or mends it.
    pub fn set_broken(&mut self, input: Input, broken: Option<Broken>) {
        self.broken[input as usize] = broken;
    }

    /// Lets [`STEP_S`] pass under the board's outputs and the fast loop's duty; returns what the converter then reads.
    pub fn step(&mut self, outputs: &Outputs, coil_duty: f32) -> RawSamples {
        self.advance(outputs, coil_duty);
        let ratios = self.pins;
        RawSamples::from_channels(ratios.map(|true_ratio| self.converter.ratio(true_ratio)))
    }

    /// What the inputs' next readings see, by input and reading, in codes and not rounded: for a board with a converter of its own. The noise
    /// is that of [`Bench::step`].
    pub fn voltages(&mut self) -> [[f64; OVERSAMPLED]; INPUTS] {
        let ratios = self.pins;
        ratios.map(|true_ratio| self.converter.voltages(true_ratio))
    }

    /// Lets [`STEP_S`] pass without a reading.
    pub fn advance(&mut self, outputs: &Outputs, coil_duty: f32) {
        let rate_mm_s = if outputs.arm_run {
            -f64::from(outputs.arm_rate_mm_s)
        } else {
            // Slows down on the last stretch so as not to overshoot its home.
            (20.0 * (self.home_mm - self.arm.position_mm())).clamp(-RETURN_MM_S, RETURN_MM_S)
        };
        self.arm.step(rate_mm_s, STEP_S);
        match &mut self.hand {
            Some(hand) => hand.step(self.actuator.cap_mm(hand.force_n()), self.fluid.yield_kpa(), STEP_S),
            None => self.finger.step(self.actuator.rate_mm_s(), STEP_S),
        }
        self.fsr.step(self.finger_n(), STEP_S);
        self.actuator.step(f64::from(outputs.actuator_v), self.finger_n(), STEP_S);
        self.coil.step(f64::from(coil_duty) * COIL_SUPPLY_V, STEP_S);
        self.fluid.step(self.coil.current_a(), STEP_S);
        self.pins = self.ratios();
    }

    /// True voltages at the inputs, as fractions of the reference.
    fn ratios(&self) -> [f64; INPUTS] {
        let probe_mm = self.arm.position_mm();
        let felt_n = self.placed.as_ref().map_or(0.0, |p| p.felt_n(probe_mm));
        let sound = [
            self.load_cell.ratio(felt_n),
            self.fsr.ratio(),
            self.potentiometer.ratio(if self.rides { self.bone_mm().max(0.0) } else { self.actuator.position_mm() }),
            self.transducer.ratio(probe_mm),
            SHUNT.0 + self.coil.current_a() / SHUNT.1,
        ];
        let before = |i: usize| self.pins[(i + INPUTS - 1) % INPUTS];
        std::array::from_fn(|i| match self.broken[i] {
            None => sound[i],
            Some(Broken::Low) => 0.0,
            Some(Broken::High) => 1.0,
            Some(Broken::Stuck(ratio)) => ratio,
            Some(Broken::Floating(pin)) => pin.drift(self.pins[i], before(i)),
        })
    }

    /// What no sensor says, for the board's tick number `tick` at `time_s`.
    pub fn truth(&self, tick: u32, time_s: f64) -> Truth {
        let probe_mm = self.arm.position_mm();
        let placed = self.placed.as_ref();
        Truth {
            tick,
            time_s,
            specimen: placed.map_or_else(String::new, |p| p.foam().name.clone()),
            probe_mm,
            depth_mm: placed.map_or(0.0, |p| p.depth_mm(probe_mm).max(0.0)),
            force_n: placed.map_or(0.0, |p| p.force_n(probe_mm)),
            finger_n: self.finger_n(),
            shaft_mm: self.actuator.position_mm(),
            coil_a: self.coil.current_a(),
            coil_c: self.coil.celsius(),
            flux_t: self.fluid.flux_t(),
            yield_kpa: self.fluid.yield_kpa(),
        }
    }
}
