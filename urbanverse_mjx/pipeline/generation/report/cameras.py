"""Frames that a report shows, and the cameras from which cousins are filmed: those of the frames, in the graph's
coordinates."""

import dataclasses

import numpy as np

from ....datatypes import Camera, Recording, SceneGraph
from ....geometry import rotations

#: Most frames of a page, evenly spaced over the recording.
MAX_FRAMES = 120
#: Pixels, largest width of a film.
WIDTH = 640
#: Of a graph without a recording: rad, vertical field of view; downward slope of the view; s between two places.
FOV, LOOK_DOWN, PERIOD = np.radians(55.0), 0.05, 0.5


@dataclasses.dataclass(frozen=True)
class Shot:
    """One moment.

    Attributes:
      number: of the frame in the recording; of the place in the graph's trajectory where there is no recording.
      time_s: s.
      pose: (4, 4) T_world_camera (OpenCV's axes) in the graph's coordinates; None for frames without one.
    """

    number: int
    time_s: float
    pose: np.ndarray | None


@dataclasses.dataclass(frozen=True)
class Shots:
    """All moments of a page.

    Attributes:
      shots: in the order of time.
      camera: the frames' camera, scaled to the films' pixels, which are even on both sides.
      missing: sentence that says why no moment has a pose; "" where some have one.
    """

    shots: tuple[Shot, ...]
    camera: Camera
    missing: str


def shots_of(graph: SceneGraph, recording: Recording | None) -> Shots:
    """The moments of a recording, or of a graph's trajectory where there is no recording."""
    return _of_graph(graph) if recording is None else _of_recording(graph, recording)


def _of_recording(graph: SceneGraph, recording: Recording) -> Shots:
    count, path = len(recording), np.array(graph.camera_path).reshape(-1, 4)
    registered = recording.registered
    missing = ""
    if len(registered) == 0:
        missing = "No frame has a pose, so no cousin is shown from the frames' places."
    elif len(path) != len(registered):
        missing = (
            f"The graph's trajectory has {len(path)} places and the recording {len(registered)} frames with a pose, so "
            "the cousins cannot be shown from the frames' places."
        )
    row_of = {} if missing else {int(number): row for row, number in enumerate(registered)}
    shots = []
    for number in _spaced(count):
        frame, row = recording.frames[number], row_of.get(number)
        pose = None if row is None or frame.pose is None else _moved(frame.pose, path[row])
        shots.append(Shot(number, frame.time_s, pose))
    return Shots(tuple(shots), _scaled(recording.camera), missing)


def _spaced(count: int) -> list[int]:
    """At most `MAX_FRAMES` of so many numbers, evenly spaced, with the first and the last."""
    return np.unique(np.linspace(0, count - 1, min(MAX_FRAMES, count)).round().astype(int)).tolist()


def _moved(pose: np.ndarray, place: np.ndarray) -> np.ndarray:
    """A pose at a place (x, y, z, yaw) of the graph's trajectory; distillation corrects poses, and the trajectory holds
    their places and headings, not their pitch and roll."""
    ahead = pose[:3, 2]
    turned = np.eye(4)
    turned[:3, :3] = rotations.about_z(place[3] - np.arctan2(ahead[1], ahead[0])) @ pose[:3, :3]
    turned[:3, 3] = place[:3]
    return turned


def _of_graph(graph: SceneGraph) -> Shots:
    camera = Camera.from_fov(WIDTH, WIDTH * 9 // 16, FOV)
    path = np.array(graph.camera_path).reshape(-1, 4)
    missing = "" if len(path) else "The graph has no trajectory, so there is no place to show the cousins from."
    chosen = (
        np.unique(np.linspace(0, len(path) - 1, min(MAX_FRAMES, len(path))).round().astype(int)) if len(path) else ()
    )
    shots = []
    for k, row in enumerate(np.asarray(chosen, int).tolist()):
        x, y, z, yaw = path[row]
        ahead = np.array([np.cos(yaw), np.sin(yaw), -LOOK_DOWN])
        ahead /= np.linalg.norm(ahead)
        right = np.array([np.sin(yaw), -np.cos(yaw), 0.0])
        pose = np.eye(4)
        pose[:3, :3] = np.column_stack([right, np.cross(ahead, right), ahead])
        pose[:3, 3] = x, y, z
        shots.append(Shot(row, k * PERIOD, pose))
    return Shots(tuple(shots), camera, missing)


def _scaled(camera: Camera) -> Camera:
    """The camera of a film at most `WIDTH` pixels wide, with even sides, as H.264 needs."""
    scale = min(1.0, WIDTH / camera.width)
    width, height = (max(2, round(side * scale / 2) * 2) for side in (camera.width, camera.height))
    x, y = width / camera.width, height / camera.height
    return Camera(width, height, camera.fx * x, camera.fy * y, camera.cx * x, camera.cy * y)
