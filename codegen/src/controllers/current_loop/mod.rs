//! The step that all controllers share: from the sample to the voltage asked for, and what the next
//! step needs to know (semantics page of predictive deadbeat, steps 1 to 9 and 12).

mod dead_time;
mod design;
mod emf;
mod held;
mod observer;
mod stability;
mod words;

pub use design::LoopDesign;
pub use held::{Held, LeftOver};
pub use stability::{LinearLoop, StableRange, estimate};
pub use words::{EmfUse, Needs, Words};

use crate::ir::{Program, StateId, Value};
use crate::lower::set_point::{SetPointWords, setters};
use crate::lower::{
    Applied, Bus, Coefficient, Command, Commutation, Corner, Currents, Lowering, OffLeg, Scale,
};
use crate::scaling::Lowered;
use crate::spec::{BusSource, EmfSource, LoopOptions, Reference, Spec};

/// Lowers a controller at a scale: `law` builds its step; `stiffness` is the set-point's weight in V/A.
pub fn lower_with(
    spec: &Spec,
    scale: Scale,
    stiffness: f64,
    law: impl FnOnce(&mut Lowering, SetPointWords),
) -> Lowered {
    let mut program = Program::new(&spec.name);
    let set_point = SetPointWords::new(&mut program, spec, scale, stiffness);
    let mut lowering = Lowering::new(&mut program, spec, scale);
    let setters = setters(&mut lowering, set_point);
    law(&mut lowering, set_point);
    let Lowering {
        b,
        formats,
        misfits,
        long_products,
        ..
    } = lowering;
    let step = b.finish();
    program.step = step;
    program.setters = setters;
    Lowered {
        program: program.pruned(),
        formats,
        misfits,
        long_products,
    }
}

/// Share that the integral of a modelled EMF takes over in a period of what the model lacks: slow against the
/// current, quick against the commutations of an EMF whose constant is off.
pub const EMF_INTEGRAL_SHARE: f64 = 0.125;

/// A step under construction.
pub struct CurrentLoop<'l, 'p> {
    /// The builder.
    pub lowering: &'l mut Lowering<'p>,
    /// Shared options.
    pub options: &'l LoopOptions,
    /// Coefficients in SI units.
    pub design: &'l LoopDesign,
    /// What the law needs.
    pub needs: Needs,
}

/// The deadbeat voltage.
#[derive(Clone, Copy, Debug)]
pub struct Deadbeat {
    /// Voltages of phases a and b, not limited.
    pub u: [Value; 2],
    /// Shifts of the compare values against the dead time, where the law compensates it.
    pub shifts: Option<[Value; 3]>,
}

/// What the shared part of a step knows.
pub struct Front {
    /// State words.
    pub words: Words,
    /// Phase currents.
    pub currents: Currents,
    /// Sector in force, with its advance.
    pub sector: Value,
    /// Direction of rotation, 1 or -1; where the law follows commutations or the rotor.
    pub direction: Option<Value>,
    /// Set-point as a voltage word.
    pub set_point: Value,
    /// The commutation; where the law follows it.
    pub commutation: Option<Commutation>,
    /// Reference as voltage words, phases a, b.
    pub reference: [Value; 2],
    /// 1/3.
    pub third: Coefficient,
    /// The bus.
    pub bus: Bus,
    /// Voltage applied in the period that begins now, where the step needs it.
    pub now: Option<[Value; 2]>,
    /// EMF over the target period; none where the law needs no EMF.
    pub e: Option<[Value; 2]>,
    /// EMF over the period that begins now.
    pub e_now: Option<[Value; 2]>,
    /// The same as the next step shall compare it with what it sees.
    pub e_expected: Option<[Value; 2]>,
    /// What the modelled EMF lacks; where the law integrates that.
    pub integral: Option<[Value; 2]>,
    /// The folded words; where the EMF is held.
    pub held: Option<Held>,
    /// Integral of the speed regulator, and its state; with a speed loop.
    pub speed_integral: Option<(StateId, Value)>,
}

/// Names the voltage of phase `x`, 0 or 1, that the law asks for, and states its error.
fn asked_for(l: &mut Lowering<'_>, x: usize, volts: Value) -> Value {
    let doc = "Voltage of a phase that the law asks for, before the limit";
    let word = 1.0 / l.scale.voltage();
    l.b.state_error("voltage", volts, [doc, "V"], word);
    l.b.name(["u_a_unsat", "u_b_unsat"][x], volts)
}

/// State words and their new values.
pub type Remembered = Vec<(StateId, Value)>;

impl CurrentLoop<'_, '_> {
    /// Steps 1 to 8.
    pub fn front(&mut self, set_point: SetPointWords) -> Front {
        let words = self.declare(set_point);
        let options = *self.options;
        let l = &mut *self.lowering;
        let sample = l.sample();
        let word = words.sector_prev;
        let hall = word.map(|word| l.find_sector(&sample, word));
        // Read here, in an open stage: the stage that senses the direction is a guarded one.
        for word in words
            .direction
            .into_iter()
            .chain(words.pair.map(|pair| pair.left))
        {
            l.b.state(word);
        }
        let rotor = words.rotor.zip(hall.as_ref());
        let rotor = rotor.map(|(words, hall)| l.track_rotor(words, hall, sample.hall_ticks));
        let timeout = options.commutation_timeout;
        let advances = options.advance > 0.0;
        // Without an angle the commutation begins where the direction is sensed, at an edge, which is rare.
        let (direction, kept) = match (&rotor, words.direction, &hall) {
            (None, Some(word), Some(hall)) => {
                let commutation = words.pair.map(|pair| (pair.left, timeout));
                let (direction, kept) = l.sense_direction(word, hall, commutation);
                (Some(direction), kept)
            }
            // With an angle the edge is looked at in every period.
            (rotor, _, hall) => {
                if let Some(hall) = hall {
                    l.b.set_state(hall.sector_prev_word, hall.sector);
                }
                (rotor.as_ref().map(|rotor| rotor.direction), None)
            }
        };
        let ahead = match (&rotor, &hall) {
            (Some(rotor), Some(hall)) if advances => {
                Some(l.advanced_sector(options.advance, hall.sector, rotor))
            }
            _ => None,
        };
        l.b.end_tracking();
        let currents = l.third_current(&sample);
        let sector_seen = match hall {
            Some(hall) => hall.sector,
            None => l.sector_of(&sample),
        };
        let sector = ahead.unwrap_or(sector_seen);
        let j = l.b.param(set_point.j);
        let regulated = match (options.speed, set_point.speed, words.speed, &rotor) {
            (Some(options), Some(words), Some(state), Some(rotor)) => {
                let inputs = [rotor.direction, rotor.omega, j];
                Some(l.regulate_speed(options, set_point.stiffness, words, state, inputs))
            }
            _ => None,
        };
        let j = regulated.map_or(j, |regulated| regulated.j);
        let (commutation, outgoing) = match (words.pair, direction.zip(hall)) {
            (Some(pair), Some((direction, hall))) => {
                let kept = kept.unwrap_or_else(|| {
                    let began = pair
                        .sector_prev
                        .map_or(hall.edge, |word| l.sector_in_force_changed(word, sector));
                    let left = l.b.state(pair.left);
                    l.commutation_kept(began, left, timeout)
                });
                let (commutation, outgoing) = l.commutation(
                    [sector, kept, direction, j],
                    pair.left,
                    &currents,
                    options.commutation_threshold,
                    timeout,
                );
                (Some(commutation), Some(outgoing))
            }
            _ => (None, None),
        };
        // Ahead of the reference, so that its product with a sign is added last, by one instruction.
        let held = self.holds_emf().then(|| self.held(currents.phases));
        let l = &mut *self.lowering;
        // Where the sector is the sample's own, its code leads to the corner straight away; an invalid one turns the
        // legs off.
        let corner = if advances {
            Corner::Sector(sector)
        } else {
            Corner::HallCode(sample.hall)
        };
        let reference = match (&rotor, options.reference) {
            (Some(rotor), Reference::Proportional) => {
                l.proportional_reference(rotor, j, options.delay)
            }
            _ => l.quasi_square_reference(corner, j),
        };
        let third = l.coefficient(
            "k_third",
            1.0 / 3.0,
            options.word,
            "Mean of three legs.",
            "1/3",
        );
        let bus = l.read_bus(set_point);
        // Read here, in an open stage: the last one of the EMF may be a guarded one.
        let commanded = words.v_cmd.map(|word| word.map(|word| l.b.state(word)));
        let terminals = self.commanded_terminals(&words);
        let emf = self.emf(
            &words,
            &currents,
            sector_seen,
            rotor.as_ref(),
            third,
            outgoing,
        );
        let (e, e_now) = (emf.map(|emf| emf.target), emf.map(|emf| emf.present));
        let speed = regulated.as_ref().map(|regulated| regulated.speed);
        let speed = speed.or_else(|| rotor.as_ref().map(|rotor| rotor.step_angle));
        // Of the target period, where the law goes by that.
        let believed = if self.needs.emf == EmfUse::Prediction {
            e_now
        } else {
            e
        };
        self.tell(believed, speed);
        let off_leg = self.off_leg_of(bus, third);
        let now = commanded.or_else(|| self.applied_now(terminals, &currents, e_now, &off_leg));
        Front {
            words,
            currents,
            sector,
            direction,
            set_point: j,
            commutation,
            reference,
            third,
            bus,
            now,
            e,
            e_now,
            e_expected: emf.map(|emf| emf.expected),
            integral: emf.and_then(|emf| emf.integral),
            held,
            speed_integral: regulated.map(|regulated| regulated.integral),
        }
    }

    /// Tells people what the law knows of the motor.
    fn tell(&mut self, e: Option<[Value; 2]>, speed: Option<Value>) {
        let b = &mut self.lowering.b;
        if let Some([e_a, e_b]) = e {
            b.tell("e_a", e_a);
            b.tell("e_b", e_b);
        }
        if let Some(speed) = speed {
            b.tell("speed", speed);
        }
    }

    /// Whether the law predicts with the EMF of the last period.
    fn holds_emf(&self) -> bool {
        self.needs.predicts() && self.options.emf == EmfSource::Held
    }

    /// Whether tables have what a whole vector leaves to later steps: with a fixed bus that is known beforehand.
    pub fn tables_left_over(&self) -> bool {
        self.holds_emf() && matches!(self.lowering.spec.inverter.bus, BusSource::Fixed)
    }

    /// Where an off leg's terminal sits.
    pub fn off_leg(&self, front: &Front) -> OffLeg {
        self.off_leg_of(front.bus, front.third)
    }

    fn off_leg_of(&self, bus: Bus, third: Coefficient) -> OffLeg {
        OffLeg {
            bus,
            third,
            threshold: self.options.commutation_threshold,
        }
    }

    /// The last step's command, where it may have turned a leg off.
    fn commanded_terminals(&mut self, words: &Words) -> Option<Applied> {
        let b = &mut self.lowering.b;
        words.t_cmd.map(|(terminals, off)| Applied {
            terminals: terminals.map(|word| b.state(word)),
            off: b.state(off),
        })
    }

    /// The voltage that a command which may turn a leg off applies in the period that begins now (delay 1),
    /// with the EMF of that period.
    fn applied_now(
        &mut self,
        commanded: Option<Applied>,
        currents: &Currents,
        e_now: Option<[Value; 2]>,
        off_leg: &OffLeg,
    ) -> Option<[Value; 2]> {
        let names = ["v_a_now", "v_b_now"];
        let (commanded, e_now) = (commanded?, e_now?);
        Some(
            self.lowering
                .applied_voltage(names, commanded, currents, e_now, off_leg),
        )
    }

    /// Shifts against the dead time where no deadbeat term holds the present current by itself.
    fn shifts_of_held(&mut self, reference: [Value; 2], currents: &Currents) -> [Value; 3] {
        let k_hold = self.hold();
        let l = &mut *self.lowering;
        l.b.stage(
            "hold_current",
            &["What the present current still contributes when the voltage takes effect."],
        );
        let held = [0, 1].map(|x| {
            let held = l.times(k_hold, currents.phases[x]);
            l.b.name(["held_a", "held_b"][x], held)
        });
        self.dead_time_shifts(reference, held, self.design.k_di)
    }

    /// The weight of the present current when the voltage takes effect.
    fn hold(&mut self) -> Coefficient {
        let delayed = self.options.delay == 1;
        self.lowering.impedance(
            "k_hold",
            self.design.k_hold,
            self.options.word,
            "What the present current still contributes when the voltage takes effect.",
            [if delayed { "K a^2" } else { "K a" }, "V/A"],
        )
    }

    /// Step 9: the deadbeat voltage of phases a, b, with shifts against the dead time where it is compensated.
    pub fn deadbeat(&mut self, front: &Front, compensates: bool) -> Deadbeat {
        let (reference, currents, now) = (front.reference, &front.currents, front.now);
        let (options, design) = (*self.options, self.design);
        if let Some(held) = &front.held {
            let u = self.held_voltage(held, reference);
            let shifts = compensates.then(|| self.shifts_of_held(reference, currents));
            return Deadbeat { u, shifts };
        }
        let k_hold = self.hold();
        let l = &mut *self.lowering;
        let k_decay = (options.delay == 1).then(|| design.decay(l, options.word));
        let doc: &[&str] = if options.delay == 1 {
            &[
                "Deadbeat voltage, the paper's (11) corrected: v = K (i_ref - a i_pred) + e, with the prediction",
                "i_pred = a i + b (v_now - e_now) of (7) folded in:",
                "v = K i_ref - K a^2 i + (1 - a)(v_now - e_now) + e + e_now - v_now.",
            ]
        } else {
            &["Deadbeat voltage without computation delay: v = K (i_ref - a i) + e."]
        };
        l.b.stage("deadbeat_voltage", doc);
        let found = [0, 1].map(|x| {
            let held = l.times(k_hold, currents.phases[x]);
            if compensates {
                l.b.name(["held_a", "held_b"][x], held);
            }
            let open = l.b.sub(reference[x], held);
            let volts = match (k_decay, now, front.e, front.e_now) {
                (Some(k_decay), Some(now), Some(e), Some(e_now)) => {
                    let driving = l.b.sub(now[x], e_now[x]);
                    let lost = l.times(k_decay, driving);
                    let open = l.b.add(open, lost);
                    let open = l.b.add(open, e[x]);
                    let open = l.b.add(open, e_now[x]);
                    l.b.sub(open, now[x])
                }
                (_, _, Some(e), _) => l.b.add(open, e[x]),
                _ => open,
            };
            [held, asked_for(l, x, volts)]
        });
        let held = found.map(|[held, _]| held);
        let shifts = compensates.then(|| self.dead_time_shifts(reference, held, design.k_di));
        let u = found.map(|[_, u]| u);
        Deadbeat { u, shifts }
    }

    /// Step 12: closes the step. `v_cmd` are the commanded voltages; `applied` are the terminals instead, where a
    /// command may turn a leg off whose real voltage counts.
    pub fn remember(
        &mut self,
        front: &Front,
        command: &Command,
        v_cmd: Option<[Value; 2]>,
        applied: Option<Applied>,
        mut remembered: Remembered,
    ) {
        let words = &front.words;
        if let (Some(held), Some(u)) = (&front.held, v_cmd) {
            let left_over = self.left_over(held, u);
            remembered.extend(self.fold(held, left_over));
        }
        if let Some((state, integral)) = front.speed_integral {
            remembered.push((state, integral));
        }
        if let (Some(commutation), Some(pair)) = (front.commutation, words.pair) {
            if let Some(sector_prev) = pair.sector_prev {
                remembered.push((sector_prev, front.sector));
            }
            remembered.push((pair.left, commutation.left));
        }
        if let (Some((terminals, off)), Some(applied)) = (words.t_cmd, applied) {
            remembered.extend(terminals.into_iter().zip(applied.terminals));
            remembered.push((off, applied.off));
        }
        if let (Some(words), Some(v_cmd)) = (words.v_cmd, v_cmd) {
            remembered.push((words[0], v_cmd[0]));
            remembered.push((words[1], v_cmd[1]));
        }
        if let Some(v_prev) = words.v_prev {
            let volts = match (front.now, applied, front.e) {
                (Some(now), ..) => Some(now),
                (None, Some(applied), Some(e)) => {
                    let off_leg = self.off_leg(front);
                    let names = ["v_a_applied", "v_b_applied"];
                    let currents = &front.currents;
                    Some(
                        self.lowering
                            .applied_voltage(names, applied, currents, e, &off_leg),
                    )
                }
                _ => v_cmd,
            };
            if let Some(volts) = volts {
                remembered.push((v_prev[0], volts[0]));
                remembered.push((v_prev[1], volts[1]));
            }
        }
        if let Some(off_prev) = words.off_prev {
            let off = match (words.t_cmd, applied) {
                (Some((_, off_cmd)), _) => Some(self.lowering.b.state(off_cmd)),
                (None, applied) => applied.map(|applied| applied.off),
            };
            remembered.extend(off.map(|off| (off_prev, off)));
        }
        if let (Some(e_prev), Some(e)) = (words.e_prev, front.e_expected) {
            remembered.push((e_prev[0], e[0]));
            remembered.push((e_prev[1], e[1]));
        }
        if let (Some(words), Some(integral)) = (words.integral, front.integral) {
            remembered.push((words[0], integral[0]));
            remembered.push((words[1], integral[1]));
        }
        if let Some(i_prev) = words.i_prev {
            remembered.push((i_prev[0], front.currents.phases[0]));
            remembered.push((i_prev[1], front.currents.phases[1]));
        }
        self.lowering.close_step(command, &remembered);
    }
}
