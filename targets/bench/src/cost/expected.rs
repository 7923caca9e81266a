//! Expected figures, versioned beside each target in `cost.toml`.

use crate::BenchError;
use crate::firmware::workspace;
use crate::targets::Target;
use hexagen_lab::counted::{Counted, Figures, Longest};
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

/// Expectations of a target.
#[derive(Debug)]
pub struct Expected(pub Counted);

/// The figures by name. Those that a step lacks are 0.
fn named(figures: Figures) -> [(&'static str, u32); 12] {
    let path = |of: fn(Longest) -> u32| figures.longest.map_or(0, of);
    [
        ("normal path", figures.normal),
        ("supervision", figures.supervision.unwrap_or(0)),
        ("worst path", figures.worst),
        ("cycles", figures.cycles),
        ("code", figures.code),
        ("stack", figures.stack),
        ("longest path", path(|longest| longest.instructions)),
        (
            "longest path in control",
            path(|longest| longest.instructions_in_control),
        ),
        ("most cycles", path(|longest| longest.cycles)),
        (
            "most cycles in control",
            path(|longest| longest.cycles_in_control),
        ),
        ("core cycles", path(|longest| longest.core_cycles)),
        (
            "core cycles in control",
            path(|longest| longest.core_cycles_in_control),
        ),
    ]
}

fn path(target: Target) -> PathBuf {
    workspace()
        .join("targets")
        .join(target.name())
        .join("cost.toml")
}

impl Expected {
    /// Reads the expectations of a target.
    ///
    /// # Errors
    /// If there are none.
    pub fn read(target: Target) -> Result<Self, BenchError> {
        let path = path(target);
        let text = fs::read_to_string(&path)?;
        Counted::parse(&text)
            .map(Self)
            .map_err(|error| BenchError::Failed(format!("{}: {error}", path.display())))
    }

    /// Writes them.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&self, target: Target) -> Result<(), BenchError> {
        let text =
            toml::to_string(&self.0).map_err(|error| BenchError::Failed(error.to_string()))?;
        let head = "# Written by `cargo xtask cost --accept`; a figure that rises fails `cargo xtask cost`.\n";
        fs::write(path(target), format!("{head}{text}"))?;
        Ok(())
    }

    /// The increases. Figures of another compiler are not compared; `is_above_goal` limits them.
    pub fn rises(
        &self,
        compiler: &str,
        found: &BTreeMap<String, Figures>,
        is_above_goal: impl Fn(&str, &Figures) -> bool,
    ) -> Vec<String> {
        let mut rises = vec![];
        for (symbol, figures) in found {
            match self.0.steps.get(symbol) {
                None => rises.push(format!("{symbol} is not expected")),
                Some(expected) if self.0.compiler == compiler => {
                    for ((name, expected), (_, found)) in
                        named(*expected).into_iter().zip(named(*figures))
                    {
                        if found > expected {
                            rises.push(format!("{symbol}: {name} rose from {expected} to {found}"));
                        }
                    }
                }
                Some(expected) => {
                    if is_above_goal(symbol, figures) && !is_above_goal(symbol, expected) {
                        rises.push(format!("{symbol}: above its goal with {compiler}"));
                    }
                }
            }
        }
        let gone = self
            .0
            .steps
            .keys()
            .filter(|symbol| !found.contains_key(*symbol));
        rises.extend(gone.map(|symbol| format!("{symbol} is expected, but missing")));
        rises
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LONGEST: Longest = Longest {
        instructions: 200,
        instructions_in_control: 110,
        cycles: 600,
        cycles_in_control: 300,
        core_cycles: 250,
        core_cycles_in_control: 130,
    };

    #[test]
    fn increases_fail_and_another_compiler_fails_only_above_its_goal() {
        let figures = |normal: u32| Figures {
            normal,
            supervision: Some(normal / 2),
            worst: 100,
            cycles: 60,
            code: 200,
            stack: 8,
            longest: Some(LONGEST),
        };
        let of = |normal: u32| BTreeMap::from([("step_x".to_owned(), figures(normal))]);
        let expected = Expected(Counted {
            compiler: "rustc 1".to_owned(),
            steps: of(50),
        });
        let above = |_: &str, figures: &Figures| figures.normal > 54;
        assert_eq!(expected.rises("rustc 1", &of(50), above), [""; 0]);
        assert_eq!(expected.rises("rustc 1", &of(49), above), [""; 0]);
        assert_eq!(
            expected.rises("rustc 1", &of(51), above),
            ["step_x: normal path rose from 50 to 51"]
        );
        assert_eq!(
            expected.rises("rustc 1", &of(52), above),
            [
                "step_x: normal path rose from 50 to 52",
                "step_x: supervision rose from 25 to 26"
            ]
        );
        let longest = Some(Longest {
            instructions: 201,
            cycles_in_control: 301,
            ..LONGEST
        });
        let longer = BTreeMap::from([(
            "step_x".to_owned(),
            Figures {
                longest,
                ..figures(50)
            },
        )]);
        assert_eq!(
            expected.rises("rustc 1", &longer, above),
            [
                "step_x: longest path rose from 200 to 201",
                "step_x: most cycles in control rose from 300 to 301"
            ]
        );
        assert_eq!(expected.rises("rustc 2", &of(53), above), [""; 0]);
        assert_eq!(
            expected.rises("rustc 2", &of(55), above),
            ["step_x: above its goal with rustc 2"]
        );
        assert_eq!(
            expected.rises("rustc 1", &BTreeMap::new(), above),
            ["step_x is expected, but missing"]
        );
    }
}
