"""The table of all records."""

import numpy as np
import pyarrow as pa
import pytest

from urbanverse_mjx.assets import AssetIndex, load_index
from urbanverse_mjx.assets.categories.materials import FINISHES, HARDNESS
from urbanverse_mjx.assets.records.catalogue import (
    SCHEMA,
    build_leaf,
    catalogue_hash,
    disagreements,
    leaf_counts,
    leaf_uid,
)
from urbanverse_mjx.assets.records.store import shipped_content
from urbanverse_mjx.datatypes import ValidationError

INDEX = load_index()
#: Of every tenth leaf without any recipe's records, so that it changes with the priors, materials and ontology alone.
#: After a change of those check the differences, then store the value that the test found here.
PRIOR_HASH = "fc2eeb1cd7d5898be7fc7202a29aa8e2d5700b4bb41e32fce39d4af98f7bd61f"


@pytest.fixture(scope="module")
def table(catalogue):
    return catalogue


def test_as_many_records_per_leaf_as_the_authors_have(table) -> None:
    assert table.num_rows == sum(leaf_counts().values()) == 102_444
    counts = {row["values"]: row["counts"] for row in table["category"].value_counts().to_pylist()}
    assert counts == leaf_counts()
    assert len(set(table["uid"].to_pylist())) == table.num_rows
    assert table.schema == SCHEMA


def test_a_leaf_with_base_shapes_has_a_mesh_for_every_record(table) -> None:
    recipe, uids = np.array(table["recipe"].to_pylist(), dtype=object), table["uid"].to_pylist()
    built = {r.uid for r in INDEX.records}
    bare = [uid for uid in uids if "/prior/" not in uid]
    assert set(bare) <= built
    assert len(bare) == sum(min(len(INDEX.by_leaf(leaf)), n) for leaf, n in leaf_counts().items())
    shown = sum(n for leaf, n in leaf_counts().items() if INDEX.by_leaf(leaf))
    assert (recipe != None).sum() == shown  # noqa: E711 (an array of objects)
    provenance = table["provenance"].to_pylist()
    assert all(("no mesh" in text) == (name is None) for text, name in zip(provenance, recipe, strict=True))


def test_fields_agree_in_every_record(table) -> None:
    assert disagreements(table) == {}
    assert set(table["surface_hardness"].unique().to_pylist()) <= set(HARDNESS)
    assert set(table["surface_finish"].unique().to_pylist()) <= set(FINISHES)
    clearance = table["recommended_clearance"].to_numpy()
    assert 0 <= clearance.min() <= clearance.max() <= 1.5


def test_mass_by_hand() -> None:
    """One record against the laws, with the numbers of the tables typed in here."""
    row = build_leaf("washing machine", AssetIndex([]), 1).to_pylist()[0]
    density = {"steel": 7850, "concrete": 2400, "plastic": 950, "copper": 8950, "air": 0}
    shares = dict(zip(row["materials"], row["materials_composition"], strict=True))
    assert set(shares) == set(density)
    assert row["mass"] == pytest.approx(
        row["volume"] * sum(density[k] * share for k, share in shares.items()), rel=1e-6
    )
    assert row["volume"] == pytest.approx(0.95 * row["length"] * row["width"] * row["height"], rel=1e-9)
    assert row["required_force"] == pytest.approx(row["friction_coefficient"] * row["mass"] * 9.81, rel=1e-6)


@pytest.mark.parametrize(
    ("name", "change", "said"),
    [
        ("mass", lambda x: 1.01 * x, "mass is not volume"),
        ("volume", lambda x: 0.98 * x, "mass is not volume"),
        ("height", lambda x: x + 0.01, "sizes are not"),
        ("materials_composition", lambda x: [x[0] + 0.01, *x[1:]], "does not sum to 1"),
        ("required_force", lambda x: 2 * x, "required_force is not"),
        ("movable", lambda x: not x, "movable contradicts"),
    ],
)
def test_a_contradiction_is_found(name: str, change, said: str) -> None:
    table = build_leaf("traffic cone", INDEX)
    values = table[name].to_pylist()
    values[5] = change(values[5])
    field = SCHEMA.field(name)
    spoiled = table.set_column(table.column_names.index(name), field, pa.array(values, field.type))
    found = disagreements(spoiled)
    assert list(found) == [table["uid"][5].as_py()]
    assert said in next(iter(found.values()))


def test_recipes_keep_their_measured_boxes() -> None:
    records = INDEX.by_leaf("bollard")
    table = build_leaf("bollard", INDEX)
    assert table["uid"].to_pylist()[: len(records)] == [r.uid for r in records]
    for k, record in enumerate(records):
        assert table["extent_xyz"][k].as_py() == pytest.approx(record.extent_xyz, abs=1e-4)
        assert table["params"][k].as_py()
    assert table["uid"][len(records)].as_py() == leaf_uid("bollard", len(records)) == "bollard/prior/00004"


def test_a_record_does_not_depend_on_how_many_there_are(table) -> None:
    few, many = build_leaf("rock", INDEX, 30), build_leaf("rock", INDEX, 1200)
    assert many.slice(0, 30).equals(few)
    assert build_leaf("bench", INDEX).equals(table.slice(table["category"].to_pylist().index("bench"), 423))


def test_the_hash_sees_every_change() -> None:
    table = build_leaf("traffic cone", INDEX)
    seen = {catalogue_hash(table)}
    for name, value in (("mass", 1.0), ("movable", False), ("affordances", [["a"]]), ("recipe", "x")):
        position = table.column_names.index(name)
        values = table[name].to_pylist()
        values[3] = value[0] if isinstance(value, list) else value
        import pyarrow as pa

        seen.add(
            catalogue_hash(table.set_column(position, SCHEMA.field(name), pa.array(values, SCHEMA.field(name).type)))
        )
    assert len(seen) == 5


def test_no_records_are_refused() -> None:
    with pytest.raises(ValidationError, match="found 0, needed at least 1"):
        build_leaf("bench", INDEX, 0)


@pytest.mark.extended
def test_the_content_is_the_committed_one(table) -> None:
    """After a change of recipes, priors or code that is meant to change records: `urbanverse assets index`, which
    writes index.parquet, shapes.parquet and this hash."""
    assert catalogue_hash(table) == shipped_content()


def test_what_needs_no_mesh_is_the_same_everywhere() -> None:
    """Checked by hand under numpy 2.1.3 and 2.5.5: every number comes from + - * / and square roots."""
    leaves = list(leaf_counts())[::10]
    assert catalogue_hash(pa.concat_tables(build_leaf(leaf, AssetIndex([])) for leaf in leaves)) == PRIOR_HASH
