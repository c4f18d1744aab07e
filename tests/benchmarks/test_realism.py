"""The realism figure: measures of a scene by hand, diversity by hand, an image that is one."""

import json
import pathlib

import numpy as np
import pytest
from PIL import Image

from benchmarks import realism
from urbanverse_mjx.datatypes import PlacedGround, PlacedObject, SceneLayout, ValidationError

GROUND = (PlacedGround("g", "sidewalk", ((0, 0), (1, 0), (1, 1)), (0.0, 0.0, 0.0), "slabs_grey"),)


def _layout(graph: str, cousin: int, uids: list[str]) -> SceneLayout:
    objects = tuple(
        PlacedObject(f"o{i}", u[0], u[0], u, (0.0, 0.0, 0.0), 0.0, (1.0, 1.0, 1.0), 1.0, 0.5, False)
        for i, u in enumerate(uids)
    )
    return SceneLayout(f"{graph}_{cousin}", graph, "h", 0, cousin, objects, GROUND, "sky", 0.0, {})


def _scene(folder: pathlib.Path, layout: SceneLayout, objects: int) -> None:
    folder.mkdir(parents=True)
    layout.save(folder / "layout.json")
    statistics = {
        "objects": objects,
        "houses": 10,
        "categories": {"tree": 6, "bench": 4},
        "spacing_m": {"p50": 1.5} if objects else {},
        "kerbs": {"length_m": 1.0, "height_m": 0.15},
        "pavement": {
            "length_m": 50.0,
            "width_under": {"2": 0.25, "3": 0.5},
            "narrower_than": {"robot": 0.1, "ada": 0.2, "prowag": 0.3},
        },
    }
    body = {"schema": "urbanverse.compiled_scene/1", "id": layout.id, "statistics": statistics}
    (folder / "metadata.json").write_text(json.dumps(body))


def test_diversity_is_bray_curtis_between_cousins_and_between_layouts() -> None:
    """Cousins share one of two assets; another layout has one category in common with either first cousin."""
    layouts = [_layout("x", 0, ["a1", "b1"]), _layout("x", 1, ["a1", "b2"]), _layout("y", 0, ["a1", "c1"])]
    found = realism.diversity(layouts)
    assert found == {"cousin_assets": 0.5, "layout_assets": 0.5, "cousin_objects": 0.0, "layout_objects": 0.5}
    assert realism.diversity(layouts[:1]) == {}


def test_figure_and_numbers(tmp_path: pathlib.Path, capsys) -> None:
    for k in range(3):
        _scene(tmp_path / "real" / str(k), _layout("x", k, ["a1", f"b{k}"]), 20 + k)
    _scene(tmp_path / "plain" / "0", _layout("y", 0, ["c1"]), 30)
    out = tmp_path / "figure.png"
    families = [f"{n}={tmp_path / n}" for n in ("real", "plain")]
    assert realism.main([*families, "--out", str(out)]) == 0
    figure = json.loads((tmp_path / "figure.json").read_text())
    assert figure["families"]["real"]["median"]["objects"] == pytest.approx(22.0)  # 11 on 50 m
    assert figure["families"]["real"]["median"]["trees"] == pytest.approx(12.0)
    assert (figure["families"]["real"]["scenes"], figure["families"]["real"]["layouts"]) == (3, 1)
    assert "objects" in figure["no_page_gave"]
    assert all(p["address"].startswith("https://") for rows in figure["published"].values() for p in rows)
    image = np.asarray(Image.open(out))
    assert image.shape[1] > 1500
    for colour in ((40, 96, 190), (214, 66, 40)):
        assert (image == colour).all(-1).sum() > 200  # dots of either family
    json.loads(capsys.readouterr().out)


def test_a_family_without_scenes_is_refused(tmp_path: pathlib.Path, capsys) -> None:
    assert realism.main([f"x={tmp_path}", "--out", str(tmp_path / "f.png")]) == 2
    assert "no compiled scene" in capsys.readouterr().err
    with pytest.raises(ValidationError, match="NAME=FOLDER"):
        realism.families_of(["x"])
    assert not (tmp_path / "f.png").exists()
