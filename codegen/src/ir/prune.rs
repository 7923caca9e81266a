//! Removal of dead values, joins, stages, constants and tables.
//!
//! Building blocks compute the values of all variants; those that a variant does not use are
//! removed here. State words, set-point words and inputs stay: they are the interface.

use super::graph::{Function, Program};
use super::op::{ConstantId, Op, TableId, Value};

impl Program {
    /// The program without dead values, constants and tables.
    #[must_use]
    pub fn pruned(mut self) -> Self {
        self.step.prune();
        for (_, setter) in &mut self.setters {
            setter.prune();
        }
        let mut constants = vec![false; self.constants.len()];
        let mut tables = vec![false; self.tables.len()];
        for node in self.functions().flat_map(|function| &function.nodes) {
            match node.op {
                Op::Constant(id) => constants[id.index()] = true,
                Op::Lookup { table, .. } => tables[table.index()] = true,
                _ => {}
            }
        }
        let new_constants = renumbered(&constants);
        let new_tables = renumbered(&tables);
        let setters = self.setters.iter_mut().map(|(_, setter)| setter);
        for function in std::iter::once(&mut self.step).chain(setters) {
            for node in &mut function.nodes {
                match &mut node.op {
                    Op::Constant(id) => *id = ConstantId(new_constants[id.index()]),
                    Op::Lookup { table, .. } => *table = TableId(new_tables[table.index()]),
                    _ => {}
                }
            }
        }
        let mut keep = constants.iter();
        self.constants.retain(|_| *keep.next().unwrap_or(&true));
        let mut keep = tables.iter();
        self.tables.retain(|_| *keep.next().unwrap_or(&true));
        self
    }
}

/// New position of every kept element.
fn renumbered(kept: &[bool]) -> Vec<u32> {
    let mut next = 0;
    kept.iter()
        .map(|&keep| {
            let position = next;
            next += u32::from(keep);
            position
        })
        .collect()
}

impl Function {
    pub(super) fn prune(&mut self) {
        let live = self.live();
        let position = renumbered(&live);
        let moved = |value: Value| Value(position[value.index()]);
        let count = live.iter().filter(|&&live| live).count();
        let before = |index: usize| position.get(index).map_or(count, |&p| p as usize);
        for stage in &mut self.stages {
            stage.first = before(stage.first);
            stage.end = before(stage.end);
            if let Some(guard) = &mut stage.guard {
                guard.joins.retain(|join| live[join.index()]);
            }
        }
        self.quantities
            .retain(|quantity| live[quantity.value.index()]);
        self.stages.retain(|stage| match &stage.guard {
            None => stage.first < stage.end,
            Some(guard) => !guard.joins.is_empty(),
        });
        let mut keep = live.iter();
        self.nodes.retain(|_| *keep.next().unwrap_or(&true));
        for node in &mut self.nodes {
            node.op.map_operands(moved);
        }
        self.map_values(moved);
        self.tracking = before(self.tracking);
    }

    /// The nodes that some result needs; a join needs its stage's guard.
    fn live(&self) -> Vec<bool> {
        let mut live = vec![false; self.nodes.len()];
        let mut conditions = vec![None; self.nodes.len()];
        for guard in self.stages.iter().filter_map(|stage| stage.guard.as_ref()) {
            for join in &guard.joins {
                conditions[join.index()] = Some(guard.condition);
            }
        }
        let results = self.outputs.iter().map(|&(_, value)| value);
        let results = results.chain(self.told.iter().map(|&(_, value)| value));
        let words = self
            .next_state
            .iter()
            .map(|&(_, value)| value)
            .chain(self.next_params.iter().map(|&(_, value)| value));
        let mut wanted: Vec<Value> = results.chain(words).collect();
        while let Some(value) = wanted.pop() {
            if std::mem::replace(&mut live[value.index()], true) {
                continue;
            }
            wanted.extend(self.node(value).op.operands());
            wanted.extend(conditions[value.index()]);
        }
        live
    }
}
