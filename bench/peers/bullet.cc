/* bullet.cc - Bullet: its dynamic bounding volume tree.
 *
 * One tree each for vertices, edges and faces, built top down once; then the leaves get
 * their new boxes and inner nodes the union of their children, which costs less than
 * taking each leaf out and putting it in again.
 */
#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include <cstdio>
#include <vector>

#include "peer.h"

namespace
{

struct group {
    const peer_features *features;
    btDbvt tree;
    std::vector<btDbvtNode *> leaves;
    std::vector<btDbvtNode *> inner; /* a parent before its children */

    btDbvtVolume volume(uint32_t i) const
    {
        const peer_box &box = features->boxes[i];
        return btDbvtVolume::FromMM(btVector3(box.lo[0], box.lo[1], box.lo[2]),
                                    btVector3(box.hi[0], box.hi[1], box.hi[2]));
    }

    void build(const peer_features *given)
    {
        features = given;
        for (uint32_t i = 0; i < given->count; i++) {
            leaves.push_back(tree.insert(volume(i), nullptr));
            leaves.back()->dataAsInt = static_cast<int>(i);
        }
        tree.optimizeTopDown();
        if (tree.m_root && tree.m_root->isinternal()) {
            inner.push_back(tree.m_root);
        }
        for (size_t i = 0; i < inner.size(); i++) {
            for (btDbvtNode *child : inner[i]->childs) {
                if (child->isinternal()) {
                    inner.push_back(child);
                }
            }
        }
    }

    void refit()
    {
        for (uint32_t i = 0; i < features->count; i++) {
            leaves[i]->volume = volume(i);
        }
        for (size_t i = inner.size(); i-- > 0;) {
            Merge(inner[i]->childs[0]->volume, inner[i]->childs[1]->volume,
                  inner[i]->volume);
        }
    }
};

struct trees {
    const peer_input *input;
    group groups[3]; /* vertices, edges, faces */
};

template <bool is_vf> struct collector : btDbvt::ICollide {
    const peer_input *input;
    peer_sink *sink;

    collector(const peer_input *given, peer_sink *into) : input(given), sink(into)
    {
    }

    void Process(const btDbvtNode *first, const btDbvtNode *second) override
    {
        peer_offer(input, is_vf ? PEER_VF : PEER_EE, sink,
                   static_cast<uint32_t>(first->dataAsInt),
                   static_cast<uint32_t>(second->dataAsInt));
    }
};

void version(char *text, size_t capacity)
{
    std::snprintf(text, capacity, "Bullet %d.%02d", BT_BULLET_VERSION / 100,
                  BT_BULLET_VERSION % 100);
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
        each.refit();
    }
}

void collide(void *state, peer_sink *sinks)
{
    auto *self = static_cast<trees *>(state);
    group *groups = self->groups;
    collector<true> vf(self->input, sinks);
    collector<false> ee(self->input, sinks);
    groups[0].tree.collideTTpersistentStack(groups[0].tree.m_root, groups[2].tree.m_root,
                                            vf);
    groups[1].tree.selfCollideTT(groups[1].tree.m_root, ee);
}

void close(void *state)
{
    delete static_cast<trees *>(state);
}

} // namespace

const peer peer_bullet = {"Bullet", false,   version, open,
                          update,   collide, close,   nullptr};
