"""Models by their file alone."""

from pathlib import Path

import numpy as np
import pytest

from wigwag.errors import ModelError
from wigwag.recognise.store import kind_of, write
from wigwag.stream.models import load_model


def test_what_hears_no_stream_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "other.wigwag"
    write(path, "Kettle", {}, {"water": np.zeros(3)})
    assert kind_of(path) == "Kettle"
    with pytest.raises(ModelError, match="holds a Kettle, but expected one of StreamModel"):
        load_model(path)
    (tmp_path / "noise").write_bytes(b"noise")
    for name, says in (("noise", "not a model file"), ("nothing", "there is no such model file")):
        with pytest.raises(ModelError, match=says):
            load_model(tmp_path / name)
