//! Commands to copy into a shell.

use std::ffi::OsStr;

/// Quotes a word as a POSIX shell takes it: as it is, or in single quotes.
pub fn quote(word: impl AsRef<OsStr>) -> String {
    let word = word.as_ref().to_string_lossy();
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.into_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// Joins words with spaces, each quoted.
pub fn join(words: impl IntoIterator<Item = impl AsRef<OsStr>>) -> String {
    words.into_iter().map(quote).collect::<Vec<_>>().join(" ")
}

/// The words that the process was started with, without its own name.
pub fn own_words() -> Vec<String> {
    std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shell_gives_the_words_back() {
        let words = ["plain-1,2.exr", "", "a b", "it's", "$HOME", "*", "ü;rm", "kd:layout=a", "~"];
        assert_eq!(join(["a", "b c"]), "a 'b c'");
        assert_eq!(quote("it's"), r"'it'\''s'");
        if cfg!(unix) {
            let script = format!("printf '%s\\n' {}", join(words));
            let output = std::process::Command::new("sh").args(["-c", &script]).output();
            let output = String::from_utf8(output.expect("a shell").stdout).expect("text");
            assert_eq!(output.lines().collect::<Vec<_>>(), words);
        }
    }
}
