//! No value exceeds its error bound: steps from random words against the same steps in floating
//! point with exact coefficients, without rounding and with the same decisions.

use fastrand::Rng;
use hexagen_codegen::ir::{Case, Exact, Interval, Kind, Node, Op, Program, Value, cases};
use hexagen_codegen::pipeline::generate;
use hexagen_codegen::spec::{apply_variant, check, parse_toml};
use hexagen_tests::library::{PAPER_MOTOR, motor, with_inertia};

/// Drives that together have every block of a step.
const VARIANTS: [&str; 11] = [
    "pdcc",
    "pdcc:reference=quasi_square,emf=observer,saturation=nearest",
    "pdcc:modulation=pair,saturation=keep_angle,word=16",
    "pdcc:reference=proportional,emf=model",
    "pi-pwm",
    "pi-pwm:six_step=on",
    "fcs-mpc",
    "fcs-mpc:candidates=all,modulated=on",
    "phcc",
    "phcc:candidates=three_phase,emf=held",
    "pdcc:reference=quasi_square,speed_loop=on",
];

/// Steps per drive.
const STEPS: u32 = 3_000;

/// Both values of a node: the word, and the ideal number.
type Pair = (i64, f64);

/// A word of the interval: near zero as often as anywhere, and at the ends.
fn word(random: &mut Rng, Interval { low, high }: Interval) -> i64 {
    match random.u8(..8) {
        0 => low,
        1 => high,
        2..5 => random.i64(low..=high),
        _ => {
            let (low, high) = (low.max(-1 << 22), high.min(1 << 22));
            if low <= high {
                random.i64(low..=high)
            } else {
                low
            }
        }
    }
}

/// A word for an input, a set-point or a state word: Hall codes are mostly valid.
fn draw(random: &mut Rng, node: &Node) -> i64 {
    let anything = random.u8(..8) == 0;
    match node.name.as_str() {
        "hall" if !anything => random.i64(1..=6),
        _ => word(random, node.interval),
    }
}

/// The ideal number of a node, from those of its operands, in the order of [`Op::operands`]; for
/// angles and lookups the word itself, which is as exact as its own bound.
fn ideal(program: &Program, op: Op, x: &[Pair], result: i64) -> f64 {
    let scale = |shift: u32| (-f64::from(shift)).exp2();
    match op {
        Op::Constant(id) => match program.constants[id.index()].exact {
            Exact::Number(number) => number.value(),
            Exact::Itself | Exact::Within(_) => result as f64,
        },
        Op::Add(..) => x[0].1 + x[1].1,
        Op::Sub(..) => x[0].1 - x[1].1,
        Op::Neg(_) => -x[0].1,
        Op::Abs(_) => x[0].1.abs(),
        Op::Product(..) => x[0].1 * x[1].1,
        Op::MulRound { shift, .. }
        | Op::MulRoundNarrow { shift, .. }
        | Op::MulFloor { shift, .. } => x[0].1 * x[1].1 * scale(shift),
        Op::MulAddFloor { shift, .. } => (x[0].1 * x[1].1 + x[2].1 * x[3].1) * scale(shift),
        Op::MulLimited { .. } => (x[0].1 * x[1].1).min(x[2].1),
        Op::ShiftLeft(_, n) => x[0].1 / scale(n),
        Op::ShiftRight(_, n) | Op::ShiftRound(_, n) => x[0].1 * scale(n),
        Op::Remainder(..) => 0.0,
        Op::Min(..) | Op::Lesser(..) => x[0].1.min(x[1].1),
        Op::Max(..) | Op::Greater(..) => x[0].1.max(x[1].1),
        Op::Clamp { .. } => x[0].1.max(x[1].1).min(x[2].1),
        Op::Divide { shift, .. } | Op::DivideNarrow { shift, .. } => {
            (x[0].1 / scale(shift) / x[1].1).min(x[2].1)
        }
        Op::Select { .. } => x[if x[0].0 == 1 { 1 } else { 2 }].1,
        _ => result as f64,
    }
}

/// Largest ratio of an error to its bound, over all values of all steps.
fn run(program: &Program, seed: u64) -> f64 {
    let function = &program.step;
    let all: Vec<Case> = cases(program, function);
    let mut random = Rng::with_seed(seed);
    let mut most = 0.0_f64;
    for _ in 0..STEPS {
        let mut values: Vec<Option<Pair>> = vec![None; function.nodes.len()];
        for value in function.values() {
            let node = function.node(value);
            let stage = function
                .stages
                .iter()
                .find(|stage| (stage.first..stage.end).contains(&value.index()));
            let at = |operand: Value| values[operand.index()];
            let guard = stage.and_then(|stage| stage.guard.as_ref());
            // State words and constants may be read in a stage that does not run.
            let is_leaf = node.op.operands().is_empty();
            let rests =
                guard.is_some_and(|guard| at(guard.condition).is_none_or(|(flag, _)| flag == 0));
            if rests && !is_leaf {
                continue;
            }
            let x: Option<Vec<Pair>> = node.op.operands().into_iter().map(at).collect();
            values[value.index()] = match (node.op, x) {
                (Op::Join { taken, otherwise }, _) => at(taken).or(at(otherwise)),
                (Op::Input(_) | Op::Param(_) | Op::State(_), _) => {
                    let word = draw(&mut random, node);
                    Some((word, word as f64))
                }
                (Op::Constant(id), _) => {
                    let raw = i64::from(program.constants[id.index()].raw);
                    Some((raw, ideal(program, node.op, &[], raw)))
                }
                (op, Some(x)) => {
                    let words: Vec<i64> = x.iter().map(|pair| pair.0).collect();
                    let table = |table: hexagen_codegen::ir::TableId, at: i64| {
                        program.tables[table.index()].entry(at)
                    };
                    op.apply_to(&words, table)
                        .map(|result| (result, ideal(program, op, &x, result)))
                }
                (_, None) => None,
            };
        }
        // The case of the step: of each condition, whether it held.
        let holds = |condition: Value, held: bool| {
            values[condition.index()].is_some_and(|(flag, _)| (flag == 1) == held)
        };
        let case = all.iter().find(|case| {
            case.known
                .iter()
                .all(|&(condition, held)| holds(condition, held))
        });
        let bounds = &case.expect("cases are all that can happen").bounds;
        for (_, result) in &function.outputs {
            most = most.max(share(bounds, *result, &values));
        }
        for (_, result) in &function.next_state {
            most = most.max(share(bounds, *result, &values));
        }
        for quantity in &function.quantities {
            most = most.max(share(bounds, quantity.value, &values));
        }
    }
    most
}

/// The ratio of a value's error to its bound.
fn share(bounds: &hexagen_codegen::ir::Bounds, value: Value, values: &[Option<Pair>]) -> f64 {
    let Some((word, ideal)) = values[value.index()] else {
        return 0.0;
    };
    // Floating point itself is off by some units in the last of 53 bits.
    let error = (word as f64 - ideal).abs() - 1e-6 - ideal.abs() * 1e-13;
    let bound = bounds.error(value).magnitude();
    if error <= 0.0 {
        0.0
    } else {
        error / bound.max(1e-9)
    }
}

#[test]
fn no_value_exceeds_its_error_bound() {
    let toml = with_inertia(&motor(PAPER_MOTOR).text);
    for variant in VARIANTS {
        let mut ast = parse_toml(&toml, "motor.toml").expect("TOML");
        apply_variant(&mut ast, variant).expect("a variant");
        let (spec, origins) = check(&ast).expect("a specification");
        let generated = generate(&spec, &origins).expect("a controller");
        let program = generated.graph.program();
        assert!(
            program
                .step
                .nodes
                .iter()
                .any(|node| node.kind == Kind::Word)
        );
        let most = run(program, 1);
        println!("{variant}: {most:.3} of the bound at most");
        assert!(most <= 1.0, "{variant}: {most} of the bound");
        // A bound that nothing approaches would be useless; that of a reference by table is the
        // table's own error, which the ideal step here has, too.
        assert!(
            most > 0.02 || variant.contains("proportional"),
            "{variant}: only {most} of the bound"
        );
    }
}
