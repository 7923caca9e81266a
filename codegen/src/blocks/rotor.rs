//! Rotor angle and speed from Hall edges (semantics, step 4).

use super::Lowering;
use super::commutation::CommutationRule;
use super::hall_learning::{Edge, HallLearning, Placed, Seen};
use super::measure::{Hall, SIXTH, Sample};
use super::number::round_half_up;
use super::over_speed::OverSpeedWatch;
use super::speed_rise::{GREATEST_RISE, risen, speed_rise, tells_rise};
use crate::diagnostics::significant;
use crate::interface::Rounding;
use crate::ir::{Exact, Expr, Flag, Interval, Memory, Named, Real, named};
use crate::spec::{RotorSensing, Spec};
use std::f64::consts::TAU;

/// Angle added before the division into sectors: sector 1 begins at -30 degrees. Rounded up like
/// the sector starts, so that a sector's first and last angle lie in that sector.
const SECTOR_ORIGIN: i64 = 357_913_942;

/// Text of the stage that measures the speed.
const MEASUREMENT: &[&str] = &[
    "Speed from the last six intervals: the placement errors of the sensors average out.",
    "",
    "The first interval in a direction fills all six; a jump or a reversal restarts the measurement.",
];

/// Names of the last six intervals, the latest first.
const INTERVALS: [&str; 6] = ["t1", "t2", "t3", "t4", "t5", "t6"];

/// `share` of a sixth of a turn, exactly.
fn sixth_turn(share: f64) -> Exact {
    Exact::Number(Real::of(f64::from(32).exp2() / 6.0 * share))
}

/// The mechanical speed of one word of `omega`, rad/s.
pub(super) fn speed_word(spec: &Spec) -> f64 {
    let tick = spec.inverter.t_s / spec.inverter.rotor_sensing.ticks_per_period();
    TAU / (32_f64.exp2() * tick * f64::from(spec.motor.pole_pairs))
}

/// The greatest speed that is measured, words of `omega`.
pub(super) fn greatest_speed(spec: &Spec) -> i64 {
    match spec.angle_sensor() {
        None => ((1_i64 << 32) - 1) / i64::from(spec.rev_min()),
        Some(sensor) => i64::from(spec.greatest_turn(sensor)),
    }
}

/// Ticks of the edge timer in a control period.
#[derive(Clone, Copy, Debug)]
struct PeriodTicks {
    exact: f64,
    /// Ticks, rounded down, so that a software count never leads the timer.
    whole: i64,
    /// Ticks missing in a turn of six intervals that were counted in whole ticks per period; 0 if
    /// the ticks per period are whole.
    turn_rest: i64,
}

impl PeriodTicks {
    fn of(capture: RotorSensing) -> Self {
        let exact = capture.ticks_per_period();
        Self {
            exact,
            whole: exact.floor() as i64,
            turn_rest: (6.0 * exact.fract() + 0.5).floor() as i64,
        }
    }

    fn are_whole(self) -> bool {
        self.exact.fract() == 0.0
    }

    fn number<'b>(self, l: &Lowering<'b>) -> Expr<'b> {
        let doc = if self.are_whole() {
            "Ticks per control period.".to_owned()
        } else {
            let exact = significant(self.exact);
            format!("Whole ticks per control period, of {exact}.")
        };
        l.number("ticks", self.whole, &doc)
    }
}

/// State words of the rotor tracker.
#[derive(Clone, Copy, Debug)]
pub struct RotorWords<'b> {
    direction: Memory<'b>,
    age_prev: Memory<'b>,
    edges: Memory<'b>,
    intervals: [Memory<'b>; 6],
    rev: Memory<'b>,
    omega: Memory<'b>,
    rise: Option<Memory<'b>>,
    step_angle: Memory<'b>,
    learning: Option<HallLearning<'b>>,
    over_speed: Option<OverSpeedWatch<'b>>,
}

/// Angle and speed at this sample.
#[derive(Clone, Copy, Debug)]
pub struct Rotor<'b> {
    /// Direction of the last edge: 1 or -1; 0 before the first.
    pub direction: Expr<'b>,
    /// Electrical angle.
    pub theta: Expr<'b>,
    /// Electrical angle per control period, signed; 0 while the speed is unknown.
    pub step_angle: Expr<'b>,
    /// The speed is known and the angle interpolated.
    pub tracking: Flag<'b>,
    pub(super) speed: SpeedWord<'b>,
}

/// The speed, words of [`speed_word`].
#[derive(Clone, Copy, Debug)]
pub(super) enum SpeedWord<'b> {
    /// Electrical angle per tick, mean of the last turn; 0 while the speed is unknown.
    ByEdges(Expr<'b>),
    /// Electrical angle per control period, signed.
    ByAngles(Expr<'b>),
}

impl<'b> Rotor<'b> {
    /// The signed speed, words of [`speed_word`].
    pub(super) fn signed_speed(&self) -> Expr<'b> {
        match self.speed {
            SpeedWord::ByEdges(omega) => (self.direction * omega).named("speed"),
            SpeedWord::ByAngles(step) => step,
        }
    }
}

/// Change of the sector at an edge.
struct Turned<'b> {
    forward: Flag<'b>,
    backward: Flag<'b>,
    /// The direction; the old one if the change was neither.
    direction: Expr<'b>,
}

/// Direction and speed from the edges.
struct Edges<'b> {
    direction: Expr<'b>,
    /// Edges seen in this direction, at most 2.
    counted: Expr<'b>,
    /// Ticks of a turn.
    rev: Expr<'b>,
    omega: Expr<'b>,
    /// This sector's speed over `omega` less 1, where it is told.
    rise: Option<Expr<'b>>,
    step_angle: Expr<'b>,
    /// Ticks since the last edge.
    age: Expr<'b>,
    /// Where the sector begins and how wide it is, with `hall_learning` only.
    placed: Option<Placed<'b>>,
}

/// Declares the direction word.
pub fn direction_word<'b>(l: &Lowering<'b>) -> Memory<'b> {
    let doc = "Direction of the last Hall edge: 1 forward, -1 backward, 0 before the first.";
    l.b.memory("direction", 0, Interval::new(-1, 1), doc)
}

/// Angle per tick of a turn that takes so many ticks, at most the greatest speed's.
fn angle_per_tick<'b>(l: &Lowering<'b>, rev: Expr<'b>) -> Expr<'b> {
    let doc = "Ticks of an electrical turn at the greatest speed.";
    let least = l.number("rev_min", i64::from(l.spec.rev_min()), doc);
    rev.max(least).turn_over().named("rate")
}

/// Angle per tick and signed angle per period, 0 until a second edge was seen.
fn seen_speed<'b>(
    edges: Expr<'b>,
    is_forward: Flag<'b>,
    [rate, turn]: [Expr<'b>; 2],
) -> [Expr<'b>; 2] {
    named! {
        let known = edges.is(2);
        let omega_seen = known.choose(rate, 0);
        let step_angle_seen = known.choose(is_forward.sign(turn.named("turn")), 0);
    }
    [omega_seen, step_angle_seen]
}

/// Compares two sectors; added to the open stage.
fn turned<'b>(l: &Lowering<'b>, hall: &Hall<'b>, old: Expr<'b>) -> Turned<'b> {
    let doc = "Next sector in forward rotation.";
    let following = vec![0, 2, 3, 4, 5, 6, 1];
    let next = l.b.column("sector", "next_sector", following, doc);
    let last = hall.sector_prev.read();
    let forward = next.at(last).is(hall.sector);
    let backward = next.at(hall.sector).is(last);
    named! {
        let direction_seen = forward.choose(1, backward.choose(-1, old));
    }
    Turned {
        forward,
        backward,
        direction: direction_seen,
    }
}

/// Direction of rotation, for controllers without an angle; with a commutation rule also the
/// samples left to the commutation ([`CommutationRule::kept`]).
pub fn sense_direction<'b>(
    l: &Lowering<'b>,
    direction: Memory<'b>,
    hall: &Hall<'b>,
    commutation: Option<CommutationRule<'b>>,
) -> (Expr<'b>, Option<Expr<'b>>) {
    let (old, last) = (direction.read(), hall.sector_prev.read());
    l.b.guarded_stage(
        "sense_direction",
        hall.changed,
        true,
        &[
            "Direction of rotation at a change of the sector: 1 to the next sector, -1 to the previous one; a jump and",
            "the first sample leave it. With a commutation, its time-out.",
        ],
    );
    let seen = turned(l, hall, old).direction;
    let kept = commutation.map(|rule| (rule.kept(l, last.is_not(0)), rule.left.read()));
    let [direction_next, sector_next] = l.b.join([
        ("direction_next", seen, old),
        ("sector_prev_next", hall.sector, last),
    ]);
    let kept = kept.map(|(kept, left)| l.b.join([("commutation_kept", kept, left)])[0]);
    direction.set(direction_next);
    hall.sector_prev.set(sector_next);
    (direction_next, kept)
}

/// The last six intervals, the new one first; the first one in a direction fills all six.
fn passed_on<'b>(
    old: [Expr<'b>; 6],
    interval: Expr<'b>,
    [again, fill]: [Flag<'b>; 2],
) -> [Expr<'b>; 6] {
    std::array::from_fn(|k| {
        let seen = match k {
            0 => again.choose(interval, old[0]),
            _ => fill.choose(interval, again.choose(old[k - 1], old[k])),
        };
        seen.named(&format!("{}_seen", INTERVALS[k]))
    })
}

/// Ticks of an electrical turn: the sum of its six intervals and their missing ticks.
fn turn<'b>(l: &Lowering<'b>, [first, others @ ..]: [Expr<'b>; 6]) -> Expr<'b> {
    let sum = others
        .into_iter()
        .fold(first, |sum, interval| sum + interval);
    match PeriodTicks::of(l.spec.inverter.rotor_sensing).turn_rest {
        0 => sum,
        rest => {
            let doc =
                "Ticks missing in a turn whose six intervals count whole ticks per control period.";
            sum + l.number("turn_rest", rest, doc)
        }
    }
}

impl<'b> RotorWords<'b> {
    /// Declares the rotor tracker's state words.
    pub fn new(l: &Lowering<'b>) -> Self {
        let age_max = i64::from(l.spec.age_max());
        let rest = PeriodTicks::of(l.spec.inverter.rotor_sensing).turn_rest;
        let omega_max = greatest_speed(l.spec);
        let tells_rise = tells_rise(l.spec);
        let greatest_rise = if tells_rise { GREATEST_RISE } else { 0.0 };
        let turn_max = greatest_turn(l.spec, 1.0 + greatest_rise).ceil() as i64;
        let turn_max = turn_max.min(SIXTH / 2);
        let word = |name, initial, low, high, doc| {
            l.b.memory(name, initial, Interval::new(low, high), doc)
        };
        Self {
            direction: direction_word(l),
            age_prev: word(
                "age_prev",
                0,
                0,
                age_max + 1,
                "Ticks since the last Hall edge, at the last sample.",
            ),
            edges: word("edges", 0, 0, 2, "Edges seen in this direction, at most 2."),
            intervals: INTERVALS.map(|name| {
                let doc = "Ticks between two Hall edges, the latest first.";
                word(name, 1, 1, age_max, doc)
            }),
            rev: word(
                "rev",
                6,
                6,
                6 * age_max + rest,
                "Ticks of the last six intervals: one electrical turn.",
            ),
            omega: word(
                "omega",
                0,
                0,
                omega_max,
                "Electrical angle per tick, mean of the last turn, 2^32 a turn; 0 while unknown.",
            ),
            rise: tells_rise.then(|| {
                let most = (greatest_rise * 32_f64.exp2()).ceil() as i64;
                let doc =
                    "Rise of the speed from the mean of the last turn to this sector, 2^32 for 1.";
                word("rise", 0, -most, most, doc)
            }),
            step_angle: word(
                "step_angle",
                0,
                -turn_max,
                turn_max,
                "Electrical angle per control period, 2^32 a turn; 0 while unknown.",
            ),
            learning: HallLearning::new(l),
            over_speed: OverSpeedWatch::new(l),
        }
    }

    /// Angle and speed from the Hall edges; `across`: the word of the EMF's error across the shape, of an observer.
    pub fn track(
        &self,
        l: &Lowering<'b>,
        hall: &Hall<'b>,
        sample: &Sample<'b>,
        across: Option<Memory<'b>>,
    ) -> Rotor<'b> {
        let meaning = "electrical angle, base one turn; speed per tick";
        l.format("omega", 32, 32, Rounding::Floor, meaning);
        let ages = self.time_since_edge(l, hall, sample.hall_ticks);
        let seen = self.learning.zip(across).map(|(_, across)| Seen {
            last: last_of_sector(l, hall.sector),
            currents: sample.currents,
            across: across.read(),
            step_angle: self.step_angle.read(),
        });
        let edges = self.measure_speed(l, hall, ages, seen);
        let turning = self.keep_or_lose(l, &edges);
        let theta = interpolate(l, hall, &edges, &turning);
        Rotor {
            direction: edges.direction,
            theta,
            step_angle: turning.step_angle,
            tracking: turning.tracking,
            speed: SpeedWord::ByEdges(turning.omega),
        }
    }

    /// Time since the last edge: counted in software, and of this sample.
    fn time_since_edge(
        &self,
        l: &Lowering<'b>,
        hall: &Hall<'b>,
        hall_ticks: Option<Expr<'b>>,
    ) -> [Expr<'b>; 2] {
        let ticks = PeriodTicks::of(l.spec.inverter.rotor_sensing);
        let doc = match hall_ticks {
            None => "Time since the last Hall edge, in half periods.",
            Some(_) => {
                "Time since the last Hall edge, in ticks of the edge timer. A count that belongs to the other side of an edge than the code is rejected."
            }
        };
        l.b.stage("age_edge", &[doc]);
        named! {
            let age_before = self.age_prev.read() + ticks.number(l);
            let age = age(l, hall, age_before, hall_ticks);
        }
        [age_before, age]
    }

    /// The speed, measured at an edge; the ages come from [`Self::time_since_edge`]. `observed`: where the
    /// sensors' places are learnt.
    fn measure_speed(
        &self,
        l: &Lowering<'b>,
        hall: &Hall<'b>,
        [age_before, age]: [Expr<'b>; 2],
        observed: Option<Seen<'b>>,
    ) -> Edges<'b> {
        let old = self.direction.read();
        let (edges, rev, omega) = (self.edges.read(), self.rev.read(), self.omega.read());
        let (step_angle, rise) = (self.step_angle.read(), self.rise.map(Memory::read));
        let intervals = self.intervals.map(Memory::read);
        l.b.guarded_stage("measure_speed", hall.edge, true, MEASUREMENT);
        let turned = turned(l, hall, old);
        named! {
            let to_next = turned.forward;
            let to_previous = turned.backward;
            let step_ok = to_next | to_previous;
            let interval = (age_before - age).clamp(1, greatest_age(l, l.spec.age_max().into()));
            let again = step_ok & (turned.direction.is(old) & edges.is_at_least(1));
            let edges_counted = step_ok.choose(again.choose(2, 1), 0);
            let fill = again & edges.is(1);
        }
        let seen = passed_on(intervals, interval, [again, fill]);
        named! {
            let rev_seen = turn(l, seen);
        }
        let over = (self.over_speed).map(|watch| watch.seen(l, edges_counted.is(2), rev_seen));
        let rate = angle_per_tick(l, rev_seen);
        let rise = rise.map(|old| (speed_rise(l, seen, [rev_seen, rate]), old));
        let edge = Edge {
            forward: to_next,
            again,
            interval,
            rate,
            rev: rev_seen,
            rev_before: rev,
        };
        let learnt = self
            .learning
            .zip(observed)
            .map(|(learning, seen)| (learning.at_edge(l, hall, &edge, &seen), seen.last));
        let turn = turn_of_period(l, rate, rise.map(|(rise, _)| rise));
        let [omega_seen, step_angle_seen] = seen_speed(edges_counted, to_next, [rate, turn]);
        let [direction, counted, rev, omega, step_angle] = l.b.join([
            ("direction_next", turned.direction, old),
            ("edges_now", edges_counted, edges),
            ("rev_next", rev_seen, rev),
            ("omega_now", omega_seen, omega),
            ("step_angle_now", step_angle_seen, step_angle),
        ]);
        let placed = learnt.map(|(learnt, last)| learnt.keep(l, last));
        let rise = rise.map(|(seen, old)| l.b.join([("rise_now", seen, old)])[0]);
        let edges_now = Edges {
            direction,
            counted,
            rev,
            omega,
            rise,
            step_angle,
            age,
            placed,
        };
        self.keep(&edges_now);
        self.keep_measured(l, [seen, intervals], over);
        edges_now
    }

    /// Sets the words of direction, age, turn and rise.
    fn keep(&self, edges: &Edges<'b>) {
        if let Some((word, rise)) = self.rise.zip(edges.rise) {
            word.set(rise);
        }
        self.direction.set(edges.direction);
        self.age_prev.set(edges.age);
        self.rev.set(edges.rev);
    }

    /// Joins the intervals and the count of over-speed behind the open guarded stage, and sets their words.
    fn keep_measured(
        &self,
        l: &Lowering<'b>,
        [seen, old]: [[Expr<'b>; 6]; 2],
        over: Option<Expr<'b>>,
    ) {
        for (k, word) in self.intervals.into_iter().enumerate() {
            let name = format!("{}_next", INTERVALS[k]);
            let [next] = l.b.join([(&*name, seen[k], old[k])]);
            word.set(next);
        }
        if let Some((watch, seen)) = self.over_speed.zip(over) {
            watch.keep(l, seen);
        }
    }

    /// The speed unless an edge is missing.
    fn keep_or_lose(&self, l: &Lowering<'b>, seen: &Edges<'b>) -> Turning<'b> {
        l.b.stage(
            "lose_speed",
            &[
                "A missing edge (after two mean intervals, or at the least speed) sets the angle to the sector's centre and",
                "the speed to zero until two edges have been seen again.",
            ],
        );
        let age_max = i64::from(l.spec.age_max());
        let late = (3 * seen.age).is_above(seen.rev);
        named! {
            let speed_known = seen.counted.is(2);
            let lost = seen.age.is_above(greatest_age(l, age_max)) | (speed_known & late);
            let edges_next = lost.choose(0, seen.counted);
            let omega_next = lost.choose(0, seen.omega);
            let step_angle_next = lost.choose(0, seen.step_angle);
            let tracking = edges_next.is(2);
        }
        self.edges.set(edges_next);
        self.omega.set(omega_next);
        self.step_angle.set(step_angle_next);
        Turning {
            omega: omega_next,
            step_angle: step_angle_next,
            tracking,
        }
    }
}

/// The speed of this period.
struct Turning<'b> {
    omega: Expr<'b>,
    step_angle: Expr<'b>,
    tracking: Flag<'b>,
}

/// The angle between edges.
fn interpolate<'b>(
    l: &Lowering<'b>,
    hall: &Hall<'b>,
    seen: &Edges<'b>,
    turning: &Turning<'b>,
) -> Expr<'b> {
    l.b.stage(
        "interpolate_angle",
        &[
            "Electrical angle between Hall edges: the sector's edge plus speed times age, at most one sector.",
            "With an edge timer the speed is that of this sector at the last turn's acceleration.",
        ],
    );
    named! {
        let forward = seen.direction.is_above(0);
        let last = seen.placed.map_or_else(|| last_of_sector(l, hall.sector), |placed| placed.last);
    }
    let width = seen.placed.map_or(last, |placed| placed.width);
    let progress = turning.omega.mul_limited(seen.age, width);
    let progress = match seen.rise {
        Some(rise) => risen(progress.named("mean_progress"), rise).min(width),
        None => progress,
    };
    let progress = progress.named("progress");
    let inside = forward.choose(progress, width - progress);
    let inside = seen
        .placed
        .map_or(inside, |placed| placed.begin.angle_add(inside));
    let inside = turning.tracking.choose(inside, centre_of_sector(l, last));
    let doc = "Electrical angle at which sectors 1 to 6 begin, 2^32 a turn.".to_owned();
    let exact = (Exact::Within(1), None);
    let starts = sector_starts(l.spec.motor.hall_angles);
    let starts = l.b.rounded_table("sector_start", starts, exact, &[doc]);
    named! {
        let theta = starts.at(hall.sector).angle_add(inside);
    }
    theta
}

/// Ticks since the last edge: counted, or measured by a timer.
fn age<'b>(
    l: &Lowering<'b>,
    hall: &Hall<'b>,
    age_before: Expr<'b>,
    hall_ticks: Option<Expr<'b>>,
) -> Expr<'b> {
    let age_max = i64::from(l.spec.age_max());
    let limit = || {
        l.number(
            "age_limit",
            age_max + 1,
            "Limit of the time since the last edge.",
        )
    };
    let Some(counted) = hall_ticks else {
        return hall.edge.choose(1, age_before.min(limit()));
    };
    // Code and ticks contradict each other if an edge came between their readings.
    let ticks = PeriodTicks::of(l.spec.inverter.rotor_sensing);
    let doc = "Ticks of two control periods: a new edge is no older.";
    let recent = l.number("ticks_recent", (2.0 * ticks.exact).floor() as i64, doc);
    let since_edge = counted.is_above(recent).choose(0, counted);
    let since = hall.edge.choose(since_edge, counted.max(age_before));
    since.min(limit())
}

fn greatest_age<'b>(l: &Lowering<'b>, age_max: i64) -> Expr<'b> {
    let doc = "Ticks of 60 electrical degrees at the least measurable speed.";
    l.number("age_max", age_max, doc)
}

/// The last angle of a sector, from its first.
fn last_of_sector<'b>(l: &Lowering<'b>, sector: Expr<'b>) -> Expr<'b> {
    if l.spec.motor.has_even_halls() {
        let doc = "Last angle of a sector, from its first: 60 degrees less 2^-32 of a turn.";
        return l.rounded_number("sector_last", SIXTH - 1, sixth_turn(1.0), doc);
    }
    let starts = sector_starts(l.spec.motor.hall_angles);
    let width = |sector: usize| starts[sector % 6 + 1].wrapping_sub(starts[sector]);
    let last = std::iter::once(0).chain((1..7).map(|sector| width(sector) - 1));
    let doc = "Last angle of sectors 1 to 6, from their first.".to_owned();
    let exact = (Exact::Within(2), None);
    let table =
        l.b.rounded_table("sector_last", last.collect(), exact, &[doc]);
    table.at(sector).named("last_inside")
}

/// Half a sector.
fn centre_of_sector<'b>(l: &Lowering<'b>, last: Expr<'b>) -> Expr<'b> {
    if l.spec.motor.has_even_halls() {
        let doc = "Half a sector: 30 degrees.";
        return l.rounded_number("sector_centre", SIXTH / 2, sixth_turn(0.5), doc);
    }
    last >> 1
}

/// Angles of Hall edges, degrees, as wrapped words, rounded up; 0 for sector 0.
fn sector_starts(degrees: [f64; 6]) -> Vec<i32> {
    let start = |degrees: f64| {
        // Exact for whole degrees; the tolerance of other decimals is far below a word.
        let words = degrees / 360.0 * 32_f64.exp2();
        (words - 1e-4).ceil() as i64 as u32 as i32
    };
    std::iter::once(0).chain(degrees.map(start)).collect()
}

/// The rotor's angle per control period at this speed; `rise` as in [`Edges`].
fn turn_of_period<'b>(l: &Lowering<'b>, omega: Expr<'b>, rise: Option<Expr<'b>>) -> Expr<'b> {
    let ticks = PeriodTicks::of(l.spec.inverter.rotor_sensing);
    let turn = if ticks.are_whole() {
        ticks.number(l) * omega
    } else {
        let k_ticks = l.coefficient(
            "k_ticks",
            ticks.exact,
            32,
            "Ticks per control period, fraction included.",
            &format!("clock Ts = {}", significant(ticks.exact)),
        );
        k_ticks * omega
    };
    let turn = limited_turn(l, turn, 1.0);
    let Some(rise) = rise else {
        return turn;
    };
    limited_turn(l, risen(turn.named("mean_turn"), rise), 1.0 + GREATEST_RISE)
}

/// Angle per control period at the greatest mean speed times a factor.
fn greatest_turn(spec: &Spec, factor: f64) -> f64 {
    let omega_max = (32_f64.exp2() - 1.0) / f64::from(spec.rev_min());
    omega_max * spec.inverter.rotor_sensing.ticks_per_period() * factor
}

/// The angle, at most 30 degrees; `factor` is that of [`greatest_turn`], which may be less.
fn limited_turn<'b>(l: &Lowering<'b>, turn: Expr<'b>, factor: f64) -> Expr<'b> {
    if greatest_turn(l.spec, factor) < (SIXTH / 2) as f64 {
        return turn;
    }
    let doc = "Largest plausible angle per period: 30 degrees.";
    turn.min(l.rounded_number("turn_max", SIXTH / 2, sixth_turn(0.5), doc))
}

/// The sector in force `advance` periods ahead (semantics, end of step 4).
pub fn advanced_sector<'b>(
    l: &Lowering<'b>,
    advance: f64,
    seen: Expr<'b>,
    rotor: &Rotor<'b>,
) -> Expr<'b> {
    let doc = "Advanced sector: the rotor's sector when the command takes effect.";
    l.b.stage("advance_sector", &[doc]);
    // 16 fraction bits hold any advance from 0 to 2.
    let exact = advance * 65536.0;
    let meaning = "periods of phase advance";
    l.format("k_advance", 32, 16, Rounding::RoundHalfUp, meaning);
    let k_advance = l.rounded_number(
        "k_advance",
        round_half_up(exact) as i64,
        Exact::Number(Real::of(exact)),
        &format!("Phase advance of {advance} periods, 16 fraction bits."),
    );
    let theta = rotor
        .theta
        .angle_add(rotor.step_angle.mul_round(k_advance, 16));
    let doc = "30 degrees: sector 1 begins at -30 degrees.";
    let origin = l.rounded_number("sector_origin", SECTOR_ORIGIN, Exact::Within(1), doc);
    let ahead = theta.angle_add(origin).angle_index(6) + 1;
    named! {
        let sector_eff = rotor.tracking.choose(ahead, seen);
    }
    sector_eff
}
