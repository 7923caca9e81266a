//! The drive of the examples, and the registers of its motor's peripherals.
#![no_std]

pub use hexagen;
pub use hexagen_firmware::Registers;

hexagen::controller! {
    /// A drive from the motor library.
    pub HubDrive {
        motor: "../motors/trivedi-keshri-660w.toml",
        controller: pdcc {},
    }
}

/// The drive.
pub type Drive = hexagen::Drive<HubDrive>;

/// The control interrupt's half of the drive.
pub type ControlLoop = hexagen::ControlLoop<'static, HubDrive>;

/// The half of the drive for everything else.
pub type SetPoint = hexagen::SetPoint<HubDrive>;

/// ADCs, Hall port and PWM timer; on a chip, those of its peripheral access crate.
pub static REGISTERS: Registers = Registers::new();
