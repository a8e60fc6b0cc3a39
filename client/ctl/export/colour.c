/* colour.c - colours of times and of objects. */
#include "export.h"

#include <string.h>

#define STOPS   9
#define OBJECTS 6

static const float stops[STOPS][3] = {
    {0.050f, 0.030f, 0.528f}, {0.294f, 0.012f, 0.631f}, {0.492f, 0.012f, 0.658f},
    {0.658f, 0.134f, 0.588f}, {0.798f, 0.280f, 0.470f}, {0.899f, 0.424f, 0.360f},
    {0.973f, 0.585f, 0.252f}, {0.994f, 0.770f, 0.165f}, {0.940f, 0.975f, 0.131f}};

static const float fronts[OBJECTS][3] = {{0.55f, 0.66f, 0.80f}, {0.93f, 0.86f, 0.74f},
                                         {0.66f, 0.80f, 0.64f}, {0.84f, 0.70f, 0.80f},
                                         {0.76f, 0.76f, 0.78f}, {0.86f, 0.72f, 0.62f}};

void colour_of_time(double toi, float colour[3])
{
    double at = toi * (STOPS - 1);
    int below = at < 0 ? 0 : at >= STOPS - 1 ? STOPS - 2 : (int)at;
    float share = (float)(at - below);
    share = share < 0 ? 0 : share > 1 ? 1 : share;
    for (int k = 0; k < 3; k++) {
        colour[k] = stops[below][k] + share * (stops[below + 1][k] - stops[below][k]);
    }
}

void colour_of_object(uint32_t i, float front[3], float back[3])
{
    memcpy(front, fronts[i % OBJECTS], sizeof fronts[0]);
    for (int k = 0; k < 3; k++) {
        back[k] = 0.82f * front[k];
    }
}
