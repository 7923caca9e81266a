//! Limits of the set-point by the bus voltage (section "Fades").

use super::scale::Scale;
use crate::exact::{Coefficient, Word, greater, lesser, round_half_up, within};
use crate::model::variant::reference_gain;
use crate::{Error, Spec};

/// One fade.
#[derive(Clone, Debug)]
struct Slope<W> {
    factor: Coefficient<W>,
    none: f64,
    width: f64,
}

/// Constants of the fades.
#[derive(Clone, Debug)]
pub struct Fade<W> {
    braking: Option<Slope<W>>,
    motoring: Option<Slope<W>>,
}

impl<W: Word> Fade<W> {
    /// `None` without a fade.
    pub fn new(spec: &Spec, scale: &Scale) -> Result<Option<Self>, Error> {
        let inverter = &spec.inverter;
        let most = inverter.max_current * reference_gain(spec);
        let slope = |levels: Option<[f64; 2]>, name| -> Result<Option<Slope<W>>, Error> {
            let Some([full, none]) = levels else {
                return Ok(None);
            };
            let width = (full - none).abs();
            let word = |volts: f64| round_half_up(volts / scale.w * scale.two_v);
            Ok(Some(Slope {
                factor: scale.coefficient(name, most / width)?,
                none: word(none),
                width: word(width),
            }))
        };
        let braking = slope(inverter.braking_fade, "k_braking")?;
        let motoring = slope(inverter.motoring_fade, "k_motoring")?;
        let any = braking.is_some() || motoring.is_some();
        Ok(any.then_some(Self { braking, motoring }))
    }

    /// Least and greatest set-point at a bus voltage and a direction; none where unlimited.
    #[inline]
    pub fn allowed(&self, v_bus: W, direction: W) -> [Option<W>; 2] {
        let part = |slope: &Option<Slope<W>>, sign: f64| {
            let slope = slope.as_ref()?;
            let distance = (v_bus - slope.none) * sign;
            Some(slope.factor.mul(within(distance, 0.0, slope.width)))
        };
        let (braking, motoring) = (part(&self.braking, -1.0), part(&self.motoring, 1.0));
        let forward = if direction == -1.0 { braking } else { motoring };
        let backward = if direction == 1.0 { braking } else { motoring };
        [backward.map(|most| -most), forward]
    }
}

/// A set-point within the limits.
#[inline]
pub fn limited<W: Word>([least, most]: [Option<W>; 2], j: W) -> W {
    let above = least.map_or(j, |least| greater(j, least));
    most.map_or(above, |most| lesser(above, most))
}
