//! Ripple of the phase currents within a period of the pulse-width modulation.

use super::Spec;

/// Greatest swing of a phase current over the bus voltage times a period over the phase inductance: where the phase's
/// own voltage is 0, at the greatest amplitude of a sine. A test tries all others.
const SWING: f64 = 1.0 / 6.0;

impl Spec {
    /// Greatest peak-to-peak ripple of a phase current that the pulses of three legs make within a period, ampere, at
    /// the nominal bus; none where whole vectors are chosen or a leg is turned off.
    pub fn pwm_ripple(&self) -> Option<f64> {
        self.controller.common_mode()?;
        let inverter = &self.inverter;
        let period = inverter.t_s / f64::from(inverter.pwm_per_control);
        Some(SWING * inverter.v_bus * period / self.motor.inductance)
    }
}

#[cfg(test)]
mod tests {
    use super::SWING;
    use std::f64::consts::TAU;

    /// Swing of phase a's current in a period of 1 s, bus of 1 V and 1 H, with centred pulses of these duties and
    /// their mean voltage as the EMF.
    fn swing(duties: [f64; 3]) -> f64 {
        let phase = |levels: [f64; 3]| levels[0] - levels.iter().sum::<f64>() / 3.0;
        let emf = phase(duties);
        let mut edges: Vec<f64> = duties.iter().map(|duty| duty / 2.0).collect();
        edges.push(0.5);
        edges.sort_by(f64::total_cmp);
        // From the middle of the pulses to the end of the period; before the middle all signs are changed.
        let (mut from, mut current, mut most) = (0.0, 0.0_f64, 0.0_f64);
        for to in edges {
            let middle = f64::midpoint(from, to);
            let levels = duties.map(|duty| f64::from(u8::from(middle < duty / 2.0)));
            current += (phase(levels) - emf) * (to - from);
            most = most.max(current.abs());
            from = to;
        }
        2.0 * most
    }

    #[test]
    fn no_duty_of_a_sine_swings_the_current_further() {
        let mut most = 0.0_f64;
        for degree in 0..360 {
            for percent in 1..=100 {
                let amplitude = f64::from(percent) / 100.0 / 3.0_f64.sqrt();
                let voltages = [0.0, 1.0, 2.0].map(|phase| {
                    amplitude * (f64::from(degree) / 360.0 * TAU - phase * TAU / 3.0).cos()
                });
                let high = voltages.iter().copied().fold(f64::MIN, f64::max);
                let low = voltages.iter().copied().fold(f64::MAX, f64::min);
                // Centred, and with the lowest leg low throughout.
                for common in [0.5 - f64::midpoint(high, low), -low] {
                    most = most.max(swing(voltages.map(|voltage| voltage + common)));
                }
            }
        }
        assert!((most - SWING).abs() < 1e-9, "{most}");
    }
}
