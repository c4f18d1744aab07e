"""Lanes, loops that they divide, and vectors, in C++; see `native`."""

LANES_SOURCE = """
#if defined(__CUDA_ARCH__)

#define UV_TABLE __device__ const
constexpr int LANES = 32;
CUDA_CALLABLE inline int lane() { return threadIdx.x; }
CUDA_CALLABLE inline void sync() { __syncwarp(); }

CUDA_CALLABLE inline float total(float x)
{
    for (int distance = 16; distance > 0; distance /= 2) x += __shfl_xor_sync(0xffffffffu, x, distance);
    return x;
}

// Three sums at once, which wait for each other's shuffles only once.
CUDA_CALLABLE inline void total(float& x, float& y, float& z)
{
    for (int distance = 16; distance > 0; distance /= 2) {
        x += __shfl_xor_sync(0xffffffffu, x, distance);
        y += __shfl_xor_sync(0xffffffffu, y, distance);
        z += __shfl_xor_sync(0xffffffffu, z, distance);
    }
}

// The place of this lane's entry in a list of which `count` are taken; in the order of the lanes.
CUDA_CALLABLE inline int append(bool wanted, int& count)
{
    const unsigned all = __ballot_sync(0xffffffffu, wanted);
    const int place = count + __popc(all & ((1u << threadIdx.x) - 1u));
    count += __popc(all);
    return place;
}

#elif defined(URBANVERSE_THREADS)  // tests: lanes as threads, defined where this is included

#define UV_TABLE static const

#else

#define UV_TABLE static const
constexpr int LANES = 1;
CUDA_CALLABLE inline int lane() { return 0; }
CUDA_CALLABLE inline void sync() {}
CUDA_CALLABLE inline float total(float x) { return x; }
CUDA_CALLABLE inline void total(float&, float&, float&) {}
CUDA_CALLABLE inline int append(bool wanted, int& count) { return wanted ? count++ : count; }

#endif

// Before a loop that NVRTC shall not write out: each env runs this program once, so its length counts.
#if defined(__CUDA_ARCH__)
#define ROLLED _Pragma("unroll 1")
#else
#define ROLLED
#endif

#if defined(URBANVERSE_BACKWARDS)  // tests: independent iterations may run in any order
#define EACH(i, n) sync(); for (int i = (n) - 1; i >= 0; --i)
#else
#define EACH(i, n) sync(); ROLLED for (int i = lane(); i < (n); i += LANES)
#endif
"""

ALGEBRA = """
struct V3 { float x, y, z; };

CUDA_CALLABLE inline V3 v3(const float* p) { return { p[0], p[1], p[2] }; }
CUDA_CALLABLE inline void put(float* p, V3 a) { p[0] = a.x, p[1] = a.y, p[2] = a.z; }
CUDA_CALLABLE inline V3 operator+(V3 a, V3 b) { return { a.x + b.x, a.y + b.y, a.z + b.z }; }
CUDA_CALLABLE inline V3 operator-(V3 a, V3 b) { return { a.x - b.x, a.y - b.y, a.z - b.z }; }
CUDA_CALLABLE inline V3 operator*(float s, V3 a) { return { s * a.x, s * a.y, s * a.z }; }
CUDA_CALLABLE inline float dot(V3 a, V3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
CUDA_CALLABLE inline V3 cross(V3 a, V3 b)
{
    return { a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}
CUDA_CALLABLE inline V3 turned(const float* m, V3 a)
{
    return { dot(v3(m), a), dot(v3(m + 3), a), dot(v3(m + 6), a) };
}
CUDA_CALLABLE inline V3 turned_back(const float* m, V3 a)
{
    return a.x * v3(m) + a.y * v3(m + 3) + a.z * v3(m + 6);
}
CUDA_CALLABLE inline float bound(float x, float low, float high) { return x < low ? low : (x > high ? high : x); }
CUDA_CALLABLE inline float larger(float a, float b) { return a > b ? a : b; }
CUDA_CALLABLE inline float lesser(float a, float b) { return a < b ? a : b; }
CUDA_CALLABLE inline float magnitude(float a) { return a < 0.0f ? -a : a; }
CUDA_CALLABLE inline void sine_cosine(float x, float& s, float& c)
{
#if defined(__CUDA_ARCH__)
    sincosf(x, &s, &c);
#else
    s = sinf(x), c = cosf(x);
#endif
}
CUDA_CALLABLE inline V3 unit(V3 a)
{
    const float length = sqrtf(dot(a, a));
    return length > 0.0f ? (1.0f / length) * a : V3{ 0.0f, 0.0f, 0.0f };
}

struct Quaternion { float w, x, y, z; };

CUDA_CALLABLE inline Quaternion quaternion(const float* p) { return { p[0], p[1], p[2], p[3] }; }
CUDA_CALLABLE inline void put(float* p, Quaternion q) { p[0] = q.w, p[1] = q.x, p[2] = q.y, p[3] = q.z; }
CUDA_CALLABLE inline Quaternion operator*(Quaternion a, Quaternion b)
{
    return { a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
             a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w };
}
CUDA_CALLABLE inline Quaternion unit(Quaternion q)
{
    const float s = 1.0f / sqrtf(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return { s * q.w, s * q.x, s * q.y, s * q.z };
}
CUDA_CALLABLE inline Quaternion about(V3 axis, float angle)
{
    float s, c;
    sine_cosine(0.5f * angle, s, c);
    return { c, s * axis.x, s * axis.y, s * axis.z };
}
CUDA_CALLABLE inline void matrix(float* m, Quaternion q)
{
    const float ww = q.w * q.w, xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
    m[0] = ww + xx - yy - zz, m[4] = ww - xx + yy - zz, m[8] = ww - xx - yy + zz;
    m[1] = 2.0f * (q.x * q.y - q.w * q.z), m[3] = 2.0f * (q.x * q.y + q.w * q.z);
    m[2] = 2.0f * (q.x * q.z + q.w * q.y), m[6] = 2.0f * (q.x * q.z - q.w * q.y);
    m[5] = 2.0f * (q.y * q.z - q.w * q.x), m[7] = 2.0f * (q.y * q.z + q.w * q.x);
}

// Spatial vectors: angular part, then linear part about the centre of mass.
struct V6 { V3 a, l; };

CUDA_CALLABLE inline V6 v6(const float* p) { return { v3(p), v3(p + 3) }; }
CUDA_CALLABLE inline void put(float* p, V6 v) { put(p, v.a), put(p + 3, v.l); }
CUDA_CALLABLE inline V6 operator+(V6 a, V6 b) { return { a.a + b.a, a.l + b.l }; }
CUDA_CALLABLE inline V6 operator*(float s, V6 b) { return { s * b.a, s * b.l }; }
CUDA_CALLABLE inline float dot(V6 a, V6 b) { return dot(a.a, b.a) + dot(a.l, b.l); }
CUDA_CALLABLE inline V6 cross_motion(V6 u, V6 v) { return { cross(u.a, v.a), cross(u.a, v.l) + cross(u.l, v.a) }; }
CUDA_CALLABLE inline V6 cross_force(V6 v, V6 f) { return { cross(v.a, f.a) + cross(v.l, f.l), cross(v.a, f.l) }; }

// An inertia is xx yy zz xy xz yz, mass times the offset of the centre of mass, mass.
CUDA_CALLABLE inline V6 inertia_times(const float* i, V6 v)
{
    const V3 h = v3(i + 6);
    const V3 a = { i[0] * v.a.x + i[3] * v.a.y + i[4] * v.a.z, i[3] * v.a.x + i[1] * v.a.y + i[5] * v.a.z,
                   i[4] * v.a.x + i[5] * v.a.y + i[2] * v.a.z };
    return { a + cross(h, v.l), i[9] * v.l - cross(h, v.a) };
}
"""
