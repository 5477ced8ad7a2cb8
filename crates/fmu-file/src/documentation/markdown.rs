//! Markdown: what the pages are written in, and its form in HTML.

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd, html};

/// Markdown as HTML, for one page: a link to a heading of any page leads to that heading here, and pictures lie beside the page.
pub(crate) fn to_html(markdown: &str) -> String {
    let mut events: Vec<Event> = Parser::new_ext(markdown, Options::ENABLE_TABLES).collect();
    for at in 0..events.len() {
        let (start, rest) = events[at..].split_first_mut().expect("an event");
        match start {
            Event::Start(Tag::Heading { id, .. }) => {
                let title = rest.iter().map_while(|event| match event {
                    Event::Text(text) | Event::Code(text) => Some(text.as_ref()),
                    Event::End(TagEnd::Heading(_)) => None,
                    _ => Some(""),
                });
                *id = Some(anchor(&title.collect::<String>()).into());
            }
            Event::Start(Tag::Link { dest_url, .. }) => {
                if let Some(at) = dest_url.find('#') {
                    *dest_url = dest_url[at..].to_owned().into();
                }
            }
            Event::Start(Tag::Image { dest_url, .. }) => {
                let name = dest_url.rsplit('/').next().unwrap_or_default().to_owned();
                *dest_url = name.into();
            }
            _ => {}
        }
    }
    // A table that is wider than the window scrolls by itself.
    let scrolling = events.into_iter().flat_map(|event| match event {
        Event::Start(Tag::Table(_)) => [Event::Html("<div class=\"wide\">".into()), event],
        Event::End(TagEnd::Table) => [event, Event::Html("</div>\n".into())],
        event => [event, Event::Text("".into())],
    });
    let mut text = String::new();
    html::push_html(&mut text, scrolling);
    text
}

/// Anchor that a page shows for a heading.
pub(crate) fn anchor(heading: &str) -> String {
    let kept = |letter: &char| letter.is_alphanumeric() || " -_".contains(*letter);
    heading.to_lowercase().chars().filter(kept).map(|letter| if letter == ' ' { '-' } else { letter }).collect()
}

/// List of links to headings of a page.
pub(crate) fn contents<T: AsRef<str>>(headings: impl Iterator<Item = T>) -> String {
    let link = |heading: T| format!("[{0}](#{1})", heading.as_ref(), anchor(heading.as_ref()));
    format!("{}\n\n", headings.map(link).collect::<Vec<_>>().join(" ·\n"))
}

/// Headings of a page one level lower, where the page becomes a section.
pub(crate) fn section(page: &str) -> String {
    format!("#{}", page.replace("\n#", "\n##"))
}

/// Text in a cell of a table, or in a paragraph.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('|', "\\|").replace('*', "\\*")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_pictures_and_tables_are_those_of_one_page() {
        let page = "# A `b_c`, (d)\n\n[there](other.md#x)\n\n![what](../y/z.svg)\n\n|a|\n|---|\n|\\|v\\||\n";
        let html = to_html(page);
        for part in [
            "<h1 id=\"a-b_c-d\">A <code>b_c</code>, (d)</h1>",
            "<a href=\"#x\">there</a>",
            "<img src=\"z.svg\" alt=\"what\" />",
            "<div class=\"wide\"><table>",
            "<td>|v|</td></tr>\n</tbody></table>\n</div>",
        ] {
            assert!(html.contains(part), "{part} is not in {html}");
        }
        assert_eq!(section("# A\n\n## B\n"), "## A\n\n### B\n");
        assert_eq!(contents(["A (b)"].iter()), "[A (b)](#a-b)\n\n");
    }
}
