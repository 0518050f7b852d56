"""One thread, or one core, for everything that is timed or compared."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold numpy's, scikit-learn's and numba's thread pools to one thread."""
    import numba
    from threadpoolctl import threadpool_limits

    threads = numba.get_num_threads()
    numba.set_num_threads(1)
    try:
        with threadpool_limits(limits=1):
            yield
    finally:
        numba.set_num_threads(threads)


@contextmanager
def one_core() -> Iterator[None]:
    """Hold this thread, and all that are started from here, to one core; OpenCV to one thread.

    For what brings threads of its own that cannot be counted otherwise. Where a system cannot bind threads to
    a core (macOS, Windows), they are left free.
    """
    import cv2

    threads = cv2.getNumThreads()
    allowed = os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else set()
    cv2.setNumThreads(1)
    if allowed:
        os.sched_setaffinity(0, {max(allowed)})
    try:
        with one_thread():
            yield
    finally:
        cv2.setNumThreads(threads)
        if allowed:
            os.sched_setaffinity(0, allowed)


__all__ = ["one_core", "one_thread"]
