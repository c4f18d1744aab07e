"""The comparison of detectors of faces: labels, covered shares, and false boxes."""

import io
import json
import pathlib

import numpy as np
import PIL.Image
import pytest

from benchmarks import face_blur, photographs
from urbanverse_mjx.distillation.perception.privacy import Blur


def test_labelled_faces_are_of_labelled_people() -> None:
    body = json.loads(photographs.LABELS.read_text(encoding="utf-8"))
    number = 0
    for entry in body["photographs"]:
        people = np.array([b for name, *b in entry["boxes"] if name in ("person", "cyclist")]).reshape(-1, 4)
        for face in np.array(entry.get("faces", [])).reshape(-1, 4):
            assert (face[2:] > face[:2]).all()
            assert face_blur.false_boxes(face[None], people) == 0
            number += 1
    assert number >= 40


def test_the_union_of_boxes_covers_a_face() -> None:
    face = np.array([10.0, 20.0, 20.0, 40.0])
    assert face_blur.share_covered(face, np.zeros((0, 4))) == 0.0
    halves = np.array([[0, 0, 15, 100], [12, 0, 100, 100]], float)
    assert face_blur.share_covered(face, halves[:1]) == 0.5
    assert face_blur.share_covered(face, halves) == 1.0
    assert face_blur.share_covered(face, np.array([[10, 20, 20, 25.0]])) == 0.25


def test_a_detector_is_scored_by_the_width_of_faces(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    entry = {
        "repository": "a/b",
        "commit": "0" * 40,
        "path": "c.png",
        "boxes": [["person", 100, 50, 200, 300], ["car", 500, 100, 600, 200]],
        "faces": [[130, 60, 150, 90], [180, 60, 185, 68]],
        "points": [],
    }
    body = {"width": 1000, "photographs": [entry, {**entry, "path": "d.png", "faces": []}]}
    del body["photographs"][1]["faces"]
    (tmp_path / "labels.json").write_text(json.dumps(body), encoding="utf-8")
    file = io.BytesIO()
    PIL.Image.new("RGB", (100, 60)).save(file, "png")
    monkeypatch.setattr(photographs, "LABELS", tmp_path / "labels.json")
    monkeypatch.setattr(photographs, "read_file", lambda clones, repository, commit, path: file.getvalue())

    def detector(rgb: np.ndarray) -> np.ndarray:
        assert rgb.shape == (600, 1000, 3)
        # Nine tenths of the large face, which the margin completes, and a headlight of the car.
        return np.array([[131.0, 62, 149, 88], [510, 150, 520, 160]])

    table = face_blur.score_detector(Blur(detector, "mine"), tmp_path)
    assert table["photographs"] == 1
    assert table["false"] == 1
    assert table["all"] == {"faces": 2, "covered": [0.5]}
    assert table["widths"]["16 and more"] == {"faces": 1, "covered": [1.0]}
    assert table["widths"]["below 8"] == {"faces": 1, "covered": [0.0]}
    assert table["widths"]["8 to 16"] == {"faces": 0, "covered": None}
