//! Every interleaving of a few operations: interrupts before every access, nested, too.

extern crate std;

use super::{Banks, FIRST, NO, Place};
use crate::arith::Word;
use crate::bus_watch::{self, SOUND, Watch};
use std::boxed::Box;
use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::rc::Rc;
use std::vec::Vec;

/// The interrupts, each before an access, counted over all contexts.
type Interrupt<'t> = (usize, Box<dyn Fn() + 't>);

/// One core: counts accesses and runs interrupts.
#[derive(Default)]
struct Core<'t> {
    accesses: Cell<usize>,
    pending: RefCell<Vec<Interrupt<'t>>>,
}

impl<'t> Core<'t> {
    fn at(&self, access: usize, interrupt: impl Fn() + 't) {
        self.pending
            .borrow_mut()
            .push((access, Box::new(interrupt)));
    }

    fn access(&self) {
        let now = self.accesses.get();
        self.accesses.set(now + 1);
        loop {
            let mut pending = self.pending.borrow_mut();
            let Some(next) = pending.iter().position(|&(access, _)| access == now) else {
                return;
            };
            let (_, interrupt) = pending.remove(next);
            drop(pending);
            interrupt();
        }
    }
}

impl Core<'_> {
    /// Runs the interrupts that are still pending.
    fn let_in_the_rest(&self) {
        let late: Vec<_> = self.pending.borrow_mut().drain(..).collect();
        for (_, interrupt) in late {
            interrupt();
        }
    }
}

/// A memory cell whose accesses may be interrupted.
struct Watched<'t> {
    core: Rc<Core<'t>>,
    value: Cell<i32>,
}

impl Place for Watched<'_> {
    fn load(&self) -> i32 {
        self.core.access();
        self.value.get()
    }

    fn store(&self, value: i32) {
        self.core.access();
        self.value.set(value);
    }
}

fn watched<'t>(core: &Rc<Core<'t>>, value: i32) -> Watched<'t> {
    Watched {
        core: Rc::clone(core),
        value: Cell::new(value),
    }
}

fn buffer<'t>(core: &Rc<Core<'t>>, value: i32) -> Rc<Banks<Watched<'t>, 3>> {
    Rc::new(Banks {
        first: [value; 3].map(|value| watched(core, value)),
        second: [value; 3].map(|value| watched(core, value)),
        published: watched(core, FIRST),
        storing: watched(core, NO),
    })
}

/// The common value of all words.
fn whole(words: [Word; 3]) -> i32 {
    assert!(
        words.iter().all(|word| *word == words[0]),
        "torn: {words:?}"
    );
    words[0].0
}

/// Periods until a store is given up, and until a bus voltage is stale.
const GIVEN_UP: i32 = 6;
const STALE: i32 = 3;

/// More accesses than any scenario makes: an interrupt at this place never runs.
const BEHIND: usize = 40;

/// Runs a scenario with interrupts before every access, and with none.
fn at_every_access(mut scenario: impl FnMut(&Rc<Core<'_>>, usize)) {
    for access in 0..BEHIND {
        let core = Rc::new(Core::default());
        scenario(&core, access);
        assert!(core.accesses.get() < BEHIND, "the scenario is longer");
    }
}

#[test]
fn a_read_that_interrupts_a_store_gets_old_or_new_words_whole() {
    at_every_access(|core, access| {
        let buffer = buffer(core, 1);
        let reader = Rc::clone(&buffer);
        core.at(access, move || {
            let seen = whole(reader.read());
            assert!(seen == 1 || seen == 2);
        });
        buffer.store([Word(2); 3], GIVEN_UP);
        assert_eq!(whole(buffer.read()), 2);
    });
}

#[test]
fn a_store_that_interrupts_a_read_is_seen_whole_or_not_at_all() {
    at_every_access(|core, access| {
        let buffer = buffer(core, 1);
        let writer = Rc::clone(&buffer);
        core.at(access, move || {
            writer.store([Word(2); 3], GIVEN_UP);
        });
        let seen = whole(buffer.read());
        assert!(seen == 1 || seen == 2);
    });
}

#[test]
fn stores_that_interrupt_each_other_never_tear_a_read() {
    for second in 0..BEHIND {
        at_every_access(|core, access| {
            let buffer = buffer(core, 1);
            let (writer, reader) = (Rc::clone(&buffer), Rc::clone(&buffer));
            core.at(access, move || {
                writer.store([Word(3); 3], GIVEN_UP);
            });
            core.at(second, move || {
                whole(reader.read());
            });
            buffer.store([Word(2); 3], GIVEN_UP);
            let end = whole(buffer.read());
            assert!(end == 2 || end == 3);
            core.let_in_the_rest();
            // A later store is not blocked by earlier ones.
            buffer.store([Word(4); 3], GIVEN_UP);
            assert_eq!(whole(buffer.read()), 4);
        });
    }
}

/// As in a drive: the word of the current and the words of the bus in separate cells.
#[test]
fn current_and_bus_told_from_two_contexts_both_arrive() {
    at_every_access(|core, access| {
        let (current, bus) = (Rc::new(watched(core, 0)), buffer(core, 1));
        let interrupt = Rc::clone(&current);
        core.at(access, move || interrupt.store(7));
        bus.store([Word(2); 3], GIVEN_UP);
        whole(bus.read());
        core.let_in_the_rest();
        assert_eq!((current.load(), whole(bus.read())), (7, 2));
    });
    at_every_access(|core, access| {
        let (current, bus) = (Rc::new(watched(core, 0)), buffer(core, 1));
        let interrupt = Rc::clone(&bus);
        core.at(access, move || {
            interrupt.store([Word(2); 3], GIVEN_UP);
        });
        current.store(7);
        core.let_in_the_rest();
        assert_eq!((current.load(), whole(bus.read())), (7, 2));
    });
}

/// The documented limit; also proves that these tests detect a torn read.
#[test]
fn two_stores_within_one_read_tear_it() {
    let mut torn = 0;
    for first in 0..BEHIND {
        at_every_access(|core, access| {
            let buffer = buffer(core, 1);
            for (at, value) in [(first, 2), (access, 3)] {
                let writer = Rc::clone(&buffer);
                core.at(at, move || {
                    writer.store([Word(value); 3], GIVEN_UP);
                });
            }
            let words = buffer.read();
            if words.iter().any(|word| *word != words[0]) {
                torn += 1;
            }
        });
    }
    assert!(torn > 0);
}

/// A drive with a measured bus voltage, as emitted.
struct Told<'t> {
    bus: Rc<Banks<Watched<'t>, 3>>,
    watch: Watch<Watched<'t>>,
}

impl<'t> Told<'t> {
    fn new(core: &Rc<Core<'t>>) -> Rc<Self> {
        Rc::new(Self {
            bus: buffer(core, 1),
            watch: Watch {
                told: watched(core, bus_watch::NO),
                left: watched(core, 0),
            },
        })
    }

    fn set_bus(&self, value: i32) {
        if self.bus.store([Word(value); 3], GIVEN_UP) {
            self.watch.told(SOUND);
        }
    }

    /// The control interrupt; returns the voltage it uses.
    fn step(&self) -> i32 {
        self.bus.pass_period();
        self.watch.pass_period(STALE);
        whole(self.bus.read())
    }
}

/// Abandons a call before an access; returns whether that was before its end.
fn is_ended_at(core: &Core<'_>, access: usize, call: impl Fn()) -> bool {
    core.at(core.accesses.get() + access, || resume_unwind(Box::new(())));
    let ended = catch_unwind(AssertUnwindSafe(call)).is_err();
    core.pending.borrow_mut().clear();
    ended
}

#[test]
fn a_bus_voltage_is_stale_before_the_first_call_and_after_calls_cease() {
    let drive = Told::new(&Rc::new(Core::default()));
    assert!(drive.watch.is_stale());
    drive.step();
    assert!(drive.watch.is_stale());
    for _ in 0..2 {
        drive.set_bus(2);
        for _ in 0..STALE {
            assert_eq!(drive.step(), 2);
            assert!(!drive.watch.is_stale());
        }
        for _ in 0..4 * STALE {
            drive.step();
            assert!(drive.watch.is_stale());
        }
    }
    for _ in 0..8 {
        drive.set_bus(2);
        (1..STALE).for_each(|_| {
            drive.step();
        });
        assert!(!drive.watch.is_stale());
    }
}

/// A call abandoned at any access leaves all old or all new words. While later calls have no
/// effect, the voltage becomes stale and stays so.
#[test]
fn an_abandoned_call_makes_the_voltage_stale_until_a_later_one_takes_effect() {
    let (mut ended, mut held_up) = (0, 0);
    for access in 0..BEHIND {
        let core = Rc::new(Core::default());
        let drive = Told::new(&core);
        drive.set_bus(2);
        drive.step();
        if !is_ended_at(&core, access, || drive.set_bus(3)) {
            continue;
        }
        ended += 1;
        // Later calls, one per period, all of another voltage.
        let (mut stale, mut told) = (0, 0);
        for _ in 0..4 * GIVEN_UP {
            drive.set_bus(4);
            let is_told = drive.step() == 4;
            assert!(told == 0 || is_told, "{access}: a call is lost");
            assert!(!is_told || !drive.watch.is_stale(), "{access}: not seen");
            stale += i32::from(drive.watch.is_stale());
            told += i32::from(is_told);
        }
        assert!(told >= 3 * GIVEN_UP, "{access}: {told} periods");
        // A block longer than the voltage's lifetime is reported as stale for the rest of it.
        let held = 4 * GIVEN_UP - told;
        assert_eq!(stale, (held + 1 - STALE).max(0), "{access}: {held} periods");
        held_up += i32::from(stale > 0);
    }
    assert!(ended > 6 && held_up > 3, "{ended} ended, {held_up} held up");
}

/// The control interrupt between any two accesses of a call, and a call between any two of the
/// interrupt's: every call that takes effect is seen.
#[test]
fn no_call_is_lost_to_an_interrupt() {
    at_every_access(|core, access| {
        let drive = Told::new(core);
        let control = Rc::clone(&drive);
        core.at(access, move || {
            control.step();
        });
        drive.set_bus(2);
        core.let_in_the_rest();
        drive.step();
        assert!(!drive.watch.is_stale());
    });
    for access in 0..BEHIND {
        let core = Rc::new(Core::default());
        let drive = Told::new(&core);
        drive.set_bus(1);
        (0..STALE).for_each(|_| {
            drive.step();
        });
        // The last period before it is stale.
        let caller = Rc::clone(&drive);
        core.at(core.accesses.get() + access, move || caller.set_bus(2));
        drive.step();
        core.let_in_the_rest();
        drive.step();
        assert!(!drive.watch.is_stale());
    }
}

/// The control interrupt that ages a store never overwrites its beginning or end.
#[test]
fn a_store_that_goes_on_is_not_given_up() {
    at_every_access(|core, access| {
        let buffer = buffer(core, 1);
        let (control, writer) = (Rc::clone(&buffer), Rc::clone(&buffer));
        core.at(access, move || {
            (1..GIVEN_UP).for_each(|_| control.pass_period());
            writer.store([Word(3); 3], GIVEN_UP);
        });
        buffer.store([Word(2); 3], GIVEN_UP);
        core.let_in_the_rest();
        whole(buffer.read());
        assert_eq!(buffer.storing.value.get(), NO);
    });
    at_every_access(|core, access| {
        let buffer = buffer(core, 1);
        let writer = Rc::clone(&buffer);
        core.at(access, move || {
            writer.store([Word(2); 3], GIVEN_UP);
        });
        buffer.pass_period();
        core.let_in_the_rest();
        assert_eq!(whole(buffer.read()), 2);
        assert_eq!(buffer.storing.value.get(), NO);
    });
}
