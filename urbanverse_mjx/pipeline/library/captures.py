"""Films and distils a block modelled on a city, which is a layout of UrbanVerse-160 or AutoBench.

The block's true graph is materialised, filmed along its trajectory with exact poses, depth and masks, and discarded;
only the graph distilled from the recording is kept.
"""

import dataclasses
import pathlib

import numpy as np

from ...assets.appearances.skies import build_sky
from ...assets.records.index import load_index
from ...assets.selection.label_priors import LabelPriors
from ...capture import CameraPath, FilmOptions, film_scene
from ...capture.path import camera_poses
from ...capture.street import StreetGrid, street_grid
from ...citygen.city_blocks import CityProfile, block
from ...citygen.city_blocks.block import LENGTH, VERSION
from ...datatypes import Recording, SceneBank, SceneGraph, Source
from ...distillation import distil
from ...materialisation import index_of, materialise_cousins
from ...scene.bank import pack
from ...scene.compiler import scene_geometry
from ...scene.geometry import EpisodeTable
from ..generation.distilling import DESCRIBE

#: Pixels of the images: a bollard 8 m away is still 14 pixels high.
SIZE = (320, 180)
#: s between frames; rad, amplitude of the camera's yaw to both sides, and frames of one oscillation.
PERIOD, SWAY, SWAY_FRAMES = 1.7, np.radians(38.0), 7
PITCH = np.radians(5.0)
#: m, clearance of the path to objects, and largest shift of the path for it.
_WALKER_CLEARANCE, _MAX_SHIFT = 0.3, 3.0


@dataclasses.dataclass(frozen=True)
class Capture:
    """A filmed block: its bank of one scene, the recording with ground truth, and the distilled graph."""

    bank: SceneBank
    recording: Recording
    graph: SceneGraph


def film(profile: CityProfile, seed: int, name: str, folder: pathlib.Path, length: float = LENGTH) -> Capture:
    """Makes, films and distils one block.

    Args:
      profile, seed: profile and seed of the block.
      name: id of the layout.
      folder: folder of the recording, about 30 MB.
      length: m of street.

    Raises:
      ValidationError: the profile has records that are not in the asset index, or the capture has no ground.
    """
    bank, places = compiled_block(profile, seed, name, length)
    options = FilmOptions(width=SIZE[0], height=SIZE[1], samples=2)
    count = np.arange(len(places))
    yaw = places[:, 3] + SWAY * np.sin(2 * np.pi * count / SWAY_FRAMES)
    path = CameraPath(count * PERIOD, camera_poses(places[:, :3], yaw, PITCH))
    recording = film_scene(bank, 0, folder, path, options)
    graph = distil(recording, LabelPriors(load_index()), describe=DESCRIBE).graph
    words = f"synthetic tour of a block that follows the statistics of {profile.city} (block {VERSION}, seed {seed})"
    source = Source(words, "Apache-2.0", profile.city, profile.country)
    return Capture(bank, recording, compact(dataclasses.replace(graph, id=name, source=source)))


def compiled_block(profile: CityProfile, seed: int, name: str, length: float = LENGTH) -> tuple[SceneBank, np.ndarray]:
    """Makes one block as a bank of one scene, without filming it; for the arguments see `film`.

    Returns:
      the bank, and (n, 4) x, y, z (m) and yaw (rad) of the camera along the block, moved off objects that block it.
    """
    ground_truth = block(profile, seed, name, length)
    layout = materialise_cousins(ground_truth, 1, kerb=0.0)[0].layout
    geometry = scene_geometry(layout, index_of(layout))
    geometry = dataclasses.replace(geometry, episodes=_one_episode(ground_truth))
    bank = pack([geometry], ["train"], {layout.sky: build_sky(layout.sky)})
    places = np.array(ground_truth.camera_path)
    if profile.travel == "walk":
        places[:, :2] = _cleared(places[:, :2], street_grid(bank, 0))
    return bank, places


def _one_episode(ground_truth: SceneGraph) -> EpisodeTable:
    """Episode table that a bank requires, with one dummy episode."""
    (x, y, z, _), (gx, gy, gz, _) = ground_truth.camera_path[0], ground_truth.camera_path[-1]
    goal, no = np.array([[gx, gy, gz]]), np.zeros(1, bool)
    return EpisodeTable(
        np.array([[x, y, z, 0.0]]), goal, goal[:, None], np.ones(1, np.int32), np.ones(1), no, no, np.array([-1.0])
    )


def _cleared(places: np.ndarray, street: StreetGrid) -> np.ndarray:
    """(n, 2) m, points inside objects moved to the nearest free point, if that is near."""
    free = np.argwhere(street.clearance >= _WALKER_CLEARANCE)
    points = street.middle(free)
    out = places.copy()
    for k, place in enumerate(places):
        if street.clearance[tuple(street.cell(place))] < _WALKER_CLEARANCE and len(points):
            away = np.linalg.norm(points - place, axis=1)
            if away.min() <= _MAX_SHIFT:
                out[k] = points[away.argmin()]
    return out


def compact(graph: SceneGraph) -> SceneGraph:
    """Rounds the graph to whole millimetres and milliradians and scores to hundredths, and keeps every second point of
    the trajectory."""
    objects = tuple(
        dataclasses.replace(
            o,
            center=tuple(round(x, 3) for x in o.center),
            size=tuple(max(round(x, 3), 0.001) for x in o.size),
            yaw=round(o.yaw, 3),
            score=round(o.score, 2),
        )
        for o in graph.objects
    )
    ground = tuple(
        dataclasses.replace(r, plane=(*(round(p, 6) for p in r.plane[:2]), round(r.plane[2], 4))) for r in graph.ground
    )
    path = tuple(tuple(round(x, 2) for x in place) for place in graph.camera_path[::2])
    return dataclasses.replace(graph, objects=objects, ground=ground, camera_path=path)
