//! DXF as it lies in the file: pairs of a group code and a value.
//!
//! In: the bytes of a file, as text or binary. Out: [`Pair`]s with their places. A text file has the
//! code on one line and the value on the next. Values stay bytes until somebody asks for them.

use std::borrow::Cow;
use std::fmt;

use super::DxfError;

/// How a binary file begins.
const BINARY: &[u8] = b"AutoCAD Binary DXF\r\n\x1a\0";

/// Where a pair stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    /// Line of the code, from 1.
    Line(u32),
    /// Bytes before it.
    Byte(u32),
}

impl fmt::Display for At {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            At::Line(n) => write!(f, "line {n}"),
            At::Byte(n) => write!(f, "byte {n}"),
        }
    }
}

/// A value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value<'a> {
    /// As it stands in a text file, without spaces around it.
    Text(&'a [u8]),
    /// A number of a binary file.
    Real(f64),
    /// A whole number of a binary file.
    Whole(i64),
}

/// A group code with its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair<'a> {
    /// The group code: what the value is.
    pub code: i32,
    /// The value.
    pub value: Value<'a>,
    /// Where it stands.
    pub at: At,
}

impl<'a> Pair<'a> {
    /// Whether it is this word.
    pub fn is(&self, code: i32, word: &str) -> bool {
        self.code == code
            && matches!(self.value, Value::Text(t) if t.eq_ignore_ascii_case(word.as_bytes()))
    }

    /// The value as a text; bytes that are no UTF-8 are taken for Windows' Western European.
    pub fn text(&self) -> Cow<'a, str> {
        match self.value {
            Value::Text(bytes) => match std::str::from_utf8(bytes) {
                Ok(text) => Cow::Borrowed(text),
                Err(_) => bytes.iter().map(|&b| char::from(b)).collect(),
            },
            Value::Real(x) => x.to_string().into(),
            Value::Whole(n) => n.to_string().into(),
        }
    }

    /// The value as a number.
    pub fn real(&self) -> Result<f64, DxfError> {
        let number = match self.value {
            Value::Real(x) => Some(x),
            Value::Whole(n) => Some(n as f64),
            Value::Text(t) => std::str::from_utf8(t).ok().and_then(|t| t.parse().ok()),
        };
        number
            .filter(|x: &f64| x.is_finite())
            .ok_or_else(|| self.wrong("a number"))
    }

    /// The value as a whole number.
    pub fn whole(&self) -> Result<i64, DxfError> {
        let number = match self.value {
            Value::Whole(n) => Some(n),
            Value::Real(x) => Some(x as i64),
            // Some programs write 1.0 for 1.
            Value::Text(t) => std::str::from_utf8(t).ok().and_then(|t| {
                let real = || t.parse::<f64>().ok().filter(|x| x.is_finite());
                t.parse().ok().or_else(|| real().map(|x| x as i64))
            }),
        };
        number.ok_or_else(|| self.wrong("a whole number"))
    }

    fn wrong(&self, needed: &'static str) -> DxfError {
        DxfError::Value {
            at: self.at,
            code: self.code,
            needed,
            found: self.text().chars().take(40).collect(),
        }
    }
}

/// The pairs of a file, one after the other.
pub struct Pairs<'a> {
    bytes: &'a [u8],
    pos: usize,
    line: u32,
    binary: bool,
}

impl<'a> Pairs<'a> {
    /// Begins to read; refuses what cannot be DXF.
    pub fn new(bytes: &'a [u8]) -> Result<Pairs<'a>, DxfError> {
        let binary = bytes.starts_with(BINARY);
        if !binary {
            let wide = matches!(bytes.get(..2), Some([0xff, 0xfe] | [0xfe, 0xff]));
            if wide || bytes.get(1) == Some(&0) {
                return Err(DxfError::Wide);
            }
            if bytes.starts_with(b"AC10") {
                return Err(DxfError::Dwg);
            }
        }
        let start = match binary {
            true => BINARY.len(),
            false if bytes.starts_with(b"\xef\xbb\xbf") => 3,
            false => 0,
        };
        Ok(Pairs {
            bytes,
            pos: start,
            line: 1,
            binary,
        })
    }

    /// The next pair; none at the end of the file.
    pub fn next_pair(&mut self) -> Result<Option<Pair<'a>>, DxfError> {
        if self.binary {
            self.next_binary()
        } else {
            self.next_text()
        }
    }

    /// Where the next pair stands.
    pub fn at(&self) -> At {
        if self.binary {
            At::Byte(self.pos as u32)
        } else {
            At::Line(self.line)
        }
    }

    fn next_line(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.pos..).filter(|r| !r.is_empty())?;
        let end = rest.iter().position(|&b| b == b'\n').unwrap_or(rest.len());
        self.pos += end + 1;
        self.line += 1;
        Some(rest[..end].trim_ascii())
    }

    fn next_text(&mut self) -> Result<Option<Pair<'a>>, DxfError> {
        let at = self.at();
        let Some(code) = self.next_line() else {
            return Ok(None);
        };
        let number = std::str::from_utf8(code).ok().and_then(|t| t.parse().ok());
        let Some(code) = number else {
            // Empty lines after the end are no pair.
            let rest = self.bytes.get(self.pos..).unwrap_or_default();
            if code.is_empty() && rest.iter().all(u8::is_ascii_whitespace) {
                return Ok(None);
            }
            let found = String::from_utf8_lossy(code).chars().take(40).collect();
            return Err(DxfError::Code { at, found });
        };
        let Some(value) = self.next_line() else {
            return Err(DxfError::CutOff { at: self.at() });
        };
        Ok(Some(Pair {
            code,
            value: Value::Text(value),
            at,
        }))
    }

    fn next_binary(&mut self) -> Result<Option<Pair<'a>>, DxfError> {
        let at = self.at();
        if self.pos >= self.bytes.len() {
            return Ok(None);
        }
        let code = i32::from(i16::from_le_bytes(self.take()?));
        let value = match code {
            10..=59 | 110..=149 | 210..=239 | 460..=469 | 1010..=1059 => {
                Value::Real(f64::from_le_bytes(self.take()?))
            }
            60..=79 | 170..=179 | 270..=289 | 370..=389 | 400..=409 | 1060..=1070 => {
                Value::Whole(i64::from(i16::from_le_bytes(self.take()?)))
            }
            90..=99 | 420..=429 | 440..=459 | 1071 => {
                Value::Whole(i64::from(i32::from_le_bytes(self.take()?)))
            }
            160..=169 => Value::Whole(i64::from_le_bytes(self.take()?)),
            290..=299 => Value::Whole(i64::from(self.take::<1>()?[0])),
            310..=319 | 1004 => {
                let n = usize::from(self.take::<1>()?[0]);
                let end = self.pos + n;
                let bytes = self.bytes.get(self.pos..end);
                self.pos = end;
                Value::Text(bytes.ok_or(DxfError::CutOff { at })?)
            }
            0..=9
            | 100..=109
            | 300..=309
            | 320..=369
            | 390..=399
            | 410..=419
            | 430..=439
            | 470..=481
            | 999..=1009 => {
                let rest = self.bytes.get(self.pos..).unwrap_or_default();
                let end = rest.iter().position(|&b| b == 0);
                let end = end.ok_or(DxfError::CutOff { at })?;
                self.pos += end + 1;
                Value::Text(rest[..end].trim_ascii())
            }
            _ => {
                return Err(DxfError::Code {
                    at,
                    found: code.to_string(),
                });
            }
        };
        Ok(Some(Pair { code, value, at }))
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], DxfError> {
        let end = self.pos + N;
        let bytes = self.bytes.get(self.pos..end);
        let bytes = bytes.and_then(|b| <[u8; N]>::try_from(b).ok());
        let bytes = bytes.ok_or(DxfError::CutOff { at: self.at() })?;
        self.pos = end;
        Ok(bytes)
    }
}
