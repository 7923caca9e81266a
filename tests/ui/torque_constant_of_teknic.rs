use hexagen::controller;

controller! {
    pub Hub {
        motor: {
            pole_pairs: 4,
            resistance: 0.36 ohm per_phase,
            inductance: 0.2 mH per_phase,
            winding: star,
            back_emf: 4.64 V/krpm line_to_line peak,
            emf_shape: sinusoidal,
            rated_current: 7.1 A,
            torque_constant: 0.274 Nm/A,
            rated_speed: 2000 rpm,
        },
        inverter: {
            bus_voltage: 48 V,
            f_pwm: 20 kHz,
            timer_clock: 72 MHz,
            adc_bits: 12,
            adc_range: 40 A,
        },
        controller: pdcc,
    }
}

fn main() {}
