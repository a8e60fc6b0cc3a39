/* fcl.cc - FCL: the dynamic AABB tree of its broad phase. */
#include <fcl/broadphase/broadphase_dynamic_AABB_tree_array.h>
#include <fcl/config.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>

#include <cstdio>
#include <memory>
#include <vector>

#include "peer.h"

namespace
{

typedef fcl::CollisionObject<float> object;

struct feature : object {
    uint32_t index;

    feature(const std::shared_ptr<fcl::CollisionGeometry<float>> &shape, uint32_t idx)
        : object(shape), index(idx)
    {
    }

    void place(const peer_box &box)
    {
        this->aabb.min_ = fcl::Vector3<float>(box.lo[0], box.lo[1], box.lo[2]);
        this->aabb.max_ = fcl::Vector3<float>(box.hi[0], box.hi[1], box.hi[2]);
    }
};

struct group {
    std::vector<std::unique_ptr<feature>> members;
    fcl::DynamicAABBTreeCollisionManager_Array<float> tree;
};

struct context {
    const peer_input *input;
    peer_sink *sink;
};

template <peer_kind kind> bool on_pair(object *first, object *second, void *data)
{
    const auto *at = static_cast<const context *>(data);
    peer_offer(at->input, kind, at->sink, static_cast<feature *>(first)->index,
               static_cast<feature *>(second)->index);
    return false; /* go on */
}

struct trees {
    const peer_input *input;
    group groups[PEER_GROUPS];

    trees(const peer_input *given, uint32_t) : input(given)
    {
        auto shape = std::make_shared<fcl::Sphere<float>>(1.0f); /* never looked at */
        for (int i = 0; i < PEER_GROUPS; i++) {
            std::vector<object *> list;
            for (uint32_t k = 0; k < given->groups[i].count; k++) {
                groups[i].members.push_back(std::make_unique<feature>(shape, k));
                list.push_back(groups[i].members.back().get());
            }
            place(i);
            groups[i].tree.registerObjects(list);
            groups[i].tree.setup();
        }
    }

    void place(int i)
    {
        for (auto &member : groups[i].members) {
            member->place(input->groups[i].boxes[member->index]);
        }
    }

    static void version(char *text, size_t capacity)
    {
        std::snprintf(text, capacity, "FCL %s", FCL_VERSION);
    }

    void update()
    {
        for (int i = 0; i < PEER_GROUPS; i++) {
            place(i);
            groups[i].tree.update();
        }
    }

    void collide(peer_sink *sinks)
    {
        context at = {input, sinks};
        groups[PEER_VERTICES].tree.collide(&groups[PEER_FACES].tree, &at,
                                           on_pair<PEER_VF>);
        groups[PEER_EDGES].tree.collide(&at, on_pair<PEER_EE>);
    }
};

} // namespace

const peer peer_fcl = peer_of<trees>("FCL", false);
