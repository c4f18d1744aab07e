"""A structure from motion: camera poses and some thousand points, up to a similarity."""

import dataclasses

import cv2
import numpy as np

from ...datatypes import Camera

#: Pixels at the corner; less lens distortion is not corrected.
MIN_DISTORTION = 0.3


@dataclasses.dataclass(frozen=True)
class Structure:
    """A reconstruction of m registered frames, p points and o observations; each model has a unit and axes of its own.

    Attributes:
      camera: pinhole camera of the undistorted frames.
      distortion: k1 of COLMAP's SIMPLE_RADIAL.
      registered: (m,) i32 numbers of the frames.
      poses: (m, 4, 4) f64 T_structure_camera, OpenCV axes.
      points: (p, 3) f64.
      frame, point: (o,) i32 row of `registered` and of `points`.
      pixel: (o, 2) f32 u, v in the straightened frame.
      error: pixels, mean reprojection error.
      model: (m,) i32 which model each frame belongs to; points are seen by the frames of one model alone.
      bridges: number of breaks that were mapped again (`bridges`).
    """

    camera: Camera
    distortion: float
    registered: np.ndarray
    poses: np.ndarray
    points: np.ndarray
    frame: np.ndarray
    point: np.ndarray
    pixel: np.ndarray
    error: float
    model: np.ndarray
    bridges: int = 0

    def only(self, rows: np.ndarray) -> "Structure":
        """The structure with only the frames of some rows (k,), in order, and their observations; all points are
        kept."""
        new = np.full(len(self.registered), -1, np.int32)
        new[rows] = np.arange(len(rows))
        seen = new[self.frame] >= 0
        return dataclasses.replace(
            self,
            registered=self.registered[rows],
            poses=self.poses[rows],
            frame=new[self.frame[seen]],
            point=self.point[seen],
            pixel=self.pixel[seen],
            model=self.model[rows],
        )

    def step(self, rows: np.ndarray) -> float:
        """Median distance between the cameras of some rows (k,) from one frame to the next, in the structure's unit;
        NaN for fewer than two rows."""
        if len(rows) < 2:
            return float("nan")
        distance = np.linalg.norm(np.diff(self.poses[rows, :3, 3], axis=0), axis=1)
        return float(np.median(distance / np.diff(self.registered[rows])))

    def depth(self) -> np.ndarray:
        """(o,) f64: depth of every observation along its camera's axis."""
        out = self.points[self.point] - self.poses[self.frame, :3, 3]
        return np.einsum("oi,oi->o", out, self.poses[self.frame, :3, 2])

    def straighten(self, rgb: np.ndarray) -> np.ndarray:
        """Undistorts a frame (H, W, 3) u8."""
        camera = self.camera
        corner = (camera.cx**2 + camera.cy**2) / camera.fx**2
        if abs(self.distortion) * corner * np.hypot(camera.cx, camera.cy) < MIN_DISTORTION:
            return rgb
        # The origin of pixel coordinates is the centre of the first pixel in OpenCV and its corner here. COLMAP and
        # OpenCV define k1 alike.
        pinhole = np.array([[camera.fx, 0.0, camera.cx - 0.5], [0.0, camera.fy, camera.cy - 0.5], [0.0, 0.0, 1.0]])
        lens = np.array([self.distortion, 0.0, 0.0, 0.0])
        size = (camera.width, camera.height)
        columns, rows = cv2.initUndistortRectifyMap(pinhole, lens, np.eye(3), pinhole, size, cv2.CV_32FC1)
        return cv2.remap(rgb, columns, rows, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
