//! The README says what the program does: its level format and its examples.

const README: &str = include_str!("../../README.md");

#[test]
fn levels_in_the_readme_can_be_read() {
    let mut blocks = 0;
    for block in README.split("```toml\n").skip(1) {
        let text = block.split("```").next().unwrap();
        enfilade::level::toml::read(text, "README.md").unwrap_or_else(|e| panic!("{e}\n{text}"));
        blocks += 1;
    }
    assert!(blocks > 0, "the README shows a level");
}

#[test]
fn every_key_of_the_level_format_is_in_the_readme() {
    let docs = include_str!("../../src/level/toml/mod.rs");
    let rows: Vec<&str> = docs
        .lines()
        .filter_map(|l| l.strip_prefix("//! "))
        .filter(|l| l.starts_with('|'))
        .collect();
    assert!(rows.len() > 10, "the format is documented in tables");
    for row in rows {
        assert!(
            README.contains(row),
            "README.md lacks this row of src/level/toml/mod.rs:\n{row}"
        );
    }
}

#[test]
fn there_are_two_set_up_commands_and_the_files_they_name_exist() {
    let set_up = README
        .split("## Set-up")
        .nth(1)
        .unwrap()
        .split("\n## ")
        .next()
        .unwrap();
    let commands: Vec<&str> = set_up
        .lines()
        .filter_map(|l| l.strip_prefix("    "))
        .collect();
    assert_eq!(
        commands,
        [
            "cargo run --release -- build levels/museum.toml",
            "cargo test --release --features viewer-tests"
        ]
    );
    assert!(
        std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("levels/museum.toml")
            .exists()
    );
}
