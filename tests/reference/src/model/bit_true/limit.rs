//! Limiting to the hexagon of reachable voltages (section 10).

use super::constants::Constants;
use crate::Saturation;
use crate::exact::{
    Coefficient, Shift, WHOLE, Word, all_three, both, either, floor, floor_shift, greater, halve,
    lesser, pow2, within, word,
};
use crate::model::Reach;

/// Fraction bits of the blend between torque priority and the nearest point.
const BLEND_BITS: u32 = 15;
/// Torque priority blends over `p_max >> BLEND_SHARE` beyond its limit.
const BLEND_SHARE: u32 = 1;
/// The lighter weight is at least the largest EMF `>> LIGHT_SHARE`.
const LIGHT_SHARE: u32 = 2;
/// Torque priority needs an EMF of at least the bus `>> LEAST_EMF`.
const LEAST_EMF: u32 = 5;
const BLEND_ONE: f64 = 32_768.0;
/// Fraction bits of the ratio of bus and spread.
const SCALE_BITS: u32 = 16;
/// The phase behind each.
const NEXT: [usize; 3] = [1, 2, 0];

/// A voltage within the hexagon.
pub struct Limited<W> {
    /// Of phases a, b.
    pub u: [W; 2],
    /// Of the legs, about the middle of the bus.
    pub legs: [W; 3],
    pub reach: Reach,
    /// Greatest less least of the phase voltages, at most the bus.
    pub spread: W,
}

/// Leg voltages less a middle, within half the bus.
#[inline]
fn centred<W: Word>(v_bus: W, legs: [W; 3], middle: W) -> [W; 3] {
    let half = halve(v_bus + 1.0);
    all_three(|x| within(legs[x] - middle, -half, half))
}

/// The same less their own middle.
#[inline]
fn about_middle<W: Word>(v_bus: W, legs: [W; 3]) -> [W; 3] {
    let [a, b, c] = legs;
    let middle = halve(greater(greater(a, b), c) + lesser(lesser(a, b), c));
    centred(v_bus, legs, middle)
}

/// Phase voltages a, b of leg voltages.
#[inline]
fn phases<W: Word>(k: &Constants<W>, legs: [W; 3]) -> [W; 2] {
    let mean = k.k_third.mul(legs[0] + legs[1] + legs[2]);
    [legs[0] - mean, legs[1] - mean]
}

/// Limits phase voltages a, b; `e` is the EMF of phases a, b.
#[inline]
pub fn limit<W: Word>(
    rule: Saturation,
    k: &Constants<W>,
    v_bus: W,
    u: [W; 2],
    e: [W; 2],
) -> Limited<W> {
    let u_c = -(u[0] + u[1]);
    let max = greater(greater(u[0], u[1]), u_c);
    let min = lesser(lesser(u[0], u[1]), u_c);
    let spread = max - min;
    let all = [u[0], u[1], u_c];
    if spread <= v_bus {
        let legs = about_middle(v_bus, all);
        return Limited {
            u,
            legs,
            reach: Reach::Inside,
            spread,
        };
    }
    let (legs, reach) = match rule {
        Saturation::KeepAngle => {
            let bus = floor_shift(v_bus, k.scale_dropped);
            let short = greater(floor_shift(spread, k.scale_dropped), 1.0);
            let most = word(pow2(SCALE_BITS as i32) - 1.0);
            let ratio = bus.divide(SCALE_BITS, short, most);
            let scaled = |bits| Coefficient::new(ratio, bits);
            let [a, b] = both(|x| scaled(SCALE_BITS).mul(u[x]));
            // That of half the sum.
            let middle = scaled(SCALE_BITS + 1).mul(max + min);
            let legs = centred(v_bus, [a, b, -(a + b)], middle);
            let u = phases(k, legs);
            return Limited {
                u,
                legs,
                reach: Reach::Outside,
                spread: v_bus,
            };
        }
        Saturation::Nearest => (nearest(v_bus, all, max, min), Reach::Outside),
        Saturation::TorquePriority => {
            let near = nearest(v_bus, all, max, min);
            let f = [e[0], e[1], -(e[0] + e[1])];
            torque_priority(k, v_bus, all, f, near)
        }
    };
    let u = phases(k, legs);
    let legs = about_middle(v_bus, legs);
    Limited {
        u,
        legs,
        reach,
        spread: v_bus,
    }
}

/// The terminal voltages of the nearest point of the hexagon.
#[inline]
fn nearest<W: Word>(v_bus: W, u: [W; 3], max: W, min: W) -> [W; 3] {
    let middle = halve(max + min);
    let half_bus = halve(v_bus);
    all_three(|x| within(u[x] - middle + half_bus, 0.0, v_bus))
}

/// The legs of the point of the hexagon that keeps the component of `u` along the EMF `f`; `near`
/// are the terminals of the nearest point.
fn torque_priority<W: Word>(
    k: &Constants<W>,
    v_bus: W,
    u: [W; 3],
    f: [W; 3],
    near: [W; 3],
) -> ([W; 3], Reach) {
    let product = |x, y| k.emf_product.floor_product(x, y);
    let strong = [f[0].abs(), f[1].abs(), f[2].abs()];
    let mut d = usize::from(strong[1] > strong[0]);
    if strong[2] > strong[d] {
        d = 2;
    }
    let (x, y) = (NEXT[d], NEXT[NEXT[d]]);
    let f_max = strong[d];
    if f_max < floor_shift(v_bus, LEAST_EMF) {
        return (near, Reach::Outside);
    }
    let s1 = f[d].sign();
    let (f_x, f_y) = (greater(-s1 * f[x], 0.0), greater(-s1 * f[y], 0.0));
    let (along_x, along_y) = (s1 * (u[d] - u[x]), s1 * (u[d] - u[y]));
    let along = product(f_x, along_x) + product(f_y, along_y);
    let flip = along.sign();
    let (along_x, along_y, p, sign) = (flip * along_x, flip * along_y, along.abs(), flip * s1);
    let p_max = product(f_max, v_bus);
    let p_in = lesser(p, p_max);
    let x_is_heavy = along_x >= along_y;
    let (near_x, near_y) = (sign * (near[d] - near[x]), sign * (near[d] - near[y]));
    let q_heavy = product(either(x_is_heavy, f_x, f_y), v_bus);
    let f_light = either(x_is_heavy, f_y, f_x);
    let light_near = either(x_is_heavy, near_y, near_x);
    let n = p_in - q_heavy;
    let is_more = n >= 0.0;
    let least = floor_shift(f_max, LIGHT_SHARE);
    let den = greater(either(is_more, greater(f_light, least), f_max), 1.0);
    let quotient = n.abs().divide(k.emf_product.bits(), den, v_bus);
    let light = either(is_more, greater(quotient, light_near), -quotient);
    let heavy = lesser(light + v_bus, v_bus);
    let (mut to_x, mut to_y) = (
        either(x_is_heavy, heavy, light),
        either(x_is_heavy, light, heavy),
    );

    let mut reach = Reach::Outside;
    if p > p_max {
        reach = Reach::PastReach;
        let share = greater(floor_shift(p_max, BLEND_SHARE), 1.0);
        // Implied by the condition.
        let past = (p - p_max).known(0.0, WHOLE);
        let blend = lesser(floor(past * BLEND_ONE / share), BLEND_ONE);
        let mul15 = Shift::new(BLEND_BITS);
        to_x += mul15.round_product(blend, near_x - to_x);
        to_y += mul15.round_product(blend, near_y - to_y);
    }
    let mut legs = [word(0.0); 3];
    legs[x] = -sign * to_x;
    legs[y] = -sign * to_y;
    (legs, reach)
}
