//! From phase voltages to pulses (section 11).

use super::common_mode::CommonModeRule;
use super::{Command, Inputs};
use crate::exact::{Word, all_three, both, floor, halve, to_u16, within, word};
use crate::model::sector;
use hexagen::{LegState, Legs};

/// A timer compare value from a word of integer and half counts.
#[inline]
fn compare<W: Word>(now: &Inputs<W>, counts: W, top: f64) -> u16 {
    to_u16(within(nearest(now, counts), 0.0, top))
}

/// The nearest whole count.
#[inline]
fn nearest<W: Word>(now: &Inputs<W>, counts: W) -> W {
    floor((counts + now.k.half_count) * now.k.to_counts)
}

/// The voltage `u` as the compare values of three legs of these duties make it: without what rounding takes.
#[inline]
pub fn written<W: Word>(now: &Inputs<W>, u: [W; 2], duties: [W; 3]) -> [W; 2] {
    let k = now.k;
    let count = 2.0 * k.half_count;
    let rests = duties.map(|duty| {
        let rest = duty + k.half_count - nearest(now, duty) * count;
        within(rest, 0.0, count - 1.0)
    });
    let mean = k.k_third.mul(rests[0] + rests[1] + rests[2]);
    both(|x| u[x] - rests[x] + mean)
}

/// The voltage with the same duty on the nominal bus.
#[inline]
fn nominal<W: Word>(now: &Inputs<W>, t: W) -> W {
    if now.k.bus.is_some() {
        now.to_duty.mul(t)
    } else {
        t
    }
}

/// The compare value, up to `top`, of a leg that is high for the fraction `t` of the bus; `shift` compensates the dead
/// time.
#[inline]
pub fn compare_up_to<W: Word>(now: &Inputs<W>, t: W, shift: W, top: f64) -> u16 {
    compare(now, nominal(now, t) + shift, top)
}

/// Three pulsed legs with voltages about the middle of the bus, and their duties; with terminal voltages if the variant keeps them. `shifts` compensate the dead time.
#[inline]
pub fn three<W: Word>(
    now: &Inputs<W>,
    centred: [W; 3],
    shifts: [W; 3],
    common_mode: &CommonModeRule<W>,
    terminals: bool,
) -> (Command<W>, [W; 3]) {
    let terminal = if terminals {
        let half_bus = halve(now.v_bus);
        all_three(|x| within(centred[x] + half_bus, 0.0, now.v_bus))
    } else {
        [word(0.0); 3]
    };
    let pulses = all_three(|x| nominal(now, centred[x]) + shifts[x]);
    let lift = common_mode.lift(now.k, pulses);
    let duties = all_three(|x| pulses[x] + lift);
    let command = Command {
        legs: Legs::new(
            all_three(|x| compare(now, duties[x], common_mode.top)),
            [LegState::Pulsed; 3],
        )
        .into(),
        terminal,
        off: 0,
    };
    (command, duties)
}

/// One pulsed leg of the conducting pair, the other low, the third off; `shifts` compensate the
/// dead time.
#[inline]
pub fn pair<W: Word>(
    now: &Inputs<W>,
    u: [W; 2],
    shifts: [W; 3],
    legs: &CommonModeRule<W>,
) -> Command<W> {
    if now.sector_eff == 0 {
        return Command::idle(Legs::OFF);
    }
    let u = [u[0], u[1], -(u[0] + u[1])];
    let v = u[sector::PLUS[now.sector_eff]] - u[sector::MINUS[now.sector_eff]];
    let reach = legs.reach(now.v_bus);
    line(now, within(v, -reach, reach), shifts, legs)
}

/// The line voltage `v` of the conducting pair, clamped to what its legs reach.
#[inline]
pub fn line<W: Word>(
    now: &Inputs<W>,
    v: W,
    shifts: [W; 3],
    legs: &CommonModeRule<W>,
) -> Command<W> {
    let mut command = Command::idle(Legs::OFF);
    let sector_eff = now.sector_eff;
    if sector_eff == 0 {
        return command;
    }
    let (plus, minus) = (sector::PLUS[sector_eff], sector::MINUS[sector_eff]);
    let (pulsed, low, t) = if v >= 0.0 {
        (plus, minus, v)
    } else {
        (minus, plus, -v)
    };
    let (mut compare, mut state) = ([0; 3], [LegState::Off; 3]);
    compare[pulsed] = compare_up_to(now, t, shifts[pulsed], legs.top);
    state[pulsed] = LegState::Pulsed;
    state[low] = LegState::Low;
    command.legs = Legs::new(compare, state).into();
    command.terminal[pulsed] = t;
    command.off = sector::OUT_PHASE[sector_eff] + 1;
    command
}
