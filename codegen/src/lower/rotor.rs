//! Rotor angle and speed from Hall edges (semantics, step 4).

use super::Lowering;
use super::measure::Hall;
use super::number::round_half_up;
use crate::diagnostics::significant;
use crate::interface::Rounding;
use crate::ir::{Comparison, Exact, Interval, Real, StateId, Value};
use crate::spec::HallCapture;

/// A sixth of a turn: floor(2^32 / 6).
const SIXTH: i64 = 715_827_882;
/// Angle added before the division into sectors: sector 1 begins at -30 degrees. Rounded up, as are the
/// sector starts, so that a sector's first and last angle fall into that sector.
const SECTOR_ORIGIN: i64 = 357_913_942;

/// So many sixths of a turn.
fn sixth_turn(share: f64) -> Exact {
    Exact::Number(Real::of(f64::from(32).exp2() / 6.0 * share))
}

/// Ticks of the edge timer in a control period.
#[derive(Clone, Copy, Debug)]
struct PeriodTicks {
    exact: f64,
    /// Whole ticks, rounded down: counts that go up by them are never ahead of the timer.
    whole: i64,
    /// What six intervals, each counted with a period of whole ticks, lack in a turn; 0 where all
    /// ticks are whole.
    turn_rest: i64,
}

impl PeriodTicks {
    fn of(capture: HallCapture) -> Self {
        let exact = capture.ticks_per_period();
        Self {
            exact,
            whole: exact.floor() as i64,
            turn_rest: (6.0 * exact.fract() + 0.5).floor() as i64,
        }
    }

    fn doc(self) -> String {
        if self.exact.fract() == 0.0 {
            "Ticks per control period.".to_owned()
        } else {
            format!(
                "Whole ticks per control period, of {}.",
                significant(self.exact)
            )
        }
    }
}

/// State words of the rotor tracker.
#[derive(Clone, Copy, Debug)]
pub struct RotorWords {
    direction: StateId,
    age_prev: StateId,
    edges: StateId,
    intervals: [StateId; 6],
    rev: StateId,
    omega: StateId,
}

/// Angle and speed at this sample.
#[derive(Clone, Copy, Debug)]
pub struct Rotor {
    /// Direction of the last edge: 1 or -1.
    pub direction: Value,
    /// Electrical angle.
    pub theta: Value,
    /// Electrical angle per control period, signed; 0 while the speed is unknown.
    pub step_angle: Value,
    /// Flag: the speed is known and the angle interpolated.
    pub tracking: Value,
    /// Electrical angle per tick; 0 while the speed is unknown.
    pub omega: Value,
}

/// Which way the sector changed at an edge.
struct Turned {
    forward: Value,
    backward: Value,
    direction: Value,
}

impl Lowering<'_> {
    /// Declares the direction word alone.
    pub fn direction_word(&mut self) -> StateId {
        self.state(
            "direction",
            0,
            Interval::new(-1, 1),
            "Direction of the last Hall edge: 1 forward, -1 backward, 0 before the first.",
        )
    }

    /// Declares the rotor tracker's state words.
    pub fn rotor_words(&mut self) -> RotorWords {
        let age_max = i64::from(self.spec.age_max());
        let rev_min = i64::from(self.spec.rev_min());
        let rest = PeriodTicks::of(self.spec.inverter.hall_capture).turn_rest;
        let direction = self.direction_word();
        let age = Interval::new(0, age_max + 1);
        let interval = Interval::new(1, age_max);
        let age_prev = self.state(
            "age_prev",
            0,
            age,
            "Ticks since the last Hall edge, at the last sample.",
        );
        let edges = self.state(
            "edges",
            0,
            Interval::new(0, 2),
            "Edges seen in this direction: 0, 1, or 2 and more.",
        );
        let intervals = ["t1", "t2", "t3", "t4", "t5", "t6"].map(|name| {
            self.state(
                name,
                1,
                interval,
                "Ticks between two Hall edges, the latest first.",
            )
        });
        let rev = self.state(
            "rev",
            6,
            Interval::new(6, 6 * age_max + rest),
            "Ticks of the last six intervals: one electrical turn.",
        );
        let omega_max = ((1 << 32) - 1) / rev_min;
        let omega = self.state(
            "omega",
            0,
            Interval::new(0, omega_max),
            "Electrical angle per tick, 2^32 a turn; 0 while unknown.",
        );
        RotorWords {
            direction,
            age_prev,
            edges,
            intervals,
            rev,
            omega,
        }
    }

    /// Adds the comparison of two sectors to the open stage.
    fn turned(&mut self, hall: &Hall, old: Value) -> Turned {
        let next = self.b.program.column(
            "sector",
            "next_sector",
            vec![0, 2, 3, 4, 5, 6, 1],
            &["Sector that follows in forward rotation.".to_owned()],
        );
        let after = self.b.lookup(next, hall.sector_prev);
        let forward = self.b.compare(Comparison::Equal, after, hall.sector);
        let before = self.b.lookup(next, hall.sector);
        let backward = self.b.compare(Comparison::Equal, before, hall.sector_prev);
        let minus = self.b.literal(-1);
        let otherwise = self.b.select(backward, minus, old);
        let plus = self.b.literal(1);
        let direction = self.b.select(forward, plus, otherwise);
        self.b.name("direction_seen", direction);
        Turned {
            forward,
            backward,
            direction,
        }
    }

    /// Direction of rotation alone, for controllers that need no angle; and [`Self::commutation_kept`] where the word of
    /// that, with its time-out, is given.
    pub fn sense_direction(
        &mut self,
        direction: StateId,
        hall: &Hall,
        commutation: Option<(StateId, u32)>,
    ) -> (Value, Option<Value>) {
        let old = self.b.state(direction);
        let left = commutation.map(|(word, timeout)| (self.b.state(word), timeout));
        self.b.guarded_stage(
            "sense_direction",
            hall.changed,
            true,
            &[
                "What a new sector brings: the direction of rotation, 1 to the next sector, -1 to the one before (a jump and the first",
                "sample change nothing), and, where it is followed, a commutation that begins.",
            ],
        );
        let seen = self.turned(hall, old).direction;
        let mut results = vec![
            ("direction_next", seen, old),
            ("sector_prev_next", hall.sector, hall.sector_prev),
        ];
        if let Some((left, timeout)) = left {
            let zero = self.zero();
            let known = self.b.compare(Comparison::NotEqual, hall.sector_prev, zero);
            let kept = self.commutation_kept(known, left, timeout);
            results.push(("commutation_kept", kept, left));
        }
        let joined = self.b.join_all(&results);
        self.b.set_state(direction, joined[0]);
        self.b.set_state(hall.sector_prev_word, joined[1]);
        (joined[0], joined.get(2).copied())
    }

    /// Angle and speed from the edges.
    pub fn track_rotor(
        &mut self,
        words: RotorWords,
        hall: &Hall,
        hall_ticks: Option<Value>,
    ) -> Rotor {
        let spec = self.spec;
        let age_max = i64::from(spec.age_max());
        let ticks = PeriodTicks::of(spec.inverter.hall_capture);
        let age_doc = "Ticks of 60 electrical degrees at the least speed that counts as turning.";
        self.format(
            "omega",
            32,
            32,
            Rounding::Floor,
            "electrical angle, base one turn; speed per tick",
        );

        let doc = match spec.inverter.hall_capture {
            HallCapture::Sampled => "Time since the last Hall edge, in half periods.",
            HallCapture::Timer { .. } => {
                "Time since the last Hall edge, in ticks of the edge timer. One that was read before an edge or behind it, other than the code, is not believed."
            }
        };
        self.b.stage("age_edge", &[doc]);
        let age_prev = self.b.state(words.age_prev);
        let period = self.number("ticks", ticks.whole, &ticks.doc());
        let age_before = self.b.add(age_prev, period);
        self.b.name("age_before", age_before);
        let old = self.b.state(words.direction);
        let edges = self.b.state(words.edges);
        let intervals = words.intervals.map(|word| self.b.state(word));
        let rev = self.b.state(words.rev);
        let omega = self.b.state(words.omega);
        let age = match hall_ticks {
            None => {
                let one = self.b.literal(1);
                let limit = self.number("age_limit", age_max + 1, "Ages are counted no further.");
                let older = self.b.min(age_before, limit);
                self.b.select(hall.edge, one, older)
            }
            Some(counted) => {
                // Code and ticks that are read on either side of an edge contradict each other.
                let recent = self.number(
                    "ticks_recent",
                    (2.0 * ticks.exact).floor() as i64,
                    "Ticks since an edge that the last two samples can have seen.",
                );
                let stale = self.b.compare(Comparison::Less, recent, counted);
                let zero = self.zero();
                let since_edge = self.b.select(stale, zero, counted);
                let older = self.b.max(counted, age_before);
                let since = self.b.select(hall.edge, since_edge, older);
                let limit = self.number("age_limit", age_max + 1, "Ages are counted no further.");
                self.b.min(since, limit)
            }
        };
        self.b.name("age", age);

        self.b.guarded_stage(
            "measure_speed",
            hall.edge,
            true,
            &[
                "Speed from the last six edges, which averages the placement errors of all sensors.",
                "",
                "The first interval in a direction fills all six; a jump or a reversal starts over.",
            ],
        );
        let Turned {
            forward,
            backward,
            direction,
        } = self.turned(hall, old);
        self.b.name("to_next", forward);
        self.b.name("to_previous", backward);
        let step_ok = self.b.or(forward, backward);
        self.b.name("step_ok", step_ok);
        let interval = self.b.sub(age_before, age);
        let (low, high) = (self.b.literal(1), self.number("age_max", age_max, age_doc));
        let interval = self.b.clamp(interval, low, high);
        self.b.name("interval", interval);
        let same = self.b.compare(Comparison::Equal, direction, old);
        let one = self.b.literal(1);
        let begun = self.b.compare(Comparison::LessEqual, one, edges);
        let again = self.b.and(same, begun);
        let again = self.b.and(step_ok, again);
        self.b.name("again", again);
        let (two, one, zero) = (self.b.literal(2), self.b.literal(1), self.b.literal(0));
        let counted = self.b.select(again, two, one);
        let counted = self.b.select(step_ok, counted, zero);
        self.b.name("edges_counted", counted);
        let one = self.b.literal(1);
        let first = self.b.compare(Comparison::Equal, edges, one);
        let fill = self.b.and(again, first);
        self.b.name("fill", fill);
        let mut taken = vec![];
        for k in 0..6 {
            let shifted = if k == 0 { interval } else { intervals[k - 1] };
            let moved = self.b.select(again, shifted, intervals[k]);
            let value = if k == 0 {
                moved
            } else {
                self.b.select(fill, interval, moved)
            };
            taken.push(self.b.name(
                [
                    "t1_seen", "t2_seen", "t3_seen", "t4_seen", "t5_seen", "t6_seen",
                ][k],
                value,
            ));
        }
        let mut sum = taken[0];
        for &term in &taken[1..] {
            sum = self.b.add(sum, term);
        }
        if ticks.turn_rest > 0 {
            let doc = "Ticks that six intervals lack in a turn, each counted with whole ticks per control period.";
            let rest = self.number("turn_rest", ticks.turn_rest, doc);
            sum = self.b.add(sum, rest);
        }
        self.b.name("rev_seen", sum);
        let least = self.number(
            "rev_min",
            i64::from(spec.rev_min()),
            "Ticks of an electrical turn at the greatest speed.",
        );
        let turn = self.b.max(sum, least);
        let rate = self.b.turn_over(turn);
        let zero = self.zero();
        let two = self.b.literal(2);
        let known = self.b.compare(Comparison::Equal, counted, two);
        let rate = self.b.select(known, rate, zero);
        self.b.name("omega_seen", rate);
        let names = [
            "t1_next", "t2_next", "t3_next", "t4_next", "t5_next", "t6_next",
        ];
        let mut results = vec![
            ("direction_next", direction, old),
            ("edges_now", counted, edges),
            ("rev_next", sum, rev),
            ("omega_now", rate, omega),
        ];
        results.extend((0..6).map(|k| (names[k], taken[k], intervals[k])));
        let joined = self.b.join_all(&results);
        let [direction, edges, rev, omega] = [joined[0], joined[1], joined[2], joined[3]];
        self.b.set_state(words.direction, direction);
        self.b.set_state(words.age_prev, age);
        self.b.set_state(words.rev, rev);
        for (word, value) in words.intervals.iter().zip(&joined[4..]) {
            self.b.set_state(*word, *value);
        }
        self.interpolate(words, hall, [direction, edges, rev, omega, age])
    }

    fn interpolate(
        &mut self,
        words: RotorWords,
        hall: &Hall,
        [direction, edges, rev, omega, age]: [Value; 5],
    ) -> Rotor {
        let spec = self.spec;
        let age_max = i64::from(spec.age_max());
        let ticks = PeriodTicks::of(spec.inverter.hall_capture);
        self.b.stage(
            "interpolate_angle",
            &[
                "Electrical angle between Hall edges: the sector's edge plus speed times age, at most one sector.",
                "",
                "When an edge is missing (two mean intervals, or the least speed) the angle falls back to the sector's",
                "centre and the speed to zero, until two edges have come again.",
            ],
        );
        let (three, two) = (self.b.literal(3), self.b.literal(2));
        let thrice = self.b.mul(three, age, 0);
        let late = self.b.compare(Comparison::Less, rev, thrice);
        let known = self.b.compare(Comparison::Equal, edges, two);
        self.b.name("speed_known", known);
        let missing = self.b.and(known, late);
        let limit = self.number(
            "age_max",
            age_max,
            "Ticks of 60 electrical degrees at the least speed that counts as turning.",
        );
        let slow = self.b.compare(Comparison::Less, limit, age);
        let lost = self.b.or(slow, missing);
        self.b.name("lost", lost);
        let zero = self.zero();
        let edges = self.b.select(lost, zero, edges);
        self.b.name("edges_next", edges);
        self.b.set_state(words.edges, edges);
        let zero = self.zero();
        let omega = self.b.select(lost, zero, omega);
        self.b.name("omega_next", omega);
        self.b.set_state(words.omega, omega);
        let two = self.b.literal(2);
        let tracking = self.b.compare(Comparison::Equal, edges, two);
        self.b.name("tracking", tracking);
        let zero = self.zero();
        let forward = self.b.compare(Comparison::Less, zero, direction);
        self.b.name("forward", forward);
        let last = self.rounded_number("sector_last", SIXTH - 1, sixth_turn(1.0), "Last angle of a sector, seen from its first: 60 degrees less one part in 2^32 of a turn.");
        let progress = self.b.mul_limited(omega, age, last);
        self.b.name("progress", progress);
        let last = self.rounded_number("sector_last", SIXTH - 1, sixth_turn(1.0), "Last angle of a sector, seen from its first: 60 degrees less one part in 2^32 of a turn.");
        let from_end = self.b.sub(last, progress);
        let inside = self.b.select(forward, progress, from_end);
        let centre = self.rounded_number(
            "sector_centre",
            SIXTH / 2,
            sixth_turn(0.5),
            "Half a sector: 30 degrees.",
        );
        let inside = self.b.select(tracking, inside, centre);
        let starts: Vec<i32> = (0..7_i64)
            .map(|sector| {
                // ceil((60 (sector - 1) - 30) / 360 2^32) in exact integers, as a wrapped word.
                let numerator = (2 * (sector - 1) - 1) * (1_i64 << 32);
                let angle = if sector == 0 {
                    0
                } else {
                    -(-numerator).div_euclid(12)
                };
                angle as u32 as i32
            })
            .collect();
        let table = self.b.program.rounded_table(
            "sector_start",
            starts,
            (Exact::Within(1), None),
            &["Electrical angle at which sectors 1 to 6 begin, 2^32 a turn.".to_owned()],
        );
        let start = self.b.lookup(table, hall.sector);
        let theta = self.b.angle_add(start, inside);
        self.b.name("theta", theta);
        let limit = |l: &mut Self| {
            l.rounded_number(
                "turn_max",
                SIXTH / 2,
                sixth_turn(0.5),
                "Largest angle per period that is believed: 30 degrees.",
            )
        };
        let turn = if ticks.exact.fract() == 0.0 {
            let period = self.number("ticks", ticks.whole, &ticks.doc());
            let limit = limit(self);
            self.b.mul_limited(omega, period, limit)
        } else {
            let period = self.coefficient(
                "k_ticks",
                ticks.exact,
                32,
                "Ticks per control period, with their fraction.",
                &format!("clock Ts = {}", significant(ticks.exact)),
            );
            let turn = self.times(period, omega);
            let limit = limit(self);
            self.b.min(turn, limit)
        };
        self.b.name("turn", turn);
        let back = self.b.neg(turn);
        let step_angle = self.b.select(forward, turn, back);
        self.b.name("step_angle", step_angle);
        Rotor {
            direction,
            theta,
            step_angle,
            tracking,
            omega,
        }
    }

    /// The sector in force `advance` periods ahead (semantics, end of step 4).
    pub fn advanced_sector(&mut self, advance: f64, seen: Value, rotor: &Rotor) -> Value {
        self.b.stage(
            "advance_sector",
            &["The sector that the rotor will be in when the command takes effect."],
        );
        let coefficient = {
            // The shift is fixed: 16 fraction bits hold any advance from 0 to 2.
            let exact = advance * 65536.0;
            let raw = round_half_up(exact) as i64;
            self.format(
                "k_advance",
                32,
                16,
                Rounding::RoundHalfUp,
                "periods of phase advance",
            );
            self.rounded_number(
                "k_advance",
                raw,
                Exact::Number(Real::of(exact)),
                &format!("Phase advance of {advance} periods, 16 fraction bits."),
            )
        };
        let ahead = self.b.mul(coefficient, rotor.step_angle, 16);
        let theta = self.b.angle_add(rotor.theta, ahead);
        let origin = self.rounded_number(
            "sector_origin",
            SECTOR_ORIGIN,
            Exact::Within(1),
            "30 degrees: sector 1 begins at -30 degrees.",
        );
        let turned = self.b.angle_add(theta, origin);
        let index = self.b.angle_index(turned, 6);
        let one = self.b.literal(1);
        let sector = self.b.add(index, one);
        let sector = self.b.select(rotor.tracking, sector, seen);
        self.b.name("sector_eff", sector)
    }
}
