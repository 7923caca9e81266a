//! Field weakening (section "Field weakening").

use super::constants::Constants;
use super::scale::Scale;
use crate::exact::{
    Coefficient, Shift, Word, both, either, floor_shift, greater, lesser, pow2, round_half_up,
    within, word,
};
use crate::spec::EmfShapeKind;
use crate::{Error, Spec};

/// Greatest angle of the reference, turns.
const MOST_TURN: f64 = 75.0 / 360.0;
/// Periods in which it is reached while current is left.
const RISE: f64 = 128.0;
/// Fraction bits of the share of the torque.
const SHARE_BITS: u32 = 30;
/// Fraction bits of its slope.
const SLOPE_BITS: u32 = 26;
/// Current left over the greatest from which on the reference is even, and fraction bits of the part that is.
const EVEN: f64 = 0.25;
const EVEN_BITS: u32 = 15;

/// Constants of the field weakening.
#[derive(Clone, Copy, Debug)]
pub struct FieldWeakening<W> {
    /// Greatest set-point word.
    top: W,
    most: f64,
    step: f64,
    slope: f64,
    k_weakening: Coefficient<W>,
    square: Shift,
    loss: Shift,
    share: Shift,
    /// Of a shape with harmonics.
    even: Option<Even<W>>,
}

/// Constants of an even current against the field.
#[derive(Clone, Copy, Debug)]
struct Even<W> {
    against: Coefficient<W>,
    weight: Coefficient<W>,
    part: Shift,
}

impl<W: Word> FieldWeakening<W> {
    /// `None` without field weakening.
    pub fn new(spec: &Spec, scale: &Scale, k: &Constants<W>) -> Result<Option<Self>, Error> {
        let Some([square, fourth]) = spec.weakening_share() else {
            return Ok(None);
        };
        let turn = |turns: f64| round_half_up(turns * pow2(32));
        let top = k.k_set.mul(word::<W>(k.i_max_bits));
        let even = if spec.motor.emf_shape == EmfShapeKind::Sinusoidal {
            None
        } else {
            let most = f64::from(top.to_i32());
            let against = most / (3f64.sqrt() * turn(MOST_TURN));
            let part = pow2(EVEN_BITS as i32) / (EVEN * most);
            Some(Even {
                against: scale.coefficient("k_against", against)?,
                weight: scale.coefficient("k_even", part)?,
                part: Shift::new(EVEN_BITS),
            })
        };
        Ok(Some(Self {
            top,
            most: turn(MOST_TURN),
            step: turn(MOST_TURN / RISE),
            slope: round_half_up(square * pow2(SLOPE_BITS as i32)),
            k_weakening: scale.coefficient("k_weakening", fourth * pow2(SLOPE_BITS as i32 - 32))?,
            square: Shift::new(32),
            loss: Shift::new(32 + SLOPE_BITS - SHARE_BITS),
            share: Shift::new(SHARE_BITS),
            even,
        }))
    }

    /// The reference, and rise and fall of the angle if the voltage is cut or not: `along` is the reference along the EMF,
    /// `shape` that of one ampere, at the angle `theta`.
    #[inline]
    pub fn reference(
        &self,
        k: &Constants<W>,
        [theta, angle]: [W; 2],
        shape: [W; 2],
        j: W,
        along: [W; 2],
    ) -> ([W; 2], [W; 2]) {
        let step: W = word(self.step);
        if angle <= 0.0 {
            return (along, [step; 2]);
        }
        let pushes = j >= 0.0;
        let turned = k.shape.both(theta + either(pushes, angle, -angle));
        let square = self.square.floor_product(angle, angle);
        let slope = word::<W>(self.slope) - self.k_weakening.mul(square);
        let share = word::<W>(pow2(SHARE_BITS as i32)) - self.loss.floor_product(square, slope);
        let most = self.share.floor_product(share, self.top);
        let surplus = greater(most - either(pushes, j, -j), 0.0);
        let turned = both(|x| {
            k.shape_product.floor_product(turned[x], self.top)
                - k.shape_product.floor_product(shape[x], surplus)
        });
        let turned = turned.map(|turned| either(pushes, turned, -turned));
        let left = self.top - either(pushes, j, -j);
        let reference = match &self.even {
            Some(even) => {
                let against = even.against.mul(angle);
                let half = floor_shift(left, 1);
                let against = lesser(against, half);
                let across = both(|x| k.shape_product.floor_product(shape[x], against));
                let [a, b] = across;
                let smooth = [along[0] - (a + b + b), along[1] + (a + a + b)];
                let part = within(even.weight.mul(surplus), 0.0, pow2(EVEN_BITS as i32));
                let most = self.top + self.top + self.top + self.top;
                both(|x| {
                    let apart = smooth[x] - turned[x];
                    let evened = turned[x] + even.part.floor_product(apart, part);
                    within(evened, -most, most)
                })
            }
            None => turned,
        };
        let slow = floor_shift(step, 2);
        (
            reference,
            if surplus > 0.0 {
                [step, slow]
            } else {
                [slow, step]
            },
        )
    }

    /// The angle's new value.
    #[inline]
    pub fn follow(&self, angle: W, [rise, fall]: [W; 2], cut: bool) -> W {
        within(angle + either(cut, rise, -fall), 0.0, self.most)
    }
}
