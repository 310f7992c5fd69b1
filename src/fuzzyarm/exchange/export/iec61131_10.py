"""A project as XML of IEC 61131-10, the format that the standard made of PLCopen's.

Its elements are written here as IEC 61131-10:2019 has them; its schema is sold with the standard,
so that nothing here has been held against it.
"""

from __future__ import annotations

from xml.etree import ElementTree as Xml

from fuzzyarm.exchange.export.document import xml_document
from fuzzyarm.exchange.export.plc_project import (
    TIME,
    Declaration,
    DeclarationSection,
    Project,
    Unit,
)
from fuzzyarm.version import __version__

__all__ = ["iec61131_10_xml"]

_SPACE = "www.iec.ch/public/TC65SC65BWG7TF10"
_INSTANCE = "http://www.w3.org/2001/XMLSchema-instance"

_SORTS = {"FUNCTION": "Function", "FUNCTION_BLOCK": "FunctionBlock", "PROGRAM": "Program"}
_PARAMETERS = {"VAR_IN_OUT": "InoutVars", "VAR_INPUT": "InputVars", "VAR_OUTPUT": "OutputVars"}
_LOCAL = {
    "VAR CONSTANT": {"constant": "true"},
    "VAR RETAIN": {"retain": "true"},
    "VAR": {},
}  # type: dict[str, dict[str, str]]


def iec61131_10_xml(project: Project) -> str:
    """Return the text of a file.

    Parameters
    ----------
    project : Project
        Units of Structured Text.
    """
    Xml.register_namespace("", _SPACE)
    Xml.register_namespace("xsi", _INSTANCE)
    root = Xml.Element(_of("Project"), {"schemaVersion": "1"})
    product = {"companyName": "", "productName": "fuzzyarm", "productVersion": __version__}
    Xml.SubElement(root, _of("FileHeader"), product)
    head = {"name": project.name, "creationDateTime": TIME}
    Xml.SubElement(root, _of("ContentHeader"), head)
    space = Xml.SubElement(Xml.SubElement(root, _of("Types")), _of("GlobalNamespace"))
    for array in project.types:
        defined = Xml.SubElement(space, _of("DataTypeDecl"), {"name": array.named})
        defined.append(_array(array, "UserDefinedTypeSpec"))
    # The types first, then what uses them.
    for sort in ("FUNCTION", "FUNCTION_BLOCK", "PROGRAM"):
        for unit in project.units:
            if unit.sort == sort:
                space.append(_declared(unit))
    Xml.SubElement(root, _of("Instances"))
    texts = {element: element.text for element in root.iter(_of("ST"))}
    Xml.indent(root)
    for element, text in texts.items():
        element.text = text
    return xml_document(root)


def _declared(unit: Unit) -> Xml.Element:
    element = Xml.Element(_of(_SORTS[unit.sort]), {"name": unit.name})
    if unit.head:
        element.append(_documentation(unit.head))
    if unit.returned:
        element.append(_type(Declaration("", unit.returned, None, "", ""), "ResultType"))
    sections = {section.title: section for section in unit.sections}
    ports = [title for title in sections if title in _PARAMETERS]
    if ports:
        listed = Xml.SubElement(element, _of("Parameters"))
        order = 0  # one count over all parameters: the order of a call
        for title in ports:
            group = Xml.SubElement(listed, _of(_PARAMETERS[title]))
            for declaration in sections[title].declarations:
                variable = _variable(declaration)
                variable.set("orderWithinParamSet", str(order))
                group.append(variable)
                order += 1
    for title, words in _LOCAL.items():
        if title in sections:
            element.append(_local(sections[title], words))
    content = Xml.SubElement(
        Xml.SubElement(element, _of("MainBody")),
        _of("BodyContent"),
        {f"{{{_INSTANCE}}}type": "ST"},
    )
    Xml.SubElement(content, _of("ST")).text = unit.statements
    return element


def _local(section: DeclarationSection, words: dict[str, str]) -> Xml.Element:
    listed = Xml.Element(_of("Vars"), {**words, "accessSpecifier": "private"})
    listed.extend(map(_variable, section.declarations))
    return listed


def _variable(declaration: Declaration) -> Xml.Element:
    variable = Xml.Element(_of("Variable"), {"name": declaration.name})
    if declaration.remark:
        variable.append(_documentation(declaration.remark))
    variable.append(_type(declaration, "Type"))
    if declaration.start:
        start = Xml.SubElement(variable, _of("InitialValue"))
        if declaration.last is None:
            Xml.SubElement(start, _of("SimpleValue"), {"value": declaration.start})
        else:
            values = Xml.SubElement(start, _of("ArrayValue"))
            for number in declaration.elements:
                cell = Xml.SubElement(values, _of("Value"))
                Xml.SubElement(cell, _of("SimpleValue"), {"value": number})
    return variable


def _type(declaration: Declaration, name: str) -> Xml.Element:
    """Return a type under a name; one of an array is defined where it stands."""
    element = Xml.Element(_of(name))
    if declaration.named or declaration.last is None:
        Xml.SubElement(element, _of("TypeName")).text = declaration.named or declaration.type
    else:
        element.append(_array(declaration, "InstantlyDefinedType"))
    return element


def _array(declaration: Declaration, name: str) -> Xml.Element:
    array = Xml.Element(_of(name), {f"{{{_INSTANCE}}}type": "ArrayTypeSpec"})
    Xml.SubElement(Xml.SubElement(array, _of("BaseType")), _of("TypeName")).text = declaration.type
    dimension = Xml.SubElement(array, _of("DimensionSpec"), {"dimensionNumber": "1"})
    bounds = {"lower": "0", "upper": str(declaration.last)}
    Xml.SubElement(dimension, _of("IndexRange"), bounds)
    return array


def _documentation(text: str) -> Xml.Element:
    element = Xml.Element(_of("Documentation"), {f"{{{_INSTANCE}}}type": "SimpleText"})
    element.text = text
    return element


def _of(name: str) -> str:
    return f"{{{_SPACE}}}{name}"
