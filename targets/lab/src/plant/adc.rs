//! The current ADCs: rounding, offset, sign and saturation.

use super::AdcChannel;

/// The largest count of an ADC with `bits` bits.
pub(super) fn full_scale(bits: u32) -> f64 {
    f64::from((1_u32 << bits) - 1)
}

/// Count of a channel at a current in amperes; clamped to the ADC's range.
pub(super) fn convert(channel: &AdcChannel, current: f64) -> u16 {
    let count = (current / channel.amperes_per_count + channel.offset).round();
    count.clamp(0.0, full_scale(channel.bits)) as u16
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
