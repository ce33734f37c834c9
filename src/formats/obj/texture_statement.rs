//! What follows `map_Kd` and its like: options, and the name of a file that may hold spaces.

use super::lines;
use crate::math::Vec2;

/// A texture as an MTL file asks for it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// The file's name as it is spelt.
    pub name: String,
    /// Where it stands.
    pub line: usize,
    /// `-s`.
    pub scale: Vec2,
    /// `-o`, in OBJ's coordinates, where v counts upwards.
    pub offset: Vec2,
    /// `-clamp on`.
    pub clamp: bool,
    /// `-bm`, what bump heights or normals are multiplied by.
    pub bump: f32,
    /// `-imfchan`.
    pub channel: Option<Channel>,
}

/// What of a picture makes a scalar.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Channel {
    /// Red, green, blue or alpha, by number.
    Component(usize),
    /// Luminance.
    Luminance,
}

/// Options that take as many words as stated and change nothing here that can be seen, or that are
/// not honoured; the second kind is remarked on.
const OTHERS: [(&str, usize, bool); 8] = [
    ("-blendu", 1, false),
    ("-blendv", 1, false),
    ("-texres", 1, false),
    ("-colorspace", 1, false),
    ("-boost", 1, true),
    ("-cc", 1, true),
    ("-mm", 2, true),
    ("-type", 1, true),
];

/// Reads what follows the keyword; options may also follow the name. `remark` hears of options that
/// are not honoured. None where no name is given, as exporters leave it that lost a picture: then
/// all numbers are those of options.
///
/// # Errors
/// What is malformed.
pub(super) fn parse(
    rest: &[u8],
    line: usize,
    mut remark: impl FnMut(String),
) -> Result<Option<Map>, String> {
    let text = String::from_utf8_lossy(rest);
    let mut rest = Rest(text.trim());
    let mut map = Map {
        name: String::new(),
        line,
        scale: Vec2::ONE,
        offset: Vec2::ZERO,
        clamp: false,
        bump: 1.0,
        channel: None,
    };
    let mut lacking = None;
    while let Some(word) = rest.peek() {
        if !is_option(word) {
            if !map.name.is_empty() {
                return Err(format!("{} after the texture's name", lines::quote(word.as_bytes())));
            }
            rest.name().clone_into(&mut map.name);
            continue;
        }
        rest.next();
        if option(word, &mut rest, &mut map, &mut remark)?.is_none() {
            lacking = Some(word);
        }
    }
    if map.name.is_empty() {
        return Ok(None);
    }
    if let Some(word) = lacking {
        remark(format!("texture option {word} lacks its value and is skipped"));
    }
    Ok(Some(map))
}

/// Reads the values of an option. None if the statement ends before them.
fn option(
    word: &str,
    rest: &mut Rest,
    map: &mut Map,
    remark: &mut impl FnMut(String),
) -> Result<Option<()>, String> {
    match word {
        "-s" | "-o" | "-t" => {
            let default = if word == "-s" { map.scale } else { map.offset };
            let Some(vector) = rest.vector(default)? else { return Ok(None) };
            match word {
                "-s" => map.scale = vector,
                "-o" => map.offset = vector,
                _ => remark("texture option -t (turbulence) is not honoured".to_owned()),
            }
        }
        "-bm" => {
            let Some(bump) = rest.number()? else { return Ok(None) };
            map.bump = bump;
        }
        "-clamp" => {
            let Some(word) = rest.next() else { return Ok(None) };
            map.clamp = word == "on";
        }
        "-imfchan" => match rest.next() {
            None => return Ok(None),
            Some("z") => remark("texture option -imfchan z (depth) is not honoured".to_owned()),
            Some(word) => map.channel = Some(channel(word)?),
        },
        other => {
            let (_, count, matters) = OTHERS.iter().find(|o| o.0 == other).unwrap_or(&OTHERS[0]);
            let mut neutral = other == "-mm";
            for expected in ["0", "1"].iter().take(*count) {
                let Some(word) = rest.next() else { return Ok(None) };
                neutral &= word.parse::<f32>() == expected.parse::<f32>();
            }
            if *matters && !neutral {
                remark(format!("texture option {other} is not honoured"));
            }
        }
    }
    Ok(Some(()))
}

fn is_option(word: &str) -> bool {
    matches!(word, "-s" | "-o" | "-t" | "-bm" | "-clamp" | "-imfchan")
        || OTHERS.iter().any(|other| other.0 == word)
}

fn channel(word: &str) -> Result<Channel, String> {
    match word {
        "r" => Ok(Channel::Component(0)),
        "g" => Ok(Channel::Component(1)),
        "b" => Ok(Channel::Component(2)),
        "m" => Ok(Channel::Component(3)),
        "l" => Ok(Channel::Luminance),
        _ => Err(format!("-imfchan {word} is none of r, g, b, m, l and z")),
    }
}

/// What is not read yet.
struct Rest<'a>(&'a str);

impl<'a> Rest<'a> {
    fn peek(&self) -> Option<&'a str> {
        self.0.split_whitespace().next()
    }

    fn next(&mut self) -> Option<&'a str> {
        let text = self.0.trim_start();
        let end = text.find(char::is_whitespace).unwrap_or(text.len());
        let (word, rest) = text.split_at(end);
        self.0 = rest;
        (!word.is_empty()).then_some(word)
    }

    /// A number, unless there is nothing more.
    fn number(&mut self) -> Result<Option<f32>, String> {
        self.next().map(|word| lines::number(word.as_bytes())).transpose()
    }

    /// One to three numbers, of which the third, for solid textures, is dropped; `default` for what
    /// is left out. None if there is nothing more.
    fn vector(&mut self, default: Vec2) -> Result<Option<Vec2>, String> {
        let mut vector = default;
        let Some(first) = self.number()? else { return Ok(None) };
        vector.x = first;
        for k in 1..3 {
            let number = self.peek().and_then(|word| lines::number(word.as_bytes()).ok());
            let Some(number) = number else { break };
            self.next();
            if k == 1 {
                vector.y = number;
            }
        }
        Ok(Some(vector))
    }

    /// In quotes, or up to the next option. A quote that is not closed is as if it were not there.
    fn name(&mut self) -> &'a str {
        let mut text = self.0.trim_start();
        if let Some(opened) = text.strip_prefix('"') {
            if let Some((inside, rest)) = opened.split_once('"') {
                self.0 = rest;
                return inside;
            }
            text = opened.trim_start();
        }
        let mut ahead = Rest(text);
        let mut end = text.len();
        while let Some(word) = ahead.next() {
            if is_option(word) {
                end = text.len() - ahead.0.len() - word.len();
                break;
            }
        }
        self.0 = &text[end..];
        text[..end].trim_end()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn map(text: &str) -> Result<(Map, Vec<String>), String> {
        let mut remarks = Vec::new();
        let map = parse(text.as_bytes(), 1, |remark| remarks.push(remark))?;
        Ok((map.ok_or("it names no file")?, remarks))
    }

    fn name(text: &str) -> String {
        map(text).expect("it is well-formed").0.name
    }

    #[test]
    fn names_hold_spaces_and_options_stand_on_both_sides() {
        assert_eq!(name("texture 01.png"), "texture 01.png");
        assert_eq!(name("-bm 2 bump 01.png"), "bump 01.png");
        assert_eq!(name("\"a -s b.png\" -clamp on"), "a -s b.png");
        assert_eq!(name("  -blendu on -texres 512 .\\maps\\a.png "), ".\\maps\\a.png");
        let (map, _) = map("-imfchan r bump map2.jpg -bm 1.5").unwrap();
        assert_eq!(
            (&*map.name, map.bump, map.channel),
            ("bump map2.jpg", 1.5, Some(Channel::Component(0)))
        );
    }

    #[test]
    fn vectors_have_one_to_three_numbers() {
        let scale = |text| map(text).expect("it is well-formed").0.scale;
        assert_eq!(scale("-s 2 a.png"), Vec2::new(2.0, 1.0));
        assert_eq!(scale("-s 2 3 a.png"), Vec2::new(2.0, 3.0));
        assert_eq!(scale("-s 2 3 4 a.png"), Vec2::new(2.0, 3.0));
        assert_eq!(name("-s 2 3 4 5"), "5");
        assert_eq!(name("-s 2 3 4 -bm 1 5"), "5");
        assert_eq!(name("1 -s 2 3 4"), "1");
        let (map, _) = map("-o 0.1 -s 2 2 2 -clamp on a.png").unwrap();
        assert_eq!((map.offset, map.clamp), (Vec2::new(0.1, 0.0), true));
    }

    #[test]
    fn options_without_effect_are_remarked_on() {
        let remarks = |text| map(text).expect("it is well-formed").1;
        assert_eq!(remarks("-type sphere a.png"), ["texture option -type is not honoured"]);
        assert_eq!(remarks("-mm 0.1 0.3 a.png"), ["texture option -mm is not honoured"]);
        let (depth, said) = map("-imfchan z a.png").expect("it is well-formed");
        assert_eq!((&*depth.name, depth.channel), ("a.png", None));
        assert_eq!(said, ["texture option -imfchan z (depth) is not honoured"]);
        assert!(remarks("-mm 0 1 -blendv off a.png").is_empty());
    }

    #[test]
    fn what_is_missing_is_said() {
        assert_eq!(map("-bm x a.png"), Err("'x' is not a number".to_owned()));
        assert_eq!(map("\"a\" b"), Err("'b' after the texture's name".to_owned()));
        assert_eq!(
            map("-imfchan q a"),
            Err("-imfchan q is none of r, g, b, m, l and z".to_owned())
        );
    }

    /// What could be a name or an option's number is a number: pictures are rarely called 1.
    #[test]
    fn where_all_words_are_of_options_there_is_no_name() {
        for text in [
            "",
            "-s",
            "-s 1",
            "-s 1 1 1",
            "-o 0 0 0",
            "-t 1 1",
            "-s 1 1 -o 0 0",
            "-bm",
            "-bm 1",
            "-clamp",
            "-clamp on",
            "-imfchan",
            "-mm 0",
            "-type",
            "-boost",
            "\"",
            "\"\"",
            "\" -s 1",
        ] {
            assert_eq!(map(text), Err("it names no file".to_owned()), "{text}");
        }
    }

    #[test]
    fn an_option_that_lacks_its_value_is_skipped_and_said() {
        for option in ["-bm", "-clamp", "-imfchan", "-mm 0", "-s", "-type"] {
            let (map, said) = map(&format!("a.png {option}")).expect("it is well-formed");
            let word = option.split(' ').next().expect("it is a word");
            assert_eq!(said, [format!("texture option {word} lacks its value and is skipped")]);
            assert_eq!((&*map.name, map.scale, map.bump), ("a.png", Vec2::ONE, 1.0));
        }
        assert_eq!(name("\"a b.png -clamp on"), "a b.png");
    }

    proptest! {
        #[test]
        fn no_words_make_it_panic_or_hang(
            words in proptest::collection::vec("(-s|-o|-mm|-bm|-clamp|-type|1|on|\"|a b|é)", 0..12)
        ) {
            let _ = map(&words.join(" "));
        }
    }
}
