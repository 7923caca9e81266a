//! Predictive deadbeat control as a program: the shared step, the voltage limit and the modulator.
//! The law's voltage is [`CurrentLoop::deadbeat`], which other controllers predict with as well.

use crate::blocks::set_point::Gain;
use crate::blocks::{CommonModeRule, Hexagon, Modulator, Priority, Scale};
use crate::ir::Phases;
use crate::laws::current_loop::{
    CurrentLoop, Deadbeat, EmfUse, Held, LoopDesign, Needs, lower_with,
};
use crate::scaling::Lowered;
use crate::spec::{Modulation, PdccSpec, Spec};

/// Source of the EMF for the voltage limit.
enum LimitEmf<'b> {
    /// The folded words, from which it is computed if the limit acts.
    Held(Held<'b>),
    /// A computed EMF.
    Known(Phases<'b>),
}

impl<'b> LimitEmf<'b> {
    /// The EMF of phases a, b; added to the open stage.
    fn of_phases(self, step: &CurrentLoop<'_, 'b>) -> Phases<'b> {
        match self {
            Self::Held(held) => step.held_emf(&held),
            Self::Known(e) => e,
        }
    }
}

/// Lowers the controller at a scale.
pub(super) fn lower(spec: &Spec, options: &PdccSpec, design: &LoopDesign, scale: Scale) -> Lowered {
    lower_with(spec, scale, Gain::stiffness(design.k_di), |l, set_point| {
        let pair = options.modulation == Modulation::Pair;
        let is_table2 = options.modulation == Modulation::Table2;
        let step = CurrentLoop {
            l,
            options: &options.common,
            design,
            needs: Needs {
                commutation: pair || is_table2,
                off_leg: pair,
                emf: EmfUse::Deadbeat,
                memory: 0,
                rounding: options.rounding_prediction,
            },
        };
        let front = step.front(set_point);
        let Deadbeat { u, held } = step.deadbeat(&front, options.dead_time_compensation);
        let folded = front.held.map(LimitEmf::Held);
        let emf = folded.or(front.e.map(LimitEmf::Known));
        let emf = emf.map(|emf| move || emf.of_phases(&step));
        let priority = Priority::of(options.saturation, emf);
        if let Some(table2) = front.table2(options.zero).filter(|_| is_table2) {
            let modulated = table2.modulate(l, priority, u);
            let (command, u) = (modulated.command, modulated.u);
            step.remember(&front, command, Some(u), None, vec![]);
            return;
        }
        let common_mode = CommonModeRule::new(l, options.common_mode);
        let hexagon = Hexagon {
            bus: common_mode.reach(l, front.bus),
            third: front.third,
            // A pair needs the centred voltages themselves.
            lift: (common_mode.in_limit(front.bus, held.is_some())).filter(|_| !pair),
        };
        let limited = hexagon.limit(l, priority, u);
        let limited = common_mode.second_readable(l, front.third, front.bus, limited);
        let turned = front.turned(l, limited.cut);
        let spread = (!pair).then_some(limited.spread);
        let modulator = Modulator {
            bus: front.bus,
            rounding: options.rounding_prediction.then_some(front.third),
            shifts: held
                .map(|held| step.dead_time_shifts(front.reference, held, design.k_di, spread)),
        };
        let (command, u, applied) = match front.commutation {
            None => {
                let pulsed = modulator.three(l, &limited, common_mode);
                (pulsed.command, pulsed.u, None)
            }
            Some(commutation) => {
                let flag = commutation.flag;
                let (command, applied) = modulator.pair(l, front.sector, flag, u, &limited);
                (command, limited.u, Some(applied))
            }
        };
        step.remember(&front, command, Some(u), applied, turned);
    })
}
