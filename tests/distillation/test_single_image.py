"""A photograph becomes a recording of one frame: upright, in metres, with what was assumed on record."""

import dataclasses
import json
import pathlib

import imageio.v3 as iio
import numpy as np
import pytest
from PIL import Image

from tests.distillation.test_perceive import CAMERA, HEIGHT, SIDEWALK, SOURCE, _frame, _pose
from urbanverse_mjx.datatypes import Recording, ValidationError
from urbanverse_mjx.distillation.perception import FrameObservation, Frames, Photograph, perceive_photograph, photograph
from urbanverse_mjx.pipeline.generation.sources import recognise

POSE = _pose(3.0, 0.5, -0.15)


@dataclasses.dataclass
class _Guess:
    """A predictor whose depth is wrong by a factor."""

    factor: float = 1.4
    focal: float = 0.0

    def __call__(self, rgb: np.ndarray, focal: float, /) -> FrameObservation:
        self.focal = focal
        _, seen, depth = _frame(POSE)
        return dataclasses.replace(seen, depth=(depth * self.factor).astype(np.float32))


def taken(folder: pathlib.Path, image: np.ndarray, focal: int | None = 26) -> Frames:
    exif = Image.Exif()
    if focal is not None:
        exif.get_ifd(0x8769)[0xA405] = focal
    folder.mkdir(exist_ok=True)
    Image.fromarray(image).save(folder / "street.jpg", exif=exif, quality=95)
    return photograph(folder / "street.jpg", folder / "frames")


@pytest.fixture
def frames(tmp_path: pathlib.Path) -> Frames:
    return taken(tmp_path, _frame(POSE)[0])


def test_the_ground_gives_vertical_and_scale(frames: Frames, tmp_path: pathlib.Path) -> None:
    known = Photograph(HEIGHT, CAMERA.fx)
    recording = perceive_photograph(frames, tmp_path / "out", _Guess(), known, SOURCE, "a street")
    (pose,) = recording.poses()
    assert pose[2, 3] == pytest.approx(HEIGHT, abs=0.02)
    assert np.degrees(np.arcsin(pose[2, 2])) == pytest.approx(np.degrees(-0.15), abs=0.5)
    assert pose[2, 0] == pytest.approx(0.0, abs=0.01)  # no roll
    depth, true = recording.depth(0), _frame(POSE)[2]
    assert depth is not None
    seen = (true > 0) & (true < 20)
    assert np.median(np.abs(depth - true)[seen] / true[seen]) < 0.03
    body = json.loads((tmp_path / "out" / "perception.json").read_text())
    assert body["photograph"]
    assert body["focal_assumed"] is False
    assert body["camera_height_assumed_m"] == HEIGHT
    assert body["depth_scale"] == pytest.approx(1 / 1.4, rel=0.02)
    assert Recording.load(tmp_path / "out").id == "a_street"


def test_an_unknown_lens_is_that_of_a_phone_and_said(tmp_path: pathlib.Path) -> None:
    frames = taken(tmp_path, _frame(POSE)[0], focal=None)
    assert frames.focal is None
    guess = _Guess()
    perceive_photograph(frames, tmp_path / "out", guess, Photograph(HEIGHT), SOURCE)
    assert guess.focal == pytest.approx(26.0 / 43.2666 * np.hypot(320, 180), rel=1e-4)
    assert json.loads((tmp_path / "out" / "perception.json").read_text())["focal_assumed"] is True


def test_a_photograph_without_ground_or_depth_is_refused(frames: Frames, tmp_path: pathlib.Path) -> None:
    class _Blind(_Guess):
        def __call__(self, rgb: np.ndarray, focal: float, /) -> FrameObservation:
            return dataclasses.replace(super().__call__(rgb, focal), depth=None)

    class _Wall(_Guess):
        def __call__(self, rgb: np.ndarray, focal: float, /) -> FrameObservation:
            seen = super().__call__(rgb, focal)
            return dataclasses.replace(seen, surfaces=np.where(seen.surfaces == SIDEWALK, 0, seen.surfaces))

    for predictor, said in ((_Blind(), "without depth"), (_Wall(), r"ground in 0\.0 % of the photograph")):
        with pytest.raises(ValidationError, match=said):
            perceive_photograph(frames, tmp_path / "out", predictor, Photograph(HEIGHT), SOURCE)


@pytest.mark.parametrize(("grey", "said"), [(9, "a dark image"), (99, "without detail")])
def test_useless_photographs_are_refused(tmp_path: pathlib.Path, grey: int, said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        taken(tmp_path, np.full((90, 160, 3), grey, np.uint8))


def test_a_photograph_is_recognised_by_its_content(tmp_path: pathlib.Path) -> None:
    taken(tmp_path, _frame(POSE)[0])
    assert recognise(tmp_path / "street.jpg").kind == "photograph"
    (tmp_path / "street.jpg").rename(tmp_path / "street.mov")
    with pytest.raises(ValidationError, match=r"call the photograph street\.jpeg"):
        recognise(tmp_path / "street.mov")


def test_a_photograph_of_a_format_without_a_known_suffix_is_to_be_converted(tmp_path: pathlib.Path) -> None:
    Image.fromarray(_frame(POSE)[0]).save(tmp_path / "street.gif")
    with pytest.raises(ValidationError, match=r"single GIF image.* convert the photograph to PNG"):
        recognise(tmp_path / "street.gif")


def test_videos_that_pillow_takes_for_an_image_are_videos(tmp_path: pathlib.Path) -> None:
    images = [Image.fromarray(np.roll(_frame(POSE)[0], 9 * k, 1)) for k in range(6)]
    images[0].save(tmp_path / "a.gif", save_all=True, append_images=images[1:], duration=100)
    with (tmp_path / "a.mjpeg").open("wb") as file:
        for image in images:
            image.save(file, "JPEG")
    stack = np.stack([np.asarray(image) for image in images])
    parameters = {"fps": 25, "codec": "mpeg2video", "output_params": ["-f", "mpeg2video"]}
    iio.imwrite(tmp_path / "stream.mp4", stack, plugin="FFMPEG", macro_block_size=2, **parameters)
    (tmp_path / "stream.mp4").rename(tmp_path / "a.m2v")
    for name in ("a.gif", "a.mjpeg", "a.m2v"):
        with Image.open(tmp_path / name) as image:
            assert image.format, "Pillow opens it"
        assert recognise(tmp_path / name).kind == "video"
