//! Without the feature `signals` nobody asks for any.

use crate::Checked;
use crate::control::Observation;

/// Nothing.
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
