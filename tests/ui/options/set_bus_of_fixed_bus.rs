use hexagen::{Drive, controller};

controller! {
    pub Hub {
        motor: "motors/hub.toml",
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
    let drive = Drive::<Hub>::new();
    drive.set_bus(2400);
}
