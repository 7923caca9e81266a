//! The voltage limit: a voltage outside the hexagon is brought to its edge (semantics, step 10).
//!
//! For phase voltages that sum to zero the hexagon is max - min <= V_BUS, so one comparison detects
//! saturation and all else is off the normal path.

use super::modulate::half_period;
use super::{Bus, CommonModeRule, Lowering};
use crate::interface::Rounding;
use crate::ir::{Coefficient, Expr, Flag, Interval, Named, Phases, named, pick};
use crate::spec::LimitRule;

/// A voltage inside the hexagon.
#[derive(Clone, Copy, Debug)]
pub struct Limited<'b> {
    /// Phase voltages a, b.
    pub u: Phases<'b>,
    /// Leg voltages: phase voltages less floor((max + min) / 2), or lifted to where their pulses lie if the hexagon
    /// has a `lift`.
    pub legs: Phases<'b, 3>,
    /// Whether they are lifted.
    pub is_lifted: bool,
    /// Whether the voltage was outside.
    pub cut: Flag<'b>,
    /// max - min of the phase voltages, at most the bus.
    pub spread: Expr<'b>,
}

/// A voltage before the limit.
#[derive(Clone, Copy, Debug)]
struct Free<'b> {
    /// Phase voltages.
    u: Phases<'b, 3>,
    /// max - min of the three.
    spread: Expr<'b>,
    /// max + min.
    extent: Expr<'b>,
    /// (max + min) / 2, rounded down.
    middle: Expr<'b>,
}

/// Rule of the voltage limit. `E`: the EMF, or a function that computes it.
#[derive(Clone, Copy, Debug)]
pub enum Priority<E> {
    /// Scale the voltage; its angle stays.
    Angle,
    /// Take the nearest point of the hexagon.
    Nearest,
    /// Keep the component along this EMF, which makes torque.
    Torque(E),
}

impl<E> Priority<E> {
    /// The rule of the specification; torque priority without an EMF becomes the nearest point.
    pub fn of(rule: LimitRule, emf: Option<E>) -> Self {
        match (rule, emf) {
            (LimitRule::KeepAngle, _) => Self::Angle,
            (LimitRule::TorquePriority, Some(emf)) => Self::Torque(emf),
            (LimitRule::TorquePriority, None) | (LimitRule::Nearest, _) => Self::Nearest,
        }
    }

    /// The same rule in another plane, to which `turn` brings the EMF.
    pub fn of_plane<'b>(
        self,
        turn: impl FnOnce(Phases<'b>) -> Phases<'b>,
    ) -> Priority<impl FnOnce() -> Phases<'b>>
    where
        E: FnOnce() -> Phases<'b>,
    {
        match self {
            Self::Angle => Priority::Angle,
            Self::Nearest => Priority::Nearest,
            Self::Torque(emf) => Priority::Torque(move || turn(emf())),
        }
    }
}

/// Fraction bits of the ratio in keep_angle, and bits of the bus in it: so it is one division of 32 bits.
const SCALE_BITS: u32 = 16;
/// Torque priority needs an EMF of at least V_BUS / 2^5.
const LEAST_EMF_BITS: u32 = 5;
/// Fraction bits of the blend towards the nearest point.
const BLEND_BITS: u32 = 15;

/// The hexagon of voltages that the bus can make.
#[derive(Clone, Copy, Debug)]
pub struct Hexagon<'b> {
    /// The bus.
    pub bus: Bus<'b>,
    /// 1/3.
    pub third: Coefficient,
    /// What lifts leg voltages to where their pulses lie.
    pub lift: Option<CommonModeRule>,
}

impl<'b> Hexagon<'b> {
    /// Limits the voltage `u_unsat` of phases a, b; the EMF is computed off the normal path.
    pub fn limit<E: FnOnce() -> Phases<'b>>(
        &self,
        l: &Lowering<'b>,
        priority: Priority<E>,
        u_unsat: Phases<'b>,
    ) -> Limited<'b> {
        let bus = self.bus.volts;
        let mut doc = vec!["Spread of the phase voltages; above the bus voltage the limit acts."];
        let lowers = self.lift.and_then(CommonModeRule::doc_of_lift);
        doc.extend(lowers);
        l.b.stage("find_saturation", &doc);
        let u = u_unsat.with_c("u_unsat");
        let [high, low] = u.extremes(["u_max", "u_min"]);
        named! {
            let spread = high - low;
            let extent = high + low;
            let middle_unsat = extent >> 1;
        }
        let free = Free {
            u,
            spread,
            extent,
            middle: middle_unsat,
        };
        let legs = if let Some(rule) = self.lift {
            named! {
                let lift_unsat = rule.lift(l, Some(middle_unsat), [high, low]);
            }
            u.map(|u| u + lift_unsat)
        } else {
            u.map(|u| u - middle_unsat)
        };
        named! {
            let saturated = spread.is_above(bus);
            let applied_spread = spread.min(bus);
        }
        // Pulses that lie lower are duties already.
        let name = if lowers.is_some() { "duty" } else { "centred" };
        let outside = legs.named(&format!("{name}_unsat"));
        let (inside, inside_legs) = match priority {
            Priority::Angle => self.keep_angle(l, saturated, free),
            Priority::Nearest => self.take_nearest(l, saturated, free),
            Priority::Torque(emf) => self.keep_torque(l, saturated, free, emf),
        };
        let names = ["a", "b", "c"].map(|letter| format!("{name}_{letter}"));
        let [u_a, u_b, leg_a, leg_b, leg_c] = l.b.join([
            ("u_a", inside.a(), u.a()),
            ("u_b", inside.b(), u.b()),
            (&*names[0], inside_legs.a(), outside.a()),
            (&*names[1], inside_legs.b(), outside.b()),
            (&*names[2], inside_legs.c(), outside.c()),
        ]);
        Limited {
            u: Phases([u_a, u_b]),
            legs: Phases([leg_a, leg_b, leg_c]),
            is_lifted: self.lift.is_some(),
            cut: saturated,
            spread: applied_spread,
        }
    }

    /// Voltages times bus over spread, a ratio of 16 bits. The centred legs are clamped, and the phase
    /// voltages follow from them.
    fn keep_angle(
        &self,
        l: &Lowering<'b>,
        saturated: Flag<'b>,
        free: Free<'b>,
    ) -> (Phases<'b>, Phases<'b, 3>) {
        let doc = "Voltage scaled to the edge of the hexagon, at the same angle.";
        l.b.guarded_stage("limit_keep_angle", saturated, true, &[doc]);
        let bus = self.bus.volts;
        // Without the sign.
        let dropped = bus.interval().bits().saturating_sub(SCALE_BITS + 1);
        let meaning = "bus over spread, below 1";
        l.format("scale", 32, SCALE_BITS as i32, Rounding::Floor, meaning);
        l.format(
            "scale_volts",
            32,
            l.scale.voltage_bits as i32 - dropped as i32,
            Rounding::Floor,
            "bus in the ratio",
        );
        named! {
            let spread_short = (free.spread >> dropped).max(1);
            let scale = (bus >> dropped).divide(SCALE_BITS, spread_short, (1 << SCALE_BITS) - 1);
            // Products of it and twice a voltage have the result in their upper word.
            let scale_long = scale << (31 - SCALE_BITS);
            let u_scaled = free.u.pair().map(|u| (u << 1).mul_round(scale_long, 32));
            let middle_scaled = free.extent.mul_round(scale_long, 32);
        }
        let legs = self.centred(u_scaled.with_c("u_scaled"), middle_scaled);
        (self.without_mean(legs), self.lifted(l, legs))
    }

    fn take_nearest(
        &self,
        l: &Lowering<'b>,
        saturated: Flag<'b>,
        free: Free<'b>,
    ) -> (Phases<'b>, Phases<'b, 3>) {
        let doc =
            "Nearest point of the hexagon: the centred leg voltages, each clamped to the bus.";
        l.b.guarded_stage("limit_nearest", saturated, true, &[doc]);
        // The greatest of the three is the bus and the least is zero.
        named! {
            let terminal_middle = self.bus.volts >> 1;
        }
        let legs = self.nearest(free);
        let u = self.without_mean(legs);
        (u, self.lifted(l, self.centred(legs, terminal_middle)))
    }

    fn keep_torque(
        &self,
        l: &Lowering<'b>,
        saturated: Flag<'b>,
        free: Free<'b>,
        emf: impl FnOnce() -> Phases<'b>,
    ) -> (Phases<'b>, Phases<'b, 3>) {
        l.b.guarded_stage(
            "limit_torque_priority",
            saturated,
            true,
            &[
                "Voltage limit with torque priority: the component along the EMF stays, the rest is clipped.",
                "",
                "d is the phase of the largest EMF, x and y the next two; with X = u_d - u_x, Y = u_d - u_y and",
                "F = (-f_x, -f_y) the hexagon is |X|, |Y|, |X - Y| <= V_BUS and the component is F_x X + F_y Y.",
                "Beyond the reachable component the result blends into the nearest point.",
            ],
        );
        let e = emf();
        let legs = self.torque_priority(l, free, e);
        let u = self.without_mean(legs);
        (u, self.lifted(l, self.centred(legs, middle(legs))))
    }

    /// Phase voltages a and b from leg voltages; added to the open stage.
    fn without_mean(&self, legs: Phases<'b, 3>) -> Phases<'b> {
        named! {
            let legs_mean = self.third * legs.sum();
            let u_limited = legs.pair().map(|leg| within_bus(leg - legs_mean, self.bus.volts));
        }
        u_limited
    }

    /// Leg voltages less their middle, within half the bus; added to the open stage.
    fn centred(&self, legs: Phases<'b, 3>, middle: Expr<'b>) -> Phases<'b, 3> {
        named! {
            let centred_max = (self.bus.volts + 1) >> 1;
            let centred_min = -centred_max;
        }
        let least_top = Interval::symmetric(centred_max.interval().low);
        named! {
            let centred_limited = legs.map(|leg| {
                let centred = leg - middle;
                if least_top.contains(centred.interval()) {
                    centred
                } else {
                    centred.max(centred_min).min(centred_max)
                }
            });
        }
        centred_limited
    }

    /// Centred leg voltages, lifted where the hexagon's are; added to the open stage.
    fn lifted(&self, l: &Lowering<'b>, legs: Phases<'b, 3>) -> Phases<'b, 3> {
        let Some(rule) = self.lift else {
            return legs;
        };
        if rule.is_centred() {
            named! {
                let lifted_limited = legs.map(|leg| leg + half_period(l));
            }
            return lifted_limited;
        }
        // The clamp never acts: the legs lie within half of V_REACH about their middle. It tells the range.
        let extremes = legs.extremes(["highest_limited", "lowest_limited"]);
        named! {
            let lift_limited = rule.lift(l, None, extremes);
            let duty_limited = legs.map(|leg| (leg + lift_limited).clamp(0, rule.pulse_top(l)));
        }
        duty_limited
    }

    /// Terminal voltages of the nearest point; added to the open stage.
    fn nearest(&self, free: Free<'b>) -> Phases<'b, 3> {
        let bus = self.bus.volts;
        named! {
            let lift = (bus >> 1) - free.middle;
            let terminal = free.u.map(|u| (u + lift).clamp(0, bus));
        }
        terminal
    }

    /// Leg voltages relative to the phase of the largest EMF; with a small EMF the terminal
    /// voltages of the nearest point.
    fn torque_priority(&self, l: &Lowering<'b>, free: Free<'b>, e: Phases<'b>) -> Phases<'b, 3> {
        let bus = self.bus.volts;
        let near = self.nearest(free);
        let frame = Frame::of(e.with_c("e"));
        let forward = frame.lines(free.u, "u_d", "line");
        let forward = axes("forward", forward);
        let shift = product_shift(l, frame.force, forward);
        let [along_x, along_y] = [0, 1].map(|k| frame.force[k].mul_floor(forward[k], shift));
        named! {
            let component_signed = along_x + along_y;
            let pushing = component_signed.is_at_least(0);
        }
        let turned = |values: [Expr<'b>; 2]| values.map(|value| pushing.sign(value));
        let near_line = frame.lines(near, "near_d", "near_line");
        let asked = Asked {
            line: axes_of(["x", "y"], turned(forward)),
            near: axes(
                "near",
                turned(axes_of(["near_x_forward", "near_y_forward"], near_line)),
            ),
            component: component_signed.abs(),
            shift,
        };
        let inside = asked.nearest_inside(&frame, bus);
        let blended = turned(axes("blended", inside));
        let chosen = axes("turned", blended).map(|leg| frame.positive.choose(-leg, leg));
        let [x, y] = axes("leg", chosen);
        named! {
            let directed = frame.size.is_at_least(bus >> LEAST_EMF_BITS);
        }
        // From (d, x, y) to (a, b, c).
        let zero = l.b.number(0);
        let legs = [[zero, y, x], [x, zero, y], [y, x, zero]];
        let kept = Phases(legs.map(|legs| pick(frame.d, legs)));
        named! {
            let leg_kept = kept.zip(near, |kept, near| directed.choose(kept, near));
        }
        leg_kept
    }
}

/// Phase order d, x, y and signs that make F and the component non-negative.
struct Frame<'b> {
    /// d is a; d is b.
    d: [Flag<'b>; 2],
    /// f_d >= 0
    positive: Flag<'b>,
    /// F, with the sign of f_d.
    force: [Expr<'b>; 2],
    /// |f_d|
    size: Expr<'b>,
}

impl<'b> Frame<'b> {
    fn of(e: Phases<'b, 3>) -> Self {
        named! {
            let e_size = e.map(Expr::abs);
        }
        let [a, b, c] = e_size.0;
        named! {
            let d_is_a = b.is_at_most(a) & c.is_at_most(a);
            let d_is_b = c.is_at_most(b);
        }
        let d = [d_is_a, d_is_b];
        let [f_d, f_x, f_y] = rotated(d, e);
        named! {
            let f_d = f_d;
            let f_x = f_x;
            let f_y = f_y;
            let f_positive = f_d.is_at_least(0);
            let f_size = f_d.abs();
        }
        let force = [f_x, f_y].map(|f| f_positive.choose(-f, f).max(0));
        Self {
            d,
            positive: f_positive,
            force: axes("force", force),
            size: f_size,
        }
    }

    /// X and Y of three phase values, with the sign of f_d.
    fn lines(&self, phases: Phases<'b, 3>, d_name: &str, line: &str) -> [Expr<'b>; 2] {
        let [d, x, y] = rotated(self.d, phases);
        let d = d.named(d_name);
        axes(line, [d - x, d - y]).map(|line| self.positive.sign(line))
    }
}

/// Phases a, b, c as d, x, y.
fn rotated<'b>(d: [Flag<'b>; 2], phases: Phases<'b, 3>) -> [Expr<'b>; 3] {
    let [a, b, c] = phases.0;
    [[a, b, c], [b, c, a], [c, a, b]].map(|phases| pick(d, phases))
}

/// Values on x and y under these names.
fn axes_of<'b>(names: [&str; 2], [x, y]: [Expr<'b>; 2]) -> [Expr<'b>; 2] {
    [x.named(names[0]), y.named(names[1])]
}

/// Values on x and y: `line_x` and `line_y`.
fn axes<'b>(name: &str, values: [Expr<'b>; 2]) -> [Expr<'b>; 2] {
    axes_of([&format!("{name}_x"), &format!("{name}_y")], values)
}

/// A voltage outside the hexagon, with the sign that makes its component non-negative.
struct Asked<'b> {
    /// X and Y.
    line: [Expr<'b>; 2],
    /// X and Y of the nearest point.
    near: [Expr<'b>; 2],
    /// F_x X + F_y Y, shifted right.
    component: Expr<'b>,
    shift: u32,
}

impl<'b> Asked<'b> {
    /// The point of the hexagon with this component that is nearest to the voltage; beyond the
    /// reachable component a blend into the nearest point, complete at 1.5 times the reachable one.
    fn nearest_inside(&self, frame: &Frame<'b>, bus: Expr<'b>) -> [Expr<'b>; 2] {
        named! {
            let component = self.component;
            let reachable = frame.size.mul_floor(bus, self.shift);
        }
        let kept = self.with_component(component.min(reachable), frame, bus);
        let past = (component - reachable).max(0);
        named! {
            let blend = past.divide(BLEND_BITS, (reachable >> 1).max(1), 1 << BLEND_BITS);
        }
        [0, 1].map(|k| kept[k] + (self.near[k] - kept[k]).mul_round(blend, BLEND_BITS))
    }

    /// The nearest point of the hexagon with the component `kept`.
    fn with_component(&self, kept: Expr<'b>, frame: &Frame<'b>, bus: Expr<'b>) -> [Expr<'b>; 2] {
        let ([x, y], [force_x, force_y]) = (self.line, frame.force);
        named! {
            let x_heavy = y.is_at_most(x);
            let at_corner = x_heavy.choose(force_x, force_y).mul_floor(bus, self.shift);
            let past_corner = kept - at_corner;
            let beyond_corner = past_corner.is_at_least(0);
        }
        // At least a quarter of the EMF: the light force vanishes in mid-sector, where the exact
        // quotient would jump along a whole edge for an error of one ulp. The maximum with the
        // nearest point, whose component is never the larger, makes up for the difference.
        let light_force = x_heavy.choose(force_y, force_x).max(frame.size >> 2);
        let force = beyond_corner.choose(light_force, frame.size).max(1);
        named! {
            // A scale at which the shift is over 31 is refused.
            let quotient = past_corner.abs().divide(self.shift.min(31), force, bus);
        }
        let near_light = x_heavy.choose(self.near[1], self.near[0]);
        named! {
            let light = beyond_corner.choose(quotient.max(near_light), -quotient);
            let heavy = (light + bus).min(bus);
        }
        let kept = [x_heavy.choose(heavy, light), x_heavy.choose(light, heavy)];
        axes("kept", kept)
    }
}

/// (max + min) / 2 of three legs, rounded down; added to the open stage.
fn middle(legs: Phases<'_, 3>) -> Expr<'_> {
    let [high, low] = legs.extremes(["limited_max", "limited_min"]);
    named! {
        let limited_middle = (high + low) >> 1;
    }
    limited_middle
}

/// A value that never exceeds the bus, as the caller guarantees: the clamp only tells the intervals that it
/// never exceeds the greatest bus.
pub(super) fn within_bus<'b>(value: Expr<'b>, bus: Expr<'b>) -> Expr<'b> {
    let greatest_bus = Interval::symmetric(bus.interval().high);
    if greatest_bus.contains(value.interval()) {
        return value;
    }
    value.max(-bus).min(bus)
}

/// The least shift at which the sum of two products fits a word with one bit to spare.
fn product_shift(l: &Lowering<'_>, forces: [Expr<'_>; 2], lines: [Expr<'_>; 2]) -> u32 {
    let bits = |[x, y]: [Expr<'_>; 2]| x.interval().bits().max(y.interval().bits());
    let shift = (bits(forces) + bits(lines)).saturating_sub(31);
    let meaning = "products of EMF and voltage in torque priority";
    l.product_format("emf_product", shift, meaning);
    shift
}
