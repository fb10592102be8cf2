//! Values that some programs write as text: numbers and truth.
//!
//! In: a value of JSON. Out: the number or truth that it is, or that its text says.

use serde::de::{Error, Unexpected};
use serde::{Deserialize, Deserializer};

/// What may stand where a number or truth belongs.
#[derive(Deserialize)]
#[serde(untagged)]
enum Value {
    Number(f64),
    Flag(bool),
    Text(String),
}

impl Value {
    fn number<E: Error>(self) -> Result<f64, E> {
        let text = match self {
            Value::Number(x) => return Ok(x),
            Value::Flag(flag) => {
                return Err(E::invalid_value(
                    Unexpected::Other(&flag.to_string()),
                    &"a number",
                ));
            }
            Value::Text(text) => text,
        };
        match text.trim().parse::<f64>() {
            Ok(x) if x.is_finite() => Ok(x),
            _ => Err(E::invalid_value(Unexpected::Str(&text), &"a number")),
        }
    }

    fn flag<E: Error>(self) -> Result<bool, E> {
        match self {
            Value::Flag(flag) => Ok(flag),
            Value::Number(x) => Ok(x != 0.0),
            Value::Text(text) => match text.trim().to_lowercase().as_str() {
                "true" | "1" | "yes" => Ok(true),
                "false" | "0" | "no" | "" => Ok(false),
                _ => Err(E::invalid_value(Unexpected::Str(&text), &"true or false")),
            },
        }
    }
}

/// A number.
pub(super) fn number<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Value::deserialize(from)
        .map_err(|_| D::Error::custom("a number belongs here"))?
        .number()
}

/// A number or nothing.
pub(super) fn maybe_number<'de, D: Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    let value = Option::<Value>::deserialize(from)?;
    value.map(Value::number).transpose()
}

/// Truth or nothing.
pub(super) fn maybe_flag<'de, D: Deserializer<'de>>(from: D) -> Result<Option<bool>, D::Error> {
    let value = Option::<Value>::deserialize(from)?;
    value.map(Value::flag).transpose()
}
