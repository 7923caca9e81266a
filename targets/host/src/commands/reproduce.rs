//! `hexagen reproduce`: the paper's experiment, its claims and a page with its figures.
//!
//! Both readings of each controller are generated drives in closed loop on the paper's motor.

use super::report::{FOLDER, PAPER_MOTOR};
use crate::cli::{Failure, PlantArguments, SelectedMotor, TextTable, bar, print_text, significant};
use crate::report;
use crate::report::reproduction::{
    self, BothReadings, CLOCK_HZ, Method, Point, Reading, Reproduction, Run, SwitchingTables,
    TIMES_TEXT, distance_rms,
};
use clap::Args;
use hexagen_codegen::interface::PublicValue;
use hexagen_lab::READINGS;
use hexagen_lab::closed_loop::{
    Delay, Held, LimitOptions, RunOptions, STARTS, mean_torque, measure, speed_limit_knowing,
};
use hexagen_lab::counted::{Counted, Figures as StepCost};
use hexagen_lab::engine::{Model, Prepared, SetPoint, plant_of, run_of};
use hexagen_lab::plant::PlantParams;
use indicatif::ProgressBar;
use rayon::prelude::*;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// The two speeds in rpm.
const SPEEDS: [f64; 2] = [400.0, 1500.0];

/// The demanded torque in newton metres.
const TORQUE: f64 = 3.3;

/// Options of `reproduce`.
#[derive(Args, Clone, Debug, Default)]
pub struct Options {
    /// Folder of the page [default: target/hexagen]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// How much is run.
#[derive(Clone, Debug, PartialEq)]
pub struct Effort {
    /// Electrical start angles in radians.
    pub starts: Vec<f64>,
    /// Speeds of the torque-speed curves in rpm, ascending.
    pub curve_rpm: Vec<f64>,
    /// First speed and step of the search for the limit in rpm.
    pub limit_rpm: (f64, f64),
}

impl Effort {
    /// All three starts, curves from 10 to 130 % of rated speed, limits in steps of 20 rpm.
    pub fn full() -> Self {
        Self {
            starts: STARTS.to_vec(),
            curve_rpm: (2..=26).map(|k| 100.0 * f64::from(k)).collect(),
            limit_rpm: (400.0, 20.0),
        }
    }
}

/// Symbol of the step function that `cargo xtask cost` counts for each reading of each method, and its variant; in the
/// order of [`READINGS`], literal before corrected.
pub fn counted_readings() -> impl Iterator<Item = (String, &'static str)> {
    let methods = Method::ALL.into_iter().zip(READINGS);
    methods.flat_map(|(method, readings)| {
        let controller = method.name().to_lowercase().replace('-', "_");
        Reading::ALL.map(|reading| {
            let variant = match reading {
                Reading::Literal => readings.literal,
                Reading::Corrected => readings.corrected,
            };
            let symbol = format!("step_trivedi_keshri_660w_{controller}_{}", reading.name());
            (symbol, variant)
        })
    })
}

/// Runs everything. A folder that the page is meant for is tried before the long work.
///
/// # Errors
/// Diagnostics of a drive, a plant parameter out of range, or a folder that cannot be written into.
pub fn collect(effort: &Effort, folder: Option<&Path>) -> Result<Reproduction, Failure> {
    if let Some(folder) = folder {
        report::prepare_folder(folder)?;
    }
    let motor = SelectedMotor::find(PAPER_MOTOR, &PlantArguments::default())?;
    let drives = counted_readings()
        .map(|(_, variant)| motor.prepare(Some(variant)))
        .collect::<Result<Vec<_>, _>>()?;
    let per_drive = SPEEDS.len() + effort.curve_rpm.len() + 1;
    let progress = bar((per_drive * drives.len()) as u64, "simulating");
    let counted = Counted::on_cortex_m4()?;
    let costs = counted_readings()
        .map(|(symbol, _)| counted.of_step(&symbol))
        .collect::<Result<Vec<_>, _>>()?;
    let runs = drives
        .par_iter()
        .zip(costs)
        .map(|(drive, cost)| Bench::of(drive, effort, cost).run(&progress))
        .collect::<Result<Vec<_>, Failure>>();
    progress.finish_and_clear();
    let mut runs = runs?.into_iter();
    let [Some(fcs_mpc), Some(pdcc), Some(phcc), Some(pi_pwm)] = [(); 4].map(|()| {
        Some(BothReadings {
            literal: runs.next()?,
            corrected: runs.next()?,
        })
    }) else {
        return Err(Failure::Argument("not every reading ran".to_owned()));
    };
    let phcc_drives = &drives[2 * Method::Phcc.index()..];
    let spec = &drives[0].spec;
    Ok(Reproduction {
        generator: format!("hexagen {}", env!("CARGO_PKG_VERSION")),
        motor: spec.motor.clone(),
        inverter: spec.inverter.clone(),
        torque: TORQUE,
        current: TORQUE / spec.torque_constant(),
        speeds_rpm: SPEEDS,
        methods: [fcs_mpc, pdcc, phcc, pi_pwm],
        tables: SwitchingTables {
            printed: forward_rows(&phcc_drives[0]),
            derived: forward_rows(&phcc_drives[1]),
        },
    })
}

/// The forward motoring rows of a drive's switching table; zeros for a drive that has none.
fn forward_rows(drive: &Prepared) -> [[u8; 8]; 6] {
    let constants = &drive.generated.interface.constants;
    let table = constants.iter().find_map(|constant| match &constant.value {
        PublicValue::Integers { values, .. } if constant.name == "SWITCHING_TABLE" => Some(values),
        _ => None,
    });
    // Eight entries per sector; the first eight are those of an unknown sector.
    std::array::from_fn(|k| {
        std::array::from_fn(|entry| {
            let value = table.and_then(|table| table.get(8 * (k + 1) + entry));
            value.map_or(0, |&value| value as u8)
        })
    })
}

/// A drive on its plant.
struct Bench<'p> {
    drive: &'p Prepared,
    effort: &'p Effort,
    plant: PlantParams,
    set_point: SetPoint,
    cost: StepCost,
}

impl<'p> Bench<'p> {
    fn of(drive: &'p Prepared, effort: &'p Effort, cost: StepCost) -> Self {
        Self {
            drive,
            effort,
            plant: plant_of(&drive.spec),
            set_point: drive.set_point(TORQUE),
            cost,
        }
    }

    /// The rig computes a command in one period and applies it in the next, whatever delay the
    /// drive reckons with.
    fn at(&self, rpm: f64) -> RunOptions {
        RunOptions {
            delay: Delay::OnePeriod,
            starts: self.effort.starts.clone(),
            ..run_of(&self.drive.spec, rpm * TAU / 60.0, TORQUE)
        }
    }

    fn run(&self, progress: &ProgressBar) -> Result<Run, Failure> {
        let (drive, effort) = (self.drive, self.effort);
        let [low, high] = SPEEDS.map(|rpm| {
            let point = self.point(rpm);
            progress.inc(1);
            point
        });
        let points = [low?, high?];
        let maker = || drive.maker(Model::Fixed, self.set_point);
        let known = |rpm: f64| points.iter().find(|point| point.rpm == rpm);
        let curve = effort
            .curve_rpm
            .par_iter()
            .map(|&rpm| {
                let torque = match known(rpm) {
                    Some(point) => point.figures.mean_torque_nm,
                    None => mean_torque(&self.plant, &self.at(rpm), &maker())?.ok(),
                };
                progress.inc(1);
                Ok(torque.map(|torque| (rpm, torque)))
            })
            .collect::<Result<Vec<_>, Failure>>()?;
        // A drive that tripped has no torque there.
        let mut curve: Vec<(f64, f64)> = curve.into_iter().flatten().collect();
        let (from_rpm, step_rpm) = effort.limit_rpm;
        // The paper asks where the torque falls off: more than the demand counts as held.
        let scan = LimitOptions {
            held: Held::AtLeast,
            from_rpm,
            step_rpm,
            ..LimitOptions::new(drive.rated_rpm(), TORQUE)
        };
        let limit = speed_limit_knowing(&self.plant, &self.at(1.0), &scan, &curve, maker())?;
        progress.inc(1);
        // The search's speeds lie closer: with them the limit lies on the curve.
        curve.extend_from_slice(&limit.curve);
        curve.sort_by(|a, b| a.0.total_cmp(&b.0));
        curve.dedup_by(|a, b| (a.0 - b.0).abs() < 1e-6);
        Ok(Run {
            variant: drive.variant.clone(),
            engine: drive.engine_kind().name(),
            points,
            curve,
            limit,
            cost: self.cost,
        })
    }

    fn point(&self, rpm: f64) -> Result<Point, Failure> {
        let run = self.at(rpm);
        let maker = self.drive.maker(Model::Fixed, self.set_point);
        let measured = measure(&self.plant, &run, maker)?;
        let distances = measured.traces.iter();
        let distance: f64 = distances
            .map(|trace| distance_rms(trace, run.current))
            .sum();
        let hexagon_rms_a = distance / measured.traces.len() as f64;
        let Some(trace) = measured.traces.into_iter().next() else {
            return Err(Failure::Argument("a run needs a start".to_owned()));
        };
        Ok(Point {
            rpm,
            figures: measured.figures,
            hexagon_rms_a,
            trace,
            trip: measured.tripped,
        })
    }
}

/// Runs the command.
///
/// # Errors
/// As [`collect`], or a page that cannot be written.
pub fn run(options: &Options) -> Result<(), Failure> {
    let folder = options.out.clone().unwrap_or_else(|| PathBuf::from(FOLDER));
    let data = collect(&Effort::full(), Some(&folder))?;
    print_text(&summary(&data))?;
    let page = reproduction::write(&data, &folder)?;
    print_text(&format!("Page: {}", page.display()))
}

/// The claims and Table 5, as text.
pub fn summary(data: &Reproduction) -> String {
    let head = format!(
        "{}: {} Nm, {} V bus, Ts {} us, {}-bit ADC; figures are FCS-MPC / PDCC / PHCC / PI-PWM",
        data.motor.description,
        significant(data.torque, 3),
        significant(data.inverter.v_bus, 3),
        significant(data.inverter.t_s * 1e6, 3),
        data.inverter.adc_bits
    );
    let claims = data.claims();
    let header = ["claim", "literal reading", "corrected reading", "verdict"];
    let mut table = TextTable::new(4, header);
    for claim in &claims {
        let [literal, corrected] = claim.figures.clone();
        table.row([
            format!("({}) {}", claim.letter, claim.text),
            literal.replace("; ", "\n"),
            corrected.replace("; ", "\n"),
            claim.verdict().text().to_owned(),
        ]);
    }
    let reasons = claims
        .iter()
        .map(|claim| format!("({}) {}", claim.letter, claim.reason()));
    let parts = [table.wrapped(0, 48).render()].into_iter().chain(reasons);
    let parts: Vec<String> = [head].into_iter().chain(parts).collect();
    format!("{}\n\n{}", parts.join("\n"), table_5(data))
}

/// Table 5 and what its times are reckoned from.
fn table_5(data: &Reproduction) -> String {
    let [low, high] = data.speeds_rpm;
    let mut table = TextTable::new(
        2,
        [
            "method".to_owned(),
            "reading".to_owned(),
            "instructions".to_owned(),
            "worst".to_owned(),
            "T_c us".to_owned(),
            "worst".to_owned(),
            "T_f us".to_owned(),
            format!("f_sw kHz, {low:.0} rpm"),
            format!("{high:.0} rpm"),
        ],
    );
    for method in Method::ALL {
        for reading in Reading::ALL {
            let run = data.methods[method.index()].of(reading);
            let times = run.times(data.inverter.t_s);
            let microseconds = |time: f64| format!("{:.1}", 1e6 * time);
            let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
            let switching = run.points.iter().map(|point| {
                let kilohertz = point.figures.switching_hz.map(|hertz| hertz / 1e3);
                or_dash(kilohertz.map(|figure| format!("{figure:.1}")))
            });
            let cells = [
                method.name().to_owned(),
                reading.name().to_owned(),
                or_dash(run.usual_instructions().map(|count| count.to_string())),
                run.cost.worst.to_string(),
                or_dash(times.usual.map(microseconds)),
                microseconds(times.worst),
                microseconds(times.free),
            ];
            table.row(cells.into_iter().chain(switching));
        }
    }
    format!("{}\n{TIMES_TEXT}; {} MHz.", table.render(), CLOCK_HZ / 1e6)
}
