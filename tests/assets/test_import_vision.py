"""Annotation of imported files: the official JSON, licences, and a vision endpoint played by a local server."""

import base64
import http.server
import io
import json
import pathlib
import threading
from collections.abc import Iterator
from typing import Any

import pytest
from PIL import Image

from tests.assets import mesh_files
from urbanverse_mjx.assets import imported_index
from urbanverse_mjx.assets.importing import vision
from urbanverse_mjx.assets.importing.annotation import checked, known_licence, leaf_in, licence_of
from urbanverse_mjx.assets.importing.run import Entry, Options, import_folder
from urbanverse_mjx.assets.importing.screening import RefusedFileError
from urbanverse_mjx.settings import VisionEndpoint

ANSWER = {
    "category": "wooden park bench",
    "description": "a bench of brown planks",
    "height": 0.85,
    "mass": 41.5,
    "materials": ["wood", "steel"],
    "materials_composition": [0.7, 0.3],
    "frontView": 0,
    "friction_coefficient": 0.6,
    "movable": True,
    "bounciness": 7,
}


class Model(http.server.ThreadingHTTPServer):
    """An endpoint that records its requests and replies in turn from `answers` (a status or a message)."""

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Asked)
        self.asked: list[tuple[str, str, dict[str, Any]]] = []
        self.answers: list[int | str] = []


class Asked(http.server.BaseHTTPRequestHandler):
    server: Model

    def do_POST(self) -> None:
        body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        self.server.asked.append((self.path, self.headers.get("Authorization", ""), body))
        answer = self.server.answers.pop(0)
        self.send_response(answer if isinstance(answer, int) else 200)
        self.end_headers()
        if isinstance(answer, str):
            self.wfile.write(json.dumps({"choices": [{"message": {"content": answer}}]}).encode())

    def log_message(self, format: str, *args: Any) -> None:
        pass


@pytest.fixture
def model(monkeypatch: pytest.MonkeyPatch) -> Iterator[Model]:
    monkeypatch.setattr(vision, "WAIT", 0.0)
    server = Model()
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield server
    server.shutdown()
    server.server_close()


@pytest.fixture
def folder(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> pathlib.Path:
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    (tmp_path / "files").mkdir()
    return tmp_path / "files"


def put(folder: pathlib.Path, name: str, leaf: str = "bench") -> None:
    (folder / name).write_bytes(mesh_files.glb_bytes(mesh_files.mesh_of(leaf)[1], None, mesh_files.LICENCE))


def ask(folder: pathlib.Path, server: Model) -> Entry:
    endpoint = VisionEndpoint(f"http://127.0.0.1:{server.server_port}/v1", "eyes-1", "the key")
    (entry,) = import_folder(folder, Options(jobs=1, pictures=False, endpoint=endpoint), lambda *_: None)
    return entry


def test_an_endpoint_names_what_its_file_does_not(model: Model, folder: pathlib.Path) -> None:
    """A 503 is retried, the request has four images, and invalid fields of the reply are left out."""
    put(folder, "qz81_final.glb")
    model.answers = [503, f"Here it is:\n```json\n{json.dumps(ANSWER)}\n```"]
    entry = ask(folder, model)
    if any("no images" in note for note in entry.notes):
        pytest.skip("no off-screen OpenGL here")
    assert entry.uid, entry
    record = imported_index().get(entry.uid)
    assert (record.leaf, record.mass, record.materials) == ("bench", 41.5, ("wood", "steel"))
    assert record.friction_coefficient == 0.6
    assert record.required_force == pytest.approx(0.6 * 41.5 * 9.81, abs=0.1)
    assert record.height == pytest.approx(0.85, rel=0.1)
    assert [(name, fixed) for name, _, fixed in entry.findings] == [("inconsistent name", True)]
    assert any("bounciness" in note for note in entry.notes)
    assert len(model.asked) == 2
    path, authorization, body = model.asked[1]
    assert (path, authorization, body["model"]) == ("/v1/chat/completions", "Bearer the key", "eyes-1")
    text, *shown = body["messages"][0]["content"]
    assert "fire hydrant" in text["text"]
    seen = [Image.open(io.BytesIO(base64.b64decode(p["image_url"]["url"].partition(",")[2]))) for p in shown]
    assert [p.size for p in seen] == [(256, 256)] * 4
    assert len({p.tobytes() for p in seen}) == 4


@pytest.mark.parametrize("answer", [401, "no JSON at all", '{"category": "galaxy cluster"}', "{" * 50_000 + "}"])
def test_a_useless_endpoint_leaves_it_to_the_priors(model: Model, folder: pathlib.Path, answer: int | str) -> None:
    put(folder, "bench.glb")
    model.answers = [answer]
    entry = ask(folder, model)
    assert entry.uid
    assert any("from the priors" in note for note in entry.notes)
    assert len(model.asked) <= 1


def test_an_annotated_file_is_not_shown_to_anyone(model: Model, folder: pathlib.Path) -> None:
    put(folder, "qz81.glb")
    (folder / "qz81.json").write_text(json.dumps(ANSWER | {"bounciness": 0.1, "near_synsets": {"bench.n.01": 0.9}}))
    entry = ask(folder, model)
    assert entry.uid
    assert model.asked == []
    record = imported_index().get(entry.uid)
    assert (record.leaf, record.mass, record.description) == ("bench", 41.5, "a bench of brown planks")
    (annotation,) = (folder.parent / "cache").rglob("annotation.json")
    stored = json.loads(annotation.read_text(encoding="utf-8"))
    assert stored["near_synsets"] == {"bench.n.01": 0.9}, "fields that nobody reads are kept"
    assert stored["license_info"]["license"] == mesh_files.LICENCE


def test_units_of_the_official_fields() -> None:
    fields, complaints = checked({"youngs_modulus": 2e11, "quality": 8, "mass": float("nan"), "frontView": 4}, "x.json")
    assert fields == {"youngs_modulus": 2e5, "quality": 8.0}
    assert len(complaints) == 2
    assert checked({"youngs_modulus": 200000}, "x")[0] == {"youngs_modulus": 200000.0}


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("by", "CC-BY-4.0"),
        ("by-nc-sa", "CC-BY-NC-SA-4.0"),
        ("CC BY 3.0", "CC-BY-3.0"),
        ("http://creativecommons.org/licenses/by-sa/4.0/", "CC-BY-SA-4.0"),
        ("CC0", "CC0-1.0"),
        ("Apache-2.0", "Apache-2.0"),
        ("(c) 2024 somebody", None),
        ("standby", None),
    ],
)
def test_licences(text: str, name: str | None) -> None:
    assert known_licence(text) == name


def test_where_a_licence_is_looked_for() -> None:
    assert licence_of({"license_info": {"license": "by"}}, {"license": "MIT"}, "", "CC0") == "CC-BY-4.0"
    assert licence_of({}, {"license": "MIT"}, "", None) == "MIT"
    assert licence_of({}, {}, "(c) 2024 somebody", "CC0") == "CC0-1.0"
    assert licence_of({}, {"license": "my own terms"}, "", None) == "my own terms"
    for copyright_text in ("", "(c) 2024 somebody", "(c) somebody, all rights reserved"):
        with pytest.raises(RefusedFileError) as refusal:
            licence_of({}, {}, copyright_text, None)
        assert refusal.value.reason == "no licence"


@pytest.mark.parametrize(
    ("name", "leaf"),
    [
        ("ParkBench_v2", "bench"),
        ("SM-fire_hydrant.001", "fire hydrant"),
        ("x91--street-light", "street light"),
        ("b7", None),
    ],
)
def test_leaves_in_file_names(name: str, leaf: str | None) -> None:
    assert leaf_in([name]) == leaf
