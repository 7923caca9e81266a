//! The text form of a program, one value per line.

use std::fmt::{self, Write as _};

use super::graph::{AtRest, Function, Program, Table};
use super::op::{Comparison, Kind, Op, Value};

impl fmt::Display for Program {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "program {}", self.name)?;
        for constant in &self.constants {
            writeln!(f, "const {} = {}", constant.name, constant.raw)?;
        }
        for table in &self.tables {
            writeln!(
                f,
                "table {}[{}] = {:?}",
                table.name,
                table.values.len(),
                table.values
            )?;
        }
        for (_, word) in &self.params {
            writeln!(
                f,
                "param {}: i32 in {} = {}",
                word.name, word.interval, word.initial
            )?;
        }
        for word in &self.states {
            writeln!(
                f,
                "state {}: {} bits in {} = {}",
                word.name, word.storage_bits, word.interval, word.initial
            )?;
        }
        for function in self.functions() {
            writeln!(f)?;
            self.write_function(f, function)?;
        }
        Ok(())
    }
}

impl Program {
    fn write_function(&self, f: &mut fmt::Formatter<'_>, function: &Function) -> fmt::Result {
        let inputs: Vec<String> = function
            .inputs
            .iter()
            .map(|input| format!("{} in {}", input.name, input.interval))
            .collect();
        writeln!(f, "fn {}({})", function.name, inputs.join(", "))?;
        for stage in &function.stages {
            if stage.first == function.tracking && function.tracking > 0 {
                writeln!(f, "  controlled:")?;
            }
            match &stage.guard {
                None => writeln!(f, "  {}:", stage.name)?,
                Some(guard) => {
                    let rare = if guard.rare { "rarely " } else { "" };
                    writeln!(
                        f,
                        "  {} ({rare}if {}):",
                        stage.name,
                        name(function, guard.condition)
                    )?;
                }
            }
            for index in stage.first..stage.end {
                self.write_node(f, function, Value(index as u32))?;
            }
            for &join in stage.guard.iter().flat_map(|guard| &guard.joins) {
                self.write_node(f, function, join)?;
            }
        }
        for (output, value) in &function.outputs {
            writeln!(f, "  output {output} = {}", name(function, *value))?;
        }
        for (state, value) in &function.next_state {
            let rests = match function.at_rest(*value) {
                AtRest::Tracked(_) => "",
                AtRest::Forgotten => ", at rest 0",
            };
            writeln!(
                f,
                "  state {} = {}{rests}",
                self.states[state.index()].name,
                name(function, *value)
            )?;
        }
        for (param, value) in &function.next_params {
            writeln!(
                f,
                "  param {} = {}",
                self.params[param.index()].1.name,
                name(function, *value)
            )?;
        }
        Ok(())
    }

    fn write_node(
        &self,
        f: &mut fmt::Formatter<'_>,
        function: &Function,
        value: Value,
    ) -> fmt::Result {
        let node = function.node(value);
        if matches!(node.op, Op::Constant(_) | Op::Literal(_)) && node.name.is_empty() {
            return Ok(());
        }
        let range = match node.kind {
            Kind::Flag => "flag".to_owned(),
            Kind::Word => node.interval.to_string(),
        };
        writeln!(
            f,
            "    {} = {}  ; {range}",
            name(function, value),
            self.expression(function, node.op)
        )
    }

    fn expression(&self, function: &Function, op: Op) -> String {
        let of = |value: Value| match function.node(value).op {
            Op::Constant(id) => self.constants[id.index()].name.clone(),
            Op::Literal(number) => number.to_string(),
            _ => name(function, value),
        };
        match op {
            Op::Input(n) => format!("input {}", function.inputs[n as usize].name),
            Op::Param(id) => format!("param {}", self.params[id.index()].1.name),
            Op::State(id) => format!("state {}", self.states[id.index()].name),
            Op::Constant(id) => self.constants[id.index()].name.clone(),
            Op::Literal(number) => number.to_string(),
            Op::Add(a, b) => format!("{} + {}", of(a), of(b)),
            Op::Sub(a, b) => format!("{} - {}", of(a), of(b)),
            Op::Neg(a) => format!("-{}", of(a)),
            Op::Abs(a) => format!("abs {}", of(a)),
            Op::Product(a, b) => format!("{} * {}", of(a), of(b)),
            Op::MulRound {
                coefficient,
                signal,
                shift,
            }
            | Op::MulRoundNarrow {
                coefficient,
                signal,
                shift,
            } => {
                format!("round({} * {} >> {shift})", of(coefficient), of(signal))
            }
            Op::MulFloor { a, b, shift } => format!("floor({} * {} >> {shift})", of(a), of(b)),
            Op::MulAddFloor {
                first: [a, b],
                second: [c, d],
                shift,
            } => {
                let [a, b, c, d] = [a, b, c, d].map(of);
                format!("floor({a} * {b} + {c} * {d} >> {shift})")
            }
            Op::MulLimited { a, b, limit } => format!("min({} * {}, {})", of(a), of(b), of(limit)),
            Op::ShiftLeft(a, n) => format!("{} << {n}", of(a)),
            Op::ShiftRight(a, n) => format!("{} >> {n}", of(a)),
            Op::ShiftRound(a, n) => format!("round({} >> {n})", of(a)),
            Op::Remainder(a, n) => format!("remainder({}, {n})", of(a)),
            Op::Min(a, b) | Op::Lesser(a, b) => format!("min({}, {})", of(a), of(b)),
            Op::Max(a, b) | Op::Greater(a, b) => format!("max({}, {})", of(a), of(b)),
            Op::Clamp { x, low, high } => format!("clamp({}, {}, {})", of(x), of(low), of(high)),
            Op::Divide {
                numerator,
                shift,
                denominator,
                limit,
            }
            | Op::DivideNarrow {
                numerator,
                shift,
                denominator,
                limit,
            } => {
                format!(
                    "min(({} << {shift}) / {}, {})",
                    of(numerator),
                    of(denominator),
                    of(limit)
                )
            }
            Op::TurnOver(a) => format!("turn / {}", of(a)),
            Op::AngleAdd(a, b) => format!("angle {} + {}", of(a), of(b)),
            Op::AngleSub(a, b) => format!("angle {} - {}", of(a), of(b)),
            Op::AngleIndex { angle, segments } => format!("segment({}, {segments})", of(angle)),
            Op::AngleFraction { angle, segments } => format!("fraction({}, {segments})", of(angle)),
            Op::Lookup {
                table,
                index,
                is_masked,
            } => {
                let Table { name, values, .. } = &self.tables[table.index()];
                if is_masked {
                    format!("{name}[{} mod {}]", of(index), values.len())
                } else {
                    format!("{name}[{}]", of(index))
                }
            }
            Op::Compare(how, a, b) => {
                let sign = match how {
                    Comparison::Less => "<",
                    Comparison::LessEqual => "<=",
                    Comparison::Equal => "==",
                    Comparison::NotEqual => "!=",
                };
                format!("{} {sign} {}", of(a), of(b))
            }
            Op::Exceeds(a, limit) => format!("abs {} > {}", of(a), of(limit)),
            Op::FlagWord(a) => format!("1 if {} else 0", of(a)),
            Op::And(a, b) => format!("{} and {}", of(a), of(b)),
            Op::Or(a, b) => format!("{} or {}", of(a), of(b)),
            Op::Not(a) => format!("not {}", of(a)),
            Op::Select {
                condition,
                then,
                otherwise,
            } => {
                format!("{} if {} else {}", of(then), of(condition), of(otherwise))
            }
            Op::Join { taken, otherwise } => format!("join({}, {})", of(taken), of(otherwise)),
        }
    }
}

fn name(function: &Function, value: Value) -> String {
    let node = function.node(value);
    if node.name.is_empty() {
        let mut text = String::from("%");
        // Writing to a string cannot fail.
        let _ = write!(text, "{}", value.index());
        text
    } else {
        node.name.clone()
    }
}
