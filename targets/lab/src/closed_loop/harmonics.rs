//! Harmonics of the electrical angle, by projection on a record.

use super::{Trace, percent};

/// Amplitudes of the harmonics of several signals over the same angles, one list per signal,
/// index = order, from 0 (magnitude of the mean) to `highest`. Angles in radians; the record
/// should span whole electrical turns.
pub fn amplitudes<const N: usize>(
    signals: [&[f64]; N],
    theta_e: &[f64],
    highest: usize,
) -> [Vec<f64>; N] {
    let count = theta_e.len().max(1) as f64;
    let means = signals.map(|signal| signal.iter().sum::<f64>() / count);
    let mut sums = vec![[(0.0, 0.0); N]; highest + 1];
    for (k, theta) in theta_e.iter().enumerate() {
        // Without the mean nothing leaks if the record is not quite a whole number of turns.
        let values: [f64; N] = std::array::from_fn(|n| signals[n][k] - means[n]);
        // One sine per bin: those of the multiples follow by rotation.
        let (sin, cos) = theta.sin_cos();
        let (mut s, mut c) = (0.0, 1.0);
        for order in &mut sums {
            for (sum, value) in order.iter_mut().zip(values) {
                sum.0 += value * c;
                sum.1 += value * s;
            }
            (c, s) = (c * cos - s * sin, s * cos + c * sin);
        }
    }
    std::array::from_fn(|n| {
        let amplitude = |order: &[(f64, f64); N]| 2.0 * order[n].0.hypot(order[n].1) / count;
        let mut amplitudes: Vec<f64> = sums.iter().map(amplitude).collect();
        amplitudes[0] = means[n].abs();
        amplitudes
    })
}

/// Harmonics of the phase currents in percent of the fundamental, mean of the phases; none of a
/// fundamental that is nothing.
pub fn harmonics_of_current(trace: &Trace, highest: usize) -> Vec<Option<f64>> {
    let i_c: Vec<f64> = trace
        .i_a
        .iter()
        .zip(&trace.i_b)
        .map(|(a, b)| -a - b)
        .collect();
    let phases = [&trace.i_a[..], &trace.i_b, &i_c];
    let phases = amplitudes(phases, &trace.theta_e, highest);
    let mean_share = |order: usize| {
        let shares = phases.iter();
        let shares = shares.map(|phase| percent(phase[order], phase[1], trace.current_floor));
        shares.sum::<Option<f64>>().map(|sum| sum / 3.0)
    };
    (0..=highest).map(mean_share).collect()
}

/// Harmonics of the torque in percent of its mean; none of a mean that is nothing.
pub fn harmonics_of_torque(trace: &Trace, highest: usize) -> Vec<Option<f64>> {
    let [amplitudes] = amplitudes([&trace.torque[..]], &trace.theta_e, highest);
    let share = |amplitude: &f64| percent(*amplitude, amplitudes[0], trace.torque_floor);
    amplitudes.iter().map(share).collect()
}

/// Harmonics of the ideal quasi-square wave in percent of its fundamental: 100/n for odd orders
/// that three does not divide, else 0.
pub fn harmonic_of_quasi_square(order: usize) -> f64 {
    if order % 2 == 1 && !order.is_multiple_of(3) {
        100.0 / order as f64
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn amplitudes_of_a_known_sum() {
        let theta: Vec<f64> = (0..3600).map(|k| f64::from(k) * TAU / 1200.0).collect();
        let wave: Vec<f64> = theta
            .iter()
            .map(|t| -2.0 + 0.5 * (6.0 * t).sin() + 0.25 * (12.0 * t + 1.0).cos())
            .collect();
        let [got] = amplitudes([&wave[..]], &theta, 13);
        for (order, amplitude) in got.iter().enumerate() {
            let want = match order {
                0 => 2.0,
                6 => 0.5,
                12 => 0.25,
                _ => 0.0,
            };
            assert!((amplitude - want).abs() < 1e-9, "{order}: {amplitude}");
        }
    }

    #[test]
    fn quasi_square_series_is_that_of_the_sampled_wave() {
        let theta: Vec<f64> = (0..36_000)
            .map(|k| (f64::from(k) + 0.5) * TAU / 36_000.0)
            .collect();
        let wave: Vec<f64> = theta
            .iter()
            .map(|t| match t.to_degrees() {
                d if (30.0..150.0).contains(&d) => 20.0,
                d if (210.0..330.0).contains(&d) => -20.0,
                _ => 0.0,
            })
            .collect();
        let [got] = amplitudes([&wave[..]], &theta, 25);
        for (order, amplitude) in got.iter().enumerate().skip(1) {
            let percent = 100.0 * amplitude / got[1];
            assert!(
                (percent - harmonic_of_quasi_square(order)).abs() < 1e-3,
                "{order}: {percent}"
            );
        }
    }
}
