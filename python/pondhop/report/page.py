"""The report as a Markdown page and as one HTML file that needs no other.

The text is in `report.md.jinja`; the HTML page is the Markdown page with its pictures inside, light or dark as the
reader's system is.
"""

from __future__ import annotations

import re
from base64 import b64encode
from collections.abc import Callable, Sequence
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, get_args

from pondhop.documents.atomic import write_all
from pondhop.errors import Fault, InvalidInput
from pondhop.plot import LOOKS, Theme, save_figure
from pondhop.report import charts, maps
from pondhop.report.printed import COLUMNS, TABLE_1, TABLE_2
from pondhop.report.tables import Tables, csv_files
from pondhop.report.wording import Wording

if TYPE_CHECKING:
    from jinja2 import Environment
    from markdown_it.token import Token
    from matplotlib.axes import Axes

MARKDOWN_NAME, HTML_NAME = "report.md", "report.html"
FIGURES_FOLDER = "figures"
TITLE = "Planners on the paper's farms"

PICTURES: dict[str, Callable[[Tables, Theme], Axes]] = {
    "margins": charts.draw_margins,
    "farm": maps.draw_farm,
    "clusters": maps.draw_clusters,
    "routes": maps.draw_routes,
    "quality_against_time": charts.draw_quality_against_time,
    "scaling": charts.draw_scaling,
}
"""By the name of their files."""


def require_packages() -> None:
    """Find what drawing and writing the report need.

    Raises
    ------
    InvalidInput
        If a package is missing, with how to install it.
    """
    missing = [package for package in ("jinja2", "markdown_it", "matplotlib") if find_spec(package) is None]
    if missing:
        message = f"the report needs {', '.join(missing)}: not installed"
        raise InvalidInput(
            [Fault("report", message, "install them with: pip install jinja2 markdown-it-py matplotlib")]
        )


def write_report(tables: Tables, folder: Path) -> list[Path]:
    """Write the pages, the CSV files and the pictures; what is there is replaced.

    Parameters
    ----------
    tables
        What the report says.
    folder
        Where it goes; made if it is missing.

    Returns
    -------
    list of Path
        The files, the page to read first.

    Raises
    ------
    OSError
        If a file cannot be written.
    """
    pictures = [
        _picture_path(folder, name, theme, suffix)
        for name in PICTURES
        for theme in get_args(Theme)
        for suffix in (".png", ".svg")
    ]
    for name, draw in PICTURES.items():
        for theme in get_args(Theme):
            ax = draw(tables, theme)
            for suffix in (".png", ".svg"):
                save_figure(ax, _picture_path(folder, name, theme, suffix))
    page = markdown(tables)
    pages = {folder / HTML_NAME: html(page, folder), folder / MARKDOWN_NAME: page}
    files = pages | csv_files(tables, folder)
    write_all(files)
    return [*files, *pictures]


def markdown(tables: Tables) -> str:
    """Return the report as Markdown; pictures are links to files beside it."""
    template = _environment().get_template("report.md.jinja")
    return template.render(
        title=TITLE,
        figures=FIGURES_FOLDER,
        words=Wording(tables),
        study=tables.study,
        scope=tables.study.scope,
        printed=TABLE_1,
        printed_columns=COLUMNS,
        printed_adjectives=TABLE_2,
    )


def html(page: str, folder: Path) -> str:
    """Return a Markdown page as one HTML file with its pictures inside.

    Parameters
    ----------
    page
        As `markdown` returns it.
    folder
        Where its pictures are.
    """
    from markdown_it import MarkdownIt

    renderer = MarkdownIt("commonmark").enable("table")
    tokens = renderer.parse(page)
    headings = _name_headings(tokens)
    tokens = _with_pictures(tokens, folder)
    body = renderer.renderer.render(tokens, renderer.options, {})
    body = body.replace("<table>", '<div class="scroll"><table>').replace("</table>", "</table></div>")
    template = _environment().get_template("page.html.jinja")
    return template.render(title=TITLE, body=body, headings=headings, looks=LOOKS)


def _environment() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    loader = PackageLoader("pondhop", "report")
    return Environment(
        loader=loader,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=lambda name: name is not None and ".html" in name,
    )


def _picture_path(folder: Path, name: str, theme: Theme, suffix: str) -> Path:
    tail = "" if theme == "light" else f"-{theme}"
    return folder / FIGURES_FOLDER / f"{name}{tail}{suffix}"


def _name_headings(tokens: Sequence[Token]) -> list[tuple[str, str]]:
    """Give each second-level heading an id, that which Markdown viewers give it; return ids and texts."""
    headings = []
    for opening, text in pairwise(tokens):
        if opening.type == "heading_open" and opening.tag == "h2":
            name = re.sub(r"[^\w -]", "", text.content.lower()).replace(" ", "-")
            opening.attrSet("id", name)
            headings.append((name, text.content))
    return headings


def _with_pictures(tokens: Sequence[Token], folder: Path) -> list[Token]:
    """Replace each paragraph that is a picture by a figure that holds it."""
    from markdown_it.token import Token

    found: list[Token] = []
    for token in tokens:
        image = token.children[0] if token.type == "inline" and token.children else None
        if image is not None and image.type == "image":
            name = Path(str(image.attrs["src"])).stem
            found[-1] = Token("html_block", "", 0, content=_figure(name, image.content, folder))
        elif token.type != "paragraph_close" or found[-1].type != "html_block":
            found.append(token)
    return found


def _figure(name: str, caption: str, folder: Path) -> str:
    light, dark = (_data_uri(_picture_path(folder, name, theme, ".svg")) for theme in get_args(Theme))
    template = _environment().get_template("figure.html.jinja")
    return template.render(caption=caption, light=light, dark=dark)


def _data_uri(path: Path) -> str:
    return f"data:image/svg+xml;base64,{b64encode(path.read_bytes()).decode()}"
