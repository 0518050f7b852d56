"""``import wigwag`` is quick, and brings none of the heavy parts along until they are used."""

from __future__ import annotations

import json
import resource
import subprocess
import sys
from graphlib import TopologicalSorter

import grimp
import pytest

HEAVY = {"sklearn", "numba", "cv2", "matplotlib", "rotorpy", "scipy", "av", "ai_edge_litert", "rich", "tyro"}


def fresh(code: str) -> str:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout


def test_importing_wigwag_brings_no_heavy_part_along() -> None:
    loaded = json.loads(fresh("import wigwag, sys, json; print(json.dumps(list(sys.modules)))"))
    assert HEAVY & {name.partition(".")[0] for name in loaded} == set()
    assert "wigwag.pose" not in loaded and "wigwag.sim" not in loaded


@pytest.mark.parametrize("module", ["wigwag.fly.supervisor", "wigwag.cli.app", "wigwag.pilot"])
def test_what_decides_and_what_parses_does_not_wait_for_what_teaches_and_draws(module: str) -> None:
    loaded = json.loads(fresh(f"import {module}, sys, json; print(json.dumps(list(sys.modules)))"))
    assert {"sklearn", "numba", "cv2", "matplotlib", "rotorpy"} & set(loaded) == set()


def test_recognising_does_not_wait_for_what_only_teaching_elsewhere_and_drawing_need() -> None:
    loaded = json.loads(fresh("import wigwag.recognise, sys, json; print(json.dumps(list(sys.modules)))"))
    assert {"sklearn", "cv2", "matplotlib", "rotorpy", "scipy.optimize"} & set(loaded) == set()


def test_no_modules_import_each_other_in_a_circle() -> None:
    """Imports inside functions count, those for type checkers alone do not; the error names the circle."""
    graph = grimp.build_graph("wigwag", exclude_type_checking_imports=True)
    TopologicalSorter({m: graph.find_modules_directly_imported_by(m) for m in graph.modules}).prepare()


def test_importing_wigwag_is_quick() -> None:
    """Processor time, the least of three: below half a second on a desk machine, twice that anywhere."""

    def spent_s() -> float:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        fresh("import wigwag")
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime

    assert min(spent_s() for _ in range(3)) < 1.0
