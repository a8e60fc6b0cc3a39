/* embree.cc - Embree: BVHs over user geometries that are refitted, rtcCollide.
 *
 * Three scenes of one geometry each: vertices, edges, faces. A scene of low build quality
 * keeps a hierarchy for each geometry, which a geometry of quality refit only refits when
 * it is committed again.
 *
 * Threads: as many as the device is told; each finds a sink of its own.
 */
#include <embree3/rtcore.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "peer.h"

namespace
{

std::atomic<unsigned> sinks_given;
std::atomic<unsigned> run; /* a thread asks for a sink once a run */

/* Of `sinks`, for this thread. */
peer_sink *sink_of_this_thread(peer_sink *sinks)
{
    static thread_local unsigned mine;
    static thread_local unsigned mine_run;
    if (mine_run != run.load(std::memory_order_relaxed)) {
        mine_run = run.load(std::memory_order_relaxed);
        mine = sinks_given.fetch_add(1, std::memory_order_relaxed);
        if (mine >= PEER_SINK_MAX) {
            std::fprintf(stderr, "embree: more threads than sinks\n");
            std::exit(2);
        }
    }
    return &sinks[mine];
}

void on_error(void *, RTCError code, const char *text)
{
    std::fprintf(stderr, "embree: error %d: %s\n", static_cast<int>(code), text);
    std::exit(2);
}

void bounds(const RTCBoundsFunctionArguments *arguments)
{
    const auto *features = static_cast<const peer_features *>(arguments->geometryUserPtr);
    const peer_box &box = features->boxes[arguments->primID];
    RTCBounds *out = arguments->bounds_o;
    out->lower_x = box.lo[0];
    out->lower_y = box.lo[1];
    out->lower_z = box.lo[2];
    out->upper_x = box.hi[0];
    out->upper_y = box.hi[1];
    out->upper_z = box.hi[2];
}

struct embree {
    const peer_input *input;
    RTCDevice device;
    RTCScene scene[PEER_GROUPS];
    RTCGeometry geometry[PEER_GROUPS];
    peer_sink *sinks;

    embree(const peer_input *given, uint32_t threads) : input(given)
    {
        std::string settings =
            "threads=" + std::to_string(threads) + ",user_threads=0,set_affinity=0";
        rtcSetDeviceErrorFunction(device = rtcNewDevice(settings.c_str()), on_error,
                                  nullptr);
        for (int i = 0; i < PEER_GROUPS; i++) {
            auto *features = const_cast<peer_features *>(&given->groups[i]);
            scene[i] = rtcNewScene(device);
            rtcSetSceneFlags(scene[i], RTC_SCENE_FLAG_DYNAMIC);
            rtcSetSceneBuildQuality(scene[i], RTC_BUILD_QUALITY_LOW);
            geometry[i] = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
            rtcSetGeometryBuildQuality(geometry[i], RTC_BUILD_QUALITY_REFIT);
            rtcSetGeometryUserPrimitiveCount(geometry[i], features->count);
            rtcSetGeometryUserData(geometry[i], features);
            rtcSetGeometryBoundsFunction(geometry[i], bounds, nullptr);
            rtcCommitGeometry(geometry[i]);
            rtcAttachGeometry(scene[i], geometry[i]);
            rtcCommitScene(scene[i]);
        }
    }

    ~embree()
    {
        for (int i = 0; i < PEER_GROUPS; i++) {
            rtcReleaseGeometry(geometry[i]);
            rtcReleaseScene(scene[i]);
        }
        rtcReleaseDevice(device);
    }

    static void version(char *text, size_t capacity)
    {
        std::snprintf(text, capacity, "Embree %s", RTC_VERSION_STRING);
    }

    void update()
    {
        for (int i = 0; i < PEER_GROUPS; i++) {
            rtcCommitGeometry(geometry[i]);
            rtcCommitScene(scene[i]);
        }
    }

    /* Pairs of leaves that meet; whether their primitives do is left to the caller. */
    template <peer_kind kind>
    static void on_pairs(void *user, RTCCollision *collisions, unsigned count)
    {
        const auto *self = static_cast<const embree *>(user);
        const peer_features *groups = self->input->groups;
        const peer_box *a = groups[kind == PEER_VF ? PEER_VERTICES : PEER_EDGES].boxes;
        const peer_box *b = groups[kind == PEER_VF ? PEER_FACES : PEER_EDGES].boxes;
        peer_sink *sink = sink_of_this_thread(self->sinks);
        for (unsigned i = 0; i < count; i++) {
            unsigned p = collisions[i].primID0;
            unsigned q = collisions[i].primID1;
            /* A scene against itself gives both orders of a pair. */
            if ((kind == PEER_VF || p < q) && peer_overlap(&a[p], &b[q])) {
                peer_offer(self->input, kind, sink, p, q);
            }
        }
    }

    void collide(peer_sink *into)
    {
        sinks = into;
        sinks_given = 0;
        run++;
        rtcCollide(scene[PEER_VERTICES], scene[PEER_FACES], on_pairs<PEER_VF>, this);
        rtcCollide(scene[PEER_EDGES], scene[PEER_EDGES], on_pairs<PEER_EE>, this);
    }
};

} // namespace

const peer peer_embree = peer_of<embree>("Embree", true);
