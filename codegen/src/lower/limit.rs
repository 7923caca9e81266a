//! The voltage limit: what gives way outside the hexagon (semantics, step 10).
//!
//! In phase coordinates that sum to zero the hexagon is "largest less smallest at most V_BUS", so one
//! comparison finds saturation and everything else is off the normal path.

use super::{Bus, Coefficient, Lowering};
use crate::interface::Rounding;
use crate::ir::{Comparison, Interval, Value};
use crate::spec::LimitRule;

/// A voltage inside the hexagon.
#[derive(Clone, Copy, Debug)]
pub struct Limited {
    /// Phase voltages a, b.
    pub u: [Value; 2],
    /// Phase voltages less (max + min) / 2 of the three, rounded down: what centred pulses stand for. Lifted by half the
    /// period where that was asked for.
    pub centred: [Value; 3],
}

/// Voltages of the three legs.
#[derive(Clone, Copy, Debug)]
enum Legs {
    /// Phase voltages.
    ZeroSum([Value; 3]),
    /// Against any common point.
    Any([Value; 3]),
}

/// A voltage that may lie outside.
#[derive(Clone, Copy, Debug)]
struct Free {
    /// Phase voltages.
    u: [Value; 3],
    /// (max + min) / 2 of the three, rounded down.
    middle: Value,
}

/// What gives way, and what it needs for that: `E` is an EMF, or a way to find it.
#[derive(Clone, Copy, Debug)]
pub enum Priority<E> {
    /// The magnitude: the voltage keeps its angle.
    Angle,
    /// Whatever is nearest.
    Nearest,
    /// What makes no torque: the component along this EMF stays.
    Torque(E),
}

impl<E> Priority<E> {
    /// A rule of the specification. A law without an EMF knows no torque, and takes the nearest point.
    pub fn of(rule: LimitRule, emf: Option<E>) -> Self {
        match (rule, emf) {
            (LimitRule::KeepAngle, _) => Self::Angle,
            (LimitRule::TorquePriority, Some(emf)) => Self::Torque(emf),
            (LimitRule::TorquePriority, None) | (LimitRule::Nearest, _) => Self::Nearest,
        }
    }
}

/// Fraction bits of the ratio in keep_angle.
const SCALE_BITS: u32 = 30;
/// Torque priority needs an EMF of at least the bus over 2 to this power.
const LEAST_EMF_BITS: u32 = 5;
/// Names of the limited phase voltages.
const LIMITED: [&str; 2] = ["u_a_limited", "u_b_limited"];
/// Fraction bits of the blend towards the nearest point.
const BLEND_BITS: u32 = 15;

impl Lowering<'_> {
    /// Limits the voltage `u` (phases a, b) to the hexagon; the EMF (phases a, b) is found off the normal path.
    /// `lifts`: centres the voltages at half the period rather than at 0.
    pub fn limit_voltage<E: FnOnce(&mut Self) -> [Value; 2]>(
        &mut self,
        priority: Priority<E>,
        u: [Value; 2],
        (bus, third): (Bus, Coefficient),
        lifts: bool,
    ) -> Limited {
        self.b.stage(
            "find_saturation",
            &["Largest less smallest phase voltage: more than the bus means saturation."],
        );
        let u_c = self.third_phase("u_c_unsat", u[0], u[1]);
        let [high, low] = self.extremes(["u_max", "u_min"], [u[0], u[1], u_c]);
        let spread = self.b.sub(high, low);
        self.b.name("spread", spread);
        let sum = self.b.add(high, low);
        let middle = self.b.shift_right(sum, 1);
        self.b.name("middle_unsat", middle);
        let free = Free {
            u: [u[0], u[1], u_c],
            middle,
        };
        let names = ["centred_a_unsat", "centred_b_unsat", "centred_c_unsat"];
        let lift = lifts.then(|| {
            let half = self.half_period();
            let lift = self.b.sub(half, middle);
            self.b.name("lift_unsat", lift)
        });
        let centred = [0, 1, 2].map(|x| {
            let centred = match lift {
                Some(lift) => self.b.add(free.u[x], lift),
                None => self.b.sub(free.u[x], middle),
            };
            self.b.name(names[x], centred)
        });
        let saturated = self.b.compare(Comparison::Less, bus.volts, spread);
        self.b.name("saturated", saturated);
        let (legs, middle) = match priority {
            Priority::Angle => {
                self.b.guarded_stage(
                    "limit_keep_angle",
                    saturated,
                    true,
                    &["Scales the voltage to the edge of the hexagon; its angle stays."],
                );
                self.format(
                    "scale",
                    32,
                    SCALE_BITS as i32,
                    Rounding::Floor,
                    "bus over spread, at most 1",
                );
                let one = self.b.literal(1 << SCALE_BITS);
                let divisor = self.at_least_one(spread);
                let scale = self.b.divide(bus.volts, SCALE_BITS, divisor, one);
                self.b.name("scale", scale);
                let scaled = [0, 1].map(|x| {
                    let scaled = self.b.mul(scale, u[x], SCALE_BITS);
                    let held = self.within_bus(scaled, bus.volts);
                    self.b.name(LIMITED[x], held)
                });
                let scaled_c = self.third_phase("u_c_limited", scaled[0], scaled[1]);
                (Legs::ZeroSum([scaled[0], scaled[1], scaled_c]), None)
            }
            Priority::Nearest => {
                self.b.guarded_stage(
                    "limit_nearest",
                    saturated,
                    true,
                    &["Nearest point of the hexagon: with the offset that centres the pulses, each leg is clamped for itself."],
                );
                // The greatest is the bus and the least zero.
                let half = self.b.shift_right(bus.volts, 1);
                self.b.name("terminal_middle", half);
                (Legs::Any(self.nearest(free, bus)), Some(half))
            }
            Priority::Torque(emf) => {
                self.b.guarded_stage(
                    "limit_torque_priority",
                    saturated,
                    true,
                    &[
                        "Keeps the component of the voltage along the EMF, which makes torque, and clips the rest.",
                        "",
                        "d is the phase of the largest EMF, x and y the next two; with X = u_d - u_x, Y = u_d - u_y and",
                        "F = (-f_x, -f_y) the hexagon is |X|, |Y|, |X - Y| <= V_BUS and the component is F_x X + F_y Y.",
                        "Past the reachable component the result goes over to the nearest point without a jump.",
                    ],
                );
                let e = emf(self);
                (Legs::Any(self.torque_priority(free, e, bus)), None)
            }
        };
        let (legs, inside) = match legs {
            Legs::ZeroSum(legs) => (legs, [legs[0], legs[1]]),
            Legs::Any(legs) => (legs, self.without_mean(legs, bus, third)),
        };
        let middle = middle.unwrap_or_else(|| self.middle(legs));
        let inside_centred = self.centred(legs, middle, bus, lifts);
        let [u_a, u_b, centred_a, centred_b, centred_c] = self.b.join([
            ("u_a", inside[0], u[0]),
            ("u_b", inside[1], u[1]),
            ("centred_a", inside_centred[0], centred[0]),
            ("centred_b", inside_centred[1], centred[1]),
            ("centred_c", inside_centred[2], centred[2]),
        ]);
        Limited {
            u: [u_a, u_b],
            centred: [centred_a, centred_b, centred_c],
        }
    }

    /// The phase voltages a and b of legs against any common point, added to the open stage.
    fn without_mean(&mut self, legs: [Value; 3], bus: Bus, third: Coefficient) -> [Value; 2] {
        let sum = self.b.add(legs[0], legs[1]);
        let sum = self.b.add(sum, legs[2]);
        let mean = self.times(third, sum);
        self.b.name("legs_mean", mean);
        [0, 1].map(|x| {
            let voltage = self.b.sub(legs[x], mean);
            let held = self.within_bus(voltage, bus.volts);
            self.b.name(LIMITED[x], held)
        })
    }

    /// (max + min) / 2 of three legs, rounded down; added to the open stage.
    fn middle(&mut self, legs: [Value; 3]) -> Value {
        let [high, low] = self.extremes(["limited_max", "limited_min"], legs);
        let sum = self.b.add(high, low);
        let middle = self.b.shift_right(sum, 1);
        self.b.name("limited_middle", middle)
    }

    /// Legs about their middle, within half the bus, and lifted; added to the open stage.
    fn centred(&mut self, legs: [Value; 3], middle: Value, bus: Bus, lifts: bool) -> [Value; 3] {
        let up = self.b.literal(1);
        let up = self.b.add(bus.volts, up);
        let top = self.b.shift_right(up, 1);
        self.b.name("centred_max", top);
        let bottom = self.b.neg(top);
        self.b.name("centred_min", bottom);
        let names = [
            "centred_a_limited",
            "centred_b_limited",
            "centred_c_limited",
        ];
        let least_top = self.b.interval(top).low;
        let centred = [0, 1, 2].map(|x| self.b.sub(legs[x], middle));
        [0, 1, 2].map(|x| {
            let mut held = centred[x];
            if !Interval::symmetric(least_top).contains(self.b.interval(held)) {
                let raised = self.b.max(held, bottom);
                held = self.b.min(raised, top);
            }
            if lifts {
                let half = self.half_period();
                held = self.b.add(held, half);
            }
            self.b.name(names[x], held)
        })
    }

    fn at_least_one(&mut self, value: Value) -> Value {
        let one = self.b.literal(1);
        self.b.max(value, one)
    }

    /// The nearest point's terminal voltages, added to the open stage.
    fn nearest(&mut self, free: Free, bus: Bus) -> [Value; 3] {
        let half = self.b.shift_right(bus.volts, 1);
        let lift = self.b.sub(half, free.middle);
        self.b.name("lift", lift);
        let names = ["terminal_a", "terminal_b", "terminal_c"];
        [0, 1, 2].map(|x| {
            let phase = free.u[x];
            let lifted = self.b.add(phase, lift);
            let zero = self.zero();
            let terminal = self.b.clamp(lifted, zero, bus.volts);
            self.b.name(names[x], terminal)
        })
    }

    /// A value that cannot leave the bus, held there for the proof (a third or two of the bus at most).
    fn within_bus(&mut self, value: Value, bus: Value) -> Value {
        let least_bus = self.b.interval(bus).low;
        if Interval::symmetric(least_bus).contains(self.b.interval(value)) {
            return value;
        }
        let low = self.b.neg(bus);
        let low = self.b.max(value, low);
        self.b.min(low, bus)
    }

    /// The legs' voltages against the phase of the largest EMF, or where that is small the nearest point's terminals.
    fn torque_priority(&mut self, free: Free, e: [Value; 2], bus: Bus) -> [Value; 3] {
        let near = self.nearest(free, bus);

        // d, x, y: the phase of the largest EMF and the next two.
        let e_c = self.third_phase("e_c", e[0], e[1]);
        let size = [e[0], e[1], e_c].map(|phase| self.b.abs(phase));
        let size = [0, 1, 2].map(|x| {
            self.b
                .name(["e_a_size", "e_b_size", "e_c_size"][x], size[x])
        });
        let over_b = self.b.compare(Comparison::LessEqual, size[1], size[0]);
        let over_c = self.b.compare(Comparison::LessEqual, size[2], size[0]);
        let d_is_a = self.b.and(over_b, over_c);
        self.b.name("d_is_a", d_is_a);
        let d_is_b = self.b.compare(Comparison::LessEqual, size[2], size[1]);
        self.b.name("d_is_b", d_is_b);
        let rotate = |lowering: &mut Self, [a, b, c]: [Value; 3]| {
            [[a, b, c], [b, c, a], [c, a, b]].map(|phases| lowering.pick(d_is_a, d_is_b, phases))
        };
        let [f_d, f_x, f_y] = rotate(self, [e[0], e[1], e_c]);
        for (name, value) in [("f_d", f_d), ("f_x", f_x), ("f_y", f_y)] {
            self.b.name(name, value);
        }
        let [u_d, u_x, u_y] = rotate(self, free.u);
        self.b.name("u_d", u_d);
        let [n_d, n_x, n_y] = rotate(self, near);
        self.b.name("near_d", n_d);

        // Signs such that F and the component are not negative.
        let zero = self.zero();
        let positive = self.b.compare(Comparison::LessEqual, zero, f_d);
        self.b.name("f_positive", positive);
        let [f_x, f_y] = [(f_x, "force_x"), (f_y, "force_y")].map(|(f, name)| {
            let turned = self.b.neg(f);
            let along = self.b.select(positive, turned, f);
            let zero = self.zero();
            let force = self.b.max(along, zero);
            self.b.name(name, force)
        });
        let mut differences = |d: Value, x: Value, name: &str| {
            let difference = self.b.sub(d, x);
            self.b.name(name, difference)
        };
        let line = [
            differences(u_d, u_x, "line_x"),
            differences(u_d, u_y, "line_y"),
        ];
        let near_line = [
            differences(n_d, n_x, "near_line_x"),
            differences(n_d, n_y, "near_line_y"),
        ];
        let flip = |lowering: &mut Self, flag: Value, value: Value| {
            let turned = lowering.b.neg(value);
            lowering.b.select(flag, value, turned)
        };
        let forward = [0, 1].map(|k| {
            let value = flip(self, positive, line[k]);
            self.b.name(["forward_x", "forward_y"][k], value)
        });
        let shift = self.product_shift([f_x, f_y], forward);
        let along = [0, 1].map(|k| self.b.mul_floor([f_x, f_y][k], forward[k], shift));
        let component = self.b.add(along[0], along[1]);
        self.b.name("component_signed", component);
        let zero = self.zero();
        let pushing = self.b.compare(Comparison::LessEqual, zero, component);
        self.b.name("pushing", pushing);
        let [x, y] = [0, 1].map(|k| {
            let value = flip(self, pushing, forward[k]);
            self.b.name(["x", "y"][k], value)
        });
        let component = self.b.abs(component);
        self.b.name("component", component);
        let near_line = [0, 1].map(|k| {
            let value = flip(self, positive, near_line[k]);
            let value = flip_named(
                self,
                pushing,
                value,
                ["near_x_forward", "near_y_forward"][k],
            );
            self.b.name(["near_x", "near_y"][k], value)
        });

        // The point of the hexagon with that component (or the greatest one) nearest to (x, y).
        let f_size = self.b.abs(f_d);
        self.b.name("f_size", f_size);
        let reachable = self.b.mul_floor(f_size, bus.volts, shift);
        self.b.name("reachable", reachable);
        let kept = self.b.min(component, reachable);
        let x_heavy = self.b.compare(Comparison::LessEqual, y, x);
        self.b.name("x_heavy", x_heavy);
        let heavy_force = self.b.select(x_heavy, f_x, f_y);
        let full = self.b.mul_floor(heavy_force, bus.volts, shift);
        self.b.name("at_corner", full);
        let rest = self.b.sub(kept, full);
        self.b.name("past_corner", rest);
        let zero = self.zero();
        let beyond = self.b.compare(Comparison::LessEqual, zero, rest);
        self.b.name("beyond_corner", beyond);
        let light_force = self.b.select(x_heavy, f_y, f_x);
        // A quarter of the EMF at least: where the light force vanishes in mid-sector the exact quotient
        // would jump along a whole edge for an error of one ulp. What that gives away the nearest point,
        // whose component is never the larger, returns.
        let quarter = self.b.shift_right(f_size, 2);
        let light_force = self.b.max(light_force, quarter);
        let force = self.b.select(beyond, light_force, f_size);
        let force = self.at_least_one(force);
        let size = self.b.abs(rest);
        let quotient = self.b.divide(size, shift.min(31), force, bus.volts);
        self.b.name("quotient", quotient);
        let back = self.b.neg(quotient);
        let near_light = self.b.select(x_heavy, near_line[1], near_line[0]);
        let ahead = self.b.max(quotient, near_light);
        let light = self.b.select(beyond, ahead, back);
        self.b.name("light", light);
        let heavy = self.b.add(light, bus.volts);
        let heavy = self.b.min(heavy, bus.volts);
        self.b.name("heavy", heavy);
        let kept_x = self.b.select(x_heavy, heavy, light);
        let kept_y = self.b.select(x_heavy, light, heavy);
        let kept = [self.b.name("kept_x", kept_x), self.b.name("kept_y", kept_y)];

        // Past the reach: over to the nearest point within half of it.
        let past = self.b.sub(component, reachable);
        let zero = self.zero();
        let past = self.b.max(past, zero);
        let half = self.b.shift_right(reachable, 1);
        let half = self.at_least_one(half);
        let one = self.b.literal(1 << BLEND_BITS);
        let blend = self.b.divide(past, BLEND_BITS, half, one);
        self.b.name("blend", blend);
        let chosen = [0, 1].map(|k| {
            let way = self.b.sub(near_line[k], kept[k]);
            let part = self.b.mul(blend, way, BLEND_BITS);
            let blended = self.b.add(kept[k], part);
            let back = flip_named(self, pushing, blended, ["blended_x", "blended_y"][k]);
            self.b.name(["turned_x", "turned_y"][k], back);
            let turned = self.b.neg(back);
            let below = self.b.select(positive, turned, back);
            self.b.name(["leg_x", "leg_y"][k], below)
        });
        let least = self.b.shift_right(bus.volts, LEAST_EMF_BITS);
        let directed = self.b.compare(Comparison::LessEqual, least, f_size);
        self.b.name("directed", directed);
        // Back from (d, x, y) to (a, b, c).
        let (zero, [x, y]) = (self.zero(), chosen);
        let legs = [[zero, y, x], [x, zero, y], [y, x, zero]];
        [0, 1, 2].map(|phase| {
            let kept = self.pick(d_is_a, d_is_b, legs[phase]);
            let leg = self.b.select(directed, kept, near[phase]);
            self.b
                .name(["leg_a_kept", "leg_b_kept", "leg_c_kept"][phase], leg)
        })
    }

    /// The least shift at which the sum of two products fits a word with room for one more bit.
    fn product_shift(&mut self, forces: [Value; 2], lines: [Value; 2]) -> u32 {
        let bits = |values: [Value; 2]| {
            values
                .map(|value| self.b.interval(value).bits())
                .into_iter()
                .max()
                .unwrap_or(32)
        };
        let shift = (bits(forces) + bits(lines)).saturating_sub(31);
        if shift > 31 {
            self.misfits.push("emf_product".to_owned());
        }
        self.product_format(
            "emf_product",
            shift,
            "products of EMF and voltage in torque priority",
        );
        shift
    }
}

/// `value` where the flag holds, else `-value`; the argument gets a name because it is used twice.
fn flip_named(lowering: &mut Lowering<'_>, flag: Value, value: Value, name: &str) -> Value {
    lowering.b.name(name, value);
    let turned = lowering.b.neg(value);
    lowering.b.select(flag, value, turned)
}
