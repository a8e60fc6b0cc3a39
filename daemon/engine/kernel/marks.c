/* marks.c - points onto the grid. */
#include "table.h"

typedef int32_t half_bits __attribute__((vector_size(ENG_D_LANES * 4), may_alias));

/* The sum with this has the nearest whole number in its lowest bits. */
#define WHOLE 0x1.8p52

/* `frame_scale`: of the frame, if there is one. */
ENG_INLINE bool place_points(const struct eng_point *points, uint32_t count,
                             const double origin[8], const double *frame_scale,
                             double grid_scale, struct eng_mark *marks)
{
    /* The owner's words, as doubles mostly denormal, count as 0. */
    static const int64_t is_coordinate[8] = {-1, -1, -1, 0, -1, -1, -1, 0};
    eng_d farthest = {0};
    for (uint32_t i = 0; i < count; i++) {
        const char *in = (const char *)&points[i];
        char *out = (char *)&marks[i];
        for (size_t k = 0; k < 8; k += ENG_D_LANES) {
            eng_di bits;
            eng_di mask;
            memcpy(&bits, in + 8 * k, sizeof bits);
            memcpy(&mask, is_coordinate + k, sizeof mask);
            eng_d x = eng_d_of(bits & mask) - eng_d_load(origin + k);
            if (frame_scale) {
                x *= *frame_scale;
            }
            x *= grid_scale;
            farthest = eng_d_max_abs(farthest, x);
            half_bits q = __builtin_convertvector(eng_di_of(x + WHOLE), half_bits);
            memcpy(out + 4 * k, &q, sizeof q);
        }
    }
    return eng_dm_bits(eng_d_less(eng_d_all(ENG_GRID_REACH), farthest)) == 0;
}

bool ENG_KERNEL(place_points)(const struct eng_point *points, uint32_t count,
                              const struct eng_box_frame *frame,
                              const struct eng_grid *grid, struct eng_mark *marks)
{
    double origin[8] = {0};
    for (int i = 0; i < 3; i++) {
        double at = frame ? grid->origin[i] / frame->scale : grid->origin[i];
        origin[i] = frame ? frame->origin[i] + at : at;
        origin[4 + i] = frame ? frame->origin[4 + i] + at : at;
    }
    return frame ? place_points(points, count, origin, &frame->scale, grid->scale, marks)
                 : place_points(points, count, origin, NULL, grid->scale, marks);
}
