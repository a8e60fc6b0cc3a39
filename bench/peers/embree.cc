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

struct embree {
    RTCDevice device;
    RTCScene scene[3];
    RTCGeometry geometry[3];
    const peer_input *input;
    const peer_features *features[3]; /* vertices, edges, faces */
    peer_sink *sinks;
};

std::atomic<unsigned> sinks_given;
std::atomic<unsigned> run; /* a thread asks for a sink once a run */

peer_sink *sink_of_this_thread(const embree *self)
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
    return &self->sinks[mine];
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

/* Pairs of leaves that meet; whether their primitives do is left to the caller. */
template <bool is_vf> void on_pairs(void *user, RTCCollision *collisions, unsigned count)
{
    const auto *self = static_cast<const embree *>(user);
    const peer_features &a = *self->features[is_vf ? 0 : 1];
    const peer_features &b = *self->features[is_vf ? 2 : 1];
    peer_sink *sink = sink_of_this_thread(self);
    for (unsigned i = 0; i < count; i++) {
        unsigned p = collisions[i].primID0;
        unsigned q = collisions[i].primID1;
        /* A scene against itself gives both orders of a pair. */
        if ((is_vf || p < q) && peer_overlap(&a.boxes[p], &b.boxes[q])) {
            peer_offer(self->input, is_vf ? PEER_VF : PEER_EE, sink, p, q);
        }
    }
}

void version(char *text, size_t capacity)
{
    std::snprintf(text, capacity, "Embree %s", RTC_VERSION_STRING);
}

void *open(const peer_input *input, uint32_t threads)
{
    auto *self = new embree{};
    std::string settings =
        "threads=" + std::to_string(threads) + ",user_threads=0,set_affinity=0";
    self->device = rtcNewDevice(settings.c_str());
    if (!self->device) {
        std::fprintf(stderr, "embree: no device\n");
        delete self;
        return nullptr;
    }
    rtcSetDeviceErrorFunction(self->device, on_error, nullptr);
    self->input = input;
    self->features[0] = &input->vertices;
    self->features[1] = &input->edges;
    self->features[2] = &input->faces;
    for (int i = 0; i < 3; i++) {
        self->scene[i] = rtcNewScene(self->device);
        rtcSetSceneFlags(self->scene[i], RTC_SCENE_FLAG_DYNAMIC);
        rtcSetSceneBuildQuality(self->scene[i], RTC_BUILD_QUALITY_LOW);
        self->geometry[i] = rtcNewGeometry(self->device, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryBuildQuality(self->geometry[i], RTC_BUILD_QUALITY_REFIT);
        rtcSetGeometryUserPrimitiveCount(self->geometry[i], self->features[i]->count);
        rtcSetGeometryUserData(self->geometry[i],
                               const_cast<peer_features *>(self->features[i]));
        rtcSetGeometryBoundsFunction(self->geometry[i], bounds, nullptr);
        rtcCommitGeometry(self->geometry[i]);
        rtcAttachGeometry(self->scene[i], self->geometry[i]);
        rtcCommitScene(self->scene[i]);
    }
    return self;
}

void update(void *state)
{
    auto *self = static_cast<embree *>(state);
    for (int i = 0; i < 3; i++) {
        rtcCommitGeometry(self->geometry[i]);
        rtcCommitScene(self->scene[i]);
    }
}

void collide(void *state, peer_sink *sinks)
{
    auto *self = static_cast<embree *>(state);
    self->sinks = sinks;
    sinks_given = 0;
    run++;
    rtcCollide(self->scene[0], self->scene[2], on_pairs<true>, self);
    rtcCollide(self->scene[1], self->scene[1], on_pairs<false>, self);
}

void close(void *state)
{
    auto *self = static_cast<embree *>(state);
    for (int i = 0; i < 3; i++) {
        rtcReleaseGeometry(self->geometry[i]);
        rtcReleaseScene(self->scene[i]);
    }
    rtcReleaseDevice(self->device);
    delete self;
}

} // namespace

const peer peer_embree = {"Embree", true, version, open, update, collide, close, nullptr};
