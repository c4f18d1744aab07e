"""Warp kernels that fill a render context from the scene tables and unpack its image."""

# Kernels are written in Warp's subset of Python; Warp checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

import warp as wp

from urbanverse_mjx.simulation.rendering.settings import NOWHERE

_NOWHERE = wp.constant(NOWHERE)

wp.set_module_options({"enable_backward": False, "fast_math": False})


@wp.struct
class SceneTables:
    """Every scene of the bank on the device; Z scenes, N slots.

    position, lower, upper, rotation, mesh, material, roughness, metallic: (Z, N) per slot;
    sun_direction, sun_irradiance, ambient, sky, sky_yaw: (Z,) per scene.
    """

    position: wp.array2d[wp.vec3]
    rotation: wp.array2d[wp.mat33]
    lower: wp.array2d[wp.vec3]
    upper: wp.array2d[wp.vec3]
    mesh: wp.array2d[int]
    material: wp.array2d[int]
    roughness: wp.array2d[float]
    metallic: wp.array2d[float]
    sun_direction: wp.array[wp.vec3]
    sun_irradiance: wp.array[wp.vec3]
    ambient: wp.array[wp.vec3]
    sky: wp.array[int]
    sky_yaw: wp.array[float]


@wp.struct
class RobotTables:
    """T_body_geom, and the box around each of the robot's R visual geoms in the geom's frame."""

    body: wp.array[int]
    position: wp.array[wp.vec3]
    rotation: wp.array[wp.mat33]
    centre: wp.array[wp.vec3]
    half: wp.array[wp.vec3]


@wp.struct
class Worlds:
    """Inputs of a render context, per world and geom or per world and light."""

    geom_xpos: wp.array2d[wp.vec3]
    geom_xmat: wp.array2d[wp.mat33]
    geom_dataid: wp.array2d[int]
    geom_matid: wp.array2d[int]
    geom_roughness: wp.array2d[float]
    geom_metallic: wp.array2d[float]
    lower: wp.array[wp.vec3]
    upper: wp.array[wp.vec3]
    group: wp.array[int]
    light_xdir: wp.array2d[wp.vec3]
    light_diffuse: wp.array2d[wp.vec3]
    ambient: wp.array[wp.vec3]
    env_id: wp.array[int]
    env_yaw: wp.array[float]
    cam_xpos: wp.array2d[wp.vec3]
    cam_xmat: wp.array2d[wp.mat33]
    cam_fovy: wp.array2d[float]
    ngeom: int


@wp.kernel
def place_slots(tables: SceneTables, scene: wp.array[int], current: wp.array[int], worlds: Worlds):
    """Puts the objects of scene[w] into world w where current[w] is another scene; dim (worlds, N)."""
    w, slot = wp.tid()
    z = scene[w]
    if current[w] == z:
        return
    worlds.geom_xpos[w, slot] = tables.position[z, slot]
    worlds.geom_xmat[w, slot] = tables.rotation[z, slot]
    worlds.geom_dataid[w, slot] = tables.mesh[z, slot]
    worlds.geom_matid[w, slot] = tables.material[z, slot]
    worlds.geom_roughness[w, slot] = tables.roughness[z, slot]
    worlds.geom_metallic[w, slot] = tables.metallic[z, slot]
    worlds.lower[w * worlds.ngeom + slot] = tables.lower[z, slot]
    worlds.upper[w * worlds.ngeom + slot] = tables.upper[z, slot]
    worlds.group[w * worlds.ngeom + slot] = w


@wp.kernel
def place_light(tables: SceneTables, scene: wp.array[int], current: wp.array[int], worlds: Worlds):
    """Sun and sky of scene[w], after `place_slots`; remembers the scene in current[w]; dim worlds."""
    w = wp.tid()
    z = scene[w]
    if current[w] == z:
        return
    current[w] = z
    worlds.light_xdir[w, 0] = -tables.sun_direction[z]
    worlds.light_diffuse[w, 0] = tables.sun_irradiance[z]
    worlds.ambient[w] = tables.ambient[z]
    worlds.env_id[w] = tables.sky[z]
    worlds.env_yaw[w] = tables.sky_yaw[z]


@wp.func
def _matrix(q: wp.vec4) -> wp.mat33:
    """Rotation of a unit quaternion wxyz."""
    return wp.quat_to_matrix(wp.quat(q[1], q[2], q[3], q[0]))


@wp.kernel
def place_robot(tables: RobotTables, xpos: wp.array2d[wp.vec3], xquat: wp.array2d[wp.vec4], first: int, worlds: Worlds):
    """Puts the robot's visual geoms at its bodies' poses; `first` is their first geom; dim (worlds, R)."""
    w, i = wp.tid()
    body = tables.body[i]
    turn = _matrix(xquat[w, body])
    position = xpos[w, body] + turn @ tables.position[i]
    rotation = turn @ tables.rotation[i]
    # A non-finite state must not reach the search tree, so the robot is placed far outside the view.
    if not (wp.isfinite(position) and wp.isfinite(xquat[w, body])):
        position = wp.vec3(0.0, 0.0, _NOWHERE)
        rotation = wp.identity(n=3, dtype=float)
    geom = first + i
    worlds.geom_xpos[w, geom] = position
    worlds.geom_xmat[w, geom] = rotation
    half = tables.half[i]
    reach = wp.vec3(0.0)
    for row in range(3):
        reach[row] = (
            wp.abs(rotation[row, 0]) * half[0] + wp.abs(rotation[row, 1]) * half[1] + wp.abs(rotation[row, 2]) * half[2]
        )
    centre = position + rotation @ tables.centre[i]
    worlds.lower[w * worlds.ngeom + geom] = centre - reach
    worlds.upper[w * worlds.ngeom + geom] = centre + reach
    worlds.group[w * worlds.ngeom + geom] = w


@wp.kernel
def place_camera(position: wp.array[wp.vec3], quaternion: wp.array[wp.vec4], fovy: wp.array[float], worlds: Worlds):
    """T_world_camera and vertical field of view (rad) of each world's camera; dim worlds."""
    w = wp.tid()
    sound = wp.isfinite(position[w]) and wp.isfinite(quaternion[w])
    worlds.cam_xpos[w, 0] = wp.where(sound, position[w], wp.vec3(0.0, 0.0, _NOWHERE))
    worlds.cam_xmat[w, 0] = wp.where(sound, _matrix(quaternion[w]), wp.identity(n=3, dtype=float))
    worlds.cam_fovy[w, 0] = fovy[w] * (180.0 / wp.pi)


@wp.kernel
def unpack_colour(packed: wp.array2d[wp.uint32], rgb: wp.array4d[wp.uint8]):
    """0xAARRGGBB words to bytes; dim (worlds, pixels)."""
    w, pixel = wp.tid()
    word = packed[w, pixel]
    row = pixel // rgb.shape[2]
    column = pixel % rgb.shape[2]
    rgb[w, row, column, 0] = wp.uint8((word >> wp.uint32(16)) & wp.uint32(255))
    rgb[w, row, column, 1] = wp.uint8((word >> wp.uint32(8)) & wp.uint32(255))
    rgb[w, row, column, 2] = wp.uint8(word & wp.uint32(255))
