//! The runtime's supervisor, alone, equals the bit-true model's supervision, in streams and from
//! arbitrary states, in all of its modes and faults.

use hexagen::{Command, Fault, Limits, Sample, Sensors, Supervisor, Unfit};
use hexagen_codegen::pipeline::Generated;
use hexagen_lab::{formats, limits, sensors};
use hexagen_reference::verify::{Action, Context, Stimulus};
use hexagen_reference::{BitTrue, FormatTable, Mode, Spec, Stop};
use hexagen_tests::options::{Drive, generate_toml};
use hexagen_tests::sensors::{SHORT, specification};
use hexagen_tests::states::States;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// Drives that together use everything of a supervisor. Their laws store the last currents.
const DRIVES: [Drive; 4] = [
    Drive {
        kind: "pdcc",
        motor: "hoverboard-hub",
        settings: &[("stall_timeout", "100ms"), ("start_up", "short")],
    },
    Drive {
        kind: "pdcc",
        motor: "estun-emj-04apb22",
        settings: &[("adc_inverted", "on"), ("start_up", "brief")],
    },
    Drive {
        kind: "pdcc",
        motor: "teknic-m2310p",
        settings: &[
            ("word", "16"),
            ("stall_timeout", "100ms"),
            ("start_up", "short"),
            ("halls", "bridged"),
        ],
    },
    Drive {
        kind: "pdcc",
        motor: "trivedi-keshri-660w",
        settings: &[
            ("v_bus", "measured"),
            ("halls", "bridged_60_degrees"),
            ("start_up", "short"),
        ],
    },
];

/// Sensors of further drives: in other phases, unlike, and three of them.
const SENSORS: [&str; 5] = [
    "sensed_phases = \"bc\"\nadc_inverted = [\"on\", \"off\"]\nadc_offset = [2100, 2011]",
    "sensed_phases = \"ca\"\nadc_offset = [2000, 2048]",
    "sensed_phases = \"abc\"\nadc_gain = [\"20 mA/count\", \"25 mA/count\", \"18 mA/count\"]\ncurrent_sum_samples = 2",
    "sensed_phases = \"abc\"\nadc_offset = [2000, 2048, 2100]\nadc_inverted = [\"off\", \"off\", \"on\"]\ncurrent_sum_samples = 3\n\
     current_sensing = \"low_side\"\nsettling_time = \"2.5 us\"\naperture_time = \"200 ns\"\nconversion_time = \"0 us\"",
    "sensed_phases = \"abc\"\ncurrent_sum_samples = 0",
];

/// Steps of a drive in streams, and from arbitrary states.
const STEPS: u64 = 200_000;

/// A drive.
struct Supervised {
    generated: Generated,
    spec: Spec,
    model: BitTrue,
    limits: Limits,
    sensors: Sensors,
}

impl Supervised {
    fn of(toml: &str) -> Self {
        let (_, generated) = generate_toml(toml).expect("the drive generates");
        let interface = &generated.interface;
        let spec = Spec::from_toml(&interface.spec_toml).expect("a specification");
        let table = FormatTable::new(&formats(&interface.formats));
        Self {
            model: BitTrue::new(&spec, &table).expect("a model"),
            limits: limits(&interface.limits),
            sensors: sensors(&interface.limits),
            spec,
            generated,
        }
    }

    /// Tells what the streams reach.
    fn assert_equal_in_streams(&self) -> Reach {
        let mut stimulus = Stimulus::new(&self.spec, 1).expect("a stimulus");
        let mut pair = Pair::new(self);
        stimulus.restart();
        for _ in 0..STEPS {
            let context = Context {
                offset: pair.model.offset_counts(),
                tripped: pair.model.mode() == Mode::Tripped,
            };
            let (action, sample) = stimulus.next(&context);
            match action {
                Some(Action::SetCurrent(bits)) => pair.model.set_current(bits),
                Some(Action::SetTorque(bits)) => pair.model.set_torque(bits),
                Some(Action::SetBus(counts)) => pair.set_bus(counts),
                Some(Action::Reset) => pair.reset(),
                Some(Action::Calibrate) => pair.calibrate(),
                Some(Action::Precharge) => pair.precharge(),
                Some(Action::Stop(stop)) => pair.stop(stop),
                _ => {}
            }
            pair.step(&sample);
            stimulus.respond(pair.command);
        }
        pair.reach
    }

    /// Tells the faults to which a step leads.
    fn assert_equal_from_states(&self) -> BTreeSet<i32> {
        let mut pair = Pair::new(self);
        let names = self.model.state_names();
        let mut states = States::new(&self.spec, &self.generated, &names, 1);
        for number in 0..STEPS {
            pair.model.set_current(states.set_point(1e6));
            let sample = states.fill(&mut pair.words);
            pair.model.set_state_words(&pair.words);
            let own = pair.words.first_chunk();
            pair.supervisor
                .set_words(*own.expect("the supervisor's words"));
            match number % 12 {
                0 => pair.reset(),
                1 => pair.calibrate(),
                2 => pair.precharge(),
                3 => pair.stop(Stop::Coast),
                4 => pair.stop(Stop::Brake),
                5 => pair.stop(Stop::Resume),
                6 if pair.model.has_measured_bus() => pair.set_bus(states.bus_counts()),
                _ => {}
            }
            pair.step(&sample);
        }
        pair.reach.faults
    }
}

/// What streams reach.
#[derive(Debug, Default, PartialEq, Eq)]
struct Reach {
    /// Words of the modes.
    modes: BTreeSet<i32>,
    /// Words of the faults to which a step leads.
    faults: BTreeSet<i32>,
    /// Directions that a drive brakes against; 0 if unknown.
    opposed: BTreeSet<i32>,
    /// A disturbed Hall code is bridged.
    bridges: bool,
}

/// A supervisor, and the model that it is compared with.
struct Pair {
    reach: Reach,
    supervisor: Supervisor,
    limits: Limits,
    sensors: Sensors,
    model: BitTrue,
    /// What the last call told of the bus.
    known: Option<Fault>,
    words: Vec<i32>,
    /// Indices of the last currents.
    currents: [usize; 2],
    command: hexagen_reference::AnyCommand,
}

impl Pair {
    fn new(drive: &Supervised) -> Self {
        let names = drive.model.state_names();
        let place = |name| names.iter().position(|known| *known == name);
        Self {
            reach: Reach::default(),
            supervisor: Supervisor::new(&drive.limits, &drive.sensors),
            limits: drive.limits,
            sensors: drive.sensors,
            model: drive.model.clone(),
            known: None,
            words: vec![0; names.len()],
            currents: ["i_a_prev", "i_b_prev"]
                .map(|name| place(name).expect("a law with currents")),
            command: hexagen_reference::AnyCommand::default(),
        }
    }

    fn set_bus(&mut self, counts: u16) {
        self.model.set_bus(counts);
        self.known = self.limits.bus_fault(counts);
    }

    fn reset(&mut self) {
        self.model.reset();
        self.supervisor.reset(&self.limits, &self.sensors);
    }

    fn calibrate(&mut self) {
        self.model.calibrate();
        self.supervisor.calibrate(&self.limits);
    }

    fn precharge(&mut self) {
        self.model.precharge();
        self.supervisor.precharge(&self.limits);
    }

    fn stop(&mut self, stop: Stop) {
        self.model.stop(stop);
        match stop {
            Stop::Coast => self.supervisor.coast(),
            Stop::Brake => self.supervisor.brake(),
            Stop::Resume => {
                self.supervisor.resume();
            }
        }
    }

    /// A period of both.
    #[track_caller]
    fn step(&mut self, sample: &Sample) {
        let (limits, sensors) = (&self.limits, &self.sensors);
        let [mode_before, before, ..] = self.supervisor.words();
        let demanded = self.model.set_point_words()[0];
        let checked = self
            .supervisor
            .check(limits, sensors, sample, || demanded != 0.0);
        let known = self.known.take();
        let checked = checked.filter(|_| known.is_none());
        let is_doubtful = checked.is_none();
        let (checked, unfit) = match checked {
            Some(checked) => (checked, Unfit::Control),
            None => self.supervisor.examine(limits, sensors, sample, known),
        };
        self.command = self.model.step(sample);
        self.model.state_words(&mut self.words);
        let legs = match unfit {
            Unfit::Rest(fault) => {
                let (legs, tripped) = self.supervisor.rest(limits, sensors, sample, fault);
                // A trip is told in its period alone.
                let [mode, fault, ..] = self.supervisor.words();
                let trips = mode != mode_before && mode == hexagen::Mode::Tripped as i32;
                let expected = Fault::from_number(fault).filter(|_| trips);
                assert_eq!(tripped, expected, "{sample:?}");
                Some(legs)
            }
            Unfit::Control | Unfit::Against(_) => {
                self.supervisor
                    .follow_command(sensors, Command::on(self.command));
                None
            }
        };
        let expected = (!self.model.trace().run).then(|| self.command.state()[0]);
        assert_eq!(legs, expected, "{sample:?}");
        self.reach.bridges |= unfit == Unfit::Control && is_doubtful;
        if let Unfit::Against(direction) = unfit {
            self.reach.opposed.insert(direction.0);
            // The model demands the largest torque against the direction, or none.
            let demanded = self.model.set_point_words()[0];
            let is_opposed = match direction.0 {
                0 => demanded == 0.0,
                direction => demanded * f64::from(direction) < 0.0,
            };
            assert!(is_opposed, "{demanded} against {direction:?}");
        }
        let words = self.supervisor.words();
        self.reach.modes.insert(words[0]);
        if words[1] != before {
            self.reach.faults.insert(words[1]);
        }
        assert_eq!(&self.words[..words.len()], words, "{sample:?}");
        let currents = self.currents.map(|place| self.words[place]);
        assert_eq!([checked.i_a().0, checked.i_b().0], currents, "{sample:?}");
    }
}

#[test]
fn supervisor_and_model_agree() {
    let of_sensors = SENSORS.iter().map(|sensors| {
        let inverter = format!("{SHORT}{sensors}");
        specification(&inverter, "kind = \"pdcc\"")
    });
    let drives = DRIVES.iter().map(|drive| drive.toml(None));
    let drives: Vec<String> = drives.chain(of_sensors).collect();
    let reached = drives.par_iter().map(|toml| {
        let drive = Supervised::of(toml);
        let faults = drive.assert_equal_from_states();
        let reach = drive.assert_equal_in_streams();
        let faults = &faults | &reach.faults;
        Reach { faults, ..reach }
    });
    let reach = reached.reduce(Reach::default, |one, other| Reach {
        modes: &one.modes | &other.modes,
        faults: &one.faults | &other.faults,
        opposed: &one.opposed | &other.opposed,
        bridges: one.bridges || other.bridges,
    });
    let all = Reach {
        modes: (0..=6).collect(),
        // Without those that a law finds.
        faults: BTreeSet::from([1, 2, 3, 4, 5, 6, 7, 9]),
        opposed: BTreeSet::from([-1, 0, 1]),
        bridges: true,
    };
    assert_eq!(reach, all);
}
