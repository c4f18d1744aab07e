"""Errors put into a perfect recording: estimated poses, depth and masks at fixed sizes.

Pose drift of 1 % of the path and 0.3° per 10 m; depth x (1 + N(0, 0.08)) per frame and 5 % correlated over the
image; detector recall 0.75, precision 0.8; 8 % of the labels confused; masks eroded or dilated by 5 % of their size.
"""

import dataclasses
import pathlib

import numpy as np
import scipy.ndimage
from scipy.spatial.transform import Rotation

from urbanverse_mjx.datatypes import Detection, Recording, RecordingWriter


@dataclasses.dataclass(frozen=True)
class Errors:
    """Sizes of the errors; the defaults are the protocol's.

    Attributes:
      drift: share of the path by which it is too long, and as much again sideways from the turn below.
      turn: rad per m.
      frame_depth: sigma of each frame's depth factor.
      pixel_depth: sigma of the field over the image, whose features are about a tenth of the image wide.
      recall, precision: of detections per frame.
      confusion: share of labels that are another label of the capture.
      mask: by what share of its size (square root of its area) a mask grows or shrinks.
    """

    drift: float = 0.01
    turn: float = np.radians(0.3) / 10.0
    frame_depth: float = 0.08
    pixel_depth: float = 0.05
    recall: float = 0.75
    precision: float = 0.8
    confusion: float = 0.08
    mask: float = 0.05


_FIELD = (6, 10)  # rows and columns of the coarse noise that the depth field is drawn from


def inject(
    recording: Recording, folder: pathlib.Path, seed: int, errors: Errors | None = None, images: bool = False
) -> Recording:
    """A copy of a recording with errors; tracks are gone.

    Args:
      recording: with depth, masks and surfaces in every frame.
      folder: of the copy.
      seed: of everything random.
      images: whether the copy has the recording's images; otherwise they are black.
    """
    errors = errors or Errors()
    rng = np.random.default_rng([seed, 17])
    writer = RecordingWriter(folder, recording.id, recording.source, recording.camera, recording.depth_unit_m)
    names = sorted({d.label for f in recording.frames for d in f.detections})
    poses = drifted(recording.poses(), errors, rng.choice([-1.0, 1.0]))
    black = np.zeros((recording.camera.height, recording.camera.width, 3), np.uint8)
    for i, number in enumerate(recording.registered):
        frame = recording.frames[number]
        depth, masks = recording.depth(int(number)), recording.masks(int(number))
        if depth is None or masks is None:
            continue
        factor = (1.0 + rng.normal(0.0, errors.frame_depth)) * (1.0 + errors.pixel_depth * _field(depth.shape, rng))
        masks = _resized(masks, len(frame.detections), errors.mask, rng)
        masks, found = _detected(masks, frame.detections, names, errors, rng)
        surfaces = recording.surfaces(int(number))
        rgb = recording.rgb(int(number)) if images else black
        writer.add(frame.time_s, rgb, depth * np.maximum(factor, 0.2), masks, surfaces, poses[i], found)
    return writer.close()


def drifted(poses: np.ndarray, errors: Errors, sign: float) -> np.ndarray:
    """(m, 4, 4) poses put together from steps that are too long and always turned a little to the same side."""
    out = poses.copy()
    turned = 0.0
    for i in range(1, len(poses)):
        step = poses[i, :3, 3] - poses[i - 1, :3, 3]
        turned += sign * errors.turn * float(np.linalg.norm(step))
        turn = Rotation.from_euler("z", turned).as_matrix()
        out[i, :3, 3] = out[i - 1, :3, 3] + (1.0 + errors.drift) * turn @ step
        out[i, :3, :3] = turn @ poses[i, :3, :3]
    return out


def _field(shape: tuple[int, ...], rng: np.random.Generator) -> np.ndarray:
    """(H, W) smooth noise of mean 0 and standard deviation 1."""
    coarse = rng.normal(size=_FIELD)
    grid = np.meshgrid(*(np.linspace(0, n - 1, s) for n, s in zip(_FIELD, shape, strict=True)), indexing="ij")
    field = scipy.ndimage.map_coordinates(coarse, grid, order=3, mode="nearest")
    return (field - field.mean()) / field.std()


def _resized(masks: np.ndarray, count: int, share: float, rng: np.random.Generator) -> np.ndarray:
    """Masks that have each grown or shrunk along their outline."""
    if count == 0:
        return masks
    area = np.bincount(masks[masks >= 0], minlength=count)
    # Whole pixels, drawn so that the mean is right.
    radius = np.floor(share * np.sqrt(area) + rng.random(count)).astype(int)
    grows = rng.random(count) < 0.5
    padded = np.pad(masks, 1, mode="edge")
    other = masks.copy()
    for dy, dx in ((0, 1), (2, 1), (1, 0), (1, 2)):
        neighbour = padded[dy : dy + masks.shape[0], dx : dx + masks.shape[1]]
        other = np.where(neighbour != masks, neighbour, other)
    edge = other != masks
    if not edge.any():
        return masks
    distance, at = scipy.ndimage.distance_transform_edt(~edge, return_indices=True)
    same = masks[tuple(at)] == masks
    beyond, apart = np.where(same, other[tuple(at)], masks[tuple(at)]), distance + same
    out = masks.copy()
    own = np.maximum(masks, 0)
    out[(masks >= 0) & ~grows[own] & (apart <= radius[own])] = -1
    next_ = np.maximum(beyond, 0)
    taken = (beyond >= 0) & grows[next_] & (apart <= radius[next_])
    out[taken] = beyond[taken]
    return out


def _detected(
    masks: np.ndarray, objects: tuple[Detection, ...], names: list[str], errors: Errors, rng: np.random.Generator
) -> tuple[np.ndarray, list[Detection]]:
    """Some objects missed, some labels wrong, some objects found that are not there; scores as detectors give them."""
    found: list[Detection] = []
    number = np.full(len(objects) + 1, -1)
    for i, obj in enumerate(objects):
        if rng.random() < errors.recall:
            label = names[rng.integers(len(names))] if rng.random() < errors.confusion else obj.label
            number[i] = len(found)
            found.append(Detection(label, float(rng.uniform(0.5, 1.0))))
    out = number[masks]
    height, width = masks.shape
    rows, columns = np.mgrid[0:height, 0:width]
    for _ in range(rng.binomial(len(found), (1 - errors.precision) / errors.precision) if found else 0):
        y, x = rng.uniform(0.35, 0.9) * height, rng.uniform(0, width)
        ry, rx = rng.uniform(0.02, 0.12, 2) * height
        ellipse = ((rows - y) / ry) ** 2 + ((columns - x) / rx) ** 2 <= 1
        out[ellipse] = len(found)
        found.append(Detection(names[rng.integers(len(names))], float(rng.uniform(0.3, 0.8))))
    return out, found
