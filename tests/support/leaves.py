"""Leaves of the ontology as test parameters: some always, all of them with `make test-slow`."""

from collections.abc import Sequence
from typing import Any

import pytest

#: Of so many leaves one is always tested; its meshes take a second or so.
EVERY = 18


def leaf_params(leaves: Sequence[str]) -> list[Any]:
    """All leaves as parameters, those that are not always tested with the mark `slow`."""
    return [leaf if i % EVERY == 0 else pytest.param(leaf, marks=pytest.mark.slow) for i, leaf in enumerate(leaves)]


def always(leaves: Sequence[str]) -> list[str]:
    """The leaves that are always tested."""
    return list(leaves[::EVERY])
