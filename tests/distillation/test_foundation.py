"""Foundation models behind `Predictor`. Real weights are not at hand: models of the real architectures with a few
random numbers are run where torch and transformers are installed."""

import base64
import io
import pathlib
import sys
import types
from typing import Any

import numpy as np
import pytest
from PIL import Image

from tests.support import small_models
from urbanverse_mjx.assets.categories import ontology
from urbanverse_mjx.assets.importing.vision import VisionError
from urbanverse_mjx.datatypes import KIND_INDEX, Camera, RecordingWriter, Source, ValidationError
from urbanverse_mjx.datatypes.recording import SKY
from urbanverse_mjx.distillation.perception.foundation import boxes, detectors, grounds, loading
from urbanverse_mjx.pipeline.generation import listing
from urbanverse_mjx.pipeline.generation.predictors import make_predictor
from urbanverse_mjx.pipeline.generation.video_options import VideoOptions
from urbanverse_mjx.settings import VisionEndpoint

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


# Models of the real architectures, with a few random numbers ----------------------------------------------------------

LABELS = [*list(ontology.categories())[:66], "car", "tree", "bench", "house"]
RGB = np.random.default_rng(0).integers(0, 256, (60, 90, 3)).astype(np.uint8)


@pytest.fixture(scope="module")
def models(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    return small_models.write(tmp_path_factory.mktemp("models"), "owlv2", "sam2", "sam3", "mask2former", "depth")


@pytest.fixture
def every_score(monkeypatch: pytest.MonkeyPatch) -> None:
    """Random models are sure of nothing."""
    monkeypatch.setattr(detectors, "OWLV2_SCORE", 0.0)
    monkeypatch.setattr(detectors, "SAM3_SCORE", 0.0)


def calls_of(module: Any) -> list[int]:
    """A list that grows with every call of a part of a model."""
    calls: list[int] = []
    module.register_forward_hook(lambda *_: calls.append(1))
    return calls


@small_models.needed
def test_owlv2_gives_what_its_own_forward_pass_gives(models: pathlib.Path) -> None:
    """The encoders are called one by one here, words 64 at a time; the whole model gives the same to the same words."""
    import torch  # pyright: ignore[reportMissingImports]

    found = detectors.Owlv2Detector.load(LABELS, models)
    image = Image.fromarray(RGB)
    texts = [[f"a photo of a {label}" for label in LABELS]]
    inputs = found.owlv2.processor(text=texts, images=image, return_tensors="pt")
    with torch.inference_mode():
        answer = found.owlv2.model(**inputs)
    scores, corners = found.outputs(image)
    assert scores.shape == (16, len(LABELS))
    assert np.ptp(scores, axis=1).max() > 0.5  # words differ
    np.testing.assert_allclose(scores, answer.logits[0].numpy(), rtol=1e-3, atol=1e-3)
    np.testing.assert_allclose(corners, answer.pred_boxes[0].numpy(), atol=1e-5)


@small_models.needed
@pytest.mark.usefixtures("every_score")
def test_each_image_is_encoded_once_for_all_labels(models: pathlib.Path) -> None:
    owl = detectors.Owlv2Detector.load(LABELS, models)
    sam = detectors.Sam3Detector.load(LABELS[:5], models)
    parts = [owl.owlv2.model.owlv2, owl.sam2.model, sam.sam3.model]
    images = [calls_of(p) for p in (parts[0].vision_model, parts[1].vision_encoder, parts[2].vision_encoder)]
    texts = [calls_of(p) for p in (parts[0].text_model, parts[2].text_encoder)]
    for detector in (owl, sam):
        detector(Image.fromarray(RGB))
        detector(Image.fromarray(RGB[::-1].copy()))
    assert [len(c) for c in images] == [2, 2, 2]
    assert [len(c) for c in texts] == [0, 0]


@small_models.needed
@pytest.mark.usefixtures("every_score")
def test_sam3_finds_what_its_own_forward_pass_finds(models: pathlib.Path) -> None:
    import torch  # pyright: ignore[reportMissingImports]

    found = detectors.Sam3Detector.load(["car"], models)
    image = Image.fromarray(RGB)
    inputs = found.sam3.processor(images=image, text="car", return_tensors="pt")
    with torch.inference_mode():
        answer = found.sam3.model(**inputs)
    (theirs,) = found.sam3.processor.post_process_instance_segmentation(answer, threshold=0.0, target_sizes=[(60, 90)])
    ours = found(image)
    assert len(ours.boxes.box) >= 1
    assert ours.masks.shape == (len(ours.boxes.box), 60, 90)
    all_masks = np.asarray(theirs["masks"]).astype(bool)
    for box, score, mask in zip(ours.boxes.box, ours.boxes.score, ours.masks, strict=True):
        row = int(np.abs(theirs["boxes"].numpy() - box).sum(1).argmin())
        np.testing.assert_allclose(theirs["boxes"][row].numpy(), box, atol=1e-3)
        assert score == pytest.approx(float(theirs["scores"][row]), abs=1e-5)
        assert (mask == all_masks[row]).all()


@small_models.needed
@pytest.mark.usefixtures("every_score")
@pytest.mark.parametrize("detector", ["owlv2", "sam3"])
def test_all_models_make_an_observation_that_a_recording_holds(
    models: pathlib.Path, tmp_path: pathlib.Path, detector: str
) -> None:
    """Detector, segmenter, ground and depth, loaded as by `--models`, from an image to a recording and back."""
    options = VideoOptions(perception="foundation", models=str(models), detector=detector)
    observation = make_predictor(options)(RGB, 60.0)
    assert observation.masks.shape == observation.surfaces.shape == (60, 90)
    assert observation.masks.max() == len(observation.detections) - 1
    assert {d.label for d in observation.detections} <= set(ontology.categories())
    known = {0, SKY, *(KIND_INDEX[k] for k in ("road", "sidewalk", "ground"))}
    assert set(np.unique(observation.surfaces).tolist()) <= known
    assert (observation.surfaces[observation.masks >= 0] == 0).all()
    assert observation.depth is not None
    assert observation.depth.dtype == np.float32
    assert 0.0 < observation.depth.min() <= observation.depth.max() < small_models.MAX_DEPTH
    writer = RecordingWriter(tmp_path, "seen", Source("v", "l", "c", "c"), Camera.from_fov(90, 60, 1.0))
    parts = (observation.depth, observation.masks, observation.surfaces, np.eye(4), observation.detections)
    writer.add(0.0, RGB, *parts)
    assert (writer.close().masks(0) == observation.masks).all()


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
    for models, name in ((None, loading.OWLV2.hub), (tmp_path, str(tmp_path / "owlv2"))):
        with pytest.raises(ValidationError, match="found no weights under") as error:
            loading.load(loading.OWLV2, models)
        assert asked[-1] == name
        assert "\n" not in str(error.value)
    with pytest.raises(ValidationError, match="needed a newer version"):
        loading.load(loading.SAM2, None)
    with pytest.raises(ValidationError, match="one of eye, foundation"):
        make_predictor(VideoOptions(perception="magic"))


def chat(text: str) -> dict:
    return {"choices": [{"message": {"content": text}}]}


def test_an_endpoints_list_becomes_leaves() -> None:
    answer = chat('```json\n{"categories": ["park bench", "bench", "qqq zzz", "car"]}\n```')
    assert listing.leaves_of(answer) == ["bench", "car"]
    assert listing.leaves_of(chat('{"categories": ["qqq zzz"]}')) == []
    for text in ("no JSON", '{"objects": []}', '{"categories": 3}'):
        with pytest.raises(VisionError):
            listing.leaves_of(chat(text))


ENDPOINT = VisionEndpoint("https://x", "m")


@pytest.fixture
def asked(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> tuple[list[pathlib.Path], list[Any]]:
    """40 frames, and the requests that an endpoint gets, whose answers name a tree and, once, a car."""
    monkeypatch.setenv("URBANVERSE_CACHE", str(tmp_path / "cache"))
    (tmp_path / "frames").mkdir()
    for k in range(40):
        Image.fromarray(np.full((90, 1000, 3), 5 * k, np.uint8)).save(tmp_path / "frames" / f"{k:06d}.png")
    sent: list[Any] = []

    def answer(endpoint: VisionEndpoint, body: Any) -> Any:
        sent.append(body)
        return chat('{"categories": ["car", "tree"]}' if len(sent) == 2 else '{"categories": ["tree"]}')

    monkeypatch.setattr(listing, "post", answer)
    return sorted((tmp_path / "frames").iterdir()), sent


def levels(bodies: list[Any]) -> list[int]:
    """The grey level of each image that was sent, and the size that they have."""
    found = []
    for body in bodies:
        for part in body["messages"][0]["content"][1:]:
            raw = base64.b64decode(part["image_url"]["url"].partition(",")[2])
            with Image.open(io.BytesIO(raw)) as image:
                assert image.size == (listing.SIDE, round(90 * listing.SIDE / 1000))
                found.append(round(float(np.asarray(image).mean()) / 5))
    return found


def test_the_endpoint_sees_every_third_frame_once(asked: tuple[list[pathlib.Path], list[Any]]) -> None:
    images, sent = asked
    said: list[str] = []
    assert listing.list_categories(ENDPOINT, images, said.append) == ["tree", "car"]
    assert levels(sent) == list(range(1, 40, 3))
    assert len(sent) == 2
    assert "m at https://x: 2 requests with 13 images" in said[0]
    text = sent[0]["messages"][0]["content"][0]["text"]
    assert all(leaf in text for leaf in list(ontology.categories())[:20])


def test_the_cost_is_said_before_anything_is_sent(asked: tuple[list[pathlib.Path], list[Any]]) -> None:
    images, sent = asked

    def stop(sentence: str) -> None:
        raise KeyboardInterrupt(sentence)

    with pytest.raises(KeyboardInterrupt, match=r"2 requests with 13 images, .* MB, about [0-9,]+ tokens"):
        listing.list_categories(ENDPOINT, images, stop)
    assert sent == []


def test_answers_are_kept(asked: tuple[list[pathlib.Path], list[Any]], tmp_path: pathlib.Path) -> None:
    images, sent = asked
    said: list[str] = []
    first = listing.list_categories(ENDPOINT, images, said.append)
    assert listing.list_categories(ENDPOINT, images, said.append) == first
    assert len(sent) == 2
    assert said[1] == "m: nothing to send; 2 answers are in the cache."
    (one, _) = sorted((tmp_path / "cache" / "vision").iterdir())
    one.write_text("{")  # cut off
    listing.list_categories(ENDPOINT, images, said.append)
    assert len(sent) == 3
    listing.list_categories(VisionEndpoint("https://x", "other"), images[:3], said.append)
    assert len(sent) == 4


def test_unblurred_frames_are_never_sent(monkeypatch: pytest.MonkeyPatch, tmp_path: pathlib.Path) -> None:
    monkeypatch.setenv("URBANVERSE_VISION_URL", "https://example.org/v1")
    monkeypatch.setenv("URBANVERSE_VISION_MODEL", "m")
    monkeypatch.setattr(listing, "post", lambda *_: pytest.fail("sent"))
    with pytest.raises(ValidationError, match="needed --blur"):
        make_predictor(VideoOptions(perception="foundation"), tmp_path)
