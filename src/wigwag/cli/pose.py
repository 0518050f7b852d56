"""``wigwag pose``: find the body in pictures and draw it."""

from __future__ import annotations

import json as json_format
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import tyro

from wigwag.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    from jaxtyping import UInt8

    from wigwag.pose.body import Body


@dataclass(frozen=True)
class PoseCommand:
    """Find a whole body in each picture, draw it, and write its 33 landmarks as JSON.

    Example: wigwag pose photo.jpg --out drawn --json bodies.json
    """

    images: tyro.conf.Positional[tuple[Path, ...]]
    """Pictures: JPEG, PNG, or whatever else OpenCV reads."""
    out: Path = Path("out/pose")
    """Folder for the drawn pictures."""
    json: Path | None = None
    """File for a list of records, one a picture: {"file", "found", "landmarks_px", "visibility", ...}."""
    engine: Literal["litert", "mediapipe"] = "litert"
    """What runs the networks; 'mediapipe' needs the extra of that name."""
    model: Literal["lite", "full", "heavy"] = "full"
    """Landmark network."""
    models_dir: Path | None = None
    """Folder with the network files; by default they are looked for and fetched once."""
    names: bool = True
    """Write the landmarks' names beside them."""

    def run(self) -> int:
        """Work through the pictures; return 0, or 2 if one of them could not be read."""
        from rich.console import Console
        from rich.progress import track

        from wigwag.pose.engine import open_engine

        if not self.images:
            raise InputError("No picture was given. Name one or more: wigwag pose photo.jpg --out DIR")
        _make_folder(self.out)
        finder = open_engine(self.engine, self.model, self.models_dir)
        errors = Console(stderr=True)
        records, faults = [], []
        drawn = _drawn_paths(self.images, self.out)
        for path in track(self.images, "finding bodies", console=errors, transient=True):
            try:
                picture = read_picture(path)
            except InputError as error:
                faults.append(str(error))
                records.append(_record(path, None, str(error)))
                continue
            body = finder.detect(picture)
            self._draw(picture, body, path, drawn[path])
            records.append(_record(path, body, None))
        if self.json:
            _write_json(self.json, records)
        self._summarise(records, len(faults))
        for fault in faults:
            errors.print("[bold red]error:[/]", end=" ")
            errors.print(fault, highlight=False, markup=False, soft_wrap=True)
        return 2 if faults else 0

    def _draw(self, picture: UInt8[np.ndarray, "h w 3"], body: Body | None, path: Path, out: Path) -> None:
        import cv2

        from wigwag.view.draw import MISSING, draw_banner, draw_body

        if body is None:
            draw_banner(picture, "nobody found", path.name, MISSING)
        else:
            draw_body(picture, body, self.names)
            clarity = "" if body.clarity is None else f"clarity {body.clarity:.2f}"
            draw_banner(picture, "body found", clarity)
        if not cv2.imwrite(str(out), cv2.cvtColor(picture, cv2.COLOR_RGB2BGR)):
            raise InputError(f"{out}: the drawn picture cannot be written; choose another folder with --out.")

    def _summarise(self, records: list[dict[str, Any]], n_faults: int) -> None:
        from rich.console import Console
        from rich.table import Table

        table = Table(title="Bodies in pictures")
        for column in ("pictures", "found", "nobody", "unreadable", "found %"):
            table.add_column(column, justify="right")
        read = len(records) - n_faults
        found = sum(record["found"] for record in records)
        share = f"{100 * found / read:.1f}" if read else "-"
        table.add_row(str(len(records)), str(found), str(read - found), str(n_faults), share)
        console = Console()
        console.print(table)
        for record in records:
            if not record["found"] and record["error"] is None:
                console.print(
                    f"nobody found: {record['file']}", markup=False, highlight=False, soft_wrap=True
                )
        console.print(f"drawn pictures: {self.out}", markup=False, highlight=False, soft_wrap=True)
        if self.json:
            console.print(f"records: {self.json}", markup=False, highlight=False, soft_wrap=True)


def read_picture(path: Path) -> UInt8[np.ndarray, "height width 3"]:
    """Read a picture file as RGB.

    Raises:
        InputError: If there is no such file, it cannot be read, or it is no picture.
    """
    import cv2
    import numpy as np

    expected = "Expected a picture file such as JPEG or PNG."
    if path.is_dir():
        raise InputError(f"{path}: is a folder. {expected} Name the pictures in it: {path}/*.jpg")
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: there is no such file. {expected}") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}). {expected}") from error
    try:
        picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR) if data else None
    except cv2.error:
        picture = None
    if picture is None:
        raise InputError(
            f"{path}: is no picture that can be read ({len(data)} bytes). {expected} "
            "Check that the file is whole and not another kind of file by that name."
        )
    return np.asarray(cv2.cvtColor(picture, cv2.COLOR_BGR2RGB))


def _record(path: Path, body: Body | None, error: str | None) -> dict[str, Any]:
    from wigwag import __version__

    return {
        "file": str(path),
        "found": body is not None,
        "landmarks_px": None if body is None else body.points_px.round(2).tolist(),
        "visibility": None if body is None else body.visibility.round(4).tolist(),
        "score": None if body is None or body.score is None else round(body.score, 4),
        "clarity": None if body is None or body.clarity is None else round(body.clarity, 4),
        "error": error,
        "command": "wigwag pose",
        "seed": None,
        "version": __version__,
    }


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"{folder}: cannot be made a folder for the drawn pictures ({error.strerror}). "
            "Choose another one with --out."
        ) from error


def _drawn_paths(images: tuple[Path, ...], out: Path) -> dict[Path, Path]:
    """Give every picture a file name of its own in ``out``, though pictures of two folders may share one."""
    paths: dict[Path, Path] = {}
    taken: set[str] = set()
    for image in images:
        if image in paths:
            continue
        stem, parent = image.stem, image.absolute().parent.name
        choices = [stem, f"{parent}_{stem}", *(f"{parent}_{stem}_{n}" for n in range(2, len(images) + 2))]
        name = next(choice for choice in choices if choice not in taken)
        taken.add(name)
        paths[image] = out / f"{name}.jpg"
    return paths


def _write_json(path: Path, records: list[dict[str, Any]]) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json_format.dumps(records, indent=1) + "\n")
    except OSError as error:
        raise InputError(f"{path}: the records cannot be written ({error.strerror}).") from error


__all__ = ["PoseCommand", "read_picture"]
