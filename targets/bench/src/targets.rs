//! The targets: their compiler's name, folder and emulated machine.

use clap::ValueEnum;
use std::process::Command;

/// A core with firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Target {
    /// ARMv7E-M, as `mps2-an386`
    CortexM4,
    /// ARMv6-M, as `microbit`; counted on `mps2-an385`
    CortexM0,
    /// RV32IMC, as `virt`
    Riscv32,
}

/// Purpose of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Answers only, at full speed.
    Answers,
    /// Counts of instructions, which drive the emulator's clock.
    Counts,
    /// A log of all instructions, one by one, in the file `log`.
    Trace,
}

impl Target {
    /// All targets, in the order of reports.
    pub const ALL: [Self; 3] = [Self::CortexM4, Self::CortexM0, Self::Riscv32];

    /// Folder under `targets/`, and name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::CortexM4 => "cortex-m4",
            Self::CortexM0 => "cortex-m0",
            Self::Riscv32 => "riscv32",
        }
    }

    /// The compiler's name.
    pub fn triple(self) -> &'static str {
        match self {
            Self::CortexM4 => "thumbv7em-none-eabi",
            Self::CortexM0 => "thumbv6m-none-eabi",
            Self::Riscv32 => "riscv32imc-unknown-none-elf",
        }
    }

    /// The C compiler's program, for C drives.
    pub fn c_compiler(self) -> &'static str {
        match self {
            Self::CortexM4 | Self::CortexM0 => "arm-none-eabi-gcc",
            Self::Riscv32 => "riscv64-unknown-elf-gcc",
        }
    }

    /// The disassembler, which is installed with the C compiler.
    pub fn disassembler(self) -> &'static str {
        match self {
            Self::CortexM4 | Self::CortexM0 => "arm-none-eabi-objdump",
            Self::Riscv32 => "riscv64-unknown-elf-objdump",
        }
    }

    /// The emulator's program.
    pub fn emulator(self) -> &'static str {
        match self {
            Self::CortexM4 | Self::CortexM0 => "qemu-system-arm",
            Self::Riscv32 => "qemu-system-riscv32",
        }
    }

    /// The emulator's option for executing instructions one by one: renamed in version 8.1; the old
    /// name was removed later.
    fn single_steps(self) -> Vec<&'static str> {
        let version = Command::new(self.emulator()).arg("--version").output();
        let major = version.ok().and_then(|output| {
            let text = String::from_utf8(output.stdout).ok()?;
            let (_, version) = text.split_once("version ")?;
            version.split('.').next()?.parse::<u32>().ok()
        });
        if major.is_some_and(|major| major < 9) {
            vec!["-singlestep"]
        } else {
            vec!["-accel", "tcg,one-insn-per-tb=on"]
        }
    }

    /// The emulator's machine and clock. SysTick of the MPS2 boards ticks every 40 ns, so that
    /// `shift=10`, 1024 ns per instruction, resolves each; the `microbit` has none that fits, and
    /// the Cortex-M3 of `mps2-an385` executes all instructions of a Cortex-M0, from the same
    /// addresses.
    pub fn machine(self, purpose: Purpose) -> Vec<&'static str> {
        let mut arguments = match (self, purpose) {
            (Self::CortexM4, _) => vec!["-machine", "mps2-an386"],
            (Self::CortexM0, Purpose::Answers) => vec!["-machine", "microbit"],
            (Self::CortexM0, _) => vec!["-machine", "mps2-an385"],
            (Self::Riscv32, _) => vec!["-machine", "virt", "-bios", "none"],
        };
        if purpose == Purpose::Trace {
            arguments.extend(self.single_steps());
            arguments.extend(["-d", "exec,nochain", "-D", "log"]);
        }
        if purpose == Purpose::Counts {
            let shift = match self {
                Self::CortexM4 | Self::CortexM0 => "shift=10",
                Self::Riscv32 => "shift=0",
            };
            arguments.extend(["-icount", shift]);
        }
        arguments
    }
}
