//! Over-speed watch: counts the Hall edges in a row at which the last turn was too short, or the periods in a
//! row whose angle per period is too large (shared semantics page, "Over-speed").

use super::Lowering;
use crate::diagnostics::rpm;
use crate::ir::{Expr, Flag, Interval, Memory, named};

/// The state word.
pub const OVER_SPEED_COUNT: &str = "over_speed_count";

/// Edges or periods in a row that trip. Of edges: a turn is the mean of six intervals, so the first and the last of seven
/// share none: a single wrong interval, also one that stands for all six, is not in all.
pub const OVER_SPEED_EDGES: i32 = 7;

/// Count of the edges, and the turn below which they count.
#[derive(Clone, Copy, Debug)]
pub struct OverSpeedWatch<'b> {
    count: Memory<'b>,
    /// Ticks of a turn at the over-speed; without effect with an angle sensor.
    turn: u32,
    /// The over-speed, mechanical rad/s.
    speed: f64,
}

impl<'b> OverSpeedWatch<'b> {
    /// Declares the count; `None` without an `over_speed`.
    pub fn new(l: &Lowering<'b>) -> Option<Self> {
        let (speed, turn) = (l.spec.inverter.over_speed?, l.spec.over_speed_turn()?);
        let doc = match l.spec.angle_sensor() {
            None => {
                "Hall edges in a row at which the last turn was shorter than at the over-speed."
            }
            Some(_) => "Periods in a row in which the rotor turned faster than at the over-speed.",
        };
        let range = Interval::new(0, i64::from(OVER_SPEED_EDGES));
        Some(Self {
            count: l.b.memory(OVER_SPEED_COUNT, 0, range, doc),
            turn,
            speed,
        })
    }

    /// The count at an edge, in the open stage of edges; `measured`: the ticks of the turn are known.
    pub fn seen(&self, l: &Lowering<'b>, measured: Flag<'b>, rev: Expr<'b>) -> Expr<'b> {
        let doc = format!(
            "Ticks of an electrical turn at the over-speed, {}.",
            rpm(self.speed)
        );
        let turn = l.number("over_speed_turn", i64::from(self.turn), &doc);
        let more = self.more();
        named! {
            let over_speed_count_seen = (measured & rev.is_below(turn)).choose(more, 0);
        }
        over_speed_count_seen
    }

    fn more(&self) -> Expr<'b> {
        (self.count.read() + 1).min(OVER_SPEED_EDGES)
    }

    /// Counts a period, in the open stage.
    pub fn count(&self, is_over: Flag<'b>) {
        named! {
            let over_speed_count_seen = is_over.choose(self.more(), 0);
        }
        self.count.set(over_speed_count_seen);
    }

    /// Joins the count of the open guarded stage and sets its state word.
    pub fn keep(&self, l: &Lowering<'b>, seen: Expr<'b>) {
        let [next] =
            l.b.join([("over_speed_count_next", seen, self.count.read())]);
        self.count.set(next);
    }
}
