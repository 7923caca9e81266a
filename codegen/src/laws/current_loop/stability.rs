//! Stability of linear current loops: closed-loop poles on a plant whose R and L are not the
//! model's.

use super::LoopDesign;
use crate::design::DiscretePlant;
use crate::spec::{Discretisation, EmfSource, LoopOptions, Spec};
use nalgebra::{DMatrix, DVector};

/// Stable ranges of true over stated inductance and resistance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StableRange {
    /// Of the inductance.
    pub inductance: (f64, f64),
    /// Of the resistance.
    pub resistance: (f64, f64),
}

/// A linear loop without EMF and reference: one period of state `x` on the given plant.
pub trait LinearLoop {
    /// Length of the state.
    fn order(&self) -> usize;
    /// The state a period later: affine in the plant's pole and gain, which affect only the
    /// current.
    fn advance(&self, real: DiscretePlant, x: &DVector<f64>) -> DVector<f64>;

    /// One period as a matrix.
    fn matrix(&self, real: DiscretePlant) -> DMatrix<f64> {
        let order = self.order();
        let columns: Vec<DVector<f64>> = (0..order)
            .map(|axis| {
                let unit = DVector::from_fn(order, |row, _| f64::from(u8::from(row == axis)));
                self.advance(real, &unit)
            })
            .collect();
        DMatrix::from_columns(&columns)
    }

    /// Spectral radius with the stated motor (per axis; EMF as a disturbance).
    fn spectral_radius(&self, spec: &Spec) -> f64 {
        let matrix = self.matrix(real_plant(spec, 1.0, 1.0));
        matrix
            .complex_eigenvalues()
            .iter()
            .map(|pole| pole.re.hypot(pole.im))
            .fold(0.0, f64::max)
    }

    /// Greatest current per volt, A/V, in response to an EMF that steps up at rest and then turns
    /// by up to `turn` radian a period, with the stated motor.
    fn greatest_response(&self, spec: &Spec, turn: f64) -> f64 {
        let real = real_plant(spec, 1.0, 1.0);
        // The response to one period of a volt, whose superposition is that to any EMF.
        let mut state = DVector::zeros(self.order());
        state[0] = real.gain;
        let (mut currents, mut greatest) = (vec![], 0.0_f64);
        while state.amax() > OVER * greatest && currents.len() < LONGEST {
            greatest = greatest.max(state.amax());
            currents.push(state[0]);
            state = self.advance(real, &state);
        }
        let peak = |turn: f64| {
            // In the frame of the EMF each earlier period lags one turn more.
            let (sin, cos) = turn.sin_cos();
            let (mut along, mut across) = (1.0, 0.0);
            let (mut facing, mut lagging) = (0.0_f64, 0.0_f64);
            let mut most = 0.0_f64;
            for current in &currents {
                facing += along * current;
                lagging += across * current;
                (along, across) = (along * cos - across * sin, along * sin + across * cos);
                most = most.max(facing.hypot(lagging));
            }
            most
        };
        let turns = (0..=TURNS).map(|n| turn * f64::from(n) / f64::from(TURNS));
        turns.map(peak).fold(0.0, f64::max)
    }

    /// Stable ranges of true over stated R and L, one varied at a time, searched from 0.1 to 10.
    fn stable_range(&self, spec: &Spec) -> StableRange {
        let poles = CharacteristicPolynomial::new(self);
        let is_stable = |resistance_ratio, inductance_ratio| {
            poles.are_inside_the_unit_circle(real_plant(spec, resistance_ratio, inductance_ratio))
        };
        StableRange {
            inductance: stable_interval(|ratio| is_stable(1.0, ratio)),
            resistance: stable_interval(|ratio| is_stable(ratio, 1.0)),
        }
    }
}

/// Speeds, from 0, at which a turning EMF is evaluated.
const TURNS: u32 = 8;

/// Part of its greatest value below which a decaying response counts as over.
const OVER: f64 = 0.004;

/// Longest response that is followed, periods.
const LONGEST: usize = 1000;

/// The plant with `resistance_ratio` and `inductance_ratio` times the motor's R and L, in exact
/// discretisation whatever the model's.
fn real_plant(spec: &Spec, resistance_ratio: f64, inductance_ratio: f64) -> DiscretePlant {
    DiscretePlant::new(
        Discretisation::Exact,
        (spec.motor.resistance * resistance_ratio).max(1e-9),
        spec.motor.inductance * inductance_ratio,
        spec.inverter.t_s,
    )
}

/// Characteristic polynomial of a loop on any plant, from the highest power, whose coefficient is
/// 1.
///
/// The plant's pole and gain are in one row of the loop's matrix, and a determinant is linear in
/// each row, so three polynomials give all others. The search for a stable range evaluates
/// hundreds, in macros that run unoptimised.
struct CharacteristicPolynomial {
    fixed: Vec<f64>,
    of_pole: Vec<f64>,
    of_gain: Vec<f64>,
}

impl CharacteristicPolynomial {
    fn new(linear: &(impl LinearLoop + ?Sized)) -> Self {
        let on = |pole, gain| characteristic(&linear.matrix(DiscretePlant { pole, gain }));
        let fixed = on(0.0, 0.0);
        let beside_fixed = |coefficients: Vec<f64>| {
            let pairs = coefficients.iter().zip(&fixed);
            pairs.map(|(with, without)| with - without).collect()
        };
        Self {
            of_pole: beside_fixed(on(1.0, 0.0)),
            of_gain: beside_fixed(on(0.0, 1.0)),
            fixed,
        }
    }

    /// Whether all poles on this plant have a magnitude below 1 (Schur-Cohn criterion).
    fn are_inside_the_unit_circle(&self, real: DiscretePlant) -> bool {
        let mut polynomial = self.fixed.clone();
        for (power, coefficient) in polynomial.iter_mut().enumerate() {
            *coefficient += real.pole * self.of_pole[power] + real.gain * self.of_gain[power];
        }
        while let [highest, .., lowest] = polynomial[..] {
            let reflection = lowest / highest;
            if reflection.is_nan() || reflection.abs() >= 1.0 {
                return false;
            }
            let last = polynomial.len() - 1;
            polynomial = (0..last)
                .map(|power| polynomial[power] - reflection * polynomial[last - power])
                .collect();
        }
        true
    }
}

/// Coefficients of det(z - A), by the Faddeev-Le Verrier recursion.
fn characteristic(matrix: &DMatrix<f64>) -> Vec<f64> {
    let order = matrix.nrows();
    let mut coefficients = vec![1.0];
    let mut product = DMatrix::zeros(order, order);
    for step in 1..=order {
        let sum = &product + DMatrix::identity(order, order) * coefficients[step - 1];
        product = matrix * sum;
        coefficients.push(-product.trace() / step as f64);
    }
    coefficients
}

/// EMF of a law from current and voltage, at standstill, without advance.
#[derive(Clone, Copy, Debug, Default)]
pub struct SeenEmf {
    /// Over the target period.
    pub target: f64,
    /// Over the period that begins now.
    pub present: f64,
}

impl SeenEmf {
    /// From the currents of the last two samples, the voltage between them, and the EMF expected for
    /// that period and for the one that begins now.
    pub fn new(
        options: &LoopOptions,
        design: &LoopDesign,
        i: [f64; 2],
        v_prev: f64,
        [e_prev, e_next]: [f64; 2],
    ) -> Self {
        let seen = v_prev - design.k_di * (i[0] - i[1]) - design.k_r * i[1];
        let both = |e| Self {
            target: e,
            present: e,
        };
        match options.emf {
            EmfSource::Estimated => both(e_prev + options.emf_filter * (seen - e_prev)),
            // Folding does not change the loop.
            EmfSource::Held => both(seen),
            EmfSource::Model => both(0.0),
            EmfSource::Observer => {
                let correction = design.observer_gain * (seen - e_prev);
                if options.delay == 0 {
                    return both(e_prev + correction);
                }
                Self {
                    target: e_next + correction,
                    present: e_next,
                }
            }
        }
    }
}

/// Least and greatest multiple of a parameter that are searched: a range that ends here may go on.
pub const SEARCHED: [f64; 2] = [0.1, 10.0];

/// The interval around 1 where the loop is stable, within [`SEARCHED`], to 1e-4 relative.
fn stable_interval(is_stable: impl Fn(f64) -> bool) -> (f64, f64) {
    if !is_stable(1.0) {
        return (1.0, 1.0);
    }
    let search = |direction: f64| {
        let (mut inside, mut outside) = (1.0_f64, 1.0_f64);
        let stride = 1.02_f64.powf(direction);
        while is_stable(outside) {
            inside = outside;
            outside *= stride;
            let [least, most] = SEARCHED;
            if !(least..=most).contains(&outside) {
                return outside.clamp(least, most);
            }
        }
        while (outside / inside - 1.0).abs() > 1e-4 {
            let middle = (inside * outside).sqrt();
            if is_stable(middle) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        inside
    };
    (search(-1.0), search(1.0))
}

#[cfg(test)]
mod tests {
    use super::{CharacteristicPolynomial, DiscretePlant, LinearLoop};
    use nalgebra::{DMatrix, DVector};

    /// A loop of any matrix; the plant stands in its first row.
    struct Any(DMatrix<f64>);

    impl LinearLoop for Any {
        fn order(&self) -> usize {
            self.0.nrows()
        }

        fn advance(&self, real: DiscretePlant, x: &DVector<f64>) -> DVector<f64> {
            let mut next = &self.0 * x;
            next[0] = real.pole * x[0] + real.gain * next[0];
            next
        }
    }

    #[test]
    fn the_polynomial_is_stable_where_the_largest_eigenvalue_is_below_1() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 * 2.0 - 1.0
        };
        let mut stable = 0;
        for round in 0..2000 {
            let order = 2 + round % 5;
            let linear = Any(DMatrix::from_fn(order, order, |_, _| 0.8 * random()));
            let plant = DiscretePlant {
                pole: 0.5 + random() / 2.0,
                gain: 2.0 * random(),
            };
            let poles = linear.matrix(plant).complex_eigenvalues();
            let radius = poles
                .iter()
                .map(|pole| pole.re.hypot(pole.im))
                .fold(0.0, f64::max);
            if (radius - 1.0).abs() < 1e-9 {
                continue;
            }
            let is_stable =
                CharacteristicPolynomial::new(&linear).are_inside_the_unit_circle(plant);
            assert_eq!(is_stable, radius < 1.0, "radius {radius} of {}", linear.0);
            stable += usize::from(is_stable);
        }
        assert!((500..1500).contains(&stable), "{stable} of 2000 are stable");
    }
}
