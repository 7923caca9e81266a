//! Documentation of the method, and its switching table.

use super::table::switching_table;
use crate::diagnostics::engineering;
use crate::interface::{PublicConstant, PublicValue};
use crate::laws::Description;
use crate::laws::current_loop::LoopDesign;
use crate::laws::whole_vectors::pulsed_legs;
use crate::spec::{PhccSpec, Spec, SwitchingTable};

const SETS: [&str; 4] = [
    "motoring forward",
    "motoring backward",
    "braking forward",
    "braking backward",
];

/// Name of a vector number.
fn name(vector: i32) -> String {
    match vector {
        0..=6 => format!("V{vector}"),
        7..=12 => format!("V{}{}", vector - 6, (vector - 6) % 6 + 1),
        _ => "0".to_owned(),
    }
}

/// Documentation and constants of the method.
pub(super) fn describe(spec: &Spec, options: &PhccSpec, design: &LoopDesign) -> Description {
    let high = spec.inverter.v_bus * spec.reach_share();
    let stride = design.plant.gain * 2.0 / 3.0 * high;
    let table = switching_table(options, spec.motor.emf_shape);
    let mut notes = vec![
        format!(
            "Two hysteresis bands of {} around the reference, on alpha and beta: each axis demands a rise (1) or a fall (0) of",
            engineering(options.band, "A")
        ),
        "the predicted current, and a table gives the vector.".to_owned(),
        format!(
            "One three-phase vector moves the current by at most {} per period.",
            engineering(stride, "A")
        ),
    ];
    notes.extend(pulsed_legs(spec));
    notes.extend([String::new(), origin(options.table).to_owned()]);
    for (set, title) in SETS.iter().enumerate() {
        notes.extend([
            String::new(),
            format!("Switching table, {title}; columns (alpha, beta); 0 is the zero vector of the sector's pair, third leg off:"),
            String::new(),
            "| sector | commutation 11 | 10 | 01 | 00 | otherwise 11 | 10 | 01 | 00 |".to_owned(),
            "|---|---|---|---|---|---|---|---|---|".to_owned(),
        ]);
        for sector in 1..=6 {
            let row = &table[64 * set + 8 * sector..][..8];
            let cells: Vec<String> = [7, 6, 5, 4, 3, 2, 1, 0]
                .iter()
                .map(|&column: &usize| name(row[column]))
                .collect();
            notes.push(format!("| S{sector} | {} |", cells.join(" | ")));
        }
    }
    Description {
        title: "Predictive hysteresis current controller",
        notes,
        stable: None,
        constants: vec![PublicConstant {
            name: "SWITCHING_TABLE".to_owned(),
            value: PublicValue::Integers {
                rust_type: "u8",
                values: table.into_iter().map(i64::from).collect(),
            },
            doc: vec![
                "Vector by 64 set + 8 sector + 4 commutating + 2 alpha + beta; sets: 0 motoring forward, 1 motoring backward, 2".to_owned(),
                "braking forward, 3 braking backward. Vectors: 0 V0, 1 to 6 V1 to V6, 7 to 12 V12 to V61, 13 to 15 a pair's zero with leg a, b or c off.".to_owned(),
            ],
        }],
    }
}

fn origin(table: SwitchingTable) -> &'static str {
    match table {
        SwitchingTable::Derived => {
            "The table is derived from the geometry of the vectors: an entry is the vector nearest to the EMF plus the demanded change."
        }
        SwitchingTable::Printed => {
            "The motoring rows are the paper's printed row of sector 1, turned through the sectors. They select vectors that\nmove the axes the wrong way: the current is lost at speed. For study only."
        }
        SwitchingTable::Given(_) => "The motoring rows are those of the specification.",
    }
}
