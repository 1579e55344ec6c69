"""Writing several files all or none: nobody ever loads half a mission."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping
from pathlib import Path


def write_all(texts: Mapping[Path, str]) -> None:
    """Write texts to files; none of the files is touched before all texts are on the disk.

    Every text goes to a temporary folder next to its file first; then they are renamed, one after the other. Missing
    parent folders are made.

    Parameters
    ----------
    texts
        Path -> content, written as UTF-8 with the line ends it has.

    Raises
    ------
    OSError
        If the disk is full, a folder is read-only or the like.
    """
    with _Staging() as staging:
        staged = [(staging.write(path, text), path) for path, text in texts.items()]
        for temporary, path in staged:
            temporary.replace(path)


class _Staging:
    """A temporary folder in each target folder: a rename is atomic only within a file system."""

    def __init__(self) -> None:
        self._folders: dict[Path, tempfile.TemporaryDirectory[str]] = {}

    def __enter__(self) -> _Staging:
        return self

    def __exit__(self, *_exception: object) -> None:
        for folder in self._folders.values():
            folder.cleanup()

    def write(self, path: Path, text: str) -> Path:
        """Write the text beside ``path`` and return where it is."""
        if path.parent not in self._folders:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._folders[path.parent] = tempfile.TemporaryDirectory(dir=path.parent, prefix=".pondhop-")
        temporary = Path(self._folders[path.parent].name) / path.name
        temporary.write_text(text, encoding="utf-8", newline="")
        return temporary
