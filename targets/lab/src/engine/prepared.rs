//! A drive taken through the generator, with its models.

use super::{
    AnyDrive, AnySubject, BuiltIn, Engine, EngineKind, Model, MotorSource, ToldBus, Verifier,
    built_in, plant_of, reach_of, run_of,
};
use crate::closed_loop::{Measurement, measure};
use crate::plant::{PlantError, PlantParams, Truth};
use crate::{Interpreted, formats, state_names};
use hexagen::Format;
use hexagen_codegen::diagnostics::Diagnostics;
use hexagen_codegen::emit::datasheet::emit_datasheet;
use hexagen_codegen::emit::rust::{Surface, emit_rust, readable_rust};
use hexagen_codegen::pipeline::{Generated, generate, warning_in_c, warnings};
use hexagen_codegen::spec::{
    BusSource, Spec, SpecAst, SpeedLoop, TARGET, apply_variant, check, parse_toml, variant_of,
};
use hexagen_reference::{BitTrue, Error, FormatTable, Ideal};
use std::path::Path;

/// One drive: specification, generated program and reference models at rest.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// Short name of the motor.
    pub motor: String,
    /// The controller with its written options, from the variant or the motor's file.
    pub variant: String,
    /// The checked specification.
    pub spec: Spec,
    /// Lowest bus voltage of the whole torque, volt, where the motor's file states a `bus_min` of its own.
    pub least_bus: Option<f64>,
    /// The stated `over_speed` or, without one, the stated `maximum_speed`, with its name, rad/s.
    pub highest_speed: Option<(&'static str, f64)>,
    /// Limits of a measured bus that the motor's file does not state, but its board or the default.
    pub limits_of_others: Vec<&'static str>,
    /// Speed loop of the drive, which was left out to set its torque.
    pub left_out: Option<SpeedLoop>,
    /// The generated program.
    pub generated: Generated,
    /// What the board's file says of the core that it states, where the controller names none itself.
    pub core_of_board: Option<String>,
    /// The generator's warnings.
    pub warnings: Vec<String>,
    /// The generator's warning of a step that is too long in C only.
    pub warning_in_c: Option<String>,
    /// The specification as read by the reference.
    pub reference: hexagen_reference::Spec,
    /// Formats in the types of the runtime.
    pub formats: Vec<Format>,
    /// The emitted source text's `[source]` fields, for data sheets.
    pub source: Vec<(String, String)>,
    bit_true: BitTrue,
    ideal: Ideal,
    built_in: Option<&'static BuiltIn>,
}

/// Set-point and measured bus voltage of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetPoint {
    /// Current in amperes, with the torque's sign.
    pub current: f64,
    /// True bus voltage in volts, for drives that measure it.
    pub v_bus: f64,
    /// Speed in rpm, for drives with a speed loop; the current is then its limit.
    pub rpm: Option<f64>,
}

/// Takes a motor and a variant (`None`: the controller of the motor's file) through the generator.
///
/// # Errors
/// All diagnostics of specification, design and scaling.
pub fn prepare(motor: &MotorSource, variant: Option<&str>) -> Result<Prepared, Diagnostics> {
    let mut ast = parse_toml(&motor.text, &motor.file)?;
    ast.read_board(Path::new(""), &motor.file, &mut vec![])?;
    prepare_ast(ast, &motor.name, variant)
}

/// Like [`prepare`], from a syntax tree.
///
/// # Errors
/// As [`prepare`].
pub fn prepare_ast(
    mut ast: SpecAst,
    motor: &str,
    variant: Option<&str>,
) -> Result<Prepared, Diagnostics> {
    if let Some(variant) = variant {
        apply_variant(&mut ast, variant)?;
    }
    let (spec, origins) = check(&ast)?;
    let generated = generate(&spec, &origins)?;
    let warnings = warnings(&spec, &origins, &generated.interface.times);
    let warning_in_c = warning_in_c(&origins, &generated.interface.times);
    let warning_in_c = warning_in_c.map(|warning| warning.to_string());
    let formats = formats(&generated.interface.formats);
    let models = models(&generated.interface.spec_toml, &formats);
    let (reference, bit_true, ideal) = models.map_err(|error| {
        // Both read the same normalised text: a disagreement is a bug.
        let at = origins.at("controller.kind");
        hexagen_codegen::diagnostics::catalogue::internal(at, &error.to_string())
    })?;
    Ok(Prepared {
        motor: motor.to_owned(),
        variant: variant_of(&ast),
        built_in: built_in(&generated.interface.spec_toml),
        least_bus: (ast.inverter.field("bus_min").is_some())
            .then(|| spec.inverter.lowest_driving_bus())
            .filter(|least| *least < spec.inverter.v_bus),
        highest_speed: highest_speed(&ast, &spec),
        limits_of_others: limits_of_others(&ast, &spec),
        left_out: None,
        core_of_board: core_of_board(&ast),
        spec,
        generated,
        warnings: warnings.iter().map(ToString::to_string).collect(),
        warning_in_c,
        reference,
        formats,
        source: ast.source,
        bit_true,
        ideal,
    })
}

/// A mechanical speed of rad/s in rpm.
fn rpm(omega_m: f64) -> f64 {
    omega_m * 30.0 / std::f64::consts::PI
}

/// The speed that a file lets its rotor reach, where it states one.
fn highest_speed(ast: &SpecAst, spec: &Spec) -> Option<(&'static str, f64)> {
    let over = spec.inverter.over_speed;
    let over = over.map(|speed| ("over_speed", speed));
    let is_stated = ast.inverter.field("maximum_speed").is_some();
    let maximum = is_stated.then_some(("maximum_speed", spec.inverter.maximum_speed));
    over.or(maximum)
}

/// Limits of a measured bus that the file itself does not state.
fn limits_of_others(ast: &SpecAst, spec: &Spec) -> Vec<&'static str> {
    let stated = [["bus_min", "under_voltage"], ["bus_max", "over_voltage"]];
    let is_measured = matches!(spec.inverter.bus, BusSource::Measured { .. });
    let others = stated.into_iter().filter(|names| {
        let own = |name: &&str| ast.inverter.field(name).is_some();
        is_measured && !names.iter().any(own)
    });
    others.map(|[limit, _]| limit).collect()
}

fn core_of_board(ast: &SpecAst) -> Option<String> {
    let names_core = ast.controller.field(TARGET).is_some();
    let file = ast.board.as_ref()?.file.as_ref()?;
    let told = file.source_of(TARGET)?;
    (!names_core).then(|| told.to_owned())
}

fn models(
    spec: &str,
    formats: &[Format],
) -> Result<(hexagen_reference::Spec, BitTrue, Ideal), Error> {
    let spec = hexagen_reference::Spec::from_toml(spec)?;
    let bit_true = BitTrue::new(&spec, &FormatTable::new(formats))?;
    let ideal = Ideal::new(&spec)?;
    Ok((spec, bit_true, ideal))
}

impl Prepared {
    /// Engine of the fixed-point program.
    pub fn engine_kind(&self) -> EngineKind {
        if self.built_in.is_some() {
            EngineKind::Compiled
        } else {
            EngineKind::Interpreter
        }
    }

    /// Emitted code in its initial state, if this drive is compiled in.
    pub fn compiled(&self) -> Option<AnySubject<'static>> {
        self.built_in.map(|drive| AnySubject((drive.new)()))
    }

    /// The interpreted program in its initial state.
    pub fn interpreted(&self) -> Interpreted<'_> {
        Interpreted::new(self.generated.graph.program(), &self.generated.interface)
    }

    /// The bit-true model in its initial state.
    pub fn bit_true(&self) -> BitTrue {
        self.bit_true.clone()
    }

    /// The ideal model in its initial state.
    pub fn ideal(&self) -> Ideal {
        self.ideal.clone()
    }

    /// A controller with its set-point.
    pub fn engine(&self, model: Model, set_point: SetPoint) -> Engine<'_> {
        let drive = match model {
            Model::Fixed => AnyDrive::Fixed(match self.compiled() {
                Some(drive) => drive,
                None => AnySubject(Box::new(self.interpreted())),
            }),
            Model::BitTrue => AnyDrive::BitTrue(Box::new(self.bit_true())),
            Model::Ideal => AnyDrive::Ideal(Box::new(self.ideal())),
        };
        let counts = self.bus_counts(set_point.v_bus);
        let fresh = self.generated.interface.bus_periods;
        let mut engine = Engine {
            drive,
            bus: counts.zip(fresh).map(|(counts, fresh)| ToldBus {
                counts,
                // Twice before it is old.
                every: (fresh.unsigned_abs() / 2).max(1),
                left: 0,
                is_told: true,
            }),
        };
        engine.set_current(set_point.current);
        if let Some(rpm) = set_point.rpm {
            engine.set_speed(rpm);
        }
        engine
    }

    /// ADC count of a measured bus at a voltage; `None` if the bus is not measured.
    pub fn bus_counts(&self, v_bus: f64) -> Option<u16> {
        match self.spec.inverter.bus {
            BusSource::Fixed => None,
            BusSource::Measured { gain, adc_bits, .. } => {
                let full = f64::from((1_u32 << adc_bits) - 1);
                Some((v_bus / gain).round().clamp(0.0, full) as u16)
            }
        }
    }

    /// The bit-true and the ideal model with a set-point, that of the bit-true model's word.
    pub fn references(&self, set_point: SetPoint) -> (BitTrue, Ideal) {
        let (mut bit_true, mut ideal) = (self.bit_true(), self.ideal());
        if let Some(counts) = self.bus_counts(set_point.v_bus) {
            bit_true.set_bus(counts);
            ideal.set_bus(counts);
        }
        let bits = (set_point.current * f64::from(1 << 16)).round() as i32;
        bit_true.set_current(bits);
        ideal.set_current_amps(bit_true.set_point_amps());
        (bit_true, ideal)
    }

    /// A constructor of controllers for measurements in closed loop, called with the plant's
    /// initial state.
    pub fn maker<'g>(
        &'g self,
        model: Model,
        set_point: SetPoint,
    ) -> impl Fn(&Truth) -> Engine<'g> + Sync {
        move |_| self.engine(model, set_point)
    }

    /// Names of the state words.
    pub fn state_names(&self) -> Vec<&str> {
        state_names(self.generated.graph.program())
    }

    /// The bit-for-bit test of this drive.
    pub fn verifier(&self) -> Verifier<'_> {
        Verifier::new(self)
    }

    /// The emitted Rust module.
    pub fn rust(&self) -> String {
        let Generated {
            graph, interface, ..
        } = &self.generated;
        readable_rust(&emit_rust(
            graph,
            interface,
            &Surface::public(&interface.type_name),
        ))
    }

    /// The data sheet, in Markdown.
    pub fn data_sheet(&self) -> String {
        emit_datasheet(&self.generated.graph, &self.generated.interface)
    }

    /// Rated torque in newton metres: as specified, else that of the rated current.
    pub fn rated_torque(&self) -> f64 {
        self.spec.motor.torque_rating()
    }

    /// The set-point of a torque in newton metres, at the nominal bus.
    pub fn set_point(&self, torque: f64) -> SetPoint {
        SetPoint {
            current: torque / self.spec.torque_constant(),
            v_bus: self.spec.inverter.v_bus,
            rpm: None,
        }
    }

    /// Largest torque in newton metres that the set-point limit allows.
    pub fn reach(&self) -> f64 {
        reach_of(&self.spec)
    }

    /// The default torque of measurements in newton metres: the rated one, clamped to the set-point
    /// limit.
    pub fn demand(&self) -> f64 {
        self.rated_torque().min(self.reach())
    }

    /// The fixed-point program on the plant of its motor's file, at a mechanical speed in rad/s and a
    /// torque in newton metres.
    ///
    /// # Errors
    /// A plant parameter out of range.
    pub fn measure_at(&self, omega_m: f64, torque: f64) -> Result<Measurement, PlantError> {
        self.measure_on_bus(omega_m, torque, self.spec.inverter.v_bus)
    }

    /// The same with another true bus voltage.
    ///
    /// # Errors
    /// A plant parameter out of range.
    pub fn measure_on_bus(
        &self,
        omega_m: f64,
        torque: f64,
        v_bus: f64,
    ) -> Result<Measurement, PlantError> {
        let run = run_of(&self.spec, omega_m, torque);
        let set_point = SetPoint {
            v_bus,
            ..self.set_point(torque)
        };
        let plant = PlantParams {
            v_bus,
            ..plant_of(&self.spec)
        };
        measure(&plant, &run, self.maker(Model::Fixed, set_point))
    }

    /// Rated speed in rpm.
    pub fn rated_rpm(&self) -> f64 {
        rpm(self.spec.motor.rated_speed)
    }

    /// Greatest speed that the drive follows, rpm.
    pub fn maximum_rpm(&self) -> f64 {
        rpm(self.spec.inverter.maximum_speed)
    }

    /// Least speed that Hall edges tell, rpm.
    pub fn minimum_rpm(&self) -> f64 {
        rpm(self.spec.inverter.minimum_speed)
    }

    /// The compiled drive, if this one is built in.
    pub(super) fn built_in(&self) -> Option<&'static BuiltIn> {
        self.built_in
    }
}
