//! The grammar of UDMF 1.1: from the text of a map to its blocks of fields.
//!
//! In: the bytes of a `TEXTMAP` lump. Out: [`Document`], every block and field with its place, names
//! in lower case as they are the same in any case. Whether a field has the right type is for
//! [`super::udmf`] to say, since fields that it does not know may hold anything.

use thiserror::Error;

/// A mistake in a text map, with its place.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("line {}, column {}: {problem}", at.line, at.column)]
pub struct TextError {
    /// Where.
    pub at: Spot,
    /// What is wrong.
    pub problem: TextProblem,
}

/// A place in a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spot {
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

/// What is wrong with a text map.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TextProblem {
    /// Something else should stand here.
    #[error("expected {wanted}, found {found}")]
    Expected {
        /// What should stand here.
        wanted: &'static str,
        /// What does, in quotes, or "the end of the text".
        found: String,
    },
    /// A comment does not end.
    #[error("this comment does not end; close it with '*/'")]
    OpenComment,
    /// A string does not end.
    #[error("this string does not end; close it with '\"'")]
    OpenString,
    /// A number that is none, or does not fit.
    #[error("'{text}' is no number that can be read here")]
    Number {
        /// The text.
        text: String,
    },
    /// A field has a value of a wrong type.
    #[error("field '{key}' wants {wanted}")]
    Type {
        /// The field.
        key: String,
        /// What it wants.
        wanted: &'static str,
    },
    /// A block lacks a field that has no default.
    #[error("this {block} has no field '{key}', which it must have")]
    MissingField {
        /// Kind of block.
        block: String,
        /// The field.
        key: &'static str,
    },
    /// The map does not say how to read its numbers.
    #[error("the map names no namespace; begin it with: namespace = \"doom\"; (or another)")]
    NoNamespace,
}

/// A text map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// Assignments outside of blocks.
    pub fields: Vec<Field>,
    /// Blocks, in order.
    pub blocks: Vec<Block>,
}

/// `name { … }`
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Its name in lower case.
    pub name: String,
    /// Where its name stands.
    pub at: Spot,
    /// What it assigns.
    pub fields: Vec<Field>,
}

/// `key = value;`
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// Its name in lower case.
    pub key: String,
    /// Its value.
    pub value: Value,
    /// Where the value stands.
    pub at: Spot,
}

/// The value of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Decimal, octal (leading 0) or hexadecimal (leading 0x).
    Integer(i64),
    /// With a point; finite.
    Float(f64),
    /// In quotes, escapes resolved.
    Text(String),
    /// `true` or `false`.
    Bool(bool),
    /// Any other bare word: no field of the specification takes one.
    Word(String),
}

/// Reads the text of a map.
pub fn parse(text: &[u8]) -> Result<Document, TextError> {
    let mut reader = Reader {
        text,
        next: 0,
        spot: Spot { line: 1, column: 1 },
    };
    let mut document = Document::default();
    loop {
        reader.skip_space()?;
        if reader.peek().is_none() {
            return Ok(document);
        }
        let at = reader.spot;
        let name = reader.identifier("the name of a block or field")?;
        reader.skip_space()?;
        match reader.peek() {
            Some(b'=') => document.fields.push(reader.assignment(name)?),
            Some(b'{') => {
                reader.step();
                let fields = reader.fields()?;
                document.blocks.push(Block { name, at, fields });
            }
            _ => return Err(reader.expected("'=' or '{'")),
        }
    }
}

struct Reader<'a> {
    text: &'a [u8],
    next: usize,
    spot: Spot,
}

impl Reader<'_> {
    fn peek(&self) -> Option<u8> {
        self.text.get(self.next).copied()
    }

    fn step(&mut self) {
        let Some(byte) = self.peek() else { return };
        self.next += 1;
        if byte == b'\n' {
            self.spot.line += 1;
            self.spot.column = 1;
        } else if self.text.get(self.next).is_none_or(|b| b & 0xC0 != 0x80) {
            // A column is a character: the further bytes of one in UTF-8 do not count.
            self.spot.column += 1;
        }
    }

    fn error(&self, problem: TextProblem) -> TextError {
        TextError {
            at: self.spot,
            problem,
        }
    }

    /// The error that something else was expected at the present place.
    fn expected(&self, wanted: &'static str) -> TextError {
        let rest = &self.text[self.next..];
        let found = match rest.first() {
            None => "the end of the text".to_string(),
            Some(first) => {
                let is_word = |b: &u8| b.is_ascii_alphanumeric() || *b == b'_' || *b >= 0x80;
                let n = match rest.iter().take(20).take_while(|b| is_word(b)).count() {
                    0 => 1,
                    n => n,
                };
                match first {
                    b'\'' => "\"'\"".to_string(),
                    _ => format!("'{}'", String::from_utf8_lossy(&rest[..n])),
                }
            }
        };
        self.error(TextProblem::Expected { wanted, found })
    }

    fn starts_with(&self, what: &[u8]) -> bool {
        self.text[self.next..].starts_with(what)
    }

    /// Skips white space and comments.
    fn skip_space(&mut self) -> Result<(), TextError> {
        loop {
            if self.starts_with(b"//") {
                while self.peek().is_some_and(|b| b != b'\n') {
                    self.step();
                }
            } else if self.starts_with(b"/*") {
                let open = self.error(TextProblem::OpenComment);
                self.step();
                self.step();
                while !self.starts_with(b"*/") {
                    if self.peek().is_none() {
                        return Err(open);
                    }
                    self.step();
                }
                self.step();
                self.step();
            } else if self.peek().is_some_and(is_space) {
                self.step();
            } else {
                return Ok(());
            }
        }
    }

    fn identifier(&mut self, wanted: &'static str) -> Result<String, TextError> {
        let start = self.next;
        if !self
            .peek()
            .is_some_and(|b| b.is_ascii_alphabetic() || b == b'_')
        {
            return Err(self.expected(wanted));
        }
        while self
            .peek()
            .is_some_and(|b| b.is_ascii_alphanumeric() || b == b'_')
        {
            self.step();
        }
        let name = String::from_utf8_lossy(&self.text[start..self.next]);
        Ok(name.to_ascii_lowercase())
    }

    /// The fields of a block, up to and with its closing brace.
    fn fields(&mut self) -> Result<Vec<Field>, TextError> {
        let mut fields = Vec::new();
        loop {
            self.skip_space()?;
            if self.peek() == Some(b'}') {
                self.step();
                return Ok(fields);
            }
            let key = self.identifier("the name of a field, or '}'")?;
            self.skip_space()?;
            if self.peek() != Some(b'=') {
                return Err(self.expected("'='"));
            }
            fields.push(self.assignment(key)?);
        }
    }

    /// What follows a key: `= value;`.
    fn assignment(&mut self, key: String) -> Result<Field, TextError> {
        self.step();
        self.skip_space()?;
        let at = self.spot;
        let value = self.value()?;
        self.skip_space()?;
        if self.peek() != Some(b';') {
            return Err(self.expected("';'"));
        }
        self.step();
        Ok(Field { key, value, at })
    }

    fn value(&mut self) -> Result<Value, TextError> {
        if self.peek() == Some(b'"') {
            return self.string().map(Value::Text);
        }
        let start = self.next;
        let before = self.spot;
        while self.peek().is_some_and(is_word)
            && !self.starts_with(b"//")
            && !self.starts_with(b"/*")
        {
            self.step();
        }
        if start == self.next {
            return Err(self.expected("a value"));
        }
        let word = String::from_utf8_lossy(&self.text[start..self.next]).into_owned();
        word_value(&word).ok_or(TextError {
            at: before,
            problem: TextProblem::Number { text: word },
        })
    }

    /// A string in quotes; a backslash keeps the character after it.
    fn string(&mut self) -> Result<String, TextError> {
        let open = self.error(TextProblem::OpenString);
        self.step();
        let mut bytes = Vec::new();
        loop {
            match self.peek() {
                None => return Err(open),
                Some(b'"') => {
                    self.step();
                    return Ok(String::from_utf8_lossy(&bytes).into_owned());
                }
                Some(b'\\') => {
                    self.step();
                    bytes.push(self.peek().ok_or_else(|| open.clone())?);
                    self.step();
                }
                Some(byte) => {
                    bytes.push(byte);
                    self.step();
                }
            }
        }
    }
}

fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0B | 0x0C)
}

fn is_word(byte: u8) -> bool {
    !is_space(byte) && !b"{}();\"'=".contains(&byte)
}

/// The value that a bare word stands for; `None` for what begins like a number but is none.
fn word_value(word: &str) -> Option<Value> {
    if word.eq_ignore_ascii_case("true") {
        return Some(Value::Bool(true));
    }
    if word.eq_ignore_ascii_case("false") {
        return Some(Value::Bool(false));
    }
    let (negative, digits) = match word.as_bytes()[0] {
        b'-' => (true, &word[1..]),
        b'+' => (false, &word[1..]),
        _ => (false, word),
    };
    if !digits.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
        return Some(Value::Word(word.to_string()));
    }
    let is_hex = digits.starts_with("0x") || digits.starts_with("0X");
    let all_digits = digits.bytes().all(|b| b.is_ascii_digit());
    // `from_str_radix` would take a second sign.
    let whole = |text: &str, radix| {
        let unsigned = text.bytes().all(|b| b.is_ascii_alphanumeric());
        let n = i64::from_str_radix(text, radix).ok().filter(|_| unsigned)?;
        Some(Value::Integer(if negative { -n } else { n }))
    };
    if is_hex {
        whole(&digits[2..], 16)
    } else if all_digits && digits.len() > 1 && digits.starts_with('0') {
        whole(&digits[1..], 8)
    } else if all_digits {
        whole(digits, 10)
    } else {
        let number: f64 = digits.parse().ok()?;
        let number = if negative { -number } else { number };
        number.is_finite().then_some(Value::Float(number))
    }
}
