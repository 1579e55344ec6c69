"""Colours of routes, the same in pictures and on maps.

Six colours of the palette of M. Okabe and K. Ito, *Color Universal Design* (2008), which people with any of the common
kinds of colour blindness tell apart. Its black and its yellow are left out: one of them vanishes on every background.
"""

from __future__ import annotations

ROUTE_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#D55E00", "#56B4E9", "#CC79A7")


def route_colour(index: int) -> str:
    """Return the colour of a route as ``#RRGGBB``; from the seventh on colours come again."""
    return ROUTE_COLOURS[index % len(ROUTE_COLOURS)]
