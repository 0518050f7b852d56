import pytest

from wigwag.errors import InputError, ModelError
from wigwag.evaluate.monocular import MonocularBenchmarkConfig, measure_monocular
from wigwag.pose.blazepose import BlazePose


@pytest.fixture(scope="module")
def networks() -> None:
    try:
        BlazePose()
    except ModelError as error:
        pytest.skip(f"the pose networks are not here: {error}")


@pytest.mark.usefixtures("networks")
def test_three_ways_stand_beside_each_other() -> None:
    done: list[int] = []
    rows = measure_monocular(MonocularBenchmarkConfig(1, (4.0,), 0.5, seed=3), done.append)
    assert done == [1]
    assert [row["way"] for row in rows] == ["depth", "stature stated", "stature unknown"]
    for row in rows:
        assert (row["frames"], row["distance_m"], row["people"]) == (15, 4.0, 1)
        assert row["found"] > 0.9
    by_depth, stated, unknown = rows
    assert by_depth["distance_error_median"] < 0.02
    assert by_depth["distance_error_median"] < stated["distance_error_p95"] < 0.15
    assert unknown["distance_error_p95"] < 0.25


@pytest.mark.parametrize("fields", [{"people": 0}, {"seconds": 0.0}, {"distances_m": ()}])
def test_faults(fields: dict) -> None:
    with pytest.raises(InputError, match="needs people, distances and seconds"):
        MonocularBenchmarkConfig(**fields)
