//! Plausible motors with a fitting inverter, at random.

use crate::is_whole;
use hexagen_lab::engine::{MotorSource, Prepared, prepare};

/// A generator of random numbers that gives the same motors everywhere.
struct Random(u64);

impl Random {
    /// The next number, from 0 to 1.
    fn next(&mut self) -> f64 {
        // The constants are those of splitmix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut word = self.0;
        word = (word ^ word >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        word = (word ^ word >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (word >> 11) as f64 / 53_f64.exp2()
    }

    fn one_of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[(self.next() * choices.len() as f64) as usize]
    }

    /// Between both, the same chance for every decade.
    fn decades(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
}

/// A motor with its inverter.
#[derive(Clone, Debug)]
pub struct RandomMotor {
    toml: String,
}

impl RandomMotor {
    /// The motor of this number.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let bus = random.one_of(&[12.0, 18.0, 24.0, 36.0, 48.0, 60.0, 96.0, 160.0, 320.0]);
        let current = random.decades(1.0, 60.0);
        let f_pwm = random.one_of(&[10e3, 16e3, 20e3, 25e3, 32e3, 40e3]);
        // Copper takes 2 to 12 percent of the bus at rated current.
        let resistance = bus * random.decades(0.02, 0.12) / current / 2.0;
        // The winding's time constant is 2 to 60 control periods.
        let inductance = resistance * random.decades(2.0, 60.0) / f_pwm;
        let speed = random.decades(300.0, 20_000.0);
        // The line EMF at rated speed leaves room for copper and control.
        let line_emf = bus * (0.5 + 0.25 * random.next());
        let constant = line_emf / (speed * std::f64::consts::TAU / 60.0);
        let shape = random.one_of(&["trapezoidal", "sinusoidal"]);
        let pole_pairs = random.one_of(&[1, 2, 3, 4, 5, 7, 10, 14]);
        let adc_bits = random.one_of(&[10, 12, 12, 14]);
        let range = current * (2.0 + random.next());
        let clock = random.one_of(&[48, 64, 72, 84, 168]);
        let hall = random.one_of(&["", "hall_timer_clock = \"1 MHz\"\n"]);
        let toml = format!(
            "[motor]\npole_pairs = {pole_pairs}\nresistance = \"{resistance:.6} ohm per_phase\"\n\
             inductance = \"{:.6} mH per_phase\"\nwinding = \"star\"\n\
             back_emf = \"{constant:.8} V/(rad/s) line_to_line peak\"\nemf_shape = \"{shape}\"\n\
             rated_current = \"{current:.3} A peak\"\nrated_speed = \"{speed:.0} rpm\"\n\
             [inverter]\nbus_voltage = \"{bus} V\"\nf_pwm = \"{f_pwm} Hz\"\ntimer_clock = \"{clock} MHz\"\n\
             adc_bits = {adc_bits}\nadc_range = \"{range:.3} A\"\ncurrent_sensing = \"in_phase\"\n{hall}[controller]\nkind = \"pdcc\"\n",
            inductance * 1e3,
        );
        Self { toml }
    }

    /// Its file.
    #[must_use]
    pub fn toml(self) -> String {
        self.toml
    }
}

/// Drives of random motors, numbered from `first` on, that the generator takes and that fit: `few`
/// in a push, and `many` where `HEXAGEN_WHOLE_PRODUCTS` is set, as in the nightly run.
pub fn random_drives(
    first: u64,
    variant: &str,
    [few, many]: [usize; 2],
    fits: impl Fn(&Prepared) -> bool,
) -> Vec<Prepared> {
    let drives = (first..).filter_map(|seed| {
        let name = format!("motor {seed}");
        let file = format!("{name}.toml");
        let text = RandomMotor::new(seed).toml();
        prepare(&MotorSource { name, file, text }, Some(variant)).ok()
    });
    let wanted = if is_whole() { many } else { few };
    drives.filter(fits).take(wanted).collect()
}
