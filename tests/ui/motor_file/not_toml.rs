use hexagen::controller;

controller! {
    pub Hub {
        motor: "motors/not_toml.toml",
        inverter: {
            bus_voltage: 48 V,
            f_pwm: 20 kHz,
            timer_clock: 72 MHz,
            adc_bits: 12,
            adc_range: 40 A,
            current_sensing: in_phase,
        },
        controller: pdcc,
    }
}

fn main() {
    // The type keeps its shape: nothing here is reported.
    let mut hub = hexagen::Drive::<Hub>::new();
    let legs = hub.step(&hexagen::Sample::with_hall([2048, 2048], 1));
    let _: [u16; 3] = legs.compare();
    hub.reset();
}
