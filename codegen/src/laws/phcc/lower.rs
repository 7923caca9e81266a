//! Predictive hysteresis control as a program: the shared step, the predicted error, two bands and
//! a table.

use super::table::{
    BRAKING_BACKWARD, BRAKING_FORWARD, MOTORING_BACKWARD, MOTORING_FORWARD, PER_SET,
    switching_table,
};
use crate::blocks::set_point::Gain;
use crate::blocks::{Lowering, Scale};
use crate::diagnostics::engineering;
use crate::ir::{Expr, Flag, Interval, Memory, Named, Phases, named};
use crate::laws::current_loop::{CurrentLoop, EmfUse, Front, LoopDesign, Needs, lower_with};
use crate::laws::whole_vectors::{Choices, HYSTERESIS_STATES, Numbers};
use crate::scaling::Lowered;
use crate::spec::{EmfShape, PhccCandidates, PhccSpec, Spec};

/// Lowers the controller at a scale.
pub(super) fn lower(spec: &Spec, options: &PhccSpec, design: &LoopDesign, scale: Scale) -> Lowered {
    lower_with(spec, scale, Gain::stiffness(design.k_di), |l, set_point| {
        let bands =
            [1.0, 3.0_f64.sqrt()].map(|share| l.volts_word(share * design.k_di * options.band));
        let common = &options.common;
        let mut step = CurrentLoop {
            l,
            options: common,
            design,
            needs: Needs {
                commutation: true,
                off_leg: options.floating(),
                emf: if common.delay == 1 {
                    EmfUse::Prediction
                } else {
                    EmfUse::None
                },
                memory: 0,
                rounding: false,
            },
        };
        // Tables of the vector's contribution to the next error include the hysteresis memory.
        let folds = step.tables_left_over();
        if folds {
            step.needs.memory = bands[1] + 1;
        }
        let front = step.front_of_vectors(set_point);
        let axes = [("alpha", "h_a"), ("beta", "h_b")];
        let axes = [0, 1].map(|axis| {
            let ((name, memory), band) = (axes[axis], bands[axis]);
            let memory = (!folds).then(|| {
                let doc = "Hysteresis memory of the axis, added to its error: half the band after a rise was demanded, minus that and one word more after a fall; 0 at rest.";
                l.b.memory(memory, 0, Interval::new(-band - 1, band), doc)
            });
            Axis { name, band, memory }
        });
        let q = step.predicted_error(&front);
        let outputs = compare_with_bands(l, options, design, q, axes);
        let pairs = options.candidates == PhccCandidates::Table2;
        let numbers = match (folds, pairs) {
            (true, pairs) => Numbers::Choices(Choices {
                pairs,
                memory: folded_memory(bands),
            }),
            (false, true) => Numbers::Vectors,
            (false, false) => Numbers::WithoutPairs,
        };
        let falls = outputs.map(|output| output.falls);
        let number = look_up(l, options, &front, falls, numbers);
        let remembered = outputs.into_iter().filter_map(|output| output.remembered);
        step.apply_vector(&front, number, numbers, remembered.collect());
    })
}

/// Hysteresis memory in the next errors of phases a and b, words of voltage: alpha's in a, half of
/// beta's less alpha's in b, since beta is 2 b + a.
fn folded_memory(bands: [i64; 2]) -> [[i64; 2]; HYSTERESIS_STATES] {
    std::array::from_fn(|state| {
        let falls = [0, 1].map(|axis| state >> axis & 1 == 1);
        let [alpha, beta] = [0, 1].map(|axis| memory_of(bands[axis], falls[axis]));
        // An odd difference is rounded towards the band's centre.
        [alpha, (beta - alpha + i64::from(falls[1])) >> 1]
    })
}

/// Hysteresis memory of an axis with half the band `band`, words of voltage.
fn memory_of(band: i64, falls: bool) -> i64 {
    if falls { -band - 1 } else { band }
}

impl<'b> CurrentLoop<'_, 'b> {
    /// K (i_ref - i(k+1)) of phases a, b, words of voltage; with delay 0 K (i_ref - i).
    fn predicted_error(&self, front: &Front<'b>) -> Phases<'b> {
        let (l, reference) = (self.l, front.reference);
        if let Some(held) = &front.held {
            l.b.stage(
                "predict_error",
                &[
                    "Error of the current predicted for the end of this period, as a voltage: K (i_ref - i(k+1)) with estimate (9)",
                    "and prediction (7) substituted and the terms collected by age: K i_ref + k_now i + due.",
                ],
            );
            return deviation(l, held.sum(reference));
        }
        let is_delayed = self.options.delay == 1;
        let k_hold = l.impedance(
            "k_hold",
            self.design.k_di
                * if is_delayed {
                    self.design.plant.pole
                } else {
                    1.0
                },
            self.options.word,
            "Weight of the present current in the predicted error.",
            [if is_delayed { "K a" } else { "K" }, "V/A"],
        );
        let doc: &[&str] = if is_delayed {
            &[
                "Error of the current predicted for the end of this period, as a voltage: K (i_ref - i(k+1)) with",
                "i(k+1) = a i + b (v_now - e_now) of (7).",
            ]
        } else {
            &["Error of the current, as a voltage: K (i_ref - i)."]
        };
        l.b.stage("predict_error", doc);
        let open = reference - k_hold * front.currents.pair();
        let error = match front.net_now() {
            Some(net) => open - net,
            None => open,
        };
        deviation(l, error)
    }
}

/// Names the predicted error of phases a and b, and states its error bound.
fn deviation<'b>(l: &Lowering<'b>, error: Phases<'b>) -> Phases<'b> {
    let doc = "Predicted error of a phase current, as the voltage K (i_ref - i)";
    l.state_phase_volts("deviation", error, doc);
    named! {
        let q = error;
    }
    q
}

/// An axis of the plane, alpha or beta.
#[derive(Clone, Copy)]
struct Axis<'b> {
    name: &'static str,
    /// Half its band, words of voltage.
    band: i64,
    /// Memory added to its error, unless folded into `due`.
    memory: Option<Memory<'b>>,
}

/// Output of an axis' hysteresis, and its new memory.
#[derive(Clone, Copy)]
struct Output<'b> {
    /// Whether the component is to fall.
    falls: Flag<'b>,
    remembered: Option<(Memory<'b>, Expr<'b>)>,
}

/// Hysteresis outputs of the two axes.
fn compare_with_bands<'b>(
    l: &Lowering<'b>,
    options: &PhccSpec,
    design: &LoopDesign,
    q: Phases<'b>,
    axes: [Axis<'b>; 2],
) -> [Output<'b>; 2] {
    let doc = [
        "Hysteresis of alpha and beta: an axis demands a rise once its error exceeds the band's upper edge, and a fall once it",
        "is below the lower edge; in between the last demand stays. After rest the sign of the error decides. Beta is scaled",
        "by the square root of 3: (b - c) = 2 b + a.",
        "",
        "The error includes the hysteresis memory (in `due`), so that its sign decides.",
    ];
    let is_folded = axes[0].memory.is_none();
    l.b.stage(
        "compare_with_bands",
        if is_folded { &doc } else { &doc[..3] },
    );
    named! {
        let q_beta = (q.b() << 1) + q.a();
    }
    // Alpha, phase a itself, has the smaller error.
    let doc = "Predicted current error on alpha and beta, compared with the band";
    let word = 1.0 / (l.scale.voltage() * design.k_di * 3.0_f64.sqrt());
    l.b.state_error("current", q_beta, [doc, "A"], word);
    [0, 1].map(|x| axes[x].compare(l, options, [q.a(), q_beta][x]))
}

impl<'b> Axis<'b> {
    fn compare(self, l: &Lowering<'b>, options: &PhccSpec, error: Expr<'b>) -> Output<'b> {
        let falls = |error: Expr<'b>| error.is_below(0).named(&format!("{}_falls", self.name));
        let Some(memory) = self.memory else {
            return Output {
                falls: falls(error),
                remembered: None,
            };
        };
        let lifted = error + memory.read();
        let falls = falls(lifted.named(&format!("lifted_{}", self.name)));
        let half = engineering(options.band, "A");
        let band = format!("band_{}", self.name);
        let doc = format!("Half the band, {half}, as a voltage");
        let above = l.voltage(&band, memory_of(self.band, false), &doc);
        let doc = format!("Half the band, {half}, plus one word, negative, as a voltage");
        let below = l.voltage(&format!("{band}_below"), memory_of(self.band, true), &doc);
        let next = falls.choose(below, above);
        let next = next.named(&format!("memory_{}", self.name));
        Output {
            falls,
            remembered: Some((memory, next)),
        }
    }
}

/// Entries of the switching table in the law's numbering.
fn entries(options: &PhccSpec, shape: EmfShape, numbers: Numbers) -> Vec<i32> {
    let sets = switching_table(options, shape);
    // Direction unknown, forward, unused, backward (the index wraps); each for a set-point of at
    // least 0 and for a negative one.
    [
        [BRAKING_FORWARD; 2],
        [MOTORING_FORWARD, BRAKING_FORWARD],
        [BRAKING_FORWARD; 2],
        [BRAKING_BACKWARD, MOTORING_BACKWARD],
    ]
    .iter()
    .flatten()
    .flat_map(|&set| {
        sets[PER_SET * set..][..PER_SET]
            .as_chunks::<HYSTERESIS_STATES>()
            .0
    })
    // A bit of the index is 1 if the axis is to fall.
    .flat_map(|&[both_fall, beta_rises, alpha_rises, both_rise]| {
        let vectors = [both_rise, beta_rises, alpha_rises, both_fall];
        match numbers {
            Numbers::Choices(_) => std::array::from_fn(|state| {
                vectors[state] * HYSTERESIS_STATES as i32 + state as i32
            }),
            _ => vectors,
        }
    })
    .collect()
}

/// The entry of the switching table, by direction, set-point, sector, commutation and hysteresis.
fn look_up<'b>(
    l: &Lowering<'b>,
    options: &PhccSpec,
    front: &Front<'b>,
    [alpha, beta]: [Flag<'b>; 2],
    numbers: Numbers,
) -> Expr<'b> {
    let entries = entries(options, l.spec.motor.emf_shape, numbers);
    let (what, name) = match numbers {
        Numbers::Choices(_) => ("4 vector + 2 if beta is to fall + 1 if alpha is", "choice"),
        _ => ("Vector", "vector"),
    };
    let table = l.b.table(
        "switching",
        entries,
        &[
            format!(
                "{what}, by 128 direction (modulo the table's length) + 64 if the set-point is negative + 8 sector \
                + 4 in commutation + 2 if beta is to fall + 1 if alpha is."
            ),
            "Vectors: 0 V0, 1 to 6 V1 to V6, 7 to 12 V12 to V61, 13 to 15 a pair's zero with leg a, b, c off.".to_owned(),
        ],
    );
    l.b.stage(
        "look_up_vector",
        &["Vector from the switching table, by direction, sign of the set-point, sector, commutation and hysteresis."],
    );
    let negative = front.set_point.is_below(0);
    let row = front.sector << 3;
    // Without commutation the direction is not known.
    let row = match front.commutation {
        Some(commutation) => (commutation.direction << 7) + row + (commutation.word << 2),
        None => row,
    };
    named! {
        let entry = row + negative.choose(64, 0) + beta.choose(2, 0) + alpha.choose(1, 0);
    }
    table.at(entry).named(name)
}
