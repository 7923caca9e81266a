//! A drive in C as the trait that all drives share.

use hexagen_firmware::hexagen::{Fault, Mode, Status};

/// Mode and fault as C hands them over, of a byte each.
#[repr(C)]
pub(crate) struct CStatus {
    mode: u8,
    fault: u8,
}

impl CStatus {
    pub(crate) fn read(&self) -> Status {
        let modes = [Mode::Run, Mode::Calibrate, Mode::Precharge, Mode::Tripped];
        let faults = [
            Fault::None,
            Fault::AdcRange,
            Fault::OverCurrent,
            Fault::Hall,
            Fault::Stall,
            Fault::Offset,
        ];
        Status {
            mode: modes[usize::from(self.mode)],
            fault: faults[usize::from(self.fault)],
            // No drive here is told its bus voltage.
            bus_is_stale: false,
        }
    }
}

/// Types around the functions of drives in C, and the list of them.
macro_rules! drives {
    ($(
        $name:ident: [u32; $words:literal], $symbol:ident, {
            init: $init:ident, set_current: $set_current:ident, set_torque: $set_torque:ident,
            reset: $reset:ident, calibrate: $calibrate:ident, precharge: $precharge:ident,
            status: $status:ident, state_words: $state_words:ident,
            set_state_word: $set_state_word:ident
        },
        $motor:literal, $kind:literal, $options:literal, $names:expr, $spec:literal;
    )*) => {
        $(
            unsafe extern "C" {
                fn $init(drive: *mut $name);
                /// The last argument is for drives with a capture timer: a function in C may be handed more than it takes.
                safe fn $symbol(
                    drive: &mut $name,
                    adc_a: u16,
                    adc_b: u16,
                    hall: u8,
                    hall_ticks: u16,
                ) -> LegsInC;
                fn $set_current(drive: *mut $name, bits: i32);
                fn $set_torque(drive: *mut $name, bits: i32);
                fn $reset(drive: *mut $name);
                fn $calibrate(drive: *mut $name);
                fn $precharge(drive: *mut $name);
                fn $status(drive: *const $name) -> CStatus;
                fn $state_words(drive: *const $name, words: *mut i32);
                fn $set_state_word(drive: *mut $name, index: u16, value: i32);
            }

            #[doc = concat!("`", stringify!($name), "` in C.")]
            #[repr(C)]
            pub struct $name(UnsafeCell<[u32; $words]>);

            // SAFETY: what both halves reach are volatile words of C.
            unsafe impl Sync for $name {}

            impl $name {
                fn pointer(&self) -> *mut Self {
                    self.0.get().cast()
                }
            }

            // SAFETY (of all calls here): the drive is initialised, its size is as C has it, and one context uses it.
            impl Drive for $name {
                type SetPointHalf = Self;
                type LoopHalf<'drive> = Whole<'drive, Self>;
                const NAME: &'static str = stringify!($name);
                const SPEC: &'static str = $spec;
                const FORMATS: &'static [Format] = &[];
                const STATE_NAMES: &'static [&'static str] = &$names;

                fn new() -> Self {
                    let drive = Self(UnsafeCell::new([0; $words]));
                    unsafe { $init(drive.pointer()) };
                    drive
                }

                /// The bench runs one half after the other.
                fn split(&mut self) -> (&Self, Whole<'_, Self>) {
                    let pointer = self.pointer();
                    (self, Whole(pointer, PhantomData))
                }

                fn set_point(&self) -> &Self {
                    self
                }

                fn state_words(&self, words: &mut [i32]) {
                    if words.len() >= Self::STATE_NAMES.len() {
                        unsafe { $state_words(self.pointer(), words.as_mut_ptr()) };
                    }
                }

                fn set_state_word(&mut self, index: usize, value: i32) {
                    unsafe { $set_state_word(self.pointer(), index as u16, value) };
                }
            }

            impl DriveSetPoint for $name {
                fn set_current(&self, current: I16F16) {
                    unsafe { $set_current(self.pointer(), current.to_bits()) };
                }

                fn set_torque(&self, torque: I16F16) {
                    unsafe { $set_torque(self.pointer(), torque.to_bits()) };
                }

                fn set_bus(&self, _counts: u16) {}

                fn status(&self) -> Status {
                    unsafe { $status(self.pointer()) }.read()
                }
            }

            impl DriveLoop for Whole<'_, $name> {
                fn step(&mut self, sample: &Sample) -> Legs {
                    let drive = unsafe { &mut *self.0 };
                    StepFn::Structure($symbol).call(drive, *sample)
                }

                fn reset(&mut self) {
                    unsafe { $reset(self.0) };
                }

                fn calibrate(&mut self) {
                    unsafe { $calibrate(self.0) };
                }

                fn precharge(&mut self) {
                    unsafe { $precharge(self.0) };
                }

                fn status(&self) -> Status {
                    unsafe { $status(self.0) }.read()
                }
            }
        )*

        /// All drives in C.
        pub static DRIVES: Drives = &[$(Listed {
            symbol: stringify!($symbol),
            motor: $motor,
            kind: $kind,
            options: $options,
            size: size_of::<$name>(),
            state_names: <$name as Drive>::STATE_NAMES,
            spec: <$name as Drive>::SPEC,
            replay: |link, task| replay(StepFn::Structure($symbol), link, task),
        },)*];
    };
}
