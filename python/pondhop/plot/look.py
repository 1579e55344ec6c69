"""Colours of everything but the routes, for the day and for the night."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Theme = Literal["light", "dark"]


@dataclass(frozen=True)
class Look:
    """Colours of everything but the routes."""

    background: str
    ink: str
    faint_ink: str
    water: str
    shore: str
    outline: str
    no_fly: str


LOOKS: dict[Theme, Look] = {
    "light": Look("#FFFFFF", "#1F2933", "#5F6C7B", "#DCEBF5", "#A9C4D8", "#8494A5", "#C0392B"),
    "dark": Look("#14191F", "#E8EDF2", "#9AA8B7", "#1F3342", "#3C5A70", "#71808F", "#FF6B5E"),
}
"""By theme; pages that show pictures use the same background."""
