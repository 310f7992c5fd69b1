"""A project as PLCopen XML (TC6, version 2.01), which IDEs for PLCs import.

Declarations become elements; statements stay as they are.
"""

from __future__ import annotations

from xml.etree import ElementTree as Xml

from fuzzyarm.exchange.export.document import xml_document
from fuzzyarm.exchange.export.plc_project import ELEMENTARY, TIME, Declaration, Project, Unit
from fuzzyarm.version import __version__

__all__ = ["plcopen_xml"]

_SPACE = "http://www.plcopen.org/xml/tc6_0201"
_TEXT = "http://www.w3.org/1999/xhtml"

_SORTS = {"FUNCTION": "function", "FUNCTION_BLOCK": "functionBlock", "PROGRAM": "program"}
_LISTS: dict[str, tuple[str, dict[str, str]]] = {
    "VAR_INPUT": ("inputVars", {}),
    "VAR_OUTPUT": ("outputVars", {}),
    "VAR_IN_OUT": ("inOutVars", {}),
    "VAR CONSTANT": ("localVars", {"constant": "true"}),
    "VAR RETAIN": ("localVars", {"retain": "true"}),
    "VAR": ("localVars", {}),
}


def plcopen_xml(project: Project) -> str:
    """Return the text of a file.

    Parameters
    ----------
    project : Project
        Units of Structured Text.
    """
    Xml.register_namespace("", _SPACE)
    Xml.register_namespace("xhtml", _TEXT)
    root = Xml.Element(_of("project"))
    Xml.SubElement(
        root,
        _of("fileHeader"),
        {
            "companyName": "",
            "productName": "fuzzyarm",
            "productVersion": __version__,
            "creationDateTime": TIME,
        },
    )
    content = Xml.SubElement(root, _of("contentHeader"), {"name": project.name})
    coordinates = Xml.SubElement(content, _of("coordinateInfo"))
    for language in ("fbd", "ld", "sfc"):
        kind = Xml.SubElement(coordinates, _of(language))
        Xml.SubElement(kind, _of("scaling"), {"x": "1", "y": "1"})
    types = Xml.SubElement(root, _of("types"))
    listed = Xml.SubElement(types, _of("dataTypes"))
    for array in project.types:
        defined = Xml.SubElement(listed, _of("dataType"), {"name": array.named})
        _array(Xml.SubElement(defined, _of("baseType")), array)
    pous = Xml.SubElement(types, _of("pous"))
    for unit in project.units:
        pous.append(_pou(unit))
    instances = Xml.SubElement(root, _of("instances"))
    Xml.SubElement(instances, _of("configurations"))
    _indent(root)
    return xml_document(root)


def _pou(unit: Unit) -> Xml.Element:
    words = {"name": unit.name, "pouType": _SORTS[unit.sort]}
    pou = Xml.Element(_of("pou"), words)
    interface = Xml.SubElement(pou, _of("interface"))
    if unit.returned:
        returned = Xml.SubElement(interface, _of("returnType"))
        returned.append(_type(unit.returned))
    for section in unit.sections:
        name, words = _LISTS[section.title]
        listed = Xml.SubElement(interface, _of(name), words)
        for declaration in section.declarations:
            listed.append(_variable(declaration))
    body = Xml.SubElement(Xml.SubElement(pou, _of("body")), _of("ST"))
    Xml.SubElement(body, f"{{{_TEXT}}}p").text = unit.statements
    if unit.head:
        remark = Xml.SubElement(pou, _of("documentation"))
        Xml.SubElement(remark, f"{{{_TEXT}}}p").text = unit.head
    return pou


def _variable(declaration: Declaration) -> Xml.Element:
    variable = Xml.Element(_of("variable"), {"name": declaration.name})
    kind = Xml.SubElement(variable, _of("type"))
    if declaration.named or declaration.last is None:
        kind.append(_type(declaration.named or declaration.type))
    else:
        _array(kind, declaration)
    if declaration.start:
        start = Xml.SubElement(variable, _of("initialValue"))
        if declaration.last is None:
            Xml.SubElement(start, _of("simpleValue"), {"value": declaration.start})
        else:
            values = Xml.SubElement(start, _of("arrayValue"))
            for value in declaration.elements:
                cell = Xml.SubElement(values, _of("value"))
                Xml.SubElement(cell, _of("simpleValue"), {"value": value})
    return variable


def _array(parent: Xml.Element, declaration: Declaration) -> None:
    array = Xml.SubElement(parent, _of("array"))
    Xml.SubElement(array, _of("dimension"), {"lower": "0", "upper": str(declaration.last)})
    Xml.SubElement(array, _of("baseType")).append(_type(declaration.type))


def _type(name: str) -> Xml.Element:
    """Return an elementary type, or the block of an instance."""
    if name in ELEMENTARY:
        return Xml.Element(_of(name))
    return Xml.Element(_of("derived"), {"name": name})


def _of(name: str) -> str:
    return f"{{{_SPACE}}}{name}"


def _indent(root: Xml.Element) -> None:
    """Put elements on their own lines, except for texts, which stay as they are."""
    texts = {element: element.text for element in root.iter(f"{{{_TEXT}}}p")}
    Xml.indent(root)
    for element, text in texts.items():
        element.text = text
