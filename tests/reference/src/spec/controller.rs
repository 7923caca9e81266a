//! The controllers and their options.

use serde::Deserialize;

/// A controller and its options.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Controller {
    /// Predictive deadbeat current control.
    Pdcc(Pdcc),
    /// Finite-control-set model predictive control.
    FcsMpc(FcsMpc),
    /// Predictive hysteresis current control.
    Phcc(Phcc),
    /// PI control with pulse-width modulation.
    PiPwm(PiPwm),
    /// Proportional control with pulse-width modulation.
    PPwm(PPwm),
}

/// Options of all controllers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopOptions {
    /// Source of the EMF.
    pub emf: EmfSource,
    /// Weight of a new EMF estimate, above 0 to 1 (1: no filter).
    pub emf_filter: f64,
    /// Shape of the current reference.
    pub reference: Reference,
    /// Phase advance, periods of electrical angle.
    pub advance: f64,
    /// Periods between sampling and the command's effect, 0 or 1.
    pub delay: u32,
    /// Discretisation of the plant.
    pub discretisation: Discretisation,
    /// Word length, 16 or 32 bits.
    pub word: u32,
    /// Bandwidth of the speed loop, hertz; 0 without one.
    pub speed_bandwidth: f64,
    /// Inertia of rotor and load, kg m2; with a speed loop.
    pub inertia: f64,
    /// Greatest rate of the speed set-point in force, rad/s2; 0 without one.
    pub acceleration_limit: f64,
    /// Greatest rate of the current set-point in force, A/s; 0 without one.
    pub slew_rate: f64,
    /// Time-out of the residual watch, control periods; 0 where the currents are not watched.
    pub residual_periods: u32,
    /// Whether the reference turns against the field where the voltage ends.
    pub field_weakening: Switch,
    /// Whether the places of the Hall sensors are learnt.
    pub hall_learning: Switch,
    /// Whether the torque constant is learnt.
    pub torque_learning: Switch,
}

impl LoopOptions {
    /// A speed controller provides the current set-point.
    pub fn has_speed_loop(&self) -> bool {
        self.speed_bandwidth > 0.0
    }
}

/// End of a commutation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CommutationEnd {
    /// Outgoing current that ends it, ampere.
    pub threshold: f64,
    /// Time-out, periods.
    pub timeout: u32,
}

/// Declares a controller's options: the common ones, and its own.
macro_rules! options {
    ($(#[$about:meta])* $name:ident { $($(#[$doc:meta])* $field:ident: $kind:ty,)* }) => {
        $(#[$about])*
        #[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
        #[serde(deny_unknown_fields)]
        pub struct $name {
            /// Source of the EMF.
            pub emf: EmfSource,
            /// Weight of a new EMF estimate, above 0 to 1 (1: no filter).
            pub emf_filter: f64,
            /// Shape of the current reference.
            pub reference: Reference,
            /// Phase advance, periods of electrical angle.
            pub advance: f64,
            /// Periods between sampling and the command's effect, 0 or 1.
            pub delay: u32,
            /// Discretisation of the plant.
            pub discretisation: Discretisation,
            /// Word length, 16 or 32 bits.
            pub word: u32,
            /// Bandwidth of the speed loop, hertz; 0 without one.
            #[serde(default)]
            pub speed_bandwidth: f64,
            /// Inertia of rotor and load, kg m2; with a speed loop.
            #[serde(default)]
            pub inertia: f64,
            /// Greatest rate of the speed set-point in force, rad/s2; 0 without one.
            #[serde(default)]
            pub acceleration_limit: f64,
            /// Greatest rate of the current set-point in force, A/s; 0 without one.
            #[serde(default)]
            pub slew_rate: f64,
            /// Time-out of the residual watch, control periods; 0 where the currents are not watched.
            #[serde(default, rename = "residual_timeout")]
            pub residual_periods: u32,
            /// Whether the reference turns against the field where the voltage ends.
            #[serde(default)]
            pub field_weakening: Switch,
            /// Whether the places of the Hall sensors are learnt.
            #[serde(default)]
            pub hall_learning: Switch,
            /// Whether the torque constant is learnt.
            #[serde(default)]
            pub torque_learning: Switch,
            $($(#[$doc])* pub $field: $kind,)*
        }

        impl $name {
            pub(super) fn loop_options(&self) -> LoopOptions {
                LoopOptions {
                    emf: self.emf,
                    emf_filter: self.emf_filter,
                    reference: self.reference,
                    advance: self.advance,
                    delay: self.delay,
                    discretisation: self.discretisation,
                    word: self.word,
                    speed_bandwidth: self.speed_bandwidth,
                    inertia: self.inertia,
                    acceleration_limit: self.acceleration_limit,
                    slew_rate: self.slew_rate,
                    residual_periods: self.residual_periods,
                    field_weakening: self.field_weakening,
                    hall_learning: self.hall_learning,
                    torque_learning: self.torque_learning,
                }
            }
        }
    };
}

options! {
    /// Options of predictive deadbeat current control.
    Pdcc {
        /// Modulation of a voltage to leg commands.
        modulation: Modulation,
        /// Zero vector outside commutations, with intervals.
        #[serde(default)]
        zero: Zero,
        /// Saturation rule outside the hexagon.
        saturation: Saturation,
        /// Whether compare values are shifted to compensate the dead time.
        #[serde(default)]
        dead_time_compensation: Switch,
        /// Whether the prediction knows the rounding of compare values.
        #[serde(default)]
        rounding_prediction: Switch,
        /// Common mode of three pulsed legs.
        #[serde(default)]
        common_mode: CommonMode,
        /// Outgoing current that ends a commutation, ampere.
        commutation_threshold: f64,
        /// Commutation time-out, periods.
        commutation_timeout: u32,
    }
}

fn one() -> u32 {
    1
}

options! {
    /// Options of finite-control-set model predictive control.
    FcsMpc {
        /// The candidate vectors.
        candidates: Candidates,
        /// Assumed position of an off leg.
        off_leg: OffLeg,
        /// Whether a second vector shares the period.
        modulated: Switch,
        /// Horizon of the cost, 1 or 2 periods.
        #[serde(default = "one")]
        horizon: u32,
        /// Weight of a leg's change of state, as an error of current, ampere.
        #[serde(default)]
        switching_weight: f64,
        /// Weight of the square of the error's component along the sector's mean EMF.
        #[serde(default)]
        torque_weight: f64,
        /// Outgoing current that ends a commutation, ampere.
        commutation_threshold: f64,
        /// Commutation time-out, periods.
        commutation_timeout: u32,
    }
}

options! {
    /// Options of predictive hysteresis current control.
    Phcc {
        /// Source of the switching table.
        table: SwitchingTable,
        /// Hysteresis band of an error component, ampere.
        band: f64,
        /// The vectors of a derived table (`All`: none).
        candidates: Candidates,
        /// Assumed position of an off leg.
        off_leg: OffLeg,
        /// Outgoing current that ends a commutation, ampere.
        commutation_threshold: f64,
        /// Commutation time-out, periods.
        commutation_timeout: u32,
    }
}

options! {
    /// Options of PI control with pulse-width modulation.
    PiPwm {
        /// Bandwidth of the proportional loop, hertz: the gain is 2 pi times it times the
        /// inductance.
        bandwidth: f64,
        /// Integral time and tracking time of the anti-windup, seconds.
        integral_time: f64,
        /// Whether the EMF is added to the voltage.
        feed_forward: Switch,
        /// Whether one controller controls the conducting pair's current.
        six_step: Switch,
        /// Modulation of a voltage to leg commands.
        #[serde(default)]
        modulation: Modulation,
        /// Zero vector outside commutations, with intervals.
        #[serde(default)]
        zero: Zero,
        /// Outgoing current that ends a commutation, ampere; with intervals.
        #[serde(default)]
        commutation_threshold: f64,
        /// Commutation time-out, periods; with intervals.
        #[serde(default)]
        commutation_timeout: u32,
        /// Saturation rule outside the hexagon.
        saturation: Saturation,
        /// Whether compare values are shifted to compensate the dead time.
        #[serde(default)]
        dead_time_compensation: Switch,
        /// Common mode of three pulsed legs.
        #[serde(default)]
        common_mode: CommonMode,
    }
}

options! {
    /// Options of proportional control with pulse-width modulation.
    PPwm {
        /// Bandwidth of the loop, hertz: the gain is 2 pi times it times the inductance.
        bandwidth: f64,
        /// Saturation rule outside the hexagon.
        saturation: Saturation,
        /// Common mode of three pulsed legs.
        #[serde(default)]
        common_mode: CommonMode,
    }
}

/// The common mode of three pulsed legs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CommonMode {
    /// The extremes equally far from the ends of the period.
    #[default]
    Centred,
    /// Centred, but lowered as far as the highest leg requires.
    Readable,
    /// The lowest leg low throughout.
    ClampedLow,
}

/// The candidate vectors of FCS-MPC, or those of a switching table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Candidates {
    /// Those of three switched legs in commutation, else those of two (and their zero).
    Table2,
    /// Those of three switched legs.
    ThreePhase,
    /// All of both (FCS-MPC only).
    All,
}

/// Assumed position of an off leg with controllers of whole vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OffLeg {
    /// Determined by its diode or its EMF.
    Physical,
    /// In the middle of the two others.
    Nominal,
}

/// The switching table of PHCC.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "TableText")]
pub enum SwitchingTable {
    /// From the vectors' geometry.
    Derived,
    /// The paper's row of sector 1, rotated with the sector.
    Printed,
    /// Vector numbers for motoring forward: of each sector first the four without, then the four in
    /// commutation, each in the order of H_a, H_b (0 first).
    Given([u8; 48]),
}

/// As written.
#[derive(Deserialize)]
#[serde(untagged)]
enum TableText {
    Word(String),
    Numbers(Vec<u8>),
}

impl TryFrom<TableText> for SwitchingTable {
    type Error = String;

    fn try_from(text: TableText) -> Result<Self, String> {
        match text {
            TableText::Word(word) if word == "derived" => Ok(Self::Derived),
            TableText::Word(word) if word == "printed" => Ok(Self::Printed),
            TableText::Numbers(numbers) if numbers.iter().all(|number| *number < 16) => numbers
                .try_into()
                .map(Self::Given)
                .map_err(|numbers: Vec<u8>| {
                    format!(
                        "controller.table has {} numbers, expected 48",
                        numbers.len()
                    )
                }),
            _ => Err(
                "controller.table: expected derived, printed or 48 numbers of vectors, 0 to 15"
                    .into(),
            ),
        }
    }
}

/// An option that is on or off.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Switch {
    /// It is on.
    On,
    /// It is off.
    #[default]
    Off,
}

/// Modulation of a voltage to leg commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Modulation {
    /// Three duties in every period.
    #[default]
    ThreePhase,
    /// Three duties in commutation, else one pulsed leg of the conducting pair.
    Pair,
    /// Two neighbouring vectors and a zero vector: three-phase ones in commutation, else pair vectors.
    Table2,
}

/// Zero vector of intervals outside commutations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Zero {
    /// All legs low.
    #[default]
    AllLow,
    /// The sector's pair low, the third leg off.
    PairLow,
}

/// Saturation rule for voltages outside the hexagon.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Saturation {
    /// Scale to the edge.
    KeepAngle,
    /// Nearest point of the hexagon.
    Nearest,
    /// Keep the component along the EMF.
    TorquePriority,
}

/// Source of the EMF.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EmfSource {
    /// From the last period's voltage and currents.
    Estimated,
    /// From the motor's EMF shape at the interpolated Hall angle.
    Model,
    /// The modelled one plus its error, observed in the rotor frame.
    Observer,
    /// That of the last period, used as that of the target.
    Held,
}

/// Shape of the current reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reference {
    /// The sector's corner.
    QuasiSquare,
    /// Parallel to the EMF.
    Proportional,
}

/// Discretisation of the plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Discretisation {
    /// a = exp(-R Ts/L), b = (1 - a)/R.
    Exact,
    /// a = 1 - R Ts/L, b = Ts/L.
    Euler,
}
