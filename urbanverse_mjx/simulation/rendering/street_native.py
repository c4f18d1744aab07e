"""The walk of a ray through a street in C++, for both compilers that Warp feeds: clang on the CPU, NVRTC for CUDA.

It is the one part of the renderer that is not written in Warp's own language, which copies whole structs and arrays at
every branch and call of a loop (a tenth to a fifth of all frames on a CPU).
"""

# Warp's types in annotations are values; Warp itself checks them.
# pyright: reportGeneralTypeIssues=false, reportInvalidTypeForm=false, reportReturnType=false

from typing import Any

import warp as wp

from . import street_light_native
from .street_tree import EMPTY, LEAF, NODE

_NUMBERS = f"namespace urbanverse {{ constexpr int NODE = {NODE}, LEAF = {LEAF}, EMPTY = {EMPTY}; }}"
_WALK = """
namespace urbanverse {

struct Row { float x, y, z, w; };

// Rows of a table from one on: neighbours are read relative to the same address.
CUDA_CALLABLE inline const Row* from(wp::uint64 table, int row) { return reinterpret_cast<const Row*>(table) + row; }

CUDA_CALLABLE inline Row load(const Row* row)
{
#if defined(__CUDA_ARCH__)
    const float4 r = __ldg(reinterpret_cast<const float4*>(row));
    return { r.x, r.y, r.z, r.w };
#else
    return *row;
#endif
}

CUDA_CALLABLE inline int bits(float x)
{
#if defined(__CUDA_ARCH__)
    return __float_as_int(x);
#else
    int i;
    __builtin_memcpy(&i, &x, 4);
    return i;
#endif
}

// One instruction each: CUDA has one for fminf, a CPU for the comparison.
#if defined(__CUDA_ARCH__)
CUDA_CALLABLE inline float lesser(float a, float b) { return fminf(a, b); }
CUDA_CALLABLE inline float larger(float a, float b) { return fmaxf(a, b); }
#else
CUDA_CALLABLE inline float lesser(float a, float b) { return a < b ? a : b; }
CUDA_CALLABLE inline float larger(float a, float b) { return a > b ? a : b; }
#endif

// 1 / x, finite: what is smaller turns a ray by less than its own rounding.
CUDA_CALLABLE inline float inverse(float x)
{
    const float tiny = 1.0e-8f;
    return 1.0f / (x > tiny || x < -tiny ? x : (x < 0.0f ? -tiny : tiny));
}

struct Line { float ox, oy, oz, dx, dy, dz; };

// A ray in the frame of what it is to meet; i: 1 / direction, s: -origin / direction.
struct Ray : Line {
    float ix, iy, iz, sx, sy, sz;

    CUDA_CALLABLE inline void set(const Line& line)
    {
        ox = line.ox, oy = line.oy, oz = line.oz, dx = line.dx, dy = line.dy, dz = line.dz;
        ix = inverse(dx), iy = inverse(dy), iz = inverse(dz);
        sx = -ox * ix, sy = -oy * iy, sz = -oz * iz;
    }

    // The line in the frame whose T_frame_world has the three rows from `row` on.
    CUDA_CALLABLE inline void set(const Line& w, const Row* row)
    {
        const Row x = load(row), y = load(row + 1), z = load(row + 2);
        set({
            x.x * w.ox + x.y * w.oy + x.z * w.oz + x.w, y.x * w.ox + y.y * w.oy + y.z * w.oz + y.w,
            z.x * w.ox + z.y * w.oy + z.z * w.oz + z.w, x.x * w.dx + x.y * w.dy + x.z * w.dz,
            y.x * w.dx + y.y * w.dy + y.z * w.dz, z.x * w.dx + z.y * w.dy + z.z * w.dz
        });
    }
};

// Where a ray enters a box (at >= 0, before the limit).
CUDA_CALLABLE inline bool enters(const Ray& r, const Row& lower, const Row& upper, float limit, float& at)
{
    const float x1 = lower.x * r.ix + r.sx, x2 = upper.x * r.ix + r.sx;
    const float y1 = lower.y * r.iy + r.sy, y2 = upper.y * r.iy + r.sy;
    const float z1 = lower.z * r.iz + r.sz, z2 = upper.z * r.iz + r.sz;
    at = larger(larger(lesser(x1, x2), lesser(y1, y2)), larger(lesser(z1, z2), 0.0f));
    return lesser(lesser(larger(x1, x2), larger(y1, y2)), lesser(larger(z1, z2), limit)) >= at;
}

struct Found { float distance, u, v; int object, face; };

// Nearest of a leaf's triangles, from either side: leaves of trees and paint have two faces in one place. They grow by
// a millionth, so that no ray passes between two of them. Of a triangle seen edge on t is 0 but for rounding (1e-30),
// which is no hit.
template <bool ANY>
CUDA_CALLABLE inline void meet(wp::uint64 triangles, const Ray& r, int face, int object, Found& found)
{
    const Row* row = from(triangles, 3 * face);
    for (bool last = false; !last; ++face, row += 3) {
        const Row p = load(row), e = load(row + 1), f = load(row + 2);
        last = p.w != 0.0f;
        const float ax = r.dy * f.z - r.dz * f.y, ay = r.dz * f.x - r.dx * f.z, az = r.dx * f.y - r.dy * f.x;
        const float volume = e.x * ax + e.y * ay + e.z * az;
        const float scale = 1.0f / (volume == 0.0f ? 1.0e30f : volume);
        const float cx = r.ox - p.x, cy = r.oy - p.y, cz = r.oz - p.z;
        const float u = (cx * ax + cy * ay + cz * az) * scale;
        const float bx = cy * e.z - cz * e.y, by = cz * e.x - cx * e.z, bz = cx * e.y - cy * e.x;
        const float v = (r.dx * bx + r.dy * by + r.dz * bz) * scale;
        const float t = (f.x * bx + f.y * by + f.z * bz) * scale;
        if (lesser(lesser(u, v), 1.0f - u - v) >= -1.0e-6f && t > 1.0e-12f && t < found.distance) {
            found.distance = t, found.u = u, found.v = v, found.object = object, found.face = face;
            if (ANY) return;
        }
    }
}

// Whether a line passes by a ball (centre, radius) or leads away from it.
CUDA_CALLABLE inline bool misses(const Row& ball, const Line& w)
{
    const float x = ball.x - w.ox, y = ball.y - w.oy, z = ball.z - w.oz;
    const float along = x * w.dx + y * w.dy + z * w.dz, square = x * x + y * y + z * z, inside = ball.w * ball.w;
    return square - along * along > inside || (along < 0.0f && square > inside);
}

// Tables (see street_kernels.py), and the parts of the robot to be looked at: the first `total` of a list, or all.
struct Tables {
    wp::uint64 nodes, triangles, entries, poses, balls;
    const int* list;
    int objects, total;
    // Objects of the street that stand elsewhere in this world: those of the parts from `first` on, -1 = none.
    const int* moved;
    int first, number;
};

CUDA_CALLABLE inline bool has_moved(const Tables& t, int object)
{
    for (int i = 0; i < t.number; ++i)
        if (t.moved[i] == object) return true;
    return false;
}

// Goes on from the entry that `current` names to its object's tree, and returns the rows of the object's pose; null if
// the object stands elsewhere. MOVED: some objects of the street may.
template <bool MOVED>
CUDA_CALLABLE inline const Row* enter_object(const Tables& t, int& current, int& object)
{
    const Row* row = from(t.entries, 4 * (current - LEAF));
    const Row entry = load(row + 3);
    if (MOVED && has_moved(t, bits(entry.y) - LEAF)) {
        current = EMPTY;
        return nullptr;
    }
    object = bits(entry.y) - LEAF;
    current = bits(entry.x);
    return row;
}

// The nearest triangle (ANY: some triangle) of the street below `root`, then of the listed parts of the robot.
// MOVED: some objects of the street may stand elsewhere.
template <bool ANY, bool MOVED>
CUDA_CALLABLE inline void walk(const Tables& t, int root, const Line& world, Found& found)
{
    // Warp builds no tree deeper than 32, and here one leads on into another.
    struct alignas(8) Aside { int reference; float at; } stack[64];
    Ray ray;
    ray.set(world);
    // The object that is being looked into, and how much of the stack lies below it.
    int object = -1, floor = 0, count = 0, listed = 0, current = root;
    while (true) {
        while (current < LEAF) {
            const Row* row = from(t.nodes, 4 * (current - NODE));
            const Row a = load(row), b = load(row + 1), e = load(row + 2), f = load(row + 3);
            float at_first, at_second;
            const bool first = enters(ray, a, b, found.distance, at_first);
            const bool second = enters(ray, e, f, found.distance, at_second);
            const bool to_first = first && !(second && at_second < at_first);
            if (first && second) {
                stack[count].reference = bits(to_first ? e.w : a.w);
                stack[count].at = to_first ? at_second : at_first;
                ++count;
            }
            current = first || second ? bits(to_first ? a.w : e.w) : EMPTY;
        }
        if (current < EMPTY && object < 0) {
            if (const Row* row = enter_object<MOVED>(t, current, object)) {
                floor = count;
                ray.set(world, row);
                continue;
            }
        }
        if (current < EMPTY) {
            meet<ANY>(t.triangles, ray, current - LEAF, object, found);
            if (ANY && found.object >= 0) return;
            current = EMPTY;
        }
        // Nothing below: back to the nearest box that was left aside.
        while (current == EMPTY && count > 0) {
            if (object >= 0 && count == floor) {
                object = -1;
                ray.set(world);
            }
            --count;
            if (stack[count].at < found.distance) current = stack[count].reference;
        }
        while (current == EMPTY && listed < t.total) {
            const int part = ANY ? listed : t.list[listed];
            ++listed;
            if (misses(load(from(t.balls, part)), world)) continue;
            const int like = MOVED && part >= t.first ? t.moved[part - t.first] : t.objects + part;
            if (MOVED && like < 0) continue;
            object = t.objects + part;
            floor = 0;
            current = bits(load(from(t.entries, 4 * like + 3)).x);
            ray.set(world, from(t.poses, 3 * part));
        }
        if (current == EMPTY) return;
    }
}

}  // namespace urbanverse
"""

_PREAMBLE = _NUMBERS + _WALK + street_light_native.PREAMBLE
#: Build options of a kernel that calls functions of `make_walks`.
BUILD_OPTIONS = wp.ModuleBuildOptions(extra_cuda_preamble=_PREAMBLE, extra_cpu_preamble=_PREAMBLE)

#: object, face (row numbers, -1 = none), and the bits of distance, u and v (of a triangle's second and third corner).
Found = wp.types.vector(length=5, dtype=wp.int32)


@wp.func_native("""
    const urbanverse::Row r = urbanverse::load(urbanverse::from(table, row));
    return wp::vec_t<4, wp::float32>(r.x, r.y, r.z, r.w);
""")
def load(table: wp.uint64, row: int) -> wp.vec4:
    """A row of a table in one 16-byte load."""


@wp.struct
class Hit:
    """Nearest surface; object_row: row number, -1 = none; face: row number; u, v: of its second and third corner."""

    distance: float
    object_row: int
    face: int
    u: float
    v: float


@wp.func
def as_hit(found: Found) -> Hit:
    hit = Hit()
    hit.object_row = found[0]
    hit.face = found[1]
    hit.distance = wp.cast(found[2], wp.float32)
    hit.u = wp.cast(found[3], wp.float32)
    hit.v = wp.cast(found[4], wp.float32)
    return hit


_LINE = """
    const int* gone = reinterpret_cast<const int*>(moved);
    const urbanverse::Line line = { origin[0], origin[1], origin[2], direction[0], direction[1], direction[2] };
"""
_NEAREST = """
    const int* list = reinterpret_cast<const int*>(seen);
    urbanverse::Found found = { limit, 0.0f, 0.0f, -1, -1 };
    urbanverse::walk<false, MOVED>(
        { nodes, triangles, entries, poses, balls, list + 1, objects, list[0], gone, first, number }, root, line,
        found
    );
    wp::vec_t<5, wp::int32> out;
    out[0] = found.object, out[1] = found.face, out[2] = urbanverse::bits(found.distance);
    out[3] = urbanverse::bits(found.u), out[4] = urbanverse::bits(found.v);
    return out;
"""
_ANY_HIT = """
    urbanverse::Found found = { 1.0e6f, 0.0f, 0.0f, -1, -1 };
    const urbanverse::Row around = urbanverse::load(urbanverse::from(balls, parts));
    const int total = parts == 0 || urbanverse::misses(around, line) ? 0 : parts;
    urbanverse::walk<true, MOVED>(
        { nodes, triangles, entries, poses, balls, nullptr, objects, total, gone, first, number }, root, line, found
    );
    return found.object >= 0;
"""


def make_walks(moved: bool) -> tuple[Any, Any]:
    """`nearest` and `any_hit` for streets in which objects stand where the bank has them, or (moved) may not.

    Such objects are the `number` parts from `first` on; moved (of this world): which object each is. Where there are
    none the compilers remove this code.
    """

    of_moved = str(moved).lower()

    # Warp names functions in C++ by the decorator's name.
    @wp.func_native((_LINE + _NEAREST).replace("MOVED", of_moved))
    def nearest(
        nodes: wp.uint64,
        triangles: wp.uint64,
        entries: wp.uint64,
        poses: wp.uint64,
        balls: wp.uint64,
        seen: wp.uint64,
        moved: wp.uint64,
        objects: int,
        first: int,
        number: int,
        root: int,
        origin: wp.vec3,
        direction: wp.vec3,
        limit: float,
    ) -> Found:
        """The nearest triangle on a ray; poses, balls and seen: of this world."""

    @wp.func_native((_LINE + _ANY_HIT).replace("MOVED", of_moved))
    def any_hit(
        nodes: wp.uint64,
        triangles: wp.uint64,
        entries: wp.uint64,
        poses: wp.uint64,
        balls: wp.uint64,
        moved: wp.uint64,
        objects: int,
        first: int,
        number: int,
        parts: int,
        root: int,
        origin: wp.vec3,
        direction: wp.vec3,
    ) -> bool:
        """Whether a ray meets any triangle."""

    return nearest, any_hit
