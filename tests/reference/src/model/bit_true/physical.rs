//! The bit-true model's signals in physical units, not part of its arithmetic.

use super::bus_current::BusCurrent;
use super::constants::Constants;
use super::law::phcc::in_due;
use super::parts::Part;
use super::state::State;
use super::{BitTrue, Signals};
use crate::exact::{both, pow2};
use crate::model::ideal::hall_learning::PlacedEdges;
use crate::model::ideal::torque_learning::LearntTorque;
use crate::model::trace::{Past, PhysicalState, Trace};
use std::f64::consts::TAU;

impl BitTrue {
    /// The current set-point of the word `j`, ampere.
    pub fn set_point_amps(&self) -> f64 {
        self.j * self.k.volt / self.gain
    }

    /// Current offsets, ADC counts.
    pub fn offset_counts(&self) -> [f64; 3] {
        self.state.offset.map(|word| word / self.k.count)
    }

    /// Signals of the last step in physical units.
    pub fn trace(&self) -> Trace {
        let Signals {
            i,
            e,
            net,
            u_unsat,
            u,
            theta,
            step_angle,
            sector_eff,
            commutating,
            reach,
            vector,
            run,
        } = self.last;
        let turn = TAU * pow2(-32);
        Trace {
            i: i.map(|word| word * self.k.ampere),
            e: e.map(|word| word * self.k.volt),
            net: net.map(|word| word * self.k.volt),
            u_unsat: u_unsat.map(|word| word * self.k.volt),
            u: u.map(|word| word * self.k.volt),
            theta: theta * turn,
            step_angle: step_angle * turn,
            sector_eff,
            commutating,
            reach,
            vector,
            run,
        }
    }

    /// The whole state in physical units, from which an ideal model can be built.
    pub fn physical_state(&self) -> PhysicalState {
        let integral_ampere = self.speed.as_ref().map_or(0.0, |speed| speed.ampere);
        let slew_ampere = self.slew.map_or(0.0, |slew| slew.ampere);
        let ramp_unit = self.ramp.map_or(0.0, |ramp| ramp.unit);
        let of_bus = self
            .bus_current
            .as_ref()
            .map_or([0.0; 2], BusCurrent::amperes);
        self.state
            .to_physical(&self.k, [integral_ampere, slew_ampere, ramp_unit], of_bus)
    }
}

impl State<f64> {
    /// The state in physical units.
    pub fn to_physical(
        self,
        k: &Constants<f64>,
        [integral_ampere, slew_ampere, ramp_unit]: [f64; 3],
        [withheld_ampere, bus_ampere]: [f64; 2],
    ) -> PhysicalState {
        let volts = |words: [f64; 2]| words.map(|word| word * k.volt);
        let radians = |word: f64| word * TAU * pow2(-32);
        let mut due = self.past.due;
        if !k.parts.has(Part::Hysteresis) {
            let memory = in_due(self.hysteresis);
            due = both(|x| due[x] - memory[x]);
        }
        PhysicalState {
            supervisor: self.supervisor,
            timing: self.timing,
            sector_prev: self.sector_prev,
            sector_eff_prev: self.sector_eff_prev,
            commutation_left: self.commutation_left,
            offset: self.offset.map(|word| word / k.count),
            i_prev: self.i_prev.map(|word| word * k.ampere),
            v_cmd: volts(self.v_cmd),
            t_cmd: self.t_cmd.map(|word| word * k.volt),
            off_cmd: self.off_cmd.checked_sub(1),
            v_prev: volts(self.v_prev),
            off_prev: self.off_prev.checked_sub(1),
            e_prev: volts(self.e_prev),
            e_next: volts(self.e_next),
            net_prev: volts(self.net_prev),
            net_next: volts(self.net_next),
            emf_error: volts(self.emf_error),
            step_angle: radians(self.speed.step),
            learnt: PlacedEdges {
                shifts: self.learnt.shifts.map(radians),
                all: radians(self.learnt.all),
                begin: radians(self.learnt.begin),
                width: radians(self.learnt.width),
            },
            weakening: self.weakening * pow2(-32),
            residual_count: self.residual_count,
            torque: LearntTorque {
                ratio: self.torque.ratio * pow2(-28),
                light: self.torque.light,
            },
            integral: volts(self.integral),
            j_next: volts(self.j_next),
            j_due: volts(self.j_due),
            rises: self
                .hysteresis
                .map(|word| (word != 0.0).then_some(word > 0.0)),
            vector_prev: self.vector_prev.0,
            past: Past {
                due: volts(due),
                later: volts(self.past.later),
            },
            speed_integral: self.speed_integral * integral_ampere,
            speed_in_force: self.speed_in_force * ramp_unit,
            ramp_begun: self.ramp_begun,
            current_in_force: self.j_in_force * slew_ampere,
            current_withheld: self.j_withheld * withheld_ampere,
            line_cmd: self.line_cmd.map(|counts| counts / k.timer_period),
            line_ended: self.line_ended.map(|counts| counts / k.timer_period),
            bus_current: self.i_bus_mean * bus_ampere,
        }
    }
}
