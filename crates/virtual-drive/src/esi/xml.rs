//! The few shapes of XML that an ESI file has.

use std::io;

use quick_xml::Writer;
use quick_xml::events::BytesText;

/// The file as it grows.
pub(super) type Xml = Writer<Vec<u8>>;

/// LCID of US English, which ETG.2000 asks for in names.
const ENGLISH: &str = "1033";

pub(super) fn element(xml: &mut Xml, tag: &str, content: impl FnOnce(&mut Xml) -> io::Result<()>) -> io::Result<()> {
    xml.create_element(tag).write_inner_content(content)?;
    Ok(())
}

pub(super) fn text(xml: &mut Xml, tag: &str, content: &str) -> io::Result<()> {
    xml.create_element(tag).write_text_content(BytesText::new(content))?;
    Ok(())
}

pub(super) fn name(xml: &mut Xml, content: &str) -> io::Result<()> {
    xml.create_element("Name")
        .with_attribute(("LcId", ENGLISH))
        .write_text_content(BytesText::new(content))?;
    Ok(())
}

/// A group's type and its name, which are the same.
pub(super) fn named(xml: &mut Xml, content: &str) -> io::Result<()> {
    text(xml, "Type", content)?;
    name(xml, content)
}

pub(super) fn hex(number: u32) -> String {
    format!("#x{number:04X}")
}

/// Bytes as hexadecimal digits, as ETG.2000 has them.
pub(super) fn digits(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02X}")).collect()
}
