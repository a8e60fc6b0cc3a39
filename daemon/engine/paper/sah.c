/* sah.c - split a list where the surface area heuristic says. */
#include "sah.h"

#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

static const struct eng_sah_box no_box = {{INFINITY, INFINITY, INFINITY},
                                          {-INFINITY, -INFINITY, -INFINITY}};

static void include(struct eng_sah_box *box, const struct eng_sah_box *other)
{
    for (int k = 0; k < 3; k++) {
        box->lo[k] = other->lo[k] < box->lo[k] ? other->lo[k] : box->lo[k];
        box->hi[k] = other->hi[k] > box->hi[k] ? other->hi[k] : box->hi[k];
    }
}

/* Half of the surface; double, because the squares of 1e18 fit into no float. */
static double area_of(const struct eng_sah_box *box)
{
    double size[3];
    for (int k = 0; k < 3; k++) {
        size[k] = (double)box->hi[k] - (double)box->lo[k];
    }
    return size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
}

void eng_sah_begin(struct eng_sah *sah, uint32_t count)
{
    assert(count >= 2 && sah->boxes);
    sah->pass = 0;
    sah->left = 0;
    sah->bin_count = count < ENG_SAH_BINS ? count : ENG_SAH_BINS;
}

static void measure(struct eng_sah *sah, const struct eng_split_item *items,
                    uint32_t count)
{
    struct eng_sah_box bounds = no_box;
    for (uint32_t i = 0; i < count; i++) {
        struct eng_sah_box point;
        memcpy(point.lo, items[i].centroid, sizeof point.lo);
        memcpy(point.hi, items[i].centroid, sizeof point.hi);
        include(&bounds, &point);
    }
    for (int k = 0; k < 3; k++) {
        float extent = bounds.hi[k] - bounds.lo[k];
        float scale = (float)sah->bin_count / extent;
        sah->lo[k] = bounds.lo[k];
        sah->scale[k] = scale <= FLT_MAX ? scale : 0; /* also without extent */
    }
}

static uint32_t bin_of(const struct eng_sah *sah, const struct eng_split_item *item,
                       int axis)
{
    /* At most bin_count + 1 by rounding, so the conversion is defined. */
    uint32_t bin = (uint32_t)((item->centroid[axis] - sah->lo[axis]) * sah->scale[axis]);
    return bin < sah->bin_count ? bin : sah->bin_count - 1;
}

static void fill_bins(struct eng_sah *sah, const struct eng_split_item *items,
                      uint32_t count)
{
    for (int k = 0; k < 3; k++) {
        for (uint32_t bin = 0; bin < sah->bin_count; bin++) {
            sah->bins[k][bin] = (struct eng_sah_bin){no_box, 0};
        }
    }
    for (uint32_t i = 0; i < count; i++) {
        const struct eng_sah_box *box = &sah->boxes[items[i].id - sah->first_id];
        for (int k = 0; k < 3; k++) {
            struct eng_sah_bin *bin = &sah->bins[k][bin_of(sah, &items[i], k)];
            bin->count++;
            include(&bin->box, box);
        }
    }
}

/* The cheapest plane of one axis, if it beats *best. */
static void search_axis(struct eng_sah *sah, int axis, double *best)
{
    const struct eng_sah_bin *bins = sah->bins[axis];
    double right_cost[ENG_SAH_BINS]; /* of the bins from this one on */
    struct eng_sah_box box = no_box;
    uint32_t right = 0;
    for (uint32_t bin = sah->bin_count; bin-- > 1;) {
        include(&box, &bins[bin].box);
        right += bins[bin].count;
        right_cost[bin] = right > 0 ? right * area_of(&box) : 0;
    }
    box = no_box;
    uint32_t left = 0;
    for (uint32_t plane = 1; plane < sah->bin_count; plane++) {
        include(&box, &bins[plane - 1].box);
        left += bins[plane - 1].count;
        if (left == 0 || bins[plane].count == 0) {
            continue; /* the next plane divides the same way */
        }
        double cost = left * area_of(&box) + right_cost[plane];
        if (cost < *best) {
            *best = cost;
            sah->axis = axis;
            sah->plane = plane;
            sah->left = left;
        }
    }
}

static void divide(const struct eng_sah *sah, struct eng_split_item *items,
                   uint32_t count)
{
    uint32_t i = 0;
    uint32_t j = count;
    while (i < j) {
        if (bin_of(sah, &items[i], sah->axis) < sah->plane) {
            i++;
        } else {
            struct eng_split_item item = items[--j];
            items[j] = items[i];
            items[i] = item;
        }
    }
}

bool eng_sah_pass(struct eng_sah *sah, struct eng_split_item *items, uint32_t count)
{
    double best = INFINITY;
    switch (sah->pass++) {
    case 0:
        measure(sah, items, count);
        return false;
    case 1:
        fill_bins(sah, items, count);
        for (int k = 0; k < 3; k++) {
            if (sah->scale[k] > 0) {
                search_axis(sah, k, &best);
            }
        }
        return sah->left == 0;
    default:
        divide(sah, items, count);
        return true;
    }
}
