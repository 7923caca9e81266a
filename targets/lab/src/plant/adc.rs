//! The current ADCs: rounding, offset, sign, noise and saturation.

use super::gates::Gate;
use super::{AdcChannel, LowSide};
use hexagen_reference::AnyCommand;
use std::f64::consts::TAU;

/// The largest count of an ADC with `bits` bits.
pub(super) fn full_scale(bits: u32) -> f64 {
    f64::from((1_u32 << bits) - 1)
}

/// Count of a channel at a current in amperes; clamped to the amplifier's and to the converter's range.
pub(super) fn convert(channel: &AdcChannel, current: f64, random: &mut fastrand::Rng) -> u16 {
    let shown = channel
        .most
        .map_or(current, |most| current.clamp(-most, most));
    let mut count = shown / channel.amperes_per_count + channel.offset;
    if channel.noise > 0.0 {
        count += channel.noise * gaussian(random);
    }
    count.round().clamp(0.0, full_scale(channel.bits)) as u16
}

/// A Gaussian random number of variance 1, by the method of Box and Muller.
fn gaussian(random: &mut fastrand::Rng) -> f64 {
    let radius = (-2.0 * (1.0 - random.f64()).ln()).sqrt();
    radius * (TAU * random.f64()).cos()
}

/// Slack for the rounding of times, second.
const ROUNDING: f64 = 1e-12;

/// Time constants in which a sensor settles: to 0.7 % of a step.
const TIME_CONSTANTS: f64 = 5.0;

/// What a sensor in a low leg sees of its phase's current, and whether it has settled; `held_for`: how long the
/// leg's switches have been as they are; `dead_time`: for how long both were off before. It sees nothing of what flows
/// through the upper switch or diode, and approaches what the lower ones take over.
pub(super) fn seen(
    low_side: LowSide,
    (gate, held_for): (Gate, f64),
    dead_time: f64,
    current: f64,
) -> (f64, bool) {
    // The lower diode conducts what flows into the motor.
    let into_motor = current > 0.0;
    let conducts_for = match gate {
        Gate::Lower if into_motor => held_for + dead_time,
        Gate::Off if into_motor => held_for,
        Gate::Lower => held_for,
        Gate::Off | Gate::Upper => return (0.0, current == 0.0),
    };
    if conducts_for >= low_side.settling - ROUNDING {
        return (current, true);
    }
    let approached = |time: f64| -(-TIME_CONSTANTS * time / low_side.settling).exp_m1();
    let share = approached(conducts_for) / approached(low_side.settling);
    (share * current, false)
}

/// Whether a leg's lower switch stays on for `time` seconds behind the start of a period with this
/// command.
pub(super) fn is_held(
    time: f64,
    command: AnyCommand,
    leg: usize,
    (timer_period, pwm_period): (u16, f64),
) -> bool {
    let duty = command.duty(timer_period)[leg].unwrap_or_default();
    0.5 * pwm_period * (1.0 - duty) >= time - ROUNDING
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounds_offsets_inverts_and_saturates() {
        let convert = |channel: &AdcChannel, current: f64| {
            super::convert(channel, current, &mut fastrand::Rng::with_seed(0))
        };
        let channel = AdcChannel {
            amperes_per_count: 0.02,
            ..AdcChannel::bipolar(12, 40.0)
        };
        assert_eq!(convert(&channel, 0.0), 2048);
        assert_eq!(convert(&channel, 0.0099), 2048);
        assert_eq!(convert(&channel, 0.0101), 2049);
        assert_eq!(convert(&channel, -1.0), 1998);
        assert_eq!(convert(&channel, 1e3), 4095);
        assert_eq!(convert(&channel, -1e3), 0);
        let saturating = AdcChannel {
            most: Some(30.0),
            ..channel
        };
        assert_eq!(convert(&saturating, 29.0), 2048 + 1450);
        assert_eq!(convert(&saturating, 35.0), 2048 + 1500);
        assert_eq!(convert(&saturating, -1e3), 2048 - 1500);
        let inverting = AdcChannel {
            amperes_per_count: -0.02,
            ..channel
        };
        assert_eq!(convert(&inverting, 1.0), 1998);
        assert_eq!(convert(&AdcChannel::bipolar(12, 40.0), 40.0), 4095);
        assert_eq!(convert(&AdcChannel::bipolar(16, 40.0), -40.0), 0);
    }

    #[test]
    fn a_sensor_in_a_low_leg_approaches_what_the_lower_switch_and_diode_conduct() {
        let low_side = LowSide {
            settling: 1e-6,
            aperture: 0.0,
        };
        let seen = |gate, held_for, dead_time, current| {
            super::seen(low_side, (gate, held_for), dead_time, current)
        };
        assert_eq!(seen(Gate::Lower, 1e-6, 0.0, -8.0), (-8.0, true));
        assert_eq!(seen(Gate::Upper, 5e-6, 0.0, -8.0), (0.0, false));
        // The upper diode conducts what flows out of the motor.
        assert_eq!(seen(Gate::Off, 5e-6, 0.5e-6, -8.0), (0.0, false));
        assert_eq!(seen(Gate::Off, 5e-6, 0.5e-6, 8.0), (8.0, true));
        assert_eq!(seen(Gate::Lower, 0.5e-6, 0.5e-6, 8.0), (8.0, true));
        let (early, settled) = seen(Gate::Lower, 0.5e-6, 0.5e-6, -8.0);
        assert!(!settled && (-7.4..-7.3).contains(&early), "{early}");
        let (earlier, _) = seen(Gate::Lower, 1e-9, 0.5e-6, -8.0);
        assert!((-0.05..0.0).contains(&earlier), "{earlier}");
        // No step at the end.
        let (last, _) = seen(Gate::Lower, 0.999e-6, 0.0, -8.0);
        assert!((last + 8.0).abs() < 0.001, "{last}");
    }

    #[test]
    fn noise_has_the_stated_rms_and_no_mean() {
        let channel = AdcChannel {
            noise: 3.0,
            ..AdcChannel::bipolar(12, 40.0)
        };
        let mut random = fastrand::Rng::with_seed(1);
        let errors: Vec<f64> = (0..20_000)
            .map(|_| f64::from(convert(&channel, 0.0, &mut random)) - 2048.0)
            .collect();
        let mean = errors.iter().sum::<f64>() / 20_000.0;
        let rms = (errors.iter().map(|x| x * x).sum::<f64>() / 20_000.0).sqrt();
        assert!(mean.abs() < 0.1, "{mean}");
        // Rounding adds a twelfth of a count to the variance of 9.
        assert!((rms - 3.014).abs() < 0.05, "{rms}");
        // A Gaussian, not a uniform or a triangular one: it passes three times its rms.
        let far = errors.iter().filter(|x| x.abs() > 9.5).count();
        assert!((15..60).contains(&far), "{far} of 20000");
    }
}
