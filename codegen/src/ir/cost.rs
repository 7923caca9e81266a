//! Operation counts of functions: per stage, on the normal path and in the worst case.
//!
//! Counted on the graph, so the same for every target. The normal path leaves out rare stages; the
//! worst case runs every stage.

use super::graph::{Function, Stage};
use super::op::Op;
use std::fmt;
use std::ops::AddAssign;

/// Operations by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Additions, subtractions, negations, magnitudes and shifts.
    pub additions: u32,
    /// Multiplications, rounding and shift included.
    pub multiplications: u32,
    /// Those of them whose product is a word.
    pub narrow: u32,
    /// Comparisons, minima, maxima, selections and logic; a clamp counts two.
    pub comparisons: u32,
    /// Table look-ups.
    pub lookups: u32,
    /// Divisions.
    pub divisions: u32,
}

/// Operations of one function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathCost {
    /// Without rare stages.
    pub normal: Cost,
    /// With every stage.
    pub worst: Cost,
}

impl Cost {
    /// The operations of one stage.
    pub fn of_stage(function: &Function, stage: &Stage) -> Self {
        let mut cost = Self::default();
        for node in &function.nodes[stage.first..stage.end] {
            cost += Self::of_op(&node.op);
        }
        cost
    }

    /// Products of more than 32 bits.
    pub const fn long(&self) -> u32 {
        self.multiplications - self.narrow
    }

    /// All operations together.
    pub fn total(&self) -> u32 {
        self.additions + self.multiplications + self.comparisons + self.lookups + self.divisions
    }

    fn of_op(op: &Op) -> Self {
        let mut cost = Self::default();
        match op {
            Op::Input(_)
            | Op::Param(_)
            | Op::State(_)
            | Op::Constant(_)
            | Op::Literal(_)
            | Op::Join { .. } => {}
            Op::Add(..)
            | Op::Sub(..)
            | Op::Neg(_)
            | Op::Abs(_)
            | Op::ShiftLeft(..)
            | Op::ShiftRight(..)
            | Op::Remainder(..)
            | Op::FlagWord(_)
            | Op::AngleAdd(..)
            | Op::AngleSub(..) => cost.additions = 1,
            Op::Product(..) | Op::MulRoundNarrow { .. } => {
                cost.multiplications = 1;
                cost.narrow = 1;
            }
            Op::MulRound { .. }
            | Op::MulFloor { .. }
            | Op::MulLimited { .. }
            | Op::AngleIndex { .. }
            | Op::AngleFraction { .. } => cost.multiplications = 1,
            Op::MulAddFloor { .. } => {
                cost.additions = 1;
                cost.multiplications = 2;
            }
            Op::ShiftRound(..) => cost.additions = 2,
            Op::Min(..)
            | Op::Max(..)
            | Op::Lesser(..)
            | Op::Greater(..)
            | Op::Exceeds(..)
            | Op::Compare(..)
            | Op::And(..)
            | Op::Or(..)
            | Op::Not(_)
            | Op::Select { .. } => cost.comparisons = 1,
            Op::Clamp { .. } => cost.comparisons = 2,
            Op::Lookup { .. } => cost.lookups = 1,
            Op::Divide { .. } | Op::DivideNarrow { .. } | Op::TurnOver(_) => cost.divisions = 1,
        }
        cost
    }
}

impl AddAssign for Cost {
    fn add_assign(&mut self, other: Self) {
        self.additions += other.additions;
        self.multiplications += other.multiplications;
        self.narrow += other.narrow;
        self.comparisons += other.comparisons;
        self.lookups += other.lookups;
        self.divisions += other.divisions;
    }
}

impl PathCost {
    /// The operations of a function.
    pub fn of_function(function: &Function) -> Self {
        let mut cost = Self::default();
        for stage in &function.stages {
            let of_stage = Cost::of_stage(function, stage);
            cost.worst += of_stage;
            if stage.guard.as_ref().is_none_or(|guard| !guard.rare) {
                cost.normal += of_stage;
            }
        }
        cost
    }
}

/// `31 additions, 9 multiplications, 24 comparisons, 3 look-ups, no divisions`.
impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kinds = [
            (self.additions, "addition"),
            (self.multiplications, "multiplication"),
            (self.comparisons, "comparison"),
            (self.lookups, "look-up"),
            (self.divisions, "division"),
        ];
        for (index, (count, kind)) in kinds.into_iter().enumerate() {
            if index > 0 {
                f.write_str(", ")?;
            }
            match count {
                0 => write!(f, "no {kind}s")?,
                1 => write!(f, "1 {kind}")?,
                _ => write!(f, "{count} {kind}s")?,
            }
        }
        Ok(())
    }
}

/// Largest number of live values in the function: computed (or read from state, set-point or input)
/// and still to be used. An upper bound of the words that a compiler must keep.
pub fn live_words(function: &Function) -> usize {
    let mut last_use = vec![0; function.nodes.len()];
    for (index, node) in function.nodes.iter().enumerate() {
        for operand in node.op.operands() {
            last_use[operand.index()] = index;
        }
    }
    let results = function.outputs.iter().map(|&(_, value)| value);
    let states = function.next_state.iter().map(|&(_, value)| value);
    let params = function.next_params.iter().map(|&(_, value)| value);
    for value in results.chain(states).chain(params) {
        last_use[value.index()] = function.nodes.len();
    }
    let in_memory = |op: &Op| matches!(op, Op::Constant(_) | Op::Literal(_));
    let mut live = 0_usize;
    let mut most = 0;
    let mut ends = vec![0_usize; function.nodes.len() + 1];
    for (index, node) in function.nodes.iter().enumerate() {
        live -= ends[index];
        if !in_memory(&node.op) {
            live += 1;
            ends[last_use[index]] += 1;
        }
        most = most.max(live);
    }
    most
}

#[cfg(test)]
pub(crate) mod tests {
    use super::{Cost, PathCost, live_words};
    use crate::ir::{Interval, Output, Program, ProgramBuilder, named};

    /// A sum and a comparison, and a product in a rare stage.
    pub(crate) fn with_rare_product() -> Program {
        let b = ProgramBuilder::new("Count", &[]);
        b.stage("read", &[]);
        let word = Interval::symmetric(1000);
        let (x, y) = (b.input("x", word, ""), b.input("y", word, ""));
        named! {
            let sum = x + y;
            let large = sum.is_above(0);
        }
        b.guarded_stage("shrink", large, true, &[]);
        named! {
            let product = y.mul_round(x, 4);
        }
        let [result] = b.join([("result", product, sum)]);
        b.output(Output::Probe("result"), result);
        b.finish()
    }

    #[test]
    fn rare_stages_count_in_the_worst_case_only() {
        let function = with_rare_product().step;
        let normal = Cost {
            additions: 1,
            comparisons: 1,
            ..Cost::default()
        };
        let worst = Cost {
            multiplications: 1,
            ..normal
        };
        assert_eq!(PathCost::of_function(&function), PathCost { normal, worst });
        assert_eq!(
            worst.to_string(),
            "1 addition, 1 multiplication, 1 comparison, no look-ups, no divisions"
        );
        // x, y, sum and large, before x and y meet their last use.
        assert_eq!(live_words(&function), 4);
    }
}
