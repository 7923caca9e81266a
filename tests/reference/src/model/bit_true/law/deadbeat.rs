//! The deadbeat voltage (section 9).

use super::Inputs;
use super::held::Held;
use crate::Error;
use crate::exact::{Coefficient, Word, both};
use crate::model::bit_true::scale::Scale;
use crate::model::trace::Past;

/// Form of the voltage.
#[derive(Clone, Debug)]
pub enum Form<W> {
    /// From prediction and EMF.
    TwoStep(Deadbeat<W>),
    /// From the contributions of past periods.
    Held(Held<W>),
}

impl<W: Word> Form<W> {
    /// `asked`: the law uses the EMF, too.
    pub fn new(asked: bool, scale: &Scale) -> Result<Self, Error> {
        Ok(if scale.variant.holds() {
            Self::Held(Held::new(asked, scale)?)
        } else {
            Self::TwoStep(Deadbeat::new(scale)?)
        })
    }

    /// Phases a, b, not limited.
    #[inline]
    pub fn voltage(&self, now: &Inputs<W>) -> [W; 2] {
        match self {
            Self::TwoStep(form) => form.voltage(now),
            Self::Held(form) => form.voltage(now),
        }
    }

    /// EMF of phases a, b.
    #[inline]
    pub fn emf(&self, now: &Inputs<W>) -> [W; 2] {
        match self {
            Self::TwoStep(_) => now.e,
            Self::Held(form) => form.emf(now),
        }
    }

    /// The part of the measured current left when the voltage takes effect, as a voltage.
    #[inline]
    pub fn kept(&self, now: &Inputs<W>) -> [W; 2] {
        match self {
            Self::TwoStep(form) => form.held(now),
            Self::Held(form) => form.kept(now),
        }
    }

    /// Contribution of the currents and the voltage `u` to later steps.
    #[inline]
    pub fn past(&self, now: &Inputs<W>, u: [W; 2]) -> Past<W> {
        match self {
            Self::TwoStep(_) => now.past,
            Self::Held(form) => form.past(now, u),
        }
    }
}

/// Coefficients of the deadbeat voltage.
#[derive(Clone, Debug)]
pub struct Deadbeat<W> {
    delayed: bool,
    k_hold: Coefficient<W>,
    k_decay: Coefficient<W>,
}

impl<W: Word> Deadbeat<W> {
    fn new(scale: &Scale) -> Result<Self, Error> {
        let (a, b) = (scale.phase.a, scale.phase.b);
        let delayed = scale.variant.delayed();
        let held = if delayed { a * a } else { a };
        Ok(Self {
            delayed,
            k_hold: scale.coefficient("k_hold", scale.ohm * held / b)?,
            k_decay: scale.only_if(delayed, "k_decay", b * scale.resistance)?,
        })
    }

    /// The measured current as a voltage, phases a, b.
    #[inline]
    fn held(&self, now: &Inputs<W>) -> [W; 2] {
        both(|x| self.k_hold.mul(now.i[x]))
    }

    /// Phases a, b, not limited.
    #[inline]
    fn voltage(&self, now: &Inputs<W>) -> [W; 2] {
        let held = self.held(now);
        both(|x| {
            let held = now.j[x] - held[x];
            if self.delayed {
                held + self.k_decay.mul(now.net[x]) + now.e[x] - now.net[x]
            } else {
                held + now.e[x]
            }
        })
    }
}
