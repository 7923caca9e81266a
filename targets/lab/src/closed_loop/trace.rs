//! Time series of a run: fine bins for figures of merit and plots, one row per period for CSV.
//!
//! Bins of 2.5 us (a whole number per period) hold exact means, integrated on the solution.

use super::{Recorder, RunOptions, Step};
use crate::plant::{Observer, Segment, Terminal, clarke, integral, sector_of};
use hexagen::Command;
use hexagen_reference::AnyCommand;
use serde::Serialize;
use std::f64::consts::{FRAC_PI_3, PI, TAU};
use std::io;

/// Target length of bins, in seconds.
const BIN: f64 = 2.5e-6;

/// Phase that is off in sectors S1 to S6.
const OFF_PHASE: [usize; 6] = [0, 2, 1, 0, 2, 1];

/// Sign of its current before the sector, for positive torque and forward rotation.
const OFF_SIGN: [f64; 6] = [-1.0, 1.0, -1.0, 1.0, -1.0, 1.0];

/// Quasi-square reference of an electrical angle's sector: Clarke of (+I, -I, 0) on the sector's
/// pair, with `current` = I in amperes, negative for negative torque ([`hexagen::conventions`]).
pub fn quasi_square(theta_e: f64, current: f64) -> (f64, f64) {
    let angle = (sector_of(theta_e) as f64 - 1.0) * FRAC_PI_3 - PI / 2.0;
    let length = current * 2.0 / 3.0_f64.sqrt();
    (length * angle.cos(), length * angle.sin())
}

/// One control period, at its sampling instant; means are over the period that follows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PeriodRow {
    /// Time in seconds.
    pub t: f64,
    /// Electrical angle in radians.
    pub theta_e: f64,
    /// Mechanical speed in rad/s.
    pub omega_m: f64,
    /// True sector, 1 to 6.
    pub sector: usize,
    /// Hall code.
    pub hall: u8,
    /// ADC counts of phases a and b.
    pub adc: [u16; 2],
    /// Phase currents in amperes.
    pub currents: [f64; 3],
    /// Compare values in effect, timer counts; of a command of intervals the ends of the first two, and 0.
    pub compare: [u16; 3],
    /// Leg states in effect: 0 pulsed, 1 low, 2 off; of a command of intervals those in the first.
    pub state: [u8; 3],
    /// Mean torque in newton metres.
    pub torque_mean: f64,
    /// Mean terminal voltage, alpha axis, in volts.
    pub v_alpha_mean: f64,
    /// Mean terminal voltage, beta axis, in volts.
    pub v_beta_mean: f64,
    /// Whether the command is on the hexagon's edge: compare values of the driven legs span the
    /// full period, or intervals leave no time for a zero vector.
    pub saturated: bool,
    /// Turn-ons of all six switches during the period.
    pub turn_ons: u32,
}

/// The record of a run.
#[derive(Clone, Debug)]
pub struct Trace {
    /// Length of a bin in seconds.
    pub bin: f64,
    /// Bins per control period.
    pub bins_per_period: usize,
    /// Time of the first bin's start in seconds.
    pub start: f64,
    /// Electrical angle at each bin's middle in radians.
    pub theta_e: Vec<f64>,
    /// Mean torque of each bin in newton metres.
    pub torque: Vec<f64>,
    /// Mean current of phase a in each bin in amperes.
    pub i_a: Vec<f64>,
    /// Mean current of phase b in each bin in amperes.
    pub i_b: Vec<f64>,
    /// One row per control period.
    pub periods: Vec<PeriodRow>,
    /// One ADC count in amperes, the larger of both channels: the resolution of currents.
    pub current_floor: f64,
    /// Greatest torque of that current through a pair of phases, in newton metres.
    pub torque_floor: f64,
    /// Charge taken from the bus in ampere-seconds; negative: returned.
    pub bus_charge: f64,
    t_s: f64,
    /// Difference of two compare values at the edge of the hexagon.
    reach: u16,
    turn_ons: u64,
    open: [f64; 3],
    open_theta: f64,
    filled: usize,
}

/// The closed hexagon between the corners of the quasi-square reference.
pub fn hexagon(current: f64) -> Vec<(f64, f64)> {
    (0..=6)
        .map(|k| quasi_square(f64::from(k) * FRAC_PI_3, current))
        .collect()
}

impl Trace {
    /// An empty record from the plant's present state on; `periods` is the expected length.
    pub fn new(plant: &crate::plant::Plant, periods: usize) -> Self {
        let params = plant.params();
        let t_s = params.t_s;
        let counts = params
            .adc
            .iter()
            .map(|channel| channel.amperes_per_count.abs());
        let current_floor = counts.fold(0.0, f64::max);
        let k_phase = params.k_phase.into_iter().fold(0.0, f64::max);
        let bins_per_period = ((t_s / BIN).round() as usize).max(1);
        let bins = periods * bins_per_period;
        Self {
            bin: t_s / bins_per_period as f64,
            bins_per_period,
            start: plant.time(),
            theta_e: Vec::with_capacity(bins),
            torque: Vec::with_capacity(bins),
            i_a: Vec::with_capacity(bins),
            i_b: Vec::with_capacity(bins),
            periods: Vec::with_capacity(periods),
            current_floor,
            torque_floor: 2.0 * k_phase * current_floor,
            bus_charge: 0.0,
            t_s,
            reach: params.timer_period,
            turn_ons: plant.turn_ons(),
            open: [0.0; 3],
            open_theta: 0.0,
            filled: 0,
        }
    }

    /// The same of a run's drive.
    pub fn of_run(plant: &crate::plant::Plant, run: &RunOptions, periods: usize) -> Self {
        let trace = Self::new(plant, periods);
        Self {
            reach: run.reach.unwrap_or(trace.reach),
            ..trace
        }
    }

    /// Length of the record in seconds.
    pub fn duration(&self) -> f64 {
        self.periods.len() as f64 * self.t_s
    }

    /// Electrical turns of the shaft over the record; 0 at standstill.
    pub fn turns(&self) -> f64 {
        let steps = self.theta_e.windows(2);
        let turned: f64 = steps
            .map(|pair| (pair[1] - pair[0] + PI).rem_euclid(TAU) - PI)
            .sum();
        turned.abs() / TAU
    }

    /// Time of the middle of bin `index` in seconds.
    pub fn time(&self, index: usize) -> f64 {
        self.start + (index as f64 + 0.5) * self.bin
    }

    /// Mean currents (alpha, beta) of bin `index` in amperes.
    pub fn i_alpha_beta(&self, index: usize) -> (f64, f64) {
        let (a, b) = (self.i_a[index], self.i_b[index]);
        clarke([a, b, -a - b])
    }

    /// Torque after a moving mean over one control period, in newton metres; shorter than the
    /// record by one period less one bin.
    pub fn smoothed_torque(&self) -> Vec<f64> {
        let n = self.bins_per_period;
        // A sum per window avoids accumulating rounding errors along the record.
        self.torque
            .windows(n)
            .map(|window| window.iter().sum::<f64>() / n as f64)
            .collect()
    }

    /// For each bin whether the true state is commutating: after a change of the true sector until
    /// the outgoing phase's current is at most `threshold` amperes, or the next change. `current`
    /// is the reference's signed amplitude, whose sign is the torque's.
    pub fn commutating(&self, current: f64, threshold: f64) -> Vec<bool> {
        let mut active = false;
        let mut last = self.theta_e.first().map_or(1, |&theta| sector_of(theta));
        let rotation = self
            .periods
            .first()
            .map_or(1.0, |row| 1.0_f64.copysign(row.omega_m));
        (0..self.torque.len())
            .map(|k| {
                let sector = sector_of(self.theta_e[k]);
                if sector != last {
                    active = true;
                    last = sector;
                }
                let outgoing = match OFF_PHASE[sector - 1] {
                    0 => self.i_a[k],
                    1 => self.i_b[k],
                    _ => -self.i_a[k] - self.i_b[k],
                };
                let sign = OFF_SIGN[sector - 1] * rotation * 1.0_f64.copysign(current);
                active &= sign * outgoing > threshold;
                active
            })
            .collect()
    }

    /// Writes the period rows as CSV with the columns t, theta_e, rpm, sector, hall, comm, ia, ib, ic,
    /// ialpha_ref, ibeta_ref, torque_mean, valpha_mean, vbeta_mean; SI units but for rpm, the mechanical speed. References are the
    /// quasi-square of the true sector with amplitude `current`; comm as [`Self::commutating`].
    ///
    /// # Errors
    /// An error of the writer.
    pub fn write_csv(
        &self,
        out: impl io::Write,
        current: f64,
        threshold: f64,
    ) -> Result<(), csv::Error> {
        let mut writer = csv::Writer::from_writer(out);
        let commutating = self.commutating(current, threshold);
        for (k, row) in self.periods.iter().enumerate() {
            let (ialpha_ref, ibeta_ref) = quasi_square(row.theta_e, current);
            writer.serialize(CsvRow {
                t: row.t,
                theta_e: row.theta_e,
                rpm: row.omega_m * 60.0 / TAU,
                sector: row.sector,
                hall: row.hall,
                comm: u8::from(commutating[k * self.bins_per_period]),
                ia: row.currents[0],
                ib: row.currents[1],
                ic: row.currents[2],
                ialpha_ref,
                ibeta_ref,
                torque_mean: row.torque_mean,
                valpha_mean: row.v_alpha_mean,
                vbeta_mean: row.v_beta_mean,
            })?;
        }
        writer.flush()?;
        Ok(())
    }

    fn close_bin(&mut self) {
        let scale = 1.0 / self.bin;
        self.torque.push(self.open[0] * scale);
        self.i_a.push(self.open[1] * scale);
        self.i_b.push(self.open[2] * scale);
        self.theta_e.push(self.open_theta);
        self.open = [0.0; 3];
        self.filled += 1;
    }

    fn add(&mut self, to: [f64; 3], from: [f64; 3]) {
        for (sum, (to, from)) in self.open.iter_mut().zip(to.iter().zip(from)) {
            *sum += to - from;
        }
    }
}

#[derive(Serialize)]
struct CsvRow {
    t: f64,
    theta_e: f64,
    rpm: f64,
    sector: usize,
    hall: u8,
    comm: u8,
    ia: f64,
    ib: f64,
    ic: f64,
    ialpha_ref: f64,
    ibeta_ref: f64,
    torque_mean: f64,
    valpha_mean: f64,
    vbeta_mean: f64,
}

impl Observer for Trace {
    fn segment(&mut self, segment: &Segment) {
        let terms = segment.terms;
        for (terminal, current) in segment.terminal.iter().zip(&segment.current) {
            if let Terminal::Rail { upper: true, .. } = terminal {
                self.bus_charge += integral(&current[..terms], segment.duration);
            }
        }
        let integrals = |t: f64| {
            [
                integral(&segment.torque[..terms], t),
                integral(&segment.current[0][..terms], t),
                integral(&segment.current[1][..terms], t),
            ]
        };
        let mut from = [0.0; 3];
        let end = segment.offset + segment.duration;
        let angle_at = |offset: f64| segment.theta_e + segment.omega_e * (offset - segment.offset);
        loop {
            let middle = (self.filled as f64 + 0.5) * self.bin;
            if (segment.offset..=end).contains(&middle) {
                self.open_theta = angle_at(middle);
            }
            let edge = (self.filled + 1) as f64 * self.bin;
            // The period's last bin is closed by the end of the period itself.
            if edge >= end || self.filled + 1 == self.bins_per_period {
                self.add(integrals(segment.duration), from);
                return;
            }
            let to = integrals(edge - segment.offset);
            self.add(to, from);
            self.close_bin();
            from = to;
        }
    }
}

/// Whether a command is on the edge of the voltage hexagon of legs that reach so many counts; one of intervals is where it
/// leaves no time for a zero vector.
fn saturated(command: AnyCommand, reach: u16) -> bool {
    let legs = match command {
        AnyCommand::Legs(legs) => legs,
        AnyCommand::Intervals(intervals) => return intervals.ends()[1] >= reach,
    };
    let driven = legs.on().into_iter().flatten();
    let (least, most) = driven.fold((u16::MAX, 0), |(low, high), c| (low.min(c), high.max(c)));
    most >= least.saturating_add(reach)
}

impl Recorder for Trace {
    fn period(&mut self, step: &Step<'_>) {
        self.close_bin();
        self.filled = 0;
        let after = step.plant.truth();
        let (v_alpha_mean, v_beta_mean) = clarke(after.mean_voltages);
        let turn_ons = step.plant.turn_ons();
        let [adc_a, adc_b, _] = step.sample.adc();
        self.periods.push(PeriodRow {
            t: step.truth.t,
            theta_e: step.truth.theta_e,
            omega_m: step.truth.omega_m,
            sector: step.truth.sector,
            hall: step.sample.hall(),
            adc: [adc_a, adc_b],
            currents: step.truth.currents,
            compare: step.applied.instants(),
            state: step.applied.state().map(|state| state as u8),
            torque_mean: after.mean_torque,
            v_alpha_mean,
            v_beta_mean,
            saturated: saturated(step.applied, self.reach),
            turn_ons: (turn_ons - self.turn_ons) as u32,
        });
        self.turn_ons = turn_ons;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closed_loop::{ClosedLoop, Delay};
    use crate::plant::{Plant, PlantParams, Truth};
    use hexagen::{Intervals, LegState, Legs, Sample};

    fn plant(omega_m: f64) -> Plant {
        Plant::new(
            PlantParams::ideal(4, 0.135, 0.22e-3, 0.0824, 48.0, 50e-6),
            0.1,
            omega_m,
        )
        .unwrap()
    }

    fn pulsed(compare: [u16; 3]) -> Legs {
        Legs::new(compare, [LegState::Pulsed; 3])
    }

    #[test]
    fn bins_hold_the_exact_means_of_the_solution() {
        let mut closed = ClosedLoop::new(
            plant(100.0),
            |_: &Sample, _: &Truth| pulsed([1200, 300, 700]),
            Delay::None,
        );
        let mut trace = Trace::new(closed.plant(), 40);
        closed.run(40, &mut trace);
        assert_eq!((trace.bins_per_period, trace.torque.len()), (20, 800));
        for (row, bins) in trace.periods.iter().zip(trace.torque.chunks(20)) {
            let mean = bins.iter().sum::<f64>() / 20.0;
            assert!(
                (mean - row.torque_mean).abs() < 1e-9,
                "{mean} {}",
                row.torque_mean
            );
        }
        // The bin after a sample begins at the sampled current and angle.
        let row = trace.periods[30];
        assert!((trace.i_a[600] - row.currents[0]).abs() < 0.3);
        let half_bin = 100.0 * 4.0 * 1.25e-6;
        assert!((trace.theta_e[600] - row.theta_e - half_bin).abs() < 1e-9);
    }

    #[test]
    fn command_takes_effect_one_period_later_or_at_once() {
        for (delay, first) in [(Delay::OnePeriod, 1), (Delay::None, 0)] {
            let mut closed = ClosedLoop::new(
                plant(0.0),
                |_: &Sample, _: &Truth| pulsed([1800, 0, 0]),
                delay,
            );
            let mut trace = Trace::new(closed.plant(), 3);
            closed.run(3, &mut trace);
            for (k, row) in trace.periods.iter().enumerate() {
                assert_eq!(row.saturated, k >= first, "{delay:?} {k}");
                assert_eq!(row.v_alpha_mean > 31.9, k >= first, "{delay:?} {k}");
            }
        }
    }

    #[test]
    fn switching_counts_turn_ons_of_both_switches() {
        let pair = Legs::new(
            [900, 0, 0],
            [LegState::Pulsed, LegState::Low, LegState::Off],
        );
        for (legs, per_period) in [(pulsed([900, 600, 300]), 6), (pair, 2), (Legs::LOW, 0)] {
            let mut closed =
                ClosedLoop::new(plant(10.0), |_: &Sample, _: &Truth| legs, Delay::None);
            closed.run(1, &mut ());
            let mut trace = Trace::new(closed.plant(), 5);
            closed.run(5, &mut trace);
            assert!(
                trace.periods.iter().all(|row| row.turn_ons == per_period),
                "{legs:?}"
            );
        }
    }

    #[test]
    fn intervals_without_a_zero_vector_are_saturated() {
        use LegState::{Low, Off, Pulsed};
        // Leg a low against b, then c: no leg is high all the time.
        let legs = [[Low, Pulsed, Off], [Low, Off, Pulsed], [Low; 3]];
        for (end, expected) in [(1800, true), (1799, false)] {
            let command = Intervals::new([700, end], legs);
            assert_eq!(saturated(command.into(), 1800), expected, "{end}");
        }
    }

    #[test]
    fn csv_has_the_documented_columns_and_one_row_per_period() {
        let mut closed = ClosedLoop::new(
            plant(100.0),
            |_: &Sample, _: &Truth| pulsed([1000, 800, 900]),
            Delay::OnePeriod,
        );
        let mut trace = Trace::new(closed.plant(), 7);
        closed.run(7, &mut trace);
        let mut out = Vec::new();
        trace.write_csv(&mut out, 20.0, 0.5).unwrap();
        let text = String::from_utf8(out).unwrap();
        let mut lines = text.lines();
        assert_eq!(
            lines.next(),
            Some(
                "t,theta_e,rpm,sector,hall,comm,ia,ib,ic,ialpha_ref,ibeta_ref,torque_mean,valpha_mean,vbeta_mean"
            )
        );
        assert_eq!(lines.count(), 7);
    }

    #[test]
    fn quasi_square_is_the_clarke_transform_of_each_sectors_pair() {
        let pairs = [
            [0.0, -1.0, 1.0],
            [1.0, -1.0, 0.0],
            [1.0, 0.0, -1.0],
            [0.0, 1.0, -1.0],
            [-1.0, 1.0, 0.0],
            [-1.0, 0.0, 1.0],
        ];
        for (k, pair) in pairs.into_iter().enumerate() {
            let (alpha, beta) = quasi_square((k as f64 * 60.0 + 7.0).to_radians(), 3.0);
            let want = clarke(pair.map(|x| 3.0 * x));
            assert!((alpha - want.0).hypot(beta - want.1) < 1e-12, "S{}", k + 1);
        }
    }
}
