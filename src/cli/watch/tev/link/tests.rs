//! Links to small servers: one that decodes, one that comes late, one that hangs.

use std::collections::BTreeMap;
use std::io::Read;
use std::net::TcpListener;
use std::sync::Mutex;
use std::sync::mpsc::{self, Receiver};
use std::thread::JoinHandle;

use super::*;
use crate::film::Window;

/// An image as a viewer has it: its size, and the values of each channel.
#[derive(Debug, Default, PartialEq)]
struct Image {
    size: (usize, usize),
    channels: BTreeMap<String, Vec<f32>>,
    /// How many tiles were set.
    updates: usize,
}

/// What packets tell, as tev reads it.
#[derive(Default)]
struct Viewer(BTreeMap<String, Image>);

/// Takes fields off the front of a packet.
struct Fields<'a>(&'a [u8]);

impl Fields<'_> {
    fn bytes<const N: usize>(&mut self) -> [u8; N] {
        let (first, rest) = self.0.split_first_chunk().expect("a whole field");
        self.0 = rest;
        *first
    }

    fn int(&mut self) -> usize {
        i32::from_le_bytes(self.bytes()).try_into().expect("none is negative")
    }

    fn long(&mut self) -> usize {
        i64::from_le_bytes(self.bytes()).try_into().expect("none is negative")
    }

    fn name(&mut self) -> String {
        let end = self.0.iter().position(|&byte| byte == 0).expect("names end");
        let name = String::from_utf8(self.0[..end].to_vec()).expect("text");
        self.0 = &self.0[end + 1..];
        name
    }
}

impl Viewer {
    fn take(&mut self, packet: &[u8]) {
        let mut fields = Fields(packet);
        let [kind, grabs] = fields.bytes();
        assert_eq!(grabs, 0);
        let name = fields.name();
        match kind {
            4 => {
                let (width, height) = (fields.int(), fields.int());
                let names = (0..fields.int()).map(|_| fields.name()).collect::<Vec<_>>();
                let blank = |name| (name, vec![0.0; width * height]);
                let channels = names.into_iter().map(blank).collect();
                self.0.insert(name, Image { size: (width, height), channels, updates: 0 });
                assert!(fields.0.is_empty());
            }
            6 => self.0.get_mut(&name).expect("it was made").set(fields),
            other => panic!("type {other}"),
        }
    }
}

impl Image {
    fn set(&mut self, mut fields: Fields<'_>) {
        let names = (0..fields.int()).map(|_| fields.name()).collect::<Vec<_>>();
        let [x, y, width, height] = std::array::from_fn(|_| fields.int());
        let offsets: Vec<usize> = names.iter().map(|_| fields.long()).collect();
        let strides: Vec<usize> = names.iter().map(|_| fields.long()).collect();
        let values: Vec<f32> =
            fields.0.as_chunks().0.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
        for ((name, offset), stride) in names.iter().zip(offsets).zip(strides) {
            let channel = self.channels.get_mut(name).expect("it was made");
            for pixel in 0..width * height {
                let place = (y + pixel / width) * self.size.0 + x + pixel % width;
                channel[place] = values[offset + pixel * stride];
            }
        }
        self.updates += 1;
    }
}

/// Reads all packets of one connection, until it ends.
fn serve(listener: TcpListener) -> JoinHandle<Viewer> {
    std::thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a client");
        let mut viewer = Viewer::default();
        let mut length = [0; 4];
        while stream.read_exact(&mut length).is_ok() {
            let mut packet = vec![0; u32::from_le_bytes(length) as usize - 4];
            stream.read_exact(&mut packet).expect("whole");
            viewer.take(&packet);
        }
        viewer
    })
}

fn listen() -> (TcpListener, TevAddress) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("it has one").to_string();
    (listener, address.parse().expect("an address"))
}

/// A link, and what it tells.
fn link(address: TevAddress) -> (Link, Receiver<String>) {
    let (sender, told) = mpsc::channel();
    let sender = Mutex::new(sender);
    let tell = move |line: &str| {
        let sender = sender.lock().expect("sound");
        sender.send(line.to_owned()).expect("someone listens");
    };
    (Link::new(address, "dapple: a".to_owned(), Box::new(tell)), told)
}

/// A picture of a crop at (3, 1) of a frame, each value another.
fn picture(width: usize, height: usize) -> Picture {
    let frame = Window::of_size(width + 5, height + 4);
    let crop = Window { x0: 3, y0: 1, x1: 3 + width as i32, y1: 1 + height as i32 };
    let mut picture = Picture::new(frame, crop);
    for (index, name) in ["R", "G", "B", "A", "depth.Z"].into_iter().enumerate() {
        let values = (0..width * height).map(|pixel| (pixel * 8 + index) as f32).collect();
        picture.set_channel(name, values);
    }
    picture
}

/// Whether an image is a picture, and black around it.
fn assert_shows(image: &Image, picture: &Picture) {
    let (width, height) = image.size;
    assert_eq!(image.size, (picture.frame.width(), picture.frame.height()));
    assert_eq!(image.channels.keys().collect::<Vec<_>>(), ["A", "B", "G", "R"]);
    for (name, found) in &image.channels {
        let mut expected = vec![0.0; width * height];
        let values = picture.channel(name).expect("there");
        for (row, values) in values.chunks(picture.width()).enumerate() {
            let start = (row + picture.crop.y0 as usize) * width + picture.crop.x0 as usize;
            expected[start..start + values.len()].copy_from_slice(values);
        }
        assert!(*found == expected, "{name}");
    }
}

#[test]
fn a_viewer_has_each_pixel_and_gets_what_has_changed() {
    let (listener, address) = listen();
    let server = serve(listener);
    let (mut link, told) = link(address);
    let first = Arc::new(picture(300, 130));
    assert_eq!(link.show(&first), Duration::ZERO);
    let mut second = picture(300, 130);
    let mut reds = second.channel("R").expect("there").to_vec();
    reds[129 * 300 + 299] = -1.0;
    second.set_channel("R", reds);
    let second = Arc::new(second);
    assert_eq!(link.show(&second), Duration::ZERO);
    drop(link);
    let viewer = server.join().expect("it understood");
    let image = &viewer.0["dapple: a"];
    assert_shows(image, &second);
    assert_eq!(image.updates, 6 + 1, "six tiles, and the one that differs");
    assert_eq!(told.iter().count(), 0);
}

#[test]
fn a_picture_of_another_shape_is_made_anew() {
    let (listener, address) = listen();
    let server = serve(listener);
    let (mut link, _told) = link(address);
    let mut opaque = picture(20, 10);
    opaque.retain_channels(|name| name != "A");
    assert_eq!(link.show(&Arc::new(opaque)), Duration::ZERO);
    let picture = Arc::new(picture(20, 10));
    assert_eq!(link.show(&picture), Duration::ZERO);
    drop(link);
    assert_shows(&server.join().expect("it understood").0["dapple: a"], &picture);
}

#[test]
fn a_viewer_that_comes_late_is_found_and_said_to_be() {
    let (listener, address) = listen();
    let place = listener.local_addr().expect("it has one");
    drop(listener);
    let (mut link, told) = link(address);
    let picture = Arc::new(picture(20, 10));
    let pauses = [link.show(&picture), link.show(&picture), link.show(&picture)];
    assert_eq!(pauses, [1, 2, 4].map(Duration::from_secs));
    let server = serve(TcpListener::bind(place).expect("the same port"));
    assert_eq!(link.show(&picture), Duration::ZERO);
    drop(link);
    assert_shows(&server.join().expect("it understood").0["dapple: a"], &picture);
    let told: Vec<String> = told.iter().collect();
    assert_eq!(told.len(), 2, "{told:?}");
    assert!(told[0].contains("is not reached") && told[1].contains("is reached again"), "{told:?}");
}

#[test]
fn a_viewer_that_takes_nothing_is_given_up() {
    let (listener, address) = listen();
    let (mut link, told) = link(address);
    // More than the system keeps for one who does not read.
    let picture = Arc::new(picture(2048, 1024));
    assert_eq!(link.show(&picture), FIRST_PAUSE);
    assert!(told.try_recv().expect("it is said").contains("is not reached"));
    drop(listener);
}

#[test]
fn a_viewer_that_goes_away_is_found_again() {
    let (listener, address) = listen();
    let (mut link, told) = link(address);
    let picture = |shade: f32| {
        let window = Window::of_size(64, 64);
        let mut picture = Picture::new(window, window);
        picture.set_aov("", "RGB", &vec![[shade; 3]; 64 * 64]);
        Arc::new(picture)
    };
    let again = listener.try_clone().expect("a second handle");
    assert_eq!(link.show(&picture(1.0)), Duration::ZERO);
    drop(listener.accept().expect("the link"));
    // The system tells only after it has sent something in vain.
    let mut shade = 2.0;
    while link.show(&picture(shade)).is_zero() {
        shade += 1.0;
    }
    let server = serve(again);
    assert_eq!(link.show(&picture(-1.0)), Duration::ZERO);
    drop(link);
    let viewer = server.join().expect("it understood");
    assert_eq!(viewer.0["dapple: a"].channels["G"], vec![-1.0; 64 * 64]);
    assert_eq!(told.iter().count(), 2);
}
