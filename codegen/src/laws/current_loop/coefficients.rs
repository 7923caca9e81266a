//! Coefficients of the predictive laws as words.

use super::CurrentLoop;
use crate::ir::Coefficient;

impl CurrentLoop<'_, '_> {
    /// Weight of the present current in the deadbeat voltage.
    pub(super) fn k_hold(&self) -> Coefficient {
        let symbol = if self.options.delay == 1 {
            "K a^2"
        } else {
            "K a"
        };
        let doc = "Contribution of the present current when the voltage takes effect.";
        let (value, word) = (self.design.k_hold, self.options.word);
        self.l
            .impedance("k_hold", value, word, doc, [symbol, "V/A"])
    }

    /// 1 - a.
    pub(super) fn k_decay(&self) -> Coefficient {
        let (value, word) = (self.design.k_decay, self.options.word);
        let doc = "Share of current lost in one period.";
        let physical = format!("1 - a = {value:.6}");
        self.l.coefficient("k_decay", value, word, doc, &physical)
    }

    /// K.
    pub fn k_di(&self) -> Coefficient {
        let (value, word) = (self.design.k_di, self.options.word);
        let doc = "K = 1/b: voltage over one period per change of current.";
        self.l.impedance("k_di", value, word, doc, ["K", "V/A"])
    }

    /// R.
    pub(super) fn k_r(&self) -> Coefficient {
        let (value, word) = (self.design.k_r, self.options.word);
        let doc = "(1 - a)/b = R: resistive drop.";
        self.l.impedance("k_r", value, word, doc, ["R", "ohm"])
    }
}
