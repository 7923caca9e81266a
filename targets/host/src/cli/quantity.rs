//! Quantities on the command line: a number with its unit, which only an option that names one may lack.

use hexagen_codegen::spec::units::{Dimension, Unit};
use hexagen_codegen::spec::{EmfShape, Harmonics};
use hexagen_lab::engine::PerSensor;

/// A number with a unit of one dimension; 0 needs none.
fn quantity(text: &str, dimension: Dimension) -> Result<f64, String> {
    match split(text.trim()) {
        Some((number, "")) if number != 0.0 => {
            let mut units: Vec<String> = Unit::spellings(dimension)
                .iter()
                .take(2)
                // Without a space the shell takes it for one argument.
                .map(|unit| format!("`{number}{}`", unit.replace(' ', "")))
                .collect();
            units.dedup();
            Err(format!(
                "`{text}` has no unit; write it like {}",
                units.join(" or ")
            ))
        }
        _ => quantity_or_number(text, dimension),
    }
}

/// A number with an optional unit of one dimension; without one it is in SI units (degrees for
/// angles).
fn quantity_or_number(text: &str, dimension: Dimension) -> Result<f64, String> {
    let text = text.trim();
    let (number, symbol) = split(text).ok_or_else(|| format!("`{text}` is not a number"))?;
    if symbol.is_empty() {
        return Ok(number);
    }
    let Some(unit) = Unit::from_symbol(symbol) else {
        let nearest = Unit::nearest(symbol, &[dimension])
            .map(|nearest| format!("; did you mean `{nearest}`?"))
            .unwrap_or_default();
        return Err(format!("unknown unit `{symbol}`{nearest}"));
    };
    if unit.dimension == dimension {
        Ok(unit.to_si(number))
    } else {
        Err(format!(
            "`{symbol}` is {}, but {} is expected",
            unit.dimension.name(),
            dimension.name()
        ))
    }
}

/// The longest beginning that is a finite number, and the rest.
fn split(text: &str) -> Option<(f64, &str)> {
    let mut ends = text
        .char_indices()
        .rev()
        .map(|(index, letter)| index + letter.len_utf8());
    ends.find_map(|end| {
        let number: f64 = text[..end].parse().ok()?;
        number
            .is_finite()
            .then(|| (number, text[end..].trim_start()))
    })
}

/// A value within a range of magnitudes, which the message names: values beyond it are mistakes,
/// and may take the simulation hours.
fn within(value: f64, least: f64, most: f64, unit: &str) -> Result<f64, String> {
    if (least..=most).contains(&value.abs()) {
        Ok(value)
    } else {
        let range = if least > 0.0 {
            format!("{least} to {most}")
        } else {
            format!("at most {most}")
        };
        // As it was written, but for a long row of zeros.
        let is_short = value == 0.0 || (1e-4..1e7).contains(&value.abs());
        let given = if is_short {
            value.to_string()
        } else {
            format!("{value:e}")
        };
        Err(format!("{given} is out of range: {range}{unit}"))
    }
}

/// Newton metres.
pub(super) fn torque(text: &str) -> Result<f64, String> {
    within(quantity(text, Dimension::Torque)?, 0.0, 1e5, " Nm")
}

/// Seconds.
pub(super) fn time(text: &str) -> Result<f64, String> {
    quantity(text, Dimension::Time)
}

/// Volts.
pub(super) fn voltage(text: &str) -> Result<f64, String> {
    within(quantity(text, Dimension::Voltage)?, 0.0, 1e4, " V")
}

/// Amperes, kept as text: it goes into the specification.
pub(super) fn current_text(text: &str) -> Result<String, String> {
    quantity(text, Dimension::Current).map(|amperes| format!("{amperes} A"))
}

/// Amperes of all channels or of each, `0.2A` or `0.2A,-0.1A`.
pub(super) fn adc_offset(text: &str) -> Result<PerSensor, String> {
    per_sensor(text, |part| quantity(part, Dimension::Current))
}

/// Factors of all channels or of each, `1.01` or `1.01,0.99`.
pub(super) fn adc_scale(text: &str) -> Result<PerSensor, String> {
    per_sensor(text, factor)
}

/// A value for all current sensors, or one for each.
fn per_sensor(
    text: &str,
    parse: impl Fn(&str) -> Result<f64, String>,
) -> Result<PerSensor, String> {
    let list = text.split(',').map(parse).collect::<Result<Vec<_>, _>>()?;
    match list.len() {
        1..=3 => Ok(PerSensor(list)),
        _ => Err("give one value for all sensed phases, or one of each".to_owned()),
    }
}

/// Counts of an ADC.
pub(super) fn counts(text: &str) -> Result<f64, String> {
    match split(text.trim()) {
        Some((number, "" | "count" | "counts")) => Ok(number),
        _ => Err(format!("`{text}` is not a number of counts")),
    }
}

/// kg m2.
pub(super) fn inertia(text: &str) -> Result<f64, String> {
    within(quantity(text, Dimension::Inertia)?, 1e-9, 100.0, " kg m2")
}

/// A true value over the stated one.
pub(super) fn factor(text: &str) -> Result<f64, String> {
    match split(text.trim()) {
        Some((number, "")) => within(number, 0.01, 100.0, " times the stated value"),
        _ => Err(format!("`{text}` is not a number")),
    }
}

/// Revolutions per minute, of an option that names them; other units of speed are converted.
pub(super) fn rpm(text: &str) -> Result<f64, String> {
    match split(text.trim()) {
        Some((number, "")) => Ok(number),
        _ => speed(text),
    }
}

/// Revolutions per minute of a speed with its unit.
pub(super) fn speed(text: &str) -> Result<f64, String> {
    match split(text.trim()) {
        Some((number, "rpm")) => Ok(number),
        _ => quantity(text, Dimension::Speed).map(|omega| omega * 30.0 / std::f64::consts::PI),
    }
}

/// Radians of an angle with its unit.
pub(super) fn radians(text: &str) -> Result<f64, String> {
    quantity(text, Dimension::Angle).map(f64::to_radians)
}

/// A shape of the EMF: a word, and behind a colon its data.
pub(super) fn emf_shape(text: &str) -> Result<EmfShape, String> {
    let (word, data) = text.split_once(':').unwrap_or((text, ""));
    match (word.trim(), data.trim()) {
        ("sinusoidal", "") => Ok(EmfShape::Sinusoidal),
        ("trapezoidal", flat_top) => {
            let flat_top = if flat_top.is_empty() {
                120.0
            } else {
                quantity_or_number(flat_top, Dimension::Angle)?
            };
            let flat_top_deg = within(flat_top, 1.0, 179.0, " degrees of flat top")?;
            Ok(EmfShape::Trapezoidal { flat_top_deg })
        }
        ("harmonics", list) if !list.is_empty() => {
            let harmonics = list.split(',').map(harmonic);
            let harmonics = harmonics.collect::<Result<Vec<_>, _>>()?;
            let orders: std::collections::BTreeSet<u32> =
                harmonics.iter().map(|harmonic| harmonic.0).collect();
            if orders.len() < harmonics.len() {
                return Err(format!("`{list}` gives an order twice"));
            }
            Ok(EmfShape::Harmonics(Harmonics::of(harmonics)))
        }
        _ => Err(
            "give `sinusoidal`, `trapezoidal:100` or `harmonics:5=4,7=-2@20`: a flat top in degrees, or orders, percents of the fundamental and phases in degrees"
                .to_owned(),
        ),
    }
}

/// `5=4` or `5=4@20`: order, share of the fundamental and phase of a harmonic.
fn harmonic(text: &str) -> Result<(u32, f64, f64), String> {
    let wrong =
        || format!("`{text}` is not an odd order from 3 to 23 and a percentage, as in `5=4`");
    let (order, share) = text.split_once('=').ok_or_else(wrong)?;
    let (share, phase) = share.split_once('@').unwrap_or((share, "0"));
    let phase = quantity_or_number(phase, Dimension::Angle)?.to_radians();
    let order: u32 = order.trim().parse().map_err(|_| wrong())?;
    let percent = split(share.trim())
        .filter(|(percent, unit)| percent.abs() <= 100.0 && matches!(*unit, "" | "%"));
    match percent {
        Some((percent, _)) if Harmonics::has_order(order) => Ok((order, percent / 100.0, phase)),
        _ => Err(wrong()),
    }
}

/// Degrees of one sensor or of three, `5deg` or `5deg,-3deg,0`.
pub(super) fn hall_error(text: &str) -> Result<[f64; 3], String> {
    let list = text
        .split(',')
        .map(|part| quantity(part, Dimension::Angle))
        .collect::<Result<Vec<_>, _>>()?;
    match list[..] {
        [all] => Ok([all; 3]),
        [a, b, c] => Ok([a, b, c]),
        _ => Err("give one angle for all sensors, or three for Ha, Hb and Hc".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_with_and_without_units() {
        assert_eq!(time("1us"), Ok(1e-6));
        assert_eq!(time("0"), Ok(0.0));
        assert_eq!(torque("-0.5 Nm"), Ok(-0.5));
        assert_eq!(voltage("48V"), Ok(48.0));
        assert_eq!(current_text("40A"), Ok("40 A".to_owned()));
        assert_eq!(rpm("-1500"), Ok(-1500.0));
        assert_eq!(rpm("1500rpm"), Ok(1500.0));
        assert_eq!(speed("-1500rpm"), Ok(-1500.0));
        assert_eq!(inertia("1.2e-5 kg m2"), Ok(1.2e-5));
        assert_eq!(
            inertia("120 g cm2").map(|value| (value * 1e9).round()),
            Ok(12_000.0)
        );
        assert_eq!(radians("180deg"), Ok(std::f64::consts::PI));
        assert_eq!(hall_error("5deg"), Ok([5.0; 3]));
        assert_eq!(hall_error("5deg,-3deg,0"), Ok([5.0, -3.0, 0.0]));
        assert_eq!(adc_offset("200mA"), Ok(PerSensor(vec![0.2])));
        assert_eq!(adc_offset("0.2A,-1A"), Ok(PerSensor(vec![0.2, -1.0])));
        assert_eq!(adc_scale("1.1,0.9,1.2"), Ok(PerSensor(vec![1.1, 0.9, 1.2])));
        assert_eq!(counts("1.5 counts"), Ok(1.5));
    }

    #[test]
    fn shapes_of_the_emf() {
        assert_eq!(emf_shape("sinusoidal"), Ok(EmfShape::Sinusoidal));
        let trapezoid = |flat_top_deg| Ok(EmfShape::Trapezoidal { flat_top_deg });
        assert_eq!(emf_shape("trapezoidal"), trapezoid(120.0));
        assert_eq!(emf_shape("trapezoidal:95deg"), trapezoid(95.0));
        let series = Harmonics::of([(5, 0.04, 0.0), (7, -0.02, 0.0)]);
        let stated = Ok(EmfShape::Harmonics(series));
        assert_eq!(emf_shape("harmonics:5=4,7=-2%"), stated);
        for wrong in [
            "sinusoidal:3",
            "trapezoidal:200",
            "harmonics",
            "harmonics:5",
            "harmonics:4=3",
            "harmonics:25=1",
            "harmonics:5=101",
            "harmonics:5=4,5=4",
            "square",
        ] {
            assert!(emf_shape(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn mistakes_are_told() {
        assert_eq!(
            time("1 V"),
            Err("`V` is a voltage, but a time is expected".to_owned())
        );
        assert_eq!(
            voltage("48 v"),
            Err("unknown unit `v`; did you mean `V`?".to_owned())
        );
        assert_eq!(
            time("500"),
            Err("`500` has no unit; write it like `500s` or `500ms`".to_owned())
        );
        assert_eq!(factor("1 A"), Err("`1 A` is not a number".to_owned()));
        assert_eq!(
            factor("1e300"),
            Err("1e300 is out of range: 0.01 to 100 times the stated value".to_owned())
        );
        assert_eq!(
            torque("-1e300 Nm"),
            Err("-1e300 is out of range: at most 100000 Nm".to_owned())
        );
        let told = emf_shape("trapezoidal:200").expect_err("is too wide");
        assert!(told.starts_with("200 is out of range: 1 to 179"), "{told}");
        let told = speed("1500").expect_err("has no unit");
        assert!(
            told.ends_with("write it like `1500rpm` or `1500rad/s`"),
            "{told}"
        );
        assert!(hall_error("1deg,2deg").is_err() && adc_offset("1A,2A,3A,4A").is_err());
        assert!(adc_scale("1,200").is_err() && counts("1 A").is_err());
        for (bare, remedy) in [
            (torque("3.3"), "`3.3` has no unit; write it like `3.3Nm`"),
            (
                inertia("0.001"),
                "`0.001` has no unit; write it like `0.001kgm2`",
            ),
            (radians("90"), "`90` has no unit; write it like `90deg`"),
            (speed("1500"), "`1500` has no unit; write it like `1500rpm`"),
        ] {
            let told = bare.expect_err("is bare");
            assert!(told.starts_with(remedy), "{told}");
        }
        assert!(torque("inf").is_err() && torque("nan").is_err() && torque("").is_err());
    }
}
