//! Cost of a step: instructions, cycles, code, tables, state and stack, of every drive and of its
//! peers.

mod calibration;
mod count;
mod cycles;
pub mod elf;
mod expected;
mod goals;
mod longest;
mod peers;

use crate::BenchError;
use crate::firmware::{Firmware, PROGRAMS};
use crate::listing::Listed;
use crate::pil::Emulated;
use crate::targets::Target;
use crate::vectors::drive_of;
use calibration::{Calibration, Drive};
use comfy_table::{CellAlignment, Table, presets};
use count::{Counts, Inputs, count, supervision};
use elf::{Code, Image, Isa};
use expected::Expected;
use goals::{blocks, goal};
use hexagen_lab::counted::{Counted, Figures, Longest};
use hexagen_lab::engine::{MotorSource, Prepared, prepare};
use hexagen_lab::reproduction::counted_drives;
use longest::{Program, chip};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// The motor of the peers and of the firmware's interrupt.
const PAPER_MOTOR: &str = "trivedi-keshri-660w";

/// The whole interrupt of the firmware, and its drive.
const INTERRUPT: &str = "interrupt_trivedi_keshri_660w_pdcc";
const INTERRUPT_VARIANT: &str = "pdcc:reference=quasi_square,saturation=keep_angle,emf=held";

/// The program with the drives of the paper's experiment.
const EXPERIMENT: &str = "experiment";

/// The program with the peers.
const PEERS: &str = "peers";

/// The programs with drives in Rust, whose supervision is counted separately.
const IN_RUST: [&str; 2] = ["bench", EXPERIMENT];

/// What the columns are.
const LEGEND: &str = "normal, worst: instructions from the function's entry to its return, in closed loop at rated current (QEMU); normal is the \
    median of settled steps at 0.2 and 0.7 of the rated speed, worst the maximum of all steps there, at 1.25 and at -0.7 of it, each \
    from the initial state.\n\
    supervision: share of the normal path, counted on a drive with the same limits and an empty law: call and return, mode, \
    checks of Hall code, ADCs and currents. The rest is the law. Only for drives in Rust.\n\
    arbitrary: maximum in calibration, one that fails included, in pre-charge, coasting and braking, and on arbitrary inputs and calls, \
    which trip the drive; only for drives.\n\
    longest: instructions of the longest path through the control-flow graph of the function and its callees, paths that never \
    return left out; behind it, as a multiple of the largest counted step. Paths count whose conditions contradict each other. \
    in control: the same of periods that pass the supervisor's check: without start-up, calibration, pre-charge, trips, coasting, \
    braking and bridged Hall codes. Only for drives.\n\
    most cycles: an upper bound along both graphs, for the chip above: times of its core's manual, each instruction at its most; \
    wait states for every line fetched, without credit for prefetch and caches. Only for drives.\n\
    goal: normal / worst / stack of the best version found by editing the emitted text by hand, with the same supervisor.\n\
    code: bytes of the function, and of its callees. state: bytes of the drive's type. stack: bytes, maximum of all steps.\n\
    cycles: estimated for the normal path: load, store 2, of n words 1 + n, taken branch 3, all else 1.\n\
    Peers (step_f32_..., step_i16f16_..., step_foc, step_idsp) have no supervisor; their outputs are compared with the host, exactly (of step_foc, \
    the first 500 steps).";

/// Options of counting.
#[derive(Debug, clap::Args)]
pub struct Options {
    /// Only steps whose symbol contains this; without comparison with the expected figures
    #[arg(long)]
    pub only: Option<String>,
    /// Writes the counted figures as expected
    #[arg(long)]
    pub accept: bool,
}

impl Options {
    fn wants(&self, symbol: &str) -> bool {
        let part = self.only.as_ref();
        part.is_none_or(|part| symbol.contains(part.as_str()))
    }
}

/// One line of the table.
struct Row {
    symbol: String,
    counts: Counts,
    /// Only for drives.
    longest: Option<Longest>,
    code: Code,
    /// Bytes of tables; `None` for peers, whose tables have no names.
    tables: Option<usize>,
    state: Option<usize>,
    /// Only for drives in Rust.
    calibration: Option<Calibration>,
    /// Whether others are estimated from it: the experiment has the paper's errors in it.
    is_typical: bool,
}

/// What is run on a step function.
struct Run {
    inputs: Inputs,
    /// As in [`Row`].
    tables: Option<usize>,
    /// Of drives.
    calibration: Option<Calibration>,
}

impl Row {
    fn calibrated(&self) -> Option<Drive> {
        Some(Drive {
            symbol: self.symbol.clone(),
            calibration: self.calibration?,
            is_typical: self.is_typical,
            times: self.figures().times()?,
        })
    }

    fn figures(&self) -> Figures {
        Figures {
            normal: self.counts.normal,
            supervision: self.counts.supervision,
            worst: self.counts.worst,
            cycles: self.counts.cycles,
            code: self.code.own,
            stack: self.counts.stack,
            longest: self.longest,
        }
    }
}

/// Counts every drive of every target.
///
/// # Errors
/// If a tool is missing, or a figure rose.
pub fn run(targets: &[Target], options: &Options) -> Result<(), BenchError> {
    let mut rises = vec![];
    let mut calibrated = vec![];
    for &target in targets {
        let firmware = Firmware::build(target)?;
        let rows = rows(&firmware, options)?;
        let compiler = firmware.toolchain.version();
        let release = calibration::release(compiler);
        let (name, chip) = (target.name(), chip(target));
        let table = table(target, &rows);
        println!(
            "{name}, {compiler}; most cycles: {} at {} MHz, {}\n{table}",
            chip.name,
            chip.clock(),
            chip.assumed
        );
        let figures = figures(&rows);
        let over_budget = print_budgets(target, &figures);
        if !options.accept {
            rises.extend(over_budget);
        }
        let counted = calibration::Counted {
            target,
            compiler: release,
            drives: rows.iter().filter_map(Row::calibrated).collect(),
            in_c: calibration::in_c(&figures),
        };
        if options.only.is_none() && !options.accept {
            rises.extend(calibration::rises(&counted));
        }
        calibrated.push(counted);
        if options.accept {
            let compiler = compiler.to_owned();
            let mut steps = figures;
            if options.only.is_some() {
                // Figures that were not counted are kept.
                let known = Expected::read(target)?.0.steps;
                steps.extend(
                    known
                        .into_iter()
                        .filter(|(symbol, _)| !options.wants(symbol)),
                );
            }
            Expected(Counted { compiler, steps }).write(target)?;
        } else if options.only.is_none() {
            let found = Expected::read(target)?.rises(compiler, &figures, |symbol, figures| {
                goal(target, symbol).is_some_and(|goal| !goal.is_met(figures))
            });
            rises.extend(
                found
                    .into_iter()
                    .map(|rise| format!("{}: {rise}", target.name())),
            );
        }
    }
    if options.accept && options.only.is_none() && targets.len() == Target::ALL.len() {
        calibration::write(&calibrated)?;
    } else if options.accept {
        println!(
            "codegen/src/timing/figures.rs is as before: `cargo xtask cost --accept`, of all targets and steps, writes it"
        );
    }
    println!("{LEGEND}");
    if rises.is_empty() {
        return Ok(());
    }
    Err(BenchError::Failed(format!(
        "{}\naccept intended changes by `cargo xtask cost --accept`",
        rises.join("\n")
    )))
}

/// Prints what the blocks with a budget add; returns those that add more.
fn print_budgets(target: Target, figures: &BTreeMap<String, Figures>) -> Vec<String> {
    let mut over = vec![];
    for block in blocks(target) {
        let Some(added) = block.added(figures) else {
            continue;
        };
        let [with, without] = block.steps;
        let told = format!(
            "{}: {added} instructions on the normal path, {with} less {without}; budget {}",
            block.name, block.budget
        );
        println!("{told}");
        if added > block.budget {
            over.push(format!("{}: {told}", target.name()));
        }
    }
    over
}

fn rows(firmware: &Firmware, options: &Options) -> Result<Vec<Row>, BenchError> {
    let mut rows = vec![];
    let of_drive = |listed: &Listed| {
        let drive = drive_of(listed)?;
        Ok(Run {
            inputs: Inputs::record(&drive)?,
            tables: Some(tables(&drive)),
            calibration: Some(Calibration::of(&drive)),
        })
    };
    for program in PROGRAMS {
        rows.extend(rows_of(firmware, program, options, of_drive)?);
    }
    if firmware.target == Target::CortexM4 {
        let mut drives = firmware.drives(EXPERIMENT)?;
        for program in PROGRAMS {
            drives.extend(firmware.drives(program)?);
        }
        check_experiment(&drives)?;
        rows.extend(rows_of(firmware, EXPERIMENT, options, of_drive)?);
    }

    let paper = paper_drive(INTERRUPT_VARIANT)?;
    if options.wants(INTERRUPT) {
        let image = Image::read(&firmware.elf("interrupt"), isa(firmware.target))?;
        let inputs = Inputs::record_interrupt(&paper)?;
        let counts = count(firmware, "interrupt", &image, (0, INTERRUPT), &inputs, None)?;
        rows.push(Row {
            symbol: INTERRUPT.to_owned(),
            counts,
            longest: None,
            code: image.code(INTERRUPT)?,
            tables: None,
            state: None,
            calibration: None,
            is_typical: false,
        });
    }

    firmware.build_peers()?;
    let of_peer = |listed: &Listed| {
        let run = peers::run(&paper, &listed.symbol)?;
        run.compare(&Emulated(firmware, PEERS), listed)?;
        Ok(Run {
            inputs: run.inputs,
            tables: None,
            calibration: None,
        })
    };
    rows.extend(rows_of(firmware, PEERS, options, of_peer)?);
    Ok(rows)
}

fn isa(target: Target) -> Isa {
    match target {
        Target::CortexM4 | Target::CortexM0 => Isa::Thumb,
        Target::Riscv32 => Isa::RiscV,
    }
}

/// A drive of the paper's motor.
fn paper_drive(variant: &str) -> Result<Prepared, BenchError> {
    let paper = MotorSource::of_library(PAPER_MOTOR)
        .ok_or_else(|| BenchError::Motor(PAPER_MOTOR.to_owned()))?;
    prepare(&paper, Some(variant))
        .map_err(|errors| BenchError::Drive(variant.to_owned(), errors.to_string()))
}

/// The counted drives of the paper's experiment are those that `hexagen reproduce` runs.
fn check_experiment(drives: &[Listed]) -> Result<(), BenchError> {
    for (symbol, variant) in counted_drives() {
        let listed = drives.iter().find(|drive| drive.symbol == symbol);
        let listed = listed.ok_or_else(|| BenchError::Failed(format!("{symbol} is missing")))?;
        let run = paper_drive(variant)?;
        let counted = drive_of(listed)?;
        if run.spec != counted.spec {
            return Err(BenchError::Failed(format!(
                "{symbol} is not `{variant}`, which `hexagen reproduce` runs"
            )));
        }
    }
    Ok(())
}

/// Counts the drives of a program, each on its inputs, with the bytes of its tables.
fn rows_of(
    firmware: &Firmware,
    program: &str,
    options: &Options,
    run_of: impl Fn(&Listed) -> Result<Run, BenchError> + Sync,
) -> Result<Vec<Row>, BenchError> {
    let elf = firmware.elf(program);
    let image = Image::read(&elf, isa(firmware.target))?;
    let paths = (program != PEERS).then(|| Program::read(&elf, firmware.target, &image));
    let paths = paths.transpose()?;
    let mut steps = firmware.drives(program)?;
    steps.retain(|step| options.wants(&step.symbol));
    let row_of = |listed: &Listed| {
        let run = run_of(listed)?;
        let is_in_rust = IN_RUST.contains(&program);
        let symbol = listed.symbol.as_str();
        let step = (listed.place, symbol);
        let mut counts = count(firmware, program, &image, step, &run.inputs, paths.as_ref())?;
        if is_in_rust {
            counts.supervision = Some(supervision(firmware, program, listed.place, &run.inputs)?);
        }
        let longest = paths.as_ref().map(|paths| paths.longest(symbol));
        let longest = longest.transpose()?;
        if let Some(longest) = &longest {
            longest::check(symbol, longest, counts.largest())?;
        }
        Ok(Row {
            symbol: symbol.to_owned(),
            counts,
            longest,
            code: image.code(symbol)?,
            tables: run.tables,
            state: Some(listed.size),
            calibration: run.calibration.filter(|_| is_in_rust),
            is_typical: program != EXPERIMENT,
        })
    };
    steps.par_iter().map(row_of).collect()
}

/// Bytes of a drive's tables in flash: entries of the least width that fits their values.
fn tables(drive: &Prepared) -> usize {
    let tables = &drive.generated.graph.program().tables;
    let bytes = |values: &[i32]| {
        let fits = |bits: u32| {
            values
                .iter()
                .all(|value| *value >> (bits - 1) == *value >> 31)
        };
        let width = if fits(8) {
            1
        } else if fits(16) {
            2
        } else {
            4
        };
        width * values.len()
    };
    tables.iter().map(|table| bytes(&table.values)).sum()
}

fn figures(rows: &[Row]) -> BTreeMap<String, Figures> {
    rows.iter()
        .map(|row| (row.symbol.clone(), row.figures()))
        .collect()
}

fn table(target: Target, rows: &[Row]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header([
        "symbol",
        "normal",
        "supervision",
        "worst",
        "arbitrary",
        "longest",
        "",
        "in control",
        "most cycles",
        "goal",
        "",
        "cycles",
        "code",
        "called",
        "tables",
        "state",
        "stack",
    ]);
    let or_dash = |number: Option<usize>| number.map_or("-".to_owned(), |n| n.to_string());
    for row in rows {
        let counts = row.counts;
        let of_path = |text: &dyn Fn(Longest) -> String| row.longest.map_or("-".to_owned(), text);
        let (goal, verdict) = goal(target, &row.symbol).map_or((String::new(), ""), |goal| {
            let is_met = goal.is_met(&row.figures());
            (goal.to_string(), if is_met { "met" } else { "not met" })
        });
        table.add_row([
            row.symbol.clone(),
            counts.normal.to_string(),
            or_dash(counts.supervision.map(|count| count as usize)),
            counts.worst.to_string(),
            or_dash(counts.arbitrary.map(|most| most as usize)),
            of_path(&|longest| longest.instructions.to_string()),
            of_path(&|longest| {
                let ratio = f64::from(longest.instructions) / f64::from(counts.largest());
                format!("x {ratio:.2}")
            }),
            of_path(&|longest| longest.instructions_in_control.to_string()),
            of_path(&|longest| format!("{} / {}", longest.cycles, longest.cycles_in_control)),
            goal,
            verdict.to_owned(),
            counts.cycles.to_string(),
            row.code.own.to_string(),
            row.code.called.to_string(),
            or_dash(row.tables),
            or_dash(row.state),
            counts.stack.to_string(),
        ]);
    }
    for column in (1..10).chain(11..17) {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}
