//! PHCC: directions are kept within the band, and the table's vectors move the current in the
//! demanded direction.

use crate::variants::{self, Variant};
use hexagen::Sample;
use hexagen_reference::verify::{Action, Context, Stimulus};
use hexagen_reference::{
    BitTrue, Candidates, Controller, DiscretePhase, Ideal, Mode, OffLeg, Phcc, Spec, SwitchingTable,
};

/// Phases of the conducting pair in sectors 1 to 6, plus and minus, and the third one.
const PAIRS: [[usize; 3]; 6] = [
    [2, 1, 0],
    [0, 1, 2],
    [0, 2, 1],
    [1, 2, 0],
    [1, 0, 2],
    [2, 0, 1],
];
/// The vectors' legs as the paper names them, by number.
const LEGS: [&str; 16] = [
    "---", "--+", "+-+", "+--", "++-", "-+-", "-++", "0-+", "+-0", "+0-", "0+-", "-+0", "-0+",
    "0--", "-0-", "--0",
];

fn phcc() -> impl Iterator<Item = (Variant, Phcc)> {
    variants::others().into_iter().filter_map(|variant| {
        let Controller::Phcc(options) = variant.spec.controller else {
            return None;
        };
        Some((variant, options))
    })
}

/// The number of a vector by its legs.
fn vector(legs: [char; 3]) -> usize {
    let text: String = legs.iter().collect();
    let found = LEGS.iter().position(|known| *known == text);
    found.expect("a vector")
}

/// The first variant on the motor (its name's beginning) with these options and no angle, delay 0.
fn plain(motor: &str, table: SwitchingTable, candidates: Candidates) -> (Variant, Phcc) {
    let mut found = phcc().filter(|(variant, options)| {
        variant.name.starts_with(motor)
            && options.table == table
            && options.candidates == candidates
            && options.delay == 0
            && options.off_leg == OffLeg::Physical
            && !variants::has_rotor(variant)
    });
    found.next().expect("such a variant")
}

/// Counts of phases a and b for currents in ampere.
fn sample(spec: &Spec, sector: usize, currents: [f64; 2]) -> Sample {
    let count = |current: f64| {
        let counts =
            f64::from(spec.inverter.adc_offset.first()) + current / spec.inverter.adc_gain.first();
        counts.round() as u16
    };
    Sample::with_hall(currents.map(count), spec.motor.hall_codes[sector - 1])
}

/// History of the drive; with the direction of rotation, 1 or -1.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Past {
    /// It stood still since the start.
    Standing,
    /// It has just entered the sector.
    Entering(isize),
    /// Commutation is over.
    Conducting(isize),
}

/// Vector of both models in a sector if both components are off in the directions `wishes`.
fn chosen(variant: &Variant, sector: usize, past: Past, current: f64, wishes: [f64; 2]) -> usize {
    let spec = &variant.spec;
    let mut bit_true = BitTrue::new(spec, &variants::table(variant)).expect("a model");
    let mut ideal = Ideal::new(spec).expect("a model");
    let bits = (current * 65_536.0) as i32;
    bit_true.set_current(bits);
    ideal.set_current(bits);
    let [plus, minus, _] = PAIRS[sector - 1];
    let mut currents = [0.0; 3];
    currents[plus] = current;
    currents[minus] = -current;
    // A current below its reference by this much, above either band, demands a rise.
    let step = spec.inverter.max_current / 10.0;
    currents[0] -= wishes[0] * step;
    currents[1] -= step * (wishes[1] * 3f64.sqrt() - wishes[0]) / 2.0;
    let sectors = match past {
        Past::Standing => vec![],
        Past::Entering(sense) => vec![(sector as isize - 1 - sense).rem_euclid(6) as usize + 1],
        Past::Conducting(sense) => {
            let before = (sector as isize - 1 - sense).rem_euclid(6) as usize + 1;
            vec![before, sector, sector]
        }
    };
    for passed in sectors {
        let first = sample(spec, passed, [0.0; 2]);
        bit_true.step(&first);
        ideal.step(&first);
    }
    let last = sample(spec, sector, [currents[0], currents[1]]);
    let legs = bit_true.step(&last);
    let duties = ideal.step(&last);
    assert_eq!(bit_true.mode(), Mode::Run);
    let entering = matches!(past, Past::Entering(_));
    assert_eq!(bit_true.trace().commutating, entering);
    assert_eq!(legs, duties.to_command(spec.inverter.timer_period as u16));
    assert_eq!(bit_true.trace().vector, ideal.trace().vector);
    ideal.trace().vector
}

/// alpha, beta of a vector of three driven legs or of a pair, in buses.
fn alpha_beta(vector: usize) -> [f64; 2] {
    let [a, b, c] = [0, 1, 2].map(|x| match LEGS[vector].as_bytes()[x] {
        b'+' => 0.5,
        b'-' => -0.5,
        _ => 0.0,
    });
    [(2.0 * a - b - c) / 3.0, (b - c) / 3f64.sqrt()]
}

#[test]
fn at_standstill_the_pair_follows_the_direction_along_its_line() {
    // The direction is unknown: rows that hold at any speed, without an EMF in the design and
    // without zeros.
    for motor in ["660 W", "servo"] {
        let (variant, _) = plain(motor, SwitchingTable::Derived, Candidates::Table2);
        let current = -0.4 * variant.spec.inverter.max_current;
        for sector in 1..=6 {
            let [plus, minus, _] = PAIRS[sector - 1];
            let mut legs = ['0'; 3];
            (legs[plus], legs[minus]) = ('+', '-');
            let pair = vector(legs);
            (legs[plus], legs[minus]) = ('-', '+');
            let reverse = vector(legs);
            let [c_a, c_b] = alpha_beta(pair);
            for wishes in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
                let along = c_a * wishes[0] + c_b * wishes[1];
                let expected = if along > 0.0 { pair } else { reverse };
                let found = chosen(&variant, sector, Past::Standing, current, wishes);
                assert_eq!(found, expected);
            }
        }
    }
}

/// Driving voltage in mid-sector or at its beginning, by vector: v - e.
fn drive(vector: usize, sector: usize, entering: bool, shape: fn(f64) -> f64) -> [f64; 2] {
    let theta = (sector as f64 - 1.0) * 60.0 - if entering { 21.0 } else { 0.0 };
    let e = [0.0, 120.0, 240.0].map(|lag| 0.375 * shape(theta - lag));
    let [v_a, v_b] = alpha_beta(vector);
    [
        v_a - (2.0 * e[0] - e[1] - e[2]) / 3.0,
        v_b - (e[1] - e[2]) / 3f64.sqrt(),
    ]
}

fn trapezoid(degrees: f64) -> f64 {
    let x = (degrees + 180.0).rem_euclid(360.0) - 180.0;
    (x.abs().min(180.0 - x.abs()) / 30.0).min(1.0).copysign(x)
}

#[test]
fn motoring_vectors_are_nearest_to_a_quarter_bus_in_the_demanded_direction() {
    let (variant, _) = plain("660 W", SwitchingTable::Derived, Candidates::ThreePhase);
    let current = 0.4 * variant.spec.inverter.max_current;
    for sector in 1..=6 {
        for past in [Past::Conducting(1), Past::Entering(1)] {
            for wishes in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
                let found = chosen(&variant, sector, past, current, wishes);
                let miss = |vector: usize| {
                    let [a, b] = drive(vector, sector, past == Past::Entering(1), trapezoid);
                    (a - 0.25 * wishes[0]).powi(2) + (b - 0.25 * wishes[1]).powi(2)
                };
                let least = (0..7).map(miss).fold(f64::MAX, f64::min);
                assert!(found < 7 && miss(found) <= least + 1e-9);
            }
        }
    }
}

#[test]
fn backward_is_the_mirror_image_of_forward() {
    for (table, candidates) in [
        (SwitchingTable::Derived, Candidates::Table2),
        (SwitchingTable::Derived, Candidates::ThreePhase),
        (SwitchingTable::Printed, Candidates::Table2),
    ] {
        for motor in ["660 W", "servo"] {
            let (variant, _) = plain(motor, table, candidates);
            let current = 0.4 * variant.spec.inverter.max_current;
            for sector in 1..=6 {
                for wishes in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
                    let forward = chosen(&variant, sector, Past::Entering(1), current, wishes);
                    let mut legs: Vec<char> = LEGS[forward].chars().collect();
                    legs.swap(1, 2);
                    let image = [1, 6, 5, 4, 3, 2][sector - 1];
                    let past = Past::Entering(-1);
                    let backward = chosen(&variant, image, past, -current, [wishes[0], -wishes[1]]);
                    assert_eq!(backward, vector([legs[0], legs[1], legs[2]]));
                }
            }
        }
    }
}

#[test]
fn the_printed_row_rotates_with_the_sector() {
    let (variant, _) = plain("660 W", SwitchingTable::Printed, Candidates::Table2);
    let current = 0.4 * variant.spec.inverter.max_current;
    for sector in 1..=6 {
        let next = sector % 6 + 1;
        let pair = |first: usize| 6 + first;
        let before = (sector + 4) % 6 + 1;
        let (entering, conducting) = (Past::Entering(1), Past::Conducting(1));
        for (past, wishes, expected) in [
            (entering, [1.0, 1.0], next),
            (entering, [1.0, -1.0], sector),
            (entering, [-1.0, 1.0], next),
            (entering, [-1.0, -1.0], 0),
            (conducting, [1.0, 1.0], pair(sector)),
            (conducting, [1.0, -1.0], pair(before)),
            (conducting, [-1.0, 1.0], pair(sector)),
            (conducting, [-1.0, -1.0], 0),
        ] {
            assert_eq!(chosen(&variant, sector, past, current, wishes), expected);
        }
    }
}

#[test]
fn a_numeric_table_has_the_order_of_sector_commutation_and_directions() {
    let (variant, _) = plain("servo", SwitchingTable::Printed, Candidates::Table2);
    let numbers: Vec<usize> = (0..48).map(|place| (place * 7 + place / 16) % 16).collect();
    let text = variant.toml.replace("\"printed\"", &format!("{numbers:?}"));
    let given = Variant {
        spec: Spec::from_toml(&text).expect("a specification"),
        ..variant
    };
    let current = 0.4 * given.spec.inverter.max_current;
    let mut place = 0;
    for sector in 1..=6 {
        for past in [Past::Conducting(1), Past::Entering(1)] {
            for wishes in [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]] {
                let found = chosen(&given, sector, past, current, wishes);
                assert_eq!(found, numbers[place], "place {place}");
                place += 1;
            }
        }
    }
}

#[test]
fn invalid_numeric_tables_are_rejected() {
    let (variant, _) = plain("servo", SwitchingTable::Printed, Candidates::Table2);
    let with = |table: &str| Spec::from_toml(&variant.toml.replace("\"printed\"", table));
    assert!(with(&format!("{:?}", [15; 48])).is_ok());
    assert!(with(&format!("{:?}", [15; 47])).is_err());
    assert!(with(&format!("{:?}", [16; 48])).is_err());
    assert!(with("\"paper\"").is_err());
    let pairs = variant.toml.replace("\"table2\"", "\"all\"");
    assert!(Spec::from_toml(&pairs).is_err());
    let band = variant.toml.replace("band = 0.1", "band = -0.1");
    assert!(Spec::from_toml(&band).is_err());
}

/// The directions of the step; `None` for an axis that comes from rest.
fn wishes(model: &BitTrue) -> [Option<bool>; 2] {
    model.physical_state().rises
}

#[test]
fn a_direction_is_kept_within_the_band() {
    let mut held = 0;
    for (seed, (variant, options)) in (0..).zip(phcc()) {
        let mut model = BitTrue::new(&variant.spec, &variants::table(&variant)).expect("a model");
        let mut stimulus = Stimulus::new(&variant.spec, seed).expect("a stimulus");
        let DiscretePhase { b, .. } = DiscretePhase::new(&variant.spec);
        for _ in 0..1000 {
            let context = Context {
                offset: model.offset_counts(),
                tripped: model.mode() == Mode::Tripped,
            };
            let (action, sample) = stimulus.next(&context);
            match action {
                Some(Action::SetCurrent(bits)) => model.set_current(bits),
                Some(Action::SetTorque(bits)) => model.set_torque(bits),
                Some(Action::SetBus(counts)) => model.set_bus(counts),
                Some(Action::Reset) => model.reset(),
                _ => {}
            }
            let before = wishes(&model);
            stimulus.respond(model.step(&sample));
            let after = wishes(&model);
            let trace = model.trace();
            if !trace.run {
                assert_eq!(after, [None; 2]);
                continue;
            }
            let [q_a, q_b] = trace.u_unsat;
            let errors = [q_a, (q_a + 2.0 * q_b) / 3f64.sqrt()].map(|q| q * b);
            for axis in 0..2 {
                let (error, edge) = (errors[axis], 1e-3 * options.band);
                if error > options.band + edge {
                    assert_eq!(after[axis], Some(true));
                } else if error < -options.band - edge {
                    assert_eq!(after[axis], Some(false));
                } else if error.abs() < options.band - edge && before[axis].is_some() {
                    assert_eq!(after[axis], before[axis]);
                    held += 1;
                } else if error.abs() > edge && before[axis].is_none() {
                    assert_eq!(after[axis], Some(error > 0.0));
                }
            }
        }
    }
    assert!(held > 1000, "{held}");
}
