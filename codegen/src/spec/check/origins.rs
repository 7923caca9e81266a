//! Where the values of a checked specification were written, for the errors of later stages.

use super::emf;
use crate::diagnostics::catalogue::Part;
use crate::diagnostics::{Diagnostic, Location};
use crate::spec::ast::{Section, SpecAst};
use std::collections::BTreeMap;

/// Places and texts of all fields, by paths such as `motor.inductance_tolerance`.
#[derive(Clone, Debug)]
pub struct Origins {
    name: Location,
    sections: BTreeMap<&'static str, Location>,
    fields: BTreeMap<String, Origin>,
    board_bus: Option<f64>,
    warnings: Vec<Diagnostic>,
}

/// Where and how a field was written.
#[derive(Clone, Debug)]
pub struct Origin {
    /// The value as written, e.g. `10 %`.
    pub given: String,
    /// Where it was written.
    pub location: Location,
    /// Why it was assumed, where the data sheet lacks it.
    pub assumed: Option<String>,
}

impl Origins {
    /// Of a specification whose inverter and controller have their board's fields.
    pub(super) fn new(
        ast: &SpecAst,
        inverter: &Section,
        controller: &Section,
        warnings: Vec<Diagnostic>,
    ) -> Self {
        let mut origins = Self {
            name: ast.name.location.clone(),
            sections: BTreeMap::new(),
            fields: BTreeMap::new(),
            board_bus: ast.board_bus(),
            warnings,
        };
        origins.take("motor", &ast.motor);
        origins.take("inverter", inverter);
        origins.take("controller", controller);
        origins
    }

    fn take(&mut self, name: &'static str, section: &Section) {
        if let Some(location) = &section.location {
            self.sections.insert(name, location.clone());
        }
        for field in &section.fields {
            let origin = Origin {
                given: field.value.to_string(),
                location: field.location.clone(),
                assumed: field.assumed.clone(),
            };
            self.fields.insert(format!("{name}.{}", field.name), origin);
        }
    }

    /// Where the field of `path` was written; for a default, where its section or the drive's
    /// name stands.
    pub fn at(&self, path: &str) -> &Location {
        let section = path.split('.').next().unwrap_or_default();
        self.fields
            .get(path)
            .map(|origin| &origin.location)
            .or_else(|| self.sections.get(section))
            .unwrap_or(&self.name)
    }

    /// Whether the field was written.
    pub fn is_given(&self, path: &str) -> bool {
        self.fields.contains_key(path)
    }

    /// The field's value as written, or `default` marked as one.
    pub fn given(&self, path: &str, default: &str) -> String {
        self.fields.get(path).map_or_else(
            || format!("{default} (default)"),
            |origin| origin.given.clone(),
        )
    }

    /// A field of the motor without default.
    pub fn of_motor(&self, field: &'static str) -> Part {
        let path = format!("motor.{field}");
        Part {
            field,
            given: self.given(&path, ""),
            location: self.at(&path).clone(),
        }
    }

    /// The field from which the EMF constant was taken.
    pub fn emf_constant(&self) -> Part {
        let is_given = |field: &&str| self.is_given(&format!("motor.{field}"));
        let field = emf::FIELDS.into_iter().find(is_given);
        self.of_motor(field.unwrap_or(emf::FIELDS[0]))
    }

    /// Greatest bus voltage that the board states, volt, whether or not the bus is measured.
    pub fn board_bus(&self) -> Option<f64> {
        self.board_bus
    }

    /// What the checks warn of: values that fit, and are probably not meant so.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// Every field that was written, by path.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &Origin)> {
        self.fields
            .iter()
            .map(|(path, origin)| (path.as_str(), origin))
    }
}
