//! The classes of faults of a drive, by the part that breaks.

use super::defect::{CurrentDefect, Defect, PlantDefect, SignalDefect};
use crate::plant::Short;
use hexagen_codegen::spec::{BusSource, RotorSensing, Spec};
use serde::Serialize;

/// The part of drive and motor that breaks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// Nothing: a sound drive on a motor that differs from its data sheet.
    Sound,
    /// Current sensors and their ADC.
    CurrentSensors,
    /// Wires, windings and switches of the phases.
    Phases,
    /// Hall sensors.
    Halls,
    /// The timer that measures the age of Hall edges.
    EdgeTimer,
    /// The angle sensor.
    Angle,
    /// The bus and its measurement.
    Bus,
    /// Shaft and magnets.
    Rotor,
    /// The control interrupt.
    Control,
}

impl Part {
    /// All of them, in the order of the study.
    pub const ALL: [Self; 9] = [
        Self::CurrentSensors,
        Self::Phases,
        Self::Halls,
        Self::EdgeTimer,
        Self::Angle,
        Self::Bus,
        Self::Rotor,
        Self::Control,
        Self::Sound,
    ];

    /// Its name in headings.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sound => "nothing broken",
            Self::CurrentSensors => "current sensors",
            Self::Phases => "phases and switches",
            Self::Halls => "Hall sensors",
            Self::EdgeTimer => "edge timer",
            Self::Angle => "angle sensor",
            Self::Bus => "bus",
            Self::Rotor => "rotor",
            Self::Control => "control interrupt",
        }
    }
}

/// A class of faults.
#[derive(Clone, Debug, PartialEq)]
pub struct FaultClass {
    /// The part that breaks.
    pub part: Part,
    /// What happens, in plain words.
    pub name: String,
    /// What breaks.
    pub defect: Defect,
}

impl FaultClass {
    /// Whether nothing is broken, so that a trip is a false alarm.
    pub fn is_sound(&self) -> bool {
        self.part == Part::Sound
    }
}

/// Names of the phases, and of the Hall sensors from the code's highest bit.
const PHASES: [&str; 3] = ["a", "b", "c"];
const HALLS: [&str; 3] = ["Ha", "Hb", "Hc"];

/// Placement error of a Hall sensor that came loose, electrical degrees.
const DISPLACED: f64 = 15.0;

/// Placement error of a sound drive's Hall sensors, electrical degrees.
const PLACED: f64 = 5.0;

/// True over stated current per ADC count of a sound drive's two channels.
const APART: [f64; 3] = [1.01, 0.99, 1.0];

/// Dead time beyond what the specification of a sound drive states, second.
const UNSTATED: f64 = 1e-6;

/// Control periods that pass without the interrupt before it comes again.
const LOST: usize = 10;

/// All classes for a drive: those of parts that it has.
pub fn classes(spec: &Spec) -> Vec<FaultClass> {
    let mut list = List(Vec::new());
    list.current_sensors(spec.inverter.sensed_phases.phases());
    list.phases();
    match spec.inverter.rotor_sensing {
        RotorSensing::SampledHalls => list.halls(),
        RotorSensing::TimedHalls { .. } => {
            list.halls();
            list.edge_timer();
        }
        RotorSensing::Angle(_) => list.angle(),
    }
    list.bus(matches!(spec.inverter.bus, BusSource::Measured { .. }));
    list.rotor_and_control();
    list.sound(spec.angle_sensor().is_some());
    list.0
}

struct List(Vec<FaultClass>);

impl List {
    fn add(&mut self, part: Part, name: impl Into<String>, defect: Defect) {
        let name = name.into();
        self.0.push(FaultClass { part, name, defect });
    }

    fn signal(&mut self, part: Part, name: impl Into<String>, defect: SignalDefect) {
        self.add(part, name, Defect::Signal(defect));
    }

    fn plant(&mut self, part: Part, name: impl Into<String>, defect: PlantDefect) {
        self.add(part, name, Defect::Plant(defect));
    }

    fn current_sensors(&mut self, sensed: &[usize]) {
        let kinds = [
            ("stuck at 0 A", CurrentDefect::StuckAtZero),
            ("stuck at its last value", CurrentDefect::StuckAtLast),
            ("stuck at the lowest count", CurrentDefect::StuckAtBottom),
            ("stuck at the highest count", CurrentDefect::StuckAtTop),
            ("gain halved", CurrentDefect::Gain(0.5)),
            ("gain doubled", CurrentDefect::Gain(2.0)),
            ("sign reversed", CurrentDefect::Gain(-1.0)),
            (
                "zero moved by 10 % of the range",
                CurrentDefect::Offset(0.1),
            ),
            ("noise of +-5 % of the range", CurrentDefect::Noise(0.05)),
        ];
        for (kind, defect) in kinds {
            for &phase in sensed {
                let name = format!("current sensor {}: {kind}", PHASES[phase]);
                let defect = SignalDefect::Current { phase, defect };
                self.signal(Part::CurrentSensors, name, defect);
            }
        }
        if let [first, second, ..] = *sensed {
            let name = format!(
                "current sensors {} and {} exchanged",
                PHASES[first], PHASES[second]
            );
            let defect = SignalDefect::CurrentsExchanged([first, second]);
            self.signal(Part::CurrentSensors, name, defect);
        }
    }

    fn phases(&mut self) {
        let part = Part::Phases;
        for (leg, phase) in PHASES.into_iter().enumerate() {
            let name = format!("wire of phase {phase} open");
            self.plant(part, name, PlantDefect::OpenWire { leg });
        }
        for (leg, phase) in PHASES.into_iter().enumerate() {
            let name = format!("phase {phase}: resistance times 3");
            self.plant(part, name, PlantDefect::Joint { leg, factor: 3.0 });
        }
        for (switch, is_upper) in [("upper", true), ("lower", false)] {
            for (leg, phase) in PHASES.into_iter().enumerate() {
                let name = format!("leg {phase}: {switch} switch stays off");
                self.plant(part, name, PlantDefect::DeadSwitch { leg, is_upper });
            }
        }
        for [x, y] in [[0, 1], [1, 2], [2, 0]] {
            let name = format!("phases {} and {} shorted", PHASES[x], PHASES[y]);
            self.plant(part, name, PlantDefect::Short(Short::Legs([x, y])));
        }
        for (leg, phase) in PHASES.into_iter().enumerate() {
            let name = format!("phase {phase} shorted to minus");
            self.plant(part, name, PlantDefect::Short(Short::ToMinus(leg)));
        }
        let name = "wires of phases a and b exchanged";
        self.plant(part, name, PlantDefect::WiresExchanged);
    }

    fn halls(&mut self) {
        let part = Part::Halls;
        for (level, is_high) in [("low", false), ("high", true)] {
            for (line, hall) in HALLS.into_iter().enumerate() {
                let name = format!("Hall sensor {hall} stuck {level}");
                self.signal(part, name, SignalDefect::HallStuck { line, is_high });
            }
        }
        let name = "Hall sensors Ha and Hb exchanged";
        self.signal(part, name, SignalDefect::HallsExchanged);
        let name = "a Hall line flips for a sample, every 20 ms";
        self.signal(part, name, SignalDefect::HallFlips);
        let name = "opposite Hall code for a sample, every 20 ms";
        self.signal(part, name, SignalDefect::HallOpposite);
        for (name, error_deg) in [
            ("Hall sensor Ha displaced by 15 deg", [DISPLACED, 0.0, 0.0]),
            ("all Hall sensors displaced by 15 deg", [DISPLACED; 3]),
        ] {
            self.plant(part, name, PlantDefect::Halls { error_deg });
        }
    }

    fn edge_timer(&mut self) {
        let part = Part::EdgeTimer;
        let name = "edge timer always at 0";
        self.signal(part, name, SignalDefect::EdgeTimer { ticks: 0 });
        let name = "edge timer always at its end";
        self.signal(part, name, SignalDefect::EdgeTimer { ticks: u16::MAX });
    }

    fn angle(&mut self) {
        let part = Part::Angle;
        self.signal(part, "angle stuck", SignalDefect::AngleStuck);
        let name = "angle half a turn off for a sample, every 20 ms";
        self.signal(part, name, SignalDefect::AngleJumps);
        let name = "angle sensor displaced by 15 deg";
        let error_deg = DISPLACED;
        self.plant(part, name, PlantDefect::Angle { error_deg });
    }

    fn bus(&mut self, is_measured: bool) {
        for (name, factor) in [("bus sags to 50 %", 0.5), ("bus rises to 150 %", 1.5)] {
            let is_told = true;
            self.add(Part::Bus, name, Defect::Bus { factor, is_told });
        }
        if is_measured {
            let (factor, is_told) = (0.7, false);
            let name = "bus sags to 70 %, its measurement stays";
            self.add(Part::Bus, name, Defect::Bus { factor, is_told });
        }
    }

    fn rotor_and_control(&mut self) {
        let part = Part::Rotor;
        self.add(part, "shaft blocked", Defect::Shaft { factor: 0.0 });
        let name = "shaft thrown to twice its speed";
        self.add(part, name, Defect::Shaft { factor: 2.0 });
        let half = PlantDefect::Motor([1.0, 1.0, 0.5]);
        self.plant(part, "magnets half demagnetised", half);
        let part = Part::Control;
        let name = format!("interrupt lost for {LOST} periods");
        let lost = Some(LOST);
        self.add(part, name, Defect::Interrupt { lost });
        let lost = None;
        self.add(part, "interrupt lost for good", Defect::Interrupt { lost });
    }

    fn sound(&mut self, has_angle: bool) {
        let part = Part::Sound;
        self.add(part, "as specified", Defect::None);
        for (name, factors) in [
            ("R times 2", [2.0, 1.0, 1.0]),
            ("R times 0.5", [0.5, 1.0, 1.0]),
            ("L times 0.75", [1.0, 0.75, 1.0]),
            ("L times 1.3", [1.0, 1.3, 1.0]),
            ("k_b 20 % low", [1.0, 1.0, 0.8]),
            ("k_b 20 % high", [1.0, 1.0, 1.2]),
        ] {
            self.plant(part, name, PlantDefect::Motor(factors));
        }
        let (factor, is_told) = (0.85, true);
        self.add(part, "bus 15 % low", Defect::Bus { factor, is_told });
        let dead_time = PlantDefect::DeadTime { more: UNSTATED };
        self.plant(part, "1 us of dead time unstated", dead_time);
        let apart = PlantDefect::AdcScale(APART);
        self.plant(part, "current sensors 2 % apart", apart);
        let noise = PlantDefect::AdcNoise { rms: 1.0 };
        self.plant(part, "noise of 1 ADC count rms", noise);
        if has_angle {
            let error_deg = PLACED;
            self.plant(
                part,
                "angle sensor 5 deg off",
                PlantDefect::Angle { error_deg },
            );
            return;
        }
        for (name, error_deg) in [
            ("Hall sensor Ha 5 deg off", [PLACED, 0.0, 0.0]),
            ("all Hall sensors 5 deg off", [PLACED; 3]),
        ] {
            self.plant(part, name, PlantDefect::Halls { error_deg });
        }
    }
}
