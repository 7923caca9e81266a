use hexagen::controller;

controller! {
    pub Hub {
        motor: {
            pole_pairs: 4,
            resistance: 0,135 ohm per_phase,
            inductance: 0.22 mH per_phase,
            winding: star,
            back_emf: 0.1648 V/(rad/s) line_to_line peak,
            emf_shape: trapezoidal,
            rated_current: 20 A,
            rated_torque: 3.3 Nm,
            rated_speed: 2000 rpm,
        },
        inverter: {
            bus_voltage: 48 V,
            f_pwm: 20 kHz,
            timer_clock: 72 MHz,
            adc_bits: 12,
            adc_range: 40 A,
            current_sensing: in_phase,
            sensed_phases: a, b, c,
        },
        controller: pdcc,
    }
}

fn main() {}
