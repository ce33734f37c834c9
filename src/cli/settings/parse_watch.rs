//! Values of the settings about where a render is seen.

use std::fmt;
use std::str::FromStr;

use clap::ValueEnum;

/// How a picture is shown in a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Show {
    /// As the terminal says that it can.
    Auto,
    /// By kitty's graphics protocol.
    Kitty,
    /// By iTerm2's inline images.
    Iterm,
    /// By sixels.
    Sixel,
    /// By half blocks in true colour.
    Blocks,
}

/// Where the viewer tev listens.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TevAddress {
    /// A name or a number, as the system's resolver takes it.
    pub host: String,
    /// The port.
    pub port: u16,
}

impl TevAddress {
    /// Where tev listens unless it is told otherwise.
    pub const DEFAULT: &str = "127.0.0.1:14158";
}

impl FromStr for TevAddress {
    type Err = String;

    /// `HOST:PORT`; a host with colons is in brackets.
    fn from_str(text: &str) -> Result<Self, String> {
        let form = || format!("expected HOST:PORT, as in {}", Self::DEFAULT);
        let (host, port) = text.rsplit_once(':').ok_or_else(form)?;
        let bare = host.strip_prefix('[').and_then(|host| host.strip_suffix(']'));
        let port = port.parse().ok().filter(|&port| port > 0).ok_or_else(form)?;
        match bare.unwrap_or(host) {
            "" => Err(form()),
            host if bare.is_none() && host.contains(':') => Err(form()),
            host => Ok(Self { host: host.to_owned(), port }),
        }
    }
}

impl fmt::Display for TevAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.host.contains(':') {
            write!(f, "[{}]:{}", self.host, self.port)
        } else {
            write!(f, "{}:{}", self.host, self.port)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_have_a_host_and_a_port() {
        for text in [TevAddress::DEFAULT, "viewer.local:1", "[::1]:14158"] {
            assert_eq!(text.parse::<TevAddress>().expect(text).to_string(), text);
        }
        let local: TevAddress = "[::1]:14158".parse().expect("an address");
        assert_eq!((&*local.host, local.port), ("::1", 14158));
        for wrong in ["", "scene.gltf", "a:", ":1", "a:0", "a:65536", "::1:14158", "[]:1"] {
            assert!(wrong.parse::<TevAddress>().is_err(), "{wrong}");
        }
    }
}
