"""Scoring of photographs: the labels' form, what counts as found, missed and false, and which faces are blurred."""

import csv
import io
import json
import pathlib
import subprocess

import numpy as np
import PIL.Image
import pytest

from benchmarks import face_blur, photographs
from benchmarks.photographs import Count, ScoredPhotograph, boxes_of, conditions_of, match, row, summary, total
from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.distillation.perception.privacy import Blur
from urbanverse_mjx.distillation.perception_model import classes
from urbanverse_mjx.distillation.perception_model.decode import Decoded, FoundObject


def _box(*sides: float) -> np.ndarray:
    return np.array(sides, float)


def test_labels_name_known_classes_and_lie_in_their_photograph():
    body = json.loads(photographs.LABELS.read_text(encoding="utf-8"))
    entries = body["photographs"]
    assert len(entries) >= 100
    assert len({(e["repository"], e["path"]) for e in entries}) == len(entries)
    for entry in entries:
        assert len(entry["commit"]) == 40
        assert len(entry["boxes"]) + len(entry["points"]) > 3
        for name, left, top, right, bottom in entry["boxes"]:
            assert name in photographs.GROUPS
            assert 0 <= left < right <= body["width"]
            assert 0 <= top < bottom
        assert {kind for kind, _, _ in entry["points"]} <= set(classes.names()[: classes.FIRST_OBJECT])
    groups = [group for members in photographs.GROUPS.values() for group in members]
    assert set(groups) <= set(classes.names())
    assert len(groups) == len(set(groups))
    known = {member for _, members in photographs.CAMVID_CLASSES for member in members}
    assert known <= set(classes.names())


def test_each_label_is_found_once_and_by_its_class():
    counts = {name: Count() for name in photographs.GROUPS}
    labelled = [("car", _box(0, 0, 100, 100)), ("lamp", _box(200, 0, 210, 300)), ("person", _box(400, 0, 440, 90))]
    detected = [
        ("car", 0.6, _box(0, 0, 100, 90)),
        ("car", 0.9, _box(5, 0, 100, 100)),
        ("sign", 0.9, _box(200, 0, 212, 300)),
        ("car", 0.9, _box(700, 0, 730, photographs.MIN_HEIGHT - 1)),
    ]
    distant = match(labelled, detected, counts)
    # The second car is a repetition; the small one far away is not judged.
    assert counts["car"] == Count(there=1, found=1, false=1, any_class=1)
    assert counts["lamp"] == Count(there=1, found=0, false=0, any_class=1)
    assert counts["sign"].false == 1
    assert distant == Count()
    assert row([counts["person"]]) == {"labelled": 1, "recall": [0.0], "precision": None, "recall_any_class": [0.0]}
    assert total(counts) == Count(there=3, found=1, false=2, any_class=2)


def test_distant_objects_are_counted_apart():
    counts = {name: Count() for name in photographs.GROUPS}
    high = photographs.DISTANT - 1.0
    labelled = [("car", _box(0, 0, 60, high)), ("car", _box(100, 0, 160, high)), ("car", _box(200, 0, 300, 90))]
    distant = match(labelled, [("car", 0.9, _box(0, 0, 60, high)), ("car", 0.8, _box(200, 0, 300, 90))], counts)
    assert distant == Count(there=2, found=1, any_class=1)
    assert counts["car"] == Count(there=3, found=2, any_class=2)


def test_conditions_are_light_clutter_and_a_mark_for_terrain():
    grey, dark = (np.full((4, 6, 3), x, np.uint8) for x in (120, int(photographs.LOW_LIGHT) - 1))
    box = ["car", 0, 0, 1, 1]
    assert conditions_of(grey, {"boxes": [box] * (photographs.CLUTTER - 1)}) == ()
    assert conditions_of(dark, {"boxes": [box] * photographs.CLUTTER}) == ("low light", "clutter")
    assert conditions_of(grey, {"boxes": [], "conditions": ["terrain"]}) == ("complex terrain",)
    body = json.loads(photographs.LABELS.read_text(encoding="utf-8"))
    assert {name for e in body["photographs"] for name in e.get("conditions", ())} == {"terrain"}


def test_the_summary_parts_photographs_by_condition(tmp_path: pathlib.Path):
    def scored_photograph(name: str, found: int, *conditions: str) -> ScoredPhotograph:
        counts = {group: Count() for group in photographs.GROUPS}
        counts["car"] = Count(there=4, found=found, false=1, any_class=found)
        return ScoredPhotograph(name, conditions, counts, Count(there=1), (("sky", found > 1),))

    scored = [
        scored_photograph("a", 4),
        scored_photograph("b", 2),
        scored_photograph("c", 0, "low light"),
        scored_photograph("d", 1, "low light", "clutter"),
    ]
    table = summary(scored)
    assert table["objects"]["car"]["recall"][0] == pytest.approx(7 / 16, abs=1e-3)
    assert table["conditions"]["low light"]["photographs"] == 2
    assert table["conditions"]["low light"]["recall"][0] == pytest.approx(1 / 8, abs=1e-3)
    assert table["conditions"]["none of these"]["recall"][0] == 0.75
    assert table["conditions"]["distant objects"]["recall"] == [0.0, 0.0, 0.0]
    assert table["points"]["sky"]["right"][0] == 0.5
    photographs.write_counts(scored, tmp_path / "a.csv")
    lines = (tmp_path / "a.csv").read_text(encoding="utf-8").splitlines()
    assert lines[4] == "d,low light+clutter,4,1,1,1,0"


def test_boxes_enclose_masks_in_pixels_of_the_photograph():
    masks = np.full((10, 20), -1)
    masks[2:5, 4:10] = 0
    masks[6:8, 0:2] = 1
    kinds = [classes.names().index(name) for name in ("van", "bench")]
    objects = tuple(FoundObject(kind, 0.8, 0) for kind in kinds)
    found = boxes_of(Decoded(masks, masks, objects, masks), 100, 400)
    assert [name for name, _, _ in found] == ["car"]
    np.testing.assert_array_equal(found[0][2], [80, 20, 200, 50])


def test_the_kept_counts_are_those_of_the_labels():
    body = json.loads(photographs.LABELS.read_text(encoding="utf-8"))
    with (photographs.LABELS.parent / "scores" / "photographs.csv").open(encoding="utf-8", newline="") as file:
        kept = {r["photograph"]: r for r in csv.DictReader(file)}
    assert set(kept) == {f"{e['repository']}/{e['path']}" for e in body["photographs"]}
    for entry in body["photographs"]:
        counts = kept[f"{entry['repository']}/{entry['path']}"]
        assert int(counts["labelled"]) == len(entry["boxes"])
        assert int(counts["found"]) <= int(counts["labelled"])
        assert int(counts["distant"]) == sum(b[4] - b[2] < photographs.DISTANT for b in entry["boxes"])


def test_a_photograph_is_read_at_its_commit(tmp_path: pathlib.Path):
    clone = tmp_path / "owner+name"
    clone.mkdir()

    def git(*words: str) -> str:
        identity = ["-c", "user.name=a", "-c", "user.email=a@b"]
        return subprocess.run(["git", *identity, *words], cwd=clone, check=True, capture_output=True, text=True).stdout

    git("init", "-q")
    PIL.Image.new("RGB", (40, 20), (200, 0, 0)).save(clone / "a.png")
    git("add", ".")
    git("commit", "-qm", "a")
    commit = git("rev-parse", "HEAD").strip()
    PIL.Image.new("RGB", (40, 20)).save(clone / "a.png")
    image = photographs.photograph(photographs.read_file(tmp_path, "owner/name", commit, "a.png"), 100)
    assert image.shape == (50, 100, 3)
    assert (image[25, 50] == [200, 0, 0]).all()
    with pytest.raises(ValidationError, match=r"git clone https://github\.com/owner/other"):
        photographs.read_file(tmp_path, "owner/other", commit, "a.png")


def test_pixels_of_camvid_are_compared_by_class(monkeypatch: pytest.MonkeyPatch):
    """A model that takes everything for sky is right on the sky's half of the known pixels alone."""
    true = np.zeros((36, 48), np.uint8)
    true[18:] = 3
    true[:, :8] = 11
    files = {"CamVid/test.txt": b"/a/one.png /a/annot/one.png\n"}
    for path, image in (("CamVid/test/one.png", np.zeros((36, 48, 3), np.uint8)), ("CamVid/testannot/one.png", true)):
        body = io.BytesIO()
        PIL.Image.fromarray(image).save(body, "PNG")
        files[path] = body.getvalue()
    monkeypatch.setattr(photographs, "read_file", lambda clones, repository, commit, path: files[path])

    class Sky:
        def decoded(self, rgb: np.ndarray, focal: float) -> Decoded:
            kinds = np.full((18, 24), classes.SKY_CLASS)
            return Decoded(kinds, kinds - 1, (), kinds)

    table = photographs.score_camvid(Sky(), pathlib.Path(), 5)  # type: ignore[arg-type]
    assert table == {"images": 1, "iou": {"sky": 0.5, "road": 0.0}, "mean_iou": 0.25}


# Faces ---------------------------------------------------------------------------------------------------------------


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
