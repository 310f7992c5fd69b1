"""Texts of files: templates with holes, and XML documents with texts from files of users."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
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


Blocks = Mapping[str, Sequence[str] | str]
"""What fills the holes of a template, by their names."""


def filled(template: str, blocks: Blocks) -> Iterator[str]:
    """Yield the lines of a template; a hole on its own line takes lines, others a text."""
    for line in template.strip("\n").split("\n"):
        hole = re.fullmatch(r"( *)<(\w+)>", line)
        if hole is not None and not isinstance(blocks[hole[2]], str):
            yield from (f"{hole[1]}{each}" for each in blocks[hole[2]])
        else:
            yield re.sub(r"<(\w+)>", lambda match: str(blocks[match[1]]), line)


def filled_text(template: str, blocks: Blocks) -> str:
    """Return a template with its holes filled."""
    return "\n".join([*filled(template, blocks), ""])
