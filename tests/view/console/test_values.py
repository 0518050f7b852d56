"""What comes back from the page: a few known wishes, and nothing else."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wigwag.errors import InputError
from wigwag.fly.values import Command
from wigwag.view.console.slot import Slot
from wigwag.view.console.values import NAME_MOST, Ask, Button


@pytest.mark.parametrize(
    "ask", [*map(Ask, Button), Ask(None, "ceiling_m", 2.5), Ask(teach="salute"), Ask(teach="")]
)
def test_what_is_asked_for_comes_back_as_it_went(ask: Ask) -> None:
    assert Ask.from_json(ask.to_json()) == ask


@pytest.mark.parametrize(
    "data",
    [
        b"", b"{}", b"[]", b"1", b"null", b'{"button": "arm"}', b'{"button": "take_off"}',
        b'{"button": "stop", "limit": "x", "value": 1}', b'{"limit": "x", "value": NaN}',
        b'{"limit": "x", "value": "fast"}', b'{"limit": "x"}', b"\xff",
        b'{"teach": 1}', b'{"teach": null}', b'{"teach": ["a"]}', b'{"teach": "a", "button": "stop"}',
        b'{"teach": "a", "limit": "x", "value": 1}',
    ],
)  # fmt: skip
def test_anything_else_is_refused(data: bytes) -> None:
    with pytest.raises(InputError, match="nothing that the console's page can ask for"):
        Ask.from_json(data)


@given(st.binary(max_size=80))
def test_whatever_comes_is_read_or_refused(data: bytes) -> None:
    try:
        ask = Ask.from_json(data)
    except InputError:
        return
    assert ask.button in (None, *Button)


@given(st.text(max_size=5000))
def test_a_name_of_any_length_fits_its_way(name: str) -> None:
    data = Ask(teach=name).to_json()
    assert len(data) < 4096, "what is longer would close the link"
    assert Ask.from_json(data).teach == name[:NAME_MOST]


def test_a_later_wish_about_the_same_replaces_the_earlier_one() -> None:
    assert Ask(teach="a").about == Ask(teach="b").about
    others = {Ask(teach="stop").about, Ask(Button.STOP).about, Ask(None, "stop", 1.0).about}
    assert len(others) == 3, "and nothing else is replaced by it"


def test_no_button_arms_or_takes_off() -> None:
    assert not {button.value for button in Button} & {"arm", Command.TAKE_OFF.value}


def test_a_slot_gives_the_newest_and_ends() -> None:
    slot: Slot[int] = Slot()
    for value in range(5):
        slot.put(value)
    assert (slot.take(), slot.replaced) == (4, 4)
    slot.close()
    assert slot.take() is None
