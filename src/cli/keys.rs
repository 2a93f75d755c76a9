//! `marraztu keys`: lists all keys and mouse actions, from the same tables as the editor.

use std::fmt::Write as _;

use clap::Args;
use marraztu::app::actions::{ActionInfo, Group, MouseInfo};

use super::failure::Failure;
use super::talk::print;

/// Lists every key of the editor, and what the mouse does.
#[derive(Debug, Args)]
pub(crate) struct Keys {
    /// Print Markdown, with a table for each group
    #[arg(long)]
    markdown: bool,
}

/// Prints the keys.
pub(crate) fn keys(arguments: &Keys) -> Result<(), Failure> {
    let text = if arguments.markdown { markdown() } else { plain() };
    print(&text)
}

/// Returns each group with the actions that have keys.
fn groups() -> impl Iterator<Item = (Group, Vec<ActionInfo>)> {
    Group::ALL.into_iter().filter_map(|group| {
        let looks = group.actions().map(|action| action.info());
        let looks: Vec<ActionInfo> = looks.filter(|look| !look.keys.is_empty()).collect();
        (!looks.is_empty()).then_some((group, looks))
    })
}

fn names(look: &ActionInfo) -> Vec<String> {
    look.keys.iter().flat_map(|key| key.names()).collect()
}

fn plain() -> String {
    let mut text = String::new();
    for (group, looks) in groups() {
        let blank = if text.is_empty() { "" } else { "\n" };
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{blank}{}", group.label());
        for look in looks {
            let _ = writeln!(text, "  {:22}{:26}{}", names(&look).join(" "), look.label, look.hint);
        }
    }
    let _ = writeln!(text, "\n{}", MouseInfo::HEADING);
    for MouseInfo { inputs, label, hint, .. } in MouseInfo::ALL {
        let _ = writeln!(text, "  {:26}{label:22}{hint}", inputs.join(", "));
    }
    text
}

fn markdown() -> String {
    let mut text = String::new();
    for (group, looks) in groups() {
        let blank = if text.is_empty() { "" } else { "\n" };
        let _ = writeln!(text, "{blank}| {} | | |\n|---|---|---|", group.label());
        for look in looks {
            let keys: Vec<String> = names(&look).iter().map(|key| format!("`{key}`")).collect();
            let _ = writeln!(text, "| {} | {} | {} |", keys.join(" "), look.label, look.hint);
        }
    }
    let _ = writeln!(text, "\n| {} | | |\n|---|---|---|", MouseInfo::HEADING);
    for MouseInfo { inputs, label, hint, .. } in MouseInfo::ALL {
        let _ = writeln!(text, "| {} | {label} | {hint} |", inputs.join(", "));
    }
    text
}
