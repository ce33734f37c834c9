//! The connection to tev: made when it can be, made again when it is lost.

use std::io::{self, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::Arc;
use std::time::Duration;

use super::packet::{self, Tile};
use crate::cli::settings::parse_watch::TevAddress;
use crate::film::Picture;

/// Columns and rows of a tile.
const SIDE: usize = 128;
/// How long tev may take to answer a call.
const CONNECT: Duration = Duration::from_secs(1);
/// How long tev may take nothing, before it counts as lost.
const STALL: Duration = Duration::from_secs(2);
/// Before the second attempt to reach tev; each later one waits twice as long.
const FIRST_PAUSE: Duration = Duration::from_secs(1);
/// The most that an attempt waits.
const LONGEST_PAUSE: Duration = Duration::from_secs(30);

/// Shows pictures in tev.
pub struct Link {
    address: TevAddress,
    /// What tev calls the picture.
    name: String,
    tell: Box<dyn Fn(&str) + Send>,
    stream: Option<TcpStream>,
    /// What tev has of the picture; `None`: it has yet to make an image.
    sent: Option<Arc<Picture>>,
    pause: Duration,
    /// Whether someone was told that it is lost.
    lost: bool,
}

impl Link {
    /// A link that is not connected yet. `tell` hears when tev is lost and when it is back.
    pub fn new(address: TevAddress, name: String, tell: Box<dyn Fn(&str) + Send>) -> Self {
        let (stream, sent) = (None, None);
        Self { address, name, tell, stream, sent, pause: FIRST_PAUSE, lost: false }
    }

    /// Shows a picture, if tev can be reached. Says for how long there is no use in another.
    pub fn show(&mut self, picture: &Arc<Picture>) -> Duration {
        match self.send(picture) {
            Ok(()) => {
                if std::mem::take(&mut self.lost) {
                    (self.tell)(&format!("tev: {} is reached again", self.address));
                }
                self.pause = FIRST_PAUSE;
                Duration::ZERO
            }
            Err(error) => {
                if !std::mem::replace(&mut self.lost, true) {
                    let address = &self.address;
                    let message = format!("tev: {address} is not reached: {error}; trying again");
                    (self.tell)(&message);
                }
                let pause = self.pause;
                self.pause = (2 * pause).min(LONGEST_PAUSE);
                pause
            }
        }
    }

    fn send(&mut self, picture: &Arc<Picture>) -> io::Result<()> {
        let channels = channels(picture);
        let names: Vec<&str> = channels.iter().map(|(name, _)| *name).collect();
        let mut stream = match self.stream.take() {
            Some(stream) => stream,
            None => connect(&self.address)?,
        };
        let sent = self.sent.take().filter(|sent| has_shape(sent, picture));
        if sent.is_none() {
            let size = (picture.frame.width(), picture.frame.height());
            stream.write_all(&packet::create(&self.name, size, &names))?;
        }
        for tile in tiles(picture) {
            if sent.as_ref().is_some_and(|sent| agrees(sent, &channels, tile)) {
                continue;
            }
            let pixels = indices(picture, tile);
            let values = pixels.flat_map(|pixel| channels.iter().map(move |(_, it)| it[pixel]));
            stream.write_all(&packet::update(
                &self.name,
                &names,
                in_frame(picture, tile),
                values,
            ))?;
        }
        (self.stream, self.sent) = (Some(stream), Some(Arc::clone(picture)));
        Ok(())
    }
}

/// The colours of a picture, by name.
fn channels(picture: &Picture) -> Vec<(&'static str, &[f32])> {
    let names = ["R", "G", "B", "A"].into_iter();
    names.filter_map(|name| Some((name, picture.channel(name)?))).collect()
}

/// Whether an image that was made for one picture can take another.
fn has_shape(sent: &Picture, picture: &Picture) -> bool {
    let names = |picture| channels(picture).into_iter().map(|(name, _)| name).collect::<Vec<_>>();
    (sent.frame, sent.crop) == (picture.frame, picture.crop) && names(sent) == names(picture)
}

/// Connects to the first of a name's addresses that answers.
fn connect(address: &TevAddress) -> io::Result<TcpStream> {
    let mut last = io::Error::from(io::ErrorKind::NotFound);
    for address in (&*address.host, address.port).to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT) {
            Ok(stream) => {
                stream.set_write_timeout(Some(STALL))?;
                return Ok(stream);
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

/// The tiles of a picture's crop, by the crop's own rows and columns.
fn tiles(picture: &Picture) -> impl Iterator<Item = Tile> + use<> {
    let (width, height) = (picture.width(), picture.height());
    (0..height).step_by(SIDE).flat_map(move |y| {
        (0..width).step_by(SIDE).map(move |x| Tile {
            x,
            y,
            width: SIDE.min(width - x),
            height: SIDE.min(height - y),
        })
    })
}

/// A tile of the crop by rows and columns of the frame, whose corner is tev's.
fn in_frame(picture: &Picture, tile: Tile) -> Tile {
    let shift = |from: i32, to: i32| (i64::from(to) - i64::from(from)).max(0) as usize;
    Tile {
        x: tile.x + shift(picture.frame.x0, picture.crop.x0),
        y: tile.y + shift(picture.frame.y0, picture.crop.y0),
        ..tile
    }
}

/// Where the pixels of a tile are in a channel.
fn indices(picture: &Picture, tile: Tile) -> impl Iterator<Item = usize> + use<> {
    let width = picture.width();
    (tile.y..tile.y + tile.height)
        .flat_map(move |y| y * width + tile.x..y * width + tile.x + tile.width)
}

/// Whether a tile is the same in what was sent.
fn agrees(sent: &Picture, channels: &[(&str, &[f32])], tile: Tile) -> bool {
    channels.iter().all(|(name, now)| {
        sent.channel(name)
            .is_some_and(|then| indices(sent, tile).all(|pixel| then[pixel] == now[pixel]))
    })
}

#[cfg(test)]
mod tests;
