//! The body of a control interrupt, and the counter of a whole one.

use crate::counter::interrupt_step;
use crate::link::{Broken, Link};
use crate::registers::Registers;
use crate::session::measure;
use crate::wire::{HEADER, Mode, RECORD, Record, Task};
use hexagen::fixed::types::I16F16;
use hexagen::{Control, ControlLoop, Legs, SetPoint};

/// One control period: two ADC registers and the Hall port are read, three compare registers and
/// the output enables are written.
#[inline]
pub fn control_period<C: Control<Command = Legs>>(
    control: &mut ControlLoop<'_, C>,
    registers: &Registers,
) {
    let legs = control.step(&registers.sample());
    registers.apply(legs);
}

/// Counts an interrupt that is called as a function: the core's own entry and exit are not
/// included.
///
/// # Errors
/// If the exchange ends early.
pub fn serve<C: Control>(
    link: &mut dyn Link,
    set_point: &SetPoint<C>,
    registers: &Registers,
    reset: impl Fn(),
    interrupt: extern "C" fn(),
) -> Result<(), Broken> {
    let mut header = [0; HEADER];
    link.read(&mut header)?;
    let task = Task::decode(header).ok_or(Broken::Format)?;
    let step = interrupt_step(interrupt);
    let mut depth = 0;
    let mut record = [0; RECORD];
    while link.read(&mut record)? == RECORD {
        match Record::decode(record).ok_or(Broken::Format)? {
            Record::Step(sample) => {
                registers.feed(&sample);
                measure(task.mode, step, &mut (), sample, &mut depth, link)?;
            }
            Record::SetCurrent(bits) => set_point.set_current(I16F16::from_bits(bits)),
            Record::New => reset(),
            _ => return Err(Broken::Format),
        }
    }
    if task.mode == Mode::Stack {
        link.write(&depth.to_le_bytes())?;
    }
    Ok(())
}
