"""The fit of the regression that names objects, and the truth it learns from."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from benchmarks import object_names
from benchmarks.object_names import Examples
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.distillation.perception_model import classes

LEAVES = classes.leaves()
SEDAN, VAN, BENCH = (LEAVES.index(name) for name in ("sedan", "van", "bench"))


def confused(count: int, seed: int, height: bool) -> Examples:
    """Sedans and vans that the network believes to be sedans, all of them, by the same share; vans are higher."""
    rng = np.random.default_rng(seed)
    leaf = rng.choice([SEDAN, VAN, BENCH], count, p=[0.4, 0.4, 0.2])
    belief = np.zeros((count, len(LEAVES)))
    car = leaf != BENCH
    belief[car, SEDAN], belief[car, VAN] = 0.8, 0.2
    belief[~car, BENCH] = 1.0
    up = np.where(leaf == VAN, 2.2, np.where(leaf == SEDAN, 1.45, 0.9)) * np.exp(rng.normal(0, 0.05, count))
    return Examples(belief, up if height else np.full(count, 1.5), leaf, rng.integers(0, 10, count))


@pytest.mark.extended
def test_what_is_confused_is_told_apart_by_height() -> None:
    data = confused(400, 0, True)
    fitted, other = object_names.fit(data, 1e-3, 0.5), confused(400, 1, True)
    found = fitted.probabilities(other.belief, other.height).argmax(1)
    assert (other.belief.argmax(1) == other.leaf).mean() < 0.65
    assert (found == other.leaf).mean() > 0.97


@pytest.mark.extended
def test_probabilities_are_shares_where_nothing_tells_apart() -> None:
    """Half of what looks so is a van: that is what the regression says, not the network's 20 %."""
    data = confused(2000, 0, False)
    fitted = object_names.fit(data, 1e-5, 0.0)
    p = fitted.probabilities(data.belief, data.height)[data.leaf == VAN][0]
    share = (data.leaf == VAN).sum() / (data.leaf != BENCH).sum()
    assert p[VAN] == pytest.approx(share, abs=0.03)


@pytest.mark.extended
def test_scores_are_of_streets_that_are_held_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Vans of a fifth of the streets look like chairs: only a fit that saw these streets would name them right."""
    monkeypatch.setattr(object_names, "_ITERATIONS", 25)
    data = confused(120, 0, True)
    odd = (data.leaf == VAN) & (data.street % 5 == 0)
    belief = np.where(odd[:, None], np.eye(len(LEAVES))[LEAVES.index("chair")], data.belief)
    table = object_names.scores(data._replace(belief=belief), 1e-3, 0.5)
    assert table["streets"] == 10
    assert table["by_regression"]["all"] == pytest.approx(1.0 - odd.mean(), abs=0.04)
    assert table["by_belief"]["all"] < 0.7
    assert sum(count for _, count, _ in table["right_by_probability"]) == 120


def test_one_street_alone_has_no_scores() -> None:
    data = confused(20, 0, True)
    with pytest.raises(ValidationError, match="found those of one street"):
        object_names.scores(data._replace(street=np.full(20, 3)), 1e-3, 0.5)


def test_the_gradient_is_that_of_the_loss(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = {}

    def keep(loss, start, **_):
        seen["loss"] = loss
        return type("Result", (), {"x": start})

    monkeypatch.setattr(object_names.scipy.optimize, "minimize", keep)
    object_names.fit(confused(50, 0, True), 1e-2, 0.5)
    rng = np.random.default_rng(0)
    size = len(object_names.naming.used()) - 1
    start = 0.1 * rng.normal(size=size * len(LEAVES) + 1)
    along = rng.normal(size=start.shape)
    step = 1e-5
    up, down = (seen["loss"](start + sign * step * along)[0] for sign in (1, -1))
    assert seen["loss"](start)[1] @ along == pytest.approx((up - down) / (2 * step), rel=1e-4)


@pytest.mark.parametrize(("share", "found"), [(0.6, SEDAN), (0.4, -1)])
def test_an_object_is_what_half_of_its_pixels_show(share: float, found: int) -> None:
    """A far view of something else counts by its pixels; what is mixed of many is nothing."""
    views = SimpleNamespace(pixels=np.array([900, 100]), origin=np.array([[0, 0], [1, 0]]))
    fused: Any = SimpleNamespace(views=views)
    shown = {(0, 0): ("car_1", "sedan", share), (1, 0): ("bench_1", "bench", 1.0)}
    assert object_names._true_leaf(fused, np.arange(2), shown) == found
