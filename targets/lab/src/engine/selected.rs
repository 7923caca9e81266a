//! Motors with their plants: simulation may deviate from the motor's file.

use super::plant::shape_of;
use super::{MotorSource, Prepared, SetPoint, library, plant_of, prepare_ast, run_of};
use crate::LabError;
use crate::closed_loop::RunOptions;
use crate::plant::{Mechanics, PlantError, PlantParams};
use hexagen_codegen::diagnostics::Diagnostics;
use hexagen_codegen::diagnostics::catalogue::unreadable_board_file;
use hexagen_codegen::spec::{
    Board, EmfShape, Field, InverterSpec, SpecAst, apply_variant, motor_text, parse_board,
    parse_toml, reason_of,
};
use std::f64::consts::TAU;
use std::path::Path;

/// A value of every current sensor: one for all, or one of each in the order of the sensed phases.
#[derive(Clone, Debug, PartialEq)]
pub struct PerSensor(pub Vec<f64>);

impl PerSensor {
    /// The value of each of `count` sensors. `name`: of the quantity, for the error.
    ///
    /// # Errors
    /// Neither one value nor as many as there are sensors.
    pub fn of(&self, name: &'static str, count: usize) -> Result<Vec<f64>, PlantError> {
        match self.0[..] {
            [all] => Ok(vec![all; count]),
            _ if self.0.len() == count => Ok(self.0.clone()),
            _ => Err(PlantError::Sensors {
                name,
                given: self.0.len(),
                sensors: count,
            }),
        }
    }
}

/// Deviations of a simulated plant from the motor's file; none by default.
#[derive(Clone, Debug, Default)]
pub struct PlantOptions {
    /// The board, a name of the library or a file, of plant and controller alike: the specification changes.
    pub board: Option<String>,
    /// Dead time of the inverter's legs in seconds.
    pub dead_time: Option<f64>,
    /// Bits of the current ADCs, of plant and controller: the specification changes.
    pub adc_bits: Option<u32>,
    /// Range of the current ADCs with its unit, of plant and controller: the specification changes.
    pub adc_range: Option<String>,
    /// Zero error of the current ADCs in amperes, unknown to the controller.
    pub adc_offset: Option<PerSensor>,
    /// True over stated current per ADC count.
    pub scale_adc: Option<PerSensor>,
    /// Noise of the current ADCs in counts rms.
    pub adc_noise: Option<f64>,
    /// Time in seconds from the first current's sample to the second's.
    pub conversion_time: Option<f64>,
    /// True bus voltage in volts.
    pub v_bus: Option<f64>,
    /// True over stated resistance.
    pub scale_r: Option<f64>,
    /// True over stated inductance.
    pub scale_l: Option<f64>,
    /// True over stated EMF constant.
    pub scale_kb: Option<f64>,
    /// True shape of the EMF in place of the stated one, at the same peak between two terminals.
    pub emf_shape: Option<EmfShape>,
    /// Placement errors of the Hall sensors in electrical degrees; positive is late in forward
    /// rotation.
    pub hall_error: Option<[f64; 3]>,
    /// Inertia of rotor and load in kg m2: the speed is free.
    pub inertia: Option<f64>,
    /// Load torque in newton metres that opposes the motion of a free shaft.
    pub load: Option<f64>,
    /// Electrical angle at the start in radians: one run in place of three.
    pub start_angle: Option<f64>,
}

/// A motor with its specification, changed by the plant options.
#[derive(Clone, Debug)]
pub struct SelectedMotor {
    /// The motor.
    pub source: MotorSource,
    /// The syntax tree after the changes.
    pub ast: SpecAst,
}

impl SelectedMotor {
    /// Finds and reads a motor.
    ///
    /// # Errors
    /// If there is none, or its file is not TOML.
    pub fn find(given: &str, plant: &PlantOptions) -> Result<Self, LabError> {
        let source = MotorSource::find(given)?;
        Self::of(source, plant)
    }

    /// Every motor of the library.
    ///
    /// # Errors
    /// As [`Self::find`].
    pub fn library(plant: &PlantOptions) -> Result<Vec<Self>, LabError> {
        let all = library().iter().map(MotorSource::from);
        all.map(|source| Self::of(source, plant)).collect()
    }

    /// Reads a motor's text.
    ///
    /// # Errors
    /// If it is not TOML.
    pub fn of(source: MotorSource, plant: &PlantOptions) -> Result<Self, LabError> {
        let mut ast = parse_toml(&source.text, &source.file)?;
        match &plant.board {
            Some(board) => ast.put_on(board_of(board)?),
            None => ast.read_board(Path::new(""), &source.file, &mut vec![])?,
        }
        plant.change_specification(&mut ast)?;
        Ok(Self { source, ast })
    }

    /// The same motor on a board that leaves every leg free: current sensors in the phases, and legs
    /// that may be high all the time.
    ///
    /// # Errors
    /// None for a specification that can be read.
    pub fn without_window(&self) -> Result<Self, LabError> {
        const OF_WINDOW: [&str; 7] = [
            "current_sensing",
            "current_adcs",
            "settling_time",
            "aperture_time",
            "conversion_time",
            "sampling_lead",
            "minimum_low_time",
        ];
        let mut free = self.clone();
        let board = free
            .ast
            .board
            .as_mut()
            .and_then(|board| board.file.as_mut());
        let sections = board.map(|file| &mut file.inverter).into_iter();
        for section in sections.chain([&mut free.ast.inverter]) {
            let is_kept = |name: &str| !OF_WINDOW.contains(&name);
            section.fields.retain(|field| is_kept(&field.name));
        }
        let lines = "current_sensing = \"in_phase\"\nminimum_low_time = \"0 s\"";
        state_of_inverter(&mut free.ast, lines, "sensors in the phases")?;
        Ok(free)
    }

    /// Takes a variant through the generator; `None`: the controller of the motor's file.
    ///
    /// # Errors
    /// All diagnostics.
    pub fn prepare(&self, variant: Option<&str>) -> Result<Prepared, LabError> {
        Ok(prepare_ast(self.ast.clone(), &self.source.name, variant)?)
    }

    /// Values that no data sheet gives, of motor file and board, as `field value`.
    pub fn assumed(&self) -> Vec<String> {
        let SpecAst {
            motor, inverter, ..
        } = &self.ast;
        let own = motor.fields.iter().chain(&inverter.fields);
        let of_board = self
            .board_fields()
            .iter()
            .filter(|field| inverter.field(&field.name).is_none());
        let assumed = own.chain(of_board).filter(|field| field.assumed.is_some());
        let assumed = assumed.map(|field| format!("`{}` {}", field.name, field.value));
        let unstated = self.mounting_assumed().chain(self.sign_assumed());
        assumed.chain(unstated).collect()
    }

    /// The inverter's fields of the board.
    fn board_fields(&self) -> &[Field] {
        let board = self.ast.board.as_ref();
        let file = board.and_then(|board| board.file.as_ref());
        file.map_or(&[], |file| &file.inverter.fields)
    }

    /// The inverter's field, of the motor file or of its board.
    fn inverter_field(&self, name: &str) -> Option<&Field> {
        let own = self.ast.inverter.field(name);
        own.or_else(|| self.board_fields().iter().find(|field| field.name == name))
    }

    /// The sign of sensors in the low legs where nobody stated it: amplifiers of shunts are wired either way, and with
    /// the wrong sign the loop drives the current away from its set-point.
    fn sign_assumed(&self) -> Option<String> {
        let place = self.inverter_field("current_sensing")?;
        let is_low = place.value.to_string() == "low_side";
        let is_stated = self.inverter_field("adc_inverted").is_some();
        (is_low && !is_stated).then(|| "`adc_inverted` off".to_owned())
    }

    /// How an angle sensor sits on the shaft where nobody stated it: no data sheet tells that.
    fn mounting_assumed(&self) -> impl Iterator<Item = String> + '_ {
        const MOUNTING: [[&str; 2]; 2] =
            [["angle_offset", "0 deg"], ["angle_direction", "forward"]];
        let of_angle = MOUNTING.into_iter().filter(|_| self.has_angle());
        let missing = of_angle.filter(|[name, _]| self.ast.motor.field(name).is_none());
        missing.map(|[name, value]| format!("`{name}` {value}"))
    }

    /// Whether the motor has an angle sensor in place of Hall sensors.
    pub fn has_angle(&self) -> bool {
        let rotor = self.ast.motor.field("rotor");
        rotor.is_some_and(|field| field.value.to_string() == "angle")
    }

    /// Whether motor file or board states a timer that captures Hall edges.
    pub fn has_edge_timer(&self) -> bool {
        self.inverter_field("hall_timer_clock").is_some()
    }

    /// Like [`Self::prepare`], for commands with a torque set-point: of a drive with a speed loop its current loop,
    /// with the whole drive's stall time-out and warnings and the time of its step.
    ///
    /// # Errors
    /// All diagnostics.
    pub fn prepare_for_torque(&self, variant: Option<&str>) -> Result<Prepared, LabError> {
        self.without_speed_loop(self.prepare(variant)?, variant)
    }

    /// The current loop of a drive of this motor, as [`Self::prepare_for_torque`] gives it; `variant` is that of the drive.
    ///
    /// # Errors
    /// All diagnostics.
    pub fn without_speed_loop(
        &self,
        drive: Prepared,
        variant: Option<&str>,
    ) -> Result<Prepared, LabError> {
        const OF_SPEED: [&str; 3] = ["speed_loop", "speed_bandwidth", "acceleration_limit"];
        if drive.spec.controller.common().speed.is_none() {
            return Ok(drive);
        }
        let mut inner = self.ast.clone();
        if let Some(variant) = variant {
            apply_variant(&mut inner, variant)?;
        }
        let is_kept = |name: &str| !OF_SPEED.contains(&name);
        inner.controller.fields.retain(|field| is_kept(&field.name));
        // By default a stall is watched for with a speed loop only.
        let InverterSpec {
            stall_periods, t_s, ..
        } = drive.spec.inverter;
        let stall = f64::from(stall_periods) * t_s;
        let line = format!("stall_timeout = \"{stall} s\"");
        state_of_inverter(&mut inner, &line, "stall time-out of the speed loop")?;
        let mut current_loop = prepare_ast(inner, &self.source.name, None)?;
        current_loop.generated.interface.times = drive.generated.interface.times;
        current_loop.warnings = drive.warnings;
        current_loop.left_out = drive.spec.controller.common().speed;
        Ok(current_loop)
    }
}

/// States fields of the inverter over those of a specification; `why` names them in messages.
fn state_of_inverter(ast: &mut SpecAst, lines: &str, why: &str) -> Result<(), LabError> {
    let mut over = parse_toml(&format!("[inverter]\n{lines}\n"), why)?;
    over.name = ast.name.clone();
    over.inverter.location = None;
    ast.overlay(over);
    Ok(())
}

/// The board of a name of the library, or else of a path.
fn board_of(given: &str) -> Result<Board, LabError> {
    let mut board = Board::named(given.into())?;
    if board.file.is_none() {
        let bytes = std::fs::read(given).map_err(|error| {
            let reason = reason_of(&error);
            Diagnostics::from(unreadable_board_file(&board.name.location, given, &reason))
        })?;
        board.file = Some(parse_board(&motor_text(bytes, given)?, given)?);
    }
    Ok(board)
}

impl PlantOptions {
    /// Nothing changed, but for a board in place of the motor file's if one is given.
    pub fn on_board(board: Option<&str>) -> Self {
        Self {
            board: board.map(str::to_owned),
            ..Self::default()
        }
    }

    /// ADC bits and range apply to the controller, too: they override the specification.
    fn change_specification(&self, ast: &mut SpecAst) -> Result<(), LabError> {
        let bits = self.adc_bits.map(|bits| format!("adc_bits = {bits}"));
        let range = self
            .adc_range
            .as_ref()
            .map(|range| format!("adc_range = \"{range}\""));
        let lines: Vec<String> = bits.into_iter().chain(range).collect();
        if lines.is_empty() {
            return Ok(());
        }
        // An offset is a count of the previous bits; the middle of the new range replaces it.
        ast.inverter
            .fields
            .retain(|field| field.name != "adc_offset");
        let mut over = parse_toml(
            &format!("[inverter]\n{}", lines.join("\n")),
            "ADC bits and range",
        )?;
        over.name = ast.name.clone();
        over.inverter.location = None;
        ast.overlay(over);
        Ok(())
    }

    /// The plant of a drive.
    ///
    /// # Errors
    /// An option out of range.
    pub fn plant(&self, drive: &Prepared) -> Result<PlantParams, PlantError> {
        let mut plant = plant_of(&drive.spec).scaled(
            self.scale_r.unwrap_or(1.0),
            self.scale_l.unwrap_or(1.0),
            self.scale_kb.unwrap_or(1.0),
        );
        if let Some(shape) = self.emf_shape {
            let stated = drive.spec.motor.emf_shape.line_to_line_peak();
            let by = stated / shape.line_to_line_peak();
            plant.k_phase = plant.k_phase.map(|constant| constant * by);
            plant.shape = shape_of(shape);
        }
        plant.dead_time = self.dead_time.unwrap_or(plant.dead_time);
        plant.v_bus = self.v_bus.unwrap_or(plant.v_bus);
        let count = plant.adc.len();
        if let Some(offset) = &self.adc_offset {
            for (channel, error) in plant.adc.iter_mut().zip(offset.of("adc offset", count)?) {
                channel.offset += error / channel.amperes_per_count;
            }
        }
        if let Some(scale) = &self.scale_adc {
            plant.scale_adc(&scale.of("adc scale", count)?);
        }
        for channel in &mut plant.adc {
            channel.noise = self.adc_noise.unwrap_or(channel.noise);
        }
        if let Some(time) = self.conversion_time {
            let first = plant.adc[0].instant;
            for (channel, place) in plant.adc.iter_mut().zip(0_u8..) {
                channel.instant = first + f64::from(place) * time;
            }
        }
        plant.hall_error_deg = self.hall_error.unwrap_or(plant.hall_error_deg);
        if let (Some(sensor), Some([error, ..])) = (&mut plant.angle, self.hall_error) {
            sensor.offset_deg += error;
        }
        plant.mechanics = self.inertia.map(|inertia| Mechanics {
            inertia,
            opposing_torque: self.load.unwrap_or(0.0),
            external_torque: 0.0,
            viscous: 0.0,
        });
        plant.check()?;
        Ok(plant)
    }

    /// The run of a drive at a mechanical speed in rpm and a torque in newton metres.
    pub fn run(&self, drive: &Prepared, rpm: f64, torque: f64) -> RunOptions {
        let mut run = run_of(&drive.spec, rpm * TAU / 60.0, torque);
        if let Some(start) = self.start_angle {
            run.starts = vec![start];
        }
        run
    }

    /// The drive's set-point for a torque in newton metres.
    pub fn set_point(&self, drive: &Prepared, torque: f64) -> SetPoint {
        SetPoint {
            current: torque / drive.spec.torque_constant(),
            v_bus: self.v_bus.unwrap_or(drive.spec.inverter.v_bus),
            rpm: None,
        }
    }
}
