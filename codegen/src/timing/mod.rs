//! Time of a step on named chips: counted for the drives of the firmware, estimated from the
//! operations of the step for all others.
//!
//! `figures.rs` is written by `cargo xtask cost --accept`, which counts the firmware's drives and
//! fits the estimates to them.

mod figures;

use crate::ir::{Cost, PathCost, Program};
use figures::CHIPS;
use fnv::FnvHasher;
use std::fmt;
use std::hash::Hasher;

/// Figures of a step. Any step includes start-up, calibration, trips, braking of a fast rotor and
/// bridged Hall codes; a step in control has none of them. Cycles are those of the chip, with the
/// wait states of its memory and without credit for prefetch and caches; core cycles are those of a
/// memory without wait states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Times<T> {
    /// Instructions of most steps in control.
    pub normal: T,
    /// Instructions of the longest path in control.
    pub control: T,
    /// Core cycles of a step in control at most.
    pub control_core_cycles: T,
    /// Cycles of a step in control at most.
    pub control_cycles: T,
    /// Instructions of the longest path of any step.
    pub any: T,
    /// Core cycles of any step at most.
    pub any_core_cycles: T,
    /// Cycles of any step at most.
    pub any_cycles: T,
}

/// A chip with its figures.
#[derive(PartialEq)]
pub struct Chip {
    /// The core as a word of the option `target`.
    pub target: &'static str,
    /// The core's name.
    pub core: &'static str,
    /// The chip's name.
    pub name: &'static str,
    /// Highest clocks at which the memory takes 0, 1, 2 … wait states, hertz; the last is the core's highest.
    pub clocks_of_waits: &'static [f64],
    /// What the cycles assume.
    pub assumed: &'static str,
    /// The compiler whose code was counted.
    pub compiler: &'static str,
    /// Largest ratio of a counted drive's time in C to its time in Rust.
    pub in_c: Times<f64>,
    estimates: Times<Estimate>,
    /// Figures of drives by [`digest`].
    counted: &'static [(u64, Times<u32>)],
}

/// How a figure follows from the operations of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Weights of [`Work`].
    pub weights: Work,
    /// The least that any step takes: that of one at rest, whose law computes little.
    pub least: f64,
    /// Largest error of a counted drive by the estimate fitted to all others, as a part of the
    /// estimate.
    pub errors: Errors,
}

/// Largest error among drives of a kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Usual drives.
    pub usual: f64,
    /// These and drives that learn the places of their Hall sensors: an edge that is learnt is work of
    /// few steps, of which the operations tell less.
    pub learning: f64,
    /// All, with those that turn legs off within a period, to which nothing is fitted: which of their
    /// steps limit the voltage depends on the drive.
    pub intervals: f64,
}

impl Estimate {
    const fn of(weights: Work, least: f64, [usual, learning, intervals]: [f64; 3]) -> Self {
        Self {
            weights,
            least,
            errors: Errors {
                usual,
                learning,
                intervals,
            },
        }
    }
}

/// What a drive has that its operations do not tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Peculiarity {
    /// Nothing.
    None,
    /// It learns the places of its Hall sensors.
    Learning,
    /// It turns legs off within a period.
    Intervals,
}

impl Peculiarity {
    /// Of a drive.
    pub fn of(program: &Program, learns_halls: bool) -> Self {
        match (program.has_intervals(), learns_halls) {
            (true, _) => Self::Intervals,
            (false, true) => Self::Learning,
            (false, false) => Self::None,
        }
    }
}

/// The estimate of these operations by these weights, at least `least`.
pub fn weighed(weights: &Work, least: f64, work: &Work) -> f64 {
    let parts = weights.iter().zip(work);
    let sum: f64 = parts.map(|(weight, count)| weight * count).sum();
    sum.max(least)
}

/// What an estimate weighs: one step, state words, additions with comparisons, products of more
/// than 32 bits, other products, look-ups, divisions.
pub type Work = [f64; 7];

/// Number of figures of [`Times`].
pub const FIGURES: usize = 7;

/// Time of a controller's step on a chip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepTime {
    /// The chip.
    pub chip: &'static Chip,
    /// Clock of the core, hertz: `core_clock`, or that of the chip.
    pub clock: f64,
    /// Control period, seconds.
    pub period: f64,
    /// Whether the specification names the core.
    pub is_named: bool,
    /// Figures; their cycles have the wait states that the memory takes at this clock.
    pub times: Times<u32>,
    /// Largest errors of the estimates; `None` for a drive that was counted.
    pub errors: Option<Times<f64>>,
}

impl<T> Times<T> {
    /// All figures.
    pub fn into_array(self) -> [T; FIGURES] {
        [
            self.normal,
            self.control,
            self.control_core_cycles,
            self.control_cycles,
            self.any,
            self.any_core_cycles,
            self.any_cycles,
        ]
    }

    /// These figures, each with that of others.
    pub fn zip<U>(self, others: Times<U>) -> Times<(T, U)> {
        Times {
            normal: (self.normal, others.normal),
            control: (self.control, others.control),
            control_core_cycles: (self.control_core_cycles, others.control_core_cycles),
            control_cycles: (self.control_cycles, others.control_cycles),
            any: (self.any, others.any),
            any_core_cycles: (self.any_core_cycles, others.any_core_cycles),
            any_cycles: (self.any_cycles, others.any_cycles),
        }
    }

    /// The same of other figures.
    pub fn map<U>(self, mut of: impl FnMut(T) -> U) -> Times<U> {
        Times {
            normal: of(self.normal),
            control: of(self.control),
            control_core_cycles: of(self.control_core_cycles),
            control_cycles: of(self.control_cycles),
            any: of(self.any),
            any_core_cycles: of(self.any_core_cycles),
            any_cycles: of(self.any_cycles),
        }
    }
}

impl<T: Copy> Times<T> {
    /// These figures, in the order of the fields.
    pub const fn of(figures: [T; FIGURES]) -> Self {
        let [
            normal,
            control,
            control_core_cycles,
            control_cycles,
            any,
            any_core_cycles,
            any_cycles,
        ] = figures;
        Self {
            normal,
            control,
            control_core_cycles,
            control_cycles,
            any,
            any_core_cycles,
            any_cycles,
        }
    }
}

impl Times<u32> {
    /// These figures with a part of the wait states of the cycles, from 0 to 1.
    ///
    /// The cycles of a path grow by as much with each wait state, so that those of the longest path
    /// are a convex function of the wait states: between two counts they lie below the line
    /// through both.
    fn with_waits(self, part: f64) -> Self {
        let cycles = |core: u32, all: u32| {
            let waits = f64::from(all.saturating_sub(core));
            core + (part * waits).ceil() as u32
        };
        Self {
            control_cycles: cycles(self.control_core_cycles, self.control_cycles),
            any_cycles: cycles(self.any_core_cycles, self.any_cycles),
            ..self
        }
    }

    /// Errors of [`Self::with_waits`] of estimates with these errors: those of the two counts of cycles, each by
    /// its share.
    fn errors_with_waits(self, part: f64, errors: Times<f64>) -> Times<f64> {
        let mixed = |[core, all]: [u32; 2], [of_core, of_all]: [f64; 2]| {
            let core = (1.0 - part) * f64::from(core);
            let all = part * f64::from(all);
            (core * of_core + all * of_all) / (core + all).max(1.0)
        };
        Times {
            control_cycles: mixed(
                [self.control_core_cycles, self.control_cycles],
                [errors.control_core_cycles, errors.control_cycles],
            ),
            any_cycles: mixed(
                [self.any_core_cycles, self.any_cycles],
                [errors.any_core_cycles, errors.any_cycles],
            ),
            ..errors
        }
    }
}

impl StepTime {
    /// Cycles of a control period.
    pub fn cycles_of_period(&self) -> f64 {
        self.clock * self.period
    }

    /// Cycles of any step at most, an estimate with its error.
    pub fn most_cycles(&self) -> f64 {
        let error = self.errors.map_or(0.0, |errors| errors.any_cycles);
        (f64::from(self.times.any_cycles) * (1.0 + error)).ceil()
    }

    /// Cycles of a step in control in C: what the counted drives take more there, at most.
    pub fn control_cycles_in_c(&self) -> f64 {
        let in_c = self.chip.in_c;
        f64::from(self.told().control_cycles) * in_c.control_cycles.max(in_c.control_core_cycles)
    }

    /// Cycles of any step at most, in C.
    pub fn most_cycles_in_c(&self) -> f64 {
        let in_c = self.chip.in_c;
        self.most_cycles() * in_c.any_cycles.max(in_c.any_core_cycles)
    }

    /// Whether a step may take longer than the control period on the core that is named.
    pub fn is_too_long(&self) -> bool {
        self.is_named && self.most_cycles() > self.cycles_of_period()
    }

    /// Whether a step may take longer than the control period in C.
    pub fn is_too_long_in_c(&self) -> bool {
        self.most_cycles_in_c() > self.cycles_of_period()
    }

    /// Whether a step may take longer than the control period in C only.
    pub fn is_too_long_in_c_only(&self) -> bool {
        self.most_cycles() <= self.cycles_of_period() && self.is_too_long_in_c()
    }

    /// Whether the figures are bounds: counted, and at no higher clock than the chip's, beyond which
    /// a memory takes more wait states.
    pub fn is_bound(&self) -> bool {
        self.errors.is_none() && self.clock <= self.chip.clock()
    }

    /// The figures, estimates with two digits.
    pub fn told(&self) -> Times<u32> {
        self.times.map(|figure| {
            let step = 10_u32.pow(figure.max(1).ilog10().saturating_sub(1));
            match self.errors {
                Some(_) => (figure + step / 2) / step * step,
                None => figure,
            }
        })
    }

    /// Part of the control period that so many cycles take, in whole percents, rounded up.
    pub fn percent_of_period(&self, cycles: u32) -> f64 {
        (100.0 * f64::from(cycles) / self.cycles_of_period()).ceil()
    }
}

/// What is asked of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asked<'a> {
    /// The normalised specification.
    pub spec_toml: &'a str,
    /// The core that is named, a word of the option `target`; `None`: all.
    pub target: Option<&'static str>,
    /// Its clock, hertz; `None`: that of the chip.
    pub clock: Option<f64>,
    /// Control period, seconds.
    pub period: f64,
    /// Whether the drive learns the places of its Hall sensors.
    pub learns_halls: bool,
}

/// Times of a controller's step: on the chip of its core, on every chip if none is named.
pub fn of_step(program: &Program, asked: Asked) -> Vec<StepTime> {
    let digest = digest(asked.spec_toml);
    let work = work(program);
    let peculiarity = Peculiarity::of(program, asked.learns_halls);
    let chips = CHIPS
        .iter()
        .filter(|chip| asked.target.is_none_or(|target| target == chip.target));
    chips
        .map(|chip| {
            let counted = chip.counted(digest);
            let times = counted.unwrap_or_else(|| chip.estimated(&work));
            let clock = asked.clock.unwrap_or(chip.clock());
            let part = chip.part_of_waits(clock);
            StepTime {
                chip,
                clock,
                period: asked.period,
                is_named: asked.target.is_some(),
                times: times.with_waits(part),
                errors: counted
                    .is_none()
                    .then(|| times.errors_with_waits(part, chip.errors(peculiarity))),
            }
        })
        .collect()
}

/// Largest ratio of a drive's time in C to its time in Rust on a core, and the compiler.
pub fn in_c(target: &str) -> Option<(&'static str, Times<f64>)> {
    let chip = CHIPS.iter().find(|chip| chip.target == target)?;
    Some((chip.compiler, chip.in_c))
}

/// Counted times of a drive on a core by the [`digest`] of its specification, and the compiler.
pub fn counted(target: &str, digest: u64) -> Option<(&'static str, Times<u32>)> {
    let chip = CHIPS.iter().find(|chip| chip.target == target)?;
    Some((chip.compiler, chip.counted(digest)?))
}

impl fmt::Debug for Chip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

impl Chip {
    fn counted(&self, digest: u64) -> Option<Times<u32>> {
        let counted = self.counted.iter().find(|(of, _)| *of == digest);
        counted.map(|(_, times)| *times)
    }

    fn errors(&self, peculiarity: Peculiarity) -> Times<f64> {
        self.estimates.map(|estimate| match peculiarity {
            Peculiarity::None => estimate.errors.usual,
            Peculiarity::Learning => estimate.errors.learning,
            Peculiarity::Intervals => estimate.errors.intervals,
        })
    }

    /// Highest clock of the core, hertz.
    pub fn clock(&self) -> f64 {
        self.clocks_of_waits.last().copied().unwrap_or_default()
    }

    /// Most wait states, those at the highest clock.
    fn most_waits(&self) -> usize {
        self.clocks_of_waits.len() - 1
    }

    /// Wait states of the memory at a clock in hertz: all beyond the chip's highest.
    pub fn waits(&self, clock: f64) -> usize {
        let fast_enough = self
            .clocks_of_waits
            .iter()
            .position(|&highest| clock <= highest);
        fast_enough.unwrap_or(self.most_waits())
    }

    /// The same as a part of those at the chip's highest clock; 0 of a memory without any.
    fn part_of_waits(&self, clock: f64) -> f64 {
        self.waits(clock) as f64 / self.most_waits().max(1) as f64
    }

    fn estimated(&self, work: &Times<Work>) -> Times<u32> {
        self.estimates.zip(*work).map(|(estimate, work)| {
            weighed(&estimate.weights, estimate.least, &work).round() as u32
        })
    }
}

/// What each figure is estimated from.
pub fn work(program: &Program) -> Times<Work> {
    let cost = PathCost::of_function(&program.step);
    let of = |cost: Cost| {
        [
            1.0,
            program.states.len() as f64,
            f64::from(cost.additions + cost.comparisons),
            f64::from(cost.long()),
            f64::from(cost.narrow),
            f64::from(cost.lookups),
            f64::from(cost.divisions),
        ]
    };
    let (normal, worst) = (of(cost.normal), of(cost.worst));
    Times::of([normal, worst, worst, worst, worst, worst, worst])
}

/// Products of more than 32 bits on the longest path of a step.
pub fn long_products(program: &Program) -> u32 {
    PathCost::of_function(&program.step).worst.long()
}

/// Digest of a normalised specification, FNV-1a, whatever the name in its first line. The core is
/// not part of it.
pub fn digest(spec_toml: &str) -> u64 {
    let mut digest = FnvHasher::default();
    let (_name, rest) = spec_toml.split_once('\n').unwrap_or_default();
    digest.write(rest.as_bytes());
    digest.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ir::with_rare_product;
    use crate::spec::{apply_variant, check, parse_toml};

    const WEIGHTS: Work = [100.0, 10.0, 2.0, 7.0, 3.0, 5.0, 50.0];

    static COUNTED: [(u64, Times<u32>); 1] = [(17, Times::of([1, 2, 3, 4, 5, 6, 7]))];

    const CHIP: Chip = Chip {
        target: "cortex_m0",
        core: "Core",
        assumed: "code in flash",
        name: "Chip",
        clocks_of_waits: &[24e6, 36e6, 48e6],
        compiler: "rustc",
        in_c: Times::of([2.0; FIGURES]),
        estimates: Times {
            any: Estimate::of(WEIGHTS, 250.0, [0.1, 0.2, 0.3]),
            ..Times::of([Estimate::of(WEIGHTS, 0.0, [0.1, 0.2, 0.3]); FIGURES])
        },
        counted: &COUNTED,
    };

    #[test]
    fn an_estimate_weighs_the_operations_of_its_path() {
        let times = CHIP.estimated(&work(&with_rare_product()));
        let normal = 100 + 2 * 2;
        assert_eq!(times.normal, normal);
        assert_eq!([times.control, times.any_cycles], [normal + 7; 2]);
        assert_eq!(times.any, 250, "a rest takes longer");
    }

    #[test]
    fn a_counted_drive_is_known_by_its_digest_alone() {
        assert_eq!(CHIP.counted(17).map(|times| times.any), Some(5));
        assert_eq!(CHIP.counted(18), None);
    }

    #[test]
    fn an_estimate_has_the_error_of_drives_of_its_kind() {
        let kinds = [
            Peculiarity::None,
            Peculiarity::Learning,
            Peculiarity::Intervals,
        ];
        let error = |kind| CHIP.errors(kind).any_cycles;
        assert_eq!(kinds.map(error), [0.1, 0.2, 0.3]);
    }

    #[test]
    fn cycles_have_the_wait_states_of_their_clock() {
        let waits = [20e6, 24e6, 30e6, 48e6, 60e6].map(|clock| CHIP.waits(clock));
        assert_eq!(waits, [0, 0, 1, 2, 2]);
        let of = |clock| {
            let times = Times::of([10, 20, 101, 204, 30, 300, 400]);
            let times = times.with_waits(CHIP.part_of_waits(clock));
            [times.control_cycles, times.any_cycles]
        };
        assert_eq!(of(24e6), [101, 300]);
        assert_eq!(of(36e6), [153, 350], "half of 103 is rounded up");
        assert_eq!(of(48e6), [204, 400]);
        let without = Chip {
            clocks_of_waits: &[48e6],
            ..CHIP
        };
        assert_eq!(without.part_of_waits(48e6), 0.0);
    }

    #[test]
    fn between_two_estimates_each_error_counts_by_its_share() {
        let times = Times::of([10, 20, 100, 300, 30, 100, 100]);
        let errors = Times::of([0.0, 0.0, 0.4, 0.2, 0.0, 0.1, 0.1]);
        let at = |part| times.errors_with_waits(part, errors).control_cycles;
        assert_eq!([at(0.0), at(1.0)], [0.4, 0.2]);
        assert!((at(0.5) - 0.25).abs() < 1e-12);
    }

    #[test]
    fn estimates_are_told_with_two_digits() {
        let time = |errors| StepTime {
            chip: &CHIP,
            clock: 48e6,
            period: 50e-6,
            is_named: true,
            times: Times::of([7, 96, 1111, 1234, 2345, 2222, 2449]),
            errors,
        };
        assert_eq!(
            time(Some(Times::of([0.1; FIGURES]))).told().into_array(),
            [7, 96, 1100, 1200, 2300, 2200, 2400]
        );
        assert_eq!(time(None).told().control_cycles, 1234);
        assert_eq!(time(None).percent_of_period(1201), 51.0);
        assert_eq!(time(None).percent_of_period(1200), 50.0);
        // Beyond the chip's clock its memory takes more wait states.
        let at = |clock| StepTime {
            clock,
            ..time(None)
        };
        let bounds = [1.0, 0.5, 1.01].map(|share| at(share * CHIP.clock()).is_bound());
        assert_eq!(bounds, [true, true, false]);
        assert!(!time(Some(Times::of([0.1; FIGURES]))).is_bound());
        let with = |any_cycles, errors| StepTime {
            times: Times {
                any_cycles,
                ..time(errors).times
            },
            ..time(errors)
        };
        assert!(!with(2400, None).is_too_long());
        assert!(with(2401, None).is_too_long());
        assert!(with(2200, Some(Times::of([0.1; FIGURES]))).is_too_long());
        assert!(!with(2100, Some(Times::of([0.1; FIGURES]))).is_too_long());
        let in_c_only = [2401, 1201, 1200].map(|cycles| with(cycles, None).is_too_long_in_c_only());
        assert_eq!(in_c_only, [false, true, false], "twice the time in C");
    }

    /// The name and the core change nothing of what a drive computes.
    #[test]
    fn the_digest_ignores_name_and_core() {
        let of = |text: &str, variant: &str| {
            let mut ast = parse_toml(text, "motor.toml").expect("it parses");
            apply_variant(&mut ast, variant).expect("a variant");
            digest(&check(&ast).expect("it passes the checks").0.to_toml())
        };
        let text = include_str!("../example.toml");
        let known = of(text, "pdcc");
        assert_eq!(of(text, "pdcc:target=cortex_m4,core_clock=72 MHz"), known);
        let renamed = text.replace("name = \"", "name = \"Other");
        assert_ne!(renamed, text);
        assert_eq!(of(&renamed, "pdcc"), known);
        assert_ne!(of(text, "pdcc:delay=0"), known);
        assert_ne!(of(text, "pdcc:word=16"), known);
    }
}
