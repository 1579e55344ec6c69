"""Formats that GDAL reads: Shapefile, GeoPackage, FlatGeobuf, file geodatabase, MapInfo, GML; through pyogrio.

Which driver GDAL takes is up to the content of a file, and some drivers open other files or ask the web. So a file is
handed over only if its first bytes are those of a format on the list.
"""

from __future__ import annotations

import math
import shutil
import stat
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from itertools import takewhile
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from pondhop.errors import Fault
from pondhop.farm.encodings import FieldText, guess_of_fields
from pondhop.farm.features import Feature, Geometry, Source, listed
from pondhop.farm.projections import reproject
from pondhop.places import LonLat

FORMATS = "GeoJSON, KML, KMZ, GPX, Shapefile, GeoPackage, Excel, or CSV with columns lon and lat"

_MAGIC = {
    b"\x00\x00\x27\x0a": "ESRI Shapefile",
    b"SQLite format 3\x00": "GPKG",
    b"fgb\x03": "FlatGeobuf",
}
_SHEETS_AS_TEXT = {
    "OGR_XLSX_HEADERS": "DISABLE",
    "OGR_XLSX_FIELD_TYPES": "STRING",
    "OGR_ODS_HEADERS": "DISABLE",
    "OGR_ODS_FIELD_TYPES": "STRING",
}
"""Else GDAL guesses a heading, and a type for each column from its first cells. Options of one reading it heeds for the
first sheet alone."""

MAX_DBF_HEADER = 65_536
"""Bytes of the head of a shapefile's table, whose length is a number of 16 bits."""

_FORBIDDEN = (b"<OGRVRT", b"<VRTDataset", b"gdal_streamed_alg")
"""Marks of drivers that read other files, which GDAL looks for anywhere in the head of a file."""


def is_gis_file(path: Path, head: bytes) -> bool:
    """Whether a file is of a format on the list, by its first bytes."""
    if any(mark in head for mark in _FORBIDDEN):
        return False
    if any(head.startswith(magic) for magic in _MAGIC):
        return True
    first_lines = head[:2000].lower()
    match path.suffix.lower():
        case ".tab":
            # Other kinds of tables name files elsewhere.
            return first_lines.startswith(b"!table") and b"type native" in first_lines
        case ".mif":
            return first_lines.startswith(b"version")
        case ".gml":
            return b"opengis.net/gml" in first_lines
    return False


def read_gis(path: Path, source: Source, layers: Sequence[str] = ()) -> None:
    """Read all layers with geometry, or those that were asked for; GDAL's own warnings become notes."""
    import pyogrio

    fault = _sibling_fault(path)
    if fault is not None:
        source.faults.append(fault)
        return
    pyogrio.set_gdal_config_options({"GML_DOWNLOAD_SCHEMA": "NO", "GML_SKIP_RESOLVE_ELEMS": "ALL"})
    with warnings.catch_warnings(record=True) as caught, TemporaryDirectory() as folder:
        warnings.simplefilter("always")
        place = str(path)
        # Beside a GML file GDAL would write one of its own.
        opened = Path(shutil.copy(path, folder)) if path.suffix.lower() == ".gml" else path.resolve()
        try:
            found = [str(name) for name, kind in pyogrio.list_layers(opened) if kind is not None]
            source.layers.extend(found)
            for layer in found:
                if not layers or layer.casefold() in {wanted.casefold() for wanted in layers}:
                    _read_layer(opened, layer, len(found) > 1, source)
        except (pyogrio.errors.DataSourceError, pyogrio.errors.DataLayerError) as error:
            detail = str(error).partition(";")[0].replace(str(opened), path.name)
            source.faults.append(
                Fault(place, f"not a file of a known format: {detail}", f"export the farm as {FORMATS}")
            )
        except (pyogrio.errors.FeatureError, pyogrio.errors.GeometryError, RuntimeError) as error:
            source.faults.append(Fault(place, f"damaged: {error}", "export the farm again"))
    for warning in caught:
        source.notes.add(f"While reading: {str(warning.message).replace(str(opened), path.name)}", kind="while reading")


def _sibling_fault(path: Path) -> Fault | None:
    """The fault of a format of several files whose other files are missing, or are no files."""
    siblings = [other for other in path.parent.iterdir() if other.stem.casefold() == path.stem.casefold()]
    if path.is_dir():
        siblings = list(path.iterdir())
    for other in siblings:
        if not (stat.S_ISREG(other.stat().st_mode) or other.is_dir()):
            return Fault(str(other), "this is no regular file", "copy it as a file")
    if path.suffix.lower() != ".shp":
        return None
    present = {other.suffix.lower() for other in siblings}
    missing = [suffix for suffix in (".shx", ".dbf", ".prj") if suffix not in present]
    if not {".shx", ".dbf"} & set(missing):
        return None
    names = ", ".join([f"{path.stem}{missing[0]}", *missing[1:]])
    message = f"{names} {'is' if len(missing) == 1 else 'are'} missing"
    return Fault(
        str(path), message, f"a shapefile is several files: copy all files named {path.stem}, or send them zipped"
    )


def _read_layer(path: Path, layer: str, has_siblings: bool, source: Source) -> None:
    import pyogrio
    import shapely

    read: Callable[..., Any] = pyogrio.raw.read
    options = {"layer": layer, "return_fids": True, "force_2d": True}
    try:
        meta, fids, wkbs, columns = read(path, **options)
    except UnicodeDecodeError:
        meta, fids, wkbs, columns = read(path, **options, encoding="cp1252")
        source.notes.add("Attributes are not in the encoding that the file names; read as Windows Latin (cp1252).")
    if path.suffix.lower() == ".shp" and not _names_encoding(path):
        written = read(path, **options, encoding="ISO-8859-1")[3]
        columns = _guessed_columns(written, columns, _field_widths(path), source)
    names = [str(name) for name in meta["fields"]]
    prefix = f"layer {layer!r}, feature " if has_siblings else "feature "
    features = []
    for row, shape in enumerate(shapely.from_wkb(wkbs, on_invalid="ignore")):
        values = {name: _scalar(column[row]) for name, column in zip(names, columns, strict=True)}
        geometry = Geometry()
        place = f"{prefix}{fids[row]}"
        if shape is not None and not shape.is_empty:
            add_shape(shape, geometry)
        if not all(math.isfinite(lon) and math.isfinite(lat) for lon, lat in geometry.positions()):
            source.faults.append(Fault(place, "a coordinate is NaN or infinite", "draw the feature again"))
            continue
        features.append(Feature(place, f"{place}, field {{}}", values, geometry, folders=(layer,)))
    source.features.extend(features)
    if meta["crs"] is not None:
        reproject(meta["crs"], f"layer {layer!r}", features, source)
    elif features:
        source.notes.add("The file names no coordinate system; WGS84 (EPSG:4326) is assumed.")


def _names_encoding(path: Path) -> bool:
    """Whether a file beside a shapefile says how its texts are encoded; Latin is what programs say that do not know."""
    said = [
        other.read_text("latin-1").strip().casefold()
        for other in path.parent.iterdir()
        if other.stem.casefold() == path.stem.casefold() and other.suffix.lower() == ".cpg"
    ]
    return bool(said) and said[0] not in {
        "",
        "iso-8859-1",
        "iso 8859-1",
        "88591",
        "latin1",
        "1252",
        "cp1252",
        "ansi 1252",
    }


def _field_widths(path: Path) -> list[int]:
    """The bytes that each field of a shapefile's table holds at most (dBASE III: 32 bytes a field from byte 32 on)."""
    siblings = (other for other in path.parent.iterdir() if other.suffix.lower() == ".dbf")
    table = next((other for other in siblings if other.stem.casefold() == path.stem.casefold()), None)
    if table is None:
        return []
    with table.open("rb") as file:
        header = file.read(MAX_DBF_HEADER)
    starts = takewhile(lambda start: header[start : start + 1] not in {b"", b"\r"}, range(32, len(header) - 16, 32))
    return [header[start + 16] for start in starts]


def _guessed_columns(
    written: Sequence[Any], read: Sequence[Any], widths: Sequence[int], source: Source
) -> Sequence[Any]:
    """The columns of a shapefile in the encoding that its texts are in; as GDAL read them where nothing tells.

    Parameters
    ----------
    written
        The columns, their bytes as Latin letters.
    read
        The columns as GDAL understood them.
    widths
        The bytes that a field of each column holds at most.
    source
        Gets a note where the encoding was guessed.
    """

    def field_text(text: str, width: int) -> FieldText:
        content = text.encode("latin-1")
        return FieldText(content, len(content) >= width)

    of_texts = {
        index: width
        for index, (column, width) in enumerate(zip(written, widths, strict=False))
        if column.dtype == object
    }
    texts = [
        field_text(value, width)
        for index, width in of_texts.items()
        for value in written[index]
        if isinstance(value, str)
    ]
    guess = guess_of_fields(texts)
    if guess is None:
        return read
    codec, label = guess
    source.notes.add(
        f"The shapefile does not say how its texts are encoded; they were read as {label}. If names look wrong, "
        "export it as GeoPackage."
    )

    def decoded(value: object, width: int) -> object:
        if not isinstance(value, str):
            return value
        text = field_text(value, width)
        whole = text.decoded(codec)
        return text.content.decode(codec, errors="replace") if whole is None else whole

    return [
        [decoded(value, of_texts[index]) for value in written[index]] if index in of_texts else column
        for index, column in enumerate(read)
    ]


def _scalar(value: Any) -> object:
    """A plain Python value; GDAL's missing numbers are NaN."""
    plain = value.tolist() if hasattr(value, "tolist") else value
    return None if isinstance(plain, float) and math.isnan(plain) else plain


def add_shape(shape: Any, geometry: Geometry) -> None:
    """Sort a shapely geometry's parts by what they draw."""
    for part in _single_parts(shape):
        match part.geom_type:
            case "Point":
                geometry.points.append((part.x, part.y))
            case "Polygon":
                geometry.polygons.append([_lonlats(ring) for ring in (part.exterior, *part.interiors)])
            case _:
                geometry.lines.append(_lonlats(part))


def _single_parts(shape: Any) -> Iterator[Any]:
    if not hasattr(shape, "geoms"):
        yield shape
        return
    for part in shape.geoms:
        yield from _single_parts(part)


def _lonlats(line: Any) -> list[LonLat]:
    return [(float(position[0]), float(position[1])) for position in line.coords]


@contextmanager
def _gdal_configured(options: dict[str, str]) -> Iterator[None]:
    """Set options of GDAL for a while."""
    import pyogrio

    before = {name: pyogrio.get_gdal_config_option(name) for name in options}
    pyogrio.set_gdal_config_options(options)
    try:
        yield
    finally:
        pyogrio.set_gdal_config_options(before)


def read_sheets(path: Path, source: Source) -> dict[str, list[list[str]]]:
    """The sheets of a workbook as rows of text, as they stand."""
    import pyogrio

    read: Callable[..., Any] = pyogrio.raw.read
    sheets: dict[str, list[list[str]]] = {}
    with warnings.catch_warnings(), _gdal_configured(_SHEETS_AS_TEXT):
        # That a sheet has no geometry is no news.
        warnings.simplefilter("ignore")
        try:
            for name in [str(name) for name, _ in pyogrio.list_layers(path)]:
                _, _, _, columns = read(path, layer=name, read_geometry=False)
                cells = [["" if value is None else str(value) for value in column] for column in columns]
                sheets[name] = [list(row) for row in zip(*cells, strict=True)]
        except (pyogrio.errors.DataSourceError, pyogrio.errors.DataLayerError, RuntimeError) as error:
            message = f"the workbook cannot be read: {str(error).partition(';')[0]}"
            source.faults.append(Fault(str(path), message, "save the sheet with the ponds as CSV"))
    if not sheets and not source.faults:
        source.faults.append(Fault(str(path), "the workbook has no sheet", "save the sheet with the ponds as CSV"))
    return sheets


def layer_fault(wanted: Sequence[str], found: Sequence[str]) -> Fault | None:
    """The fault of a layer that was asked for and is not there."""
    known = {name.casefold() for name in found}
    absent = [name for name in wanted if name.casefold() not in known]
    if not absent:
        return None
    action = (
        f"choose among {listed(map(repr, dict.fromkeys(found)), 10)}"
        if found
        else "this file has no layers: leave --layer out"
    )
    return Fault("--layer", f"there is no layer {', '.join(map(repr, absent))}", action)
