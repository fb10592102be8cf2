//! Numbers and names as people like to read them.

use crate::cells::{CellGraph, CellId};
use crate::level::Level;

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

/// An area in square units: `96.3 m²`, `1,234,567 square map units`.
pub fn area(level: &Level, square_units: f64) -> String {
    let number = if square_units >= 999.5 {
        grouped(square_units.round() as u64)
    } else {
        let digits = match square_units {
            a if a >= 99.95 => 0,
            a if a >= 9.995 => 1,
            _ => 2,
        };
        format!("{square_units:.digits$}")
    };
    if level.unit.len() > 2 {
        format!("{number} square {}", unit(level))
    } else {
        format!("{number} {}²", level.unit)
    }
}

/// The room or sector in which a cell lies: ` in 'Hall'`, ` in sector 12`, or nothing.
pub fn in_sector(level: &Level, graph: &CellGraph, cell: CellId) -> String {
    let Some(id) = graph.cell(cell).sector else {
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
    fn times() {
        assert_eq!(duration(0.0), "0 s");
        assert_eq!(duration(0.0123), "12.3 ms");
        assert_eq!(duration(0.9999), "1.00 s");
        assert_eq!(duration(0.09999), "100 ms");
        assert_eq!(duration(125.0), "125 s");
    }
}
