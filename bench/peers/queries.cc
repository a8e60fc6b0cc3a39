/* queries.cc - who is right on pairs that were made to be hard?
 *
 * Room:     bench/peers.
 * Does:     ask pccd, FCL and, where configure was told of it, ipc-toolkit the public
 *           hand-made queries, whose truth was computed symbolically; count what each
 *           misses and what it invents. Each has the settings that it has by itself. A
 *           wrong answer of ours ends it with 1.
 * Needs:    $PCCD_DATA; without it, it ends with 77.
 */
#include <fcl/narrowphase/detail/traversal/collision/intersect.h>
#ifdef PEERS_IPC_TOOLKIT
#include <ipc/ccd/additive_ccd.hpp>
#include <ipc/ccd/tight_inclusion_ccd.hpp>
#include <ipc/utils/logger.hpp>
#endif

#include <cstdio>
#include <cstdlib>

#include "pccd.h"
extern "C" {
#include "data.h"
}

namespace
{

pccd_client *client;

void must(int status)
{
    if (status != PCCD_OK) {
        std::fprintf(stderr, "queries: %s\n", pccd_error_text(client));
        std::exit(2);
    }
}

// Four points at t = 0, then the same at t = 1: a vertex and the corners of a face, or
// the ends of two edges. Does the pair meet on the way?
using query = const double (*)[3];

// One mesh of four vertices: a point and a triangle, or two edges.
bool ours(bool is_vf, query p)
{
    static const uint32_t triangle[3] = {1, 2, 3}, point = 0, edges[4] = {0, 1, 2, 3};
    pccd_mesh_data data{};
    data.struct_bytes = sizeof data;
    data.x = p;
    data.format = PCCD_FORMAT_F64;
    data.vertex_count = 4;
    data.triangles = triangle;
    data.triangle_count = is_vf;
    data.points = &point;
    data.point_count = is_vf;
    data.edges = edges;
    data.edge_count = is_vf ? 0 : 2;
    pccd_answer answer{};
    answer.struct_bytes = sizeof answer;
    uint32_t scene, object, mesh = 0;
    must(pccd_scene_create(client, nullptr, &scene));
    must(pccd_mesh_put(client, &data, &mesh, nullptr));
    must(pccd_scene_add(client, scene, mesh, &object));
    must(pccd_step_x1(client, scene, object, p + 4, PCCD_FORMAT_F64, 4, nullptr,
                      &answer));
    const bool meets = answer.total > 0;
    pccd_answer_release(client, &answer);
    must(pccd_scene_destroy(client, scene));
    must(pccd_mesh_destroy(client, mesh));
    return meets;
}

bool fcl_says(bool is_vf, query p)
{
    using test = fcl::detail::Intersect<double>;
    fcl::Vector3d x[8], place;
    double time;
    for (int i = 0; i < 8; i++) {
        x[i] = fcl::Vector3d(p[i][0], p[i][1], p[i][2]);
    }
    return is_vf ? test::intersect_VF(x[1], x[2], x[3], x[0], x[5], x[6], x[7], x[4],
                                      &time, &place)
                 : test::intersect_EE(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7],
                                      &time, &place);
}

#ifdef PEERS_IPC_TOOLKIT
template <class method> bool ipc_says(bool is_vf, query p)
{
    static const method narrow;
    Eigen::Vector3d x[8];
    double time;
    ipc::logger().set_level(spdlog::level::off);
    for (int i = 0; i < 8; i++) {
        x[i] = Eigen::Vector3d(p[i][0], p[i][1], p[i][2]);
    }
    return is_vf ? narrow.point_triangle_ccd(x[0], x[1], x[2], x[3], x[4], x[5], x[6],
                                             x[7], time)
                 : narrow.edge_edge_ccd(x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7],
                                        time);
}
#endif

struct judged {
    const char *name;
    bool (*meets)(bool is_vf, query p);
    size_t missed, invented;
} all[] = {
    {"pccd", ours, 0, 0},
#ifdef PEERS_IPC_TOOLKIT
    {"ipc-toolkit, Tight-Inclusion", ipc_says<ipc::TightInclusionCCD>, 0, 0},
    {"ipc-toolkit, additive CCD", ipc_says<ipc::AdditiveCCD>, 0, 0},
#endif
    {"FCL", fcl_says, 0, 0},
};

size_t asked[2]; // that do not meet, that do

void ask(void *, bool is_vf, const char *, const data_queries *queries)
{
    for (size_t i = 0; i < queries->count; i++) {
        const bool truth = queries->truth[i];
        asked[truth]++;
        for (judged &one : all) {
            const bool meets = one.meets(is_vf, queries->p[i]);
            one.missed += truth && !meets;
            one.invented += !truth && meets;
        }
    }
}

} // namespace

int main()
{
    pccd_options options;
    pccd_options_init(&options);
    options.url = "direct:";
    must(pccd_connect(&options, &client));
    if (data_handmade(ask, nullptr) == 0) {
        std::fprintf(stderr, "queries: no hand-made queries in $PCCD_DATA\n");
        return 77;
    }
    std::printf("| of %zu queries, %zu of which meet | missed | invented |\n",
                asked[0] + asked[1], asked[1]);
    std::printf("|---|---|---|\n");
    for (const judged &one : all) {
        std::printf("| %s | %zu | %zu |\n", one.name, one.missed, one.invented);
    }
    pccd_close(client);
    return all[0].missed + all[0].invented > 0;
}
