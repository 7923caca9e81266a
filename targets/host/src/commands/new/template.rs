//! The lines of a new motor file.

/// A line of the template.
pub struct Line {
    /// The fields that state it, the usual one first.
    pub fields: &'static [&'static str],
    /// What it is; a further line begins with `# `.
    pub about: &'static str,
    /// A value.
    pub example: &'static str,
    /// Whether a drive needs it.
    pub is_needed: bool,
    /// Whether it is asked for though a drive does not need it: it tells wrong answers to other questions.
    pub is_asked: bool,
    /// The value where none is given.
    pub default: Option<&'static str>,
    /// Another field, and the value of it, without which it has no place in the file; an empty value stands for any.
    pub only_with: Option<(&'static str, &'static str)>,
}

const fn needed(
    fields: &'static [&'static str],
    about: &'static str,
    example: &'static str,
) -> Line {
    Line {
        fields,
        about,
        example,
        is_needed: true,
        is_asked: false,
        default: None,
        only_with: None,
    }
}

impl Line {
    const fn optional(self) -> Self {
        Self {
            is_needed: false,
            ..self
        }
    }

    const fn asked(self) -> Self {
        Self {
            is_asked: true,
            ..self.optional()
        }
    }

    const fn only_with(self, field: &'static str, value: &'static str) -> Self {
        Self {
            only_with: Some((field, value)),
            ..self
        }
    }

    const fn or(self, default: &'static str) -> Self {
        Self {
            default: Some(default),
            ..self
        }
    }
}

/// What states the magnets of the rotor.
pub const POLES: &[&str] = &["poles", "pole_pairs"];

/// Voltage of the ADC's full scale.
pub const REFERENCE: &[&str] = &["adc_reference"];

/// Of a sensor on the shaft it is the motor's number.
pub const ANGLE_POLE_PAIRS: &str = "angle_pole_pairs";

const MOTOR: &[Line] = &[
    needed(&["description"], "Free text for the documentation.", "Rear hub drive").optional(),
    needed(
        POLES,
        "Magnet poles of the rotor; or pole_pairs, half as many.",
        "8",
    ),
    needed(
        &["resistance"],
        "per_phase (one winding) or terminal (between two terminals, \"phase to phase\").",
        "0.27 ohm terminal",
    ),
    needed(&["inductance"], "As the resistance.", "0.44 mH terminal"),
    needed(
        &["winding"],
        "star (wye) or delta; of use only where a value is per_phase.",
        "star",
    )
    .optional(),
    needed(&["emf_shape"], "sinusoidal (most hub, servo and outrunner motors) or trapezoidal; or harmonics, or samples of a trace between\n# two terminals.", "sinusoidal"),
    needed(
        &["emf_orders"],
        "Orders of the phase EMF's harmonics, odd, 3 to 23.",
        "[5, 7]",
    )
    .only_with("emf_shape", "harmonics"),
    needed(
        &["emf_amplitudes"],
        "Their amplitudes over that of the fundamental.",
        "[\"4 %\", \"-2 %\"]",
    )
    .only_with("emf_shape", "harmonics"),
    needed(
        &["emf_samples"],
        "24 to 1000 samples over one electrical period, between two terminals, turned forward.",
        "[0.0, 1.3, 2.4]",
    )
    .only_with("emf_shape", "samples"),
    needed(
        &["back_emf", "speed_constant", "torque_constant"],
        "The EMF: back_emf with line_to_line or phase, and peak or rms; or speed_constant (rpm/V;\n\
         # with block_mean for the KV of an outrunner, rms for a meter's reading);\n\
         # or torque_constant with per_peak_ampere, per_rms_ampere or block_mean (Maxon).",
        "17.3 V/krpm line_to_line peak",
    ),
    needed(
        &["rated_current"],
        "Continuous current of a phase: its peak, or rms (servo motors).",
        "20 A peak",
    ),
    needed(
        &["rated_torque"],
        "Torque at rated current; checked against the EMF.",
        "3.3 Nm",
    )
    .asked(),
    needed(&["rated_speed"], "Speed under load at rated torque.", "2000 rpm"),
    needed(
        &["no_load_speed"],
        "Speed without load; checked against the EMF.",
        "2700 rpm",
    )
    .asked(),
    needed(
        &["nominal_voltage"],
        "Voltage of the no-load speed, where that is not the bus voltage.",
        "48 V",
    )
    .asked()
    .only_with("no_load_speed", ""),
    needed(&["inertia"], "Of the rotor and what it moves; needed for speed control.", "24 g cm2").asked(),
    needed(
        &["rotor"],
        "An encoder or a resolver in place of Hall sensors; then also angle_offset, angle_direction and angle_bits.",
        "angle",
    )
    .optional(),
    needed(
        &[ANGLE_POLE_PAIRS],
        "Pole pairs of the angle, that is electrical turns in a turn of it: all of the motor for a sensor on the shaft,\n\
         # 1 for an angle that is electrical, as of a resolver with the motor's pole pairs.",
        "4",
    )
    .optional(),
];

const INVERTER: &[Line] = &[
    needed(&["bus_voltage"], "Nominal supply of the inverter.", "48 V"),
    needed(
        &["f_pwm", "sampling_time"],
        "PWM frequency; the control frequency too, unless `pwm_per_control` is above 1.",
        "20 kHz",
    )
    .or("20 kHz"),
    needed(
        &["timer_clock", "timer_period"],
        "Clock of the centre-aligned PWM timer.",
        "72 MHz",
    ),
    needed(&["adc_bits"], "Bits of the phase-current ADCs.", "12").or("12"),
    needed(
        &["adc_range", "adc_gain", "shunt"],
        "Largest current of either sign that the ADC shows; or adc_gain, as 20 mA/LSB, or\n\
         # as 66 mV/A with adc_reference; or shunt with amplifier_gain and adc_reference.",
        "40 A",
    ),
    needed(
        &["amplifier_gain"],
        "Gain from the shunt's voltage to the ADC.",
        "20",
    )
    .only_with("shunt", ""),
    needed(
        REFERENCE,
        "Voltage of the ADC's full scale.",
        "3.3 V",
    )
    .only_with("shunt", ""),
    needed(
        &["current_sensing"],
        "in_phase (between legs and motor, as Hall-effect sensors are) or low_side (shunts below the low switches;\n\
         # then also settling_time, aperture_time, conversion_time, adc_inverted and sensed_phases).",
        "in_phase",
    ),
    needed(
        &["adc_inverted"],
        "on where counts fall with the current into the motor, as many shunts in the low legs make them; the bring-up\n\
         # measures it.",
        "on",
    )
    .optional(),
    needed(
        &["settling_time"],
        "From the switching of a leg until its amplifier shows the current.",
        "1 us",
    )
    .only_with("current_sensing", "low_side"),
    needed(
        &["aperture_time"],
        "For which the ADC samples a current.",
        "200 ns",
    )
    .only_with("current_sensing", "low_side"),
    needed(
        &["conversion_time"],
        "From the sample of one current to that of the next; 0 only where each sensor has an ADC of its own.",
        "400 ns",
    )
    .only_with("current_sensing", "low_side"),
    needed(
        &["sensed_phases"],
        "Legs with a shunt: ab, bc, ca or abc; ab where nothing is said.",
        "ab",
    )
    .asked()
    .only_with("current_sensing", "low_side"),
    needed(
        &["current_adcs"],
        "ADCs that sample different phases at once, each its share of the phases in turn; 1 where nothing is said;\n\
         # without effect where conversion_time is 0.",
        "2",
    )
    .optional()
    .only_with("current_sensing", "low_side"),
    needed(
        &["v_bus"],
        "fixed, or measured: the firmware passes the bus voltage; then also bus_adc_bits and bus_adc_range,\n\
         # and bus_min and bus_max, at which the drive trips: with room around a battery's voltages.",
        "fixed",
    )
    .optional(),
    needed(
        &["bus_adc_bits"],
        "Bits of the ADC that measures the bus.",
        "12",
    )
    .only_with("v_bus", "measured"),
    needed(
        &["bus_adc_range"],
        "Bus voltage at that ADC's full scale.",
        "80 V",
    )
    .only_with("v_bus", "measured"),
    needed(
        &["bus_min"],
        "Bus voltage below which the drive trips; 70 % of bus_voltage where nothing is said.",
        "36 V",
    )
    .asked()
    .only_with("v_bus", "measured"),
    needed(
        &["bus_max"],
        "Bus voltage above which the drive trips, as when it brakes into a full battery; 130 % where nothing is said.",
        "60 V",
    )
    .asked()
    .only_with("v_bus", "measured"),
    needed(
        &["braking_fade"],
        "Width of the bus voltage below bus_max over which braking torque falls to 0.",
        "4 V",
    )
    .asked()
    .only_with("v_bus", "measured"),
    needed(
        &["bus_current_limit"],
        "Largest mean current drawn from the supply; no limit where nothing is said.",
        "10 A",
    )
    .asked(),
    needed(
        &["return_current_limit"],
        "Largest mean current returned to the supply when braking: what charges a battery, little where nothing\n\
         # takes it; no limit where nothing is said.",
        "5 A",
    )
    .asked(),
    needed(
        &["bus_clamp"],
        "Voltage at which a brake chopper or the battery holds the bus while the motor drives current into it.",
        "56 V",
    )
    .optional(),
    needed(&["max_current"], "Largest set-point. By default rated_current; with a sinusoidal EMF up to 15 % more where rated_torque needs it.", "25 A").optional(),
    needed(&["dead_time"], "Of the gate driver, per edge.", "500 ns").asked(),
    needed(
        &["hall_timer_clock"],
        "Clock of a timer that captures Hall edges, if the board has one; a slow motor needs a slower clock (HX0310).",
        "1 MHz",
    )
    .asked(),
];

const CONTROLLER: &[Line] = &[
    needed(
        &["kind"],
        "pdcc, pi-pwm, fcs-mpc, phcc or p-pwm; `hexagen --help` lists their options.",
        "pdcc",
    )
    .or("pdcc"),
    needed(
        &["speed_loop"],
        "on: a PI controller of the speed around that of the current; needs inertia. off where nothing is said.",
        "on",
    )
    .asked(),
    needed(
        &["speed_bandwidth"],
        "Bandwidth of the speed loop; by default 1/50 of the electrical frequency at rated speed.",
        "5 Hz",
    )
    .optional()
    .only_with("speed_loop", "on"),
    needed(
        &["acceleration_limit"],
        "Largest rate at which the speed follows its set-point; at once where nothing is said.",
        "2000 rpm/s",
    )
    .asked()
    .only_with("speed_loop", "on"),
    needed(
        &["target"],
        "The core: cortex_m4 (as M3, M7 and M33), cortex_m0 or riscv32; whether a step fits is then checked.",
        "cortex_m4",
    )
    .optional(),
    needed(&["core_clock"], "Its clock, with target.", "72 MHz").optional(),
];

/// The sections with their lines.
pub const SECTIONS: [(&str, &[Line]); 3] = [
    ("motor", MOTOR),
    ("inverter", INVERTER),
    ("controller", CONTROLLER),
];
