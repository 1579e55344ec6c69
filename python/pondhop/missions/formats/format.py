"""What a format of mission files is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from pondhop.missions.mission import Mission


@dataclass(frozen=True)
class MissionFormat:
    """A format of mission files.

    Attributes
    ----------
    name
        The programs that load it.
    suffix
        Of its files: ``.plan``.
    write
        Returns the text of a mission.
    parse
        Returns the mission of a text and a name, read strictly; raises `InvalidInput` for what `write` would not write.
    has_areas
        Whether it holds fences and no-fly zones.
    """

    name: str
    suffix: str
    write: Callable[[Mission], str]
    parse: Callable[[str, str], Mission]
    has_areas: bool

    def checked_text(self, mission: Mission) -> str:
        """Return the text of a mission, which must read back as the same mission.

        Raises
        ------
        RuntimeError
            If it does not: a bug of pondhop.
        """
        text = self.write(mission)
        expected = mission if self.has_areas else replace(mission, fences=(), no_fly=())
        if self.parse(text, mission.name) != expected:
            raise RuntimeError(f"{mission.name}{self.suffix} reads back as another mission than was written")
        return text
