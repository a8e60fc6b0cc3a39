/* cgal.cc - CGAL: intersections of sequences of boxes by streamed segment trees.
 *
 * Source: CGAL/box_intersection_d.h (closed boxes, cutoff 10, both the defaults);
 * Zomorodian, Edelsbrunner: Fast software for box intersections.
 */
#include <CGAL/Box_intersection_d/Box_d.h>
#include <CGAL/box_intersection_d.h>
#include <CGAL/version.h>

#include <cstdio>
#include <vector>

#include "peer.h"

namespace
{

class box
    : public CGAL::Box_intersection_d::Box_d<float, 3, CGAL::Box_intersection_d::ID_NONE>
{
  public:
    box(float *lower, float *upper, uint32_t idx)
        : CGAL::Box_intersection_d::Box_d<float, 3, CGAL::Box_intersection_d::ID_NONE>(
              lower, upper),
          index(idx)
    {
    }

    /* The name by which the algorithm tells equal bounds apart. */
    typedef size_t ID;
    ID id() const
    {
        return index;
    }

    uint32_t index;
};

struct sequences {
    const peer_input *input;
    std::vector<box> boxes[3]; /* vertices, edges, faces */
};

void fill(std::vector<box> &boxes, const peer_features &features, uint32_t first_id)
{
    boxes.clear();
    for (uint32_t i = 0; i < features.count; i++) {
        boxes.emplace_back(features.boxes[i].lo, features.boxes[i].hi, first_id + i);
    }
}

void version(char *text, size_t capacity)
{
    std::snprintf(text, capacity, "CGAL %s", CGAL_VERSION_STR);
}

void update(void *state)
{
    auto *self = static_cast<sequences *>(state);
    fill(self->boxes[0], self->input->vertices, 0);
    fill(self->boxes[1], self->input->edges, 0);
    /* Two sequences must not share a name. */
    fill(self->boxes[2], self->input->faces, self->input->vertices.count);
}

void *open(const peer_input *input, uint32_t)
{
    auto *self = new sequences;
    self->input = input;
    update(self);
    return self;
}

void collide(void *state, peer_sink *sinks)
{
    auto *self = static_cast<sequences *>(state);
    const peer_input *input = self->input;
    std::vector<box> *boxes = self->boxes;
    auto vf = [input, sinks](const box &a, const box &b) {
        peer_offer(input, PEER_VF, sinks, a.index, b.index - input->vertices.count);
    };
    auto ee = [input, sinks](const box &a, const box &b) {
        peer_offer(input, PEER_EE, sinks, a.index, b.index);
    };
    CGAL::box_intersection_d(boxes[0].begin(), boxes[0].end(), boxes[2].begin(),
                             boxes[2].end(), vf);
    CGAL::box_self_intersection_d(boxes[1].begin(), boxes[1].end(), ee);
}

void close(void *state)
{
    delete static_cast<sequences *>(state);
}

} // namespace

const peer peer_cgal = {"CGAL", false, version, open, update, collide, close, nullptr};
