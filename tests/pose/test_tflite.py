"""Networks that compute less, and files that are none."""

from __future__ import annotations

import numpy as np
import pytest
from ai_edge_litert.interpreter import Interpreter
from hypothesis import given
from hypothesis import strategies as st

from wigwag.errors import ModelError
from wigwag.pose.tflite import only_outputs

HEAT, WORLD, MASK = (1, 64, 64, 39), (1, 117), (1, 256, 256, 1)


def answers(network: bytes, picture: np.ndarray) -> dict[tuple[int, ...], np.ndarray]:
    interpreter = Interpreter(model_content=network, num_threads=1)
    interpreter.allocate_tensors()
    interpreter.set_tensor(interpreter.get_input_details()[0]["index"], picture)
    interpreter.invoke()
    outputs = interpreter.get_output_details()
    return {tuple(map(int, o["shape"])): interpreter.get_tensor(o["index"]) for o in outputs}


def operators(network: bytes) -> int:
    return len(Interpreter(model_content=network)._get_ops_details())


def test_what_is_kept_is_computed_bit_for_bit_and_less_is_computed(landmark_network: bytes) -> None:
    picture = np.random.default_rng(0).random((1, 256, 256, 3), dtype=np.float32)
    less = only_outputs(landmark_network, [HEAT, WORLD])
    expected, got = answers(landmark_network, picture), answers(less, picture)
    assert MASK in expected
    assert set(got) == {HEAT, WORLD}
    for shape, values in got.items():
        np.testing.assert_array_equal(values, expected[shape])
    assert operators(less) < operators(landmark_network) - 20
    assert less.endswith(landmark_network + bytes(-len(landmark_network) % 64)), (
        "the network's own bytes stay"
    )


def test_an_output_that_is_not_there(landmark_network: bytes) -> None:
    with pytest.raises(ModelError, match=r"No output has shape \(1, 7\); there are \[\(1, 1\), .*version"):
        only_outputs(landmark_network, [(1, 7)])


@pytest.mark.parametrize("data", [b"", b"no network", b"\x1c\x00\x00\x00TFL4" + bytes(64)])
def test_no_network(data: bytes) -> None:
    with pytest.raises(ModelError, match="Expected a TensorFlow Lite network"):
        only_outputs(data, [HEAT])


@given(st.binary(max_size=200))
def test_any_bytes_after_the_mark_are_refused(rest: bytes) -> None:
    with pytest.raises(ModelError):
        only_outputs(b"\x08\x00\x00\x00TFL3" + rest, [HEAT])


@pytest.mark.parametrize("share", [0.001, 0.3, 0.9, 0.99])
def test_a_cut_network_is_refused(landmark_network: bytes, share: float) -> None:
    """Its tables stand behind its weights: what is cut off is missed."""
    with pytest.raises(ModelError):
        only_outputs(landmark_network[: int(share * len(landmark_network))], [HEAT])


def test_the_detector_is_a_network_too(detection_network: bytes) -> None:
    boxes = only_outputs(detection_network, [(1, 2254, 12)])
    assert set(answers(boxes, np.zeros((1, 224, 224, 3), np.float32))) == {(1, 2254, 12)}
