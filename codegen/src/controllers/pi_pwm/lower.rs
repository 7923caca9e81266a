//! PI control as IR: the shared step, two regulators, the voltage limit and the modulator.

use crate::controllers::current_loop::{CurrentLoop, EmfUse, LoopDesign, Needs, lower_with};
use crate::ir::Interval;
use crate::lower::Scale;
use crate::scaling::Lowered;
use crate::spec::{BusSource, PiPwmSpec, Spec};

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
        let l = &mut *step.lowering;
        let bound = l.bus_interval().high;
        let integrals = ["integral_a", "integral_b"].map(|name| {
            let doc = "Integral part of the regulator, words of voltage.";
            l.state(name, 0, Interval::symmetric(bound), doc)
        });
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
        l.b.stage(
            "regulate",
            &["PI regulator per phase: v = k_p (i_ref - i) + integral, and the EMF where it is fed forward."],
        );
        let mut held = [None; 2];
        let parts = [0, 1].map(|x| {
            let drop = l.times(k_p, front.currents.phases[x]);
            if options.dead_time_compensation {
                held[x] = Some(l.b.name(["held_a", "held_b"][x], drop));
            }
            let part = l.b.sub(front.reference[x], drop);
            l.b.name(["p_a", "p_b"][x], part)
        });
        let sums = [0, 1].map(|x| l.b.state(integrals[x]));
        let u = [0, 1].map(|x| {
            let volts = l.b.add(parts[x], sums[x]);
            let volts = match front.e {
                Some(e) => l.b.add(volts, e[x]),
                None => volts,
            };
            l.b.name(["u_a_unsat", "u_b_unsat"][x], volts)
        });
        let shifts = match held {
            [Some(a), Some(b)] => Some(step.dead_time_shifts(front.reference, [a, b], gain)),
            _ => None,
        };
        let l = &mut *step.lowering;
        let e = front.e.unwrap_or(u);
        let limited = l.limit_voltage(options.saturation, u, e, front.bus, front.third);
        l.b.stage(
            "integrate",
            &["Integration and tracking anti-windup in one product: what the limit cut off is taken back with the same time constant."],
        );
        let mut remembered = vec![];
        for x in 0..2 {
            let cut = l.b.sub(limited.u[x], u[x]);
            let drive = l.b.add(parts[x], cut);
            l.b.name(["drive_a", "drive_b"][x], drive);
            let change = l.times(k_i, drive);
            let sum = l.b.add(sums[x], change);
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
            l.b.name(["integral_a_now", "integral_b_now"][x], held);
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
