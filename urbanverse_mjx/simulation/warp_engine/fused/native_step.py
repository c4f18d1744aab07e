"""Touches, integration and the control step in C++; see `native`."""

STEP = """
struct Touch {
    float force, agent_force;
    int owner, ground, count, missed, agent;
};

// Adds the touches of a physics step; see `kernels.note`.
CUDA_CALLABLE inline void note(Work& k, Touch& t, int found)
{
    const int contacts = found < MAX_CONTACTS ? found : MAX_CONTACTS;
    EACH(f, NUM_FEET) {
        for (int c = 0; c < contacts; ++c)
            if (k.contact[c].foot == f) k.foot[f] += k.force[c][0];
    }
    bool touched = false;
    float strength = -1.0f;
    int strongest = NONE;
    for (int c = 0; c < contacts; ++c) {
        const int owner = k.contact[c].owner;
        const float force = k.force[c][0];
        if (owner == GROUND && k.contact[c].foot >= 0) continue;
        touched = true;
        if (owner == GROUND) t.ground = 1;
        if (owner <= FIRST_AGENT && (force > t.agent_force || t.agent < 0))
            t.agent = FIRST_AGENT - owner, t.agent_force = force;
        if (force > strength) strength = force, strongest = owner;
    }
    if (touched) {
        if (strength > t.force || t.count == 0) t.owner = strongest;
        t.force = larger(t.force, strength);
        ++t.count;
    }
    if (found - MAX_CONTACTS > t.missed) t.missed = found - MAX_CONTACTS;
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
        } else if (HAS_BALLS && BODY_JOINT[b] == BALL) {
            const V3 spin = v3(v);
            const float speed = sqrtf(dot(spin, spin));
            put(q, unit(unit(quaternion(q)) * about(unit(spin), dt * speed)));
        } else if (BODY_JOINT[b] != FIXED) {
            q[0] += dt * v[0];
        }
    }
}

// What a coordinate is shifted by in the world.
CUDA_CALLABLE inline float shift(int i, V3 origin)
{
    return i == ROOT_QPOS ? origin.x : i == ROOT_QPOS + 1 ? origin.y : 0.0f;
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
        for (int i = 0; i < 3; ++i)
            k.xpos[0][i] = k.acceleration[0][i] = 0.0f, k.acceleration[0][3 + i] = -r.gravity[i];
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
        const int found = find_contacts(k, r, hulls, e, set, occupied);
        const int contacts = found < MAX_CONTACTS ? found : MAX_CONTACTS;
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
            EACH(i, NQ) e.path[step * NQ + i] = k.qpos[i] + shift(i, origin);
            if (lane() == 0) e.hit[step] = t.count - before;
        }
    }
    EACH(i, NQ) e.qpos_out[i] = k.qpos[i] + shift(i, origin);
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
