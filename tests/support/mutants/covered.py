"""A pytest plugin that writes down which lines each test runs: `-p tests.support.mutants.covered`.

Only in Python 3.12 and newer, whose `sys.monitoring` reports a line once and has no cost afterwards.
"""

import collections
import json
import os
import pathlib
import sys
from collections.abc import Iterator
from types import CodeType

import pytest

#: Folder for the files of this plugin, one for each process; and what names of followed files begin with.
OUT, PACKAGE = "MUTANTS_COVERAGE", "urbanverse_mjx/"
_TOOL = sys.monitoring.COVERAGE_ID


class Lines:
    """Lines of the package that ran since the last `begin`, and all of them by test."""

    def __init__(self, root: pathlib.Path) -> None:
        self._prefix = f"{root}/"
        self._now: set[tuple[str, int]] = set()
        self.tests: dict[str, dict[str, list[int]]] = {}
        self.seconds: dict[str, float] = collections.defaultdict(float)
        self.failed: set[str] = set()

    def seen(self, code: CodeType, line: int) -> object:
        name = code.co_filename.removeprefix(self._prefix)
        if name.startswith(PACKAGE):
            self._now.add((name, line))
        return sys.monitoring.DISABLE

    def begin(self) -> None:
        self._now.clear()
        sys.monitoring.restart_events()

    def end(self, test: str) -> None:
        found = collections.defaultdict[str, list[int]](list)
        for file, line in sorted(self._now):
            found[file].append(line)
        self.tests[test] = found


def pytest_configure(config: pytest.Config) -> None:
    lines = Lines(config.rootpath)
    sys.monitoring.use_tool_id(_TOOL, "mutants")
    sys.monitoring.register_callback(_TOOL, sys.monitoring.events.LINE, lines.seen)
    sys.monitoring.set_events(_TOOL, sys.monitoring.events.LINE)
    config.pluginmanager.register(_Recorder(lines))


class _Recorder:
    def __init__(self, lines: Lines) -> None:
        self._lines = lines

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self._lines.begin()
        result = yield
        self._lines.end(item.nodeid)
        return result

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self._lines.seconds[report.nodeid] += report.duration
        if report.failed:
            self._lines.failed.add(report.nodeid)

    def pytest_unconfigure(self) -> None:
        sys.monitoring.set_events(_TOOL, sys.monitoring.events.NO_EVENTS)  # modules are about to be emptied

    def pytest_sessionfinish(self) -> None:
        if self._lines.tests:
            path = pathlib.Path(os.environ[OUT]) / f"{os.getpid()}.json"
            found = {"tests": self._lines.tests, "seconds": self._lines.seconds, "failed": sorted(self._lines.failed)}
            path.write_text(json.dumps(found))
