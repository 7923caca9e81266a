//! Predictive hysteresis control as IR: the shared step, the predicted error, two bands and a table.

use super::switching_table;
use crate::controllers::current_loop::{CurrentLoop, EmfUse, Front, LoopDesign, Needs, lower_with};
use crate::diagnostics::engineering;
use crate::ir::{Comparison, Interval, StateId, Value};
use crate::lower::{Lowering, Scale};
use crate::scaling::Lowered;
use crate::spec::{PhccSpec, Spec};

/// Lowers the controller at a scale.
pub fn lower(spec: &Spec, options: &PhccSpec, design: &LoopDesign, scale: Scale) -> Lowered {
    lower_with(spec, scale, design.k_di, |lowering, set_point| {
        let mut step = CurrentLoop {
            lowering,
            options: &options.common,
            design,
            needs: Needs {
                commutation: true,
                off_leg: options.floating(),
                emf: if options.common.delay == 1 {
                    EmfUse::Prediction
                } else {
                    EmfUse::None
                },
                integral: false,
            },
        };
        let front = step.front(set_point);
        let flag = Interval::new(0, 1);
        let memory = ["h_a", "h_b"].map(|name| {
            let doc = "Wish of the axis: 1 its component shall rise, 0 fall.";
            step.lowering.state(name, 0, flag, doc)
        });
        let q = step.predicted_error(&front);
        let wishes = compare_with_bands(step.lowering, options, design, q, memory);
        let vector = look_up(step.lowering, options, &front, wishes);
        let remembered = vec![
            (memory[0], "h_a_next", wishes[0]),
            (memory[1], "h_b_next", wishes[1]),
        ];
        step.apply_vector(&front, vector, remembered);
    })
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

/// The wishes of the two axes.
fn compare_with_bands(
    l: &mut Lowering<'_>,
    options: &PhccSpec,
    design: &LoopDesign,
    q: [Value; 2],
    memory: [StateId; 2],
) -> [Value; 2] {
    l.b.stage(
        "compare_with_bands",
        &[
            "Each axis asks for a rise (1) or a fall (0) of its component once the error leaves the band, and keeps asking.",
            "Beta is taken times the square root of 3: (b - c) = 2 b + a.",
        ],
    );
    let twice = l.b.shift_left(q[1], 1);
    let beta = l.b.add(twice, q[0]);
    l.b.name("q_beta", beta);
    // Alpha, phase a itself, is less far off.
    let doc = "Predicted error of the current on alpha and beta, which is compared with the band";
    let word = 1.0 / (l.scale.voltage() * design.k_di * 3.0_f64.sqrt());
    l.b.state_error("current", beta, [doc, "A"], word);
    let band = design.k_di * options.band;
    [0, 1].map(|x| {
        let volts = if x == 0 { band } else { 3.0_f64.sqrt() * band };
        let raw = l.volts_word(volts);
        let name = ["band_alpha", "band_beta"][x];
        let doc = format!(
            "Half width of the band of {} as a voltage",
            engineering(options.band, "A")
        );
        let error = [q[0], beta][x];
        let top = l.voltage(name, raw, &doc);
        let above = l.b.compare(Comparison::Less, top, error);
        l.b.name(["above_alpha", "above_beta"][x], above);
        let top = l.voltage(name, raw, &doc);
        let bottom = l.b.neg(top);
        let below = l.b.compare(Comparison::Less, error, bottom);
        let before = l.b.state(memory[x]);
        let zero = l.zero();
        let kept = l.b.select(below, zero, before);
        let one = l.b.literal(1);
        let wish = l.b.select(above, one, kept);
        l.b.name(["wish_alpha", "wish_beta"][x], wish)
    })
}

/// The vector that the switching table holds for sector, commutation and wishes.
fn look_up(
    l: &mut Lowering<'_>,
    options: &PhccSpec,
    front: &Front,
    [alpha, beta]: [Value; 2],
) -> Value {
    let table = switching_table(options, l.spec.motor.emf_shape);
    let table = l.b.program.table(
        "switching",
        table,
        &[
            "Vector by 64 set + 8 sector + 4 commutating + 2 alpha + beta; sets: 0 motoring forward, 1 motoring backward,".to_owned(),
            "2 braking forward, 3 braking backward. Vectors: 0 V0, 1 to 6 V1 to V6, 7 to 12 V12 to V61, 13 to 15 a pair's zero with leg a, b, c off.".to_owned(),
        ],
    );
    l.b.stage(
        "look_up_vector",
        &["The switching table: rows by quadrant of torque and speed, sector and commutation, columns by the wishes."],
    );
    let direction = front.direction.unwrap_or(front.set_point);
    let zero = l.zero();
    let negative = l.b.compare(Comparison::Less, front.set_point, zero);
    l.b.name("is_negative", negative);
    let positive = l.b.not(negative);
    let zero = l.zero();
    let forward = l.b.compare(Comparison::Less, zero, direction);
    let zero = l.zero();
    let backward = l.b.compare(Comparison::Less, direction, zero);
    l.b.name("is_backward", backward);
    let with_forward = l.b.and(positive, forward);
    let with_backward = l.b.and(negative, backward);
    let motoring = l.b.or(with_forward, with_backward);
    let (none, braking) = (l.zero(), l.b.literal(128));
    let quadrant = l.b.select(motoring, none, braking);
    let (reverse, none) = (l.b.literal(64), l.zero());
    let side = l.b.select(backward, reverse, none);
    let set = l.b.add(quadrant, side);
    l.b.name("set", set);
    let sector = l.b.shift_left(front.sector, 3);
    let row = l.b.add(set, sector);
    let commutating = front.commutation.map_or(alpha, |[_, word, _]| word);
    let commutating = l.b.shift_left(commutating, 2);
    let row = l.b.add(row, commutating);
    let alpha = l.b.shift_left(alpha, 1);
    let wishes = l.b.add(alpha, beta);
    let index = l.b.add(row, wishes);
    l.b.name("entry", index);
    let vector = l.b.lookup(table, index);
    l.b.name("vector", vector)
}
