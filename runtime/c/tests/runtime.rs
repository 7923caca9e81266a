//! The C runtime against wider arithmetic, for every ADC count, and with interrupts at every
//! access; each also with planted faults, which must be found.

use hexagen_c99::{ABI, FILES, HEADER, SOURCE};
use rayon::prelude::*;
use std::path::Path;
use std::process::{Command, Output};
use std::{env, fs};

/// Strict warning flags of users' projects.
const STRICT: [&str; 8] = [
    "-std=c99",
    "-Wall",
    "-Wextra",
    "-Wconversion",
    "-Werror",
    "-pedantic",
    "-O1",
    "-DHEXAGEN_SIGNALS",
];

/// Makes the program stop at undefined behaviour.
const CHECKED: [&str; 2] = ["-fsanitize=undefined", "-fno-sanitize-recover"];

/// Compiles a file with the given texts of the runtime into `program`.
fn compile(folder: &Path, [header, source]: [&str; 2], test: &str) -> Output {
    for (name, text) in [
        ("hexagen.h", header),
        ("hexagen.c", source),
        ("test.c", test),
    ] {
        fs::write(folder.join(name), text).expect("a file");
    }
    let mut cc = Command::new(env::var_os("CC").unwrap_or_else(|| "cc".into()));
    cc.current_dir(folder).args(STRICT).args(CHECKED).args([
        "hexagen.c",
        "test.c",
        "-o",
        "program",
    ]);
    cc.output().expect("a C compiler: `cc`, or what `CC` names")
}

/// Output of a test with a runtime.
fn said(runtime: [&str; 2], test: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let built = compile(folder.path(), runtime, test);
    let messages = String::from_utf8_lossy(&built.stderr);
    assert!(built.status.success(), "{messages}");
    let run = Command::new(folder.path().join("program"))
        .output()
        .expect("it runs");
    String::from_utf8_lossy(&[run.stdout, run.stderr].concat()).into_owned()
}

/// The runtime with a part of its text replaced.
fn planted(old: &str, new: &str) -> [String; 2] {
    let [(_, header), (_, source)] = FILES;
    assert!(header.contains(old) || source.contains(old), "`{old}`");
    [header, source].map(|text| text.replacen(old, new, 1))
}

/// Those planted faults that the test does not find, or reports under another word.
fn unnoticed<'f>(test: &str, faults: &[(&'f str, &str, &'f str)]) -> Vec<(&'f str, &'f str)> {
    let faults = faults.par_iter().filter(|(name, old, new)| {
        let [header, source] = planted(old, new);
        let said = said([&header, &source], test);
        said == "no difference\n" || !said.contains(name)
    });
    faults.map(|&(name, _, new)| (name, new)).collect()
}

#[test]
fn the_abi_number_matches_the_header() {
    assert!(HEADER.contains(&format!("\n#define HEXAGEN_ABI {ABI}\n")));
    assert!(SOURCE.contains(&format!("\n#if HEXAGEN_ABI != {ABI}\n")));
    let other = HEADER.replace("#define HEXAGEN_ABI ", "#define HEXAGEN_ABI 9");
    let folder = tempfile::tempdir().expect("a folder");
    let built = compile(
        folder.path(),
        [&other, SOURCE],
        "int main(void) { return 0; }\n",
    );
    let messages = String::from_utf8_lossy(&built.stderr);
    assert!(messages.contains("take both from one"), "{messages}");
}

#[test]
fn primitives_match_their_comments() {
    const TEST: &str = include_str!("arithmetic.c");
    assert_eq!(said([HEADER, SOURCE], TEST), "no difference\n");
    let faults = [
        ("abs(", "(x < 0) ? -x", "(x < -1) ? -x"),
        ("exceeds(", "limit > UINT32_C(2)", "limit >= UINT32_C(2)"),
        (
            "divide(",
            "return (quotient < (uint32_t)limit) ? (int32_t)quotient : limit;\n}\n\nint32_t hexagen_thou",
            "return (quotient < (uint32_t)limit) ? (int32_t)(quotient & ~UINT32_C(1)) : limit;\n}\n\nint32_t hexagen_thou",
        ),
        (
            "divide(",
            "< UINT32_C(0x80000000)",
            "< UINT32_C(0x40000000)",
        ),
        (
            "divide(",
            "(is_one_digit ? 16 : 32)) >= divisor",
            "(is_one_digit ? 16 : 32)) > divisor",
        ),
        (
            "divide(",
            "limit <= INT32_C(0xffff)",
            "limit <= INT32_C(0x1ffff)",
        ),
        (
            "divide(",
            "rest = (uint32_t)(dividend >> 16);",
            "rest = (uint32_t)(dividend >> 17);",
        ),
        ("divide(", "        rest += top;\n", ""),
        (
            "divide_narrow(",
            "/ (uint32_t)denominator",
            "/ ((uint32_t)denominator + 1U)",
        ),
        (
            "mul_round(",
            "INT64_C(1) << (shift - 1)",
            "(INT64_C(1) << (shift - 1)) - 1",
        ),
        ("remainder(", "<< bits) - 1U", "<< bits) - 2U"),
        (
            "turn_over(",
            "UINT32_C(0xffffffff) /",
            "UINT32_C(0xfffffffe) /",
        ),
        ("thousandths(", "INT32_C(32767999)", "INT32_C(32767998)"),
        ("thousandths(", "limited, 31)", "limited, 31) + 1"),
        ("whole(", "INT32_C(32767))", "INT32_C(32766))"),
    ];
    assert_eq!(unnoticed(TEST, &faults), []);
}

#[test]
fn currents_of_every_count_lie_in_their_range_and_every_fault_trips() {
    const TEST: &str = include_str!("samples.c");
    assert_eq!(said([HEADER, SOURCE], TEST), "no difference\n");
    let faults = [
        (
            "line",
            "count >= limits->adc_max",
            "count > limits->adc_max",
        ),
        ("line", "hall <= 6U", "hall <= 7U"),
        (
            "line",
            "exceeds(third, limits->trip)",
            "exceeds(-third, INT32_MAX)",
        ),
        (
            "line",
            "\n        && is_sound && !hexagen_is_over",
            "\n        && (is_sound || true) && !hexagen_is_over",
        ),
        (
            "line",
            "sample->hall ^ limits->hall_inverted",
            "sample->hall ^ (limits->hall_inverted & 0U)",
        ),
        (
            "line",
            "supervisor->hall_prev == 0U || is_beside",
            "supervisor->hall_prev == 0U || is_beside || true",
        ),
        (
            "line",
            "supervisor->hall_gap = 0;\n    }\n    return is_sound",
            "}\n    return is_sound",
        ),
        ("line", "hall_gap >= limits", "hall_gap > limits"),
        (
            "line",
            "supervisor->hall_prev == 0U || supervisor->hall_gap",
            "supervisor->hall_gap",
        ),
        (
            "line",
            "< HEXAGEN_MOST_GLITCHES",
            "< HEXAGEN_MOST_GLITCHES - 1U",
        ),
        (
            "line",
            "counts > limits->bus_most",
            "counts >= limits->bus_most",
        ),
        (
            "line",
            "counts < limits->bus_least",
            "counts <= limits->bus_least",
        ),
        (
            "line",
            "supervisor->mode == HEXAGEN_MODE_RUN && !hexagen_has_end",
            "!hexagen_has_end",
        ),
        (
            "checked.i_a ==",
            "limits->sensors[sensor].inverted ? zero - word",
            "limits->sensors[sensor].inverted ? word - zero",
        ),
        (
            "checked.i_",
            "limits->sensors[sensor].inverted ? zero",
            "limits->sensors[sensor & 0U].inverted ? zero",
        ),
        (
            "checked.i_a ==",
            "== HEXAGEN_SENSED_BC)          ? third",
            "== HEXAGEN_SENSED_BC)          ? second",
        ),
        (
            "checked.i_b ==",
            "== HEXAGEN_SENSED_BC)          ? first",
            "== HEXAGEN_SENSED_BC)          ? third",
        ),
        (
            "checked.i_a ==",
            "hexagen_clamp(current, limits->current_least, limits->current_most)",
            "hexagen_clamp(current, INT32_MIN, INT32_MAX - 0 * limits->trip)",
        ),
        (
            "checked.i_",
            "(read < limits->adc_max) ? read : limits->adc_max;",
            "read;",
        ),
        (
            "supervisor.fault ==",
            "if (supervisor->mode != HEXAGEN_MODE_TRIPPED)",
            "if (true)",
        ),
        (
            "leg",
            "if (supervisor->mode == HEXAGEN_MODE_PRECHARGE\n",
            "if (supervisor->mode == HEXAGEN_MODE_CALIBRATE\n",
        ),
        (
            "line",
            "supervisor->mode == HEXAGEN_MODE_BRAKE && supervisor->countdown == 0U)",
            "false)",
        ),
        (
            "line",
            "supervisor->mode == HEXAGEN_MODE_BRAKE && supervisor->countdown == 0U)",
            "supervisor->mode == HEXAGEN_MODE_BRAKE)",
        ),
        (
            "line",
            "hexagen_unfit unfit = { false, false, 0, known };",
            "hexagen_unfit unfit = { false, false, 0, HEXAGEN_FAULT_NONE };",
        ),
        ("line", "if (known == HEXAGEN_FAULT_NONE) {", "if (true) {"),
        ("line", "sector + 1U);", "sector + 2U);"),
        ("line", "follows(now, before) ? -1 : 0", "-1"),
        (
            "line",
            "is_second = direction != 0 && direction",
            "is_second = direction",
        ),
        ("line", "direction == supervisor->turn_direction;", "true;"),
        (
            "line",
            "} else if (!is_slow(supervisor, limits)) {",
            "} else if (!is_slow(supervisor, limits) || true) {",
        ),
        ("line", "supervisor->turn_interval = 0;\n        if", "if"),
        (
            "line",
            "supervisor->turn_direction == 0 && direction != 0",
            "direction != 0",
        ),
        (
            "line",
            "(supervisor->turn_interval == 0) ? 0 : supervisor",
            "supervisor",
        ),
        (
            "line",
            "supervisor->mode != HEXAGEN_MODE_CALIBRATE && hexagen_is_over",
            "hexagen_is_over",
        ),
        (
            "line",
            "supervisor->mode != HEXAGEN_MODE_CALIBRATE && hexagen_is_over",
            "supervisor->mode == HEXAGEN_MODE_RUN && hexagen_is_over",
        ),
        ("line", "countdown = limits->start_periods", "countdown = 1"),
        (
            "line",
            "return supervisor->countdown == 0U && !is_slow",
            "return !is_slow",
        ),
        ("line", "(void)is_last(supervisor);", ""),
        (
            "line",
            "before_control(supervisor->countdown);\n        break",
            "HEXAGEN_MODE_START;\n        break",
        ),
        (
            "line",
            "supervisor->turn_interval = supervisor->turn_age;",
            "",
        ),
        (
            "line",
            "supervisor->turn_age + 1, limits",
            "supervisor->turn_age + 2, limits",
        ),
    ];
    assert_eq!(unnoticed(TEST, &faults), []);
}

/// Valid arguments of `HEXAGEN_LIMITS`, each in turn replaced by an invalid one.
#[test]
fn limits_that_contradict_each_other_do_not_compile() {
    let sound = [
        "4095",
        "false",
        "18",
        "2048",
        "1946",
        "2150",
        "509607936",
        "-563609600",
        "563347456",
        "8",
        "20",
        "0",
        "0",
        "0",
        "0x04236510",
        "0",
        "0",
        "0",
        "65535",
    ];
    let compiles = |arguments: [&str; 19]| {
        let folder = tempfile::tempdir().expect("a folder");
        let arguments = arguments.join(", ");
        let test = format!(
            "#include \"hexagen.h\"\nHEXAGEN_LIMITS(limits, {arguments});\n\
             int main(void) {{ return limits.adc_max == 0U; }}\n"
        );
        compile(folder.path(), [HEADER, SOURCE], &test)
            .status
            .success()
    };
    assert!(compiles(sound));
    let inverted = [(1, "true"), (7, "-563347456"), (8, "563609600")];
    let inverted = inverted.into_iter().fold(sound, |mut all, (place, value)| {
        all[place] = value;
        all
    });
    assert!(compiles(inverted));
    for (place, value) in [
        (0, "4094"),
        (1, "true"),
        (2, "17"),
        (2, "31"),
        (3, "1945"),
        (3, "2151"),
        (4, "1947"),
        (5, "4096"),
        (6, "0"),
        (7, "-563609601"),
        (8, "563347455"),
        (9, "16"),
        (11, "-1"),
        (11, "2147483647"),
        (15, "-1"),
        (15, "2147483647"),
    ] {
        let mut wrong = sound;
        wrong[place] = value;
        assert!(!compiles(wrong), "{place}: {value}");
    }
    // Twice the greatest current does not fit 32 bits; the longest sum of a calibration does.
    let wide = [
        "65535",
        "false",
        "15",
        "1",
        "1",
        "1",
        "9",
        "-32768",
        "2147385344",
        "8",
        "20",
        "0",
        "0",
        "0",
        "0",
        "0",
        "0",
        "0",
        "65535",
    ];
    assert!(!compiles(wide));
    let sums = [
        "65535", "false", "0", "1", "1", "1", "9", "-1", "65534", "15", "20", "0", "0", "0", "0",
        "0", "0", "0", "65535",
    ];
    assert!(compiles(sums));
}

/// Inserted before each access.
const HOOK: &str = "    hook();\n";

/// The text with a hook before each line of these functions that accesses shared state, and the
/// number of hooks.
fn hooked(text: &str, functions: &[&str], begin: &str) -> (String, usize) {
    let (mut hooked, mut hooks, mut is_inside) = (String::new(), 0, false);
    for line in text.lines() {
        let names = |name: &str| line.contains(&format!(" {name}("));
        is_inside |= !line.starts_with(' ')
            && !line.ends_with(';')
            && functions.iter().any(|name| names(name));
        is_inside &= line != "}";
        let is_access = line.starts_with(' ')
            && (line.contains("bus->") || line.contains("port->"))
            && !line.trim_start().starts_with('}');
        if is_inside && is_access {
            hooked.push_str(HOOK);
            hooks += 1;
        }
        hooked.push_str(line);
        hooked.push('\n');
        if line == begin {
            hooked.push_str("void hook(void);\n");
        }
    }
    (hooked, hooks)
}

#[test]
fn shared_state_is_consistent_under_every_interrupt() {
    const TEST: &str = include_str!("contexts.c");
    let functions = ["hexagen_pass_period", "hexagen_tell_bus", "hexagen_take"];
    let check = |[header, source]: [&str; 2]| {
        let (header, of_header) = hooked(header, &functions, "#include <stdint.h>");
        let (source, of_source) = hooked(source, &functions, "");
        assert!(
            of_header >= 6 && of_source >= 16,
            "{of_header}, {of_source} hooks"
        );
        said([&header, &source], TEST)
    };
    let sound = check([HEADER, SOURCE]);
    assert!(sound.ends_with(" 0 failures\n"), "{sound}");
    for (old, new) in [
        ("    bus->published = spare;\n", ""),
        (
            "spare = (bus->published == 0) ? 1 : 0",
            "spare = (bus->published == 0) ? 0 : 1",
        ),
        ("bus->told = judged;", "bus->told = (judged == 0) ? 1 : 0;"),
        ("bus->told = judged;", "bus->told = judged | HEXAGEN_SOUND;"),
        ("        bus->told = 0;\n", ""),
        ("bus->storing = storing - 1", "bus->storing = storing"),
        ("if (turn == 0)", "if (turn != 3)"),
        (
            "    port->turn = 0;\n    return true;",
            "    port->turn = 1;\n    return true;",
        ),
        (
            "    of_phases(signals->currents",
            "    port->turn = 1;\n    of_phases(signals->currents",
        ),
        ("    port->turn = 3;\n", ""),
    ] {
        let [header, source] = planted(old, new);
        let said = check([&header, &source]);
        assert!(!said.ends_with(" 0 failures\n"), "`{new}`: {said}");
    }
}
