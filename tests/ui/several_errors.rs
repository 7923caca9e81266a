use hexagen::controller;

controller! {
    pub Hub {
        motor: {
            pole_pairs: 0,
            resistance: 135 mohm,
            inductance: 0.22 mH per_phase,
            winding: star,
            back_emf: 0.1648 V/(rad/s) line_to_line peak,
            emf_shape: square,
            rated_current: 20 A,
            rated_torque: 3.3 Nm,
            rated_speed: 2000 rpm,
        },
        inverter: {
            bus_voltage: 48,
            f_pwm: 20 kHz,
            timer_clock: 72 MHz,
            adc_bits: 12,
            adc_range: 40 A,
            current_sensing: in_phase,
        },
        controller: pdcc { word: 8 },
    }
}

fn main() {}
