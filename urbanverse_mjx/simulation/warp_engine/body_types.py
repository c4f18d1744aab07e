"""Structs that the kernels of `bodies` read and write."""

import warp as wp


@wp.struct
class BodyTable:
    """`body_table.BodyTable` on the device; turn: quaternions wxyz of the principal axes in the frame of the object."""

    shape: wp.array[int]
    mass: wp.array[float]
    friction: wp.array[float]
    centre: wp.array[wp.vec3]
    inertia: wp.array[wp.vec3]
    turn: wp.array[wp.vec4]
    radius: wp.array[float]
    hull: wp.array2d[int]
    points: wp.array2d[wp.vec3]


@wp.struct
class Bodies:
    """W bodies that are awake in each of n worlds.

    row (n, W): of the body table, -1 = empty; near_* (n, W, T): ground prisms, then static hulls near each, about the
    worlds' origins; position, rotation (n, W): T_world_object; ground_*, other_* and point (n, W, P): where each point
    of a body is and how deep in what; invweight (n, bodies of the model): what MuJoCo Warp takes for 1 / kg.
    first_qpos, first_dof, first_body, first_geom: of the first body in MuJoCo's model; first_slot: of its first hull;
    ground: the geom that stands for all that does not move; least: see `contact.Slots`.
    """

    row: wp.array2d[int]
    near_row: wp.array2d[int]
    near_distance: wp.array2d[float]
    near_hull: wp.array3d[int]
    near_position: wp.array3d[wp.vec3]
    near_rotation: wp.array3d[wp.mat33]
    near_friction: wp.array3d[float]
    position: wp.array2d[wp.vec3]
    rotation: wp.array2d[wp.mat33]
    point: wp.array3d[wp.vec3]
    ground_depth: wp.array3d[float]
    ground_normal: wp.array3d[wp.vec3]
    ground_friction: wp.array3d[float]
    other_depth: wp.array3d[float]
    other_normal: wp.array3d[wp.vec3]
    other_friction: wp.array3d[float]
    other_geom: wp.array3d[int]
    invweight: wp.array2d[wp.vec2]
    first_qpos: int
    first_dof: int
    first_body: int
    first_geom: int
    first_slot: int
    ground: int
    least: int
