"""The compiled inner loops of dynamic time warping, across many references at a time.

The recurrence of DTW cannot be vectorised along one pair of sequences: each cell waits for its neighbour.
Across references it can. 32 references in float32, 16 in float64, lie side by side as lanes, so that one
feature of one frame of all of them is a row of 128 bytes: eight registers of SSE or NEON, four of AVX2, two
of AVX-512. The lanes of a cell's cost stay in registers over all features.

Everything here trusts its arguments; :mod:`wigwag.distances.packed` checks them. Vector instructions and
the loops that use them stand in one file, since numba's cache of a function looks at its own file alone.
"""

# ruff: noqa: PLR0917  (compiled functions are called by position)
from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from llvmlite.binding import get_host_cpu_features
from numba import njit, types
from numba.core import cgutils
from numba.extending import intrinsic

_ROW_BYTES = 128
"""One feature of one frame, all lanes. With two rows of sums, 8 of AVX2's 16 registers are taken."""

_ROWS = 2
"""Query frames that meet a reference's frame at once, so that it is loaded once for both."""

_MORE_ROWS = 4 if get_host_cpu_features().get("avx512f") else _ROWS
"""As many again where there are 32 registers of 64 bytes to hold the sums."""

_CHUNK = 128
"""Features of a frame, all lanes, that stay in the first cache (16 KiB) while the query's frames pass by."""

_FIRST_LOOK = 3
"""References beyond k that are looked at first; what they give decides how many follow."""

FAR = 1e30
"""Stands for 'no path'; fastmath must not meet infinity."""


def lanes_of(dtype: Any) -> int:
    """Return how many references of this floating point type stand side by side."""
    return int(_ROW_BYTES // np.dtype(dtype).itemsize)


@intrinsic
def _lanes(context, array):  # type: ignore[no-untyped-def]  # numba's protocol
    """Return ``lanes_of(array.dtype)`` as a constant, so that loops over lanes have a known length."""
    lanes = lanes_of(str(array.dtype))

    def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        return ir.Constant(context.get_value_type(types.intp), lanes)

    return types.intp(array), code


def _least(builder: Any, a: Any, b: Any) -> Any:
    return builder.select(builder.fcmp_ordered("<", a, b, flags=["fast"]), a, b)


def _most(builder: Any, a: Any, b: Any) -> Any:
    return builder.select(builder.fcmp_ordered(">", a, b, flags=["fast"]), a, b)


def _zeros(vector: Any) -> Any:
    return ir.Constant(vector, [0.0] * vector.count)


def _lane_row(builder: Any, pointer: Any, row: Any, vector: Any) -> Any:
    """Return a pointer to row ``row`` of lanes."""
    width = ir.Constant(row.type, vector.count)
    return builder.bitcast(builder.gep(pointer, [builder.mul(row, width)]), vector.as_pointer())


def _gap(builder: Any, low: Any, high: Any, theirs: Any, box: bool) -> Any:
    """Return by how much ``theirs`` misses the point ``low``, or the box from ``low`` to ``high``."""
    below = builder.fsub(low, theirs, flags=["fast"])
    if not box:
        return below
    above = builder.fsub(theirs, high, flags=["fast"])
    return _most(builder, _most(builder, below, above), _zeros(below.type))


def _squares(box: bool, rows: int) -> Any:
    """Make the function that adds up squared distances of ``rows`` query frames to one frame of all lanes.

    It goes over the features from ``start`` to ``stop``; from 0 on, ``out`` is set, else added to. Written
    as vector instructions, since LLVM does not find them itself in a loop over features within which a
    loop over lanes keeps its sums in registers.
    """

    @intrinsic
    def squares(context, low, high, row, frame, start, stop, out):  # type: ignore[no-untyped-def]
        lanes = lanes_of(str(frame.dtype))

        def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            vector = ir.VectorType(context.get_data_type(frame.dtype), lanes)
            whole = context.get_value_type(types.intp)
            nowhere = ir.Constant(vector, ir.Undefined)
            first = ir.Constant(ir.VectorType(ir.IntType(32), lanes), [0] * lanes)
            align = frame.dtype.bitwidth // 8
            lows, highs, frames, outs = (
                context.make_array(kind)(context, builder, arguments[at])
                for kind, at in ((low, 0), (high, 1), (frame, 3), (out, 6))
            )
            features = builder.extract_value(lows.shape, 1)

            def spread(pointer: Any, row: Any, feature: Any) -> Any:
                value = builder.load(builder.gep(pointer, [builder.add(builder.mul(row, features), feature)]))
                one = builder.insert_element(nowhere, value, ir.Constant(ir.IntType(32), 0))
                return builder.shuffle_vector(one, nowhere, first)

            some = [builder.add(arguments[2], ir.Constant(whole, k)) for k in range(rows)]
            sums = [cgutils.alloca_once(builder, vector) for _ in some]
            fresh = builder.icmp_signed("==", arguments[4], ir.Constant(whole, 0))
            for k, total in zip(some, sums, strict=True):
                old = builder.load(_lane_row(builder, outs.data, k, vector), align=align)
                builder.store(builder.select(fresh, _zeros(vector), old), total)
            with cgutils.for_range_slice(builder, arguments[4], arguments[5], ir.Constant(whole, 1)) as (
                f,
                _,
            ):
                theirs = builder.load(_lane_row(builder, frames.data, f, vector), align=align)
                for k, total in zip(some, sums, strict=True):
                    mine = spread(lows.data, k, f)
                    upper = spread(highs.data, k, f) if box else mine
                    step = _gap(builder, mine, upper, theirs, box)
                    square = builder.fmul(step, step, flags=["fast"])
                    builder.store(builder.fadd(builder.load(total), square, flags=["fast"]), total)
            for k, total in zip(some, sums, strict=True):
                builder.store(builder.load(total), _lane_row(builder, outs.data, k, vector), align=align)
            return context.get_dummy_value()

        return types.void(low, high, row, frame, start, stop, out), code

    return squares


_box_squares = _squares(box=True, rows=_ROWS)
_point_squares, _more_point_squares = _squares(False, _ROWS), _squares(False, _MORE_ROWS)


def _steps(root: bool) -> Any:
    """Make the function that writes one cell of the recurrence, all lanes."""

    @intrinsic
    def step(context, costs, before, line, j):  # type: ignore[no-untyped-def]
        def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            vector = ir.VectorType(context.get_data_type(costs.dtype), lanes_of(str(costs.dtype)))
            align = costs.dtype.bitwidth // 8
            local, above, own = (
                context.make_array(kind)(context, builder, arguments[at]).data
                for kind, at in ((costs, 0), (before, 1), (line, 2))
            )
            here = arguments[3]
            after = builder.add(here, ir.Constant(here.type, 1))

            def load(pointer: Any, row: Any) -> Any:
                return builder.load(_lane_row(builder, pointer, row, vector), align=align)

            cost = load(local, here)
            if root:
                kind = ir.FunctionType(vector, [vector])
                name = f"llvm.sqrt.v{vector.count}f{costs.dtype.bitwidth}"
                cost = builder.call(cgutils.get_or_insert_function(builder.module, kind, name), [cost])
            best = _least(builder, _least(builder, load(above, here), load(above, after)), load(own, here))
            total = builder.fadd(cost, best, flags=["fast"])  # eq. DTW
            builder.store(total, _lane_row(builder, own, after, vector), align=align)
            return context.get_dummy_value()

        return types.void(costs, before, line, j), code

    return step


_step_root, _step_square = _steps(root=True), _steps(root=False)


@njit(cache=True, fastmath=True, error_model="numpy")
def _relax(costs, before, line, start, stop, at, limits, narrowest, squared):  # type: ignore[no-untyped-def]
    """Advance the recurrence of DTW by one reference frame, ``at``, for all lanes.

    ``costs[j]`` are squared distances to frame ``j`` of the query; ``line[j + 1]`` becomes the cost of the
    best path that ends there, ``before`` being the line of frame ``at - 1``. Lane ``l`` reaches only
    ``|j - at| <= limits[l]``; ``narrowest`` is the least of the limits.
    """
    lanes = _lanes(costs)
    far = costs.dtype.type(FAR)
    line[start] = far
    for j in range(start, stop):
        if squared:
            _step_square(costs, before, line, j)
        else:
            _step_root(costs, before, line, j)
        off = abs(j - at)
        if off > narrowest:
            for lane in range(lanes):
                if off > limits[lane]:
                    line[j + 1, lane] = far
    if stop + 1 < len(line):
        line[stop + 1] = far


@njit(cache=True, fastmath=True, error_model="numpy")
def _reach(n, lengths, band, limits):  # type: ignore[no-untyped-def]
    """Widen the band to the difference of the lengths, lane by lane; return the least and the largest."""
    narrowest = widest = max(band, abs(n - lengths[0]))
    for lane in range(len(lengths)):
        limits[lane] = max(band, abs(n - lengths[lane]))
        narrowest, widest = min(narrowest, limits[lane]), max(widest, limits[lane])
    return narrowest, widest


@njit(cache=True, fastmath=True, error_model="numpy")
def _warp(query, block, lengths, band, squared, lines, costs, ends):  # type: ignore[no-untyped-def]
    """Write into ``ends`` the DTW distance of a query to each reference of one block.

    Args:
        query: One frame a row, and one row more, since rows are read in pairs.
        block: References (frames, features, lanes), padded at the end.
        lengths: Frames of each lane's reference.
        band: Sakoe-Chiba band, frames; per lane it is widened to the difference of the lengths.
        squared: Local cost is the squared Euclidean distance.
        lines: Scratch (2, query rows, lanes).
        costs: Scratch (query rows, lanes).
        ends: The result, one a lane.
    """
    n, features, lanes = len(query) - 1, query.shape[1], _lanes(block)
    before, line = lines[0], lines[1]
    before[:] = block.dtype.type(FAR)
    before[0] = 0
    limits = np.empty(lanes, np.int64)
    narrowest, widest = _reach(n, lengths, band, limits)
    for t in range(len(block)):
        start, stop = max(0, t - widest), min(n, t + widest + 1)
        for feature in range(0, features, _CHUNK):
            upto = min(feature + _CHUNK, features)
            i = start
            while i + _MORE_ROWS <= stop:
                _more_point_squares(query, query, i, block[t], feature, upto, costs)
                i += _MORE_ROWS
            while i < stop:
                _point_squares(query, query, i, block[t], feature, upto, costs)
                i += _ROWS
        _relax(costs, before, line, start, stop, t, limits, narrowest, squared)
        before, line = line, before
        for lane in range(lanes):
            if lengths[lane] == t + 1:
                ends[lane] = before[n, lane]


@njit(cache=True, fastmath=True, error_model="numpy")
def warp_all(query, data, starts, lengths, band, squared, ends):  # type: ignore[no-untyped-def]
    """Warp a query (its last row is padding) against all blocks; block ``b`` begins at ``starts[b]``."""
    lanes = _lanes(data)
    lines = np.empty((2, len(query), lanes), data.dtype)
    costs = np.empty((len(query), lanes), data.dtype)
    for b in range(len(starts) - 1):
        some = slice(b * lanes, (b + 1) * lanes)
        _warp(query, data[starts[b] : starts[b + 1]], lengths[some], band, squared, lines, costs, ends[some])


@njit(cache=True, fastmath=True, error_model="numpy")
def bound_all(query, width, data, starts, lengths, band, squared, ends):  # type: ignore[no-untyped-def]
    """Write a lower bound of the DTW distance of a query to each reference of all blocks.

    ``width`` frames of the query at a time are replaced by the least box that holds them. A path through
    the frames, mapped to boxes, is a path through the boxes which visits each of its cells at least once,
    and in each pays no more than before: DTW over the boxes is a lower bound. With one box for the whole
    reach of the band it would be LB_Keogh (Keogh and Ratanamahatana 2005); a few boxes keep the order in
    time, which LB_Keogh forgets, and cost little more.
    """
    n, lanes, features = len(query) - 1, _lanes(data), query.shape[1]
    boxes = (n + width - 1) // width
    low = np.zeros((boxes + 1, features), data.dtype)
    high = np.zeros((boxes + 1, features), data.dtype)
    for i in range(n):
        for f in range(features):
            value, s = query[i, f], i // width
            low[s, f] = value if i % width == 0 else min(low[s, f], value)
            high[s, f] = value if i % width == 0 else max(high[s, f], value)
    lines = np.empty((2, boxes + 1, lanes), data.dtype)
    costs = np.empty((boxes + 1, lanes), data.dtype)
    limits = np.empty(lanes, np.int64)
    for b in range(len(starts) - 1):
        these = lengths[b * lanes : (b + 1) * lanes]
        _, widest = _reach(n, these, band, limits)
        before, line = lines[0], lines[1]
        before[:] = data.dtype.type(FAR)
        before[0] = 0
        for t in range(starts[b + 1] - starts[b]):
            start, stop = max(0, t - widest) // width, min(n - 1, t + widest) // width + 1
            for s in range(start, stop, _ROWS):
                _box_squares(low, high, s, data[starts[b] + t], 0, features, costs)
            _relax(costs, before, line, start, stop, t, limits, n + t, squared)
            before, line = line, before
            for lane in range(lanes):
                if these[lane] == t + 1:
                    ends[b * lanes + lane] = before[boxes, lane]


@njit(cache=True, fastmath=True, error_model="numpy")
def nearest(query, flat, offsets, order, bounds, band, squared, k):  # type: ignore[no-untyped-def]
    """Find the ``k`` nearest references, going through them in the order of their lower bounds.

    Args:
        query: As in ``_warp``.
        flat: All references' frames, one after the other.
        offsets: Reference ``r`` is ``flat[offsets[r] : offsets[r + 1]]``.
        order: References, least bound first.
        bounds: Lower bound of each reference.
        band: As in ``_warp``.
        squared: As in ``_warp``.
        k: How many; not more than ``order`` holds.

    Returns:
        Distances of the first so many of ``order``: those that had to be computed.
    """
    lanes, features = _lanes(flat), flat.shape[1]
    longest = 1
    for r in range(len(offsets) - 1):
        longest = max(longest, offsets[r + 1] - offsets[r])
    lines = np.empty((2, len(query), lanes), flat.dtype)
    costs = np.empty((len(query), lanes), flat.dtype)
    block = np.zeros((longest, features, lanes), flat.dtype)
    lengths, ends = np.ones(lanes, np.int64), np.zeros(lanes, flat.dtype)
    best = np.full(k, FAR)  # least first
    computed = np.empty(len(order), flat.dtype)
    at, some = 0, min(k + _FIRST_LOOK, lanes)
    while at < len(order) and bounds[order[at]] <= best[k - 1]:
        many, frames = 0, 1
        while many < some and at + many < len(order) and bounds[order[at + many]] <= best[k - 1]:
            first, stop = offsets[order[at + many]], offsets[order[at + many] + 1]
            for t in range(stop - first):
                for f in range(features):
                    block[t, f, many] = flat[first + t, f]
            lengths[many] = stop - first
            frames = max(frames, stop - first)
            many += 1
        for lane in range(many, lanes):
            lengths[lane] = lengths[0]
        _warp(query, block[:frames], lengths, band, squared, lines, costs, ends)
        for lane in range(many):
            computed[at + lane] = ends[lane]
            place = k
            while place > 0 and ends[lane] < best[place - 1]:
                place -= 1
            if place < k:
                for later in range(k - 1, place, -1):
                    best[later] = best[later - 1]
                best[place] = ends[lane]
        at += many
        some = lanes
    return computed[:at]


@njit(cache=True, fastmath=True, error_model="numpy")
def warp_chosen(query, store, chosen, band, squared, ends):  # type: ignore[no-untyped-def]
    """Warp a query (its last row is padding) against some of many references of one length.

    Args:
        query: As in ``_warp``.
        store: All references (references, frames, features).
        chosen: Which; a multiple of the lanes.
        band: As in ``_warp``.
        squared: As in ``_warp``.
        ends: The result, one for each of ``chosen``.
    """
    lanes, frames, features = _lanes(store), store.shape[1], store.shape[2]
    lines = np.empty((2, len(query), lanes), store.dtype)
    costs = np.empty((len(query), lanes), store.dtype)
    block = np.empty((frames, features, lanes), store.dtype)
    lengths = np.full(lanes, frames)
    for start in range(0, len(chosen), lanes):
        for lane in range(lanes):
            reference = store[chosen[start + lane]]
            for t in range(frames):
                for f in range(features):
                    block[t, f, lane] = reference[t, f]
        _warp(query, block, lengths, band, squared, lines, costs, ends[start : start + lanes])
