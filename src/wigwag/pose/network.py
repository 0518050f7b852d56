"""One LiteRT network that takes a picture: load, fill, run, read."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from wigwag.errors import ModelError
from wigwag.pose.region import Region
from wigwag.pose.tflite import only_outputs


class PictureNetwork:
    """A network whose one input is a square RGB picture, run by LiteRT's XNNPACK kernels.

    Args:
        path: The ``.tflite`` file.
        threads: Threads of the interpreter.
        low: What a black pixel is to the network.
        high: What a white pixel is to the network.
        border: OpenCV's border mode for the part of a crop that lies outside of the picture.
        outputs: Shapes of the outputs that will be read; what leads to others alone is not computed. All by
            default.

    Raises:
        ModelError: If LiteRT cannot read the file, its input is no square RGB picture, or an output is not
            there.
    """

    def __init__(
        self,
        path: Path,
        threads: int,
        low: float,
        high: float,
        border: int,
        *,
        outputs: Sequence[tuple[int, ...]] | None = None,
    ) -> None:
        from ai_edge_litert.interpreter import Interpreter

        try:
            data = path.read_bytes() if outputs is None else only_outputs(path.read_bytes(), outputs)
            with native_stderr_closed():
                self._interpreter: Any = Interpreter(model_content=data, num_threads=threads)
                self._interpreter.allocate_tensors()
        except ModelError as error:
            raise ModelError(f"{path}: {error}") from error
        except (RuntimeError, ValueError, OSError) as error:
            raise ModelError(f"{path}: LiteRT cannot load this network ({error}).") from error
        entry = self._interpreter.get_input_details()[0]
        shape = tuple(int(n) for n in entry["shape"])
        if len(shape) != 4 or shape[1] != shape[2] or shape[3] != 3:
            raise ModelError(f"{path}: expected a network that takes (1, side, side, 3), but got {shape}.")
        self.pixels = shape[1]
        """Side of the input, pixels."""
        self._input = int(entry["index"])
        self._outputs = {
            tuple(int(n) for n in item["shape"]): int(item["index"])
            for item in self._interpreter.get_output_details()
        }
        self._path, self._border, self._low, self._gain = path, border, low, (high - low) / 255.0
        self._crop = np.empty((self.pixels, self.pixels, 3), np.uint8)

    def run(
        self, rgb: UInt8[np.ndarray, "height width 3"], region: Region, *, mirrored: bool = False
    ) -> None:
        """Cut ``region`` out of the picture, left and right exchanged if so wished, and run the network."""
        matrix = region.matrix(self.pixels)
        if mirrored:
            matrix[:, 2] += (self.pixels - 1) * matrix[:, 0]
            matrix[:, 0] *= -1.0
        cv2.warpAffine(
            rgb,
            matrix,
            (self.pixels, self.pixels),
            dst=self._crop,
            flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
            borderMode=self._border,
        )
        # The view into the interpreter's memory must be gone before it runs, hence no name for it.
        self._fill(self._interpreter.tensor(self._input)()[0])
        self._interpreter.invoke()

    def _fill(self, tensor: Float[np.ndarray, "side side 3"]) -> None:
        np.multiply(self._crop, np.float32(self._gain), out=tensor)
        if self._low:
            tensor += np.float32(self._low)

    def output(self, *shape: int) -> Float[np.ndarray, "..."]:
        """Return a copy of the output that has this shape; only what is asked for is read.

        Raises:
            ModelError: If the network has no output of that shape.
        """
        if (index := self._outputs.get(shape)) is None:
            raise ModelError(
                f"{self._path}: no output has shape {shape}; there are {sorted(self._outputs)}. "
                "Is it another network or version?"
            )
        return np.asarray(self._interpreter.get_tensor(index))


@contextmanager
def native_stderr_closed() -> Iterator[None]:
    """Keep the greetings of native libraries, which no setting turns off, out of the user's terminal."""
    try:
        sys.stderr.flush()
        kept = os.dup(2)
    except (OSError, AttributeError, ValueError):  # there is no standard error here
        yield
        return
    try:
        with open(os.devnull, "wb") as nowhere:
            os.dup2(nowhere.fileno(), 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
