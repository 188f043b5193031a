//! How much the power outputs give: duties of coil and actuator, rate of the arm. Whether they are on at all is the
//! interlock's.

use crate::number::limit;
use embassy_stm32::Peri;
use embassy_stm32::gpio::{OutputType, Pull, Speed};
use embassy_stm32::peripherals::{PC6, PD15, PE9, PE11, TIM1, TIM4, TIM8};
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::low_level::CountingMode;
use embassy_stm32::timer::simple_pwm::{PwmPin, PwmPinConfig, SimplePwm, SimplePwmChannel};
use embassy_stm32::timer::{Ch1, GeneralInstance4Channel};

/// Above hearing, and far above every electrical time constant that matters here.
const PWM_HZ: Hertz = Hertz(20_000);

/// Supply of the actuator's H-bridge, V: its full duty.
pub const ACTUATOR_SUPPLY_V: f32 = 12.0;

/// Rate of the arm at full duty of its set point, mm/s.
pub const ARM_FULL_RATE_MM_S: f32 = 10.0;

/// With the pin's own pull-down (40 kOhm): it is what keeps a pin low that floats where the board's is missing. Edges
/// of 10 ns are fast enough for 20 kHz.
const PIN: PwmPinConfig = PwmPinConfig { output_type: OutputType::PushPull, speed: Speed::Medium, pull: Pull::Down };

fn set<T: GeneralInstance4Channel>(channel: &mut SimplePwmChannel<'_, T>, duty: f32) {
    let full = channel.max_duty_cycle();
    channel.set_duty_cycle((limit(duty, 0.0, 1.0) * full as f32) as u32);
}

/// Low-side switch of the coil on PC6 (TIM8 channel 1).
pub struct Coil(SimplePwm<'static, TIM8>);

impl Coil {
    pub fn new(timer: Peri<'static, TIM8>, pin: Peri<'static, PC6>) -> Self {
        let pin: PwmPin<'_, _, Ch1> = PwmPin::new_with_config(pin, PIN);
        let mut pwm = SimplePwm::new(timer, Some(pin), None, None, None, PWM_HZ, CountingMode::EdgeAlignedUp);
        pwm.ch1().set_duty_cycle_fully_off();
        pwm.ch1().enable();
        Coil(pwm)
    }

    /// Duty, 0 to 1.
    pub fn set(&mut self, duty: f32) {
        set(&mut self.0.ch1(), duty);
    }
}

/// H-bridge of the display's actuator: PE9 drives one way, PE11 the other (TIM1 channels 1 and 2).
pub struct Actuator(SimplePwm<'static, TIM1>);

impl Actuator {
    pub fn new(timer: Peri<'static, TIM1>, forward: Peri<'static, PE9>, reverse: Peri<'static, PE11>) -> Self {
        let forward = PwmPin::new_with_config(forward, PIN);
        let reverse = PwmPin::new_with_config(reverse, PIN);
        let mut pwm =
            SimplePwm::new(timer, Some(forward), Some(reverse), None, None, PWM_HZ, CountingMode::EdgeAlignedUp);
        pwm.ch1().set_duty_cycle_fully_off();
        pwm.ch2().set_duty_cycle_fully_off();
        pwm.ch1().enable();
        pwm.ch2().enable();
        Actuator(pwm)
    }

    /// Mean voltage over the bridge, V. The other side is switched off first, so both never conduct.
    pub fn set_v(&mut self, volts: f32) {
        let duty = volts / ACTUATOR_SUPPLY_V;
        if duty >= 0.0 {
            self.0.ch2().set_duty_cycle_fully_off();
            set(&mut self.0.ch1(), duty);
        } else {
            self.0.ch1().set_duty_cycle_fully_off();
            set(&mut self.0.ch2(), -duty);
        }
    }
}

/// Set point of the palpation arm's rate: PD15 (TIM4 channel 4).
pub struct Arm(SimplePwm<'static, TIM4>);

impl Arm {
    pub fn new(timer: Peri<'static, TIM4>, rate: Peri<'static, PD15>) -> Self {
        let rate = PwmPin::new_with_config(rate, PIN);
        let mut pwm = SimplePwm::new(timer, None, None, None, Some(rate), PWM_HZ, CountingMode::EdgeAlignedUp);
        pwm.ch4().set_duty_cycle_fully_off();
        pwm.ch4().enable();
        Arm(pwm)
    }

    /// Sets the rate.
    pub fn set_rate(&mut self, rate_mm_s: f32) {
        set(&mut self.0.ch4(), rate_mm_s / ARM_FULL_RATE_MM_S);
    }
}
