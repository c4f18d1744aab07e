"""Streets compiled with few episodes, for tests of anything else: a street's own are tried and driven for seconds."""

import contextlib
import functools
from collections.abc import Iterator
from unittest import mock

from urbanverse_mjx.scene import EpisodeRules, episodes

NUMBER = 24


@contextlib.contextmanager
def few_episodes() -> Iterator[None]:
    """Within, a street that is compiled without rules of its own gets `NUMBER` episodes towards six goals."""
    rules = functools.partial(EpisodeRules, rows=NUMBER, goals=6)
    with mock.patch.object(episodes, "MIN_ROWS", NUMBER), mock.patch.object(episodes, "EpisodeRules", rules):
        yield
