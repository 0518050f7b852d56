"""Which forms of recordings can be read as clips and written from them: a table of each, a line a form."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from wigwag.datasets import utd_mhad
from wigwag.datasets.bvh_clips import bvh_text, read_bvhs
from wigwag.datasets.folder import UNLABELLED, clip_path, load_folder, safe_name, save_clip
from wigwag.datasets.loaded import Loaded
from wigwag.datasets.notes import Notes
from wigwag.datasets.ntu import read_ntu
from wigwag.datasets.parquet import read_parquet, write_parquet
from wigwag.datasets.staged import staged_file, staged_folder
from wigwag.errors import InputError
from wigwag.skeleton import Clip


@dataclass(frozen=True, slots=True)
class Options:
    """What some readers have to be told."""

    unit_m: float | None = None
    """Unit of length of BVH files, metres; ``None``: told by the legs."""


Read = Callable[[Path, Notes, Options], Iterator[Clip]]


@dataclass(frozen=True, slots=True)
class Reader:
    """One form that can be read."""

    what: str
    """In a few words."""
    patterns: tuple[str, ...]
    """By one of these a file is known, or a folder by what is in it."""
    read: Read
    """Yields clip after clip and notes what it leaves out."""

    def knows(self, path: Path) -> bool:
        """Say whether a path looks like this form."""
        if path.is_dir():
            return any(next(path.glob(pattern), None) is not None for pattern in self.patterns)
        return any(path.match(pattern.removeprefix("**/")) for pattern in self.patterns)


def _from_loaded(load: Callable[[Path], Loaded]) -> Read:
    """Make a reader of a function that loads all at once."""

    def read(path: Path, notes: Notes, options: Options) -> Iterator[Clip]:
        loaded = load(path)
        notes.left_out.extend(loaded.left_out)
        notes.repaired.extend(loaded.repaired)
        yield from loaded.clips

    return read


READERS: dict[str, Reader] = {
    "folder": Reader("folder of wigwag's clips", ("**/*.json",), _from_loaded(load_folder)),
    "parquet": Reader("Parquet table", ("*.parquet",), lambda path, notes, _: read_parquet(path, notes)),
    "bvh": Reader("BVH", ("**/*.bvh", "**/*.BVH"), lambda path, notes, o: read_bvhs(path, notes, o.unit_m)),
    "ntu": Reader(
        "NTU RGB+D skeletons",
        ("*.skeleton", "nturgb+d_skeletons/*.skeleton", "nturgbd_skeletons*.zip"),
        lambda path, notes, _: read_ntu(path, notes),
    ),
    "utd-mhad": Reader(
        "UTD-MHAD skeletons",
        ("Skeleton.zip", "Skeleton/*_skeleton.mat", "*_skeleton.mat"),
        _from_loaded(utd_mhad.load_skeletons),
    ),
}
"""Every form that can be read, by the name that the command line knows it by."""

Add = Callable[[Clip], None]
"""Takes one clip into what is being written."""


@dataclass(frozen=True, slots=True)
class Writer:
    """One form that can be written."""

    what: str
    """In a few words."""
    open: Callable[[Path, bool, Notes], AbstractContextManager[Add]]
    """Opens a target (whether existing files may be replaced); what is written appears at the end."""


@contextmanager
def _write_folder(path: Path, overwrite: bool, notes: Notes) -> Iterator[Add]:
    with staged_folder(path, overwrite) as beside:
        free = _Names(notes)

        def add(clip: Clip) -> None:
            save_clip(free.named(clip, Path()), beside)

        yield add


@contextmanager
def _write_bvh(path: Path, overwrite: bool, notes: Notes) -> Iterator[Add]:
    """One ``.bvh`` file, or ``<label>/<subject>/<name>.bvh`` in a folder."""

    def text(clip: Clip) -> str:
        content, said = bvh_text(clip)
        if said:
            notes.repaired.append((clip.name, said))
        return content

    if path.suffix.lower() == ".bvh":
        written = 0

        def write(clip: Clip) -> None:
            nonlocal written
            written += 1
            if written > 1:
                raise InputError(f"{path}: a BVH file holds one clip, but there are more. Give a folder.")
            beside.write_text(text(clip), encoding="utf-8")

        with staged_file(path, overwrite) as beside:
            yield write
        return
    with staged_folder(path, overwrite) as folder:
        free = _Names(notes)

        def add(clip: Clip) -> None:
            person = Path(safe_name(clip.subject)) if clip.subject else Path()
            clip = free.named(clip, person)
            file = folder / safe_name(clip.label or UNLABELLED) / person / clip_path(clip, ".bvh").name
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text(clip), encoding="utf-8")

        yield add


class _Names:
    """Gives clips of one name in one folder names of their own, so that none replaces another.

    Args:
        notes: Is told of every clip that gets another name.
    """

    def __init__(self, notes: Notes) -> None:
        self._taken: set[str] = set()
        self._notes = notes

    def named(self, clip: Clip, folder: Path) -> Clip:
        """Return the clip, with another name if its own is taken."""
        wanted, count = clip.name, 1
        # Without case, since some file systems do not see it.
        while (key := str(folder / clip_path(clip, "")).casefold()) in self._taken:
            count += 1
            clip = replace(clip, name=f"{wanted}_{count}")
        self._taken.add(key)
        if count > 1:
            self._notes.repaired.append((wanted, f"written as {clip.name}: the name was taken"))
        return clip


WRITERS: dict[str, Writer] = {
    "folder": Writer("folder of wigwag's clips", _write_folder),
    "parquet": Writer("Parquet table", lambda path, overwrite, _: write_parquet(path, overwrite)),
    "bvh": Writer("BVH", _write_bvh),
}
"""Every form that can be written."""


def reader_for(path: Path, name: str | None = None) -> str:
    """Say which reader fits a path.

    Args:
        path: File or folder.
        name: What the user says it is; ``None``: it is looked at.

    Raises:
        InputError: If there is nothing at ``path``, no such reader, none fits, or several do.
    """
    if name is not None:
        return _known(name, READERS, "source format")
    if not path.exists():
        raise InputError(f"{path}: no such file or folder.")
    fits = [key for key, reader in READERS.items() if reader.knows(path)]
    if len(fits) != 1:
        found = f"could be {' or '.join(fits)}" if fits else "is of no known form"
        known = "; ".join(f"{key} ({', '.join(reader.patterns)})" for key, reader in READERS.items())
        raise InputError(f"{path}: {found}. Say which with --source-format. Known: {known}.")
    return fits[0]


def writer_for(path: Path, name: str | None = None) -> str:
    """Say which writer fits a target: by its ending, and a folder of clips where it has none.

    Raises:
        InputError: If there is no such writer, or the ending is another one.
    """
    if name is not None:
        return _known(name, WRITERS, "target format")
    endings = {".parquet": "parquet", ".bvh": "bvh", "": "folder"}
    ending = "" if path.is_dir() else path.suffix.lower()
    if ending not in endings:
        raise InputError(
            f"{path}: no form is known by the ending {ending}. Give a folder's name, a .parquet or a .bvh "
            "file, or say --target-format."
        )
    return endings[ending]


def _known(name: str, table: Collection[str], what: str) -> str:
    if name not in table:
        raise InputError(f"{what} must be one of {', '.join(table)}, but got {name!r}.")
    return name


__all__ = ["READERS", "WRITERS", "Options", "Reader", "Writer", "reader_for", "writer_for"]
