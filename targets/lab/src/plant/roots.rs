//! First sign change of a polynomial: the plant's event times.

/// Depth of subdivision after which a touching point counts as no crossing.
const MAX_DEPTH: u32 = 40;

/// Value of a polynomial, lowest coefficient first.
pub(super) fn evaluate(p: &[f64], t: f64) -> f64 {
    p.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

fn derivative(p: &[f64], t: f64) -> f64 {
    p.iter()
        .enumerate()
        .skip(1)
        .rev()
        .fold(0.0, |sum, (k, c)| sum * t + k as f64 * c)
}

/// Upper bound of `|p''|` on `[0, t]`.
fn curvature_bound(p: &[f64], t: f64) -> f64 {
    p.iter()
        .enumerate()
        .skip(2)
        .rev()
        .fold(0.0, |sum, (k, c)| sum * t + (k * (k - 1)) as f64 * c.abs())
}

/// The first `t` in `(0, h]` at which `p` passes from positive to negative, or `None`.
///
/// `p` is positive just after 0: `p[0] > 0`, or `p[0] == 0` with a rising start. No crossing is
/// missed except one that dips below zero for less than about `h * 2^-40`.
pub(super) fn first_crossing(p: &[f64], h: f64) -> Option<f64> {
    let (&first, rest) = p.split_first()?;
    let reach = rest.iter().rev().fold(0.0, |sum, c| (sum + c.abs()) * h);
    if first > reach {
        return None;
    }
    // A root at 0 is the start, not a crossing.
    if first <= 0.0 {
        return if rest.is_empty() {
            None
        } else {
            search(rest, 0.0, h, 0)
        };
    }
    search(p, 0.0, h, 0)
}

fn search(p: &[f64], from: f64, to: f64, depth: u32) -> Option<f64> {
    let (at_from, at_to) = (evaluate(p, from), evaluate(p, to));
    if at_from < 0.0 {
        return Some(from);
    }
    let width = to - from;
    let curvature = curvature_bound(p, to);
    if at_to >= 0.0 {
        let sag = curvature * width * width / 8.0;
        if at_from.min(at_to) > sag || depth >= MAX_DEPTH {
            return None;
        }
    } else if derivative(p, from) + curvature * width < 0.0 || depth >= MAX_DEPTH {
        return Some(bracketed_root(p, from, to));
    }
    let middle = 0.5 * (from + to);
    search(p, from, middle, depth + 1).or_else(|| search(p, middle, to, depth + 1))
}

/// Newton's method kept inside a bracket with `p(low) >= 0 > p(high)`.
fn bracketed_root(p: &[f64], mut low: f64, mut high: f64) -> f64 {
    let mut t = 0.5 * (low + high);
    for _ in 0..100 {
        let at = evaluate(p, t);
        if at >= 0.0 {
            low = t;
        } else {
            high = t;
        }
        let newton = t - at / derivative(p, t);
        let next = if newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
        if (next - t).abs() <= 1e-15 * high {
            return next;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_first_of_several_crossings() {
        // (t - 0.2)(t - 0.3)(t - 0.9), negated so that it starts positive.
        let p = [0.054, -0.51, 1.4, -1.0];
        let t = first_crossing(&p, 1.0).unwrap();
        assert!((t - 0.2).abs() < 1e-12, "{t}");
        assert_eq!(first_crossing(&p, 0.19), None);
    }

    #[test]
    fn finds_a_dip_between_two_positive_ends() {
        // (t - 0.5)^2 - 1e-6.
        let t = first_crossing(&[0.25 - 1e-6, -1.0, 1.0], 1.0).unwrap();
        assert!((t - 0.499).abs() < 1e-12, "{t}");
        assert_eq!(first_crossing(&[0.25 + 1e-6, -1.0, 1.0], 1.0), None);
    }

    #[test]
    fn ignores_a_root_at_the_start() {
        assert_eq!(first_crossing(&[0.0, 1.0], 1.0), None);
        let t = first_crossing(&[0.0, 1.0, -2.0], 1.0).unwrap();
        assert!((t - 0.5).abs() < 1e-15, "{t}");
    }
}
