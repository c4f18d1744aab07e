"""Imported assets in catalogue, search and materialisation."""

import json
import pathlib
import shutil
from typing import Any

import numpy as np
import pytest
import trimesh
from trimesh.exchange import stl

from tests.support.box_bank import street_regions
from urbanverse_mjx.assets import build_mesh, imported_index
from urbanverse_mjx.assets.importing.run import Options, import_folder
from urbanverse_mjx.assets.records.store import ensure_store
from urbanverse_mjx.assets.selection.matching import Matcher
from urbanverse_mjx.assets.selection.search import ObjectLibrary, full_library, library
from urbanverse_mjx.cli.main import main
from urbanverse_mjx.datatypes import AssetRecord, GraphObject, SceneGraph, Source
from urbanverse_mjx.materialisation import index_of, materialise_cousins

Both = tuple[ObjectLibrary, ObjectLibrary, AssetRecord]


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory):
    """(catalogue, catalogue with an imported storage box, the box's record)."""
    plain = library()  # in the tests' cache
    cache = tmp_path_factory.mktemp("cache")
    (cache / "assets").mkdir()
    shutil.copy(ensure_store(), cache / "assets")  # made anew in 10 s
    patch = pytest.MonkeyPatch()
    patch.setenv("URBANVERSE_CACHE", str(cache))
    assert full_library() is plain
    folder = tmp_path_factory.mktemp("files")
    body = trimesh.creation.box((0.613, 0.371, 0.293))
    (folder / "0815.stl").write_bytes(stl.export_stl(body))
    options = Options(licence="CC0-1.0", leaf="storage box", pictures=False)
    (entry,) = import_folder(folder, options, lambda *_: None)
    assert entry.uid, entry.why
    yield plain, full_library(), imported_index().get(entry.uid)
    patch.undo()


def test_the_catalogue_holds_it_behind_all_others(both: Both) -> None:
    plain, full, box = both
    assert full.get_uids_all() == [*plain.get_uids_all(), box.uid]
    (found,) = full.imported()
    assert (found.uid, found.params, found.extent_xyz) == (box.uid, box.params, box.extent_xyz)
    assert (found.mass, found.volume) == pytest.approx((box.mass, box.volume), rel=1e-3)
    assert plain.imported() == []
    assert full.load_annotations([box.uid])[box.uid]["license_info"]["license"] == "CC0-1.0"
    assert full_library() is full


def test_search_finds_it(both: Both, capsys: pytest.CaptureFixture[str]) -> None:
    plain, full, box = both
    sides: dict[str, Any] = {
        f"{name}_range": [getattr(box, name) - 1e-6, getattr(box, name) + 1e-6] for name in ("length", "height")
    }
    assert full.get_uids_conditioned(query="storage box", categories=["storage box"], **sides) == [box.uid]
    assert plain.get_uids_conditioned(query="storage box", categories=["storage box"], **sides) == []
    assert main(["assets", "search", "storage box", "--filters", json.dumps(sides)]) == 0
    assert box.uid in capsys.readouterr().out
    assert main(["assets", "list", "--leaf", "storage box"]) == 0
    assert box.uid in capsys.readouterr().out


def test_it_stands_for_objects_of_its_size(both: Both) -> None:
    _, full, box = both
    best = Matcher(full).match("storage box", box.extent_xyz)[0]
    assert (best.uid, best.base, best.distortion) == (box.uid, box.uid, 0.0)
    grey = [0] * 44 + [255] * 16 + [128]
    assert box.uid in {m.uid for m in Matcher(full).match("storage box", box.extent_xyz, grey, count=1000)}
    place = (10.0, 6.0, 0.15 + box.height / 2)
    source = Source("hand", "Apache-2.0", "none", "none")
    boxes = (GraphObject("box", "storage box", place, box.extent_xyz, 0.0),)
    graph = SceneGraph("street", source, boxes, tuple(street_regions()))
    cousins, others = materialise_cousins(graph, 16, objects=full), materialise_cousins(graph, 16)
    used = [c.layout for c in cousins if c.layout.objects[0].asset_uid == box.uid]
    assert used
    np.testing.assert_allclose(build_mesh(index_of(used[0], full).get(box.uid)).extent, box.extent_xyz, atol=1e-3)
    assert box.uid not in {c.layout.objects[0].asset_uid for c in others}
    assert used[0].hashes["assets"] != others[0].layout.hashes["assets"]


def test_a_bank_with_imported_assets_is_not_put_into_the_cache(
    tmp_path: pathlib.Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["scene", "bank", str(tmp_path / "graph.json"), "--imported"]) == 2
    assert "--out" in capsys.readouterr().err
