"""XML of farm files as a tree, as forgiving as map programs are: name spaces are not checked."""

from __future__ import annotations

import re
from xml.etree.ElementTree import Element, TreeBuilder
from xml.parsers import expat

from pondhop.errors import Fault
from pondhop.farm.encodings import decode
from pondhop.farm.features import Source


def parse_xml(content: bytes, place: str, source: Source) -> Element | None:
    """The root of a document without its name spaces, or ``None`` with a fault.

    Entities are refused: no map program writes them, and a few of them fill any memory.
    """
    declaration = re.match(rb"""\s*<\?xml[^>]*encoding\s*=\s*["']([\w.-]+)["']""", content[:200])
    text = decode(content, source.notes, declaration[1].decode("ascii") if declaration else None)
    if "<!ENTITY" in text:
        action = "export the farm again, or remove the lines with <!ENTITY"
        source.faults.append(Fault(place, "the file defines entities, which are not read", action))
        return None
    builder = TreeBuilder()
    # Without a separator for name spaces expat does not check them: many programs forget to declare gx.
    parser = expat.ParserCreate("utf-8")
    parser.buffer_text = True
    parser.StartElementHandler = lambda tag, attributes: builder.start(tag.rpartition(":")[2], attributes)
    parser.EndElementHandler = lambda tag: builder.end(tag.rpartition(":")[2])
    parser.CharacterDataHandler = builder.data
    try:
        parser.Parse(text.encode("utf-8", errors="replace"), True)
        return builder.close()
    except expat.ExpatError as error:
        source.faults.append(Fault(place, f"not a file of a known format: {error}", "export the farm again"))
        return None


def text_in(element: Element, *tags: str) -> str:
    """The text of the first child of one of the tags; empty where there is none."""
    for tag in tags:
        child = element.find(tag)
        if child is not None and child.text and child.text.strip():
            return child.text.strip()
    return ""
