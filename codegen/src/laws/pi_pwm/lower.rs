//! PI control as a program: the shared step, two regulators, the voltage limit and the modulator.

use crate::blocks::set_point::Gain;
use crate::blocks::{
    CommonModeRule, Hexagon, Lowering, Modulator, Priority, Scale, across_pair, limit_line,
    pair_signs,
};
use crate::ir::{Coefficient, Expr, Interval, Memory, Named, Phases, named};
use crate::laws::current_loop::{
    CurrentLoop, EmfUse, Front, LoopDesign, Needs, Remembered, kept, lower_with, read,
    unlimited_voltage,
};
use crate::scaling::Lowered;
use crate::spec::{PiModulation, PiPwmSpec, Spec};

/// Documentation of the integrating stage.
const INTEGRATION: &[&str] = &[
    "Integration and tracking anti-windup with one time constant: s + k_i (p + v - u) with u = p + s + e the voltage before",
    "the limit and v the limited one, so the integral part tracks v - e.",
];

/// Documentation of the regulator with a turning reference.
const TURNING: &[&str] = &[
    "PI regulator per phase: v = k_p (i_ref - i) + integral + e + K (i_ref_end - a i_ref_begin). The last term is the voltage",
    "that moves the current along the reference over the target period, so the regulator has only its deviation to",
    "correct: i_ref belongs to the sample, i_ref_begin and i_ref_end to the begin and end of the target period.",
];

/// Documentation of the integral part's error.
const INTEGRAL: &str = "Integral part after one step";

/// Lowers the controller at a scale.
pub(super) fn lower(
    spec: &Spec,
    options: &PiPwmSpec,
    design: &LoopDesign,
    scale: Scale,
) -> Lowered {
    let gain = if options.turns_reference() {
        Gain::stiffness(design.k_di)
    } else {
        Gain {
            value: options.proportional_gain(&spec.motor),
            symbol: "k_p",
            formula: "k_p = 2 pi f L",
        }
    };
    lower_with(spec, scale, gain, |l, set_point| {
        let emf = if options.feed_forward {
            EmfUse::FeedForward
        } else {
            EmfUse::None
        };
        let step = CurrentLoop {
            l,
            options: &options.common,
            design,
            needs: Needs {
                commutation: options.modulation == PiModulation::Table2,
                off_leg: false,
                emf,
                memory: 0,
                rounding: false,
            },
        };
        let front = step.front(set_point);
        let regulator = Regulator::new(l, options);
        if options.six_step {
            regulator.six_step(&step, &front);
        } else {
            regulator.per_phase(&step, &front);
        }
    })
}

/// The regulator's options and coefficients.
struct Regulator<'l, 'b> {
    l: &'l Lowering<'b>,
    options: &'l PiPwmSpec,
    /// k_p, V/A.
    gain: f64,
    /// Range of the integral part.
    range: Interval,
    /// -k_p, so that a multiply-accumulate adds its product.
    k_drop: Coefficient,
    k_i: Coefficient,
}

impl<'l, 'b> Regulator<'l, 'b> {
    fn new(l: &'l Lowering<'b>, options: &'l PiPwmSpec) -> Self {
        let (gain, word) = (
            options.proportional_gain(&l.spec.motor),
            options.common.word,
        );
        let doc = "Weight of the present current: the proportional gain k_p = 2 pi f L, negative.";
        let k_drop = l.impedance("k_drop", -gain, word, doc, ["-k_p", "V/A"]);
        let share = options.integral_share(l.spec);
        let doc =
            "Share of its distance to v - e that the integral part covers in one period, T_s/T_i.";
        let k_i = l.coefficient("k_i", share, word, doc, &format!("T_s/T_i = {share:.6}"));
        Self {
            l,
            options,
            gain,
            range: integral_range(l, options),
            k_drop,
            k_i,
        }
    }

    /// A regulator for each phase.
    fn per_phase(&self, step: &CurrentLoop<'_, 'b>, front: &Front<'b>) {
        let l = self.l;
        let doc = "Integral part of the regulator, words of voltage.";
        let memories = l.memories(["integral_a", "integral_b"], self.range, doc);
        let turning = self
            .options
            .turns_reference()
            .then(|| Turning::new(step, self.gain, front.reference));
        let Regulated {
            integral,
            u,
            forward,
            held,
        } = self.regulated(step, front, memories, turning);
        let emf = front.e.map(|e| move || e);
        let priority = Priority::of(self.options.saturation, emf);
        let integrate = |limited: Phases<'b>| {
            l.b.stage("integrate", INTEGRATION);
            let target = forward.map_or(limited, |forward| limited - forward);
            named! {
                let distance = target - integral;
                let integral_now = (integral + self.k_i * distance).map(|sum| self.held(sum));
            }
            l.state_phase_volts("integral", integral_now, INTEGRAL);
            kept(memories, integral_now)
        };
        if self.options.modulation == PiModulation::Table2
            && let Some(table2) = front.table2(self.options.zero)
        {
            let modulated = table2.modulate(l, priority, u);
            let (remembered, volts) = (integrate(modulated.u).to_vec(), Some(modulated.u));
            return step.remember(front, modulated.command, volts, None, remembered);
        }
        let common_mode = CommonModeRule::new(l, self.options.common_mode);
        let hexagon = Hexagon {
            bus: common_mode.reach(l, front.bus),
            third: front.third,
            lift: common_mode.in_limit(front.bus, held.is_some()),
        };
        let limited = hexagon.limit(l, priority, u);
        let limited = common_mode.second_readable(l, front.third, front.bus, limited);
        let mut remembered = front.turned(l, limited.cut);
        let integrated = integrate(limited.u);
        let stiffness = turning.map_or(self.gain, |_| step.design.k_di);
        let spread = Some(limited.spread);
        let modulator = Modulator {
            bus: front.bus,
            rounding: None,
            shifts: held
                .map(|held| step.dead_time_shifts(front.reference, held, stiffness, spread)),
        };
        let pulsed = modulator.three(l, &limited, common_mode);
        remembered.extend(integrated);
        remembered.extend(
            turning
                .into_iter()
                .flat_map(|turning| turning.kept(front.reference)),
        );
        step.remember(front, pulsed.command, Some(limited.u), None, remembered);
    }

    /// The voltage that the regulators of the phases ask for.
    fn regulated(
        &self,
        step: &CurrentLoop<'_, 'b>,
        front: &Front<'b>,
        memories: [Memory<'b>; 2],
        turning: Option<Turning<'b>>,
    ) -> Regulated<'b> {
        let l = self.l;
        let docs: &[&str] = match turning {
            None => &[
                "PI regulator per phase: v = k_p (i_ref - i) + integral, plus the EMF if it is fed forward.",
            ],
            Some(_) => TURNING,
        };
        l.b.stage("regulate", docs);
        let integral = read(memories);
        let drop = self.k_drop * front.currents.pair();
        let held = self.options.dead_time_compensation.then(|| {
            if turning.is_some() {
                named! {
                    let held = step.k_di() * front.currents.pair();
                }
                return held;
            }
            named! {
                let drop = drop;
                let held = -drop;
            }
            held
        });
        let due = turning.map(|turning| turning.due());
        named! {
            let p = due.unwrap_or(front.reference) + drop;
        }
        let forward = front.e.map(|e| match turning {
            Some(turning) => (e + turning.led(front.reference)).named("forward"),
            None => e,
        });
        let asked = p + integral;
        let asked = forward.map_or(asked, |forward| asked + forward);
        let u = unlimited_voltage(l, asked);
        Regulated {
            integral,
            u,
            forward,
            held,
        }
    }

    /// One regulator for the current of the conducting pair, and the pulses of its line voltage.
    fn six_step(&self, step: &CurrentLoop<'_, 'b>, front: &Front<'b>) {
        let (l, i) = (self.l, front.currents);
        let doc = "Integral part of the regulator, words of voltage.";
        let memory = l.b.memory("integral", 0, self.range, doc);
        let doc =
            "PI regulator of the pair's current: v = k_p (i_ref - i) + integral, per winding.";
        l.b.stage("regulate", &[doc]);
        let integral = memory.read();
        let sign = pair_signs(l, front.sector);
        named! {
            let pair_current = across_pair(sign, i >> 1);
            let part = front.set_point + self.k_drop * pair_current;
        }
        let held = self.options.dead_time_compensation.then(|| {
            named! {
                let held = -(self.k_drop * i.pair());
            }
            held
        });
        named! {
            let u = part + integral;
        }
        let doc = "Winding voltage before the limit";
        l.state_volts("voltage", u, doc);
        let reach = CommonModeRule::reach_of_pair(l, front.bus);
        let line = limit_line(u << 1, reach);
        l.b.stage("integrate", INTEGRATION);
        named! {
            let distance = (line >> 1) - integral;
            let integral_now = self.held(integral + self.k_i * distance);
        }
        l.state_volts("integral", integral_now, INTEGRAL);
        let shifts = held.map(|held| step.dead_time_shifts(front.reference, held, self.gain, None));
        let doc =
            "One leg of the pair pulsed, its partner low, the third off; in commutation as well.";
        l.b.stage("modulate_pair", &[doc]);
        let modulator = Modulator {
            bus: front.bus,
            rounding: None,
            shifts,
        };
        let pulses = modulator.pulse_pair(l, sign, line);
        let remembered = vec![(memory, integral_now)];
        step.remember(front, pulses.command, None, None, remembered);
    }

    /// An integral part within its range.
    fn held(&self, sum: Expr<'b>) -> Expr<'b> {
        let doc = "Largest integral part";
        let low = self.l.voltage("integral_min", self.range.low, doc);
        let high = self.l.voltage("integral_max", self.range.high, doc);
        sum.clamp(low, high)
    }
}

/// Range of the integral part: the largest bus. Without an EMF it cannot exceed that, as a mean of
/// itself and the limited voltage; the clamp then serves the proof and is at the next power of two,
/// for a saturating instruction.
fn integral_range(l: &Lowering<'_>, options: &PiPwmSpec) -> Interval {
    let bus = l.bus_interval().high;
    if options.feed_forward {
        return Interval::symmetric(bus);
    }
    let limit = bus.unsigned_abs().next_power_of_two() as i64;
    Interval::new(-limit, limit - 1)
}

/// What the regulators of the phases ask for.
struct Regulated<'b> {
    /// Integral part before the step.
    integral: Phases<'b>,
    /// Voltage before the limit.
    u: Phases<'b>,
    /// What is fed forward of it.
    forward: Option<Phases<'b>>,
    /// The measured current as a voltage, for the compensation of the dead time.
    held: Option<Phases<'b>>,
}

/// A reference that turns: those of the last steps, as voltages K i_ref.
#[derive(Clone, Copy)]
struct Turning<'b> {
    /// Reference at the begin of the target period, with delay 1.
    begin: Option<[Memory<'b>; 2]>,
    /// Reference at the sample; that is the begin of the target period with delay 0.
    sample: [Memory<'b>; 2],
    /// a, negative.
    k_lead: Coefficient,
    /// k_p/K.
    k_due: Coefficient,
}

impl<'b> Turning<'b> {
    fn new(step: &CurrentLoop<'_, 'b>, gain: f64, reference: Phases<'b>) -> Self {
        let (l, word) = (step.l, step.options.word);
        let most = reference.0.map(|phase| phase.interval().magnitude());
        let range = Interval::symmetric(most[0].max(most[1]));
        let doc = "Reference at the begin of the next step's target period, as a voltage.";
        let begin =
            (step.options.delay == 1).then(|| l.memories(["j_a_next", "j_b_next"], range, doc));
        let doc = "Reference that belongs to the next sample, as a voltage.";
        let sample = l.memories(["j_a_due", "j_b_due"], range, doc);
        let pole = 1.0 - step.design.k_decay;
        let doc = "Share of the reference at the begin of the target period that is left at its end, negative.";
        let k_lead = l.coefficient("k_lead", -pole, word, doc, &format!("-a = -{pole:.6}"));
        let share = gain / step.design.k_di;
        let doc = "Proportional gain over the voltage per change of current in a period.";
        let k_due = l.coefficient("k_due", share, word, doc, &format!("k_p/K = {share:.6}"));
        Self {
            begin,
            sample,
            k_lead,
            k_due,
        }
    }

    /// The reference that the sampled current should have had, times the proportional gain.
    fn due(&self) -> Phases<'b> {
        named! {
            let due = self.k_due * read(self.sample);
        }
        due
    }

    /// The voltage that moves the current along the reference over the target period.
    fn led(&self, end: Phases<'b>) -> Phases<'b> {
        end + self.k_lead * read(self.begin.unwrap_or(self.sample))
    }

    /// The references for the next step.
    fn kept(&self, end: Phases<'b>) -> Remembered<'b> {
        let now = self.begin.map_or(end, read);
        let next = self.begin.into_iter().flat_map(|begin| kept(begin, end));
        next.chain(kept(self.sample, now)).collect()
    }
}
