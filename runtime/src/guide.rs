//! Guide: from a data sheet to a motor that turns.
//!
//! Read the first three chapters before the first drive, the next three with the board on the
//! bench, and the rest when a question brings you there. Every example of Rust and C is compiled and
//! run in a test; every figure names the command that prints it.
//!
//! 1. [`first_drive`]: dependencies, macro, interrupt, start and stop, faults, a test.
//! 2. [`controllers`]: which controller to take.
//! 3. [`data_sheets`]: bases, constants, delta windings; Maxon, outrunners, hub motors.
//! 4. [`boards`]: current sensors, their window, their offsets; the library of boards.
//! 5. [`interrupt`]: what happens when in a control period, and how long a step takes.
//! 6. [`bring_up`]: the first hours with a board.
//! 7. [`tuning`]: what each option changes, in figures.
//! 8. [`troubleshooting`]: from the symptom to the cause.
//! 9. [`snapshots`]: a test that shows when generated code changes.
//! 10. [`two_motors`]: two drives in one firmware.
//! 11. [`in_c`]: the same drives as C99.
//! 12. [`fixed_and_float`]: what fixed point costs in accuracy.
//! 13. [`proofs`]: what is proven, what is tested, and what is neither.
//! 14. [`theory`]: the model of the motor and the four laws.
//! 15. [`glossary`]: terms and symbols.

/// Chapter 1: dependencies, macro, interrupt, start and stop, faults, a test.
///
#[cfg_attr(doc, doc = include_str!("guide/first_drive.md"))]
pub mod first_drive {}
/// Chapter 2: which controller to take.
///
#[cfg_attr(doc, doc = include_str!("guide/controllers.md"))]
pub mod controllers {}
/// Chapter 3: bases, constants, delta windings; Maxon, outrunners, hub motors.
///
#[cfg_attr(doc, doc = include_str!("guide/data_sheets.md"))]
pub mod data_sheets {}
/// Chapter 4: current sensors, their window, their offsets; the library of boards.
///
#[cfg_attr(doc, doc = include_str!("guide/boards.md"))]
pub mod boards {}
/// Chapter 5: what happens when in a control period, and how long a step takes.
///
#[cfg_attr(doc, doc = include_str!("guide/interrupt.md"))]
pub mod interrupt {}
/// Chapter 6: the first hours with a board.
///
#[cfg_attr(doc, doc = include_str!("guide/bring_up.md"))]
pub mod bring_up {}
/// Chapter 7: what each option changes, in figures.
///
#[cfg_attr(doc, doc = include_str!("guide/tuning.md"))]
pub mod tuning {}
/// Chapter 8: from the symptom to the cause.
///
#[cfg_attr(doc, doc = include_str!("guide/troubleshooting.md"))]
pub mod troubleshooting {}
/// Chapter 9: a test that shows when generated code changes.
///
#[cfg_attr(doc, doc = include_str!("guide/snapshots.md"))]
#[cfg_attr(doc, doc = "```rs")]
#[cfg_attr(doc, doc = include_str!("guide/generated_code.rs"))]
#[cfg_attr(doc, doc = "```")]
#[cfg_attr(doc, doc = include_str!("guide/snapshots_end.md"))]
pub mod snapshots {}
/// Chapter 10: two drives in one firmware.
///
#[cfg_attr(doc, doc = include_str!("guide/two_motors.md"))]
pub mod two_motors {}
/// Chapter 11: the same drives as C99.
///
#[cfg_attr(doc, doc = include_str!("guide/in_c.md"))]
pub mod in_c {}
/// Chapter 12: what fixed point costs in accuracy.
///
#[cfg_attr(doc, doc = include_str!("guide/fixed_and_float.md"))]
pub mod fixed_and_float {}
/// Chapter 13: what is proven, what is tested, and what is neither.
///
#[cfg_attr(doc, doc = include_str!("guide/proofs.md"))]
pub mod proofs {}
/// Chapter 14: the model of the motor and the four laws.
///
#[cfg_attr(doc, doc = include_str!("guide/theory.md"))]
pub mod theory {}
/// Chapter 15: terms and symbols.
///
#[cfg_attr(doc, doc = include_str!("guide/glossary.md"))]
pub mod glossary {}
