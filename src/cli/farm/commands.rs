//! The commands of a task and of a merge, as bash takes them.
//!
//! A task is told by the variable `task`, its index from 0, a merge by `picture`, another one.

use super::plan::Plan;
use crate::cli::settings::frames::find_number;
use crate::cli::shell::quote;

/// The columns that a line of a script may have.
const COLUMNS: usize = 90;

impl Plan {
    /// The lines that render task `$task`, the last of them one command. `before` and `more` are
    /// words around it, as bash takes them.
    pub fn render_task(&self, before: &str, more: &[&str]) -> String {
        let parts = self.parts;
        let mut lines = Vec::new();
        let mut files = Vec::new();
        if let Some(frames) = self.frames {
            let number = if parts > 1 { format!("task / {parts}") } else { "task".to_owned() };
            lines.push(format!("frame=$(({} + {number}))", frames.first));
            files.push("$frame");
        }
        if parts > 1 {
            let is_all = self.frames.is_none();
            let part = if is_all { "$task".to_owned() } else { format!("$((task % {parts}))") };
            lines.push(format!("part={part}"));
            files.push("$part");
        }
        if files.is_empty() {
            files.push("$task");
        }
        let file = |ending: &str| self.file(&format!("\"{}\"{ending}", files.join(".")));
        let mut words = vec![format!("{before}{}", quote(&self.dapple)), "render".to_owned()];
        words.extend(self.words.iter().map(quote));
        if self.frames.is_some() {
            words.extend(["--frames", "\"$frame\""].map(str::to_owned));
        }
        if parts > 1 {
            words.extend(["--part".to_owned(), format!("\"$part/{parts}\"")]);
            words.extend(["--partial".to_owned(), file(".part")]);
        } else {
            // Render numbers them itself.
            let named = self.outputs.iter().map(|(flag, file)| [(*flag).to_owned(), quote(file)]);
            words.extend(named.flatten());
        }
        words.extend(["--checkpoint".to_owned(), file(".checkpoint")]);
        words.extend(["--resume", "auto"].map(str::to_owned));
        words.extend(more.iter().map(|&word| word.to_owned()));
        lines.push(wrap(&words));
        lines.join("\n")
    }

    /// The lines that merge the parts of picture `$picture`, the last of them one command.
    pub fn merge_picture(&self, before: &str, more: &[&str]) -> String {
        let mut lines = Vec::new();
        let last = self.parts - 1;
        let mut parts = format!("{{0..{last}}}.part");
        if let Some(frames) = self.frames {
            lines.push(format!("frame=$(({} + picture))", frames.first));
            parts = format!("\"$frame\".{parts}");
        }
        let mut words =
            vec![format!("{before}{}", quote(&self.dapple)), "merge".to_owned(), self.file(&parts)];
        for (flag, file) in &self.outputs {
            words.extend([(*flag).to_owned(), self.numbered(file)]);
        }
        if self.typed.contains(&"reproducible") {
            words.push("--reproducible".to_owned());
        }
        if self.typed.contains(&"quiet") {
            words.push("--quiet".to_owned());
        }
        words.extend(more.iter().map(|&word| word.to_owned()));
        lines.push(wrap(&words));
        lines.join("\n")
    }

    /// A file in the folder of parts; `name` is as bash takes it.
    pub fn file(&self, name: &str) -> String {
        format!("{}/{name}", quote(&self.work))
    }

    /// An output with the number of `$frame` in its place, if there are frames.
    fn numbered(&self, file: &str) -> String {
        let Some(it) = find_number(file).filter(|_| self.frames.is_some()) else {
            return quote(file);
        };
        let quoted = |text: &str| if text.is_empty() { String::new() } else { quote(text) };
        let number = format!("\"$(printf %0{}d \"$frame\")\"", it.digits);
        format!("{}{number}{}", quoted(it.before), quoted(it.after))
    }
}

/// Joins words into a command, in lines of some length; a flag stays with its value.
fn wrap(words: &[String]) -> String {
    let is_flag = |word: &str| word.starts_with('-');
    let mut groups: Vec<String> = Vec::new();
    for (at, word) in words.iter().enumerate() {
        match groups.last_mut() {
            Some(flag) if is_flag(&words[at - 1]) && !is_flag(word) => {
                flag.push(' ');
                flag.push_str(word);
            }
            _ => groups.push(word.clone()),
        }
    }
    let mut lines: Vec<String> = Vec::new();
    for group in groups {
        match lines.last_mut() {
            Some(line) if line.chars().count() + group.chars().count() < COLUMNS => {
                line.push(' ');
                line.push_str(&group);
            }
            _ => lines.push(group),
        }
    }
    lines.join(" \\\n    ")
}

/// Puts each line two columns to the right.
pub fn indent(text: &str) -> String {
    text.lines().flat_map(|line| ["  ", line, "\n"]).collect()
}
