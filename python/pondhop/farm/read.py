"""Farm files of any format made into a `Farm`, or all that is wrong with them."""

from __future__ import annotations

import difflib
import gc
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from pondhop.errors import Fault, InvalidInput
from pondhop.farm import checks
from pondhop.farm.features import Feature, Geometry, Source, normal_name, number_of, text_of
from pondhop.farm.formats import read_source
from pondhop.farm.model import Farm, Pond
from pondhop.places import Area, LonLat, distance_m

ROLES = ("pond", "depot", "station", "no_fly", "fence")
"""What a feature can be, in the property ``role``; the first is the default."""

MAX_SAMPLING_OFFSET_M = 1_000.0
"""A sampling point further outside its pond than this is a typing error, not a shore."""

MAX_FAULTS = 200
"""Faults that are listed one by one; more are counted."""


def read_farm(path: str | Path, *, depot: LonLat | None = None) -> Farm:
    """Read a farm from a file; docs/how-to/farm-files.md shows every format and explains every fault.

    Parameters
    ----------
    path
        GeoJSON, KML, KMZ, Shapefile, GeoPackage, anything else that GDAL reads, or a CSV table.
    depot
        Longitude and latitude in degrees; replaces the depot of the file. In a file of several farms it tells which one
        is meant.

    Returns
    -------
    Farm
        With at least one pond, and a note for everything that was assumed, converted or left out.

    Raises
    ------
    InvalidInput
        With every fault of the file: its place, what is wrong, what to do.
    """
    with _collection_paused():
        source = read_source(Path(path))
        reader = _FarmReader(source)
        reader.read_features(depot)
        reader.check_ponds()
        if depot is not None:
            reader.set_depot(depot)
        reader.check_distances(is_depot_given=depot is not None)
    if reader.faults or reader.depot is None:
        raise InvalidInput(_limited(reader.faults))
    return Farm(
        source.name,
        tuple(reader.ponds),
        reader.depot,
        tuple(reader.stations),
        tuple(reader.no_fly),
        tuple(reader.fences),
        tuple(source.notes),
    )


@contextmanager
def _collection_paused() -> Iterator[None]:
    """Spare the garbage collector the millions of small objects of a large file, none of which is garbage.

    It would walk through all of them again and again: 50 MB take 11 s of processor time without it and 25 s with it.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def _limited(faults: Sequence[Fault]) -> list[Fault]:
    if len(faults) <= MAX_FAULTS:
        return list(faults)
    hidden = len(faults) - MAX_FAULTS
    return [*faults[:MAX_FAULTS], Fault("file", f"{hidden} more faults", "correct the ones above first")]


@dataclass
class _FarmReader:
    """What has been made of a source so far; every step adds to the source's faults and notes."""

    source: Source
    ponds: list[Pond] = field(default_factory=list)
    pond_features: list[Feature] = field(default_factory=list)
    depot: LonLat | None = None
    has_depot_feature: bool = False
    stations: list[LonLat] = field(default_factory=list)
    no_fly: list[Area] = field(default_factory=list)
    fences: list[Area] = field(default_factory=list)
    offsets_m: dict[str, float] = field(default_factory=dict)

    @property
    def faults(self) -> list[Fault]:
        return self.source.faults

    def read_features(self, given_depot: LonLat | None) -> None:
        """Sort features by role and check each for itself."""
        features = self.source.features
        if not features and not self.faults:
            action = "export the layer that holds the ponds"
            self.faults.append(Fault("file", "there is no feature in this file", action))
        misplaced = checks.check_coordinates(features)
        self.faults.extend(misplaced)
        misplaced_places = {fault.path for fault in misplaced}
        all_misplaced = len(misplaced) == 1 and misplaced[0].path.startswith("all ")
        first_depot: Feature | None = None
        for feature in features:
            role = self._role(feature)
            self.has_depot_feature |= role == "depot"
            if role is None or all_misplaced or feature.place in misplaced_places:
                continue
            if role == "pond":
                self._read_pond(feature)
            elif role in {"no_fly", "fence"}:
                areas = self.no_fly if role == "no_fly" else self.fences
                areas.extend(self._areas(feature, f"a {role} area"))
            else:
                point = self._point(feature, role)
                if point is None:
                    continue
                if role == "station":
                    self.stations.append(point)
                elif first_depot is None:
                    first_depot = feature
                    self.depot = point
                elif given_depot is None:
                    message = f"a second depot; the first is {first_depot.place}"
                    self.faults.append(Fault(feature.place, message, "keep one, or pass --depot LON,LAT"))
        if not self.ponds and features and not self.faults:
            self.faults.append(Fault("file", "there is no pond in this file", "add the ponds as polygons or points"))

    def _role(self, feature: Feature) -> str | None:
        roles = {normal_name(role): role for role in ROLES}
        found = feature.find("role")
        if found is not None:
            key, value = found
            role = roles.get(normal_name(str(value)))
            if role is None:
                close = difflib.get_close_matches(normal_name(str(value)), roles, n=1)
                hint = f"did you mean {roles[close[0]]!r}?" if close else f"use one of {', '.join(ROLES)}"
                place = feature.property_place.format(key)
                self.faults.append(Fault(place, f"{str(value)[:40]!r} is no role", hint))
            return role
        # Google Earth lets people name things and folders, not give them properties.
        name = feature.find("name")
        for hint in (str(name[1]) if name else "", feature.layer or ""):
            role = roles.get(normal_name(hint))
            if role is not None and role != "pond":
                self.source.notes.append(f"{feature.place}: taken as {role}, because it is called {hint.strip()!r}.")
                return role
        return "pond"

    def _read_pond(self, feature: Feature) -> None:
        num_faults = len(self.faults)
        geometry = feature.geometry
        sampling_point = self._sampling_point(feature)
        service_s = self._service_s(feature)
        outline: Area = ()
        if geometry.polygons or geometry.lines:
            areas = self._areas(feature, "a pond")
            if areas:
                outline = max(areas, key=checks.area_deg2) if len(areas) > 1 else areas[0]
                extent_m = checks.extent_m(outline)
                if extent_m > checks.MAX_GAP_M:
                    message = f"the pond is {extent_m / 1000:.0f} km across"
                    self.faults.append(Fault(feature.place, message, "look for a mistyped corner"))
            if len(areas) > 1:
                self.source.notes.append(f"{feature.place}: the pond has {len(areas)} parts; the largest is sampled.")
        elif len(geometry.points) == 1:
            sampling_point = sampling_point or geometry.points[0]
        else:
            held = f"{len(geometry.points)} points" if geometry.points else "no geometry"
            self.faults.append(
                Fault(feature.place, f"the feature has {held}", "draw each pond as one polygon or point")
            )
        if len(self.faults) > num_faults:
            return
        if outline and sampling_point is not None:
            offset_m = checks.distance_to_outline_m(sampling_point, outline)
            if offset_m > MAX_SAMPLING_OFFSET_M:
                place = feature.property_place.format("sampling_point")
                message = f"the sampling point lies {offset_m / 1000:.1f} km outside the pond"
                self.faults.append(Fault(place, message, "correct it, or remove it to sample the middle"))
                return
            if offset_m > 0.0:
                self.offsets_m[feature.place] = offset_m
        pond_id = self._id(feature)
        self.ponds.append(Pond(pond_id, sampling_point or checks.point_inside(outline), outline, service_s))
        self.pond_features.append(feature)

    def _id(self, feature: Feature) -> str:
        found = feature.find("id", "pond_id", "pond", "pond_name", "pond_no", "name", "label", "fid")
        if found is not None:
            return text_of(found[1])
        return feature.own_id or ""

    def _service_s(self, feature: Feature) -> float | None:
        found = feature.find("service_s")
        if found is None:
            return None
        number = number_of(found[1])
        if number is None or number < 0.0:
            place = feature.property_place.format(found[0])
            message = f"{str(found[1])[:40]!r} is no time on station"
            self.faults.append(Fault(place, message, "give seconds as a number, 0 or more"))
        return number

    def _sampling_point(self, feature: Feature) -> LonLat | None:
        found = feature.find("sampling_point")
        if found is None:
            return None
        key, value = found
        # GIS formats have no lists in their tables, so the pair comes as text.
        parts = value.strip(" []()").replace(";", ",").split(",") if isinstance(value, str) else value
        numbers = [number_of(part) for part in parts] if isinstance(parts, list) else []
        place = feature.property_place.format(key)
        if len(numbers) == 2 and numbers[0] is not None and numbers[1] is not None:
            lonlat = (numbers[0], numbers[1])
            if abs(lonlat[0]) <= 180.0 and abs(lonlat[1]) <= checks.MAX_LATITUDE_DEG:
                return lonlat
            exchanged = checks.exchanged(lonlat)
            action = "exchange longitude and latitude" if exchanged else "correct longitude and latitude"
            self.faults.append(Fault(place, f"{lonlat[0]:g}, {lonlat[1]:g} is no place of a pond", action))
        else:
            action = "write [longitude, latitude] in degrees"
            self.faults.append(Fault(place, f"{str(value)[:40]!r} is no position", action))
        return None

    def _point(self, feature: Feature, role: str) -> LonLat | None:
        geometry = feature.geometry
        if len(geometry.points) == 1 and not geometry.polygons:
            return geometry.points[0]
        if geometry.polygons or geometry.lines:
            areas = self._areas(feature, f"a {role}")
            return checks.point_inside(areas[0]) if areas else None
        self.faults.append(Fault(feature.place, f"the {role} has no position", "draw it as a point"))
        return None

    def _areas(self, feature: Feature, what: str) -> list[Area]:
        """The polygons of a feature, closed and valid; closed lines count as polygons, faulty ones are left out."""
        polygons = [*feature.geometry.polygons]
        for line in feature.geometry.lines:
            if len(line) > 3 and line[0] == line[-1]:
                polygons.append([line])
            else:
                action = "draw it as a polygon, or close the line"
                self.faults.append(Fault(feature.place, f"an open line is not {what}", action))
        areas = [tuple(map(checks.close_ring, polygon)) for polygon in polygons]
        if not areas and not feature.geometry.lines:
            self.faults.append(Fault(feature.place, f"without an outline this is not {what}", "draw it as a polygon"))
        valid = []
        for area in areas:
            faults = checks.check_polygon(feature.place, area)
            self.faults.extend(faults)
            if not faults:
                valid.append(area)
        return valid

    def check_ponds(self) -> None:
        """Check the ponds against each other: ids, and ponds that lie in ponds."""
        used = {pond.id for pond in self.ponds}
        first_places: dict[str, str] = {}
        num_unnamed = 0
        for index, (pond, feature) in enumerate(zip(self.ponds, self.pond_features, strict=True)):
            if not pond.id:
                num_unnamed += 1
                number = index + 1
                while str(number) in used:
                    number += len(self.ponds)
                used.add(str(number))
                self.ponds[index] = Pond(str(number), pond.sampling_point, pond.outline, pond.service_s)
            elif pond.id in first_places:
                message = f"id {pond.id!r} is already that of {first_places[pond.id]}"
                self.faults.append(Fault(feature.place, message, "give every pond an id of its own"))
            else:
                first_places[pond.id] = feature.place
        if num_unnamed:
            self.source.notes.append(f"{num_unnamed} ponds without an id were numbered in the order of the file.")
        if self.offsets_m:
            place, offset_m = max(self.offsets_m.items(), key=lambda item: item[1])
            self.source.notes.append(
                f"{len(self.offsets_m)} sampling points lie outside the outline of their pond, "
                f"the furthest by {offset_m:.1f} m ({place})."
            )
        if any(pond.outline for pond in self.ponds):
            points = [pond.sampling_point for pond in self.ponds]
            outlines = [pond.outline for pond in self.ponds]
            for inner, outer in checks.ponds_within_ponds(points, outlines):
                place, other = self.pond_features[inner].place, self.pond_features[outer].place
                self.source.notes.append(
                    f"{place}: the sampling point of pond {self.ponds[inner].id} lies in pond {self.ponds[outer].id} "
                    f"({other}); check both outlines."
                )

    def set_depot(self, depot: LonLat) -> None:
        """Take the depot that the user gave, with a note if the file has another."""
        lonlat = [number_of(value) for value in depot]
        if len(lonlat) != 2 or lonlat[0] is None or lonlat[1] is None:
            action = "give longitude and latitude in degrees"
            self.faults.append(Fault("depot", f"{depot!r} is no position", action))
            return
        given = Feature("depot", "depot", {}, Geometry(points=[(lonlat[0], lonlat[1])]))
        faults = checks.check_coordinates([given])
        self.faults.extend(faults)
        if faults:
            return
        if self.depot is not None:
            self.source.notes.append("The depot of the file was replaced by the one that was given.")
        self.depot = (lonlat[0], lonlat[1])

    def check_distances(self, *, is_depot_given: bool) -> None:
        """Check that ponds and depot lie together; a missing depot is a fault here, for it tells farms apart.

        A single pond far from all others is mistyped. Several together far away are another farm: with a depot from the
        user, who thereby says which farm is meant, they are left out with a note; else they are faults.
        """
        points = [pond.sampling_point for pond in self.ponds]
        groups = checks.neighbourhoods(points if self.depot is None else [*points, self.depot])
        main = groups[0] if groups else []
        if self.depot is not None:
            main = next(group for group in groups if len(points) in group)
        others = [group for group in groups if group is not main]
        main = [index for index in main if index < len(points)]
        if not is_depot_given and not self.has_depot_feature and self.source.features:
            told = [self._described(group) for group in (main, *others) if len(group) > 1 or group == main != []]
            action = f"pass --depot LON,LAT{': ' if told else ''}{'; '.join(told)}"
            self.faults.append(Fault("file", "there is no depot, where drones start and end", action))
        if not main:
            if points:
                self._report_far_depot(others)
            return
        centre = self.depot or checks.middle([points[index] for index in main])
        left_out: set[int] = set()
        for group in others:
            if len(group) > 1 and is_depot_given:
                left_out.update(group)
                ids = ", ".join(self.ponds[index].id for index in group[:5]) + (", ..." if len(group) > 5 else "")
                away_km = distance_m(centre, points[group[0]]) / 1000.0
                self.source.notes.append(
                    f"{len(group)} ponds ({ids}) lie {away_km:.0f} km from the depot: another farm, left out."
                )
            elif len(group) == 1 or self.depot is not None:
                self._report_far_ponds(group, centre)
        self.ponds = [pond for index, pond in enumerate(self.ponds) if index not in left_out]

    def _described(self, group: Sequence[int]) -> str:
        lon, lat = checks.middle([self.ponds[index].sampling_point for index in group])
        ponds = "1 pond lies" if len(group) == 1 else f"{len(group)} ponds lie"
        return f"{ponds} around {lon:.6f},{lat:.6f}"

    def _report_far_depot(self, groups: Sequence[list[int]]) -> None:
        depot = self.depot or (0.0, 0.0)
        points = [pond.sampling_point for pond in self.ponds]
        away_km = min(distance_m(depot, point) for point in points) / 1000.0
        swapped_km = min(distance_m((depot[1], depot[0]), point) for point in points) / 1000.0
        if swapped_km * 1000.0 <= checks.MAX_GAP_M:
            action = "longitude and latitude of the depot, or of all ponds, look exchanged; longitude comes first"
        else:
            action = f"correct it: {'; '.join(map(self._described, groups[:5]))}"
        self.faults.append(Fault("depot", f"the depot lies {away_km:.0f} km from the nearest pond", action))

    def _report_far_ponds(self, group: Sequence[int], centre: LonLat) -> None:
        for index in group:
            pond = self.ponds[index]
            away_km = distance_m(centre, pond.sampling_point) / 1000.0
            message = f"pond {pond.id!r} lies {away_km:.0f} km from the rest of the farm"
            action = "correct its coordinates, or remove it"
            if len(group) > 1:
                action += "; or pass --depot LON,LAT to plan only the farm there"
            self.faults.append(Fault(self.pond_features[index].place, message, action))
