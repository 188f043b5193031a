//! The lease of a mode: which link holds the motion, and for how long without a word from it.

use crate::link::LinkId;
use protocol::TICK_HZ;
use protocol::message::Holder;

/// Shortest and longest lease, ms. The longest bounds how long outputs outlive their host, whatever it asks for.
pub const LEASE_MS: (u16, u16) = (100, 1000);

/// The holder's lease.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Lease {
    holder: Option<LinkId>,
    ticks: u16,
    silent: u16,
}

impl Lease {
    /// Gives the motion to a link.
    pub fn grant(&mut self, link: LinkId, lease_ms: u16) {
        let ticks = u32::from(lease_ms) * TICK_HZ / 1000;
        *self = Lease { holder: Some(link), ticks: ticks as u16, silent: 0 };
    }

    /// Gives the motion to a link that holds it already, with another half on: the shorter lease holds for both.
    pub fn grant_beside(&mut self, link: LinkId, lease_ms: u16) {
        let before = self.ticks;
        self.grant(link, lease_ms);
        self.ticks = self.ticks.min(before);
    }

    /// A request came over a link: it renews the lease of nobody else.
    pub fn heard(&mut self, link: LinkId) {
        if self.holder == Some(link) {
            self.silent = 0;
        }
    }

    /// True if another link than this one holds the motion.
    pub fn is_held_from(&self, link: LinkId) -> bool {
        self.holder.is_some_and(|holder| holder != link)
    }

    /// The holder, seen from a link.
    pub fn seen_from(&self, link: LinkId) -> Holder {
        match self.holder {
            None => Holder::Nobody,
            Some(holder) if holder == link => Holder::You,
            Some(_) => Holder::Another,
        }
    }

    /// One tick. Silence counts only while outputs are on: a quiet host is no hazard to a board that does nothing.
    pub fn count(&mut self, outputs_on: bool) {
        self.silent = if outputs_on { self.silent.saturating_add(1) } else { 0 };
    }

    /// The board rests: nobody holds it.
    pub fn release(&mut self) {
        *self = Lease::default();
    }

    /// Ticks of silence, and how many the lease allows.
    pub const fn silence(&self) -> (u16, u16) {
        (self.silent, self.ticks)
    }
}
