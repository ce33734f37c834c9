//! The little of Markdown that the documents are made of.

/// A file of Markdown.
pub struct Document {
    /// As it is called from the root of the project.
    pub name: String,
    text: String,
}

/// A fenced block of code.
pub struct Block<'d> {
    /// The language, such as `sh`.
    pub language: &'d str,
    /// What follows the language.
    pub tag: &'d str,
    /// Number of its first line, and its lines.
    pub first: usize,
    pub lines: Vec<&'d str>,
}

impl Document {
    pub fn new(name: &str, text: String) -> Self {
        Self { name: name.to_owned(), text }
    }

    /// All fenced blocks.
    pub fn blocks(&self) -> Vec<Block<'_>> {
        let (mut blocks, mut open) = (Vec::new(), None::<Block>);
        for (number, line) in self.text.lines().enumerate() {
            let fence = line.strip_prefix("```");
            match (fence, &mut open) {
                (Some(_), Some(_)) => blocks.extend(open.take()),
                (Some(info), None) => {
                    let (language, tag) = info.split_once(' ').unwrap_or((info, ""));
                    open = Some(Block { language, tag, first: number + 2, lines: Vec::new() });
                }
                (None, Some(block)) => block.lines.push(line),
                (None, None) => {}
            }
        }
        assert!(open.is_none(), "{}: a fence is not closed", self.name);
        blocks
    }

    /// Lines outside of fenced blocks, with their numbers.
    pub fn prose(&self) -> impl Iterator<Item = (usize, &str)> {
        let mut inside = false;
        self.text.lines().enumerate().filter_map(move |(number, line)| {
            inside ^= line.starts_with("```");
            (!inside).then_some((number + 1, line))
        })
    }

    /// The files that its blocks hold: those that begin with a remark that is a file's name.
    pub fn files(&self) -> impl Iterator<Item = (&str, String)> {
        self.blocks().into_iter().filter(|block| block.language == "toml").filter_map(|block| {
            let name = block.lines[0].strip_prefix("# ")?;
            super::commands::has_ending(name, &["toml"]).then(|| (name, block.lines.join("\n")))
        })
    }

    /// The places of commands that are not to be run, and why.
    pub fn left_out(&self) -> Vec<(String, String)> {
        let reason = |block: &Block| {
            let reason = block.tag.strip_prefix("no-run")?;
            let place = format!("{}:{}", self.name, block.first);
            Some((place, reason.trim_start_matches(':').trim().to_owned()))
        };
        self.blocks().iter().filter_map(reason).collect()
    }

    /// What it links to, pictures included.
    pub fn links(&self) -> impl Iterator<Item = &str> {
        self.prose().flat_map(|(_, line)| {
            line.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(link, _)| link)
        })
    }

    /// What stands as code amid words.
    pub fn code(&self) -> impl Iterator<Item = &str> {
        self.prose().flat_map(|(_, line)| line.split('`').skip(1).step_by(2))
    }

    /// Its headings, without the marks.
    pub fn headings(&self) -> impl Iterator<Item = &str> {
        let heading = |line: &'_ str| line.starts_with('#');
        self.prose()
            .filter(move |(_, line)| heading(line))
            .map(|(_, line)| line.trim_start_matches('#').trim())
    }

    /// The rows of the table whose first line is `heading`.
    pub fn table(&self, heading: &str) -> Vec<&str> {
        let lines = self.prose().map(|(_, line)| line).skip_while(|line| *line != heading);
        lines.skip(2).take_while(|line| line.starts_with('|')).collect()
    }

    /// The words that stand as code at the beginning of a row of a table.
    pub fn row_names(&self) -> impl Iterator<Item = &str> {
        self.prose().filter_map(|(_, line)| Some(line.strip_prefix("| `")?.split_once('`')?.0))
    }
}

/// What a link to a heading says behind the `#`, as on GitHub.
pub fn anchor(heading: &str) -> String {
    let kept = |c: &char| c.is_alphanumeric() || [' ', '-', '_'].contains(c);
    heading.to_lowercase().chars().filter(kept).map(|c| if c == ' ' { '-' } else { c }).collect()
}
