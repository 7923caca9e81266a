//! What the field of a name takes: kind of value, bases, and examples for messages.

use super::basis::Basis;
use super::rule::{Kind, Rule};
use super::units::{Dimension, Unit};
use crate::diagnostics::catalogue::with_meanings;

/// A name, and the rule of the field that has it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldRule<'n> {
    /// The name.
    pub name: &'n str,
    /// None where no field is called so.
    pub rule: Option<&'static Rule>,
}

impl FieldRule<'_> {
    /// Whether the field takes free text.
    pub fn is_text(self) -> bool {
        self.rule
            .is_some_and(|rule| matches!(rule.kind, Kind::Text))
    }

    /// Whether the field takes a list of values in brackets: one of each sensed phase in place of
    /// one for all, of each Hall edge, or of an EMF shape.
    pub fn takes_each(self) -> bool {
        matches!(
            self.name,
            "adc_gain"
                | "adc_offset"
                | "adc_inverted"
                | "hall_angles"
                | "emf_amplitudes"
                | "emf_phases"
                | "emf_samples"
        )
    }

    /// The quantities that the field takes; none for other kinds.
    pub fn dimensions(self) -> &'static [Dimension] {
        match self.rule.map(|rule| rule.kind) {
            Some(Kind::Quantity { dimensions, .. }) => dimensions,
            _ => &[],
        }
    }

    /// An example of the field's value.
    pub fn example(self) -> &'static str {
        self.rule.map_or("20 A", |rule| rule.example)
    }

    /// The usual unit of the field's value; none of a plain number or a word.
    fn unit(self) -> Option<&'static str> {
        if self.dimensions().is_empty() {
            return None;
        }
        let first = self.example().trim_start_matches('[').split(',').next()?;
        let (_, unit) = first.split_once(' ')?;
        // Basis words may follow.
        let ends = unit.match_indices(' ').map(|(space, _)| space);
        let ends = ends.chain([unit.len()]).rev();
        let mut units = ends.map(|end| &unit[..end]);
        units.find(|unit| Unit::parse(unit).is_some())
    }

    /// What to write for a field that is missing, a clause: its name with its unit, or an example.
    pub fn form(self) -> String {
        let (name, example) = (self.name, self.example());
        self.unit().map_or_else(
            || format!("`{name}: {example}`"),
            |unit| format!("`{name}` in {unit}"),
        )
    }

    /// What a number must be given with, a clause: a unit, and the bases where there is a choice that `named` does not
    /// make. No number or basis is taken from the example: the reader might keep it.
    pub fn unit_to_give(self, named: &[Basis]) -> String {
        let Some(unit) = self.unit() else {
            return "give a plain number".to_owned();
        };
        let references = self.references();
        let is_named = references.iter().any(|(basis, _)| named.contains(basis));
        if references.is_empty() || is_named {
            return format!("give a unit such as `{unit}`");
        }
        let words: Vec<(&str, &str)> = references
            .iter()
            .map(|(basis, meaning)| (basis.word(), *meaning))
            .collect();
        format!(
            "give a unit such as `{unit}`, with {}",
            with_meanings(&words)
        )
    }

    /// Examples of the field's value, one for each possible basis, so that no basis is suggested
    /// over another. `named`: the basis words of the given value.
    pub fn examples(self, named: &[Basis]) -> Vec<String> {
        let (example, references) = (self.example(), self.references());
        let Some((own, _)) = references
            .iter()
            .find(|(basis, _)| example.contains(basis.word()))
        else {
            // A basis that was not named is none to suggest.
            let bare = example.trim_end_matches(" block_mean");
            let is_named = named.contains(&Basis::BlockMean);
            return vec![if is_named { example } else { bare }.to_owned()];
        };
        let is_named = references.iter().any(|(basis, _)| named.contains(basis));
        references
            .iter()
            .filter(|(basis, _)| !is_named || named.contains(basis))
            .map(|(basis, _)| example.replace(own.word(), basis.word()))
            .collect()
    }

    /// All bases that the field's value takes, with their meanings: [references](Self::references), and
    /// which number of a wave it is.
    pub fn bases(self) -> &'static [(Basis, &'static str)] {
        match self.name {
            "speed_constant" => &[
                (Basis::BlockMean, "mean over block commutation"),
                (Basis::Peak, "amplitude between two terminals"),
                (Basis::Rms, "root mean square between two terminals"),
            ],
            "rated_current" => &[
                (Basis::Peak, "of the block or sine wave"),
                (Basis::Rms, "of the phase current"),
            ],
            _ => self.references(),
        }
    }

    /// The possible bases of the field's value with their meanings; empty where there is no choice.
    pub fn references(self) -> &'static [(Basis, &'static str)] {
        match self.name {
            "resistance" | "inductance" => &[
                (Basis::PerPhase, "of one winding"),
                (Basis::LineToLine, "between two terminals"),
            ],
            "back_emf" => &[
                (Basis::Phase, "of one phase"),
                (Basis::LineToLine, "between two terminals"),
            ],
            "torque_constant" => &[
                (Basis::BlockMean, "per ampere of block commutation"),
                (Basis::PerPeakAmpere, "per ampere of the current's peak"),
                (Basis::PerRmsAmpere, "per ampere of its root mean square"),
            ],
            _ => &[],
        }
    }
}
