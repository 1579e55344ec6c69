"""Put a report of `pondhop bench paper` into docs/benchmarks.md: `python scripts/benchmarks_page.py REPORT_FOLDER`."""

import re
import shutil
import sys
from pathlib import Path

DOCS = Path(__file__).resolve().parent.parent / "docs"
PAGE = DOCS / "benchmarks.md"
PICTURES = DOCS / "images" / "report"
BEGIN, END = "<!-- report: begin -->\n", "<!-- report: end -->\n"
PICTURE = re.compile(r"\(figures/(?P<name>[\w-]+\.png)\)")


def chapter(report: str) -> str:
    """Return the report as a chapter of a page: no title, headings one level down, commands that are not run."""
    _, _, body = report.partition("\n")
    body = re.sub(r"^#", "##", body, flags=re.MULTILINE)
    body = body.replace("```bash\n", "<!-- not run: it takes an hour or so -->\n```bash\n")
    return PICTURE.sub(r"(images/report/\g<name>)", body).strip() + "\n"


def main() -> None:
    """Renew the chapter and its pictures."""
    folder = Path(sys.argv[1])
    report = (folder / "report.md").read_text()
    PICTURES.mkdir(parents=True, exist_ok=True)
    for name in PICTURE.findall(report):
        shutil.copyfile(folder / "figures" / name, PICTURES / name)
    before, begin, rest = PAGE.read_text().partition(BEGIN)
    _, end, after = rest.partition(END)
    PAGE.write_text(f"{before}{begin}\n{chapter(report)}\n{end}{after}")


if __name__ == "__main__":
    main()
