from wigwag.cli.doctor import check_extras


def test_extras_are_grouped_and_none_is_needed():
    lines = [
        "numpy>=1.26",
        "pytest>=1; extra == 'tests'",
        'hypothesis; extra == "tests"',
        "no-such-package-here>=2; python_version == '3.11' and extra == 'boats'",
    ]
    tests, boats = check_extras(lines)
    assert (tests.check, tests.state, tests.fix) == ("extra tests", "ok", "")
    assert "pytest" in tests.detail and "hypothesis" in tests.detail
    assert boats.state == "optional"
    assert boats.detail == "not installed: no-such-package-here"
    assert boats.fix == "python -m pip install 'wigwag[boats]'"


def test_the_extras_for_vehicles_are_known():
    names = {finding.check for finding in check_extras()}
    assert {"extra mavlink", "extra ros2"} <= names
