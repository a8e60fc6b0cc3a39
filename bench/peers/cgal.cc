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
    std::vector<box> boxes[PEER_GROUPS];

    sequences(const peer_input *given, uint32_t) : input(given)
    {
        update();
    }

    static void version(char *text, size_t capacity)
    {
        std::snprintf(text, capacity, "CGAL %s", CGAL_VERSION_STR);
    }

    /* Vertices and faces must not share a name. */
    uint32_t first_of(int group) const
    {
        return group == PEER_FACES ? input->groups[PEER_VERTICES].count : 0;
    }

    void update()
    {
        for (int i = 0; i < PEER_GROUPS; i++) {
            const peer_features &features = input->groups[i];
            boxes[i].clear();
            for (uint32_t k = 0; k < features.count; k++) {
                boxes[i].emplace_back(features.boxes[k].lo, features.boxes[k].hi,
                                      first_of(i) + k);
            }
        }
    }

    void collide(peer_sink *sinks)
    {
        std::vector<box> &vertices = boxes[PEER_VERTICES];
        std::vector<box> &edges = boxes[PEER_EDGES];
        std::vector<box> &faces = boxes[PEER_FACES];
        uint32_t first_face = first_of(PEER_FACES);
        auto vf = [this, sinks, first_face](const box &a, const box &b) {
            peer_offer(input, PEER_VF, sinks, a.index, b.index - first_face);
        };
        auto ee = [this, sinks](const box &a, const box &b) {
            peer_offer(input, PEER_EE, sinks, a.index, b.index);
        };
        CGAL::box_intersection_d(vertices.begin(), vertices.end(), faces.begin(),
                                 faces.end(), vf);
        CGAL::box_self_intersection_d(edges.begin(), edges.end(), ee);
    }
};

} // namespace

const peer peer_cgal = peer_of<sequences>("CGAL", false);
