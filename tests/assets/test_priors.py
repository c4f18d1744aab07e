"""The table of priors: complete, valid, and true of the objects it speaks of."""

import pytest

from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.categories.materials import materials, sources
from urbanverse_mjx.assets.categories.physical import GRAVITY, ROLLING_RESISTANCE, medians, sample
from urbanverse_mjx.assets.categories.priors import FORMS, Prior, prior, priors
from urbanverse_mjx.assets.categories.published import published
from urbanverse_mjx.datatypes import ValidationError

# Range of the mass (kg) and of the largest side (m) of a leaf's median object, by mid-level category. Written apart
# from the table, from what such objects are, so that a slipped decimal point in a row falls out.
BOUNDS = {
    "emergency amenity": (0.1, 120, 0.08, 1.2),
    "facilities amenity": (0.5, 150_000, 0.2, 40),
    "financial amenity": (8, 800, 0.8, 2.2),
    "misc amenity": (100, 800, 0.9, 4.5),
    "power amenity": (15, 80_000, 1.0, 12),
    "public service amenity": (3, 3000, 0.3, 4),
    "tourism amenity": (50, 2e7, 1, 120),
    "traffic signs": (8, 60, 1.4, 3.2),
    "transportation amenity": (10, 2e6, 0.7, 45),
    "waste management amenity": (8, 900, 0.7, 5),
    "access control barrier": (2, 2500, 0.6, 5),
    "linear barrier": (30, 5000, 1.5, 5),
    "obstacle barrier": (5, 1000, 0.2, 3),
    "agricultural building": (1000, 250_000, 5, 25),
    "commercial building": (100, 1e8, 2, 180),
    "education building": (400_000, 1.2e7, 20, 70),
    "healthcare building": (100_000, 4e7, 8, 100),
    "misc building": (150_000, 3e6, 12, 35),
    "public building": (3, 2e7, 0.5, 80),
    "religious building": (2500, 8e7, 2.5, 90),
    "residential building": (8000, 5e6, 5, 45),
    "sports building": (40_000, 1.2e8, 20, 200),
    "storage building": (5000, 2.5e6, 4, 50),
    "terrain": (100, 25_000, 1.5, 10),
    "vegetation": (0.05, 1000, 0.3, 9),
    "water body": (25, 1.5e7, 1.5, 100),
    "primary road": (10_000, 60_000, 10, 20),
    "secondary road": (1000, 300_000, 4, 35),
    "animal": (0.2, 700, 0.15, 2.6),
    "person": (7, 300, 0.6, 2.2),
    "robot": (10, 70, 0.5, 1.8),
    "cleaning equipment": (0.2, 8, 0.3, 1.5),
    "decorations": (0.3, 15, 0.1, 2.2),
    "drinks": (0.3, 1.4, 0.15, 0.32),
    "electrical appliances": (0.1, 130, 0.07, 1.8),
    "fixtures": (0.3, 16, 0.15, 0.65),
    "food": (0.05, 1.5, 0.05, 0.35),
    "fruits": (0.001, 8, 0.012, 0.35),
    "furniture": (0.1, 350, 0.2, 3.2),
    "healthcare objects": (0.05, 45, 0.05, 2.1),
    "household items": (0.3, 25, 0.25, 2.3),
    "kitchenware": (0.01, 2.5, 0.08, 0.7),
    "misc urban objects": (0.003, 200, 0.12, 5.5),
    "musical instruments": (0.3, 260, 0.4, 1.8),
    "office supplies": (0.005, 20, 0.12, 1.5),
    "personal care product": (0.001, 0.4, 0.05, 0.35),
    "personal item": (0.0008, 8, 0.03, 1),
    "sports equipments": (0.1, 100, 0.07, 3),
    "street trash": (0.012, 10, 0.08, 0.7),
    "tools": (0.05, 12, 0.1, 2.5),
    "toys": (0.15, 0.6, 0.25, 0.5),
    "vegetables": (0.03, 6, 0.05, 0.35),
    "weapons": (0.7, 60, 0.18, 1.2),
    "aircraft vehicle": (0.5, 10_000, 0.3, 25),
    "construction vehicle": (3000, 40_000, 3, 15),
    "emergency vehicle": (1500, 16_000, 4.5, 9),
    "private vehicle": (5, 10_000, 0.6, 8.5),
    "public vehicle": (9000, 60_000, 6, 30),
    "watercraft vehicle": (20, 5e6, 3, 90),
}
# Common objects of known mass (kg, of the median).
KNOWN = {
    "car": (1000, 2500),
    "sedan": (1200, 1700),
    "bench": (30, 150),
    "bicycle": (10, 20),
    "scooter": (10, 25),
    "trash bin": (8, 20),
    "dumpster": (50, 400),
    "traffic cone": (1.5, 5),
    "fire hydrant": (50, 130),
    "bollard": (10, 60),
    "jersey barrier": (1200, 2500),
    "vending machine": (220, 380),
    "parking meter": (8, 30),
    "street cabinet": (60, 200),
    "laptop": (1.2, 2.2),
    "football": (0.41, 0.45),
    "basketball": (0.567, 0.65),
    "egg": (0.053, 0.068),
    "cigarette": (0.0007, 0.0012),
    "pedestrian adult": (60, 85),
    "pedestrian child": (18, 32),
    "bus": (9000, 14_000),
    "motorcycle": (150, 250),
    "manhole cover": (40, 110),
    "washing machine": (55, 80),
    "piano": (180, 280),
    "tree": (250, 1200),
    "house": (60_000, 300_000),
    "bird": (0.2, 0.5),
    "dog": (12, 35),
    "knife or sword": (0.2, 1.2),
    "street light": (70, 200),
    "stop sign": (8, 25),
}


def rows_of(middle: str) -> list[Prior]:
    return [row for leaf, row in priors().items() if ontology.category_of(leaf)[1] == middle]


def test_every_leaf_has_its_row_in_the_ontologys_order() -> None:
    assert list(priors()) == list(ontology.categories())
    assert set(BOUNDS) == {middle for _, middle, _ in ontology.categories().values()}


@pytest.mark.parametrize("middle", BOUNDS)
def test_rows_agree_with_themselves(middle: str) -> None:
    for row in rows_of(middle):
        assert row.median_mass() == pytest.approx(row.mass[1], rel=1e-3), row.leaf
        for index, make in enumerate(row.makes):
            assert row.mass[0] <= row.median_mass(index) <= row.mass[2], row.leaf
            assert make.fill <= FORMS[row.form], f"{row.leaf}: more matter than the form encloses"
        assert row.length[0] < row.length[2], row.leaf
        assert row.height[0] < row.height[2], row.leaf
        if row.section in ("round", "ball"):
            assert row.width == row.length, row.leaf
        if row.section in ("lying", "wheel", "ball"):
            assert row.height == {"lying": row.width, "wheel": row.length, "ball": row.length}[row.section], row.leaf
        wheels = {"rollable", "pushable", "ridable", "pullable"} & set(row.affordances)
        assert row.rest != "rolls" or wheels, row.leaf


@pytest.mark.parametrize("middle", BOUNDS)
def test_medians_are_plausible_for_their_category(middle: str) -> None:
    least, most, small, large = BOUNDS[middle]
    for row in rows_of(middle):
        assert least <= row.mass[1] <= most, row.leaf
        assert small <= max(row.length[1], row.height[1]) <= large, row.leaf


@pytest.mark.parametrize(("leaf", "least", "most"), [(k, *v) for k, v in KNOWN.items()])
def test_known_objects_weigh_what_they_weigh(leaf: str, least: float, most: float) -> None:
    assert least <= prior(leaf).mass[1] <= most


def test_no_row_is_a_copy_of_another() -> None:
    rows = list(priors().values())
    assert len({(r.length, r.width, r.height, r.mass) for r in rows}) == len(rows)
    assert len({r.note for r in rows}) == len(rows)


def test_every_source_is_listed_and_used() -> None:
    used = {key for m in materials().values() for key in (m.density_source, m.friction_source)}
    notes = [row.note for row in priors().values() if row.basis == "published"]
    used |= {key for key in sources() if any(key in note for note in notes)} | {row.source for row in published()}
    assert used | {"etbroll", "cda3000"} == set(sources())
    assert all(source.address.startswith("http") for source in sources().values() if source.address)
    assert {key for key, source in sources().items() if not source.address} == {"handbook", "judged"}
    in_rows = {name for row in priors().values() for make in row.makes for name in make.shares}
    assert in_rows <= set(materials())


def test_force_of_a_car_with_brakes_and_of_a_bicycle_that_rolls() -> None:
    car, bicycle = (sample(prior(leaf), medians()) for leaf in ("car", "bicycle"))
    assert car.force[0] == pytest.approx(0.85 * 1430 * GRAVITY, rel=0.01)  # rubber on concrete
    assert bicycle.force[0] == pytest.approx(ROLLING_RESISTANCE * 12.5 * GRAVITY, rel=0.01)
    assert bicycle.movable[0]
    assert not car.movable[0]


def test_an_invalid_row_is_refused_with_its_place(tmp_path, monkeypatch) -> None:
    from urbanverse_mjx.assets.categories import materials as tables
    from urbanverse_mjx.assets.categories import priors as module
    from urbanverse_mjx.settings import asset_root

    text = (asset_root() / "priors.csv").read_text(encoding="utf-8")
    for name in ("materials.csv", "sources.csv"):
        (tmp_path / name).write_bytes((asset_root() / name).read_bytes())
    (tmp_path / "priors.csv").write_text(text.replace("1.2 1.68 2.4", "1.2 1.68", 1), encoding="utf-8")
    monkeypatch.setattr(module, "asset_root", lambda: tmp_path)
    with pytest.raises(ValidationError, match=r"priors\.csv:\d+ length: found '1\.2 1\.68', needed three"):
        module.priors.__wrapped__()
    (tmp_path / "priors.csv").write_text(text.replace("published,fiba ball:", "published,my ball:"), encoding="utf-8")
    with pytest.raises(ValidationError, match="found 'my ball' as its source"):
        module.priors.__wrapped__()
    assert tables.materials() is tables.materials()
