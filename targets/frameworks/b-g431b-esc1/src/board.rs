//! The B-G431B-ESC1: pins and peripherals as UM2516 and the data sheet of the STM32G431 have them.
//!
//! | what | where |
//! |---|---|
//! | gates of phases U, V, W (a, b, c) | `TIM1` channels 1 to 3: PA8, PA9, PA10; lower switches PC13, PA12, PB15; driver L6387, active high |
//! | currents | 3 mohm in each lower leg; op-amps 1, 2 (PA1, PA7) at gain 16, behind the board's dividers 64/7; op-amp 3 (PB0), of phase c, is not read |
//! | samples | injected conversions of `ADC1` (op-amp 1, PA2) and `ADC2` (op-amp 2, PA6) at the update event |
//! | over-current | comparators 1, 2, 4 on the inputs of all three op-amps, against `DAC3`: break of `TIM1` |
//! | Hall sensors | PB6, PB7, PB8: `TIM4`, whose counter each edge resets |
//! | commutation event | `TIM2`, reset by each update of `TIM1`, triggers it before the next one (`hexagen_stm32`) |
//! | control interrupt does not come | independent watchdog, 1 ms |

use crate::HubDrive;
use core::mem::forget;
use embassy_stm32::adc::{Adc, AdcChannel, AdcConfig, Exten, InjectedAdc, SampleTime};
use embassy_stm32::comp::{self, Comp};
use embassy_stm32::dac::{DacChannel, Value};
use embassy_stm32::gpio::{OutputType, Pull, Speed};
use embassy_stm32::interrupt::{self, InterruptExt, Priority};
use embassy_stm32::opamp::{OpAmp, OpAmpGain, OpAmpSpeed};
use embassy_stm32::pac::gpio::vals::Idr;
use embassy_stm32::pac::timer::{regs, vals};
use embassy_stm32::pac::{self, GPIOB};
use embassy_stm32::peripherals::{ADC1, ADC2, COMP1, COMP2, COMP4, IWDG, TIM2, TIM4};
use embassy_stm32::rcc;
use embassy_stm32::time::Hertz;
use embassy_stm32::timer::complementary_pwm::{ComplementaryPwm, ComplementaryPwmPin};
use embassy_stm32::timer::input_capture::CapturePin;
use embassy_stm32::timer::low_level::CountingMode;
use embassy_stm32::timer::simple_pwm::{PwmPin, PwmPinConfig};
use embassy_stm32::timer::{Ch1, Ch2, Ch3};
use embassy_stm32::triggers::TIM1_TRGO;
use embassy_stm32::wdg::IndependentWatchdog;
use embassy_stm32::{Config, Peripherals, bind_interrupts};
use hexagen::{Control, Legs, Sample};
use hexagen_stm32::{LEAD, is_sampled_at_update, outputs, specified_dead_time};

/// The timers' clock, the specification's `timer_clock`.
const TIMER_HZ: u32 = 170_000_000;
/// From the timers' clock to the Hall timer's.
const HALL_PRESCALER: u16 = 170;
const _: () = assert!(HubDrive::HALL_TIMER_HZ * HALL_PRESCALER as u32 == TIMER_HZ);
const _: () = assert!(
    2 * HubDrive::TIMER_PERIOD as u64 * 1_000_000_000 == HubDrive::T_S_NS as u64 * TIMER_HZ as u64,
    "the specification has another `timer_clock`"
);
const _: () = assert!(
    is_sampled_at_update(HubDrive::SPEC),
    "`TIM1`'s update starts the ADCs here: state `sampling_lead: 0 ns`, or start them by its channel 4"
);
/// The specification's `dead_time`.
const DEAD_TIME: u8 = match specified_dead_time(HubDrive::SPEC, TIMER_HZ) {
    Some(bits) => bits,
    None => panic!("the specification states no dead time, or one that the timer cannot make"),
};
/// Where the comparators cut the outputs: 25 A above the mid-scale of the op-amps, at their inputs.
/// The ADCs see 16 times as much, and both go by the same reference. Counts rise with current out of the motor: a current
/// into one phase is seen in the other two, through which it leaves.
const OVER_CURRENT: u16 = (2048 + 850) / 16;

bind_interrupts!(struct Irqs {
    COMP1_2_3 => comp::InterruptHandler<COMP1>, comp::InterruptHandler<COMP2>;
    COMP4 => comp::InterruptHandler<COMP4>;
});

/// 170 MHz from the internal oscillator, for the core, all timers and, divided by 4, the ADCs.
pub fn clocks() -> Config {
    let mut config = Config::default();
    config.rcc.pll = Some(rcc::Pll {
        source: rcc::PllSource::HSI,
        prediv: rcc::PllPreDiv::DIV4,
        mul: rcc::PllMul::MUL85,
        divp: None,
        divq: None,
        divr: Some(rcc::PllRDiv::DIV2),
    });
    config.rcc.sys = rcc::Sysclk::PLL1_R;
    config.rcc.boost = true;
    config.rcc.mux.adc12sel = rcc::mux::Adcsel::SYS;
    config
}

/// What the control interrupt reads and writes.
pub struct Board {
    phase_a: InjectedAdc<'static, ADC1, 1>,
    phase_b: InjectedAdc<'static, ADC2, 1>,
    watchdog: IndependentWatchdog<'static, IWDG>,
}

impl Board {
    /// Sets everything up; nothing runs yet, and all gates are low.
    pub fn new(mut p: Peripherals) -> Self {
        // Bits of op-amps and comparators are in reach behind the clock of SYSCFG, which embassy
        // has switched on. What is dropped is switched off: what stays on for good is forgotten.
        let mut op_amp = OpAmp::new(p.OPAMP1, OpAmpSpeed::HighSpeed);
        let (plus, bias, out) = (p.PA1.reborrow(), p.PA3.reborrow(), p.PA2.reborrow());
        forget(op_amp.pga_biased_ext(plus, bias, out, OpAmpGain::Mul16));
        let mut op_amp = OpAmp::new(p.OPAMP2, OpAmpSpeed::HighSpeed);
        let (plus, bias, out) = (p.PA7.reborrow(), p.PA5.reborrow(), p.PA6.reborrow());
        forget(op_amp.pga_biased_ext(plus, bias, out, OpAmpGain::Mul16));

        // DAC3 serves comparators alone: channel 1 numbers 1 and 3, channel 2 numbers 2 and 4.
        let mut threshold =
            DacChannel::new_internal_blocking::<_, embassy_stm32::dac::Ch1>(p.DAC3.reborrow());
        threshold.set(Value::Bit12Right(OVER_CURRENT));
        forget(threshold);
        let mut threshold = DacChannel::new_internal_blocking::<_, embassy_stm32::dac::Ch2>(p.DAC3);
        threshold.set(Value::Bit12Right(OVER_CURRENT));
        forget(threshold);
        let config = comp::Config {
            inverting_input: comp::InvertingInput::Dac1,
            hysteresis: comp::Hysteresis::Hyst10M,
            ..comp::Config::default()
        };
        let mut over_current = Comp::new(p.COMP1, p.PA1.reborrow(), Irqs, config);
        over_current.enable();
        forget(over_current);
        let mut over_current = Comp::new(p.COMP2, p.PA7.reborrow(), Irqs, config);
        over_current.enable();
        forget(over_current);
        let mut over_current = Comp::new(p.COMP4, p.PB0, Irqs, config);
        over_current.enable();
        forget(over_current);

        let pin = PwmPinConfig {
            output_type: OutputType::PushPull,
            speed: Speed::High,
            // Holds the gates low until the timer drives them.
            pull: Pull::Down,
        };
        let mut pwm = ComplementaryPwm::new(
            p.TIM1,
            Some(PwmPin::new_with_config(p.PA8, pin)),
            Some(ComplementaryPwmPin::new_with_config(p.PC13, pin)),
            Some(PwmPin::new_with_config(p.PA9, pin)),
            Some(ComplementaryPwmPin::new_with_config(p.PA12, pin)),
            Some(PwmPin::new_with_config(p.PA10, pin)),
            Some(ComplementaryPwmPin::new_with_config(p.PB15, pin)),
            None,
            None,
            Hertz(20_000),
            CountingMode::CenterAlignedUpInterrupts,
        );
        pwm.set_master_output_enable(false);
        for comparator in [0, 1, 3] {
            pwm.set_break_comparator_enable(comparator, true);
        }
        forget(pwm);
        forget(CapturePin::<TIM4, Ch1>::new(p.PB6, Pull::Up));
        forget(CapturePin::<TIM4, Ch2>::new(p.PB7, Pull::Up));
        forget(CapturePin::<TIM4, Ch3>::new(p.PB8, Pull::Up));
        set_up_pwm();
        set_up_commutation();
        set_up_hall_timer();

        let adc = AdcConfig::default;
        let (sampled, edge) = (SampleTime::CYCLES6_5, Exten::RISING_EDGE);
        let channel = [(p.PA2.degrade_adc(), sampled)];
        let phase_a =
            Adc::new(p.ADC1, adc()).setup_injected_conversions(channel, TIM1_TRGO, edge, true);
        let channel = [(p.PA6.degrade_adc(), sampled)];
        let phase_b =
            Adc::new(p.ADC2, adc()).setup_injected_conversions(channel, TIM1_TRGO, edge, false);
        Self {
            phase_a,
            phase_b,
            watchdog: IndependentWatchdog::new(p.IWDG, 1_000),
        }
    }
}

impl Board {
    /// Starts the timer so that one update event per period is left, that of the overflow, and with
    /// it the ADCs; then the outputs, and the watchdog.
    ///
    /// Which of the two it is says `DIR` behind an event. `RCR` = 1 that is written between an
    /// underflow and the next overflow is loaded by that overflow's event and leaves out the
    /// underflow behind it.
    pub fn start(&mut self) {
        let timer = pac::TIM1;
        timer.cr1().modify(|w| w.set_cen(true));
        while wait_for_update() != vals::Dir::UP {}
        timer.rcr().write(|w| w.set_rep(1));
        wait_for_update();
        for _ in 0..4 {
            assert!(
                wait_for_update() == vals::Dir::DOWN,
                "TIM1 updates at the underflow: the ADCs would sample the upper switches' time"
            );
            assert!(
                is_commutation_next(),
                "no commutation event before the update of TIM1: TIM2 does not trigger it"
            );
        }
        // Commands of the drive are OFF until it has calibrated.
        timer.bdtr().modify(|w| w.set_moe(true));
        self.watchdog.unleash();
    }

    /// What was sampled at the last update event. To be called in the interrupt of the conversions.
    pub fn sample(&mut self) -> Sample {
        self.watchdog.pet();
        let [a] = self.phase_a.read_injected_samples();
        let [b] = self.phase_b.read_injected_samples();
        let (code, ticks) = hall();
        Sample::with_hall([a, b], code).hall_ticks(ticks)
    }
}

/// Commands the next period: all of it is preloaded.
pub fn apply(legs: Legs) {
    let outputs = outputs(legs);
    for (channel, compare) in outputs.compare.into_iter().enumerate() {
        pac::TIM1.ccr(channel).write(|w| w.set_ccr(compare));
    }
    pac::TIM1.ccer().write_value(regs::CcerAdv(outputs.enables));
}

/// Whether a comparator has cut the outputs. They come on again after a reset of the chip: what
/// drew the current is to be found first.
pub fn has_tripped() -> bool {
    !pac::TIM1.bdtr().read().moe()
}

/// Code and ticks of one moment: an edge in between shows in a second count that is lower.
fn hall() -> (u8, u16) {
    loop {
        let before = ticks();
        // PB6, PB7, PB8 are Ha, Hb, Hc, and Ha is bit 2.
        let port = GPIOB.idr().read();
        let is_high = |pin| u8::from(port.idr(pin) == Idr::HIGH);
        let code = is_high(6) << 2 | is_high(7) << 1 | is_high(8);
        let after = ticks();
        if after >= before {
            return (code, after);
        }
    }
}

/// Microseconds since the last Hall edge; from the counter's first overflow on 65535.
fn ticks() -> u16 {
    let status = pac::TIM4.sr().read();
    if status.ccif(0) {
        // An edge: what overflowed before it counts no longer. Flags are cleared by zeros.
        pac::TIM4.sr().write(|w| {
            w.0 = !0;
            w.set_ccif(0, false);
            w.set_uif(false);
        });
    } else if status.uif() {
        return u16::MAX;
    }
    pac::TIM4.cnt().read().cnt()
}

/// `TIM1` as [`hexagen_stm32`] has it, but for its start.
fn set_up_pwm() {
    let timer = pac::TIM1;
    timer.cr1().modify(|w| w.set_cen(false));
    timer.psc().write_value(0);
    timer.arr().write(|w| w.set_arr(HubDrive::TIMER_PERIOD));
    timer.rcr().write(|w| w.set_rep(0));
    timer.cr2().modify(|w| {
        w.set_ccpc(true);
        w.set_ccus(true);
        w.set_mms(vals::Mms::UPDATE);
    });
    // RM0440, interconnection of timers: internal trigger 1 is TIM2's. The trigger does nothing to
    // the counter.
    timer.smcr().modify(|w| {
        w.set_ts(vals::Ts::ITR1);
        w.set_sms(vals::Sms::DISABLED);
    });
    timer.bdtr().modify(|w| {
        w.set_dtg(DEAD_TIME);
        w.set_ossi(vals::Ossi::IDLE_LEVEL);
        w.set_ossr(vals::Ossr::IDLE_LEVEL);
        w.set_bkp(0, vals::Bkp::ACTIVE_HIGH);
        w.set_bke(0, true);
    });
    // Counter 0, prescaler and preloaded registers in force.
    timer.egr().write(|w| w.set_ug(true));
}

/// `TIM2` is reset by each update of `TIM1`; its channel 1 rises [`LEAD`] clocks before the next
/// one, which is its trigger output.
fn set_up_commutation() {
    rcc::enable_and_reset::<TIM2>();
    let timer = pac::TIM2;
    let period = 2 * u32::from(HubDrive::TIMER_PERIOD);
    timer.ccr(0).write_value(period - u32::from(LEAD));
    timer
        .ccmr_output(0)
        .modify(|w| w.set_ocm(0, vals::Ocm::PWM_MODE2));
    timer.cr2().modify(|w| w.set_mms(vals::Mms::COMPARE_OC1));
    timer.smcr().modify(|w| {
        w.set_ts(vals::Ts::ITR0);
        w.set_sms(vals::Sms::RESET_MODE);
    });
    timer.cr1().modify(|w| w.set_cen(true));
}

/// `TIM4` as Hall interface (RM0440: all three inputs by exclusive or, each edge resets the counter
/// and is captured), at 1 MHz. With `URS` only its overflow sets the update flag.
fn set_up_hall_timer() {
    rcc::enable_and_reset::<TIM4>();
    let timer = pac::TIM4;
    timer.psc().write_value(HALL_PRESCALER - 1);
    timer.arr().write(|w| w.set_arr(u16::MAX));
    timer.cr2().modify(|w| w.set_ti1s(vals::Ti1s::XOR));
    timer.ccmr_input(0).modify(|w| {
        w.set_ccs(0, vals::CcmrInputCcs::TRC);
        w.set_icf(0, vals::FilterValue::FDTS_DIV16_N8);
    });
    timer.ccer().modify(|w| w.set_cce(0, true));
    timer.smcr().modify(|w| {
        w.set_ts(vals::Ts::TI1F_ED);
        w.set_sms(vals::Sms::RESET_MODE);
    });
    timer.cr1().modify(|w| w.set_urs(vals::Urs::COUNTER_ONLY));
    timer.egr().write(|w| w.set_ug(true));
    timer.cr1().modify(|w| w.set_cen(true));
}

/// Lets the control interrupt in, above all others. Out of reset all have one priority, and then
/// the time driver's and the comparators' would delay it.
pub fn let_interrupt_in() {
    // SAFETY: nobody else sets priorities, and no critical section goes by them.
    let controller = unsafe { cortex_m::Peripherals::steal() }.NVIC;
    for priority in &controller.ipr {
        // SAFETY: as above.
        unsafe { priority.write(Priority::P1.into()) };
    }
    interrupt::ADC1_2.set_priority(Priority::P0);
    // SAFETY: what the handler uses was handed over to it before.
    unsafe { interrupt::ADC1_2.enable() };
}

/// Whether a commutation event comes before the next update event. A turn of the loop takes less
/// than [`LEAD`] clocks.
fn is_commutation_next() -> bool {
    let timer = pac::TIM1;
    timer.sr().write(|w| {
        w.0 = !0;
        w.set_uif(false);
        w.set_comif(false);
    });
    loop {
        let status = timer.sr().read();
        if status.comif() || status.uif() {
            return status.comif();
        }
    }
}

/// Waits for an update event; the counter's direction behind it.
fn wait_for_update() -> vals::Dir {
    let timer = pac::TIM1;
    timer.sr().write(|w| {
        w.0 = !0;
        w.set_uif(false);
    });
    while !timer.sr().read().uif() {}
    timer.cr1().read().dir()
}
