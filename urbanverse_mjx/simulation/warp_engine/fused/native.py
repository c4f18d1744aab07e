"""The physics steps of one control step in C++, for both compilers that Warp feeds: clang on the CPU, NVRTC for CUDA.

A robot's state stays in one `Work`, in the shared memory of a block of one warp on CUDA and on the stack on a CPU.
The program is a sequence of loops whose iterations are independent (`EACH`): the lanes of the warp divide them, a CPU
runs them one after another. Everything outside these loops is computed by all lanes alike.

The formulas are those of MuJoCo (Todorov, Erez, Tassa 2012, and the "Computation" chapter of its documentation):
composite inertia, recursive Newton-Euler, soft constraints with pyramidal cones, Newton's method with a line search, and
Euler integration with implicit damping. A contact keeps the three rows of its frame instead of the four of its pyramid,
and rows and matrices only what a tree of joints leaves nonzero (Featherstone 2005).
"""

from typing import Any

import numpy as np

__all__ = ["LANES", "preamble"]

#: Threads that share the work of an env on CUDA: one warp.
LANES = 32

_LANES = """
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

_ALGEBRA = """
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

_WORK = """
constexpr int SWEPT = 16;  // numbers of a body that are summed towards the root: inertia (10) and force (6)
constexpr int CANDIDATES = 2 * 32 + LANES;
constexpr int NONE = -1, GROUND = -1;

struct Contact {
    int sphere, owner;
    float distance, friction;
    V3 position, inward;
};

struct Work {
    float qpos[NQ], qvel[NV], warm[NV], ctrl[NU];
    float xpos[NB][3], xquat[NB][4], xmat[NB][9], anchor[NB][3], axis[NB][3], middle[NB][3];
    float sphere[NS][3];
    float dof[NV][6], inertial[NV][6];
    float swept[NB][SWEPT], velocity[NB][6], acceleration[NB][6];
    float mass[NV][NV], hessian[NV][NV], inverse[NV];
    float smooth[NV], acc[NV], momentum[NV], gradient[NV], search[NV], searched[NV];
    // Contacts: rows of their frames, J acc - reference, the same of the search, weights, forces.
    Contact contact[ROOM];
    float rows[ROOM][3][NV], rest[ROOM][3], along[ROOM][3], stiffness[ROOM], weight[ROOM][5], force[ROOM][3];
    int active[ROOM];
    float limit_sign[NL], limit_rest[NL], limit_along[NL], limit_stiffness[NL], limit_force[NL];
    int limit_active[NL];
    // Slots that hold a hull.
    int hull[SLOTS], owner[SLOTS];
    float place[SLOTS][3], turn[SLOTS][9], box[SLOTS][6], slot_friction[SLOTS];
    float agent_place[AGENTS][3], agent_turn[AGENTS];
    int candidate[CANDIDATES];
    float foot[FEET];
};

// What comes in and goes out, of one env; see the kernel.
struct Env {
    const float *qpos, *qvel, *warm, *ctrl, *centre;
    float friction_scale, mass_scale;
    const int *slot_hull, *slot_owner;
    const float *slot_position, *slot_rotation, *slot_friction;
    const int *agent_present;
    const float *agent_position, *agent_heading, *agent_velocity, *agent_turn_rate;
    const float *agent_radius, *agent_half, *agent_height;
    const int* missing;
    float *qpos_out, *qvel_out, *warm_out, *xpos, *xquat, *force, *foot, *path;
    int *touch, *hit;
};

struct Hulls {
    const int *plane_start, *edge_start;
    const float *normal, *offset, *start, *edge, *centre, *half;
};

struct Settings { int slots, least, substeps, recorded, iterations, line_steps; };
"""

_DYNAMICS = """
CUDA_CALLABLE inline void place_bodies(Work& k, const Robot& r)
{
    ROLLED for (int level = 1; level < LEVELS; ++level) {
        EACH(n, LEVEL_START[level + 1] - LEVEL_START[level]) {
            const int b = LEVEL_BODY[LEVEL_START[level] + n], p = BODY_PARENT[b], type = BODY_JOINT[b];
            V3 place;
            Quaternion turn;
            if (type == FREE) {
                place = v3(k.qpos + BODY_QPOS[b]);
                turn = unit(quaternion(k.qpos + BODY_QPOS[b] + 3));
            } else {
                place = v3(k.xpos[p]) + turned(k.xmat[p], v3(r.body_pos[b]));
                turn = quaternion(k.xquat[p]) * quaternion(r.body_quat[b]);
                if (type != FIXED) {
                    float m[9];
                    matrix(m, turn);
                    const V3 anchor = place + turned(m, v3(r.joint_pos[b])), axis = turned(m, v3(r.joint_axis[b]));
                    const float moved = k.qpos[BODY_QPOS[b]] - r.joint_zero[b];
                    put(k.anchor[b], anchor);
                    put(k.axis[b], axis);
                    if (type == SLIDE) {
                        place = place + moved * axis;
                    } else {
                        turn = turn * about(v3(r.joint_axis[b]), moved);
                        matrix(m, turn);
                        place = anchor - turned(m, v3(r.joint_pos[b]));
                    }
                }
                turn = unit(turn);
            }
            put(k.xpos[b], place);
            put(k.xquat[b], turn);
            matrix(k.xmat[b], turn);
            put(k.middle[b], place + turned(k.xmat[b], v3(r.body_centre[b])));
        }
    }
    EACH(s, NS) put(k.sphere[s], v3(k.xpos[SPHERE_BODY[s]]) + turned(k.xmat[SPHERE_BODY[s]], v3(r.sphere_pos[s])));
    sync();
}

// Inertia of a body about the robot's centre of mass, world axes.
CUDA_CALLABLE inline void place_inertia(float* out, const float* m, const float* own, V3 offset, float mass, float scale)
{
    const float i[9] = { own[0], own[3], own[4], own[3], own[1], own[5], own[4], own[5], own[2] };
    float half[9];
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            half[3 * row + column] = m[3 * row] * i[column] + m[3 * row + 1] * i[3 + column] + m[3 * row + 2] * i[6 + column];
    const V3 a = v3(half), b = v3(half + 3), c = v3(half + 6), o = offset;
    out[0] = scale * (dot(a, v3(m)) + mass * (o.y * o.y + o.z * o.z));
    out[1] = scale * (dot(b, v3(m + 3)) + mass * (o.x * o.x + o.z * o.z));
    out[2] = scale * (dot(c, v3(m + 6)) + mass * (o.x * o.x + o.y * o.y));
    out[3] = scale * (dot(a, v3(m + 3)) - mass * o.x * o.y);
    out[4] = scale * (dot(a, v3(m + 6)) - mass * o.x * o.z);
    out[5] = scale * (dot(b, v3(m + 6)) - mass * o.y * o.z);
    put(out + 6, scale * mass * o);
    out[9] = scale * mass;
}

// Mass matrix (both triangles) and the forces that need no contact; returns the centre of mass.
CUDA_CALLABLE inline V3 smooth_dynamics(Work& k, const Robot& r, float mass_scale)
{
    V3 com = { 0.0f, 0.0f, 0.0f };
    for (int b = 1; b < NB; ++b) com = com + r.body_mass[b] * v3(k.middle[b]);
    com = (1.0f / r.total_mass) * com;
    EACH(i, NV) {
        const int b = DOF_BODY[i], type = BODY_JOINT[b], number = i - BODY_DOF[b];
        V6 out = { { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f } };
        if (type == FREE) {
            if (number < 3) {
                out.l = { number == 0 ? 1.0f : 0.0f, number == 1 ? 1.0f : 0.0f, number == 2 ? 1.0f : 0.0f };
            } else {
                const float* column = k.xmat[b] + number - 3;
                out.a = { column[0], column[3], column[6] };
                out.l = cross(out.a, com - v3(k.xpos[b]));
            }
        } else if (type == SLIDE) {
            out.l = v3(k.axis[b]);
        } else {
            out.a = v3(k.axis[b]);
            out.l = cross(out.a, com - v3(k.anchor[b]));
        }
        put(k.dof[i], out);
    }
    ROLLED for (int level = 1; level < LEVELS; ++level) {
        EACH(n, LEVEL_START[level + 1] - LEVEL_START[level]) {
            const int b = LEVEL_BODY[LEVEL_START[level] + n], p = BODY_PARENT[b], first = BODY_DOF[b];
            V6 v = v6(k.velocity[p]), a = v6(k.acceleration[p]);
            const int type = BODY_JOINT[b];
            if (type == FREE) {
                v.l = v.l + v3(k.qvel + first);
                V6 spin = { { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f } };
                for (int i = first + 3; i < first + 6; ++i) {
                    spin = spin + k.qvel[i] * v6(k.dof[i]);
                    a = a + k.qvel[i] * cross_motion(v, v6(k.dof[i]));
                }
                v = v + spin;
            } else if (type != FIXED) {
                const V6 own = k.qvel[first] * v6(k.dof[first]);
                a = a + cross_motion(v, own);
                v = v + own;
            }
            put(k.velocity[b], v);
            put(k.acceleration[b], a);
            float* out = k.swept[b];
            place_inertia(out, k.xmat[b], r.body_inertia[b], v3(k.middle[b]) - com, r.body_mass[b], mass_scale);
            put(out + 10, inertia_times(out, a) + cross_force(v, inertia_times(out, v)));
        }
    }
    ROLLED for (int b = NB - 1; b > 0; --b)
        if (BODY_PARENT[b] > 0) {
            EACH(n, SWEPT) k.swept[BODY_PARENT[b]][n] += k.swept[b][n];
        }
    EACH(i, NV) {
        const float* sum = k.swept[DOF_BODY[i]];
        const V6 own = v6(k.dof[i]);
        put(k.inertial[i], inertia_times(sum, own));
        float out = -r.damping[i] * k.qvel[i] - dot(own, v6(sum + 10));
        for (int u = 0; u < NU; ++u)
            if (ACTUATOR_DOF[u] == i) {
                const float ctrl = bound(k.ctrl[u], r.ctrl_range[u][0], r.ctrl_range[u][1]), gear = r.gear[u];
                const float driven = r.gain[u] * ctrl + r.bias[u][0] + r.bias[u][1] * gear * k.qpos[ACTUATOR_QPOS[u]]
                    + r.bias[u][2] * gear * k.qvel[i];
                out += gear * bound(driven, r.force_range[u][0], r.force_range[u][1]);
            }
        k.smooth[i] = out;
    }
    EACH(e, ENTRIES) {
        const int i = ENTRY_ROW[e], j = ENTRY_COLUMN[e];
        const float value = dot(v6(k.dof[j]), v6(k.inertial[i])) + (i == j ? r.armature[i] : 0.0f);
        k.mass[i][j] = value;
        k.mass[j][i] = value;
    }
    return com;
}

// hessian = L^T D L in place, from the leaves on: what a tree of joints leaves zero stays zero. L is not divided by D.
CUDA_CALLABLE inline void factorise(Work& k)
{
    ROLLED for (int d = NV - 1; d >= 0; --d) {
        sync();
        const float inverse = 1.0f / k.hessian[d][d];
        EACH(n, DOF_DEPTH[d]) {
            const int i = DOF_ABOVE[d][n];
            const float share = k.hessian[d][i] * inverse;
            ROLLED for (int m = 0; m <= n; ++m) {
                const int j = DOF_ABOVE[d][m];
                k.hessian[i][j] -= share * k.hessian[d][j];
            }
        }
        if (lane() == 0) k.inverse[d] = inverse;
    }
}

// x = hessian^-1 x, factorised before.
CUDA_CALLABLE inline void solve(Work& k, float* x)
{
    ROLLED for (int d = NV - 1; d >= 0; --d) {
        sync();
        const float share = k.inverse[d] * x[d];
        EACH(n, DOF_DEPTH[d]) x[DOF_ABOVE[d][n]] -= k.hessian[d][DOF_ABOVE[d][n]] * share;
    }
    EACH(i, NV) x[i] *= k.inverse[i];
    ROLLED for (int d = 0; d < NV; ++d) {
        sync();
        const float value = x[d];
        EACH(n, DOF_BELOW_COUNT[d]) {
            const int i = DOF_BELOW[d][n];
            x[i] -= k.hessian[i][d] * k.inverse[i] * value;
        }
    }
    sync();
}
"""

_CONTACTS = """
CUDA_CALLABLE inline float outside_box(V3 p, const float* box)
{
    if (!(dot(p, p) < 3.0e38f)) return 1.0e30f;
    const float x = larger(magnitude(p.x - box[0]) - box[3], 0.0f), y = larger(magnitude(p.y - box[1]) - box[4], 0.0f);
    const float z = larger(magnitude(p.z - box[2]) - box[5], 0.0f);
    return sqrtf(x * x + y * y + z * z);
}

// Direction and distance (m) from a hull to a point in its frame; see `contact.hull_distance`.
CUDA_CALLABLE inline float hull_distance(const Hulls& t, int hull, V3 point, float limit, V3& normal)
{
    const int first = t.plane_start[hull], last = t.plane_start[hull + 1];
    float distance = -1.0e30f;
    int face = first;
    for (int p = first; p < last; ++p) {
        const float height = dot(v3(t.normal + 3 * p), point) - t.offset[p];
        if (height > distance) distance = height, face = p;
    }
    normal = v3(t.normal + 3 * face);
    if (distance > 0.0f && distance < limit) {
        const V3 foot = point - distance * normal;
        float outside = 0.0f;
        for (int p = first; p < last; ++p) outside = larger(outside, dot(v3(t.normal + 3 * p), foot) - t.offset[p]);
        if (outside > FOOT_TOLERANCE) {
            float nearest = 1.0e30f;
            V3 direction = { 0.0f, 0.0f, 0.0f };
            for (int e = t.edge_start[hull]; e < t.edge_start[hull + 1]; ++e) {
                const V3 offset = point - v3(t.start + 3 * e), edge = v3(t.edge + 3 * e);
                const V3 away = offset - bound(dot(offset, edge) / dot(edge, edge), 0.0f, 1.0f) * edge;
                const float square = dot(away, away);
                if (square < nearest) nearest = square, direction = away;
            }
            distance = sqrtf(nearest);
            if (distance > ON_EDGE) normal = (1.0f / distance) * direction;
        }
    }
    return distance;
}

// From an upright prism to a point; see `agents.prism_distance`.
CUDA_CALLABLE inline float prism_distance(V3 offset, float turn, float radius, float half, float height, V3& normal)
{
    float s, c;
    sine_cosine(turn, s, c);
    const float along = bound(c * offset.x + s * offset.y, -half, half);
    float x = offset.x - along * c, y = offset.y - along * s;
    const float rho = sqrtf(x * x + y * y);
    if (rho < ON_AXIS) x = -s, y = c;
    else x /= rho, y /= rho;
    const float up = offset.z > 0.5f * height ? 1.0f : -1.0f;
    const float aside = rho - radius, above = magnitude(offset.z - 0.5f * height) - 0.5f * height;
    if (aside > 0.0f && above > 0.0f) {
        const float corner = sqrtf(aside * aside + above * above);
        normal = { x * aside / corner, y * aside / corner, up * above / corner };
        return corner;
    }
    normal = aside > above ? V3{ x, y, 0.0f } : V3{ 0.0f, 0.0f, up };
    return aside > above ? aside : above;
}

CUDA_CALLABLE inline float friction_of(const Robot& r, int s, float other, const Settings& set, float scale)
{
    const float own = r.sphere_friction[s];
    if (SPHERE_ALONE[s]) return own * scale;
    return (set.least ? lesser(own, other) : larger(own, other)) * scale;
}

// Adds contacts of the listed candidates, in their order; `count` may exceed the room.
CUDA_CALLABLE inline void test_candidates(
    Work& k, const Robot& r, const Hulls& hulls, const Env& e, const Settings& set, int number, int agents_from, int& count)
{
    sync();
    ROLLED for (int base = 0; base < number; base += LANES) {
        const int n = base + lane();
        Contact out;
        out.distance = 1.0f;
        if (n < number) {
            const int c = k.candidate[n] / NS, s = k.candidate[n] % NS;
            const V3 centre = v3(k.sphere[s]);
            const float radius = r.sphere_radius[s];
            V3 normal;
            float other;
            if (NUM_AGENTS == 0 || c < agents_from) {
                const V3 local = turned_back(k.turn[c], centre - v3(k.place[c]));
                out.distance = hull_distance(hulls, k.hull[c], local, radius, normal) - radius;
                normal = turned(k.turn[c], normal);
                out.owner = k.owner[c];
                other = k.slot_friction[c];
            } else {
                const int a = c - agents_from;
                const V3 offset = centre - v3(k.agent_place[a]);
                out.distance = prism_distance(
                    offset, k.agent_turn[a], e.agent_radius[a], e.agent_half[a], e.agent_height[a], normal) - radius;
                out.owner = FIRST_AGENT - a;
                other = AGENT_FRICTION;
            }
            out.sphere = s;
            out.inward = -1.0f * normal;
            out.position = centre + (radius + 0.5f * out.distance) * out.inward;
            out.friction = friction_of(r, s, other, set, e.friction_scale);
        }
        const bool touches = out.distance < 0.0f;
        const int place = append(touches, count);
        if (touches && place < ROOM) k.contact[place] = out;
    }
    sync();
}

// All contacts of spheres with `occupied` hulls and with agents; returns how many there are.
CUDA_CALLABLE inline int find_contacts(
    Work& k, const Robot& r, const Hulls& hulls, const Env& e, const Settings& set, int occupied)
{
    int count = 0, listed = 0;
    const int pairs = (occupied + NUM_AGENTS) * NS;
    ROLLED for (int base = 0; base < pairs; base += LANES) {
        const int pair = base + lane(), c = pair / NS, s = pair % NS;
        bool near = false;
        if (pair < occupied * NS) {
            const V3 local = turned_back(k.turn[c], v3(k.sphere[s]) - v3(k.place[c]));
            near = outside_box(local, k.box[c]) < r.sphere_radius[s];
        } else if (NUM_AGENTS > 0 && pair < pairs) {
            near = e.agent_present[c - occupied] != 0;
        }
        const int place = append(near, listed);
        if (near) k.candidate[place] = pair;
        if (listed > CANDIDATES - LANES || (base + LANES >= pairs && listed > 0)) {
            test_candidates(k, r, hulls, e, set, listed, occupied, count);
            listed = 0;
        }
    }
    return count;
}
"""

_SOLVER = """
// Stiffness and damping of a constraint and its impedance at a depth; see MuJoCo's "Solver parameters".
CUDA_CALLABLE inline void impedance(const float* solref, const float* p, float dt, float depth, float& k, float& b, float& i)
{
    const float time = larger(solref[0], 2.0f * dt), low = bound(p[0], 0.0001f, 0.9999f), top = bound(p[1], 0.0001f, 0.9999f);
    const float width = larger(p[2], MINIMUM), mid = bound(p[3], 0.0001f, 0.9999f), power = larger(p[4], 1.0f);
    k = solref[0] <= 0.0f ? -solref[0] / larger(MINIMUM, top * top)
                          : 1.0f / larger(MINIMUM, top * top * time * time * solref[1] * solref[1]);
    b = solref[1] <= 0.0f ? -solref[1] / larger(MINIMUM, top) : 2.0f / larger(MINIMUM, top * time);
    const float x = magnitude(depth) / width;
    if (low == top || p[2] <= MINIMUM) i = 0.5f * (low + top);
    else if (x <= 0.0f) i = low;
    else if (x >= 1.0f) i = top;
    else if (power == 1.0f) i = low + x * (top - low);
    else {
        // MuJoCo's own power is 2.
        const float u = x <= mid ? x : 1.0f - x, v = x <= mid ? mid : 1.0f - mid;
        const float part = SQUARES ? u * u / v : powf(u, power) / powf(v, power - 1.0f);
        const float y = x <= mid ? part : 1.0f - part;
        i = bound(low + y * (top - low), lesser(low, top), larger(low, top));
    }
}

CUDA_CALLABLE inline float stiffness(float weight, float impedance)
{
    return 1.0f / larger(weight * (1.0f - impedance) / impedance, MINIMUM);
}

// Jacobians and references of contacts and limits; `rest` is minus the reference.
CUDA_CALLABLE inline void make_rows(Work& k, const Robot& r, V3 com, int contacts)
{
    EACH(n, contacts * NV) {
        const int c = n / NV, i = n % NV;
        const Contact& at = k.contact[c];
        V3 moved = { 0.0f, 0.0f, 0.0f };
        V3 y = { 0.0f, 0.0f, 0.0f }, z = y;
        if (BODY_MASK[SPHERE_BODY[at.sphere]] >> i & 1u) {
            const V6 own = v6(k.dof[i]);
            moved = own.l + cross(own.a, at.position - com);
            y = at.inward.y > -0.5f && at.inward.y < 0.5f ? V3{ 0.0f, 1.0f, 0.0f } : V3{ 0.0f, 0.0f, 1.0f };
            y = unit(y - dot(at.inward, y) * at.inward);
            z = cross(at.inward, y);
        }
        // Of the hull relative to the sphere.
        k.rows[c][0][i] = -dot(at.inward, moved);
        k.rows[c][1][i] = -dot(y, moved);
        k.rows[c][2][i] = -dot(z, moved);
    }
    EACH(c, contacts) {
        const Contact& at = k.contact[c];
        const int s = at.sphere;
        float stiff, damp, imp, v[3] = { 0.0f, 0.0f, 0.0f };
        for (int row = 0; row < 3; ++row)
            for (int i = 0; i < NV; ++i) v[row] += k.rows[c][row][i] * k.qvel[i];
        impedance(r.sphere_solref[s], r.sphere_solimp[s], r.timestep, at.distance, stiff, damp, imp);
        float weight = r.sphere_weight[s];
        if (!SPHERE_SLIPPERY[s]) weight = (weight + at.friction * at.friction * weight) * 2.0f * at.friction * at.friction;
        k.stiffness[c] = stiffness(weight, imp);
        k.rest[c][0] = stiff * imp * at.distance + damp * v[0];
        k.rest[c][1] = damp * v[1];
        k.rest[c][2] = damp * v[2];
    }
    EACH(n, NUM_LIMITS) {
        const float q = k.qpos[LIMIT_QPOS[n]], below = q - r.limit_range[n][0], above = r.limit_range[n][1] - q;
        const float depth = lesser(below, above), sign = below < above ? 1.0f : -1.0f;
        float stiff, damp, imp;
        impedance(r.limit_solref[n], r.limit_solimp[n], r.timestep, depth, stiff, damp, imp);
        k.limit_sign[n] = sign;
        k.limit_stiffness[n] = depth < 0.0f ? stiffness(r.limit_weight[n], imp) : 0.0f;
        k.limit_rest[n] = stiff * imp * depth + damp * sign * k.qvel[LIMIT_DOF[n]];
    }
}

// The rows of a pyramid: normal +- friction times a tangent; a slippery sphere has the normal alone.
CUDA_CALLABLE inline int pyramid(const Work& k, int c, const float* x, float* out)
{
    if (SPHERE_SLIPPERY[k.contact[c].sphere]) {
        out[0] = x[0];
        return 1;
    }
    const float mu = k.contact[c].friction;
    out[0] = x[0] + mu * x[1], out[1] = x[0] - mu * x[1], out[2] = x[0] + mu * x[2], out[3] = x[0] - mu * x[2];
    return 4;
}

// Forces of all rows where J acc - reference is `rest`, and with weights how they change with it. Returns, to each lane
// for its own, how many rows began or ceased to push.
CUDA_CALLABLE inline float push(Work& k, int contacts)
{
    float changed = 0.0f;
    EACH(c, contacts) {
        float x[4], f[4] = { 0.0f, 0.0f, 0.0f, 0.0f }, w[4] = { 0.0f, 0.0f, 0.0f, 0.0f };
        const int rows = pyramid(k, c, k.rest[c], x);
        int active = 0;
        for (int n = 0; n < rows; ++n)
            if (x[n] < 0.0f) active |= 1 << n, w[n] = k.stiffness[c], f[n] = -w[n] * x[n];
        const float mu = rows == 1 ? 0.0f : k.contact[c].friction;
        k.force[c][0] = f[0] + f[1] + f[2] + f[3];
        k.force[c][1] = mu * (f[0] - f[1]);
        k.force[c][2] = mu * (f[2] - f[3]);
        k.weight[c][0] = w[0] + w[1] + w[2] + w[3];
        k.weight[c][1] = mu * (w[0] - w[1]);
        k.weight[c][2] = mu * (w[2] - w[3]);
        k.weight[c][3] = mu * mu * (w[0] + w[1]);
        k.weight[c][4] = mu * mu * (w[2] + w[3]);
        if (active != k.active[c]) changed += 1.0f;
        k.active[c] = active;
    }
    EACH(n, NUM_LIMITS) {
        const int active = k.limit_rest[n] < 0.0f && k.limit_stiffness[n] > 0.0f;
        k.limit_force[n] = active ? -k.limit_stiffness[n] * k.limit_rest[n] : 0.0f;
        if (active != k.limit_active[n]) changed += 1.0f;
        k.limit_active[n] = active;
    }
    return changed;
}

// Force of the rows on a velocity.
CUDA_CALLABLE inline float pushed(const Work& k, int contacts, int i)
{
    float out = 0.0f;
    for (int c = 0; c < contacts; ++c)
        out += k.rows[c][0][i] * k.force[c][0] + k.rows[c][1][i] * k.force[c][1] + k.rows[c][2][i] * k.force[c][2];
    if (NUM_LIMITS > 0 && DOF_LIMIT[i] >= 0) out += k.limit_sign[DOF_LIMIT[i]] * k.limit_force[DOF_LIMIT[i]];
    return out;
}

// Slope and curvature of the cost at `step` along the search, without the part of the inertia.
CUDA_CALLABLE inline void slope(const Work& k, int contacts, float step, float& first, float& second)
{
    first = 0.0f, second = 0.0f;
    ROLLED for (int c = lane(); c < contacts; c += LANES) {
        float x[4], p[4];
        const int rows = pyramid(k, c, k.rest[c], x);
        pyramid(k, c, k.along[c], p);
        for (int n = 0; n < rows; ++n) {
            const float at = x[n] + step * p[n];
            if (at < 0.0f) first += k.stiffness[c] * at * p[n], second += k.stiffness[c] * p[n] * p[n];
        }
    }
    ROLLED for (int n = lane(); n < NUM_LIMITS; n += LANES) {
        const float at = k.limit_rest[n] + step * k.limit_along[n];
        if (at < 0.0f) {
            first += k.limit_stiffness[n] * at * k.limit_along[n];
            second += k.limit_stiffness[n] * k.limit_along[n] * k.limit_along[n];
        }
    }
    first = total(first), second = total(second);
}

// How far along the search the cost is least.
CUDA_CALLABLE inline float line_search(const Work& k, int contacts, float slope_mass, float curve_mass, float begin, int steps)
{
    float low = 0.0f, high = -1.0f, step = 1.0f;
    const float enough = LINE_TOLERANCE * magnitude(begin);
    ROLLED for (int n = 0; n < steps; ++n) {
        float first, second;
        slope(k, contacts, step, first, second);
        first += slope_mass + step * curve_mass;
        second += curve_mass;
        if (magnitude(first) <= enough) return step;
        if (first < 0.0f) low = step;
        else high = step;
        step -= first / second;
        if (step <= low || (high > 0.0f && step >= high)) step = high > 0.0f ? 0.5f * (low + high) : 2.0f * low;
    }
    return step;
}

// acc = the acceleration of least cost, with the forces there; from `warm` on, in one iteration where nothing pushes.
// Returns the iterations.
CUDA_CALLABLE inline int minimise(Work& k, const Robot& r, int contacts, const Settings& set)
{
    EACH(i, NV) {
        float sum = 0.0f;
        for (int j = 0; j < NV; ++j) sum += k.mass[i][j] * k.warm[j];
        k.momentum[i] = sum;
        k.acc[i] = k.warm[i];
    }
    EACH(n, contacts * 3) {
        const int c = n / 3, row = n % 3;
        float sum = k.rest[c][row];
        for (int i = 0; i < NV; ++i) sum += k.rows[c][row][i] * k.warm[i];
        k.rest[c][row] = sum;
        if (row == 0) k.active[c] = -1;
    }
    EACH(n, NUM_LIMITS) {
        k.limit_rest[n] += k.limit_sign[n] * k.warm[LIMIT_DOF[n]];
        k.limit_active[n] = -1;
    }
    int iteration = 0;
    push(k, contacts);
    ROLLED while (iteration < set.iterations) {
        float square = 0.0f;
        EACH(i, NV) {
            const float out = k.momentum[i] - k.smooth[i] - pushed(k, contacts, i);
            k.gradient[i] = out;
            k.search[i] = -out;
            square += out * out;
        }
        if (r.scale * sqrtf(total(square)) < r.tolerance) break;
        ++iteration;
        EACH(e, ENTRIES) {
            const int i = ENTRY_ROW[e], j = ENTRY_COLUMN[e];
            float sum = k.mass[i][j];
            for (int c = 0; c < contacts; ++c)
                if (k.active[c] && BODY_MASK[SPHERE_BODY[k.contact[c].sphere]] >> i & 1u) {
                    const float* w = k.weight[c];
                    const float a = k.rows[c][0][i], b = k.rows[c][1][i], d = k.rows[c][2][i];
                    sum += (w[0] * a + w[1] * b + w[2] * d) * k.rows[c][0][j] + (w[1] * a + w[3] * b) * k.rows[c][1][j]
                        + (w[2] * a + w[4] * d) * k.rows[c][2][j];
                }
            if (NUM_LIMITS > 0 && i == j && DOF_LIMIT[i] >= 0 && k.limit_active[DOF_LIMIT[i]])
                sum += k.limit_stiffness[DOF_LIMIT[i]];
            k.hessian[i][j] = sum;
        }
        factorise(k);
        solve(k, k.search);
        float slope_mass = 0.0f, curve_mass = 0.0f, begin = 0.0f;
        EACH(i, NV) {
            float sum = 0.0f;
            for (int j = 0; j < NV; ++j) sum += k.mass[i][j] * k.search[j];
            k.searched[i] = sum;
            slope_mass += k.search[i] * (k.momentum[i] - k.smooth[i]);
            curve_mass += k.search[i] * sum;
            begin += k.search[i] * k.gradient[i];
        }
        slope_mass = total(slope_mass), curve_mass = total(curve_mass), begin = total(begin);
        EACH(n, contacts * 3) {
            const int c = n / 3, row = n % 3;
            float sum = 0.0f;
            for (int i = 0; i < NV; ++i) sum += k.rows[c][row][i] * k.search[i];
            k.along[c][row] = sum;
        }
        EACH(n, NUM_LIMITS) k.limit_along[n] = k.limit_sign[n] * k.search[LIMIT_DOF[n]];
        sync();
        const float step = line_search(k, contacts, slope_mass, curve_mass, begin, set.line_steps);
        EACH(i, NV) {
            k.acc[i] += step * k.search[i];
            k.momentum[i] += step * k.searched[i];
        }
        EACH(n, contacts * 3) k.rest[n / 3][n % 3] += step * k.along[n / 3][n % 3];
        EACH(n, NUM_LIMITS) k.limit_rest[n] += step * k.limit_along[n];
        // A whole step that no row noticed ends at the minimum of a parabola.
        const float changed = total(push(k, contacts));
        if (changed == 0.0f && step == 1.0f) break;
    }
    sync();
    return iteration;
}
"""

_STEP = """
struct Touch {
    float force, agent_force;
    int owner, ground, count, missed, agent;
};

// Adds the touches of a physics step; see `kernels.note`.
CUDA_CALLABLE inline void note(Work& k, Touch& t, int found)
{
    const int contacts = found < ROOM ? found : ROOM;
    EACH(f, NUM_FEET) {
        for (int c = 0; c < contacts; ++c)
            if (SPHERE_FOOT[k.contact[c].sphere] == f) k.foot[f] += k.force[c][0];
    }
    bool touched = false;
    float strength = -1.0f;
    int strongest = NONE;
    for (int c = 0; c < contacts; ++c) {
        const int owner = k.contact[c].owner;
        const float force = k.force[c][0];
        if (owner == GROUND && SPHERE_FOOT[k.contact[c].sphere] >= 0) continue;
        touched = true;
        if (owner == GROUND) t.ground = 1;
        if (owner <= FIRST_AGENT && (force > t.agent_force || t.agent < 0)) t.agent = FIRST_AGENT - owner, t.agent_force = force;
        if (force > strength) strength = force, strongest = owner;
    }
    if (touched) {
        if (strength > t.force || t.count == 0) t.owner = strongest;
        t.force = larger(t.force, strength);
        ++t.count;
    }
    if (found - ROOM > t.missed) t.missed = found - ROOM;
}

// Semi-implicit Euler, damping implicit.
CUDA_CALLABLE inline void integrate(Work& k, const Robot& r, int contacts)
{
    const float dt = r.timestep;
    if (DAMPED) {
        EACH(i, NV) k.search[i] = k.smooth[i] + pushed(k, contacts, i);
        EACH(e, ENTRIES) {
            const int i = ENTRY_ROW[e], j = ENTRY_COLUMN[e];
            k.hessian[i][j] = k.mass[i][j] + (i == j ? dt * r.damping[i] : 0.0f);
        }
        factorise(k);
        solve(k, k.search);
    } else {
        EACH(i, NV) k.search[i] = k.acc[i];
    }
    EACH(i, NV) {
        k.qvel[i] += dt * k.search[i];
        k.warm[i] = k.acc[i];
    }
    EACH(b, NB) {
        float* q = k.qpos + BODY_QPOS[b];
        const float* v = k.qvel + BODY_DOF[b];
        if (BODY_JOINT[b] == FREE) {
            put(q, v3(q) + dt * v3(v));
            const V3 spin = v3(v + 3);
            const float speed = sqrtf(dot(spin, spin));
            put(q + 3, unit(unit(quaternion(q + 3)) * about(unit(spin), dt * speed)));
        } else if (BODY_JOINT[b] != FIXED) {
            q[0] += dt * v[0];
        }
    }
}

CUDA_CALLABLE inline void control_step(Work& k, const Robot& r, const Hulls& hulls, const Env& e, const Settings& set)
{
    const V3 origin = { rintf(e.centre[0]), rintf(e.centre[1]), 0.0f };
    EACH(i, NQ) k.qpos[i] = e.qpos[i];
    EACH(i, NV) {
        k.qvel[i] = e.qvel[i];
        k.warm[i] = e.warm[i];
        for (int j = 0; j < NV; ++j) k.mass[i][j] = 0.0f;
    }
    EACH(i, NUM_ACTUATORS) k.ctrl[i] = e.ctrl[i];
    EACH(f, NUM_FEET) k.foot[f] = 0.0f;
    EACH(a, NUM_AGENTS) {
        put(k.agent_place[a], v3(e.agent_position + 3 * a) - origin);
        k.agent_turn[a] = e.agent_heading[a];
    }
    int occupied = 0;
    ROLLED for (int base = 0; base < set.slots; base += LANES) {
        const int c = base + lane(), hull = c < set.slots ? e.slot_hull[c] : NONE, n = append(hull >= 0, occupied);
        if (hull >= 0) {
            k.hull[n] = hull;
            k.owner[n] = e.slot_owner[c];
            k.slot_friction[n] = e.slot_friction[c];
            put(k.place[n], v3(e.slot_position + 3 * c));
            for (int i = 0; i < 9; ++i) k.turn[n][i] = e.slot_rotation[9 * c + i];
            put(k.box[n], v3(hulls.centre + 3 * hull));
            put(k.box[n] + 3, v3(hulls.half + 3 * hull));
        }
    }
    sync();
    if (lane() == 0) {
        put(k.qpos + ROOT_QPOS, v3(k.qpos + ROOT_QPOS) - origin);
        for (int i = 0; i < 3; ++i) k.xpos[0][i] = k.acceleration[0][i] = 0.0f, k.acceleration[0][3 + i] = -r.gravity[i];
        for (int i = 0; i < 6; ++i) k.velocity[0][i] = 0.0f;
        for (int i = 0; i < 9; ++i) k.xmat[0][i] = i % 4 == 0 ? 1.0f : 0.0f;
        for (int i = 0; i < 4; ++i) k.xquat[0][i] = i == 0 ? 1.0f : 0.0f;
        for (int i = 0; i < 3; ++i) k.middle[0][i] = 0.0f;
    }
    Touch t = { 0.0f, 0.0f, NONE, 0, 0, 0, NONE };
    ROLLED for (int step = 0;; ++step) {
        place_bodies(k, r);
        if (step == set.substeps) break;
        const V3 com = smooth_dynamics(k, r, e.mass_scale);
        const int found = find_contacts(k, r, hulls, e, set, occupied), contacts = found < ROOM ? found : ROOM;
        make_rows(k, r, com, contacts);
        minimise(k, r, contacts, set);
        const int before = t.count;
        note(k, t, found);
        integrate(k, r, contacts);
        EACH(a, NUM_AGENTS) {
            put(k.agent_place[a], v3(k.agent_place[a]) + r.timestep * v3(e.agent_velocity + 3 * a));
            k.agent_turn[a] += r.timestep * e.agent_turn_rate[a];
        }
        if (step < set.recorded) {
            EACH(i, NQ) e.path[step * NQ + i] = k.qpos[i] + (i == ROOT_QPOS ? origin.x : i == ROOT_QPOS + 1 ? origin.y : 0.0f);
            if (lane() == 0) e.hit[step] = t.count - before;
        }
    }
    EACH(i, NQ) e.qpos_out[i] = k.qpos[i] + (i == ROOT_QPOS ? origin.x : i == ROOT_QPOS + 1 ? origin.y : 0.0f);
    EACH(i, NV) {
        e.qvel_out[i] = k.qvel[i];
        e.warm_out[i] = k.warm[i];
    }
    EACH(b, NB) {
        put(e.xpos + 3 * b, v3(k.xpos[b]) + (b == 0 ? V3{ 0.0f, 0.0f, 0.0f } : origin));
        put(e.xquat + 4 * b, quaternion(k.xquat[b]));
    }
    EACH(f, NUM_FEET) e.foot[f] = k.foot[f];
    if (lane() == 0) {
        e.force[0] = t.force;
        e.touch[0] = t.owner > NONE ? t.owner : NONE;
        e.touch[1] = t.ground;
        e.touch[2] = t.count;
        e.touch[3] = e.missing[0] + e.missing[1] + t.missed;
        e.touch[4] = t.agent;
    }
    sync();
}
"""


def _table(name: str, values: Any) -> str:
    values = np.asarray(values)
    dims = "".join(f"[{n}]" for n in values.shape)

    def braces(x: Any) -> str:
        return "{ " + ", ".join(map(braces, x)) + " }" if isinstance(x, list) else f"{x}u" if kind == "u" else str(x)

    kind = values.dtype.kind
    return f"UV_TABLE {'unsigned' if kind == 'u' else 'int'} {name}{dims} = {braces(values.tolist())};\n"


def preamble(numbers: dict[str, int], floats: dict[str, float], tables: dict[str, Any], robot: dict[str, Any]) -> str:
    """The program of one robot, in the namespace `urbanverse`; needs `CUDA_CALLABLE` and the mathematics of C.

    Args:
      numbers, floats: constants by name.
      tables: arrays of whole numbers by name, which say how the robot is connected.
      robot: arrays of numbers by name; those that the program reads lie behind one another in this order, see `Robot`.
    """
    lines = [f"constexpr int {name} = {value};\n" for name, value in numbers.items()]
    lines += [f"constexpr float {name} = {float(value)!r}f;\n" for name, value in floats.items()]
    lines += [_table(name, values) for name, values in tables.items()]
    fields = "".join(
        f"    float {name}{''.join(f'[{n}]' for n in np.shape(values))};\n" for name, values in robot.items()
    )
    parts = [_LANES, *lines, f"struct Robot {{\n{fields}}};\n", _ALGEBRA, _WORK, _DYNAMICS, _CONTACTS, _SOLVER, _STEP]
    # Nothing here is seen by another module, whose robot may have other sizes.
    return "namespace urbanverse { namespace {\n" + "".join(parts) + "\n} }\n"
