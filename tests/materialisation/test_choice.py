"""Scaling an asset to a box, and drawing one of a ranking for each cousin."""

import hashlib

import pytest

from urbanverse_mjx.materialisation import choice

from .fake_index import record


def draw(entry: int) -> int:
    return int.from_bytes(hashlib.sha256(str(entry).encode()).digest()[:8], "big")


def test_scale_is_bounded_for_furniture_and_free_for_house_fronts():
    bench = record("bench", 0, (0.65, 1.8, 0.85), False)
    bakery = record("bakery", 0, (8.0, 7.5, 8.0), False)
    assert choice.scale_to((0.65 * 3, 1.8 * 3, 0.85 * 3), bench) == (1.25, 1.25, 1.25)
    assert choice.scale_to((0.65 * 1.2, 1.8, 0.85 / 1.2), bench) == pytest.approx((1.09, 1.0, 0.92))
    assert choice.scale_to((4.0, 9.0, 12.0), bakery) == (0.5, 1.2, 1.5)


@pytest.mark.parametrize("ranked", [True, False])
@pytest.mark.parametrize("entries", [1, 3, 5, 7, 12, 40])
def test_a_cousin_has_the_same_entry_however_many_are_asked_for(entries: int, ranked: bool):
    most = choice.one_each(range(entries), ranked, 64, draw)
    for count in range(1, 64):
        assert choice.one_each(range(entries), ranked, count, draw) == most[:count]
    assert len(set(most[:entries])) == entries, "all different while there are enough"
    assert most[entries:] == most[: 64 - entries], "then again from the first"


def test_of_a_ranking_the_first_is_the_best_and_the_others_are_near_it():
    drawn = choice.one_each(range(40), True, 15, draw)
    assert drawn[0] == 0
    for first in (0, 5, 10):
        assert max(drawn[first : first + 5]) < 2 * (first + 5)
    assert drawn[:5] != sorted(drawn[:5])
    free = choice.one_each(range(40), False, 15, draw)
    assert free == sorted(range(40), key=draw)[:15]
