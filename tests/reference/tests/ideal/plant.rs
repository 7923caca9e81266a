//! A small plant for the tests of this crate: star R-L-EMF motor at fixed speed on three pulsed
//! legs with ideal switches, centre-aligned, and the sensors of the drive.
//!
//! Voltages are averaged over bins of 1.25 us, so switching instants are exact in the mean. Legs
//! that are off are not modelled: `three_phase` modulation only.

use hexagen::Sample;
use hexagen_reference::{EmfShape, Spec};
use std::f64::consts::{FRAC_PI_3, FRAC_PI_6, TAU};

/// Bins per control period.
pub const BINS: usize = 40;

/// The paper's 660 W motor with timer-captured Hall edges and the given controller options.
pub fn spec_660w(controller: &str) -> Spec {
    let text = format!(
        r#"
name = "Paper"
[motor]
pole_pairs = 4
resistance = 0.135
inductance = 0.00022
emf_constant = 0.0824
emf_shape = "trapezoidal"
flat_top_deg = 120.0
torque_constant = 0.1648
hall_codes = [1, 5, 4, 6, 2, 3]
[inverter]
v_bus = 48.0
bus = "fixed"
t_s = 5e-5
timer_period = 1800
adc_bits = 12
adc_gain = 0.01953125
adc_offset = 2048
offset_tolerance = 102
trip_current = 39.0
max_current = 30.0
hall_capture = "timer"
ticks = 50
age_max = 60000
rev_min = 1000
omega_max = 420.0
stall_periods = 0
calibration_log2 = 8
precharge_periods = 0
[controller]
kind = "pdcc"
{controller}
"#
    );
    Spec::from_toml(&text).unwrap()
}

/// The motor, its inverter and the sensors.
pub struct Plant {
    spec: Spec,
    shape: EmfShape,
    omega_e: f64,
    theta: f64,
    pub i: [f64; 3],
    /// Torque of each bin of the last period, Nm.
    pub torque: [f64; BINS],
}

impl Plant {
    pub fn new(spec: &Spec, rpm: f64, theta: f64) -> Self {
        let omega_e = rpm * TAU / 60.0 * f64::from(spec.motor.pole_pairs);
        Self {
            spec: spec.clone(),
            shape: EmfShape::new(&spec.motor).unwrap(),
            omega_e,
            theta,
            i: [0.0; 3],
            torque: [0.0; BINS],
        }
    }

    pub fn electrical_period(&self) -> f64 {
        TAU / self.omega_e.abs()
    }

    /// The sensors' present values.
    pub fn sample(&self) -> Sample {
        let inverter = &self.spec.inverter;
        let max = f64::from((1u32 << inverter.adc_bits) - 1);
        let adc = |i: f64| {
            (i / inverter.adc_gain.first() + f64::from(inverter.adc_offset.first()))
                .round()
                .clamp(0.0, max) as u16
        };
        // Sextants since 30 degrees before angle 0: sector 1 is [0, 1).
        let sextants = (self.theta + FRAC_PI_6) / FRAC_PI_3;
        let sector = sextants.floor().rem_euclid(6.0) as usize;
        let since = if self.omega_e > 0.0 {
            sextants - sextants.floor()
        } else {
            sextants.floor() + 1.0 - sextants
        };
        let ticks = since * FRAC_PI_3 / self.omega_e.abs() / inverter.t_s * inverter.ticks;
        Sample::with_hall(
            [adc(self.i[0]), adc(self.i[1])],
            self.spec.motor.hall_codes[sector],
        )
        .hall_ticks(ticks.floor().min(65_535.0) as u16)
    }

    /// One control period under three duties.
    pub fn advance_duty(&mut self, duty: [f64; 3]) {
        let (motor, inverter) = (&self.spec.motor, &self.spec.inverter);
        let dt = inverter.t_s / BINS as f64;
        let decay = -(-motor.resistance * dt / motor.inductance).exp_m1();
        for bin in 0..BINS {
            let (start, end) = (bin as f64 / BINS as f64, (bin + 1) as f64 / BINS as f64);
            let theta_mid = self.theta + self.omega_e * dt / 2.0;
            let mut drive = [0.0; 3];
            let mut shape = [0.0; 3];
            for x in 0..3 {
                let on = (end.min(0.5 + duty[x] / 2.0) - start.max(0.5 - duty[x] / 2.0)).max(0.0)
                    * BINS as f64;
                shape[x] = self.shape.unit(theta_mid - x as f64 * TAU / 3.0);
                drive[x] = on * inverter.v_bus
                    - shape[x] * motor.emf_constant * self.omega_e / f64::from(motor.pole_pairs);
            }
            let neutral = drive.iter().sum::<f64>() / 3.0;
            let mut torque = 0.0;
            for x in 0..3 {
                let before = self.i[x];
                self.i[x] += decay * ((drive[x] - neutral) / motor.resistance - before);
                torque += motor.emf_constant * shape[x] * (before + self.i[x]) / 2.0;
            }
            self.torque[bin] = torque;
            self.theta += self.omega_e * dt;
        }
    }
}

/// Torque's mean and ripple.
#[derive(Clone, Copy, Debug, Default)]
pub struct Merits {
    /// Nm.
    pub mean: f64,
    /// Peak to peak of the moving mean over a period, percent of the mean.
    pub pp: f64,
    /// Its standard deviation, percent of the mean.
    pub rms: f64,
    /// Largest phase current, ampere.
    pub peak: f64,
    /// Root mean square of the phase current, ampere.
    pub i_rms: f64,
}

/// Runs a controller on the plant from three starts, like the `hexagen` program, and returns the
/// figures of merit.
pub fn merits(
    spec: &Spec,
    rpm: f64,
    controller: impl Fn() -> Box<dyn FnMut(&Sample) -> [f64; 3]>,
) -> Merits {
    let mut total = Merits::default();
    for theta in [0.1, 0.117, 0.134] {
        let mut step = controller();
        let mut plant = Plant::new(spec, rpm, theta);
        let t_s = spec.inverter.t_s;
        let period = plant.electrical_period();
        // Two turns for the Hall timing plus two of settling.
        let drop = ((0.015f64).max(4.0 * period) / t_s).ceil() as usize;
        let measure = (6.0 * period / t_s).round() as usize;
        let mut torque = Vec::with_capacity(measure * BINS);
        let (mut peak, mut square) = (0f64, 0.0);
        let mut pending = step(&plant.sample());
        for k in 0..drop + measure {
            let next = step(&plant.sample());
            plant.advance_duty(pending);
            pending = next;
            if k >= drop {
                torque.extend_from_slice(&plant.torque);
                peak = plant.i.iter().fold(peak, |peak, i| peak.max(i.abs()));
                square += plant.i.iter().map(|i| i * i).sum::<f64>() / 3.0;
            }
        }
        let mean = torque.iter().sum::<f64>() / torque.len() as f64;
        let mut window: f64 = torque[..BINS].iter().sum();
        let (mut least, mut greatest, mut variance, mut count) = (f64::MAX, f64::MIN, 0.0, 0.0);
        for k in BINS..torque.len() {
            let smooth = window / BINS as f64;
            least = least.min(smooth);
            greatest = greatest.max(smooth);
            variance += (smooth - mean) * (smooth - mean);
            count += 1.0;
            window += torque[k] - torque[k - BINS];
        }
        total.mean += mean / 3.0;
        total.pp = total.pp.max((greatest - least) / mean * 100.0);
        total.rms += (variance / count).sqrt() / mean * 100.0 / 3.0;
        total.peak = total.peak.max(peak);
        total.i_rms += (square / measure as f64).sqrt() / 3.0;
    }
    total
}
