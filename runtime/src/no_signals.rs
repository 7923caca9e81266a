//! Stand-in for `signals` without that feature: never requested.

use crate::Checked;
use crate::control::Observation;

/// No words.
#[derive(Debug)]
pub(crate) struct Port;

impl Port {
    pub(crate) const fn new() -> Self {
        Self
    }

    #[inline]
    pub(crate) const fn is_asked(&self) -> bool {
        false
    }

    #[inline]
    pub(crate) fn answer(&self, _: Checked, _: [Option<u16>; 3], _: Observation) {}
}
