//! Proportional control as a program: the shared step, a gain, the voltage limit and the modulator.

use crate::blocks::set_point::Gain;
use crate::blocks::{CommonModeRule, Hexagon, Modulator, Priority, Scale};
use crate::ir::named;
use crate::laws::current_loop::{
    CurrentLoop, EmfUse, LoopDesign, Needs, lower_with, unlimited_voltage,
};
use crate::scaling::Lowered;
use crate::spec::{PPwmSpec, Spec};

/// Lowers the controller at a scale.
pub(super) fn lower(spec: &Spec, options: &PPwmSpec, design: &LoopDesign, scale: Scale) -> Lowered {
    let gain = options.proportional_gain(&spec.motor);
    let of_set_point = Gain {
        value: gain,
        symbol: "k_p",
        formula: "k_p = 2 pi f L",
    };
    lower_with(spec, scale, of_set_point, |l, set_point| {
        let step = CurrentLoop {
            l,
            options: &options.common,
            design,
            needs: Needs {
                commutation: false,
                off_leg: false,
                emf: EmfUse::FeedForward,
                memory: 0,
                rounding: false,
            },
        };
        let front = step.front(set_point);
        let doc = "Proportional regulator per phase: v = k_p (i_ref - i) + e.";
        l.b.stage("regulate", &[doc]);
        let doc = "Weight of the present current: the proportional gain k_p = 2 pi f L, negative.";
        let k_drop = l.impedance("k_drop", -gain, options.common.word, doc, ["-k_p", "V/A"]);
        named! {
            let p = front.reference + k_drop * front.currents.pair();
        }
        let u = unlimited_voltage(l, front.e.map_or(p, |e| p + e));
        let emf = front.e.map(|e| move || e);
        let common_mode = CommonModeRule::new(l, options.common_mode);
        let hexagon = Hexagon {
            bus: common_mode.reach(l, front.bus),
            third: front.third,
            lift: common_mode.in_limit(front.bus, false),
        };
        let limited = hexagon.limit(l, Priority::of(options.saturation, emf), u);
        let limited = common_mode.second_readable(l, front.third, front.bus, limited);
        let turned = front.turned(l, limited.cut);
        let modulator = Modulator {
            bus: front.bus,
            rounding: None,
            shifts: None,
        };
        let pulsed = modulator.three(l, &limited, common_mode);
        step.remember(&front, pulsed.command, Some(limited.u), None, turned);
    })
}
