//! A drive: controller, supervisor and set-point, whole or split into two halves.

use crate::arith::{Word, mul_round};
use crate::bus::Bus;
use crate::set_point::debug;
use crate::trip::Trip;
use crate::{
    Checked, Command, Control, Fault, Legs, Observation, Sample, SetPoint, State, Status,
    Supervisor, Unfit,
};
use core::fmt;
use core::hint::black_box;
use core::ops::Deref;
use fixed::types::I16F16;

/// A drive with the controller `C`, emitted by `hexagen::controller!`.
///
/// Firmware keeps it in a static and splits it: the main program gets the [`SetPoint`], the control
/// interrupt the [`ControlLoop`]. An unsplit drive has the calls of both.
///
/// ```
/// use hexagen::{Control, ControlLoop, Drive, SetPoint};
/// use static_cell::StaticCell;
///
/// fn hand_over<C: Control>(
///     place: &'static StaticCell<Drive<C>>,
/// ) -> (&'static SetPoint<C>, ControlLoop<'static, C>) {
///     place.init(Drive::new()).split()
/// }
/// ```
///
/// A new drive controls currents at set-point 0 with nominal current offsets, behind a start in which
/// it finds the angle of a turning rotor, where it needs that ([`Mode::Start`](crate::Mode::Start)).
/// Where offsets or the bootstrap capacitors of the inverter need it, call
/// [`calibrate`](Self::calibrate) before the first period.
pub struct Drive<C: Control> {
    set_point: SetPoint<C>,
    core: Core<C>,
}

/// The control interrupt's part.
struct Core<C: Control> {
    supervisor: Supervisor,
    law: C::State,
}

impl<C: Control> Drive<C> {
    /// A drive in its initial state.
    #[must_use]
    pub const fn new() -> Self {
        const {
            assert!(
                C::LIMITS.hold(&C::SENSORS),
                "limits of a controller contradict each other"
            );
        };
        Self {
            set_point: SetPoint::new(),
            core: Core {
                supervisor: Supervisor::new(&C::LIMITS, &C::SENSORS),
                law: C::State::INITIAL,
            },
        }
    }

    /// The two halves: the set-point for the main program, the control loop for an interrupt.
    pub const fn split(&mut self) -> (&SetPoint<C>, ControlLoop<'_, C>) {
        let set_point = &self.set_point;
        let core = &mut self.core;
        (set_point, ControlLoop { set_point, core })
    }

    /// The set-point of an unsplit drive.
    #[must_use]
    pub const fn set_point(&self) -> &SetPoint<C> {
        &self.set_point
    }

    /// The control loop of an unsplit drive.
    pub const fn control(&mut self) -> ControlLoop<'_, C> {
        self.split().1
    }

    /// Runs one control period; see [`ControlLoop::step`].
    #[inline]
    pub fn step(&mut self, sample: &Sample) -> C::Command {
        self.control().step(sample)
    }

    /// See [`ControlLoop::reset`].
    pub fn reset(&mut self) {
        self.control().reset();
    }

    /// See [`ControlLoop::calibrate`].
    pub fn calibrate(&mut self) {
        self.control().calibrate();
    }

    /// See [`ControlLoop::precharge`].
    pub fn precharge(&mut self) {
        self.control().precharge();
    }

    /// See [`ControlLoop::coast`].
    pub fn coast(&mut self) {
        self.control().coast();
    }

    /// See [`ControlLoop::brake`].
    pub fn brake(&mut self) {
        self.control().brake();
    }

    /// See [`ControlLoop::resume`].
    pub fn resume(&mut self) {
        self.control().resume();
    }

    /// Sets the speed, bits of an `I16F16` in rpm; no effect without a speed loop. For verification
    /// of any drive; firmware uses [`SetPoint::set_speed`].
    #[doc(hidden)]
    pub fn set_speed_bits(&self, bits: i32) {
        if let Some(speed) = C::SPEED {
            self.set_point.words.speed.store(speed(Word(bits)));
        }
    }

    /// Sets the bus voltage as an ADC count; no effect with a fixed bus. For verification of any
    /// drive; firmware uses [`SetPoint::set_bus`].
    #[doc(hidden)]
    pub fn set_bus_counts(&self, counts: u16) {
        if let Some(words) = C::TOLD_BUS {
            let fault = C::LIMITS.bus_fault(counts);
            self.set_point.words.bus.tell(words(counts.into()), fault);
        }
    }

    /// Names of the state words: the supervisor's, then the law's. For verification.
    pub fn state_names() -> impl Iterator<Item = &'static str> {
        let supervisor = Supervisor::NAMES.iter().copied();
        supervisor.chain(C::State::NAMES.iter().copied())
    }

    /// Copies the state words to the front of `words`, as many as fit. For verification.
    #[inline]
    pub fn state_words(&self, words: &mut [i32]) {
        let Some((supervisor, law)) = words.split_first_chunk_mut() else {
            return;
        };
        *supervisor = self.core.supervisor.words();
        self.core.law.words(law);
    }

    /// Overwrites the state words with values inside their ranges; missing ones are kept. For
    /// verification.
    pub fn set_state_words(&mut self, words: &[i32]) {
        let Some((supervisor, law)) = words.split_first_chunk() else {
            return;
        };
        self.core.supervisor.set_words(*supervisor);
        for (index, word) in law.iter().enumerate() {
            self.core.law.set_word(index, *word);
        }
        publish_torque(&self.set_point, &self.core.law);
        self.control().publish();
    }
}

/// The calls of the set-point.
impl<C: Control> Deref for Drive<C> {
    type Target = SetPoint<C>;

    fn deref(&self) -> &SetPoint<C> {
        &self.set_point
    }
}

impl<C: Control> Default for Drive<C> {
    fn default() -> Self {
        Self::new()
    }
}

impl<C: Control> fmt::Debug for Drive<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        debug::<C>("Drive", self.status(), f)
    }
}

/// The control interrupt's half of a drive.
pub struct ControlLoop<'drive, C: Control> {
    set_point: &'drive SetPoint<C>,
    core: &'drive mut Core<C>,
}

impl<C: Control> ControlLoop<'_, C> {
    /// Runs one control period: takes the measurements of its beginning, returns the inverter's
    /// command.
    ///
    /// With `delay: 1` the command takes effect in the next period; with `delay: 0` at once.
    #[inline]
    pub fn step(&mut self, sample: &Sample) -> C::Command {
        let Self { set_point, core } = self;
        let fault = unsampled_fault(set_point, &core.law);
        let is_demanded = || set_point.is_demanded();
        let (limits, sensors) = (&C::LIMITS, &C::SENSORS);
        let resolved;
        let seen = match C::ANGLE {
            // No copy: a drive with Hall sensors pays nothing for the others.
            None => sample,
            Some(sensor) => {
                resolved = sensor.resolve(sample);
                &resolved
            }
        };
        let checked = core.supervisor.check(limits, sensors, seen, is_demanded);
        let checked = if let (Some(checked), None) = (checked, fault) {
            C::ANGLE.map_or(checked, |_| checked.with_angle_of(seen))
        } else {
            let examined = examine(set_point, core, *sample, fault);
            match examined.unfit {
                Unfit::Control | Unfit::Against(_) => examined.checked,
                Unfit::Rest(fault) => return rest(set_point, core, &examined, fault),
            }
        };
        let rotor = C::track(&mut core.law, &checked);
        let (law, words) = (&mut core.law, &set_point.words);
        let mut observation = Observation::default();
        let command = C::step(law, words, &checked, rotor, &mut observation);
        if sensors.third.is_some() {
            core.supervisor.follow_command(sensors, command.on());
        }
        publish_torque(set_point, law);
        if set_point.signals.is_asked() {
            let on = command.on();
            set_point.signals.answer(checked, on, observation);
        }
        command
    }

    /// Clears a trip and all control state, and sets the set-point to 0; keeps calibrated offsets.
    /// Ignored while calibrating and pre-charging.
    ///
    /// A start follows, without calibration and pre-charge: if the bootstrap capacitors need it, call
    /// [`precharge`](Self::precharge) right behind this. Each call begins the start anew. With a speed
    /// loop the set-point is the speed, and speed 0 brakes a turning rotor with up to the current
    /// limit.
    pub fn reset(&mut self) {
        if self.core.supervisor.reset(&C::LIMITS, &C::SENSORS) {
            self.core.law = C::State::INITIAL;
            publish_torque(self.set_point, &self.core.law);
            self.set_point.trip.forget();
            self.set_point.clear();
        }
        self.publish();
    }

    /// Starts current-offset calibration: all legs off, the motor at rest. Pre-charge, if
    /// specified, a start and control with the present set-point follow by themselves. Ignored when
    /// tripped.
    pub fn calibrate(&mut self) {
        self.core.supervisor.calibrate(&C::LIMITS);
        self.publish();
    }

    /// Starts bootstrap pre-charge: all lower switches on, which short-circuits a turning motor; a
    /// start, in which all legs are off, and control follow by themselves. Accepted during control,
    /// too: call it only at rest. Ignored when tripped, calibrating, coasting and braking, and if the
    /// specification has no pre-charge.
    pub fn precharge(&mut self) {
        self.core.supervisor.precharge(&C::LIMITS);
        self.publish();
    }

    /// Turns all legs off on purpose, without a fault, until [`resume`](Self::resume) or a reset.
    /// Above the speed at which the EMF reaches the bus voltage the diodes still brake the motor into
    /// the bus. Ignored when tripped, calibrating and pre-charging.
    pub fn coast(&mut self) {
        self.core.supervisor.coast();
        self.publish();
    }

    /// Slows the rotor down until [`resume`](Self::resume) or a reset: all lower switches on where
    /// the motor takes no more than the specification's `max_current` that way; above that speed this
    /// current against the rotation, with a speed loop speed 0 within the current that is set, into
    /// the bus, once two Hall edges in one direction tell it. An `acceleration_limit` holds for this
    /// speed, too. In a start, once that is over. Ignored when tripped, calibrating and pre-charging.
    pub fn brake(&mut self) {
        self.core.supervisor.brake();
        self.publish();
    }

    /// Ends coasting and braking: control at set-point 0 follows, behind what is left of a start that
    /// they interrupted, with the rotor's angle and speed as they were followed meanwhile. Ignored if
    /// the drive does neither.
    pub fn resume(&mut self) {
        if self.core.supervisor.resume() {
            self.set_point.clear();
        }
        self.publish();
    }

    /// Mode and fault of the drive.
    #[must_use]
    pub fn status(&self) -> Status {
        Status::from_bits(
            self.core.supervisor.status_bits(),
            self.set_point.words.bus.is_stale(),
        )
    }

    /// How far the edges of the three Hall sensors stand from `hall_angles`, electrical degrees: those at which sectors 1
    /// and 4, 2 and 5, 3 and 6 begin. 0 before anything is learnt, behind a reset, and without `hall_learning: on`.
    #[must_use]
    pub fn hall_offsets(&self) -> [I16F16; 3] {
        let [first, second, all] =
            C::HALL_SHIFTS.map_or([Word(0); 3], |shifts| shifts(&self.core.law));
        let third = -(first + second);
        // The sensor between the others is taken to be in its place.
        let middle = first.min(second).max(first.max(second).min(third));
        [first, second, third].map(|own| {
            // 360 degrees of 16 fraction bits are 2^32.
            let degrees = mul_round(Word(360), own - middle + all, 16);
            I16F16::from_bits(degrees.0)
        })
    }

    fn publish(&self) {
        publish(self.set_point, self.core);
    }
}

/// Ages the bus voltage by a period, and returns the first fault that is not in the sample: one of the
/// bus voltage, of lost currents, or of the speed.
#[inline]
fn unsampled_fault<C: Control>(set_point: &SetPoint<C>, law: &C::State) -> Option<Fault> {
    let of_bus = set_point.words.bus.pass_period();
    let is_found = |watch: Option<fn(&C::State) -> bool>| watch.is_some_and(|found| found(law));
    if of_bus.is_some() {
        of_bus
    } else if is_found(C::HAS_LOST_CURRENTS) {
        Some(Fault::Residual)
    } else if is_found(C::IS_TOO_FAST) {
        Some(Fault::OverSpeed)
    } else {
        None
    }
}

/// A period that is not fit for control.
struct Examined {
    sample: Sample,
    checked: Checked,
    unfit: Unfit,
}

/// Asks the supervisor about a period that is not fit for control. The drive controls nevertheless to
/// brake a fast rotor, and where a disturbed Hall code is bridged.
#[cold]
#[inline(never)]
fn examine<C: Control>(
    set_point: &SetPoint<C>,
    core: &mut Core<C>,
    sample: Sample,
    fault: Option<Fault>,
) -> Examined {
    // Without effect but on cost: where the compiler sees that a copy of the sample is only read, it
    // stores the original one in memory instead, in every step. It does not see through this.
    black_box(&sample);
    let resolved;
    let seen = match C::ANGLE {
        None => &sample,
        Some(sensor) => {
            resolved = sensor.resolve(&sample);
            &resolved
        }
    };
    let (limits, sensors) = (&C::LIMITS, &C::SENSORS);
    let (checked, unfit) = core.supervisor.examine(limits, sensors, seen, fault);
    let checked = C::ANGLE.map_or(checked, |_| checked.with_angle_of(seen));
    match unfit {
        // A trip is kept before it is published.
        Unfit::Rest(_) => {}
        Unfit::Control => publish(set_point, core),
        Unfit::Against(direction) => {
            publish(set_point, core);
            set_point.oppose(direction);
        }
    }
    Examined {
        sample,
        checked,
        unfit,
    }
}

/// A period with all legs in one state: in start-up, with a fault or off on purpose. It is apart from
/// [`examine`], so that no way leads from here to control.
#[cold]
#[inline(never)]
fn rest<C: Control>(
    set_point: &SetPoint<C>,
    core: &mut Core<C>,
    examined: &Examined,
    fault: Option<Fault>,
) -> C::Command {
    let Examined {
        sample, checked, ..
    } = examined;
    let supervisor = &mut core.supervisor;
    let (state, tripped) = supervisor.rest(&C::LIMITS, &C::SENSORS, sample, fault);
    if let Some(fault) = tripped {
        keep(set_point, core, *sample, fault);
    }
    publish(set_point, core);
    let rotor = C::track(&mut core.law, checked);
    C::rest(&mut core.law, checked, rotor);
    publish_torque(set_point, &core.law);
    C::Command::at_rest(state)
}

/// Publishes the status for the set-point's half. A step that passes all checks does not change it.
fn publish<C: Control>(set_point: &SetPoint<C>, core: &Core<C>) {
    set_point.status.store(core.supervisor.status_bits().into());
}

/// Tells the set-point's half the learnt torque constant.
#[inline]
fn publish_torque<C: Control>(set_point: &SetPoint<C>, law: &C::State) {
    if let Some(ratio) = C::TORQUE_RATIO {
        set_point.torque_ratio.store(ratio(law));
    }
}

/// Keeps the period of a trip.
fn keep<C: Control>(set_point: &SetPoint<C>, core: &Core<C>, sample: Sample, fault: Fault) {
    let [current, speed] = set_point.demands();
    let trip = Trip {
        fault,
        sample,
        current: current.0,
        speed: speed.0,
        bus: set_point.words.bus.kept(),
    };
    set_point.trip.keep(&trip, &core.supervisor, &core.law);
}

impl<C: Control> fmt::Debug for ControlLoop<'_, C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        debug::<C>("ControlLoop", self.status(), f)
    }
}

/// The control loop of any drive, for firmware that selects one of several at run time.
pub trait DynLoop<Out: Command = Legs>: Send {
    /// See [`ControlLoop::step`].
    fn step(&mut self, sample: &Sample) -> Out;
    /// See [`ControlLoop::reset`].
    fn reset(&mut self);
    /// See [`ControlLoop::calibrate`].
    fn calibrate(&mut self);
    /// See [`ControlLoop::precharge`].
    fn precharge(&mut self);
    /// See [`ControlLoop::coast`].
    fn coast(&mut self);
    /// See [`ControlLoop::brake`].
    fn brake(&mut self);
    /// See [`ControlLoop::resume`].
    fn resume(&mut self);
    /// See [`ControlLoop::status`].
    fn status(&self) -> Status;
}

impl<C: Control> DynLoop<C::Command> for ControlLoop<'_, C> {
    fn step(&mut self, sample: &Sample) -> C::Command {
        self.step(sample)
    }

    fn reset(&mut self) {
        self.reset();
    }

    fn calibrate(&mut self) {
        self.calibrate();
    }

    fn precharge(&mut self) {
        self.precharge();
    }

    fn coast(&mut self) {
        self.coast();
    }

    fn brake(&mut self) {
        self.brake();
    }

    fn resume(&mut self) {
        self.resume();
    }

    fn status(&self) -> Status {
        self.status()
    }
}
