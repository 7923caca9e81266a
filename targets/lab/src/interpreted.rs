//! The generator's interpreter as a drive.

use crate::{Inputs, angle, limits, sensors};
use hexagen::arith::{Word, scaled_torque};
use hexagen::{
    AngleSensor, Checked, Command, Fault, Intervals, LegState, Legs, Limits, Sample, Sensors,
    Supervisor, Unfit,
};
use hexagen_codegen::interface::{Interface, Watch};
use hexagen_codegen::ir::{Demand, Escape, Machine, Output, Phase, Program, Setter, Value};
use hexagen_reference::verify::Subject;
use hexagen_reference::{AnyCommand, Stop};
use std::sync::{Arc, OnceLock};

/// A drive with an interpreted law and the common supervisor.
///
/// A value outside its proven interval, a bug of the generator, trips nothing: it is kept for
/// [`Interpreted::escape`], and all legs are switched off.
#[derive(Clone, Debug)]
pub struct Interpreted<'g> {
    program: &'g Program,
    machine: Machine<'g>,
    supervisor: Supervisor,
    limits: Limits,
    sensors: Sensors,
    angle: Option<AngleSensor>,
    bus: Option<BusWatch>,
    /// What the law watches itself: index of its state word, the count at which it trips, its fault.
    watches: [Option<(usize, i32, Fault)>; 2],
    /// Index of the state word of the learnt torque constant.
    torque_ratio: Option<usize>,
    places: Places,
    escape: Arc<OnceLock<Escape>>,
}

/// Age of a measured bus voltage.
#[derive(Clone, Copy, Debug)]
struct BusWatch {
    /// Since the last period.
    told: bool,
    /// What is wrong with the voltage that was told.
    fault: Option<Fault>,
    /// Periods until it is stale.
    left: i32,
    /// Periods for which it is fresh.
    periods: i32,
}

impl BusWatch {
    fn pass_period(&mut self) -> Option<Fault> {
        self.left = if self.told {
            self.periods
        } else {
            (self.left - 1).max(0)
        };
        self.told = false;
        self.fault.take()
    }
}

/// Indices of the words of a command.
#[derive(Clone, Copy, Debug)]
enum CommandPlaces {
    Legs {
        compare: [usize; 3],
        state: [usize; 3],
    },
    Intervals {
        ends: [usize; 2],
        states: [usize; 3],
    },
}

impl CommandPlaces {
    fn of(program: &Program) -> Option<Self> {
        let place = |sought: Output| {
            let mut outputs = program.step.outputs.iter();
            outputs.position(|(output, _)| *output == sought)
        };
        if program.has_intervals() {
            return Some(Self::Intervals {
                ends: [place(Output::End(0))?, place(Output::End(1))?],
                states: [
                    place(Output::States(0))?,
                    place(Output::States(1))?,
                    place(Output::States(2))?,
                ],
            });
        }
        let phases = |of: fn(Phase) -> Output| {
            let [a, b, c] = Phase::ALL.map(|phase| place(of(phase)));
            Some([a?, b?, c?])
        };
        Some(Self::Legs {
            compare: phases(Output::Compare)?,
            state: phases(Output::Leg)?,
        })
    }

    /// The command of a step with these results.
    fn command(self, results: &[i32]) -> AnyCommand {
        let half = |place: usize| results[place] as u16;
        match self {
            Self::Legs { compare, state } => {
                let state = state.map(|place| LegState::from_number(results[place]));
                Legs::new(compare.map(half), state).into()
            }
            Self::Intervals { ends, states } => {
                Intervals::of_states(ends.map(half), states.map(half)).into()
            }
        }
    }

    /// All legs in one state.
    fn at_rest(self, state: LegState) -> AnyCommand {
        AnyCommand::all(state, matches!(self, Self::Intervals { .. }))
    }
}

/// Indices of a drive's input and output words.
#[derive(Clone, Debug)]
struct Places {
    inputs: Inputs,
    command: CommandPlaces,
    /// Index of the set-point that a reset clears.
    set_point: usize,
    has_speed: bool,
    /// Index of the word that tells a fresh bus voltage.
    bus_is_fresh: Option<usize>,
}

impl Places {
    fn of(program: &Program) -> Option<Self> {
        let demand = |demand| program.place_of(demand);
        Some(Self {
            inputs: Inputs::of(program)?,
            command: CommandPlaces::of(program)?,
            set_point: demand(Demand::Speed).or_else(|| demand(Demand::Current))?,
            has_speed: demand(Demand::Speed).is_some(),
            bus_is_fresh: demand(Demand::BusIsFresh),
        })
    }
}

impl<'g> Interpreted<'g> {
    /// The drive in its initial state. The program need not pass verification: planted faults are
    /// run as well.
    ///
    /// # Panics
    /// If the program is not of a drive (inputs, outputs or words are missing), or its limits are
    /// contradictory.
    pub fn new(program: &'g Program, interface: &Interface) -> Self {
        let (limits, sensors) = (limits(&interface.limits), sensors(&interface.limits));
        assert!(limits.hold(&sensors), "contradictory limits: {limits:?}");
        Self {
            program,
            machine: Machine::of_program(program),
            supervisor: Supervisor::new(&limits, &sensors),
            limits,
            sensors,
            angle: angle(&interface.limits),
            bus: interface.bus_periods.map(|periods| BusWatch {
                told: false,
                fault: None,
                left: 0,
                periods,
            }),
            watches: [
                (interface.residual, Fault::Residual),
                (interface.over_speed, Fault::OverSpeed),
            ]
            .map(|(watch, fault)| {
                let Watch { word, most } = watch?;
                Some((place_of(program, word), most, fault))
            }),
            torque_ratio: interface.torque_ratio.map(|word| place_of(program, word)),
            places: Places::of(program).expect("the program of a drive"),
            escape: Arc::default(),
        }
    }

    /// The same, reporting the first value that leaves its interval to `place`, which several
    /// drives may share.
    #[must_use]
    pub fn telling(self, place: &Arc<OnceLock<Escape>>) -> Self {
        Self {
            escape: Arc::clone(place),
            ..self
        }
    }

    /// The first value outside its proven interval.
    pub fn escape(&self) -> Option<&Escape> {
        self.escape.get()
    }

    /// The supervisor's result.
    pub fn supervisor(&self) -> &Supervisor {
        &self.supervisor
    }

    /// A value of the law in the last period.
    pub fn word(&self, value: Value) -> Option<i64> {
        self.machine.value(value)
    }

    /// A period, at whose begin a fault is known that its sample does not show, or none.
    fn try_step(&mut self, sample: &Sample, known: Option<Fault>) -> Result<AnyCommand, Escape> {
        let Self {
            machine,
            supervisor,
            limits,
            sensors,
            angle,
            places,
            ..
        } = self;
        let sample = &angle.map_or(*sample, |sensor| sensor.resolve(sample));
        let with_angle =
            |checked: Checked| angle.map_or(checked, |_| checked.with_angle_of(sample));
        let is_demanded = machine.params[places.set_point] != 0;
        let checked = supervisor.check(limits, sensors, sample, || is_demanded);
        let checked = match checked.filter(|_| known.is_none()) {
            Some(checked) => with_angle(checked),
            None => match supervisor.examine(limits, sensors, sample, known) {
                (checked, Unfit::Rest(fault)) => {
                    let (legs, _) = supervisor.rest(limits, sensors, sample, fault);
                    machine.rest(&places.inputs.words(&with_angle(checked)))?;
                    return Ok(places.command.at_rest(legs));
                }
                (checked, Unfit::Control) => with_angle(checked),
                (checked, Unfit::Against(direction)) => {
                    if places.has_speed {
                        machine.params[places.set_point] = 0;
                    } else {
                        let most = -i32::MAX * direction.0.signum();
                        machine.set(Setter::Current, &[most])?;
                    }
                    with_angle(checked)
                }
            },
        };
        let results = machine.step(&places.inputs.words(&checked))?;
        let command = places.command.command(results);
        supervisor.follow_command(sensors, command.on());
        Ok(command)
    }

    fn set(&mut self, setter: Setter, word: i32) {
        if let Err(escape) = self.machine.set(setter, &[word]) {
            self.escape.get_or_init(|| escape);
        }
    }
}

/// Index of a state word that the interface names.
fn place_of(program: &Program, word: &str) -> usize {
    let place = program.states.iter().position(|state| state.name == word);
    place.expect("a word of the state")
}

impl Subject for Interpreted<'_> {
    fn step(&mut self, sample: &Sample) -> AnyCommand {
        let of_bus = self.bus.as_mut().and_then(BusWatch::pass_period);
        if let Some(place) = self.places.bus_is_fresh {
            self.machine.params[place] = (!self.bus_is_stale()).into();
        }
        let mut watches = self.watches.into_iter().flatten();
        let found = watches.find(|&(place, most, _)| self.machine.state[place] >= most);
        let known = of_bus.or(found.map(|(_, _, fault)| fault));
        self.try_step(sample, known).unwrap_or_else(|escape| {
            self.escape.get_or_init(|| escape);
            self.places.command.at_rest(LegState::Off)
        })
    }

    fn set_current(&mut self, bits: i32) {
        self.set(Setter::Current, bits);
    }

    fn set_torque(&mut self, bits: i32) {
        let learnt = self.torque_ratio.map(|place| self.machine.state[place]);
        let scaled = learnt.map(|ratio| scaled_torque(Word(bits), Word(ratio)).0);
        self.set(Setter::Torque, scaled.unwrap_or(bits));
    }

    fn set_speed(&mut self, bits: i32) {
        self.set(Setter::Speed, bits);
    }

    fn set_bus(&mut self, counts: u16) {
        self.set(Setter::Bus, counts.into());
        if let Some(bus) = &mut self.bus {
            bus.told = true;
            bus.fault = self.limits.bus_fault(counts);
        }
    }

    fn reset(&mut self) {
        if self.supervisor.reset(&self.limits, &self.sensors) {
            let words = self.program.states.iter();
            self.machine.state = words.map(|word| word.initial).collect();
            self.machine.params[self.places.set_point] = 0;
        }
    }

    fn calibrate(&mut self) {
        self.supervisor.calibrate(&self.limits);
    }

    fn precharge(&mut self) {
        self.supervisor.precharge(&self.limits);
    }

    fn stop(&mut self, stop: Stop) {
        match stop {
            Stop::Coast => self.supervisor.coast(),
            Stop::Brake => self.supervisor.brake(),
            Stop::Resume => {
                if self.supervisor.resume() {
                    self.machine.params[self.places.set_point] = 0;
                }
            }
        }
    }

    fn fault(&self) -> Option<Fault> {
        self.supervisor.status().fault
    }

    fn bus_is_stale(&self) -> bool {
        self.bus.is_some_and(|bus| bus.left == 0)
    }

    fn state_words(&self, words: &mut [i32]) {
        let supervisor = self.supervisor.words();
        let own = supervisor.iter().chain(&self.machine.state);
        for (word, own) in words.iter_mut().zip(own) {
            *word = *own;
        }
    }

    fn set_state_words(&mut self, words: &[i32]) {
        let Some((supervisor, law)) = words.split_first_chunk() else {
            return;
        };
        self.supervisor.set_words(*supervisor);
        for (word, given) in self.machine.state.iter_mut().zip(law) {
            *word = *given;
        }
    }
}
