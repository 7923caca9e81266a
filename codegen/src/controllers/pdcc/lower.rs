//! Predictive deadbeat control as IR: the stages of the semantics page strung together.

use super::design::PdccDesign;
use super::{EmfSource, Modulation, PdccSpec, Reference, Saturation};
use crate::diagnostics::engineering;
use crate::ir::{Interval, Program, StateId, Value};
use crate::lower::set_point::{SetPointWords, setters};
use crate::lower::{
    Applied, Bus, Coefficient, Currents, LimitRule, Lowering, OffLeg, PairModulation, RotorWords,
    Scale, SupervisorWords, product_bound, round_down,
};
use crate::scaling::Lowered;
use crate::spec::Spec;

/// State words of the control law, each only where the variant needs it.
struct Words {
    supervisor: SupervisorWords,
    direction: Option<StateId>,
    rotor: Option<RotorWords>,
    pair: Option<PairModulation>,
    i_prev: Option<[StateId; 2]>,
    v_cmd: Option<[StateId; 2]>,
    t_cmd: Option<([StateId; 3], StateId)>,
    v_prev: Option<[StateId; 2]>,
    e_prev: Option<[StateId; 2]>,
}

/// Lowers the controller at a scale.
pub fn lower(spec: &Spec, options: &PdccSpec, design: &PdccDesign, scale: Scale) -> Lowered {
    let mut program = Program::new(&spec.name);
    let set_point = SetPointWords::new(&mut program, spec, scale, design.k_di);
    let mut lowering = Lowering::new(&mut program, spec, scale);
    let setters = setters(&mut lowering, set_point, design.k_di);
    Step {
        lowering: &mut lowering,
        options,
        design,
        set_point,
    }
    .build();
    let Lowering {
        b,
        formats,
        misfits,
        ..
    } = lowering;
    let step = b.finish();
    program.step = step;
    program.setters = setters;
    Lowered {
        program: program.pruned(),
        formats,
        misfits,
    }
}

struct Step<'l, 'p> {
    lowering: &'l mut Lowering<'p>,
    options: &'l PdccSpec,
    design: &'l PdccDesign,
    set_point: SetPointWords,
}

impl Step<'_, '_> {
    fn build(mut self) {
        let words = self.declare();
        let options = *self.options;
        let l = &mut *self.lowering;
        let currents = l.measure(words.supervisor.offsets);
        let hall = l.read_hall(words.supervisor.sector_prev);
        l.b.set_state(words.supervisor.sector_prev, hall.sector);
        if let Some(direction) = words.direction {
            // Read here, in an open stage: the stage that senses the direction is a guarded one.
            l.b.state(direction);
        }
        let set_point = l.b.param(self.set_point.j);
        let mode = l.supervise(words.supervisor, &currents, &hall, set_point);

        let rotor = words.rotor.map(|rotor| l.track_rotor(rotor, &hall));
        let direction = match (&rotor, words.direction) {
            (Some(rotor), _) => Some(rotor.direction),
            (None, Some(word)) => Some(l.sense_direction(word, &hall)),
            (None, None) => None,
        };
        let sector = match &rotor {
            Some(rotor) if options.advance > 0.0 => {
                l.advanced_sector(options.advance, &hall, rotor)
            }
            _ => hall.sector,
        };
        let commutation = match (words.pair, direction) {
            (Some(pair), Some(direction)) => {
                let inputs = [sector, direction, set_point];
                Some(l.commutation(
                    pair,
                    inputs,
                    &currents,
                    options.commutation_threshold,
                    options.commutation_timeout,
                ))
            }
            _ => None,
        };
        let reference = match (&rotor, options.reference) {
            (Some(rotor), Reference::Proportional) => {
                l.proportional_reference(rotor, set_point, options.delay)
            }
            _ => l.quasi_square_reference(sector, set_point),
        };
        let third = self.third();
        let bus = self.lowering.read_bus(self.set_point);
        let now = self.applied_now(&words, &currents, bus, third);
        let (e, e_now) = if let (Some(rotor), EmfSource::Model) = (&rotor, options.emf) {
            let flux = self.lowering.flux_model();
            let e_limit = self.design.e_limit;
            let e = self.lowering.model_emf(flux, rotor, options.delay, e_limit);
            (e.target, e.present)
        } else {
            // An estimate is taken as constant over both periods.
            let e = self.estimate_emf(&words, &currents);
            (e, e)
        };
        let u = self.deadbeat(reference, &currents, now, e, e_now);
        let rule = match options.saturation {
            Saturation::KeepAngle => LimitRule::KeepAngle,
            Saturation::Nearest => LimitRule::Nearest,
            Saturation::TorquePriority => LimitRule::TorquePriority,
        };
        let limited = self.lowering.limit_voltage(rule, u, e, bus, third);
        let mut remembered: Vec<(StateId, &str, Value)> = vec![];
        let command = match commutation {
            None => {
                let command = self.lowering.modulate(limited, bus);
                if let Some(v_cmd) = words.v_cmd {
                    remembered.push((v_cmd[0], "v_a_cmd_next", limited.u[0]));
                    remembered.push((v_cmd[1], "v_b_cmd_next", limited.u[1]));
                }
                if let Some(v_prev) = words.v_prev {
                    let applied = now.unwrap_or(limited.u);
                    remembered.push((v_prev[0], "v_a_prev_next", applied[0]));
                    remembered.push((v_prev[1], "v_b_prev_next", applied[1]));
                }
                command
            }
            Some([flag, word, age]) => {
                let (command, applied) =
                    self.lowering.modulate_pair([sector, flag], u, limited, bus);
                if let Some(pair) = words.pair {
                    self.lowering.b.set_state(pair.sector_prev, sector);
                    remembered.push((pair.commutating, "commutating_next", word));
                    remembered.push((pair.age, "commutation_age_next", age));
                }
                if let Some((terminals, off)) = words.t_cmd {
                    for ((state, name), value) in terminals
                        .into_iter()
                        .zip(["t_a_cmd_next", "t_b_cmd_next", "t_c_cmd_next"])
                        .zip(applied.terminals)
                    {
                        remembered.push((state, name, value));
                    }
                    remembered.push((off, "off_cmd_next", applied.off));
                }
                if let Some(v_prev) = words.v_prev {
                    let volts = match now {
                        Some(now) => now,
                        None => self.lowering.applied_voltage(
                            ["v_a_applied", "v_b_applied"],
                            applied,
                            &currents,
                            e,
                            &OffLeg {
                                bus,
                                third,
                                threshold: options.commutation_threshold,
                            },
                        ),
                    };
                    remembered.push((v_prev[0], "v_a_prev_next", volts[0]));
                    remembered.push((v_prev[1], "v_b_prev_next", volts[1]));
                }
                command
            }
        };
        if let Some(e_prev) = words.e_prev {
            remembered.push((e_prev[0], "e_a_prev_next", e[0]));
            remembered.push((e_prev[1], "e_b_prev_next", e[1]));
        }
        let l = &mut *self.lowering;
        if let Some(i_prev) = words.i_prev {
            l.b.set_state(i_prev[0], currents.phases[0]);
            l.b.set_state(i_prev[1], currents.phases[1]);
        }
        l.hold_unless_running(mode, &command, &remembered);
    }

    fn third(&mut self) -> Coefficient {
        let word = self.options.word;
        self.lowering
            .coefficient("k_third", 1.0 / 3.0, word, "Mean of three legs.", "1/3")
    }

    /// Largest zero-sum phase EMF that an estimate can reach, words of voltage: the applied voltage, the
    /// believed current change and the resistive drop at their limits.
    fn e_bound(&mut self) -> i64 {
        let (design, options) = (self.design, self.options);
        if options.emf == EmfSource::Model {
            return self.lowering.volts_word(design.e_limit);
        }
        let scale = self.lowering.scale;
        let di_max = self.di_max();
        let volts_per_word = scale.voltage() / scale.current();
        let change = product_bound(design.k_di * volts_per_word, options.word, di_max);
        let span = self.lowering.current_span();
        let drop = product_bound(design.k_r * volts_per_word, options.word, span);
        self.lowering.bus_interval().high + change + drop
    }

    fn di_max(&self) -> i64 {
        round_down(self.design.di_max * self.lowering.scale.current()) as i64
    }

    fn declare(&mut self) -> Words {
        let options = *self.options;
        let pair = options.modulation == Modulation::Pair;
        let needs_rotor = options.emf == EmfSource::Model
            || options.advance > 0.0
            || options.reference == Reference::Proportional;
        let estimated = options.emf == EmfSource::Estimated;
        let e_bound = self.e_bound();
        let l = &mut *self.lowering;
        let current = Interval::symmetric(l.current_span());
        let bus = l.bus_interval().high;
        let volts = Interval::symmetric(bus);
        let supervisor = l.supervisor_words();
        let rotor = needs_rotor.then(|| l.rotor_words());
        let direction = (pair && !needs_rotor).then(|| l.direction_word());
        let pair_words = pair.then(|| l.pair_words(options.commutation_timeout));
        let i_prev = estimated.then(|| {
            ["i_a_prev", "i_b_prev"].map(|name| {
                l.state(
                    name,
                    0,
                    current,
                    "Current of the last sample, words of current.",
                )
            })
        });
        let v_cmd = (options.delay == 1 && !pair).then(|| {
            ["v_a_cmd", "v_b_cmd"].map(|name| {
                l.state(
                    name,
                    0,
                    volts,
                    "Limited voltage of the last step, applied during this period.",
                )
            })
        });
        let t_cmd = (options.delay == 1 && pair).then(|| {
            let terminals = ["t_a_cmd", "t_b_cmd", "t_c_cmd"].map(|name| {
                l.state(
                    name,
                    0,
                    Interval::new(0, bus),
                    "Terminal voltage of the last step's command; of an off leg 0.",
                )
            });
            (
                terminals,
                l.state(
                    "off_cmd",
                    0,
                    Interval::new(0, 3),
                    "Leg that the last step's command turns off: 1 a, 2 b, 3 c, 0 none.",
                ),
            )
        });
        let v_prev = estimated.then(|| {
            ["v_a_prev", "v_b_prev"].map(|name| {
                l.state(
                    name,
                    0,
                    volts,
                    "Voltage applied during the period that just ended.",
                )
            })
        });
        let remembers_e =
            (pair && (options.delay == 1 || estimated)) || (estimated && options.emf_filter < 1.0);
        let e_prev = remembers_e.then(|| {
            ["e_a_prev", "e_b_prev"].map(|name| {
                l.state(
                    name,
                    0,
                    Interval::symmetric(e_bound),
                    "EMF of the last step.",
                )
            })
        });
        Words {
            supervisor,
            direction,
            rotor,
            pair: pair_words,
            i_prev,
            v_cmd,
            t_cmd,
            v_prev,
            e_prev,
        }
    }

    /// The voltage that the inverter applies in the period that begins now (delay 1).
    fn applied_now(
        &mut self,
        words: &Words,
        currents: &Currents,
        bus: Bus,
        third: Coefficient,
    ) -> Option<[Value; 2]> {
        let l = &mut *self.lowering;
        if let Some(v_cmd) = words.v_cmd {
            return Some(v_cmd.map(|word| l.b.state(word)));
        }
        let (terminals, off) = words.t_cmd?;
        let e_prev = words.e_prev?;
        let applied = Applied {
            terminals: terminals.map(|word| l.b.state(word)),
            off: l.b.state(off),
        };
        let e = e_prev.map(|word| l.b.state(word));
        Some(l.applied_voltage(
            ["v_a_now", "v_b_now"],
            applied,
            currents,
            e,
            &OffLeg {
                bus,
                third,
                threshold: self.options.commutation_threshold,
            },
        ))
    }

    fn estimate_emf(&mut self, words: &Words, currents: &Currents) -> [Value; 2] {
        let (options, design) = (*self.options, self.design.clone());
        let di_max = self.di_max();
        let e_bound = self.e_bound();
        let l = &mut *self.lowering;
        let per_word = l.scale.voltage() / l.scale.current();
        let physical = engineering(design.k_di, "V/A");
        let k_di = l.coefficient(
            "k_di",
            design.k_di * per_word,
            options.word,
            "K = 1/b: voltage over one period per change of current.",
            &format!("K = {physical}"),
        );
        let k_r = l.coefficient(
            "k_r",
            design.k_r * per_word,
            options.word,
            "(1 - a)/b = R: resistive drop.",
            &format!("R = {}", engineering(design.k_r, "ohm")),
        );
        let filter = (options.emf_filter < 1.0).then(|| {
            l.coefficient(
                "k_filter",
                options.emf_filter,
                options.word,
                "Weight of the new estimate in the EMF filter.",
                &format!("{}", options.emf_filter),
            )
        });
        l.b.stage(
            "estimate_emf",
            &[
                "EMF of the period that just ended: e = v - K (i - i_prev) - R i_prev (the paper's (9), causal form).",
                "",
                "v is the voltage really applied; a change of current larger than the bus can cause is not believed.",
            ],
        );
        let (Some(i_prev), Some(v_prev)) = (words.i_prev, words.v_prev) else {
            return [currents.phases[0], currents.phases[1]];
        };
        [0, 1].map(|x| {
            let previous = l.b.state(i_prev[x]);
            let change = l.b.sub(currents.phases[x], previous);
            let doc = "Largest change of current in one period that is believed, words of current.";
            let (low, high) = (
                l.number("di_min", -di_max, doc),
                l.number("di_max", di_max, doc),
            );
            let change = l.b.clamp(change, low, high);
            l.b.name(["di_a", "di_b"][x], change);
            let applied = l.b.state(v_prev[x]);
            let rise = l.times(k_di, change);
            let drop = l.times(k_r, previous);
            let rest = l.b.sub(applied, rise);
            let seen = l.b.sub(rest, drop);
            let names = ["e_a", "e_b"];
            match (filter, words.e_prev) {
                (Some(filter), Some(e_prev)) => {
                    l.b.name(["e_a_seen", "e_b_seen"][x], seen);
                    let old = l.b.state(e_prev[x]);
                    let news = l.b.sub(seen, old);
                    let part = l.times(filter, news);
                    let filtered = l.b.add(old, part);
                    // A weighted mean never leaves the interval of its parts; the clamp is for the proof.
                    let doc = "Largest EMF that an estimate can reach, words of voltage.";
                    let (low, high) = (
                        l.number("e_min", -e_bound, doc),
                        l.number("e_max", e_bound, doc),
                    );
                    let held = l.b.clamp(filtered, low, high);
                    l.b.name(names[x], held)
                }
                _ => l.b.name(names[x], seen),
            }
        })
    }

    fn deadbeat(
        &mut self,
        reference: [Value; 2],
        currents: &Currents,
        now: Option<[Value; 2]>,
        e: [Value; 2],
        e_now: [Value; 2],
    ) -> [Value; 2] {
        let (options, design) = (*self.options, self.design.clone());
        let l = &mut *self.lowering;
        let per_word = l.scale.voltage() / l.scale.current();
        let power = if options.delay == 1 { "K a^2" } else { "K a" };
        let k_hold = l.coefficient(
            "k_hold",
            design.k_hold * per_word,
            options.word,
            "What the present current still contributes when the voltage takes effect.",
            &format!("{power} = {}", engineering(design.k_hold, "V/A")),
        );
        let k_decay = (options.delay == 1).then(|| {
            l.coefficient(
                "k_decay",
                design.k_decay,
                options.word,
                "Share of current lost in one period.",
                &format!("1 - a = {:.6}", design.k_decay),
            )
        });
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
        [0, 1].map(|x| {
            let held = l.times(k_hold, currents.phases[x]);
            let open = l.b.sub(reference[x], held);
            let volts = match (k_decay, now) {
                (Some(k_decay), Some(now)) => {
                    let driving = l.b.sub(now[x], e_now[x]);
                    let lost = l.times(k_decay, driving);
                    let open = l.b.add(open, lost);
                    let open = l.b.add(open, e[x]);
                    let open = l.b.add(open, e_now[x]);
                    l.b.sub(open, now[x])
                }
                _ => l.b.add(open, e[x]),
            };
            l.b.name(["u_a_unsat", "u_b_unsat"][x], volts)
        })
    }
}
