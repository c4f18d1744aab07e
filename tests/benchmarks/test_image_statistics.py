"""Statistics of images whose values are known, and the table of the image part of `benchmarks.realism`."""

import json
import pathlib

import numpy as np
import pytest
from PIL import Image

from benchmarks import realism_images
from benchmarks.lib import image_statistics as s


def noise(exponent: float, size: int, seed: int) -> np.ndarray:
    """(size, size) image with the amplitude spectrum 1/f^exponent and random phases, mean 0.5."""
    rng = np.random.default_rng(seed)
    frequency = np.hypot(*np.meshgrid(np.fft.fftfreq(size), np.fft.fftfreq(size)))
    frequency[0, 0] = 1.0
    spectrum = np.fft.fft2(rng.normal(size=(size, size))) / frequency**exponent
    spectrum[0, 0] = 0.0
    image = np.fft.ifft2(spectrum).real
    return 0.5 + 0.1 * image / image.std()


def grating(degrees: float, size: int = 360, period: float = 12.0) -> np.ndarray:
    """(size, size) sine wave whose crests run in a direction: 0 horizontal, 90 vertical."""
    y, x = np.mgrid[:size, :size]
    turn = np.radians(degrees)
    return 0.5 + 0.4 * np.sin(2 * np.pi * (x * np.sin(turn) - y * np.cos(turn)) / period)


@pytest.mark.parametrize("exponent", [0.5, 1.0, 1.5])
def test_the_slope_of_noise_is_the_exponent_it_was_made_with(exponent: float) -> None:
    """Also of a part of a larger image, whose borders do not fit together as those of the whole do."""
    slopes = [s.amplitude_slope(noise(exponent, 720, seed)[180:540, 120:600]) for seed in range(4)]
    assert np.mean(slopes) == pytest.approx(exponent, abs=0.05)


def test_the_slope_does_not_depend_on_contrast_or_brightness() -> None:
    image = noise(1.2, 360, 1)
    assert s.amplitude_slope(0.2 + 0.3 * image) == pytest.approx(s.amplitude_slope(image), abs=1e-6)


@pytest.mark.parametrize(
    ("degrees", "cardinal", "upright"), [(0, 1.0, 0.0), (90, 1.0, 1.0), (45, 0.0, None), (8, 1.0, 0.0), (15, 0.0, None)]
)
def test_edges_of_gratings_are_where_they_were_put(degrees: float, cardinal: float, upright: float | None) -> None:
    """Within 11.25 degrees of an axis counts; beyond does not."""
    found = s.edges(grating(degrees))
    assert found[0] == pytest.approx(cardinal, abs=0.02)
    if upright is not None:
        assert found[1] == pytest.approx(upright, abs=0.02)


def test_edges_of_isotropic_noise_are_a_quarter_and_a_half() -> None:
    found = [s.edges(noise(1.0, 360, seed)) for seed in range(4)]
    assert np.mean(found, 0) == pytest.approx([0.25, 0.5], abs=0.03)


def test_colours_by_hand() -> None:
    """Half pure red, half grey of 51: by the definitions of luma, saturation, and Hasler and Suesstrunk."""
    image = np.full((360, 480, 3), 51, np.uint8)
    image[:, :240] = 255, 0, 0
    found = s.statistics(image)
    assert found["brightness"] == pytest.approx((0.2126 + 0.2) / 2)
    assert found["contrast"] == pytest.approx((0.2126 - 0.2) / 2)
    assert (found["darkest"], found["brightest"]) == pytest.approx((0.2, 0.2126))
    assert (found["red_green"], found["blue_green"], found["saturated"]) == pytest.approx((0.5, 0.0, 0.5))
    # rg is 255 or 0, yb 127.5 or 0: spreads 127.5 and 63.75, means the same.
    assert found["colourfulness"] == pytest.approx(1.3 * np.hypot(127.5, 63.75))


def test_an_image_is_compared_at_one_resolution() -> None:
    """The same image in twice the resolution has the same statistics."""
    rgb = np.stack([noise(1.2, 360, k) for k in range(3)], -1)
    small = (255 * np.clip(rgb, 0, 1)).round().astype(np.uint8)
    large = np.repeat(np.repeat(small, 2, 0), 2, 1)
    assert s.statistics(large) == pytest.approx(s.statistics(small))


def _save(folder: pathlib.Path, level: float, count: int) -> None:
    folder.mkdir()
    for k in range(count):
        image = np.clip(noise(1.2, 360, k) - 0.5 + level, 0, 1)
        Image.fromarray((255 * np.repeat(image[..., None], 3, -1)).astype(np.uint8)).save(folder / f"{k}.png")


def test_a_gap_is_named_where_a_median_lies_outside(tmp_path: pathlib.Path, monkeypatch, capsys) -> None:
    monkeypatch.setattr(realism_images, "REFERENCE", tmp_path / "reference.json")
    for name, level in (("photographs", 0.5), ("same", 0.5), ("dark", 0.3)):
        _save(tmp_path / name, level, 5)
    assert realism_images.main(["--reference", str(tmp_path / "photographs"), "--named", "noise"]) == 0
    stored = json.loads((tmp_path / "reference.json").read_text())
    assert (stored["source"], stored["images"]) == ("noise", 5)
    families = [f"{name}={tmp_path / name}" for name in ("same", "dark")]
    assert realism_images.main([*families, "--out", str(tmp_path / "t.md")]) == 0
    found = json.loads((tmp_path / "t.json").read_text())
    low = stored["quantiles"]["brightness"][0]
    assert found["same"]["brightness"]["gap"] == 0.0
    assert found["dark"]["brightness"]["gap"] == pytest.approx(0.3 - low, abs=0.01)
    assert found["dark"]["brightness"]["within"] == 0.0
    assert found["dark"]["slope"]["gap"] == pytest.approx(0.0, abs=0.05)
    line = next(x for x in (tmp_path / "t.md").read_text().splitlines() if "mean of the luma" in x)
    assert "gap -0.2" in line
    assert "Cityscapes" in line
    capsys.readouterr()


@pytest.mark.parametrize("text", ["photographs", "=x", "a=/no/such/file"])
def test_a_family_that_is_no_file_is_refused(text: str, capsys) -> None:
    assert realism_images.main([text]) == 2
    assert "needed NAME=PATH" in capsys.readouterr().err


def test_a_folder_without_images_is_refused(tmp_path: pathlib.Path, capsys) -> None:
    assert realism_images.main([f"a={tmp_path}"]) == 2
    assert "found no image" in capsys.readouterr().err


def test_the_committed_reference_has_all_statistics_in_order() -> None:
    stored = json.loads(realism_images.REFERENCE.read_text())
    assert list(stored["quantiles"]) == list(s.STATISTICS)
    assert stored["images"] > 500
    for low, middle, high in stored["quantiles"].values():
        assert low <= middle <= high
    assert set(realism_images.PUBLISHED) <= set(s.STATISTICS)
