//! Motor, controller and model of a command that runs a drive, for its JSON and its text.

use hexagen_lab::engine::{EngineKind, Model, Prepared};
use serde::Serialize;

/// Motor, controller and model of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Ran {
    /// Motor.
    pub motor: String,
    /// Controller variant.
    pub controller: String,
    /// Model that ran.
    pub model: Model,
    /// Engine of the fixed-point program; none for the references.
    pub engine: Option<EngineKind>,
}

impl Ran {
    /// A drive as a model of it runs.
    pub fn of(drive: &Prepared, model: Model) -> Self {
        Self {
            motor: drive.motor.clone(),
            controller: drive.variant.clone(),
            model,
            engine: (model == Model::Fixed).then(|| drive.engine_kind()),
        }
    }

    /// `hub, pdcc (fixed point)`
    pub fn name(&self) -> String {
        let Self {
            motor,
            controller,
            model,
            ..
        } = self;
        format!("{motor}, {controller} ({})", model.text())
    }
}
