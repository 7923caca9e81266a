//! The figures of merit of a run, from its record: means over bins of 2.5 us.

use super::trace::{Trace, quasi_square};
use super::{amplitudes, percent};
use hexagen_codegen::spec::Reference;
use serde::Serialize;

/// Figures of merit; undefined ones are null in JSON. A tripped drive has none
/// ([`FiguresOfMerit::default`]).
///
/// Percentages of mean torque and of the current's fundamental are `None` if that, or the requested
/// current, is below the resolution of the drive's ADCs ([`Trace::current_floor`],
/// [`Trace::torque_floor`]). Harmonics are `None` if the shaft turned less than an electrical turn,
/// as at standstill.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct FiguresOfMerit {
    /// Mean torque in newton metres, with its sign.
    pub mean_torque_nm: Option<f64>,
    /// Peak-to-peak torque after a moving mean over Ts, in percent of the mean.
    pub ripple_pp_pct: Option<f64>,
    /// Standard deviation of the same, in percent of the mean.
    pub ripple_rms_pct: Option<f64>,
    /// Amplitude of the torque's 6th electrical harmonic in percent of the mean.
    pub h6_pct: Option<f64>,
    /// Amplitude of the 12th.
    pub h12_pct: Option<f64>,
    /// 5th harmonic of the phase current in percent of the fundamental, mean of the phases.
    pub i5_pct: Option<f64>,
    /// 7th harmonic, likewise.
    pub i7_pct: Option<f64>,
    /// 11th harmonic, likewise.
    pub i11_pct: Option<f64>,
    /// 13th harmonic, likewise.
    pub i13_pct: Option<f64>,
    /// Total harmonic distortion of the phase current (everything except mean and fundamental,
    /// switching ripple included) in percent of the fundamental; mean of the phases.
    pub thd_pct: Option<f64>,
    /// Root mean square of the phase currents over all phases, in amperes: three times its square and R
    /// are the copper loss.
    pub current_rms_a: Option<f64>,
    /// Mean current drawn from the bus in amperes; negative: returned.
    pub bus_current_a: Option<f64>,
    /// RMS distance of the current from the quasi-square reference of the true sector in the
    /// alpha-beta plane, in amperes. The reference's amplitude is that of the limited set-point
    /// ([`super::RunOptions::current`]).
    pub tracking_rms_a: Option<f64>,
    /// Mean time from a change of the true sector until the outgoing phase's current has fallen to
    /// the threshold, in microseconds; `None` if the sector never changes.
    pub commutation_us: Option<f64>,
    /// Turn-ons per device and second, mean of the six switches, in hertz.
    pub switching_hz: Option<f64>,
    /// Share of periods with the command on the edge of the hexagon, in percent.
    pub saturated_pct: Option<f64>,
}

/// The highest computed harmonic.
const HIGHEST: usize = 13;

/// The figures of merit of one record. `current` is the quasi-square reference's amplitude in
/// amperes, with the torque's sign; `threshold` ends a commutation, in amperes. The record should
/// span whole electrical periods.
pub fn figures_of_merit(trace: &Trace, current: f64, threshold: f64) -> FiguresOfMerit {
    let mean = mean(&trace.torque);
    let is_asked = current.abs() > trace.current_floor;
    let has_turned = trace.turns() >= 1.0;
    let of_mean = |part: f64| percent(part, mean, trace.torque_floor).filter(|_| is_asked);
    let smoothed = trace.smoothed_torque();
    let (least, most) = smoothed
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, m), &x| {
            (l.min(x), m.max(x))
        });

    let i_c: Vec<f64> = trace
        .i_a
        .iter()
        .zip(&trace.i_b)
        .map(|(a, b)| -a - b)
        .collect();
    let signals = [&trace.torque[..], &trace.i_a, &trace.i_b, &i_c];
    let [torque, currents @ ..] = amplitudes(signals, &trace.theta_e, HIGHEST);
    let torque_harmonic = |order: usize| of_mean(torque[order]).filter(|_| has_turned);
    let of_fundamental = |part: &dyn Fn(&[f64], &[f64]) -> f64| {
        let phases = signals[1..].iter().zip(&currents);
        let shares = phases.map(|(current, harmonics)| {
            percent(part(current, harmonics), harmonics[1], trace.current_floor)
        });
        let sum = shares.sum::<Option<f64>>()?;
        (is_asked && has_turned).then_some(sum / 3.0)
    };
    let current_harmonic = |order: usize| of_fundamental(&|_, harmonics| harmonics[order]);

    let bins = trace.torque.len();
    let squares = (0..bins).map(|k| {
        let (i_alpha, i_beta) = trace.i_alpha_beta(k);
        let (alpha_ref, beta_ref) = quasi_square(trace.theta_e[k], current);
        (i_alpha - alpha_ref).powi(2) + (i_beta - beta_ref).powi(2)
    });
    let tracking = (squares.sum::<f64>() / bins as f64).sqrt();

    let phases = trace.i_a.iter().chain(&trace.i_b).chain(&i_c);
    let rms = (phases.map(|i| i * i).sum::<f64>() / (3 * bins) as f64).sqrt();

    let turn_ons: u64 = trace
        .periods
        .iter()
        .map(|row| u64::from(row.turn_ons))
        .sum();
    let saturated = trace.periods.iter().filter(|row| row.saturated).count();
    FiguresOfMerit {
        mean_torque_nm: Some(mean),
        ripple_pp_pct: of_mean(most - least),
        ripple_rms_pct: of_mean(deviation(&smoothed)),
        h6_pct: torque_harmonic(6),
        h12_pct: torque_harmonic(12),
        i5_pct: current_harmonic(5),
        i7_pct: current_harmonic(7),
        i11_pct: current_harmonic(11),
        i13_pct: current_harmonic(13),
        thd_pct: of_fundamental(&distortion),
        current_rms_a: Some(rms),
        bus_current_a: Some(trace.bus_charge / trace.duration()),
        tracking_rms_a: Some(tracking),
        commutation_us: commutation_time(trace, current, threshold).map(|time| time * 1e6),
        switching_hz: Some(turn_ons as f64 / 6.0 / trace.duration()),
        saturated_pct: percent(saturated as f64, trace.periods.len() as f64, 0.0),
    }
}

impl FiguresOfMerit {
    /// Names, values and units of figures of merit that any current has.
    pub fn rows(&self) -> [(&'static str, Option<f64>, &'static str); 14] {
        [
            ("mean torque", self.mean_torque_nm, "Nm"),
            ("torque ripple, peak to peak", self.ripple_pp_pct, "%"),
            ("torque ripple, rms", self.ripple_rms_pct, "%"),
            ("torque harmonic 6", self.h6_pct, "%"),
            ("torque harmonic 12", self.h12_pct, "%"),
            ("current harmonic 5", self.i5_pct, "%"),
            ("current harmonic 7", self.i7_pct, "%"),
            ("current harmonic 11", self.i11_pct, "%"),
            ("current harmonic 13", self.i13_pct, "%"),
            ("current distortion", self.thd_pct, "%"),
            ("phase current, rms", self.current_rms_a, "A"),
            ("bus current, mean", self.bus_current_a, "A"),
            ("switching per device", self.switching_hz, "Hz"),
            ("saturated periods", self.saturated_pct, "%"),
        ]
    }

    /// Those that belong to a current of this shape: all of [`Self::rows`], and what compares with the reference.
    pub fn rows_of(
        &self,
        reference: Reference,
    ) -> impl Iterator<Item = (&'static str, Option<f64>, &'static str)> + use<> {
        let of_shape = self.quasi_square_rows().into_iter();
        let of_shape = of_shape.filter(move |_| reference == Reference::QuasiSquare);
        self.rows().into_iter().chain(of_shape)
    }

    /// Figures that compare with a quasi-square current, as [`Self::rows`].
    fn quasi_square_rows(&self) -> [(&'static str, Option<f64>, &'static str); 2] {
        [
            (
                "distance from quasi-square currents, rms",
                self.tracking_rms_a,
                "A",
            ),
            (
                "commutation of quasi-square currents",
                self.commutation_us,
                "us",
            ),
        ]
    }

    /// Combines several starts: the worst peak-to-peak ripple, the mean of everything else; `None`
    /// if any start has none.
    pub(super) fn of_starts(starts: &[Self]) -> Self {
        let all = |of: fn(&Self) -> Option<f64>| starts.iter().map(of).collect::<Option<Vec<_>>>();
        let mean = |of| all(of).map(|values| mean(&values));
        Self {
            mean_torque_nm: mean(|m| m.mean_torque_nm),
            ripple_pp_pct: all(|m| m.ripple_pp_pct)
                .and_then(|values| values.into_iter().reduce(f64::max)),
            ripple_rms_pct: mean(|m| m.ripple_rms_pct),
            h6_pct: mean(|m| m.h6_pct),
            h12_pct: mean(|m| m.h12_pct),
            i5_pct: mean(|m| m.i5_pct),
            i7_pct: mean(|m| m.i7_pct),
            i11_pct: mean(|m| m.i11_pct),
            i13_pct: mean(|m| m.i13_pct),
            thd_pct: mean(|m| m.thd_pct),
            current_rms_a: mean(|m| m.current_rms_a),
            bus_current_a: mean(|m| m.bus_current_a),
            tracking_rms_a: mean(|m| m.tracking_rms_a),
            commutation_us: mean(|m| m.commutation_us),
            switching_hz: mean(|m| m.switching_hz),
            saturated_pct: mean(|m| m.saturated_pct),
        }
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn deviation(values: &[f64]) -> f64 {
    let mean = mean(values);
    (values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

/// Amplitude of a current without mean and fundamental; `harmonics` are its amplitudes by order.
fn distortion(current: &[f64], harmonics: &[f64]) -> f64 {
    let rest = deviation(current).powi(2) - 0.5 * harmonics[1].powi(2);
    (2.0 * rest.max(0.0)).sqrt()
}

/// Mean length of the commutations that begin within the record, in seconds; `None` if the sector
/// never changes.
fn commutation_time(trace: &Trace, current: f64, threshold: f64) -> Option<f64> {
    let sectors: Vec<usize> = trace
        .theta_e
        .iter()
        .map(|&theta| crate::plant::sector_of(theta))
        .collect();
    let changes = sectors.windows(2).filter(|pair| pair[0] != pair[1]).count();
    if changes == 0 {
        return None;
    }
    let active = trace
        .commutating(current, threshold)
        .iter()
        .filter(|&&active| active)
        .count();
    Some(active as f64 * trace.bin / changes as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_loop::trace::PeriodRow;
    use crate::plant::{Plant, PlantParams};
    use std::f64::consts::TAU;

    /// A record of six turns of 800 bins with the given torque and currents over the angle.
    fn synthetic(torque: impl Fn(f64) -> f64, i: impl Fn(f64) -> f64) -> Trace {
        let plant =
            Plant::new(PlantParams::ideal(4, 0.1, 1e-3, 0.1, 48.0, 50e-6), 0.0, 1.0).unwrap();
        let mut trace = Trace::new(&plant, 240);
        for bin in 0..4800 {
            let theta = (f64::from(bin) + 0.5) * TAU / 800.0;
            trace.theta_e.push(theta.rem_euclid(TAU));
            trace.torque.push(torque(theta));
            trace.i_a.push(i(theta));
            trace.i_b.push(i(theta - TAU / 3.0));
        }
        let row = PeriodRow {
            omega_m: 1.0,
            turn_ons: 2,
            ..PeriodRow::default()
        };
        trace.periods = vec![row; 240];
        trace.periods[..60]
            .iter_mut()
            .for_each(|row| row.saturated = true);
        trace
    }

    /// Phase a of the ideal quasi-square current of 20 A, forward and motoring.
    fn square(theta: f64) -> f64 {
        let degrees = theta.to_degrees().rem_euclid(360.0);
        match degrees {
            d if (30.0..150.0).contains(&d) => 20.0,
            d if (210.0..330.0).contains(&d) => -20.0,
            _ => 0.0,
        }
    }

    #[track_caller]
    fn assert_close(got: Option<f64>, want: f64, tolerance: f64) {
        assert!(
            got.is_some_and(|got| (got - want).abs() <= tolerance),
            "got {got:?}, want {want} +- {tolerance}"
        );
    }

    #[test]
    fn harmonics_distortion_and_tracking_of_an_ideal_square() {
        let torque =
            |theta: f64| -3.0 + 0.06 * (6.0 * theta + 0.4).cos() + 0.03 * (12.0 * theta).sin();
        let figures = figures_of_merit(&synthetic(torque, square), 20.0, 0.5);
        assert_close(figures.mean_torque_nm, -3.0, 1e-12);
        assert_close(figures.h6_pct, 2.0, 1e-9);
        assert_close(figures.h12_pct, 1.0, 1e-9);
        // Fourier series of the six-step wave; its total distortion is sqrt(pi^2/9 - 1).
        for (got, order) in [
            (figures.i5_pct, 5.0),
            (figures.i7_pct, 7.0),
            (figures.i11_pct, 11.0),
            (figures.i13_pct, 13.0),
        ] {
            assert_close(got, 100.0 / order, 0.3);
        }
        assert_close(figures.thd_pct, 31.08, 0.1);
        assert_close(figures.tracking_rms_a, 0.0, 1e-9);
        assert_close(figures.commutation_us, 0.0, 0.0);
        assert_close(figures.switching_hz, 2.0 / 6.0 / 50e-6, 1e-6);
        assert_close(figures.saturated_pct, 25.0, 0.0);
    }

    #[test]
    fn ripple_is_measured_after_a_moving_mean_over_the_period() {
        // A ripple at the PWM frequency (20 bins) vanishes, a slow one of 10 % remains.
        let torque = |theta: f64| 2.0 + 0.5 * (40.0 * theta).sin() + 0.1 * theta.sin();
        let figures = figures_of_merit(&synthetic(torque, square), 20.0, 0.5);
        assert_close(figures.ripple_pp_pct, 10.0, 0.05);
        assert_close(figures.ripple_rms_pct, 5.0 / 2.0_f64.sqrt(), 0.02);
    }

    #[test]
    fn commutation_lasts_until_the_outgoing_current_is_zero() {
        // Every edge of the wave decays linearly from 20 A to zero within 16 degrees; 0.5 A are
        // reached after 15.6 degrees, which is 34.67 bins of 0.45 degrees. Phase c follows from a
        // and b and stops at once, so two commutations of three last.
        let decaying = |theta: f64| {
            let degrees = theta.to_degrees().rem_euclid(180.0);
            let sign = if theta.to_degrees().rem_euclid(360.0) < 180.0 {
                1.0
            } else {
                -1.0
            };
            match degrees {
                d if d < 30.0 => 0.0,
                d if d < 150.0 => sign * 20.0,
                d => sign * (20.0 - (d - 150.0) / 16.0 * 20.0).max(0.0),
            }
        };
        let trace = synthetic(|_| 1.0, decaying);
        assert_close(
            figures_of_merit(&trace, 20.0, 0.5).commutation_us,
            34.67 * 2.5 * 2.0 / 3.0,
            1.7,
        );
        assert_close(
            figures_of_merit(&trace, 20.0, 10.0).commutation_us,
            17.78 * 2.5 * 2.0 / 3.0,
            1.7,
        );
        // Against the torque's sign the outgoing current counts as zero at once.
        assert_close(
            figures_of_merit(&trace, -20.0, 0.5).commutation_us,
            0.0,
            0.0,
        );
    }

    #[test]
    fn starts_combine_to_the_worst_peak_and_the_mean_of_everything_else() {
        let quiet = figures_of_merit(
            &synthetic(|theta| 2.0 + 0.01 * theta.sin(), square),
            20.0,
            0.5,
        );
        let loud = figures_of_merit(
            &synthetic(|theta| 3.0 + 0.6 * theta.sin(), square),
            20.0,
            0.5,
        );
        let both = FiguresOfMerit::of_starts(&[quiet, loud, quiet]);
        assert_eq!(both.ripple_pp_pct, loud.ripple_pp_pct);
        assert_close(both.mean_torque_nm, 7.0 / 3.0, 1e-9);
        assert_close(
            both.ripple_rms_pct,
            (2.0 * quiet.ripple_rms_pct.unwrap() + loud.ripple_rms_pct.unwrap()) / 3.0,
            1e-12,
        );
        // A figure that one start lacks is undefined.
        let still = figures_of_merit(&synthetic(|_| 0.0, square), 20.0, 0.5);
        let some = FiguresOfMerit::of_starts(&[quiet, still]);
        assert_eq!((some.ripple_pp_pct, some.ripple_rms_pct), (None, None));
        assert_close(some.mean_torque_nm, 1.0, 1e-9);
    }

    /// Percentages of mean torque, and of the current's fundamental.
    fn percentages(figures: &FiguresOfMerit) -> ([Option<f64>; 4], [Option<f64>; 5]) {
        (
            [
                figures.ripple_pp_pct,
                figures.ripple_rms_pct,
                figures.h6_pct,
                figures.h12_pct,
            ],
            [
                figures.i5_pct,
                figures.i7_pct,
                figures.i11_pct,
                figures.i13_pct,
                figures.thd_pct,
            ],
        )
    }

    #[test]
    fn values_below_the_adc_resolution_have_no_percentages() {
        // One count of 12 bits over +-40 A, and its torque at 0.1 V s/rad per phase.
        let (count, torque) = (40.0 / 2048.0, 2.0 * 0.1 * 40.0 / 2048.0);
        for share in [0.0, 0.9] {
            let rippling = |theta: f64| share * torque + 0.5 * (6.0 * theta).sin();
            let found = figures_of_merit(&synthetic(rippling, square), 20.0, 0.5);
            assert_eq!(percentages(&found).0, [None; 4], "{found:?}");
            assert!(percentages(&found).1.iter().all(Option::is_some));
            assert_close(found.mean_torque_nm, share * torque, 1e-9);

            let small = |theta: f64| 0.9 * count * share * theta.sin() + 0.2 * (5.0 * theta).sin();
            let found = figures_of_merit(&synthetic(|_| 3.0, small), 20.0, 0.5);
            assert_eq!(percentages(&found).1, [None; 5], "{found:?}");
            assert!(percentages(&found).0.iter().all(Option::is_some));

            let unasked = figures_of_merit(&synthetic(|_| 3.0, square), share * count, 0.5);
            assert_eq!(percentages(&unasked), ([None; 4], [None; 5]));
        }
        let enough = figures_of_merit(&synthetic(|_| 1.1 * torque, square), 20.0, 0.5);
        assert!(percentages(&enough).0.iter().all(Option::is_some));
    }

    #[test]
    fn less_than_an_electrical_turn_has_no_harmonics() {
        let mut trace = synthetic(|theta| 3.0 + 0.1 * theta.sin(), square);
        assert!((trace.turns() - 6.0).abs() < 0.01, "{}", trace.turns());
        trace.theta_e.iter_mut().for_each(|theta| *theta = 0.2);
        let still = figures_of_merit(&trace, 20.0, 0.5);
        assert_eq!((still.h6_pct, still.h12_pct), (None, None));
        assert_eq!(percentages(&still).1, [None; 5]);
        assert_eq!(still.commutation_us, None);
        assert!(still.ripple_pp_pct.is_some() && still.tracking_rms_a.is_some());
        // Backward, and to and fro.
        for (k, theta) in trace.theta_e.iter_mut().enumerate() {
            *theta = (-0.01 * k as f64).rem_euclid(TAU);
        }
        assert!((trace.turns() - 47.99 / TAU).abs() < 1e-9);
        for (k, theta) in trace.theta_e.iter_mut().enumerate() {
            *theta = (0.3 * (k as f64 * 0.1).sin()).rem_euclid(TAU);
        }
        assert!(trace.turns() < 0.1);
    }
}
