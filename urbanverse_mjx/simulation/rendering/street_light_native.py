"""The lookups of baked light in C++, for both compilers that Warp feeds (see `street_native`)."""

#: m, side of a texel of the ground's map, and of a cell of the grid.
TEXEL, CELL = 0.125, 1.0
#: Rows of a scene: lower corner of the ground's map, exposure, thousands of cells before its first; size of the map,
#: thousands of texels before its first and the rest; lower corner of the grid; its size, and the rest of the cells.
SHEET = 4
THOUSAND = 1024.0
#: Bytes of a cell: sun, mean of the light around, and its gradient along x, y and z, each with a sign.
CELL_BYTES = 8
#: Where off a surface its light is read, in cells: nearer, the grid would mix what lies behind the surface.
STAND_OFF = 0.75

_LIGHT = """
namespace urbanverse {

CUDA_CALLABLE inline float clamped(float x, float most) { return lesser(larger(x, 0.0f), most); }

struct Texel { unsigned char sun, sky; };

// Sun and sky of the ground at a place: bilinear between the centres of four texels.
CUDA_CALLABLE inline void ground_light(wp::uint64 sheet, wp::uint64 texels, float x, float y, float& sun, float& sky)
{
    const Row a = load(from(sheet, 0)), b = load(from(sheet, 1));
    const float u = clamped((x - a.x) * TEXELS - 0.5f, b.x - 1.0f), v = clamped((y - a.y) * TEXELS - 0.5f, b.y - 1.0f);
    const int i = int(lesser(u, b.x - 2.0f)), j = int(lesser(v, b.y - 2.0f)), width = int(b.y);
    const float s = u - float(i), t = v - float(j);
    const long long first = (long long)b.z * THOUSAND + (long long)b.w;
    const Texel* at = reinterpret_cast<const Texel*>(texels) + first + (long long)i * width + j;
    const Texel p = at[0], q = at[1], r = at[width], w = at[width + 1];
    const float low = 1.0f / 255.0f;
    sun = ((p.sun * (1.0f - t) + q.sun * t) * (1.0f - s) + (r.sun * (1.0f - t) + w.sun * t) * s) * low;
    sky = ((p.sky * (1.0f - t) + q.sky * t) * (1.0f - s) + (r.sky * (1.0f - t) + w.sky * t) * s) * low;
}

struct alignas(8) Cell { unsigned char sun, mean; signed char x, y, z, rest[3]; };

// Sun and sky at a place in space for a surface with normal n: between the centres of eight cells.
CUDA_CALLABLE inline void space_light(
    wp::uint64 sheet, wp::uint64 cells, float x, float y, float z, float nx, float ny, float nz, float& sun, float& sky)
{
    const Row a = load(from(sheet, 2)), b = load(from(sheet, 3)), d = load(from(sheet, 0));
    const float p = clamped((x - a.x) * CELLS + nx * STAND_OFF - 0.5f, b.x - 1.0f);
    const float q = clamped((y - a.y) * CELLS + ny * STAND_OFF - 0.5f, b.y - 1.0f);
    const float r = clamped((z - a.z) * CELLS + nz * STAND_OFF - 0.5f, b.z - 1.0f);
    const int i = int(lesser(p, b.x - 2.0f)), j = int(lesser(q, b.y - 2.0f)), k = int(lesser(r, b.z - 2.0f));
    const float u = p - float(i), v = q - float(j), w = r - float(k);
    const int deep = int(b.z), wide = int(b.y) * deep;
    const Cell* at = reinterpret_cast<const Cell*>(cells);
    at += (long long)d.w * THOUSAND + (long long)b.w + (long long)i * wide + j * deep + k;
    float total = 0.0f, mean = 0.0f, gx = 0.0f, gy = 0.0f, gz = 0.0f;
    for (int n = 0; n < 8; ++n) {
        const float share = (n & 4 ? u : 1.0f - u) * (n & 2 ? v : 1.0f - v) * (n & 1 ? w : 1.0f - w);
        const Cell cell = at[(n & 4 ? wide : 0) + (n & 2 ? deep : 0) + (n & 1)];
        total += share * cell.sun, mean += share * cell.mean;
        gx += share * cell.x, gy += share * cell.y, gz += share * cell.z;
    }
    sun = total * (1.0f / 255.0f);
    sky = clamped(mean * (1.0f / 255.0f) + (gx * nx + gy * ny + gz * nz) * (1.0f / 127.0f), 1.0f);
}

}  // namespace urbanverse
"""
PREAMBLE = (
    _LIGHT.replace("THOUSAND", f"{int(THOUSAND)}")
    .replace("STAND_OFF", f"{STAND_OFF}f")
    .replace("TEXELS", f"{1.0 / TEXEL}f")
    .replace("CELLS", f"{1.0 / CELL}f")
)
