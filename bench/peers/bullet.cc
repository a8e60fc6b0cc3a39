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

template <peer_kind kind> struct collector : btDbvt::ICollide {
    const peer_input *input;
    peer_sink *sink;

    collector(const peer_input *given, peer_sink *into) : input(given), sink(into)
    {
    }

    void Process(const btDbvtNode *first, const btDbvtNode *second) override
    {
        peer_offer(input, kind, sink, static_cast<uint32_t>(first->dataAsInt),
                   static_cast<uint32_t>(second->dataAsInt));
    }
};

struct bullet {
    const peer_input *input;
    group groups[PEER_GROUPS];

    bullet(const peer_input *given, uint32_t) : input(given)
    {
        for (int i = 0; i < PEER_GROUPS; i++) {
            groups[i].build(&given->groups[i]);
        }
    }

    static void version(char *text, size_t capacity)
    {
        std::snprintf(text, capacity, "Bullet %d.%02d", BT_BULLET_VERSION / 100,
                      BT_BULLET_VERSION % 100);
    }

    void update()
    {
        for (group &each : groups) {
            each.refit();
        }
    }

    void collide(peer_sink *sinks)
    {
        collector<PEER_VF> vf(input, sinks);
        collector<PEER_EE> ee(input, sinks);
        group &edges = groups[PEER_EDGES];
        groups[PEER_VERTICES].tree.collideTTpersistentStack(
            groups[PEER_VERTICES].tree.m_root, groups[PEER_FACES].tree.m_root, vf);
        edges.tree.selfCollideTT(edges.tree.m_root, ee);
    }
};

} // namespace

const peer peer_bullet = peer_of<bullet>("Bullet", false);
