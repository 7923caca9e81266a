//! Ranges of words at every place of the program, and possibly inexact operations.

use super::bounded::{Bounded, Made};
use std::cell::RefCell;
use std::collections::HashMap;
use std::fmt;
use std::hash::{BuildHasherDefault, Hasher};
use std::panic::Location;

/// Number of reported faults.
const TOLD: usize = 8;

/// An operation of the program: its place in the source, or that of the operation with several
/// steps it belongs to, the number of the step, and its kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Place {
    file: &'static str,
    line: u32,
    column: u32,
    step: u32,
    what: &'static str,
}

impl Place {
    fn new(location: &'static Location<'static>, step: u32, what: &'static str) -> Self {
        Self {
            file: location.file(),
            line: location.line(),
            column: location.column(),
            step,
            what,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file,
            line,
            column,
            what,
            ..
        } = self;
        write!(f, "{what} at {file}:{line}:{column}")
    }
}

/// Mixes lines, columns and addresses well enough.
#[derive(Clone, Copy, Debug, Default)]
struct Mixer(u64);

impl Hasher for Mixer {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        // Texts are distinguished by length and last letters.
        self.write_u64(bytes.len() as u64);
        for chunk in bytes.rchunks(8).take(2) {
            self.write_u64(
                chunk
                    .iter()
                    .fold(0, |word, byte| word << 8 | u64::from(*byte)),
            );
        }
    }

    fn write_u8(&mut self, x: u8) {
        self.write_u64(x.into());
    }

    fn write_u32(&mut self, x: u32) {
        self.write_u64(x.into());
    }

    fn write_u64(&mut self, x: u64) {
        self.0 = (self.0.rotate_left(5) ^ x).wrapping_mul(0x517c_c1b7_2722_0a95);
    }
}

#[derive(Debug, Default)]
struct Ledger {
    /// Places are distinguished, except while coefficients are made, all at one place.
    is_open: bool,
    known: HashMap<Place, Bounded, BuildHasherDefault<Mixer>>,
    /// Entries that changed a range, and the last of them.
    news: u64,
    newest: Option<Place>,
    faults: Vec<String>,
    /// The current operation with several steps, and its number of steps so far.
    outer: Option<(&'static Location<'static>, u32)>,
}

thread_local! {
    static LEDGER: RefCell<Ledger> = RefCell::default();
}

/// Ends an operation of several steps.
#[derive(Debug)]
pub struct Site {
    is_outer: bool,
}

impl Drop for Site {
    fn drop(&mut self) {
        if self.is_outer {
            LEDGER.with_borrow_mut(|ledger| ledger.outer = None);
        }
    }
}

/// Marks the present function's caller: its operations count as steps of that place.
#[track_caller]
pub fn here() -> Site {
    let location = Location::caller();
    LEDGER.with_borrow_mut(|ledger| {
        let is_outer = ledger.outer.is_none();
        if is_outer {
            ledger.outer = Some((location, 0));
        }
        Site { is_outer }
    })
}

/// Steps of one way through an operation have numbers of their own.
pub(crate) fn go_another_way() {
    LEDGER.with_borrow_mut(|ledger| {
        if let Some((_, step)) = &mut ledger.outer {
            *step += 100;
        }
    });
}

/// The union of the place's range and of `x`, its present result from `first` and another operand;
/// `x` itself while the ledger is closed.
#[track_caller]
pub(crate) fn enter(x: Bounded, what: &'static str, first: Bounded) -> Bounded {
    let location = Location::caller();
    let before = match first.made {
        Some(made) if made.location == location => made.before + 1,
        _ => 0,
    };
    LEDGER.with_borrow_mut(|ledger| {
        let place = match &mut ledger.outer {
            None => Place::new(location, before, what),
            Some((outer, step)) => {
                *step += 1;
                Place::new(outer, *step, what)
            }
        };
        ledger.judge(place, x);
        if !ledger.is_open {
            return x;
        }
        let known = ledger.known.get(&place).copied();
        let mut union = known.map_or(x, |known| x.union(known));
        union.made = Some(Made { location, before });
        let is_new = known.is_none_or(|known| {
            (known.low, known.high, known.last) != (union.low, union.high, union.last)
        });
        if is_new {
            ledger.news += 1;
            ledger.newest = Some(place);
            ledger.known.insert(place, union);
            ledger.judge(place, union);
        }
        union
    })
}

/// Records a possibly inexact operation.
#[track_caller]
pub(crate) fn fault(text: &str) {
    let location = Location::caller();
    LEDGER.with_borrow_mut(|ledger| {
        let (location, _) = ledger.outer.unwrap_or((location, 0));
        ledger.tell(format!("{text} at {location}"));
    });
}

impl Ledger {
    fn judge(&mut self, place: Place, x: Bounded) {
        if x.bits() > 53 {
            self.tell(format!("{place} takes {} bits: {x:?}", x.bits()));
        }
        if !x.holds() {
            self.tell(format!("{place} is not what is known of it: {x:?}"));
        }
    }

    fn tell(&mut self, text: String) {
        if self.faults.len() < TOLD {
            self.faults.push(text);
        }
    }
}

/// Clears everything. The following is judged by itself.
pub fn begin() {
    LEDGER.with_borrow_mut(|ledger| *ledger = Ledger::default());
}

/// The following on this thread is recorded.
pub fn open() {
    LEDGER.with_borrow_mut(|ledger| ledger.is_open = true);
}

/// Number of entries that changed a range.
pub fn news() -> u64 {
    LEDGER.with_borrow(|ledger| ledger.news)
}

/// The last entry that changed a range.
pub fn newest() -> String {
    LEDGER.with_borrow(|ledger| {
        let told = |place: Place| format!("{place}: {:?}", ledger.known[&place]);
        ledger.newest.map(told).unwrap_or_default()
    })
}

/// Summary.
#[derive(Clone, Debug)]
pub struct Findings {
    /// Operations.
    pub operations: usize,
    /// The most bits of any sum or product.
    pub bits: i32,
    /// Its place.
    pub place: String,
}

/// The possibly inexact operations.
pub fn faults() -> Option<String> {
    LEDGER.with_borrow(|ledger| (!ledger.faults.is_empty()).then(|| ledger.faults.join("\n")))
}

/// Summary.
pub fn findings() -> Findings {
    LEDGER.with_borrow(|ledger| {
        let longest = ledger.known.iter().max_by_key(|(place, word)| {
            (
                word.bits(),
                std::cmp::Reverse((place.file, place.line, place.column)),
            )
        });
        Findings {
            operations: ledger.known.len(),
            bits: longest.map_or(0, |(_, word)| word.bits()),
            place: longest.map_or_else(String::new, |(place, _)| place.to_string()),
        }
    })
}
