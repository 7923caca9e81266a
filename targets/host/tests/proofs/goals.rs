//! What scripts leave out is missed: the graph says which goals there must be.

use crate::{VARIANTS, generated};
use hexagen_codegen::emit::gappa::{Script, Subject, emit_gappa};
use hexagen_host::checker::missing_goals;
use hexagen_host::commands::prove::collect_scripts;
use hexagen_lab::engine::{MotorSource, Prepared, library, prepare};

fn drive(variant: &str) -> Prepared {
    let motor = MotorSource::of_library("trivedi-keshri-660w").expect("is in the library");
    prepare(&motor, Some(variant)).expect("generates")
}

/// The scripts without the goals about this.
fn without(scripts: &[Script], subject: Subject) -> Vec<Script> {
    let mut scripts = scripts.to_vec();
    for script in &mut scripts {
        script.goals.retain(|goal| goal.subject != subject);
    }
    scripts
}

#[test]
fn every_drive_of_the_library_has_all_goals() {
    for motor in library() {
        for variant in VARIANTS {
            let Ok(generated) = generated(motor.text, variant) else {
                continue;
            };
            let missing = missing_goals(&generated.graph, &emit_gappa(&generated.graph));
            assert_eq!(missing, [""; 0], "{} {variant}", motor.name);
        }
    }
}

#[test]
fn a_goal_that_is_left_out_is_missed() {
    for variant in [
        "pdcc",
        "pdcc:reference=quasi_square,saturation=nearest,word=16",
        "fcs-mpc",
        "phcc",
    ] {
        let graph = drive(variant).generated.graph;
        let scripts = emit_gappa(&graph);
        for subject in [Subject::Value, Subject::Error, Subject::TieBand] {
            let some = scripts.iter().flat_map(|script| &script.goals);
            let some = some.filter(|goal| goal.subject == subject).count();
            let missing = missing_goals(&graph, &without(&scripts, subject)).len();
            assert!(
                missing >= some && some > 0,
                "{variant}: {missing} of {some} {subject:?}"
            );
        }
        for (place, script) in scripts.iter().enumerate() {
            let mut fewer = scripts.clone();
            fewer.remove(place);
            assert_ne!(
                missing_goals(&graph, &fewer),
                [""; 0],
                "{variant}: {}",
                script.name
            );
            for (number, goal) in script.goals.iter().enumerate() {
                let mut fewer = scripts.clone();
                fewer[place].goals.remove(number);
                let missing = missing_goals(&graph, &fewer);
                let names_it = missing.iter().any(|what| what.contains(&goal.expression));
                assert!(
                    names_it,
                    "{variant}: {}: {goal:?}: {missing:?}",
                    script.name
                );
                // A goal that says less than the generator is none.
                let mut weaker = scripts.clone();
                weaker[place].goals[number].high.mantissa += 1;
                assert_eq!(
                    missing_goals(&graph, &weaker),
                    missing,
                    "{variant}: {goal:?}"
                );
            }
        }
    }
}

#[test]
fn a_drive_whose_scripts_lack_goals_is_not_proved() {
    let drives = [drive("pdcc:reference=quasi_square")];
    let scripts = emit_gappa(&drives[0].generated.graph);
    let of_set_current = |script: &&Script| script.name.starts_with("set_current");
    let few: Vec<Script> = scripts.iter().filter(of_set_current).cloned().collect();
    let proved = collect_scripts(&drives, vec![few.clone()], None).expect("gappa runs");
    assert!(!proved[0].passed);
    assert_eq!(proved[0].proved, proved[0].goals, "what there is holds");
    let failures = proved[0].failures.join("\n");
    assert!(
        failures.contains("step.estimate_emf.normal: no goal for the value, e_a_seen_"),
        "{failures}"
    );
    assert!(!failures.contains("set_current"), "{failures}");
    let proved = collect_scripts(&drives, vec![without(&few, Subject::Error)], None);
    let failures = proved.expect("gappa runs")[0].failures.join("\n");
    assert!(
        failures.contains("set_current.") && failures.contains("no goal for the error, "),
        "{failures}"
    );
}
