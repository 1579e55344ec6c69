"""What the tags of OpenStreetMap say of a feature, as its many programs export them."""

from __future__ import annotations

import re
from collections.abc import Iterator

from pondhop.farm.features import Feature, is_blank
from pondhop.farm.vocabulary import perhaps_pond_tags, tag_meanings, tags_of_anything_else
from pondhop.farm.words import Meaning, meanings

OSM_KEYS = tuple(
    dict.fromkeys((*tags_of_anything_else(), *(key for key, _ in (*tag_meanings(), *perhaps_pond_tags()))))
)
"""Tags that say what a feature is, not what it is called."""

_ID_KEYS = ("@id", "osm_id", "osm_way_id", "full_id")
_LAND_KEYS = ("natural", "landuse", "waterway")
_NO = frozenset({"no", "false", "0", "none"})
_YES = frozenset({"yes", "true", "1"})


def tells_anything(key: str, value: str) -> bool:
    """Whether a property is a tag whose value is known."""
    tag = (key.lower(), value.strip().lower())
    return tag in tag_meanings() or tag in perhaps_pond_tags()


def has_pond_tag(feature: Feature) -> bool:
    """Whether a tag says that a feature is a pond beyond doubt; ``natural=water`` may be any water."""
    tags = _tags(feature)
    return any(
        tag_meanings().get((key, value.lower())) == "pond" for key, value in tags.items() if (key, value) != _ANY_WATER
    )


def said_by_tags(feature: Feature, *, has_sure_ponds: bool) -> Iterator[tuple[Meaning, str]]:
    """What tags say, the most telling first, with the text of each; and columns that are a question: ``no_fly: yes``.

    Parameters
    ----------
    feature
        With its tags as properties, or as text in a column of them.
    has_sure_ponds
        Whether other features of the file are tagged as ponds: then a lake beside them is asked for.
    """
    tags = _tags(feature)
    is_osm = any(key in feature.properties for key in _ID_KEYS)
    is_map = is_osm or any(key in tags for key in _LAND_KEYS)
    for key, value in sorted(tags.items(), key=_rank):
        text = f"{key}={value[:40]}"
        meaning = _meaning(key, value.lower(), is_osm=is_osm, is_map=is_map, has_sure_ponds=has_sure_ponds)
        if meaning is not None and not tags.keys() & _REFINED_BY.get((key, value), set()):
            yield meaning, text


_ANY_WATER = ("natural", "water")
_REFINED_BY = {_ANY_WATER: {"water", "waterway"}, ("landuse", "basin"): {"basin"}, ("water", "basin"): {"basin"}}
"""Tags that say nothing where another one says what kind of water it is."""


def _rank(tag: tuple[str, str]) -> int:
    """What kind of water it is tells more than the land around it, and a fence around a pond nothing of the pond."""
    if tag[0] in {"water", "waterway"}:
        return 0
    return 2 if tag == _ANY_WATER else 3 if tag[0] == "barrier" else 1


def _meaning(key: str, value: str, *, is_osm: bool, is_map: bool, has_sure_ponds: bool) -> Meaning | None:
    if (key, value) in perhaps_pond_tags():
        return Meaning.UNCERTAIN if has_sure_ponds else Meaning.POND
    name = tag_meanings().get((key, value))
    if name is not None:
        meaning = Meaning[name.upper()]
        # A table may say in its column "water" where the water of a pond comes from.
        return Meaning.UNCERTAIN if key == "water" and meaning is Meaning.OTHER and not is_map else meaning
    if key in tags_of_anything_else() and (is_osm or value == "yes"):
        return Meaning.OTHER
    if key == "water" and is_map:
        return Meaning.UNCERTAIN
    return Meaning.NO_FLY if value in _YES and meanings(key) == {Meaning.NO_FLY} else None


def _tags(feature: Feature) -> dict[str, str]:
    """The tags of a feature that say anything, also those that GDAL writes into one column: ``"water"=>"river"``."""
    tags: dict[str, str] = {}
    for key, value in feature.properties.items():
        if key.lower() in {"other_tags", "all_tags", "tags", "hstore"}:
            continue
        tags[key if key.startswith("@") else key.lower()] = "" if is_blank(value) else str(value).strip()
    for key in ("other_tags", "all_tags", "tags", "hstore"):
        packed = feature.find(key)
        if packed is not None:
            given = packed[1] if isinstance(packed[1], dict) else dict(_PACKED_TAG.findall(str(packed[1])))
            for own_key, value in given.items():
                tags[own_key] = tags.get(own_key) or str(value)
    return {key: value for key, value in tags.items() if value and value.lower() not in _NO}


_PACKED_TAG = re.compile(r'"([^"]+)"\s*(?:=>|:)\s*"([^"]*)"')
