//! Elements and attributes of an XML file, indented, with escaping by quick-xml.

use std::borrow::Cow;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesEnd, BytesStart, Event};

/// An attribute: name and unescaped value.
pub(crate) type Attribute<'a> = (&'a str, Cow<'a, str>);

/// An XML file in the making. Writing to memory cannot fail, so neither can any method.
pub(crate) struct Xml {
    writer: Writer<Vec<u8>>,
    open: Vec<String>,
}

impl Xml {
    /// A file with its declaration.
    pub(crate) fn new() -> Self {
        let mut xml = Xml { writer: Writer::new_with_indent(Vec::new(), b' ', 2), open: Vec::new() };
        xml.event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)));
        xml
    }

    fn event(&mut self, event: Event) {
        self.writer.write_event(event).expect("writing to memory");
    }

    fn start<'a>(name: &'a str, attributes: &[Attribute]) -> BytesStart<'a> {
        let mut start = BytesStart::new(name);
        for (name, value) in attributes {
            start.push_attribute((*name, value.as_ref()));
        }
        start
    }

    /// An element with content; close it with [`Xml::close`].
    pub(crate) fn open(&mut self, name: &str, attributes: &[Attribute]) {
        self.event(Event::Start(Self::start(name, attributes)));
        self.open.push(name.to_owned());
    }

    /// An element without content.
    pub(crate) fn empty(&mut self, name: &str, attributes: &[Attribute]) {
        self.event(Event::Empty(Self::start(name, attributes)));
    }

    pub(crate) fn close(&mut self) {
        let name = self.open.pop().expect("an element is open");
        self.event(Event::End(BytesEnd::new(name)));
    }

    pub(crate) fn finish(mut self) -> String {
        assert!(self.open.is_empty(), "{:?} are still open", self.open);
        self.writer.get_mut().push(b'\n');
        String::from_utf8(self.writer.into_inner()).expect("only text was written")
    }
}

/// A number in the shortest form that reads back as the same f64.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 || (1e-4..1e9).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

/// `(name, number)` as an attribute.
pub(crate) fn numeric(name: &str, value: f64) -> Attribute<'_> {
    (name, number(value).into())
}

/// `(name, text)` as an attribute.
pub(crate) fn text<'a>(name: &'a str, value: &'a str) -> Attribute<'a> {
    (name, value.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_as_the_same_value() {
        for value in [0.0, 1e-4, 9.9e-5, 1e9, -2.5, 293.15, 1.0 / 3.0, 2e-14, 1.7976931348623157e308, -5e-324] {
            assert_eq!(number(value).parse::<f64>(), Ok(value));
        }
        assert_eq!(
            (number(2e-14).as_str(), number(1370.0).as_str(), number(1e-4).as_str()),
            ("2e-14", "1370", "0.0001")
        );
    }

    #[test]
    fn values_are_escaped() {
        let mut xml = Xml::new();
        xml.open("a", &[text("b", "x < \"y\" & z")]);
        xml.empty("c", &[numeric("d", 0.5)]);
        xml.close();
        assert_eq!(
            xml.finish(),
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<a b=\"x &lt; &quot;y&quot; &amp; z\">\n  <c d=\"0.5\"/>\n</a>\n"
        );
    }
}
