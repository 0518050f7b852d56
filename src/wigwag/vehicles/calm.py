"""A process in which nothing keeps the thread that sends from sending."""

from __future__ import annotations

import gc
import sys

_SWITCH_S = 0.0005


def calm() -> None:
    """Let the thread that sends have the interpreter when its moment comes.

    Python lets a thread keep the interpreter for 5 ms while others wait. A full garbage collection keeps it
    for as long as it takes to look at every object there is: with the networks loaded 40 ms, and 300 ms and
    more where the processor is shared. What is there already is therefore left out of all collections to come
    (``gc.freeze``); it is in use until the flight ends. Takes as long as one collection.
    """
    sys.setswitchinterval(min(sys.getswitchinterval(), _SWITCH_S))
    gc.collect()
    gc.freeze()
