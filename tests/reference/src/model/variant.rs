//! Steps and state words of a variant, for both models.

use crate::Error;
use crate::emf_shape::EmfShape;
use crate::spec::{
    Bus, Candidates, CommutationEnd, Controller, EmfSource, LoopOptions, Modulation, OffLeg, PiPwm,
    Reference, Saturation, Spec, Switch,
};

/// Consequences of the choice of controller and options.
#[derive(Clone, Copy, Debug)]
pub struct Variant {
    /// The options of all controllers.
    pub options: LoopOptions,
    /// Section 4: the rotor's angle is interpolated.
    pub rotor: bool,
    /// Section 5: commutations are tracked, and their end.
    pub commutation: Option<CommutationEnd>,
    /// Section 8: source of the EMF, if the variant uses it.
    pub emf: Option<EmfSource>,
    /// Section 9: contributions of past periods to the voltage are combined, with a held EMF.
    pub held: Switch,
    /// Section 9 of PHCC: the contributions of past periods contain the directions' memory.
    pub wishes_in_due: Switch,
    /// Section 11: the command has intervals, by the paper's modulator.
    pub intervals: Switch,
    /// Section 7: a leg may be off, so commands are kept as terminal voltages.
    pub floating: bool,
    /// Section 7: the voltage of the period that starts now is known.
    pub applied_now: bool,
    /// Section 10a: two vectors share the period.
    pub modulated: Switch,
    /// Section 10w: changes of leg states have a cost.
    pub counts_changes: Switch,
    /// Section 11: compare values are shifted to compensate the dead time.
    pub dead_time: Switch,
    /// PI: whether there is one controller for the pair, or one per axis.
    pub six_step: Option<Switch>,
    /// Section 9 of PI: the voltage that turns the reference is fed forward.
    pub turning: Switch,
    /// Section 10: the saturation rule, if the voltage can exceed the hexagon.
    pub saturation: Option<Saturation>,
}

impl Variant {
    /// Whether the command has intervals.
    pub fn has_intervals(&self) -> bool {
        self.intervals == Switch::On
    }

    pub fn new(spec: &Spec) -> Self {
        let options = spec.loop_options();
        let (mut emf, mut predicts) = (Some(options.emf), true);
        let mut modulated = Switch::Off;
        let mut counts_changes = Switch::Off;
        let mut dead_time = Switch::Off;
        let mut has_intervals = false;
        let (commutates, floating, saturation) = match &spec.controller {
            Controller::Pdcc(pdcc) => {
                let pair = pdcc.modulation == Modulation::Pair;
                has_intervals = pdcc.modulation == Modulation::Table2;
                dead_time = pdcc.dead_time_compensation;
                (pair || has_intervals, pair, Some(pdcc.saturation))
            }
            Controller::FcsMpc(fcs_mpc) => {
                let pairs = fcs_mpc.candidates != Candidates::ThreePhase;
                modulated = fcs_mpc.modulated;
                if modulated == Switch::Off && fcs_mpc.switching_weight > 0.0 {
                    counts_changes = Switch::On;
                }
                (pairs, pairs && fcs_mpc.off_leg == OffLeg::Physical, None)
            }
            Controller::Phcc(phcc) => {
                // Without a delay nothing is predicted.
                predicts = options.delay == 1;
                if !predicts {
                    emf = None;
                }
                let physical =
                    phcc.candidates == Candidates::Table2 && phcc.off_leg == OffLeg::Physical;
                (true, predicts && physical, None)
            }
            Controller::PiPwm(pi_pwm) => {
                predicts = false;
                dead_time = pi_pwm.dead_time_compensation;
                if pi_pwm.feed_forward == Switch::Off {
                    emf = None;
                }
                let hexagon = pi_pwm.six_step == Switch::Off;
                has_intervals = pi_pwm.modulation == Modulation::Table2;
                (has_intervals, false, hexagon.then_some(pi_pwm.saturation))
            }
            Controller::PPwm(p_pwm) => {
                predicts = false;
                (false, false, Some(p_pwm.saturation))
            }
        };
        let held = emf == Some(EmfSource::Held);
        if held {
            (emf, predicts) = (None, false);
        }
        let is_phcc = matches!(spec.controller, Controller::Phcc(_));
        let has_fixed_bus = spec.inverter.bus == Bus::Fixed;
        Self {
            options,
            rotor: matches!(emf, Some(EmfSource::Model | EmfSource::Observer))
                || options.advance > 0.0
                || options.reference == Reference::Proportional
                || options.has_speed_loop()
                || spec.inverter.over_speed_turn.is_some()
                || spec.inverter.over_speed_step.is_some(),
            commutation: spec.commutation_end().filter(|_| commutates),
            emf,
            held: if held { Switch::On } else { Switch::Off },
            wishes_in_due: if held && is_phcc && has_fixed_bus {
                Switch::On
            } else {
                Switch::Off
            },
            floating,
            intervals: if has_intervals {
                Switch::On
            } else {
                Switch::Off
            },
            applied_now: options.delay == 1
                && (predicts || matches!(emf, Some(EmfSource::Estimated | EmfSource::Observer))),
            modulated,
            counts_changes,
            dead_time,
            six_step: match &spec.controller {
                Controller::PiPwm(pi_pwm) => Some(pi_pwm.six_step),
                _ => None,
            },
            turning: match &spec.controller {
                Controller::PiPwm(pi_pwm) if turns(pi_pwm, options.reference) => Switch::On,
                _ => Switch::Off,
            },
            saturation,
        }
    }

    /// Section 11: legs are pulsed for a fraction of the period.
    pub fn pulsed(&self) -> bool {
        self.saturation.is_some()
            || self.modulated == Switch::On
            || self.six_step == Some(Switch::On)
    }

    /// A command takes effect one period after its sample.
    pub fn delayed(&self) -> bool {
        self.options.delay == 1
    }

    /// Section 8: the EMF is estimated and filtered.
    pub fn filtered(&self) -> bool {
        self.estimated() && self.options.emf_filter < 1.0
    }

    /// Section 8: the EMF is estimated from the last period.
    pub fn estimated(&self) -> bool {
        self.emf == Some(EmfSource::Estimated)
    }

    /// Section 8: the observed EMF of the last period is used.
    pub fn sees(&self) -> bool {
        self.estimated() || self.observes()
    }

    /// Section 9: contributions of past periods to the voltage are combined, with a held EMF.
    pub fn holds(&self) -> bool {
        self.held == Switch::On
    }

    /// Section 9 of PHCC: the contributions of past periods contain the directions' memory.
    pub fn folds_wishes(&self) -> bool {
        self.wishes_in_due == Switch::On
    }

    /// Section 8: the error of the modelled EMF is observed.
    pub fn observes(&self) -> bool {
        self.emf == Some(EmfSource::Observer)
    }

    /// Section 9 of PI: the voltage that turns the reference is fed forward.
    pub fn turns_reference(&self) -> bool {
        self.turning == Switch::On
    }

    /// Section 6: the shape of the proportional reference takes part.
    pub fn shaped(&self) -> bool {
        self.options.reference == Reference::Proportional || self.observes()
    }

    /// Section 11: compare values are shifted to compensate the dead time.
    pub fn compensates(&self) -> bool {
        self.dead_time == Switch::On
    }

    /// Section 8: an off leg may leave a phase's EMF unobserved.
    pub fn unseen(&self) -> bool {
        self.estimated() && self.floating
    }

    /// Some step needs the voltage applied by a command (section 7).
    pub fn applied(&self) -> bool {
        self.applied_now || self.sees() || self.holds()
    }
}

/// A proportional reference turns in every period, and with feed-forward its voltage is known.
fn turns(pi_pwm: &PiPwm, reference: Reference) -> bool {
    pi_pwm.feed_forward == Switch::On && reference == Reference::Proportional
}

/// Voltage per ampere of the current reference: 1/b, or the proportional gain of a PI controller that does not
/// turn it.
pub fn reference_gain(spec: &Spec) -> f64 {
    let proportional = |bandwidth: f64| std::f64::consts::TAU * bandwidth * spec.motor.inductance;
    match &spec.controller {
        Controller::PPwm(p_pwm) => proportional(p_pwm.bandwidth),
        Controller::PiPwm(pi_pwm) if !turns(pi_pwm, spec.loop_options().reference) => {
            proportional(pi_pwm.bandwidth)
        }
        _ => 1.0 / crate::DiscretePhase::new(spec).b,
    }
}

/// Limit of a modelled EMF's error, timer counts: the least power of two that is not below half the
/// largest bus.
///
/// # Errors
/// When the bus is inconsistent.
pub fn emf_error_limit(spec: &Spec) -> Result<f64, Error> {
    Ok(saturated(spec, spec.inverter.v_bus_max()? / 2.0))
}

/// Largest plausible EMF, timer counts of voltage: a power of two.
pub fn emf_limit(spec: &Spec) -> f64 {
    saturated(
        spec,
        1.5 * spec.motor.emf_constant * spec.inverter.omega_max,
    )
}

/// Volts as timer counts, up to the next power of two.
fn saturated(spec: &Spec, volts: f64) -> f64 {
    let count = spec.inverter.v_bus / f64::from(spec.inverter.timer_period);
    (volts / count).log2().ceil().exp2()
}

/// Resistance, over the stated one, whose drop the EMF must exceed.
pub const LITTLE: f64 = 200.0;
/// Periods behind which the observed error has settled.
pub const SETTLED: f64 = 64.0;

/// Component along the shape that the observer makes of the EMF, V s per electrical radian.
pub fn flux_along(spec: &Spec, shape: &EmfShape) -> f64 {
    let motor = &spec.motor;
    let mean = shape.mean_inverse_square();
    1.5 * motor.emf_constant.powi(2) / (motor.torque_constant * mean) / f64::from(motor.pole_pairs)
}

/// Mean of 1/|f|^2 where the error of the observed EMF is corrected along the EMF's own shape (section 8).
pub fn stretch_mean(spec: &Spec, shape: EmfShape) -> Option<f64> {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let least = shape.squared_lengths().fold(f64::INFINITY, f64::min);
    let most = shape.squared_lengths().fold(0.0, f64::max);
    let moved = motor.emf_constant * inverter.omega_max * inverter.t_s / motor.inductance;
    let is_stretched = (most / least - 1.0) * moved / inverter.max_current > 0.15;
    is_stretched.then(|| shape.mean_inverse_square())
}

/// Residual allowed by the residual watch: volt always, volt per ampere of the set-point, volt per
/// electrical radian per second, and in its place volt while the angle is unknown.
pub fn allowed_residual(spec: &Spec) -> [f64; 4] {
    let (motor, inverter) = (&spec.motor, &spec.inverter);
    let flux = motor.emf_constant / f64::from(motor.pole_pairs);
    let dead_time = inverter.v_bus * 1.5e-6 / inverter.pwm_period();
    let waits = f64::from(inverter.start_periods) * inverter.t_s;
    let fastest = if waits > 0.0 {
        2.0 * motor.widest_sector() / waits
    } else {
        f64::from(motor.pole_pairs) * inverter.omega_max
    };
    [
        4.0 / 3.0 * dead_time,
        1.6 * motor.resistance,
        0.5 * flux + 0.7 * motor.inductance * inverter.max_current,
        1.5 * flux * fastest,
    ]
}
