//! A drive in C, as replayed by sessions.

/// Status of a C drive, in bytes.
#[repr(C)]
pub(crate) struct StatusInC {
    mode: u8,
    pub(crate) fault: u8,
    bus_is_stale: bool,
    hall_glitches: u16,
}

/// Types around the functions of drives in C, and their list.
macro_rules! drives {
    ($(
        $name:ident: [u32; $words:literal], $symbol:ident, {
            init: $init:ident, set_current: $set_current:ident, set_torque: $set_torque:ident,
            reset: $reset:ident, calibrate: $calibrate:ident, precharge: $precharge:ident,
            coast: $coast:ident, brake: $brake:ident, resume: $resume:ident,
            status: $status:ident, state_words: $state_words:ident,
            set_state_words: $set_state_words:ident
        },
        $motor:literal, $kind:literal, $options:literal, $names:expr, $spec:literal;
    )*) => {
        $(
            unsafe extern "C" {
                safe fn $init(drive: &mut $name);
                safe fn $symbol(drive: &mut $name, sample: &SampleInC) -> LegsInC;
                safe fn $set_current(drive: &mut $name, bits: i32);
                safe fn $set_torque(drive: &mut $name, bits: i32);
                safe fn $reset(drive: &mut $name);
                safe fn $calibrate(drive: &mut $name);
                safe fn $precharge(drive: &mut $name);
                safe fn $coast(drive: &mut $name);
                safe fn $brake(drive: &mut $name);
                safe fn $resume(drive: &mut $name);
                safe fn $status(drive: &$name) -> StatusInC;
                fn $state_words(drive: *const $name, words: *mut i32);
                fn $set_state_words(drive: *mut $name, words: *const i32);
            }

            #[doc = concat!("`", stringify!($name), "` in C.")]
            #[repr(C)]
            pub struct $name([u32; $words]);

            impl $name {
                const LAW: &'static [&'static str] = &$names;

                fn words(&self) -> [i32; <Self as Subject>::WORDS] {
                    let mut words = [0; <Self as Subject>::WORDS];
                    // SAFETY: it writes this many words.
                    unsafe { $state_words(self, words.as_mut_ptr()) };
                    words
                }
            }

            impl Subject for $name {
                const WORDS: usize = Supervisor::NAMES.len() + Self::LAW.len();

                fn new() -> Self {
                    let mut drive = Self([0; $words]);
                    $init(&mut drive);
                    drive
                }

                fn set_current(&mut self, bits: i32) {
                    $set_current(self, bits);
                }

                fn set_torque(&mut self, bits: i32) {
                    $set_torque(self, bits);
                }

                /// No drive here has a speed loop.
                fn set_speed(&mut self, _: i32) {}

                /// None has a measured bus voltage.
                fn set_bus(&mut self, _: u16) {}

                fn reset(&mut self) {
                    $reset(self);
                }

                fn calibrate(&mut self) {
                    $calibrate(self);
                }

                fn precharge(&mut self) {
                    $precharge(self);
                }

                fn stop(&mut self, stop: Stop) {
                    match stop {
                        Stop::Coast => $coast(self),
                        Stop::Brake => $brake(self),
                        Stop::Resume => $resume(self),
                    }
                }

                fn fault(&self) -> Option<Fault> {
                    Fault::from_number($status(self).fault.into())
                }

                fn state_words(&self, words: &mut [i32]) {
                    let own = self.words();
                    let count = own.len().min(words.len());
                    words[..count].copy_from_slice(&own[..count]);
                }

                fn set_state_word(&mut self, index: usize, value: i32) {
                    let mut words = self.words();
                    if let Some(word) = words.get_mut(index) {
                        *word = value;
                    }
                    // SAFETY: it reads this many words.
                    unsafe { $set_state_words(self, words.as_ptr()) };
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
            state_names: [&Supervisor::NAMES, $name::LAW],
            spec: $spec,
            replay: |link, task| replay(StepFn::Structure($symbol), link, task),
        },)*];
    };
}
