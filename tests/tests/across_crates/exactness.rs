//! Every sum and product of the bit-true model is exact in f64, for all words that a drive's
//! formats allow.

use hexagen_lab::formats;
use hexagen_reference::exact::{Coefficient, Word, floor, input};
use hexagen_tests::exactness::{Bounded, ledger, prove_exact, prove_exact_in};
use hexagen_tests::library::{PAPER_MOTOR, motor, motors};
use hexagen_tests::options::{generate_toml, kind, kinds};
use rayon::prelude::*;

/// Drives of the paper's motor, by kind: number of elements of the product of options.
const OPTIONS: usize = 24;

/// Proves drives, and reports the longest number. Some are rejected by diagnostics.
fn prove_all(what: &str, tomls: &[(String, String)]) {
    let proofs: Vec<_> = tomls
        .par_iter()
        .filter_map(|(name, toml)| {
            let (_, generated) = generate_toml(toml).ok()?;
            let proof = prove_exact(&generated);
            Some(proof.map_err(|fault| format!("{name}: {fault}")))
        })
        .collect();
    let faults: Vec<&str> = proofs
        .iter()
        .filter_map(|proof| proof.as_ref().err())
        .map(String::as_str)
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let findings = || proofs.iter().filter_map(|proof| proof.as_ref().ok());
    let longest = findings().max_by_key(|found| found.bits);
    let longest = longest.expect("some drive is generated");
    let fewest = findings().map(|found| found.operations).min();
    println!(
        "{what}: {} drives of {} exact; {} operations or more; at most {} bits: {}",
        proofs.len(),
        tomls.len(),
        fewest.unwrap_or_default(),
        longest.bits,
        longest.place
    );
    assert!(proofs.len() * 2 > tomls.len(), "{what}: most are refused");
}

#[test]
fn of_every_motor_controller_and_word_length() {
    let mut drives = vec![];
    for motor in motors() {
        for kind in kinds() {
            for word in ["32", "16"] {
                let choice = kind.choice_of(&[("word", word)]);
                let name = format!("{}, {}, {word}-bit words", motor.name, kind.name);
                drives.push((name, kind.drive_toml(&motor, &choice, None)));
            }
        }
    }
    prove_all("library", &drives);
}

#[test]
fn of_the_paper_motor_with_every_value_of_every_option() {
    let paper = motor(PAPER_MOTOR);
    let mut drives = vec![];
    for kind in kinds() {
        for index in 0..OPTIONS {
            // A stride that shares no factor with the axes' lengths visits all their values.
            let choice = kind.product_element(index * 13_831 % kind.product_len());
            drives.push((
                kind.describe(&choice),
                kind.drive_toml(&paper, &choice, None),
            ));
        }
    }
    prove_all("options", &drives);
}

/// Too many bits of a format are detected, and a product that is not split.
#[test]
fn numbers_that_are_too_long_are_detected() {
    let kind = kind("pdcc");
    let toml = kind.drive_toml(&motor(PAPER_MOTOR), &kind.choice_of(&[]), None);
    let (_, generated) = generate_toml(&toml).expect("the paper's motor generates");
    let table = formats(&generated.interface.formats);
    let wider = |bits: i8| {
        let mut table = table.clone();
        for format in &mut table {
            if format.name == "current" {
                format.frac_bits += bits;
            }
        }
        prove_exact_in(&generated, &table)
    };
    let found = (1..24).find_map(|bits| Some((bits, wider(bits).err()?)));
    let (bits, fault) = found.expect("words of more than 53 bits");
    println!("current wider by {bits}: {fault}");
    assert!(fault.contains("bits"), "{fault}");

    let faults = |compute: &dyn Fn()| {
        ledger::begin();
        compute();
        ledger::faults().unwrap_or_default()
    };
    let largest = || input::<Bounded>(i32::MAX);
    let product = || {
        let _ = largest() * largest();
    };
    assert!(faults(&product).contains("takes 63 bits"));
    let split = || {
        let _ = Coefficient::new(2_147_483_647.0, 31).mul(largest());
    };
    assert_eq!(faults(&split), "");
    let false_lemma = || {
        let _ = Bounded::from(2.0).known(0.0, 1.0);
    };
    assert!(faults(&false_lemma).contains("2 is not from 0 to 1"));
    let quotient = || {
        let _ = input::<Bounded>(7u16) / 2.0 + 1.0;
    };
    assert!(faults(&quotient).starts_with("sum at "));
    let whole = || {
        let _ = floor(input::<Bounded>(7u16) / 2.0) + 1.0;
    };
    assert_eq!(faults(&whole), "");
}
