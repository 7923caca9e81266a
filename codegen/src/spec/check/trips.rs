//! Warnings of trips in ordinary use: by the bus voltage as the motor brakes, and by a stall as it starts.

use super::motor::Motor;
use crate::diagnostics::Diagnostic;
use crate::diagnostics::catalogue::{self, StallOfStart};
use crate::spec::reader::Reader;
use crate::spec::{BusSource, Spec};
use std::f64::consts::FRAC_PI_3;

/// A trip level over the nominal bus voltage up to which a full battery may stand at it: a lithium cell of 3.6 V has
/// 4.2 V when it is full, 17 % more.
const NEAR: f64 = 1.2;

pub(super) fn check(inverter: &Reader, motor: &Motor, spec: &Spec, warnings: &mut Vec<Diagnostic>) {
    check_braking(inverter, spec, warnings);
    check_start(inverter, motor, spec, warnings);
}

/// A trip near to the nominal voltage of a measured bus, and nothing that takes braking torque back before it.
fn check_braking(reader: &Reader, spec: &Spec, warnings: &mut Vec<Diagnostic>) {
    let nominal = spec.inverter.v_bus;
    let BusSource::Measured {
        over,
        braking: None,
        max,
        ..
    } = spec.inverter.bus
    else {
        return;
    };
    let is_clamped = spec.inverter.bus_clamp.is_some_and(|clamp| clamp < over);
    if over <= 0.0 || over >= NEAR * nominal * (1.0 - 1e-9) || is_clamped {
        return;
    }
    let name = if reader.field("over_voltage").is_some() {
        "over_voltage"
    } else {
        "bus_max"
    };
    let level = reader.part(name, String::new);
    let limit = reader
        .field("return_current_limit")
        .map(|_| reader.part("return_current_limit", String::new));
    warnings.push(catalogue::trip_by_braking(
        &level,
        limit.as_ref(),
        [nominal, over.min(max)],
    ));
}

/// A stall time-out that ends before the whole current has turned the inertia through a sector from rest: no start from
/// a sector's far edge lasts less, and a load makes it longer.
fn check_start(
    reader: &Reader,
    motor: &Motor,
    spec: &Spec,
    warnings: &mut Vec<Diagnostic>,
) -> Option<()> {
    reader.field("stall_timeout")?;
    let inertia = motor.inertia?;
    let inverter = &spec.inverter;
    let timeout = f64::from(inverter.stall_periods) * inverter.t_s;
    let torque = spec.torque_constant() * inverter.max_current;
    let sector = FRAC_PI_3 * spec.motor.widest_sector() / f64::from(spec.motor.pole_pairs);
    let start = (2.0 * sector * inertia / torque).sqrt();
    if timeout > 0.0 && timeout < start {
        warnings.push(catalogue::stall_before_start(&StallOfStart {
            timeout: reader.part("stall_timeout", String::new),
            inertia,
            torque,
            start,
        }));
    }
    Some(())
}
