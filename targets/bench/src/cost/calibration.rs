//! Calibration of the generator's step times: figures of the counted drives, and weights of
//! operations that estimate those of others. The weights make the sum of relative errors least.

use super::longest::chip;
use crate::BenchError;
use crate::firmware::workspace;
use crate::targets::Target;
use hexagen_codegen::timing::{
    self, Errors, FIGURES, Peculiarity, Times, Work, counted, digest, weighed, work,
};
use hexagen_lab::counted::Figures;
use hexagen_lab::engine::Prepared;
use microlp::{ComparisonOp, OptimizationDirection, Problem, SolveOutcome};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::process::Command;

/// What a drive's times are known by, and estimated from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    digest: u64,
    peculiarity: Peculiarity,
    work: Times<Work>,
}

/// A counted drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Drive {
    pub symbol: String,
    pub calibration: Calibration,
    /// Whether others are estimated from it.
    pub is_typical: bool,
    pub times: Times<u32>,
}

/// The drives of a target, and the compiler that made their code.
#[derive(Clone, Debug, PartialEq)]
pub struct Counted {
    pub target: Target,
    pub compiler: String,
    pub drives: Vec<Drive>,
    /// Largest ratio of a drive's time in C to its time in Rust.
    pub in_c: Times<f64>,
}

/// One figure of a counted drive.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    peculiarity: Peculiarity,
    work: Work,
    time: f64,
}

/// What a figure is estimated by: weights, and the least that it is.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Line {
    weights: Work,
    least: f64,
}

/// A line, and the errors that it is told with.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Fit {
    line: Line,
    errors: Errors,
}

impl Line {
    /// Relative error of a point's estimate.
    fn off(&self, point: &Point) -> f64 {
        (point.time / weighed(&self.weights, self.least, &point.work) - 1.0).abs()
    }
}

impl Calibration {
    pub fn of(drive: &Prepared) -> Self {
        let program = drive.generated.graph.program();
        Self {
            digest: digest(&drive.generated.interface.spec_toml),
            peculiarity: Peculiarity::of(program, drive.generated.interface.hall_shifts.is_some()),
            work: work(program),
        }
    }
}

/// Name and version of a compiler, without what is behind them.
pub fn release(compiler: &str) -> String {
    let words: Vec<&str> = compiler.split(' ').take(2).collect();
    words.join(" ")
}

/// Largest ratio of a drive's time in C (`step_x_c`) to its time in Rust (`step_x`).
pub fn in_c(figures: &BTreeMap<String, Figures>) -> Times<f64> {
    let pairs = figures.iter().filter_map(|(symbol, in_c)| {
        let in_rust = figures.get(symbol.strip_suffix("_c")?)?;
        Some(in_c.times()?.zip(in_rust.times()?))
    });
    let ratios = pairs.map(|pair| pair.map(|(c, rust)| f64::from(c) / f64::from(rust)));
    let most = |most: Times<f64>, ratio| most.zip(ratio).map(|(one, other)| one.max(other));
    // Rounded up to hundredths: what is told is no less than what was counted.
    let most = ratios.fold(Times::of([1.0; FIGURES]), most);
    most.map(|ratio| (100.0 * ratio).ceil() / 100.0)
}

/// Drives whose counted times exceed those that the generator tells. Those of another compiler are
/// not compared.
pub fn rises(of: &Counted) -> Vec<String> {
    let Counted {
        target,
        compiler,
        drives,
        in_c,
    } = of;
    let (target, mut rises) = (*target, vec![]);
    if let Some((by, known)) = timing::in_c(&core(target))
        && by == compiler
        && known
            .zip(*in_c)
            .into_array()
            .iter()
            .any(|(known, found)| found > known)
    {
        rises.push(format!(
            "{}: C over Rust {in_c:?}, and the generator tells {known:?}",
            target.name()
        ));
    }
    for drive in drives {
        let Some((by, known)) = counted(&core(target), drive.calibration.digest) else {
            rises.push(format!(
                "{}: {}: the generator does not know its times",
                target.name(),
                drive.symbol
            ));
            continue;
        };
        let pairs = known.zip(drive.times).into_array();
        if by == compiler && pairs.iter().any(|(known, found)| found > known) {
            rises.push(format!(
                "{}: {}: times {:?}, and the generator tells {known:?}",
                target.name(),
                drive.symbol,
                drive.times
            ));
        }
    }
    rises
}

/// Writes the generator's figures.
///
/// # Errors
/// If a fit fails, the file cannot be written, or rustfmt does not run.
pub fn write(targets: &[Counted]) -> Result<(), BenchError> {
    let chips = targets.iter().map(chip_item);
    let chips = chips.collect::<Result<Vec<_>, _>>()?;
    let text = format!(
        "//! Written by `cargo xtask cost --accept`.\n\n\
         use super::{{Chip, Estimate, Times}};\n\n\
         pub static CHIPS: [Chip; {}] = [{}];",
        chips.len(),
        chips.join(", ")
    );
    write_formatted(&workspace().join("codegen/src/timing/figures.rs"), &text)
}

/// Rust text of a chip with the figures of its drives.
fn chip_item(of: &Counted) -> Result<String, BenchError> {
    let chip = chip(of.target);
    let clocks = chip.clocks_of_waits.iter();
    let clocks: Vec<String> = clocks.map(|clock| format!("{clock}e6")).collect();
    Ok(format!(
        "Chip {{ target: {:?}, core: {:?}, name: {:?}, clocks_of_waits: &[{}], assumed: {:?}, compiler: {:?}, \
         in_c: {}, estimates: {}, counted: &[{}] }}",
        core(of.target),
        name(of.target),
        chip.name,
        clocks.join(", "),
        chip.assumed,
        of.compiler,
        times(of.in_c.map(|ratio| format!("{ratio:?}"))),
        times(fits(&of.drives)?.map(estimate)),
        counted_items(&of.drives),
    ))
}

fn estimate(fit: Fit) -> String {
    let Errors {
        usual,
        learning,
        intervals,
    } = fit.errors;
    let [weights, errors] = [&fit.line.weights[..], &[usual, learning, intervals]].map(|numbers| {
        let numbers: Vec<String> = numbers.iter().copied().map(number).collect();
        numbers.join(", ")
    });
    let least = number(fit.line.least);
    format!("Estimate::of([{weights}], {least}, [{errors}])")
}

/// The times of each specification; of drives with one specification the longer.
fn counted_items(drives: &[Drive]) -> String {
    let mut counted = BTreeMap::<u64, Times<u32>>::new();
    for drive in drives {
        let times = counted
            .entry(drive.calibration.digest)
            .or_insert(drive.times);
        *times = times
            .zip(drive.times)
            .map(|(known, other)| known.max(other));
    }
    let items = counted.into_iter().map(|(digest, figures)| {
        let groups = [48, 32, 16, 0].map(|shift| format!("{:04x}", digest >> shift & 0xffff));
        let figures = times(figures.map(|figure| figure.to_string()));
        format!("(0x{}, {figures})", groups.join("_"))
    });
    items.collect::<Vec<_>>().join(", ")
}

/// Writes a Rust file in the format of rustfmt, whole or not at all.
fn write_formatted(path: &Path, text: &str) -> Result<(), BenchError> {
    let new = path.with_extension("new");
    fs::write(&new, text)?;
    let formatted = Command::new("rustfmt")
        .args(["--edition", "2024"])
        .arg(&new)
        .status()?;
    if !formatted.success() {
        fs::remove_file(&new)?;
        return Err(BenchError::Failed("rustfmt failed".to_owned()));
    }
    fs::rename(new, path)?;
    Ok(())
}

/// The target as a word of the option of controllers.
fn core(target: Target) -> String {
    target.name().replace('-', "_")
}

fn name(target: Target) -> &'static str {
    match target {
        Target::CortexM4 => "Cortex-M4",
        Target::CortexM0 => "Cortex-M0",
        Target::Riscv32 => "RV32IMC",
    }
}

/// Rust text of figures.
fn times(figures: Times<String>) -> String {
    format!("Times::of([{}])", figures.into_array().join(", "))
}

/// A number with four digits.
fn number(number: f64) -> String {
    let digits = if number >= 1.0 {
        3 - (number.log10().floor() as i32).min(3)
    } else {
        4
    };
    format!("{number:.*}", digits.max(1) as usize)
}

/// The fit of each figure.
fn fits(drives: &[Drive]) -> Result<Times<Fit>, BenchError> {
    let typical = drives.iter().filter(|drive| drive.is_typical);
    let points = typical.map(|drive| {
        let Calibration {
            peculiarity, work, ..
        } = drive.calibration;
        let figures = work.zip(drive.times.map(f64::from));
        let point = |(work, time)| Point {
            peculiarity,
            work,
            time,
        };
        figures.map(point).into_array()
    });
    let points: Vec<[Point; FIGURES]> = points.collect();
    let of = |figure: usize| -> Vec<Point> { points.iter().map(|point| point[figure]).collect() };
    let mut fits = vec![];
    for figure in 0..FIGURES {
        // Those of any step lie as far behind those of a step in control.
        let in_control = figure.checked_sub(ANY - CONTROL).filter(|_| figure >= ANY);
        fits.push(fit(&of(figure), in_control.map(of).as_deref())?);
    }
    let fits: [Fit; FIGURES] = fits
        .try_into()
        .map_err(|_| BenchError::Failed("a figure has no fit".to_owned()))?;
    Ok(Times::of(fits))
}

/// The first figure of a step in control, and of any step.
const CONTROL: usize = 1;
const ANY: usize = 4;

/// The line through the points of a figure. Drives whose commands have intervals are not fitted: which of
/// their steps limit the voltage depends on the drive, and the operations do not tell it. `in_control`:
/// for a figure of any step, the points of the same drives in control, on whose line its line builds.
fn fit(points: &[Point], in_control: Option<&[Point]>) -> Result<Fit, BenchError> {
    let is_fitted = |&drive: &usize| points[drive].peculiarity != Peculiarity::Intervals;
    let fitted: Vec<usize> = (0..points.len()).filter(is_fitted).collect();
    let line = |drives: &[usize]| {
        let of = |points: &[Point]| -> Vec<Point> {
            drives.iter().map(|&drive| points[drive]).collect()
        };
        match in_control {
            None => weights(&of(points)).map(|weights| Line {
                weights,
                least: 0.0,
            }),
            Some(in_control) => Ok(beyond(weights(&of(in_control))?, &of(points))),
        }
    };
    let mut errors = Errors::default();
    for &left_out in &fitted {
        let others: Vec<usize> = fitted
            .iter()
            .copied()
            .filter(|&drive| drive != left_out)
            .collect();
        let point = &points[left_out];
        let own = line(&others)?.off(point);
        errors.learning = errors.learning.max(own);
        if point.peculiarity == Peculiarity::None {
            errors.usual = errors.usual.max(own);
        }
    }
    let line = line(&fitted)?;
    let all = points.iter().map(|point| line.off(point));
    errors.intervals = all.fold(errors.learning, f64::max);
    Ok(Fit { line, errors })
}

/// Any step is one in control behind a braked or bridged period's examination, or one at rest, whichever is
/// longer: the constant that is added and the least time with the least sum of relative errors, among
/// those that fit one drive each.
fn beyond(in_control: Work, points: &[Point]) -> Line {
    let line = |added: f64, least: f64| {
        let mut weights = in_control;
        weights[0] += added;
        Line { weights, least }
    };
    let added = points
        .iter()
        .map(|point| point.time - weighed(&in_control, 0.0, &point.work));
    let lines = added.flat_map(|added| {
        points
            .iter()
            .map(move |point| line(added.max(0.0), point.time))
    });
    let error = |line: &Line| -> f64 { points.iter().map(|point| line.off(point)).sum() };
    let best = lines.min_by(|one, other| error(one).total_cmp(&error(other)));
    best.unwrap_or(line(0.0, 0.0))
}

/// Weights of 0 or more whose estimates have the least sum of relative errors: a linear program with
/// an error above each point's deviation to both sides.
fn weights(points: &[Point]) -> Result<Work, BenchError> {
    let mut program = Problem::new(OptimizationDirection::Minimize);
    let weights = Work::default().map(|_| program.add_var(0.0, (0.0, f64::INFINITY)));
    for Point { work, time, .. } in points {
        let error = program.add_var(1.0, (0.0, f64::INFINITY));
        for (sign, bound) in [(1.0, ComparisonOp::Ge), (-1.0, ComparisonOp::Le)] {
            let parts = weights
                .iter()
                .zip(work)
                .map(|(weight, work)| (*weight, work / time));
            let both: Vec<_> = parts.chain([(error, sign)]).collect();
            program.add_constraint(both, bound, 1.0);
        }
    }
    match program.solve() {
        Ok(SolveOutcome::Solution(solution)) => {
            Ok(weights.map(|weight| solution.var_value(weight)))
        }
        other => Err(BenchError::Failed(format!("fit of step times: {other:?}"))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_law_of_operations_is_found_and_an_outlier_is_told() {
        let point = |add: f64, product: f64| [1.0, 0.0, add, product, 0.0, 0.0, 0.0];
        let exact = |work: Work| Point {
            peculiarity: Peculiarity::None,
            work,
            time: 20.0 + 1.5 * work[2] + 4.0 * work[3],
        };
        let mut points: Vec<Point> = (1..9)
            .map(|k| exact(point(f64::from(10 * k), f64::from(k * k % 7))))
            .collect();
        let found = fit(&points, None).expect("a fit");
        for (weight, expected) in [(0, 20.0), (2, 1.5), (3, 4.0)] {
            assert!((found.line.weights[weight] - expected).abs() < 1e-6);
        }
        assert!(found.errors.learning < 1e-6 && found.errors.usual < 1e-6);
        // A drive that takes a quarter more changes no weight, and is the largest error of its kind.
        let usual = exact(point(35.0, 3.0));
        points.push(Point {
            peculiarity: Peculiarity::Learning,
            time: 1.25 * usual.time,
            ..usual
        });
        let found = fit(&points, None).expect("a fit");
        assert!((found.line.weights[2] - 1.5).abs() < 1e-6);
        assert!(
            (found.errors.learning - 0.25).abs() < 1e-6,
            "{}",
            found.errors.learning
        );
        assert!(found.errors.usual < 1e-6, "{found:?}");
        // One with intervals is not fitted, and the largest error of all.
        points.push(Point {
            peculiarity: Peculiarity::Intervals,
            time: 2.0 * usual.time,
            ..usual
        });
        let with_intervals = fit(&points, None).expect("a fit");
        assert_eq!(with_intervals.line, found.line);
        assert!((with_intervals.errors.intervals - 1.0).abs() < 1e-6);
        assert!((with_intervals.errors.learning - 0.25).abs() < 1e-6);
        assert!(with_intervals.errors.usual < 1e-6);
    }

    #[test]
    fn any_step_is_one_in_control_and_more_or_one_at_rest() {
        let in_control = |add: f64| Point {
            peculiarity: Peculiarity::None,
            work: [1.0, 0.0, add, 0.0, 0.0, 0.0, 0.0],
            time: 20.0 + 2.0 * add,
        };
        let control: Vec<Point> = (1..20).map(|k| in_control(f64::from(10 * k))).collect();
        let any = |point: &Point| Point {
            time: (point.time + 70.0).max(230.0),
            ..*point
        };
        let any: Vec<Point> = control.iter().map(any).collect();
        let found = fit(&any, Some(&control)).expect("a fit");
        assert!((found.line.weights[0] - 90.0).abs() < 1e-6, "{found:?}");
        assert!((found.line.weights[2] - 2.0).abs() < 1e-6, "{found:?}");
        assert!((found.line.least - 230.0).abs() < 1e-6, "{found:?}");
        assert!(found.errors.intervals < 1e-6, "{found:?}");
    }

    #[test]
    fn numbers_have_four_digits() {
        assert_eq!(
            [0.123_45, 1.234_56, 123.456, 7654.3].map(number),
            ["0.1235", "1.235", "123.5", "7654.3"]
        );
    }
}
