"""CLIP's and DINOv2's embeddings in the choice of assets, with small random models of the real architectures."""

import dataclasses
import pathlib
import sys
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.support import small_models
from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.categories.semantics import MAX_EMBEDDING_SCORE, rank_leaves
from urbanverse_mjx.assets.previews import thumbnails
from urbanverse_mjx.assets.selection.matching import Matcher
from urbanverse_mjx.assets.selection.search import library
from urbanverse_mjx.datatypes import GraphObject, GroundRegion, SceneGraph, Source, ValidationError
from urbanverse_mjx.datatypes.validation import write_atomically
from urbanverse_mjx.materialisation import BUILT_IN, materialise_cousins
from urbanverse_mjx.materialisation.shortlists import Series, shortlist
from urbanverse_mjx.pipeline.generation.embeddings import BACKGROUND, load_embeddings
from urbanverse_mjx.pipeline.generation.stages import GenerationOptions, generate

SQUARE = ((-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0))
BENCH = GraphObject("bench_000", "bench", (3.0, 0.0, 0.45), (0.65, 1.8, 0.9), 0.0)
GRAPH = SceneGraph(
    "benches",
    Source("hand", "CC0-1.0", "none", "none"),
    (BENCH, dataclasses.replace(BENCH, id="bench_001", center=(-3.0, 0.0, 0.45))),
    (GroundRegion("ground", "ground", SQUARE, (0.0, 0.0, 0.0)),),
)


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> str:
    return str(small_models.write(tmp_path_factory.mktemp("models"), "clip", "dinov2"))


@pytest.fixture(autouse=True)
def textures(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Thumbnails need OpenGL; an asset's texture stands for it."""

    def draw(mesh: Any, path: pathlib.Path) -> pathlib.Path:
        image = Image.fromarray(np.resize(mesh.texture, (160, 160, 3)))
        return write_atomically(path, lambda p: image.save(p, "PNG"))

    monkeypatch.setattr(thumbnails, "folder", lambda: tmp_path / "thumbnails")
    monkeypatch.setattr(thumbnails, "draw", draw)


def save_crop(folder: pathlib.Path, name: str, image: np.ndarray) -> None:
    folder.mkdir(exist_ok=True)
    alpha = np.full((*image.shape[:2], 1), 255, np.uint8)
    Image.fromarray(np.concatenate([image, alpha], 2), "RGBA").save(folder / f"{name}_0.png")


@small_models.needed
def test_clip_ranks_leaves(models: str, tmp_path: pathlib.Path) -> None:
    text = load_embeddings("neural", models, GRAPH, tmp_path).text
    assert text is not None
    vectors = text(["bench", "a very long label that needs more tokens than others", "bench"])
    np.testing.assert_allclose(np.linalg.norm(vectors, axis=1), 1.0, atol=1e-5)
    np.testing.assert_allclose(vectors[0], vectors[2], atol=1e-5)
    everything = text(list(ontology.categories()))
    # Without the mean's subtraction random encoders, like trained ones, give nearly the same vector for all.
    assert np.abs((everything @ everything.T).mean()) < 0.1
    (best, score), *_ = rank_leaves("bench", 3, text)
    assert (best, score) == ("bench", 1.0)  # a name needs no embedding
    ranked = rank_leaves("zzqx", 3, text)
    leaves = list(ontology.categories())
    query = text(["zzqx"])[0]
    names = [f"{leaf}, {middle}" for leaf, (_, middle, _) in ontology.categories().items()]
    near = np.clip(text(names) @ query, 0.0, MAX_EMBEDDING_SCORE)
    np.testing.assert_allclose([score for _, score in ranked], np.sort(near)[::-1][:3], atol=1e-5)
    np.testing.assert_allclose([near[leaves.index(leaf)] for leaf, _ in ranked], [s for _, s in ranked], atol=1e-5)


@small_models.needed
def test_the_asset_that_looks_like_the_crop_becomes_cousin_0(models: str, tmp_path: pathlib.Path) -> None:
    """The crop is the thumbnail of one asset of the shortlist: that one is chosen, and by nothing but its image."""
    objects = library()
    plain = shortlist(Series((BENCH,)), Matcher(objects), objects)
    images = objects.load_thumbnails([c.match.uid for c in plain])
    wanted = next(
        c.match.uid for c in plain[3:] if sum((images[c.match.uid] == other).all() for other in images.values()) == 1
    )
    save_crop(tmp_path / "crops", BENCH.id, images[wanted])
    embeddings = load_embeddings("neural", models, GRAPH, tmp_path / "crops")
    assert set(embeddings.crops) == {BENCH.id}
    found = shortlist(Series((BENCH,)), Matcher(objects), objects, embeddings)
    assert found[0].match.uid == wanted != plain[0].match.uid
    assert found[0].match.appearance_distance == pytest.approx(0.0, abs=1e-4)
    assert sorted(c.match.uid for c in found) == sorted(c.match.uid for c in plain)
    (cousin,) = materialise_cousins(GRAPH, 1, embeddings=embeddings)
    assert cousin.chosen[BENCH.id].match.uid == wanted


@small_models.needed
def test_a_thumbnail_is_encoded_once(models: str, tmp_path: pathlib.Path) -> None:
    save_crop(tmp_path / "crops", BENCH.id, np.full((30, 40, 3), 90, np.uint8))
    embeddings = load_embeddings("neural", models, GRAPH, tmp_path / "crops")
    assert embeddings.image is not None
    seen: list[int] = []
    hook = embeddings.image.model.register_forward_hook(lambda _, __, out: seen.append(len(out[0])))
    objects, matcher = library(), Matcher(library())
    first = shortlist(Series((BENCH,)), matcher, objects, embeddings)
    count = sum(seen)
    second = shortlist(Series((BENCH,)), matcher, objects, embeddings)
    hook.remove()
    assert sum(seen) == count + 1  # the crop alone
    assert [c.match for c in first] == [c.match for c in second]


@small_models.needed
def test_crops_lie_on_the_background_of_thumbnails(models: str, tmp_path: pathlib.Path) -> None:
    (tmp_path / "crops").mkdir()
    image = np.zeros((4, 6, 4), np.uint8)
    image[:2] = (200, 10, 10, 255)
    Image.fromarray(image, "RGBA").save(tmp_path / "crops" / "bench_001_0.png")
    crop = load_embeddings("neural", models, GRAPH, tmp_path / "crops").crops["bench_001"]
    assert crop[0, 0].tolist() == [200, 10, 10]
    assert tuple(crop[3, 0].tolist()) == BACKGROUND
    (tmp_path / "crops" / "bench_000_0.png").write_bytes(b"no image")
    with pytest.raises(ValidationError, match="unreadable image"):
        load_embeddings("neural", models, GRAPH, tmp_path / "crops")


def test_a_missing_package_is_told_before_the_run_begins(
    tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    GRAPH.save(tmp_path / "graph.json")
    with pytest.raises(ValidationError, match=r"--retrieval neural: found no package 'torch'.*\[foundation\]"):
        generate(tmp_path / "graph.json", tmp_path / "run", GenerationOptions(retrieval="neural"))
    assert not (tmp_path / "run").exists()


def test_other_names_are_refused_and_the_default_needs_nothing(tmp_path: pathlib.Path) -> None:
    assert load_embeddings("built-in", None, GRAPH, tmp_path) is BUILT_IN
    with pytest.raises(ValidationError, match="--retrieval"):
        load_embeddings("magic", None, GRAPH, tmp_path)
