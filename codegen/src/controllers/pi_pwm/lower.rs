//! PI control as IR: the shared step, two regulators, the voltage limit and the modulator.

use crate::controllers::current_loop::{CurrentLoop, EmfUse, Front, LoopDesign, Needs, lower_with};
use crate::ir::{Interval, Value};
use crate::lower::{Coefficient, Command, Lowering, Scale};
use crate::scaling::Lowered;
use crate::spec::{BusSource, PiPwmSpec, Spec};

/// What the stage that integrates is about.
const INTEGRATION: &[&str] = &[
    "Integration and tracking anti-windup in one product: what the limit cut off is taken back with the same time constant.",
];

/// Lowers the controller at a scale.
pub fn lower(spec: &Spec, options: &PiPwmSpec, design: &LoopDesign, scale: Scale) -> Lowered {
    let gain = options.proportional_gain(&spec.motor);
    lower_with(spec, scale, gain, |lowering, set_point| {
        let mut step = CurrentLoop {
            lowering,
            options: &options.common,
            design,
            needs: Needs {
                commutation: false,
                off_leg: false,
                emf: if options.feed_forward {
                    EmfUse::FeedForward
                } else {
                    EmfUse::None
                },
                integral: false,
            },
        };
        let front = step.front(set_point);
        if options.six_step {
            return six_step(&mut step, &front, spec, options);
        }
        let l = &mut *step.lowering;
        let bound = l.bus_interval().high;
        let integrals = ["integral_a", "integral_b"].map(|name| {
            let doc = "Integral part of the regulator, words of voltage.";
            l.state(name, 0, Interval::symmetric(bound), doc)
        });
        let [k_p, k_i] = gains(l, spec, options);
        l.b.stage(
            "regulate",
            &["PI regulator per phase: v = k_p (i_ref - i) + integral, and the EMF where it is fed forward."],
        );
        let regulated = [0, 1].map(|x| {
            let held = l.times(k_p, front.currents.phases[x]);
            if options.dead_time_compensation {
                l.b.name(["held_a", "held_b"][x], held);
            }
            let part = l.b.sub(front.reference[x], held);
            [held, l.b.name(["p_a", "p_b"][x], part)]
        });
        let parts = regulated.map(|[_, part]| part);
        let sums = [0, 1].map(|x| l.b.state(integrals[x]));
        let u = [0, 1].map(|x| {
            let volts = l.b.add(parts[x], sums[x]);
            let volts = match front.e {
                Some(e) => l.b.add(volts, e[x]),
                None => volts,
            };
            let doc = "Voltage of a phase that the law asks for, before the limit";
            let word = 1.0 / l.scale.voltage();
            l.b.state_error("voltage", volts, [doc, "V"], word);
            l.b.name(["u_a_unsat", "u_b_unsat"][x], volts)
        });
        let held = regulated.map(|[held, _]| held);
        let shifts = options
            .dead_time_compensation
            .then(|| step.dead_time_shifts(front.reference, held, gain));
        let l = &mut *step.lowering;
        let e = front.e.unwrap_or(u);
        let limited = l.limit_voltage(options.saturation, u, |_| e, front.bus, front.third);
        l.b.stage("integrate", INTEGRATION);
        let mut remembered = vec![];
        for x in 0..2 {
            let regulated = Regulated {
                part: parts[x],
                sum: sums[x],
                u: u[x],
                limited: limited.u[x],
            };
            let names = [["drive_a", "integral_a_now"], ["drive_b", "integral_b_now"]][x];
            let held = integrate(l, spec, k_i, &regulated, names);
            remembered.push((
                integrals[x],
                ["integral_a_next", "integral_b_next"][x],
                held,
            ));
        }
        let command = l.modulate(limited, front.bus, shifts);
        step.remember(&front, &command, Some(limited.u), None, remembered);
    })
}

/// k_p and k_i.
fn gains(l: &mut Lowering<'_>, spec: &Spec, options: &PiPwmSpec) -> [Coefficient; 2] {
    let gain = options.proportional_gain(&spec.motor);
    let word = options.common.word;
    let k_p = l.impedance(
        "k_p",
        gain,
        word,
        "Proportional gain 2 pi f L.",
        ["k_p", "V/A"],
    );
    let share = options.integral_share(spec);
    let k_i = l.coefficient(
        "k_i",
        share,
        word,
        "Share of the proportional voltage that one period integrates, T_s/T_i; also the weight of the anti-windup.",
        &format!("T_s/T_i = {share:.6}"),
    );
    [k_p, k_i]
}

/// What a regulator made of its error.
struct Regulated {
    /// Proportional part.
    part: Value,
    /// Integral part.
    sum: Value,
    /// Voltage asked for.
    u: Value,
    /// Voltage within the limit.
    limited: Value,
}

/// The new integral part, within the greatest bus; `names` are those of what drives it and of itself.
fn integrate(
    l: &mut Lowering<'_>,
    spec: &Spec,
    k_i: Coefficient,
    regulated: &Regulated,
    names: [&str; 2],
) -> Value {
    let cut = l.b.sub(regulated.limited, regulated.u);
    let drive = l.b.add(regulated.part, cut);
    l.b.name(names[0], drive);
    let change = l.times(k_i, drive);
    let sum = l.b.add(regulated.sum, change);
    let bound = l.bus_interval().high;
    let doc = format!(
        "Largest integral part, the {}bus",
        if spec.inverter.bus == BusSource::Fixed {
            ""
        } else {
            "greatest "
        },
    );
    let (low, high) = (
        l.voltage("integral_min", -bound, &doc),
        l.voltage("integral_max", bound, &doc),
    );
    let held = l.b.clamp(sum, low, high);
    let doc = "Integral part after one step";
    let word = 1.0 / l.scale.voltage();
    l.b.state_error("integral", held, [doc, "V"], word);
    l.b.name(names[1], held)
}

/// One regulator for the current of the conducting pair, and the pulses of its line voltage.
fn six_step(step: &mut CurrentLoop<'_, '_>, front: &Front, spec: &Spec, options: &PiPwmSpec) {
    let l = &mut *step.lowering;
    let bound = Interval::symmetric(l.bus_interval().high);
    let doc = "Integral part of the regulator, words of voltage.";
    let integral = l.state("integral", 0, bound, doc);
    let [k_p, k_i] = gains(l, spec, options);
    l.b.stage(
        "regulate",
        &["PI regulator of the pair's current: v = k_p (i_ref - i) + integral, per winding."],
    );
    let sign = l.pair_signs(front.sector);
    let halves = [0, 1, 2].map(|x| l.b.shift_right(front.currents.phases[x], 1));
    let current = l.across_pair(sign, halves);
    l.b.name("pair_current", current);
    let drop = l.times(k_p, current);
    let part = l.b.sub(front.set_point, drop);
    l.b.name("part", part);
    let flow = options.dead_time_compensation.then(|| {
        [0, 1].map(|x| {
            let flow = l.times(k_p, front.currents.phases[x]);
            l.b.name(["held_a", "held_b"][x], flow)
        })
    });
    let sum = l.b.state(integral);
    let u = l.b.add(part, sum);
    let doc = "Voltage of a winding that the law asks for, before the limit";
    let word = 1.0 / l.scale.voltage();
    l.b.state_error("voltage", u, [doc, "V"], word);
    l.b.name("u", u);
    let line = l.b.shift_left(u, 1);
    let line = l.limit_line(line, front.bus);
    l.b.stage("integrate", INTEGRATION);
    let limited = l.b.shift_right(line, 1);
    let regulated = Regulated {
        part,
        sum,
        u,
        limited,
    };
    let held = integrate(l, spec, k_i, &regulated, ["drive", "integral_now"]);
    let gain = options.proportional_gain(&spec.motor);
    let shifts = flow.map(|flow| step.dead_time_shifts(front.reference, flow, gain));
    let l = &mut *step.lowering;
    l.b.stage(
        "modulate_pair",
        &["One leg of the pair pulsed, its partner low, the third off, in commutation as well."],
    );
    let pulses = l.pulse_pair(sign, line, front.bus, shifts);
    let command = Command {
        compares: pulses.compares,
        legs: pulses.legs,
    };
    step.remember(
        front,
        &command,
        None,
        None,
        vec![(integral, "integral_next", held)],
    );
}
