"""The bonnet of the camera's own car is found in its frames, and is neither ground nor an object."""

import json
import pathlib

import numpy as np
import pytest
from PIL import Image
from scipy import ndimage

from tests.distillation.test_perceive import HEIGHT, POSES, SOURCE, _frame, _Oracle
from urbanverse_mjx.distillation.perception import Frames, Perception, StructureOptions, perceive, reconstruct, sample
from urbanverse_mjx.distillation.perception.own_vehicle import own_vehicle
from urbanverse_mjx.distillation.perception.trajectory import trajectory_error

ROWS, COLUMNS = np.mgrid[:180, :320]
BONNET = ((COLUMNS - 160) / 190) ** 2 + ((ROWS - 200) / 60) ** 2 < 1.0


def with_bonnet(image: np.ndarray, reflection: int = 0) -> np.ndarray:
    """A shining bonnet: brighter towards its edge, with a spot of light that moves."""
    shade = 60 + 0.5 * (ROWS - 140)
    spot = 40 * np.exp(-(((COLUMNS - 40 - 25 * reflection) / 14) ** 2 + ((ROWS - 165) / 8) ** 2))
    return np.where(BONNET[..., None], (shade + spot)[..., None], image).astype(np.uint8)


def film(folder: pathlib.Path, images: list[np.ndarray]) -> Frames:
    folder.mkdir()
    for k, image in enumerate(images):
        Image.fromarray(image).save(folder / f"{k:03d}.png")
    return sample(folder, folder / "frames")


@pytest.fixture(scope="module")
def driven(tmp_path_factory: pytest.TempPathFactory) -> Frames:
    images = [with_bonnet(_frame(pose)[0], k) for k, pose in enumerate(POSES)]
    return film(tmp_path_factory.mktemp("driven") / "in", images)


def test_a_bonnet_is_found_to_its_edge(driven: Frames) -> None:
    found = own_vehicle(driven)
    assert found is not None
    assert (found & BONNET).sum() / (found | BONNET).sum() > 0.85
    assert (found & BONNET).sum() / BONNET.sum() > 0.97


def test_walks_smooth_roads_and_still_films_have_none(tmp_path: pathlib.Path) -> None:
    walk = [_frame(pose)[0] for pose in POSES]
    assert own_vehicle(film(tmp_path / "walk", walk)) is None
    rng = np.random.default_rng(0)
    road = []
    for image in walk:
        weight = ndimage.gaussian_filter((ROWS > 120).astype(float), 8)[..., None]
        smooth = 110 + rng.normal(0, 2, (180, 320, 1))
        road.append((weight * smooth + (1 - weight) * image).clip(0, 255).astype(np.uint8))
    assert own_vehicle(film(tmp_path / "road", road)) is None
    still = [np.clip(with_bonnet(walk[0]) + rng.normal(0, 3, (180, 320, 3)), 0, 255).astype(np.uint8) for _ in range(9)]
    frames = Frames(tmp_path, tuple(f"{k}.png" for k in range(9)), tuple(map(float, range(9))), 320, 180)
    for k, image in enumerate(still):
        Image.fromarray(image).save(tmp_path / f"{k}.png")
    assert own_vehicle(frames) is None


@pytest.mark.extended
def test_a_recording_has_neither_ground_nor_objects_nor_depth_on_it(driven: Frames, tmp_path: pathlib.Path) -> None:
    structure = reconstruct(driven, StructureOptions(features=1500), body=own_vehicle(driven))
    column, row = np.clip(structure.pixel.T.astype(int), 0, [[319], [179]])
    assert BONNET[row, column].mean() < 0.01, "no feature of the bonnet takes part"
    perception = Perception(_Oracle(1.3), lambda frames, progress: structure, HEIGHT)
    recording = perceive(driven, tmp_path, perception, SOURCE)
    assert trajectory_error(recording.poses(), POSES[structure.registered]).rmse < 0.15
    share = json.loads((tmp_path / "perception.json").read_text())["own_vehicle_percent"]
    assert share == pytest.approx(100 * BONNET.mean(), abs=3)
    for number in recording.registered[::3]:
        depth, masks, surfaces = (read(int(number)) for read in (recording.depth, recording.masks, recording.surfaces))
        assert depth is not None
        assert masks is not None
        assert surfaces is not None
        inside = ndimage.binary_erosion(BONNET, iterations=3)
        assert (surfaces[inside] == 0).mean() > 0.98
        assert (masks[inside] == -1).mean() > 0.98
        assert (depth[inside] == 0).mean() > 0.98
        assert (depth[:100] > 0).mean() > 0.5
