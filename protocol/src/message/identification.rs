//! The answer to a palpation.

use crate::wire::wire;

wire! {
    /// What one palpation found.
    pub struct Verdict {
        /// Number of the palpation since start.
        pub palpation: u32,
        /// How it ended.
        pub outcome: Outcome,
        /// Rate, mm/s.
        pub rate_mm_s: f32,
        /// Height of the specimen at contact, mm.
        pub height_mm: f32,
        /// Height of the table's slice that was searched, mm.
        pub table_height_mm: f32,
        /// Shear modulus, MPa: between the columns of the grid, by least squares at the refined contact point.
        pub mu_mpa: f32,
        /// Exponent, likewise.
        pub alpha: f32,
        /// Mean absolute difference of the best column (Eq. 17 over the number of samples), N.
        pub error_n: f32,
        /// The same of the best column that is not a neighbour of the best one, N.
        pub runner_up_error_n: f32,
        /// `1 - error_n / runner_up_error_n`: 0 undecided, towards 1 clear.
        pub margin: f32,
        /// Largest force, N.
        pub peak_force_n: f32,
        /// Samples that entered the search.
        pub samples: u16,
        /// Best material of the library and how far the next one is.
        pub material: Recognition,
        /// Longest tick of the palpation, us.
        pub tick_max_us: u16,
        /// Mean tick while searching, us.
        pub tick_mean_us: f32,
    }
    /// The nearest library material.
    pub struct Recognition {
        /// Index into the library, or [`Recognition::NONE`] if none is near enough.
        pub index: u8,
        /// Mean absolute difference, N.
        pub error_n: f32,
        /// Index of the runner-up.
        pub runner_up: u8,
        /// Mean absolute difference of the runner-up, N.
        pub runner_up_error_n: f32,
        /// `1 - error_n / runner_up_error_n`.
        pub margin: f32,
        /// Error up to which the nearest material would be named, N: its acceptance, widened by the noise before contact.
        pub limit_n: f32,
    }
}

wire! {
    /// What one palpation says of its foam, with standard errors: comes right before its [`Verdict`] if there is a result.
    ///
    /// Values and errors are mean and standard deviation of the posterior distribution over the whole valley in which mu, alpha and height make up
    /// for each other. The errors hold the noise of force and probe, the unknown contact point and zero, the table's error bound, and gains of
    /// the sensors and from press to press. Within two errors lie 93 to 97 of 100 palpations (`docs/board.md`).
    pub struct Estimate {
        /// Number of the palpation since start.
        pub palpation: u32,
        /// Shear modulus, MPa.
        pub mu_mpa: f32,
        /// Exponent.
        pub alpha: f32,
        /// Height of the specimen's surface, mm.
        pub height_mm: f32,
        /// Standard error of the modulus, MPa.
        pub mu_error_mpa: f32,
        /// Standard error of the exponent.
        pub alpha_error: f32,
        /// Standard error of the height, mm.
        pub height_error_mm: f32,
        /// Standard deviation of the force that the filter assumed (R of Eq. 20), N.
        pub noise_n: f32,
        /// Samples that it used.
        pub samples: u16,
    }
}

impl Recognition {
    /// Not in the library.
    pub const NONE: u8 = 0xff;
}

wire! {
    /// How a palpation ended.
    pub enum Outcome {
        /// Full depth reached, best column inside the grid.
        Identified,
        /// The best column lies on the edge of the grid: the material may be outside. The library is compared nevertheless, parameters are not given.
        GridEdge,
        /// The probe reached the end of its travel without contact.
        NoContact,
        /// Ended early with too few samples for a verdict.
        TooShort,
        /// No slice of the table is near the specimen's height.
        NoSuchHeight,
        /// The host stopped it, or a fault did.
        Aborted,
        /// No slice of the table is near the commanded rate.
        NoSuchRate,
        /// The ball went deeper than the table reaches, for more than a sixth of the samples in contact.
        DeeperThanTable,
        /// More than a tenth of the readings were no numbers.
        BadReadings,
        /// The load cell read the same largest force while the ball went deeper: it is at its end.
        Saturated,
    }
}
