//! The signals of drives agree with the bit-true model's in the same period.

use hexagen::fixed::types::I16F16;
use hexagen::{Control, Drive, Legs, Signals};
use hexagen_reference::verify::{Action, Context, Stimulus};
use hexagen_reference::{AnyCommand, BitTrue, FormatTable, Mode, Spec};
use std::f64::consts::TAU;

macro_rules! drives {
    ($($name:ident: { $($controller:tt)* })*) => { $(
        hexagen::controller! {
            $name {
                motor: "../targets/motors/anaheim-bly171d.toml",
                controller: $($controller)*,
            }
        }
    )* };
}

drives! {
    Estimated: { pdcc { reference: quasi_square } }
    Modelled: { pdcc { emf: model, advance: 1.5 } }
    Timed: { fcs_mpc { hall_capture: timer, emf: model } }
    Fed: { pi_pwm { feed_forward: on, emf: model } }
    Regulated: { pdcc { speed_loop: on } }
    Held: { pdcc { reference: quasi_square, emf: held } }
    Hysteretic: { phcc { delay: 0 } }
}

const STEPS: usize = 60_000;

/// Number of signals with an EMF, and with a speed that is not 0.
#[derive(Debug, Default, PartialEq)]
struct Told {
    periods: usize,
    emfs: usize,
    speeds: usize,
}

/// Radian per period at the mean speed of the last turn; only with a speed loop.
fn mean_turn(model: &BitTrue, ticks: f64) -> Option<f64> {
    let names = model.state_names();
    let mut words = vec![0; names.len()];
    model.state_words(&mut words);
    let word = |name| {
        let place = names.iter().position(|known| *known == name)?;
        Some(f64::from(words[place]))
    };
    word("speed_integral")?;
    Some(word("direction")? * word("omega")? * ticks * TAU / 32_f64.exp2())
}

/// Compares every controlled period of a drive.
fn told<C: Control<Command = Legs>>() -> Told {
    let spec = Spec::from_toml(C::SPEC).expect("a specification");
    let mut model = BitTrue::new(&spec, &FormatTable::new(C::FORMATS)).expect("a model");
    let mut stimulus = Stimulus::new(&spec, 1).expect("a stimulus");
    stimulus.restart();
    let mut drive = Drive::<C>::new();
    let rpm = 60.0 / (TAU * f64::from(spec.motor.pole_pairs) * spec.inverter.t_s);
    let mut told = Told::default();
    let _ = drive.signals();
    for _ in 0..STEPS {
        let context = Context {
            offset: model.offset_counts(),
            tripped: model.mode() == Mode::Tripped,
        };
        let (action, sample) = stimulus.next(&context);
        match action {
            Some(Action::SetCurrent(bits)) => {
                model.set_current(bits);
                drive.set_current(I16F16::from_bits(bits));
            }
            Some(Action::SetSpeed(bits)) => {
                model.set_speed(bits);
                drive.set_speed_bits(bits);
            }
            Some(Action::Reset) => {
                model.reset();
                drive.reset();
            }
            _ => {}
        }
        let command = model.step(&sample);
        assert_eq!(AnyCommand::from(drive.step(&sample)), command);
        stimulus.respond(command);
        let trace = model.trace();
        let Some(Signals {
            currents,
            emf,
            speed,
            ..
        }) = drive.signals()
        else {
            assert!(!trace.run, "a controlled period answers");
            continue;
        };
        assert!(trace.run, "a period without control does not");
        let _ = drive.signals();
        told.periods += 1;
        let near = |found: I16F16, expected: f64| {
            let range = f64::from(1 << 15);
            let error = found.to_num::<f64>() - expected.clamp(-range, range);
            assert!(
                error.abs() <= 1e-4 + 1e-6 * expected.abs(),
                "{found} for {expected}"
            );
        };
        for phase in 0..2 {
            near(currents[phase], trace.i[phase]);
            if let Some(emf) = emf {
                near(emf[phase], trace.e[phase]);
            }
        }
        told.emfs += usize::from(emf.is_some());
        if let Some(speed) = speed {
            // A speed loop tells the speed that it controls, the mean of the last turn.
            let turn = mean_turn(&model, spec.inverter.ticks);
            near(speed, turn.unwrap_or(trace.step_angle) * rpm);
            told.speeds += usize::from(trace.step_angle != 0.0);
        }
    }
    assert!(told.periods > STEPS / 10, "{told:?}");
    told
}

fn assert_tells<C: Control<Command = Legs>>(emf: bool, speed: bool) {
    let told = told::<C>();
    assert_eq!(told.emfs, if emf { told.periods } else { 0 }, "{told:?}");
    assert_eq!(told.speeds > STEPS / 100, speed, "{told:?}");
}

#[test]
fn an_estimated_emf() {
    assert_tells::<Estimated>(true, false);
}

#[test]
fn a_modelled_emf_and_speed() {
    assert_tells::<Modelled>(true, true);
    assert_tells::<Timed>(true, true);
}

#[test]
fn a_fed_forward_emf() {
    assert_tells::<Fed>(true, true);
}

#[test]
fn the_speed_of_a_speed_loop() {
    assert_tells::<Regulated>(true, true);
}

#[test]
fn no_emf_if_the_law_estimates_none() {
    assert_tells::<Held>(false, false);
    assert_tells::<Hysteretic>(false, false);
}
