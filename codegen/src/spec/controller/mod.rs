//! The choice of controller and its options; a file per kind holds its table and its checks.
//!
//! A new controller adds a file here and a line each to [`ControllerSpec`], [`with_options`] and
//! [`KINDS`].

pub(crate) mod common;
mod core;
pub(crate) mod fcs_mpc;
mod off_leg;
pub(crate) mod p_pwm;
pub(crate) mod pdcc;
pub(crate) mod phcc;
pub(crate) mod pi_pwm;
mod table2;

pub use common::{
    CommonMode, Discretisation, EmfSource, Learning, LimitRule, LoopOptions, Reference, SpeedLoop,
};
pub use core::{Core, Target};
pub use fcs_mpc::{Candidates, FcsMpcSpec};
pub use off_leg::OffLegModel;
pub use p_pwm::PPwmSpec;
pub use pdcc::{Modulation, PdccSpec};
pub use phcc::{PhccCandidates, PhccSpec, SwitchingTable};
pub use pi_pwm::{PiModulation, PiPwmSpec};
pub(crate) use table2::TABLE2;
pub use table2::ZeroVector;

use super::health::Drive;
use super::option_row::{Row, lines};
use super::reader::Reader;
use super::rule::Rule;
use crate::diagnostics::catalogue::Part;
use crate::diagnostics::{Collector, Diagnostic};
use common::Surroundings;

/// The options of one kind of controller: table, reader and checks.
pub(crate) trait Options: Into<ControllerSpec> + 'static {
    /// The name in a specification.
    const KIND: &'static str;
    /// The method.
    const TITLE: &'static str;
    /// Notes for the reference page.
    const NOTES: &'static str = "";
    /// Options of this kind, in the order of the normalised specification.
    const OWN: &'static [Row<Self>];
    /// Options shared with others; they follow the own ones.
    const SHARED: &'static [&'static [Row<LoopOptions>]] = &[common::LOOP, common::COMMUTATION];

    /// Reads and checks the options. None only together with an error.
    fn read(reader: &Reader, surroundings: &Surroundings, errors: &mut Collector) -> Option<Self>;

    /// The options that all controllers share.
    fn common(&self) -> &LoopOptions;

    /// The same, to change them.
    fn common_mut(&mut self) -> &mut LoopOptions;

    /// Whether it uses pulse-width modulation, instead of one vector per period.
    fn modulates(&self) -> bool;

    /// The option that turns legs off within a turn of the rotor, if one does.
    fn turns_off(&self) -> Option<TurnsOff> {
        None
    }

    /// Where the pulses of three legs lie; none where not all three are pulsed in every period.
    fn common_mode(&self) -> Option<CommonMode> {
        None
    }

    /// Whether legs change their states within a period, so that its command has intervals.
    fn has_intervals(&self) -> bool {
        false
    }

    /// Greatest excess of phase currents over the reference without a fault, ampere.
    fn overshoot(&self, _: &Drive) -> f64 {
        0.0
    }

    /// Peak of the phase currents in commutations at low speed, ampere; 0 where it is not above the
    /// peak elsewhere.
    fn swing(&self, _: &Drive) -> f64 {
        0.0
    }

    /// The error for a trip level that the currents reach; `parts`: largest set-point, trip level.
    fn refuse_trip(&self, _: &Drive, _rated: f64, _parts: [&Part; 2]) -> Option<Diagnostic> {
        None
    }
}

/// An option by which legs that carry current are turned off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TurnsOff {
    /// The option.
    pub option: &'static str,
    /// Its value.
    pub value: &'static str,
    /// The same in place of which no leg is turned off, a setting.
    pub instead: &'static str,
}

/// A controller and its options.
#[derive(Clone, Debug, PartialEq)]
pub enum ControllerSpec {
    /// Finite-control-set model predictive control.
    FcsMpc(FcsMpcSpec),
    /// Proportional control with pulse-width modulation.
    PPwm(PPwmSpec),
    /// Predictive deadbeat current control.
    Pdcc(PdccSpec),
    /// Predictive hysteresis current control.
    Phcc(PhccSpec),
    /// PI control with pulse-width modulation.
    PiPwm(PiPwmSpec),
}

/// Binds the options of any controller in an expression: the only match on the variants.
macro_rules! with_options {
    ($controller:expr, $options:ident => $use:expr) => {
        match $controller {
            $crate::spec::ControllerSpec::FcsMpc($options) => $use,
            $crate::spec::ControllerSpec::PPwm($options) => $use,
            $crate::spec::ControllerSpec::Pdcc($options) => $use,
            $crate::spec::ControllerSpec::Phcc($options) => $use,
            $crate::spec::ControllerSpec::PiPwm($options) => $use,
        }
    };
}
pub(crate) use with_options;

/// A kind of controller.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// The name in a specification.
    pub name: &'static str,
    /// The method.
    pub title: &'static str,
    pub(crate) notes: &'static str,
    pub(crate) own: fn() -> Vec<&'static Rule>,
    pub(crate) shared: fn() -> Vec<&'static Rule>,
    pub(crate) read: fn(&Reader, &Surroundings, &mut Collector) -> Option<ControllerSpec>,
}

/// The kinds of controllers.
pub const KINDS: [Kind; 5] = [
    Kind::of::<FcsMpcSpec>(),
    Kind::of::<PPwmSpec>(),
    Kind::of::<PdccSpec>(),
    Kind::of::<PhccSpec>(),
    Kind::of::<PiPwmSpec>(),
];

impl Kind {
    const fn of<S: Options>() -> Self {
        Self {
            name: S::KIND,
            title: S::TITLE,
            notes: S::NOTES,
            own: || S::OWN.iter().map(|row| &row.rule).collect(),
            shared: || {
                let rows = S::SHARED.iter().flat_map(|rows| rows.iter());
                rows.map(|row| &row.rule).collect()
            },
            read: |reader, surroundings, errors| {
                S::read(reader, surroundings, errors).map(Into::into)
            },
        }
    }

    /// All options: its own, then the shared ones.
    pub fn rules(&self) -> Vec<&'static Rule> {
        [(self.own)(), (self.shared)()].concat()
    }
}

/// The rules of `kind` and of the options of all controllers; shared options are repeated.
pub(crate) fn rules() -> impl Iterator<Item = &'static Rule> {
    const KIND: &Rule = &common::KIND;
    std::iter::once(KIND).chain(KINDS.iter().flat_map(Kind::rules))
}

impl ControllerSpec {
    /// The options that all controllers share.
    pub fn common(&self) -> &LoopOptions {
        with_options!(self, options => options.common())
    }

    /// The same with another word length, bits.
    #[must_use]
    pub fn with_word(mut self, word: u32) -> Self {
        with_options!(&mut self, options => options.common_mut().word = word);
        self
    }

    /// Whether it uses pulse-width modulation, instead of one vector per period.
    pub fn modulates(&self) -> bool {
        with_options!(self, options => options.modulates())
    }

    /// [`Options::turns_off`].
    pub(crate) fn turns_off(&self) -> Option<TurnsOff> {
        with_options!(self, options => options.turns_off())
    }

    /// Where the pulses of three legs lie; none where not all three are pulsed throughout.
    pub fn common_mode(&self) -> Option<CommonMode> {
        with_options!(self, options => options.common_mode())
    }

    /// Whether legs change their states within a period, so that its command has intervals.
    pub fn has_intervals(&self) -> bool {
        with_options!(self, options => options.has_intervals())
    }

    /// The name in a specification.
    pub fn kind(&self) -> &'static str {
        fn of<S: Options>(_: &S) -> &'static str {
            S::KIND
        }
        with_options!(self, options => of(options))
    }

    /// Its options with their values, in the order of the normalised specification.
    pub(crate) fn lines(&self) -> Vec<(&'static Rule, String)> {
        fn of<S: Options>(options: &S) -> Vec<(&'static Rule, String)> {
            let shared = S::SHARED
                .iter()
                .flat_map(|rows| lines(rows, options.common()));
            lines(S::OWN, options).into_iter().chain(shared).collect()
        }
        with_options!(self, options => of(options))
    }

    /// [`Options::overshoot`].
    pub(crate) fn overshoot(&self, drive: &Drive) -> f64 {
        with_options!(self, options => options.overshoot(drive))
    }

    /// [`Options::swing`].
    pub(crate) fn swing(&self, drive: &Drive) -> f64 {
        with_options!(self, options => options.swing(drive))
    }

    /// [`Options::refuse_trip`].
    pub(crate) fn refuse_trip(
        &self,
        drive: &Drive,
        rated: f64,
        parts: [&Part; 2],
    ) -> Option<Diagnostic> {
        with_options!(self, options => options.refuse_trip(drive, rated, parts))
    }
}

impl From<FcsMpcSpec> for ControllerSpec {
    fn from(options: FcsMpcSpec) -> Self {
        Self::FcsMpc(options)
    }
}

impl From<PPwmSpec> for ControllerSpec {
    fn from(options: PPwmSpec) -> Self {
        Self::PPwm(options)
    }
}

impl From<PdccSpec> for ControllerSpec {
    fn from(options: PdccSpec) -> Self {
        Self::Pdcc(options)
    }
}

impl From<PhccSpec> for ControllerSpec {
    fn from(options: PhccSpec) -> Self {
        Self::Phcc(options)
    }
}

impl From<PiPwmSpec> for ControllerSpec {
    fn from(options: PiPwmSpec) -> Self {
        Self::PiPwm(options)
    }
}
