//! The plant as a whole: state, one control period at a time, samples and truth.

use super::gates::{Gate, Gates};
use super::hall::Sensors;
use super::network::{Network, balance, set_shape};
use super::segment::{Segment, integral};
use super::short::{Detour, tied};
use super::{Mechanics, PlantError, PlantParams, adc, emf, sector_of, wrap};
use hexagen::Sample;
use hexagen_reference::AnyCommand;
use std::f64::consts::TAU;

/// Minimum steps per period with a free speed, which is constant within a step.
const MECHANICAL_STEPS: f64 = 20.0;

/// Segments in a period beyond which events are resolved to a thousandth of it only, so that a
/// period always ends. No known circuit comes near.
const MAX_SEGMENTS: u32 = 1000;

/// Start of the ADCs' noise: it is the same in every run.
const NOISE_SEED: u64 = 1;

/// The plant's true state at a sampling instant, for ideal controllers and for records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// Time in seconds.
    pub t: f64,
    /// Electrical angle in radians, `[0, 2 pi)`.
    pub theta_e: f64,
    /// Electrical speed in rad/s.
    pub omega_e: f64,
    /// Mechanical speed in rad/s.
    pub omega_m: f64,
    /// True sector, 1 to 6.
    pub sector: usize,
    /// Phase currents in amperes.
    pub currents: [f64; 3],
    /// Mean terminal voltages of the last period in volts against the negative rail; zero before
    /// the first.
    pub mean_voltages: [f64; 3],
    /// Mean torque of the last period in newton metres; zero before the first.
    pub mean_torque: f64,
}

/// Observes every segment of the solution.
pub trait Observer {
    /// Called once per segment, in order of time.
    fn segment(&mut self, segment: &Segment);
}

/// An observer that does nothing.
impl Observer for () {
    fn segment(&mut self, _: &Segment) {}
}

/// Several observers at once.
impl<A: Observer, B: Observer> Observer for (A, B) {
    fn segment(&mut self, segment: &Segment) {
        self.0.segment(segment);
        self.1.segment(segment);
    }
}

impl<T: Observer + ?Sized> Observer for &mut T {
    fn segment(&mut self, segment: &Segment) {
        (**self).segment(segment);
    }
}

/// A motor with inverter and sensors.
#[derive(Clone, Debug)]
pub struct Plant {
    params: PlantParams,
    network: Network,
    gates: Gates,
    sensors: Sensors,
    segment: Segment,
    period: u64,
    theta_e: f64,
    /// Whole electrical turns before it.
    turns: f64,
    omega_m: f64,
    currents: [f64; 3],
    mean_voltages: [f64; 3],
    mean_torque: f64,
    /// The sensed legs at those channels' instants that come before the next period.
    early: [LegNow; 3],
    noise: fastrand::Rng,
    blind: u64,
}

/// A leg at an instant.
#[derive(Clone, Copy, Debug, Default)]
struct LegNow {
    /// Current in amperes.
    current: f64,
    gate: Gate,
    /// How long the gate has been as it is, second.
    held_for: f64,
}

/// Integrals over a part of a period.
#[derive(Clone, Copy, Debug, Default)]
struct Integrals {
    /// Of the terminal voltages, volt-seconds.
    volt_seconds: [f64; 3],
    /// Of the torque, newton metre seconds.
    impulse: f64,
}

impl Integrals {
    fn add(&mut self, impulse: f64, volt_seconds: [f64; 3]) {
        self.impulse += impulse;
        for (sum, part) in self.volt_seconds.iter_mut().zip(volt_seconds) {
            *sum += part;
        }
    }
}

impl Plant {
    /// A plant without current at electrical angle `theta_e` (radians) and mechanical speed
    /// `omega_m` (rad/s), all legs off.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(params: PlantParams, theta_e: f64, omega_m: f64) -> Result<Self, PlantError> {
        params.check()?;
        Ok(Self {
            network: Network::new(&params),
            gates: Gates::new(params.dead_time, params.wiring),
            sensors: Sensors::new(
                params.hall_edges_deg,
                params.hall_error_deg,
                params.hall_codes,
            ),
            segment: Segment::default(),
            period: 0,
            theta_e: wrap(theta_e),
            turns: 0.0,
            omega_m,
            currents: [0.0; 3],
            mean_voltages: [0.0; 3],
            mean_torque: 0.0,
            early: [LegNow::default(); 3],
            noise: fastrand::Rng::with_seed(NOISE_SEED),
            blind: 0,
            params,
        })
    }

    /// The plant's parameters.
    pub fn params(&self) -> &PlantParams {
        &self.params
    }

    /// Changes parameters between two periods: something breaks, or is repaired. The rotor keeps
    /// angle and speed; the current of a wire that opens ends in its arc.
    ///
    /// # Errors
    /// A parameter outside its range; then nothing changes.
    pub fn change(&mut self, change: impl FnOnce(&mut PlantParams)) -> Result<(), PlantError> {
        let mut params = self.params.clone();
        change(&mut params);
        params.check()?;
        self.network = Network::new(&params);
        self.gates.change(params.dead_time, params.wiring);
        self.sensors.change(
            params.hall_edges_deg,
            params.hall_error_deg,
            params.hall_codes,
        );
        self.currents = self.network.without_open(self.currents);
        self.params = params;
        Ok(())
    }

    /// Sets the mechanical speed in rad/s.
    pub fn set_speed(&mut self, omega_m: f64) {
        self.omega_m = omega_m;
    }

    /// Sets the phase currents in amperes, to start from another state than rest. Their sum must
    /// be zero; a remainder is taken from the third.
    pub fn set_currents(&mut self, [i_a, i_b]: [f64; 2]) {
        self.currents = [i_a, i_b, -i_a - i_b];
    }

    /// Changes the load torque that opposes the motion, where the speed is free.
    pub fn set_load(&mut self, opposing_torque: f64) {
        if let Some(mechanics) = &mut self.params.mechanics {
            mechanics.opposing_torque = opposing_torque;
        }
    }

    /// Time in seconds: the start of the next period.
    pub fn time(&self) -> f64 {
        self.period as f64 * self.params.t_s
    }

    /// Turn-ons of all six switches so far.
    pub fn turn_ons(&self) -> u64 {
        self.gates.turn_ons()
    }

    /// The true state now.
    pub fn truth(&self) -> Truth {
        Truth {
            t: self.time(),
            theta_e: self.theta_e,
            omega_e: self.omega_m * f64::from(self.params.pole_pairs),
            omega_m: self.omega_m,
            sector: sector_of(self.theta_e),
            currents: self.currents,
            mean_voltages: self.mean_voltages,
            mean_torque: self.mean_torque,
        }
    }

    /// The controller's sample of the period that begins. `next` is that period's command: a channel
    /// that is sampled later than the first sees the currents under it.
    pub fn sample(&mut self, next: impl Into<AnyCommand>) -> Sample {
        let next = next.into();
        let since_edge = (self.time() - self.sensors.last_edge()) / self.params.t_s;
        let ticks = (since_edge * self.params.hall_ticks_per_period).floor();
        let mut counts = [0; 3];
        let mut blind = 0_u64;
        for place in 0..self.params.adc.len() {
            let (current, is_seen) = self.read(place, next);
            blind += u64::from(!is_seen);
            let channel = &self.params.adc[place];
            counts[self.params.sensed[place]] = adc::convert(channel, current, &mut self.noise);
        }
        // Of three sensors two are enough.
        let spared = self.params.adc.len() as u64 - 2;
        self.blind += blind.saturating_sub(spared);
        let [adc_a, adc_b, adc_c] = counts;
        if let Some(sensor) = self.params.angle {
            let angle = sensor.word(self.theta_e + TAU * self.turns);
            return Sample::with_angle([adc_a, adc_b], angle).third_current(adc_c);
        }
        Sample::with_hall([adc_a, adc_b], self.sensors.code(self.theta_e))
            .third_current(adc_c)
            .hall_ticks(ticks.clamp(0.0, f64::from(u16::MAX)) as u16)
    }

    /// What a channel's sensor shows of its phase's current, and whether that is the current, not cut
    /// short by the next command: the one that flows at its instant, or the one at the turning point, which a
    /// controller wants. Where legs were off until then no current flows, and a sensor that has not settled
    /// shows that, which is right; so is what begins to flow until a later instant.
    fn read(&mut self, place: usize, next: AnyCommand) -> (f64, bool) {
        let (instant, phase) = (self.params.adc[place].instant, self.params.sensed[place]);
        let leg = if instant < 0.0 {
            self.early[place]
        } else if instant > 0.0 {
            let mut later = self.clone();
            later.begin(next);
            later.advance((0.0, instant), &mut Integrals::default(), &mut ());
            later.leg(phase, instant)
        } else {
            self.leg(phase, 0.0)
        };
        let Some(low_side) = self.params.low_side else {
            return (leg.current, true);
        };
        let gate = (leg.gate, leg.held_for);
        let (seen, is_settled) = adc::seen(low_side, gate, self.params.dead_time, leg.current);
        let until = instant + low_side.aperture;
        let timing = (self.params.timer_period, self.params.pwm_period());
        let is_held = adc::is_held(until, next, phase, timing);
        let before = self.leg(phase, 0.0);
        let begins = before.gate == Gate::Off && before.current == 0.0;
        let is_right = is_settled || seen == before.current || begins;
        (seen, is_right && is_held)
    }

    /// A leg `t` seconds into the period.
    fn leg(&self, leg: usize, t: f64) -> LegNow {
        let gates = self.gates.state();
        let detour = Detour::of(self.params.wiring.short, gates, self.params.v_bus);
        LegNow {
            current: detour.legs(self.currents)[leg],
            gate: gates[leg],
            held_for: self.gates.held_for(t)[leg],
        }
    }

    /// Samples so far, each sensor's by itself, that did not show the current, or that the next command cut short; of
    /// three sensors that sample at once one may, as the other two show its current.
    pub fn blind_samples(&self) -> u64 {
        self.blind
    }

    /// Runs one control period under a command.
    pub fn run_period(&mut self, command: impl Into<AnyCommand>, observer: &mut dyn Observer) {
        let t_s = self.params.t_s;
        let mut integrals = Integrals::default();
        let mut t = 0.0;
        self.begin(command.into());
        for place in 0..self.params.adc.len() {
            let instant = t_s + self.params.adc[place].instant;
            if instant < t_s {
                self.advance((t, instant), &mut integrals, observer);
                self.early[place] = self.leg(self.params.sensed[place], instant);
                t = instant;
            }
        }
        self.advance((t, t_s), &mut integrals, observer);
        self.gates.end(t_s);
        self.period += 1;
        self.mean_voltages = integrals.volt_seconds.map(|sum| sum / t_s);
        self.mean_torque = integrals.impulse / t_s;
    }

    /// Begins a period with a command.
    fn begin(&mut self, command: AnyCommand) {
        let pulses = (self.params.pwm_period(), self.params.pwm_per_control);
        self.gates.begin(command, self.params.timer_period, pulses);
    }

    /// Runs a part of a period; its ends in seconds from the period's start.
    fn advance(
        &mut self,
        (mut t, end): (f64, f64),
        integrals: &mut Integrals,
        observer: &mut dyn Observer,
    ) {
        let t_s = self.params.t_s;
        let mut segments = 0;
        while t < end {
            let until = self.gates.advance_to(t).min(end);
            self.prepare_segment(t, until);
            let gates = self.connect();
            let planned = self.segment.duration;
            let zero_leg = self
                .network
                .solve(gates, &mut self.currents, &mut self.segment);
            segments += 1;
            if segments > MAX_SEGMENTS * u32::from(self.params.pwm_per_control) {
                self.segment.duration = self.segment.duration.max(planned.min(1e-3 * t_s));
            }
            let h = self.segment.duration;
            self.segment.fill_torque();
            observer.segment(&self.segment);

            let impulse = integral(&self.segment.torque[..self.segment.terms], h);
            integrals.add(impulse, self.segment.volt_seconds());
            self.currents = self.segment.currents_at(h);
            if let Some(leg) = zero_leg {
                self.currents[leg] = 0.0;
            }
            balance(&mut self.currents, gates);
            self.turn(impulse);
            let whole = h >= planned && t + planned >= until - 1e-9 * t_s;
            t = if whole { until } else { t + h };
        }
    }

    /// What the gates connect to the windings, for the next segment.
    fn connect(&mut self) -> [Gate; 3] {
        let gates = self.network.reached(self.gates.state());
        let short = self.params.wiring.short;
        self.segment.detour = Detour::of(short, gates, self.params.v_bus);
        let shape = self.segment.shape.each_ref();
        let emf = shape.map(|series| self.segment.omega_m * series[0]);
        tied(short, gates, self.currents, emf)
    }

    /// Turns the rotor by the segment that ends, with the impulse (N m s) of the motor's torque.
    fn turn(&mut self, impulse: f64) {
        let h = self.segment.duration;
        let theta_end = self.theta_e + self.segment.omega_e * h;
        self.sensors
            .sweep(self.theta_e, theta_end, self.segment.start, h);
        self.theta_e = wrap(theta_end);
        self.turns += ((theta_end - self.theta_e) / TAU).round();
        if let Some(mechanics) = self.params.mechanics {
            self.omega_m = speed_after(&mechanics, self.omega_m, impulse, h);
        }
    }

    /// Fills times, speed and EMF of the next segment, `t` seconds into the period and at most up
    /// to `until`.
    fn prepare_segment(&mut self, t: f64, until: f64) {
        let params = &self.params;
        let mut h = until - t;
        let mut omega_m = self.omega_m;
        if let Some(mechanics) = &params.mechanics {
            h = h.min(params.t_s / MECHANICAL_STEPS);
            let shape = emf::values(params.shape, self.theta_e, params.wiring.windings);
            let torque: f64 = (0..3)
                .map(|x| params.k_phase[x] * shape[x] * self.currents[x])
                .sum();
            omega_m = 0.5 * (omega_m + speed_after(mechanics, omega_m, torque * h, h));
        }
        let omega_e = omega_m * f64::from(params.pole_pairs);
        // Speed of the fastest wave of the EMF.
        let sine_speed = omega_e * params.shape.highest_order() as f64;
        h = h.min(self.network.longest_step(sine_speed));
        if omega_e != 0.0 {
            h = h.min(emf::angle_to_corner(params.shape, self.theta_e, omega_e) / omega_e.abs());
        }
        self.segment.start = self.period as f64 * params.t_s + t;
        self.segment.offset = t;
        self.segment.duration = h;
        self.segment.terms = self.network.terms(sine_speed, h);
        self.segment.theta_e = self.theta_e;
        self.segment.omega_e = omega_e;
        self.segment.omega_m = omega_m;
        set_shape(params, &mut self.segment);
    }
}

/// Mechanical speed after `h` seconds with the given impulse (N m s) of the motor's torque.
fn speed_after(mechanics: &Mechanics, omega_m: f64, impulse: f64, h: f64) -> f64 {
    // Trapezoidal rule for the viscous part: second order, stable for any step.
    let decay = 0.5 * mechanics.viscous * h / mechanics.inertia;
    let driving = (impulse + mechanics.external_torque * h) / mechanics.inertia;
    let free = (omega_m * (1.0 - decay) + driving) / (1.0 + decay);
    let friction = mechanics.opposing_torque * h;
    // Dry friction decelerates, but never reverses the rotation.
    let slowed = free.abs() - friction / mechanics.inertia;
    if slowed > 0.0 {
        slowed.copysign(free)
    } else {
        0.0
    }
}
