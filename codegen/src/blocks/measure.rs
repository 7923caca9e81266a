//! Inputs of a step: phase currents and the Hall code (semantics, steps 1 and 2). Currents arrive as
//! words: the runtime's supervisor has made them of ADC counts, by the numbers of
//! `laws::supervision`.

use super::Lowering;
use crate::ir::{Expr, Flag, Interval, Lut, Memory, Phases, named};
use crate::spec::RotorSensing;

/// A sixth of a turn, a sector: floor(2^32 / 6).
pub(super) const SIXTH: i64 = 715_827_882;

/// A sample that the supervisor has checked.
#[derive(Clone, Copy, Debug)]
pub struct Sample<'b> {
    /// Currents of phases a and b, words of current.
    pub currents: Phases<'b>,
    /// Hall code; 0 in a period at rest without a valid code.
    pub hall: Expr<'b>,
    /// Ticks since the last Hall edge; with a capture timer only.
    pub hall_ticks: Option<Expr<'b>>,
    /// Electrical angle; with an angle sensor only.
    pub angle: Option<Expr<'b>>,
}

/// Sector and edge of this sample.
#[derive(Clone, Copy, Debug)]
pub struct Hall<'b> {
    /// Sector; the last valid one if the code is invalid, 0 before the first.
    pub sector: Expr<'b>,
    /// The word of the last sample's sector.
    pub sector_prev: Memory<'b>,
    /// The sector changed, the first one included.
    pub changed: Flag<'b>,
    /// The sector changed from a valid one: a Hall edge.
    pub edge: Flag<'b>,
}

/// The inputs of the step.
pub fn sample<'b>(l: &Lowering<'b>) -> Sample<'b> {
    l.b.stage("sample", &[]);
    let range = l.current_range();
    let doc = "Current of the phase into the motor, words of current.";
    let currents = Phases(["i_a", "i_b"].map(|name| l.b.input(name, range, doc)));
    let codes = Interval::new(0, 6);
    let doc = "Hall code, Ha in bit 2; 0 in a period at rest without a valid code.";
    let hall = l.b.input("hall", codes, doc);
    let is_timed = matches!(
        l.spec.inverter.rotor_sensing,
        RotorSensing::TimedHalls { .. }
    );
    let hall_ticks = is_timed.then(|| {
        let ticks = Interval::new(0, i64::from(u16::MAX));
        let doc = "Ticks of a clock of `HALL_TIMER_HZ` from the last Hall edge to this sample, at most 65535.";
        l.b.input("hall_ticks", ticks, doc)
    });
    let angle = l.spec.angle_sensor().map(|_| {
        let angles = Interval::new(i64::from(i32::MIN), i64::from(i32::MAX));
        let doc = "Electrical angle, 2^32 a turn.";
        l.b.input("angle", angles, doc)
    });
    Sample {
        currents,
        hall,
        hall_ticks,
        angle,
    }
}

/// Currents of all phases.
pub fn third_current<'b>(l: &Lowering<'b>, sample: &Sample<'b>) -> Phases<'b, 3> {
    let doc = "Current of phase c by Kirchhoff's law.";
    l.b.stage("find_third_current", &[doc]);
    sample.currents.with_c("i")
}

/// Sector 1 to 6 by Hall code; 0 for invalid codes.
fn hall_sectors<'b>(l: &Lowering<'b>) -> Lut<'b> {
    let sectors = l.spec.hall_sectors().map(i32::from).to_vec();
    let doc = "Sector 1 to 6 by Hall code; 0 for invalid codes.";
    l.b.column("hall", "hall_sector", sectors, doc)
}

/// The sector of a sample, for laws that use no edges.
pub fn sector_of<'b>(l: &Lowering<'b>, sample: &Sample<'b>) -> Expr<'b> {
    l.b.stage("find_sector", &["Sector from the Hall code."]);
    named! {
        let sector = hall_sectors(l).at(sample.hall);
    }
    sector
}

/// Sector and edge of a sample.
pub fn find_sector<'b>(l: &Lowering<'b>, sample: &Sample<'b>, sector_prev: Memory<'b>) -> Hall<'b> {
    let doc = "Sector from the Hall code; a sample without a code keeps the last sector.";
    l.b.stage("find_sector", &[doc]);
    let last = sector_prev.read();
    named! {
        let sector_seen = hall_sectors(l).at(sample.hall);
        let sector = sample.hall.is(0).choose(last, sector_seen);
        let sector_changed = sector.is_not(last);
        // Before the first sample there is no last sector to leave.
        let sector_left = last.is(0).choose(sector, last);
        let edge = sector.is_not(sector_left);
    }
    Hall {
        sector,
        sector_prev,
        changed: sector_changed,
        edge,
    }
}

/// Declares the sector of the last sample.
pub fn sector_word<'b>(l: &Lowering<'b>) -> Memory<'b> {
    let doc = "Sector of the last sample; 0 before the first.";
    l.b.memory("sector_prev", 0, Interval::new(0, 6), doc)
}
