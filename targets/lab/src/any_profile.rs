//! The greatest torque of any current profile whatever: a bound for every controller.
//!
//! Over a sector of 60 degrees, whose turned copies make up the turn, currents at equal steps are free. The
//! voltage that moves the current of a step's begin, i, to that of its end, i', is v = (i' - A i)/B + e: A
//! and B are those of the step in place of the control period, e is its mean EMF. It stays in the hexagon
//! that the legs reach, and each phase current within the peak of the drive's own reference at its largest
//! set-point. The mean torque (3/2) e.i/omega is linear, so a linear program finds the best profile.

use hexagen_codegen::spec::Envelope;
use microlp::{ComparisonOp, LinearExpr, OptimizationDirection, Problem, SolveOutcome, Variable};
use std::f64::consts::{FRAC_PI_3, FRAC_PI_6};

/// Steps of a sector.
const STEPS: usize = 24;

/// Halvings of the search for a speed: to a thousandth.
const HALVINGS: u32 = 12;

/// A vector of the stationary plane.
type Vector = [f64; 2];

/// Greatest mean torque at a speed above 0 in mechanical rad/s, Nm; 0 where no motoring profile stays within
/// the limits.
pub fn torque(limits: &Envelope, omega_m: f64) -> f64 {
    let mut program = Problem::new(OptimizationDirection::Maximize);
    let step = FRAC_PI_3 / STEPS as f64;
    let turn = |k: usize| step * k as f64;
    let mean: Vec<Vector> = (0..STEPS)
        .map(|k| mean_emf(limits, turn(k), step))
        .collect();
    // The torque of a step goes by the mean of the currents at its ends; that of the last ends in the
    // first one, turned.
    let share = 0.75 / STEPS as f64;
    let currents: Vec<[Variable; 2]> = (0..STEPS)
        .map(|k| {
            let before = if k == 0 {
                rotated(mean[STEPS - 1], -FRAC_PI_3)
            } else {
                mean[k - 1]
            };
            [0, 1].map(|axis| {
                let weight = share * (mean[k][axis] + before[axis]);
                program.add_var(weight, (f64::NEG_INFINITY, f64::INFINITY))
            })
        })
        .collect();
    let period = step / (omega_m * limits.pole_pairs);
    let decay = (-limits.resistance * period / limits.inductance).exp();
    let gain = limits.resistance / (1.0 - decay);
    // The hexagon's edges are at this distance from its centre.
    let reach = limits.v_bus * limits.reach / 3_f64.sqrt();
    let peak = limits.peak_current();
    for k in 0..STEPS {
        for side in 0..6 {
            let along = unit(FRAC_PI_6 + FRAC_PI_3 * side as f64);
            let emf = omega_m * dot(along, mean[k]);
            let mut voltage = LinearExpr::empty();
            add(&mut voltage, currents[k], along, -decay * gain);
            match currents.get(k + 1) {
                Some(next) => add(&mut voltage, *next, along, gain),
                None => add(&mut voltage, currents[0], rotated(along, -FRAC_PI_3), gain),
            }
            program.add_constraint(voltage, ComparisonOp::Le, reach - emf);
            // A phase's axis, either way.
            let mut current = LinearExpr::empty();
            add(
                &mut current,
                currents[k],
                unit(FRAC_PI_3 * side as f64),
                1.0,
            );
            program.add_constraint(current, ComparisonOp::Le, peak);
        }
    }
    // Without a solution no profile meets the limits; no time limit is set that could interrupt.
    let best = match program.solve() {
        Ok(SolveOutcome::Solution(found)) => found.objective(),
        _ => 0.0,
    };
    let power = limits.bus_current.map(|bus| limits.v_bus * bus / omega_m);
    power.map_or(best, |most| best.min(most)).max(0.0)
}

/// Greatest speed at which a torque in Nm is possible, mechanical rad/s, from `held` on, at which it is; the
/// greatest torque falls with speed.
pub fn speed(limits: &Envelope, demand: f64, held: f64) -> f64 {
    let mut held = held;
    let mut lost = held.max(limits.idle_speed());
    while torque(limits, lost) >= demand && lost < 16.0 * limits.idle_speed() {
        held = lost;
        lost *= 2.0;
    }
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(held, lost);
        if torque(limits, middle) < demand {
            lost = middle;
        } else {
            held = middle;
        }
    }
    held
}

/// Adds `scale` times the component of a current along a vector.
fn add(sum: &mut LinearExpr, [alpha, beta]: [Variable; 2], along: Vector, scale: f64) {
    sum.add(alpha, scale * along[0]);
    sum.add(beta, scale * along[1]);
}

/// Mean EMF over a step in the plane, volt per mechanical rad/s.
fn mean_emf(limits: &Envelope, theta: f64, step: f64) -> Vector {
    let [a, b, c] = limits.mean_emf(theta, step);
    [a, (b - c) / 3_f64.sqrt()]
}

fn unit(angle: f64) -> Vector {
    [angle.cos(), angle.sin()]
}

fn rotated([alpha, beta]: Vector, angle: f64) -> Vector {
    let [cos, sin] = unit(angle);
    [cos * alpha - sin * beta, sin * alpha + cos * beta]
}

fn dot(left: Vector, right: Vector) -> f64 {
    left[0] * right[0] + left[1] * right[1]
}
