//! How many operations a function takes: per stage, on the normal path and at worst.
//!
//! Counted over the graph, so the same for every target. The normal path leaves out the stages that
//! are marked rare; the worst path runs every stage.

use super::graph::{Function, Op, Stage};
use std::fmt;
use std::ops::AddAssign;

/// Operations by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Additions, subtractions, negations, magnitudes and shifts.
    pub additions: u32,
    /// Multiplications, rounding and shift included.
    pub multiplications: u32,
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
    /// Without the stages that are marked rare.
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
            | Op::AngleAdd(..)
            | Op::AngleSub(..) => cost.additions = 1,
            Op::Product(..)
            | Op::MulRound { .. }
            | Op::MulFloor { .. }
            | Op::MulLimited { .. }
            | Op::AngleIndex { .. }
            | Op::AngleFraction { .. } => cost.multiplications = 1,
            Op::Min(..)
            | Op::Max(..)
            | Op::Compare(..)
            | Op::And(..)
            | Op::Or(..)
            | Op::Not(_)
            | Op::Select { .. } => cost.comparisons = 1,
            Op::Clamp { .. } => cost.comparisons = 2,
            Op::Lookup { .. } => cost.lookups = 1,
            Op::Divide { .. } | Op::TurnOver(_) => cost.divisions = 1,
        }
        cost
    }
}

impl AddAssign for Cost {
    fn add_assign(&mut self, other: Self) {
        self.additions += other.additions;
        self.multiplications += other.multiplications;
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
