//! Which way of showing pictures a terminal has.

use crate::cli::settings::parse_watch::Show;

/// A way of showing pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Kitty's graphics protocol.
    Kitty,
    /// iTerm2's inline images.
    Iterm,
    /// Sixels.
    Sixel,
    /// Half blocks in true colour.
    Blocks,
}

/// What there is to be done about a wish to see pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found {
    /// They can be shown in such a way.
    Way(Way),
    /// So they can, but a terminal multiplexer of this name keeps better ways from the terminal.
    Within(&'static str, Way),
    /// Nobody would see them.
    Nothing,
}

/// How to show pictures on standard error, which may be a terminal; `variable` reads the
/// environment.
pub fn detect(wish: Show, terminal: bool, variable: &dyn Fn(&str) -> Option<String>) -> Found {
    match wish {
        Show::Kitty => Found::Way(Way::Kitty),
        Show::Iterm => Found::Way(Way::Iterm),
        Show::Sixel => Found::Way(Way::Sixel),
        Show::Blocks => Found::Way(Way::Blocks),
        Show::Auto if !terminal || variable("TERM").as_deref() == Some("dumb") => Found::Nothing,
        Show::Auto => detect_terminal(variable),
    }
}

fn detect_terminal(variable: &dyn Fn(&str) -> Option<String>) -> Found {
    let is_set = |name: &str| variable(name).is_some_and(|value| !value.is_empty());
    let multiplexers = [("TMUX", "tmux"), ("ZELLIJ", "zellij"), ("STY", "screen")];
    if let Some((_, name)) = multiplexers.iter().find(|(variable, _)| is_set(variable)) {
        return Found::Within(name, Way::Blocks);
    }
    let term = variable("TERM").unwrap_or_default();
    let program = variable("TERM_PROGRAM").unwrap_or_default();
    let is_iterm = |name: &str| variable(name).as_deref() == Some("iTerm2");
    let way = match &*program {
        "iTerm.app" | "WezTerm" | "mintty" => Way::Iterm,
        "kitty" | "ghostty" => Way::Kitty,
        _ if is_set("KITTY_WINDOW_ID") || term == "xterm-kitty" || term == "xterm-ghostty" => {
            Way::Kitty
        }
        _ if is_iterm("LC_TERMINAL") => Way::Iterm,
        _ if ["foot", "mlterm", "contour", "yaft"].iter().any(|it| term.starts_with(it)) => {
            Way::Sixel
        }
        _ if term.contains("sixel") || is_set("KONSOLE_VERSION") => Way::Sixel,
        _ => Way::Blocks,
    };
    Found::Way(way)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(wish: Show, terminal: bool, set: &[(&str, &str)]) -> Found {
        detect(wish, terminal, &|name| {
            let value = set.iter().find(|(it, _)| *it == name).map(|(_, value)| *value);
            value.map(str::to_owned)
        })
    }

    #[test]
    fn terminals_are_known_by_their_variables() {
        for (set, way) in [
            (&[("TERM", "xterm-kitty")][..], Way::Kitty),
            (&[("TERM", "xterm-256color"), ("KITTY_WINDOW_ID", "1")], Way::Kitty),
            (&[("TERM", "xterm-ghostty"), ("TERM_PROGRAM", "ghostty")], Way::Kitty),
            (&[("TERM_PROGRAM", "iTerm.app")], Way::Iterm),
            (&[("TERM_PROGRAM", "WezTerm")], Way::Iterm),
            (&[("TERM", "xterm-256color"), ("LC_TERMINAL", "iTerm2")], Way::Iterm),
            (&[("TERM", "foot-extra")], Way::Sixel),
            (&[("TERM", "xterm-256color"), ("KONSOLE_VERSION", "240800")], Way::Sixel),
            (&[("TERM", "xterm-256color"), ("TERM_PROGRAM", "vscode")], Way::Blocks),
            (&[], Way::Blocks),
        ] {
            assert_eq!(found(Show::Auto, true, set), Found::Way(way), "{set:?}");
        }
    }

    #[test]
    fn multiplexers_get_blocks_and_are_named() {
        let set = [("TERM", "tmux-256color"), ("TMUX", "/tmp/a,1,0"), ("KITTY_WINDOW_ID", "1")];
        assert_eq!(found(Show::Auto, true, &set), Found::Within("tmux", Way::Blocks));
        assert_eq!(found(Show::Kitty, true, &set), Found::Way(Way::Kitty), "asked by name");
    }

    #[test]
    fn where_there_is_no_terminal_only_what_is_asked_for_by_name_is_shown() {
        assert_eq!(found(Show::Auto, false, &[("TERM", "xterm-kitty")]), Found::Nothing);
        assert_eq!(found(Show::Auto, true, &[("TERM", "dumb")]), Found::Nothing);
        assert_eq!(found(Show::Sixel, false, &[]), Found::Way(Way::Sixel));
    }
}
