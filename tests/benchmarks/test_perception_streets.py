"""The training streets of the perception model: separate splits, equal for any number of processes."""

import itertools
import pathlib
import types

import numpy as np
import pytest

from benchmarks import perception_streets
from benchmarks.lib import perception_library
from urbanverse_mjx.assets import AssetIndex, load_index
from urbanverse_mjx.assets.meshes.instances import KEY
from urbanverse_mjx.assets.records.index import build_mesh
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.distillation.perception_model.classes import class_of_leaf
from urbanverse_mjx.scene.compiler import AssetSource


@pytest.fixture(scope="module")
def splits() -> dict[str, AssetIndex]:
    return {split: perception_streets.of_split(split, load_index()) for split in perception_streets.SPLITS}


def _shapes(index: AssetIndex, leaf: str) -> set[str]:
    return {r.params[KEY]["base"] if KEY in r.params else r.uid for r in index.by_leaf(leaf)}


def test_the_splits_share_no_shape_of_a_leaf_with_three(splits: dict[str, AssetIndex]):
    index = load_index()
    for leaf in perception_streets.shown_leaves():
        train, test = (_shapes(splits[s], leaf) for s in ("train", "test"))
        assert train | test == {r.uid for r in index.by_leaf(leaf)}
        if len(index.by_leaf(leaf)) >= 3:
            assert not train & test


def test_kin_gives_a_class_more_leaves_and_keeps_its_frequency():
    plain, shown = perception_streets.stock("train"), perception_streets.shown_leaves()
    drawn = [perception_streets.stock("train", kin=k) for k in range(8)]
    more: set[str] = set()
    for street in drawn:
        bands = zip((plain.houses, *plain.leaves.values()), (street.houses, *street.leaves.values()), strict=True)
        for names, others in bands:
            assert [class_of_leaf(x) for x in names] == [class_of_leaf(x) for x in others]
        more |= {x for names in (street.houses, *street.leaves.values()) for x in names} - shown
    assert len(more) > 50
    assert {class_of_leaf(leaf) for leaf in ("dirt bike", "trolleybus", "barn")} <= {class_of_leaf(x) for x in more}
    assert drawn[0] != drawn[1]
    assert plain == perception_streets.stock("train")
    index = load_index()
    records = perception_streets.of_split("train", index, kin=True)
    assert all(any(KEY in r.params for r in records.by_leaf(leaf)) for leaf in more)
    # What the test shows stays unseen.
    test = {r.uid for r in perception_streets.of_split("test", index).records}
    for leaf in shown:
        if len(index.by_leaf(leaf)) >= 3:
            assert not {r.params[KEY]["base"] if KEY in r.params else r.uid for r in records.by_leaf(leaf)} & test


def test_streets_that_are_made_in_the_given_time_are_kept(monkeypatch: pytest.MonkeyPatch):
    ended: list[bool] = []

    def made(*_: object):
        try:
            for number in range(9):
                yield types.SimpleNamespace(sky="overcast_grey"), f"street_{number}", "hash"
        finally:
            ended.append(True)

    clock = itertools.count(0.0, 10.0)
    monkeypatch.setattr(perception_streets, "_made", made)
    monkeypatch.setattr(perception_streets.time, "monotonic", lambda: next(clock))
    monkeypatch.setattr(perception_streets, "pack", lambda scenes, splits, *_: (len(scenes), len(splits)))
    assert perception_streets.build("train", 9, within=25.0) == (3, 3)
    assert ended == [True]


def test_training_instances_are_built_in_the_size_that_their_record_tells(splits: dict[str, AssetIndex]):
    for leaf in ("bench", "sedan"):
        made = [r for r in splits["train"].by_leaf(leaf) if KEY in r.params]
        assert len(made) == perception_streets.INSTANCES
        assert len({r.extent_xyz for r in made}) > perception_streets.INSTANCES // 2
        build_mesh(made[0])
    assert not any(KEY in r.params for r in splits["test"].records)


def test_processes_make_the_same_streets():
    alone, together = (
        [(name, content) for _, name, content in perception_streets._made("test", range(2), processes)]
        for processes in (1, 2)
    )
    assert alone == together


@pytest.mark.extended
def test_a_library_street_loses_held_out_shapes_and_gains_people(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch, splits: dict[str, AssetIndex]
):
    """A street of all shapes stands for one of the library."""
    index = load_index()
    layout, _ = perception_streets.make_street("test", 0, index)
    layout.save(tmp_path / "layout.json")
    monkeypatch.setattr(perception_library, "index_of", lambda _: index)
    source = AssetSource(build_mesh, perception_streets._point_hull)
    made, name, content = perception_library.make(tmp_path, splits["train"], source)
    assert name == layout.id
    assert content != layout.content_hash()
    left = {o.id for o in layout.objects if o.asset_uid in _kept(splits["train"])}
    assert {x for x in made.object_ids if not x.startswith("added_")} == left
    assert 0 < len(left) < len(layout.objects)
    added = [k for k, x in enumerate(made.object_ids) if x.startswith("added_")]
    kinds = (perception_library.PEOPLE, perception_library.TRAFFIC)
    people = {leaf for _, leaves, _ in kinds for leaf in leaves.split("|")}
    assert len(added) > 10
    assert {made.object_categories[k] for k in added} <= people
    # They stand on the ground, apart from each other.
    places = made.object_position[added]
    gaps = np.linalg.norm(places[:, None, :2] - places[None, :, :2], axis=-1)
    assert gaps[~np.identity(len(places), bool)].min() > perception_library._APART
    assert places[:, 2].min() > -0.01
    assert places[:, 2].max() < 0.3
    assert len(made.episodes.start) == 1


def _kept(index: AssetIndex) -> set[str]:
    return {r.params[KEY]["base"] if KEY in r.params else r.uid for r in index.records}


def test_library_streets_are_asked_for_by_set_and_number(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path))
    with pytest.raises(ValidationError, match="needed SET:COUNT"):
        perception_streets._folders("places")
    with pytest.raises(ValidationError, match=r"found 0 training scenes of 'places'.*needed 2"):
        perception_streets._folders("places:2")
    root = tmp_path / "library" / "places" / "scenes"
    for k in range(6):
        (root / f"places_{k:03d}").mkdir(parents=True)
        (root / f"places_{k:03d}" / "layout.json").write_text("{}")
    found = perception_streets._folders("places:3")
    assert len(found) == len(set(found)) == 3


def test_a_share_of_the_instances_of_training_is_deformed(splits: dict[str, AssetIndex]):
    records = splits["train"].by_leaf("bollard")
    base = next(r for r in records if KEY not in r.params)
    instances = [r for r in records if KEY in r.params]
    train, test = perception_streets.source("train"), perception_streets.source("test")
    np.testing.assert_array_equal(train.mesh(base).vertices, build_mesh(base).vertices)
    plain = [build_mesh(r).vertices for r in instances]
    np.testing.assert_array_equal(test.mesh(instances[0]).vertices, plain[0])
    kept = sum(np.array_equal(train.mesh(r).vertices, x) for r, x in zip(instances, plain, strict=True))
    assert 0.2 < kept / len(instances) < 0.8
