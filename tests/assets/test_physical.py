"""Physical values of records: they agree with each other, with the priors, and are the same everywhere."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.categories.materials import AIR, material
from urbanverse_mjx.assets.categories.physical import (
    GRAVITY,
    MASS_STEP,
    ONE_PERSON_PUSH,
    ROLLING_RESISTANCE,
    Measured,
    Physical,
    agreeing,
    composition,
    medians,
    sample,
    sample_meshes,
    sample_uids,
    uniforms,
)
from urbanverse_mjx.assets.categories.priors import Prior, prior, priors
from urbanverse_mjx.datatypes import ValidationError

MIDDLES = sorted({middle for _, middle, _ in ontology.categories().values()})
LEAVES = st.sampled_from(list(ontology.categories()))


def check(row: Prior, values: Physical) -> None:
    """Every law of the module's docstring, for all records."""
    density = np.array([m.density for m in row.makes])[values.make]
    friction = material(row.contact).friction
    assert (values.length >= values.width).all()
    assert values.mass == pytest.approx(values.solid * density, rel=1e-12)
    assert (values.solid <= values.volume * (1 + 1e-9) + MASS_STEP / density).all()
    assert (values.volume <= np.prod(values.extent, axis=1) * (1 + 1e-9)).all()
    coefficient = ROLLING_RESISTANCE if row.rest == "rolls" else values.friction
    assert values.force == pytest.approx(coefficient * values.mass * GRAVITY, rel=1e-12)
    assert (np.abs(values.friction / friction - 1) <= 0.1 + 0.005 / friction + 1e-9).all()
    loose = row.rest not in ("fixed", "hangs")
    assert (values.movable == (loose & (values.force <= ONE_PERSON_PUSH))).all()
    for make, solid, volume in zip(values.make[:20], values.solid, values.volume, strict=False):
        shares = composition(row.makes[make], solid, volume)
        assert sum(shares.values()) == pytest.approx(1.0, abs=1e-12)
        assert min(shares.values()) > 0
        matter = sum(share * material(name).density for name, share in shares.items() if name != AIR)
        # A mesh of the least volume holds no more than its volume of matter, but for rounding to MASS_STEP.
        assert matter * volume == pytest.approx(solid * row.makes[make].density, rel=1e-6, abs=2 * MASS_STEP)


@pytest.mark.parametrize("middle", MIDDLES)
def test_drawn_records_stay_in_their_rows(middle: str) -> None:
    for leaf in (k for k, path in ontology.categories().items() if path[1] == middle):
        row = prior(leaf)
        values = sample_uids(leaf, [f"{leaf}/{k}" for k in range(300)])
        check(row, values)
        for sizes, span in ((values.length, row.length), (values.height, row.height)):
            assert span[0] - 1e-4 <= sizes.min() <= sizes.max() <= span[2] + 1e-4, leaf
        assert values.width.max() <= row.width[2] + 1e-4, leaf
        assert values.mass.max() <= row.mass[2] * (1 + 1e-6), leaf
        # Small dense objects may be too small to hold the least mass; then the matter fills them.
        full = values.solid >= values.volume * (1 - 1e-3)
        assert ((values.mass >= row.mass[0] - MASS_STEP) | full).all(), leaf
        at_bound = (values.mass <= row.mass[0] * 1.001) | (values.mass >= row.mass[2] * 0.999)
        assert at_bound.mean() <= 0.12, f"{leaf}: the mass range is too narrow for the sizes"
        along, across = (1, 0) if row.front == "side" else (0, 1)
        assert (values.extent[:, along] == values.length).all(), leaf
        assert (values.extent[:, across] == values.width).all(), leaf


def test_the_median_record_is_the_row() -> None:
    for leaf, row in priors().items():
        values = sample(row, medians())
        sizes = (values.length[0], values.width[0], values.height[0])
        assert sizes == pytest.approx((row.length[1], row.width[1], row.height[1]), abs=5.1e-5), leaf
        assert values.mass[0] == pytest.approx(row.mass[1], rel=0.03), leaf


@settings(max_examples=150, deadline=None)
@given(
    LEAVES,
    st.lists(st.text(max_size=12), min_size=1, max_size=5, unique=True),
    st.tuples(*[st.floats(1e-3, 300.0)] * 3),
    st.floats(1e-3, 1.0),
)
def test_any_measured_mesh_gets_values_that_agree(
    leaf: str, uids: list[str], extent: tuple[float, float, float], share: float
) -> None:
    box = np.tile(np.array(extent), (len(uids), 1))
    values = sample_meshes(leaf, uids, box, share * box.prod(1))
    check(prior(leaf), values)
    assert values.extent == pytest.approx(box, abs=1e-4)
    assert values.mass.max() <= prior(leaf).mass[2] * (1 + 1e-6)


def test_values_depend_on_the_uid_alone() -> None:
    together = sample_uids("bench", ["a", "b", "c"])
    alone = sample_uids("bench", ["b"])
    assert together.mass[1] == alone.mass[0]
    assert (together.extent[1] == alone.extent[0]).all()
    assert len(set(together.mass.tolist())) == 3


def test_draws_are_fixed_for_ever() -> None:
    """The words of blake2b, computed apart with Python's integers."""
    import hashlib

    digest = hashlib.blake2b(b"bench/prior/00004").digest()
    words = [int.from_bytes(digest[4 * k : 4 * k + 4], "little") for k in range(16)]
    assert uniforms(["bench/prior/00004"])[0].tolist() == [(w + 0.5) / 2**32 for w in words]


def test_a_mass_guess_chooses_the_make() -> None:
    row = prior("bench")
    extent, volume = np.tile([0.6, 1.65, 0.82], (2, 1)), np.full(2, 0.2)
    values = sample_meshes("bench", ["x", "y"], extent, volume, [340.0, 45.0])
    assert [row.makes[k].surface for k in values.make] == ["concrete", "plastic"]


def test_records_of_recipes_get_values_that_agree() -> None:
    records = load_index().records
    for old, new in zip(records, agreeing(records), strict=True):
        row = prior(new.leaf)
        assert (new.uid, new.extent_xyz, new.volume, new.params) == (old.uid, old.extent_xyz, old.volume, old.params)
        assert row.mass[0] * 0.999 <= new.mass <= row.mass[2] * 1.001 or new.mass < row.mass[0]
        coefficient = ROLLING_RESISTANCE if row.rest == "rolls" else new.friction_coefficient
        assert new.required_force == pytest.approx(coefficient * new.mass * GRAVITY, abs=0.06 + 0.005 * coefficient)
        assert AIR not in new.materials
        assert new.materials[0] in {name for make in row.makes for name in make.shares}
    assert [r.uid for r in agreeing(records[:1])] == [records[0].uid]


def test_makes_are_drawn_by_their_squared_rank() -> None:
    make = sample_uids("fence", [str(k) for k in range(4000)]).make
    assert np.bincount(make) / 4000 == pytest.approx(np.array([16, 9, 4, 1]) / 30, abs=0.03)


def test_larger_objects_weigh_more() -> None:
    """Over all leaves whose mass grows with the box: the largest tenth outweighs the smallest in each make."""
    for leaf, row in priors().items():
        if row.grows_with != "box":
            continue
        values = sample_uids(leaf, [f"{leaf}#{k}" for k in range(400)])
        first = values.make == 0
        box, mass = np.prod(values.extent[first], axis=1), values.mass[first]
        order = np.argsort(box)
        tenth = max(len(order) // 10, 1)
        assert mass[order[-tenth:]].mean() > mass[order[:tenth]].mean(), leaf


@pytest.mark.parametrize(
    ("extent", "volume"),
    [(np.ones((2, 3)), np.ones(1)), (np.zeros((1, 3)), np.ones(1)), (np.full((1, 3), np.nan), np.ones(1))],
)
def test_measures_that_do_not_fit_are_refused(extent: np.ndarray, volume: np.ndarray) -> None:
    with pytest.raises(ValidationError, match="measured geometry: found"):
        sample(prior("bench"), uniforms(["a"]), Measured(extent, volume))
