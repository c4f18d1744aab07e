"""The scene of a bank as an ordinary MuJoCo model, and what C MuJoCo's rays see in it: the renderer's oracle."""

import dataclasses

import mujoco
import numpy as np

from urbanverse_mjx.datatypes import RobotSpec, SceneBank

#: Visible groups: the scene's meshes (0) and the robot's visual geoms (2), not its collision spheres (3).
_SEEN = np.array([1, 0, 1, 0, 0, 0], np.uint8)


@dataclasses.dataclass(frozen=True)
class Street:
    """One scene with a robot in it. slot: (ngeom,) slot of each geom, -2 for the robot's."""

    model: mujoco.MjModel
    data: mujoco.MjData
    slot: np.ndarray


def build_street(bank: SceneBank, scene: int, robot: RobotSpec) -> Street:
    """Meshes as MuJoCo itself places them: body poses from the bank, without our compensation of inertial frames."""
    spec = mujoco.MjSpec.from_string(robot.mjcf)
    for slot, mesh in enumerate(bank.slot_mesh[scene]):
        if mesh < 0:
            continue
        name = f"bank/{mesh}"
        if spec.mesh(name) is None:
            corners = slice(bank.mesh_vertex_start[mesh], bank.mesh_vertex_start[mesh + 1])
            faces = bank.mesh_faces[bank.mesh_face_start[mesh] : bank.mesh_face_start[mesh + 1]]
            spec.add_mesh(
                name=name,
                uservert=bank.mesh_vertices[corners].ravel(),
                userface=faces.ravel(),
                inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL,
            )
        spec.worldbody.add_geom(
            name=f"slot/{slot}",
            type=mujoco.mjtGeom.mjGEOM_MESH,
            meshname=name,
            pos=bank.slot_position[scene, slot],
            quat=bank.slot_quaternion[scene, slot],
            contype=0,
            conaffinity=0,
            group=0,
        )
    model = spec.compile()
    names = [model.geom(i).name for i in range(model.ngeom)]
    slots = [int(name[5:]) if name.startswith("slot/") else -2 for name in names]
    return Street(model, mujoco.MjData(model), np.array(slots))


def place(street: Street, robot: RobotSpec, start: np.ndarray) -> None:
    """Puts the robot at (x, y, z of the ground, yaw)."""
    street.data.qpos[:] = street.model.qpos0
    street.data.qpos[:3] = [start[0], start[1], start[2] + robot.spawn_height]
    street.data.qpos[3:7] = [np.cos(start[3] / 2), 0.0, 0.0, np.sin(start[3] / 2)]
    mujoco.mj_kinematics(street.model, street.data)
    mujoco.mj_camlight(street.model, street.data)


def pixel_rays(fovy: float, height: int, width: int) -> np.ndarray:
    """(H, W, 3) rays through pixel centres in the camera's frame, scaled so that -z is 1."""
    half = np.tan(fovy / 2)
    y = (1 - (np.arange(height) + 0.5) / height * 2) * half
    x = ((np.arange(width) + 0.5) / width * 2 - 1) * half * width / height
    return np.stack([*np.meshgrid(x, y), -np.ones((height, width))], -1)


def cast(street: Street, camera: str, height: int, width: int) -> tuple[np.ndarray, np.ndarray]:
    """Planar depth (H, W), 0 = no hit, and slot (H, W), -1 = no hit, -2 = the robot, by `mj_ray`."""
    number = mujoco.mj_name2id(street.model, mujoco.mjtObj.mjOBJ_CAMERA, camera)
    rays = pixel_rays(np.radians(street.model.cam_fovy[number]), height, width)
    world = rays @ street.data.cam_xmat[number].reshape(3, 3).T
    depth, slot = np.zeros((height, width)), np.full((height, width), -1)
    geom = np.zeros(1, np.int32)
    for i, j in np.ndindex(height, width):
        direction = world[i, j] / np.linalg.norm(world[i, j])
        distance = mujoco.mj_ray(
            street.model, street.data, street.data.cam_xpos[number], direction, _SEEN, 1, -1, geom, None
        )
        if distance >= 0:
            depth[i, j] = distance / np.linalg.norm(rays[i, j])
            slot[i, j] = street.slot[geom[0]]
    return depth, slot


def is_free(street: Street, point: np.ndarray, direction: np.ndarray) -> bool:
    """Whether no visible geom is on the ray from `point` along `direction`."""
    return distance(street, point, direction) < 0


def distance(street: Street, point: np.ndarray, direction: np.ndarray) -> float:
    """m to the first visible geom on the ray from `point` along the unit vector `direction`; -1 if there is none."""
    geom = np.zeros(1, np.int32)
    return mujoco.mj_ray(street.model, street.data, point, direction, _SEEN, 1, -1, geom, None)
