//! The normalised text of a checked specification, as documented in `normalised.md`: TOML, SI
//! units, a fixed order of keys, every float with the fewest digits that read back the same.

use super::sensing::LOW_SIDE;
use super::torque_share::share_of_torque;
use super::words::Words;
use super::{
    BusCurrents, BusSource, CurrentSensing, EmfShape, InverterSpec, MotorSpec, RotorSensing,
    SensedPhases, SensingTimes, Spec,
};
use crate::spec::ControllerSpec;
use std::fmt::{Debug, Display};

impl Spec {
    /// The normalised specification: the same specification gives the same bytes.
    pub fn to_toml(&self) -> String {
        let mut text = Text::default();
        text.word("name", &self.name);
        self.write_motor(&mut text, &self.motor);
        self.write_inverter(&mut text, &self.inverter);
        write_controller(&mut text, &self.controller);
        text.0
    }

    fn write_motor(&self, text: &mut Text, motor: &MotorSpec) {
        text.section("motor");
        text.number("pole_pairs", motor.pole_pairs);
        text.number("resistance", motor.resistance);
        text.number("inductance", motor.inductance);
        text.number("emf_constant", motor.emf_constant);
        match motor.emf_shape {
            EmfShape::Trapezoidal { flat_top_deg } => {
                text.word("emf_shape", "trapezoidal");
                text.number("flat_top_deg", flat_top_deg);
            }
            EmfShape::Sinusoidal => text.word("emf_shape", "sinusoidal"),
            EmfShape::Harmonics(series) => {
                text.word("emf_shape", "harmonics");
                text.number("emf_sines", series.sines);
                text.number("emf_cosines", series.cosines);
            }
        }
        text.number("torque_constant", self.torque_constant());
        if self.controller.common().field_weakening {
            text.number("weakening_share", share_of_torque(motor.emf_shape));
        }
        if self.angle_sensor().is_none() {
            text.number("hall_codes", motor.hall_codes);
        }
        if !motor.has_even_halls() {
            text.number("hall_angles", motor.hall_angles);
        }
    }

    fn write_inverter(&self, text: &mut Text, inverter: &InverterSpec) {
        text.section("inverter");
        text.number("v_bus", inverter.v_bus);
        match inverter.bus {
            BusSource::Fixed => text.word("bus", "fixed"),
            BusSource::Measured {
                gain,
                adc_bits,
                min,
                max,
                braking,
                motoring,
                ..
            } => {
                text.word("bus", "measured");
                text.number("bus_gain", gain);
                text.number("bus_adc_bits", adc_bits);
                text.number("bus_min", min);
                text.number("bus_max", max);
                let counts = inverter.bus_counts();
                if counts != [0, u16::MAX] {
                    text.number("bus_counts", counts);
                }
                for (key, fade) in [("braking_fade", braking), ("motoring_fade", motoring)] {
                    if let Some(fade) = fade {
                        text.number(key, [fade.full, fade.none]);
                    }
                }
            }
        }
        text.number("t_s", inverter.t_s);
        if inverter.pwm_per_control > 1 {
            text.number("pwm_per_control", inverter.pwm_per_control);
        }
        if inverter.dead_time > 0.0 {
            text.number("dead_time", inverter.dead_time);
        }
        text.number("timer_period", inverter.timer_period);
        text.number("adc_bits", inverter.adc_bits);
        write_sensors(text, inverter);
        text.number("offset_tolerance", inverter.offset_tolerance);
        text.number("trip_current", inverter.trip_current);
        text.number("max_current", inverter.max_current);
        let BusCurrents { drawn, returned } = inverter.bus_currents;
        for (key, most) in [
            ("bus_current_limit", drawn),
            ("return_current_limit", returned),
        ] {
            if let Some(most) = most {
                text.number(key, most);
            }
        }
        self.write_rotor(text);
        text.number("omega_max", inverter.maximum_speed);
        match inverter.rotor_sensing {
            RotorSensing::Angle(_) => text.optional("over_speed_step", self.over_speed_step()),
            _ => text.optional("over_speed_turn", self.over_speed_turn()),
        }
        text.number("stall_periods", inverter.stall_periods);
        if inverter.hall_glitches > 0 {
            text.number("hall_glitches", inverter.hall_glitches);
        }
        text.number("brake_periods", self.brake_periods());
        if self.start_periods() > 0 {
            text.number("start_periods", self.start_periods());
        }
        text.number("calibration_log2", inverter.calibration_log2);
        text.number("precharge_periods", inverter.precharge_periods);
    }
}

impl Spec {
    /// What tells the rotor's position.
    fn write_rotor(&self, text: &mut Text) {
        let sensing = self.inverter.rotor_sensing;
        let capture = match sensing {
            RotorSensing::Angle(sensor) => {
                text.number("angle_turns", sensor.turns);
                text.number("angle_offset", sensor.offset());
                text.number("angle_filter", self.speed_filter(sensor));
                text.number("turn_max", self.greatest_turn(sensor));
                return;
            }
            RotorSensing::SampledHalls => "sampled",
            RotorSensing::TimedHalls { .. } => "timer",
        };
        text.word("hall_capture", capture);
        text.number("ticks", sensing.ticks_per_period());
        text.number("age_max", self.age_max());
        text.number("rev_min", self.rev_min());
    }
}

/// One value where all sensors are alike, else one of each.
fn write_sensors(text: &mut Text, inverter: &InverterSpec) {
    let sensors = inverter.sensors();
    let gains: Vec<f64> = sensors.iter().map(|sensor| sensor.gain).collect();
    let offsets: Vec<u32> = sensors.iter().map(|sensor| sensor.offset).collect();
    text.one_or_each("adc_gain", &gains);
    text.one_or_each("adc_offset", &offsets);
    if inverter.sensed_phases != SensedPhases::Ab {
        text.word("sensed_phases", inverter.sensed_phases.word());
    }
    if let CurrentSensing::LowSide(times) = inverter.current_sensing {
        let SensingTimes {
            settling,
            aperture,
            conversion,
            converters,
            lead,
        } = times;
        text.word("current_sensing", LOW_SIDE);
        text.number("settling_time", settling);
        text.number("aperture_time", aperture);
        text.number("conversion_time", conversion);
        if converters > 1 {
            text.number("current_adcs", converters);
        }
        text.number("sampling_lead", lead);
    }
    if let Some(sum) = inverter.current_sum {
        text.number("current_sum_tolerance", sum.tolerance);
        text.number("current_sum_samples", sum.samples);
    }
    if inverter.minimum_low_time > 0.0 {
        text.number("minimum_low_time", inverter.minimum_low_time);
    }
}

fn write_controller(text: &mut Text, controller: &ControllerSpec) {
    text.section("controller");
    text.word("kind", controller.kind());
    for (rule, value) in controller.lines() {
        text.line(&format!("{} = {value}", rule.name));
    }
    if let Some(speed) = controller.common().speed {
        text.number("inertia", speed.inertia);
    }
}

#[derive(Default)]
struct Text(String);

impl Text {
    fn section(&mut self, name: &str) {
        self.line(&format!("[{name}]"));
    }

    /// `Debug` of a float is the shortest text that reads back the same.
    fn number(&mut self, key: &str, value: impl Debug) {
        self.line(&format!("{key} = {value:?}"));
    }

    fn optional(&mut self, key: &str, value: Option<impl Debug>) {
        if let Some(value) = value {
            self.number(key, value);
        }
    }

    fn one_or_each<T: Debug + PartialEq>(&mut self, key: &str, values: &[T]) {
        match values {
            [first, rest @ ..] if rest.iter().all(|value| value == first) => {
                self.number(key, first);
            }
            values => self.number(key, values),
        }
    }

    fn word(&mut self, key: &str, value: impl Display) {
        self.line(&format!("{key} = \"{value}\""));
    }

    fn line(&mut self, line: &str) {
        self.0.push_str(line);
        self.0.push('\n');
    }
}

#[cfg(test)]
mod tests {
    use crate::spec::{
        BusCurrents, BusSource, CommonMode, ControllerSpec, Core, CurrentSensing, CurrentSensor,
        Discretisation, EmfShape, EmfSource, HALL_ANGLES, InverterSpec, Learning, LimitRule,
        LoopOptions, Modulation, MotorSpec, PdccSpec, Reference, RotorSensing, SensedPhases,
        SensingTimes, Spec, ZeroVector,
    };

    fn hub_drive() -> Spec {
        Spec {
            name: "HubDrive".into(),
            motor: MotorSpec {
                description: String::new(),
                pole_pairs: 4,
                resistance: 0.135,
                inductance: 0.00022,
                emf_constant: 0.0824,
                emf_shape: EmfShape::Trapezoidal {
                    flat_top_deg: 120.0,
                },
                rated_current: 20.0,
                rated_torque: Some(3.3),
                rated_speed: 209.5,
                inertia: None,
                inductance_tolerance: 0.1,
                resistance_tolerance: 0.3,
                hall_codes: [1, 5, 4, 6, 2, 3],
                hall_angles: HALL_ANGLES,
            },
            inverter: InverterSpec {
                v_bus: 48.0,
                bus: BusSource::Fixed,
                t_s: 5e-5,
                pwm_per_control: 1,
                timer_period: 1800,
                dead_time: 0.0,
                adc_bits: 12,
                adc_gain: 0.019_531_25,
                adc_offset: 2048,
                other_sensors: vec![CurrentSensor {
                    gain: 0.019_531_25,
                    offset: 2048,
                }],
                amplifier_reach: None,
                sensed_phases: SensedPhases::Ab,
                current_sum: None,
                current_sensing: CurrentSensing::InPhase,
                minimum_low_time: 0.0,
                offset_tolerance: 102,
                trip_current: 38.0,
                max_current: 20.0,
                bus_currents: BusCurrents::default(),
                rotor_sensing: RotorSensing::TimedHalls { ticks: 37.5 },
                minimum_speed: 4.0,
                maximum_speed: 314.0,
                bus_clamp: None,
                over_speed: None,
                stall_periods: 0,
                hall_glitches: 0,
                calibration_log2: 8,
                precharge_periods: 20,
            },
            controller: ControllerSpec::Pdcc(PdccSpec {
                modulation: Modulation::ThreePhase,
                zero: ZeroVector::AllLow,
                saturation: LimitRule::TorquePriority,
                dead_time_compensation: false,
                rounding_prediction: false,
                common_mode: CommonMode::Centred,
                common: LoopOptions {
                    emf: EmfSource::Estimated,
                    emf_filter: 1.0,
                    reference: Reference::QuasiSquare,
                    advance: 0.0,
                    delay: 1,
                    discretisation: Discretisation::Exact,
                    word: 32,
                    core: Core::default(),
                    word_by_target: false,
                    commutation_threshold: 0.5,
                    commutation_timeout: 8,
                    speed: None,
                    slew_rate: None,
                    residual_periods: None,
                    field_weakening: false,
                    learning: Learning::default(),
                },
            }),
        }
    }

    #[test]
    fn keys_and_numbers_stand_as_documented() {
        let expected = r#"name = "HubDrive"
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
trip_current = 38.0
max_current = 20.0
hall_capture = "timer"
ticks = 37.5
age_max = 49087
rev_min = 3751
omega_max = 314.0
stall_periods = 0
brake_periods = 192
calibration_log2 = 8
precharge_periods = 20
[controller]
kind = "pdcc"
modulation = "three_phase"
saturation = "torque_priority"
emf = "estimated"
emf_filter = 1.0
reference = "quasi_square"
advance = 0.0
delay = 1
discretisation = "exact"
word = 32
commutation_threshold = 0.5
commutation_timeout = 8
"#;
        assert_eq!(hub_drive().to_toml(), expected);
        expected.parse::<toml_edit::DocumentMut>().expect("is TOML");
    }

    #[test]
    fn sensing_is_written_where_it_is_not_the_usual_one() {
        let mut spec = hub_drive();
        let inverter = &mut spec.inverter;
        inverter.pwm_per_control = 3;
        inverter.other_sensors[0] = CurrentSensor {
            gain: -0.02,
            offset: 2050,
        };
        inverter.sensed_phases = SensedPhases::Bc;
        inverter.current_sensing = CurrentSensing::LowSide(SensingTimes {
            settling: 1e-6,
            aperture: 2e-7,
            conversion: 0.0,
            converters: 1,
            lead: 0.0,
        });
        inverter.minimum_low_time = 2e-6;
        let text = spec.to_toml();
        for lines in [
            "t_s = 5e-5\npwm_per_control = 3\n",
            "adc_gain = [0.01953125, -0.02]\nadc_offset = [2048, 2050]\nsensed_phases = \"bc\"\n\
             current_sensing = \"low_side\"\nsettling_time = 1e-6\naperture_time = 2e-7\n\
             conversion_time = 0.0\nsampling_lead = 0.0\nminimum_low_time = 2e-6\noffset_tolerance",
        ] {
            assert!(text.contains(lines), "{text}");
        }
    }
}
