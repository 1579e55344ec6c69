"""Every bash and python block of the README and the docs is run, top to bottom, in a directory of its own.

``<!-- not run: why -->`` before a block excuses it; ``<!-- file: name -->`` saves the block under that name instead.
"""

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

import pytest

import pondhop

ROOT = Path(__file__).resolve().parent.parent
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(
    r"^(?:<!-- (?P<marker>not run|file): (?P<text>.*?) -->\n)?```(?P<language>\w+)\n(?P<code>.*?)^```$",
    flags=re.MULTILINE | re.DOTALL,
)


class Block(NamedTuple):
    line: int
    language: str
    code: str
    file_name: str | None


def blocks_of(text: str) -> list[Block]:
    blocks = []
    for match in BLOCK.finditer(text):
        if match["marker"] == "not run":
            continue
        file_name = match["text"] if match["marker"] == "file" else None
        if file_name or match["language"] in ("bash", "python"):
            line = text.count("\n", 0, match.start("code")) + 1
            blocks.append(Block(line, match["language"], match["code"], file_name))
    return blocks


def test_the_parser_sees_blocks_and_markers() -> None:
    text = (
        "```bash\ntrue\n```\n<!-- not run: network -->\n```bash\nfalse\n```\n"
        '<!-- file: a.toml -->\n```toml\nx = 1\n```\n```json\n{}\n```\n```python\nprint("x")\n```\n'
    )
    assert blocks_of(text) == [
        Block(2, "bash", "true\n", None),
        Block(10, "toml", "x = 1\n", "a.toml"),
        Block(16, "python", 'print("x")\n', None),
    ]


PAGES_WITH_CODE = [page for page in PAGES if blocks_of(page.read_text())]


@pytest.mark.parametrize("page", PAGES_WITH_CODE, ids=lambda page: str(page.relative_to(ROOT)))
def test_the_code_of_a_page_runs(page: Path, tmp_path: Path) -> None:
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    environment = os.environ | {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    for block in blocks_of(page.read_text()):
        if block.file_name:
            (tmp_path / block.file_name).write_text(block.code)
            continue
        command = ["bash", "-euo", "pipefail"] if block.language == "bash" else [sys.executable, "-W", "error", "-"]
        ran = subprocess.run(
            command, input=block.code, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False
        )
        assert ran.returncode == 0, f"{page.relative_to(ROOT)}, line {block.line}:\n{ran.stdout}{ran.stderr}"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page.read_text()):
        if "://" not in target:
            assert (page.parent / target).exists(), f"{page.relative_to(ROOT)} links to {target}"


def test_the_python_reference_names_everything_public() -> None:
    page = (ROOT / "docs" / "reference" / "python.md").read_text()
    named = set(re.findall(r"\w+", page))
    assert {name for name in pondhop.__all__ if not name.startswith("_")} <= named
    assert all(hasattr(pondhop, name) for name in pondhop.__all__)


def test_the_glossary_is_sorted_and_has_no_word_twice() -> None:
    rows = re.findall(r"^\| ([^|]+?) \|", (ROOT / "docs" / "glossary.md").read_text(), flags=re.MULTILINE)
    words = [row for row in rows if row != "word"]
    assert words == sorted(set(words))
