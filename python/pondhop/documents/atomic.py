"""Writing files whole or not at all: nobody ever loads half a mission, or one plan's mission beside another's."""

from __future__ import annotations

import os
import platform
import re
import shutil
import stat
import sys
import tempfile
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from io import RawIOBase
from pathlib import Path

from pondhop.documents.signals import signals_held_back
from pondhop.errors import Fault, InvalidInput

Content = str | bytes | Iterable[str]
"""Text, written as UTF-8 with the line ends it has, at once or in parts; or bytes."""

_MAX_BEGINNING = 1_000
"""Bytes of a file that tell whose it is."""

STAGING_PREFIX = ".pondhop-"
"""How the names of temporary folders begin; one is left behind only where the program is killed or the power fails."""

_STAGING_NAME = re.compile(rf"{re.escape(STAGING_PREFIX)}[a-z0-9_]{{8}}")
_MARK, _NEW, _OLD = "pondhop.txt", "new", "old"
"""What a temporary folder holds: the file that says whose it is, what is to come, and what has gone."""


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
    for parent in {path.parent for path in targets}:
        parent.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stagings:
        # One in each target folder: a rename is atomic only within a file system.
        folders = {
            parent: stagings.enter_context(_temporary_folder(parent))
            for parent in dict.fromkeys(path.parent for path in targets)
        }
        staged = [(folders[path.parent] / _NEW / path.name, path) for path in targets]
        for temporary, path in staged:
            _write(temporary, targets[path], path)
        with signals_held_back():
            for temporary, path in staged:
                temporary.replace(path)


def replace_files(
    folder: Path, files: Mapping[str, Content], earlier: Iterable[str], witnesses: Collection[str] = ()
) -> None:
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
    witnesses
        Files by which `earlier_files` knows the others: they go last and come first, so that whatever is left where the
        program was killed is known as ours.

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
    old.sort(key=lambda name: name in witnesses)
    new = sorted(files, key=lambda name: name not in witnesses)
    try:
        with _temporary_folder(folder) as staging:
            for name, content in files.items():
                _write(staging / _NEW / name, content, folder / name)
            with signals_held_back():
                _swap(folder, staging, old, new)
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
            move(folder / name, staging / _OLD / name)
        for name in new:
            move(staging / _NEW / name, folder / name)
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


@contextmanager
def _temporary_folder(parent: Path) -> Iterator[Path]:
    """Make a folder in another one, and remove it, whatever comes.

    So are those that a killed program left there, but not before all went well: they may hold the only copies of files
    that were there before.
    """
    ends = ExitStack()
    try:
        with signals_held_back(), _named(parent):
            folder = Path(tempfile.mkdtemp(dir=parent, prefix=STAGING_PREFIX))
            ends.callback(shutil.rmtree, folder, ignore_errors=True)
            mark = ends.enter_context((folder / _MARK).open("wb", buffering=0))
            # Locked before it says whose it is: whoever reads that can tell that we still use the folder.
            if _lock(mark):
                mark.write(_mark_text())
        yield folder
        _remove_left_behind(parent, folder)
    finally:
        with signals_held_back():
            ends.close()


def _remove_left_behind(parent: Path, in_use: Path) -> None:
    """Remove temporary folders that a killed program left in a folder; ours, and any that may be another's, stay."""
    with suppress(OSError):
        for entry in list(os.scandir(parent)):
            is_other = entry.name != in_use.name and _STAGING_NAME.fullmatch(entry.name)
            if is_other and entry.is_dir(follow_symlinks=False):
                # For writing, though nothing is written: network file systems lock no file that is open for reading.
                with suppress(OSError), (Path(entry.path) / _MARK).open("r+b", buffering=0) as mark:
                    if _is_left_behind(Path(entry.path), mark):
                        shutil.rmtree(entry.path, ignore_errors=True)


def _is_left_behind(folder: Path, mark: RawIOBase) -> bool:
    """Whether a folder is a temporary one of ours that no program uses any more."""
    is_known = {path.name for path in folder.iterdir()} <= {_MARK, _NEW, _OLD}
    return is_known and mark.read() == _mark_text() and _lock(mark)


def _mark_text() -> bytes:
    # Locks may hold on one machine only where several share a disk, and people have names of their own.
    user = os.getuid() if sys.platform != "win32" else ""
    return f"A temporary folder of pondhop, made on {platform.node()} by user {user}.\n".encode()


def _lock(file: RawIOBase) -> bool:
    """Lock an open file until it is closed, at the latest by the end of the program; return whether that could be done.

    Where there are no such locks, no folder is ever taken for one that a killed program left.
    """
    if sys.platform == "win32":
        return False
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True


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
