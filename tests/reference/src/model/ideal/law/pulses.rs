//! From phase voltages to duties (section 11).

use super::common_mode::CommonModeRule;
use super::{Command, Inputs};
use crate::model::ideal::Duties;
use crate::model::sector;
use hexagen::LegState;
use nalgebra::Vector3;

/// Three pulsed legs, their common mode in the middle of the bus; `shifts` are shares of the
/// period.
pub fn three(
    now: &Inputs,
    u: &Vector3<f64>,
    shifts: &Vector3<f64>,
    common_mode: CommonModeRule,
) -> Command {
    let v_bus = now.v_bus;
    let half = common_mode.reach(v_bus) / 2.0;
    let centred = u.map(|u_x| (u_x - u.max().midpoint(u.min())).clamp(-half, half));
    let duties = centred / v_bus + shifts;
    let lift = common_mode.lift(&duties);
    let terminal = u.map(|u_x| (u_x - u.max().midpoint(u.min()) + v_bus / 2.0).clamp(0.0, v_bus));
    let duties = Duties {
        duty: duties
            .map(|duty| (duty + lift).clamp(0.0, common_mode.top))
            .into(),
        state: [LegState::Pulsed; 3],
        later: None,
    };
    Command {
        duties,
        terminal,
        off: None,
    }
}

/// One pulsed leg of the conducting pair, the other low, the third off; `shifts` are shares of the
/// period.
pub fn pair(
    now: &Inputs,
    u: &Vector3<f64>,
    shifts: &Vector3<f64>,
    legs: CommonModeRule,
) -> Command {
    if now.sector_eff == 0 {
        return Command::idle(Duties::OFF);
    }
    let v = u[sector::PLUS[now.sector_eff]] - u[sector::MINUS[now.sector_eff]];
    let reach = legs.reach(now.v_bus);
    line(now, v.clamp(-reach, reach), shifts, legs)
}

/// The line voltage `v` of the conducting pair, clamped to what its legs reach.
pub fn line(now: &Inputs, v: f64, shifts: &Vector3<f64>, legs: CommonModeRule) -> Command {
    let mut command = Command::idle(Duties::OFF);
    let (sector_eff, v_bus) = (now.sector_eff, now.v_bus);
    if sector_eff == 0 {
        return command;
    }
    let (plus, minus) = (sector::PLUS[sector_eff], sector::MINUS[sector_eff]);
    let (pulsed, low) = if v >= 0.0 {
        (plus, minus)
    } else {
        (minus, plus)
    };
    command.terminal[pulsed] = v.abs();
    command.duties.duty[pulsed] = (v.abs() / v_bus + shifts[pulsed]).clamp(0.0, legs.top);
    command.duties.state[pulsed] = LegState::Pulsed;
    command.duties.state[low] = LegState::Low;
    command.off = Some(sector::OUT_PHASE[sector_eff]);
    command
}
