"""What is kept of an env, kinematics, and the mass matrix with its factors, in C++; see `native`."""

WORK = """
constexpr int COMPOSITE = 16;  // numbers of a body that are summed towards the root: inertia (10) and force (6)
constexpr int CANDIDATES = 2 * 32 + LANES;
constexpr int NONE = -1, GROUND = -1;

struct Contact {
    int sphere, owner, foot, slippery;
    unsigned moved_by;  // a bit for each velocity
    float distance, friction;
    V3 position, inward;
};

struct Work {
    float qpos[NQ], qvel[NV], warm[NV], ctrl[NU];
    float xpos[NB][3], xquat[NB][4], xmat[NB][9], anchor[NB][3], axis[NB][3], middle[NB][3];
    float sphere[NS][3];
    float dof[NV][6], inertial[NV][6];
    float composite[NB][COMPOSITE], velocity[NB][6], acceleration[NB][6];
    float mass[NV][NV], hessian[NV][NV], inverse[NV];
    float smooth[NV], acc[NV], mass_acc[NV], gradient[NV], search[NV], mass_search[NV];
    // Contacts: rows of their frames, J acc - reference, the same of the search, weights, forces.
    Contact contact[MAX_CONTACTS];
    float rows[MAX_CONTACTS][3][NV], residual[MAX_CONTACTS][3], change[MAX_CONTACTS][3];
    float stiffness[MAX_CONTACTS], weight[MAX_CONTACTS][5], force[MAX_CONTACTS][3];
    int active[MAX_CONTACTS];
    unsigned coupled[MAX_CONTACTS];  // of a contact that pushes: the velocities that move it
    float limit_sign[NL], limit_residual[NL], limit_change[NL], limit_stiffness[NL], limit_force[NL];
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

DYNAMICS = """
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
                        turn = turn * (HAS_BALLS && type == BALL ? unit(quaternion(k.qpos + BODY_QPOS[b]))
                                                                 : about(v3(r.joint_axis[b]), moved));
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
CUDA_CALLABLE inline void place_inertia(
    float* out, const float* m, const float* own, V3 offset, float mass, float scale)
{
    const float i[9] = { own[0], own[3], own[4], own[3], own[1], own[5], own[4], own[5], own[2] };
    float half[9];
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            half[3 * row + column]
                = m[3 * row] * i[column] + m[3 * row + 1] * i[3 + column] + m[3 * row + 2] * i[6 + column];
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

// rad, a component of the rotation vector of a ball joint.
CUDA_CALLABLE inline float turn_about(Quaternion q, int axis)
{
    const float part = axis == 0 ? q.x : axis == 1 ? q.y : q.z;
    const float sine = sqrtf(q.x * q.x + q.y * q.y + q.z * q.z);
    if (sine < 1e-12f) return 0.0f;
    // The shorter way round.
    return part / sine * 2.0f * atan2f(q.w < 0.0f ? -sine : sine, magnitude(q.w));
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
        } else if (HAS_BALLS && type == BALL) {
            const float* column = k.xmat[b] + number;
            out.a = { column[0], column[3], column[6] };
            out.l = cross(out.a, com - v3(k.anchor[b]));
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
            if (type == FREE || (HAS_BALLS && type == BALL)) {
                const int from = type == FREE ? first + 3 : first;
                if (type == FREE) v.l = v.l + v3(k.qvel + first);
                V6 spin = { { 0.0f, 0.0f, 0.0f }, { 0.0f, 0.0f, 0.0f } };
                for (int i = from; i < from + 3; ++i) {
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
        }
    }
    EACH(b, NB) {
        float* out = k.composite[b];
        const V6 v = v6(k.velocity[b]);
        place_inertia(out, k.xmat[b], r.body_inertia[b], v3(k.middle[b]) - com, r.body_mass[b], mass_scale);
        put(out + 10, inertia_times(out, v6(k.acceleration[b])) + cross_force(v, inertia_times(out, v)));
    }
    ROLLED for (int level = LEVELS - 2; level > 0; --level) {
        EACH(n, (LEVEL_START[level + 1] - LEVEL_START[level]) * COMPOSITE) {
            const int b = LEVEL_BODY[LEVEL_START[level] + n / COMPOSITE];
            float sum = k.composite[b][n % COMPOSITE];
            for (int c = CHILD_START[b]; c < CHILD_START[b + 1]; ++c) sum += k.composite[CHILD[c]][n % COMPOSITE];
            k.composite[b][n % COMPOSITE] = sum;
        }
    }
    EACH(i, NV) {
        const float* sum = k.composite[DOF_BODY[i]];
        const V6 own = v6(k.dof[i]);
        put(k.inertial[i], inertia_times(sum, own));
        float out = -r.damping[i] * k.qvel[i] - dot(own, v6(sum + 10));
        for (int u = 0; u < NU; ++u)
            if (ACTUATOR_DOF[u] == i) {
                const float ctrl = bound(k.ctrl[u], r.ctrl_range[u][0], r.ctrl_range[u][1]), gear = r.gear[u];
                const float at = HAS_BALLS && ACTUATOR_SPIN[u] >= 0
                    ? turn_about(quaternion(k.qpos + ACTUATOR_QPOS[u]), ACTUATOR_SPIN[u])
                    : k.qpos[ACTUATOR_QPOS[u]];
                float gain = r.gain[u];
                if (AFFINE_GAINS) gain += gear * (r.gain_slope[u][0] * at + r.gain_slope[u][1] * k.qvel[i]);
                const float driven
                    = gain * ctrl + r.bias[u][0] + r.bias[u][1] * gear * at + r.bias[u][2] * gear * k.qvel[i];
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
// Velocities of equal depth do not touch each other, so that lanes take whole depths at once.
CUDA_CALLABLE inline void factorise(Work& k)
{
    if (LANES == 1) {
        for (int d = NV - 1; d >= 0; --d) {
            const float inverse = 1.0f / k.hessian[d][d];
            for (int n = 0; n < DOF_DEPTH[d]; ++n) {
                const int i = DOF_ABOVE[d][n];
                const float share = k.hessian[d][i] * inverse;
                for (int m = 0; m <= n; ++m) k.hessian[i][DOF_ABOVE[d][m]] -= share * k.hessian[d][DOF_ABOVE[d][m]];
            }
            k.inverse[d] = inverse;
        }
        return;
    }
    ROLLED for (int depth = DEPTHS - 1; depth >= 0; --depth) {
        const int first = DEPTH_START[depth], last = DEPTH_START[depth + 1];
        EACH(n, last - first) {
            const int d = DEPTH_DOF[first + n];
            k.inverse[d] = 1.0f / k.hessian[d][d];
        }
        EACH(e, DEPTH_ENTRIES[depth]) {
            const int i = ENTRY_ROW[e], j = ENTRY_COLUMN[e];
            float sum = k.hessian[i][j];
            for (int n = first; n < last; ++n) {
                const int d = DEPTH_DOF[n];
                if (DOF_MASK[d] >> i & 1u) sum -= k.hessian[d][i] * k.inverse[d] * k.hessian[d][j];
            }
            k.hessian[i][j] = sum;
        }
    }
}

// x = hessian^-1 x, factorised before.
CUDA_CALLABLE inline void solve(Work& k, float* x)
{
    if (LANES == 1) {
        for (int d = NV - 1; d >= 0; --d) {
            const float share = k.inverse[d] * x[d];
            for (int n = 0; n < DOF_DEPTH[d]; ++n) x[DOF_ABOVE[d][n]] -= k.hessian[d][DOF_ABOVE[d][n]] * share;
        }
        for (int d = 0; d < NV; ++d) {
            float sum = x[d];
            for (int n = 0; n < DOF_DEPTH[d]; ++n) sum -= k.hessian[d][DOF_ABOVE[d][n]] * x[DOF_ABOVE[d][n]];
            x[d] = sum * k.inverse[d];
        }
        return;
    }
    ROLLED for (int depth = DEPTHS - 1; depth > 0; --depth) {
        EACH(i, NV) {
            float value = x[i];
            bool changed = false;
            for (int n = DEPTH_START[depth]; n < DEPTH_START[depth + 1]; ++n) {
                const int d = DEPTH_DOF[n];
                if (DOF_MASK[d] >> i & 1u) value -= k.hessian[d][i] * k.inverse[d] * x[d], changed = true;
            }
            if (changed) x[i] = value;
        }
    }
    ROLLED for (int depth = 0; depth < DEPTHS; ++depth) {
        EACH(n, DEPTH_START[depth + 1] - DEPTH_START[depth]) {
            const int d = DEPTH_DOF[DEPTH_START[depth] + n];
            float sum = x[d];
            for (int m = 0; m < DOF_DEPTH[d]; ++m) sum -= k.hessian[d][DOF_ABOVE[d][m]] * x[DOF_ABOVE[d][m]];
            x[d] = sum * k.inverse[d];
        }
    }
    sync();
}
"""
