//! The crates `foc` and `idsp` in a current loop.

use super::Peer;
use dsp_fixedpoint::Q;
use dsp_process::SplitProcess;
use foc::Foc;
use foc::pid::PIController;
use foc::pwm::SpaceVector;
use hexagen::fixed::types::I16F16;
use hexagen::{LegState, Legs, Sample};
use idsp::cossin;
use idsp::iir::{BiquadClamp, DirectForm1};

/// Counts of the timer.
const TIMER: u16 = 1800;

/// Middle of the rotor's sector by Hall code, in turns of 2^32.
const ANGLES: [i32; 8] = [
    0,
    0,
    0x5555_5555,
    -0x2aaa_aaab,
    0x2aaa_aaaa,
    0x1555_5555,
    0x7fff_ffff,
    0,
];

// Constants, since a literal that is read at run time costs a thousand instructions.
// `foc` takes the error as measured minus demanded.
const K_P: I16F16 = I16F16::lit("-0.029");
const K_I: I16F16 = I16F16::lit("-17.7");
const OFFSET: I16F16 = I16F16::lit("2048");
const GAIN: I16F16 = I16F16::lit("0.01953125");
const DEMAND: I16F16 = I16F16::lit("20");
const T_S: I16F16 = I16F16::lit("0.00005");

/// Rotor-oriented control by `foc`: its PI controllers in d and q, its space-vector modulation.
pub struct FocLoop(Foc<SpaceVector, TIMER>);

impl Peer for FocLoop {
    fn new() -> Self {
        let controller = || PIController::new(K_P, K_I);
        Self(Foc::new(controller(), controller()))
    }

    #[inline]
    fn step(&mut self, sample: &Sample) -> Legs {
        let current = |count: u16| (I16F16::from_num(count) - OFFSET) * GAIN;
        // Turns to radians.
        let turns = I16F16::from_bits(ANGLES[usize::from(sample.hall() & 7)] >> 16);
        let [adc_a, adc_b, _] = sample.adc();
        let currents = [current(adc_a), current(adc_b)];
        let compare = self.0.update(currents, turns * I16F16::TAU, DEMAND, T_S);
        Legs::new(compare, [LegState::Pulsed; 3])
    }
}

type Filter = BiquadClamp<Q<i32, i64, 30>, i32>;

/// Rotor-oriented control from pieces of `idsp`: its sine and cosine, a clamped biquad per axis as
/// PI controller; Clarke, Park and modulation by hand.
pub struct IdspLoop {
    filter: Filter,
    state: [DirectForm1<i32>; 2],
}

impl Peer for IdspLoop {
    fn new() -> Self {
        let mut filter = Filter::from([0.029, -0.0281, 0.0, 1.0, 0.0]);
        filter.max = 1 << 29;
        filter.min = -(1 << 29);
        Self {
            filter,
            state: Default::default(),
        }
    }

    #[inline]
    fn step(&mut self, sample: &Sample) -> Legs {
        const COUNTS: i32 = 1024 << 16;
        let times = |x: i32, y: i32| ((i64::from(x) * i64::from(y)) >> 31) as i32;
        let [adc_a, adc_b, _] = sample.adc();
        let (cos, sin) = cossin(ANGLES[usize::from(sample.hall() & 7)]);
        let i_a = (i32::from(adc_a) - 2048) << 16;
        let i_b = (i32::from(adc_b) - 2048) << 16;
        let i_beta = times(i_a + 2 * i_b, 0x49e6_9d16);
        let i_d = times(i_a, cos) + times(i_beta, sin);
        let i_q = times(i_beta, cos) - times(i_a, sin);
        let [d, q] = &mut self.state;
        let v_d = self.filter.process(d, -i_d);
        let v_q = self.filter.process(q, COUNTS - i_q);
        let v_alpha = times(v_d, cos) - times(v_q, sin);
        let v_beta = times(v_d, sin) + times(v_q, cos);
        let side = times(v_beta, 0x6ed9_eba1);
        let v = [v_alpha, side - v_alpha / 2, -side - v_alpha / 2];
        let [a, b, c] = v;
        let middle = (a.max(b).max(c) + a.min(b).min(c)) >> 1;
        let compare = v.map(|x| {
            let counts = times(x - middle, i32::from(TIMER)) + i32::from(TIMER / 2);
            counts.max(0).min(i32::from(TIMER)) as u16
        });
        Legs::new(compare, [LegState::Pulsed; 3])
    }
}
