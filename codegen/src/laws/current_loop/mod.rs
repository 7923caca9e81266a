//! The step that all controllers share: from the sample to the deadbeat voltage, and the state for
//! the next step (shared semantics page, steps 1 to 9 and 12).

mod coefficients;
mod dead_time;
mod deadbeat;
mod design;
mod emf;
mod held;
mod observer;
mod residual;
mod stability;
mod words;

pub use deadbeat::{Deadbeat, unlimited_voltage};
pub use design::LoopDesign;
pub use held::{Held, LeftOver};
pub use residual::{Allowance, RESIDUAL_COUNT};
pub use stability::{LinearLoop, SEARCHED, SeenEmf, StableRange};
pub use words::{EmfUse, Needs, Words};

use crate::blocks::set_point::{Gain, SetPointWords};
use crate::blocks::{
    Applied, Bus, Commutation, Corner, Hall, Lowering, OffLeg, ProportionalShape, Rotor, Sample,
    Scale, StepCommand, Table2, Weakened, advanced_sector, find_sector, proportional_reference,
    quasi_square_reference, sample, sector_of, sense_direction, third_current,
};
use crate::ir::{
    Coefficient, Expr, Flag, Memory, Named, Phase, Phases, ProgramBuilder, Told, named,
};
use crate::scaling::Lowered;
use crate::spec::{BusSource, EmfSource, LoopOptions, Reference, Spec, ZeroVector};

/// Lowers a controller at a scale: `law` builds its step; `gain` is that from set-point to voltage.
pub fn lower_with(
    spec: &Spec,
    scale: Scale,
    gain: Gain,
    law: impl for<'b> FnOnce(&Lowering<'b>, &SetPointWords<'b>),
) -> Lowered {
    let builder = ProgramBuilder::new(&spec.name, &["One control period."]);
    let lowering = Lowering::new(&builder, spec, scale);
    let set_point = SetPointWords::new(&lowering, gain);
    set_point.add_setters(&lowering);
    law(&lowering, &set_point);
    let notes = lowering.into_notes();
    Lowered {
        program: builder.finish().pruned(),
        formats: notes.formats,
        misfits: notes.misfits,
        long_products: notes.long_products,
    }
}

/// A step under construction.
#[derive(Clone, Copy)]
pub struct CurrentLoop<'l, 'b> {
    /// ProgramBuilder, specification and scale.
    pub l: &'l Lowering<'b>,
    /// Shared options.
    pub options: &'l LoopOptions,
    /// Coefficients in SI units.
    pub design: &'l LoopDesign,
    /// Needs of the law.
    pub needs: Needs,
}

/// Results of the shared part of a step.
pub struct Front<'b> {
    /// State words.
    pub words: Words<'b>,
    /// Phase currents.
    pub currents: Phases<'b, 3>,
    /// Sector in force, with its advance.
    pub sector: Expr<'b>,
    /// Set-point as a voltage word.
    pub set_point: Expr<'b>,
    /// Commutation state; if the law uses it.
    pub commutation: Option<Commutation<'b>>,
    /// Reference as voltage words, phases a, b.
    pub reference: Phases<'b>,
    /// 1/3.
    pub third: Coefficient,
    /// The bus.
    pub bus: Bus<'b>,
    /// The bus as far as a high leg of a whole vector reaches: less than the bus where each leg must be low for a
    /// while.
    pub reach: Bus<'b>,
    /// Voltage applied in the period that begins now; if the step needs it.
    pub now: Option<Phases<'b>>,
    /// EMF over the target period; if the law needs it.
    pub e: Option<Phases<'b>>,
    /// EMF over the period that begins now; none where the state holds the net voltage of that period.
    pub e_now: Option<Phases<'b>>,
    /// Net voltage of the period that begins now, v - e; with an observer and delay 1.
    pub net: Option<Phases<'b>>,
    /// Error of the modelled EMF, q and d; with an observer only.
    pub emf_error: Option<[Expr<'b>; 2]>,
    /// Counts of the residual watch and of periods that tell the torque constant, and their new values; with
    /// these options only.
    pub counts: [Option<(Memory<'b>, Expr<'b>)>; 2],
    /// How far the reference is turned against the field; with field weakening only.
    pub weakened: Option<Weakened<'b>>,
    /// The folded words; with a held EMF only.
    pub held: Option<Held<'b>>,
    /// Word of the set-point's source, and its new value: the integral of the speed regulator, or the
    /// set-point in force with a slew rate.
    pub of_set_point: Remembered<'b>,
}

/// Results of the tracking, which runs in every period.
struct Tracked<'b> {
    sample: Sample<'b>,
    hall: Option<Hall<'b>>,
    /// The sector seen; where edges or an advance need it.
    sector: Option<Expr<'b>>,
    rotor: Option<Rotor<'b>>,
    /// Direction of rotation, 1 or -1, 0 before the first edge; if the law uses it.
    direction: Option<Expr<'b>>,
    /// Samples left to the commutation; if the direction is sensed without an angle.
    kept: Option<Expr<'b>>,
    /// Advanced sector; with phase advance only.
    ahead: Option<Expr<'b>>,
}

/// The set-point in force.
struct Demanded<'b> {
    /// As a voltage word.
    j: Expr<'b>,
    /// The regulated speed, signed; with a speed loop only.
    speed: Option<Expr<'b>>,
    /// Words of the regulator, or the slewed set-point, and their new values.
    words: Remembered<'b>,
}

/// State words and their new values.
pub type Remembered<'b> = Vec<(Memory<'b>, Expr<'b>)>;

/// The words of phases a and b.
pub fn read(words: [Memory<'_>; 2]) -> Phases<'_> {
    Phases(words.map(Memory::read))
}

/// New values of the words of phases a and b.
pub fn kept<'b>(words: [Memory<'b>; 2], values: Phases<'b>) -> [(Memory<'b>, Expr<'b>); 2] {
    [(words[0], values.a()), (words[1], values.b())]
}

/// Names the voltage less the EMF.
fn net_voltage<'b>(volts: Option<Phases<'b>>, e: Option<Phases<'b>>) -> Option<Phases<'b>> {
    named! {
        let net_now = volts? - e?;
    }
    Some(net_now)
}

impl<'b> Front<'b> {
    /// Voltage less EMF of the period that begins now, with delay 1; added to the open stage.
    pub fn net_now(&self) -> Option<Phases<'b>> {
        self.net.or_else(|| net_voltage(self.now, self.e_now))
    }

    /// The reference's angle against the field for the next step, in a stage of its own; nothing without
    /// field weakening.
    pub fn turned(&self, l: &Lowering<'b>, cut: Flag<'b>) -> Remembered<'b> {
        let turned = self.weakened.map(|weakened| weakened.follow(l, cut));
        turned.into_iter().collect()
    }

    /// The paper's modulator; none without commutations.
    pub fn table2(&self, zero: ZeroVector) -> Option<Table2<'b>> {
        Some(Table2 {
            bus: self.bus,
            third: self.third,
            commutating: self.commutation?.flag,
            sector: self.sector,
            zero,
        })
    }
}

impl<'b> CurrentLoop<'_, 'b> {
    /// Steps 1 to 8.
    pub fn front(&self, set_point: &SetPointWords<'b>) -> Front<'b> {
        let (l, options) = (self.l, self.options);
        let words = self.declare(set_point);
        let tracked = self.track(&words);
        l.b.end_tracking();
        let currents = third_current(l, &tracked.sample);
        let sector_seen = (tracked.sector).unwrap_or_else(|| sector_of(l, &tracked.sample));
        let sector = tracked.ahead.unwrap_or(sector_seen);
        let demand = self.demand(set_point, &words, &tracked);
        let j = demand.j;
        let commutation = self.commutation(&words, &tracked, [sector, j], currents);
        // Before the reference, so that the reference's product with a sign is added last.
        let held = self.holds_emf().then(|| self.held(currents.pair()));
        let (along, shape) = self.reference(&tracked, sector, j);
        let doc = "Mean of three legs.";
        let third = l.coefficient("k_third", 1.0 / 3.0, options.word, doc, "1/3");
        let bus = set_point.read_bus(l);
        let (reference, weakened) = match words.weakening.zip(shape) {
            Some((weakening, shape)) => {
                let (reference, weakened) = weakening.reference(l, &shape, j, along);
                (reference, Some(weakened))
            }
            None => (along, None),
        };
        let outgoing = commutation.map(|commutation| commutation.outgoing);
        let rotor = tracked.rotor.as_ref();
        let turning = (rotor.map(|rotor| (rotor, shape)), j, bus.volts);
        let emf = self.emf(&words, currents, sector_seen, turning, third, outgoing);
        let (e, e_now) = (emf.map(|emf| emf.target), emf.and_then(|emf| emf.present));
        let turned = rotor.filter(|_| self.uses_angle());
        let told_speed = demand.speed.or(turned.map(|rotor| rotor.step_angle));
        self.tell([e, e_now], told_speed);
        let off_leg = self.off_leg(bus, third);
        let commanded = words.v_cmd.map(read);
        let now = commanded.or_else(|| self.applied_now(&words, currents, e_now, &off_leg));
        let net = words.observer.and_then(|observer| {
            let next = observer.net_next.map(read);
            next.or_else(|| net_voltage(now, e_now))
        });
        Front {
            words,
            currents,
            sector,
            set_point: j,
            commutation,
            reference,
            third,
            bus,
            reach: bus,
            now,
            e,
            e_now,
            net,
            emf_error: emf.and_then(|emf| emf.error),
            counts: emf.map_or([None; 2], |emf| emf.counts),
            weakened,
            held,
            of_set_point: demand.words,
        }
    }

    /// The current set-point in force: regulated, slewed, and faded with the bus voltage, as the drive
    /// has it.
    fn demand(
        &self,
        set_point: &SetPointWords<'b>,
        words: &Words<'b>,
        tracked: &Tracked<'b>,
    ) -> Demanded<'b> {
        let l = self.l;
        let j = set_point.j.read();
        let fade = words.fade.zip(set_point.told_bus()).zip(tracked.direction);
        let allowed = fade.map(|((fade, v_bus), direction)| fade.allowed(l, v_bus, direction));
        let allowed = match words.bus_current {
            Some(limit) => Some(limit.allowed(l, allowed)),
            None => allowed,
        };
        let regulated = words.speed.zip(tracked.rotor);
        let regulated =
            regulated.map(|(regulator, rotor)| regulator.regulate(l, &rotor, j, allowed));
        let slewed = words.slew.map(|slew| slew.follow(l, j));
        let j = match (&regulated, slewed) {
            (Some(regulated), _) => regulated.j,
            (None, slewed) => {
                let j = slewed.map_or(j, |(slewed, _)| slewed);
                allowed.map_or(j, |allowed| allowed.limit(j).named("j_faded"))
            }
        };
        Demanded {
            j,
            speed: regulated.as_ref().map(|regulated| regulated.speed),
            words: match (regulated, slewed) {
                (Some(regulated), _) => regulated.words,
                (None, slewed) => slewed.map(|(_, word)| word).into_iter().collect(),
            },
        }
    }

    /// Steps 1, 2 and 4: the sector, direction, angle and speed.
    fn track(&self, words: &Words<'b>) -> Tracked<'b> {
        let l = self.l;
        let sample = sample(l);
        let hall = words.sector_prev.map(|word| find_sector(l, &sample, word));
        let mut tracked = Tracked {
            sample,
            hall,
            sector: hall.map(|hall| hall.sector),
            rotor: None,
            direction: None,
            kept: None,
            ahead: None,
        };
        if let Some((speed, angle)) = words.angle.zip(sample.angle) {
            let rotor = speed.track(l, angle);
            if let Some(hall) = hall {
                hall.sector_prev.set(hall.sector);
            }
            self.follow_rotor(&mut tracked, words, rotor);
            return tracked;
        }
        let Some(hall) = hall else {
            return tracked;
        };
        if let Some(timing) = words.rotor {
            // With an angle, edges are evaluated in every period.
            let across = words.observer.map(|observer| observer.emf_error[1]);
            let rotor = timing.track(l, &hall, &tracked.sample, across);
            hall.sector_prev.set(hall.sector);
            self.follow_rotor(&mut tracked, words, rotor);
        } else if let Some(direction) = words.direction {
            // Without an angle the commutation begins in the stage that senses the direction, at a
            // rare edge.
            let (direction, kept) = sense_direction(l, direction, &hall, words.pair);
            tracked.direction = Some(direction);
            tracked.kept = kept;
        } else {
            hall.sector_prev.set(hall.sector);
        }
        tracked
    }

    /// What the rotor's angle and speed tell.
    fn follow_rotor(&self, tracked: &mut Tracked<'b>, words: &Words<'b>, rotor: Rotor<'b>) {
        let (l, advance) = (self.l, self.options.advance);
        if advance > 0.0 {
            let sector = tracked.sector;
            let seen = sector.unwrap_or_else(|| sector_of(l, &tracked.sample));
            tracked.sector = Some(seen);
            tracked.ahead = Some(advanced_sector(l, advance, seen, &rotor));
        }
        if let Some((learning, observer)) = words.torque.zip(words.observer) {
            let [along, _] = observer.emf_error;
            learning.learn(l, &rotor, along.read());
        }
        tracked.direction = Some(rotor.direction);
        tracked.rotor = Some(rotor);
    }

    /// Step 5.
    fn commutation(
        &self,
        words: &Words<'b>,
        tracked: &Tracked<'b>,
        [sector, j]: [Expr<'b>; 2],
        currents: Phases<'b, 3>,
    ) -> Option<Commutation<'b>> {
        let (rule, direction, hall) = (words.pair?, tracked.direction?, tracked.hall?);
        let kept = tracked.kept.unwrap_or_else(|| {
            let last = rule.sector_prev;
            let changed = last.map(|last| rule.sector_changed(self.l, last, sector));
            rule.kept(self.l, changed.unwrap_or(hall.edge))
        });
        Some(rule.follow(self.l, [sector, kept, direction, j], currents))
    }

    /// Step 6: the reference, and with an angle the shape of the proportional one.
    fn reference(
        &self,
        tracked: &Tracked<'b>,
        sector: Expr<'b>,
        set_point: Expr<'b>,
    ) -> (Phases<'b>, Option<ProportionalShape<'b>>) {
        let (l, options) = (self.l, self.options);
        let is_proportional = options.reference == Reference::Proportional;
        let shape = tracked.rotor.filter(|_| is_proportional || self.observes()).map(|rotor| {
            if is_proportional {
                let doc = "Reference parallel to the EMF at the end of the target period: constant torque at least copper loss.";
                l.b.stage("reference_proportional", &[doc]);
            } else {
                let doc = "Direction of the EMF at the end of the target period.";
                l.b.stage("emf_direction", &[doc]);
            }
            ProportionalShape::new(l, &rotor, options.delay)
        });
        let reference = match shape {
            Some(shape) if is_proportional => proportional_reference(shape.unit, set_point),
            _ if options.advance > 0.0 => {
                quasi_square_reference(l, Corner::Sector(sector), set_point)
            }
            // Without phase advance the table is indexed by the Hall code; an invalid one turns the
            // legs off.
            _ => {
                let code = tracked.sample.hall;
                quasi_square_reference(l, Corner::HallCode(code), set_point)
            }
        };
        (reference, shape)
    }

    /// Observations: the EMF of the target period, or of the present one if the law only predicts and computes
    /// it, and the speed.
    fn tell(&self, [target, present]: [Option<Phases<'b>>; 2], speed: Option<Expr<'b>>) {
        let predicts = self.needs.emf == EmfUse::Prediction;
        let told = present.filter(|_| predicts).or(target);
        if let Some(e) = told {
            self.l.b.tell(Told::Emf(Phase::A), e.a());
            self.l.b.tell(Told::Emf(Phase::B), e.b());
        }
        if let Some(speed) = speed {
            self.l.b.tell(Told::Speed, speed);
        }
    }

    /// Whether the law predicts with the held EMF of the last period.
    fn holds_emf(&self) -> bool {
        self.needs.predicts() && self.options.emf == EmfSource::Held
    }

    /// Whether tables hold the contribution of whole vectors to later steps: with a held EMF and a
    /// fixed bus.
    pub fn tables_left_over(&self) -> bool {
        self.holds_emf() && matches!(self.l.spec.inverter.bus, BusSource::Fixed)
    }

    /// Model of an off leg's terminal voltage.
    fn off_leg(&self, bus: Bus<'b>, third: Coefficient) -> OffLeg<'b> {
        OffLeg {
            bus,
            third,
            threshold: self.options.commutation_threshold,
        }
    }

    /// The voltage applied in the period that begins now (delay 1) by a command with an off leg,
    /// with the EMF of that period.
    fn applied_now(
        &self,
        words: &Words<'b>,
        currents: Phases<'b, 3>,
        e_now: Option<Phases<'b>>,
        off_leg: &OffLeg<'b>,
    ) -> Option<Phases<'b>> {
        let ((terminals, off), e_now) = (words.t_cmd?, e_now?);
        let commanded = Applied {
            terminals: Phases(terminals.map(Memory::read)),
            off: off.read(),
        };
        named! {
            let v_now = off_leg.applied_voltage(self.l, &commanded, currents, e_now);
        }
        Some(v_now)
    }

    /// Net voltage of the voltage that is remembered as applied.
    fn net_of_applied(
        &self,
        front: &Front<'b>,
        v_cmd: Option<Phases<'b>>,
        applied: Option<Applied<'b>>,
    ) -> Option<Phases<'b>> {
        named! {
            let net = self.applied_to_remember(front, v_cmd, applied)? - front.e?;
        }
        Some(net)
    }

    /// Step 12: state for the next step. `v_cmd`: the commanded voltages; `applied`: the terminal
    /// voltages in their place, for commands with an off leg.
    pub fn remember(
        &self,
        front: &Front<'b>,
        command: impl Into<StepCommand<'b>>,
        v_cmd: Option<Phases<'b>>,
        applied: Option<Applied<'b>>,
        mut remembered: Remembered<'b>,
    ) {
        let (words, command) = (&front.words, command.into());
        if let (Some(held), Some(u)) = (&front.held, v_cmd) {
            let left_over = self.left_over(held, u);
            remembered.extend(self.fold(held, left_over));
        }
        remembered.extend(front.of_set_point.iter().copied());
        if let (Some(limit), StepCommand::Pulses(command)) = (words.bus_current, &command) {
            remembered.extend(limit.follow(self.l, front.currents, command));
        }
        remembered.extend(front.counts.into_iter().flatten());
        if let (Some(commutation), Some(rule)) = (front.commutation, words.pair) {
            remembered.extend(rule.sector_prev.map(|word| (word, front.sector)));
            remembered.push((rule.left, commutation.left));
        }
        if let (Some((terminals, off)), Some(applied)) = (words.t_cmd, applied) {
            remembered.extend(terminals.into_iter().zip(applied.terminals.0));
            remembered.push((off, applied.off));
        }
        let mut keep = |words: Option<[Memory<'b>; 2]>, values: Option<Phases<'b>>| {
            remembered.extend(
                words
                    .zip(values)
                    .into_iter()
                    .flat_map(|(words, values)| kept(words, values)),
            );
        };
        keep(words.v_cmd, v_cmd);
        if words.v_prev.is_some() {
            keep(
                words.v_prev,
                self.applied_to_remember(front, v_cmd, applied),
            );
        }
        keep(words.e_prev, front.e_now);
        if let Some(observer) = words.observer {
            keep(observer.e_next, front.e);
            let of_applied = || self.net_of_applied(front, v_cmd, applied);
            keep(Some(observer.net_prev), front.net.or_else(of_applied));
            if let (Some(_), Some((u, e))) = (observer.net_next, v_cmd.zip(front.e)) {
                named! {
                    let net = u - e;
                }
                keep(observer.net_next, Some(net));
            }
            keep(Some(observer.emf_error), front.emf_error.map(Phases));
        }
        keep(words.i_prev, Some(front.currents.pair()));
        if let Some(off_prev) = words.off_prev {
            let off = match words.t_cmd {
                Some((_, off_cmd)) => Some(off_cmd.read()),
                None => applied.map(|applied| applied.off),
            };
            remembered.extend(off.map(|off| (off_prev, off)));
        }
        command.close_step(self.l, &remembered);
    }

    /// The voltage applied in the period that begins now, for the next step.
    fn applied_to_remember(
        &self,
        front: &Front<'b>,
        v_cmd: Option<Phases<'b>>,
        applied: Option<Applied<'b>>,
    ) -> Option<Phases<'b>> {
        match (front.now, applied, front.e) {
            (Some(now), ..) => Some(now),
            (None, Some(applied), Some(e)) => {
                let off_leg = self.off_leg(front.bus, front.third);
                named! {
                    let v_applied = off_leg.applied_voltage(self.l, &applied, front.currents, e);
                }
                Some(v_applied)
            }
            _ => v_cmd,
        }
    }
}
