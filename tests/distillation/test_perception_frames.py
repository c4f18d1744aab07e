"""Frames of videos and folders: sampling, sizes, the screening, and errors for broken input."""

import itertools
import pathlib
import re
import struct
from typing import Any

import imageio.v3 as iio
import numpy as np
import pytest
from PIL import Image
from scipy import ndimage

from urbanverse_mjx.datatypes import ValidationError
from urbanverse_mjx.distillation.perception import Blur, SamplingOptions, blur_by_name, sample
from urbanverse_mjx.distillation.perception.frames import load
from urbanverse_mjx.distillation.perception.screening import ScreenLimits, measure, screen, turned


def _wall(height: int = 108, width: int = 192) -> np.ndarray:
    """(H, 4 W, 3) u8 of smooth random texture to look along."""
    rng = np.random.default_rng(0)
    layers = [ndimage.zoom(rng.random((height // s, 4 * width // s, 3)), (s, s, 1), order=1) for s in (2, 4, 12)]
    texture = np.sum(layers, axis=0)
    return (255 * texture / texture.max()).astype(np.uint8)


def _pan(count: int, step: int) -> list[np.ndarray]:
    """Images that slide along the wall by `step` pixels each."""
    wall = _wall()
    return [wall[:, k * step : k * step + 192] for k in range(count)]


def _folder(path: pathlib.Path, images: list[np.ndarray]) -> pathlib.Path:
    path.mkdir()
    for k, image in enumerate(images):
        Image.fromarray(image).save(path / f"p{k:03d}.png")
    return path


def _video(path: pathlib.Path, images: list[np.ndarray], fps: float) -> pathlib.Path:
    iio.imwrite(path, np.stack(images), plugin="FFMPEG", fps=fps, quality=9, macro_block_size=2)
    return path


@pytest.mark.parametrize("ending", ["mp4", "mkv", "avi"])
def test_a_video_is_sampled_at_the_rate_asked_for(tmp_path: pathlib.Path, ending: str):
    video = _video(tmp_path / f"walk.{ending}", _pan(24, 8), 8.0)
    frames = sample(video, tmp_path / "frames", SamplingOptions(rate=2.0))
    assert len(frames) == 6
    assert np.diff(frames.time_s) == pytest.approx([0.5] * 5, abs=0.26)
    assert 0.0 <= frames.time_s[0] < frames.time_s[-1] < 3.0
    assert (frames.width, frames.height) == (192, 108)
    assert load(tmp_path / "frames") == frames


def test_of_neighbours_the_sharpest_is_taken(tmp_path: pathlib.Path):
    images = _pan(12, 6)
    blurred = [p if k % 3 == 1 else ndimage.gaussian_filter(p, (3, 3, 0)) for k, p in enumerate(images)]
    frames = sample(_video(tmp_path / "v.mp4", blurred, 6.0), tmp_path / "f", SamplingOptions(rate=2.0))
    assert len(frames) == 4
    assert np.allclose(frames.time_s, [(3 * k + 1) / 6 for k in range(4)], atol=1e-3)


def test_large_images_are_scaled_down_and_small_ones_left(tmp_path: pathlib.Path):
    folder = _folder(tmp_path / "in", _pan(3, 20))
    assert sample(folder, tmp_path / "a", SamplingOptions(short_side=64)).height == 64
    assert sample(folder, tmp_path / "b", SamplingOptions(short_side=540)).height == 108


def test_the_screen_says_what_it_dropped_and_why(tmp_path: pathlib.Path):
    images = _pan(16, 16)
    images[3] = images[3] // 20
    images[6] = ndimage.gaussian_filter(images[6], (4, 4, 0))
    images[9] = images[8]
    frames = sample(_folder(tmp_path / "in", images), tmp_path / "f", SamplingOptions(rate=1.0))
    assert dict(frames.dropped) == {3.0: "dark", 6.0: "blurred", 9.0: "static"}
    assert frames.lost() == "1 dark, 1 blurred, 1 static"
    assert sorted(p.name for p in (tmp_path / "f").glob("*.png")) == list(frames.names)


def test_earlier_frames_are_replaced_and_other_images_are_not(tmp_path: pathlib.Path):
    source, folder = _folder(tmp_path / "in", _pan(3, 20)), tmp_path / "f"
    folder.mkdir()
    (folder / "000007.png").write_text("mine")
    with pytest.raises(ValidationError, match=r"000007\.png: found an image that is no frame"):
        sample(source, folder)
    assert [p.name for p in folder.iterdir()] == ["000007.png"]
    (folder / "000007.png").rename(folder / "holiday.png")
    sample(source, folder)
    (folder / "frames.json").rename(folder / ".unfinished-frames")  # as a killed process leaves it
    (folder / "000009.png").touch()
    frames = sample(source, folder)
    assert sorted(p.name for p in folder.iterdir()) == [*frames.names, "frames.json", "holiday.png"]


def test_a_sideways_turn_is_measured_and_a_fast_one_dropped():
    images = [measure(p) for p in _pan(4, 60)]
    turns = [0.0, *(turned(a, b) for a, b in itertools.pairwise(images))]
    assert turns[1:] == pytest.approx([60 / 192] * 3, abs=0.02)
    limits = ScreenLimits(turn=0.25)
    assert screen(images, turns, limits) == [None, "too fast", "too fast", "too fast"]
    rng = np.random.default_rng(1)
    noise = [measure(rng.integers(0, 255, (108, 192, 3), dtype=np.uint8)) for _ in range(2)]
    assert turned(*noise) == 0.0


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda p: p / "nothing.mp4", "no such file"),
        (lambda p: _text(p / "text.mp4"), "OpenCV reads no image"),
        (lambda p: _folder(p / "empty", []), "no image"),
        (lambda p: _folder(p / "one", _pan(1, 1)), "1 usable frames of 1"),
        (lambda p: _folder(p / "black", [np.zeros((60, 80, 3), np.uint8)] * 3), "0 usable frames of 3 .3 dark"),
        (lambda p: _folder(p / "sizes", [_wall()[:60], _wall()[:80]]), "768x80 pixels"),
    ],
)
def test_broken_input_is_one_sentence(tmp_path: pathlib.Path, make, said: str):
    with pytest.raises(ValidationError, match=said):
        sample(make(tmp_path), tmp_path / "frames")


def _photo(path: pathlib.Path, image: np.ndarray, focal: Any, orientation: int = 1) -> None:
    exif = Image.Exif()
    exif[0x0112] = orientation
    if focal is not None:
        exif.get_ifd(0x8769)[0xA405] = focal
    Image.fromarray(image).save(path, exif=exif, quality=95)


def test_the_focal_length_comes_from_the_exif_data_of_all_images(tmp_path: pathlib.Path):
    for name, focals in (
        ("same", (26, 26, 26)),
        ("zoomed", (26, 26, 52)),
        ("unknown", (26, None, 26)),
        ("zero", (0, 0, 0)),
        ("true length instead", (4, 4, 4)),
        ("no number", (26, "26 mm", 26)),
        ("two numbers", ((26, 26), 26, 26)),
    ):
        (tmp_path / name).mkdir()
        for k, focal in enumerate(focals):
            _photo(tmp_path / name / f"{k}.jpg", _pan(3, 20)[k], focal)
    frames = sample(tmp_path / "same", tmp_path / "a", SamplingOptions(short_side=64))
    assert (frames.width, frames.height) == (114, 64)
    # 26 mm on a diagonal of 43.27 mm, of 130.7 pixels.
    assert frames.focal == pytest.approx(26.0 / 43.2666 * np.hypot(114, 64), abs=0.01)
    assert load(tmp_path / "a").focal == frames.focal
    for name in ("zoomed", "unknown", "zero", "true length instead", "no number", "two numbers"):
        assert sample(tmp_path / name, tmp_path / f"{name}_frames").focal is None


def test_images_are_turned_upright(tmp_path: pathlib.Path):
    (tmp_path / "in").mkdir()
    for k, image in enumerate(_pan(3, 20)):
        _photo(tmp_path / "in" / f"{k}.jpg", np.rot90(image), 26, orientation=6)  # to be turned clockwise by 90 degrees
    frames = sample(tmp_path / "in", tmp_path / "out")
    assert (frames.width, frames.height) == (192, 108)
    assert np.abs(frames.rgb(0).astype(int) - _pan(1, 0)[0]).mean() < 10


def _film(path: pathlib.Path, seconds: int, *options: str) -> pathlib.Path:
    """A video whose index stands before its images, ten a second."""
    images = [p for k in range(seconds) for p in _pan(10, 4 + k)]
    parameters = ["-movflags", "faststart", *options] if path.suffix == ".mp4" else list(options)
    iio.imwrite(path, np.stack(images), fps=10, plugin="FFMPEG", macro_block_size=2, output_params=parameters)
    return path


@pytest.mark.parametrize("suffix", [".mp4", ".mkv"])
def test_a_film_that_ends_early_is_refused_with_the_seconds_that_are_missing(tmp_path: pathlib.Path, suffix: str):
    whole = _film(tmp_path / f"whole{suffix}", 8)
    assert sample(whole, tmp_path / "all").time_s[-1] > 7.0
    cut = tmp_path / f"cut{suffix}"
    cut.write_bytes(whole.read_bytes()[: int(0.6 * whole.stat().st_size)])
    with pytest.raises(ValidationError) as caught:
        sample(cut, tmp_path / "frames")
    found, stated = re.findall(r"found (\d\.\d) of the (\d\.\d) s", str(caught.value))[0]
    assert float(stated) == pytest.approx(8.0, abs=0.2)
    assert 3.0 < float(found) < 7.0
    assert f"the missing {float(stated) - float(found):.1f} s by --allow-truncated" in str(caught.value)
    kept = sample(cut, tmp_path / "frames", SamplingOptions(allow_truncated=True))
    assert kept.time_s[-1] == pytest.approx(float(found), abs=0.7)


@pytest.mark.extended
def test_a_film_of_uneven_rate_or_beyond_the_frame_limit_is_not_called_cut_off(tmp_path: pathlib.Path):
    """Half of the images are dropped in the second half, as phones do in the dark."""
    uneven = _film(tmp_path / "uneven.mp4", 8, "-vf", "select='lt(t,4)+not(mod(n,3))'", "-fps_mode", "vfr")
    assert sample(uneven, tmp_path / "a").time_s[-1] > 7.0
    many = sample(_film(tmp_path / "many.mp4", 8), tmp_path / "b", SamplingOptions(max_frames=12))
    assert len(many) <= 12


def test_an_mp4_without_its_index_is_said_to_be_cut_off(tmp_path: pathlib.Path):
    whole = tmp_path / "whole.mp4"
    iio.imwrite(whole, np.stack(_pan(20, 6)), fps=10, plugin="FFMPEG", macro_block_size=2)
    (tmp_path / "cut.mp4").write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
    with pytest.raises(ValidationError, match="an MP4 without its index"):
        sample(tmp_path / "cut.mp4", tmp_path / "frames")


@pytest.mark.parametrize("length", [2**64 - 9, 2**63 - 20])
def test_an_mp4_whose_first_box_has_no_possible_length_is_one_sentence(tmp_path: pathlib.Path, length: int):
    (tmp_path / "a.mp4").write_bytes(struct.pack(">I4sQ", 1, b"ftyp", length) + bytes(50))
    with pytest.raises(ValidationError, match="needed"):
        sample(tmp_path / "a.mp4", tmp_path / "frames")


def _text(path: pathlib.Path) -> pathlib.Path:
    path.write_text("not a video")
    return path


class _FindsOne:
    def __call__(self, rgb: np.ndarray) -> np.ndarray:
        return np.array([[40.0, 30.0, 60.0, 50.0]])


def test_faces_are_unreadable_in_what_is_stored(tmp_path: pathlib.Path):
    images = _pan(3, 20)
    blur = blur_by_name(f"{__name__}:_FindsOne")
    frames = sample(_folder(tmp_path / "in", images), tmp_path / "f", blur=blur)
    assert frames.blur == f"{__name__}:_FindsOne"
    stored = frames.rgb(0)
    box = np.s_[27:53, 37:63]
    assert len(np.unique(stored[box].reshape(-1, 3), axis=0)) <= 16
    outside = np.ones(stored.shape[:2], bool)
    outside[box] = False
    assert (stored[outside] == images[0][outside]).all()


def test_a_detector_that_is_missing_or_wrong_is_named():
    with pytest.raises(ValidationError, match="needed 'module:function'"):
        blur_by_name("no_such_package:detector")
    with pytest.raises(ValidationError, match=r"needed finite \(k, 4\)"):
        Blur(lambda rgb: np.zeros((2, 3)), "odd")(np.zeros((8, 8, 3), np.uint8))
