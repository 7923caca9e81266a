//! Wrong limits of a supervisor, whose code every drive shares.

use hexagen_codegen::interface::{Limits, SensedPhases, Sensor};

/// A fault: name and change.
type Fault = (&'static str, fn(&mut Limits));

const FAULTS: [Fault; 32] = [
    ("a count more", |limits| limits.adc_max += 1),
    ("a count less", |limits| limits.adc_max -= 1),
    ("the other way round", |limits| {
        limits.adc_inverted = !limits.adc_inverted;
    }),
    ("a fraction bit less", |limits| limits.current_bits -= 1),
    ("offset one more", |limits| limits.offset += 1),
    ("offset one less", |limits| limits.offset -= 1),
    ("least offset one more", |limits| limits.offsets[0] += 1),
    ("least offset one less", |limits| limits.offsets[0] -= 1),
    ("greatest offset one more", |limits| limits.offsets[1] += 1),
    ("greatest offset one less", |limits| limits.offsets[1] -= 1),
    ("trip level one more", |limits| limits.trip += 1),
    ("trip level one less", |limits| limits.trip -= 1),
    ("trip level a count more", |limits| {
        limits.trip += 1 << limits.current_bits;
    }),
    ("sensors of phases b and c", |limits| {
        limits.sensors.phases = SensedPhases::Bc;
    }),
    ("second sensor the other way round", |limits| {
        limits.sensors.second = Some(Sensor {
            adc_inverted: !limits.adc_inverted,
            offset: limits.offset,
            offsets: limits.offsets,
            ratio: Sensor::ALIKE,
        });
    }),
    ("offset of the second sensor one more", |limits| {
        limits.sensors.second = Some(Sensor {
            adc_inverted: limits.adc_inverted,
            offset: limits.offset + 1,
            offsets: limits.offsets,
            ratio: Sensor::ALIKE,
        });
    }),
    ("twice the calibration", |limits| {
        limits.calibration_log2 += 1;
    }),
    ("half the calibration", |limits| {
        limits.calibration_log2 = limits.calibration_log2.wrapping_sub(1);
    }),
    ("a period of pre-charge more", |limits| {
        limits.precharge_periods += 1;
    }),
    ("a period of pre-charge less", |limits| {
        limits.precharge_periods = limits.precharge_periods.saturating_sub(1);
    }),
    ("stall a period later", |limits| {
        limits.stall_periods += i32::from(limits.stall_periods > 0);
    }),
    ("stall a period earlier", |limits| {
        limits.stall_periods = (limits.stall_periods - 1).max(0);
    }),
    ("a Hall sensor the other way round", |limits| {
        limits.hall_inverted ^= 2;
    }),
    ("a Hall code bridged once more", |limits| {
        limits.hall_glitches += 1;
    }),
    ("a Hall code bridged once less", |limits| {
        limits.hall_glitches = limits.hall_glitches.saturating_sub(1);
    }),
    ("over-voltage a count later", |limits| {
        limits.bus_counts[1] = limits.bus_counts[1].saturating_add(1);
    }),
    ("under-voltage a count earlier", |limits| {
        limits.bus_counts[0] = limits.bus_counts[0].saturating_sub(1);
    }),
    ("two sectors exchanged", |limits| {
        let [low, high] = [4, 8].map(|shift| limits.sectors >> shift & 7);
        limits.sectors ^= (low ^ high) << 4 | (low ^ high) << 8;
    }),
    ("short circuit up to a lower speed", |limits| {
        limits.brake_periods += 1;
    }),
    ("short circuit up to a higher speed", |limits| {
        limits.brake_periods = (limits.brake_periods - 1).max(0);
    }),
    ("a start that waits a period more", |limits| {
        limits.start_periods += 1;
    }),
    ("a start that waits a period less", |limits| {
        limits.start_periods = limits.start_periods.saturating_sub(1);
    }),
];

/// All of them that these limits can have. The currents follow, so that the limits stay consistent.
pub fn wrong_limits(sound: &Limits) -> Vec<(&'static str, Limits)> {
    let planted = FAULTS.map(|(what, change)| {
        let mut limits = *sound;
        change(&mut limits);
        let one = 1 << limits.current_bits;
        let top = i32::from(limits.adc_max);
        let range = |inverted: bool, offsets: [u16; 2]| {
            let [least, most] = offsets.map(i32::from);
            if inverted {
                [(least - top) * one, most * one]
            } else {
                [-most * one, (top - least) * one]
            }
        };
        let first = range(limits.adc_inverted, limits.offsets);
        let second = limits.sensors.second;
        let second = second.map_or(first, |second| range(second.adc_inverted, second.offsets));
        limits.currents = [first[0].min(second[0]), first[1].max(second[1])];
        (what, limits)
    });
    let differs = |(_, limits): &(_, Limits)| limits != sound;
    planted.into_iter().filter(differs).collect()
}
