//! Longest paths of assembled functions, as the disassembler prints them.

use super::code::Code;
use super::listing::Listing;
use super::{Program, check, chip};
use crate::cost::elf::{Image, Isa};
use crate::targets::Target;
use hexagen_lab::counted::Longest;
use std::ops::Range;

/// A program of this text, on the chip of a Cortex-M4.
fn program<'a>(image: &'a Image, text: &str) -> Program<'a> {
    Program {
        code: Code::new(image, Listing::parse(text)),
        chip: chip(Target::CortexM4),
    }
}

/// The longest path of the first function, or the error's text.
fn longest(isa: Isa, functions: &[(&str, Range<u32>)], text: &str) -> Result<u32, String> {
    let image = Image::of_functions(isa, functions, (0, vec![]));
    let longest = program(&image, text)
        .longest("f")
        .map(|longest| longest.instructions);
    longest.map_err(|error| error.to_string())
}

fn thumb(functions: &[(&str, Range<u32>)], text: &str) -> Result<u32, String> {
    longest(Isa::Thumb, functions, text)
}

/// Checks that the search refuses a function, and what it says.
fn refuses(functions: &[(&str, Range<u32>)], text: &str, reason: &str) {
    let error = thumb(functions, text).expect_err("it is refused");
    assert!(error.contains(reason), "{error}");
}

#[test]
fn the_longer_arm_of_a_diamond_counts() {
    let text = "\
0:\tcmp\tr0, #1
2:\tbne.n\t8 <f+0x8>
4:\tmovs\tr0, #2
6:\tb.n\te <f+0xe>
8:\tadds\tr0, #1
a:\tadds\tr0, #1
c:\tadds\tr0, #1
e:\tbx\tlr
";
    assert_eq!(thumb(&[("f", 0..16)], text), Ok(6));
}

#[test]
fn a_condition_tested_twice_has_one_outcome() {
    let text = |between: &str| {
        format!(
            "\
0:\tcmp\tr0, #1
2:\tbne.n\t8 <f+0x8>
4:\tmov\tr3, r1
6:\tmov\tr3, r1
8:\t{between}\tr2, r3
a:\tbeq.n\t10 <f+0x10>
c:\tmov\tr3, r1
e:\tmov\tr3, r1
10:\tbx\tlr
"
        )
    };
    // Either both moves in front or both behind; any of them if flags change in between.
    assert_eq!(thumb(&[("f", 0..18)], &text("mov")), Ok(7));
    assert_eq!(thumb(&[("f", 0..18)], &text("adds")), Ok(9));
}

#[test]
fn an_it_block_counts_its_instructions_and_may_return() {
    let text = "\
0:\tcmp\tr0, #1
2:\titt\tcs
4:\tmovcs\tr0, #2
6:\tpopcs\t{r7, pc}
8:\tadds\tr0, #1
a:\tpop\t{r7, pc}
";
    assert_eq!(thumb(&[("f", 0..12)], text), Ok(6));
}

#[test]
fn calls_and_tail_calls_add_the_callee() {
    let functions = [("f", 0..8), ("g", 8..12), ("h", 12..16)];
    let text = "\
0:\tpush\t{r4, lr}
2:\tbl\t8 <g>
6:\tb.n\tc <h>
8:\tadds\tr0, #1
a:\tbx\tlr
c:\tadds\tr0, #1
e:\tpop\t{r4, pc}
";
    assert_eq!(thumb(&functions, text), Ok(3 + 2 + 2));
}

#[test]
fn a_long_branch_by_bl_stays_in_its_function() {
    let text = "\
0:\tbl\t6 <f+0x6>
4:\tbx\tlr
6:\tadds\tr0, #1
8:\tpop\t{r4, pc}
";
    assert_eq!(thumb(&[("f", 0..10)], text), Ok(3));
}

#[test]
fn table_branches_reach_every_entry() {
    // Distances of 2 and 3 halfwords from the table, and a zero that fills it up.
    let text = |name: &str| {
        format!(
            "\
0:\t{name}\t[pc, r0]
4:\t.word\t0x00030004
8:\tbx\tlr
a:\tadds\tr0, #1
c:\tpop\t{{r4, pc}}
"
        )
    };
    for (name, table) in [("tbb", [2, 3, 3, 0]), ("tbh", [2, 0, 3, 0])] {
        let image = Image::of_functions(Isa::Thumb, &[("f", 0..14)], (4, [table, [0; 4]].concat()));
        let longest = program(&image, &text(name)).longest("f");
        let longest = longest.map(|longest| longest.instructions);
        assert_eq!(longest.ok(), Some(3), "{name}");
    }
}

#[test]
fn a_jump_to_a_register_reaches_every_address_of_the_table_behind_it() {
    let text = "\
0:\tldr\tr6, [r6, r1]
2:\tmov\tpc, r6
4:\t.word\t0x0000000d
8:\t.word\t0x0000000f
c:\tbx\tlr
e:\tadds\tr0, #1
10:\tpop\t{r4, pc}
";
    let table = [0xd_u8, 0, 0, 0, 0xf, 0, 0, 0];
    let image = Image::of_functions(Isa::Thumb, &[("f", 0..18)], (4, table.to_vec()));
    let longest = program(&image, text).longest("f");
    assert_eq!(
        longest.ok().map(|longest| longest.instructions),
        Some(4),
        "both ways"
    );
}

#[test]
fn jumps_to_addresses_from_memory_are_refused() {
    for jump in ["mov\tpc, r3", "blx\tr3", "bx\tr3", "ldr\tpc, [r3, r0]"] {
        let text = format!("0:\t{jump}\n4:\tbx\tlr\n");
        refuses(&[("f", 0..6)], &text, "`f` at 0x0: ");
    }
    let jump = longest(Isa::RiscV, &[("f", 0..4)], "0:\tjr\ta5\n");
    assert!(jump.is_err_and(|error| error.contains("through a table")));
}

/// Five passes of three instructions would be counted by their number; the search does not know it.
const LOOP: &str = "\
0:\tmovs\tr1, #5
2:\tadds\tr0, #1
4:\tsubs\tr1, #1
6:\tbne.n\t2 <f+0x2>
8:\tbx\tlr
";

#[test]
fn a_loop_without_a_bound_is_refused() {
    refuses(&[("f", 0..10)], LOOP, "this loop has no bound");
}

#[test]
fn a_division_counts_a_pass_for_each_bit() {
    let division = [("f", 0..10), ("u32_div_rem", 0..10)];
    assert_eq!(thumb(&division, LOOP), Ok(1 + 31 * 3 + 1));
}

#[test]
fn a_block_of_constant_length_counts_a_pass_for_each_word() {
    let functions = [("f", 0..10), ("__aeabi_memclr4", 10..20)];
    let text = |length: &str| {
        format!(
            "\
0:\tpush\t{{r4, lr}}
2:\t{length}
4:\tmov\tr0, r4
6:\tbl\ta <__aeabi_memclr4>
8:\tpop\t{{r4, pc}}
a:\tmovs\tr2, #0
c:\tstmia\tr0!, {{r2}}
e:\tsubs\tr1, #4
10:\tbhi.n\tc <__aeabi_memclr4+2>
12:\tbx\tlr
"
        )
    };
    assert_eq!(
        thumb(&functions, &text("movs\tr1, #40")),
        Ok(5 + 1 + 10 * 3 + 1)
    );
    refuses(&functions, &text("ldr\tr1, [r4, #0]"), "is no constant");
}

#[test]
fn paths_that_never_return_are_no_steps() {
    let functions = [("f", 0..10), ("panic", 10..14)];
    let text = "\
0:\tcmp\tr0, #1
2:\tbne.n\t8 <f+0x8>
4:\tbl\ta <panic>
8:\tbx\tlr
a:\tadds\tr0, #1
c:\tb.n\ta <panic>
";
    assert_eq!(thumb(&functions, text), Ok(3));
    refuses(&[("f", 0..2)], "0:\tudf\t#0\n", "`f` never returns");
}

#[test]
fn recursion_is_refused() {
    let text = "0:\tbl\t0 <f>\n4:\tbx\tlr\n";
    refuses(&[("f", 0..6)], text, "calls itself");
}

#[test]
fn the_far_call_of_risc_v_is_followed() {
    let functions = [("f", 0..20), ("g", 0x1000..0x1004)];
    let text = "\
0:\tauipc\tra,0x1
4:\tjalr\t-1(ra) # 1000 <g>
8:\tbeqz\ta0,10 <f+0x10>
c:\tret
10:\tauipc\tt1,0x1
14:\tjr\t-16(t1) # 1000 <g>
1000:\tret
";
    assert_eq!(longest(Isa::RiscV, &functions, text), Ok(2 + 1 + 1 + 2 + 1));
}

#[test]
fn the_far_call_of_risc_v_without_an_offset_is_followed() {
    let functions = [("f", 0..12), ("g", 0x1000..0x1008)];
    let text = "\
0:\tauipc\tra,0x1
4:\tjalr\tra # 1000 <g>
8:\tret
1000:\tnop
1004:\tret
";
    assert_eq!(longest(Isa::RiscV, &functions, text), Ok(2 + 2 + 1));
}

#[test]
fn a_step_in_control_passes_the_check() {
    let functions = [("f", 0..12), ("examine", 12..16)];
    let text = "\
0:\tcmp\tr0, #1
2:\tbne.n\t8 <f+0x8>
4:\tbl\tc <examine>
8:\tadds\tr0, #1
a:\tbx\tlr
c:\tadds\tr0, #1
e:\tbx\tlr
";
    let image = Image::of_functions(Isa::Thumb, &functions, (0, vec![]));
    let longest = program(&image, text).longest("f").expect("paths");
    assert_eq!(
        (longest.instructions, longest.instructions_in_control),
        (7, 4)
    );
    assert!(longest.cycles > longest.cycles_in_control);
    assert!(longest.core_cycles > longest.core_cycles_in_control);
    assert!(longest.cycles > longest.core_cycles);
}

/// The check of the search against what was counted.
#[test]
fn a_step_longer_than_the_longest_path_is_an_error() {
    let check = |instructions, largest| {
        let longest = Longest {
            instructions,
            instructions_in_control: 90,
            cycles: 1000,
            cycles_in_control: 200,
            core_cycles: 500,
            core_cycles_in_control: 100,
        };
        let checked = check("step_x", &longest, largest);
        checked.map_err(|error| error.to_string())
    };
    assert_eq!(check(375, 375), Ok(()));
    let error = check(374, 375).expect_err("a path is missing");
    let said = "step_x: a step of 375 instructions was counted, and the longest path has 374";
    assert!(error.starts_with(said), "{error}");
    let error = check(90, 90).expect_err("nothing is left out");
    assert!(
        error.contains("calls no function with `examine` in its name"),
        "{error}"
    );
}

#[test]
fn executed_instructions_follow_the_graph() {
    let functions = [("f", 0..8), ("g", 8..12)];
    let text = "\
0:\tpush\t{r4, lr}
2:\tbl\t8 <g>
6:\tpop\t{r4, pc}
8:\tadds\tr0, #1
a:\tbx\tlr
";
    let image = Image::of_functions(Isa::Thumb, &functions, (0, vec![]));
    let program = program(&image, text);
    let check = |executed: &[u32]| {
        let executed = executed.iter().copied();
        let checked = program.check_executed(executed, &(0..8), &(0x100..0x104));
        checked.map_err(|error| error.to_string())
    };
    let call = [0x102, 0, 2, 8, 10, 6, 0x102, 0x200, 0, 2];
    assert_eq!(check(&call), Ok(()));
    let error = check(&[0, 2, 6]).expect_err("the call is skipped");
    assert!(error.contains("from 0x2 to 0x6"), "{error}");
}

#[test]
fn cycles_on_a_cortex_m4_count_waits_for_each_line() {
    let halves: [u16; 7] = [0xb510, 0x6808, 0xfbb0, 0xf0f1, 0xd000, 0xbf00, 0xbd10];
    let code: Vec<u8> = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
    let cycles = |start: u32| {
        let at = |offset: u32| format!("{:x}", start + offset);
        let text = format!(
            "\
{}:\tpush\t{{r4, lr}}
{}:\tldr\tr0, [r1, #0]
{}:\tudiv\tr0, r0, r1
{}:\tbeq.n\t{} <f+0xc>
{}:\tnop
{}:\tpop\t{{r4, pc}}
",
            at(0),
            at(2),
            at(4),
            at(8),
            at(12),
            at(10),
            at(12)
        );
        let functions = [("f", start..start + 14)];
        let image = Image::of_functions(Isa::Thumb, &functions, (start, code.clone()));
        let longest = program(&image, &text).longest("f").expect("paths");
        longest.cycles
    };
    let entry = 3 + 4 * 2;
    let [push, load, divide, branch, pop] = [3, 6, 12 + 4, 1, 3];
    let jump = 3 + 4 * 2;
    let back = 3 + 4 * 3;
    let expected = entry + push + load + divide + branch + jump + pop + back;
    // Wherever the function begins, each place in a line is tried.
    assert_eq!([0, 2, 4, 6].map(cycles), [expected; 4]);
}

#[test]
fn cycles_on_hazard3_count_each_branch_as_mispredicted() {
    let halves: [u16; 3] = [0x4188, 0xc119, 0x8082];
    let text = "0:\tlw\ta0,0(a1)\n2:\tbeqz\ta0,4 <f+0x4>\n4:\tret\n";
    let code = halves.iter().flat_map(|half| half.to_le_bytes()).collect();
    let image = Image::of_functions(Isa::RiscV, &[("f", 0..6)], (0, code));
    let program = Program {
        chip: chip(Target::Riscv32),
        ..program(&image, text)
    };
    let longest = program.longest("f").expect("paths");
    assert_eq!(longest.cycles, 2 + 2 + (1 + 2) + (1 + 2));
}
