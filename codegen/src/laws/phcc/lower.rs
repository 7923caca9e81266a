//! Predictive hysteresis control as IR: the shared step, the predicted error, two bands and a table.

use super::table::{
    BRAKING_BACKWARD, BRAKING_FORWARD, MOTORING_BACKWARD, MOTORING_FORWARD, PER_SET,
    switching_table,
};
use crate::blocks::set_point::Gain;
use crate::blocks::{Lowering, Scale};
use crate::diagnostics::engineering;
use crate::ir::{Expr, Flag, Interval, Memory, Named, Phases, named};
use crate::laws::current_loop::{CurrentLoop, EmfUse, Front, LoopDesign, Needs, lower_with};
use crate::laws::whole_vectors::{Choices, Numbers, WISHES};
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
                integral: false,
                memory: 0,
            },
        };
        // Where a table has what a vector leaves to the next error, what its wishes leave goes into that.
        let folds = step.tables_left_over();
        if folds {
            step.needs.memory = bands[1] + 1;
        }
        let front = step.front(set_point);
        let axes = [("alpha", "h_a"), ("beta", "h_b")];
        let axes = [0, 1].map(|axis| {
            let ((name, memory), band) = (axes[axis], bands[axis]);
            let memory = (!folds).then(|| {
                let doc = "Memory of the axis, added to its error: half the band while its component shall rise, one word more and negative while it shall fall; 0 while it has no wish.";
                l.b.memory(memory, 0, Interval::new(-band - 1, band), doc)
            });
            Axis { name, band, memory }
        });
        let q = step.predicted_error(&front);
        let wishes = compare_with_bands(l, options, design, q, axes);
        let pairs = options.candidates == PhccCandidates::Table2;
        let numbers = match (folds, pairs) {
            (true, pairs) => Numbers::Choices(Choices {
                pairs,
                memory: folded_memory(bands),
            }),
            (false, true) => Numbers::Vectors,
            (false, false) => Numbers::WithoutPairs,
        };
        let falls = wishes.map(|wish| wish.falls);
        let number = look_up(l, options, &front, falls, numbers);
        let remembered = wishes.into_iter().filter_map(|wish| wish.remembered);
        step.apply_vector(&front, number, numbers, remembered.collect());
    })
}

/// What wishes add to the next errors of phases a and b, words of voltage: alpha's memory to a; to b half of what beta's
/// exceeds that by, as beta is 2 b + a.
fn folded_memory(bands: [i64; 2]) -> [[i64; 2]; WISHES] {
    std::array::from_fn(|wishes| {
        let falls = [0, 1].map(|axis| wishes >> axis & 1 == 1);
        let [alpha, beta] = [0, 1].map(|axis| wish(bands[axis], falls[axis]));
        // Not a word beyond the band, where the difference is odd.
        [alpha, (beta - alpha + i64::from(falls[1])) >> 1]
    })
}

/// What an axis adds to its next error, words of voltage; `band` is half of it.
fn wish(band: i64, falls: bool) -> i64 {
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
                    "Error of the current predicted for the end of this period, as a voltage: K (i_ref - i(k+1)) with the estimate",
                    "(9) put into the prediction (7) and the terms collected by their age: K i_ref + k_now i + due.",
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
            "Remainder of the present current when the vector takes effect, as the voltage K i.",
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
        let error = match front.now.zip(front.e_now) {
            Some((now, e_now)) => open - (now - e_now),
            None => open,
        };
        deviation(l, error)
    }
}

/// Names the predicted error of phases a and b, and states its own.
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
    /// What is added to its error, unless that is folded into what is due.
    memory: Option<Memory<'b>>,
}

/// What an axis asks for, and what it remembers of that.
#[derive(Clone, Copy)]
struct Wish<'b> {
    /// Its component shall fall.
    falls: Flag<'b>,
    remembered: Option<(Memory<'b>, Expr<'b>)>,
}

/// The wishes of the two axes.
fn compare_with_bands<'b>(
    l: &Lowering<'b>,
    options: &PhccSpec,
    design: &LoopDesign,
    q: Phases<'b>,
    axes: [Axis<'b>; 2],
) -> [Wish<'b>; 2] {
    let doc = [
        "Each axis asks for a rise or a fall of its component once the error leaves the band, and keeps asking: while it asks",
        "for a rise, an error down to the band's lower edge will do, otherwise it takes one above the upper edge. An axis",
        "that comes from rest goes by the sign. Beta is taken times the square root of 3: (b - c) = 2 b + a.",
        "",
        "An error already holds the memory of the last wish, with what is due to it, so that its sign decides.",
    ];
    let is_folded = axes[0].memory.is_none();
    l.b.stage(
        "compare_with_bands",
        if is_folded { &doc } else { &doc[..3] },
    );
    named! {
        let q_beta = (q.b() << 1) + q.a();
    }
    // Alpha, phase a itself, is less far off.
    let doc = "Predicted error of the current on alpha and beta, which is compared with the band";
    let word = 1.0 / (l.scale.voltage() * design.k_di * 3.0_f64.sqrt());
    l.b.state_error("current", q_beta, [doc, "A"], word);
    [0, 1].map(|x| axes[x].wish(l, options, [q.a(), q_beta][x]))
}

impl<'b> Axis<'b> {
    fn wish(self, l: &Lowering<'b>, options: &PhccSpec, error: Expr<'b>) -> Wish<'b> {
        let falls = |error: Expr<'b>| error.is_below(0).named(&format!("{}_falls", self.name));
        let Some(memory) = self.memory else {
            return Wish {
                falls: falls(error),
                remembered: None,
            };
        };
        let lifted = error + memory.read();
        let falls = falls(lifted.named(&format!("lifted_{}", self.name)));
        let half = engineering(options.band, "A");
        let band = format!("band_{}", self.name);
        let doc = format!("Half width of the band of {half} as a voltage");
        let above = l.voltage(&band, wish(self.band, false), &doc);
        let doc =
            format!("Half width of the band of {half} and one word more, negative, as a voltage");
        let below = l.voltage(&format!("{band}_below"), wish(self.band, true), &doc);
        let next = falls.choose(below, above);
        let next = next.named(&format!("memory_{}", self.name));
        Wish {
            falls,
            remembered: Some((memory, next)),
        }
    }
}

/// Entries of the switching table, as the numbers that the law works with.
fn entries(options: &PhccSpec, shape: EmfShape, numbers: Numbers) -> Vec<i32> {
    let sets = switching_table(options, shape);
    // Direction unknown, forward, none, backward (the index wraps); then a set-point of 0 and more, and one below.
    [
        [BRAKING_FORWARD; 2],
        [MOTORING_FORWARD, BRAKING_FORWARD],
        [BRAKING_FORWARD; 2],
        [BRAKING_BACKWARD, MOTORING_BACKWARD],
    ]
    .iter()
    .flatten()
    .flat_map(|&set| sets[PER_SET * set..][..PER_SET].as_chunks::<WISHES>().0)
    // A sign bit is 1 where an axis shall fall.
    .flat_map(|&[both_fall, beta_rises, alpha_rises, both_rise]| {
        let vectors = [both_rise, beta_rises, alpha_rises, both_fall];
        match numbers {
            Numbers::Choices(_) => {
                std::array::from_fn(|wishes| vectors[wishes] * WISHES as i32 + wishes as i32)
            }
            _ => vectors,
        }
    })
    .collect()
}

/// The vector that the switching table holds for sector, commutation and wishes, as a number.
fn look_up<'b>(
    l: &Lowering<'b>,
    options: &PhccSpec,
    front: &Front<'b>,
    [alpha, beta]: [Flag<'b>; 2],
    numbers: Numbers,
) -> Expr<'b> {
    let entries = entries(options, l.spec.motor.emf_shape, numbers);
    let (what, name) = match numbers {
        Numbers::Choices(_) => (
            "4 vector + 2 if beta shall fall + 1 if alpha shall",
            "choice",
        ),
        _ => ("Vector", "vector"),
    };
    let table = l.b.table(
        "switching",
        entries,
        &[
            format!("{what}, by the sum of 128 direction (modulo the table's length), 64 if the set-point is negative, 8 sector,"),
            "4 if it commutates, 2 if beta shall fall, 1 if alpha shall.".to_owned(),
            "Vectors: 0 V0, 1 to 6 V1 to V6, 7 to 12 V12 to V61, 13 to 15 a pair's zero with leg a, b, c off.".to_owned(),
        ],
    );
    l.b.stage(
        "look_up_vector",
        &["The switching table: rows by direction, sign of the set-point, sector and commutation, columns by the wishes."],
    );
    let negative = front.set_point.is_below(0);
    let row = front.sector << 3;
    // Without a commutation no direction is known.
    let row = match front.commutation {
        Some(commutation) => (commutation.direction << 7) + row + (commutation.word << 2),
        None => row,
    };
    named! {
        let entry = row + negative.choose(64, 0) + beta.choose(2, 0) + alpha.choose(1, 0);
    }
    table.at(entry).named(name)
}
