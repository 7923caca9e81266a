//! Model A: the control law in f64 and physical units, with no rounding anywhere.
//!
//! Vectors are amplitude-invariant alpha-beta (`hexagen::conventions`); the inputs are the ADC
//! counts, Hall codes and timer ticks of the generated code, the outputs exact duties.

mod emf;
pub(super) mod hall_learning;
mod law;
mod limit;
mod speed;
pub(super) mod torque_learning;
mod vector;

use super::angle::AngleSensor;
use super::hall::{GREATEST_CHANGE, HallClock, RISE, SMALL_CURRENT, across_at_small_angle};
use super::sector::{self, HallEvent};
use super::supervision::{BusWatch, Limits, Observation, Period, Stop, Units};
use super::trace::{Past, PhysicalState, Reach, Trace};
use super::variant::{Variant, allowed_residual, emf_error_limit, emf_limit, stretch_mean};
use crate::emf_motion::EmfMotion;
use crate::emf_shape::THIRD;
use crate::{
    AnyCommand, BusSense, CommutationEnd, DiscretePhase, EmfShape, EmfSource, Error, Reference,
    Spec, Switch,
};
use hexagen::{Fault, Intervals, LegState, Legs, Sample};
use law::{Command, Inputs, Law};
use nalgebra::{Vector2, Vector3};
use speed::SpeedLoop;
use std::f64::consts::{FRAC_PI_3, FRAC_PI_6, TAU};
use torque_learning::TorqueLearning;
use vector::{clarke, from_ab, phases, to_ab};

/// Radians of an angle word.
const RADIANS: f64 = TAU / 4_294_967_296.0;

/// Greatest angle of the reference against the field, turns.
const MOST_TURN: f64 = 75.0 / 360.0;
/// Its change in a period.
const WEAKENING_STEP: f64 = MOST_TURN / 128.0;
/// Current left, over the greatest one, from which on a reference that is turned is even.
const EVEN: f64 = 0.25;

/// Exact leg commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Duties {
    /// Fraction of the period during which the upper switch is on, 0 to 1, phases a, b, c; with intervals the ends of the
    /// first two and 0.
    pub duty: [f64; 3],
    /// States of legs a, b, c, in the first interval.
    pub state: [LegState; 3],
    /// Those in the two later intervals; none of pulses.
    pub later: Option<[[LegState; 3]; 2]>,
}

impl Duties {
    const LOW: Self = Self {
        duty: [0.0; 3],
        state: [LegState::Low; 3],
        later: None,
    };
    const OFF: Self = Self {
        duty: [0.0; 3],
        state: [LegState::Off; 3],
        later: None,
    };

    /// The nearest timer counts, ties up.
    pub fn to_command(self, timer_period: u16) -> AnyCommand {
        let counts = |duty: f64| (duty * f64::from(timer_period) + 0.5).floor() as u16;
        let [first, second, third] = self.duty.map(counts);
        match self.later {
            None => Legs::new([first, second, third], self.state).into(),
            Some([two, three]) => Intervals::new([first, second], [self.state, two, three]).into(),
        }
    }
}

/// The ideal controller of one drive.
#[derive(Clone, Debug)]
pub struct Ideal {
    // From the specification.
    variant: Variant,
    law: Law,
    /// Current below which an off leg is without current and a commutation ends.
    end: CommutationEnd,
    phase: DiscretePhase,
    shape: EmfShape,
    /// Mean of 1/|f|^2 where the EMF's error is corrected along the EMF's own shape.
    stretch_mean: Option<f64>,
    hall_sectors: [usize; 8],
    /// Of each sector, where it begins beyond its place, and its width, radian.
    sectors: [[f64; 2]; 6],
    bus_watch: Option<BusWatch>,
    clock: HallClock,
    /// In place of Hall sensors.
    sensor: Option<AngleSensor>,
    limits: Limits,
    gain: f64,
    bus_sense: Option<BusSense>,
    bus_count_max: f64,
    timer_period: u16,
    di_limit: f64,
    e_max: f64,
    motion: EmfMotion,
    /// The largest bus voltage.
    v_largest: f64,
    /// Limit of the modelled EMF's error, volt.
    emf_error_limit: f64,
    max_current: f64,
    k_t: f64,
    k_phase: f64,
    pp_t_s: f64,
    speed_loop: Option<SpeedLoop>,
    /// Residual allowed always, per ampere, per electrical radian per second, and without an angle, volt.
    allowed_residual: [f64; 4],
    t_s: f64,
    /// Greatest change of the speed set-point in a period, rad/s; 0 for any.
    speed_step: f64,
    /// Greatest change of the set-point in a period, ampere; 0 for any.
    slew_step: f64,
    /// c2 and c4 of the torque that a turned current keeps; with field weakening only.
    weakening_share: Option<[f64; 2]>,
    /// Whether the places of the Hall sensors are learnt.
    learns_halls: bool,
    /// Learning of the torque constant.
    torque: Option<TorqueLearning>,
    /// Error of the EMF across the shape where the angle is off, volt per electrical rad/s.
    across_at_small_angle: f64,
    /// Bus voltages of the whole set-point and of none, volt: of braking, and of motoring torque.
    fades: [Option<[f64; 2]>; 2],
    /// Greatest bus current, drawn and returned, ampere.
    bus_currents: [Option<f64>; 2],
    /// Part of the PWM period that a pulse loses to the dead time; 0 for whole vectors.
    dead_share: f64,
    // Set-points.
    current: f64,
    /// The speed set-point, mechanical rad/s.
    speed: f64,
    v_bus: f64,
    state: PhysicalState,
    trace: Trace,
}

impl Ideal {
    /// A controller in its initial state.
    ///
    /// # Errors
    /// If the specification is inconsistent.
    pub fn new(spec: &Spec) -> Result<Self, Error> {
        let (motor, inverter) = (&spec.motor, &spec.inverter);
        let phase = DiscretePhase::new(spec);
        let bus_sense = inverter.bus_sense()?;
        let gain = inverter.adc_gain.first().abs();
        // A current of exactly the trip level is not above it, whatever these floating-point
        // numbers lose.
        let trip_current = inverter.trip_current + 1e-6 * gain;
        let limits = Limits::new(
            spec,
            Units {
                i_trip: trip_current,
                count: gain,
                ampere: 1.0,
                ratio_bits: None,
            },
        )?;
        let pole_pairs = f64::from(motor.pole_pairs);
        let mut ideal = Self {
            variant: Variant::new(spec),
            law: Law::new(spec)?,
            end: spec.commutation_end().unwrap_or_default(),
            phase,
            shape: EmfShape::new(motor)?,
            stretch_mean: stretch_mean(spec, EmfShape::new(motor)?),
            hall_sectors: sector::hall_sectors(motor),
            sectors: motor.sectors_beyond_places(),
            bus_watch: BusWatch::new(inverter),
            clock: HallClock::new(spec),
            sensor: AngleSensor::new(spec),
            limits,
            gain,
            bus_sense,
            bus_count_max: bus_sense.map_or(0.0, |bus| f64::from((1u32 << bus.adc_bits) - 1)),
            timer_period: inverter.timer_period as u16,
            di_limit: phase.di_limit(inverter)? * gain,
            e_max: emf_limit(spec) * inverter.v_bus / f64::from(inverter.timer_period),
            motion: EmfMotion::new(spec)?,
            v_largest: inverter.v_bus_max()?,
            emf_error_limit: emf_error_limit(spec)? * inverter.v_bus
                / f64::from(inverter.timer_period),
            max_current: inverter.max_current,
            k_t: motor.torque_constant,
            k_phase: motor.emf_constant,
            pp_t_s: pole_pairs * inverter.t_s,
            speed_loop: SpeedLoop::new(spec),
            allowed_residual: allowed_residual(spec),
            t_s: inverter.t_s,
            speed_step: spec.loop_options().acceleration_limit * inverter.t_s,
            slew_step: spec.loop_options().slew_rate * inverter.t_s,
            weakening_share: spec.weakening_share(),
            across_at_small_angle: across_at_small_angle(motor),
            torque: TorqueLearning::new(spec)?,
            learns_halls: spec.loop_options().hall_learning == Switch::On,
            fades: [inverter.braking_fade, inverter.motoring_fade],
            bus_currents: [inverter.bus_current_limit, inverter.return_current_limit],
            dead_share: spec.dead_share(),
            current: if spec.loop_options().has_speed_loop() {
                inverter.max_current
            } else {
                0.0
            },
            speed: 0.0,
            v_bus: inverter.v_bus,
            state: PhysicalState::default(),
            trace: Trace::default(),
        };
        ideal.state.offset = ideal.limits.adc_offset;
        ideal.state.supervisor.start(&ideal.limits);
        Ok(ideal)
    }

    /// Proportional current of one ampere at an electrical angle.
    fn proportional(&self, theta: f64) -> Vector2<f64> {
        let f = self.shape.alpha_beta(theta);
        f * (2.0 / 3.0 * self.k_t / self.k_phase / f.norm_squared())
    }

    /// The reference turned against the field, and rise and fall of the angle if the voltage is cut or not (section
    /// "Field weakening"). `shape`: the current of one ampere along the EMF at the angle `theta`.
    fn weakened(
        &self,
        [square, fourth]: [f64; 2],
        theta: f64,
        shape: &Vector2<f64>,
        current: f64,
    ) -> (Vector2<f64>, [f64; 2]) {
        let turn = self.state.weakening;
        let sign = if current >= 0.0 { 1.0 } else { -1.0 };
        let share = 1.0 - turn * turn * (square - fourth * turn * turn);
        let surplus = (self.max_current * share - current.abs()).max(0.0);
        let turned = self.proportional(theta + sign * TAU * turn);
        let i_ref = (turned * self.max_current - shape * surplus) * sign;
        let i_ref = if self.shape == EmfShape::Sinusoidal {
            i_ref
        } else {
            let against = 3f64.sqrt() / 2.0 * (self.max_current - current.abs());
            let against = against.min(self.max_current * turn / MOST_TURN);
            let even = shape * current + Vector2::new(-shape.y, shape.x) * against;
            i_ref.lerp(&even, (surplus / (EVEN * self.max_current)).min(1.0))
        };
        let slow = WEAKENING_STEP / 4.0;
        let changes = if surplus > 0.0 {
            [WEAKENING_STEP, slow]
        } else {
            [slow, WEAKENING_STEP]
        };
        (i_ref, changes)
    }

    /// Sets the current set-point, ampere; saturates at the largest current.
    pub fn set_current_amps(&mut self, current: f64) {
        self.current = current.clamp(-self.max_current, self.max_current);
    }

    /// Sets the current set-point from the bits of an `I16F16` in ampere.
    pub fn set_current(&mut self, bits: i32) {
        self.set_current_amps(f64::from(bits) / 65_536.0);
    }

    /// Sets the torque set-point from the bits of an `I16F16` in newton metres.
    pub fn set_torque(&mut self, bits: i32) {
        let torque = f64::from(bits) / 65_536.0 * self.state.torque.ratio;
        self.set_current_amps(torque / self.k_t);
    }

    /// Sets the speed from the bits of an `I16F16` in rpm. No effect without a speed loop.
    pub fn set_speed(&mut self, bits: i32) {
        if let Some(speed_loop) = &self.speed_loop {
            self.speed = speed_loop.allowed(f64::from(bits) / 65_536.0 * TAU / 60.0);
        }
    }

    /// Sets the bus voltage as an ADC count. No effect if the bus is not measured.
    pub fn set_bus(&mut self, counts: u16) {
        if let Some(watch) = &mut self.bus_watch {
            watch.tell(counts);
        }
        if let Some(bus) = self.bus_sense {
            self.v_bus =
                (f64::from(counts).min(self.bus_count_max) * bus.gain).clamp(bus.min, bus.max);
        }
    }

    /// Clears a trip and all control state, and sets the set-point to 0 (the speed with a speed
    /// loop, else the current); keeps the offsets. Ignored during calibration and pre-charge.
    pub fn reset(&mut self) {
        if self.state.supervisor.may_reset() {
            self.clear();
            let unread = self.state.supervisor.unread;
            self.state = PhysicalState {
                offset: self.state.offset,
                ..PhysicalState::default()
            };
            self.state.supervisor.unread = unread;
            self.state.supervisor.start(&self.limits);
        }
    }

    /// Sets the set-point to 0.
    fn clear(&mut self) {
        match self.speed_loop {
            Some(_) => self.speed = 0.0,
            None => self.current = 0.0,
        }
    }

    /// Starts current-offset calibration.
    pub fn calibrate(&mut self) {
        self.state.supervisor.calibrate(&self.limits);
    }

    /// Starts bootstrap pre-charge.
    pub fn precharge(&mut self) {
        self.state.supervisor.precharge(&self.limits);
    }

    /// Coasts, brakes, or ends both; then the set-point is 0.
    pub fn stop(&mut self, stop: Stop) {
        match stop {
            Stop::Coast => self.state.supervisor.coast(),
            Stop::Brake => self.state.supervisor.brake(),
            Stop::Resume => {
                if self.state.supervisor.resume() {
                    self.clear();
                }
            }
        }
    }

    /// Fault of the controller.
    pub fn fault(&self) -> Option<Fault> {
        self.state.supervisor.fault
    }

    /// Signals of the last step.
    pub fn trace(&self) -> &Trace {
        &self.trace
    }

    /// The state.
    pub fn physical_state(&self) -> PhysicalState {
        self.state
    }

    /// Copies another model's state, to measure the error of one step.
    pub fn rebuild_from(&mut self, state: &PhysicalState) {
        self.state = *state;
    }

    /// One control period: reads the sample, returns the exact command.
    pub fn step(&mut self, sample: &Sample) -> Duties {
        let most = f64::from(self.variant.options.residual_periods);
        let known = if let Some(fault) = self.bus_watch.as_mut().and_then(BusWatch::age) {
            Some(fault)
        } else if most > 0.0 && self.state.residual_count >= most {
            Some(Fault::Residual)
        } else {
            (self.state.timing.is_too_fast()).then_some(Fault::OverSpeed)
        };
        // 1 measure
        let limits = &self.limits;
        let adc = limits.sensed.of_sensors(sample.adc()).map(f64::from);
        let shown = [0, 1, 2].map(|x| {
            let counts = adc[x].min(limits.adc_max) - self.state.offset[x];
            counts * limits.polarity[x] * limits.ratio[x] * self.gain
        });
        let measured = limits.phases(shown, self.state.supervisor.unread(limits));
        let [i_a, i_b] = limits.for_law(measured);
        let i_abc = Vector3::new(i_a, i_b, -(i_a + i_b));
        let i = clarke(&i_abc);

        // 2 hall, 3 supervise
        let hall = (self.sensor).map_or_else(|| sample.hall(), |sensor| sensor.code(sample));
        let hall = self.state.supervisor.take_hall(&self.limits, hall);
        let event = HallEvent::new(&self.hall_sectors, hall.code(), self.state.sector_prev);
        let direction_before = self.state.timing.direction;
        self.state.timing.turn_direction(&event);
        let seen = Observation {
            known,
            adc,
            i: measured,
            sum: shown.iter().sum(),
            hall,
            demand: match self.speed_loop {
                Some(_) => self.speed != 0.0,
                None => self.current != 0.0,
            },
        };
        let verdict = self.state.supervisor.step(&self.limits, &seen);
        if verdict.calibrated {
            self.state.offset = self
                .state
                .supervisor
                .sum
                .map(|sum| sum / self.limits.calibration_samples);
        }
        let run = verdict.period == Period::Control;
        if let Some(direction) = verdict.against {
            match self.speed_loop {
                Some(_) => self.speed = 0.0,
                None => self.current = -direction * self.max_current,
            }
        }

        // 4 rotor
        let sector = event.sector;
        let (theta, step_angle, sector_eff) =
            if let (true, Some(sensor)) = (self.variant.rotor, self.sensor) {
                let theta = sensor.theta(sample);
                let timing = &mut self.state.timing;
                sensor.follow(timing, theta, |turn| turn * sensor.share);
                self.sensed(theta, sector)
            } else if self.variant.rotor {
                let ticks = f64::from(sample.ticks());
                let timing = &mut self.state.timing;
                let tells = timing.step(&self.clock, &event, direction_before, ticks);
                if event.edge && self.learns_halls {
                    self.learn_edges(&event, tells, [i_a, i_b]);
                }
                self.angle(sector)
            } else {
                (0.0, 0.0, sector)
            };

        self.state.step_angle = step_angle;
        if let Some(learning) = &self.torque
            && self.state.timing.edges >= 2
        {
            let error = self.state.emf_error[0];
            self.state.torque.ratio = learning.learn(self.state.torque, error, step_angle);
        }

        // Slew rate, speed loop
        let (mut current, mut speed_integral) = (self.current, self.state.speed_integral);
        if self.slew_step > 0.0 {
            let before = self.state.current_in_force;
            current = current.clamp(before - self.slew_step, before + self.slew_step);
        }
        let current_in_force = current;
        let direction = self.state.timing.direction;
        let allowed = self.allowed(direction);
        let mut speed_in_force = self.speed;
        if let Some(speed_loop) = &self.speed_loop {
            let angle = self.electrical_speed() * direction;
            if self.speed_step > 0.0 {
                let before = if self.state.ramp_begun < self.state.timing.ramp_known() {
                    speed_loop.speed(angle)
                } else {
                    self.state.speed_in_force
                };
                let step = self.speed_step;
                speed_in_force = speed_in_force.clamp(before - step, before + step);
            }
            let wanted = (speed_in_force, angle);
            (current, speed_integral) =
                speed_loop.regulate(wanted, current, allowed, speed_integral);
        } else {
            current = current.max(allowed[0]).min(allowed[1]);
        }

        // 5 commutation
        let commutating =
            self.variant.commutation.is_some() && self.commutate(sector_eff, current, &i_abc);

        // 6 reference
        let target = f64::from(1 + self.variant.options.delay) * step_angle;
        let shape = self.proportional(theta + target);
        let i_ref = match self.variant.options.reference {
            Reference::QuasiSquare => {
                from_ab(sector::CORNER_A[sector_eff], sector::CORNER_B[sector_eff]) * current
            }
            Reference::Proportional => shape * current,
        };
        let (i_ref, [rise, fall]) = match self.weakening_share {
            Some(share) if self.state.weakening > 0.0 => {
                self.weakened(share, theta + target, &shape, current)
            }
            _ => (i_ref, [WEAKENING_STEP; 2]),
        };

        // 8 EMF
        let delayed = self.variant.delayed();
        let mut emf_error = self.state.emf_error;
        let mut residual_count = self.state.residual_count;
        let mut light = self.state.torque.light;
        let (e, e_now) = match self.variant.emf {
            None | Some(EmfSource::Held) => (Vector2::zeros(), Vector2::zeros()),
            Some(EmfSource::Estimated) => {
                let raw = self.behind(self.state.v_prev, [i_a, i_b]);
                let [e_a, e_b] = self.state.e_prev;
                let e_prev = from_ab(e_a, e_b);
                let [e_a, e_b] =
                    to_ab(&(e_prev + (raw - e_prev) * self.variant.options.emf_filter))
                        .map(|e| self.believed(e));
                let mut e = from_ab(e_a, e_b);
                if self.variant.unseen() {
                    e = self.with_floated(&e, sector_eff);
                }
                let [present, target] = self.moved_on(&e, sector);
                (if delayed { target } else { present }, present)
            }
            Some(source @ (EmfSource::Model | EmfSource::Observer)) => {
                let start = theta + f64::from(self.variant.options.delay) * step_angle;
                let mean = |from: f64, to: f64| {
                    let [e_a, e_b] = [0.0, THIRD].map(|lag| {
                        let linkage = self.shape.zero_sum_integral(to - lag)
                            - self.shape.zero_sum_integral(from - lag);
                        (self.k_phase / self.pp_t_s * linkage).clamp(-self.e_max, self.e_max)
                    });
                    from_ab(e_a, e_b)
                };
                let e = mean(start, theta + target);
                if source == EmfSource::Model {
                    (e, mean(theta, start))
                } else {
                    let residual = self.residual([i_a, i_b]);
                    emf_error = self.corrected_error(residual, &shape);
                    residual_count =
                        self.counted_residual(residual, emf_error, [current, step_angle]);
                    if let Some(learning) = &self.torque {
                        let told = [current, emf_error[0]];
                        let is_fresh = self.bus_watch.is_some_and(|watch| !watch.is_stale());
                        let v_bus = is_fresh.then_some(self.v_bus);
                        light = learning.count(light, told, v_bus, step_angle);
                    }
                    let e = self.corrected_emf(&e, emf_error, (theta + target, &shape));
                    let [next_a, next_b] = self.state.e_next;
                    (e, if delayed { from_ab(next_a, next_b) } else { e })
                }
            }
        };

        let [s_a, s_b] = self.state.integral;
        let integral = from_ab(s_a, s_b);
        let [i_next, i_due] = [self.state.j_next, self.state.j_due]
            .map(|[j_a, j_b]| from_ab(j_a, j_b) * self.phase.b);

        // 7 applied voltage
        let v_now = match (self.variant.applied_now, self.variant.floating) {
            (false, _) => Vector2::zeros(),
            (true, false) => from_ab(self.state.v_cmd[0], self.state.v_cmd[1]),
            (true, true) => self.applied(
                &Vector3::from(self.state.t_cmd),
                self.state.off_cmd,
                &i_abc,
                &e_now,
            ),
        };

        let net = if !self.variant.applied_now {
            Vector2::zeros()
        } else if self.variant.observes() && !self.variant.floating {
            from_ab(self.state.net_next[0], self.state.net_next[1])
        } else {
            v_now - e_now
        };

        // 9 to 11, specific to the controller
        let decision = self.law.decide(&Inputs {
            phase: self.phase,
            delayed,
            v_bus: self.v_bus,
            i_ref,
            i,
            net,
            e,
            sector_eff,
            commutating,
            integral,
            i_begin: if delayed { i_next } else { i_due },
            i_due,
            set_point: current,
            direction: self.state.timing.direction,
            rises: self.state.rises,
            vector_prev: self.state.vector_prev,
            emf_is_held: self.variant.held == Switch::On,
            past: self.state.past,
        });
        let command = match verdict.period {
            Period::Control => decision.command,
            Period::Low => Command::idle(self.at_rest(Duties::LOW)),
            Period::Off => Command::idle(self.at_rest(Duties::OFF)),
        };
        let legs = command.duties.to_command(self.timer_period);
        self.state.supervisor.follow_legs(&self.limits, legs);

        let weakening = if self.weakening_share.is_some() {
            let change = match decision.reach {
                Reach::Inside => -fall,
                Reach::Outside | Reach::PastReach => rise,
            };
            (self.state.weakening + change).clamp(0.0, MOST_TURN)
        } else {
            0.0
        };

        // 12 remember
        self.state.i_prev = [i_a, i_b];
        self.state.sector_prev = sector;
        self.state.sector_eff_prev = sector_eff;
        let u = decision.u;
        if run {
            self.state.v_prev = to_ab(&match (delayed, self.variant.floating) {
                (true, _) => v_now,
                (false, false) => u,
                (false, true) => self.applied(&command.terminal, command.off, &i_abc, &e),
            });
            self.state.off_prev = if delayed {
                self.state.off_cmd
            } else {
                command.off
            };
            self.follow_bus_current(&i_abc, command.duties);
            let [v_a, v_b] = self.state.v_prev;
            self.state.net_prev = to_ab(&if delayed { net } else { from_ab(v_a, v_b) - e });
            self.state.net_next = to_ab(&(u - e));
            self.state.v_cmd = to_ab(&u);
            self.state.t_cmd = command.terminal.into();
            self.state.off_cmd = command.off;
            self.state.e_prev = to_ab(&e_now);
            self.state.e_next = to_ab(&e);
            self.state.emf_error = emf_error;
            self.state.weakening = weakening;
            self.state.residual_count = residual_count;
            self.state.torque.light = light;
            self.state.speed_integral = speed_integral;
            self.state.speed_in_force = speed_in_force;
            let known = self.state.timing.ramp_known();
            self.state.ramp_begun = self.state.ramp_begun.max(known);
            self.state.current_in_force = current_in_force;
            self.state.integral = decision.integral;
            if self.variant.turns_reference() {
                self.state.j_due = to_ab(&(if delayed { i_next } else { i_ref } / self.phase.b));
                self.state.j_next = to_ab(&(i_ref / self.phase.b));
            }
            self.state.rises = decision.rises;
            self.state.vector_prev = decision.vector;
            self.state.past = decision.past;
        } else {
            self.state.v_prev = [0.0; 2];
            self.state.v_cmd = [0.0; 2];
            self.state.t_cmd = [0.0; 3];
            self.state.off_cmd = None;
            self.state.off_prev = None;
            self.state.e_prev = [0.0; 2];
            self.state.e_next = [0.0; 2];
            self.state.net_prev = [0.0; 2];
            self.state.net_next = [0.0; 2];
            self.state.emf_error = [0.0; 2];
            self.state.weakening = 0.0;
            self.state.residual_count = 0.0;
            self.state.torque.light = 0.0;
            self.state.integral = [0.0; 2];
            self.state.j_next = [0.0; 2];
            self.state.j_due = [0.0; 2];
            self.state.speed_integral = 0.0;
            self.state.speed_in_force = 0.0;
            self.state.ramp_begun = 0.0;
            self.state.current_in_force = 0.0;
            self.state.current_withheld = 0.0;
            self.state.line_cmd = [0.0; 2];
            self.state.line_ended = [0.0; 2];
            self.state.bus_current = 0.0;
            self.state.rises = [None; 2];
            self.state.vector_prev = 0;
            self.state.past = Past::default();
            self.state.commutation_left = 0.0;
        }
        self.trace = Trace {
            i: [i_a, i_b],
            e: to_ab(&e),
            net: to_ab(&net),
            u_unsat: to_ab(&decision.u_unsat),
            u: to_ab(&u),
            theta,
            step_angle,
            sector_eff,
            commutating: run && commutating,
            reach: decision.reach,
            vector: if run { decision.vector } else { 0 },
            run,
        };
        command.duties
    }

    /// Least and greatest current, by the fades and the bus current.
    fn allowed(&self, direction: f64) -> [f64; 2] {
        let share = |fade: Option<[f64; 2]>| {
            fade.map_or(f64::INFINITY, |[full, none]| {
                let share = (self.v_bus - none) / (full - none);
                self.max_current * share.clamp(0.0, 1.0)
            })
        };
        let [braking, motoring] = self.fades.map(share);
        let backward = if direction == 1.0 { braking } else { motoring };
        let forward = if direction == -1.0 { braking } else { motoring };
        let left = self.max_current - self.state.current_withheld;
        if self.bus_currents == [None; 2] {
            [-backward, forward]
        } else {
            [-backward.min(left), forward.min(left)]
        }
    }

    /// The command of a drive at rest.
    fn at_rest(&self, duties: Duties) -> Duties {
        Duties {
            later: self.variant.has_intervals().then_some([duties.state; 2]),
            ..duties
        }
    }

    /// Takes the set-point back by what the bus current exceeds a limit by (section "Bus current").
    fn follow_bus_current(&mut self, i: &Vector3<f64>, command: Duties) {
        if self.bus_currents == [None; 2] {
            return;
        }
        let state = &mut self.state;
        let duty = [0, 1, 2].map(|x| match command.state[x] {
            LegState::Off if i[x] < 0.0 => 1.0,
            LegState::Off => 0.0,
            _ => command.duty[x],
        });
        let line = [0, 1].map(|x| duty[x] - duty[2]);
        let begins = if self.variant.delayed() {
            state.line_cmd
        } else {
            line
        };
        let paid: f64 = (0..2)
            .map(|x| f64::midpoint(state.line_ended[x], begins[x]) * i[x])
            .sum();
        let pulsed = (0..3).filter(|&x| command.state[x] == LegState::Pulsed);
        let lost = self.dead_share * pulsed.map(|x| i[x].abs()).sum::<f64>();
        state.bus_current += (paid - lost - state.bus_current) / 16.0;
        let [drawn, returned] = self.bus_currents;
        let drawn = drawn.map_or(f64::INFINITY, |most| most - state.bus_current);
        let returned = returned.map_or(f64::INFINITY, |most| most + state.bus_current);
        let withheld = state.current_withheld - drawn.min(returned) / 32.0;
        state.current_withheld = withheld.clamp(0.0, self.max_current);
        state.line_ended = begins;
        state.line_cmd = line;
    }

    /// Electrical angle per tick, radians; 0 while unknown.
    fn electrical_speed(&self) -> f64 {
        let timing = &self.state.timing;
        if self.sensor.is_some() {
            timing.step.abs() * RADIANS
        } else if timing.edges >= 2 {
            TAU / timing.rev.max(self.clock.rev_min)
        } else {
            0.0
        }
    }

    /// Speed of this sector over the mean of the last turn.
    fn ahead(&self) -> f64 {
        if !self.clock.tells_rise {
            return 1.0;
        }
        let timing = &self.state.timing;
        let most = GREATEST_CHANGE * timing.rev;
        let change = timing.shortened().clamp(-most, most);
        1.0 + RISE * change / timing.rev.max(self.clock.rev_min)
    }

    /// Learns from an edge where the sensors stand; `tells`: behind a whole turn of steady
    /// speed.
    fn learn_edges(&mut self, event: &HallEvent, tells: bool, i: [f64; 2]) {
        let omega = self.electrical_speed();
        let across = self.state.emf_error[1];
        let least = self.across_at_small_angle * self.state.step_angle.abs() / self.t_s;
        let [i_a, i_b] = i;
        let mut currents = [i_a, i_b, i_a + i_b].into_iter();
        let is_light = currents.all(|i| i.abs() <= SMALL_CURRENT * self.max_current);
        let tells_angle = is_light && across.abs() > least;
        let turned = tells.then(|| {
            let turned = omega * self.state.timing.intervals[0];
            (turned, tells_angle.then_some(across))
        });
        let width = self.sector(event.sector)[1];
        let (learnt, sector_prev) = (self.state.learnt, self.state.sector_prev);
        self.state.learnt = learnt.at_edge(event, sector_prev, turned, width);
    }

    /// Where a sector begins beyond its place, and its width, with all sensors in their places.
    fn sector(&self, sector: usize) -> [f64; 2] {
        match sector {
            0 => [0.0, FRAC_PI_3],
            _ => self.sectors[sector - 1],
        }
    }

    /// The same of a sensor's angle, as a word.
    fn sensed(&self, theta: f64, sector: usize) -> (f64, f64, usize) {
        let (theta, step_angle) = (theta * RADIANS, self.state.timing.step * RADIANS);
        let sector_eff = if self.variant.options.advance > 0.0 && self.state.timing.edges >= 2 {
            let ahead = theta + self.variant.options.advance * step_angle + FRAC_PI_6;
            (ahead / FRAC_PI_3).floor().rem_euclid(6.0) as usize + 1
        } else {
            sector
        };
        (theta, step_angle, sector_eff)
    }

    /// Angle at the sample and angle per period (radians), and the sector with its advance.
    fn angle(&self, sector: usize) -> (f64, f64, usize) {
        let timing = &self.state.timing;
        let omega = self.electrical_speed();
        // Where the sector begins beyond its place, and where it ends, from where it begins.
        let [mut beyond, mut width] = self.sector(sector);
        if self.learns_halls && timing.edges >= 2 {
            beyond += self.state.learnt.begin;
            width = self.state.learnt.width;
        }
        let end = width * (1.0 - 1e-9);
        let ahead = self.ahead();
        let progress = ((omega * timing.age_prev).min(end) * ahead).min(end);
        let turn = (omega * self.clock.period).min(FRAC_PI_6) * ahead;
        let step_angle = timing.direction * turn.min(FRAC_PI_6);
        let in_sector = if timing.edges < 2 {
            width / 2.0
        } else if timing.direction > 0.0 {
            progress
        } else {
            end - progress
        };
        let in_sector = beyond + in_sector;
        let theta = sector as f64 * FRAC_PI_3 - FRAC_PI_3 - FRAC_PI_6 + in_sector;
        let advance = self.variant.options.advance;
        let sector_eff = if advance > 0.0 && timing.edges >= 2 && sector != 0 {
            let ahead = ((in_sector + advance * step_angle) / FRAC_PI_3).floor() as i64;
            (sector as i64 - 1 + ahead).rem_euclid(6) as usize + 1
        } else {
            sector
        };
        (theta, step_angle, sector_eff)
    }

    /// Tracks the commutation (section 5); returns whether it continues.
    fn commutate(&mut self, sector_eff: usize, current: f64, i: &Vector3<f64>) -> bool {
        let state = &mut self.state;
        let changed = sector_eff != state.sector_eff_prev && state.sector_eff_prev != 0;
        let torque = if current < 0.0 { -1.0 } else { 1.0 };
        let sign = sector::OUT_SIGN[sector_eff] * torque * state.timing.direction;
        let flows = sign * i[sector::OUT_PHASE[sector_eff]] > self.end.threshold;
        let kept = if changed {
            f64::from(self.end.timeout) + 1.0
        } else {
            state.commutation_left
        };
        let goes_on = kept > 0.0 && (changed || flows);
        state.commutation_left = if goes_on { kept - 1.0 } else { 0.0 };
        goes_on
    }

    /// Voltage that a command applies at the currents `i` (section 7).
    fn applied(
        &self,
        terminal: &Vector3<f64>,
        off: Option<usize>,
        i: &Vector3<f64>,
        e: &Vector2<f64>,
    ) -> Vector2<f64> {
        let mut terminal = *terminal;
        if let Some(off) = off {
            let driven = terminal.sum() - terminal[off];
            let threshold = self.end.threshold;
            terminal[off] = if i[off] > threshold {
                0.0
            } else if i[off] < -threshold {
                self.v_bus
            } else {
                // e_o + v_n, v_n the mean of v - e over the two driven legs, e summing to zero.
                (driven / 2.0 + 1.5 * phases(e)[off]).clamp(0.0, self.v_bus)
            };
        }
        clarke(&terminal)
    }

    /// Like [`Self::step`], rounded to timer counts.
    pub fn step_rounded(&mut self, sample: &Sample) -> AnyCommand {
        self.step(sample).to_command(self.timer_period)
    }
}
