//! Fields in place of others.

/// Fields that state one quantity in two ways.
const ALTERNATIVES: [[&str; 2]; 13] = [
    ["pole_pairs", "poles"],
    ["back_emf", "speed_constant"],
    ["f_pwm", "sampling_time"],
    ["timer_clock", "timer_period"],
    ["adc_range", "adc_gain"],
    ["adc_range", "shunt"],
    ["adc_range", "amplifier_gain"],
    ["adc_range", "adc_reference"],
    ["adc_range", "amplifier_swing"],
    ["adc_gain", "shunt"],
    ["adc_gain", "amplifier_gain"],
    ["adc_gain", "adc_reference"],
    ["adc_gain", "amplifier_swing"],
];

/// Whether the one field replaces the other.
pub(crate) fn same_quantity(one: &str, other: &str) -> bool {
    one == other
        || ALTERNATIVES
            .iter()
            .any(|pair| one != other && pair.contains(&one) && pair.contains(&other))
}

#[cfg(test)]
mod tests {
    use super::same_quantity;

    #[test]
    fn period_and_frequency_are_one_quantity() {
        assert!(same_quantity("f_pwm", "sampling_time"));
        assert!(!same_quantity("f_pwm", "timer_clock"));
    }
}
