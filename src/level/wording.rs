//! Numbers and names as people like to read them.

use super::{Level, SectorId};

/// `15,123,456`
pub fn grouped(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// `1 cell`, `1,200 cells`
pub fn count(n: usize, what: &str) -> String {
    count_of(n, what, &format!("{what}s"))
}

/// `1 vertex`, `2 vertices`
pub fn count_of(n: usize, one: &str, many: &str) -> String {
    format!("{} {}", grouped(n as u64), if n == 1 { one } else { many })
}

/// Three digits and a unit: `3.21 s`, `45.6 ms`, `789 µs`; `0 s` for none at all.
pub fn duration(seconds: f64) -> String {
    let (value, unit) = match seconds {
        0.0 => return "0 s".to_string(),
        s if s >= 0.9995 => (s, "s"),
        s if s >= 0.999_5e-3 => (s * 1e3, "ms"),
        s => (s * 1e6, "µs"),
    };
    let digits = match value {
        v if v >= 99.95 => 0,
        v if v >= 9.995 => 1,
        _ => 2,
    };
    format!("{value:.digits$} {unit}")
}

/// The level's unit after a number: `map units`, but `m`.
pub fn unit(level: &Level) -> String {
    let unit = &level.unit;
    if unit.len() > 2 && !unit.ends_with('s') {
        format!("{unit}s")
    } else {
        unit.clone()
    }
}

/// Where something in a room or sector is: ` in 'Hall'`, ` in sector 12`, or nothing.
pub fn in_sector(level: &Level, sector: Option<SectorId>) -> String {
    let Some(id) = sector else {
        return String::new();
    };
    match level
        .sectors
        .get(id.0 as usize)
        .and_then(|s| s.name.as_deref())
    {
        Some(name) => format!(" in '{name}'"),
        None => format!(" in sector {}", id.0),
    }
}

/// A plan coordinate with digits that suit the level: whole map units, or hundredths.
pub fn coordinate(level: &Level, x: f64) -> String {
    if level.grid.step.length() >= 1.0 {
        format!("{x:.0}")
    } else {
        format!("{x:.2}")
    }
}

/// A length with four digits, more for large ones and powers of ten for tiny ones: `0.9`, `1436`,
/// `2.5e-7`.
pub fn length(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    if x.abs() < 1e-3 {
        return format!("{x:.1e}");
    }
    let digits = (3 - x.abs().log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{x:.digits$}");
    match text.split_once('.') {
        Some(_) => text.trim_end_matches('0').trim_end_matches('.').to_string(),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(1000), "1,000");
        assert_eq!(grouped(15_123_456), "15,123,456");
        assert_eq!(count(1, "cell"), "1 cell");
        assert_eq!(count_of(2000, "vertex", "vertices"), "2,000 vertices");
    }

    #[test]
    fn lengths() {
        assert_eq!(length(0.9), "0.9");
        assert_eq!(length(1436.4), "1436");
        assert_eq!(length(14.2049), "14.2");
        assert_eq!(length(0.0123456), "0.01235");
        assert_eq!(length(2.5e-7), "2.5e-7");
        assert_eq!(length(0.0), "0");
    }

    #[test]
    fn times() {
        assert_eq!(duration(0.0), "0 s");
        assert_eq!(duration(0.0123), "12.3 ms");
        assert_eq!(duration(0.9999), "1.00 s");
        assert_eq!(duration(0.09999), "100 ms");
        assert_eq!(duration(125.0), "125 s");
    }
}
