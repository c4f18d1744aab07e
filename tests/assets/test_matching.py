"""The three steps of matching, each against cases known by construction."""

import csv
import pathlib
import time

import numpy as np
import pytest

from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.categories.semantics import NgramIndex, known_names, rank_leaves
from urbanverse_mjx.assets.selection import descriptors
from urbanverse_mjx.assets.selection.matching import Matcher, distortions
from urbanverse_mjx.assets.selection.neural import ImageEmbedder, SentenceEmbedder
from urbanverse_mjx.assets.selection.overview import overview
from urbanverse_mjx.assets.selection.search import ObjectLibrary
from urbanverse_mjx.datatypes import ValidationError

FREE = pathlib.Path(__file__).with_name("free_labels.csv")


@pytest.fixture(scope="module")
def matcher(objects: ObjectLibrary) -> Matcher:
    return Matcher(objects)


def free_labels() -> list[tuple[str, set[str]]]:
    with FREE.open(encoding="utf-8", newline="") as file:
        return [(row["label"], set(row["leaves"].split("|"))) for row in csv.DictReader(file)]


def test_a_hundred_free_labels_show_a_sensible_leaf(objects: ObjectLibrary) -> None:
    for label, leaves in free_labels():
        assert rank_leaves(label, 1)[0][0] in leaves, label
    for label, leaves in free_labels()[::10]:
        found = overview(label, objects)
        assert found["leaf"] in leaves
        assert found["records"] == ontology.tree()[found["category"][0]][found["category"][1]][found["leaf"]]
        assert found["median"]["length"] >= found["median"]["width"]


def test_letters_alone_find_most_free_labels() -> None:
    """Without the rules for phrases: the accuracy of the embedding alone."""
    index = NgramIndex(known_names())
    hits = sum(index.leaves[int(index.scores(label).argmax())] in leaves for label, leaves in free_labels())
    assert hits >= 0.9 * len(free_labels())


def test_misspelt_labels_are_near_and_nonsense_is_unknown() -> None:
    assert rank_leaves("weelchair", 1)[0][0] == "wheelchair"
    assert rank_leaves("trafic lihgt", 1)[0][0] == "traffic light"
    with pytest.raises(ontology.UnknownLabelError):
        rank_leaves("§§§", 1)


def test_distortion_by_hand() -> None:
    box = np.array([2.0, 1.0, 0.5])
    found, turned = distortions(box, np.array([[2.0, 1.0, 0.5], [1.0, 2.0, 0.5], [4.0, 1.0, 0.5], [2.2, 1.1, 0.55]]))
    assert found == pytest.approx([0.0, 0.0, np.log(2) / 3, np.log(1.1)])
    assert turned.tolist() == [0, 1, 0, 0]


def test_a_record_is_found_by_its_own_box(objects: ObjectLibrary, matcher: Matcher) -> None:
    uids = [f"{leaf}/prior/{k:05d}" for leaf in ("bench", "sedan", "tree", "chair") for k in (20, 60)]
    for record in objects.records(uids):
        best = matcher.match(record.leaf, record.extent_xyz, count=3)
        assert best[0].distortion <= 1e-3
        assert record.uid in [m.uid for m in best]
        x, y, z = record.extent_xyz
        if x > 1.3 * y:  # a square box has no better quarter turn
            assert matcher.match(record.leaf, (y, x, z))[0].yaw == pytest.approx(np.pi / 2)


def test_the_geometric_step_keeps_the_nearest(objects: ObjectLibrary, matcher: Matcher) -> None:
    found = matcher.match("bench", (0.6, 1.7, 0.85), count=40, keep=40)
    rows = objects.rows_of("bench")
    extents = np.array(objects.table.take(rows)["extent_xyz"].to_pylist())
    nearest = np.sort(distortions(np.array([0.6, 1.7, 0.85]), extents)[0])[:40]
    assert [m.distortion for m in found] == pytest.approx(nearest)


def test_a_label_without_shapes_gets_what_stands_in(matcher: Matcher, objects: ObjectLibrary) -> None:
    assert {m.leaf for m in matcher.match("automobile", (4.5, 1.8, 1.5))} <= {"car", "sedan"}
    assert matcher.match("toothpaste", (0.2, 0.05, 0.05))


def test_parameters_give_the_descriptor_of_their_tint(objects: ObjectLibrary, matcher: Matcher) -> None:
    """A crop in one flat colour finds records of that colour."""
    for color, name, also in (((190, 34, 38), "red", {"brown"}), ((40, 88, 168), "blue", set())):
        crop = np.zeros((60, 120, 3), np.uint8)
        crop[:] = color
        query = descriptors.of_image(crop)
        assert query.shape == (descriptors.SIZE,)
        uids = [m.uid for m in matcher.match("sedan", (4.7, 1.8, 1.45), query, count=5)]
        shown = [row["colors"][:2] for row in objects.load_annotations(uids).values()]
        assert name in shown[0]
        assert all({name, *also} & set(colors) for colors in shown)


def test_histograms_are_shares() -> None:
    rng = np.random.default_rng(0)
    colors = rng.integers(0, 256, (50, 7, 3)).astype(float)
    share = rng.dirichlet(np.ones(7), 50)
    found = descriptors.histogram(colors, share)
    assert found.sum(-1) == pytest.approx(1.0)
    assert found.min() >= 0.0
    one = descriptors.histogram(np.array([[[255.0, 0.0, 0.0]]]), np.ones((1, 1)))[0]
    assert one.max() == pytest.approx(one.sum())


def test_the_mask_decides_what_is_seen() -> None:
    crop = np.full((40, 40, 3), 255, np.uint8)
    crop[10:30, 15:25] = (190, 34, 38)
    mask = np.zeros((40, 40), bool)
    mask[10:30, 15:25] = True
    inner = descriptors.of_image(crop[10:30, 15:25])
    assert np.array_equal(descriptors.of_image(crop, mask), inner)
    with pytest.raises(ValidationError, match="0 pixels"):
        descriptors.of_image(crop, np.zeros((40, 40), bool))


def test_wrong_sizes_and_descriptors_are_refused(matcher: Matcher) -> None:
    with pytest.raises(ValidationError, match="three lengths above 0"):
        matcher.match("bench", (1.0, 0.0, 1.0))
    with pytest.raises(ValidationError, match="descriptor"):
        matcher.match("bench", (0.6, 1.7, 0.8), [1, 2, 3])


def test_matching_is_quick(matcher: Matcher) -> None:
    """100 ms warm, of this process's time; `benchmarks.assets` measures the wall."""
    crop = np.random.default_rng(0).integers(0, 256, (64, 64, 3)).astype(np.uint8)
    query = descriptors.of_image(crop)
    spent = []
    for label in ("pedestrian adult", "bench", "tree") * 3:
        start = time.process_time()
        matcher.match(label, (0.5, 0.5, 1.7), query)
        spent.append(time.process_time() - start)
    assert max(spent[3:]) < 0.1


@pytest.mark.parametrize("load", [SentenceEmbedder.load, ImageEmbedder.load])
def test_neural_embeddings_say_what_they_need(load, tmp_path) -> None:
    """Without the packages, the command that installs them; with them, that the folder holds no weights."""
    with pytest.raises(ValidationError, match=r"urbanverse_mjx\[embeddings\]|no weights"):
        load(str(tmp_path))


@pytest.mark.torch("transformers")
def test_dinov2_embeds_pictures(tmp_path) -> None:
    """A DINOv2 of a few numbers, saved and loaded as the real one is."""
    import torch  # pyright: ignore[reportMissingImports]
    import transformers  # pyright: ignore[reportMissingImports]

    torch.manual_seed(0)
    config = transformers.Dinov2Config(hidden_size=16, num_hidden_layers=1, num_attention_heads=2, image_size=56)
    transformers.Dinov2Model(config).save_pretrained(tmp_path)
    size = {"height": 56, "width": 56}
    transformers.BitImageProcessor(size={"shortest_edge": 56}, crop_size=size).save_pretrained(tmp_path)
    images = np.random.default_rng(0).integers(0, 256, (3, 80, 60, 3)).astype(np.uint8)
    found = ImageEmbedder.load(str(tmp_path))([*images, images[0]])
    assert found.shape == (4, 16)
    assert np.linalg.norm(found, axis=1) == pytest.approx(1.0, abs=1e-5)
    assert found[3] == pytest.approx(found[0], abs=1e-5)
