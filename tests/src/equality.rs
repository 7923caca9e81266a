//! Inputs at which a program's comparisons meet equality: a wrong comparison, limit or order of
//! ties appears only there, and no stream of inputs gets there by chance.
//!
//! The program lists its comparisons; their operands' values come from the model.

use crate::set::Set;
use hexagen::{Limits, Sample, Sensors, Supervisor};
use hexagen_codegen::ir::{Machine, Op, Output, Program, Setter, Value};
use hexagen_lab::Inputs;

/// Operand pairs with at most this many values meet often enough by chance.
const FEW: i64 = 1 << 10;

/// Results of the probe per comparison: both operands, and whether it is evaluated.
const RESULTS: usize = 3;

/// The comparisons of a step.
#[derive(Clone, Debug)]
pub struct Comparisons {
    /// The program with the operands of its comparisons as the results of its step.
    probe: Program,
    /// Comparisons whose stage has no guard.
    unguarded: Vec<bool>,
}

impl Comparisons {
    /// Those of a program that have many values on either side.
    pub fn of(program: &Program) -> Self {
        let mut probe = program.clone();
        let step = &program.step;
        let guard_of = |index: usize| {
            let mut stages = step.stages.iter();
            let stage = stages.find(|stage| (stage.first..stage.end).contains(&index));
            stage.and_then(|stage| stage.guard.as_ref().map(|guard| guard.condition))
        };
        let width = |value: Value| {
            let interval = step.node(value).interval;
            interval.high - interval.low
        };
        let mut results = vec![];
        let mut unguarded = vec![];
        for (index, node) in step.nodes.iter().enumerate() {
            if let Op::Compare(_, a, b) = node.op
                && width(a).max(width(b)) >= FEW
            {
                let guard = guard_of(index);
                results.extend([a, b, guard.unwrap_or(a)]);
                unguarded.push(guard.is_none());
            }
        }
        let named = results.into_iter().map(|value| (Output::Probe(""), value));
        probe.step.outputs = named.collect();
        Self { probe, unguarded }
    }

    /// Their number.
    pub fn len(&self) -> usize {
        self.unguarded.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.unguarded.is_empty()
    }

    /// The program in a sample's period, with the bus voltage as set, after a supervisor.
    ///
    /// # Panics
    ///
    /// If the program is not that of a drive.
    pub fn probe(&self, supervised: (Limits, Sensors), sample: Sample, set: Set) -> Probe<'_> {
        let mut machine = Machine::of_program(&self.probe);
        if let Some(counts) = set.bus {
            // A value that leaves its interval shows in the comparison with the model.
            let _ = machine.set(Setter::Bus, &[counts.into()]);
        }
        if let Some(bits) = set.speed {
            let _ = machine.set(Setter::Speed, &[bits]);
        }
        Probe {
            setter: if set.is_torque {
                Setter::Torque
            } else {
                Setter::Current
            },
            inputs: Inputs::of(&self.probe).expect("the program of a drive"),
            supervised,
            sample,
            unguarded: &self.unguarded,
            machine,
        }
    }
}

/// A program with its comparisons.
#[derive(Debug)]
pub struct Probe<'p> {
    machine: Machine<'p>,
    setter: Setter,
    inputs: Inputs,
    supervised: (Limits, Sensors),
    sample: Sample,
    unguarded: &'p [bool],
}

impl Probe<'_> {
    /// Difference between the first and second operand of a comparison, with a set-point and in a
    /// state, whose words follow it; `None` if the comparison is not evaluated, or the period is
    /// not controlled.
    pub fn difference(&mut self, comparison: usize, words: &[i32]) -> Option<i64> {
        let (bits, words) = words.split_first()?;
        self.machine.set(self.setter, &[*bits]).ok()?;
        let (supervisor_words, law) = words.split_first_chunk()?;
        let (limits, sensors) = &self.supervised;
        let mut supervisor = Supervisor::new(limits, sensors);
        supervisor.set_words(*supervisor_words);
        let checked = supervisor.check(limits, sensors, &self.sample, || *bits != 0)?;
        self.machine.state.copy_from_slice(law);
        let results = self.machine.step(&self.inputs.words(&checked)).ok()?;
        let [a, b, guard] = results[RESULTS * comparison..][..RESULTS] else {
            return None;
        };
        (self.unguarded[comparison] || guard == 1).then(|| i64::from(a) - i64::from(b))
    }
}

/// The value of a word nearest to `from`, by powers of eight, at which the difference changes sign:
/// of the two neighbours the one with the smaller difference. `None` without a change.
pub fn seek_zero(
    from: i32,
    (least, most): (i32, i32),
    mut difference: impl FnMut(i32) -> Option<i64>,
) -> Option<i32> {
    let start = difference(from)?;
    let is_past = |value: i64| value == 0 || (value < 0) != (start < 0);
    let steps = (0..=30)
        .step_by(3)
        .flat_map(|bits| [1 << bits, -(1 << bits)]);
    let far = steps
        .map(|step: i32| from.saturating_add(step).clamp(least, most))
        .find(|&word| difference(word).is_some_and(is_past))?;
    let (mut near, mut far) = (i64::from(from), i64::from(far));
    let mut at_near = start;
    while (far - near).abs() > 1 {
        let middle = near.midpoint(far);
        let value = difference(middle as i32)?;
        if is_past(value) {
            far = middle;
        } else {
            (near, at_near) = (middle, value);
        }
    }
    let at_far = difference(far as i32)?;
    let nearer = if at_far.abs() <= at_near.abs() {
        far
    } else {
        near
    };
    Some(nearer as i32)
}

#[cfg(test)]
mod tests {
    use super::seek_zero;

    #[test]
    fn a_change_of_sign_is_found_on_its_nearer_side() {
        let range = (-1_000_000, 1_000_000);
        let line = |word: i32| Some(3 * i64::from(word) - 36_000);
        assert_eq!(seek_zero(500, range, line), Some(12_000));
        let between = |word: i32| Some(3 * i64::from(word) - 35_999);
        assert_eq!(seek_zero(-7, range, between), Some(12_000));
        assert_eq!(seek_zero(500, (0, 11_000), line), None);
    }
}
