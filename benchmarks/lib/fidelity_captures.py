"""Captures of the fidelity benchmark: rendered streets with ground truth, and their recordings by each row's
perception."""

import dataclasses
import pathlib
import shutil
from typing import Any

import numpy as np

from benchmarks.lib import fidelity_scores as scores
from urbanverse_mjx.assets.categories.ontology import UnknownLabelError
from urbanverse_mjx.capture import FilmOptions, PathOptions, film_scene
from urbanverse_mjx.capture.ground_truth import object_id, object_slots
from urbanverse_mjx.datatypes import AssetRecord, GraphObject, Recording, RecordingWriter, SceneBank, SceneGraph
from urbanverse_mjx.datatypes import validation as v
from urbanverse_mjx.distillation.perception import Perception, perceive
from urbanverse_mjx.distillation.perception.frames import Frames
from urbanverse_mjx.distillation.perception_model.inference import PerceptionModel
from urbanverse_mjx.materialisation import materialise_cousin, materialise_cousins
from urbanverse_mjx.settings import scene_root

#: Frames per second of the captures with images: COLMAP needs steps of less than a metre.
RGB_RATE = 2.0
#: Folder of a recording, inside the one that its maker gets.
RECORDED = "recording"


@dataclasses.dataclass(frozen=True)
class Capture:
    """A filmed street: its perfect recording, the true objects that are visible and hardly visible, and which have a
    heading.

    scene: its name.
    """

    recording: Recording
    seen: list[GraphObject]
    unseen: list[GraphObject]
    turnable: dict[str, bool]
    scene: str


def film(bank: SceneBank, scene: int, folder: pathlib.Path, frames: int, size: tuple[int, int], rgb: bool) -> Capture:
    """One capture, with images or black; a folder that holds it already is read."""
    name = bank.scene_ids[scene]
    folder = folder / (f"{name}_rgb" if rgb else name)
    if (folder / "recording.json").is_file() and len(Recording.load(folder)) == frames:
        recording = Recording.load(folder)
    else:
        options = FilmOptions(width=size[0], height=size[1], rgb=rgb)
        # With images the camera turns over several seconds, as in `urbanverse capture`; the angle of a turn between two
        # frames could not be estimated.
        path = PathOptions(frames=frames, rate=RGB_RATE) if rgb else PathOptions(frames=frames, turn_time=0.0)
        recording = film_scene(bank, scene, folder, path, options)
    ground_truth = SceneGraph.load(folder / "truth.json").objects
    turnable = {}
    for slot in object_slots(bank, scene):
        mesh = bank.slot_mesh[scene, slot]
        corners = bank.mesh_vertices[bank.mesh_vertex_start[mesh] : bank.mesh_vertex_start[mesh + 1], :2]
        turnable[object_id(bank, scene, slot)] = scores.is_turnable(corners)
    return with_ground_truth(recording, ground_truth, turnable, name)


def imported(folder: pathlib.Path) -> Capture:
    """A recording that `urbanverse gen import` made of KITTI-360, with its boxes as ground truth.

    Raises:
      ValidationError: no such recording, or no boxes beside it.
    """
    recording = Recording.load(folder)
    rows = v.items(v.read_json(folder / "boxes.json", "boxes of a recording"), "boxes")
    ground_truth = [GraphObject.from_json(row, f"boxes[{i}]") for i, row in enumerate(rows)]
    turnable = {t.id: max(t.size[:2]) > 1.15 * min(t.size[:2]) for t in ground_truth}
    return with_ground_truth(recording, ground_truth, turnable, recording.id)


def with_ground_truth(recording: Recording, ground_truth: Any, turnable: dict[str, bool], scene: str) -> Capture:
    """A perfect recording with its true objects, divided into those that are visible and hardly visible."""
    seen = scores.seen_objects(recording, ground_truth)
    ids = {t.id for t in seen}
    return Capture(recording, seen, [t for t in ground_truth if t.id not in ids], turnable, scene)


def from_images(filmed: Capture, folder: pathlib.Path, camera_height: float = PathOptions.height) -> Recording:
    """Returns a recording from the images alone: COLMAP's poses and the perception model's objects, surfaces and
    depth. camera_height: m above the ground, which who films knows."""
    (folder / "frames").mkdir(parents=True)
    names = []
    for k, frame in enumerate(filmed.recording.frames):
        names.append(f"{k:06d}.png")
        shutil.copyfile(filmed.recording.folder / frame.rgb, folder / "frames" / names[-1])
    camera = filmed.recording.camera
    times = tuple(f.time_s for f in filmed.recording.frames)
    frames = Frames(folder / "frames", tuple(names), times, camera.width, camera.height)
    source = filmed.recording.source
    perception = Perception(PerceptionModel.load(), camera_height=camera_height)
    return perceive(frames, folder / RECORDED, perception, source, filmed.recording.id)


def seen_by_the_model(filmed: Capture, folder: pathlib.Path) -> Recording:
    """Returns a recording with true poses and depth, and objects and surfaces of the perception model."""
    model, given = PerceptionModel.load(), filmed.recording
    writer = RecordingWriter(
        folder / RECORDED, given.id, given.source, given.camera, given.depth_unit_m, lossless=False
    )
    for k, frame in enumerate(given.frames):
        rgb = given.rgb(k)
        observation = model(rgb, given.camera.fx)
        writer.add(
            frame.time_s,
            rgb,
            given.depth(k),
            observation.masks,
            observation.surfaces,
            frame.pose,
            observation.detections,
        )
    return writer.close()


def retrieved(filmed: Capture, graph: SceneGraph, pairs: list[tuple[str, str]]) -> np.ndarray | None:
    """Returns (n,) bool over matches with known true asset, whether the first cousin uses the same base shape.

    The paper's Ast is the share of correctly retrieved objects as judged by people. Here an object counts if the asset
    chosen among the catalogue's 102,444 has the true base shape, with any size and tint. Returns None except for the
    shipped streets, whose assets are known.
    """
    path = scene_root() / filmed.scene / "graph.json"
    if not path.is_file():
        return None
    true = {name: candidate.record for name, candidate in materialise_cousin(SceneGraph.load(path)).chosen.items()}
    try:
        (cousin,) = materialise_cousins(graph, 1, 0)
    except UnknownLabelError:
        return None
    rows = [
        _shape(cousin.chosen[found].record) == _shape(true[name])
        for found, name in pairs
        if found in cousin.chosen and name in true
    ]
    return np.array(rows, bool)


def _shape(record: AssetRecord) -> tuple[str, str, int]:
    return record.recipe, record.leaf, int(record.params["variant"])
