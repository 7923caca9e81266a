//! The current ADCs: rounding, offset, sign and saturation.

use super::gates::Gate;
use super::{AdcChannel, LowSide};
use hexagen::{LegState, Legs};

/// The largest count of an ADC with `bits` bits.
pub(super) fn full_scale(bits: u32) -> f64 {
    f64::from((1_u32 << bits) - 1)
}

/// Count of a channel at a current in amperes; clamped to the ADC's range.
pub(super) fn convert(channel: &AdcChannel, current: f64) -> u16 {
    let count = (current / channel.amperes_per_count + channel.offset).round();
    count.clamp(0.0, full_scale(channel.bits)) as u16
}

/// Slack for the rounding of times, second.
const ROUNDING: f64 = 1e-12;

/// What a sensor sees of its phase's current at the start of a period; `held_for`: how long the leg has been as it is. A
/// sensor in a low leg sees nothing of what flows through the upper switch or diode, or before it has settled.
pub(super) fn seen(low_side: Option<LowSide>, gate: Gate, held_for: f64, current: f64) -> f64 {
    let Some(LowSide { settling, .. }) = low_side else {
        return current;
    };
    match gate {
        Gate::Lower if held_for >= settling - ROUNDING => current,
        // The lower diode conducts what flows into the motor.
        Gate::Off => current.max(0.0),
        Gate::Lower | Gate::Upper => 0.0,
    }
}

/// Whether a leg's lower switch stays on for long enough behind the start of a period with this command.
pub(super) fn is_held(
    low_side: LowSide,
    command: Legs,
    leg: usize,
    timer_period: u16,
    pwm_period: f64,
) -> bool {
    let duty = match command.state()[leg] {
        LegState::Pulsed => {
            f64::from(command.compare()[leg].min(timer_period)) / f64::from(timer_period)
        }
        LegState::Low | LegState::Off => 0.0,
    };
    0.5 * pwm_period * (1.0 - duty) >= low_side.hold - ROUNDING
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_offsets_inverts_and_saturates() {
        let channel = AdcChannel {
            bits: 12,
            amperes_per_count: 0.02,
            offset: 2048.0,
        };
        assert_eq!(convert(&channel, 0.0), 2048);
        assert_eq!(convert(&channel, 0.0099), 2048);
        assert_eq!(convert(&channel, 0.0101), 2049);
        assert_eq!(convert(&channel, -1.0), 1998);
        assert_eq!(convert(&channel, 1e3), 4095);
        assert_eq!(convert(&channel, -1e3), 0);
        let inverting = AdcChannel {
            amperes_per_count: -0.02,
            ..channel
        };
        assert_eq!(convert(&inverting, 1.0), 1998);
        assert_eq!(convert(&AdcChannel::bipolar(12, 40.0), 40.0), 4095);
        assert_eq!(convert(&AdcChannel::bipolar(16, 40.0), -40.0), 0);
    }
}
