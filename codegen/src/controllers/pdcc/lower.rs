//! Predictive deadbeat control as IR: the shared step, the voltage limit and the modulator.

use crate::controllers::current_loop::{
    CurrentLoop, Deadbeat, EmfUse, Held, LoopDesign, Needs, lower_with,
};
use crate::ir::Value;
use crate::lower::{Lowering, Priority, Scale};
use crate::scaling::Lowered;
use crate::spec::{Modulation, PdccSpec, Spec};

/// Where the limit finds the EMF.
enum Emf<'h> {
    /// In the folded words.
    Folded(&'h Held),
    /// Here, phases a and b.
    Known([Value; 2]),
}

/// Lowers the controller at a scale.
pub fn lower(spec: &Spec, options: &PdccSpec, design: &LoopDesign, scale: Scale) -> Lowered {
    lower_with(spec, scale, design.k_di, |lowering, set_point| {
        let pair = options.modulation == Modulation::Pair;
        let mut step = CurrentLoop {
            lowering,
            options: &options.common,
            design,
            needs: Needs {
                commutation: pair,
                off_leg: pair,
                emf: EmfUse::Deadbeat,
                integral: options.integral,
                memory: 0,
            },
        };
        let front = step.front(set_point);
        let Deadbeat { u, shifts } = step.deadbeat(&front, options.dead_time_compensation);
        let word = options.common.word;
        let emf = front.held.as_ref().map(Emf::Folded);
        let emf = emf.or(front.e.map(Emf::Known)).map(|emf| {
            move |l: &mut Lowering<'_>| match emf {
                Emf::Folded(held) => held.seen_emf(l, design, word),
                Emf::Known(e) => e,
            }
        });
        let bus = (front.bus, front.third);
        // Of a pair the centred voltages are needed as they are, and of a measured bus before their scaling.
        let lifts = !pair && front.bus.ratio.is_none();
        let limited =
            step.lowering
                .limit_voltage(Priority::of(options.saturation, emf), u, bus, lifts);
        let (command, applied) = match front.commutation {
            None => (step.lowering.modulate(limited, front.bus, shifts), None),
            Some(commutation) => {
                let (command, applied) = step.lowering.modulate_pair(
                    [front.sector, commutation.flag],
                    u,
                    limited,
                    front.bus,
                    shifts,
                );
                (command, Some(applied))
            }
        };
        step.remember(&front, &command, Some(limited.u), applied, vec![]);
    })
}
