"""Poses with the most hulls within a robot's reach, facing the nearest: the most expensive physics of a bank."""

import dataclasses

import numpy as np

from urbanverse_mjx.datatypes import RobotSpec, SceneBank, ValidationError


@dataclasses.dataclass(frozen=True)
class Poses:
    """Poses of robots.

    Attributes:
      scene: (n,) i32 rows of the bank.
      position: (n, 3) f32 m on the ground.
      yaw: (n,) f32 rad, towards the nearest hull.
      in_reach: (n,) i32 hulls within circumradius + max_speed * control step of the position.
      distance: (n,) f32 m to the nearest hull's box.
    """

    scene: np.ndarray
    position: np.ndarray
    yaw: np.ndarray
    in_reach: np.ndarray
    distance: np.ndarray


def _offsets_to_boxes(bank: SceneBank, scene: int, points: np.ndarray) -> np.ndarray:
    """(n, q, 3) m: from each of (n, 3) points to the nearest point of each oriented hull box of the scene."""
    present = bank.inst_hull[scene] >= 0
    rotation = bank.inst_rotation[scene, present]
    centre, half = np.moveaxis(bank.hull_box[bank.inst_hull[scene, present]], 1, 0)
    origin = bank.inst_position[scene, present]
    local = np.einsum("nqj,qji->nqi", points[:, None] - origin[None], rotation) - centre
    nearest = np.clip(local, -half, half) - local
    return np.einsum("qij,nqj->nqi", rotation, nearest)


def _free_places(bank: SceneBank, scene: int) -> np.ndarray:
    """(n, 3) m: starts and waypoints of the scene's episodes, all on the ground and clear of hulls."""
    rows = slice(0, int(bank.num_episodes[scene]))
    places = [bank.episode_start[scene, rows, :3], bank.episode_waypoints[scene, rows].reshape(-1, 3)]
    return np.unique(np.concatenate(places).astype(np.float32), axis=0)


def crowded_poses(bank: SceneBank, robot: RobotSpec, count: int, control_dt: float) -> Poses:
    """Returns the `count` poses with the most hulls within reach, repeated if the bank has fewer.

    Raises:
      ValidationError: the bank holds no hull within reach of any place.
    """
    reach = robot.circumradius + robot.max_speed * control_dt
    # Hulls are tested at half the robot's height.
    lift = np.array([0.0, 0.0, 0.5 * robot.planner_height], np.float32)
    found = []
    for scene in range(bank.num_scenes):
        places = _free_places(bank, scene)
        for chunk in np.array_split(places, max(1, len(places) // 512)):
            offsets = _offsets_to_boxes(bank, scene, chunk + lift)
            if not offsets.shape[1]:
                continue
            distance = np.linalg.norm(offsets, axis=-1)
            nearest = distance.argmin(1)
            row = np.arange(len(chunk))
            towards = offsets[row, nearest]
            yaw = np.arctan2(towards[:, 1], towards[:, 0])
            scenes = np.full(len(chunk), scene, np.int32)
            found.append((scenes, chunk, yaw, (distance < reach).sum(1), distance[row, nearest]))
    columns = [np.concatenate(c) for c in zip(*found, strict=True)]
    if not columns or not columns[3].any():
        raise ValidationError(
            f"bank: found no hull within {reach:.2f} m of any episode's places, needed some to drive into."
        )
    # Most hulls first, then the nearest, which are hit in the fewest steps.
    order = np.lexsort((columns[4], -columns[3]))
    order = order[columns[3][order] > 0]
    chosen = np.resize(order[:count], count)
    scene, position, yaw, in_reach, distance = (c[chosen] for c in columns)
    return Poses(scene, position, yaw.astype(np.float32), in_reach.astype(np.int32), distance.astype(np.float32))
