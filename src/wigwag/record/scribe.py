"""Writes for somebody who may be killed: a process of its own, which finishes what it was given.

A ``kill -9`` stops a process in the middle of a write. This one is handed every write as a whole through a
pipe, carries it out or drops what did not arrive whole, and ends when whoever hands over is gone. It imports
nothing of wigwag: the file is run by itself, as ``python -I -S scribe.py FD``, so that it is there in 20 ms
and stays small.
"""

from __future__ import annotations

import os
import struct
import subprocess
import sys
from pathlib import Path
from typing import BinaryIO

_HEAD = struct.Struct("<QQ")
"""Where in the file, and how many bytes follow."""


class Scribe:
    """Hands writes over to a process that a kill of this one leaves alone.

    Args:
        file: Descriptor of the open file; it may be closed here afterwards.
    """

    def __init__(self, file: int) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-I", "-S", str(Path(__file__).resolve()), str(file)],
            stdin=subprocess.PIPE,
            stderr=subprocess.PIPE,
            pass_fds=(file,),
            start_new_session=True,  # neither Ctrl-C nor a closed terminal is meant for it
        )

    def write(self, offset: int, data: bytes) -> None:
        """Hand over one write.

        Raises:
            OSError: If an earlier one could not be carried out, such as on a full disk.
        """
        pipe = self._process.stdin
        assert pipe is not None
        try:
            pipe.write(_HEAD.pack(offset, len(data)))
            pipe.write(data)
            pipe.flush()
        except BrokenPipeError:
            self._fail()

    def close(self) -> None:
        """Wait until everything is written.

        Raises:
            OSError: If something could not be.
        """
        pipe = self._process.stdin
        assert pipe is not None
        try:
            pipe.close()
        except BrokenPipeError:
            self._fail()
        if self._process.wait():
            self._fail()

    def _fail(self) -> None:
        self._process.wait()
        errors = self._process.stderr
        said = errors.read().decode(errors="replace").strip() if errors is not None else ""
        number, _, text = said.partition(" ")
        known = number.isdigit()
        raise OSError(int(number) if known else 0, text if known else said or "what writes it was killed")


def serve(pipe: BinaryIO, file: int) -> int:
    """Carry out writes until whoever hands them over is gone; return 0, or 1 after a failure."""
    while len(head := pipe.read(_HEAD.size)) == _HEAD.size:
        offset, length = _HEAD.unpack(head)
        data = memoryview(pipe.read(length))
        if len(data) < length:
            return 0
        try:
            while data:
                done = os.pwrite(file, data, offset)
                data, offset = data[done:], offset + done
        except OSError as error:
            sys.stderr.write(f"{error.errno} {error.strerror}")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(serve(sys.stdin.buffer, int(sys.argv[1])))
