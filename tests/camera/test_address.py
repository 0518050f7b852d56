import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.camera.address import parse
from wigwag.errors import InputError


def test_an_address_is_taken_apart():
    a = parse("bag:/data/fly by?color=/camera/color&depth=/d&aligned=1", ["color", "depth", "aligned"])
    assert (a.kind, a.target) == ("bag", "/data/fly by")
    assert (a.text("color"), a.text("depth"), a.text("info", "none")) == ("/camera/color", "/d", "none")
    assert a.flag("aligned") is True


def test_a_url_keeps_what_is_its_own():
    a = parse("webcam:rtsp://u:p@h:554/s?channel=1&width=640&subtype=0", ["width"])
    assert a.target == "rtsp://u:p@h:554/s?channel=1&subtype=0"
    assert a.whole("width", 0) == 640


@given(st.text(alphabet=st.characters(exclude_characters="?&=%"), max_size=20))
def test_targets_stay_as_they_are(target):
    assert parse(f"video:{target}?hfov_deg=60", ["hfov_deg"]).target == target


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("sim:?sed=1", "has no option 'sed'. sim: takes noise, seed"),
        ("sim:?seed", "must be given once, with a value"),
        ("sim:?seed=", "must be given once, with a value"),
        ("sim:?seed=1&seed=2", "must be given once"),
    ],
)
def test_wrong_options_say_what_there_is(text, what):
    with pytest.raises(InputError) as error:
        parse(text, ["seed", "noise"])
    assert what in str(error.value)


@pytest.mark.parametrize("value", ["a", "nan", "inf", "1.5", "1e400"])
def test_values_of_the_wrong_kind(value):
    address = parse(f"sim:?seed={value}", ["seed"])
    with pytest.raises(InputError, match=r"sim: \?seed= must be a"):
        address.whole("seed", 1)
    with pytest.raises(InputError, match="must be 0 or 1"):
        address.flag("seed")


def test_defaults_hold_when_nothing_is_said():
    a = parse("sim:", ["seed"])
    assert (a.target, a.options) == ("", {})
    assert (a.number("seed", 2.5), a.whole("seed", 3), a.flag("seed", True)) == (2.5, 3, True)
