//! The VESC 4: pins as `hw_46.h` of the VESC firmware has them (vedderb/bldc, hwconf/other/vesc4).
//!
//! | what | where |
//! |---|---|
//! | gates of phases 1, 2, 3 (a, b, c) | `TIM1` channels 1 to 3: PA8, PA9, PA10; lower switches PB13, PB14, PB15; DRV8302, active high |
//! | currents | 1 mohm in the lower legs of phases 1 and 2; the DRV8302's amplifiers, gain 10 |
//! | samples | injected conversions of `ADC1` (channel 6, PA6) and `ADC2` (channel 5, PA5) at the update event |
//! | over-current | the DRV8302's own, which pulls PC12 low and stops its gates |
//! | gate driver on | PC10; PB12 high would calibrate its amplifiers |
//! | Hall sensors | PB6, PB7, PC11, seen at samples: they are not the inputs of one timer |
//! | commutation event | `TIM2`, reset by each update of `TIM1`, triggers it before the next one (`hexagen_stm32`) |
//! | control interrupt does not come | independent watchdog, 1 ms |

use crate::HubDrive;
use hexagen::{Control, Legs, Sample};
use hexagen_stm32::{LEAD, is_sampled_at_update, outputs, specified_dead_time};
use stm32f4xx_hal::gpio::{Input, Output, PA7, PB6, PB7, PC4, PC10, PC11, PC12, Pull};
use stm32f4xx_hal::pac::{ADC1, ADC2, Peripherals, TIM1, TIM2, adc1};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::{Config, Enable, Reset};
use stm32f4xx_hal::watchdog::IndependentWatchdog;

/// The clock of the core and of `TIM1`, the specification's `timer_clock`.
const TIMER_HZ: u32 = 168_000_000;
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

/// What the control interrupt reads and writes.
pub struct Board {
    pwm: TIM1,
    adc: (ADC1, ADC2),
    hall: (PB6<Input>, PB7<Input>, PC11<Input>),
    /// Low: the gate driver has stopped.
    fault: PC12<Input>,
    enable: PC10<Output>,
    watchdog: IndependentWatchdog,
}

/// What people see.
pub struct Lights {
    green: PC4<Output>,
    red: PA7<Output>,
}

impl Lights {
    /// Switches each on or off.
    pub fn show(&mut self, green: bool, red: bool) {
        self.green.set_state(green.into());
        self.red.set_state(red.into());
    }
}

impl Board {
    /// Sets everything up; nothing runs yet, and all gates are low.
    pub fn new(device: Peripherals) -> (Self, Lights) {
        let clocks = Config::hse(8.MHz())
            .sysclk(TIMER_HZ.Hz())
            .pclk1(42.MHz())
            .pclk2(84.MHz());
        let mut rcc = device.RCC.freeze(clocks);
        let a = device.GPIOA.split(&mut rcc);
        let b = device.GPIOB.split(&mut rcc);
        let c = device.GPIOC.split(&mut rcc);
        b.pb12.into_push_pull_output().set_low();
        a.pa5.into_analog();
        a.pa6.into_analog();
        // Resistors hold the gates low until the timer drives them.
        a.pa8
            .into_alternate::<1>()
            .set_internal_resistor(Pull::Down);
        a.pa9
            .into_alternate::<1>()
            .set_internal_resistor(Pull::Down);
        a.pa10
            .into_alternate::<1>()
            .set_internal_resistor(Pull::Down);
        b.pb13
            .into_alternate::<1>()
            .set_internal_resistor(Pull::Down);
        b.pb14
            .into_alternate::<1>()
            .set_internal_resistor(Pull::Down);
        b.pb15
            .into_alternate::<1>()
            .set_internal_resistor(Pull::Down);
        TIM1::enable(&mut rcc);
        TIM1::reset(&mut rcc);
        TIM2::enable(&mut rcc);
        TIM2::reset(&mut rcc);
        ADC1::enable(&mut rcc);
        ADC1::reset(&mut rcc);
        ADC2::enable(&mut rcc);
        set_up_pwm(&device.TIM1);
        set_up_commutation(&device.TIM2);
        // The ADCs' clock: 84 MHz by 4.
        device.ADC_COMMON.ccr().write(|w| w.adcpre().div4());
        set_up_adc(&device.ADC1, 6, true);
        set_up_adc(&device.ADC2, 5, false);
        let board = Self {
            pwm: device.TIM1,
            adc: (device.ADC1, device.ADC2),
            hall: (
                b.pb6.into_pull_up_input(),
                b.pb7.into_pull_up_input(),
                c.pc11.into_pull_up_input(),
            ),
            fault: c.pc12.into_pull_up_input(),
            enable: c.pc10.into_push_pull_output(),
            watchdog: IndependentWatchdog::new(device.IWDG),
        };
        let lights = Lights {
            green: c.pc4.into_push_pull_output(),
            red: a.pa7.into_push_pull_output(),
        };
        (board, lights)
    }
}

impl Board {
    /// What was sampled at the last update event. To be called in the interrupt of the conversions.
    pub fn sample(&mut self) -> Sample {
        self.watchdog.feed();
        let (adc_a, adc_b) = &self.adc;
        let counts = [
            adc_a.jdr1().read().jdata().bits(),
            adc_b.jdr1().read().jdata().bits(),
        ];
        // Flags are cleared by zeros.
        adc_a
            .sr()
            .modify(|_, w| w.jeoc().clear_bit().jstrt().clear_bit());
        let (a, b, c) = &self.hall;
        let code = u8::from(a.is_high()) << 2 | u8::from(b.is_high()) << 1 | u8::from(c.is_high());
        Sample::with_hall(counts, code)
    }

    /// Commands the next period: all of it is preloaded. Behind a fault of the gate driver the
    /// outputs stay off until a reset of the chip: what caused it is to be found first.
    pub fn apply(&mut self, legs: Legs) {
        let outputs = outputs(legs);
        for (channel, compare) in outputs.compare.into_iter().enumerate() {
            self.pwm.ccr(channel).write(|w| w.ccr().set(compare));
        }
        // SAFETY: these bits are enables and polarities of channels, any of which may be written.
        self.pwm
            .ccer()
            .write(|w| unsafe { w.bits(outputs.enables) });
        if self.fault.is_low() {
            self.pwm.bdtr().modify(|_, w| w.moe().clear_bit());
            self.enable.set_low();
        }
    }

    /// Starts the timer so that one update event per period is left, that of the overflow, and with
    /// it the ADCs; then the gate driver and the outputs.
    ///
    /// Which of the two it is says `DIR` behind an event. `RCR` = 1 that is written between an
    /// underflow and the next overflow is loaded by that overflow's event and leaves out the
    /// underflow behind it.
    pub fn start(&mut self) {
        self.pwm.cr1().modify(|_, w| w.cen().set_bit());
        while self.wait_for_update() {}
        self.pwm.rcr().write(|w| w.rep().set(1));
        self.wait_for_update();
        for _ in 0..4 {
            assert!(
                self.wait_for_update(),
                "TIM1 updates at the underflow: the ADCs would sample the upper switches' time"
            );
            assert!(
                self.is_commutation_next(),
                "no commutation event before the update of TIM1: TIM2 does not trigger it"
            );
        }
        self.enable.set_high();
        // The driver charges its supplies; it reports faults meanwhile.
        cortex_m::asm::delay(TIMER_HZ / 1_000 * 20);
        // Commands of the drive are OFF until it has calibrated.
        self.pwm.bdtr().modify(|_, w| w.moe().set_bit());
        self.watchdog.start(1.millis());
    }

    /// Whether a commutation event comes before the next update event. A turn of the loop takes
    /// less than [`LEAD`] clocks.
    fn is_commutation_next(&self) -> bool {
        self.pwm
            .sr()
            .modify(|_, w| w.uif().clear_bit().comif().clear_bit());
        loop {
            let status = self.pwm.sr().read();
            if status.comif().bit_is_set() || status.uif().bit_is_set() {
                return status.comif().bit_is_set();
            }
        }
    }

    /// Waits for an update event; whether the counter counts down behind it.
    fn wait_for_update(&self) -> bool {
        self.pwm.sr().modify(|_, w| w.uif().clear_bit());
        while self.pwm.sr().read().uif().bit_is_clear() {}
        self.pwm.cr1().read().dir().bit_is_set()
    }
}

/// `TIM1` as `hexagen_stm32` has it, but for its start.
fn set_up_pwm(timer: &TIM1) {
    timer
        .cr1()
        .write(|w| w.cms().center_aligned1().arpe().set_bit());
    timer.arr().write(|w| w.arr().set(HubDrive::TIMER_PERIOD));
    timer
        .cr2()
        .write(|w| w.ccpc().set_bit().ccus().set_bit().mms().update());
    timer.ccmr1_output().write(|w| {
        w.oc1m().pwm_mode1().oc1pe().set_bit();
        w.oc2m().pwm_mode1().oc2pe().set_bit()
    });
    timer
        .ccmr2_output()
        .write(|w| w.oc3m().pwm_mode1().oc3pe().set_bit());
    // RM0090, internal triggers of TIM1: number 1 is TIM2's. It does nothing to the counter.
    timer.smcr().write(|w| w.ts().itr1());
    timer
        .bdtr()
        .write(|w| w.dtg().set(DEAD_TIME).ossi().set_bit().ossr().set_bit());
    // Counter 0, prescaler and preloaded registers in force.
    timer.egr().write(|w| w.ug().set_bit());
}

/// `TIM2` is reset by each update of `TIM1`; its channel 1 rises [`LEAD`] clocks of `TIM1` before
/// the next one, which is its trigger output. It counts at half the clock of `TIM1`.
fn set_up_commutation(timer: &TIM2) {
    let period = 2 * u32::from(HubDrive::TIMER_PERIOD);
    timer
        .ccr1()
        .write(|w| w.ccr().set((period - u32::from(LEAD)) / 2));
    timer.ccmr1_output().write(|w| w.oc1m().pwm_mode2());
    timer.cr2().write(|w| w.mms().compare_oc1());
    // RM0090, internal triggers of TIM2: number 0 is TIM1's.
    timer.smcr().write(|w| w.ts().itr0().sms().reset_mode());
    timer.cr1().write(|w| w.cen().set_bit());
}

/// One injected conversion of a channel from 0 to 9 at each update of `TIM1`, sampled for 15
/// clocks.
fn set_up_adc(adc: &adc1::RegisterBlock, channel: u8, interrupts: bool) {
    adc.cr1().write(|w| w.jeocie().bit(interrupts));
    adc.smpr2().write(|w| w.smp(channel).cycles15());
    // A sequence of one is its fourth place (RM0090, ADC_JSQR).
    // SAFETY: the channel exists.
    adc.jsqr()
        .write(|w| unsafe { w.jl().set(0).jsq4().bits(channel) });
    adc.cr2().write(|w| {
        w.jextsel()
            .tim1trgo()
            .jexten()
            .rising_edge()
            .adon()
            .set_bit()
    });
}
