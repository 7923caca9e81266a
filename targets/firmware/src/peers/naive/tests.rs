//! The naive controllers against their equations, written a second time, plainly and in `f64`.

extern crate std;

use super::{FcsMpc, Pdcc, Peer, Phcc, PiPwm, Real};
use core::cell::{Cell, RefCell};
use core::ops::Div;
use hexagen::Sample;
use hexagen::fixed::types::I16F16;

/// Pole and gain of the motor's discrete plant, exact discretisation: 135 mohm, 0.22 mH, 50 us.
const A: f64 = 0.969_784_1;
const B: f64 = 0.223_818_4;

/// Steps of a comparison.
const STEPS: usize = 20_000;

/// The Clarke transform of three quantities whose sum is zero.
fn clarke([a, b]: [f64; 2]) -> [f64; 2] {
    [a, (a + 2.0 * b) / 3.0_f64.sqrt()]
}

/// Currents alpha, beta of a sample.
fn currents(sample: Sample) -> [f64; 2] {
    let [adc_a, adc_b, _] = sample.adc();
    clarke([adc_a, adc_b].map(|count| (f64::from(count) - 2048.0) * 80.0 / 4096.0))
}

/// 20 A into one phase of the sector and out of the other.
fn reference(sample: Sample) -> [f64; 2] {
    let phases = match sample.hall() {
        1 => [0.0, -1.0],
        2 => [-1.0, 1.0],
        3 => [-1.0, 0.0],
        4 => [1.0, 0.0],
        5 => [1.0, -1.0],
        6 => [0.0, 1.0],
        _ => [0.0, 0.0],
    };
    clarke(phases.map(|phase| 20.0 * phase))
}

/// Voltage alpha, beta of gates.
fn vector(gates: [u16; 3]) -> [f64; 2] {
    let [a, b, c] = gates.map(|gate| 48.0 * f64::from(gate));
    let mean = (a + b + c) / 3.0;
    clarke([a - mean, b - mean])
}

/// EMF of the last period, and the current at the next sample.
#[derive(Default)]
struct Plain {
    i_last: [f64; 2],
    v_last: [f64; 2],
    v_now: [f64; 2],
}

impl Plain {
    fn predict(&mut self, i: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let e = [0, 1].map(|x| self.v_last[x] - (i[x] - A * self.i_last[x]) / B);
        let i_next = [0, 1].map(|x| A * i[x] + B * (self.v_now[x] - e[x]));
        self.i_last = i;
        self.v_last = self.v_now;
        (e, i_next)
    }
}

/// Applied voltage, and compare values in counts with fractions.
fn modulated([alpha, beta]: [f64; 2]) -> ([f64; 2], [f64; 3]) {
    let height = 3.0_f64.sqrt() / 2.0 * beta;
    let phases = [alpha, height - alpha / 2.0, -height - alpha / 2.0];
    let high = phases.into_iter().fold(f64::MIN, f64::max);
    let low = phases.into_iter().fold(f64::MAX, f64::min);
    let scale = (48.0 / (high - low)).min(1.0);
    let middle = f64::midpoint(high, low);
    let counts = phases.map(|phase| 900.0 + (phase - middle) * scale * 1800.0 / 48.0);
    ([alpha * scale, beta * scale], counts)
}

/// A motor whose speed is low at first, and for a fifth of the time too high for the bus.
#[derive(Default)]
struct Motor {
    step: usize,
    angle: f64,
    i: [f64; 2],
    v: [f64; 2],
}

impl Motor {
    /// Phase currents as ADC counts.
    fn sample(&self) -> Sample {
        let sector = (self.angle / 60.0_f64.to_radians()) as usize % 6;
        let [alpha, beta] = self.i;
        let i_b = (3.0_f64.sqrt() * beta - alpha) / 2.0;
        let adc = [alpha, i_b].map(|i| (i / 80.0 * 4096.0 + 2048.0).round() as u16);
        Sample::with_hall(adc, [1, 5, 4, 6, 2, 3][sector])
    }

    /// One period with the voltage demanded in the last one; `v` is that of the next.
    fn turn(&mut self, v: [f64; 2]) {
        let is_fast = self.step % 1000 >= 800;
        // The middle of sector 1, of code 1, in which the current flows from phase c to b, lies at
        // -90 degrees.
        let direction = self.angle - 2.0 * 60.0_f64.to_radians();
        let emf = if is_fast { 32.0 } else { 12.0 };
        let emf = [emf * direction.cos(), emf * direction.sin()];
        self.i = [0, 1].map(|x| A * self.i[x] + B * (self.v[x] - emf[x]));
        self.v = v;
        self.angle = (self.angle + if is_fast { 0.08 } else { 0.03 }) % 360.0_f64.to_radians();
        self.step += 1;
    }
}

/// Compare values of a peer are within `counts` of the plain ones; both cases of the modulation
/// occur.
fn stays_near<P: Peer>(
    counts: f64,
    mut voltage: impl FnMut(Sample) -> [f64; 2],
    mut applied: impl FnMut([f64; 2], &P),
) {
    let mut peer = P::new();
    let mut motor = Motor::default();
    let mut limited = 0;
    for step in 0..STEPS {
        let sample = motor.sample();
        let found = peer.step(&sample).compare();
        let v = voltage(sample);
        let (v_applied, expected) = modulated(v);
        limited += usize::from(v[0].hypot(v[1]) > 1.001 * v_applied[0].hypot(v_applied[1]));
        applied(v_applied, &peer);
        motor.turn(v_applied);
        for (found, expected) in found.into_iter().zip(expected) {
            // The plain value lies between its integer part and the next count.
            let error = f64::from(found) + 0.5 - expected;
            assert!(
                error.abs() <= 0.5 + counts,
                "step {step}, {sample:?}: {found} for {expected}"
            );
        }
    }
    assert!(
        (STEPS / 100..STEPS * 9 / 10).contains(&limited),
        "{limited}"
    );
}

fn pdcc<R: Real + Div<Output = R> + Into<f64>>(counts: f64) {
    let plain = RefCell::new(Plain::default());
    stays_near::<Pdcc<R>>(
        counts,
        |sample| {
            let (e, i_next) = plain.borrow_mut().predict(currents(sample));
            let i_ref = reference(sample);
            [0, 1].map(|x| (i_ref[x] - A * i_next[x]) / B + e[x])
        },
        // The peer's own currents: on common ones, both would take a difference of their applied
        // voltages for EMF, and double it.
        |_, peer| plain.borrow_mut().v_now = peer.0.v_now.map(Into::into),
    );
}

fn pi_pwm<R: Real + Div<Output = R>>(counts: f64) {
    const GAIN: f64 = 1.382_3;
    const SHARE: f64 = 0.030_68;
    let integral = Cell::new([0.0; 2]);
    let error_and_v = Cell::new(([0.0; 2], [0.0; 2]));
    stays_near::<PiPwm<R>>(
        counts,
        |sample| {
            let (i, i_ref) = (currents(sample), reference(sample));
            let error = [0, 1].map(|x| i_ref[x] - i[x]);
            let v = [0, 1].map(|x| GAIN * error[x] + integral.get()[x]);
            error_and_v.set((error, v));
            v
        },
        |applied, _| {
            let (error, v) = error_and_v.get();
            integral.set(
                [0, 1].map(|x| integral.get()[x] + SHARE * (GAIN * error[x] + applied[x] - v[x])),
            );
        },
    );
}

/// Gates of a peer that switches once a period.
fn gates<P: Peer>(peer: &mut P, sample: Sample) -> [u16; 3] {
    peer.step(&sample).compare().map(|count| {
        assert!(count == 0 || count == 1800, "{count}");
        count / 1800
    })
}

/// No other vector costs less than the chosen one, with a tolerance of `tie`, in A^2.
fn fcs_mpc<R: Real>(tie: f64) {
    let mut peer = FcsMpc::<R>::new();
    let mut plain = Plain::default();
    let mut chosen = [0; 8];
    let mut motor = Motor::default();
    for _ in 0..STEPS {
        let sample = motor.sample();
        let (e, i_next) = plain.predict(currents(sample));
        let i_ref = reference(sample);
        let cost = |gates: [u16; 3]| {
            let v = vector(gates);
            [0, 1]
                .map(|x| i_ref[x] - A * i_next[x] - B * (v[x] - e[x]))
                .map(|error| error * error)
                .iter()
                .sum::<f64>()
        };
        let found = gates(&mut peer, sample);
        let least = (0..8_u16)
            .map(|bits| cost([bits >> 2, bits >> 1 & 1, bits & 1]))
            .fold(f64::MAX, f64::min);
        let cost = cost(found);
        assert!(
            cost <= least + tie,
            "{sample:?}: {found:?}, {cost} A^2 for {least}"
        );
        let [a, b, c] = found;
        chosen[usize::from(a << 2 | b << 1 | c)] += 1;
        plain.v_now = vector(found);
        motor.turn(plain.v_now);
    }
    assert!(chosen[..7].iter().all(|&times| times > 0), "{chosen:?}");
}

/// The wanted direction of an axis changes when the current leaves the band of 0.5 A, with a
/// tolerance of `tie`, in A.
fn phcc<R: Real>(tie: f64) {
    let mut peer = Phcc::<R>::new();
    let mut plain = Plain::default();
    let mut wish = [false; 2];
    let mut motor = Motor::default();
    for _ in 0..STEPS {
        let sample = motor.sample();
        let (_, i_next) = plain.predict(currents(sample));
        let i_ref = reference(sample);
        let found = gates(&mut peer, sample);
        let v = vector(found);
        for x in 0..2 {
            let error = i_ref[x] - i_next[x];
            let is_plus = v[x] > 0.0;
            if error.abs() > 0.5 + tie {
                assert_eq!(is_plus, error > 0.0, "{sample:?}: {error} A");
            } else if error.abs() < 0.5 - tie {
                assert_eq!(is_plus, wish[x], "{sample:?}: {error} A");
            }
            wish[x] = is_plus;
        }
        plain.v_now = v;
        motor.turn(v);
    }
}

#[test]
fn peers_in_f32_follow_their_equations() {
    pdcc::<f32>(0.01);
    pi_pwm::<f32>(0.01);
    fcs_mpc::<f32>(0.001);
    phcc::<f32>(0.001);
}

#[test]
fn peers_in_i16f16_follow_their_equations() {
    pdcc::<I16F16>(1.0);
    pi_pwm::<I16F16>(1.0);
    fcs_mpc::<I16F16>(0.1);
    phcc::<I16F16>(0.01);
}
