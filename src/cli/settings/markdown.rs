//! The settings as documentation.

use std::fmt::Write;

use super::setting::{Group, Role, Setting};
use super::table::Table;

impl Table {
    /// All settings as Markdown: a table for each group.
    pub fn to_markdown(&self) -> String {
        let mut text = String::new();
        for group in Group::ALL {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "### {}\n", group.heading());
            text.push_str("| setting | what it does | default | example | changes the picture |\n");
            text.push_str("|---|---|---|---|---|\n");
            for setting in self.settings().filter(|setting| setting.group == group) {
                text.push_str(&format_row(setting));
            }
            text.push('\n');
        }
        text.push_str(
            "Settings with – in the last column belong on the command line; the others are keys of \
             `[render]` in a .toml scene, too.\n",
        );
        text
    }
}

fn format_row(setting: &Setting) -> String {
    let short = setting.short.map_or(String::new(), |short| format!("`-{short}`, "));
    let mut what = setting.help.to_owned();
    if !setting.details.is_empty() {
        what = format!("{what}. {}", setting.details.trim_end_matches('.'));
    }
    if !setting.requires.is_empty() {
        what = format!("{what}. Needs {}", format_flags(setting.requires, " or "));
    }
    if !setting.conflicts.is_empty() {
        what = format!("{what}. Excludes {}", format_flags(setting.conflicts, ", "));
    }
    let default = match setting.default {
        Some(word) => format!("`{word}`"),
        None => setting.otherwise.to_owned(),
    };
    let identifies = match setting.role {
        Role::Run => "–",
        role if role.identifies_picture() => "yes",
        _ => "no",
    };
    let flag = setting.flag();
    let example = if setting.takes_value() { format!("{flag} {}", setting.example) } else { flag };
    let usage = format!("{short}`{}`", setting.usage());
    let cells = [usage, what, default, format!("`{example}`"), identifies.to_owned()];
    format!("| {} |\n", cells.map(|cell| cell.replace('|', "\\|")).join(" | "))
}

fn format_flags(names: &[&str], joint: &str) -> String {
    names.iter().map(|name| format!("`--{name}`")).collect::<Vec<_>>().join(joint)
}
