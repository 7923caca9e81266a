//! Every interleaving of few operations: interrupts strike before every access, and nest.

extern crate std;

use super::{Banks, FIRST, NO, Place};
use crate::arith::Word;
use std::boxed::Box;
use std::cell::{Cell, RefCell};
use std::rc::Rc;
use std::vec::Vec;

/// What interrupts, and before which access, counted over all contexts.
type Interrupt<'t> = (usize, Box<dyn Fn() + 't>);

/// One core: counts accesses and lets interrupts in.
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
    /// Lets in what would have struck later.
    fn let_in_the_rest(&self) {
        let late: Vec<_> = self.pending.borrow_mut().drain(..).collect();
        for (_, interrupt) in late {
            interrupt();
        }
    }
}

/// A place whose accesses may be interrupted.
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

/// The number that all words have.
fn whole(words: [Word; 3]) -> i32 {
    assert!(
        words.iter().all(|word| *word == words[0]),
        "torn: {words:?}"
    );
    words[0].0
}

/// More accesses than any scenario makes: an interrupt then strikes nowhere.
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
        buffer.store([Word(2); 3]);
        assert_eq!(whole(buffer.read()), 2);
    });
}

#[test]
fn a_store_that_interrupts_a_read_is_seen_whole_or_not_at_all() {
    at_every_access(|core, access| {
        let buffer = buffer(core, 1);
        let writer = Rc::clone(&buffer);
        core.at(access, move || writer.store([Word(2); 3]));
        let seen = whole(buffer.read());
        assert!(seen == 1 || seen == 2);
    });
}

#[test]
fn stores_that_interrupt_each_other_never_tear_what_any_read_gets() {
    for second in 0..BEHIND {
        at_every_access(|core, access| {
            let buffer = buffer(core, 1);
            let (writer, reader) = (Rc::clone(&buffer), Rc::clone(&buffer));
            core.at(access, move || writer.store([Word(3); 3]));
            core.at(second, move || {
                whole(reader.read());
            });
            buffer.store([Word(2); 3]);
            let end = whole(buffer.read());
            assert!(end == 2 || end == 3);
            core.let_in_the_rest();
            // A later store is not held up by what went on before.
            buffer.store([Word(4); 3]);
            assert_eq!(whole(buffer.read()), 4);
        });
    }
}

/// As a drive has them: the current's word and the words of the bus, each for itself.
#[test]
fn current_and_bus_told_from_two_contexts_both_arrive() {
    at_every_access(|core, access| {
        let (current, bus) = (Rc::new(watched(core, 0)), buffer(core, 1));
        let interrupt = Rc::clone(&current);
        core.at(access, move || interrupt.store(7));
        bus.store([Word(2); 3]);
        whole(bus.read());
        core.let_in_the_rest();
        assert_eq!((current.load(), whole(bus.read())), (7, 2));
    });
    at_every_access(|core, access| {
        let (current, bus) = (Rc::new(watched(core, 0)), buffer(core, 1));
        let interrupt = Rc::clone(&bus);
        core.at(access, move || interrupt.store([Word(2); 3]));
        current.store(7);
        core.let_in_the_rest();
        assert_eq!((current.load(), whole(bus.read())), (7, 2));
    });
}

/// The limit that the documentation names, and the proof that these tests see a torn read.
#[test]
fn two_stores_within_one_read_tear_it() {
    let mut torn = 0;
    for first in 0..BEHIND {
        at_every_access(|core, access| {
            let buffer = buffer(core, 1);
            for (at, value) in [(first, 2), (access, 3)] {
                let writer = Rc::clone(&buffer);
                core.at(at, move || writer.store([Word(value); 3]));
            }
            let words = buffer.read();
            if words.iter().any(|word| *word != words[0]) {
                torn += 1;
            }
        });
    }
    assert!(torn > 0);
}
