//! What each code is about: cause, example and remedy, as `hexagen explain` prints them.

use super::Code;

/// Cause, example and remedy of a code.
#[derive(Clone, Copy, Debug)]
pub struct Explanation {
    /// Why there is such an error or warning.
    pub cause: &'static str,
    /// Lines of a motor file that make it; for what no file makes, whatever does.
    pub wrong: &'static str,
    /// The same lines as they are accepted.
    pub right: &'static str,
    /// What to do.
    pub remedy: &'static str,
}

const fn say(
    cause: &'static str,
    wrong: &'static str,
    right: &'static str,
    remedy: &'static str,
) -> Explanation {
    Explanation {
        cause,
        wrong,
        right,
        remedy,
    }
}

impl Code {
    /// The code of its text, with or without `HX` and leading zeros.
    pub fn from_text(text: &str) -> Option<Self> {
        // As in a message: `error[HX0302]`.
        let code = text.trim().rsplit('[').next().unwrap_or_default();
        let upper = code.trim_end_matches([']', ':']).to_uppercase();
        let digits = upper.strip_prefix("HX").unwrap_or(&upper);
        let number: u16 = digits.parse().ok()?;
        Self::ALL
            .iter()
            .copied()
            .find(|code| code.number() == number)
    }

    /// What it is about.
    pub fn explanation(self) -> Explanation {
        match self.number() / 100 {
            1 => self.of_structure(),
            2 => self.of_values(),
            3 => self.of_drives(),
            4 => self.of_controllers(),
            _ => self.of_designs(),
        }
    }

    fn of_structure(self) -> Explanation {
        match self {
            Self::UnknownSection => say(
                "A file has the sections motor, inverter, controller, assumed and source; a macro call the first three.",
                "[controler]",
                "[controller]",
                "Correct the name, or remove the section.",
            ),
            Self::UnknownField => say(
                "The section has no field of this name, so its value would have no effect.",
                "resistence = \"135 mohm per_phase\"",
                "resistance = \"135 mohm per_phase\"",
                "Correct the name; `hexagen new FILE` writes a file that names the fields, and `hexagen::specification` in the documentation explains each.",
            ),
            Self::DuplicateField => say(
                "A field or section is written twice, and only one value can hold.",
                "pole_pairs = 4\npole_pairs = 5",
                "pole_pairs = 4",
                "Keep one of the two.",
            ),
            Self::MissingField => say(
                "The field has no default: the controller cannot be designed without it.",
                "",
                "winding = \"star\"",
                "Add the field; what the data sheet lacks goes under [assumed.motor] or [assumed.inverter] with a reason.",
            ),
            Self::MissingSection => say(
                "A drive needs a motor, an inverter and a controller.",
                "",
                "[controller]\nkind = \"pdcc\"",
                "Add the section.",
            ),
            Self::MisplacedField => say(
                "The field belongs to another section.",
                "[motor]\ndead_time = \"500 ns\"",
                "[motor]",
                "Move it to the section that the message names.",
            ),
            Self::MotorFile => say(
                "The motor file of a macro call cannot be read, is not UTF-8, or its path is absolute.",
                "motor: \"/motors/hub.toml\"",
                "motor: \"motors/hub.toml\"",
                "Give a path relative to the crate's Cargo.toml, so that every machine builds the same.",
            ),
            Self::InvalidName => say(
                "The drive's name becomes the name of a Rust type.",
                "[motor]\nname = \"hub drive\"",
                "[motor]\nname = \"HubDrive\"",
                "Begin with a capital letter; letters, digits and underscores may follow.",
            ),
            Self::ExclusiveFields => say(
                "Two fields state the same quantity, and may contradict each other.",
                "timer_clock = \"72 MHz\"\ntimer_period = 1800",
                "timer_clock = \"72 MHz\"",
                "Keep the one that the data sheet states.",
            ),
            Self::DependentField => say(
                "The value of one field needs another, or makes it useless.",
                "bus_voltage = \"48 V\"\nbus_min = \"40 V\"",
                "bus_voltage = \"48 V\"",
                "Add what is needed, or remove what has no use.",
            ),
            Self::UnknownBoard => say(
                "The library has no board of this name.",
                "a motor file with `board = \"vesc-5\"`",
                "`board = \"vesc-4\"`",
                "Choose a board that `hexagen boards` lists, or give the path of a board's file.",
            ),
            _ => say(
                "The text is no TOML, or the macro call has not the shape `pub Name { section: { field: value, … }, … }`.",
                "resistance = 135 mohm per_phase",
                "resistance = \"135 mohm per_phase\"",
                "In files quantities stand in quotes; in macros fields are parted by commas.",
            ),
        }
    }

    fn of_values(self) -> Explanation {
        match self {
            Self::MalformedValue => say(
                "The value is neither a number with its unit, nor a word, nor a list.",
                "rated_current = \"20 A!\"",
                "rated_current = \"20 A\"",
                "Write the number, its unit and its basis, apart by spaces.",
            ),
            Self::UnknownUnit => say(
                "There is no such unit; a wrong prefix would be a factor of a thousand, so none is guessed.",
                "f_pwm = \"20 KHz\"",
                "f_pwm = \"20 kHz\"",
                "Use a unit of the list in `hexagen::specification`; upper and lower case differ (m is milli, M is mega).",
            ),
            Self::AmbiguousUnit => say(
                "The unit stands for two quantities: volt-seconds are an EMF over mechanical speed, or a flux linkage over electrical speed, which differ by the pole pairs.",
                "back_emf = \"0.1648 V s line_to_line peak\"",
                "back_emf = \"0.1648 V s/rad line_to_line peak\"",
                "Write the unit of the one that is meant.",
            ),
            Self::WrongDimension => say(
                "The unit measures another quantity than the field takes.",
                "resistance = \"135 mH per_phase\"",
                "resistance = \"135 mohm per_phase\"",
                "Check the field and the unit.",
            ),
            Self::MissingUnit => say(
                "A bare number would have to be guessed: ohm or milliohm, hertz or kilohertz.",
                "bus_voltage = \"48\"",
                "bus_voltage = \"48 V\"",
                "Write the unit behind the number.",
            ),
            Self::MissingBasis => say(
                "Data sheets state R, L and EMF of a phase or between terminals, as peak, rms or mean; the readings of R and L differ by a factor of two, those of an EMF by up to three, so none is guessed. The current of a sinusoidal motor is printed as peak or rms, 1.41 times apart.",
                "resistance = \"135 mohm\"",
                "resistance = \"135 mohm per_phase\"",
                "Look for \"phase to phase\", \"terminal\" or \"line to line\" in the data sheet, or measure between two terminals and write `line_to_line`. The KV of an outrunner is `block_mean`, and so are the torque and speed constants that Maxon prints: they hold for block commutation, also of a motor with a sinusoidal EMF (chapter 3 of the guide, \"Maxon's form\"). Servo motors state their current as `rms`; write `peak` for what block commutation carries, and where nothing is said. A rated current is the continuous one: a short-time maximum, which sheets call max or peak current, is no rating, but at most `max_current` of the inverter.",
            ),
            Self::WrongBasis => say(
                "The value cannot refer to what the word says.",
                "resistance = \"135 mohm phase\"",
                "resistance = \"135 mohm per_phase\"",
                "Use a basis that the message names.",
            ),
            Self::UnknownWord => say(
                "The field takes one of some words, and this is none of them.",
                "winding = \"triangle\"",
                "winding = \"delta\"",
                "Use a word that the message lists.",
            ),
            Self::WrongKind => say(
                "The field takes a number where a word stands, or the reverse, or a whole number.",
                "pole_pairs = 4.5",
                "pole_pairs = 4",
                "Write what the message asks for.",
            ),
            Self::NotPositive => say(
                "Zero and negative values of this quantity are no motor's or inverter's.",
                "rated_current = \"0 A\"",
                "rated_current = \"20 A\"",
                "Check the number; signs of currents and speeds are set at run time.",
            ),
            Self::OutOfRange => say(
                "The limits are wider than any motor that this program is made for: a value outside is a slip of unit or decimal point.",
                "bus_voltage = \"48 kV\"",
                "bus_voltage = \"48 V\"",
                "Check the number and the prefix of its unit.",
            ),
            Self::HallCodes => say(
                "Three Hall sensors 120 electrical degrees apart show six codes, each one bit from the next.",
                "pole_pairs = 4\nhall_codes = [1, 2, 3, 4, 5, 6]",
                "pole_pairs = 4\nhall_codes = [1, 5, 4, 6, 2, 3]",
                "Turn the motor forward by hand with the legs off, and note the codes in the order in which they come; `hall_angles`, if any, are those at which these sectors begin, about -30, 30, 90, 150, 210 and 270 degrees.",
            ),
            Self::EmfShape => say(
                "Harmonics are stated as lists of equal length, of odd orders from 3 to 23, in percent of the fundamental; samples are the voltage between two terminals over one electrical period, whose half waves are opposite.",
                "emf_shape = \"harmonics\"\nemf_orders = [2]\nemf_amplitudes = [\"4 %\"]",
                "emf_shape = \"harmonics\"\nemf_orders = [5]\nemf_amplitudes = [\"4 %\"]",
                "Record the voltage between two terminals of the turned motor, legs off, over one whole electrical period; `emf_samples_speed` may be left out where the amplitude is not known.",
            ),
            _ => say(
                "The field takes a plain number.",
                "pole_pairs = \"4 A\"",
                "pole_pairs = 4",
                "Remove the unit.",
            ),
        }
    }

    fn of_drives(self) -> Explanation {
        match self {
            Self::PeriodTooLong => say(
                "Between two samples the current decays by itself: with R Ts/L above 0.5 a prediction says little. Where L/R is above 0.3 s, or so short that no PWM frequency up to 500 kHz would do, it is that of no motor: then not the period is told, but the resistance or the inductance, one of which is likely a thousandfold off.",
                "f_pwm = \"1 kHz\"",
                "f_pwm = \"20 kHz\"",
                "Raise the PWM frequency, lower `pwm_per_control`, or check R and L: their numbers, the prefixes of their units (mH for uH, ohm for mohm) and their bases. The message names the value that is likely wrong.",
            ),
            Self::BusTooLow => say(
                "The line-to-line EMF at rated speed is more than the bus, or with what rated current drops between two terminals more than 125 % of it: the motor cannot turn so fast on it, and probably a value is wrong. R and I are those of a phase and of the set-point's peak: the drop is 2 R I of a quasi-square current, and sqrt(3) R I of a sine.",
                "rated_speed = \"5000 rpm\"",
                "rated_speed = \"2000 rpm\"",
                "Data sheets often print the no-load speed as speed: write it as `no_load_speed`, and the speed under load as `rated_speed`; else check the bases of EMF and resistance.",
            ),
            Self::TorqueContradiction => say(
                "Torque is EMF constant times current; rated torque and current say another constant than the one that is stated, by more than 15 %.",
                "back_emf = \"0.1648 V/(rad/s) phase peak\"\nrated_torque = \"3.3 Nm\"",
                "back_emf = \"0.1648 V/(rad/s) line_to_line peak\"\nrated_torque = \"3.3 Nm\"",
                "The message lists the readings that fit. Look up in the data sheet which of them is meant, and write that one.",
            ),
            Self::TorqueConstantContradiction => say(
                "Torque constant and EMF constant are one property of a motor in two units; these differ by more than 15 %.",
                "rated_speed = \"2000 rpm\"\ntorque_constant = \"0.274 Nm/A\"",
                "rated_speed = \"2000 rpm\"\ntorque_constant = \"0.165 Nm/A block_mean\"",
                "Look up in the data sheet of which current the torque constant is (block_mean, per_peak_ampere or per_rms_ampere) and of which voltage the EMF constant, and write both.",
            ),
            Self::SpeedContradiction => say(
                "A motor without load turns until its EMF is the voltage; speed constant or no-load speed say another EMF constant than the one that is stated.",
                "rated_speed = \"2000 rpm\"\nno_load_speed = \"5600 rpm\"",
                "rated_speed = \"2000 rpm\"\nno_load_speed = \"2700 rpm\"",
                "If the no-load speed holds at another voltage than the bus, write that as `nominal_voltage`; else check the basis of the EMF.",
            ),
            Self::AdcRangeTooSmall => say(
                "Currents above the sensors' range cannot be controlled.",
                "adc_range = \"15 A\"",
                "adc_range = \"40 A\"",
                "Widen the range, or state a max_current that the sensors show with room to trip.",
            ),
            Self::TripAboveAdcRange => say(
                "A current that no count shows cannot trip the drive.",
                "bus_voltage = \"48 V\"\ntrip_current = \"45 A\"",
                "bus_voltage = \"48 V\"\ntrip_current = \"38 A\"",
                "Lower the trip current below the range, or leave it out.",
            ),
            Self::MaxCurrentAboveTrip => say(
                "At the largest set-point the phase currents are above the trip level, so the drive trips without a fault.",
                "bus_voltage = \"48 V\"\nmax_current = \"39 A\"\ntrip_current = \"38 A\"",
                "bus_voltage = \"48 V\"\nmax_current = \"20 A\"\ntrip_current = \"38 A\"",
                "Lower the set-point or raise the trip current.",
            ),
            Self::TimerPeriod => say(
                "The centre-aligned timer counts clock/(2 f_pwm): below 100 the period is coarse, above 65535 a 16-bit timer overflows.",
                "timer_clock = \"1 MHz\"",
                "timer_clock = \"72 MHz\"",
                "Choose a timer clock or PWM frequency that the message names.",
            ),
            Self::HallTimer => say(
                "The capture timer counts 2 to 65535 ticks in a control period.",
                "bus_voltage = \"48 V\"\nhall_timer_clock = \"30 kHz\"\n[controller]\nkind = \"pdcc\"\nhall_capture = \"timer\"",
                "bus_voltage = \"48 V\"\nhall_timer_clock = \"1 MHz\"\n[controller]\nkind = \"pdcc\"\nhall_capture = \"timer\"",
                "Choose a clock near 1 MHz.",
            ),
            Self::MinimumSpeed => say(
                "At the least speed a sector lasts longer than the 16-bit age of a Hall edge counts.",
                "bus_voltage = \"48 V\"\nhall_timer_clock = \"1 MHz\"\nminimum_speed = \"10 rpm\"\n[controller]\nkind = \"pdcc\"\nhall_capture = \"timer\"",
                "bus_voltage = \"48 V\"\nhall_timer_clock = \"1 MHz\"\nminimum_speed = \"40 rpm\"\n[controller]\nkind = \"pdcc\"\nhall_capture = \"timer\"",
                "Raise the least speed, below which the angle is the sector's centre, or slow the capture clock.",
            ),
            Self::SpeedOrder => say(
                "The least speed is below the rated one, and that at most the greatest.",
                "bus_voltage = \"48 V\"\nmaximum_speed = \"1500 rpm\"",
                "bus_voltage = \"48 V\"\nmaximum_speed = \"3000 rpm\"",
                "Change one of the two.",
            ),
            Self::TooFewPeriods => say(
                "With fewer than six control periods in an electrical turn a sector can pass unseen; an angle sensor needs 15, because differences of angles are believed up to 30 degrees only.",
                "bus_voltage = \"48 V\"\nmaximum_speed = \"60000 rpm\"",
                "bus_voltage = \"48 V\"\nmaximum_speed = \"3000 rpm\"",
                "Raise the PWM frequency or lower maximum_speed.",
            ),
            Self::OverSpeed => say(
                "The speed follows from the time of a turn, which is measured in whole control periods. The over-speed must be so far above the rated speed that this error never seems an over-speed, and so low that the drive still sees every sector at it.",
                "bus_voltage = \"48 V\"\nover_speed = \"1900 rpm\"",
                "bus_voltage = \"48 V\"\nover_speed = \"2600 rpm\"",
                "State the speed that the mechanics bear, above every set-point and what it overshoots.",
            ),
            Self::StallTimeout => say(
                "A ramp of the speed through zero may bring the rotor to rest and away again within one sector, without a Hall edge. That lasts the longer, the slower the ramp, and must not seem a stalled rotor.",
                "stall_timeout = \"20 ms\"\nbus_voltage = \"48 V\"\ninertia = \"2e-3 kg m2\"\nspeed_loop = \"on\"\nacceleration_limit = \"500 rpm/s\"",
                "stall_timeout = \"500 ms\"\nbus_voltage = \"48 V\"\ninertia = \"2e-3 kg m2\"\nspeed_loop = \"on\"\nacceleration_limit = \"500 rpm/s\"",
                "Lengthen the time-out, or raise acceleration_limit.",
            ),
            Self::EmfAboveBus => say(
                "Field weakening drives the motor at speeds at which its EMF exceeds the bus. Legs that turn off there, by a trip or `coast()`, become a rectifier: the motor drives current into the bus until it has slowed down, and only a clamp holds the voltage.",
                "bus_voltage = \"48 V\"\nmaximum_speed = \"3200 rpm\"\nkind = \"pdcc\"\nfield_weakening = \"on\"",
                "bus_voltage = \"48 V\"\nmaximum_speed = \"3200 rpm\"\nbus_clamp = \"56 V\"\nkind = \"pdcc\"\nfield_weakening = \"on\"",
                "Lower maximum_speed, or state bus_clamp: a brake chopper, or a battery that takes the current.",
            ),
            Self::BusMeasurement => say(
                "The limits of a measured bus lie on either side of the nominal voltage, inside the ADC's range.",
                "v_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"50 V\"\nbus_voltage = \"48 V\"",
                "v_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"80 V\"\nbus_voltage = \"48 V\"",
                "Widen the range, or narrow bus_min and bus_max.",
            ),
            Self::CommutationThreshold => say(
                "A commutation ends when the outgoing phase's current is below this threshold, which must be above the ADC's noise and well below the rated current.",
                "kind = \"pdcc\"\nmodulation = \"pair\"\ncommutation_threshold = \"25 A\"",
                "kind = \"pdcc\"\nmodulation = \"pair\"\ncommutation_threshold = \"0.5 A\"",
                "Use a few ADC counts, at most a tenth of the rated current.",
            ),
            Self::DeadTime => say(
                "Dead time is voltage that the controller cannot command.",
                "bus_voltage = \"48 V\"\ndead_time = \"6 us\"",
                "bus_voltage = \"48 V\"\ndead_time = \"500 ns\"",
                "Shorten it, or lower the PWM frequency.",
            ),
            Self::AdcOffset => say(
                "Both signs of the current need room in the ADC's range.",
                "adc_bits = 12\nadc_offset = 100",
                "adc_bits = 12\nadc_offset = 2048",
                "Give the count at zero current; it lies near the middle.",
            ),
            Self::UnlikeGains => say(
                "The currents of all sensors are scaled to the first one's counts, within a factor of two.",
                "adc_gain = [\"20 mA/count\", \"50 mA/count\"]",
                "adc_gain = [\"20 mA/count\", \"21 mA/count\"]",
                "Correct the gain of one sensor, or sense phases whose amplifiers are alike.",
            ),
            Self::SensingWindow => say(
                "A leg whose current is read in its low leg must be low around the sampling instant.",
                "current_sensing = \"low_side\"\nsettling_time = \"20 us\"\naperture_time = \"200 ns\"\nconversion_time = \"0 us\"",
                "current_sensing = \"low_side\"\nsettling_time = \"1 us\"\naperture_time = \"200 ns\"\nconversion_time = \"0 us\"",
                "Shorten the settling or the conversions, or lower the PWM frequency.",
            ),
            Self::MinimumLowTime => say(
                "Half of the PWM period must be left for the legs to be high.",
                "bus_voltage = \"48 V\"\nminimum_low_time = \"30 us\"",
                "bus_voltage = \"48 V\"",
                "Shorten it, or lower the PWM frequency.",
            ),
            Self::SensedPhases => say(
                "A list of sensors has one value of each sensed phase.",
                "adc_bits = 12\nadc_offset = [2048, 2050, 2052]",
                "adc_bits = 12\nadc_offset = [2048, 2048]",
                "Give one value for all sensors, or as many as `sensed_phases` names.",
            ),
            Self::OutsideOfBoard => say(
                "The file of the board states the bus voltages for which it is made: those that its parts bear, or those of its battery, from empty to full. What its source says of each, `hexagen boards NAME` prints. And it states which current sensors there are.",
                "board = \"vesc-4\"\nbus_voltage = \"70 V\"",
                "board = \"vesc-4\"\nbus_voltage = \"48 V\"",
                "Choose another board, or a bus voltage for which this one is made. Where the limit is of another battery than yours, and the parts bear your voltage, state `v_bus = \"measured\"` and your own `bus_min` or `bus_max`: they replace the board's.",
            ),
            _ => say(
                "Half a count of error is too much of what is measured.",
                "bus_voltage = \"48 V\"\nmax_current = \"19 mA\"",
                "bus_voltage = \"48 V\"\nmax_current = \"20 A\"",
                "Narrow the range, use more bits, or raise the value.",
            ),
        }
    }

    fn of_controllers(self) -> Explanation {
        match self {
            Self::UnknownController => say(
                "There is no controller of this name.",
                "kind = \"pdc\"",
                "kind = \"pdcc\"",
                "Use one that the message lists; `hexagen --help` says what each takes.",
            ),
            Self::OptionUnavailable => say(
                "The option is known, and this version does not have it.",
                "kind = \"pi-pwm\"\nmodulation = \"pair\"",
                "kind = \"pi-pwm\"\nmodulation = \"three_phase\"",
                "Use a word that the message lists.",
            ),
            Self::OptionOfOtherController => say(
                "The option belongs to another controller.",
                "kind = \"pdcc\"\ncandidates = \"all\"",
                "kind = \"pdcc\"",
                "Remove it, or choose that controller.",
            ),
            Self::OptionWithoutEffect => say(
                "Beside another option this one changes nothing, so one of the two is not meant.",
                "kind = \"pdcc\"\nemf = \"model\"\nemf_filter = 0.5",
                "kind = \"pdcc\"\nemf = \"model\"",
                "Remove one of the two.",
            ),
            Self::Variant => say(
                "A controller on the command line is its name, a colon and options.",
                "--controller pdcc:advance",
                "--controller pdcc:advance=1.5,emf=model",
                "Write `name:key=value,key=value`.",
            ),
            Self::VectorTooStrong => say(
                "A controller that applies whole vectors moves the current by more than its rating in one period: it cannot hold it.",
                "resistance = \"18.2 mohm per_phase\"\ninductance = \"8.32 uH per_phase\"\nback_emf = \"0.0195 V/(rad/s) line_to_line peak\"\nrated_current = \"5 A\"\nkind = \"fcs-mpc\"",
                "resistance = \"18.2 mohm per_phase\"\ninductance = \"8.32 uH per_phase\"\nback_emf = \"0.0195 V/(rad/s) line_to_line peak\"\nrated_current = \"5 A\"\nkind = \"pdcc\"",
                "Shorten the control period, or take pdcc or pi-pwm, which pulse.",
            ),
            Self::Band => say(
                "A hysteresis band as wide as the rated current controls nothing.",
                "kind = \"phcc\"\nband = \"20 A\"",
                "kind = \"phcc\"\nband = \"1 A\"",
                "Narrow it; what one vector moves the current by in a period is a good start.",
            ),
            Self::UnreadableLeg => say(
                "The current of an off leg may flow past a sensor in its low leg.",
                "current_sensing = \"low_side\"\nsettling_time = \"1 us\"\naperture_time = \"200 ns\"\nconversion_time = \"0 us\"\nkind = \"phcc\"\ncandidates = \"table2\"",
                "current_sensing = \"low_side\"\nsettling_time = \"1 us\"\naperture_time = \"200 ns\"\nconversion_time = \"0 us\"\nkind = \"phcc\"",
                "Choose options that turn no leg off, or a board with sensors in the phases.",
            ),
            Self::IntervalsUnavailable => say(
                "The paper's modulator turns legs on and off within a period, which not every board and not every option allows.",
                "leg_enables = \"per_period\"\nkind = \"pdcc\"\nmodulation = \"table2\"",
                "leg_enables = \"per_period\"\nkind = \"pdcc\"\nmodulation = \"pair\"",
                "Choose another modulation, or a board whose timer loads the output enables by a compare event.",
            ),
            _ => say(
                "A switching table has 48 rows of vectors: six sectors, with and without commutation, four states of the bands.",
                "kind = \"phcc\"\ntable = [0, 7, 16]",
                "kind = \"phcc\"\ntable = \"derived\"",
                "Write all 48 numbers, or `derived`.",
            ),
        }
    }

    fn of_designs(self) -> Explanation {
        match self {
            Self::InductanceOutsideStableRange => say(
                "With an inductance off by as much as its tolerance says the current loop is unstable.",
                "inductance_tolerance = \"60 %\"",
                "inductance_tolerance = \"10 %\"",
                "Use `emf = \"model\"`, filter the estimate, or narrow the tolerance if the inductance is known better.",
            ),
            Self::ResistanceOutsideStableRange => say(
                "With a resistance off by as much as its tolerance says the current loop is unstable.",
                "pole_pairs = 4\nresistance_tolerance = \"80 %\"\nf_pwm = \"2 kHz\"\nkind = \"pi-pwm\"\nbandwidth = \"300 Hz\"",
                "pole_pairs = 4\nresistance_tolerance = \"10 %\"\nf_pwm = \"2 kHz\"\nkind = \"pi-pwm\"\nbandwidth = \"100 Hz\"",
                "Lower the bandwidth, or narrow the tolerance.",
            ),
            Self::Unstable => say(
                "The closed loop's largest pole is not below 1 even with the motor as stated.",
                "kind = \"pi-pwm\"\nbandwidth = \"4 kHz\"",
                "kind = \"pi-pwm\"\nbandwidth = \"1 kHz\"",
                "Lower the bandwidth; a fifteenth of the PWM frequency is a good start.",
            ),
            Self::WordTooNarrow => say(
                "A signal or coefficient of this motor does not fit words of 16 bits.",
                "adc_bits = 16\nkind = \"pdcc\"\nword = 16",
                "adc_bits = 16\nkind = \"pdcc\"\nword = 32",
                "Use 32 bits, fewer ADC bits or a narrower range.",
            ),
            Self::SwitchingTableLosesCurrent => say(
                "The table that the paper prints loses the current; it is there for study.",
                "kind = \"phcc\"\ntable = \"printed\"",
                "kind = \"phcc\"\ntable = \"derived\"",
                "Use `derived` for a drive.",
            ),
            Self::EstimateTurnsTooFar => say(
                "The controller takes the EMF of the last period for that of the period after the next. At this speed the rotor turns so far in between that the EMF is another one.",
                "f_pwm = \"4 kHz\"\nkind = \"pdcc\"\nemf = \"estimated\"",
                "f_pwm = \"4 kHz\"\nhall_timer_clock = \"1 MHz\"\nkind = \"pdcc\"\nemf = \"observer\"",
                "Leave `emf` out, or use a shorter period.",
            ),
            Self::MeanForPeak => say(
                "EMF and torque constant are one number in SI units. Of a sinusoidal motor only the means over block commutation are, as Maxon and others print them; the peak is pi/3 times that, 4.7 % more.",
                "emf_shape = \"sinusoidal\"\ntorque_constant = \"0.1648 Nm/A\"",
                "emf_shape = \"sinusoidal\"\ntorque_constant = \"0.1648 Nm/A\"\nback_emf = \"0.1648 V/(rad/s) block_mean\"",
                "Look up in the data sheet which voltage the EMF constant refers to, and which current the torque constant, and write both. A `torque_constant` without basis makes this warning, too; with one that says its basis it goes.",
            ),
            Self::RatingBeyondBus => say(
                "At rated speed and torque the drive needs more voltage than its legs reach: EMF, resistive drop and what turns the current, at the angle where they take most. The bus cuts the current's shape there.",
                "rated_speed = \"2500 rpm\"",
                "rated_speed = \"2000 rpm\"",
                "Nothing is wrong with the drive. A little beyond, torque ripples; farther, it falls: `hexagen check` simulates the drive, and `hexagen limit` finds where its mean torque ends. Raise the bus, or state the speed that is meant under load. `field_weakening = \"on\"` makes more torque there, with ripple.",
            ),
            Self::TripFarAbove => say(
                "A fault makes as much current as the trip level before the drive stops.",
                "bus_voltage = \"48 V\"\ntrip_current = \"39 A\"\nmax_current = \"2 A\"",
                "bus_voltage = \"48 V\"\nmax_current = \"2 A\"",
                "Lower it to about twice the largest set-point, unless switches and magnets bear more.",
            ),
            Self::SwingAboveTrip => say(
                "In commutations of slow rotation hysteresis control lets a current swing above the trip level.",
                "bus_voltage = \"48 V\"\nmax_current = \"22 A\"\nkind = \"phcc\"",
                "bus_voltage = \"48 V\"\nmax_current = \"20 A\"\nkind = \"phcc\"",
                "Lower max_current or widen adc_range.",
            ),
            Self::WatchIsBlind => say(
                "residual_timeout allows for a resistance of twice the stated one, and for dead time. Where that takes half the bus at max_current, a dead sensor or an open phase causes no more.",
                "resistance = \"700 mohm per_phase\"\nrated_speed = \"500 rpm\"\nkind = \"pdcc\"\nresidual_timeout = \"5 ms\"",
                "resistance = \"700 mohm per_phase\"\nrated_speed = \"500 rpm\"\nmax_current = \"10 A\"\nkind = \"pdcc\"\nresidual_timeout = \"5 ms\"",
                "Lower max_current, or leave out residual_timeout: at full current it sees nothing.",
            ),
            Self::StepExceedsPeriod => say(
                "The cycles of the longest path of a step, with all wait states of the chip's memory, are more than the control period has. They were counted in this project's firmware with the same drive, or are estimated from the operations of the step, with an error that counts too; C takes more. A step that comes too late loses a period of control.",
                "f_pwm = \"20 kHz\"\nkind = \"pdcc\"\ntarget = \"cortex_m0\"",
                "f_pwm = \"20 kHz\"\nkind = \"pdcc\"\ntarget = \"cortex_m4\"",
                "State core_clock if your core is faster, lower f_pwm, raise pwm_per_control, or choose a controller with a shorter step: `hexagen advise` compares them. A core with a cache or a prefetch buffer may hold the period nevertheless: measure it.",
            ),
            Self::TripNearSetPoint => say(
                "A step of the set-point overshoots by up to 5 %, the current ripples, and the zeros of the sensors drift. A trip level less than 15 % above the largest set-point's peak may be reached without a fault. By default it is twice the set-point, but at most what the current sensors show.",
                "bus_voltage = \"48 V\"\nmax_current = \"36 A\"",
                "bus_voltage = \"48 V\"\nmax_current = \"30 A\"",
                "Lower max_current, or take sensors that reach farther: by adc_range, or by a smaller shunt or amplifier_gain.",
            ),
            Self::WeakeningEnds => say(
                "Field weakening takes the voltage omega L I from the EMF, with I at most max_current. At high speed that no longer brings the voltage within the bus: the motor brakes, whatever the set-point. A motor of small inductance has little to gain.",
                "bus_voltage = \"48 V\"\nmaximum_speed = \"4500 rpm\"\nbus_clamp = \"80 V\"\nkind = \"pdcc\"\nfield_weakening = \"on\"",
                "bus_voltage = \"48 V\"\nmaximum_speed = \"3200 rpm\"\nbus_clamp = \"80 V\"\nkind = \"pdcc\"\nfield_weakening = \"on\"",
                "Lower maximum_speed to the speed in the message, or raise max_current if motor and sensors bear it.",
            ),
            Self::ConstantsApart => say(
                "Two fields state one EMF constant, each with its basis, and they differ by more than a data sheet rounds: a basis is probably not what the sheet means.",
                "emf_shape = \"sinusoidal\"\nback_emf = \"0.1648 V/(rad/s) line_to_line peak\"\ntorque_constant = \"0.156 Nm/A per_peak_ampere\"",
                "emf_shape = \"sinusoidal\"\nback_emf = \"0.1648 V/(rad/s) line_to_line peak\"\ntorque_constant = \"0.156 Nm/A block_mean\"",
                "Look up in the data sheet of which current or voltage the constants are, and write those bases; where it does not say, leave out the constant that you trust less.",
            ),
            Self::BasisByAgreement => say(
                "No constant says its basis, and only under one reading do they state one EMF constant. The drive is generated with that reading.",
                "emf_shape = \"sinusoidal\"\nspeed_constant = \"58 rpm/V\"\ntorque_constant = \"0.1646 Nm/A\"",
                "emf_shape = \"sinusoidal\"\nspeed_constant = \"58 rpm/V block_mean\"\ntorque_constant = \"0.1646 Nm/A block_mean\"",
                "Look up in the data sheet of which voltage and current the constants are, and write those bases. Where several readings or none bring the constants together, this is the error HX0205.",
            ),
            Self::UnlikelyInertia => say(
                "The inertia times the rated speed over the rated torque is the time from rest to rated speed. A bare rotor takes some milliseconds, a vehicle some seconds: a time far from both is rather a wrong unit. Data sheets state inertias in g cm2, kg cm2 and kg m2, a thousand and ten thousand apart; what a gear moves counts by the square of its ratio.",
                "bus_voltage = \"48 V\"\ninertia = \"24 kg m2\"",
                "bus_voltage = \"48 V\"\ninertia = \"24 kg cm2\"",
                "Look up the unit in the data sheet, and state the inertia of the rotor and of what it moves. If it is right, let the warning be.",
            ),
            Self::CurrentFarAboveRated => say(
                "The copper loss rises with the square of the current: at five times the rated current it is 25 times that of the rating. Nothing in the drive counts how long the windings bear it, so such a value is rather a wrong power of ten.",
                "hall_timer_clock = \"1 MHz\"\nrated_current = \"5 A peak\"\nmax_current = \"25 A\"",
                "hall_timer_clock = \"1 MHz\"\nrated_current = \"5 A peak\"\nmax_current = \"10 A\"\ndead_time = \"300 ns\"",
                "Lower max_current to what the windings bear, or correct rated_current. If short peaks are meant, let the application limit their time.",
            ),
            Self::GainUnlikeBoard => say(
                "A field of the motor's file replaces the gain of the board's current sensors, and the two differ by more than a factor of two. With the wrong one every current is off by that factor: the true torque is a multiple or a part of what is asked, and the trip level moves with it.",
                "board = \"vesc-4\"\nadc_range = \"40 A\"",
                "board = \"vesc-4\"",
                "Measure the gain with a meter in a phase, or remove the field. A board with other sensors than the library's is described in a file of its own.",
            ),
            Self::TripByBraking => say(
                "A motor that brakes drives its current into the bus and raises its voltage. A full battery of lithium cells already stands 17 % above its nominal voltage, and a supply that takes no current rises at once. Where the drive trips so near, braking ends in OverVoltage with all legs off: a vehicle then rolls on.",
                "v_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"80 V\"\nbus_max = \"54 V\"",
                "v_bus = \"measured\"\nbus_adc_bits = 12\nbus_adc_range = \"80 V\"\nbus_max = \"54 V\"\nbraking_fade = \"3 V\"",
                "State a braking_fade, which takes braking torque back below the trip level, or raise bus_max or over_voltage if switches and capacitors bear it. A return_current_limit holds the mean current alone. Near the trip level a fade leaves no braking torque either, without a trip: with a full battery a vehicle needs a mechanical brake or a chopper.",
            ),
            Self::StallBeforeStart => say(
                "From rest the greatest torque takes the square root of 2 angle inertia/torque to turn the rotor by an angle. If the stall time-out ends before that has turned it through a Hall sector, a start from the far edge of a sector trips with Stall, whatever the load.",
                "inertia = \"24 kg cm2\"\nstall_timeout = \"10 ms\"",
                "inertia = \"24 kg cm2\"\nstall_timeout = \"500 ms\"",
                "Give the time-out some times the time of the fastest start: a load, friction and a smaller set-point make a start longer. 0 s turns stall detection off.",
            ),
            Self::SampledHalls => say(
                "Without a timer a Hall edge is seen at the next sample, up to a control period late. The rotor's angle jumps by what it turns in that time, and reference and EMF jump with it: the more so the less inductance the motor has. A timer that captures the edges tells when they came.",
                "bus_voltage = \"100 V\"\nrated_speed = \"4000 rpm\"",
                "bus_voltage = \"100 V\"\nrated_speed = \"4000 rpm\"\nhall_timer_clock = \"1 MHz\"",
                "Let a timer capture the Hall edges, and state its clock as hall_timer_clock; or raise f_pwm, so that the rotor turns less in a period.",
            ),
            Self::LongControlPeriod => say(
                "At rated speed the rotor turns by more than 15 electrical degrees in a control period, or the bus changes the current in a PWM period by more than five times the rated one. A voltage that is computed once a period no longer fits the EMF by then, or the pulses' own ripple is larger than the current.",
                "resistance = \"20 mohm per_phase\"\ninductance = \"10 uH per_phase\"\nhall_timer_clock = \"1 MHz\"\ndead_time = \"500 ns\"",
                "resistance = \"20 mohm per_phase\"\ninductance = \"10 uH per_phase\"\nhall_timer_clock = \"1 MHz\"\ndead_time = \"500 ns\"\nf_pwm = \"40 kHz\"",
                "Raise f_pwm to what the text names, or lower pwm_per_control, if the core is fast enough; a step's time stands in the data sheet. A bus of less voltage changes the current less.",
            ),
            Self::NoDeadTime => say(
                "Between switching one transistor off and the other on an inverter waits for its dead time, and meanwhile the current chooses the voltage. With a small inductance even a microsecond of that moves the current by a share that is felt as ripple and lost torque. The drive compensates it, but only a dead time that it knows.",
                "inductance = \"50 uH per_phase\"\nhall_timer_clock = \"1 MHz\"",
                "inductance = \"50 uH per_phase\"\nhall_timer_clock = \"1 MHz\"\ndead_time = \"500 ns\"",
                "State the dead time that the timer or the gate driver inserts. A board of the library brings it.",
            ),
            _ => say(
                "The generator broke one of its own rules: a bug of this program, not of the specification.",
                "any specification",
                "none",
                "Please report it with the motor file and the whole message.",
            ),
        }
    }
}
