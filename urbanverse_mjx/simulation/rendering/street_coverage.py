"""How many pixels each object in an image would have if it were the only one: the measure of what others hide of it.

The rays are those of the image, cast anew for every object that it shows, into the object's own tree alone.
"""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false

import numpy as np
import warp as wp

from . import street_kernels as k
from .settings import AGENT_LABEL, Settings
from .street_kernels import Street, Views
from .street_native import make_walks
from .street_tree import EMPTY, LEAF

#: m, and share, by which the balls around objects are larger.
_SLACK = 1.0e-3


@wp.struct
class Columns:
    """What the columns of the counts are: the slots of the scene, then the agents.

    object_of_slot: (Z, N), -1 = empty. ground: 1 where an object is ground, which is not counted. agent_part: number of
    the moving part that each agent is. lists: two numbers for each part, 1 and the part; then a zero.
    """

    object_of_slot: wp.array2d[int]
    ground: wp.array[int]
    agent_part: wp.array[int]
    lists: wp.uint64


def make_columns(
    object_of_slot: wp.array, is_ground: np.ndarray, labels: np.ndarray, num_parts: int
) -> tuple[Columns, wp.array]:
    """The columns of a bank's streets, and an array that must live as long as they do.

    Args:
      is_ground: (objects) bool. labels: (R, 2) "object" and "category" of the moving geoms.
      num_parts: moving geoms and bodies.
    """
    columns = Columns()
    columns.object_of_slot, columns.ground = object_of_slot, wp.array(is_ground.astype(np.int32), dtype=int)
    agents = np.flatnonzero(labels[:, 0] <= AGENT_LABEL)
    agents = agents[np.argsort(-labels[agents, 0])]
    columns.agent_part = wp.array(agents.astype(np.int32), dtype=int)
    lists = np.stack([np.ones(num_parts), np.arange(num_parts)], 1).ravel()
    table = wp.array(np.append(lists, 0).astype(np.int32), dtype=int)
    columns.lists = table.ptr or 0
    return columns, table


@wp.kernel(module="unique", enable_backward=False)
def clear(first: int, shown: wp.array2d[int], coverage: wp.array2d[int]):
    """Empties the counts; dim (worlds, columns)."""
    i, column = wp.tid()
    shown[first + i, column] = 0
    coverage[first + i, column] = 0


@wp.kernel(module="unique", enable_backward=False)
def find_shown(first: int, slots: int, object: wp.array3d[int], shown: wp.array2d[int]):
    """Notes which objects the image shows; dim (worlds, height, width)."""
    i, row, column = wp.tid()
    label = object[first + i, row, column]
    if label >= 0:
        shown[first + i, label] = 1
    elif label <= wp.static(AGENT_LABEL):
        shown[first + i, slots + wp.static(AGENT_LABEL) - label] = 1


@wp.func
def found_at(street: Street, views: Views, columns: Columns, world: int, scene: int, column: int) -> wp.vec2i:
    """Part and object of a column, each -1 where it is none: a moving part, an object in its place, or ground."""
    slots = columns.object_of_slot.shape[1]
    if column >= slots:
        return wp.vec2i(columns.agent_part[column - slots], -1)
    obj = columns.object_of_slot[scene, column]
    if columns.ground[obj] == 1:
        return wp.vec2i(-1, -1)
    for body in range(street.num_bodies):
        if k.number_at(views.moved, world * street.num_bodies + body) == obj:
            return wp.vec2i(street.num_parts - street.num_bodies + body, -1)
    return wp.vec2i(-1, obj)


@wp.func
def ball_around(street: Street, views: Views, world: int, part: int, obj: int, origin: wp.vec3) -> wp.vec4:
    """Centre, relative to a place, and radius of a ball around a part or an object."""
    if obj < 0:
        ball = k.load(views.balls, world * (street.num_parts + 1) + part)
        offset = k.xyz(ball) - origin
        return wp.vec4(offset[0], offset[1], offset[2], ball[3])
    ball = k.load(street.balls, obj)
    offset = wp.vec3(0.0)
    for axis in range(3):
        row = k.load(street.object_rows, wp.static(k.OBJECT) * obj + axis)
        offset += k.xyz(row) * (ball[axis] - wp.dot(k.xyz(row), origin) - row[3])
    return wp.vec4(offset[0], offset[1], offset[2], ball[3])


def build_count_kernel(settings: Settings, far: float) -> wp.Kernel:
    """The kernel that counts pixels; dim (worlds, columns, height).

    far: m, end of all rays.
    """
    height, width, samples = settings.height, settings.width, settings.samples
    nearest, _ = make_walks(settings.bodies > 0)

    @wp.kernel(module="unique", module_options=k.module_options(), enable_backward=False)
    def count(
        first: int,
        street: Street,
        views: Views,
        columns: Columns,
        scenes: wp.array[int],
        shown: wp.array2d[int],
        coverage: wp.array2d[int],
    ):
        i, column, py = wp.tid()
        world = first + i
        if shown[world, column] == 0:
            return
        found = found_at(street, views, columns, world, scenes[world], column)
        part = found[0]
        obj = found[1]
        if part < 0 and obj < 0:
            return
        # Either the object's own tree, or nothing and then the part; the list of no part is the zero at the end.
        root = wp.where(obj >= 0, wp.static(LEAF) + obj, wp.static(EMPTY))
        listed = 2 * wp.where(obj >= 0, street.num_parts, part)
        origin = k.xyz(k.load(views.cameras, 4 * world))
        right = k.xyz(k.load(views.cameras, 4 * world + 1))
        up = k.xyz(k.load(views.cameras, 4 * world + 2))
        back = k.xyz(k.load(views.cameras, 4 * world + 3))
        ball = ball_around(street, views, world, part, obj, origin)
        offset = k.xyz(ball)
        radius = ball[3] * wp.static(1.0 + _SLACK) + wp.static(_SLACK)
        middle = up * (1.0 - (float(py * samples) + 0.5) * wp.static(2.0 / (samples * height))) - back
        # The rays of a row are in a plane.
        if wp.abs(wp.dot(offset, wp.normalize(wp.cross(right, middle)))) > radius:
            return
        square = wp.dot(offset, offset)
        inside = radius * radius
        total = int(0)  # noqa: RUF046, UP018 (Warp takes a bare number for a constant)
        for px in range(width):
            x = (float(px * samples) + 0.5) * wp.static(2.0 / (samples * width)) - 1.0
            ahead = right * x + middle
            length = wp.length(ahead)
            along = wp.dot(offset, ahead) / length
            if square <= inside or (along > 0.0 and square - along * along <= inside):
                hit = nearest(
                    street.nodes,
                    street.triangles,
                    street.entries,
                    views.poses + wp.uint64(48 * world * street.num_parts),
                    views.balls + wp.uint64(16 * world * (street.num_parts + 1)),
                    columns.lists + wp.uint64(4 * listed),
                    views.moved + wp.uint64(4 * world * street.num_bodies),
                    street.num_objects,
                    street.num_parts - street.num_bodies,
                    street.num_bodies,
                    root,
                    origin,
                    ahead / length,
                    wp.static(far) * length,
                )
                total += wp.where(hit[0] >= 0, 1, 0)
        wp.atomic_add(coverage, world, column, total)

    return count
