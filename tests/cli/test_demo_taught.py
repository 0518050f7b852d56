"""What is shown where a model of one's own flies the demo."""

from pathlib import Path

import pytest

from wigwag.cli.demo_taught import mapping_of, session_of
from wigwag.errors import InputError
from wigwag.fly.values import Command
from wigwag.sim.gestures import COMMANDS

MODEL = Path("mine.wigwag")
KNOWN = (*COMMANDS, "goalpost", "clap")


def test_a_session_takes_off_shows_what_is_named_and_lands():
    commands = mapping_of(["goalpost=orbit"])
    config = session_of(["goalpost"], commands, KNOWN, MODEL, 1)
    assert config.commands == ("take_off", "goalpost", "land")
    assert (config.repetitions, config.n_others, config.engage) == (1, 3, True)


def test_without_names_everything_that_commands_is_shown_and_is_no_distraction():
    config = session_of([], mapping_of(["clap=stop", "goalpost=orbit"]), KNOWN, MODEL, 2)
    assert set(config.commands) == set(KNOWN)
    assert (config.commands[0], config.commands[-1]) == ("take_off", "land")
    assert "clap" not in config.others
    assert config.n_others == 6


def test_gestures_command_what_is_said_beside_the_ten():
    assert mapping_of([]) == {command.value: command for command in Command}
    assert mapping_of(["goalpost=up"])["goalpost"] is Command.UP
    assert mapping_of(["goalpost=up"])["land"] is Command.LAND


@pytest.mark.parametrize(
    ("gestures", "pairs", "rounds", "message"),
    [
        (["goalpost"], [], 1, "goalpost commands nothing. Say what it commands: --commands goalpost=orbit"),
        (["hug"], ["hug=up"], 1, "mine.wigwag: does not know hug. It knows: clap, "),
        (["up"], [], 0, "--rounds must be 1 or more, but got 0."),
    ],
)
def test_what_cannot_be_flown_is_said(gestures, pairs, rounds, message):
    with pytest.raises(InputError) as error:
        session_of(gestures, mapping_of(pairs), KNOWN, MODEL, rounds)
    assert message in str(error.value)
