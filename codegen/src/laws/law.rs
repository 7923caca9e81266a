//! What the generator asks of a controller's law.

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

    /// What the documentation of the type says of the method. `stable`: the range of a linear loop.
    fn describe(
        &self,
        spec: &Spec,
        design: &LoopDesign,
        stable: Option<StableRange>,
    ) -> Description;

    /// What a control period has.
    fn period(&self) -> Period;

    /// The closed loop between limits, with the coefficients of `design`; none of a law that is not linear.
    fn linear<'a>(
        &'a self,
        spec: &'a Spec,
        design: &'a LoopDesign,
    ) -> Option<Box<dyn LinearLoop + 'a>>;

    /// Whether it works with an EMF by itself, estimated or modelled.
    fn uses_emf(&self) -> bool {
        true
    }

    /// How it takes a rotor that turns when control begins. `slow`: the estimate's filter follows more slowly than the
    /// EMF turns.
    fn start(&self, slow: bool) -> Start {
        let _ = slow;
        Start::default()
    }

    /// Whether it is known to lose the current on some of the motors that it is generated for.
    fn loses_current(&self) -> bool {
        false
    }

    /// The option that an unstable loop follows from.
    fn unstable_by(&self, spec: &Spec) -> Cause {
        Cause {
            field: "emf_filter",
            value: significant(spec.controller.common().emf_filter),
            remedy: "choose another value or `emf: model`",
        }
    }

    /// What makes the loop stable on motors farther from the stated one.
    fn steadier(&self, spec: &Spec) -> &'static str {
        let options = spec.controller.common();
        match options.emf {
            EmfSource::Estimated if options.emf_filter >= 1.0 => {
                "choose `emf: model`, an `emf_filter` below 1,"
            }
            EmfSource::Held => "choose `emf: estimated` or `emf: model`",
            EmfSource::Estimated => "choose `emf: model`",
            EmfSource::Model => "shorten the control period",
        }
    }
}

/// The law of a controller.
pub fn law(controller: &ControllerSpec) -> &dyn Law {
    with_options!(controller, options => options)
}

/// What the documentation of a type says of its method.
#[derive(Clone, Debug, PartialEq)]
pub struct Description {
    /// Name of the method, for titles: "Predictive deadbeat current controller".
    pub title: &'static str,
    /// How it is tuned, or what its choice rests on: Markdown lines.
    pub notes: Vec<String>,
    /// Range of R and L in which a linear loop is stable.
    pub stable: Option<StableRange>,
    /// Tables of the method.
    pub constants: Vec<PublicConstant>,
}

/// What a control period has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Period {
    /// Pulses that make any voltage of the hexagon.
    Pulses,
    /// Two vectors, each for a part.
    TwoVectors,
    /// One vector.
    OneVector,
}

/// How a law takes a rotor that turns when control begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Part of the bus that the line EMF may have for the law to hold the current.
    pub part_of_bus: f64,
    /// Current that comes on top, beside what a vector adds, ampere.
    pub current: f64,
    /// Whether an integral has to find the EMF, and overshoots.
    pub integrates: bool,
    /// Whether a leg floats, and hides its EMF.
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

/// An option that something follows from.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    /// Its name.
    pub field: &'static str,
    /// Its value.
    pub value: String,
    /// What to do.
    pub remedy: &'static str,
}
