"""Rows of contacts and limits, and the acceleration that they allow, in C++; see `native`."""

SOLVER = """
// Stiffness and damping of a constraint and its impedance at a depth; see MuJoCo's "Solver parameters".
CUDA_CALLABLE inline void impedance(
    const float* solref, const float* p, float dt, float depth, float& k, float& b, float& i)
{
    const float time = larger(solref[0], 2.0f * dt);
    const float low = bound(p[0], 0.0001f, 0.9999f), top = bound(p[1], 0.0001f, 0.9999f);
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

// Jacobians and references of contacts and limits; `residual` is minus the reference.
CUDA_CALLABLE inline void make_rows(Work& k, const Robot& r, V3 com, int contacts)
{
    EACH(n, contacts * NV) {
        const int c = n / NV, i = n % NV;
        const Contact& at = k.contact[c];
        V3 moved = { 0.0f, 0.0f, 0.0f };
        V3 y = { 0.0f, 0.0f, 0.0f }, z = y;
        if (at.moved_by >> i & 1u) {
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
        const float square = at.friction * at.friction;
        if (!at.slippery) weight = (weight + square * weight) * 2.0f * square;
        k.stiffness[c] = stiffness(weight, imp);
        k.residual[c][0] = stiff * imp * at.distance + damp * v[0];
        k.residual[c][1] = damp * v[1];
        k.residual[c][2] = damp * v[2];
    }
    EACH(n, NUM_LIMITS) {
        const float q = k.qpos[LIMIT_QPOS[n]], below = q - r.limit_range[n][0], above = r.limit_range[n][1] - q;
        const float depth = lesser(below, above), sign = below < above ? 1.0f : -1.0f;
        float stiff, damp, imp;
        impedance(r.limit_solref[n], r.limit_solimp[n], r.timestep, depth, stiff, damp, imp);
        k.limit_sign[n] = sign;
        k.limit_stiffness[n] = depth < 0.0f ? stiffness(r.limit_weight[n], imp) : 0.0f;
        k.limit_residual[n] = stiff * imp * depth + damp * sign * k.qvel[LIMIT_DOF[n]];
    }
}

// The rows of a pyramid: normal +- friction times a tangent. A slippery sphere has the normal alone; the others are
// `filled`.
CUDA_CALLABLE inline void pyramid(const Contact& at, const float* x, float filled, float* out)
{
    const float mu = at.friction, n = x[0], y = mu * x[1], z = mu * x[2];
    out[0] = at.slippery ? n : n + y;
    out[1] = at.slippery ? filled : n - y;
    out[2] = at.slippery ? filled : n + z;
    out[3] = at.slippery ? filled : n - z;
}

// Forces of all rows where J acc - reference is `residual`, and with weights how they change with it. Returns, to each
// lane for its own, how many rows began or ceased to push.
CUDA_CALLABLE inline float push(Work& k, int contacts)
{
    float changed = 0.0f;
    EACH(c, contacts) {
        float x[4], f[4], w[4];
        pyramid(k.contact[c], k.residual[c], 1.0f, x);
        int active = 0;
        for (int n = 0; n < 4; ++n) {
            const bool pushes = x[n] < 0.0f;
            active |= pushes << n;
            w[n] = pushes ? k.stiffness[c] : 0.0f;
            f[n] = -w[n] * x[n];
        }
        const float mu = k.contact[c].slippery ? 0.0f : k.contact[c].friction;
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
        k.coupled[c] = active ? k.contact[c].moved_by : 0u;
    }
    EACH(n, NUM_LIMITS) {
        const int active = k.limit_residual[n] < 0.0f && k.limit_stiffness[n] > 0.0f;
        k.limit_force[n] = active ? -k.limit_stiffness[n] * k.limit_residual[n] : 0.0f;
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
        pyramid(k.contact[c], k.residual[c], 1.0f, x);
        pyramid(k.contact[c], k.change[c], 0.0f, p);
        for (int n = 0; n < 4; ++n) {
            const float at = x[n] + step * p[n];
            if (at < 0.0f) first += k.stiffness[c] * at * p[n], second += k.stiffness[c] * p[n] * p[n];
        }
    }
    ROLLED for (int n = lane(); n < NUM_LIMITS; n += LANES) {
        const float at = k.limit_residual[n] + step * k.limit_change[n];
        if (at < 0.0f) {
            first += k.limit_stiffness[n] * at * k.limit_change[n];
            second += k.limit_stiffness[n] * k.limit_change[n] * k.limit_change[n];
        }
    }
    float none = 0.0f;
    total(first, second, none);
}

// How far along the search the cost is least.
CUDA_CALLABLE inline float line_search(
    const Work& k, int contacts, float slope_mass, float curve_mass, float begin, int steps)
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
        k.mass_acc[i] = sum;
        k.acc[i] = k.warm[i];
    }
    EACH(n, contacts * 3) {
        const int c = n / 3, row = n % 3;
        float sum = k.residual[c][row];
        for (int i = 0; i < NV; ++i) sum += k.rows[c][row][i] * k.warm[i];
        k.residual[c][row] = sum;
        if (row == 0) k.active[c] = -1;
    }
    EACH(n, NUM_LIMITS) {
        k.limit_residual[n] += k.limit_sign[n] * k.warm[LIMIT_DOF[n]];
        k.limit_active[n] = -1;
    }
    int iteration = 0;
    push(k, contacts);
    ROLLED while (iteration < set.iterations) {
        float square = 0.0f;
        EACH(i, NV) {
            const float out = k.mass_acc[i] - k.smooth[i] - pushed(k, contacts, i);
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
                if (k.coupled[c] >> i & 1u) {
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
            k.mass_search[i] = sum;
            slope_mass += k.search[i] * (k.mass_acc[i] - k.smooth[i]);
            curve_mass += k.search[i] * sum;
            begin += k.search[i] * k.gradient[i];
        }
        total(slope_mass, curve_mass, begin);
        EACH(n, contacts * 3) {
            const int c = n / 3, row = n % 3;
            float sum = 0.0f;
            for (int i = 0; i < NV; ++i) sum += k.rows[c][row][i] * k.search[i];
            k.change[c][row] = sum;
        }
        EACH(n, NUM_LIMITS) k.limit_change[n] = k.limit_sign[n] * k.search[LIMIT_DOF[n]];
        sync();
        const float step = line_search(k, contacts, slope_mass, curve_mass, begin, set.line_steps);
        EACH(i, NV) {
            k.acc[i] += step * k.search[i];
            k.mass_acc[i] += step * k.mass_search[i];
        }
        EACH(n, contacts * 3) k.residual[n / 3][n % 3] += step * k.change[n / 3][n % 3];
        EACH(n, NUM_LIMITS) k.limit_residual[n] += step * k.limit_change[n];
        // A whole step that no row noticed ends at the minimum of a parabola.
        const float changed = total(push(k, contacts));
        if (changed == 0.0f && step == 1.0f) break;
    }
    sync();
    return iteration;
}
"""
