//! How tables, strings, numbers and lists are set out in a written file.

use std::fmt::Write;

use glam::{DVec2, DVec3};

/// Longer lists go over several lines.
const WIDTH: usize = 96;

/// A text of TOML in the making.
#[derive(Default)]
pub(super) struct Text {
    pub(super) text: String,
}

impl Text {
    /// A comment, on lines of their own.
    pub(super) fn comment(&mut self, comment: &str) {
        let mut line = String::from("#");
        for word in comment.split_whitespace() {
            if line.len() + word.len() >= WIDTH {
                self.line(&line);
                line = String::from("#");
            }
            line.push(' ');
            line.push_str(word);
        }
        self.line(&line);
    }

    pub(super) fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// The head of a table: `[[room]]`.
    pub(super) fn head(&mut self, head: &str) {
        self.text.push('\n');
        self.line(head);
    }

    /// A key with a value that is written already.
    pub(super) fn key(&mut self, key: &str, value: &str) {
        // Writing into a string cannot fail.
        let _ = writeln!(self.text, "{key} = {value}");
    }

    pub(super) fn string(&mut self, key: &str, value: Option<&str>) {
        if let Some(value) = value {
            self.key(key, &quoted(value));
        }
    }

    pub(super) fn number(&mut self, key: &str, value: Option<f64>) {
        if let Some(value) = value {
            self.key(key, &number(value));
        }
    }

    /// A number, unless it is what is meant without it.
    pub(super) fn unusual(&mut self, key: &str, value: f64, usual: f64) {
        self.number(key, Some(value).filter(|v| *v != usual));
    }

    /// A list of values that are written already; on one line where it fits.
    pub(super) fn list(&mut self, key: &str, items: &[String]) {
        let length: usize = items.iter().map(|item| item.len() + 2).sum();
        if key.len() + length + 5 <= WIDTH {
            return self.key(key, &format!("[{}]", items.join(", ")));
        }
        self.line(&format!("{key} = ["));
        let mut line = String::new();
        for item in items {
            if !line.is_empty() && line.len() + item.len() + 6 > WIDTH {
                self.line(&format!("   {line}"));
                line.clear();
            }
            line.push_str(&format!(" {item},"));
        }
        self.line(&format!("   {line}"));
        self.line("]");
    }
}

/// A basic string of TOML.
pub(super) fn quoted(value: &str) -> String {
    let mut text = String::from("\"");
    for c in value.chars() {
        match c {
            '"' => text.push_str("\\\""),
            '\\' => text.push_str("\\\\"),
            '\n' => text.push_str("\\n"),
            '\t' => text.push_str("\\t"),
            c if c.is_control() => text.push_str(&format!("\\u{:04X}", u32::from(c))),
            c => text.push(c),
        }
    }
    text.push('"');
    text
}

/// The shortest decimal that reads back as this very number.
pub(super) fn number(value: f64) -> String {
    // Digits beyond those of an integer of TOML are a number's with an exponent.
    if value != 0.0 && !(1e-7..1e17).contains(&value.abs()) {
        format!("{value:e}")
    } else {
        format!("{}", value + 0.0)
    }
}

pub(super) fn numbers(values: &[f64]) -> String {
    let values: Vec<String> = values.iter().map(|v| number(*v)).collect();
    format!("[{}]", values.join(", "))
}

pub(super) fn point(p: DVec2) -> String {
    numbers(&p.to_array())
}

pub(super) fn point3(p: DVec3) -> String {
    numbers(&p.to_array())
}

/// `{ floor = "oak" }` of the names that are there; nothing where none is.
pub(super) fn names(names: &[(&str, Option<&str>)]) -> Option<String> {
    let given: Vec<String> = (names.iter())
        .filter_map(|(key, name)| Some(format!("{key} = {}", quoted((*name)?))))
        .collect();
    (!given.is_empty()).then(|| format!("{{ {} }}", given.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back() {
        for x in [
            0.1,
            -0.0,
            1e300,
            6.0,
            1e16,
            4.000_000_000_5e11,
            5e-324,
            -1e-9,
            123_456.062_5,
        ] {
            let text = format!("x = {}", number(x));
            let table: toml::Table = text.parse().unwrap();
            let back = (table["x"].as_float()).or(table["x"].as_integer().map(|i| i as f64));
            assert_eq!(back, Some(x), "{text}");
        }
    }

    #[test]
    fn strings_come_back() {
        for s in [
            "Hall",
            "a \"b\" \\ c",
            "line\nline\r\ttab",
            "\u{7f}ä漢\u{1}",
            "",
        ] {
            let table: toml::Table = format!("s = {}", quoted(s)).parse().unwrap();
            assert_eq!(table["s"].as_str(), Some(s));
        }
    }

    #[test]
    fn long_lists_are_folded() {
        let mut text = Text::default();
        let items: Vec<String> = (0..40).map(|i| point(DVec2::splat(f64::from(i)))).collect();
        text.list("points", &items);
        assert!(text.text.lines().all(|l| l.len() <= WIDTH), "{}", text.text);
        let table: toml::Table = text.text.parse().unwrap();
        assert_eq!(table["points"].as_array().unwrap().len(), 40);
    }
}
