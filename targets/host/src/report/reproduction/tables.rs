//! Tables 1, 2, 3 and 5.

use crate::report::sections::{number, quantity};
use hexagen_codegen::design::vectors::{
    LegSigns, SECTOR_CURRENT, THREE_PHASE, TWO_PHASE, clarke, leg_vector,
};
use hexagen_lab::reproduction::{CLOCK_HZ, Method, Reading, Reproduction, TIMES_TEXT};
use maud::{Markup, html};
use std::f64::consts::{FRAC_PI_6, TAU};

/// Electrical angle in degrees at which sector k + 1 begins.
fn entry_deg(k: usize) -> f64 {
    60.0 * k as f64 - 30.0
}

fn range_text(k: usize) -> String {
    let from = entry_deg(k);
    format!(
        "{}\u{b0} to {}\u{b0}",
        number(from, 0),
        number(from + 60.0, 0)
    )
}

/// A multiple of the unit as a fraction where it is one of the plane's: thirds, or over root 3.
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
    let theta = entry_deg(k).to_radians();
    emf(data, theta)
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
pub fn table_1(data: &Reproduction) -> Markup {
    let emf_rated = data.motor.emf_constant * data.motor.rated_speed;
    html! {
        p.note {
            "I = T/k" sub { "b" } " = " (quantity(data.current, "A")) " for " (quantity(data.torque, "Nm"))
            "; E = k" sub { "b" } "\u{3c9}/2 = " (quantity(emf_rated, "V")) " at rated speed (k" sub { "b" }
            " is line to line: as a phase constant the EMF would exceed the bus)."
        }
        div.scroll {
            table {
                thead {
                    tr {
                        th { "Sector" } th { "Rotor angle \u{3b8}" sub { "e" } } th { "Pair" }
                        th.number.edge { "i" sub { "\u{3b1}" } "/I" } th.number { "i" sub { "\u{3b2}" } "/I" }
                        th.number { "in A" }
                        th.number.edge { "e" sub { "\u{3b1}" } "/E" } th.number { "e" sub { "\u{3b2}" } "/E" }
                        th { "Against the paper" }
                    }
                }
                tbody {
                    @for (k, &signs) in SECTOR_CURRENT.iter().enumerate() {
                        @let [a, b, c] = signs.map(f64::from);
                        @let i = clarke(a, b, c);
                        @let e = emf_corner(data, k);
                        tr {
                            td { "S" (k + 1) } td { (range_text(k)) } td { (pair(signs)) }
                            td.number.edge { (exact(i.x)) } td.number { (exact(i.y)) }
                            td.number { "(" (number(data.current * i.x, 2)) ", " (number(data.current * i.y, 2)) ")" }
                            td.number.edge { (exact(e.0)) } td.number { (exact(e.1)) }
                            td {
                                @if k == 2 || k == 5 { "erratum: E" sub { (k + 1) } " is printed otherwise" } @else { "as printed" }
                            }
                        }
                    }
                }
            }
        }
        p.note {
            "Computed: the Clarke transform (2/3, amplitude-invariant) of (+I, \u{2212}I, 0) on the sector's pair, and of the three EMFs at the sector's entry. "
            "The current jumps from corner to corner; the EMF runs along the edges between its corners."
        }
    }
}

/// Legs as the paper writes them: +, -, 0.
fn legs_text(legs: LegSigns) -> String {
    legs.map(|sign| match sign {
        1 => '+',
        -1 => '\u{2212}',
        _ => '0',
    })
    .iter()
    .collect()
}

/// Table 2: vectors per sector.
pub fn table_2(data: &Reproduction) -> Markup {
    let v_bus = data.inverter.v_bus;
    let cells = |legs: LegSigns| {
        let v = leg_vector(legs, v_bus);
        let degrees = v.y.atan2(v.x).to_degrees().rem_euclid(360.0);
        html! {
            td { code { (legs_text(legs)) } }
            td.number { (number(degrees.round().rem_euclid(360.0), 0)) "\u{b0}" }
            td.number { (number(v.norm(), 1)) }
        }
    };
    html! {
        div.scroll {
            table {
                thead {
                    tr {
                        th rowspan="2" { "Sector" } th rowspan="2" { "Rotor angle \u{3b8}" sub { "e" } }
                        th.group.edge colspan="4" { "In commutation" }
                        th.group.edge colspan="4" { "Otherwise" }
                    }
                    tr {
                        @for _ in 0..2 {
                            th.edge { "Vector" } th { "Legs abc" } th.number { "Angle" } th.number { "V" }
                        }
                    }
                }
                tbody {
                    @for k in 0..6 {
                        @let next = (k + 1) % 6;
                        tr {
                            td { "S" (k + 1) } td { (range_text(k)) }
                            td.edge { "V" sub { (next + 1) } } (cells(THREE_PHASE[next]))
                            td.edge { "V" sub { (k + 1) (next + 1) } } (cells(TWO_PHASE[k]))
                        }
                    }
                }
            }
        }
        p.note {
            "Three-phase vectors are 2V" sub { "d" } "/3 long, two-phase vectors V" sub { "d" } "/\u{221a}3. The paper's column \u{201c}angle\u{201d} is the rotor angle \u{3b8}"
            sub { "e" } ", not the vector's. A two-phase vector is what it says only while its third leg carries no current: with current that leg's diode conducts, and the vector is a three-phase one."
        }
    }
}

/// Name of a vector number as in the switching tables.
fn vector_name(vector: u8) -> Markup {
    html! {
        @match vector {
            0..=6 => { "V" sub { (vector) } }
            7..=12 => { "V" sub { (vector - 6) ((vector - 6) % 6 + 1) } }
            _ => { "0" }
        }
    }
}

/// Table 3: the derived switching table beside the printed row.
pub fn table_3(data: &Reproduction) -> Markup {
    let row = |name: &str, row: &[u8; 8], is_first: bool| {
        html! {
            tr {
                td { (name) }
                @for (place, column) in [7, 6, 5, 4, 3, 2, 1, 0].into_iter().enumerate() {
                    @let differs = is_first && row[column] != data.tables.derived[0][column];
                    td.edge[place % 4 == 0].missed[differs] { (vector_name(row[column])) }
                }
            }
        }
    };
    let differing = (0..8)
        .filter(|&column| data.tables.printed[0][column] != data.tables.derived[0][column])
        .count();
    html! {
        div.scroll {
            table {
                thead {
                    tr {
                        th rowspan="2" { "Sector" }
                        th.group.edge colspan="4" { "In commutation, (H" sub { "\u{3b1}" } ", H" sub { "\u{3b2}" } ")" }
                        th.group.edge colspan="4" { "Otherwise" }
                    }
                    tr {
                        @for _ in 0..2 {
                            th.edge { "(1,1)" } th { "(1,0)" } th { "(0,1)" } th { "(0,0)" }
                        }
                    }
                }
                tbody {
                    (row("S1, printed", &data.tables.printed[0], true))
                    @for (k, derived) in data.tables.derived.iter().enumerate() {
                        (row(&format!("S{}, derived", k + 1), derived, false))
                    }
                }
            }
        }
        p.note {
            "Forward motoring; 0 is the zero vector of the sector's pair with its third leg off. The paper's table is lost but for its sector 1, as printed in the text; "
            (differing) " of its 8 entries differ from the derived ones (marked). An entry is derived from the vectors' geometry at three quarters of full EMF: the allowed vector that moves both components as wanted best. The literal reading turns the printed row through the sectors."
        }
    }
}

/// Table 5: instructions, computation time, free time, switching frequency.
pub fn table_5(data: &Reproduction) -> Markup {
    let t_s = data.inverter.t_s;
    html! {
        p {
            (TIMES_TEXT) "; " (quantity(CLOCK_HZ, "Hz")) ", T" sub { "s" } " = " (quantity(t_s, "s")) "."
        }
        div.scroll {
            table {
                thead {
                    tr {
                        th rowspan="2" { "Method" } th rowspan="2" { "Reading" }
                        th.group.edge colspan="2" { "Instructions per step" }
                        th.group.edge colspan="2" { "Bytes" }
                        th.group.edge colspan="3" { "Time, \u{b5}s" }
                        th.group.edge colspan="2" { "f" sub { "sw" } " per device, kHz" }
                    }
                    tr {
                        th.number.edge { "usual" } th.number { "worst" }
                        th.number.edge { "code" } th.number { "stack" }
                        th.number.edge { "T" sub { "c" } } th.number { "T" sub { "c" } " worst" } th.number { "T" sub { "f" } }
                        @for (k, rpm) in data.speeds_rpm.iter().enumerate() {
                            th.number.edge[k == 0] { (number(*rpm, 0)) " rpm" }
                        }
                    }
                }
                tbody {
                    @for method in Method::ALL {
                        @for reading in Reading::ALL {
                            @let run = data.methods[method.index()].of(reading);
                            @let cost = run.cost;
                            @let times = run.times(t_s);
                            tr {
                                td { @if reading == Reading::Literal { "(" (method.letter()) ") " (method.name()) } }
                                td { (reading.name()) }
                                td.number.edge { (number(run.usual_instructions().map(f64::from), 0)) } td.number { (cost.worst) }
                                td.number.edge { (cost.code) } td.number { (cost.stack) }
                                @for (k, time) in [times.usual, Some(times.worst), Some(times.free)].into_iter().enumerate() {
                                    td.number.edge[k == 0] { (number(time.map(|time| 1e6 * time), 1)) }
                                }
                                @for (k, point) in run.points.iter().enumerate() {
                                    td.number.edge[k == 0] { (number(point.figures.switching_hz.map(|hertz| hertz / 1e3), 1)) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The centre of sector k + 1 of the plane's twelve, in radians.
pub fn twelfth(k: usize) -> f64 {
    (k as f64 + 0.5) * FRAC_PI_6
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
