//! Each invariant of the verifier, broken in an otherwise valid program.

use super::graph::{Function, Program};
use super::interval::Interval;
use super::op::{Op, ParamId, StateId, Value};
use super::{Demand, Output, ProgramBuilder, Setter, Told, named, verify};

/// A valid program that exercises every invariant.
fn right() -> Program {
    let b = ProgramBuilder::new("Right", &[]);
    let word = Interval::symmetric(1000);
    let table = b.table("shape", vec![1, 2, 3, 4], &[]);
    let memory = b.memory("memory", 0, word, "");
    let param = b.param(Demand::Current, "wanted", 0, word, "");
    b.stage("read", &[]);
    let x = b.input("x", word, "");
    let index = b.input("index", Interval::new(0, 3), "");
    named! {
        let entry = table.at(index);
        let scaled = x.mul_round(b.constant("gain", 3, &[]), 1);
        let error = param.read() - memory.read();
        let large = entry.is_below(scaled);
    }
    b.guarded_stage("divide", large, true, &[]);
    named! {
        let share = entry.divide(2, entry, entry);
    }
    let [result] = b.join([("result", share, error)]);
    b.stage("keep", &[]);
    named! {
        let limited = scaled.clamp(-5, 5);
    }
    memory.set(limited);
    b.output(Output::Probe("result"), result);
    b.setter(Setter::Current, &[], |b| {
        b.stage("round", &[]);
        param.set(b.input("given", word, ""));
    });
    b.finish()
}

/// Checks that the spoilt program is refused with these words.
#[track_caller]
fn refused(words: &str, spoil: impl FnOnce(&mut Program)) {
    let mut program = right();
    spoil(&mut program);
    let violations = verify(program).expect_err("a broken invariant");
    let told = violations.iter().map(ToString::to_string);
    let told: Vec<String> = told.collect();
    assert!(told.iter().any(|what| what.contains(words)), "{told:#?}");
}

/// The place of a named value.
fn at(function: &Function, name: &str) -> usize {
    let found = function.nodes.iter().position(|node| node.name == name);
    found.expect("a value of that name")
}

fn value(function: &Function, name: &str) -> Value {
    Value(at(function, name) as u32)
}

#[test]
fn a_right_program_passes() {
    let violations = verify(right()).err();
    assert_eq!(violations, None);
}

#[test]
fn operands_are_defined_earlier() {
    refused("operand defined later", |program| {
        let (from, to) = (at(&program.step, "scaled"), value(&program.step, "limited"));
        program.step.nodes[from].op = Op::Neg(to);
    });
    refused("does not exist", |program| {
        let wanted = at(&program.step, "wanted");
        program.step.nodes[wanted].op = Op::Param(ParamId(7));
    });
    refused("result is not defined", |program| {
        program.step.outputs[0].1 = Value(1000);
    });
    refused("result is not defined", |program| {
        program.step.next_state[0].0 = StateId(1);
    });
}

#[test]
fn stages_partition_the_nodes() {
    refused("do not follow one another", |program| {
        program.step.stages[2].first += 1;
    });
    refused("do not cover all nodes", |program| {
        program.step.stages[2].end -= 1;
    });
}

#[test]
fn guarded_stages_are_left_through_joins() {
    refused("leaves its guarded stage other than by a join", |program| {
        program.step.outputs[0].1 = value(&program.step, "share");
    });
    refused("is no join of the stage before it", |program| {
        let (result, error) = (at(&program.step, "result"), value(&program.step, "error"));
        program.step.nodes[result].op = Op::Neg(error);
    });
    refused("guard is defined after the stage begins", |program| {
        let limited = value(&program.step, "limited");
        let guard = program.step.stages[1].guard.as_mut().expect("a guard");
        guard.condition = limited;
    });
}

#[test]
fn kinds_fit() {
    refused("operand kinds do not fit", |program| {
        let (scaled, large) = (at(&program.step, "limited"), value(&program.step, "large"));
        program.step.nodes[scaled].op = Op::Neg(large);
    });
    refused("a result is no word", |program| {
        program.step.outputs[0].1 = value(&program.step, "large");
    });
}

#[test]
fn intervals_follow_from_operands_and_fit() {
    refused("does not follow from the operands", |program| {
        let scaled = at(&program.step, "scaled");
        program.step.nodes[scaled].interval.high -= 1;
    });
    refused("needs 33 bits", |program| {
        let scaled = at(&program.step, "scaled");
        program.step.nodes[scaled].interval.high = 1 << 31;
    });
}

#[test]
fn operators_stay_in_their_domain() {
    refused("may leave the operator's domain", |program| {
        let (share, scaled) = (at(&program.step, "share"), value(&program.step, "scaled"));
        let Op::Divide { denominator, .. } = &mut program.step.nodes[share].op else {
            panic!("a division");
        };
        *denominator = scaled;
    });
    refused("may leave the operator's domain", |program| {
        let limited = at(&program.step, "limited");
        let Op::Clamp { low, high, .. } = &mut program.step.nodes[limited].op else {
            panic!("a limit");
        };
        std::mem::swap(low, high);
    });
}

#[test]
fn sums_of_products_fit_64_bits() {
    let sum = Op::MulAddFloor {
        first: [Value(0); 2],
        second: [Value(0); 2],
        shift: 32,
    };
    let interval = |factor: Interval| sum.interval(&[factor; 4], |_| Interval::FLAG);
    let word = Interval::new(1 - (1 << 31), (1 << 31) - 1);
    assert_eq!(
        interval(word).map(|sum| sum.high),
        Some((1 << 31) - 2),
        "the largest sum of words"
    );
    // Twice 2^62, and intervals as from the first scale that is tried.
    assert_eq!(interval(Interval::WORD), None);
    assert_eq!(interval(Interval::symmetric(1 << 40)), None);
}

#[test]
fn names_are_unique() {
    refused("gain: named twice", |program| {
        program.tables[0].name = "gain".to_owned();
    });
    refused("memory: named twice", |program| {
        program.params[0].1.name = "memory".to_owned();
    });
    refused("step: named twice", |program| {
        program.setters[0].1.name = "step".to_owned();
    });
    refused("read: named twice", |program| {
        program.step.stages[2].name = "read".to_owned();
    });
    refused("x: named twice", |program| {
        program.step.inputs[1].name = "x".to_owned();
    });
    refused("named twice", |program| {
        let scaled = at(&program.step, "scaled");
        program.step.nodes[scaled].name = "entry".to_owned();
    });
    refused("has no name", |program| {
        let scaled = at(&program.step, "scaled");
        program.step.nodes[scaled].name.clear();
    });
}

#[test]
fn an_index_that_is_not_masked_lies_within_its_table() {
    let spoil = |program: &mut Program, high| {
        let entry = at(&program.step, "entry");
        let Op::Lookup { is_masked, .. } = &mut program.step.nodes[entry].op else {
            panic!("a lookup");
        };
        *is_masked = false;
        let index = at(&program.step, "index");
        let range = Interval::new(0, high);
        program.step.nodes[index].interval = range;
        program.step.inputs[1].interval = range;
    };
    refused("the index may leave the table", |program| spoil(program, 4));
    let mut inside = right();
    spoil(&mut inside, 3);
    assert_eq!(verify(inside).err(), None);
}

#[test]
fn tables_have_a_power_of_two_length() {
    refused("not a power of two", |program| {
        program.tables[0].values.push(5);
    });
}

#[test]
fn words_are_set_once_to_what_they_hold() {
    refused("not set exactly once", |program| {
        program.step.next_state.clear();
    });
    refused("the step sets a set-point word", |program| {
        let scaled = value(&program.step, "limited");
        program.step.next_params.push((ParamId(0), scaled));
    });
    refused("a setter sets a state word", |program| {
        let given = value(&program.setters[0].1, "given");
        program.setters[0].1.next_state.push((StateId(0), given));
    });
    refused("set-point word is set twice", |program| {
        let again = program.setters[0].1.next_params[0];
        program.setters[0].1.next_params.push(again);
    });
    refused("set to", |program| {
        program.states[0].interval = Interval::symmetric(4);
        let kept = at(&program.step, "memory");
        program.step.nodes[kept].interval = Interval::symmetric(4);
    });
    refused("initial value 2000 outside", |program| {
        program.params[0].1.initial = 2000;
    });
    refused("the word has 8", |program| {
        program.states[0].storage_bits = 8;
    });
}

#[test]
fn there_are_no_dead_nodes() {
    refused("is never used", |program| program.step.outputs.clear());
}

#[test]
fn nothing_is_computed_for_people_alone() {
    refused("is told to people and used for nothing else", |program| {
        let (_, value) = program.step.outputs.remove(0);
        program.step.told.push((Told::Speed, value));
    });
}

#[test]
fn tracking_ends_with_a_stage_and_what_it_leaves_can_be_forgotten() {
    refused("tracking does not end with a stage", |program| {
        program.step.tracking = program.step.stages[1].first + 1;
    });
    refused("tracking reads a set-point word", |program| {
        program.step.tracking = program.step.nodes.len();
    });
    refused("forgotten at rest, but never 0", |program| {
        program.states[0].interval = Interval::new(1, 1000);
        program.states[0].initial = 1;
    });
}
