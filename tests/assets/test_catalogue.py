"""The table of all records."""

import numpy as np
import pytest

from urbanverse_mjx.assets import load_index
from urbanverse_mjx.assets.catalogue import (
    SCHEMA,
    build_catalogue,
    build_leaf,
    catalogue_hash,
    leaf_counts,
    leaf_uid,
)
from urbanverse_mjx.assets.materials import AIR, FINISHES, HARDNESS, material
from urbanverse_mjx.assets.physical import GRAVITY, ROLLING
from urbanverse_mjx.assets.priors import prior
from urbanverse_mjx.datatypes import NounError

INDEX = load_index()


@pytest.fixture(scope="module")
def table():
    return build_catalogue(INDEX)


def test_as_many_records_per_leaf_as_the_authors_have(table) -> None:
    assert table.num_rows == sum(leaf_counts().values()) == 102_444
    counts = {row["values"]: row["counts"] for row in table["category"].value_counts().to_pylist()}
    assert counts == leaf_counts()
    assert len(set(table["uid"].to_pylist())) == table.num_rows
    assert table.schema == SCHEMA


def test_only_what_a_recipe_builds_claims_a_mesh(table) -> None:
    recipe, uids = np.array(table["recipe"].to_pylist(), dtype=object), table["uid"].to_pylist()
    built = {r.uid for r in INDEX.records}
    assert {uid for uid, name in zip(uids, recipe, strict=True) if name} <= built
    assert all((name is None) == ("/prior/" in uid) for uid, name in zip(uids, recipe, strict=True))
    kept = {leaf: min(len(INDEX.by_leaf(leaf)), n) for leaf, n in leaf_counts().items()}
    assert (recipe != None).sum() == sum(kept.values())  # noqa: E711 (an array of objects)
    provenance = table["provenance"].to_pylist()
    assert all(("no mesh" in text) == (name is None) for text, name in zip(provenance, recipe, strict=True))


def test_fields_agree_in_every_record(table) -> None:
    """mass = volume x shares x densities; force = coefficient x mass x g; shares sum to 1; words are official."""
    rows = table.to_pylist()[::7]
    for row in rows:
        shares = dict(zip(row["materials"], row["materials_composition"], strict=True))
        assert sum(shares.values()) == pytest.approx(1.0, abs=1e-9)
        matter = sum(share * material(name).density for name, share in shares.items() if name != AIR)
        assert row["mass"] == pytest.approx(matter * row["volume"], rel=1e-5, abs=1e-6)
        rolls = prior(row["category"]).rest == "rolls"
        coefficient = ROLLING if rolls else row["friction_coefficient"]
        assert row["required_force"] == pytest.approx(coefficient * row["mass"] * GRAVITY, rel=1e-6, abs=1e-6)
        assert row["max_dimension"] == max(row["extent_xyz"]) == max(row["length"], row["height"])
        assert sorted(row["extent_xyz"][:2]) == [row["width"], row["length"]]
        assert row["surface_hardness"] in HARDNESS
        assert row["surface_finish"] in FINISHES
        assert 0 <= row["recommended_clearance"] <= 1.5


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
    assert catalogue_hash(build_catalogue(INDEX)) == catalogue_hash(table)


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
    with pytest.raises(NounError, match="found 0, needed at least 1"):
        build_leaf("bench", INDEX, 0)
