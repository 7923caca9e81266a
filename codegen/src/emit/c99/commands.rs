//! The public functions besides start, step and setters: modes, status and the record of a trip.

use super::drive::{Drive, Method, doc, lines};
use super::layout::INDENT;

impl Drive<'_> {
    /// All methods besides start, step and setters.
    pub(super) fn commands(&self) -> [Method; 8] {
        let publish = "drive->status = hexagen_status_word(&drive->supervisor);";
        let command = |name: &str, text: &[&str], body: String| Method {
            doc: doc(text),
            head: format!("void {}({})", self.names.public(name), self.drive()),
            body: body + &lines(&[publish]),
        };
        let inner = INDENT.repeat(2);
        let reset = format!(
            "{INDENT}if (hexagen_reset(&drive->supervisor, &limits)) {{\n\
             {inner}drive->state = initial;\n{inner}drive->{} = 0;\n\
             {inner}drive->trip_number = (drive->trip_number + 1U) & ~UINT32_C(1);\n{INDENT}}}\n",
            self.demand()
        );
        let run = |name: &str| lines(&[&format!("hexagen_{name}(&drive->supervisor, &limits);")]);
        let is_stale = if self.has_bus() {
            "hexagen_bus_is_stale(&drive->bus)"
        } else {
            "false"
        };
        [
            command(
                "reset",
                &[
                    "Clears a trip and all control state, and sets the set-point to 0; keeps calibrated offsets.",
                    "Ignored while calibrating and pre-charging. A start follows, without calibration and pre-charge: if the bootstrap capacitors need it, call `precharge()` right behind this. Each call begins the start anew. With a speed loop the set-point is the speed, and speed 0 brakes a turning rotor with up to the current limit.",
                ],
                reset,
            ),
            command(
                "calibrate",
                &[
                    "Starts current-offset calibration: all legs off, the motor at rest. Pre-charge, if specified, a start and control with the",
                    "present set-point follow by themselves. Ignored when tripped.",
                ],
                run("calibrate"),
            ),
            command(
                "precharge",
                &[
                    "Starts bootstrap pre-charge: all lower switches on, which short-circuits a turning motor; a start, in which all legs are off, and control follow by themselves.",
                    "Accepted during control, too: call it only at rest. Ignored when tripped, calibrating, coasting and braking, and if the specification has no pre-charge.",
                ],
                run("precharge"),
            ),
            command(
                "coast",
                &[
                    "Turns all legs off on purpose, without a fault, until `resume()` or a reset.",
                    "Above the speed at which the EMF reaches the bus voltage the diodes still brake the motor into the bus. Ignored when tripped, calibrating and pre-charging.",
                ],
                lines(&["hexagen_coast(&drive->supervisor);"]),
            ),
            command(
                "brake",
                &[
                    "Slows the rotor down until `resume()` or a reset: all lower switches on where the motor takes no more than `max_current` that way;",
                    "above that speed this current against the rotation, with a speed loop speed 0 within the current that is set, into the bus. In a start, once that is over. Ignored when tripped, calibrating and pre-charging.",
                ],
                lines(&["hexagen_brake(&drive->supervisor);"]),
            ),
            command(
                "resume",
                &[
                    "Ends coasting and braking: control at set-point 0 follows, behind what is left of a start that they interrupted, with the rotor's angle and speed as they were followed meanwhile. Ignored if the drive does neither.",
                ],
                format!(
                    "{INDENT}if (hexagen_resume(&drive->supervisor)) {{\n{inner}drive->{} = 0;\n{INDENT}}}\n",
                    self.demand()
                ),
            ),
            Method {
                doc: doc(&[
                    "Mode and fault of the drive after the last control period or call; may be called from any context.",
                ]),
                head: format!(
                    "hexagen_status {}(const {})",
                    self.names.public("status"),
                    self.drive()
                ),
                body: lines(&[&format!(
                    "return hexagen_status_of(drive->status, {is_stale});"
                )]),
            },
            self.trip(),
        ]
    }

    /// What was kept of a trip.
    fn trip(&self) -> Method {
        Method {
            doc: doc(&[
                "The control period in which the drive tripped, kept until a reset: true where there is one.",
                "False while the drive is not tripped, and if a reset interrupts the call.",
            ]),
            head: format!(
                "bool {}(const {}, {} *trip)",
                self.names.public("trip"),
                self.drive(),
                self.names.trip_record()
            ),
            body: lines(&[
                "const uint32_t number = drive->trip_number;",
                "*trip = drive->trip;",
                "return (number & 1U) != 0U && drive->trip_number == number;",
            ]),
        }
    }
}
