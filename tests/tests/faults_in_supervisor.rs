//! The bit-true model's own supervision detects every fault planted in the text of the runtime's
//! supervisor, except equivalent ones.

use hexagen::{Limits, Sensors};
use hexagen_codegen::pipeline::Generated;
use hexagen_lab::{formats, limits, sensors};
use hexagen_reference::verify::{Action, Context, Stimulus};
use hexagen_reference::{BitTrue, FormatTable, Mode, Spec, Stop};
use hexagen_tests::options::{Drive, generate_toml};
use hexagen_tests::sensors::{SHORT, specification};
use hexagen_tests::states::States;
use rayon::prelude::*;

/// A supervisor of one drive.
trait Supervised {
    /// A period.
    fn period(&mut self, adc: [u16; 3], hall: u8, is_demanded: bool) -> Outcome;
    /// Follows the legs of a controlled period.
    fn follow(&mut self, command: hexagen_reference::AnyCommand);
    /// A period begins behind a call of `set_bus` with this count.
    fn bus(&mut self, counts: u16);
    fn reset(&mut self);
    fn calibrate(&mut self);
    fn precharge(&mut self);
    fn stop(&mut self, stop: Stop);
    fn words(&self) -> [i32; WORDS];
    fn set_words(&mut self, words: [i32; WORDS]);
}

/// What a period comes to.
struct Outcome {
    /// The currents for the law.
    currents: [i32; 2],
    /// The number of the state of all legs, if the drive rests.
    leg: Option<i32>,
    /// The direction that it brakes, if it brakes a fast rotor.
    against: Option<i32>,
}

/// Words of a supervisor.
const WORDS: usize = hexagen::Supervisor::NAMES.len();

type New = fn(Limits, Sensors) -> Box<dyn Supervised>;

/// A supervisor of a module, behind the trait.
macro_rules! new {
    ($module:ident) => {{
        struct Own($module::Supervisor, $module::Limits, $module::Sensors);
        impl Supervised for Own {
            fn period(
                &mut self,
                [adc_a, adc_b, adc_c]: [u16; 3],
                hall: u8,
                is_demanded: bool,
            ) -> Outcome {
                let Self(supervisor, limits, sensors) = self;
                let sample = Sample::with_hall([adc_a, adc_b], hall).third_current(adc_c);
                let (checked, rest) =
                    match supervisor.check(limits, sensors, &sample, || is_demanded) {
                        Some(checked) => (checked, $module::Rest::Control),
                        None => supervisor.rest(limits, sensors, &sample),
                    };
                let (leg, against) = match rest {
                    $module::Rest::Legs(leg) => (Some(leg as i32), None),
                    $module::Rest::Control => (None, None),
                    $module::Rest::Against(direction) => (None, Some(direction.0)),
                };
                Outcome {
                    currents: [checked.i_a().0, checked.i_b().0],
                    leg,
                    against,
                }
            }
            fn follow(&mut self, command: hexagen_reference::AnyCommand) {
                self.0
                    .follow_command(&self.2, hexagen::Command::on(command));
            }
            fn bus(&mut self, counts: u16) {
                if let Some(fault) = self.1.bus_fault(counts) {
                    self.0.trip(fault);
                }
            }
            fn reset(&mut self) {
                self.0.reset(&self.1, &self.2);
            }
            fn calibrate(&mut self) {
                self.0.calibrate(&self.1);
            }
            fn precharge(&mut self) {
                self.0.precharge(&self.1);
            }
            fn stop(&mut self, stop: Stop) {
                match stop {
                    Stop::Coast => self.0.coast(),
                    Stop::Brake => self.0.brake(),
                    Stop::Resume => {
                        self.0.resume();
                    }
                }
            }
            fn words(&self) -> [i32; WORDS] {
                self.0.words()
            }
            fn set_words(&mut self, words: [i32; WORDS]) {
                self.0.set_words(words);
            }
        }
        |limits: Limits, sensors: Sensors| -> Box<dyn Supervised> {
            let limits = $module::Limits {
                adc_max: limits.adc_max,
                adc_inverted: limits.adc_inverted,
                current_bits: limits.current_bits,
                offset: limits.offset,
                offsets: limits.offsets,
                trip: limits.trip,
                currents: limits.currents,
                calibration_log2: limits.calibration_log2,
                precharge_periods: limits.precharge_periods,
                stall_periods: limits.stall_periods,
                hall_inverted: limits.hall_inverted,
                hall_glitches: limits.hall_glitches,
                sectors: limits.sectors,
                brake_periods: limits.brake_periods,
                start_periods: limits.start_periods,
                bus_counts: limits.bus_counts,
            };
            let sensor = |sensor: hexagen::Sensor| $module::Sensor {
                adc_inverted: sensor.adc_inverted,
                offset: sensor.offset,
                offsets: sensor.offsets,
                ratio: sensor.ratio,
            };
            let sensors = $module::Sensors {
                phases: match sensors.phases {
                    hexagen::SensedPhases::Ab => $module::SensedPhases::Ab,
                    hexagen::SensedPhases::Bc => $module::SensedPhases::Bc,
                    hexagen::SensedPhases::Ca => $module::SensedPhases::Ca,
                },
                second: sensors.second.map(sensor),
                third: sensors.third.map(|third| $module::ThirdSensor {
                    sensor: sensor(third.sensor),
                    readable: third.readable,
                    is_delayed: third.is_delayed,
                    sum_tolerance: third.sum_tolerance,
                    sum_samples: third.sum_samples,
                }),
            };
            let supervisor = $module::Supervisor::new(&limits, &sensors);
            Box::new(Own(supervisor, limits, sensors))
        }
    }};
}

/// Generated by the build script.
#[allow(
    clippy::all,
    clippy::pedantic,
    dead_code,
    unused,
    reason = "the runtime's own text, and what a fault leaves without use"
)]
mod planted {
    use super::{Limits, New, Outcome, Sensors, Stop, Supervised, WORDS};
    use hexagen::{Command, LegState, arith};
    use sample::{Checked, Sample};
    use status::{Fault, Mode, Status};

    include!(concat!(env!("OUT_DIR"), "/supervisors.rs"));
}

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

/// Steps in streams, and from arbitrary states, within which a fault must be detected.
const STEPS: u64 = 200_000;

/// Fault, and why it is equivalent.
const EQUIVALENT: &[(&str, &str)] = &[(
    "> for >=: `if bits >= log2 {`",
    "a mean of as many fraction bits as its sum is not shifted",
)];

/// A drive without fault.
#[derive(Clone)]
struct Sound {
    generated: Generated,
    spec: Spec,
    model: BitTrue,
    limits: Limits,
    sensors: Sensors,
}

impl Sound {
    fn of(drive: &Drive) -> Self {
        Self::of_toml(&drive.toml(None))
    }

    fn of_toml(toml: &str) -> Self {
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

    /// Whether a supervisor differs from the model.
    fn differs(&self, new: New) -> bool {
        self.differs_in_streams(new) || self.differs_from_states(new)
    }

    fn differs_in_streams(&self, new: New) -> bool {
        let mut stimulus = Stimulus::new(&self.spec, 1).expect("a stimulus");
        let mut pair = Pair::new(self, new);
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
            if !pair.is_same(&sample) {
                return true;
            }
            stimulus.respond(pair.command);
        }
        false
    }

    fn differs_from_states(&self, new: New) -> bool {
        let mut pair = Pair::new(self, new);
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
            if !pair.is_same(&sample) {
                return true;
            }
        }
        false
    }
}

/// A supervisor and the model that it supervises.
struct Pair {
    supervisor: Box<dyn Supervised>,
    model: BitTrue,
    words: Vec<i32>,
    /// Indices of the last currents.
    currents: [usize; 2],
    command: hexagen_reference::AnyCommand,
}

impl Pair {
    fn new(sound: &Sound, new: New) -> Self {
        let names = sound.model.state_names();
        let place = |name| names.iter().position(|known| *known == name);
        Self {
            supervisor: new(sound.limits, sound.sensors),
            model: sound.model.clone(),
            words: vec![0; names.len()],
            currents: ["i_a_prev", "i_b_prev"]
                .map(|name| place(name).expect("a law with currents")),
            command: hexagen_reference::AnyCommand::default(),
        }
    }

    fn set_bus(&mut self, counts: u16) {
        self.model.set_bus(counts);
        self.supervisor.bus(counts);
    }

    fn reset(&mut self) {
        self.model.reset();
        self.supervisor.reset();
    }

    fn calibrate(&mut self) {
        self.model.calibrate();
        self.supervisor.calibrate();
    }

    fn precharge(&mut self) {
        self.model.precharge();
        self.supervisor.precharge();
    }

    fn stop(&mut self, stop: Stop) {
        self.model.stop(stop);
        self.supervisor.stop(stop);
    }

    /// A period of both.
    fn is_same(&mut self, sample: &hexagen::Sample) -> bool {
        let is_demanded = self.model.set_point_words()[0] != 0.0;
        let Outcome {
            currents,
            leg,
            against,
        } = self
            .supervisor
            .period(sample.adc(), sample.hall(), is_demanded);
        self.command = self.model.step(sample);
        self.model.state_words(&mut self.words);
        if leg.is_none() {
            self.supervisor.follow(self.command);
        }
        let expected = (!self.model.trace().run).then(|| self.command.state()[0] as i32);
        // The model demands the largest torque against the direction, or none.
        let demanded = self.model.set_point_words()[0];
        let is_opposed = against.is_none_or(|direction| match direction {
            0 => demanded == 0.0,
            _ => demanded * f64::from(direction) < 0.0,
        });
        leg == expected
            && is_opposed
            && self.words.starts_with(&self.supervisor.words())
            && currents == self.currents.map(|place| self.words[place])
    }
}

#[test]
fn every_planted_fault_is_detected() {
    let sensors =
        SENSORS.map(|sensors| specification(&format!("{SHORT}{sensors}"), "kind = \"pdcc\""));
    let mut sound = DRIVES.map(|drive| Sound::of(&drive)).to_vec();
    sound.extend(sensors.map(|toml| Sound::of_toml(&toml)));
    let noticed = |new: New| sound.iter().any(|sound| sound.differs(new));
    let [(_, healthy), planted @ ..] = planted::SUPERVISORS else {
        panic!("no supervisor");
    };
    assert!(!noticed(*healthy), "the supervisor differs without a fault");
    let unnoticed: Vec<&str> = planted
        .par_iter()
        .filter(|(_, new)| !noticed(*new))
        .map(|(what, _)| *what)
        .collect();
    println!(
        "{} faults, {} of them unnoticed",
        planted.len(),
        unnoticed.len()
    );
    assert!(planted.len() > 80, "{} faults", planted.len());
    let listed: Vec<&str> = EQUIVALENT.iter().map(|(what, _)| *what).collect();
    assert_eq!(unnoticed, listed);
}
