//! Tables 1 to 5.

use super::verdicts::lettered;
use crate::report::{Block, Cell, Column, Label, Table};
use crate::reproduction::{CLOCK_HZ, Method, Reading, Reproduction, Run, TIMES_TEXT};
use crate::text::{number, quantity};
use hexagen_codegen::design::vectors::{
    LegSigns, SECTOR_CURRENT, THREE_PHASE, TWO_PHASE, clarke, leg_vector,
};
use std::f64::consts::TAU;

/// Electrical angle in degrees at which sector k + 1 begins.
fn entry_deg(k: usize) -> f64 {
    60.0 * k as f64 - 30.0
}

fn range_text(k: usize) -> String {
    let [from, to] = [k, k + 1].map(|k| number(entry_deg(k), 0));
    format!("{from}\u{b0} to {to}\u{b0}")
}

/// A multiple of the unit as a fraction, if it is a multiple of a third or of 1/root 3.
fn exact(value: f64) -> String {
    let root = 3.0_f64.sqrt();
    let known = [
        (0.0, "0"),
        (1.0, "1"),
        (2.0 / 3.0, "2/3"),
        (4.0 / 3.0, "4/3"),
        (1.0 / root, "1/\u{221a}3"),
        (2.0 / root, "2/\u{221a}3"),
    ];
    let found = known
        .iter()
        .find(|(magnitude, _)| (value.abs() - magnitude).abs() < 1e-9);
    match found {
        Some((_, text)) if value < -1e-9 => format!("\u{2212}{text}"),
        Some((_, text)) => (*text).to_owned(),
        None => number(value, 4),
    }
}

/// The EMF corner of sector k + 1 in units of the phase amplitude: the EMF at the sector's entry.
pub fn emf_corner(data: &Reproduction, k: usize) -> (f64, f64) {
    emf(data, entry_deg(k).to_radians())
}

/// The EMF at an electrical angle, in units of the phase amplitude.
pub fn emf(data: &Reproduction, theta: f64) -> (f64, f64) {
    let [a, b, c] = [0.0, 1.0, 2.0].map(|x| data.motor.emf_shape.at(theta - x * TAU / 3.0));
    let v = clarke(a, b, c);
    (v.x, v.y)
}

/// The conducting pair of a sector: "c+ b-".
fn pair(signs: LegSigns) -> String {
    let leg = |wanted: i32, sign: &str| {
        let phase = signs.iter().position(|&s| s == wanted);
        format!("{}{sign}", ["a", "b", "c"][phase.unwrap_or(0)])
    };
    format!("{}\u{a0}{}", leg(1, "+"), leg(-1, "\u{2212}"))
}

/// Table 1: reference corners and EMF corners.
pub fn table_1(data: &Reproduction) -> Vec<Block> {
    let emf_rated = data.motor.emf_constant * data.motor.rated_speed;
    let units = format!(
        "I = T/k_{{b}} = {} for {}; E = k_{{b}}\u{3c9}/2 = {} at rated speed (k_{{b}} is line to line: as a phase constant the EMF would \
         exceed the bus).",
        quantity(data.current, "A"),
        quantity(data.torque, "Nm"),
        quantity(emf_rated, "V")
    );
    let mut table = Table::new(
        "",
        [
            Column::text("Sector"),
            Column::text("Rotor angle \u{3b8}_{e}"),
            Column::text("Pair"),
            Column::number("i_{\u{3b1}}/I", ""),
            Column::number("i_{\u{3b2}}/I", ""),
            Column::number("in A", ""),
            Column::number("e_{\u{3b1}}/E", ""),
            Column::number("e_{\u{3b2}}/E", ""),
            Column::text("Compared with the paper"),
        ],
    );
    for (k, &signs) in SECTOR_CURRENT.iter().enumerate() {
        let [a, b, c] = signs.map(f64::from);
        let (i, e) = (clarke(a, b, c), emf_corner(data, k));
        let amperes = [i.x, i.y].map(|part| number(data.current * part, 2));
        table.row([
            format!("S{}", k + 1),
            range_text(k),
            pair(signs),
            exact(i.x),
            exact(i.y),
            format!("({})", amperes.join(", ")),
            exact(e.0),
            exact(e.1),
            match k {
                2 | 5 => format!("erratum: E_{{{}}} is printed differently", k + 1),
                _ => "as printed".to_owned(),
            },
        ]);
    }
    let how = "Computed: the Clarke transform (2/3, amplitude-invariant) of (+I, \u{2212}I, 0) on the sector's pair, and of the three EMFs \
               at the sector's entry. The current jumps from corner to corner; the EMF moves along the edges between its corners.";
    vec![
        Block::Note(units),
        Block::Table(table),
        Block::Note(how.to_owned()),
    ]
}

/// Legs in the paper's notation: +, -, 0.
fn legs_text(legs: LegSigns) -> String {
    let sign = |sign| match sign {
        1 => '+',
        -1 => '\u{2212}',
        _ => '0',
    };
    legs.map(sign).iter().collect()
}

/// The two parts of the paper's tables: during commutation, and otherwise.
const HALVES: [&str; 2] = ["In commutation", "Otherwise"];

/// Table 2: vectors per sector.
pub fn table_2(data: &Reproduction) -> Vec<Block> {
    let v_bus = data.inverter.v_bus;
    let cells = |name: String, legs: LegSigns| {
        let v = leg_vector(legs, v_bus);
        let degrees = v.y.atan2(v.x).to_degrees().rem_euclid(360.0);
        let degrees = number(degrees.round().rem_euclid(360.0), 0);
        [
            name,
            format!("`{}`", legs_text(legs)),
            format!("{degrees}\u{b0}"),
            number(v.norm(), 1),
        ]
    };
    let first = ["Sector", "Rotor angle \u{3b8}_{e}"].map(Column::text);
    let halves = HALVES.into_iter().flat_map(|half| {
        [
            Column::text("Vector").of(half),
            Column::text("Legs abc").of(half),
            Column::number("Angle", "").of(half),
            Column::number("V", "").of(half),
        ]
    });
    let mut table = Table::new("", first.into_iter().chain(halves));
    for (k, &legs) in TWO_PHASE.iter().enumerate() {
        let next = (k + 1) % 6;
        let three = cells(format!("V_{{{}}}", next + 1), THREE_PHASE[next]);
        let two = cells(format!("V_{{{}{}}}", k + 1, next + 1), legs);
        let first = [format!("S{}", k + 1), range_text(k)];
        table.row(first.into_iter().chain(three).chain(two));
    }
    let note = "Three-phase vectors are 2V_{d}/3 long, two-phase vectors V_{d}/\u{221a}3. The paper's column \u{201c}angle\u{201d} is the \
                rotor angle \u{3b8}_{e}, not the vector's. A two-phase vector needs a third leg without current: \
                with current that leg's diode conducts, which makes a three-phase vector.";
    vec![Block::Table(table), Block::Note(note.to_owned())]
}

/// Name of a vector by its number in the switching tables.
fn vector_name(vector: u8) -> String {
    match vector {
        0..=6 => format!("V_{{{vector}}}"),
        7..=12 => format!("V_{{{}{}}}", vector - 6, (vector - 6) % 6 + 1),
        _ => "0".to_owned(),
    }
}

/// Table 3: the derived switching table and the printed row.
pub fn table_3(data: &Reproduction) -> Vec<Block> {
    let (printed, derived) = (&data.tables.printed[0], &data.tables.derived);
    let halves = HALVES.into_iter().flat_map(|half| {
        let names = ["(1,1)", "(1,0)", "(0,1)", "(0,0)"].into_iter();
        let half = match half {
            "In commutation" => "In commutation, (H_{\u{3b1}}, H_{\u{3b2}})",
            _ => half,
        };
        names.map(move |name| Column::text(name).of(half))
    });
    let mut table = Table::new("", [Column::text("Sector")].into_iter().chain(halves));
    let places = || (0..8).rev();
    let marked = places().map(|place| {
        let differs = printed[place] != derived[0][place];
        Cell::from(vector_name(printed[place])).missed_if(differs)
    });
    table.row(["S1, printed".into()].into_iter().chain(marked));
    for (k, row) in derived.iter().enumerate() {
        let names = places().map(|place| vector_name(row[place]));
        table.row([format!("S{}, derived", k + 1)].into_iter().chain(names));
    }
    let differing = places()
        .filter(|&place| printed[place] != derived[0][place])
        .count();
    let note = format!(
        "Forward motoring; 0 is the zero vector of the sector's pair with its third leg off. Only sector \
         1 of the paper's table is available, from its text; {differing} of its 8 entries differ from the derived ones (marked). Entries are derived from the \
         vectors' geometry at three quarters of full EMF: the allowed vector that best moves both components in the required direction. The literal \
         reading rotates the printed row through the sectors."
    );
    vec![Block::Table(table), Block::Note(note)]
}

/// Table 4: the motor's data as printed, and as the file states them.
pub fn table_4(data: &Reproduction) -> Vec<Block> {
    let (motor, inverter) = (&data.motor, &data.inverter);
    let line_to_line = motor.emf_constant * motor.emf_shape.line_to_line_peak();
    let rpm = motor.rated_speed * 60.0 / TAU;
    let torque = motor.rated_torque.unwrap_or(data.torque);
    let rows = [
        ("pole pairs", "4", motor.pole_pairs.to_string(), ""),
        (
            "inductance",
            "0.22 mH",
            quantity(motor.inductance, "H"),
            "\u{201c}inclusive phase inductance\u{201d}: that of one phase of a star, its mutual inductance included",
        ),
        (
            "resistance",
            "0.135 ohm",
            quantity(motor.resistance, "ohm"),
            "of one phase of a star",
        ),
        ("rated torque", "3.3 Nm", quantity(torque, "Nm"), ""),
        (
            "rated speed",
            "2000 rpm",
            format!("{} rpm", number(rpm, 0)),
            "",
        ),
        (
            "rated current",
            "20 A",
            quantity(motor.rated_current, "A"),
            "the height of the quasi-square wave",
        ),
        ("bus voltage", "48 V", quantity(inverter.v_bus, "V"), ""),
        (
            "k_{b}",
            "0.1648 V s/rad",
            quantity(line_to_line, "V s/rad"),
            "line to line: 0.1648 V s/rad times 20 A are the rated torque, and as a phase constant the EMF would exceed the bus",
        ),
    ];
    let names = ["Quantity", "Printed", "Used here", "Reading"];
    let mut table = Table::new("", names.map(Column::text));
    for (name, printed, used, reading) in rows {
        table.row([name, printed, &used, reading].map(str::to_owned));
    }
    vec![Block::Table(table)]
}

/// Table 5: instructions, computation time, free time, switching frequency.
pub fn table_5(data: &Reproduction) -> Vec<Block> {
    let number = |name: &str, group: &str| Column::number(name, "").of(group);
    let instructions = "Instructions per step";
    let (bytes, time) = ("Bytes", "Time, \u{b5}s");
    let mut columns = vec![
        Column::text("Method"),
        Column::text("Reading"),
        number("usual", instructions),
        number("worst", instructions),
        number("code", bytes),
        number("stack", bytes),
        number("T_{c}", time),
        number("T_{c} worst", time),
        number("T_{f}", time),
    ];
    let speeds = data.speeds_rpm.iter();
    let switching = speeds.map(|rpm| number(&format!("{rpm:.0} rpm"), "f_{sw} per device, kHz"));
    columns.extend(switching);
    let mut table = Table::new("", columns);
    for method in Method::ALL {
        table.group(Label::Beside(lettered(method).into()));
        for reading in Reading::ALL {
            let run = data.methods[method.index()].of(reading);
            table.row(cost_row(run, reading, data.inverter.t_s));
        }
    }
    let how = format!(
        "{TIMES_TEXT}; {}, T_{{s}} = {}.",
        quantity(CLOCK_HZ, "Hz"),
        quantity(data.inverter.t_s, "s")
    );
    vec![Block::Prose(how), Block::Table(table)]
}

fn cost_row(run: &Run, reading: Reading, t_s: f64) -> Vec<String> {
    let (cost, times) = (run.cost, run.times(t_s));
    let times = [times.usual, Some(times.worst), Some(times.free)];
    let switching = run.points.iter().map(|point| point.figures.switching_hz);
    let mut cells = vec![
        reading.name().to_owned(),
        number(run.usual_instructions().map(f64::from), 0),
        cost.worst.to_string(),
        cost.code.to_string(),
        cost.stack.to_string(),
    ];
    cells.extend(times.map(|time| number(time.map(|time| 1e6 * time), 1)));
    cells.extend(switching.map(|hertz| number(hertz.map(|hertz| hertz / 1e3), 1)));
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_are_written_as_the_paper_does() {
        let root = 3.0_f64.sqrt();
        for (value, text) in [
            (0.0, "0"),
            (-1e-12, "0"),
            (-2.0 / root, "\u{2212}2/\u{221a}3"),
            (4.0 / 3.0, "4/3"),
            (0.5, "0.5000"),
        ] {
            assert_eq!(exact(value), text);
        }
    }

    #[test]
    fn legs_and_pairs_read_as_in_the_paper() {
        assert_eq!(legs_text([-1, 1, 0]), "\u{2212}+0");
        assert_eq!(pair(SECTOR_CURRENT[0]), "c+\u{a0}b\u{2212}");
        assert_eq!(pair(SECTOR_CURRENT[2]), "a+\u{a0}c\u{2212}");
    }
}
