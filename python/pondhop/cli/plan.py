"""``pondhop plan`` and what goes with real farms."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, Unpack

import typer

from pondhop.cli.shared import (
    EXIT_INFEASIBLE,
    INSTALL_MATPLOTLIB,
    Json,
    RequireFeasible,
    Seed,
    UnitsOption,
    exit_stopped,
    has_matplotlib,
    parse_lonlat,
    print_faults,
    progress,
    require_matplotlib,
    search_progress,
    with_planning_options,
)
from pondhop.documents.signals import STOPS
from pondhop.errors import Fault, InvalidInput
from pondhop.planners import PlainOptions
from pondhop.units import counted

if TYPE_CHECKING:
    from pondhop.fleet import Fleet, SamplingStyle


WindOption = Annotated[
    str | None, typer.Option(metavar="SPEED@FROM", help="Wind in m/s and where it blows from in degrees, as 4@225.")
]
StartOption = Annotated[str | None, typer.Option(metavar="HH:MM", help="When the first drone takes off, by the clock.")]
ByOption = Annotated[str | None, typer.Option(metavar="HH:MM", help="When all drones must be back, by the clock.")]


@with_planning_options
def plan(
    farm: Annotated[
        Path,
        typer.Argument(
            exists=True, help="GeoJSON, KML, KMZ, GPX, Shapefile, GeoPackage, Excel, or CSV of positions or corners."
        ),
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="Folder for plan, picture and missions.")],
    drones: Annotated[int | None, typer.Option(min=1, help="How many drones fly; all else is assumed.")] = None,
    fleet: Annotated[
        Path | None, typer.Option(exists=True, help="The fleet as a TOML file, instead of --drones.")
    ] = None,
    depot: Annotated[
        str | None, typer.Option(metavar="LON,LAT", help="Where drones start and land, if the file does not say.")
    ] = None,
    layer: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Layer, sheet or folder of the file to read; several times for several."),
    ] = None,
    accept: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ID[,ID...]",
            help="Ponds whose guessed place you have looked at and found right, or 'all'; repeatable.",
        ),
    ] = None,
    sampling: Annotated[Literal["hover-dip", "splashdown"] | None, typer.Option(help="How a pond is sampled.")] = None,
    wind: WindOption = None,
    start: StartOption = None,
    by: ByOption = None,
    deconflict: Annotated[
        bool, typer.Option("--deconflict", help="Hold trips back on the ground until no two drones meet in the air.")
    ] = False,
    figure: Annotated[
        bool | None,
        typer.Option("--figure/--no-figure", help="Draw the plan (PNG and SVG); if not said, where it can be."),
    ] = None,
    units: UnitsOption = "metric",
    require_feasible: RequireFeasible = False,
    as_json: Json = False,
    **options: Unpack[PlainOptions],
) -> None:
    """Plan a round over a real farm: routes, a picture and one checked mission file per drone.

    - `pondhop plan farm.geojson --drones 3 -o tonight`
    - `pondhop plan farm.kml --drones 3 --depot -89.21,37.70 -o tonight`
    - `pondhop plan farm.gpkg --fleet fleet.toml --sampling splashdown --no-figure -o tonight`
    - `pondhop plan farm.geojson --fleet fleet.toml --wind 4@225 --start 22:00 --by 05:30 -o tonight`

    Where the fleet changes batteries (`swap_s`), there is wind, ponds have time windows, or the round has an end, each
    drone flies trips, one a battery.

    Everything wrong with the farm file is reported at once, each fault with its place and its remedy.
    """
    from pondhop import outputs, planners
    from pondhop.farm.read import read_farm
    from pondhop.fleet import CALM, parse_wind

    if figure:
        require_matplotlib()
    is_drawn = has_matplotlib() if figure is None else figure
    outputs.check_folder(output)
    chosen_fleet = timed_fleet(chosen_by(drones, fleet, sampling), start, by)
    blowing = parse_wind(wind) if wind is not None else CALM
    with progress("Planning", total=4 if is_drawn else 3) as advance:
        read = read_farm(
            farm,
            depot=parse_lonlat("--depot", depot) if depot is not None else None,
            layers=layer or (),
            accept=accept or (),
        )
        advance()
        farm_plan = planners.plan(
            read,
            chosen_fleet,
            wind=blowing,
            is_deconflicted=deconflict,
            progress=search_progress(advance),
            **options,
        )
        advance()
        written = outputs.write_outputs(output, farm_plan, has_figure=is_drawn, units=units)
        advance(size=2.0 if is_drawn else 1.0)
    if as_json:
        typer.echo(written.plan_json, nl=False)
    else:
        from pondhop.cli import printed

        printed.print_farm_plan(written.farm_plan, units)
        typer.echo(f"Written to {output}: {', '.join(written.names)}")
        if figure is None and not is_drawn:
            typer.echo(f"No picture was drawn, because matplotlib is not installed; {INSTALL_MATPLOTLIB}")
    if written.faults:
        heading = "No mission was written, because this plan cannot be flown"
        print_faults(written.faults, "no_missions", heading, as_json)
    if farm_plan.solution.is_interrupted:
        exit_stopped(f"{STOPS.text}; this is the best plan until then, and plan.json says so")
    if written.faults or (require_feasible and not farm_plan.is_feasible):
        raise typer.Exit(EXIT_INFEASIBLE)


def generate_farm(
    ponds: Annotated[int, typer.Option(min=1, help="How many ponds.")],
    at: Annotated[str, typer.Option(metavar="LON,LAT", help="Where the farm lies.")],
    output: Annotated[Path, typer.Option("--output", "-o", help="The GeoJSON file.")],
    seed: Seed = 1,
    missing_share: Annotated[
        float,
        typer.Option(
            min=0.0,
            max=0.9,
            help="How much of the farm has no pond, as where some were filled in or sold: 0.2 is one place in five. "
            "The number of ponds stays what --ponds says; the farm grows.",
        ),
    ] = 0.0,
    irregular: Annotated[bool, typer.Option(help="Give the farm an irregular outline.")] = False,
    as_json: Json = False,
) -> None:
    """Make up a real-world farm: ponds of 4-8 ha in blocks with levees and a yard, as in the Mississippi Delta.

    - `pondhop generate-farm --ponds 700 --at -90.9,33.4 -o farm.geojson`
    """
    from pondhop.farm.made_up import generate_farm as generate
    from pondhop.farm.write import write_farm

    farm = generate(ponds, at=parse_lonlat("--at", at), seed=seed, missing_share=missing_share, irregular=irregular)
    write_farm(output, farm)
    message = {"farm": str(output), "num_ponds": len(farm.ponds)}
    typer.echo(json.dumps(message) if as_json else f"Written to {output}: {counted(len(farm.ponds), 'pond')}")


def timed_fleet(fleet: Fleet, start: str | None, by: str | None) -> Fleet:
    """Return the fleet with the times of the command line in place of its own."""
    return replace(fleet, start=start or fleet.start, end=by or fleet.end)


def chosen_by(num_drones: int | None, path: Path | None, sampling: SamplingStyle | None) -> Fleet:
    """Return the fleet of the options; one of ``--drones`` and ``--fleet`` says how many drones there are."""
    from pondhop.fleet import Fleet, read_fleet

    if num_drones is not None and path is not None:
        raise InvalidInput([Fault("--drones, --fleet", "both say how many drones there are", "give one of them")])
    if path is not None:
        fleet = read_fleet(path)
    elif num_drones is not None:
        fleet = Fleet(num_drones)
    else:
        action = "give --drones N, or --fleet fleet.toml"
        raise InvalidInput([Fault("--drones", "nothing says how many drones fly", action)])
    return fleet if sampling is None else replace(fleet, sampling=sampling)
