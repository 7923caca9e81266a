use hexagen::controller;

controller! {
    pub Hub {
        motor: {
            pole_pairs: 4,
            resistance: 18.2 mohm per_phase,
            inductance: 8.32 uH per_phase,
            winding: star,
            back_emf: 0.0195 V/(rad/s) line_to_line peak,
            emf_shape: trapezoidal,
            rated_current: 5 A,
            rated_torque: 0.0975 Nm,
            rated_speed: 3000 rpm,
        },
        inverter: {
            bus_voltage: 11.1 V,
            f_pwm: 20 kHz,
            timer_clock: 72 MHz,
            adc_bits: 12,
            adc_range: 40 A,
        },
        controller: fcs-mpc { modulated: on },
    }
}

fn main() {}
