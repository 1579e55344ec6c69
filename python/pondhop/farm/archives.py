"""Archives as farms come in them: what they hold is unpacked into a folder, within limits, and read from there."""

from __future__ import annotations

import shutil
import zipfile
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from pondhop.errors import Fault
from pondhop.farm.features import Source, listed

MAX_UNPACKED_BYTES = 250_000_000
"""What an archive may hold; a farm of 10,000 ponds takes a hundredth of it."""

MAX_RATIO = 100
"""How many times larger than the archive its content may be; maps and tables shrink to a tenth, not to a hundredth."""

FREE_BYTES = 10_000_000
"""Content that is unpacked whatever its ratio: it does no harm."""

_ENTRY_SUFFIXES = (".kml", ".geojson", ".json", ".gpx", ".shp", ".gpkg", ".fgb", ".sqlite", ".tab", ".mif", ".gml")
_TABLE_SUFFIXES = (".csv", ".tsv", ".xlsx", ".ods")
_SIBLING_SUFFIXES = (".shx", ".dbf", ".prj", ".cpg", ".dat", ".map", ".id", ".ind", ".mid", ".xsd")


@dataclass(frozen=True)
class Unpacked:
    """A file that can be read, as it was in the archive and as it lies unpacked."""

    member: str
    path: Path


def is_spreadsheet(path: Path) -> bool:
    """Whether an archive is a workbook of Excel or LibreOffice, whatever its name ends in."""
    try:
        with zipfile.ZipFile(path) as archive:
            names = set(archive.namelist())
    except (zipfile.BadZipFile, ValueError, NotImplementedError):
        return False
    return "xl/workbook.xml" in names or {"content.xml", "mimetype"} <= names


def check_archive(path: Path, members: list[zipfile.ZipInfo] | None = None) -> Fault | None:
    """The fault of an archive that would fill memory or disk, or holds what no key is given for."""
    try:
        if members is None:
            with zipfile.ZipFile(path) as archive:
                members = archive.infolist()
    except (zipfile.BadZipFile, ValueError, NotImplementedError) as error:
        return Fault(str(path), f"not a file of a known format: {error}", "export the farm again")
    unpacked = sum(member.file_size for member in members)
    limit = min(MAX_UNPACKED_BYTES, max(FREE_BYTES, MAX_RATIO * path.stat().st_size))
    if unpacked > limit:
        message = f"the archive would unpack to {unpacked / 1e6:.0f} MB, more than {limit / 1e6:.0f} MB"
        return Fault(str(path), message, "unpack it yourself, and export the ponds alone")
    if any(member.flag_bits & 1 for member in members):
        return Fault(str(path), "the archive is locked with a password", "unpack it, and name the file in it")
    return None


def unpack(path: Path, folder: Path, source: Source) -> list[Unpacked]:
    """Unpack what can be read, and return it in the order of the archive; nothing, with a fault, where nothing can.

    Folders of the archive become folders of our own naming, so that no member is written elsewhere.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            members = [member for member in archive.infolist() if _is_wanted(member)]
            fault = check_archive(path, members)
            if fault is not None:
                source.faults.append(fault)
                return []
            folders: dict[PurePosixPath, Path] = {}
            entries: list[Unpacked] = []
            for member in members:
                name = PurePosixPath(member.filename.replace("\\", "/"))
                inside = folders.setdefault(name.parent, _folder_for(name.parent, folder, len(folders)))
                inside.mkdir(exist_ok=True)
                target = inside / name.name
                with archive.open(member) as packed, target.open("wb") as unpacked:
                    shutil.copyfileobj(packed, unpacked)
                if name.parent.suffix.lower() == ".gdb":
                    target = inside
                if all(entry.path != target for entry in entries):
                    entries.append(Unpacked(str(name if target != inside else name.parent), target))
            everything = archive.namelist()
    except (zipfile.BadZipFile, zipfile.LargeZipFile, ValueError, NotImplementedError, RuntimeError, EOFError) as error:
        source.faults.append(Fault(str(path), f"not a file of a known format: {error}", "export the farm again"))
        return []
    found = [entry for entry in entries if entry.path.suffix.lower() in (*_ENTRY_SUFFIXES, ".gdb")]
    found = found or [entry for entry in entries if entry.path.suffix.lower() in _TABLE_SUFFIXES]
    if not found:
        held = listed([repr(name) for name in everything]) or "nothing"
        action = "name the file with the ponds; an archive may hold KML, shapefiles, GeoJSON and tables"
        source.faults.append(Fault(str(path), f"the archive holds no map: {held}", action))
    return found


def _is_wanted(member: zipfile.ZipInfo) -> bool:
    name = PurePosixPath(member.filename.replace("\\", "/"))
    if member.is_dir() or "__MACOSX" in name.parts or name.name.startswith("."):
        return False
    is_known = name.suffix.lower() in (*_ENTRY_SUFFIXES, *_TABLE_SUFFIXES, *_SIBLING_SUFFIXES)
    return is_known or name.parent.suffix.lower() == ".gdb"


def _folder_for(inside: PurePosixPath, folder: Path, number: int) -> Path:
    return folder / f"{number}{'.gdb' if inside.suffix.lower() == '.gdb' else ''}"
