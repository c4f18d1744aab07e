"""Foundation models behind `Predictor`: processing of their outputs, tested on synthetic outputs; no model is run."""

import contextlib
import pathlib
import sys
import types
from typing import Any

import numpy as np
import pytest

from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.importing.vision import VisionError
from urbanverse_mjx.datatypes import KIND_INDEX, ValidationError
from urbanverse_mjx.datatypes.recording import SKY
from urbanverse_mjx.distillation.perception.foundation import FoundationPredictor, boxes, grounds, loading
from urbanverse_mjx.distillation.perception.foundation.loading import Loaded
from urbanverse_mjx.pipeline.generation import listing
from urbanverse_mjx.pipeline.generation.predictors import make_predictor
from urbanverse_mjx.pipeline.generation.video_options import VideoOptions

H, W = 40, 80


def logit(p: float) -> float:
    return float(np.log(p / (1 - p)))


def test_owls_boxes_are_in_the_square_that_the_picture_was_padded_to() -> None:
    """A box over the image's right half: the square's side is 80, so its height is half of the image's share."""
    logits = np.array([[logit(0.1), logit(0.9)], [logit(0.05), logit(0.02)], [logit(0.6), logit(0.3)]])
    share = np.array([[0.75, 0.25, 0.5, 0.5], [0.5, 0.5, 0.1, 0.1], [0.1, 0.9, 0.2, 0.2]])
    found = boxes.decode_owl(logits, share, H, W, 0.2)
    np.testing.assert_allclose(found.box, [[40, 0, 80, 40]])  # the third lies in the padding
    assert found.label.tolist() == [1]
    np.testing.assert_allclose(found.score, [0.9])


def test_one_object_found_by_two_words_is_one() -> None:
    box = np.array([[0, 0, 10, 10], [0, 0, 10, 9], [5, 0, 15, 10]], float)
    found = boxes.suppressed(boxes.Boxes(box, np.array([0, 1, 2]), np.array([0.5, 0.9, 0.3])))
    assert found.label.tolist() == [1, 2]  # 0.9 overlaps, a third does not


def test_small_objects_lie_on_large_ones_and_specks_vanish() -> None:
    masks = np.zeros((3, H, W), bool)
    masks[0, 10:20, 10:20] = masks[1, 5:35, 5:60] = True
    masks[2, 0, 0] = True
    painted, kept = boxes.paint(masks, np.array([0.4, 0.8, 0.99]))
    assert kept.tolist() == [1, 0]
    assert painted[15, 15] == 1
    assert painted[30, 30] == 0
    assert painted[0, 0] == -1


def test_grounds_of_two_label_sets() -> None:
    cityscapes = {0: "road", 1: "sidewalk", 2: "building", 3: "wall", 9: "terrain", 10: "sky", 13: "car"}
    codes = grounds.surface_codes(cityscapes)
    road, walk, ground = (KIND_INDEX[k] for k in ("road", "sidewalk", "ground"))
    assert codes[[0, 1, 2, 3, 9, 10, 13]].tolist() == [road, walk, 0, 0, ground, SKY, 0]
    vistas = {
        2: "Curb",
        5: "Road Barrier",
        8: "Crosswalk - Plain",
        13: "Road",
        23: "Lane Marking - Crosswalk",
        24: "Lane Marking - General",
    }
    crosswalk, paint = KIND_INDEX["crosswalk"], KIND_INDEX["road_marking"]
    assert grounds.surface_codes(vistas)[[2, 5, 8, 13, 23, 24]].tolist() == [walk, 0, crosswalk, road, crosswalk, paint]
    with pytest.raises(ValidationError, match="class road"):
        grounds.surface_codes({0: "cat", 1: "sky"})


class Tensor:
    """As much of torch's as is used."""

    def __init__(self, values: Any) -> None:
        self.values = np.asarray(values)

    def __getitem__(self, index: Any) -> "Tensor":
        return Tensor(self.values[index])

    def float(self) -> "Tensor":
        return Tensor(self.values.astype(np.float32))

    def cpu(self) -> "Tensor":
        return self

    def numpy(self) -> np.ndarray:
        return self.values

    def __array__(self, dtype: Any = None, copy: Any = None) -> np.ndarray:
        return self.values


class Inputs(dict):
    def to(self, device: str) -> "Inputs":
        assert device == "cpu"
        return self


class Detector:
    """Takes 70 words in two lists; detects the 66th in the left half of the image."""

    asked: tuple[str, ...] = ()

    def __call__(self, text: list[list[str]], images: Any, return_tensors: str) -> Inputs:
        assert images.size == (W, H)
        return Inputs(words=text[0])

    def answer(self, words: list[str]) -> Any:
        self.asked += tuple(words)
        logits = np.full((1, 2, len(words)), logit(0.01))
        if "a photo of a word 65" in words:
            logits[0, 0, words.index("a photo of a word 65")] = logit(0.7)
        share = [[[0.25, 0.25, 0.5, 0.5], [0.5, 0.5, 1.0, 1.0]]]
        return types.SimpleNamespace(logits=Tensor(logits), pred_boxes=Tensor(share))


class Segmenter:
    def __call__(self, images: Any, input_boxes: list, return_tensors: str) -> Inputs:
        np.testing.assert_allclose(input_boxes, [[[0, 0, 40, 40]]])
        return Inputs(original_sizes=[(H, W)], marker=1)

    def post_process_masks(self, masks: Any, sizes: list) -> list:
        assert sizes == [(H, W)]
        full = np.zeros((1, 1, H, W), bool)
        full[0, 0, 10:40, 5:35] = True
        return [Tensor(full)]


class Ground:
    def __call__(self, images: Any, return_tensors: str) -> Inputs:
        return Inputs()

    def post_process_semantic_segmentation(self, answer: Any, target_sizes: list) -> list:
        assert target_sizes == [(H, W)]
        return [Tensor(np.where(np.arange(H)[:, None] < 10, 1, 0) * np.ones((1, W), int))]


class Depth:
    def __call__(self, images: Any, return_tensors: str) -> Inputs:
        return Inputs()


def foundation(monkeypatch: pytest.MonkeyPatch, words: int = 70) -> tuple[FoundationPredictor, Detector]:
    torch: Any = types.SimpleNamespace(inference_mode=contextlib.nullcontext)
    monkeypatch.setitem(sys.modules, "torch", torch)
    detector = Detector()
    masks = types.SimpleNamespace(pred_masks=Tensor(np.zeros(1)))
    depth = types.SimpleNamespace(predicted_depth=Tensor(np.full((1, 5, 9), 7.5)))
    predictor = FoundationPredictor(
        labels=tuple(f"word {k}" for k in range(words)),
        detector=Loaded(detector.answer, detector, "cpu"),
        segmenter=Loaded(lambda original_sizes, marker, multimask_output: masks, Segmenter(), "cpu"),
        ground=Loaded(lambda: None, Ground(), "cpu"),
        depth=Loaded(lambda: depth, Depth(), "cpu"),
        codes=grounds.surface_codes({0: "road", 1: "sky"}),
    )
    return predictor, detector


def test_four_answers_become_one_observation(monkeypatch: pytest.MonkeyPatch) -> None:
    predictor, detector = foundation(monkeypatch)
    observation = predictor(np.zeros((H, W, 3), np.uint8), 60.0)
    assert len(detector.asked) == 70
    (obj,) = observation.detections
    assert (obj.label, obj.score) == ("word 65", pytest.approx(0.7))
    assert (observation.masks[10:40, 5:35] == 0).all()
    assert (observation.masks == 0).sum() == 30 * 30
    assert (observation.surfaces[:10] == SKY).all()
    assert observation.surfaces[20, 60] == KIND_INDEX["road"]
    assert observation.surfaces[20, 20] == 0
    assert observation.depth is not None
    np.testing.assert_allclose(observation.depth, 7.5)
    assert observation.depth.shape == (H, W)


def test_nothing_found_asks_for_no_masks(monkeypatch: pytest.MonkeyPatch) -> None:
    predictor, _ = foundation(monkeypatch, words=3)
    observation = predictor(np.zeros((H, W, 3), np.uint8), 60.0)
    assert observation.detections == ()
    assert (observation.masks == -1).all()


def test_missing_packages_and_weights_are_one_sentence(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(ValidationError, match=r"found no package 'torch'.*foundation"):
        make_predictor(VideoOptions(perception="foundation"))
    asked = []

    class NoWeights:
        @staticmethod
        def from_pretrained(name: str) -> None:
            asked.append(name)
            raise OSError("offline\nand more")

    library: Any = types.SimpleNamespace(Owlv2Processor=NoWeights, Owlv2ForObjectDetection=NoWeights, __version__="4.0")
    monkeypatch.setitem(sys.modules, "torch", types.SimpleNamespace())  # type: ignore[arg-type]
    monkeypatch.setitem(sys.modules, "transformers", library)
    (tmp_path / "owlv2").mkdir()
    for models, name in ((None, loading.DETECTOR.hub), (tmp_path, str(tmp_path / "owlv2"))):
        with pytest.raises(ValidationError, match="found no weights under") as error:
            loading.load(loading.DETECTOR, models)
        assert asked[-1] == name
        assert "\n" not in str(error.value)
    with pytest.raises(ValidationError, match="needed a newer version"):
        loading.load(loading.SEGMENTER, None)
    with pytest.raises(ValidationError, match="one of eye, foundation"):
        make_predictor(VideoOptions(perception="magic"))


def chat(text: str) -> dict:
    return {"choices": [{"message": {"content": text}}]}


def test_an_endpoints_list_becomes_leaves() -> None:
    answer = chat('```json\n{"categories": ["park bench", "bench", "qqq zzz", "car"]}\n```')
    assert listing.leaves_of(answer) == ["bench", "car"]
    for text in ("no JSON", '{"things": []}', '{"categories": ["qqq zzz"]}', '{"categories": 3}'):
        with pytest.raises(VisionError):
            listing.leaves_of(chat(text))


def test_the_endpoint_is_shown_frames_from_all_of_the_tour(
    monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path
) -> None:
    for k in range(40):
        (tmp_path / f"{k:06d}.png").write_bytes(f"picture {k}".encode())
    sent = []
    monkeypatch.setattr(listing, "post", lambda endpoint, body: sent.append(body) or chat('{"categories": ["tree"]}'))
    endpoint: Any = types.SimpleNamespace(model="m", url="https://x", key="")
    assert listing.list_categories(endpoint, sorted(tmp_path.iterdir())) == ["tree"]
    (body,) = sent
    text, *shown = body["messages"][0]["content"]
    assert len(shown) == listing.FRAMES
    assert len({p["image_url"]["url"] for p in shown}) == listing.FRAMES
    assert all(leaf in text["text"] for leaf in list(ontology.categories())[:20])


def test_unblurred_frames_are_never_sent(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    monkeypatch.setenv("URBANVERSE_VISION_URL", "https://example.org/v1")
    monkeypatch.setenv("URBANVERSE_VISION_MODEL", "m")
    monkeypatch.setattr(listing, "post", lambda *_: pytest.fail("sent"))
    with pytest.raises(ValidationError, match="needed --blur"):
        make_predictor(VideoOptions(perception="foundation"), tmp_path)
