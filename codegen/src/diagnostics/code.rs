//! The codes of all diagnostics. A code keeps its number for good; new ones are appended.

use std::fmt;

macro_rules! codes {
    ($($(#[$doc:meta])* $name:ident = $number:literal,)*) => {
        /// The kind of an error. 01xx: structure, 02xx: values, 03xx: motor and inverter,
        /// 04xx: controller, 05xx: design and formats, 06xx: warnings, 09xx: internal errors.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {
            $($(#[$doc])* $name,)*
        }

        impl Code {
            /// Every code, by number.
            pub const ALL: &'static [Self] = &[$(Self::$name,)*];

            /// Whether it is a warning: the drive is generated nevertheless.
            pub fn is_warning(self) -> bool {
                self.number() / 100 == 6
            }

            /// The number behind `HX`.
            pub fn number(self) -> u16 {
                match self {
                    $(Self::$name => $number,)*
                }
            }
        }
    };
}

codes! {
    /// The macro call or the TOML file cannot be parsed.
    Syntax = 101,
    /// A section that does not exist.
    UnknownSection = 102,
    /// A field that does not exist in its section.
    UnknownField = 103,
    /// A field or section given twice.
    DuplicateField = 104,
    /// A field without default is missing.
    MissingField = 105,
    /// A section is missing.
    MissingSection = 106,
    /// A field stands in the wrong section.
    MisplacedField = 107,
    /// A motor or board file cannot be read or its path is not relative.
    MotorFile = 108,
    /// The drive's name is not a type name.
    InvalidName = 109,
    /// Two fields that say the same thing.
    ExclusiveFields = 110,
    /// A field that another field's value requires or excludes.
    DependentField = 111,
    /// A board that the library does not have.
    UnknownBoard = 112,
    /// A value that cannot be read.
    MalformedValue = 201,
    /// A unit that does not exist.
    UnknownUnit = 202,
    /// A unit of another quantity.
    WrongDimension = 203,
    /// A number without unit.
    MissingUnit = 204,
    /// A value without its basis (per phase, line to line, peak).
    MissingBasis = 205,
    /// A basis that the value cannot have.
    WrongBasis = 206,
    /// A word that the field does not take.
    UnknownWord = 207,
    /// A number where a word is expected, or the reverse.
    WrongKind = 208,
    /// Zero or negative where a positive value is expected.
    NotPositive = 209,
    /// A value outside its plausible limits.
    OutOfRange = 210,
    /// Hall codes that do not form a Hall sequence.
    HallCodes = 211,
    /// A unit on a plain number.
    UnwantedUnit = 212,
    /// A unit that says one of two quantities.
    AmbiguousUnit = 213,
    /// Data of an EMF shape that no motor has, or that contradict each other.
    EmfShape = 214,
    /// The control period is too long for L/R.
    PeriodTooLong = 301,
    /// The bus cannot drive the motor at rated speed.
    BusTooLow = 302,
    /// Rated torque, rated current and EMF constant contradict each other.
    TorqueContradiction = 303,
    /// Torque constant and EMF constant contradict each other.
    TorqueConstantContradiction = 304,
    /// The current sensors do not reach the rated current.
    AdcRangeTooSmall = 305,
    /// The trip current lies outside the current sensors' range.
    TripAboveAdcRange = 306,
    /// The largest set-point reaches the trip current.
    MaxCurrentAboveTrip = 307,
    /// Timer clock and PWM frequency give too few or too many timer counts.
    TimerPeriod = 308,
    /// The Hall capture timer does not fit the control period.
    HallTimer = 309,
    /// A sector at the minimum speed lasts longer than the Hall timer counts.
    MinimumSpeed = 310,
    /// Speeds that are out of order.
    SpeedOrder = 311,
    /// Too few control periods in an electrical turn.
    TooFewPeriods = 312,
    /// The bus measurement does not fit its limits.
    BusMeasurement = 313,
    /// The commutation threshold does not fit the currents.
    CommutationThreshold = 314,
    /// The dead time takes too much of the period.
    DeadTime = 315,
    /// The ADC offset leaves no room.
    AdcOffset = 316,
    /// An ADC count is too coarse for the quantity measured.
    AdcTooCoarse = 317,
    /// Speed constant or no-load speed and EMF constant contradict each other.
    SpeedContradiction = 318,
    /// The sensing window takes too much of the PWM period.
    SensingWindow = 319,
    /// The least low time takes too much of the PWM period.
    MinimumLowTime = 320,
    /// A list that does not hold a value of each sensed phase.
    SensedPhases = 321,
    /// Gains of two current sensors that differ too much.
    UnlikeGains = 322,
    /// An over-speed that a run at rated speed may reach, or that is not measured.
    OverSpeed = 323,
    /// A stall time-out within which a ramp of the speed may reverse without a Hall edge.
    StallTimeout = 324,
    /// A speed at which the EMF exceeds the bus, with field weakening.
    EmfAboveBus = 325,
    /// A bus voltage that the board is not made for.
    OutsideOfBoard = 330,
    /// A controller that does not exist.
    UnknownController = 401,
    /// An option of a controller that does not exist in this version.
    OptionUnavailable = 402,
    /// An option of another controller.
    OptionOfOtherController = 403,
    /// An option that has no effect beside another one.
    OptionWithoutEffect = 404,
    /// A controller variant on the command line that cannot be read.
    Variant = 405,
    /// One voltage vector changes the current by more than the rated current.
    VectorTooStrong = 406,
    /// A hysteresis band that cannot work.
    Band = 407,
    /// A switching table that cannot be read.
    SwitchingTable = 408,
    /// Two sensors in the low legs cannot see the current of a leg that is off.
    UnreadableLeg = 409,
    /// Legs cannot turn on and off within a period.
    IntervalsUnavailable = 410,
    /// The inductance may lie outside the loop's stable range.
    InductanceOutsideStableRange = 501,
    /// The resistance may lie outside the loop's stable range.
    ResistanceOutsideStableRange = 502,
    /// The loop is unstable with the nominal motor.
    Unstable = 503,
    /// A signal or coefficient does not fit the word.
    WordTooNarrow = 504,
    /// A switching table that loses control of the current.
    SwitchingTableLosesCurrent = 601,
    /// The EMF turns too far per control period for its estimate.
    EstimateTurnsTooFar = 602,
    /// A mean over block commutation was probably taken for a peak.
    MeanForPeak = 603,
    /// At rated speed the bus leaves part of the rated current.
    RatingBeyondBus = 604,
    /// The trip current is far above the largest set-point.
    TripFarAbove = 610,
    /// Hysteresis control may reach the trip current without a fault.
    SwingAboveTrip = 611,
    /// The residual watch allows for more than faults cause.
    WatchIsBlind = 613,
    /// A step may take longer than the control period.
    StepExceedsPeriod = 614,
    /// Overshoot and ripple may reach the trip current without a fault.
    TripNearSetPoint = 615,
    /// A speed at which field weakening no longer holds the EMF within the bus.
    WeakeningEnds = 616,
    /// Two constants that state their bases differ by more than data sheets round.
    ConstantsApart = 617,
    /// An inertia with which the rated torque takes an unlikely time to rated speed.
    UnlikelyInertia = 618,
    /// Constants without basis that agree under one reading, which is taken.
    BasisByAgreement = 619,
    /// Hall edges that are seen at samples only make the torque ripple.
    SampledHalls = 620,
    /// A largest set-point of many times the rated current.
    CurrentFarAboveRated = 621,
    /// A gain of the current sensors far from that of the board.
    GainUnlikeBoard = 622,
    /// A bus voltage near the nominal one trips a drive whose braking torque nothing takes back.
    TripByBraking = 623,
    /// A stall time-out shorter than the motor's fastest start.
    StallBeforeStart = 624,
    /// A control period that is too long for the motor's speed or inductance.
    LongControlPeriod = 625,
    /// A dead time that is not stated, and that would be felt.
    NoDeadTime = 626,
    /// An internal error of the generator.
    Internal = 901,
}

/// `HX0203`.
impl fmt::Display for Code {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "HX{:04}", self.number())
    }
}

#[cfg(test)]
mod tests {
    use super::Code;

    #[test]
    fn numbers_are_unique_and_ascend() {
        assert!(
            Code::ALL
                .windows(2)
                .all(|pair| pair[0].number() < pair[1].number())
        );
        assert_eq!(Code::WrongDimension.to_string(), "HX0203");
    }
}
