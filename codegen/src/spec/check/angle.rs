//! What tells the rotor's position: Hall sensors, or an angle in every sample.

use crate::diagnostics::{Collector, catalogue};
use crate::spec::reader::Reader;
use crate::spec::{AngleDirection, AngleSensor, RotorSource};

/// Default of the bits that an angle sensor resolves: a coarse one, whose speed needs the most filtering.
const BITS: u32 = 12;

/// Fields of the angle sensor.
const OF_ANGLE: [&str; 4] = [
    "angle_pole_pairs",
    "angle_offset",
    "angle_direction",
    "angle_bits",
];

/// The setting with which fields of Hall sensors have an effect.
const HALLS: &str = "rotor: halls";

/// Largest step of a sensor, electrical degrees: a coarser one tells the angle worse than Hall sensors do between
/// their edges.
const COARSEST: f64 = 3.0;

/// The source of the position, none if it cannot be read, and the angle sensor. Of the latter none with Hall sensors,
/// and together with an error.
pub(super) fn read(
    reader: &Reader,
    pole_pairs: Option<u32>,
    errors: &mut Collector,
) -> (Option<RotorSource>, Option<AngleSensor>) {
    let source = match (reader.field("rotor"), reader.choice(errors, "rotor", &[])) {
        (None, _) => RotorSource::Halls,
        (Some(_), Some(source)) => source,
        (Some(_), None) => return (None, None),
    };
    if source == RotorSource::Halls {
        reader.refuse_without(errors, "rotor: angle", &OF_ANGLE);
        return (Some(source), None);
    }
    reader.refuse_without(errors, HALLS, &["hall_codes", "hall_angles"]);
    (Some(source), sensor(reader, pole_pairs, errors))
}

fn sensor(reader: &Reader, pole_pairs: Option<u32>, errors: &mut Collector) -> Option<AngleSensor> {
    const PAIRS: &str = "angle_pole_pairs";
    let is_given = |name| reader.field(name).is_some();
    let pairs = reader.integer(errors, PAIRS);
    let offset = reader.plain_quantity(errors, "angle_offset");
    let direction = reader.choice(errors, "angle_direction", &[]);
    let bits = reader.integer(errors, "angle_bits");
    if !is_given(PAIRS) {
        let of_shaft = pole_pairs.unwrap_or(7).to_string();
        reader.require_beside(errors, ["rotor", "angle"], ("motor", &[(PAIRS, &of_shaft)]));
        return None;
    }
    let is_read = pairs.is_some() == is_given(PAIRS)
        && offset.is_some() == is_given("angle_offset")
        && direction.is_some() == is_given("angle_direction")
        && bits.is_some() == is_given("angle_bits");
    let pairs = pairs.unwrap_or(1);
    if let Some(all) = pole_pairs
        && all % pairs != 0
    {
        let part = reader.part(PAIRS, String::new);
        errors.push(catalogue::angle_pole_pairs(&part.location, pairs, all));
        return None;
    }
    let bits = bits.unwrap_or(BITS);
    let step = f64::from(pairs) * 360.0 / f64::from(bits).exp2();
    if step > COARSEST {
        let part = reader.part("angle_bits", || bits.to_string());
        let enough = (f64::from(pairs) * 360.0 / COARSEST).log2().ceil();
        errors.push(catalogue::angle_bits(&part, [step, COARSEST, enough]));
        return None;
    }
    let sign = match direction.unwrap_or(AngleDirection::Forward) {
        AngleDirection::Forward => 1,
        AngleDirection::Backward => -1,
    };
    is_read.then(|| AngleSensor {
        turns: sign * pairs as i32,
        offset_deg: offset.map_or(0.0, |given| given.si),
        bits,
    })
}

/// Refuses the inverter's and the controller's fields of Hall sensors beside an angle sensor.
pub(super) fn refuse_halls(
    reader: &Reader,
    rotor: Option<RotorSource>,
    names: &[&str],
    errors: &mut Collector,
) {
    if rotor == Some(RotorSource::Angle) {
        reader.refuse_without(errors, HALLS, names);
    }
}
