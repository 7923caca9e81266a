//! The interface of a controller's law to the generator.

use super::current_loop::{LinearLoop, LoopDesign, StableRange};
use crate::blocks::Scale;
use crate::diagnostics::significant;
use crate::interface::PublicConstant;
use crate::scaling::Lowered;
use crate::spec::controller::with_options;
use crate::spec::{ControllerSpec, EmfSource, Spec};

/// A controller's law: implemented by its options.
pub trait Law: Sync {
    /// The program at a scale.
    fn lower(&self, spec: &Spec, design: &LoopDesign, scale: Scale) -> Lowered;

    /// Documentation of the method. `stable`: the stable range of a linear loop.
    fn describe(
        &self,
        spec: &Spec,
        design: &LoopDesign,
        stable: Option<StableRange>,
    ) -> Description;

    /// Voltage in a control period.
    fn period(&self) -> Period;

    /// The closed loop between limits, with the coefficients of `design`; none if the law is not
    /// linear.
    fn linear<'a>(
        &'a self,
        spec: &'a Spec,
        design: &'a LoopDesign,
    ) -> Option<Box<dyn LinearLoop + 'a>>;

    /// Whether the law uses an estimated or modelled EMF.
    fn uses_emf(&self) -> bool {
        true
    }

    /// Start on a turning rotor. `slow`: the estimate's filter is slower than the EMF turns.
    fn start(&self, slow: bool) -> Start {
        let _ = slow;
        Start::default()
    }

    /// Whether the law is known to lose the current on some motors.
    fn loses_current(&self) -> bool {
        false
    }

    /// The option to change if the loop is unstable.
    fn unstable_by(&self, spec: &Spec) -> Cause {
        Cause {
            field: "emf_filter",
            value: significant(spec.controller.common().emf_filter),
            remedy: "choose another value or `emf: model`",
        }
    }

    /// Remedy that widens the stable range.
    fn steadier(&self, spec: &Spec) -> &'static str {
        let options = spec.controller.common();
        match options.emf {
            EmfSource::Estimated if options.emf_filter >= 1.0 => {
                "choose `emf: model`, an `emf_filter` below 1,"
            }
            EmfSource::Held => "choose `emf: estimated` or `emf: model`",
            EmfSource::Estimated | EmfSource::Observer => "choose `emf: model`",
            EmfSource::Model => "shorten the control period",
        }
    }
}

/// The law of a controller.
pub fn law(controller: &ControllerSpec) -> &dyn Law {
    with_options!(controller, options => options)
}

/// Documentation of the method.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Name of the method, for titles: "Predictive deadbeat current controller".
    pub title: &'static str,
    /// Tuning, or criterion of the choice: Markdown lines.
    pub notes: Vec<String>,
    /// Range of R and L in which a linear loop is stable.
    pub stable: Option<StableRange>,
    /// Tables of the method.
    pub constants: Vec<PublicConstant>,
}

/// Voltage in a control period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Period {
    /// Pulses, any voltage of the hexagon.
    Pulses,
    /// Two neighbouring vectors and a zero vector, any voltage of their hexagon.
    Intervals,
    /// Two vectors, each for a part of the period.
    TwoVectors,
    /// One vector.
    OneVector,
}

/// Behaviour of a law that starts on a turning rotor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Largest line EMF at which the law holds the current, as a part of the bus.
    pub part_of_bus: f64,
    /// Additional current besides the step of a vector, ampere.
    pub current: f64,
    /// Whether an integral has to learn the EMF, and overshoots.
    pub integrates: bool,
    /// Whether a leg floats, so that its EMF is not seen.
    pub hides_leg: bool,
}

impl Default for Start {
    fn default() -> Self {
        Self {
            part_of_bus: 1.0,
            current: 0.0,
            integrates: false,
            hides_leg: false,
        }
    }
}

/// The option behind an unstable loop.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    /// Its name.
    pub field: &'static str,
    /// Its value.
    pub value: String,
    /// What to change.
    pub remedy: &'static str,
}
