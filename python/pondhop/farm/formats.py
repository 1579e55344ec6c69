"""Farm files of every format as features: the content decides how a file is read, its ending where the content is text.

Only regular files of bounded size are opened.
"""

from __future__ import annotations

import re
import stat
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from pondhop.errors import Fault
from pondhop.farm.archives import Room, Unpacked, check_archive, is_spreadsheet, unpack
from pondhop.farm.encodings import decode
from pondhop.farm.features import Source, listed
from pondhop.farm.geojson import read_json
from pondhop.farm.gis import FORMATS, is_gis_file, layer_fault, read_gis, read_sheets
from pondhop.farm.gpx import read_gpx
from pondhop.farm.kml import read_kml
from pondhop.farm.tables import read_sheet_rows, read_table
from pondhop.farm.xml_tree import parse_xml

MAX_FILE_BYTES = 250_000_000
"""A farm of 10,000 ponds takes a hundredth of it; larger files are pictures, or other things by mistake."""

_HEAD_BYTES = 65_536


def read_source(path: Path, layers: Sequence[str] = ()) -> Source:
    """Read a farm file of any format.

    Parameters
    ----------
    path
        KML, GPX, archives, workbooks and what GDAL reads are known by their content; other text is GeoJSON if the file
        ends in ``.geojson`` or ``.json``, or begins like JSON, and else a table.
    layers
        Names of the layers, sheets or folders to read; all of them if there are none.

    Returns
    -------
    Source
        Features in WGS84 with the faults and notes of reading; a file that cannot be read has a fault and no feature.
    """
    source = Source(name=path.stem)
    try:
        fault = _file_fault(path)
        if fault is not None:
            source.faults.append(fault)
        else:
            _read_file(path, source, layers, Room())
    except OSError as error:
        source.faults.append(Fault(str(path), f"cannot be read: {error.strerror}", "check the file's permissions"))
    if layers:
        _keep_layers(layers, source)
    return source


def _file_fault(path: Path) -> Fault | None:
    """The fault of what is no file that could be read: devices and pipes never end."""
    if not path.exists():
        return Fault(str(path), "there is no such file", "check the spelling and the folder")
    if path.is_dir():
        if path.suffix.lower() == ".gdb":
            return None
        return Fault(str(path), "this is a folder", f"name the file in it: {FORMATS}")
    status = path.stat()
    if not stat.S_ISREG(status.st_mode):
        return Fault(str(path), "this is no regular file", "name a file on disk")
    if status.st_size == 0:
        return Fault(str(path), "the file is empty", "export the farm again")
    if status.st_size > MAX_FILE_BYTES:
        message = f"the file has {status.st_size / 1e6:.0f} MB, more than {MAX_FILE_BYTES / 1e6:.0f} MB"
        return Fault(str(path), message, "export the ponds alone")
    return None


def _read_file(path: Path, source: Source, layers: Sequence[str], room: Room) -> None:
    if path.is_dir():
        read_gis(path, source, layers)
        return
    with path.open("rb") as file:
        head = file.read(_HEAD_BYTES)
    suffix = path.suffix.lower()
    if head.startswith(b"PK\x03\x04"):
        if is_spreadsheet(path):
            _read_workbook(path, source, room)
        else:
            _read_archive(path, source, layers, room)
    elif is_gis_file(path, head):
        read_gis(path, source, layers)
    elif suffix in {".geojson", ".json"}:
        _read_text(path, read_json, source)
    elif _is_xml(head):
        _read_xml(path, head, source)
    elif _is_json(head):
        _read_text(path, read_json, source)
    elif suffix in {".csv", ".tsv", ".txt"}:
        _read_text(path, read_table, source)
    elif suffix in {".shx", ".dbf", ".prj", ".cpg"}:
        action = f"name {path.with_suffix('.shp').name}, and keep the others beside it"
        source.faults.append(Fault(str(path), "this is one file of a shapefile", action))
    elif suffix in {".xls", ".doc", ".docx", ".pdf", ".numbers"}:
        source.faults.append(Fault(str(path), f"{suffix} files are not read", "save the table as .xlsx or CSV"))
    else:
        source.faults.append(Fault(str(path), "not a file of a known format", f"export the farm as {FORMATS}"))


def _is_xml(head: bytes) -> bool:
    return re.match(rb"(?:\xef\xbb\xbf)?\s*<", head) is not None or head.startswith((b"\xff\xfe<", b"\xfe\xff\x00<"))


def _is_json(head: bytes) -> bool:
    return re.match(rb"(?:\xef\xbb\xbf|\x1e)?\s*[\[{]", head) is not None


def _read_text(path: Path, read: Callable[[str, Source], None], source: Source) -> None:
    text = decode(path.read_bytes(), source.notes)
    if re.search(r"[\x00-\x08\x0e-\x1d\x1f]", text[:10_000]):
        source.faults.append(Fault(str(path), "this is no text", f"name a file of {FORMATS}, by its usual ending"))
    else:
        read(text, source)


def _read_xml(path: Path, head: bytes, source: Source) -> None:
    root = parse_xml(path.read_bytes(), str(path), source)
    if root is None:
        return
    if root.tag == "kml" or (root.tag in {"Document", "Folder", "Placemark"} and path.suffix.lower() == ".kml"):
        read_kml(root, source)
    elif root.tag == "gpx":
        read_gpx(root, source)
    else:
        found = f"an XML file whose outermost element is <{root.tag[:40]}>"
        if b"<html" in head[:2000].lower():
            found = "a web page, not the file behind it"
        message = f"not a file of a known format: it is {found}"
        source.faults.append(Fault(str(path), message, f"export the farm as {FORMATS}"))


def _read_workbook(path: Path, source: Source, room: Room) -> None:
    fault = check_archive(path, room=room)
    if fault is not None:
        source.faults.append(fault)
        return
    read_sheet_rows(read_sheets(path.resolve(), source), source)


def _read_archive(path: Path, source: Source, layers: Sequence[str], room: Room) -> None:
    """Read what an archive holds; several files in it are layers of one farm, named as they are.

    What is not read is told by name: it may be the area to keep out of.
    """
    with TemporaryDirectory(prefix="pondhop-") as folder:
        entries, others = unpack(path, Path(folder), source, room)
        if source.faults:
            return
        inner_room = Room(room.bytes_left, room.depth + 1)
        read: list[tuple[Unpacked, Source]] = []
        blank: list[tuple[Unpacked, Source]] = []
        for entry in entries:
            inner = Source(name=source.name)
            try:
                _read_file(entry.path, inner, layers, inner_room)
            except OSError as error:
                inner.faults.append(Fault(entry.member, f"cannot be read: {error.strerror}", "export it again"))
            (blank if _is_blank(entry, inner) else read).append((entry, inner))
        room.bytes_left = inner_room.bytes_left
    if not read:
        read = [(entry, inner) for entry, inner in blank if entry.is_map]
        blank = [(entry, inner) for entry, inner in blank if not entry.is_map]
    others = [*(entry.member for entry, _ in blank), *others]
    if not read:
        held = listed(map(repr, others)) or "nothing"
        action = "name the file with the ponds; an archive may hold KML, shapefiles, GeoJSON and tables"
        source.faults.append(Fault(str(path), f"the archive holds no map: {held}", action))
        return
    if others:
        what = "these files of the archive hold" if len(others) > 1 else "this file of the archive holds"
        source.notes.add(
            f"Not read, because {what} no places in a form that is known: {listed(map(repr, others), 50)}."
        )
    for entry, inner in read:
        _add_layer(entry, inner, source, has_siblings=len(read) > 1)


def _is_blank(entry: Unpacked, inner: Source) -> bool:
    """Whether a file of an archive turned out to hold no places: a remark, a table of water samples, pictures."""
    if inner.features:
        return False
    if not entry.is_map:
        return True
    return bool(inner.faults) and all(
        fault.message.startswith(("no longitude and latitude columns", "the archive holds no map"))
        and "add a column zone" not in fault.action
        for fault in inner.faults
    )


def _add_layer(entry: Unpacked, inner: Source, source: Source, *, has_siblings: bool) -> None:
    """Add what a file of an archive holds."""
    stem = Path(entry.member).stem
    if has_siblings:
        for zone in inner.open_zones:
            zone.place = f"{entry.member}, {zone.place}"
        for feature in inner.features:
            feature.place = f"{entry.member}, {feature.place}"
            feature.property_place = f"{entry.member}, {feature.property_place}"
            feature.folders = feature.folders if stem in feature.folders else (stem, *feature.folders)
        source.layers.append(stem)
    elif inner.name != entry.path.stem:
        source.name = inner.name
    source.features.extend(inner.features)
    source.open_zones.extend(inner.open_zones)
    source.layers.extend(inner.layers)
    for fault in inner.faults:
        place = fault.path.replace(str(entry.path.resolve()), entry.member).replace(str(entry.path), entry.member)
        source.faults.append(Fault(place, fault.message, fault.action))
    for sentence in inner.notes.sentences():
        source.notes.add(sentence)


def _keep_layers(layers: Sequence[str], source: Source) -> None:
    """Keep the features of the layers that were asked for."""
    found = [*source.layers, *(folder for feature in source.features for folder in feature.folders)]
    fault = layer_fault(layers, found)
    if fault is not None and not (source.faults and not source.features):
        source.faults.append(fault)
        return
    wanted = {layer.casefold() for layer in layers}
    source.features = [
        feature for feature in source.features if any(folder.casefold() in wanted for folder in feature.folders)
    ]
