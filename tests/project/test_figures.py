"""Figures of results: which changes of a result they show, how they are told, and how they are stored."""

import dataclasses
import pathlib

import numpy as np
import pytest

from tests.support import defaults
from tests.support import figures as kept


@dataclasses.dataclass(frozen=True)
class Piece:
    name: str
    place: tuple[float, float]


def said(before: object, now: object, tolerance: float = 1e-4) -> list[str]:
    return kept.differences(kept.lines_of(before), kept.lines_of(now), tolerance)


def test_any_changed_element_is_told_and_rounding_is_not() -> None:
    large = np.random.default_rng(0).normal(size=(300, 200))
    for place in ((0, 0), (17, 3), (299, 199)):
        other = large.copy()
        other[place] += 1.0
        assert len(said({"a": large}, {"a": other})) == 1, place
    assert said({"a": large}, {"a": large * (1 + 1e-6)}) == []
    assert len(said({"a": large}, {"a": large[::-1]})) == 1, "the same elements elsewhere"
    assert len(said({"a": large}, {"a": large.T})) == 1
    hole = large.copy()
    hole[5, 5] = np.nan
    assert len(said({"a": large}, {"a": hole})) == 1


def test_the_part_that_changed_is_named() -> None:
    before = {"street": [Piece("a", (1.0, 2.0)), Piece("b", (3.0, 4.0))], "count": 2}
    now = {"street": [Piece("a", (1.0, 2.0)), Piece("c", (3.0, 4.5))], "count": 2, "more": True}
    assert said(before, now) == [
        "street.name: text a b  ->  text a c",
        "street.place: = 1 2 3 4  ->  = 1 2 3 4.5",
        "more: new: = 1",
    ]


def test_figures_are_stored_only_when_asked(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept, "FILE", tmp_path / "figures.txt.xz")
    monkeypatch.delenv(kept.STORE, raising=False)
    found = {"a.b": {"c": np.arange(9.0)}, "d": "two words", "e": np.zeros(0)}
    with pytest.raises(AssertionError, match="has no x/y"):
        kept.check("x/y", found)
    monkeypatch.setenv(kept.STORE, "1")
    kept.check("x/y", found)
    kept.check("a", {"b": 1.0})
    monkeypatch.delenv(kept.STORE)
    kept.check("x/y", found)
    assert list(kept.stored()) == ["a", "x/y"]
    with pytest.raises(AssertionError, match=r"x/y: .*\nd: text two words  ->  text two"):
        kept.check("x/y", found | {"d": "two"})


def test_defaults_are_those_of_a_modules_own_constants_functions_and_fields() -> None:
    found = defaults.defaults_of("urbanverse_mjx.scene.episodes")
    assert found["MIN_ROWS"].tolist() == [256.0]
    assert found["EpisodeRules.distance"].tolist() == [10.0, 30.0]
    assert "np" not in found
    assert "urbanverse_mjx.scene.roads.drawing" in defaults.modules_of("scene")
