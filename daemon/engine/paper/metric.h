/* metric.h - measures how good a node of the tree is: a poor node has children that
 * overlap much.
 *
 * Threads: [any]; inline only.
 * Source: paper section 6.2; Larsson and Akenine-Moeller 2006.
 *
 * A moving box has a volume at each end of the step; they are added. Boxes of a flat
 * sheet have none: where one of the three is zero, half of the surface takes its place.
 */
#ifndef ENG_METRIC_H
#define ENG_METRIC_H

#include "trees.h"

struct eng_extent {
    double volume; /* 1e54 at most */
    double area;   /* of half the surface */
};

static inline struct eng_extent eng_extent_of(const struct eng_box *box)
{
    eng_f4 size0 = eng_bounds(box, 1) - eng_bounds(box, 0);
    eng_f4 size1 = eng_bounds(box, 3) - eng_bounds(box, 2);
    double x0 = (double)size0[0];
    double y0 = (double)size0[1];
    double z0 = (double)size0[2];
    double x1 = (double)size1[0];
    double y1 = (double)size1[1];
    double z1 = (double)size1[2];
    return (struct eng_extent){x0 * y0 * z0 + x1 * y1 * z1,
                               x0 * y0 + y0 * z0 + z0 * x0 + x1 * y1 + y1 * z1 + z1 * x1};
}

/* The ratio for an inner node; 1 if it is a point. Children that overlap much make it
 * small. */
static inline float eng_metric(const struct eng_node *nodes, const struct eng_node *node)
{
    struct eng_extent whole = eng_extent_of(eng_box_of_const(node));
    struct eng_extent left = eng_extent_of(eng_box_of_const(&nodes[node->left]));
    struct eng_extent right = eng_extent_of(eng_box_of_const(&nodes[node->right]));
    if (whole.volume > 0 && left.volume > 0 && right.volume > 0) {
        return (float)(whole.volume / (left.volume + right.volume));
    }
    double parts = left.area + right.area;
    return parts > 0 ? (float)(whole.area / parts) : 1.0f;
}

/* Is it worth building anew? Less than `threshold`, and less than that times what it was
 * when it was built: children that overlap by nature do so again. */
static inline bool eng_metric_is_poor(float ratio, float built_ratio, float threshold)
{
    return ratio < threshold && ratio < threshold * built_ratio;
}

#endif
