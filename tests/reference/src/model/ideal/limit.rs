//! Limiting to the hexagon of reachable voltages (section 10), as plane geometry.

use crate::Saturation;
use crate::model::Reach;
use nalgebra::Vector3;

/// A limited voltage.
#[derive(Clone, Copy, Debug)]
pub struct Limited {
    /// Phase voltages, zero sum, volt.
    pub u: Vector3<f64>,
    /// Position of the voltage before limiting.
    pub reach: Reach,
    /// Greatest less least phase voltage, at most the bus.
    pub spread: f64,
}

/// Limits the zero-sum phase voltages `u` to the hexagon of bus voltage `v_bus`; `f` are the
/// zero-sum phase EMFs, used by torque priority.
pub fn limit(rule: Saturation, u: &Vector3<f64>, f: &Vector3<f64>, v_bus: f64) -> Limited {
    let spread = u.max() - u.min();
    if spread <= v_bus {
        return Limited {
            u: *u,
            reach: Reach::Inside,
            spread,
        };
    }
    let mut reach = Reach::Outside;
    let u = match rule {
        Saturation::KeepAngle => u * (v_bus / spread),
        Saturation::Nearest => nearest(u, v_bus),
        Saturation::TorquePriority if f.amax() < v_bus * LEAST_EMF => nearest(u, v_bus),
        Saturation::TorquePriority => {
            let p = u.dot(f);
            let p_max = v_bus * f.amax();
            if p.abs() > p_max {
                reach = Reach::PastReach;
            }
            let near = nearest(u, v_bus);
            let kept = clip_across(u, f, &near, v_bus);
            let blend = ((p.abs() - p_max) / (p_max * BLEND_SHARE)).clamp(0.0, 1.0);
            kept + (near - kept) * blend
        }
    };
    Limited {
        u,
        reach,
        spread: v_bus,
    }
}

/// Fraction of the limit over which torque priority blends into the nearest point.
const BLEND_SHARE: f64 = 1.0 / 2.0;
/// EMF below which torque has no preferred direction, as a fraction of the bus.
const LEAST_EMF: f64 = 1.0 / 32.0;
/// Least weight of a line-to-line voltage, as a share of the largest EMF.
const LIGHT_SHARE: f64 = 1.0 / 4.0;

/// The nearest point of the hexagon: the terminal voltages clipped about their middle.
fn nearest(u: &Vector3<f64>, v_bus: f64) -> Vector3<f64> {
    let middle = u.max().midpoint(u.min());
    let clipped = u.map(|u_x| (u_x - middle).clamp(-v_bus / 2.0, v_bus / 2.0));
    clipped.add_scalar(-clipped.mean())
}

/// The point on the hexagon's edge, on `u`'s side, that has `u`'s scalar product with `f`, or the
/// greatest that the hexagon gives.
///
/// Seen from the phase d of the largest EMF, the hexagon is |X|, |Y|, |X - Y| <= v_bus in the
/// line-to-line voltages X, Y to the two others, and p = f_x X + f_y Y with weights of one sign.
/// Where the lighter one's weight vanishes it would jump along the edge; the floor under its
/// weight keeps it continuous for less than the demanded product, and so does never giving it less
/// than `near`, the nearest point, does (whose product is never above the demanded one).
fn clip_across(
    u: &Vector3<f64>,
    f: &Vector3<f64>,
    near: &Vector3<f64>,
    v_bus: f64,
) -> Vector3<f64> {
    let d = f.iamax();
    let (x, y) = ((d + 1) % 3, (d + 2) % 3);
    let p = u.dot(f);
    // Turned so that product and weights are positive.
    let turn = if p < 0.0 { -1.0 } else { 1.0 };
    let sense = turn * f[d].signum();
    let across = |other: usize| sense * (u[d] - u[other]);
    let weight = |other: usize| (-f[d].signum() * f[other]).max(0.0);
    let (heavy, light) = if across(x) >= across(y) {
        (x, y)
    } else {
        (y, x)
    };
    // Beyond the limit the missing part is at least zero, whatever rounding gives.
    let p_heavy = weight(heavy) * v_bus;
    let missing = p.abs().min(f[d].abs() * v_bus) - p_heavy;
    let to_light = if p.abs() >= p_heavy {
        (missing.max(0.0) / weight(light).max(f[d].abs() * LIGHT_SHARE))
            .min(v_bus)
            .max(sense * (near[d] - near[light]))
    } else {
        (missing / f[d].abs()).max(-v_bus)
    };
    let to_heavy = (to_light + v_bus).min(v_bus);
    let mut kept = Vector3::zeros();
    kept[d] = sense * (to_heavy + to_light) / 3.0;
    kept[heavy] = kept[d] - sense * to_heavy;
    kept[light] = kept[d] - sense * to_light;
    kept
}
