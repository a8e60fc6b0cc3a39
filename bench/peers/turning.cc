/* turning.cc - bodies that turn, by us and by FCL, side by side in one run.
 *
 * Room:     bench/peers.
 * Does:     ask of the same motions: does anything meet anything on the way? FCL is asked
 *           at evenly spaced poses, as planners do; ours says free, hit or possible. Tell
 *           the times of both and the hits that poses miss. Tell, too, how long steps of
 *           many bodies take beside the same with bodies that go straight (games).
 * Does not: use FCL's own continuous test: between two meshes it finds no hit (0.7).
 */
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>

#include <jansson.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "pccd.h"

extern "C" {
#include "bench_scene.h"
}

namespace
{

using vector = fcl::Vector3d;
using transform = fcl::Transform3d;
using model = fcl::BVHModel<fcl::OBBRSSd>;

void must(int status, const char *what)
{
    if (status != PCCD_OK) {
        std::fprintf(stderr, "turning: %s: %s\n", what, pccd_status_name(status));
        std::exit(2);
    }
}

double now_ms()
{
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration<double, std::milli>(now).count();
}

struct mesh {
    std::vector<vector> x;
    std::vector<std::array<uint32_t, 3>> faces;

    std::shared_ptr<model> bvh() const
    {
        auto made = std::make_shared<model>();
        made->beginModel(int(faces.size()), int(x.size()));
        for (const auto &face : faces) {
            made->addTriangle(x[face[0]], x[face[1]], x[face[2]]);
        }
        made->endModel();
        return made;
    }
};

// A closed grid of rings, with a pole at each end: 2 around (rings - 1) triangles.
template <typename place> mesh closed(uint32_t rings, uint32_t around, place at)
{
    mesh made;
    made.x.push_back(at(0., 0.));
    for (uint32_t ring = 1; ring < rings; ring++) {
        for (uint32_t k = 0; k < around; k++) {
            made.x.push_back(at(double(ring) / rings, double(k) / around));
        }
    }
    made.x.push_back(at(1., 0.));
    const auto vertex = [&](uint32_t ring, uint32_t k) {
        return 1 + (ring - 1) * around + k % around;
    };
    const uint32_t last = uint32_t(made.x.size()) - 1;
    for (uint32_t k = 0; k < around; k++) {
        made.faces.push_back({0, vertex(1, k + 1), vertex(1, k)});
        for (uint32_t ring = 1; ring + 1 < rings; ring++) {
            made.faces.push_back(
                {vertex(ring, k), vertex(ring, k + 1), vertex(ring + 1, k)});
            made.faces.push_back(
                {vertex(ring, k + 1), vertex(ring + 1, k + 1), vertex(ring + 1, k)});
        }
        made.faces.push_back({last, vertex(rings - 1, k), vertex(rings - 1, k + 1)});
    }
    return made;
}

mesh bumpy(uint32_t rings, uint32_t around, double bump)
{
    return closed(rings, around, [=](double u, double v) {
        const double a = M_PI * u, b = 2 * M_PI * v;
        const double r = 1 + bump * std::sin(5 * a) * std::cos(4 * b);
        return vector(r * std::sin(a) * std::cos(b), r * std::sin(a) * std::sin(b),
                      r * std::cos(a));
    });
}

// A rod along x, from 0 to `length`.
mesh rod(double length, double radius)
{
    return closed(16, 16, [=](double u, double v) {
        const double b = 2 * M_PI * v, r = radius * std::sqrt(std::sin(M_PI * u));
        return vector(length * (1 - u), r * std::cos(b), r * std::sin(b));
    });
}

// The inside of a box: six walls of n by n squares.
mesh walls(uint32_t n, double half)
{
    mesh made;
    for (int axis = 0; axis < 3; axis++) {
        for (int side = -1; side <= 1; side += 2) {
            const uint32_t base = uint32_t(made.x.size());
            for (uint32_t i = 0; i <= n; i++) {
                for (uint32_t k = 0; k <= n; k++) {
                    vector x;
                    x[axis] = side * half;
                    x[(axis + 1) % 3] = half * (2. * i / n - 1);
                    x[(axis + 2) % 3] = half * (2. * k / n - 1);
                    made.x.push_back(x);
                }
            }
            for (uint32_t i = 0; i < n; i++) {
                for (uint32_t k = 0; k < n; k++) {
                    const uint32_t a = base + i * (n + 1) + k, b = a + n + 1;
                    made.faces.push_back({a, b, a + 1});
                    made.faces.push_back({b, b + 1, a + 1});
                }
            }
        }
    }
    return made;
}

mesh read_obj(const std::string &path)
{
    mesh made;
    std::ifstream file(path);
    std::string line;
    while (std::getline(file, line)) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "v") {
            double x, y, z;
            words >> x >> y >> z;
            made.x.emplace_back(x, y, z);
        } else if (word == "f") {
            std::vector<uint32_t> corners;
            while (words >> word) {
                corners.push_back(uint32_t(std::stoul(word)) - 1);
            }
            for (size_t i = 2; i < corners.size(); i++) {
                made.faces.push_back({corners[0], corners[i - 1], corners[i]});
            }
        }
    }
    if (made.faces.empty()) {
        std::fprintf(stderr, "turning: %s: no faces\n", path.c_str());
        std::exit(77);
    }
    return made;
}

// ---- bodies on joints -----------------------------------------------------------------

struct body {
    mesh shape;
    uint32_t joint = PCCD_NO_JOINT; // of the chain
    std::shared_ptr<model> bvh;
    std::vector<vector> x[2]; // at both ends, of one that deforms unless it turns
};

pccd_joint joint_at(uint32_t parent, const vector &position,
                    const Eigen::Quaterniond &turn)
{
    pccd_joint joint = {};
    joint.kind = PCCD_JOINT_FIXED;
    joint.parent = parent;
    for (int i = 0; i < 3; i++) {
        joint.position[i] = position[i];
    }
    joint.rotation[0] = turn.x();
    joint.rotation[1] = turn.y();
    joint.rotation[2] = turn.z();
    joint.rotation[3] = turn.w();
    return joint;
}

transform pose_of(const std::vector<pccd_joint> &joints, uint32_t of, double t)
{
    transform pose = transform::Identity();
    for (uint32_t i = of; i != PCCD_NO_JOINT; i = joints[i].parent) {
        const pccd_joint &joint = joints[i];
        transform own = transform::Identity();
        const double q = joint.from[0] + t * (joint.to[0] - joint.from[0]);
        own.translate(vector(joint.position[0], joint.position[1], joint.position[2]));
        own.rotate(Eigen::Quaterniond(joint.rotation[3], joint.rotation[0],
                                      joint.rotation[1], joint.rotation[2]));
        const vector axis(joint.axis[0], joint.axis[1], joint.axis[2]);
        if (joint.kind == PCCD_JOINT_TURN) {
            own.rotate(Eigen::AngleAxisd(q, axis.normalized()));
        } else if (joint.kind == PCCD_JOINT_SLIDE) {
            own.translate(axis.normalized() * q);
        } else if (joint.kind == PCCD_JOINT_SHIFT) {
            own.translate(vector(q, joint.from[1] + t * (joint.to[1] - joint.from[1]),
                                 joint.from[2] + t * (joint.to[2] - joint.from[2])));
        }
        pose = own * pose;
    }
    return pose;
}

// Bodies, the pairs of them that may meet, and motions of their joints.
struct world {
    std::vector<body> bodies;
    std::set<std::pair<size_t, size_t>> apart; // need no test
    std::vector<std::vector<pccd_joint>> motions;

    bool may_meet(size_t a, size_t b) const
    {
        const bool stands =
            bodies[a].joint == PCCD_NO_JOINT && bodies[b].joint == PCCD_NO_JOINT;
        return !stands && bodies[a].joint != bodies[b].joint && apart.count({a, b}) == 0;
    }
    void prepare()
    {
        for (auto &each : bodies) {
            each.bvh = each.shape.bvh();
        }
    }
};

bool fcl_hits(const world &in, const std::vector<pccd_joint> &joints, int samples)
{
    const fcl::CollisionRequestd request(1, false);
    std::vector<transform> poses(in.bodies.size());
    for (int i = 0; i <= samples; i++) {
        for (size_t k = 0; k < in.bodies.size(); k++) {
            poses[k] = pose_of(joints, in.bodies[k].joint, double(i) / samples);
        }
        for (size_t a = 0; a < in.bodies.size(); a++) {
            for (size_t b = a + 1; b < in.bodies.size(); b++) {
                fcl::CollisionResultd result;
                if (in.may_meet(a, b) &&
                    fcl::collide(in.bodies[a].bvh.get(), poses[a], in.bodies[b].bvh.get(),
                                 poses[b], request, result) > 0) {
                    return true;
                }
            }
        }
    }
    return false;
}

// ---- ours -----------------------------------------------------------------------------

struct answers {
    double ms = 0; // of all motions
    std::vector<int> verdicts;
};

// A scene of a daemon's engine in this process.
struct scene {
    pccd_client *client;
    uint32_t handle = 0;
    std::vector<uint32_t> objects;
    std::vector<uint32_t> meshes;

    scene(pccd_client *of, const world &in) : client(of)
    {
        must(pccd_scene_create(client, nullptr, &handle), "scene");
        for (const auto &each : in.bodies) {
            uint32_t mesh, object;
            must(pccd_mesh_create(
                     client, each.shape.x.data(), PCCD_FORMAT_F64,
                     uint32_t(each.shape.x.size()),
                     reinterpret_cast<const uint32_t(*)[3]>(each.shape.faces.data()),
                     uint32_t(each.shape.faces.size()), &mesh, nullptr),
                 "mesh");
            must(pccd_scene_add(client, handle, mesh, &object), "object");
            pccd_object_settings settings = {};
            settings.struct_bytes = sizeof settings;
            settings.what = PCCD_OBJECT_SELF;
            must(pccd_object_set(client, handle, object, &settings), "no self-collision");
            meshes.push_back(mesh);
            objects.push_back(object);
        }
        for (size_t a = 0; a < objects.size(); a++) {
            for (size_t b = a + 1; b < objects.size(); b++) {
                if (!in.may_meet(a, b)) {
                    must(pccd_pair_ignore(client, handle, objects[a], objects[b], true),
                         "pair");
                }
            }
        }
    }
    ~scene()
    {
        (void)pccd_scene_destroy(client, handle);
        for (uint32_t mesh : meshes) {
            (void)pccd_mesh_destroy(client, mesh);
        }
    }
    // Move straight between the poses at both ends (then without joints), or turn; bodies
    // of odd numbers alone where half do. Returns the verdict, -1 if it is not complete.
    int step(const world &in, const std::vector<pccd_joint> &joints, bool is_straight,
             const pccd_step_settings &settings, bool is_half = false)
    {
        pccd_frame frame;
        pccd_answer answer{};
        uint64_t step;
        const uint32_t joint_count = uint32_t(joints.size());
        uint64_t room = joint_count * sizeof(pccd_joint) + objects.size() * 192;
        for (const auto &each : in.bodies) {
            room += 2 * each.x[0].size() * sizeof(vector);
        }
        answer.struct_bytes = sizeof answer;
        must(
            pccd_frame_begin(client, handle, uint32_t(objects.size()), 16 + room, &frame),
            "frame");
        if (!is_straight) {
            must(pccd_frame_joints(&frame, joints.data(), joint_count), "joints");
        }
        for (size_t i = 0; i < objects.size(); i++) {
            const uint32_t count = uint32_t(in.bodies[i].shape.x.size());
            if (in.bodies[i].joint == PCCD_NO_JOINT) {
                continue;
            }
            if (!is_straight && (!is_half || i % 2 == 1)) {
                must(pccd_frame_turning(&frame, objects[i], in.bodies[i].joint, count),
                     "body");
                continue;
            }
            const std::vector<vector> *x = in.bodies[i].x;
            if (!x[0].empty()) {
                void *to[2];
                must(pccd_frame_x0x1(&frame, objects[i], PCCD_FORMAT_F64, 0, count,
                                     &to[0], &to[1]),
                     "body");
                for (int end = 0; end < 2; end++) {
                    std::memcpy(to[end], x[end].data(), count * sizeof x[end][0]);
                }
                continue;
            }
            double m[2][12];
            for (int end = 0; end < 2; end++) {
                const transform pose = pose_of(joints, in.bodies[i].joint, end);
                for (int k = 0; k < 12; k++) {
                    m[end][k] = pose.matrix()(k / 4, k % 4);
                }
            }
            must(pccd_frame_rigid(&frame, objects[i], 0, count, m[0], m[1]), "body");
        }
        must(pccd_frame_commit(&frame, &settings, &step), "step");
        must(pccd_wait(client, step, -1, &answer), "answer");
        const int verdict = answer.incomplete != 0 ? -1 : int(answer.verdict);
        pccd_answer_release(client, &answer);
        return verdict;
    }
};

pccd_step_settings one_thread(pccd_mode mode)
{
    pccd_step_settings settings = {};
    settings.struct_bytes = sizeof settings;
    settings.mode = mode;
    settings.threads = 1;
    return settings;
}

pccd_client *connect()
{
    static pccd_client *client = nullptr;
    if (client == nullptr) {
        pccd_options options = {};
        options.struct_bytes = sizeof options;
        options.url = "direct:";
        must(pccd_connect(&options, &client), "connect");
    }
    return client;
}

// Trees are made by the first motion, which is asked twice.
answers ask(const world &in)
{
    scene ours(connect(), in);
    answers found;
    const pccd_step_settings settings = one_thread(PCCD_MODE_ANY);
    (void)ours.step(in, in.motions[0], false, settings);
    const double begin = now_ms();
    for (const auto &joints : in.motions) {
        found.verdicts.push_back(ours.step(in, joints, false, settings));
    }
    found.ms = now_ms() - begin;
    return found;
}

// ---- what is asked --------------------------------------------------------------------

// A bumpy body of 5000 triangles that turns by up to 3 rad, and goes, beside its like.
world two_bodies(int motions)
{
    world made;
    made.bodies.resize(2);
    made.bodies[0].shape = bumpy(51, 50, 0.3);
    made.bodies[1].shape = made.bodies[0].shape;
    made.bodies[1].joint = 1;
    std::mt19937_64 dice(50);
    std::uniform_real_distribution<double> some(-1, 1);
    std::normal_distribution<double> any(0, 1);
    while (int(made.motions.size()) < motions) {
        const vector side = vector(any(dice), any(dice), any(dice)).normalized();
        const vector way = vector(any(dice), any(dice), any(dice)).normalized();
        const Eigen::Quaterniond turn(any(dice), any(dice), any(dice), any(dice));
        std::vector<pccd_joint> joints(2);
        joints[0] = joint_at(PCCD_NO_JOINT, side * 3, Eigen::Quaterniond::Identity());
        joints[0].kind = PCCD_JOINT_SHIFT;
        joints[1] = joint_at(0, vector::Zero(), turn.normalized());
        joints[1].kind = PCCD_JOINT_TURN;
        for (int i = 0; i < 3; i++) {
            joints[0].to[i] = -1.2 * side[i] * std::abs(some(dice)) + 0.5 * some(dice);
            joints[1].axis[i] = way[i];
        }
        joints[1].to[0] = 3 * std::abs(some(dice));
        made.motions.push_back(joints);
    }
    made.prepare();
    return made;
}

// Six links of 480 triangles in a cell of 11 532, edges of up to 0.8 rad a joint.
world arm_in_cell(int motions)
{
    world made;
    made.bodies.resize(7);
    made.bodies[0].shape = walls(31, 3.5);
    for (uint32_t i = 0; i < 6; i++) {
        made.bodies[i + 1].shape = rod(0.9, 0.12);
        made.bodies[i + 1].joint = i;
        if (i > 0) {
            made.apart.insert({i, i + 1});
        }
    }
    made.prepare();
    std::mt19937_64 dice(51);
    std::uniform_real_distribution<double> some(-1, 1);
    while (int(made.motions.size()) < motions) {
        std::vector<pccd_joint> joints(6);
        for (uint32_t i = 0; i < 6; i++) {
            joints[i] =
                joint_at(i == 0 ? PCCD_NO_JOINT : i - 1, vector(i == 0 ? 0 : 1, 0, 0),
                         Eigen::Quaterniond::Identity());
            joints[i].kind = PCCD_JOINT_TURN;
            joints[i].axis[i % 2 == 0 ? 2 : 1] = 1;
            joints[i].from[0] = joints[i].to[0] = 1.2 * some(dice);
        }
        // As planners do: an edge begins where nothing meets.
        if (!fcl_hits(made, joints, 1)) {
            for (auto &joint : joints) {
                joint.to[0] += 0.8 * some(dice);
            }
            made.motions.push_back(joints);
        }
    }
    return made;
}

// ---- rows -----------------------------------------------------------------------------

void compare(const char *name, const std::vector<world> &in)
{
    std::vector<std::pair<const world *, const std::vector<pccd_joint> *>> all;
    answers ours;
    for (const auto &each : in) {
        const answers some = ask(each);
        ours.ms += some.ms;
        ours.verdicts.insert(ours.verdicts.end(), some.verdicts.begin(),
                             some.verdicts.end());
        for (const auto &joints : each.motions) {
            all.emplace_back(&each, &joints);
        }
    }
    const size_t count = all.size();
    size_t hit = 0, possible = 0;
    for (int verdict : ours.verdicts) {
        hit += verdict == PCCD_VERDICT_YES;
        possible += verdict != PCCD_VERDICT_YES && verdict != PCCD_VERDICT_NO;
    }
    std::printf("%s, %zu motions\n", name, count);
    std::printf("  %-22s %10.4f ms a motion, %zu hit, %zu possible, %zu free\n", "ours",
                ours.ms / double(count), hit, possible, count - hit - possible);
    for (int samples : {10, 40, 100, 1000}) {
        size_t hits = 0, missed = 0, disputed = 0;
        const double begin = now_ms();
        for (size_t i = 0; i < count; i++) {
            const bool found = fcl_hits(*all[i].first, *all[i].second, samples);
            hits += found;
            missed += !found && ours.verdicts[i] == PCCD_VERDICT_YES;
            disputed += found && ours.verdicts[i] == PCCD_VERDICT_NO;
        }
        const double ms = now_ms() - begin;
        std::printf("  FCL, %4d poses %7s %10.4f ms a motion, %zu hit, %zu hits missed, "
                    "%zu that we call free; %.1f times ours\n",
                    samples, "", ms / double(count), hits, missed, disputed,
                    ms / ours.ms);
    }
}

// ---- Panda: 140 problems in joint space -----------------------------------------------

struct panda_link {
    const char *name;
    const char *file;
    uint32_t joint;
};

// The URDF's joints: where each is in its parent's frame; the first seven turn about z.
const double panda_joints[][6] = {
    {0, 0, 0.333, 0, 0, 0},
    {0, 0, 0, -1.57079632679, 0, 0},
    {0, -0.316, 0, 1.57079632679, 0, 0},
    {0.0825, 0, 0, 1.57079632679, 0, 0},
    {-0.0825, 0.384, 0, -1.57079632679, 0, 0},
    {0, 0, 0, 1.57079632679, 0, 0},
    {0.088, 0, 0, 1.57079632679, 0, 0},
    {0, 0, 0.107, 0, 0, 0},
    {0, 0, 0, 0, 0, -0.785398163397},
    {0, 0.065, 0.0584, 0, 0, 0},
    {0, -0.065, 0.0584, 0, 0, 0},
    {0, 0, 0, 0, 0, 3.14159265359},
};
const uint32_t panda_parents[] = {PCCD_NO_JOINT, 0, 1, 2, 3, 4, 5, 6, 7, 8, 8, 10};
const panda_link panda_links[] = {
    {"panda_link0", "link0.obj", PCCD_NO_JOINT},
    {"panda_link1", "link1.obj", 0},
    {"panda_link2", "link2.obj", 1},
    {"panda_link3", "link3.obj", 2},
    {"panda_link4", "link4.obj", 3},
    {"panda_link5", "link5.obj", 4},
    {"panda_link6", "link6.obj", 5},
    {"panda_link7", "link7.obj", 6},
    {"panda_hand", "hand.obj", 8},
    {"panda_leftfinger", "finger.obj", 9},
    {"panda_rightfinger", "finger.obj", 11},
};

mesh box_of(const double size[3])
{
    mesh made;
    for (uint32_t i = 0; i < 8; i++) {
        made.x.emplace_back(size[0] * ((i & 1) - 0.5), size[1] * ((i >> 1 & 1) - 0.5),
                            size[2] * ((i >> 2 & 1) - 0.5));
    }
    for (const auto &quad : {std::array<uint32_t, 4>{0, 2, 3, 1},
                             {4, 5, 7, 6},
                             {0, 1, 5, 4},
                             {2, 6, 7, 3},
                             {0, 4, 6, 2},
                             {1, 3, 7, 5}}) {
        made.faces.push_back({quad[0], quad[1], quad[2]});
        made.faces.push_back({quad[0], quad[2], quad[3]});
    }
    return made;
}

mesh cylinder_of(double height, double radius)
{
    return closed(3, 32, [=](double u, double v) {
        const double b = 2 * M_PI * v, r = u == 0 || u == 1 ? 0 : radius;
        return vector(r * std::cos(b), r * std::sin(b),
                      u < 0.5 ? height / 2 : -height / 2);
    });
}

void take(double *to, size_t count, const json_t *from)
{
    for (size_t i = 0; i < count; i++) {
        to[i] = json_number_value(json_array_get(from, i));
    }
}

std::vector<pccd_joint> panda_motion(const json_t *problem)
{
    std::vector<pccd_joint> joints;
    double start[7], goal[7], fingers[2];
    take(start, 7, json_object_get(problem, "start"));
    take(goal, 7, json_object_get(problem, "goal"));
    take(fingers, 2, json_object_get(problem, "fingers"));
    for (size_t i = 0; i < std::size(panda_joints); i++) {
        const double *at = panda_joints[i];
        const Eigen::Quaterniond turn = Eigen::AngleAxisd(at[5], vector::UnitZ()) *
                                        Eigen::AngleAxisd(at[4], vector::UnitY()) *
                                        Eigen::AngleAxisd(at[3], vector::UnitX());
        vector position(at[0], at[1], at[2]);
        position[1] = i == 9 ? fingers[0] : i == 10 ? -fingers[1] : position[1];
        joints.push_back(joint_at(panda_parents[i], position, turn));
        if (i < 7) {
            joints[i].kind = PCCD_JOINT_TURN;
            joints[i].axis[2] = 1;
            joints[i].from[0] = start[i];
            joints[i].to[0] = goal[i];
        }
    }
    return joints;
}

mesh obstacle_of(const json_t *from)
{
    double size[3] = {}, position[3], turn[4];
    const std::string type = json_string_value(json_object_get(from, "type"));
    take(size, type == "box" ? 3 : 2, json_object_get(from, "dimensions"));
    take(position, 3, json_object_get(from, "position"));
    take(turn, 4, json_object_get(from, "orientation_xyzw"));
    mesh made = type == "box" ? box_of(size) : cylinder_of(size[0], size[1]);
    transform pose = transform::Identity();
    pose.translate(vector(position[0], position[1], position[2]));
    pose.rotate(Eigen::Quaterniond(turn[3], turn[0], turn[1], turn[2]).normalized());
    for (auto &x : made.x) {
        x = pose * x;
    }
    return made;
}

// A problem: the robot, the obstacles, the straight way in joint space.
world panda_world(const std::string &folder, const json_t *problem, const json_t *allowed)
{
    static std::map<std::string, mesh> files;
    world in;
    for (const auto &link : panda_links) {
        if (files.count(link.file) == 0) {
            files[link.file] = read_obj(folder + "/" + link.file);
        }
        in.bodies.push_back({files[link.file], link.joint, nullptr, {}});
    }
    std::map<std::string, size_t> numbers;
    for (size_t i = 0; i < std::size(panda_links); i++) {
        numbers[panda_links[i].name] = i;
    }
    size_t i;
    const json_t *each;
    json_array_foreach(allowed, i, each)
    {
        const size_t a = numbers.at(json_string_value(json_array_get(each, 0)));
        const size_t b = numbers.at(json_string_value(json_array_get(each, 1)));
        in.apart.insert({std::min(a, b), std::max(a, b)});
    }
    json_array_foreach(json_object_get(problem, "obstacles"), i, each)
    {
        in.bodies.push_back({obstacle_of(each), PCCD_NO_JOINT, nullptr, {}});
    }
    in.motions.push_back(panda_motion(problem));
    in.prepare();
    return in;
}

void panda(const std::string &folder, bool is_smoke)
{
    std::ifstream problems(folder + "/problems.jsonl");
    std::string line;
    json_t *root = json_load_file((folder + "/allowed.json").c_str(), 0, nullptr);
    std::vector<world> worlds;
    while (std::getline(problems, line) && !(is_smoke && worlds.size() == 2)) {
        json_t *problem = json_loads(line.c_str(), 0, nullptr);
        worlds.push_back(panda_world(folder, problem, json_object_get(root, "allowed")));
        json_decref(problem);
    }
    json_decref(root);
    if (worlds.empty()) {
        std::printf("Panda: skipped, %s has no problems\n", folder.c_str());
        return;
    }
    compare("Panda, start to goal", worlds);
}

// ---- beside steps of the same bodies that go straight ---------------------------------

mesh level(uint32_t n, double half)
{
    mesh made;
    for (uint32_t i = 0; i <= n; i++) {
        for (uint32_t k = 0; k <= n; k++) {
            const double x = half * (2. * i / n - 1), y = half * (2. * k / n - 1);
            made.x.emplace_back(x, y, 2 * std::sin(0.3 * x) * std::cos(0.2 * y));
        }
    }
    for (uint32_t i = 0; i < n; i++) {
        for (uint32_t k = 0; k < n; k++) {
            const uint32_t a = i * (n + 1) + k, b = a + n + 1;
            made.faces.push_back({a, b, a + 1});
            made.faces.push_back({b, b + 1, a + 1});
        }
    }
    return made;
}

// Bodies of a shape, each on a shift and a turn of its own.
void add_spinning(world &to, const mesh &shape, const vector &at, const vector &way,
                  const vector &axis, double angle)
{
    body each;
    each.shape = shape;
    auto &joints = to.motions[0];
    joints.push_back(joint_at(PCCD_NO_JOINT, at, Eigen::Quaterniond::Identity()));
    joints.back().kind = PCCD_JOINT_SHIFT;
    joints.push_back(joint_at(uint32_t(joints.size()) - 1, vector::Zero(),
                              Eigen::Quaterniond::Identity()));
    joints.back().kind = PCCD_JOINT_TURN;
    for (int i = 0; i < 3; i++) {
        joints[joints.size() - 2].to[i] = way[i];
        joints.back().axis[i] = axis[i];
    }
    joints.back().to[0] = angle;
    each.joint = uint32_t(joints.size()) - 1;
    to.bodies.push_back(each);
}

// Rocks of 80 triangles at 60 Hz over a level of 99 458.
world rocks(int count)
{
    world made;
    made.motions.resize(1);
    made.bodies.resize(1);
    made.bodies[0].shape = level(223, 50);
    std::mt19937_64 dice(52);
    std::uniform_real_distribution<double> some(-1, 1);
    const mesh rock = bumpy(5, 10, 0.2);
    for (int i = 0; i < count; i++) {
        const double x = 45 * some(dice), y = 45 * some(dice);
        const double ground = 2 * std::sin(0.3 * x) * std::cos(0.2 * y);
        add_spinning(made, rock, vector(x, y, ground + 1.4 + 0.3 * some(dice)),
                     vector(some(dice), some(dice), -1) * 0.1,
                     vector(some(dice), some(dice), 1), 0.1 * some(dice));
    }
    return made;
}

// Balls of 320 triangles that go by `way` at most along each axis.
world balls(int side, double way, bool deform)
{
    world made;
    made.motions.resize(1);
    std::mt19937_64 dice(53);
    std::uniform_real_distribution<double> some(-1, 1);
    const mesh ball = bumpy(11, 16, 0);
    for (int i = 0; i < side * side * side; i++) {
        add_spinning(made, ball,
                     vector(i % side, i / side % side, i / side / side) * 2.2,
                     vector(some(dice), some(dice), some(dice)) * way,
                     vector(some(dice), some(dice), 1), 0.3 * some(dice));
    }
    for (int end = 0; end < 2 && deform; end++) {
        for (auto &each : made.bodies) {
            const transform pose = pose_of(made.motions[0], each.joint, end);
            for (const auto &x : each.shape.x) {
                each.x[end].push_back(pose * x);
            }
        }
    }
    return made;
}

// The recorded n-body: each ball an object on a shift, and on a turn of up to 0.3 rad, or
// as it has deformed. Without bodies if there is no $PCCD_DATA.
world recorded_balls()
{
    const char *const names[2] = {"n-body-simulation/frames/balls16_18.ply",
                                  "n-body-simulation/frames/balls16_19.ply"};
    world made;
    bench_scene all{};
    bench_frames frames{};
    made.motions.resize(1);
    if (std::getenv("PCCD_DATA") == nullptr || !bench_read_recorded(&all, names, 1)) {
        return made;
    }
    bench_frames_init(&frames, &all, 0);
    const bench_object &object = all.objects[0];
    std::vector<uint32_t> up, number(all.vertex_count);
    for (uint32_t v = 0; v < all.vertex_count; v++) {
        up.push_back(v);
    }
    const auto root = [&](uint32_t v) {
        while (up[v] != v) {
            v = up[v] = up[up[v]];
        }
        return v;
    };
    for (uint32_t i = 0; i < object.triangle_count; i++) {
        const auto &v = object.triangles[i];
        up[root(v[1])] = root(v[0]);
        up[root(v[2])] = root(v[0]);
    }
    std::map<uint32_t, body> balls;
    for (uint32_t v = 0; v < all.vertex_count; v++) {
        body &ball = balls[root(v)];
        number[v] = uint32_t(ball.x[0].size());
        for (int end = 0; end < 2; end++) {
            ball.x[end].emplace_back(frames.x[end][v]);
        }
    }
    for (uint32_t i = 0; i < object.triangle_count; i++) {
        const auto &v = object.triangles[i];
        balls[root(v[0])].shape.faces.push_back(
            {number[v[0]], number[v[1]], number[v[2]]});
    }
    std::mt19937_64 dice(7);
    std::uniform_real_distribution<double> some(-1, 1);
    for (auto &each : balls) {
        body &ball = each.second;
        vector middle[2] = {vector::Zero(), vector::Zero()};
        for (int end = 0; end < 2; end++) {
            for (const vector &x : ball.x[end]) {
                middle[end] += x / double(ball.x[end].size());
            }
        }
        for (const vector &x : ball.x[0]) {
            ball.shape.x.push_back(x - middle[0]);
        }
        add_spinning(made, ball.shape, middle[0], middle[1] - middle[0],
                     vector(some(dice), some(dice), 1), 0.3 * some(dice));
        made.bodies.back().x[0] = ball.x[0];
        made.bodies.back().x[1] = ball.x[1];
    }
    bench_frames_deinit(&frames);
    bench_scene_free(&all);
    return made;
}

// A part on a hinge, which it turns about once, and six around it: 35 000 triangles.
world hinge(bool is_straight)
{
    world made;
    made.motions.resize(1);
    const mesh part = bumpy(51, 50, 0.1);
    for (int i = 1; i < 7; i++) {
        body each;
        each.shape = part;
        const double angle = 2 * M_PI * i / 7;
        for (auto &x : each.shape.x) {
            x += vector(5 * std::cos(angle), 5 * std::sin(angle), i == 4 ? 0.5 : 2.4);
        }
        made.bodies.push_back(each);
    }
    mesh arm = part;
    for (auto &x : arm.x) {
        x[0] += 5;
    }
    const vector way = 5 * vector(std::cos(8 * M_PI / 7) - 1, std::sin(8 * M_PI / 7), 0);
    add_spinning(made, arm, vector::Zero(), is_straight ? way : vector(0, 0, 0),
                 vector(0, 0, 1), is_straight ? 0 : 2 * M_PI);
    return made;
}

double median(std::vector<double> &of)
{
    std::sort(of.begin(), of.end());
    return of[of.size() / 2];
}

// Medians of steps in turn: straight, and turning (half of the bodies, if so).
void beside_straight(const char *name, const world &straight, const world &turning,
                     const pccd_step_settings &settings, int times, bool is_half)
{
    scene scenes[2] = {{connect(), straight}, {connect(), turning}};
    std::vector<double> ms[2];
    for (int i = 0; i < 16 * times; i++) { // trees are made little by little
        (void)scenes[0].step(straight, straight.motions[0], true, settings, is_half);
        if (is_half) {
            (void)scenes[1].step(turning, turning.motions[0], false, settings, true);
        }
    }
    for (int i = 0; i <= times; i++) {
        for (int turns = 0; turns < 2; turns++) {
            const world &in = turns == 1 ? turning : straight;
            const auto &joints = in.motions[0];
            const double begin = now_ms();
            if (scenes[turns].step(in, joints, turns == 0, settings, is_half) < 0) {
                std::fprintf(stderr, "turning: %s: not complete\n", name);
                std::exit(1);
            }
            if (i > 0) { // trees are made by the first
                ms[turns].push_back(now_ms() - begin);
            }
        }
    }
    const double m[2] = {median(ms[0]), median(ms[1])};
    std::printf("%-37s straight %8.3f ms, turning %8.3f ms: %.2f times\n", name,
                m[0], m[1], m[1] / m[0]);
}

void games(int times)
{
    const world stones = rocks(200);
    beside_straight("rocks on a level, first", stones, stones,
                    one_thread(PCCD_MODE_FIRST), times, false);
    beside_straight("rocks on a level, all", stones, stones, one_thread(PCCD_MODE_ALL),
                    times, false);
    pccd_step_settings fine = one_thread(PCCD_MODE_FIRST);
    fine.tolerance = 1e-6 / (2 * M_PI);
    beside_straight("a hinge of 360 degrees, first", hinge(true), hinge(false), fine,
                    times, false);
    const struct {
        const char *name;
        int side, part; // balls along each axis; this part of the steps
        double way;
        bool deform;
    } rows[] = {{"343 balls, half of them turn, all", 7, 1, 0.15, false},
                {"the same beside balls that deform", 7, 1, 0.15, true},
                {"125 of these, ten times as far", 5, 4, 1.5, true}};
    for (const auto &row : rows) {
        const world some = balls(times == 1 ? 2 : row.side, row.way, row.deform);
        beside_straight(row.name, some, some, one_thread(PCCD_MODE_ALL),
                        1 + (times - 1) / row.part, true);
    }
    const world recorded = recorded_balls();
    if (!recorded.bodies.empty()) {
        beside_straight("n-body as recorded, half of it turns", recorded, recorded,
                        one_thread(PCCD_MODE_ALL), 1 + (times - 1) / 4, true);
    }
}

} // namespace

int main(int argc, char **argv)
{
    const std::string word = argc > 1 ? argv[1] : "";
    const bool is_smoke = word == "--smoke";
    const auto wants = [&](const char *row) {
        return is_smoke || word.empty() || word == row;
    };
    if (wants("bodies")) {
        compare("5000 triangles beside their like, few", {two_bodies(12)});
        compare("5000 triangles beside their like", {two_bodies(is_smoke ? 2 : 1000)});
    }
    if (wants("arm")) {
        compare("arm of six links in a cell", {arm_in_cell(is_smoke ? 2 : 400)});
    }
    if (wants("games")) {
        games(is_smoke ? 1 : 21);
    }
    std::fflush(stdout);
    const char *data = std::getenv("PCCD_DATA");
    if (data != nullptr && wants("panda")) {
        panda(std::string(data) + "/panda", is_smoke);
    }
    return 0;
}
