"""The blur by OpenCV's cascades: positions of boxes, and the error without the cascades."""

import pathlib
import types
from typing import Any

import cv2
import numpy as np
import pytest

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.distillation.perception import blur_by_name, haar
from urbanverse_mjx.distillation.perception.haar import HaarDetector


class Cascade:
    """Finds a box of 10 x 20 pixels at the brightest pixel of the left half."""

    def detectMultiScale(self, grey: np.ndarray, scaleFactor: float, minNeighbors: int) -> Any:
        rows, columns = np.nonzero(grey[:, : grey.shape[1] // 2] == 255)
        return [(c, r, 10, 20) for r, c in zip(rows, columns, strict=True)] or ()


def fake_cv2(folder: pathlib.Path) -> Any:
    return types.SimpleNamespace(
        __file__=str(folder / "__init__.py"),
        __version__="5.0",
        COLOR_RGB2GRAY=cv2.COLOR_RGB2GRAY,
        cvtColor=cv2.cvtColor,
        equalizeHist=lambda grey: grey,
        CascadeClassifier=lambda path: Cascade(),
    )


def test_profiles_are_found_on_both_sides() -> None:
    rgb = np.zeros((60, 100, 3), np.uint8)
    rgb[30, 90] = 255  # in the right half: only the mirrored profile cascade finds it
    found = HaarDetector([Cascade(), Cascade(), Cascade()])(rgb)
    np.testing.assert_allclose(found, [[81, 30, 91, 50]])
    rgb[5, 3] = 255
    found = HaarDetector([Cascade(), Cascade(), Cascade()])(rgb)
    assert sorted(map(tuple, found.tolist())) == [(3, 5, 13, 25)] * 3 + [(81, 30, 91, 50)]


def test_without_cascades_it_is_one_sentence(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    monkeypatch.setattr(haar, "cv2", fake_cv2(tmp_path))
    with pytest.raises(ValidationError, match=r"OpenCV 5\.0 without"):
        blur_by_name("haar")


def test_the_name_makes_a_blur(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    (tmp_path / "data").mkdir()
    for name in ("frontalface_default", "profileface", "russian_plate_number"):
        (tmp_path / "data" / f"haarcascade_{name}.xml").write_text("x")
    monkeypatch.setattr(haar, "cv2", fake_cv2(tmp_path))
    rng = np.random.default_rng(0)
    rgb = rng.integers(0, 200, (60, 100, 3), dtype=np.uint8)
    rgb[20, 20] = 255
    out = blur_by_name("haar")(rgb)
    assert len(np.unique(out[22:38, 21:29].reshape(-1, 3), axis=0)) <= 16
    np.testing.assert_array_equal(out[:, 60:], rgb[:, 60:])


def test_opencvs_own_cascades_load() -> None:
    blur = blur_by_name("haar")
    flat = np.full((120, 160, 3), 90, np.uint8)
    np.testing.assert_array_equal(blur(flat), flat)
