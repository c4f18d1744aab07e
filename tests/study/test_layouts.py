"""Tests of layouts: statistics of a street that a ruler gives, sizes and power of the tests, and Holm's adjustment."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from scipy import stats

from tests.support.box_bank import KERB_Y, street_regions
from urbanverse_mjx.datatypes import GraphObject, SceneGraph, Source, ValidationError
from urbanverse_mjx.study import StreetLayout, compare, layout_of_graph
from urbanverse_mjx.study.layouts import STATISTICS, category_distance, holm, ks_distance


def graph(objects: list[tuple[Any, ...]]) -> SceneGraph:
    rows = tuple(GraphObject(f"o{k}", *row) for k, row in enumerate(objects))
    return SceneGraph("street", Source("hand", "Apache-2.0", "none", "none"), rows, tuple(street_regions()))


def test_statistics_of_two_objects_at_a_straight_kerb() -> None:
    bench = ("bench", (10.0, KERB_Y + 2.0, 0.6), (0.5, 1.8, 0.9), math.pi / 2)
    bollard = ("bollard", (13.0, KERB_Y + 1.0, 0.6), (0.2, 0.2, 1.1), 0.3)
    street = layout_of_graph(graph([bench, bollard]))
    np.testing.assert_allclose(street.values["kerb_m"], [2.0, 1.0], atol=1e-6)
    np.testing.assert_allclose(street.values["spacing_m"], [math.hypot(3.0, 1.0)] * 2)
    np.testing.assert_allclose(street.values["length_m"], [1.8, 0.2])
    np.testing.assert_allclose(street.values["height_m"], [0.9, 1.1])
    np.testing.assert_allclose(street.values["turn_rad"], [math.pi / 2, 0.3], atol=1e-6)
    # 60 m x 16 m of ground.
    np.testing.assert_allclose(street.values["density_per_100m2"], [200.0 / 960.0], rtol=1e-6)
    assert sum(street.categories.values()) == 2
    assert set(street.values) == set(STATISTICS)


def test_distances_are_those_of_scipy_and_of_a_hand_count() -> None:
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=80), rng.normal(0.5, size=130)
    assert ks_distance(a, b) == pytest.approx(stats.ks_2samp(a, b).statistic)
    assert ks_distance(a, a) == 0.0
    one = StreetLayout("a", "a", {}, {"x": 3, "y": 1})
    other = StreetLayout("b", "b", {}, {"x": 1, "z": 1})
    # Shares 3/4, 1/4, 0 and 1/2, 0, 1/2.
    assert category_distance([one], [other]) == pytest.approx(0.5)


def streets(count: int, seed: int, shift: float = 0.0, spread: float = 1.0, prefix: str = "s") -> list[StreetLayout]:
    """Streets with a level of their own, so that objects of one street are alike."""
    found = []
    for k in range(count):
        rng, level = np.random.default_rng([seed, k]), np.random.default_rng([99, k]).normal()
        values = {name: spread * level + rng.normal(shift, 0.3, 40) for name in STATISTICS}
        found.append(StreetLayout(f"{prefix}{k}", f"s{k}", values, {"x": 20 + k % 3, "y": 20}))
    return found


def test_pairs_from_the_same_layouts_differ_by_no_more_than_an_exchange() -> None:
    rows = compare(streets(16, 1), streets(16, 2), paired=True, permutations=199)
    for name in STATISTICS:
        assert rows[name]["p_holm"] > 0.05
        assert rows[name]["p_holm"] >= rows[name]["p"]
    assert rows["categories"]["distance"] == 0.0
    assert rows["categories"]["p"] == 1.0


def test_a_shift_that_streets_hide_is_found_in_pairs() -> None:
    a, b = streets(16, 1), streets(16, 2, shift=0.3)
    assert compare(a, b, paired=True, permutations=199)["height_m"]["p"] <= 0.01
    assert compare(a, b, paired=False, permutations=199)["height_m"]["p"] > 0.05


def test_objects_of_one_street_do_not_count_as_independent() -> None:
    """Levels of streets alone make two sets differ by what a test of single objects calls significant."""
    first, second = streets(8, 1), [dataclasses.replace(s, source=f"t{k}") for k, s in enumerate(streets(20, 5)[12:])]
    name = "kerb_m"
    pooled = [np.concatenate([s.values[name] for s in rows]) for rows in (first, second)]
    assert stats.ks_2samp(*pooled).pvalue < 1e-4
    assert compare(first, second, paired=False, permutations=199)[name]["p"] > 0.05


def test_the_order_of_streets_does_not_matter_for_pairs() -> None:
    a, b = streets(6, 1), streets(6, 2)
    assert compare(a, b, True, 49) == compare(a[::-1], b, True, 49)


def test_sets_that_cannot_be_compared_are_refused() -> None:
    with pytest.raises(ValidationError, match="0 and 2 streets"):
        compare([], streets(2, 1), paired=False)
    with pytest.raises(ValidationError, match="without a partner: s2"):
        compare(streets(3, 1), streets(2, 1), paired=True)


def test_holm_by_hand() -> None:
    assert holm({"a": 0.01, "b": 0.04, "c": 0.03}) == pytest.approx({"a": 0.03, "c": 0.06, "b": 0.06})
