//! Commutation: when it begins and ends (semantics, step 5).

use super::Lowering;
use crate::design::vectors::{OFF_PHASE, OUTGOING_SIGN};
use crate::ir::{Expr, Flag, Interval, Lut, Memory, Phases, named};

/// Rule by which commutations begin and end, with its state words.
#[derive(Clone, Copy, Debug)]
pub struct CommutationRule<'b> {
    /// Advanced sector of the last sample; with phase advance only.
    pub sector_prev: Option<Memory<'b>>,
    /// Samples left to the commutation after the last one.
    pub left: Memory<'b>,
    /// Outgoing current at which a commutation ends, ampere.
    threshold: f64,
    /// Commutation time-out without its first sample, samples.
    timeout: u32,
}

/// Commutation state at this sample.
#[derive(Clone, Copy, Debug)]
pub struct Commutation<'b> {
    /// Whether a commutation is in progress.
    pub flag: Flag<'b>,
    /// The flag as a word: 1 or 0.
    pub word: Expr<'b>,
    /// Samples left to the commutation after this one.
    pub left: Expr<'b>,
    /// Direction of rotation, 1 or -1; 0 before the first edge.
    pub direction: Expr<'b>,
    /// Outgoing phase of the sector: 0 a, 1 b, 2 c.
    pub outgoing: Expr<'b>,
}

impl<'b> CommutationRule<'b> {
    /// Declares the state words; `advances`: with phase advance.
    pub fn new(l: &Lowering<'b>, threshold: f64, timeout: u32, advances: bool) -> Self {
        let sector_prev = advances.then(|| {
            let doc = "Sector in force at the last sample; 0 before the first.";
            l.b.memory("sector_eff_prev", 0, Interval::new(0, 6), doc)
        });
        let range = Interval::new(0, i64::from(timeout));
        let doc = "Samples left to the commutation after the last one; 0 while the outgoing phase carries no current.";
        Self {
            sector_prev,
            left: l.b.memory("commutation_left", 0, range, doc),
            threshold,
            timeout,
        }
    }

    /// Commutation time-out with its first sample, samples.
    fn whole(&self, l: &Lowering<'b>) -> Expr<'b> {
        let samples = i64::from(self.timeout) + 1;
        let doc = "Commutation time-out with its first sample, samples.";
        l.number("commutation_begun", samples, doc)
    }

    /// Samples left to the commutation, this one included; the time-out if one `began`.
    pub fn kept(&self, l: &Lowering<'b>, began: Flag<'b>) -> Expr<'b> {
        named! {
            let commutation_restarted = began.choose(self.whole(l), self.left.read());
        }
        commutation_restarted
    }

    /// Whether the advanced sector changed since the last sample.
    pub fn sector_changed(&self, l: &Lowering<'b>, last: Memory<'b>, sector: Expr<'b>) -> Flag<'b> {
        let doc = "Change of the sector in force since the last sample.";
        l.b.stage("compare_sectors", &[doc]);
        named! {
            let changed = sector.is_not(last.read()) & last.read().is_not(0);
        }
        changed
    }

    /// The commutation state; `kept` comes from [`Self::kept`].
    pub fn follow(
        &self,
        l: &Lowering<'b>,
        [sector, kept, direction, set_point]: [Expr<'b>; 4],
        currents: Phases<'b, 3>,
    ) -> Commutation<'b> {
        let phases = off_phases(l);
        let shares = outgoing_shares(l);
        l.b.stage(
            "detect_commutation",
            &["Start of a commutation, with its time-out."],
        );
        named! {
            let outgoing_phase = phases.at(sector);
            let commutation_lasts = kept.is_not(0);
        }
        let (none_left, none) = (self.left.read(), l.b.number(0));
        l.b.guarded_stage(
            "follow_commutation",
            commutation_lasts,
            false,
            &[
                "A commutation begins at the first sample in a new sector and ends at a later one, when the outgoing",
                "current has fallen to the threshold or the time-out has passed.",
            ],
        );
        let [of_a, of_b] = [0, 1].map(|x| shares[x].at(sector) * currents.0[x]);
        named! {
            let outgoing_turned = direction * (of_a + of_b);
        }
        let doc = "Outgoing current at which a commutation ends";
        let limit = l.current("i_comm", l.ampere_word(self.threshold), doc);
        let outgoing = set_point
            .is_below(0)
            .choose(-outgoing_turned, outgoing_turned);
        let flows = outgoing.is_above(limit);
        let begins = kept.is(self.whole(l));
        named! {
            let commutation_goes_on = begins | flows;
            // The guard excludes 0, which the intervals do not show.
            let left_while_flowing = commutation_goes_on.choose((kept - 1).max(0), 0);
            let commutating_now = commutation_goes_on.choose(1, 0);
        }
        let [left, word] = l.b.join([
            ("commutation_left_now", left_while_flowing, none_left),
            ("commutating", commutating_now, none),
        ]);
        l.b.stage(
            "find_commutation",
            &["Commutation state after this sample."],
        );
        named! {
            let in_commutation = word.is_not(0);
        }
        Commutation {
            flag: in_commutation,
            word,
            left,
            direction,
            outgoing: outgoing_phase,
        }
    }
}

fn off_phases<'b>(l: &Lowering<'b>) -> Lut<'b> {
    let doc = "Off phase of sectors 1 to 6: 0 a, 1 b, 2 c.";
    let phases = std::iter::once(0).chain(OFF_PHASE).collect();
    l.b.column("sector", "off_phase", phases, doc)
}

/// Weights of the phase currents a and b in the outgoing current; i_c = -(i_a + i_b).
fn outgoing_shares<'b>(l: &Lowering<'b>) -> [Lut<'b>; 2] {
    [0, 1].map(|x: i32| {
        let letter = ["a", "b"][x as usize];
        let share = |(&phase, sign): (&i32, i32)| match phase {
            2 => -sign,
            phase if phase == x => sign,
            _ => 0,
        };
        let column = OFF_PHASE.iter().zip(OUTGOING_SIGN).map(share);
        let doc = format!(
            "Weight of the phase-{letter} current in the outgoing current on entry of sectors 1 to 6, positive torque, forward."
        );
        let column = std::iter::once(0).chain(column).collect();
        l.b.column("sector", &format!("outgoing_{letter}"), column, &doc)
    })
}
