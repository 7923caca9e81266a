//! Model B: every bit of the emitted code, in f64 with an explicit quantiser at every rounding
//! point.
//!
//! All signals are words in f64 (see `crate::exact`); only table indices and small enums are
//! integers. Coefficients are rounded here, from the specification; only the format table is taken
//! from the generator. Section numbers are those of
//! `codegen/src/laws/semantics.md`.

mod applied;
mod bus_current;
mod constants;
mod emf;
mod fade;
mod hall_learning;
mod law;
mod limit;
mod motion;
mod parts;
mod physical;
mod ramp;
mod residual;
mod rise;
mod rotor;
mod scale;
mod sectors;
mod slew;
mod speed;
mod state;
mod tables;
mod torque_learning;
mod weakening;

use super::angle::AngleSensor;
use super::hall::HallClock;
use super::sector::{self, HallEvent};
use super::supervision::{BusWatch, Limits, Mode, Observation, Period, Stop, Units};
use super::trace::Reach;
use super::variant::{Variant, reference_gain};
use crate::exact::{
    Coefficient, Shift, Word, all_three, both, floor, floor_weighted, greater, input, lesser, pow2,
    within, word,
};
use crate::{AnyCommand, EmfSource, Error, FormatTable, Reference, Spec};
use bus_current::BusCurrent;
use constants::Constants;
use fade::Fade;
use hexagen::{Fault, LegState, Sample};
use law::{Command, Inputs, Law};
use parts::Part;
use ramp::Ramp;
use residual::ResidualWatch;
use scale::Scale;
use slew::Slew;
use speed::Regulator;
use state::State;
use torque_learning::TorqueLearning;
use weakening::FieldWeakening;

/// Fraction bits of the ratio of two sensors' gains.
const RATIO_BITS: i32 = 15;

/// The bit-true controller of one drive, over any words.
#[derive(Clone, Debug)]
pub struct BitTrue<W: Word = f64> {
    variant: Variant,
    hall_sectors: [usize; 8],
    clock: HallClock,
    /// In place of Hall sensors.
    angle: Option<AngleSensor>,
    limits: Limits,
    k: Constants<W>,
    law: Law<W>,
    speed: Option<Regulator<W>>,
    ramp: Option<Ramp>,
    slew: Option<Slew>,
    weakening: Option<FieldWeakening<W>>,
    fade: Option<Fade<W>>,
    bus_current: Option<BusCurrent<W>>,
    residual: Option<ResidualWatch<W>>,
    torque: Option<TorqueLearning<W>>,
    /// Volt per ampere of the set-point.
    gain: f64,
    // Set-point words.
    j: W,
    speed_ref: W,
    v_bus: W,
    ratio: W,
    /// `ratio`, split.
    to_duty: Coefficient<W>,
    bus_watch: Option<BusWatch>,
    state: State<W>,
    last: Signals<W>,
}

/// Path of a step, for coverage counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Course<W = f64> {
    /// Position of the deadbeat voltage.
    pub reach: Reach,
    /// A commutation is in progress (if tracked).
    pub commutating: bool,
    /// Angle per period, angle words (2^32 per turn), signed; 0 while the angle is not timed.
    pub step_angle: W,
}

/// Words of the last step, for [`BitTrue::trace`].
#[derive(Clone, Copy, Debug, Default)]
struct Signals<W> {
    i: [W; 2],
    e: [W; 2],
    net: [W; 2],
    u_unsat: [W; 2],
    u: [W; 2],
    theta: W,
    step_angle: W,
    sector_eff: usize,
    commutating: bool,
    reach: Reach,
    vector: usize,
    run: bool,
}

impl BitTrue {
    /// A controller in its initial state.
    ///
    /// # Errors
    /// If the specification is inconsistent, a format is missing, or a coefficient does not fit its
    /// format.
    pub fn new(spec: &Spec, formats: &FormatTable) -> Result<Self, Error> {
        Self::over_words(spec, formats)
    }
}

impl<W: Word> BitTrue<W> {
    /// Like [`BitTrue::new`], for words of another type than f64.
    ///
    /// # Errors
    /// As [`BitTrue::new`].
    pub fn over_words(spec: &Spec, formats: &FormatTable) -> Result<Self, Error> {
        let scale = Scale::new(spec, formats)?;
        let k = Constants::new(spec, &scale)?;
        let speed = Regulator::new(spec, &scale, &k)?;
        let mut model = Self {
            variant: scale.variant,
            hall_sectors: sector::hall_sectors(&spec.motor),
            clock: HallClock::new(spec),
            angle: AngleSensor::new(spec),
            limits: Limits::new(
                spec,
                Units {
                    i_trip: k.i_trip,
                    count: k.count,
                    ampere: k.count / spec.inverter.adc_gain.first().abs(),
                    ratio_bits: Some(RATIO_BITS),
                },
            )?,
            j: speed.as_ref().map_or(word(0.0), |speed| speed.top),
            speed_ref: word(0.0),
            speed,
            ramp: Ramp::new(spec, &scale)?,
            slew: Slew::new(spec, &scale, &k)?,
            weakening: FieldWeakening::new(spec, &scale, &k)?,
            fade: Fade::new(spec, &scale)?,
            bus_current: BusCurrent::new(spec, &scale, &k)?,
            residual: ResidualWatch::new(spec, &scale)?,
            torque: TorqueLearning::new(spec, &scale)?,
            v_bus: word(k.v_bus_nominal),
            gain: reference_gain(spec),
            ratio: word(pow2(k.ratio_bits as i32)),
            to_duty: Coefficient::new(pow2(k.ratio_bits as i32), k.ratio_bits),
            bus_watch: BusWatch::new(&spec.inverter),
            state: State::default(),
            last: Signals::default(),
            law: Law::new(spec, &scale)?,
            k,
        };
        model.state.offset = model
            .limits
            .adc_offset
            .map(|offset| word(offset * model.k.count));
        model.state.supervisor.start(&model.limits);
        Ok(model)
    }

    /// Sets the current set-point from the bits of an `I16F16` in ampere.
    pub fn set_current(&mut self, bits: i32) {
        self.j = self
            .k
            .k_set
            .mul(within(input(bits), -self.k.i_max_bits, self.k.i_max_bits));
    }

    /// Sets the torque set-point from the bits of an `I16F16` in newton metres.
    pub fn set_torque(&mut self, bits: i32) {
        let mut bits = input(bits);
        if self.torque.is_some() {
            bits = self.state.torque.scaled(bits);
        }
        self.j = self
            .k
            .k_torque
            .mul(within(bits, -self.k.t_max_bits, self.k.t_max_bits));
    }

    /// Sets the speed from the bits of an `I16F16` in rpm. No effect without a speed loop.
    pub fn set_speed(&mut self, bits: i32) {
        if let Some(speed) = &self.speed {
            self.speed_ref = speed.reference(bits);
        }
    }

    /// Sets the bus voltage as an ADC count. No effect if the bus is not measured.
    pub fn set_bus(&mut self, counts: u16) {
        if let Some(bus) = &self.k.bus {
            let measured = bus.k_bus.mul(lesser(input(counts), bus.count_max));
            self.v_bus = within(measured, bus.v_min, bus.v_max);
            let nominal: W = word(self.k.v_bus_nominal);
            let most = word(f64::from(i32::MAX));
            self.ratio = nominal.divide(self.k.ratio_bits, self.v_bus, most);
            self.to_duty = Coefficient::new(self.ratio, self.k.ratio_bits);
        }
        if let Some(watch) = &mut self.bus_watch {
            watch.tell(counts);
        }
    }

    /// The set-point words `j`, `v_bus`, `ratio`, `speed_ref`.
    pub fn set_point_words(&self) -> [W; 4] {
        [self.j, self.v_bus, self.ratio, self.speed_ref]
    }

    /// Clears a trip and all control state, and sets the set-point to 0 (the speed with a speed
    /// loop, else the current); keeps the offsets. Ignored during calibration and pre-charge.
    pub fn reset(&mut self) {
        if self.state.supervisor.may_reset() {
            self.clear();
            let unread = self.state.supervisor.unread;
            self.state = State {
                offset: self.state.offset,
                ..State::default()
            };
            self.state.supervisor.unread = unread;
            self.state.supervisor.start(&self.limits);
        }
    }

    /// Sets the set-point to 0.
    fn clear(&mut self) {
        match self.speed {
            Some(_) => self.speed_ref = word(0.0),
            None => self.j = word(0.0),
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

    /// Fault of the drive.
    pub fn fault(&self) -> Option<Fault> {
        self.state.supervisor.fault
    }

    /// Mode of the drive.
    pub fn mode(&self) -> Mode {
        self.state.supervisor.mode
    }

    /// Whether the last step controlled the currents.
    #[inline]
    pub fn is_in_control(&self) -> bool {
        self.last.run
    }

    /// Whether the bus voltage is measured.
    #[inline]
    pub fn has_measured_bus(&self) -> bool {
        self.bus_watch.is_some()
    }

    /// Whether a measured bus voltage is stale.
    #[inline]
    pub fn bus_is_stale(&self) -> bool {
        self.bus_watch.is_some_and(|watch| watch.is_stale())
    }

    /// Path of the last step.
    #[inline]
    pub fn course(&self) -> Course<W> {
        Course {
            reach: self.last.reach,
            commutating: self.last.commutating,
            step_angle: self.last.step_angle,
        }
    }

    /// Names of the state words, in the order of [`Self::state_words`].
    pub fn state_names(&self) -> Vec<&'static str> {
        state::names(self.k.parts)
    }

    /// Copies the state words to `words`, which holds as many as there are names.
    #[inline]
    pub fn state_words(&self, words: &mut [i32]) {
        self.state.write(self.k.parts, words);
    }

    /// Overwrites the state with words of [`Self::state_words`].
    pub fn set_state_words(&mut self, words: &[i32]) {
        let any = |&word: &i32| (word, (i32::MIN, i32::MAX));
        self.state.read(self.k.parts, words.iter().map(any));
    }

    /// Like [`Self::set_state_words`], with each word standing for any from its range's minimum to
    /// its maximum.
    pub fn set_state_within(&mut self, words: &[i32], ranges: &[(i32, i32)]) {
        let words = words.iter().copied().zip(ranges.iter().copied());
        self.state.read(self.k.parts, words);
    }

    /// Whether its commands have intervals.
    pub fn has_intervals(&self) -> bool {
        self.variant.has_intervals()
    }

    /// One control period: reads the sample, returns the command for the inverter.
    #[inline]
    pub fn step(&mut self, sample: &Sample) -> AnyCommand {
        let residual = self.residual.as_ref();
        let known = if let Some(fault) = self.bus_watch.as_mut().and_then(BusWatch::age) {
            Some(fault)
        } else if residual.is_some_and(|watch| watch.is_over(self.state.residual_count)) {
            Some(Fault::Residual)
        } else {
            (self.state.timing.is_too_fast()).then_some(Fault::OverSpeed)
        };
        let k = &self.k;
        // 1 measure
        let limits = &self.limits;
        let adc: [W; 3] = limits.sensed.of_sensors(sample.adc()).map(input);
        let shown = all_three(|x: usize| {
            let counts = lesser(adc[x], limits.adc_max) * k.count - self.state.offset[x];
            let current = counts * limits.polarity[x];
            if limits.ratio[x] == 1.0 {
                return current;
            }
            let ratio = word(limits.ratio[x] * pow2(RATIO_BITS));
            Shift::new(RATIO_BITS as u32).round_product(ratio, current)
        });
        let measured = limits.phases(shown, self.state.supervisor.unread(limits));
        let i = limits.for_law(measured);
        let i_c = -(i[0] + i[1]);

        // 2 hall, 3 supervise
        let hall = (self.angle).map_or_else(|| sample.hall(), |sensor| sensor.code(sample));
        let hall = self.state.supervisor.take_hall(&self.limits, hall);
        let event = HallEvent::new(&self.hall_sectors, hall.code(), self.state.sector_prev);
        let direction_before = self.state.timing.direction;
        self.state.timing.turn_direction(&event);
        let seen = Observation {
            known,
            adc,
            i: measured,
            sum: shown[0] + shown[1] + shown[2],
            hall,
            demand: match self.speed {
                Some(_) => self.speed_ref != 0.0,
                None => self.j != 0.0,
            },
        };
        let verdict = self.state.supervisor.step(&self.limits, &seen);
        if verdict.calibrated {
            self.state.offset = self
                .state
                .supervisor
                .sum
                .map(|sum| floor(sum * k.calibration));
        }
        let run = verdict.period == Period::Control;
        if let Some(direction) = verdict.against {
            match self.speed {
                Some(_) => self.speed_ref = word(0.0),
                None => self.set_current((-direction * f64::from(i32::MAX)) as i32),
            }
        }
        let k = &self.k;

        // 4 rotor
        let sector = event.sector;
        let mut angle = rotor::Angle {
            sector_eff: sector,
            ..rotor::Angle::default()
        };
        if let (true, Some(sensor)) = (self.variant.rotor, &self.angle) {
            let theta = sensor.theta(sample);
            let timing = &mut self.state.timing;
            sensor.follow(timing, theta, |turn| floor_weighted(turn, sensor.share));
            angle = rotor::sensed(k, timing, theta, sector);
        } else if self.variant.rotor {
            let ticks = input(sample.ticks());
            let timing = &mut self.state.timing;
            let tells = timing.step(&self.clock, &event, direction_before, ticks);
            angle = rotor::angle(&self.clock, k, &self.state, (&event, tells), i);
            self.state.speed = angle.speed;
            self.state.learnt = angle.learnt;
        }
        let sector_eff = angle.sector_eff;
        if let Some(learning) = &self.torque {
            self.state.torque.ratio = learning.learn(&self.state, angle.speed.step);
        }

        // Slew rate, speed loop
        let (mut j, mut j_in_force) = (self.j, self.state.j_in_force);
        if let Some(slew) = &self.slew {
            (j, j_in_force) = slew.follow(j, j_in_force);
        }
        let direction = self.state.timing.direction;
        let fade = self.fade.as_ref();
        let allowed = fade.map_or([None; 2], |fade| fade.allowed(self.v_bus, direction));
        let allowed = match &self.bus_current {
            Some(limit) => limit.allowed(allowed, &self.state),
            None => allowed,
        };
        let mut speed_integral = self.state.speed_integral;
        let mut speed_in_force = self.state.speed_in_force;
        if let Some(speed) = &self.speed {
            let turning = direction * angle.speed.omega;
            let mut wanted = self.speed_ref;
            if let Some(ramp) = &self.ramp {
                (wanted, speed_in_force) = ramp.follow(wanted, turning, &self.state);
            }
            (j, speed_integral) = speed.regulate((wanted, turning), j, allowed, speed_integral);
        } else {
            j = fade::limited(allowed, j);
        }

        // 5 commutation
        let i_abc = [i[0], i[1], i_c];
        let commutating =
            self.variant.commutation.is_some() && self.state.commutate(k, sector_eff, j, &i_abc);

        // 6 reference
        let delayed = self.variant.delayed();
        let theta_ref = angle.theta + angle.speed.step * if delayed { 2.0 } else { 1.0 };
        let shape = if self.variant.shaped() {
            k.shape.both(theta_ref)
        } else {
            [word(0.0); 2]
        };
        let j_ref = match self.variant.options.reference {
            Reference::QuasiSquare => [
                j * sector::CORNER_A[sector_eff],
                j * sector::CORNER_B[sector_eff],
            ],
            Reference::Proportional => shape.map(|shape| k.shape_product.floor_product(shape, j)),
        };
        let mut weakening = self.state.weakening;
        let (j_ref, changes) = match &self.weakening {
            Some(field) => field.reference(k, [theta_ref, weakening], shape, j, j_ref),
            None => (j_ref, [word(0.0); 2]),
        };

        // 8 EMF
        let mut emf_error = self.state.emf_error;
        let mut residual_count = self.state.residual_count;
        let mut light = self.state.torque.light;
        let (e, e_now) = match self.variant.emf {
            None | Some(EmfSource::Held) => ([word(0.0); 2], [word(0.0); 2]),
            Some(EmfSource::Estimated) => {
                let seen = emf::estimate(k, &self.state, i);
                let e = if self.variant.unseen() {
                    emf::with_floated(k, &self.state, sector_eff, seen)
                } else {
                    seen
                };
                motion::ahead(k, delayed, sector, e)
            }
            Some(source @ (EmfSource::Model | EmfSource::Observer)) => {
                let now = k.flux.both(angle.theta);
                let start = if delayed {
                    k.flux.both(angle.theta + angle.speed.step)
                } else {
                    now
                };
                let end = k.flux.both(theta_ref);
                let mean = |from: [W; 2], to: [W; 2]| {
                    both(|x| {
                        within(
                            floor_weighted(to[x] - from[x], k.flux_to_voltage),
                            -k.e_max,
                            k.e_max - 1.0,
                        )
                    })
                };
                if source == EmfSource::Model {
                    (mean(start, end), mean(now, start))
                } else {
                    let residual = emf::residual(k, &self.state, i);
                    emf_error = emf::corrected_error(k, &self.state, residual, shape);
                    if let Some(watch) = &self.residual {
                        let demand = (j, angle.speed.step);
                        residual_count = watch.count(&self.state, residual, emf_error, demand);
                    }
                    if let Some(learning) = &self.torque {
                        let told = [j, emf_error[0]];
                        let v_bus = (!self.bus_is_stale()).then_some(self.v_bus);
                        light = learning.count(light, told, v_bus, angle.speed.step);
                    }
                    let e = emf::corrected(k, mean(start, end), emf_error, (theta_ref, shape));
                    (e, if delayed { self.state.e_next } else { e })
                }
            }
        };

        // 7 applied voltage
        let v_now = match (self.variant.applied_now, self.variant.floating) {
            (false, _) => [word(0.0); 2],
            (true, false) => self.state.v_cmd,
            (true, true) => {
                let State { t_cmd, off_cmd, .. } = &self.state;
                applied::voltage(k, self.v_bus, t_cmd, *off_cmd, &[i[0], i[1], i_c], e_now)
            }
        };

        let net = if !self.variant.applied_now {
            [word(0.0); 2]
        } else if self.variant.observes() && !self.variant.floating {
            self.state.net_next
        } else {
            both(|x| v_now[x] - e_now[x])
        };

        // 9 to 11, specific to the controller
        let decision = self.law.decide(&Inputs {
            k,
            v_bus: self.v_bus,
            to_duty: &self.to_duty,
            j: j_ref,
            i,
            net,
            e,
            sector_eff,
            commutating,
            integral: self.state.integral,
            j_begin: if delayed {
                self.state.j_next
            } else {
                self.state.j_due
            },
            j_due: self.state.j_due,
            set_point: j,
            direction: self.state.timing.direction,
            hysteresis: self.state.hysteresis,
            vector_prev: self.state.vector_prev.0,
            past: self.state.past,
        });
        if let Some(field) = &self.weakening {
            weakening = field.follow(weakening, changes, decision.reach != Reach::Inside);
        }
        let has_intervals = self.has_intervals();
        let command = match verdict.period {
            Period::Control => decision.command,
            Period::Low => Command::idle(AnyCommand::all(LegState::Low, has_intervals)),
            Period::Off => Command::idle(AnyCommand::all(LegState::Off, has_intervals)),
        };
        self.state
            .supervisor
            .follow_legs(&self.limits, command.legs);

        // 12 remember
        if run {
            self.state.v_prev = match (delayed, self.variant.floating) {
                (true, _) => v_now,
                (false, false) => decision.u,
                (false, true) => applied::voltage(
                    &self.k,
                    self.v_bus,
                    &command.terminal,
                    command.off,
                    &[i[0], i[1], i_c],
                    e,
                ),
            };
            self.state.off_prev = if delayed {
                self.state.off_cmd
            } else {
                command.off
            };
            if let Some(limit) = &self.bus_current {
                limit.follow(&self.k, &mut self.state, i_abc, command.legs);
            }
            self.state.net_prev = if delayed {
                net
            } else {
                both(|x| self.state.v_prev[x] - e[x])
            };
            self.state.net_next = both(|x| decision.u[x] - e[x]);
            self.state.v_cmd = decision.u;
            self.state.t_cmd = command.terminal;
            self.state.off_cmd = command.off;
            self.state.e_prev = e_now;
            self.state.e_next = e;
            self.state.emf_error = emf_error;
            self.state.weakening = weakening;
            self.state.residual_count = residual_count;
            self.state.torque.light = light;
            self.state.speed_integral = speed_integral;
            self.state.speed_in_force = speed_in_force;
            self.state.ramp_begun = greater(self.state.ramp_begun, self.state.timing.ramp_known());
            self.state.j_in_force = j_in_force;
            self.state.integral = decision.integral;
            if self.variant.turns_reference() {
                self.state.j_due = if delayed { self.state.j_next } else { j_ref };
                self.state.j_next = j_ref;
            }
            self.state.hysteresis = decision.hysteresis;
            self.state.vector_prev = state::Vector(decision.vector);
            self.state.past = decision.past;
        } else {
            self.state.stop();
        }
        self.state.i_prev = i;
        if k.parts.has(Part::Edges) {
            self.state.sector_prev = sector;
        }
        self.state.sector_eff_prev = sector_eff;
        self.last = Signals {
            i,
            e,
            net,
            u_unsat: decision.u_unsat,
            u: decision.u,
            theta: angle.theta,
            step_angle: angle.speed.step,
            sector_eff,
            commutating: run && commutating,
            reach: decision.reach,
            vector: if run { decision.vector } else { 0 },
            run,
        };
        command.legs
    }
}
