"""First hits of neighbouring rays of a camera, found together: on a CPU, where a vector register holds many numbers.

Rays of 4x4 pixels walk through the street as one, wherever one of them has to go. Each keeps its own nearest hit, so
that they find what single rays find (`street_native`), but for rounding and surfaces at exactly the same distance.
"""

# Kernels are written in Warp's Python-embedded language; Warp checks their types when it compiles them.
# pyright: reportArgumentType=false, reportAssignmentType=false, reportAttributeAccessIssue=false, reportCallIssue=false
# pyright: reportGeneralTypeIssues=false, reportIndexIssue=false, reportOperatorIssue=false, reportReturnType=false
# pyright: reportInvalidTypeForm=false

import warp as wp

from . import street_kernels as k
from .street_kernels import Street, Views
from .street_native import BUILD_OPTIONS, Found

#: Pixels along each side of a packet, rays in it, and numbers of a hit.
SIDE, LANES, HIT = 4, 16, 5

_WALK = (
    f"""
namespace urbanverse {{ constexpr int SIDE = {SIDE}, LANES = {LANES}; }}
"""
    """
namespace urbanverse {

// A number of each ray, and whether something holds for it (all bits or none).
typedef float Many __attribute__((ext_vector_type(16)));
typedef int Which __attribute__((ext_vector_type(16)));
typedef bool Flags __attribute__((ext_vector_type(16)));

inline unsigned flags(Which which)
{
    return __builtin_bit_cast(unsigned short, __builtin_convertvector(which, Flags));
}

inline Many lesser(Many a, Many b) { return a < b ? a : b; }
inline Many larger(Many a, Many b) { return a > b ? a : b; }

// No ray enters a box here; finite, as these programs are compiled for finite numbers.
constexpr float FAR_AWAY = 1.0e30f;

// Rays from one place in the frame of what they are to meet; see `Ray`.
struct Rays {
    float ox, oy, oz;
    Many dx, dy, dz, ix, iy, iz, sx, sy, sz;

    inline void invert()
    {
        ix = inverse(dx), iy = inverse(dy), iz = inverse(dz);
        sx = -ox * ix, sy = -oy * iy, sz = -oz * iz;
    }

    static inline Many inverse(Many x)
    {
        const float tiny = 1.0e-8f;
        const Many kept = ((x > tiny) | (x < -tiny)) ? x : (x < 0.0f ? Many(-tiny) : Many(tiny));
        return 1.0f / kept;
    }

    // Those in the frame whose T_frame_world has the three rows from `row` on.
    inline void set(const Rays& w, const Row* row)
    {
        const Row x = load(row), y = load(row + 1), z = load(row + 2);
        ox = x.x * w.ox + x.y * w.oy + x.z * w.oz + x.w;
        oy = y.x * w.ox + y.y * w.oy + y.z * w.oz + y.w;
        oz = z.x * w.ox + z.y * w.oy + z.z * w.oz + z.w;
        dx = x.x * w.dx + x.y * w.dy + x.z * w.dz;
        dy = y.x * w.dx + y.y * w.dy + y.z * w.dz;
        dz = z.x * w.dx + z.y * w.dy + z.z * w.dz;
        invert();
    }
};

struct Nearest {
    Many distance, u, v;
    Which object, face;
};

// Which rays enter a box before their nearest hit, and where; elsewhere `at` is FAR_AWAY.
inline unsigned enter(const Rays& r, const Row& lower, const Row& upper, Many limit, Many& at)
{
    const Many x1 = lower.x * r.ix + r.sx, x2 = upper.x * r.ix + r.sx;
    const Many y1 = lower.y * r.iy + r.sy, y2 = upper.y * r.iy + r.sy;
    const Many z1 = lower.z * r.iz + r.sz, z2 = upper.z * r.iz + r.sz;
    const Many in = larger(larger(lesser(x1, x2), lesser(y1, y2)), larger(lesser(z1, z2), Many(0.0f)));
    const Many out = lesser(lesser(larger(x1, x2), larger(y1, y2)), lesser(larger(z1, z2), limit));
    const Which met = out >= in;
    at = met ? in : Many(FAR_AWAY);
    return flags(met);
}

// As `meet`, for all rays. They begin in one place, so that all but their directions is the same for them.
inline void meet_all(wp::uint64 triangles, const Rays& r, int face, int object, Nearest& found)
{
    const Row* row = from(triangles, 3 * face);
    for (bool last = false; !last; ++face, row += 3) {
        const Row p = load(row), e = load(row + 1), f = load(row + 2);
        last = p.w != 0.0f;
        const float cx = r.ox - p.x, cy = r.oy - p.y, cz = r.oz - p.z;
        const float bx = cy * e.z - cz * e.y, by = cz * e.x - cx * e.z, bz = cx * e.y - cy * e.x;
        const float along = f.x * bx + f.y * by + f.z * bz;
        const Many ax = r.dy * f.z - r.dz * f.y, ay = r.dz * f.x - r.dx * f.z, az = r.dx * f.y - r.dy * f.x;
        const Many volume = e.x * ax + e.y * ay + e.z * az;
        const Many scale = 1.0f / (volume == 0.0f ? Many(1.0e30f) : volume);
        const Many u = (cx * ax + cy * ay + cz * az) * scale;
        const Many v = (r.dx * bx + r.dy * by + r.dz * bz) * scale;
        const Many t = along * scale;
        const Which hit =
            (lesser(lesser(u, v), 1.0f - u - v) >= -1.0e-6f) & (t > 1.0e-12f) & (t < found.distance);
        if (flags(hit) == 0) continue;
        found.distance = hit ? t : found.distance;
        found.u = hit ? u : found.u;
        found.v = hit ? v : found.v;
        found.object = hit ? Which(object) : found.object;
        found.face = hit ? Which(face) : found.face;
    }
}

// Whether all rays pass by a ball or lead away from it.
inline bool all_miss(const Row& ball, const Rays& w)
{
    const float x = ball.x - w.ox, y = ball.y - w.oy, z = ball.z - w.oz;
    const float square = x * x + y * y + z * z, inside = ball.w * ball.w;
    if (square <= inside) return false;
    const Many along = x * w.dx + y * w.dy + z * w.dz;
    return flags((square - along * along <= inside) & (along >= 0.0f)) == 0;
}

// As `walk` for the nearest triangles.
template <bool MOVED>
inline void walk_all(const Tables& t, int root, const Rays& world, Nearest& found)
{
    struct Aside { Many at; int reference; } stack[64];
    Rays inner;
    const Rays* rays = &world;
    int object = -1, floor = 0, count = 0, listed = 0, current = root;
    while (true) {
        while (current < LEAF) {
            const Row* row = from(t.nodes, 4 * (current - NODE));
            const Row a = load(row), b = load(row + 1), e = load(row + 2), f = load(row + 3);
            Many at_first, at_second;
            const bool first = enter(*rays, a, b, found.distance, at_first) != 0;
            const bool second = enter(*rays, e, f, found.distance, at_second) != 0;
            bool to_first = first;
            if (first && second) {
                // Where most of them go first.
                const int nearer = __builtin_popcount(flags(at_first < at_second));
                to_first = nearer >= __builtin_popcount(flags(at_second < at_first));
                stack[count].reference = bits(to_first ? e.w : a.w);
                stack[count].at = to_first ? at_second : at_first;
                ++count;
            }
            current = first || second ? bits(to_first ? a.w : e.w) : EMPTY;
        }
        if (current < EMPTY && object < 0) {
            if (const Row* row = enter_object<MOVED>(t, current, object)) {
                floor = count;
                inner.set(world, row);
                rays = &inner;
                continue;
            }
        }
        if (current < EMPTY) {
            meet_all(t.triangles, *rays, current - LEAF, object, found);
            current = EMPTY;
        }
        while (current == EMPTY && count > 0) {
            if (object >= 0 && count == floor) {
                object = -1;
                rays = &world;
            }
            --count;
            if (flags(stack[count].at < found.distance) != 0) current = stack[count].reference;
        }
        while (current == EMPTY && listed < t.total) {
            const int part = t.list[listed];
            ++listed;
            if (all_miss(load(from(t.balls, part)), world)) continue;
            const int like = MOVED && part >= t.first ? t.moved[part - t.first] : t.objects + part;
            if (MOVED && like < 0) continue;
            object = t.objects + part;
            floor = 0;
            current = bits(load(from(t.entries, 4 * like + 3)).x);
            inner.set(world, from(t.poses, 3 * part));
            rays = &inner;
        }
        if (current == EMPTY) return;
    }
}

// The rays of a packet in an image of `columns` x `rows`; those beyond its edges meet nothing.
inline Rays aim(
    const wp::vec3& origin, const wp::vec3& right, const wp::vec3& up, const wp::vec3& back, int columns, int rows,
    int packet, float far, Nearest& found
)
{
    const int across = (columns + SIDE - 1) / SIDE;
    const int left = packet % across * SIDE, top = packet / across * SIDE;
    Many x, y, inside;
    for (int lane = 0; lane < LANES; ++lane) {
        const int column = left + lane % SIDE, row = top + lane / SIDE;
        x[lane] = (float(column) + 0.5f) * (2.0f / float(columns)) - 1.0f;
        y[lane] = 1.0f - (float(row) + 0.5f) * (2.0f / float(rows));
        inside[lane] = column < columns && row < rows ? 1.0f : 0.0f;
    }
    const Many ax = right[0] * x + up[0] * y - back[0], ay = right[1] * x + up[1] * y - back[1];
    const Many az = right[2] * x + up[2] * y - back[2];
    const Many length = __builtin_elementwise_sqrt(ax * ax + ay * ay + az * az);
    Rays rays;
    rays.ox = origin[0], rays.oy = origin[1], rays.oz = origin[2];
    rays.dx = ax / length, rays.dy = ay / length, rays.dz = az / length;
    rays.invert();
    found.distance = inside > 0.0f ? far * length : Many(-1.0f);
    found.u = found.v = Many(0.0f);
    found.object = found.face = Which(-1);
    return rays;
}

}  // namespace urbanverse
"""
)

_OPTIONS = wp.ModuleBuildOptions(extra_cpu_preamble=BUILD_OPTIONS.extra_cpu_preamble + _WALK)

_NEAREST = """
    const int* list = reinterpret_cast<const int*>(seen);
    const int* gone = reinterpret_cast<const int*>(moved);
    urbanverse::Nearest found;
    const urbanverse::Rays rays = urbanverse::aim(origin, right, up, back, columns, rows, packet, far, found);
    urbanverse::walk_all<MOVED>(
        { nodes, triangles, entries, poses, balls, list + 1, objects, list[0], gone, first, number }, root, rays,
        found
    );
    wp::int32* out = reinterpret_cast<wp::int32*>(hits);
    for (int lane = 0; lane < urbanverse::LANES; ++lane, out += 5) {
        out[0] = found.object[lane], out[1] = found.face[lane], out[2] = urbanverse::bits(found.distance[lane]);
        out[3] = urbanverse::bits(found.u[lane]), out[4] = urbanverse::bits(found.v[lane]);
    }
"""


@wp.func_native("""
    const wp::int32* row = reinterpret_cast<const wp::int32*>(hits) + 5LL * index;
    wp::vec_t<5, wp::int32> out;
    for (int i = 0; i < 5; ++i) out[i] = row[i];
    return out;
""")
def found_at(hits: wp.uint64, index: int) -> Found:
    """A hit that a packet has found."""


def num_packets(columns: int, rows: int) -> int:
    """Of an image of rays."""
    return -(-columns // SIDE) * -(-rows // SIDE)


@wp.func
def hit_index(columns: int, rows: int, image: int, column: int, row: int) -> int:
    """Where the hit of a ray stands that `build_cast_kernel`'s kernel found in its `image`-th world."""
    across = (columns + wp.static(SIDE - 1)) // SIDE
    packets = across * ((rows + wp.static(SIDE - 1)) // SIDE)
    packet = row // SIDE * across + column // SIDE
    return (image * packets + packet) * LANES + row % SIDE * SIDE + column % SIDE


def build_cast_kernel(moved: bool) -> wp.Kernel:
    """The kernel that finds the first hits of all rays of images, on a CPU; dim (worlds, packets).

    Args:
      moved: objects of the street may have moved.
    """

    @wp.func_native(_NEAREST.replace("MOVED", str(moved).lower()))
    def nearest_all(
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
        right: wp.vec3,
        up: wp.vec3,
        back: wp.vec3,
        columns: int,
        rows: int,
        packet: int,
        far: float,
        hits: wp.uint64,
    ):
        """Writes the hits of a packet."""

    @wp.kernel(
        module="unique",
        module_options={"enable_backward": False, "fast_math": True, "extra_build_options": _OPTIONS},
        enable_backward=False,
    )
    def cast(
        first: int,
        columns: int,
        rows: int,
        packets: int,
        far: float,
        street: Street,
        views: Views,
        scenes: wp.array[int],
        roots: wp.array[int],
        hits: wp.uint64,
    ):
        i, packet = wp.tid()
        world = first + i
        own = world * (street.num_parts + 1)
        nearest_all(
            street.nodes,
            street.triangles,
            street.entries,
            views.poses + wp.uint64(48 * world * street.num_parts),
            views.balls + wp.uint64(16 * own),
            views.seen + wp.uint64(4 * own),
            views.moved + wp.uint64(4 * world * street.num_bodies),
            street.num_objects,
            street.num_parts - street.num_bodies,
            street.num_bodies,
            roots[scenes[world]],
            k.xyz(k.load(views.cameras, 4 * world)),
            k.xyz(k.load(views.cameras, 4 * world + 1)),
            k.xyz(k.load(views.cameras, 4 * world + 2)),
            k.xyz(k.load(views.cameras, 4 * world + 3)),
            columns,
            rows,
            packet,
            far,
            hits + wp.uint64(wp.static(4 * HIT * LANES)) * wp.uint64(i * packets + packet),
        )

    return cast
