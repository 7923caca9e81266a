//! Predictive hysteresis control as IR: the shared step, the predicted error, two bands and a table.

use super::table::{
    BRAKING_BACKWARD, BRAKING_FORWARD, MOTORING_BACKWARD, MOTORING_FORWARD, PER_SET,
    switching_table,
};
use crate::controllers::current_loop::{CurrentLoop, EmfUse, Front, LoopDesign, Needs, lower_with};
use crate::controllers::whole_vectors::{Choices, Numbers, WISHES};
use crate::diagnostics::engineering;
use crate::ir::{Comparison, Interval, StateId, Value};
use crate::lower::{Lowering, Scale};
use crate::scaling::Lowered;
use crate::spec::{PhccCandidates, PhccSpec, Spec};

/// Lowers the controller at a scale.
pub fn lower(spec: &Spec, options: &PhccSpec, design: &LoopDesign, scale: Scale) -> Lowered {
    lower_with(spec, scale, design.k_di, |lowering, set_point| {
        let bands = [1.0, 3.0_f64.sqrt()]
            .map(|share| lowering.volts_word(share * design.k_di * options.band));
        let common = &options.common;
        let mut step = CurrentLoop {
            lowering,
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
        let memory = (!folds).then(|| {
            [("h_a", bands[0]), ("h_b", bands[1])].map(|(name, band)| {
                let doc = "Memory of the axis, added to its error: half the band while its component shall rise, one word more and negative while it shall fall; 0 while it has no wish.";
                let range = Interval::new(-band - 1, band);
                (step.lowering.state(name, 0, range, doc), band)
            })
        });
        let q = step.predicted_error(&front);
        let axes = compare_with_bands(step.lowering, options, design, q, memory);
        let falls = axes.map(|axis| axis.falls);
        let pairs = options.candidates == PhccCandidates::Table2;
        let numbers = match (folds, pairs) {
            (true, pairs) => Numbers::Choices(Choices {
                pairs,
                memory: folded_memory(bands),
            }),
            (false, true) => Numbers::Vectors,
            (false, false) => Numbers::WithoutPairs,
        };
        let number = look_up(step.lowering, options, &front, falls, numbers);
        let words = memory.iter().flatten().zip(axes);
        let remembered = words
            .filter_map(|(&(word, _), axis)| Some((word, axis.memory?)))
            .collect();
        step.apply_vector(&front, number, numbers, remembered);
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

impl CurrentLoop<'_, '_> {
    /// K (i_ref - i(k+1)) of phases a, b, words of voltage; with delay 0 K (i_ref - i).
    fn predicted_error(&mut self, front: &Front) -> [Value; 2] {
        if let Some(held) = &front.held {
            let l = &mut *self.lowering;
            l.b.stage(
                "predict_error",
                &[
                    "Error of the current predicted for the end of this period, as a voltage: K (i_ref - i(k+1)) with the estimate",
                    "(9) put into the prediction (7) and the terms collected by their age: K i_ref + k_now i + due.",
                ],
            );
            return [0, 1].map(|x| {
                let error = held.sum(l, x, front.reference[x]);
                deviation(l, x, error)
            });
        }
        let delayed = self.options.delay == 1;
        let hold = if delayed {
            self.design.k_di * self.design.plant.pole
        } else {
            self.design.k_di
        };
        let word = self.options.word;
        let l = &mut *self.lowering;
        let k_hold = l.impedance(
            "k_hold",
            hold,
            word,
            "What is left of the present current when the vector takes effect, as the voltage K i.",
            [if delayed { "K a" } else { "K" }, "V/A"],
        );
        let doc: &[&str] = if delayed {
            &[
                "Error of the current predicted for the end of this period, as a voltage: K (i_ref - i(k+1)) with",
                "i(k+1) = a i + b (v_now - e_now) of (7).",
            ]
        } else {
            &["Error of the current, as a voltage: K (i_ref - i)."]
        };
        l.b.stage("predict_error", doc);
        [0, 1].map(|x| {
            let held = l.times(k_hold, front.currents.phases[x]);
            let open = l.b.sub(front.reference[x], held);
            let error = match (front.now, front.e_now) {
                (Some(now), Some(e_now)) => {
                    let driving = l.b.sub(now[x], e_now[x]);
                    l.b.sub(open, driving)
                }
                _ => open,
            };
            deviation(l, x, error)
        })
    }
}

/// Names the predicted error of phase `x`, 0 or 1, and states its own.
fn deviation(l: &mut Lowering<'_>, x: usize, error: Value) -> Value {
    let doc = "Predicted error of a phase current, as the voltage K (i_ref - i)";
    let word = 1.0 / l.scale.voltage();
    l.b.state_error("deviation", error, [doc, "V"], word);
    l.b.name(["q_a", "q_b"][x], error)
}

/// What an axis asks for, and what it remembers of that.
#[derive(Clone, Copy)]
struct Axis {
    /// Flag: its component shall fall.
    falls: Value,
    /// What is added to its next error, unless that is folded into what is due.
    memory: Option<Value>,
}

/// The wishes of the two axes; `memory` has the state words and half the bands, unless what is due holds the memory.
fn compare_with_bands(
    l: &mut Lowering<'_>,
    options: &PhccSpec,
    design: &LoopDesign,
    q: [Value; 2],
    memory: Option<[(StateId, i64); 2]>,
) -> [Axis; 2] {
    let folded: &[&str] = if memory.is_none() {
        &[
            "",
            "An error already holds the memory of the last wish, with what is due to it, so that its sign decides.",
        ]
    } else {
        &[]
    };
    let doc = [
        "Each axis asks for a rise or a fall of its component once the error leaves the band, and keeps asking: while it asks",
        "for a rise, an error down to the band's lower edge will do, otherwise it takes one above the upper edge. An axis",
        "that comes from rest goes by the sign. Beta is taken times the square root of 3: (b - c) = 2 b + a.",
    ];
    let doc = [&doc, folded].concat();
    l.b.stage("compare_with_bands", &doc);
    let twice = l.b.shift_left(q[1], 1);
    let beta = l.b.add(twice, q[0]);
    l.b.name("q_beta", beta);
    // Alpha, phase a itself, is less far off.
    let doc = "Predicted error of the current on alpha and beta, which is compared with the band";
    let word = 1.0 / (l.scale.voltage() * design.k_di * 3.0_f64.sqrt());
    l.b.state_error("current", beta, [doc, "A"], word);
    [0, 1].map(|x| {
        let error = [q[0], beta][x];
        let lifted = memory.map(|memory| {
            let before = l.b.state(memory[x].0);
            let lifted = l.b.add(error, before);
            l.b.name(["lifted_alpha", "lifted_beta"][x], lifted)
        });
        let zero = l.zero();
        let falls = l.b.compare(Comparison::Less, lifted.unwrap_or(error), zero);
        l.b.name(["alpha_falls", "beta_falls"][x], falls);
        let memory = memory.map(|memory| next_memory(l, options, x, memory[x].1, falls));
        Axis { falls, memory }
    })
}

/// What axis `x`, 0 alpha or 1 beta, adds to its next error; `band` is half of it.
fn next_memory(
    l: &mut Lowering<'_>,
    options: &PhccSpec,
    x: usize,
    band: i64,
    falls: Value,
) -> Value {
    let (name, other) = [
        ("band_alpha", "band_alpha_below"),
        ("band_beta", "band_beta_below"),
    ][x];
    let half = engineering(options.band, "A");
    let doc = format!("Half width of the band of {half} as a voltage");
    let above = l.voltage(name, wish(band, false), &doc);
    let doc = format!("Half width of the band of {half} and one word more, negative, as a voltage");
    let below = l.voltage(other, wish(band, true), &doc);
    let memory = l.b.select(falls, below, above);
    l.b.name(["memory_alpha", "memory_beta"][x], memory)
}

/// The vector that the switching table holds for sector, commutation and wishes, as a number.
fn look_up(
    l: &mut Lowering<'_>,
    options: &PhccSpec,
    front: &Front,
    [alpha, beta]: [Value; 2],
    numbers: Numbers,
) -> Value {
    let sets = switching_table(options, l.spec.motor.emf_shape);
    // Direction unknown, forward, none, backward (the index wraps); then a set-point of 0 and more, and one below.
    let table = [
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
    .collect();
    let (what, name) = match numbers {
        Numbers::Choices(_) => (
            "4 vector + 2 if beta shall fall + 1 if alpha shall",
            "choice",
        ),
        _ => ("Vector", "vector"),
    };
    let table = l.b.program.table(
        "switching",
        table,
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
    let zero = l.zero();
    let negative = l.b.compare(Comparison::Less, front.set_point, zero);
    let mut index = l.b.shift_left(front.sector, 3);
    // Without a commutation no direction is known.
    if let Some(commutation) = front.commutation {
        let turning = l.b.shift_left(commutation.direction, 7);
        index = l.b.add(turning, index);
        let bit = l.b.shift_left(commutation.word, 2);
        index = l.b.add(index, bit);
    }
    for (flag, weight) in [(negative, 64), (beta, 2), (alpha, 1)] {
        let (set, clear) = (l.b.literal(weight), l.zero());
        let bits = l.b.select(flag, set, clear);
        index = l.b.add(index, bits);
    }
    l.b.name("entry", index);
    let number = l.b.lookup(table, index);
    l.b.name(name, number)
}
