//! Rotor angle and speed from an angle in every sample (semantics, step 4 with `rotor: angle`).

use super::Lowering;
use super::over_speed::OverSpeedWatch;
use super::rotor::{Rotor, SpeedWord};
use crate::diagnostics::rpm;
use crate::ir::{Expr, Interval, Memory, named};
use crate::spec::AngleSensor;

/// State words of the speed.
#[derive(Clone, Copy, Debug)]
pub struct AngleWords<'b> {
    sensor: AngleSensor,
    theta_prev: Memory<'b>,
    angles: Memory<'b>,
    step_angle: Memory<'b>,
    over_speed: Option<OverSpeedWatch<'b>>,
}

/// Angles behind which nothing is left of the first difference: three time constants of the filter.
fn settled(l: &Lowering, sensor: AngleSensor) -> i64 {
    3 << l.spec.speed_filter(sensor)
}

impl<'b> AngleWords<'b> {
    /// Declares the state words.
    pub fn new(l: &Lowering<'b>, sensor: AngleSensor) -> Self {
        let most = i64::from(l.spec.greatest_turn(sensor));
        let whole = Interval::new(i64::from(i32::MIN), i64::from(i32::MAX));
        let word = |name, interval, doc| l.b.memory(name, 0, interval, doc);
        Self {
            sensor,
            theta_prev: word("theta_prev", whole, "Electrical angle of the last sample."),
            angles: word(
                "angles",
                Interval::new(0, settled(l, sensor)),
                "Angles seen, up to those of three time constants of the filter: one tells the place, two the speed.",
            ),
            step_angle: word(
                "step_angle",
                Interval::symmetric(most),
                "Electrical angle per control period, filtered, 2^32 a turn; 0 while unknown.",
            ),
            over_speed: OverSpeedWatch::new(l),
        }
    }

    /// Angle and speed of a sample.
    pub fn track(&self, l: &Lowering<'b>, theta: Expr<'b>) -> Rotor<'b> {
        let meaning = "electrical angle, base one turn; speed per period";
        l.format("omega", 32, 32, crate::interface::Rounding::Floor, meaning);
        l.b.stage(
            "measure_speed",
            &[
                "Speed from the angle's differences, the first one as it is, later ones through a low-pass filter: a step of",
                "the sensor is no speed.",
            ],
        );
        let doc = "Greatest difference of two angles that is believed: beyond the greatest speed.";
        let most = l.number(
            "turn_max",
            i64::from(l.spec.greatest_turn(self.sensor)),
            doc,
        );
        let doc = "Angles of three time constants of the filter: nothing is left of the first difference.";
        let enough = l.number("angles_settled", settled(l, self.sensor), doc);
        let (seen, step) = (self.angles.read(), self.step_angle.read());
        named! {
            let turned = theta.angle_sub(self.theta_prev.read()).within(most);
            // Intervals do not show that it lies between the two.
            let filtered = (step + ((turned - step) >> l.spec.speed_filter(self.sensor))).within(most);
            let first = seen.is(1).choose(turned, 0);
            let step_angle_next = seen.is_at_least(2).choose(filtered, first);
            let angles_next = (seen + 1).min(enough);
            let tracking = angles_next.is_at_least(2);
            let backward = step_angle_next.is_below(0).choose(-1, 0);
            let direction_next = step_angle_next.is_above(0).choose(1, backward);
        }
        self.theta_prev.set(theta);
        self.angles.set(angles_next);
        self.step_angle.set(step_angle_next);
        if let Some((watch, most)) = self.over_speed.zip(l.spec.over_speed_step()) {
            let speed = rpm(l.spec.inverter.over_speed.unwrap_or_default());
            let doc = format!("Electrical angle per control period at the over-speed, {speed}.");
            let limit = l.number("over_speed_step", i64::from(most), &doc);
            // The first difference may be wrong, as the first reading of a sensor often is, and the filter keeps it.
            let is_settled = seen.is_at_least(enough);
            watch.count(is_settled & step_angle_next.abs().is_above(limit));
        }
        Rotor {
            direction: direction_next,
            theta,
            step_angle: step_angle_next,
            tracking,
            speed: SpeedWord::ByAngles(step_angle_next),
        }
    }
}
