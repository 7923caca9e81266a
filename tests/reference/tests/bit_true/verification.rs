//! The bit-for-bit test passes for the model itself, has the documented coverage, and detects one
//! bit.

use crate::variants::{self, Variant};
use hexagen::{Fault, Sample};
use hexagen_reference::verify::{Subject, VerifyError, verify_subject};
use hexagen_reference::{AnyCommand, BitTrue, Bus, Controller, FormatTable, Spec, Stop};
use rayon::prelude::*;

/// The model as a drive, with an optional fault.
struct Mirror {
    model: BitTrue,
    /// Flip the lowest bit of this state word in its output.
    flip: Option<usize>,
}

impl Subject for Mirror {
    fn step(&mut self, sample: &Sample) -> AnyCommand {
        self.model.step(sample)
    }
    fn set_current(&mut self, bits: i32) {
        self.model.set_current(bits);
    }
    fn set_torque(&mut self, bits: i32) {
        self.model.set_torque(bits);
    }
    fn set_speed(&mut self, bits: i32) {
        self.model.set_speed(bits);
    }

    fn set_bus(&mut self, counts: u16) {
        self.model.set_bus(counts);
    }
    fn reset(&mut self) {
        self.model.reset();
    }
    fn calibrate(&mut self) {
        self.model.calibrate();
    }
    fn precharge(&mut self) {
        self.model.precharge();
    }

    fn stop(&mut self, stop: Stop) {
        self.model.stop(stop);
    }
    fn fault(&self) -> Option<Fault> {
        self.model.fault()
    }
    fn bus_is_stale(&self) -> bool {
        self.model.bus_is_stale()
    }
    fn state_words(&self, words: &mut [i32]) {
        self.model.state_words(words);
        if let Some(word) = self.flip {
            words[word] ^= 1;
        }
    }
    fn set_state_words(&mut self, words: &[i32]) {
        self.model.set_state_words(words);
    }
}

fn run(
    variant: &Variant,
    steps: u64,
    flip: Option<usize>,
) -> Result<hexagen_reference::verify::Report, VerifyError> {
    let fresh = BitTrue::new(&variant.spec, &FormatTable::new(variant.formats))?;
    let names = fresh.state_names();
    verify_subject(
        &variant.toml,
        variant.formats,
        &names,
        || Mirror {
            model: fresh.clone(),
            flip,
        },
        steps,
        11,
    )
}

#[test]
fn covers_every_path() {
    let sample = variants::all().into_iter().step_by(11);
    let sample: Vec<_> = sample
        .chain(variants::others().into_iter().step_by(5))
        .collect();
    sample.par_iter().for_each(|variant| {
        let report =
            run(variant, 40_000, None).unwrap_or_else(|error| panic!("{}: {error}", variant.name));
        let at_least = |count: u64, share: f64, what: &str| {
            assert!(
                count as f64 >= share * report.steps as f64,
                "{}: {what}: {report}",
                variant.name
            );
        };
        at_least(report.running, 0.6, "in control");
        if variants::saturates(variant) {
            // A PI controller's gain is a fraction of the deadbeat one.
            let share = if matches!(variant.spec.controller, Controller::PiPwm(_)) {
                0.01
            } else {
                0.05
            };
            at_least(report.limited, share, "limited");
        }
        at_least(report.running - report.limited, 0.1, "not limited");
        at_least(report.tripped, 0.001, "tripped");
        if variant.spec.inverter.bus == Bus::Measured {
            at_least(report.fresh_bus, 0.1, "told the bus voltage");
            at_least(report.steps - report.fresh_bus, 0.01, "no longer told it");
        }
        if variants::commutates(variant) {
            at_least(report.commutating, 0.02, "commutating");
            at_least(report.running - report.commutating, 0.1, "not commutating");
        }
        if variants::has_rotor(variant) {
            at_least(report.timed, 0.05, "with angle");
            at_least(report.backward, 0.02, "backward");
        }
    });
}

#[test]
fn start_up_is_part_of_every_session() {
    let variant = &variants::all()[0];
    let report = run(variant, 5 << 16, None).expect("the model equals itself");
    assert!(
        report.calibrations >= 3 && report.precharging > 0,
        "{report}"
    );
}

#[test]
fn a_fault_in_start_up_is_detected() {
    let variant = &variants::all()[0];
    let fresh = BitTrue::new(&variant.spec, &variants::table(variant)).expect("a model");
    let names = fresh.state_names();
    for (right, wrong) in [
        ("calibration_log2 = 8", "calibration_log2 = 7"),
        ("offset_tolerance = 102", "offset_tolerance = 90"),
        ("offset_tolerance = 102", "offset_tolerance = 110"),
        ("precharge_periods = 20", "precharge_periods = 21"),
    ] {
        assert!(variant.toml.contains(right), "{right}");
        let other = Spec::from_toml(&variant.toml.replace(right, wrong)).expect("a specification");
        let faulty = BitTrue::new(&other, &variants::table(variant)).expect("a model");
        let mirror = || Mirror {
            model: faulty.clone(),
            flip: None,
        };
        let found = verify_subject(&variant.toml, variant.formats, &names, mirror, 500_000, 1);
        assert!(matches!(found, Err(VerifyError::Mismatch(_))), "{wrong}");
    }
}

#[test]
fn detects_and_locates_one_wrong_bit() {
    let variant = &variants::all()[0];
    let names = BitTrue::new(&variant.spec, &variants::table(variant))
        .expect("a model")
        .state_names();
    for (word, name) in names.iter().enumerate() {
        let Err(VerifyError::Mismatch(mismatch)) = run(variant, 100, Some(word)) else {
            panic!("a wrong bit in {name} went unseen");
        };
        let marked: Vec<_> = mismatch
            .differences
            .iter()
            .filter(|row| row.found != row.expected)
            .collect();
        assert_eq!(marked.len(), 1);
        assert_eq!(marked[0].name, *name);
        assert!(mismatch.to_string().contains("<--"));
    }
}

#[test]
fn state_words_round_trip() {
    for variant in variants::all()
        .iter()
        .step_by(7)
        .chain(variants::others().iter().step_by(3))
    {
        let mut model = BitTrue::new(&variant.spec, &variants::table(variant)).expect("a model");
        model.set_current(variant.spec.inverter.max_current as i32 * 32_768);
        let counts = if variant.name.starts_with("servo") {
            [8100, 7950]
        } else {
            [2060, 2050]
        };
        let codes = variant.spec.motor.hall_codes;
        let sample = |place: usize| Sample::with_hall(counts, codes[place % 6]).hall_ticks(3);
        for step in 0..200 {
            model.step(&sample(step / 5));
        }
        let mut words = vec![0; model.state_names().len()];
        model.state_words(&mut words);
        let mut other = BitTrue::new(&variant.spec, &variants::table(variant)).expect("a model");
        other.set_current(variant.spec.inverter.max_current as i32 * 32_768);
        other.set_state_words(&words);
        for step in 0..50 {
            let sample = sample(step / 3);
            assert_eq!(other.step(&sample), model.step(&sample), "{}", variant.name);
        }
    }
}
