"""A COLMAP model with its images -> `Recording`: poses that COLMAP, ViPE, MapAnything or others estimated.

    images/ *.png|jpg                               the frames (in sub-folders too; or beside the model)
    sparse/0/{cameras,images,points3D}.{bin,txt}    or sparse/, or the folder itself

The unit and the axes of a model are arbitrary: the ground among its points and the camera's height determine both, as
for a video, so a model needs points. Every image is undistorted to one pinhole camera, whatever its camera's model.
"""

import os
import pathlib
from collections.abc import Callable
from typing import Any

import cv2
import numpy as np
from PIL import Image

from ...datatypes import Camera, Recording, Source
from ...datatypes import validation as v
from ...datatypes.recording import UNREADABLE
from ...work_folder import work_folder
from ..perception.frames import Frames, SamplingOptions
from ..perception.mapping import MIN_FRAMES
from ..perception.observation import Predictor
from ..perception.perceive import Perception, perceive
from ..perception.structure import Structure

_MODEL_FOLDERS = ("sparse/0", "sparse", "")
#: Bytes of the shortest record of each binary file, behind the u64 that counts them.
_LEAST_BYTES = {"cameras": 48, "images": 73, "points3D": 51}


def read_colmap(
    root: str | os.PathLike[str],
    folder: str | os.PathLike[str],
    predictor: Predictor,
    source: Source,
    camera_height: float = 1.5,
    rate: float = 1.0,
    progress: Callable[[int, int], None] | None = None,
) -> Recording:
    """Converts a COLMAP model to a recording.

    Args:
      root: the folder described above; images count as frames in the order of their names.
      folder: of the recording.
      predictor: finds objects, surfaces and depth in the frames.
      camera_height: m above the ground that the camera's carrier walks on.
      rate: frames per second.

    Raises:
      ValidationError: there is no model, fewer than three images have a pose, an image does not exist or has another
        size than its camera, or the points show too little ground.
    """
    root = pathlib.Path(root)
    v.number(rate, "frames per second", above=0.0)
    model = _model(root)
    posed = sorted((image for image in model.images.values() if image.has_pose), key=lambda image: image.name)
    if len(posed) < MIN_FRAMES:
        raise v.fail(
            str(root), v.counted(len(posed), "images with a pose"), f"at least {MIN_FRAMES}", "map more images"
        )
    camera = _pinhole(model, posed)
    pictures = root / "images" if (root / "images").is_dir() else root
    with work_folder("urbanverse-colmap-") as work:
        names = []
        for number, image in enumerate(posed):
            names.append(f"{number:06d}.png")
            rgb = _undistorted(pictures / image.name, model.cameras[image.camera_id], camera)
            Image.fromarray(rgb).save(work / names[-1], compress_level=1)
        times = tuple(round(number / rate, 4) for number in range(len(posed)))
        frames = Frames(work, tuple(names), times, camera.width, camera.height)
        structure = _structure(model, posed, camera)
        perception = Perception(predictor, lambda frames, progress: structure, camera_height)
        return perceive(frames, pathlib.Path(folder), perception, source, root.absolute().name, progress)


def _model(root: pathlib.Path) -> Any:
    import pycolmap

    for name in _MODEL_FOLDERS:
        if any((root / name / f"cameras.{suffix}").is_file() for suffix in ("bin", "txt")):
            _check_counts(root / name)
            try:
                return pycolmap.Reconstruction(str(root / name))
            except (RuntimeError, ValueError, LookupError, MemoryError) as error:
                # COLMAP finds some cut-off files only by an index or a length that cannot be.
                reason = (str(error).strip() or type(error).__name__).splitlines()[-1]
                raise v.fail(
                    str(root / name), f"a model that COLMAP cannot read ({reason})", "a whole model"
                ) from error
    raise v.fail(
        str(root),
        "no cameras.bin or cameras.txt",
        "a COLMAP model in sparse/0, sparse or the folder itself",
        "export one with `colmap model_converter`, or check the path",
    )


def _check_counts(folder: pathlib.Path) -> None:
    """Refuses binary files that promise more records than they have bytes for: COLMAP reads on behind their end, for
    over a minute, before it finds that a number was given twice."""
    for name, least in _LEAST_BYTES.items():
        path = folder / f"{name}.bin"
        if path.is_file():
            with path.open("rb") as file:
                count = int.from_bytes(file.read(8), "little")
            if (size := path.stat().st_size) < 8 + count * least:
                reason = f"{path.name} has {size} bytes for {v.counted(count, 'records')}"
                raise v.fail(str(folder), f"a model that COLMAP cannot read ({reason})", "a whole model")


def _pinhole(model: Any, posed: list[Any]) -> Camera:
    """The common camera: the median focal length and size of the images, scaled to at most the usual short side."""
    lenses = [model.cameras[image.camera_id] for image in posed]
    width, height = (int(np.median([getattr(lens, side) for lens in lenses])) for side in ("width", "height"))
    focal = float(np.median([lens.mean_focal_length() for lens in lenses]))
    factor = min(1.0, SamplingOptions().short_side / min(width, height))
    width, height, focal = round(width * factor), round(height * factor), focal * factor
    return Camera(width, height, focal, focal, width / 2, height / 2)


def _undistorted(path: pathlib.Path, lens: Any, camera: Camera) -> np.ndarray:
    """(H, W, 3) u8, the image as the pinhole camera sees it."""
    try:
        with Image.open(path) as image:
            rgb = np.asarray(image.convert("RGB"))
    except UNREADABLE as error:
        raise v.fail(str(path), f"an unreadable image ({error})", "the image that the model names") from error
    if rgb.shape[:2] != (lens.height, lens.width):
        found, needed = f"{rgb.shape[1]}x{rgb.shape[0]} pixels", f"{lens.width}x{lens.height} as its camera has"
        raise v.fail(str(path), found, needed, "use the images that were mapped")
    seen = np.asarray(lens.img_from_cam(camera.rays().reshape(-1, 3)))
    # `cv2.remap` cannot average areas, so large images are reduced before.
    factor = min(1.0, camera.fx / lens.mean_focal_length())
    size = round(lens.width * factor), round(lens.height * factor)
    if factor < 1.0:
        rgb = cv2.resize(rgb, size, interpolation=cv2.INTER_AREA)
    # The centre of the first pixel is (0.5, 0.5) in COLMAP and (0, 0) in OpenCV.
    seen = seen * [size[0] / lens.width, size[1] / lens.height] - 0.5
    columns, rows = seen.reshape(camera.height, camera.width, 2).astype(np.float32).transpose(2, 0, 1)
    return cv2.remap(rgb, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)


def _structure(model: Any, posed: list[Any], camera: Camera) -> Structure:
    identifiers = sorted(model.points3D)
    row = {identifier: number for number, identifier in enumerate(identifiers)}
    poses = np.tile(np.eye(4), (len(posed), 1, 1))
    frame, point, pixel = [], [], []
    for number, image in enumerate(posed):
        poses[number, :3] = image.cam_from_world().inverse().matrix()
        seen = [p for p in image.get_observation_points2D() if p.point3D_id in row]
        frame.append(np.full(len(seen), number, np.int32))
        point.append(np.array([row[p.point3D_id] for p in seen], np.int32))
        lens = model.cameras[image.camera_id]
        straight = np.asarray(lens.cam_from_img(np.array([p.xy for p in seen]).reshape(-1, 2))).reshape(-1, 2)
        pixel.append(straight * camera.fx + [camera.cx, camera.cy])
    return Structure(
        camera=camera,
        distortion=0.0,
        registered=np.arange(len(posed), dtype=np.int32),
        poses=poses,
        points=np.array([model.points3D[i].xyz for i in identifiers]).reshape(-1, 3),
        frame=np.concatenate(frame),
        point=np.concatenate(point),
        pixel=np.concatenate(pixel).astype(np.float32),
        error=float(model.compute_mean_reprojection_error()),
        model=np.zeros(len(posed), np.int32),
    )
