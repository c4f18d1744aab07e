"""KITTI's object benchmark: image_2, velodyne, label_2, calib.

Source of columns and frames: the readme of KITTI's object development kit (Geiger et al., "Are we ready for
autonomous driving?", CVPR 2012). Boxes there stand upright in the camera's frame. The robot's camera may lean, so
labels are in the levelled camera's frame (same origin and heading, y straight down), and P2 = K [R | 0] with R from
there to the camera.
"""

import re

import numpy as np

from ..geometry import rotations
from .annotations import SeenObject
from .frame_files import FrameEpisode, FrameFolder, Rig

IMAGE_SET = "ImageSets/train.txt"
#: Words of KITTI's own classes; other categories are named in its manner, such as TrashBin.
_CLASSES = {
    "Pedestrian": {"pedestrian", "person"},
    "Cyclist": {"cyclist"},
    "Car": {"car", "taxi", "suv", "sedan"},
    "Van": {"van"},
    "Truck": {"truck", "lorry"},
    "Tram": {"tram"},
}
#: "occluded": least visible share of each level, of which KITTI has none in numbers.
_FULLY, _PARTLY = 0.9, 0.5


class KittiWriter(FrameFolder):
    """Writes training/{image_2,velodyne,label_2,calib}/000000.*, and the finished frames in ImageSets/train.txt."""

    image_type = "png"

    def files(self, episode: FrameEpisode) -> dict[str, bytes]:
        """Four files a frame."""
        found = {}
        for step in range(len(episode)):
            name = f"{self.num_frames + step:06d}"
            camera, robot = episode.columns["pose.camera"][step], episode.columns["pose"][step]
            level = levelled(camera[3:])
            found[f"training/image_2/{name}.png"] = episode.colours[step]
            points = episode.scans[step].astype("<f4")
            found[f"training/velodyne/{name}.bin"] = np.pad(points, ((0, 0), (0, 1))).tobytes()
            lines = [label_line(item, camera, level, self.rig) for item in episode.annotations[step].objects]
            found[f"training/label_2/{name}.txt"] = "".join(line + "\n" for line in lines if line).encode()
            found[f"training/calib/{name}.txt"] = calibration(camera, robot, level, self.rig).encode()
        return found

    def lists(self) -> dict[str, bytes]:
        """The names of all frames."""
        return {IMAGE_SET: "".join(f"{k:06d}\n" for k in range(self.num_frames)).encode()}


def levelled(quaternion: np.ndarray) -> np.ndarray:
    """(3, 3) R_world_level: axes of a camera with the heading of one (4,) wxyz T_world_camera, y straight down."""
    ahead = rotations.matrix_f64(np.asarray(quaternion))[:, 2]
    ahead = np.array([ahead[0], ahead[1], 0.0]) / max(np.hypot(ahead[0], ahead[1]), 1e-9)
    down = np.array([0.0, 0.0, -1.0])
    return np.column_stack([np.cross(down, ahead), down, ahead])


def projection(camera: np.ndarray, level: np.ndarray, rig: Rig) -> np.ndarray:
    """(3, 4) P2: homogeneous points in the levelled camera's frame -> pixels."""
    turn = rotations.matrix_f64(np.asarray(camera[3:])).T @ level
    return np.column_stack([rig.matrix @ turn, np.zeros(3)])


def calibration(camera: np.ndarray, robot: np.ndarray, level: np.ndarray, rig: Rig) -> str:
    """A calib file of a frame, from the poses (7,) of the camera and the robot's root body in the scene."""
    body = rotations.matrix_f64(np.asarray(robot[3:]))
    place = robot[:3] + body @ np.array(rig.lidar) - camera[:3]
    lidar = np.column_stack([level.T @ body, level.T @ place])
    imu = np.column_stack([np.eye(3), -np.array(rig.lidar)])
    p2 = projection(camera, level, rig)
    rows = {f"P{k}": p2 for k in range(4)}
    rows |= {"R0_rect": np.eye(3), "Tr_velo_to_cam": lidar, "Tr_imu_to_velo": imu}
    return "".join(f"{name}: {' '.join(f'{x:.12e}' for x in value.ravel())}\n" for name, value in rows.items())


def label_line(item: SeenObject, camera: np.ndarray, level: np.ndarray, rig: Rig) -> str:
    """A row of label_2: type, truncated, occluded, alpha, 2D box, height, width, length, x, y, z, rotation_y.

    Empty for an object whose centre is not in front of the camera, which these columns cannot describe.
    """
    middle = level.T @ (np.array(item.position_world) - camera[:3])
    if middle[2] <= 0.0:
        return ""
    length, width, height = item.size
    ahead = level.T @ rotations.matrix_f64(np.array(item.quaternion_world))[:, 0]
    rotation = np.arctan2(-ahead[2], ahead[0])
    alpha = (rotation - np.arctan2(middle[0], middle[2]) + np.pi) % (2 * np.pi) - np.pi
    left, top, right, bottom = item.box
    box = [left, top, right - 1, bottom - 1]
    numbers = [*box, height, width, length, middle[0], middle[1] + 0.5 * height, middle[2], rotation]
    cut = truncation(item, rig)
    hidden = 0 if item.visible >= _FULLY else 1 if item.visible >= _PARTLY else 2
    columns = [kitti_class(item.category), f"{cut:.2f}", str(hidden), f"{alpha:.4f}", *(f"{x:.4f}" for x in numbers)]
    return " ".join(columns)


def truncation(item: SeenObject, rig: Rig) -> float:
    """Share of the projected box in space's rectangle that lies outside the image; 1 where it reaches behind it."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)]) * item.size
    turn = rotations.matrix_f64(np.array(item.quaternion_camera))
    points = corners @ turn.T + item.position_camera
    if points[:, 2].min() <= 0.01:
        return 1.0
    pixels = (points @ rig.matrix.T)[:, :2] / points[:, 2:]
    low, high = pixels.min(0), pixels.max(0)
    size = np.array([rig.width, rig.height])
    inside = np.prod(np.maximum(np.minimum(high, size) - np.maximum(low, 0), 0.0))
    return float(1.0 - inside / max(np.prod(high - low), 1e-9))


def kitti_class(category: str) -> str:
    """One word for a category: KITTI's class where its last word, or "pedestrian" as its first, says so; else its words
    joined."""
    words = re.findall(r"[^\W_]+", category.rpartition(":")[2].rpartition("/")[2])
    ends = {word.lower() for word in words[-1:]} | ({"pedestrian"} & {word.lower() for word in words[:1]})
    own = next((name for name, known in _CLASSES.items() if known & ends), None)
    return own or "".join(word.capitalize() for word in words) or "Misc"
