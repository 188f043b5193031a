//! The way to off that waits for nobody.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// A switch that the worker looks at every turn of its conversation. It may be held by any thread.
#[derive(Debug, Clone, Default)]
pub struct OffSwitch(Arc<AtomicU32>);

impl OffSwitch {
    /// Asks for outputs off; modes that were asked for before are no longer wanted.
    pub fn press(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    /// How often it was pressed.
    #[must_use]
    pub fn presses(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }
}
