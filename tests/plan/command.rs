//! The command `marraztu plan`.

use std::process::{Command, Output};

fn run(arguments: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_marraztu"));
    let Output { status, stdout, stderr } = command.args(arguments).output().unwrap();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (status.code(), text(stdout), text(stderr))
}

fn plan(arguments: &[&str]) -> String {
    let all = [&["plan", "--size", "160x120"], arguments].concat();
    let (status, out, err) = run(&all);
    assert_eq!(status, Some(0), "{err}");
    out
}

#[test]
fn the_plan_takes_the_options_of_a_picture_and_names_their_omissions() {
    let whole = plan(&[]);
    let line = |text: &str, name: &str| {
        let found = text.lines().find(|line| line.starts_with(name));
        found.unwrap_or_else(|| panic!("{name} in\n{text}")).to_owned()
    };
    assert!(line(&whole, "sun").contains(" on "));
    assert!(whole.contains("does not change a single bit"));
    let dark = plan(&["--lights", "0"]);
    assert!(line(&dark, "sun").contains("switched off"));
    assert!(dark.contains("no light reads them"), "{dark}");
    assert!(plan(&["--edges"]).contains("edges only"));
    assert!(line(&plan(&["--helpers", "none"]), "Markers").contains("switched off"));
}

#[test]
fn every_line_for_machines_has_every_cell() {
    let csv = plan(&["--format", "csv", "--measure", "--seconds", "0.1"]);
    let mut lines = csv.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| head.iter().position(|cell| *cell == name).unwrap();
    let mut measured = 0;
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        // A reason with a comma is quoted.
        assert!(cells.len() == head.len() || line.contains('"'), "{line}");
        if cells.len() == head.len() {
            assert_eq!(cells[at("state")] == "on", !cells[at("pixels")].is_empty(), "{line}");
            measured += usize::from(!cells[at("milliseconds")].is_empty());
        }
    }
    assert!(measured > 5, "{csv}");
    let json = plan(&["--format", "json"]);
    // One more object holds the pixels by path.
    assert_eq!(json.matches('{').count(), csv.lines().count() + 1);
    assert_eq!(json.matches('{').count(), json.matches('}').count());
    assert_eq!(plan(&["--json"]), json);
}
