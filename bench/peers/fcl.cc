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
typedef fcl::DynamicAABBTreeCollisionManager_Array<float> manager;

class feature : public object
{
  public:
    feature(const std::shared_ptr<fcl::CollisionGeometry<float>> &shape, uint32_t idx)
        : object(shape), index(idx)
    {
    }

    void place(const peer_box &box)
    {
        this->aabb.min_ = fcl::Vector3<float>(box.lo[0], box.lo[1], box.lo[2]);
        this->aabb.max_ = fcl::Vector3<float>(box.hi[0], box.hi[1], box.hi[2]);
    }

    uint32_t index;
};

struct group {
    const peer_features *features;
    std::vector<std::unique_ptr<feature>> members;
    manager tree;

    void place()
    {
        for (auto &member : members) {
            member->place(features->boxes[member->index]);
        }
    }

    void build(const peer_features *given)
    {
        auto shape = std::make_shared<fcl::Sphere<float>>(1.0f); /* never looked at */
        std::vector<object *> list;
        features = given;
        for (uint32_t i = 0; i < given->count; i++) {
            members.push_back(std::make_unique<feature>(shape, i));
            list.push_back(members.back().get());
        }
        place();
        tree.registerObjects(list);
        tree.setup();
    }
};

struct trees {
    const peer_input *input;
    group groups[3]; /* vertices, edges, faces */
};

struct context {
    const peer_input *input;
    peer_sink *sink;
};

template <bool is_vf> bool on_pair(object *first, object *second, void *data)
{
    const auto *at = static_cast<const context *>(data);
    peer_offer(at->input, is_vf ? PEER_VF : PEER_EE, at->sink,
               static_cast<feature *>(first)->index,
               static_cast<feature *>(second)->index);
    return false; /* go on */
}

void version(char *text, size_t capacity)
{
    std::snprintf(text, capacity, "FCL %s", FCL_VERSION);
}

void *open(const peer_input *input, uint32_t)
{
    auto *self = new trees;
    self->input = input;
    self->groups[0].build(&input->vertices);
    self->groups[1].build(&input->edges);
    self->groups[2].build(&input->faces);
    return self;
}

void update(void *state)
{
    for (group &each : static_cast<trees *>(state)->groups) {
        each.place();
        each.tree.update();
    }
}

void collide(void *state, peer_sink *sinks)
{
    auto *self = static_cast<trees *>(state);
    context at = {self->input, sinks};
    self->groups[0].tree.collide(&self->groups[2].tree, &at, on_pair<true>);
    self->groups[1].tree.collide(&at, on_pair<false>);
}

void close(void *state)
{
    delete static_cast<trees *>(state);
}

} // namespace

const peer peer_fcl = {"FCL", false, version, open, update, collide, close, nullptr};
