"""The examples of docs/how-to/farm-files.md are farms."""

import re
from pathlib import Path

import pytest

from pondhop.farm import read_farm

PAGE = Path(__file__).parents[1] / "docs" / "how-to" / "farm-files.md"
EXAMPLES = re.findall(r"```(json|text)\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def test_the_page_shows_three_formats() -> None:
    assert [kind for kind, _ in EXAMPLES] == ["json", "text", "text"]


@pytest.mark.parametrize(("kind", "example"), EXAMPLES)
def test_an_example_is_read(tmp_path: Path, kind: str, example: str) -> None:
    path = tmp_path / ("farm.geojson" if kind == "json" else "farm.csv")
    path.write_text(example)
    farm = read_farm(path, depot=None if "depot" in example else (-90.602, 33.401))
    assert farm.ponds[0].id == "1"
    assert farm.notes == ()
