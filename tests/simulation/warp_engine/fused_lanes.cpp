// Runs a program of the fused step for test_fused.py: a robot drives over a slab and, in its way, a block and an agent.
// With LANES_OF_TEST its lanes are threads, and what CUDA's warp does together is done with barriers.
#include <math.h>

#include <condition_variable>
#include <cstdio>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#define CUDA_CALLABLE

#if defined(LANES_OF_TEST)
#define URBANVERSE_THREADS
#define UV_TABLE static const
constexpr int LANES = LANES_OF_TEST;
static thread_local int own_lane;
static std::mutex door;
static std::condition_variable opened;
static int waiting;
static unsigned long rounds;
static float values[LANES];
static bool flags[LANES];

inline int lane() { return own_lane; }

inline void sync()
{
    std::unique_lock<std::mutex> lock(door);
    const unsigned long round = rounds;
    if (++waiting == LANES) {
        waiting = 0;
        ++rounds;
        opened.notify_all();
    } else {
        opened.wait(lock, [&] { return rounds != round; });
    }
}

inline float total(float x)
{
    values[lane()] = x;
    sync();
    float sum = 0.0f;
    for (float value : values) sum += value;
    sync();
    return sum;
}

inline void total(float& x, float& y, float& z) { x = total(x), y = total(y), z = total(z); }

inline int append(bool wanted, int& count)
{
    flags[lane()] = wanted;
    sync();
    int place = count;
    for (int i = 0; i < LANES; ++i) {
        if (i < lane()) place += flags[i];
        count += flags[i];
    }
    sync();
    return place;
}
#endif

#include "program.h"

using namespace urbanverse;

static std::vector<float> read(const std::string& name)
{
    std::vector<float> out(100000);
    FILE* file = fopen(name.c_str(), "rb");
    out.resize(file ? fread(out.data(), sizeof(float), out.size(), file) : 0);
    if (file) fclose(file);
    return out;
}

static Work work;

int main(int, char** argv)
{
    const std::string folder = std::string(argv[1]) + "/";
    std::vector<float> numbers = read(folder + "numbers"), qpos = read(folder + "qpos"), ctrl = read(folder + "ctrl");
    if (numbers.size() * sizeof(float) != sizeof(Robot) || qpos.size() != NQ || ctrl.size() != NUM_ACTUATORS) return 3;
    // A slab of 20 m x 20 m whose top is at z = 0, and a block of 1 m.
    const float low[2][3] = { { -10.0f, -10.0f, -1.0f }, { -0.5f, -0.5f, 0.0f } };
    const float high[2][3] = { { 10.0f, 10.0f, 0.0f }, { 0.5f, 0.5f, 1.0f } };
    std::vector<float> normal, offset, start, edge, centre, half;
    for (int t = 0; t < 2; ++t)
        for (int axis = 0; axis < 3; ++axis) {
            for (int side = 0; side < 2; ++side) {
                for (int i = 0; i < 3; ++i) normal.push_back(i == axis ? (side ? 1.0f : -1.0f) : 0.0f);
                offset.push_back(side ? high[t][axis] : -low[t][axis]);
            }
            for (int corner = 0; corner < 4; ++corner)
                for (int i = 0; i < 3; ++i) {
                    const int other = i == (axis + 1) % 3 ? corner & 1 : corner >> 1;
                    start.push_back(i == axis ? low[t][i] : other ? high[t][i] : low[t][i]);
                    edge.push_back(i == axis ? high[t][i] - low[t][i] : 0.0f);
                }
        }
    for (int t = 0; t < 2; ++t)
        for (int i = 0; i < 3; ++i) {
            centre.push_back(0.5f * (low[t][i] + high[t][i]));
            half.push_back(0.5f * (high[t][i] - low[t][i]));
        }
    const int planes[] = { 0, 6, 12 }, edges[] = { 0, 12, 24 }, hull[] = { -1, 1, -1, 0, -1 }, owner[] = { -1, 7, -1, -1, -1 };
    const float wide = NUM_ACTUATORS == 4 ? 1.6f : 0.6f;
    const float position[15] = { 0, 0, 0, wide, 0.2f, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }, friction[] = { 1, 1, 1, 1, 1 };
    float rotation[45];
    for (int i = 0; i < 45; ++i) rotation[i] = i % 9 % 4 == 0 ? 1.0f : 0.0f;
    const int present[] = { 1 }, missing[] = { 0, 0 };
    const float place[] = { -1.5f, 0.1f, 0.0f }, heading[] = { 0.2f }, velocity[] = { 0.9f, 0.0f, 0.0f }, turning[] = { 0.1f };
    const float radius[] = { 0.3f }, middle[] = { 0.2f }, height[] = { 1.7f };
    std::vector<float> qvel(NV), warm(NV), xpos(3 * NB), xquat(4 * NB), foot(FEET), path(NQ), force(1);
    int touch[5], hit[1], touched = 0;
    Env e = {};
    const float here[] = { qpos[0], qpos[1], qpos[2] };
    e.qpos = qpos.data(), e.qvel = qvel.data(), e.warm = warm.data(), e.ctrl = ctrl.data(), e.centre = here;
    e.friction_scale = e.mass_scale = 1.0f;
    e.slot_hull = hull, e.slot_owner = owner, e.slot_position = position, e.slot_rotation = rotation;
    e.slot_friction = friction, e.missing = missing;
    e.agent_present = present, e.agent_position = place, e.agent_heading = heading, e.agent_velocity = velocity;
    e.agent_turn_rate = turning, e.agent_radius = radius, e.agent_half = middle, e.agent_height = height;
    e.qpos_out = qpos.data(), e.qvel_out = qvel.data(), e.warm_out = warm.data(), e.xpos = xpos.data();
    e.xquat = xquat.data(), e.force = force.data(), e.foot = foot.data(), e.path = path.data();
    e.touch = touch, e.hit = hit;
    const Hulls hulls = { planes, edges, normal.data(), offset.data(), start.data(), edge.data(), centre.data(), half.data() };
    const Settings settings = { 5, 0, 20, 0, 8, 10 };
    const Robot& robot = *reinterpret_cast<const Robot*>(numbers.data());
    for (int step = 0; step < 6; ++step) {
#if defined(LANES_OF_TEST)
        std::vector<std::thread> lanes;
        for (int i = 0; i < LANES; ++i)
            lanes.emplace_back([&, i] {
                own_lane = i;
                control_step(work, robot, hulls, e, settings);
            });
        for (std::thread& one : lanes) one.join();
#else
        control_step(work, robot, hulls, e, settings);
#endif
        touched += touch[2];
        for (int i = 0; i < NQ; ++i) printf("%.6g ", qpos[i]);
        printf("%.6g %d %d %d\n", force[0] * 1e-4f, touch[0], touch[4], touched);
    }
}
