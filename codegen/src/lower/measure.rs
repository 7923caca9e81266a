//! What a step takes from the supervisor: phase currents and the Hall code (semantics, steps 1 and 2).

use super::Lowering;
use crate::ir::{Comparison, Interval, StateId, Value};
use crate::spec::HallCapture;

/// A sample that the supervisor has checked.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Currents of phases a and b, words of current.
    pub currents: [Value; 2],
    /// The Hall code; 0 at rest where there is none.
    pub hall: Value,
    /// Ticks since the last Hall edge, where they are captured.
    pub hall_ticks: Option<Value>,
}

/// Phase currents of this sample, in words of current.
#[derive(Clone, Copy, Debug)]
pub struct Currents {
    /// Currents of phases a, b, c.
    pub phases: [Value; 3],
}

/// Sector and edge of this sample.
#[derive(Clone, Copy, Debug)]
pub struct Hall {
    /// Sector in force: the last valid one where the code is invalid; 0 before the first.
    pub sector: Value,
    /// Sector of the last sample.
    pub sector_prev: Value,
    /// The state word of that.
    pub sector_prev_word: StateId,
    /// Flag: the sector is not the last sample's, which may have had none.
    pub changed: Value,
    /// Flag: the sector changed.
    pub edge: Value,
}

impl Lowering<'_> {
    /// The inputs of the step.
    pub fn sample(&mut self) -> Sample {
        self.b.stage("sample", &[]);
        let range = self.current_range();
        let doc = "Current of the phase into the motor, words of current.";
        let currents = ["i_a", "i_b"].map(|name| self.b.input(name, range, doc));
        let hall = self.b.input(
            "hall",
            Interval::new(0, 6),
            "Hall code, Ha in bit 2; 0 at rest where there is none.",
        );
        let is_timed = matches!(self.spec.inverter.hall_capture, HallCapture::Timer { .. });
        let hall_ticks = is_timed.then(|| {
            self.b.input(
                "hall_ticks",
                Interval::new(0, i64::from(u16::MAX)),
                "Ticks of a clock of `HALL_TIMER_HZ` from the last Hall edge to this sample, stopping at 65535.",
            )
        });
        Sample {
            currents,
            hall,
            hall_ticks,
        }
    }

    /// Currents of all phases.
    pub fn third_current(&mut self, sample: &Sample) -> Currents {
        self.b.stage(
            "find_third_current",
            &["Current of phase c by Kirchhoff's law."],
        );
        let [a, b] = sample.currents;
        let c = self.third_phase("i_c", a, b);
        Currents { phases: [a, b, c] }
    }

    /// Sector 1 to 6 by Hall code; 0 for the codes that cannot be.
    pub(super) fn hall_sectors(&self) -> [i32; 8] {
        self.spec.hall_sectors().map(i32::from)
    }

    /// The sector of a Hall code, added to the open stage.
    fn decoded(&mut self, hall: Value) -> Value {
        let sectors = self.hall_sectors();
        let decode = self.b.program.column(
            "hall",
            "hall_sector",
            sectors.to_vec(),
            &["Sector 1 to 6 of a Hall code; 0 for the codes that cannot be.".to_owned()],
        );
        self.b.lookup(decode, hall)
    }

    /// The sector of a sample, for laws that follow no edges.
    pub fn sector_of(&mut self, sample: &Sample) -> Value {
        self.b.stage("find_sector", &["Sector from the Hall code."]);
        let sector = self.decoded(sample.hall);
        self.b.name("sector", sector)
    }

    /// Sector and edge.
    pub fn find_sector(&mut self, sample: &Sample, word: StateId) -> Hall {
        self.b.stage(
            "find_sector",
            &["Sector from the Hall code; a sample without a code keeps the last sector."],
        );
        let seen = self.decoded(sample.hall);
        self.b.name("sector_seen", seen);
        let sector_prev = self.b.state(word);
        let zero = self.zero();
        let is_lost = self.b.compare(Comparison::Equal, sample.hall, zero);
        let sector = self.b.select(is_lost, sector_prev, seen);
        self.b.name("sector", sector);
        let [changed, edge] = self.compare_sectors(sector, sector_prev);
        self.b.name("sector_changed", changed);
        self.b.name("edge", edge);
        Hall {
            sector,
            sector_prev,
            sector_prev_word: word,
            changed,
            edge,
        }
    }

    /// Declares the sector of the last sample.
    pub fn sector_word(&mut self) -> StateId {
        self.state(
            "sector_prev",
            0,
            Interval::new(0, 6),
            "Sector of the last sample; 0 before the first.",
        )
    }

    /// Flags, added to the open stage: the sector is not the last sample's, which may have had none (0); and it is another.
    pub(super) fn compare_sectors(&mut self, sector: Value, sector_prev: Value) -> [Value; 2] {
        let different = self.b.compare(Comparison::NotEqual, sector, sector_prev);
        let zero = self.zero();
        let known = self.b.compare(Comparison::NotEqual, sector_prev, zero);
        [different, self.b.and(different, known)]
    }
}
