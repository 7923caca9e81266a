//! The peers on the host: inputs of each in closed loop, and its outputs.

use super::count::Inputs;
use crate::BenchError;
use crate::listing::Listed;
use crate::pil::{Core, first_step};
use crate::vectors::Answer;
use hexagen::fixed::types::I16F16;
use hexagen_firmware::peers::{FcsMpc, FocLoop, IdspLoop, Pdcc, Peer, Phcc, PiPwm};
use hexagen_firmware::wire::{Mode, Task, encode_outputs};
use hexagen_lab::engine::Prepared;

/// Compared steps of `foc`: the integral of its controllers has no limit, and in the loop of
/// another controller overflows some time later, where a host with overflow checks stops.
const FOC_STEPS: usize = 500;

/// The run of a peer on the host.
#[derive(Debug)]
pub struct Run {
    /// Its inputs.
    pub inputs: Inputs,
    /// Its outputs, step by step.
    answers: Vec<Answer>,
}

/// Runs the peer with this symbol on the plant of a drive.
///
/// # Errors
/// If there is no such peer.
pub fn run(drive: &Prepared, symbol: &str) -> Result<Run, BenchError> {
    match symbol {
        "step_f32_pdcc" => in_closed_loop::<Pdcc<f32>>(drive),
        "step_f32_fcs_mpc" => in_closed_loop::<FcsMpc<f32>>(drive),
        "step_f32_phcc" => in_closed_loop::<Phcc<f32>>(drive),
        "step_f32_pi_pwm" => in_closed_loop::<PiPwm<f32>>(drive),
        "step_i16f16_pdcc" => in_closed_loop::<Pdcc<I16F16>>(drive),
        "step_i16f16_fcs_mpc" => in_closed_loop::<FcsMpc<I16F16>>(drive),
        "step_i16f16_phcc" => in_closed_loop::<Phcc<I16F16>>(drive),
        "step_i16f16_pi_pwm" => in_closed_loop::<PiPwm<I16F16>>(drive),
        // `foc` and `idsp` are rotor-oriented, without an angle between the edges: their inputs are
        // those of another PI.
        "step_foc" => in_loop_of::<PiPwm<f32>, FocLoop>(drive, FOC_STEPS),
        "step_idsp" => in_loop_of::<PiPwm<f32>, IdspLoop>(drive, usize::MAX),
        _ => Err(BenchError::Failed(format!(
            "`{symbol}` is not a peer of the host"
        ))),
    }
}

fn in_closed_loop<P: Peer>(drive: &Prepared) -> Result<Run, BenchError> {
    in_loop_of::<P, P>(drive, usize::MAX)
}

/// The inputs of `L` in its own closed loop, and the outputs of `P` for the first of them.
fn in_loop_of<L: Peer, P: Peer>(drive: &Prepared, steps: usize) -> Result<Run, BenchError> {
    let (mut closed, mut peer) = (L::new(), P::new());
    let inputs = Inputs::record_peer(drive, |sample| closed.step(sample))?;
    let answer = |(step, sample)| Answer {
        sample,
        step,
        bytes: encode_outputs(peer.step(&sample).to_bits(), None).to_vec(),
    };
    let answers = inputs
        .samples()
        .take(steps)
        .enumerate()
        .map(answer)
        .collect();
    Ok(Run { inputs, answers })
}

impl Run {
    /// Compares a peer's outputs on the core with those on the host: every word, and exactly, since
    /// IEEE 754 defines each operation of `f32` and nothing contracts two into one.
    ///
    /// # Errors
    /// The first step that differs, or an error of the emulator.
    pub fn compare(&self, core: &impl Core, listed: &Listed) -> Result<(), BenchError> {
        let task = Task {
            mode: Mode::Full,
            drive: listed.place,
            block: 0,
        };
        let found = core.run(task, self.inputs.records())?;
        match first_step(&self.answers, &found, false, &[]) {
            None => Ok(()),
            Some(report) => Err(BenchError::Failed(format!(
                "{} differs from the host\n{report}",
                listed.symbol
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cost::{INTERRUPT_VARIANT, paper_drive};
    use crate::pil::tests::Memory;
    use hexagen::{LegState, Legs, Sample};
    use hexagen_firmware::StepFn;
    use hexagen_firmware::session::replay_peer;

    type Tested = PiPwm<I16F16>;

    /// The core's end in this process, with a given step function.
    struct InProcess(extern "C" fn(&mut Tested, u16, u16, u8, u16) -> u64);

    impl Core for InProcess {
        fn run(&self, task: Task, records: &[u8]) -> Result<Vec<u8>, BenchError> {
            let mut link = Memory {
                input: records,
                answers: vec![],
            };
            replay_peer(StepFn::Bits(self.0), &mut link, &task).expect("a task in order");
            Ok(link.answers)
        }
    }

    extern "C" fn honest(
        peer: &mut Tested,
        adc_a: u16,
        adc_b: u16,
        hall: u8,
        hall_ticks: u16,
    ) -> u64 {
        let sample = Sample::with_hall([adc_a, adc_b], hall);
        peer.step(&sample.hall_ticks(hall_ticks)).to_bits()
    }

    /// Result of a past miscompilation: correct state, zero outputs.
    extern "C" fn zeros(peer: &mut Tested, a: u16, b: u16, hall: u8, ticks: u16) -> u64 {
        honest(peer, a, b, hall, ticks);
        Legs::all(LegState::Pulsed).to_bits()
    }

    /// One count too much in phase b, above 899.
    extern "C" fn one_more(peer: &mut Tested, a: u16, b: u16, hall: u8, ticks: u16) -> u64 {
        let legs = Legs::from_bits(honest(peer, a, b, hall, ticks));
        let [compare_a, compare_b, compare_c] = legs.compare();
        let compare_b = compare_b + u16::from(compare_b > 899);
        Legs::new([compare_a, compare_b, compare_c], legs.state()).to_bits()
    }

    #[test]
    fn every_peer_runs_on_the_host() {
        let paper = paper_drive(INTERRUPT_VARIANT).expect("a drive of the library");
        for symbol in [
            "step_f32_pdcc",
            "step_f32_fcs_mpc",
            "step_f32_phcc",
            "step_f32_pi_pwm",
            "step_i16f16_pdcc",
            "step_i16f16_fcs_mpc",
            "step_i16f16_phcc",
            "step_i16f16_pi_pwm",
            "step_foc",
            "step_idsp",
        ] {
            let run = run(&paper, symbol).expect("a peer");
            let mut outputs: Vec<_> = run.answers.iter().map(|answer| &answer.bytes).collect();
            assert!(outputs.len() >= FOC_STEPS, "{symbol}");
            outputs.sort_unstable();
            outputs.dedup();
            assert!(outputs.len() > 3, "{symbol}: {outputs:?}");
        }
    }

    #[test]
    fn a_core_with_other_outputs_is_found() {
        let listed = Listed {
            place: 0,
            symbol: "step_i16f16_pi_pwm".to_owned(),
            motor: String::new(),
            variant: String::new(),
            words: vec![],
            size: 0,
            spec: String::new(),
        };
        let paper = paper_drive(INTERRUPT_VARIANT).expect("a drive of the library");
        let run = run(&paper, &listed.symbol).expect("a peer");
        let difference = |step| {
            let outcome = run.compare(&InProcess(step), &listed);
            outcome.map_err(|error| error.to_string())
        };
        assert_eq!(difference(honest), Ok(()));
        let report = difference(zeros).expect_err("zeros are found");
        assert!(
            report.starts_with("step_i16f16_pi_pwm differs from the host"),
            "{report}"
        );
        assert!(report.contains("step 0, Sample"), "{report}");
        assert!(report.contains("* compare_a"), "{report}");
        let report = difference(one_more).expect_err("one count is found");
        assert!(report.contains("* compare_b"), "{report}");
        assert!(!report.contains("* compare_a"), "{report}");
    }
}
