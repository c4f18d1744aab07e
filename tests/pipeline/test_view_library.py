"""Answers of the viewer's library against the catalogue that it shows."""

import io
import json
import types
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from urbanverse_mjx.assets.selection.libraries import library
from urbanverse_mjx.assets.selection.search import full_library
from urbanverse_mjx.datatypes import SceneBank, ValidationError
from urbanverse_mjx.pipeline.view_library import ViewLibrary


@pytest.fixture(scope="module")
def opened() -> list[str]:
    return []


@pytest.fixture(scope="module")
def shown(small_bank: SceneBank, opened: list[str]) -> ViewLibrary:
    names = list(small_bank.scene_ids)
    scenes: Any = types.SimpleNamespace(
        names=names, cousins=lambda name: names.index(name) + 1, load=lambda name: (small_bank, names.index(name))
    )
    return ViewLibrary(scenes, opened.append)


def ask(shown: ViewLibrary, path: str, **query: str) -> Any:
    kind, body = shown.answer(path, {name.rstrip("_"): value for name, value in query.items()})
    assert kind == "application/json"
    return json.loads(body)


def image(answer: tuple[str, bytes]) -> np.ndarray:
    assert answer[0] == "image/jpeg"
    return np.asarray(Image.open(io.BytesIO(answer[1])))


def test_scenes_are_listed_drawn_and_opened(shown: ViewLibrary, small_bank: SceneBank, opened: list[str]) -> None:
    first, second = small_bank.scene_ids[:2]
    assert ask(shown, "scenes")[1] == {"name": second, "cousins": 2}
    images = [image(shown.answer("scene", {"name": name})) for name in (first, second)]
    assert images[0].shape == (400, 640, 3)
    assert min(image.std() for image in images) > 10.0
    assert np.abs(images[0].astype(int) - images[1]).mean() > 1.0
    assert ask(shown, "open", scene=second) == {"opening": second}
    with pytest.raises(ValidationError, match="scene: found 'nowhere', needed one of the list"):
        shown.answer("open", {"scene": "nowhere"})
    assert opened == [second]


def test_a_search_finds_what_the_catalogue_finds(shown: ViewLibrary) -> None:
    objects = full_library()
    found = ask(shown, "assets", query="bench", class_="furniture", colour="green", low="1", high="2.5")
    wanted = objects.get_uids_conditioned(
        query="bench", top_k=480, categories=["furniture"], dominant_colors=["green"], max_dimension_range=(1.0, 2.5)
    )
    assert found["count"] == len(wanted)
    assert [row["uid"] for row in found["rows"]] == wanted[:24]
    for row in found["rows"]:
        assert 1.0 <= max(row["size"]) <= 2.5
        assert "green" in row["fields"]["colours"]
    following = ask(shown, "assets", query="bench", class_="furniture", colour="green", low="1", high="2.5", start="24")
    assert [row["uid"] for row in following["rows"]] == wanted[24:48]
    assert ask(shown, "words")["class"] == objects.categories(2)


def test_without_a_search_there_is_one_of_each_kind(shown: ViewLibrary) -> None:
    found = ask(shown, "assets")
    assert (found["count"], found["of"]) == (len(full_library().categories(3)), len(full_library().get_uids_all()))
    assert len({row["class"] for row in found["rows"]}) == 24


def test_a_mesh_has_the_size_of_its_record(shown: ViewLibrary) -> None:
    row = ask(shown, "assets", query="bench")["rows"][0]
    kind, body = shown.answer("mesh", {"uid": row["uid"]})
    assert kind == "model/gltf-binary"
    mesh = trimesh.load_scene(io.BytesIO(body), file_type="glb")
    # Upright; its length is the longer of its sides.
    np.testing.assert_allclose([*sorted(mesh.extents[:2], reverse=True), mesh.extents[2]], row["size"], rtol=0.02)


def test_looks_are_the_thumbnails(shown: ViewLibrary) -> None:
    for kind in ("sky", "road", "sidewalk"):
        collection = library(kind)
        rows = ask(shown, "looks", kind=kind)
        assert [row["uid"] for row in rows] == collection.get_uids_all()
        stored = collection.load_thumbnails([rows[3]["uid"]])[rows[3]["uid"]].astype(int)
        drawn = image(shown.answer("look", {"kind": kind, "uid": rows[3]["uid"]}))
        assert np.abs(drawn - stored).mean() < 6.0


@pytest.mark.parametrize(
    ("path", "query", "message"),
    [
        ("nothing", {}, "library: found 'nothing', needed one of scenes"),
        ("scene", {}, "name: found None, needed a text"),
        ("mesh", {"uid": "no/such"}, "asset uid: found 'no/such'"),
        ("assets", {"query": "qqqqqxyz"}, "found 'qqqqqxyz'"),
        ("assets", {"low": "wide"}, "low: found 'wide', needed a number"),
        ("assets", {"low": "3", "high": "2"}, "needed least <= greatest"),
        ("assets", {"start": "-1"}, "start"),
        ("looks", {"kind": "sea"}, "kind: found 'sea', needed one of sky"),
        ("look", {"kind": "sky", "uid": "none"}, "none"),
    ],
)
def test_a_bad_request_is_one_sentence(shown: ViewLibrary, path: str, query: dict[str, str], message: str) -> None:
    with pytest.raises(ValidationError, match=message) as error:
        shown.answer(path, query)
    assert "\n" not in str(error.value)
