//! Timers: time base, update and compare flags, PWM duties (RM0090 sections 17 and 18).

use crate::time::Time;

const CR1: usize = 0x00;
const CR2: usize = 0x04;
const DIER: usize = 0x0c;
const SR: usize = 0x10;
const EGR: usize = 0x14;
const CCER: usize = 0x20;
const CNT: usize = 0x24;
const PSC: usize = 0x28;
const ARR: usize = 0x2c;
const CCR1: usize = 0x34;
const BDTR: usize = 0x44;

const CEN: u32 = 1;
const UDIS: u32 = 1 << 1;
const URS: u32 = 1 << 2;
const UIF: u32 = 1;
const MOE: u32 = 1 << 15;

/// A timer, counting up.
#[derive(Debug, Clone)]
pub struct Timer {
    words: [u32; 0x14],
    /// Units of time a clock of the timer.
    clock: Time,
    /// Advanced control timers need their main output enabled.
    advanced: bool,
    /// Prescaler in use; the register is taken over at the next update.
    prescaler: u32,
    /// When the counter was `base` last.
    since: Time,
    base: u64,
    /// Ticks since `since` whose flags are set already.
    seen: u64,
    /// The flags of SR.
    flags: u32,
}

impl Timer {
    /// A stopped timer whose clock takes `clock` units of time.
    pub fn new(clock: Time, advanced: bool) -> Self {
        let mut words = [0; 0x14];
        words[ARR / 4] = u32::from(u16::MAX);
        Timer { words, clock, advanced, prescaler: 0, since: 0, base: 0, seen: 0, flags: 0 }
    }

    fn word(&self, offset: usize) -> u32 {
        self.words[offset / 4]
    }

    fn runs(&self) -> bool {
        self.word(CR1) & CEN != 0
    }

    /// Units of time a tick of the counter.
    fn tick(&self) -> Time {
        self.clock * (u64::from(self.prescaler) + 1)
    }

    /// Counts of a period.
    fn period(&self) -> u64 {
        u64::from(self.word(ARR)) + 1
    }

    fn ticks(&self, now: Time) -> u64 {
        if self.runs() { (now - self.since) / self.tick() } else { 0 }
    }

    fn count(&self, now: Time) -> u64 {
        (self.base + self.ticks(now)) % self.period()
    }

    /// Tick after `after` at which the counter reads `value`.
    fn next(&self, after: u64, value: u64) -> Option<u64> {
        let period = self.period();
        (value < period).then(|| {
            let at = (self.base + after) % period;
            let wait = (value + period - at) % period;
            after + if wait == 0 { period } else { wait }
        })
    }

    /// Sets the flags of all that happened until `now`; returns how often the counter overflowed.
    pub fn sync(&mut self, now: Time) -> u64 {
        let before = self.preload(now);
        before + self.pass(now)
    }

    /// An update takes over a prescaler that was written meanwhile; returns the overflows until then.
    fn preload(&mut self, now: Time) -> u64 {
        if self.word(PSC) == self.prescaler || self.word(CR1) & UDIS != 0 || !self.runs() {
            return 0;
        }
        let Some(update) = self.next(self.seen, 0).filter(|at| *at <= self.ticks(now)) else {
            return 0;
        };
        let at = self.since + update * self.tick();
        let overflows = self.pass(at);
        self.prescaler = self.word(PSC);
        self.rebase(at, 0);
        overflows
    }

    fn pass(&mut self, now: Time) -> u64 {
        let ticks = self.ticks(now);
        if ticks == self.seen {
            return 0;
        }
        for channel in 0..4 {
            let value = u64::from(self.words[CCR1 / 4 + channel]);
            if self.next(self.seen, value).is_some_and(|at| at <= ticks) {
                self.flags |= 2 << channel;
            }
        }
        let period = self.period();
        let updates = (self.base + ticks) / period - (self.base + self.seen) / period;
        if updates > 0 && self.word(CR1) & UDIS == 0 {
            self.flags |= UIF;
        }
        self.seen = ticks;
        updates
    }

    /// Restarts the time base at `count`.
    fn rebase(&mut self, now: Time, count: u64) {
        self.since = now;
        self.base = count;
        self.seen = 0;
    }

    /// True while the timer asks for its interrupt.
    pub fn line(&self) -> bool {
        self.flags & self.word(DIER) & 0x1f != 0
    }

    /// When something happens that interrupts or, if `trigger`, triggers others.
    pub fn next_event(&self, trigger: bool) -> Option<Time> {
        if !self.runs() {
            return None;
        }
        let waiting = self.word(DIER) & !self.flags;
        let mut first = None;
        let mut consider = |at: Option<u64>| first = [first, at].into_iter().flatten().min();
        if waiting & UIF != 0 || trigger && self.triggers() {
            consider(self.next(self.seen, 0));
        }
        for channel in 0..4 {
            if waiting & 2 << channel != 0 {
                consider(self.next(self.seen, u64::from(self.words[CCR1 / 4 + channel])));
            }
        }
        first.map(|ticks| self.since + ticks * self.tick())
    }

    /// True if updates go out as a trigger (master mode 0b010).
    pub fn triggers(&self) -> bool {
        self.word(CR2) >> 4 & 7 == 2
    }

    /// Fraction of the time that output `channel` (0 to 3) is high; 0 when it is not driven.
    pub fn duty(&self, channel: usize) -> f64 {
        let on = self.runs() && self.word(CCER) >> (4 * channel) & 1 != 0;
        let enabled = !self.advanced || self.word(BDTR) & MOE != 0;
        let high = f64::from(self.words[CCR1 / 4 + channel]) / self.period() as f64;
        if on && enabled { high.min(1.0) } else { 0.0 }
    }

    /// True while an advanced timer leaves its pins to whatever is wired to them.
    pub fn floats(&self) -> bool {
        self.advanced && self.word(BDTR) & MOE == 0
    }

    /// True while output `channel` (0 to 3) drives its pin high (PWM mode 1).
    pub fn is_high(&self, channel: usize, now: Time) -> bool {
        self.duty(channel) > 0.0 && self.count(now) < u64::from(self.words[CCR1 / 4 + channel])
    }

    /// Value of a register.
    pub fn read(&mut self, offset: usize, now: Time) -> u32 {
        self.sync(now);
        match offset {
            SR => self.flags,
            CNT => self.count(now) as u32,
            EGR => 0,
            _ => self.words.get(offset / 4).copied().unwrap_or(0),
        }
    }

    /// Sets a register.
    pub fn write(&mut self, offset: usize, value: u32, now: Time) {
        self.sync(now);
        match offset {
            SR => self.flags &= value,
            CNT => self.rebase(now, u64::from(value)),
            EGR => {
                if value & 1 != 0 {
                    self.prescaler = self.word(PSC);
                    self.rebase(now, 0);
                    if self.word(CR1) & (URS | UDIS) == 0 {
                        self.flags |= UIF;
                    }
                }
                self.flags |= value & 0x1e;
            }
            CR1 | ARR => {
                // The count so far was made with the old period, and stands still while the counter is off.
                let count = self.count(now);
                self.words[offset / 4] = value;
                self.rebase(now, count);
            }
            _ => {
                if let Some(word) = self.words.get_mut(offset / 4) {
                    *word = value;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A timer of 10 counts, prescaled by 3, its clock 4 units.
    fn running() -> Timer {
        let mut timer = Timer::new(4, false);
        timer.write(PSC, 2, 0);
        timer.write(ARR, 9, 0);
        timer.write(EGR, 1, 0);
        timer.write(SR, 0, 0);
        timer.write(CR1, CEN, 0);
        timer
    }

    #[test]
    fn counts_and_overflows_at_its_period() {
        let mut timer = running();
        assert_eq!((timer.read(CNT, 11), timer.read(CNT, 12), timer.read(CNT, 119)), (0, 1, 9));
        assert_eq!(timer.read(SR, 119) & UIF, 0);
        assert_eq!((timer.read(CNT, 120), timer.read(SR, 120) & UIF), (0, UIF));
        assert_eq!(timer.sync(120 + 3 * 120), 3);
    }

    /// RM0090 section 18.4.11: a written prescaler counts from the next update on.
    #[test]
    fn a_prescaler_is_taken_over_at_the_next_overflow() {
        let mut timer = Timer::new(4, false);
        for (offset, value) in [(ARR, 9), (PSC, 1), (CR1, CEN)] {
            timer.write(offset, value, 0);
        }
        // Ten counts of 4 units, then ten of 8.
        assert_eq!((timer.sync(39), timer.sync(40), timer.sync(119), timer.sync(120)), (0, 1, 0, 1));
        assert_eq!(timer.sync(120 + 5 * 80), 5);
    }

    #[test]
    fn a_compare_is_flagged_once_a_period_and_announced() {
        let mut timer = running();
        timer.write(CCR1 + 4, 5, 0);
        timer.write(DIER, 1 << 2, 0);
        assert_eq!(timer.next_event(false), Some(60));
        assert_eq!(timer.read(SR, 59) & 4, 0);
        assert_eq!(timer.read(SR, 60) & 4, 4);
        assert!(timer.line());
        timer.write(SR, !4, 60);
        assert!(!timer.line());
        assert_eq!(timer.next_event(false), Some(180));
    }

    #[test]
    fn an_advanced_timer_drives_only_with_its_main_output_on() {
        let mut timer = Timer::new(2, true);
        for (offset, value) in [(ARR, 99), (CCR1, 25), (CCER, 1), (CR1, CEN)] {
            timer.write(offset, value, 0);
        }
        assert_eq!(timer.duty(0), 0.0);
        timer.write(BDTR, MOE, 0);
        assert_eq!(timer.duty(0), 0.25);
        timer.write(CCER, 0, 0);
        assert_eq!(timer.duty(0), 0.0);
    }
}
