//! The grammar and the fields of UDMF.

use super::build::{read_bytes, text_of, text_wad, three_rooms};
use crate::level::doom::Problem;
use crate::level::doom::text::{Spot, TextProblem, Value, parse};
use crate::level::{Place, Severity};

fn value(text: &str) -> Value {
    let document = parse(format!("key = {text};").as_bytes()).unwrap();
    document.fields[0].value.clone()
}

fn error(text: &str) -> (u32, u32, TextProblem) {
    let error = match parse(text.as_bytes()) {
        Err(error) => error,
        Ok(_) => match read_bytes(text_wad(text)).unwrap_err().problem {
            Problem::Text(error) => error,
            other => panic!("{other}"),
        },
    };
    let Spot { line, column } = error.at;
    (line, column, error.problem)
}

#[test]
fn values_of_every_kind() {
    for (text, n) in [
        ("0", 0),
        ("-12", -12),
        ("+7", 7),
        ("017", 15),
        ("0x1F", 31),
        ("-0X10", -16),
    ] {
        assert_eq!(value(text), Value::Integer(n), "{text}");
    }
    for (text, x) in [
        ("1.5", 1.5),
        ("-2.", -2.0),
        ("1.25e2", 125.0),
        ("+0.5E-1", 0.05),
    ] {
        assert_eq!(value(text), Value::Float(x), "{text}");
    }
    assert_eq!(value("TRUE"), Value::Bool(true));
    assert_eq!(value("false"), Value::Bool(false));
    assert_eq!(
        value(r#""a \"b\" \\c""#),
        Value::Text(r#"a "b" \c"#.to_string())
    );
    // Bare words are wrong for every field that is known, but no mistake of grammar.
    for word in ["word", "--1", "-"] {
        assert_eq!(value(word), Value::Word(word.to_string()));
    }
}

#[test]
fn comments_and_case_do_not_count() {
    let text = "// first\nNameSpace/**/=/* a\nb */\"Doom\"//x\n;Vertex{X=1.0;// y\nY=2;}";
    let document = parse(text.as_bytes()).unwrap();
    assert_eq!(document.fields[0].key, "namespace");
    assert_eq!(document.blocks[0].name, "vertex");
    assert_eq!(document.blocks[0].fields[1].key, "y");
    assert_eq!(document.blocks[0].at, Spot { line: 4, column: 2 });
}

#[test]
fn mistakes_are_told_by_line_and_column() {
    let expected = |wanted, found: &str| TextProblem::Expected {
        wanted,
        found: found.to_string(),
    };
    let number = |text: &str| TextProblem::Number {
        text: text.to_string(),
    };
    let cases = [
        ("a = 1\nb = 2;", 2, 1, expected("';'", "'b'")),
        ("a = ;", 1, 5, expected("a value", "';'")),
        ("vertex\n{ x 1; }", 2, 5, expected("'='", "'1'")),
        (
            "vertex { x = 1;",
            1,
            16,
            expected("the name of a field, or '}'", "the end of the text"),
        ),
        (
            "  7 = 1;",
            1,
            3,
            expected("the name of a block or field", "'7'"),
        ),
        ("vertex ;", 1, 8, expected("'=' or '{'", "';'")),
        (
            "é = 1;",
            1,
            1,
            expected("the name of a block or field", "'é'"),
        ),
        ("a = \"é\" b", 1, 9, expected("';'", "'b'")),
        ("a = 1; /* b\nc", 1, 8, TextProblem::OpenComment),
        ("a = 1;\n b = \"c\nd", 2, 6, TextProblem::OpenString),
        ("a = 089;", 1, 5, number("089")),
        ("a = 0x;", 1, 5, number("0x")),
        ("a = 1.2.3;", 1, 5, number("1.2.3")),
        ("a = 1.0e999;", 1, 5, number("1.0e999")),
        (
            "a = 99999999999999999999;",
            1,
            5,
            number("99999999999999999999"),
        ),
    ];
    for (text, line, column, problem) in cases {
        assert_eq!(error(text), (line, column, problem), "{text:?}");
    }
}

#[test]
fn wrong_and_missing_fields_are_told_by_line_and_column() {
    let wrong = |key: &str, wanted| TextProblem::Type {
        key: key.to_string(),
        wanted,
    };
    let head = "namespace = \"Doom\";\n";
    let text = format!("{head}vertex {{ x = 1.5;\n  y = \"2\"; }}");
    assert_eq!(error(&text), (3, 7, wrong("y", "a number")));
    let text = format!("{head} vertex {{ x = 1.5; }}");
    let missing = TextProblem::MissingField {
        block: "vertex".to_string(),
        key: "y",
    };
    assert_eq!(error(&text), (2, 2, missing));
    let text = format!("{head}sidedef {{ sector = 1.5; }}");
    assert_eq!(error(&text), (2, 20, wrong("sector", "a whole number")));
    let text = format!("{head}linedef {{ v1 = 0; v2 = 1; sidefront = 0; twosided = 1; }}");
    assert_eq!(error(&text), (2, 53, wrong("twosided", "true or false")));
    let text = format!("{head}sector {{ id = 3000000000; }}");
    assert_eq!(error(&text), (2, 15, wrong("id", "a number of 32 bits")));
    assert_eq!(
        error("vertex { x = 1; y = 2; }"),
        (1, 1, TextProblem::NoNamespace)
    );
}

#[test]
fn messages_name_file_map_lump_and_place() {
    let message = read_bytes(text_wad("namespace = \"Doom\";\nvertex {"))
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "test.wad, map MAP01: TEXTMAP, line 2, column 9: expected the name of a field, or '}', \
         found the end of the text"
    );
}

#[test]
fn fractions_are_kept_and_unknown_things_passed_over() {
    let mut map = three_rooms();
    map.vertices[0].x = -0.125;
    let text = text_of(&map) + "user_thing { colour = puce; } comment = \"none\";\n";
    let read = read_bytes(text_wad(&text)).unwrap();
    assert_eq!(read.draft.walls[6].from.x, -0.125);
    assert_eq!(read.draft.findings, []);
}

#[test]
fn unknown_namespaces_and_slopes_are_told() {
    let text = text_of(&three_rooms()).replace("\"Doom\"", "\"Elsewhere\"");
    let text = text.replacen("vertex { x = 0.0;", "vertex { zfloor = 8.0; x = 0.0;", 1);
    let findings = read_bytes(text_wad(&text)).unwrap().draft.findings;
    let codes: Vec<_> = findings.iter().map(|f| (f.code, f.severity)).collect();
    assert_eq!(
        codes,
        [
            ("sloped-sector", Severity::Note),
            ("unknown-namespace", Severity::Warning)
        ]
    );
    assert_eq!(findings[0].places, [Place::Sector(0)]);
    assert_eq!(
        findings[1].places,
        [Place::Text {
            line: 1,
            column: 13
        }]
    );
}
