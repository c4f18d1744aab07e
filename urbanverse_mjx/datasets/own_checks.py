"""Checks of features that `urbanverse record` writes, beyond type and shape."""

from collections.abc import Iterator

import numpy as np

_QUATERNIONS = ("pose", "pose.camera")
_UNIT_ERROR = 1e-3
NORMALS = "observation.images.normal"


def check_column(name: str, column: np.ndarray, where: str) -> Iterator[str]:
    """Checks the rows (T, ...) of a feature: quaternions have length one, forces are not negative, and something is
    touched only where a label says what.

    Yields:
      a sentence for each problem.
    """
    wrong, found, needed = np.zeros(len(column), bool), "", ""
    if name in _QUATERNIONS and column.shape[1:] == (7,):
        wrong = np.abs(np.linalg.norm(column[:, 3:], axis=1) - 1.0) > _UNIT_ERROR
        found, needed = "a quaternion that is not of length one", "qw, qx, qy, qz of a rotation"
    elif name in ("next.contact_force", "next.foot_force"):
        wrong = (column.reshape(len(column), -1) < 0.0).any(1)
        found, needed = "a negative force", "N"
    elif name == "next.contact_object":
        wrong = (column < -1) | (column == 0) | (column == 1)
        found, needed = "the label of the sky, the robot or nothing", "-1, or a label of the instance image from 2 on"
    if wrong.any():
        yield f"{where}: row {int(np.argmax(wrong))}: {name}: found {found}, needed {needed}"


def check_image(name: str, image: np.ndarray, where: str) -> Iterator[str]:
    """Checks a decoded image: pixels of normals are unit vectors, or 128 in all channels."""
    if name == NORMALS and image.ndim == 3:
        length = np.linalg.norm((image.astype(np.float64) - 128.0) / 127.0, axis=-1)
        if not ((length == 0.0) | (np.abs(length - 1.0) < 0.02)).all():
            yield f"{where}: found a pixel that is no unit vector, needed 128 + 127 n, or 128 in all channels"
