"""``pondhop size``: how many drones a round needs."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from pondhop.cli.plan import ByOption, StartOption, WindOption, chosen_by, timed_fleet
from pondhop.cli.shared import (
    EXIT_INFEASIBLE,
    Json,
    Seed,
    exit_stopped,
    parse_lonlat,
    progress,
    require_matplotlib,
)
from pondhop.units import counted, duration_text

if TYPE_CHECKING:
    from pondhop.fleet import Fleet
    from pondhop.nights import Size


def size(
    farm: Annotated[Path, typer.Argument(exists=True, help="The farm, as for 'pondhop plan'.")],
    fleet: Annotated[
        Path | None, typer.Option(exists=True, help="The fleet as a TOML file; its number of drones does not matter.")
    ] = None,
    depot: Annotated[
        str | None, typer.Option(metavar="LON,LAT", help="Where drones start and land, if the file does not say.")
    ] = None,
    wind: WindOption = None,
    start: StartOption = None,
    by: ByOption = None,
    max_drones: Annotated[int, typer.Option(min=1, max=1000, help="The last number tried.")] = 30,
    iterations: Annotated[int | None, typer.Option(min=1, help="Steps of each search.")] = None,
    seed: Seed = 1,
    output: Annotated[Path | None, typer.Option("--output", "-o", help="Draw the curve: a .png or .svg file.")] = None,
    as_json: Json = False,
) -> None:
    """Find the fewest drones that sample every pond in time.

    - `pondhop size farm.geojson --fleet fleet.toml --start 22:00 --by 05:30`
    - `pondhop size farm.geojson --fleet fleet.toml --start 22:00 --by 05:30 --wind 4@225 -o size.png`

    A round is planned with one drone, with two, and so on, until all ponds are sampled in time, and two more for the
    curve. Where a bound shows that no plan of so many drones can do it, the table says "proven". Exit code 3: not even
    the last number is enough.
    """
    from pondhop.farm.read import read_farm
    from pondhop.fleet import CALM, parse_wind
    from pondhop.nights import Effort, sizes

    if output is not None:
        require_matplotlib()
    chosen = timed_fleet(chosen_by(1 if fleet is None else None, fleet, None), start, by)
    blowing = parse_wind(wind) if wind is not None else CALM
    effort = Effort(seed=seed, iterations=iterations)
    with progress("Planning", total=max_drones) as advance:
        read = read_farm(farm, depot=parse_lonlat("--depot", depot) if depot is not None else None)
        found: list[Size] = []
        for planned in sizes(read, chosen, blowing, effort, max_drones=max_drones):
            found.append(planned)
            advance(note=counted(planned.num_drones, "drone"))
    if output is not None:
        from pondhop.plot import plot_sizes, save_figure

        save_figure(plot_sizes(found, chosen, read.name), output)
    fewest = next((planned.num_drones for planned in found if planned.is_enough), None)
    if as_json:
        sizes_json = [{**asdict(planned), "is_enough": planned.is_enough} for planned in found]
        typer.echo(json.dumps({"num_drones": fewest, "sizes": sizes_json}))
    else:
        _print_sizes(found, chosen, len(read.ponds))
    if found[-1].is_interrupted:
        exit_stopped("stopped; larger numbers of drones were not tried")
    if fewest is None:
        raise typer.Exit(EXIT_INFEASIBLE)


def _print_sizes(found: list[Size], fleet: Fleet, num_ponds: int) -> None:
    from rich.console import Console
    from rich.table import Table

    from pondhop.fleet.clock import clock_after

    console = Console(highlight=False, markup=False)
    table = Table()
    for heading in ("Drones", "All back", "After", "Left out", ""):
        table.add_column(heading, justify="right", no_wrap=True)
    fewest = next((planned for planned in found if planned.is_enough), None)
    for planned in found:
        back = clock_after(fleet.start, planned.all_back_s)[:5] if fleet.start is not None else ""
        verdict = (
            "proven too few" if planned.is_proven_too_few else "no plan found" if planned.num_unserved else "enough"
        )
        left_out = str(planned.num_unserved) if planned.num_unserved else ""
        table.add_row(
            str(planned.num_drones),
            back,
            duration_text(planned.all_back_s),
            left_out,
            verdict,
            style="bold" if planned is fewest else None,
        )
    console.print(table)
    if fewest is None and found[-1].is_interrupted:
        return
    if fewest is None:
        least = min(planned.num_unserved for planned in found)
        console.print(
            f"Not even {counted(found[-1].num_drones, 'drone')} sample all {num_ponds} ponds in time: at least {least} "
            "are left out. 'pondhop plan' with that many tells why for each pond."
        )
        return
    fewer = [planned for planned in found if planned.num_drones == fewest.num_drones - 1]
    certainty = ""
    if fewer:
        certainty = (
            "; one less is proven to be too few" if fewer[0].is_proven_too_few else "; with one less no plan was found"
        )
    console.print(f"{counted(fewest.num_drones, 'drone')} sample all {num_ponds} ponds in time{certainty}.")
