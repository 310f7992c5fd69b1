"""XML documents with texts from files of users."""

from __future__ import annotations

import re
from xml.etree import ElementTree as Xml

_NOT_IN_XML = re.compile(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def xml_document(root: Xml.Element, encoding: str = "utf-8") -> str:
    """Return the text of a document; characters that XML does not have become U+FFFD."""
    for element in root.iter():
        if element.text:
            element.text = _NOT_IN_XML.sub("\ufffd", element.text)
        for key, value in element.attrib.items():
            element.set(key, _NOT_IN_XML.sub("\ufffd", value))
    return f'<?xml version="1.0" encoding="{encoding}"?>\n{Xml.tostring(root, "unicode")}\n'
