//! The firmware's list of its drives.

/// A drive of the firmware.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listed {
    /// Index in the firmware's list.
    pub place: u16,
    /// Symbol of the step function.
    pub symbol: String,
    /// Name of the library's motor.
    pub motor: String,
    /// Controller and options in the command line's notation.
    pub variant: String,
    /// Names of the state words.
    pub words: Vec<String>,
    /// Bytes of the drive's type.
    pub size: usize,
    /// Normalised specification.
    pub spec: String,
}

/// Parses the firmware's list; `None` if it is invalid.
pub fn parse(text: &str) -> Option<Vec<Listed>> {
    let mut lines = text.lines();
    let mut drives = Vec::new();
    while let Some(first) = lines.next() {
        let symbol = first.strip_prefix("drive ")?.to_owned();
        let motor = motor(lines.next()?.strip_prefix("motor ")?)?.to_owned();
        let kind = lines.next()?.strip_prefix("kind ")?;
        let mut written = lines.next()?.strip_prefix("options")?.to_owned();
        // The compiler breaks a long list of tokens into lines.
        let words = loop {
            let line = lines.next()?;
            match line.strip_prefix("words") {
                Some(words) => break words,
                None => written.push_str(line),
            }
        };
        let size = lines.next()?.strip_prefix("size ")?.parse().ok()?;
        let mut spec = String::new();
        loop {
            match lines.next()? {
                "end" => break,
                line => {
                    spec.push_str(line);
                    spec.push('\n');
                }
            }
        }
        drives.push(Listed {
            place: u16::try_from(drives.len()).ok()?,
            symbol,
            motor,
            variant: variant(kind, &written),
            words: words.split_whitespace().map(str::to_owned).collect(),
            size,
            spec,
        });
    }
    Some(drives)
}

/// The library's name of a motor's file; `None` for any other file.
pub fn motor(file: &str) -> Option<&str> {
    file.rsplit('/').next()?.strip_suffix(".toml")
}

/// Kind and options of a macro call (`pdcc`, `saturation : keep_angle, emf_filter : 1`) in the
/// command line's notation.
pub fn variant(kind: &str, options: &str) -> String {
    let kind = kind.replace('_', "-");
    let dense: String = options.chars().filter(|c| !c.is_whitespace()).collect();
    match dense.replace(':', "=").trim_end_matches(',') {
        "" => kind,
        options => format!("{kind}:{options}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_firmwares_list_is_parsed() {
        let text = "drive step_x\nmotor ../motors/x-1.toml\nkind fcs_mpc\noptions emf : model,\nadvance : 1.5,\n\
                    words mode fault\nsize 000068\nname = \"X\"\n[motor]\nend\n";
        let drives = parse(text).expect("a list");
        assert_eq!(drives.len(), 1);
        assert_eq!(drives[0].motor, "x-1");
        assert_eq!(drives[0].variant, "fcs-mpc:emf=model,advance=1.5");
        assert_eq!(drives[0].words, ["mode", "fault"]);
        assert_eq!(drives[0].size, 68);
        assert_eq!(drives[0].spec, "name = \"X\"\n[motor]\n");
        assert_eq!(parse("drive step_x\nmotor"), None);
    }
}
