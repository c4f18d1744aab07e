"""Answers of the viewer's library page: scenes with images, assets to search and turn, skies and grounds."""

import functools
import io
import json
import pathlib
import threading
import zipfile
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..datatypes import ValidationError
from ..datatypes import validation as v

if TYPE_CHECKING:
    from .view_scenes import ViewScenes

#: Assets of an answer, and most that a text finds.
_PAGE, _MOST = 24, 480
#: Pixels (width, height) of a scene's image.
_IMAGE_SIZE = (640, 400)
#: What the page shows of an asset's annotation: name -> field.
_FIELDS = {
    "made of": "materials",
    "colours": "colors",
    "movable": "movable",
    "force to move it (N)": "required_force",
    "friction": "friction_coefficient",
    "surface": "surface_finish",
    "it is": "affordances",
    "moving parts": "interactive_parts",
    "for passers-by": "traversability",
    "source": "provenance",
}
_KINDS = ("sky", "road", "sidewalk")


class ViewLibrary:
    """The library of this machine.

    Args:
      scenes: that can be opened.
      open_scene: opens one by name in the viewer.
    """

    def __init__(self, scenes: "ViewScenes", open_scene: Callable[[str], None]) -> None:
        self._scenes, self._open_scene = scenes, open_scene
        self._images: dict[str, bytes] = {}
        # Requests come from several threads; an image or a catalogue is made once.
        self._drawing, self._loading = threading.Lock(), threading.Lock()

    def answer(self, path: str, query: Mapping[str, str]) -> tuple[str, bytes]:
        """Type and content of the answer to a request; path: after "library/", empty for the page itself.

        Raises:
          ValidationError: a request that cannot be answered; the message says why.
        """
        if path == "":
            return "text/html; charset=utf-8", _page()
        if path == "three.js":
            return "text/javascript; charset=utf-8", three_js()
        if path == "scene":
            return "image/jpeg", self._image(_text(query, "name"))
        if path == "mesh":
            return "model/gltf-binary", self._mesh(_text(query, "uid"))
        if path == "look":
            return "image/jpeg", _look(_kind(query), _text(query, "uid"))
        answers: dict[str, Callable[[Mapping[str, str]], Any]] = {
            "scenes": lambda _: self._list_scenes(),
            "open": self._open,
            "words": lambda _: self._words(),
            "assets": self._assets,
            "looks": lambda q: _looks(_kind(q), q.get("query")),
        }
        if path not in answers:
            raise v.fail("library", repr(path), f"one of {', '.join(answers)}")
        return "application/json", json.dumps(answers[path](query), ensure_ascii=False, allow_nan=False).encode()

    def _list_scenes(self) -> list[dict[str, Any]]:
        return [{"name": name, "cousins": self._scenes.cousins(name)} for name in self._scenes.names]

    def _open(self, query: Mapping[str, str]) -> dict[str, str]:
        name = self._known(_text(query, "scene"))
        self._open_scene(name)
        return {"opening": name}

    def _known(self, name: str) -> str:
        if name not in self._scenes.names:
            raise v.fail("scene", repr(name), "one of the list")
        return name

    def _image(self, name: str) -> bytes:
        from ..viz.images import Studio

        self._known(name)
        with self._drawing:
            if name not in self._images:
                bank, row = self._scenes.load(name)
                image = Studio(bank, *_IMAGE_SIZE, samples=1).birdseye(row)
                self._images[name] = _jpeg(image)
            return self._images[name]

    @property
    def _objects(self) -> Any:
        from ..assets.selection.search import full_library

        with self._loading:
            return full_library()

    def _words(self) -> dict[str, list[str]]:
        """The words for the page's lists."""
        return {
            "class": self._objects.categories(2),
            "material": self._objects.words("dominant_materials"),
            "colour": self._objects.words("dominant_colors"),
        }

    def _assets(self, query: Mapping[str, str]) -> dict[str, Any]:
        objects, text = self._objects, query.get("query")
        low, high = (_number(query, name) for name in ("low", "high"))
        conditions = {
            "categories": [query["class"]] if "class" in query else None,
            "dominant_materials": [query["material"]] if "material" in query else None,
            "dominant_colors": [query["colour"]] if "colour" in query else None,
            "max_dimension_range": (low, high) if (low, high) != (None, None) else None,
        }
        asked = text is not None or any(value is not None for value in conditions.values())
        found = objects.get_uids_conditioned(query=text, top_k=_MOST, **conditions) if asked else self._one_of_each()
        start = int(_number(query, "start") or 0)
        rows = objects.load_annotations(found[start : start + _PAGE])
        body = {"count": len(found), "of": objects.table.num_rows, "best": text is not None}
        return {**body, "rows": [_asset(uid, row) for uid, row in rows.items()]}

    def _one_of_each(self) -> list[str]:
        """The first asset of every leaf."""
        table = self._objects.table
        pairs = zip(table["category"].to_pylist(), table["uid"].to_pylist(), strict=True)
        return list(dict(reversed(list(pairs))).values())[::-1]

    def _mesh(self, uid: str) -> bytes:
        from ..assets.records.index import build_mesh
        from ..viewer.gltf import Part, Surface, glb

        mesh = build_mesh(self._objects.record(uid))
        surface = Surface(texture=mesh.texture, roughness=mesh.roughness, metallic=mesh.metallic)
        return glb([Part(mesh.vertices, mesh.faces, surface, mesh.uv)])


def _asset(uid: str, row: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "uid": uid,
        "class": row["class_name_l3"],
        "description": row["description"],
        "size": [float(row[side]) for side in ("length", "width", "height")],
        "mass": float(row["mass"]),
        "fields": {name: text for name, key in _FIELDS.items() if (text := _shown(row.get(key)))},
    }


def _shown(value: Any) -> str:
    """A field as text, empty where there is nothing."""
    if isinstance(value, (list, tuple, np.ndarray)):
        return ", ".join(_shown(part) for part in value if part != "air")
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.3g}" if isinstance(value, float) else str(value or "")


def _looks(kind: str, text: str | None) -> list[dict[str, str]]:
    """Skies or grounds, by a text or all of them."""
    from ..assets.selection.libraries import library

    collection = library(kind)
    uids = collection.get_uids_conditioned(query=text, top_k=_MOST)
    return [{"uid": uid, "description": row["description"]} for uid, row in collection.load_annotations(uids).items()]


def _look(kind: str, uid: str) -> bytes:
    from ..assets.selection.libraries import library

    return _jpeg(library(kind).load_thumbnails([uid])[uid])


def _kind(query: Mapping[str, str]) -> str:
    return v.choice(_text(query, "kind"), "kind", _KINDS)


def _text(query: Mapping[str, str], name: str) -> str:
    return v.text(query.get(name), name)


def _number(query: Mapping[str, str], name: str) -> float | None:
    if name not in query:
        return None
    try:
        return v.number(float(query[name]), name, 0.0)
    except ValueError:
        raise v.fail(name, repr(query[name]), "a number") from None


def _jpeg(image: np.ndarray) -> bytes:
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(image).save(file, "JPEG", quality=85)
    return file.getvalue()


@functools.cache
def _page() -> bytes:
    from ..viewer import front

    return pathlib.Path(front.__file__).with_name("library.html").read_bytes()


@functools.cache
def three_js() -> bytes:
    """three.js with its loader of glTF, as trimesh has it for notebooks: a browser without network needs no other.

    Raises:
      ValidationError: another version of trimesh keeps it elsewhere.
    """
    from trimesh import resources

    with zipfile.ZipFile(io.BytesIO(resources.get_bytes("templates/viewer.zip"))) as archive:
        page = archive.read("viewer.html.template").decode()
    script, found, _ = page.partition("<script>")[2].partition("var camera,controls,scene")
    if not found or "THREE.GLTFLoader=" not in script:
        raise ValidationError("trimesh: found no three.js in its viewer's template, needed that of trimesh 5.2.")
    return script.encode()
