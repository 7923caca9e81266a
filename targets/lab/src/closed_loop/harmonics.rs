//! Harmonics of the electrical angle, by projection on a record.

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
        // Without the mean nothing leaks when the record is not quite a whole number of turns.
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
