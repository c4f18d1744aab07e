"""The training streets of the perception model: separate splits, equal for any number of processes."""

import pytest

from benchmarks import perception_streets
from urbanverse_mjx.assets import AssetIndex, load_index
from urbanverse_mjx.assets.meshes.instances import KEY
from urbanverse_mjx.assets.records.index import build_mesh


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
