//! The core that runs a controller.

use crate::diagnostics::{Collector, catalogue};
use crate::spec::reader::Reader;
use crate::spec::words::{Words as _, words};

words! {
    /// A kind of core.
    pub enum Target {
        "portable" = Portable: "any core",
        "cortex_m4" = CortexM4: "one instruction for the upper half of a 32-bit product",
        "riscv32" = Riscv32: "RV32IM, with the same instruction",
        "cortex_m0" = CortexM0: "no such instruction: words of 16 bits where they suffice; the type's documentation states the loss of accuracy",
    }
}

/// The core that runs a controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Core {
    /// Its kind.
    pub target: Target,
    /// Its clock, hertz; none: that of the chip whose cycles were counted. Only of a named core.
    pub clock: Option<f64>,
}

impl Default for Core {
    fn default() -> Self {
        Self {
            target: Target::Portable,
            clock: None,
        }
    }
}

impl Core {
    /// Reads `target` and `core_clock`.
    pub(super) fn read(reader: &Reader, errors: &mut Collector) -> Self {
        let stated = reader.field("target");
        let target = reader.choice(errors, "target", &[]);
        let clock = reader.plain_quantity(errors, "core_clock");
        // Of a core that cannot be read nothing follows.
        let is_known = stated.is_none() || target.is_some();
        let target = target.unwrap_or(Target::Portable);
        if let Some(clock) = &clock
            && is_known
            && target == Target::Portable
        {
            let cores = Target::CHOICES.iter().zip(Target::WORDS);
            let cores = cores.filter(|(core, _)| **core != Target::Portable);
            let cores: Vec<&str> = cores.map(|(_, core)| core.word).collect();
            let at = stated.map(|field| &field.location);
            errors.push(catalogue::clock_without_core(&clock.part, &cores, at));
        }
        Self {
            target,
            clock: clock.map(|clock| clock.si),
        }
    }

    /// Its name as a word of `target`, if the specification names it.
    pub fn name(self) -> Option<&'static str> {
        (self.target != Target::Portable).then(|| self.target.word())
    }

    /// Word length in bits, and whether the core chose it: 16 bits without long products.
    pub(super) fn word_length(self, reader: &Reader, errors: &mut Collector) -> (u32, bool) {
        let preferred = (self.target == Target::CortexM0).then_some(16);
        if reader.field("word").is_none() {
            return (preferred.unwrap_or(32), preferred.is_some());
        }
        (reader.integer(errors, "word").unwrap_or(32), false)
    }
}
