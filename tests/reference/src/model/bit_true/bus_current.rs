//! Limits of the set-point by the bus current (section "Bus current").

use super::constants::Constants;
use super::scale::Scale;
use super::state::State;
use crate::exact::{
    Coefficient, Word, all_three, both, floor_weighted, greater, input, lesser, pow2,
    round_half_up, within, word,
};
use crate::model::variant::reference_gain;
use crate::{AnyCommand, Error, Spec};
use hexagen::LegState;

/// Constants of the limits.
#[derive(Clone, Debug)]
pub struct BusCurrent<W> {
    gain: Coefficient<W>,
    /// DRAWN and RETURNED, none where not stated.
    limits: [Option<f64>; 2],
    /// 2^(n - f_i)
    from_current: f64,
    /// J_TOP
    top: W,
    /// 2^m
    from_voltage: f64,
    /// LOST
    lost: f64,
    /// MOST
    most: f64,
    delayed: bool,
    /// Ampere per word of `j_withheld`, and of `i_bus_mean`.
    amperes: [f64; 2],
}

impl<W: Word> BusCurrent<W> {
    /// `None` without a limit.
    pub fn new(spec: &Spec, scale: &Scale, k: &Constants<W>) -> Result<Option<Self>, Error> {
        let inverter = &spec.inverter;
        let stated = [inverter.bus_current_limit, inverter.return_current_limit];
        if stated == [None; 2] {
            return Ok(None);
        }
        let counts = pow2(scale.signed_bits("i_bus")?);
        let per_ampere = 2.0 * k.timer_period * counts / scale.g;
        let from_voltage = pow2(scale.extra_bits("j_withheld")?);
        let ampere = scale.w / scale.two_v / from_voltage / reference_gain(spec);
        Ok(Some(Self {
            gain: scale.coefficient("k_bus_current", 1.0 / 32.0 / ampere / per_ampere)?,
            limits: stated.map(|most| most.map(|most| (most * per_ampere + 0.5).floor())),
            from_current: counts / scale.two_i,
            from_voltage,
            top: k.k_set.mul(word(k.i_max_bits)),
            lost: round_half_up(2.0 * spec.dead_share() * k.timer_period),
            most: 4.0 * k.timer_period * (pow2(inverter.adc_bits as i32) * counts + 1.0),
            delayed: spec.loop_options().delay == 1,
            amperes: [ampere, 1.0 / per_ampere],
        }))
    }

    /// The limits of the set-point, within others.
    #[inline]
    pub fn allowed(&self, [least, most]: [Option<W>; 2], state: &State<W>) -> [Option<W>; 2] {
        let withheld = floor_weighted(state.j_withheld, 1.0 / self.from_voltage);
        let left = self.top - withheld;
        let least = least.map_or(-left, |least| greater(least, -left));
        let most = most.map_or(left, |most| lesser(most, left));
        [Some(least), Some(most)]
    }

    /// The words behind the period that begins with the currents `i`.
    #[inline]
    pub fn follow(&self, k: &Constants<W>, state: &mut State<W>, i: [W; 3], legs: AnyCommand) {
        let (compare, leg) = (legs.instants(), legs.state());
        let duty = all_three(|x| match leg[x] {
            LegState::Off if i[x] < 0.0 => word(k.timer_period),
            LegState::Off => word(0.0),
            _ => within(input::<W>(compare[x]), 0.0, k.timer_period),
        });
        let line = both(|x| duty[x] - duty[2]);
        let begins = if self.delayed { state.line_cmd } else { line };
        let counted = i.map(|i| floor_weighted(i, self.from_current));
        let paid = both(|x| (state.line_ended[x] + begins[x]) * counted[x]);
        let switched = all_three(|x| match leg[x] {
            LegState::Pulsed => counted[x].abs(),
            _ => word(0.0),
        });
        let lost = (switched[0] + switched[1] + switched[2]) * self.lost;
        let i_bus = paid[0] + paid[1] - lost;
        let moved = state.i_bus_mean + floor_weighted(i_bus - state.i_bus_mean, 1.0 / 16.0);
        let mean = within(moved, -self.most, self.most);
        let [drawn, returned] = self.limits;
        let drawn = drawn.map(|most| word::<W>(most) - mean);
        let returned = returned.map(|most| mean + word::<W>(most));
        let left = match (drawn, returned) {
            (Some(drawn), Some(returned)) => lesser(drawn, returned),
            (drawn, returned) => drawn.or(returned).unwrap_or(word(0.0)),
        };
        let top = self.top * self.from_voltage;
        state.j_withheld = within(state.j_withheld - self.gain.mul(left), 0.0, top);
        state.i_bus_mean = mean;
        state.line_ended = begins;
        state.line_cmd = line;
    }

    /// Ampere per word of `j_withheld` and of `i_bus_mean`.
    pub fn amperes(&self) -> [f64; 2] {
        self.amperes
    }
}
