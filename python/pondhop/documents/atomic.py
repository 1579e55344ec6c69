"""Writing files whole or not at all: nobody ever loads half a mission, or one plan's mission beside another's."""

from __future__ import annotations

import os
import re
import shutil
import stat
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

from pondhop.documents.signals import signals_held_back
from pondhop.errors import Fault, InvalidInput

Content = str | bytes | Iterable[str]
"""Text, written as UTF-8 with the line ends it has, at once or in parts; or bytes."""

_MAX_BEGINNING = 200
"""Bytes of a file that tell whose it is."""

STAGING_PREFIX = ".pondhop-"
"""How the names of temporary folders begin; one is left behind only where the program is killed or the power fails."""


def write_all(files: Mapping[Path, Content]) -> None:
    """Write files; none of them is touched before all are on the disk.

    Everything goes to a temporary folder next to its file first; then the files are renamed, one after the other.
    Missing parent folders are made. The file at the end of a symbolic link is replaced, not the link.

    Parameters
    ----------
    files
        Path -> content.

    Raises
    ------
    InvalidInput
        If a folder, a device or the like has the name of a file.
    OSError
        If the disk is full, a folder is read-only or the like; it names the file.
    """
    targets = {Path(os.path.realpath(path)): content for path, content in files.items()}
    for path in targets:
        check_is_file_or_absent(path)
    with _Staging() as staging:
        staged = [(staging.write(path, content), path) for path, content in targets.items()]
        with signals_held_back():
            for temporary, path in staged:
                temporary.replace(path)


def replace_files(folder: Path, files: Mapping[str, Content], earlier: Iterable[str]) -> None:
    """Put files into a folder in place of earlier ones, as a whole: it holds all of the old files or all of the new.

    What goes wrong on the way, a full disk or a signal, leaves the folder as it was. Where nothing can be put right any
    more, as when the power fails, some of one kind may be missing, but no old file is beside a new one.

    Parameters
    ----------
    folder
        Made if it is missing.
    files
        Path within the folder -> content.
    earlier
        Paths within the folder of the files that go; those that are not there, and all others, are left alone. A
        folder within that becomes empty goes, too.

    Raises
    ------
    InvalidInput
        If a folder, a device or the like has the name of a file.
    OSError
        If a file cannot be written.
    """
    is_new = not folder.exists()
    folder.mkdir(parents=True, exist_ok=True)
    old = sorted({name for name in (*earlier, *files) if os.path.lexists(folder / name)})
    for name in old:
        check_is_file_or_absent(folder / name)
    try:
        with _temporary_folder(folder) as staging:
            for name, content in files.items():
                _write(staging / "new" / name, content, folder / name)
            with signals_held_back():
                _swap(folder, staging, old, list(files))
    except BaseException:
        if is_new:
            with suppress(OSError):
                folder.rmdir()
        raise


def earlier_files(folder: Path, names: Iterable[str], witness: str, beginning: re.Pattern[bytes]) -> list[str]:
    """Return which files of some names are in a folder, once it is sure that they are our own of an earlier time.

    A name proves nothing: many a folder has a ``README.txt`` that a person wrote. All of the files are taken for ours
    if one of them, the witness, begins as only we begin it.

    Parameters
    ----------
    folder
        Where to look; it may be missing.
    names
        What our files are called.
    witness
        The name of the file that tells.
    beginning
        What the witness begins with.

    Raises
    ------
    InvalidInput
        With every file of such a name that is not ours; or where a folder, a device or the like has one.
    OSError
        If the witness cannot be read.
    """
    found = [name for name in names if os.path.lexists(folder / name)]
    for name in found:
        check_is_file_or_absent(folder / name)
    if not found or _begins_with(folder / witness, beginning):
        return found
    message = "pondhop gives a file this name, and nothing says that it wrote the one that is there"
    raise InvalidInput(Fault(str(folder / name), message, "move it away, or choose another folder") for name in found)


def _begins_with(path: Path, beginning: re.Pattern[bytes]) -> bool:
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return beginning.match(file.read(_MAX_BEGINNING)) is not None


def check_is_file_or_absent(path: Path) -> None:
    """Refuse a path that a file cannot take: replacing a folder or a device would be worse than any fault.

    Raises
    ------
    InvalidInput
        With the path and what it is.
    OSError
        If that cannot be found out.
    """
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        return
    if stat.S_ISREG(mode):
        if not os.access(path, os.W_OK):
            fault = Fault(str(path), "this file may not be written", "change its permissions, or give another name")
            raise InvalidInput([fault])
        return
    raise InvalidInput([Fault(str(path), f"this is {kind_of_file(mode)}, not a file", "give the name of a file")])


def kind_of_file(mode: int) -> str:
    """Return what a mode of the operating system stands for, in words."""
    kinds = (
        (stat.S_ISREG, "a file"),
        (stat.S_ISDIR, "a folder"),
        (stat.S_ISFIFO, "a pipe"),
        (stat.S_ISSOCK, "a socket"),
    )
    return next((words for is_kind, words in kinds if is_kind(mode)), "a device")


def _swap(folder: Path, staging: Path, old: list[str], new: list[str]) -> None:
    """Take the old files out, then bring the new ones in; if that fails, go back."""
    moved: list[tuple[Path, Path]] = []

    def move(source: Path, target: Path) -> None:
        target.parent.mkdir(parents=True, exist_ok=True)
        source.rename(target)
        moved.append((source, target))

    try:
        for name in old:
            move(folder / name, staging / "old" / name)
        for name in new:
            move(staging / "new" / name, folder / name)
    except OSError:
        for source, target in reversed(moved):
            target.rename(source)
        raise
    finally:
        for within in sorted({Path(name).parent for name in (*old, *new)}, reverse=True):
            # A folder that is not empty, or never was there, stays as it is.
            if within != Path():
                with suppress(OSError):
                    (folder / within).rmdir()


class _Staging:
    """A temporary folder in each target folder: a rename is atomic only within a file system."""

    def __init__(self) -> None:
        self._folders: dict[Path, tempfile.TemporaryDirectory[str]] = {}

    def __enter__(self) -> _Staging:
        return self

    def __exit__(self, *_exception: object) -> None:
        for folder in self._folders.values():
            folder.cleanup()

    def write(self, path: Path, content: Content) -> Path:
        """Write the content beside ``path`` and return where it is."""
        if path.parent not in self._folders:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._folders[path.parent] = _make_temporary_folder(path.parent)
        temporary = Path(self._folders[path.parent].name) / path.name
        _write(temporary, content, path)
        return temporary


@contextmanager
def _temporary_folder(parent: Path) -> Iterator[Path]:
    with _make_temporary_folder(parent) as name:
        yield Path(name)


def _make_temporary_folder(parent: Path) -> tempfile.TemporaryDirectory[str]:
    with _named(parent):
        return tempfile.TemporaryDirectory(dir=parent, prefix=STAGING_PREFIX)


def _write(temporary: Path, content: Content, path: Path) -> None:
    """Write what is to become the file ``path``, with the permissions of the one that is there."""
    with _named(path):
        temporary.parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, bytes):
            temporary.write_bytes(content)
        else:
            with temporary.open("w", encoding="utf-8", newline="") as file:
                file.writelines([content] if isinstance(content, str) else content)
        if path.exists():
            shutil.copymode(path, temporary)


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """Let an error of the operating system name the path the user knows, not a temporary one."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(path)) from error
