"""Archives as farms come in them: what they hold is unpacked into a folder, within limits, and read from there."""

from __future__ import annotations

import shutil
import zipfile
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from pondhop.errors import Fault
from pondhop.farm.features import Source

MAX_UNPACKED_BYTES = 250_000_000
"""What an archive may hold; a farm of 10,000 ponds takes a hundredth of it."""

MAX_RATIO = 100
"""How many times larger than the archive its content may be; maps and tables shrink to a tenth, not to a hundredth."""

FREE_BYTES = 10_000_000
"""Content that is unpacked whatever its ratio: it does no harm."""

MAX_DEPTH = 3
"""How deep archives may lie in archives."""

_MAP_SUFFIXES = (".kml", ".geojson", ".json", ".gpx", ".shp", ".gpkg", ".fgb", ".sqlite", ".tab", ".mif", ".gml")
_TABLE_SUFFIXES = (".csv", ".tsv", ".xlsx", ".ods")
_ARCHIVE_SUFFIXES = (".zip", ".kmz")
_COMPANIONS = {
    ".shp": (".shx", ".dbf", ".prj", ".cpg", ".sbn", ".sbx", ".qix", ".qpj", ".qml", ".qmd", ".shp.xml"),
    ".tab": (".dat", ".map", ".id", ".ind"),
    ".mif": (".mid",),
    ".gml": (".xsd", ".gfs"),
}
"""Files that belong to another one of the same name."""

_PICTURES = (".png", ".jpg", ".jpeg", ".gif", ".bmp", ".svg", ".webp", ".ico", ".tif", ".tiff", ".heic")
_NO_MAPS = (*_PICTURES, ".pdf", ".doc", ".docx", ".mp4", ".mov", ".mp3", ".wav", ".css", ".js", ".exe", ".html", ".htm")
"""What is not even looked into."""


@dataclass
class Room:
    """What archives in archives may still take, all of them together."""

    bytes_left: int = MAX_UNPACKED_BYTES
    depth: int = 0


@dataclass(frozen=True)
class Unpacked:
    """A file that can be read, as it was in the archive and as it lies unpacked.

    Attributes
    ----------
    member
        Its name with the folders of the archive.
    path
        Where it lies now.
    is_map
        Whether its ending says that it holds a map, a table or an archive; of others only the content tells.
    """

    member: str
    path: Path
    is_map: bool = True


def is_spreadsheet(path: Path) -> bool:
    """Whether an archive is a workbook of Excel or LibreOffice, whatever its name ends in."""
    try:
        with zipfile.ZipFile(path) as archive:
            names = set(archive.namelist())
    except (zipfile.BadZipFile, ValueError, NotImplementedError):
        return False
    return "xl/workbook.xml" in names or {"content.xml", "mimetype"} <= names


def check_archive(path: Path, members: list[zipfile.ZipInfo] | None = None, room: Room | None = None) -> Fault | None:
    """The fault of an archive that would fill memory or disk, or holds what no key is given for."""
    try:
        if members is None:
            with zipfile.ZipFile(path) as archive:
                members = archive.infolist()
    except (zipfile.BadZipFile, ValueError, NotImplementedError) as error:
        return Fault(str(path), f"not a file of a known format: {error}", "export the farm again")
    unpacked = sum(member.file_size for member in members)
    limit = min(room.bytes_left if room else MAX_UNPACKED_BYTES, max(FREE_BYTES, MAX_RATIO * path.stat().st_size))
    if unpacked > limit:
        message = f"the archive would unpack to {unpacked / 1e6:.0f} MB, more than {limit / 1e6:.0f} MB"
        return Fault(str(path), message, "unpack it yourself, and export the ponds alone")
    if any(member.flag_bits & 1 for member in members):
        return Fault(str(path), "the archive is locked with a password", "unpack it, and name the file in it")
    return None


def unpack(path: Path, folder: Path, source: Source, room: Room) -> tuple[list[Unpacked], list[str]]:
    """Unpack what may be read, and return it in the order of the archive, and the names of all other files in it.

    Folders of the archive become folders of our own naming, so that no member is written elsewhere.
    """
    entries: list[Unpacked] = []
    others: list[str] = []
    try:
        with zipfile.ZipFile(path) as archive:
            members: list[zipfile.ZipInfo] = []
            names = {_name(member) for member in archive.infolist()}
            for member in archive.infolist():
                if member.is_dir() or _is_litter(_name(member)):
                    continue
                if _may_be_read(member, room) or _is_companion(_name(member), names):
                    members.append(member)
                else:
                    others.append(str(_name(member)))
            fault = check_archive(path, members, room)
            if fault is not None:
                source.faults.append(fault)
                return [], []
            room.bytes_left -= sum(member.file_size for member in members)
            folders: dict[PurePosixPath, Path] = {}
            for member in members:
                name = _name(member)
                inside = folders.setdefault(name.parent, _folder_for(name.parent, folder, len(folders)))
                inside.mkdir(exist_ok=True)
                target = inside / name.name
                if target.exists():
                    others.append(str(name))
                    continue
                with archive.open(member) as packed, target.open("wb") as unpacked:
                    shutil.copyfileobj(packed, unpacked)
                if name.parent.suffix.lower() == ".gdb":
                    if all(entry.path != inside for entry in entries):
                        entries.append(Unpacked(str(name.parent), inside))
                elif not _is_companion(name, names):
                    entries.append(Unpacked(str(name), target, _is_map(name)))
    except (zipfile.BadZipFile, zipfile.LargeZipFile, ValueError, NotImplementedError, RuntimeError, EOFError) as error:
        source.faults.append(Fault(str(path), f"not a file of a known format: {error}", "export the farm again"))
        return [], []
    maps = [entry.path.read_bytes() for entry in entries if entry.path.suffix.lower() == ".kml"]
    return entries, [name for name in others if not _is_drawn(name, maps)]


def _name(member: zipfile.ZipInfo) -> PurePosixPath:
    return PurePosixPath(member.filename.replace("\\", "/"))


def _is_litter(name: PurePosixPath) -> bool:
    """Whether it is what file managers leave behind."""
    return "__MACOSX" in name.parts or name.name.startswith("._") or name.name in {".DS_Store", "Thumbs.db"}


def _is_map(name: PurePosixPath) -> bool:
    return name.suffix.lower() in (*_MAP_SUFFIXES, *_TABLE_SUFFIXES, *_ARCHIVE_SUFFIXES)


def _may_be_read(member: zipfile.ZipInfo, room: Room) -> bool:
    """Whether a member holds a map, or may do so; of other files the small ones are tried."""
    name = _name(member)
    if name.name.startswith("."):
        return False
    if name.suffix.lower() in _ARCHIVE_SUFFIXES:
        return room.depth < MAX_DEPTH
    if _is_map(name) or name.parent.suffix.lower() == ".gdb":
        return True
    return name.suffix.lower() not in _NO_MAPS and 0 < member.file_size <= FREE_BYTES and not member.flag_bits & 1


def _is_companion(name: PurePosixPath, names: set[PurePosixPath]) -> bool:
    """Whether a file is part of another one in the archive, as a .dbf is of its .shp."""
    beside = {other.name.casefold() for other in names if other.parent == name.parent}
    plain = name.name.casefold()
    return any(
        plain.endswith(suffix) and plain.removesuffix(suffix) + of in beside
        for of, suffixes in _COMPANIONS.items()
        for suffix in suffixes
    )


def _is_drawn(name: str, maps: list[bytes]) -> bool:
    """Whether it is a picture or an icon that a map in the archive shows."""
    path = PurePosixPath(name)
    return path.suffix.lower() in _PICTURES and any(path.name.encode() in content for content in maps)


def _folder_for(inside: PurePosixPath, folder: Path, number: int) -> Path:
    return folder / f"{number}{'.gdb' if inside.suffix.lower() == '.gdb' else ''}"
