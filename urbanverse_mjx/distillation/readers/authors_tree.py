"""The folder that UrbanVerse-Gen's authors document for their distillation (not released) -> `Recording`.

    images/ *.png|jpg       the frames (beside, or named by the caller)
    depth/ *.npy            (h, w) metres      conf/ *.npy     (h, w) confidence, higher is surer
    poses/ *.npy            (4, 4) T_world_camera, OpenCV axes, metres; or one file (n, 4, 4)
    camera.yaml             fx, fy, cx, cy, or a 3 x 3 matrix under K, intrinsics or camera_matrix
    segmentations_2d/ *.jpg, scene_pcd.glb, config_params.json, distilled_scene_graph.pkl.gz

The reader uses frames, depth, confidence, poses and intrinsics. It does not open the masks, which are drawings with
JPEG artefacts, nor the graph, which is a pickle and could run arbitrary code; a `Predictor` detects the objects again.
The documentation does not define the world axes, so the world is rotated until the cameras' mean up direction is z, and
shifted so that the first camera is at the origin. If images and depth differ in size, images are scaled to the depth,
to which the intrinsics in camera.yaml belong.
"""

import os
import pathlib
from collections.abc import Callable

import numpy as np
import yaml
from PIL import Image
from scipy.spatial.transform import Rotation

from ...datatypes import Camera, Recording, RecordingWriter, Source
from ...datatypes import validation as v
from ...datatypes.recording import UNREADABLE
from ..perception.observation import Predictor
from ..perception.perceive import identifier

_IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg")
_MATRICES = ("K", "intrinsics", "camera_matrix")
#: Share of a frame's pixels, those of least confidence, whose depth is not used.
_UNTRUSTED_SHARE = 0.15


def read_authors_tree(
    root: str | os.PathLike[str],
    folder: str | os.PathLike[str],
    predictor: Predictor,
    source: Source,
    rate: float = 1.0,
    images: str | os.PathLike[str] | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Recording:
    """Converts the authors' output folder to a recording.

    Args:
      root: the folder described above.
      folder: of the recording.
      predictor: finds objects and surfaces in the frames.
      rate: frames per second.
      images: the frames' folder; default: `images` in the root.

    Raises:
      ValidationError: a part is missing, parts have different lengths, or values are not valid poses, depths or
        intrinsics.
    """
    root = pathlib.Path(root)
    rgb_files = _files(pathlib.Path(images) if images is not None else root / "images", _IMAGE_SUFFIXES)
    depths = _files(root / "depth", (".npy",))
    poses = _upright(_poses(root / "poses"))
    if not len(rgb_files) == len(depths) == len(poses):
        found = f"{len(rgb_files)} images, {len(depths)} depth maps and {len(poses)} poses"
        raise v.fail(str(root), found, "as many of each", "run the distillation again")
    trusted = _files(root / "conf", (".npy",)) if (root / "conf").is_dir() else []
    if trusted and len(trusted) != len(depths):
        found = f"{len(trusted)} confidence maps for {len(depths)} depth maps"
        raise v.fail(str(root / "conf"), found, "one for each", "remove conf/ to do without")
    first = _array(depths[0], 2)
    camera = _camera(root / "camera.yaml", first.shape[1], first.shape[0])
    writer = RecordingWriter(folder, identifier(root.name), source, camera, lossless=False)
    for k, (rgb_file, path) in enumerate(zip(rgb_files, depths, strict=True)):
        depth = _array(path, 2)
        if depth.shape != first.shape:
            raise v.fail(str(path), f"shape {depth.shape}", f"that of the first, {first.shape}", "write it again")
        depth = np.where(np.isfinite(depth) & (depth > 0), depth, 0.0)
        if trusted:
            surety = _array(trusted[k], 2)
            if surety.shape != depth.shape:
                raise v.fail(str(trusted[k]), f"shape {surety.shape}", f"the depth's {depth.shape}", "write it again")
            depth = np.where(surety >= np.quantile(surety, _UNTRUSTED_SHARE), depth, 0.0)
        rgb = _rgb(rgb_file, camera)
        observation = predictor(rgb, camera.fx)
        writer.add(k / rate, rgb, depth, observation.masks, observation.surfaces, poses[k], observation.detections)
        if progress is not None:
            progress(k + 1, len(rgb_files))
    return writer.close()


def _files(folder: pathlib.Path, suffixes: tuple[str, ...]) -> list[pathlib.Path]:
    found = sorted(p for p in folder.iterdir() if p.suffix.lower() in suffixes) if folder.is_dir() else []
    if not found:
        raise v.fail(str(folder), "no such files", f"files that end in {', '.join(suffixes)}", "name the right folder")
    return found


def _array(path: pathlib.Path, dimensions: int) -> np.ndarray:
    try:
        values = np.load(path, allow_pickle=False)
    except (OSError, ValueError, EOFError) as error:
        raise v.fail(str(path), f"no readable array ({error})", "a .npy file of numbers", "write it again") from error
    values = values.squeeze() if values.ndim > dimensions else values
    if values.ndim != dimensions or not np.issubdtype(values.dtype, np.number):
        raise v.fail(str(path), f"shape {values.shape} of {values.dtype}", f"{dimensions} dimensions of numbers")
    return values.astype(np.float64)


def _poses(folder: pathlib.Path) -> np.ndarray:
    """(n, 4, 4) poses as stored."""
    files = _files(folder, (".npy",))
    poses = _array(files[0], 3) if len(files) == 1 else np.stack([_array(path, 2) for path in files])
    if poses.shape[1:] != (4, 4):
        raise v.fail(str(folder), f"poses of shape {poses.shape[1:]}", "4 x 4", "run the distillation again")
    off = np.abs(poses[:, :3, :3] @ poses[:, :3, :3].transpose(0, 2, 1) - np.eye(3)).max((1, 2))
    wrong = np.flatnonzero(~np.isfinite(poses).all((1, 2)) | ~(off < 1e-3))
    if len(wrong):
        found = f"pose {wrong[0]} is no rotation and shift"
        raise v.fail(str(folder), found, "rigid 4 x 4 transforms", "run the distillation again")
    return poses


def _upright(poses: np.ndarray) -> np.ndarray:
    """Transforms poses to a world whose z is the cameras' mean up direction, with the first camera at the origin."""
    up = -poses[:, :3, 1].mean(0)
    turn, _ = Rotation.align_vectors([[0.0, 0.0, 1.0]], [up / np.linalg.norm(up)])
    T = np.eye(4)
    T[:3, :3] = turn.as_matrix()
    T[:3, 3] = -T[:3, :3] @ poses[0, :3, 3]
    turned = T @ poses
    # Rotations are stored in 32 bits; they are replaced by the nearest orthogonal matrices.
    u, _, vt = np.linalg.svd(turned[:, :3, :3])
    turned[:, :3, :3] = u @ vt
    turned[:, 3] = [0.0, 0.0, 0.0, 1.0]
    return turned


def _camera(path: pathlib.Path, width: int, height: int) -> Camera:
    try:
        body = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        reason = str(error).splitlines()[0]
        raise v.fail(
            str(path), f"no readable YAML ({reason})", "the intrinsics", "run the distillation again"
        ) from error
    body = body if isinstance(body, dict) else {}
    matrix = next((body[name] for name in _MATRICES if name in body), None)
    try:
        if matrix is not None:
            values = np.array(matrix["data"] if isinstance(matrix, dict) else matrix, np.float64).reshape(3, 3)
            lens = [values[0, 0], values[1, 1], values[0, 2], values[1, 2]]
        else:
            lens = [float(body[name]) for name in ("fx", "fy", "cx", "cy")]
    except (KeyError, TypeError, ValueError) as error:
        needed = "fx, fy, cx and cy, or a 3 x 3 matrix under K, intrinsics or camera_matrix"
        raise v.fail(str(path), f"the fields {', '.join(map(str, body)) or 'none'}", needed, "add them") from error
    return Camera(width, height, *(float(x) for x in lens))


def _rgb(path: pathlib.Path, camera: Camera) -> np.ndarray:
    try:
        with Image.open(path) as image:
            size = camera.width, camera.height
            return np.asarray(image.convert("RGB").resize(size, Image.Resampling.BILINEAR))
    except UNREADABLE as error:
        raise v.fail(str(path), f"no readable image ({error})", "a PNG or JPEG", "write it again") from error
