"""Warp functions that draw a still street with one robot in it: nothing is copied per world but the robot's pose.

mujoco-warp-pbr hands some 80 arrays by value from function to function, for every ray; on a CPU that alone takes longer
than finding what the ray hits. Here a ray reads two records, of the slot and of the face it hit.
"""

# Kernels are Warp's language in Python's clothes; Warp itself checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

import warp as wp
from mujoco_warp._src.ray import ray_geom
from mujoco_warp_pbr._src import texture, traverse

wp.set_module_options({"enable_backward": False})

MESH = 7  # mujoco.mjtGeom.mjGEOM_MESH
#: Ray origins of shadows stand off the surface by this, m (as in MuJoCo Warp).
OFFSET = 1.0e-4
#: Deepest stack of the walk through the search tree (Warp's own has 32).
_DEPTH = 32
_Nodes = wp.types.vector(length=_DEPTH, dtype=int)
_Entries = wp.types.vector(length=_DEPTH, dtype=float)


@wp.struct
class Slot:
    """T_world_mesh of one visual slot; mesh: id; face: row of its mesh's first face; look: row; number: slot."""

    position: wp.vec3
    rotation: wp.mat33
    mesh: wp.uint64
    face: int
    look: int
    number: int
    category: int


@wp.struct
class Part:
    """One of the robot's visual geoms in its body's frame; kind: MuJoCo's geom type; radius around the centre."""

    position: wp.vec3
    rotation: wp.mat33
    centre: wp.vec3
    radius: float
    size: wp.vec3
    mesh: wp.uint64
    kind: int
    body: int
    face: int
    look: int


@wp.struct
class Face:
    """Corner normals and texture coordinates of a triangle; density: texture lengths per metre."""

    normal0: wp.vec3
    normal1: wp.vec3
    normal2: wp.vec3
    uv0: wp.vec2
    uv1: wp.vec2
    uv2: wp.vec2
    density: float


@wp.struct
class Look:
    """Linear colour of a material and its texture, -1 = none; texels along the longer side."""

    colour: wp.vec3
    texture: int
    texels: float


@wp.struct
class Light:
    """Sun and sky of a scene; sunlight: irradiance / pi; even: light where no sky is drawn."""

    sun: wp.vec3
    sunlight: wp.vec3
    even: wp.vec3
    sky: int
    yaw: float


@wp.struct
class Hit:
    """Nearest surface; index: row of the slots, or num_slots + part of the robot, -1 = none; face -1: no mesh."""

    distance: float
    normal: wp.vec3
    index: int
    face: int
    u: float
    v: float


@wp.func
def _entry(origin: wp.vec3, inverse: wp.vec3, lower: wp.vec3, upper: wp.vec3, limit: float) -> float:
    """Distance (>= 0) at which a ray enters a box, -1 = never or beyond the limit."""
    t1 = wp.cw_mul(lower - origin, inverse)
    t2 = wp.cw_mul(upper - origin, inverse)
    near = wp.max(wp.max(wp.min(t1[0], t2[0]), wp.min(t1[1], t2[1])), wp.min(t1[2], t2[2]))
    far = wp.min(wp.min(wp.max(t1[0], t2[0]), wp.max(t1[1], t2[1])), wp.max(t1[2], t2[2]))
    first = wp.max(near, 0.0)
    if far >= first and first < limit:
        return first
    return -1.0


@wp.func
def _meet_mesh(mesh: wp.uint64, origin: wp.vec3, direction: wp.vec3, limit: float) -> Hit:
    """Nearest surface of a mesh in the mesh's frame, from either side: leaves and paint have two faces in one place."""
    hit = Hit()
    hit.distance = limit
    hit.face = -1
    query = wp.mesh_query_ray(mesh, origin, direction, limit)
    if query.result:
        hit.distance = query.t
        hit.normal = query.normal
        hit.face = query.face
        hit.u = query.u
        hit.v = query.v
    return hit


@wp.func
def nearest_slot(
    tree: wp.uint64, root: int, slots: wp.array[Slot], origin: wp.vec3, direction: wp.vec3, limit: float
) -> Hit:
    """Nearest slot on a ray; the nearer child of a node is always looked into first."""
    best = Hit()
    best.distance = limit
    best.index = -1
    best.face = -1
    if root < 0:
        return best
    inverse = wp.vec3(1.0 / direction[0], 1.0 / direction[1], 1.0 / direction[2])
    nodes = _Nodes()
    entries = _Entries()
    nodes[0] = root
    count = int(1)  # noqa: RUF046, UP018
    while count > 0:
        count -= 1
        if entries[count] >= best.distance:
            continue
        node = wp.mjpbr_bvh_node(tree, nodes[count])
        if node.leaf == 0:
            left = wp.mjpbr_bvh_node(tree, node.left)
            right = wp.mjpbr_bvh_node(tree, node.right)
            at_left = _entry(origin, inverse, left.lower, left.upper, best.distance)
            at_right = _entry(origin, inverse, right.lower, right.upper, best.distance)
            near = node.left
            far = node.right
            at_near = at_left
            at_far = at_right
            if at_right >= 0.0 and (at_left < 0.0 or at_right < at_left):
                near = node.right
                far = node.left
                at_near = at_right
                at_far = at_left
            if at_far >= 0.0 and count < _DEPTH:
                nodes[count] = far
                entries[count] = at_far
                count += 1
            if at_near >= 0.0 and count < _DEPTH:
                nodes[count] = near
                entries[count] = at_near
                count += 1
            continue
        for k in range(node.left, node.right):
            index = wp.mjpbr_bvh_primitive(tree, k)
            slot = slots[index]
            back = wp.transpose(slot.rotation)
            hit = _meet_mesh(slot.mesh, back @ (origin - slot.position), back @ direction, best.distance)
            # Of surfaces in one place the later slot is seen: paint lies over ground.
            tie = hit.face >= 0 and best.index < index and hit.distance <= best.distance
            if hit.face >= 0 and (hit.distance < best.distance or tie):
                best = hit
                best.normal = slot.rotation @ hit.normal
                best.index = index
    return best


@wp.func
def any_slot(tree: wp.uint64, root: int, slots: wp.array[Slot], origin: wp.vec3, direction: wp.vec3) -> bool:
    """Whether any slot hides the far end of a ray."""
    query = wp.bvh_query_ray(tree, origin, direction, root)
    index = int(0)  # noqa: RUF046, UP018
    while wp.bvh_query_next(query, index):
        slot = slots[index]
        back = wp.transpose(slot.rotation)
        if wp.mesh_query_ray_anyhit(slot.mesh, back @ (origin - slot.position), back @ direction, 1.0e6):
            return True
    return False


@wp.func
def misses_ball(origin: wp.vec3, direction: wp.vec3, ball: wp.vec4) -> bool:
    """Whether a ray passes by a ball (centre, radius) or leads away from it."""
    to_centre = wp.vec3(ball[0], ball[1], ball[2]) - origin
    along = wp.dot(to_centre, direction)
    square = wp.length_sq(to_centre)
    inside = ball[3] * ball[3]
    return square - along * along > inside or (along < 0.0 and square > inside)


@wp.func
def nearest_part(
    parts: wp.array[Part],
    balls: wp.array2d[wp.vec4],
    position: wp.array2d[wp.vec3],
    rotation: wp.array2d[wp.mat33],
    world: int,
    first: int,
    origin: wp.vec3,
    direction: wp.vec3,
    best: Hit,
) -> Hit:
    """The robot's nearest visual geom, if it is nearer than `best`; its index counts on from `first`."""
    out = best
    for i in range(parts.shape[0]):
        if misses_ball(origin, direction, balls[world, i]):
            continue
        part = parts[i]
        turn = rotation[world, i]
        place = position[world, i]
        if part.kind == MESH:
            back = wp.transpose(turn)
            hit = _meet_mesh(part.mesh, back @ (origin - place), back @ direction, out.distance)
            if hit.face >= 0:
                out = hit
                out.normal = turn @ hit.normal
                out.index = first + i
        else:
            distance, normal = ray_geom(place, turn, part.size, origin, direction, part.kind)
            if distance >= 0.0 and distance < out.distance and wp.dot(direction, normal) < 0.0:
                out.distance = distance
                out.normal = normal
                out.index = first + i
                out.face = -1
    return out


@wp.func
def any_part(
    parts: wp.array[Part],
    balls: wp.array2d[wp.vec4],
    position: wp.array2d[wp.vec3],
    rotation: wp.array2d[wp.mat33],
    world: int,
    origin: wp.vec3,
    direction: wp.vec3,
) -> bool:
    """Whether the robot hides the far end of a ray."""
    for i in range(parts.shape[0]):
        if misses_ball(origin, direction, balls[world, i]):
            continue
        part = parts[i]
        turn = rotation[world, i]
        place = position[world, i]
        if part.kind == MESH:
            back = wp.transpose(turn)
            if wp.mesh_query_ray_anyhit(part.mesh, back @ (origin - place), back @ direction, 1.0e6):
                return True
        else:
            distance, _normal = ray_geom(place, turn, part.size, origin, direction, part.kind)
            if distance >= 0.0:
                return True
    return False


@wp.func
def corner_normal(face: Face, u: float, v: float) -> wp.vec3:
    """Normal between the corners, in the mesh's frame, not normalised."""
    return face.normal0 * u + face.normal1 * v + face.normal2 * (1.0 - u - v)


@wp.func
def texel(face: Face, look: Look, textures: wp.array[wp.Texture2D], u: float, v: float, cone: float) -> wp.vec3:
    """Linear colour of a material at a point of a face; cone: width of the ray on the surface, m."""
    uv = face.uv0 * u + face.uv1 * v + face.uv2 * (1.0 - u - v)
    lod = wp.log2(wp.max(cone * face.density * look.texels, 1.0e-8))
    colour = texture.sample(textures[look.texture], uv, lod)
    return wp.cw_mul(look.colour, wp.vec3(colour[0], colour[1], colour[2]))


@wp.kernel
def place_parts(
    parts: wp.array[Part],
    xpos: wp.array2d[wp.vec3],
    xquat: wp.array2d[wp.vec4],
    hidden: float,
    position: wp.array2d[wp.vec3],
    rotation: wp.array2d[wp.mat33],
    balls: wp.array2d[wp.vec4],
):
    """T_world_part of every part and a ball around each; the last ball is around all of them; dim worlds."""
    w = wp.tid()
    number = parts.shape[0]
    centre = wp.vec3(0.0)
    for i in range(number):
        part = parts[i]
        q = xquat[w, part.body]
        turn = wp.quat_to_matrix(wp.quat(q[1], q[2], q[3], q[0]))
        place = xpos[w, part.body] + turn @ part.position
        turn = turn @ part.rotation
        # A state that blew up: the robot goes where nobody looks.
        if not (wp.isfinite(place) and wp.isfinite(q)):
            place = wp.vec3(0.0, 0.0, hidden)
            turn = wp.identity(n=3, dtype=float)
        position[w, i] = place
        rotation[w, i] = turn
        middle = place + turn @ part.centre
        balls[w, i] = wp.vec4(middle[0], middle[1], middle[2], part.radius)
        centre += middle / float(number)
    radius = float(0.0)  # noqa: UP018
    for i in range(number):
        b = balls[w, i]
        radius = wp.max(radius, wp.length(wp.vec3(b[0], b[1], b[2]) - centre) + b[3])
    balls[w, number] = wp.vec4(centre[0], centre[1], centre[2], radius)


def module_options() -> dict[str, object]:
    """What a kernel that inlines these functions must be built with."""
    return {"enable_backward": False, "fast_math": True, "extra_build_options": traverse.BUILD_OPTIONS}
