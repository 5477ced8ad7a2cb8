//! Markdown of the page's sections, which are written in a few elements of HTML.

/// Where a link to an anchor of the page leads in Markdown.
pub type Resolve<'a> = &'a dyn Fn(&str) -> String;

/// A section as Markdown. Of its elements, `i`, `sub` and `sup` stay HTML, which Markdown shows as it is.
///
/// # Panics
/// On an element that the page has not: it would be lost.
pub fn from_html(html: &str, resolve: Resolve) -> String {
    let mut writer = Writer::default();
    let mut rest = html;
    let mut links = Vec::new();
    while let Some(at) = rest.find('<') {
        writer.words(&rest[..at]);
        let end = at + rest[at..].find('>').expect("a tag ends");
        let tag = &rest[at + 1..end];
        let name = tag.split_whitespace().next().unwrap_or_default();
        match name {
            "a" => {
                writer.text.push('[');
                let anchor = tag.split_once("href=\"#").and_then(|(_, rest)| rest.split_once('"'));
                links.push(resolve(anchor.expect("a link within the page").0));
            }
            "/a" => writer.text += &format!("]({})", links.pop().expect("a link is open")),
            _ => writer.element(name, tag),
        }
        rest = &rest[end + 1..];
    }
    writer.words(rest);
    let text = writer.text;
    let mut lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    // One empty line between blocks, none at the ends.
    lines.dedup_by(|next, one| next.is_empty() && one.is_empty());
    format!("{}\n", lines.join("\n").trim())
}

/// Anchor that Markdown gives a heading.
pub fn anchor(heading: &str) -> String {
    let mut anchor = String::new();
    for letter in heading.to_lowercase().chars() {
        match letter {
            ' ' => anchor.push('-'),
            letter if letter.is_alphanumeric() || letter == '-' || letter == '_' => anchor.push(letter),
            _ => {}
        }
    }
    anchor
}

/// Text in a cell of a table, or in a paragraph.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('|', "\\|").replace('*', "\\*")
}

/// Headings of a section with their anchors in the page: (anchor of HTML, heading).
pub fn headings(html: &str) -> Vec<(String, String)> {
    let mut found = Vec::new();
    for level in ["<h2 id=\"", "<h3 id=\""] {
        for part in html.split(level).skip(1) {
            let (anchor, rest) = part.split_once("\">").expect("a heading with an anchor");
            let heading = rest.split_once("</h").expect("a heading ends").0;
            found.push((anchor.to_owned(), heading.replace("<code>", "").replace("</code>", "")));
        }
    }
    found
}

#[derive(Default)]
struct Writer {
    text: String,
    in_table: bool,
    /// Open lists: whether their items are numbered, and how many there are so far.
    lists: Vec<(bool, usize)>,
    /// Inside `code`, whose text is neither escaped nor formatted.
    in_code: bool,
    /// Inside `pre`, whose lines stay as well.
    in_block: bool,
    /// Inside an equation of its own line.
    in_equation: bool,
    columns: usize,
    row: usize,
}

impl Writer {
    fn words(&mut self, html: &str) {
        if self.in_code || self.in_block {
            let text = entities(html).replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&");
            self.text += &if self.in_block { text } else { text.replace('\n', " ") };
            return;
        }
        let text = entities(html).replace('*', "\\*");
        let text = if self.in_table { text.replace('|', "\\|") } else { text };
        let words: Vec<&str> = text.split_whitespace().collect();
        if words.is_empty() && (text.is_empty() || self.at_break()) {
            return;
        }
        if text.starts_with(char::is_whitespace) && !self.at_break() {
            self.text.push(' ');
        }
        self.text += &words.join(" ");
        if text.ends_with(char::is_whitespace) && !words.is_empty() {
            self.text.push(' ');
        }
    }

    fn at_break(&self) -> bool {
        self.text.is_empty() || self.text.ends_with(char::is_whitespace)
    }

    fn trim(&mut self) {
        self.text.truncate(self.text.trim_end().len());
    }

    fn element(&mut self, name: &str, tag: &str) {
        let equation = tag.contains("class=\"equation\"");
        match name {
            "h2" => self.text += "\n\n## ",
            "h3" => self.text += "\n\n### ",
            "p" if equation => {
                self.in_equation = true;
                self.text += "\n\n> <i>";
            }
            // In a list an equation is a line of its item.
            "span" if equation => {
                self.in_equation = true;
                self.text += "<br><i>";
            }
            // Upright text in an equation of the page has no equal here.
            "span" => self.in_equation = false,
            "/span" if self.in_equation => {
                self.in_equation = false;
                self.text += "</i><br>";
            }
            "/span" => self.in_equation = true,
            "p" => self.text += "\n\n",
            "/p" if self.in_equation => {
                self.in_equation = false;
                self.text += "</i>\n\n";
            }
            "/p" | "/h2" | "/h3" => {
                self.trim();
                self.text += "\n\n";
            }
            "ul" | "ol" => self.lists.push((name == "ol", 0)),
            "/ul" | "/ol" => {
                self.lists.pop();
                self.trim();
                self.text += "\n\n";
            }
            "li" => {
                self.trim();
                let (numbered, count) = self.lists.last_mut().expect("an item is in a list");
                self.text += if *count == 0 { "\n\n" } else { "\n" };
                *count += 1;
                self.text += &if *numbered { format!("{count}. ") } else { "- ".to_owned() };
            }
            "table" => (self.in_table, self.row) = (true, 0),
            "/table" => {
                self.in_table = false;
                self.text += "\n\n";
            }
            "tr" => {
                self.trim();
                self.text += if self.row == 0 { "\n\n|" } else { "\n|" };
                self.columns = 0;
            }
            "th" | "td" => {
                self.trim();
                self.text += " ";
                self.columns += 1;
            }
            "/th" | "/td" => {
                self.trim();
                self.text += " |";
            }
            "/tr" => {
                if self.row == 0 {
                    self.text += "\n|";
                    self.text += &"---|".repeat(self.columns);
                }
                self.row += 1;
            }
            "br" => self.text += "<br>",
            "code" | "/code" => {
                self.text.push('`');
                self.in_code = name == "code";
            }
            "pre" => {
                self.text += "\n\n```python\n";
                self.in_block = true;
            }
            "/pre" => {
                self.text += "\n```\n\n";
                self.in_block = false;
            }
            "b" | "/b" => self.text += "**",
            "em" | "/em" => self.text += "*",
            "i" | "/i" | "sub" | "/sub" | "sup" | "/sup" => self.text += &format!("<{name}>"),
            "div" | "/div" | "/li" => {}
            _ => panic!("the page's element <{tag}> has no form in Markdown"),
        }
    }
}

/// Named characters as themselves; those that HTML needs stay.
fn entities(html: &str) -> String {
    const NAMED: [(&str, &str); 20] = [
        ("&hellip;", "…"),
        ("&nbsp;", " "),
        ("&minus;", "−"),
        ("&ndash;", "–"),
        ("&micro;", "µ"),
        ("&aacute;", "á"),
        ("&eacute;", "é"),
        ("&oacute;", "ó"),
        ("&epsilon;", "ε"),
        ("&int;", "∫"),
        ("&le;", "≤"),
        ("&mu;", "μ"),
        ("&omega;", "ω"),
        ("&radic;", "√"),
        ("&rho;", "ρ"),
        ("&sigma;", "σ"),
        ("&sup2;", "²"),
        ("&sup3;", "³"),
        ("&middot;", "·"),
        ("&times;", "×"),
    ];
    NAMED.iter().fold(html.to_owned(), |text, (name, letter)| text.replace(name, letter))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn markdown(html: &str) -> String {
        from_html(html, &|anchor| format!("page.md#{anchor}"))
    }

    #[test]
    fn blocks_are_those_of_markdown() {
        let html = "<h2 id=\"a\">Head</h2>\n<p>One <b>two</b>\nthree &lt; <code>a_b &gt; *c</code>,\n<a href=\"#x\">there</a>.</p>\n\
                    <p class=\"equation\">F<sub>n</sub> = 1 <span>per face</span></p>\n\
                    <ul>\n<li>first\nline</li>\n<li>second <span class=\"equation\">a <span>or</span> b</span>\nend</li>\n</ul>\n<ol><li>n</li><li>m</li></ol><p>End</p>";
        let expected = "## Head\n\nOne **two** three &lt; `a_b > *c`, [there](page.md#x).\n\n> <i>F<sub>n</sub> = 1 per face</i>\n\n\
                        - first line\n- second <br><i>a or b</i><br> end\n\n1. n\n2. m\n\nEnd\n";
        assert_eq!(markdown(html), expected);
    }

    #[test]
    fn a_table_has_its_head_and_one_line_a_row() {
        let html = "<div class=\"wide\"><table class=\"messages\">\n<tr><th>message</th><th>bit</th></tr>\n\
                    <tr><td>|v| &hellip;\nx * y</td><td></td></tr>\n</table></div>\n<p>After</p>";
        assert_eq!(markdown(html), "| message | bit |\n|---|---|\n| \\|v\\| … x \\* y | |\n\nAfter\n");
    }

    #[test]
    fn anchors_are_those_of_markdown() {
        assert_eq!(anchor("Warnings and the bits of limit_reached"), "warnings-and-the-bits-of-limit_reached");
        assert_eq!(anchor("Bodies (level line, when it ends)"), "bodies-level-line-when-it-ends");
        assert_eq!(headings("<h3 id=\"a\">The <code>b</code></h3>"), [("a".to_owned(), "The b".to_owned())]);
    }

    #[test]
    #[should_panic(expected = "<video>")]
    fn an_element_that_would_be_lost_is_refused() {
        markdown("<video>");
    }
}
