//! Construction of functions: one method per operator, intervals computed on the way.
//!
//! The builder never fails: a value that leaves its word keeps its interval (clipped far outside the
//! word), and [`super::verify()`] reports it. So a caller may try a scaling, look at the violations
//! and try the next.

use super::error::{Exact, Real};
use super::graph::{
    Constant, Function, Guard, Input, Node, Periodic, Program, Quantity, Stage, Table, Word,
};
use super::interval::Interval;
use super::op::{Comparison, ConstantId, Op, ParamId, StateId, TableId, Value};

/// Intervals are clipped here, far outside the 32-bit word, so that interval arithmetic in 64 bits
/// cannot overflow however wrong a program is.
const CLIP: i64 = 1 << 40;

impl Program {
    /// An empty program.
    pub fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            constants: vec![],
            tables: vec![],
            params: vec![],
            states: vec![],
            step: Function::new("step", &[]),
            setters: vec![],
        }
    }

    /// Adds a named constant that stands for itself, or finds the one of the same name and value.
    pub fn constant(&mut self, name: &str, raw: i32, doc: &[String]) -> ConstantId {
        self.rounded_constant(name, raw, Exact::Itself, doc)
    }

    /// Adds a named constant that was rounded, or finds the one of the same name and value.
    pub fn rounded_constant(
        &mut self,
        name: &str,
        raw: i32,
        exact: Exact,
        doc: &[String],
    ) -> ConstantId {
        if let Some(known) = self
            .constants
            .iter()
            .position(|known| known.name == name && known.raw == raw)
        {
            return ConstantId(known as u32);
        }
        self.constants.push(Constant {
            name: name.to_owned(),
            raw,
            exact,
            doc: doc.to_vec(),
        });
        ConstantId(self.constants.len() as u32 - 1)
    }

    /// Adds a table whose entries stand for themselves, padded with zeros to a power of two.
    pub fn table(&mut self, name: &str, values: Vec<i32>, doc: &[String]) -> TableId {
        self.rounded_table(name, values, (Exact::Itself, None), doc)
    }

    /// Adds a table that is read by one index together with others of the same `row`.
    pub fn column(
        &mut self,
        row: &'static str,
        name: &str,
        values: Vec<i32>,
        doc: &[String],
    ) -> TableId {
        let table = self.table(name, values, doc);
        self.put_in_row(table, row);
        table
    }

    /// Says that a table is read by one index together with others of the same `row`.
    pub fn put_in_row(&mut self, table: TableId, row: &'static str) {
        self.tables[table.index()].row = Some(row);
    }

    /// Says that the entries of a table are states of legs, and are read as such alone.
    pub fn hold_legs(&mut self, table: TableId) {
        self.tables[table.index()].holds_legs = true;
    }

    /// Adds a table of rounded entries, which may belong to a function of the angle; padded as [`Self::table`].
    pub fn rounded_table(
        &mut self,
        name: &str,
        mut values: Vec<i32>,
        (exact, periodic): (Exact, Option<Periodic>),
        doc: &[String],
    ) -> TableId {
        values.resize(values.len().next_power_of_two(), 0);
        self.tables.push(Table {
            name: name.to_owned(),
            values,
            exact,
            periodic,
            row: None,
            holds_legs: false,
            doc: doc.to_vec(),
        });
        TableId(self.tables.len() as u32 - 1)
    }

    /// Adds a state word; it is stored in 16 bits where its interval allows that, see [`Word::storage_bits`].
    pub fn state(&mut self, name: &str, initial: i32, interval: Interval, doc: &str) -> StateId {
        self.states.push(word(name, initial, interval, doc));
        StateId(self.states.len() as u32 - 1)
    }

    /// Adds a set-point word.
    pub fn param(&mut self, name: &str, initial: i32, interval: Interval, doc: &str) -> ParamId {
        self.params.push(Word {
            storage_bits: 32,
            ..word(name, initial, interval, doc)
        });
        ParamId(self.params.len() as u32 - 1)
    }
}

fn word(name: &str, initial: i32, interval: Interval, doc: &str) -> Word {
    let storage_bits = if Interval::HALFWORD.contains(interval) {
        16
    } else {
        32
    };
    Word {
        name: name.to_owned(),
        initial,
        interval,
        storage_bits,
        doc: doc.to_owned(),
    }
}

impl Function {
    /// An empty function.
    pub fn new(name: &str, doc: &[&str]) -> Self {
        Self {
            name: name.to_owned(),
            doc: doc.iter().map(|&line| line.to_owned()).collect(),
            inputs: vec![],
            nodes: vec![],
            stages: vec![],
            outputs: vec![],
            next_state: vec![],
            next_params: vec![],
            told: vec![],
            quantities: vec![],
            tracking: 0,
        }
    }
}

/// Builds one function of a program, stage by stage.
#[derive(Debug)]
pub struct FunctionBuilder<'p> {
    /// The program: constants, tables and words may be added while building.
    pub program: &'p mut Program,
    function: Function,
}

impl<'p> FunctionBuilder<'p> {
    /// Starts a function.
    pub fn new(program: &'p mut Program, name: &str, doc: &[&str]) -> Self {
        Self {
            program,
            function: Function::new(name, doc),
        }
    }

    /// The function, complete.
    pub fn finish(self) -> Function {
        self.function
    }

    /// Opens a stage; all nodes up to the next stage belong to it.
    pub fn stage(&mut self, name: &str, doc: &[&str]) {
        self.close();
        let first = self.function.nodes.len();
        let doc = doc.iter().map(|&line| line.to_owned()).collect();
        self.function.stages.push(Stage {
            name: name.to_owned(),
            doc,
            first,
            end: first,
            guard: None,
        });
    }

    /// Opens a stage that runs only where `condition` holds; close it with [`Self::join`].
    pub fn guarded_stage(&mut self, name: &str, condition: Value, rare: bool, doc: &[&str]) {
        self.stage(name, doc);
        let last = self.function.stages.len() - 1;
        self.function.stages[last].guard = Some(Guard {
            condition,
            joins: vec![],
            rare,
        });
    }

    /// Tells people a value.
    pub fn tell(&mut self, name: &str, value: Value) {
        self.function.told.push((name.to_owned(), value));
    }

    /// Ends the tracking: what follows runs in controlled periods only. A new stage must be opened.
    pub fn end_tracking(&mut self) {
        self.close();
        self.function.tracking = self.function.nodes.len();
    }

    /// Closes the guarded stage: per result its name, the value from inside, and the value that holds
    /// where the stage did not run. A new stage must be opened before further nodes are added.
    pub fn join<const N: usize>(&mut self, results: [(&str, Value, Value); N]) -> [Value; N] {
        let joined = self.join_all(&results);
        std::array::from_fn(|index| joined[index])
    }

    /// [`Self::join`] for a list of any length.
    pub fn join_all(&mut self, results: &[(&str, Value, Value)]) -> Vec<Value> {
        let last = self.function.stages.len() - 1;
        self.function.stages[last].end = self.function.nodes.len();
        let joins: Vec<Value> = results
            .iter()
            .map(|&(name, taken, otherwise)| self.push(name, Op::Join { taken, otherwise }))
            .collect();
        if let Some(guard) = &mut self.function.stages[last].guard {
            guard.joins.clone_from(&joins);
        }
        joins
    }

    fn close(&mut self) {
        let end = self.function.nodes.len();
        if let Some(stage) = self.function.stages.last_mut()
            && stage
                .guard
                .as_ref()
                .is_none_or(|guard| guard.joins.is_empty())
        {
            stage.end = end;
        }
    }

    /// Names a result of the function.
    pub fn output(&mut self, name: &str, value: Value) {
        self.close();
        self.function.outputs.push((name.to_owned(), value));
    }

    /// Sets a state word's new value.
    pub fn set_state(&mut self, state: StateId, value: Value) {
        self.close();
        self.function.next_state.push((state, value));
    }

    /// Sets a set-point word's new value.
    pub fn set_param(&mut self, param: ParamId, value: Value) {
        self.close();
        self.function.next_params.push((param, value));
    }

    /// States the error of a value: of what quantity, in which unit, and what a word is worth in it.
    pub fn state_error(&mut self, name: &str, value: Value, [doc, unit]: [&str; 2], word: f64) {
        self.function.quantities.push(Quantity {
            name: name.to_owned(),
            doc: doc.to_owned(),
            unit: unit.to_owned(),
            word: Real::of(word),
            value,
        });
    }

    /// The proven interval of a value.
    pub fn interval(&self, value: Value) -> Interval {
        self.function.node(value).interval
    }

    /// Gives an unnamed value a name, so that it becomes a `let` of the emitted code.
    pub fn name(&mut self, name: &str, value: Value) -> Value {
        name.clone_into(&mut self.function.nodes[value.index()].name);
        value
    }

    fn push(&mut self, name: &str, op: Op) -> Value {
        let kind = op.kind(|value| self.function.node(value).kind);
        let operands: Vec<Interval> = op
            .operands()
            .iter()
            .map(|&value| self.interval(value))
            .collect();
        let interval = match op {
            Op::Input(n) => self.function.inputs[n as usize].interval,
            Op::Param(id) => self.program.params[id.index()].interval,
            Op::State(id) => self.program.states[id.index()].interval,
            Op::Constant(id) => Interval::point(i64::from(self.program.constants[id.index()].raw)),
            Op::Join { taken, otherwise } => {
                let guard = self
                    .function
                    .stages
                    .last()
                    .and_then(|stage| stage.guard.as_ref());
                let outside = match guard {
                    Some(guard) => self.function.interval_where_not(guard.condition, otherwise),
                    None => self.interval(otherwise),
                };
                self.interval(taken).union(outside)
            }
            _ => op
                .interval(&operands, |id| self.program.tables[id.index()].interval())
                .unwrap_or(Interval::symmetric(CLIP)),
        };
        let interval = Interval::new(
            interval.low.clamp(-CLIP, CLIP),
            interval.high.clamp(-CLIP, CLIP),
        );
        self.function.nodes.push(Node {
            op,
            kind,
            interval,
            name: name.to_owned(),
        });
        Value(self.function.nodes.len() as u32 - 1)
    }

    /// Adds an input word and reads it.
    pub fn input(&mut self, name: &str, interval: Interval, doc: &str) -> Value {
        self.function.inputs.push(Input {
            name: name.to_owned(),
            interval,
            doc: doc.to_owned(),
        });
        self.push(name, Op::Input(self.function.inputs.len() as u32 - 1))
    }

    /// Reads a set-point word; a second read is the same value.
    pub fn param(&mut self, param: ParamId) -> Value {
        if let Some(value) = self.find(Op::Param(param)) {
            return value;
        }
        let name = self.program.params[param.index()].name.clone();
        self.push(&name, Op::Param(param))
    }

    /// Reads a state word as it was before the step; a second read is the same value.
    pub fn state(&mut self, state: StateId) -> Value {
        if let Some(value) = self.find(Op::State(state)) {
            return value;
        }
        let name = self.program.states[state.index()].name.clone();
        self.push(&name, Op::State(state))
    }

    fn find(&self, op: Op) -> Option<Value> {
        self.function
            .nodes
            .iter()
            .position(|node| node.op == op)
            .map(|index| Value(index as u32))
    }

    /// Reads a named constant.
    pub fn constant(&mut self, id: ConstantId) -> Value {
        self.push("", Op::Constant(id))
    }

    /// A small number.
    pub fn literal(&mut self, value: i32) -> Value {
        self.push("", Op::Literal(value))
    }

    /// table[index mod length]
    pub fn lookup(&mut self, table: TableId, index: Value) -> Value {
        self.push("", Op::Lookup { table, index })
    }

    /// `c x` rounded half up at `shift`; the bare product for shift 0.
    pub fn mul(&mut self, coefficient: Value, signal: Value, shift: u32) -> Value {
        match shift {
            0 => self.push("", Op::Product(coefficient, signal)),
            _ => self.push(
                "",
                Op::MulRound {
                    coefficient,
                    signal,
                    shift,
                },
            ),
        }
    }

    /// A small multiple, `factor` times `a`.
    pub fn mul_by(&mut self, factor: i32, a: Value) -> Value {
        let factor = self.literal(factor);
        self.push("", Op::Product(factor, a))
    }

    /// floor(a b / 2^shift)
    pub fn mul_floor(&mut self, a: Value, b: Value, shift: u32) -> Value {
        self.push("", Op::MulFloor { a, b, shift })
    }

    /// floor((a b + c d) / 2^shift) of factors a, b and c, d
    pub fn mul_add_floor(&mut self, first: [Value; 2], second: [Value; 2], shift: u32) -> Value {
        self.push(
            "",
            Op::MulAddFloor {
                first,
                second,
                shift,
            },
        )
    }

    /// min(a b, limit), a and b not negative
    pub fn mul_limited(&mut self, a: Value, b: Value, limit: Value) -> Value {
        self.push("", Op::MulLimited { a, b, limit })
    }

    /// a 2^n
    pub fn shift_left(&mut self, a: Value, n: u32) -> Value {
        self.push("", Op::ShiftLeft(a, n))
    }

    /// floor(a / 2^n)
    pub fn shift_right(&mut self, a: Value, n: u32) -> Value {
        self.push("", Op::ShiftRight(a, n))
    }

    /// min(max(x, low), high)
    pub fn clamp(&mut self, x: Value, low: Value, high: Value) -> Value {
        self.push("", Op::Clamp { x, low, high })
    }

    /// min(max(x, -limit), limit)
    pub fn clamp_both(&mut self, x: Value, limit: Value) -> Value {
        let low = self.neg(limit);
        self.clamp(x, low, limit)
    }

    /// min(floor(numerator 2^shift / denominator), limit)
    pub fn divide(
        &mut self,
        numerator: Value,
        shift: u32,
        denominator: Value,
        limit: Value,
    ) -> Value {
        self.push(
            "",
            Op::Divide {
                numerator,
                shift,
                denominator,
                limit,
            },
        )
    }

    /// floor((2^32 - 1) / a)
    pub fn turn_over(&mut self, a: Value) -> Value {
        self.push("", Op::TurnOver(a))
    }

    /// Segment of the angle.
    pub fn angle_index(&mut self, angle: Value, segments: u32) -> Value {
        self.push("", Op::AngleIndex { angle, segments })
    }

    /// Position within the angle's segment, 31 bits.
    pub fn angle_fraction(&mut self, angle: Value, segments: u32) -> Value {
        self.push("", Op::AngleFraction { angle, segments })
    }

    /// Flag: `a` compared with `b`.
    pub fn compare(&mut self, how: Comparison, a: Value, b: Value) -> Value {
        self.push("", Op::Compare(how, a, b))
    }

    /// `then` where the flag holds, else `otherwise`.
    pub fn select(&mut self, condition: Value, then: Value, otherwise: Value) -> Value {
        self.push(
            "",
            Op::Select {
                condition,
                then,
                otherwise,
            },
        )
    }
}

macro_rules! operators {
    ($($(#[$doc:meta])* $name:ident($($operand:ident),+) = $op:ident;)*) => {
        impl FunctionBuilder<'_> {$(
            $(#[$doc])*
            pub fn $name(&mut self, $($operand: Value),+) -> Value {
                self.push("", Op::$op($($operand),+))
            }
        )*}
    };
}
operators! {
    /// a + b
    add(a, b) = Add;
    /// a - b
    sub(a, b) = Sub;
    /// -a
    neg(a) = Neg;
    /// |a|
    abs(a) = Abs;
    /// min(a, b)
    min(a, b) = Min;
    /// max(a, b)
    max(a, b) = Max;
    /// (a + b) mod 2^32
    angle_add(a, b) = AngleAdd;
    /// (a - b) mod 2^32
    angle_sub(a, b) = AngleSub;
    /// Both flags.
    and(a, b) = And;
    /// Either flag.
    or(a, b) = Or;
    /// Not the flag.
    not(a) = Not;
}
