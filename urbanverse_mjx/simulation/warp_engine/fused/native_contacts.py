"""Contacts of spheres with hulls and agents in C++, by the rules of `contact` and `agents`; see `native`."""

CONTACTS = """
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

// Adds contacts of the listed candidates, in their order; `count` may exceed MAX_CONTACTS.
CUDA_CALLABLE inline void test_candidates(
    Work& k, const Robot& r, const Hulls& hulls, const Env& e, const Settings& set, int number, int agents_from,
    int& count)
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
            out.foot = SPHERE_FOOT[s];
            out.slippery = SPHERE_SLIPPERY[s];
            out.moved_by = BODY_MASK[SPHERE_BODY[s]];
            out.inward = -1.0f * normal;
            out.position = centre + (radius + 0.5f * out.distance) * out.inward;
            out.friction = friction_of(r, s, other, set, e.friction_scale);
        }
        const bool touches = out.distance < 0.0f;
        const int place = append(touches, count);
        if (touches && place < MAX_CONTACTS) k.contact[place] = out;
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
