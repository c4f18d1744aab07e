"""Processor seconds of each test: `python -m pytest -n 0 -p tests.support.processor_seconds tests/FOLDER`.

They are those of this process and of the processes that ended in it, so that other work on the machine, which
`--durations` counts too, distorts them little. A fixture counts for the first test that asks for it.
"""

import collections
import os
from collections.abc import Generator

import pytest

#: Files and tests that are listed, by their seconds.
LISTED = 30
_SECONDS = collections.defaultdict[str, float](float)


def spent() -> float:
    """s of the processor, of this process and of its children that ended."""
    return sum(os.times()[:4])


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, bool | None, bool | None]:
    """Counts a test with its fixtures."""
    before = spent()
    try:
        return (yield)
    finally:
        _SECONDS[item.nodeid] += spent() - before


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Lists the files and the tests that took longest."""
    files = collections.defaultdict[str, float](float)
    for name, seconds in _SECONDS.items():
        files[name.partition("::")[0]] += seconds
    total = sum(_SECONDS.values())
    terminalreporter.section(f"{total:.1f} s of processor in {len(_SECONDS):,} tests, {spent() - total:.1f} s beside")
    for table in (files, _SECONDS):
        for name, seconds in sorted(table.items(), key=lambda row: -row[1])[:LISTED]:
            terminalreporter.line(f"{seconds:8.1f} s  {name}")
        terminalreporter.line("")
