//! An angle sensor in place of Hall sensors (section 4 with `rotor: angle`).

use crate::exact::{Word, pow2, within, word, wrap32};
use crate::model::hall::HallTiming;
use crate::spec::Spec;
use hexagen::Sample;

/// Number of sectors.
const SECTORS: f64 = 6.0;

/// The sensor and the filter of its speed.
#[derive(Clone, Copy, Debug)]
pub struct AngleSensor {
    turns: f64,
    offset: f64,
    codes: [u8; 6],
    /// Angle of a period at most, and at the over-speed, 2^32 a turn.
    turn_max: f64,
    over_speed: Option<f64>,
    /// Share of a difference that the speed follows at once.
    pub share: f64,
    /// Angles behind which nothing is left of the first difference.
    settled: f64,
}

impl AngleSensor {
    /// `None` with Hall sensors.
    pub fn new(spec: &Spec) -> Option<Self> {
        let inverter = &spec.inverter;
        inverter.angle_turns.map(|turns| Self {
            turns: f64::from(turns),
            offset: f64::from(inverter.angle_offset),
            codes: spec.motor.hall_codes,
            turn_max: f64::from(inverter.turn_max),
            over_speed: inverter.over_speed_step.map(f64::from),
            share: pow2(-(inverter.angle_filter as i32)),
            settled: 3.0 * pow2(inverter.angle_filter as i32),
        })
    }

    /// Electrical angle of a sample, 0 to 2^32 - 1.
    pub fn theta(&self, sample: &Sample) -> f64 {
        (f64::from(sample.angle()) * self.turns + self.offset).rem_euclid(pow2(32))
    }

    /// The Hall code of that angle's sector, which is told from its upper 16 bits; one that no sensors give, of a sample
    /// with a Hall code.
    pub fn code(&self, sample: &Sample) -> u8 {
        if sample.hall() != 0 {
            return 7;
        }
        // Sector 1 begins a twelfth of a turn before angle 0.
        let inside = (self.theta(sample) + (pow2(32) / 12.0).ceil()).rem_euclid(pow2(32));
        let sector = (inside / pow2(16)).floor() * SECTORS / pow2(16);
        self.codes[sector as usize]
    }

    /// Follows a sample; `filtered` gives the share of a difference.
    pub fn follow<W: Word>(
        &self,
        timing: &mut HallTiming<W>,
        theta: f64,
        filtered: impl Fn(W) -> W,
    ) {
        let wrapped = word::<W>(theta) - timing.theta_prev + pow2(31);
        let turned = within(wrap32(wrapped) - pow2(31), -self.turn_max, self.turn_max);
        let is_settled = f64::from(timing.edges) >= self.settled;
        timing.step = match timing.edges {
            0 => word(0.0),
            1 => turned,
            _ => timing.step + filtered(turned - timing.step),
        };
        timing.edges = (timing.edges + 1).min(self.settled as u8);
        timing.theta_prev = wrap32(word::<W>(theta + pow2(31))) - pow2(31);
        timing.direction = word(if timing.step > 0.0 {
            1.0
        } else if timing.step < 0.0 {
            -1.0
        } else {
            0.0
        });
        let is_over = |most: f64| timing.step > most || timing.step < -most;
        timing.count_speed(is_settled && self.over_speed.is_some_and(is_over));
    }
}
