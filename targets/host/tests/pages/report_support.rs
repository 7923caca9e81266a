//! Report data from real runs: a float64 deadbeat controller on the 660 W motor.
//!
//! The controller stands in for both models, so that the page has honest currents to show.

use hexagen::{LegState, Legs, Sample};
use hexagen_codegen::emit::datasheet::emit_datasheet;
use hexagen_codegen::emit::rust::{Surface, emit_rust, format_rust};
use hexagen_codegen::pipeline::generate;
use hexagen_codegen::spec::{Reference, Spec, apply_variant, check, parse_toml};

use hexagen_lab::closed_loop::{
    AnyCommand, CurrentLoop, Held, LimitOptions, RunOptions, measure, quasi_square, speed_limit,
};
use hexagen_lab::engine::{
    EngineKind, Model, MotorSource, PlantOptions, Prepared, SelectedMotor, prepare,
};
use hexagen_lab::envelope::TorqueBounds;
use hexagen_lab::judgement::Judgement;
use hexagen_lab::plant::{PlantParams, Truth};
use hexagen_lab::results::{
    Capture, DesignRow, ErrorsSeen, GeneratedTexts, Own, PAPER_MOTOR, Record, Results, Run,
    RunPoint, SameWords, SignalError, SpeedMark, Variant, Verification, design_table, links,
};
use hexagen_lab::robustness::{Cell, Column, DisturbedFigures, Heat, Outcome, Robustness};
use hexagen_lab::stability::{Parameter, Stability, StabilityCheck};
use std::f64::consts::{PI, TAU};

const R: f64 = 0.135;
const L: f64 = 0.22e-3;
const K_PHASE: f64 = 0.1648 / 2.0;
const V_BUS: f64 = 48.0;
const T_S: f64 = 50e-6;
const TORQUE: f64 = 3.3;
const CURRENT: f64 = TORQUE / 0.1648;
const SPEEDS: [f64; 2] = [400.0, 1500.0];

fn motor() -> PlantParams {
    PlantParams::ideal(4, R, L, K_PHASE, V_BUS, T_S)
}

/// What tells the variants apart.
#[derive(Clone, Copy)]
pub struct Options {
    /// Current in proportion to the EMF instead of the sector's corner.
    proportional: bool,
    /// Scale the voltage to the hexagon instead of clipping its legs.
    keep_angle: bool,
    /// Least step of the duties: 1/counts.
    counts: f64,
}

struct Deadbeat {
    options: Options,
    applied: [f64; 3],
}

/// The trapezoid with a flat top of 120 degrees.
fn shape(angle: f64) -> f64 {
    let x = angle.rem_euclid(TAU);
    let half = |x: f64| (x.min(PI - x) / (PI / 6.0)).min(1.0);
    if x < PI { half(x) } else { -half(x - PI) }
}

/// Shape of the three phases' EMF without its common mode.
fn shapes(theta: f64) -> [f64; 3] {
    let raw = [theta, theta - TAU / 3.0, theta + TAU / 3.0].map(shape);
    let zero = raw.iter().sum::<f64>() / 3.0;
    raw.map(|x| x - zero)
}

impl CurrentLoop for Deadbeat {
    fn step(&mut self, _: &Sample, truth: &Truth) -> AnyCommand {
        let (a, b) = (1.0 - R * T_S / L, T_S / L);
        let turn = truth.omega_e * T_S;
        let emf = |periods: f64| {
            shapes(truth.theta_e + periods * turn).map(|x| x * K_PHASE * truth.omega_m)
        };
        let (e_now, e_next) = (emf(0.5), emf(1.5));
        let i_ref = if self.options.proportional {
            let f = shapes(truth.theta_e + 2.0 * turn).map(|x| K_PHASE * x);
            let square: f64 = f.iter().map(|x| x * x).sum();
            f.map(|x| TORQUE * x / square)
        } else {
            let (alpha, beta) = quasi_square(truth.theta_e, CURRENT);
            let half = 3.0_f64.sqrt() / 2.0;
            [
                alpha,
                -alpha / 2.0 + half * beta,
                -alpha / 2.0 - half * beta,
            ]
        };
        let v: [f64; 3] = std::array::from_fn(|x| {
            (i_ref[x] - a * a * truth.currents[x]) / b - a * self.applied[x]
                + a * e_now[x]
                + e_next[x]
        });
        let most = v.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let least = v.iter().copied().fold(f64::INFINITY, f64::min);
        let scale = if self.options.keep_angle {
            (V_BUS / (most - least).max(1e-9)).min(1.0)
        } else {
            1.0
        };
        let counts = self.options.counts;
        let t = v.map(|x| {
            let wanted = (x - f64::midpoint(most, least)) * scale + V_BUS / 2.0;
            (wanted.clamp(0.0, V_BUS) / V_BUS * counts).round() / counts * V_BUS
        });
        let mean = t.iter().sum::<f64>() / 3.0;
        self.applied = t.map(|x| x - mean);
        Legs::new(
            t.map(|x| (x / V_BUS * 1800.0).round() as u16),
            [LegState::Pulsed; 3],
        )
        .into()
    }
}

fn run(options: Options, params: &PlantParams, rpm: f64) -> hexagen_lab::closed_loop::Measurement {
    let run = RunOptions {
        starts: vec![0.1],
        ..RunOptions::new(rpm * TAU / 60.0, CURRENT)
    };
    measure(params, &run, |_: &Truth| Deadbeat {
        options,
        applied: [0.0; 3],
    })
    .expect("the plant's parameters are sound")
}

fn generated(variant: &str) -> (Spec, GeneratedTexts, Stability) {
    let toml = include_str!("../../../motors/trivedi-keshri-660w.toml");
    let mut ast = parse_toml(toml, "motor.toml").expect("the motor parses");
    apply_variant(&mut ast, variant).expect("the variant parses");
    let (spec, origins) = check(&ast).expect("the specification is sound");
    let generated = generate(&spec, &origins).expect("the controller generates");
    let tokens = emit_rust(
        &generated.graph,
        &generated.interface,
        &Surface::public(&spec.name),
    );
    let data_sheet = emit_datasheet(&generated.graph, &generated.interface);
    let interface = generated.interface;
    let texts = GeneratedTexts {
        formats: interface.formats,
        rust: format_rust(&tokens),
        data_sheet,
        spec_toml: interface.spec_toml,
    };
    let stability = Stability {
        range: hexagen_codegen::laws::StableRange {
            inductance: (0.8, 1.25),
            resistance: (0.1, 10.0),
        },
        checks: Vec::new(),
    };
    (spec, texts, stability)
}

/// The rows that the controllers here come nearest to.
const NEAREST: &str = "PDCC three_phase, nearest, model EMF";
const PAIR: &str = "PDCC pair, keep_angle, model EMF";
const PROPORTIONAL: &str = "PDCC three_phase, nearest, proportional, model EMF";

/// The row of the design document's table that has a label.
fn row_of(label: &str) -> DesignRow {
    let mut rows = design_table().into_iter();
    rows.find(|row| row.label == label)
        .expect("the table has it")
}

fn variant(label: &str, row: &str, options: Options, with_texts: bool) -> Variant {
    let design = &row_of(row);
    let rough = Options {
        counts: 900.0,
        ..options
    };
    let mut records = Vec::new();
    let mut runs = Vec::new();
    let mut curve = Vec::new();
    for (model, options) in [(Model::Fixed, rough), (Model::Ideal, options)] {
        let mut points = Vec::new();
        for rpm in SPEEDS {
            let mut measured = run(options, &motor(), rpm);
            points.push(RunPoint {
                rpm,
                figures: measured.figures,
                tripped: measured.tripped,
            });
            if model == Model::Fixed {
                let trace = measured.traces.swap_remove(0);
                records.push(Record { rpm, trace });
            }
        }
        let limit = (model == Model::Fixed).then(|| {
            let run = RunOptions {
                starts: vec![0.1],
                ..RunOptions::new(1.0, CURRENT)
            };
            let grid = LimitOptions {
                from_rpm: 1200.0,
                held: Held::AtLeast,
                to_rpm: 2500.0,
                step_rpm: 100.0,
                ..LimitOptions::new(2000.0, TORQUE)
            };
            speed_limit(&motor(), &run, &grid, |_: &Truth| Deadbeat {
                options,
                applied: [0.0; 3],
            })
            .expect("the plant's parameters are sound")
        });
        if let Some(limit) = &limit {
            curve.clone_from(&limit.curve);
        }
        runs.push(Run {
            model,
            capture: Capture::Timer,
            points,
            limit,
            expected: (model == Model::Fixed).then(|| design.timer.clone()),
        });
    }
    let same_words = SPEEDS.iter().enumerate().map(|(k, &rpm)| SameWords {
        capture: Capture::Timer,
        rpm,
        fixed: runs[0].points[k].figures,
        ideal: runs[1].points[k].figures,
    });
    let same_words = same_words.collect();
    let (_, texts, mut stability) = generated(design.variant);
    if with_texts {
        for factor in [0.7, 0.9, 1.1, 1.4] {
            for (parameter, params) in [
                (Parameter::Inductance, motor().scaled(1.0, factor, 1.0)),
                (Parameter::Resistance, motor().scaled(factor, 1.0, 1.0)),
            ] {
                let figures = run(options, &params, 400.0).figures;
                stability.checks.push(StabilityCheck {
                    parameter,
                    factor,
                    rpm: 400.0,
                    ripple_rms_pct: figures.ripple_rms_pct,
                    stable: figures.ripple_rms_pct.is_some_and(|ripple| ripple < 5.0),
                });
            }
        }
    }
    Variant {
        label: label.to_owned(),
        variant: design.variant.to_owned(),
        chooses_vectors: false,
        runs,
        records,
        torque_speed: curve,
        reach: None,
        reference: if options.proportional {
            Reference::Proportional
        } else {
            Reference::QuasiSquare
        },
        set_point: CURRENT,
        same_words,
        signal_errors: vec![SignalError {
            signal: "duty".to_owned(),
            unit: "counts".to_owned(),
            largest: 1.0,
            rms: 0.29,
            bound: None,
        }],
        stability: Some(stability),
        generated: with_texts.then_some(texts),
    }
}

/// Errors of which most are small and a few reach three quarters of the bound.
fn errors(controller: &str, word: u32, bound_v: f64) -> ErrorsSeen {
    let count = |place: i32| match place.abs() {
        0..4 => 9_000 / (1 + place.unsigned_abs().pow(3)),
        4..23 => 5,
        _ => 0,
    };
    ErrorsSeen {
        controller: controller.to_owned(),
        word,
        snr_db: 136.0,
        largest_v: 0.74 * bound_v,
        bound_v,
        decisions_equal_pct: 99.9,
        counts: (-30..=30).map(|place| u64::from(count(place))).collect(),
    }
}

/// A sheet with every heat, every outcome, and what was refused.
fn robustness() -> Robustness {
    let disturbances = [
        "none",
        "R x 2",
        "L x 0.75",
        "dead time 1 us",
        "10-bit ADC, 200 mA off",
    ];
    let column = |controller: &str| {
        let cells = disturbances.iter().enumerate().flat_map(|(place, name)| {
            SPEEDS.map(|rpm| {
                let heat = Heat::ALL[place];
                let outcome = match (heat, rpm == SPEEDS[0]) {
                    (Heat::Broken, true) => Outcome::Trips,
                    (Heat::Broken, false) => Outcome::Oscillates,
                    _ => Outcome::Runs,
                };
                let is_refused = controller == "pdcc" && place == 3;
                let figures = DisturbedFigures {
                    engine: EngineKind::Compiled,
                    expected_torque_nm: TORQUE,
                    mean_torque_nm: Some(TORQUE - 0.1 * place as f64),
                    ripple_pp_pct: Some(12.0),
                    ripple_rms_pct: Some(2.5),
                    swing_voltage_pct: Some(1.0),
                    outcome,
                    tripped: None,
                    heat,
                };
                Cell {
                    disturbance: (*name).to_owned(),
                    rpm,
                    refused: is_refused.then(|| "the dead time is too long".to_owned()),
                    figures: (!is_refused).then_some(figures),
                }
            })
        });
        Column {
            controller: controller.to_owned(),
            refused: None,
            cells: cells.collect(),
        }
    };
    Robustness {
        speeds_rpm: SPEEDS.to_vec(),
        disturbances: disturbances.map(str::to_owned).to_vec(),
        controllers: vec![
            column("pdcc"),
            Column {
                controller: "phcc".to_owned(),
                refused: Some("one vector moves the current too far".to_owned()),
                cells: Vec::new(),
            },
            column("pi-pwm:bandwidth=1kHz,emf=model"),
        ],
    }
}

fn paper_motor() -> SelectedMotor {
    SelectedMotor::find(PAPER_MOTOR, &PlantOptions::default()).expect("is in the library")
}

/// Data of a page with three variants.
pub fn data() -> Results {
    let fine = Options {
        proportional: false,
        keep_angle: false,
        counts: 1800.0,
    };
    let keep_angle = Options {
        keep_angle: true,
        ..fine
    };
    let proportional = Options {
        proportional: true,
        ..fine
    };
    let (spec, ..) = generated(row_of(NEAREST).variant);
    let mark = |label: &str, percent: f64| SpeedMark {
        label: label.to_owned(),
        percent,
    };
    let variants = vec![
        variant("PDCC three_phase, nearest", NEAREST, fine, true),
        variant("PDCC three_phase, keep_angle", PAIR, keep_angle, false),
        variant(
            // As long as the longest name of the table, which breaks on a narrow screen.
            "PDCC three_phase, torque_priority, advance 2, estimated EMF",
            PROPORTIONAL,
            proportional,
            false,
        ),
    ];
    Results {
        generator: "hexagen 0.1.0".to_owned(),
        name: spec.name,
        file: "trivedi-keshri-660w".to_owned(),
        board: None,
        motor: spec.motor,
        inverter: spec.inverter,
        source: Some("M. S. Trivedi, R. K. Keshri, doi 10.1109/ACCESS.2020.2978695, Table 4 <text & \"quotes\">".to_owned()),
        torque: TORQUE,
        current: CURRENT,
        held: Held::AtLeast,
        speeds_rpm: SPEEDS.to_vec(),
        verification: Some(Verification {
            engine: "compiled".to_owned(),
            steps: 10_000_000,
            mismatches: 0,
        }),
        bounds: TorqueBounds {
            envelope: vec![(2000.0, 3.6), (2200.0, 3.29), (2400.0, 2.05)],
            any_profile: vec![(2000.0, 3.6), (2400.0, 3.47), (2600.0, 3.26)],
        },
        own: Some(Own {
            variant: 0,
            judgement: Judgement::of(&own_drive()).expect("runs"),
            times: own_drive().generated.interface.times,
        }),
        links: links(&paper_motor(), &variants[0].generated.as_ref().expect("is shown").rust),
        variants,
        errors: vec![errors("pdcc", 32, 9.4e-6), errors("phcc", 16, 0.24)],
        robustness: Some(robustness()),
        marks: vec![
            mark("PI-PWM (paper)", 67.0),
            mark("predictive (paper)", 85.0),
            mark("PDCC (paper)", 87.0),
            mark("bound at 20 A peak", 119.0),
        ],
        notes: vec!["A note.".to_owned()],
    }
}

/// Times of the default drive's step.
fn own_drive() -> Prepared {
    let motor = MotorSource::of_library("trivedi-keshri-660w").expect("a motor");
    prepare(&motor, Some("pdcc")).expect("a drive")
}
