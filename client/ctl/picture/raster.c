/* raster.c - triangles, dots and text on a canvas with depth. */
#include "raster.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define AMBIENT    0.46f
#define LAMP       0.54f
#define LINE_SHADE 0.80f /* brightness of a triangle's border */
#define RIM_SHADE  0.35f /* brightness of a dot's rim */
#define RING_WIDTH 0.45f /* of its radius */
/* A dot lies on a surface: it counts as visible when it is this much (relatively) behind.
 */
#define DOT_BIAS 4e-3f

#define GLYPH_COLUMNS 5
#define GLYPH_ROWS    8
#define GLYPH_FIRST   ' '
#define GLYPH_LAST    'z'

/* Columns from the left, the lowest bit on top. */
static const uint8_t glyphs[GLYPH_LAST - GLYPH_FIRST + 1][GLYPH_COLUMNS] = {
    ['!' - ' '] = {0x00, 0x00, 0x5f, 0x00, 0x00},
    ['%' - ' '] = {0x23, 0x13, 0x08, 0x64, 0x62},
    ['(' - ' '] = {0x00, 0x1c, 0x22, 0x41, 0x00},
    [')' - ' '] = {0x00, 0x41, 0x22, 0x1c, 0x00},
    ['+' - ' '] = {0x08, 0x08, 0x3e, 0x08, 0x08},
    [',' - ' '] = {0x00, 0x80, 0x70, 0x30, 0x00},
    ['-' - ' '] = {0x08, 0x08, 0x08, 0x08, 0x08},
    ['.' - ' '] = {0x00, 0x60, 0x60, 0x00, 0x00},
    ['/' - ' '] = {0x20, 0x10, 0x08, 0x04, 0x02},
    ['0' - ' '] = {0x3e, 0x51, 0x49, 0x45, 0x3e},
    ['1' - ' '] = {0x00, 0x42, 0x7f, 0x40, 0x00},
    ['2' - ' '] = {0x42, 0x61, 0x51, 0x49, 0x46},
    ['3' - ' '] = {0x21, 0x41, 0x45, 0x4b, 0x31},
    ['4' - ' '] = {0x18, 0x14, 0x12, 0x7f, 0x10},
    ['5' - ' '] = {0x27, 0x45, 0x45, 0x45, 0x39},
    ['6' - ' '] = {0x3c, 0x4a, 0x49, 0x49, 0x30},
    ['7' - ' '] = {0x01, 0x71, 0x09, 0x05, 0x03},
    ['8' - ' '] = {0x36, 0x49, 0x49, 0x49, 0x36},
    ['9' - ' '] = {0x06, 0x49, 0x49, 0x29, 0x1e},
    [':' - ' '] = {0x00, 0x36, 0x36, 0x00, 0x00},
    ['=' - ' '] = {0x14, 0x14, 0x14, 0x14, 0x14},
    ['A' - ' '] = {0x7e, 0x11, 0x11, 0x11, 0x7e},
    ['B' - ' '] = {0x7f, 0x49, 0x49, 0x49, 0x36},
    ['C' - ' '] = {0x3e, 0x41, 0x41, 0x41, 0x22},
    ['D' - ' '] = {0x7f, 0x41, 0x41, 0x22, 0x1c},
    ['E' - ' '] = {0x7f, 0x49, 0x49, 0x49, 0x41},
    ['F' - ' '] = {0x7f, 0x09, 0x09, 0x09, 0x01},
    ['G' - ' '] = {0x3e, 0x41, 0x49, 0x49, 0x7a},
    ['H' - ' '] = {0x7f, 0x08, 0x08, 0x08, 0x7f},
    ['I' - ' '] = {0x00, 0x41, 0x7f, 0x41, 0x00},
    ['J' - ' '] = {0x20, 0x40, 0x41, 0x3f, 0x01},
    ['K' - ' '] = {0x7f, 0x08, 0x14, 0x22, 0x41},
    ['L' - ' '] = {0x7f, 0x40, 0x40, 0x40, 0x40},
    ['M' - ' '] = {0x7f, 0x02, 0x0c, 0x02, 0x7f},
    ['N' - ' '] = {0x7f, 0x04, 0x08, 0x10, 0x7f},
    ['O' - ' '] = {0x3e, 0x41, 0x41, 0x41, 0x3e},
    ['P' - ' '] = {0x7f, 0x09, 0x09, 0x09, 0x06},
    ['Q' - ' '] = {0x3e, 0x41, 0x51, 0x21, 0x5e},
    ['R' - ' '] = {0x7f, 0x09, 0x19, 0x29, 0x46},
    ['S' - ' '] = {0x46, 0x49, 0x49, 0x49, 0x31},
    ['T' - ' '] = {0x01, 0x01, 0x7f, 0x01, 0x01},
    ['U' - ' '] = {0x3f, 0x40, 0x40, 0x40, 0x3f},
    ['V' - ' '] = {0x1f, 0x20, 0x40, 0x20, 0x1f},
    ['W' - ' '] = {0x3f, 0x40, 0x38, 0x40, 0x3f},
    ['X' - ' '] = {0x63, 0x14, 0x08, 0x14, 0x63},
    ['Y' - ' '] = {0x07, 0x08, 0x70, 0x08, 0x07},
    ['Z' - ' '] = {0x61, 0x51, 0x49, 0x45, 0x43},
    ['_' - ' '] = {0x40, 0x40, 0x40, 0x40, 0x40},
    ['a' - ' '] = {0x20, 0x54, 0x54, 0x54, 0x78},
    ['b' - ' '] = {0x7f, 0x48, 0x44, 0x44, 0x38},
    ['c' - ' '] = {0x38, 0x44, 0x44, 0x44, 0x20},
    ['d' - ' '] = {0x38, 0x44, 0x44, 0x48, 0x7f},
    ['e' - ' '] = {0x38, 0x54, 0x54, 0x54, 0x18},
    ['f' - ' '] = {0x08, 0x7e, 0x09, 0x01, 0x02},
    ['g' - ' '] = {0x18, 0xa4, 0xa4, 0xa4, 0x7c},
    ['h' - ' '] = {0x7f, 0x08, 0x04, 0x04, 0x78},
    ['i' - ' '] = {0x00, 0x44, 0x7d, 0x40, 0x00},
    ['j' - ' '] = {0x40, 0x80, 0x84, 0x7d, 0x00},
    ['k' - ' '] = {0x7f, 0x10, 0x28, 0x44, 0x00},
    ['l' - ' '] = {0x00, 0x41, 0x7f, 0x40, 0x00},
    ['m' - ' '] = {0x7c, 0x04, 0x18, 0x04, 0x78},
    ['n' - ' '] = {0x7c, 0x08, 0x04, 0x04, 0x78},
    ['o' - ' '] = {0x38, 0x44, 0x44, 0x44, 0x38},
    ['p' - ' '] = {0xfc, 0x24, 0x24, 0x24, 0x18},
    ['q' - ' '] = {0x18, 0x24, 0x24, 0x18, 0xfc},
    ['r' - ' '] = {0x7c, 0x08, 0x04, 0x04, 0x08},
    ['s' - ' '] = {0x48, 0x54, 0x54, 0x54, 0x20},
    ['t' - ' '] = {0x04, 0x3f, 0x44, 0x40, 0x20},
    ['u' - ' '] = {0x3c, 0x40, 0x40, 0x20, 0x7c},
    ['v' - ' '] = {0x1c, 0x20, 0x40, 0x20, 0x1c},
    ['w' - ' '] = {0x3c, 0x40, 0x30, 0x40, 0x3c},
    ['x' - ' '] = {0x44, 0x28, 0x10, 0x28, 0x44},
    ['y' - ' '] = {0x1c, 0xa0, 0xa0, 0xa0, 0x7c},
    ['z' - ' '] = {0x44, 0x64, 0x54, 0x4c, 0x44},
};

bool raster_init(struct raster *raster, uint32_t width, uint32_t height)
{
    size_t pixels = (size_t)width * height;
    raster->width = width;
    raster->height = height;
    raster->rgb = malloc(pixels * 3);
    raster->nearness = malloc(pixels * sizeof *raster->nearness);
    if (raster->rgb != NULL && raster->nearness != NULL) {
        return true;
    }
    raster_deinit(raster);
    return false;
}

void raster_deinit(struct raster *raster)
{
    free(raster->rgb);
    free(raster->nearness);
    raster->rgb = NULL;
    raster->nearness = NULL;
}

uint8_t raster_byte(float share)
{
    float value = share * 255.0f + 0.5f;
    return (uint8_t)(value < 0.0f ? 0.0f : value > 255.0f ? 255.0f : value);
}

static void put(struct raster *raster, size_t pixel, const float colour[3])
{
    for (uint32_t k = 0; k < 3; k++) {
        raster->rgb[pixel * 3 + k] = raster_byte(colour[k]);
    }
}

static void mix(struct raster *raster, size_t pixel, const float colour[3], float share)
{
    for (uint32_t k = 0; k < 3; k++) {
        float old = (float)raster->rgb[pixel * 3 + k] / 255.0f;
        raster->rgb[pixel * 3 + k] = raster_byte(old + (colour[k] - old) * share);
    }
}

void raster_forget(struct raster *raster)
{
    memset(raster->nearness, 0,
           (size_t)raster->width * raster->height * sizeof *raster->nearness);
}

void raster_clear(struct raster *raster, const float top[3], const float bottom[3])
{
    for (uint32_t y = 0; y < raster->height; y++) {
        float share = (float)y / (float)raster->height;
        float colour[3];
        for (uint32_t k = 0; k < 3; k++) {
            colour[k] = top[k] + (bottom[k] - top[k]) * share;
        }
        for (uint32_t x = 0; x < raster->width; x++) {
            put(raster, (size_t)y * raster->width + x, colour);
        }
    }
    raster_forget(raster);
}

/* Ambient light from above, a lamp that reaches round everything, so that nothing is
 * black, a little light from the eye, and a soft highlight; both sides are lit. */
static void shade(const struct raster_surface *surface, const float direction[3],
                  bool is_back, float colour[3])
{
    float sign = is_back ? -1.0f : 1.0f;
    float length = 0.0f, to_light = 0.0f, to_eye = 0.0f, to_half = 0.0f;
    for (uint32_t k = 0; k < 3; k++) {
        length += direction[k] * direction[k];
    }
    length = sqrtf(length) + 1e-20f;
    float half_length = 0.0f;
    for (uint32_t k = 0; k < 3; k++) {
        float half = surface->light[k] + surface->eye[k];
        to_light += sign * direction[k] / length * surface->light[k];
        to_eye += sign * direction[k] / length * surface->eye[k];
        to_half += sign * direction[k] / length * half;
        half_length += half * half;
    }
    to_half /= sqrtf(half_length) + 1e-20f;
    float sky = 0.5f + 0.5f * sign * direction[1] / length;
    float bright = AMBIENT * (0.65f + 0.35f * sky) + LAMP * (0.5f + 0.5f * to_light) +
                   0.13f * fmaxf(to_eye, 0.0f);
    float shine = fmaxf(to_half, 0.0f);
    for (uint32_t power = 0; power < 5; power++) {
        shine *= shine;
    }
    for (uint32_t k = 0; k < 3; k++) {
        colour[k] =
            (is_back ? surface->back[k] : surface->front[k]) * bright + 0.16f * shine;
    }
}

static float edge(const struct raster_corner *a, const struct raster_corner *b, float x,
                  float y)
{
    return (b->x - a->x) * (y - a->y) - (b->y - a->y) * (x - a->x);
}

static float minimum3(float a, float b, float c)
{
    return fminf(a, fminf(b, c));
}

/* The first and last whole pixel of a range that lies on the canvas. */
static void clip(float low, float high, uint32_t limit, uint32_t *first, uint32_t *last)
{
    float top = (float)limit - 1.0f;
    *first = (uint32_t)fminf(fmaxf(floorf(low), 0.0f), top);
    *last = (uint32_t)fminf(fmaxf(ceilf(high), 0.0f), top);
}

void raster_triangle(struct raster *raster, const struct raster_corner c[3],
                     const struct raster_surface *surface)
{
    float area = edge(&c[0], &c[1], c[2].x, c[2].y);
    if (area == 0.0f) {
        return;
    }
    /* The canvas' y points down: what is seen counter-clockwise has a negative area. */
    bool is_back = area > 0.0f;
    float heights[3];
    for (uint32_t k = 0; k < 3; k++) {
        const struct raster_corner *p = &c[(k + 1) % 3], *q = &c[(k + 2) % 3];
        heights[k] = fabsf(area) / (hypotf(q->x - p->x, q->y - p->y) + 1e-20f);
    }
    uint32_t x0, x1, y0, y1;
    clip(minimum3(c[0].x, c[1].x, c[2].x), -minimum3(-c[0].x, -c[1].x, -c[2].x),
         raster->width, &x0, &x1);
    clip(minimum3(c[0].y, c[1].y, c[2].y), -minimum3(-c[0].y, -c[1].y, -c[2].y),
         raster->height, &y0, &y1);
    for (uint32_t y = y0; y <= y1; y++) {
        for (uint32_t x = x0; x <= x1; x++) {
            float at_x = (float)x + 0.5f, at_y = (float)y + 0.5f;
            float w[3] = {edge(&c[1], &c[2], at_x, at_y) / area,
                          edge(&c[2], &c[0], at_x, at_y) / area,
                          edge(&c[0], &c[1], at_x, at_y) / area};
            if (minimum3(w[0], w[1], w[2]) < 0.0f) {
                continue;
            }
            size_t pixel = (size_t)y * raster->width + x;
            float near_here =
                w[0] * c[0].nearness + w[1] * c[1].nearness + w[2] * c[2].nearness;
            if (near_here <= raster->nearness[pixel]) {
                continue;
            }
            raster->nearness[pixel] = near_here;
            float normal[3], colour[3];
            for (uint32_t k = 0; k < 3; k++) {
                normal[k] =
                    w[0] * c[0].normal[k] + w[1] * c[1].normal[k] + w[2] * c[2].normal[k];
            }
            shade(surface, normal, is_back, colour);
            float border =
                minimum3(w[0] * heights[0], w[1] * heights[1], w[2] * heights[2]);
            for (uint32_t k = 0; border < surface->line_width && k < 3; k++) {
                colour[k] *= LINE_SHADE;
            }
            put(raster, pixel, colour);
        }
    }
}

void raster_pixel(struct raster *raster, uint32_t x, uint32_t y, float nearness,
                  const float normal[3], const struct raster_surface *surface)
{
    size_t pixel = (size_t)y * raster->width + x;
    if (nearness > raster->nearness[pixel]) {
        float colour[3];
        raster->nearness[pixel] = nearness;
        shade(surface, normal, false, colour);
        put(raster, pixel, colour);
    }
}

static bool is_on(const struct raster *raster, const struct raster_corner *at)
{
    return at->x >= 0.0f && at->y >= 0.0f && at->x < (float)raster->width &&
           at->y < (float)raster->height;
}

bool raster_is_hidden(const struct raster *raster, const struct raster_corner *at)
{
    size_t centre;
    if (!is_on(raster, at)) {
        return true;
    }
    centre = (size_t)at->y * raster->width + (size_t)at->x;
    return at->nearness * (1.0f + DOT_BIAS) < raster->nearness[centre];
}

/* Return where on the segment between two places (dx, dy) apart the one is that is
 * nearest to a place (x, y) away from the first: 0 .. 1. */
static float along(float dx, float dy, float x, float y)
{
    float square = dx * dx + dy * dy;
    return square > 0.0f ? fminf(fmaxf((x * dx + y * dy) / square, 0.0f), 1.0f) : 0.0f;
}

void raster_line(struct raster *raster, const struct raster_corner ends[2], float radius,
                 const float colour[3], float hidden)
{
    float rim[3] = {colour[0] * RIM_SHADE, colour[1] * RIM_SHADE, colour[2] * RIM_SHADE};
    float dx = ends[1].x - ends[0].x, dy = ends[1].y - ends[0].y;
    uint32_t x0, x1, y0, y1;
    if (!isfinite(ends[0].x + ends[0].y + ends[1].x + ends[1].y)) {
        return;
    }
    clip(fminf(ends[0].y, ends[1].y) - radius, fmaxf(ends[0].y, ends[1].y) + radius,
         raster->height, &y0, &y1);
    for (uint32_t y = y0; y <= y1; y++) {
        float away_y = (float)y + 0.5f - ends[0].y;
        /* The part of the segment that can be so near. */
        float from = dy != 0.0f ? (away_y - radius) / dy : 0.0f;
        float to = dy != 0.0f ? (away_y + radius) / dy : 1.0f;
        float a = ends[0].x + dx * fminf(fmaxf(from, 0.0f), 1.0f);
        float b = ends[0].x + dx * fminf(fmaxf(to, 0.0f), 1.0f);
        clip(fminf(a, b) - radius, fmaxf(a, b) + radius, raster->width, &x0, &x1);
        for (uint32_t x = x0; x <= x1; x++) {
            float away_x = (float)x + 0.5f - ends[0].x;
            float t = along(dx, dy, away_x, away_y);
            float away = hypotf(away_x - t * dx, away_y - t * dy);
            const struct raster_corner at = {
                .x = ends[0].x + t * dx,
                .y = ends[0].y + t * dy,
                .nearness = ends[0].nearness + t * (ends[1].nearness - ends[0].nearness)};
            if (away > radius || !is_on(raster, &at)) {
                continue;
            }
            bool is_hidden = raster_is_hidden(raster, &at);
            bool is_rim = !is_hidden && away > radius * 0.72f;
            mix(raster, (size_t)y * raster->width + x, is_rim ? rim : colour,
                is_hidden ? hidden : 1.0f);
        }
    }
}

void raster_dot(struct raster *raster, const struct raster_corner *at, float radius,
                const float colour[3], float hidden)
{
    raster_line(raster, (const struct raster_corner[]){*at, *at}, radius, colour, hidden);
}

void raster_ring(struct raster *raster, const struct raster_corner *at, float radius,
                 const float colour[3])
{
    float rim[3] = {colour[0] * RIM_SHADE, colour[1] * RIM_SHADE, colour[2] * RIM_SHADE};
    uint32_t x0, x1, y0, y1;
    if (!is_on(raster, at)) {
        return;
    }
    clip(at->x - radius, at->x + radius, raster->width, &x0, &x1);
    clip(at->y - radius, at->y + radius, raster->height, &y0, &y1);
    for (uint32_t y = y0; y <= y1; y++) {
        for (uint32_t x = x0; x <= x1; x++) {
            float away = hypotf((float)x + 0.5f - at->x, (float)y + 0.5f - at->y);
            float inside = (1 - away / radius) / RING_WIDTH; /* 0 outside, 1 inside */
            if (inside >= 0.0f && inside <= 1.0f) {
                bool is_rim = inside < 0.25f || inside > 0.75f;
                put(raster, (size_t)y * raster->width + x, is_rim ? rim : colour);
            }
        }
    }
}

void raster_lighten(struct raster *raster, const uint32_t corner[2],
                    const uint32_t size[2], float opacity)
{
    static const float white[3] = {1, 1, 1};
    for (uint32_t y = corner[1]; y < corner[1] + size[1] && y < raster->height; y++) {
        for (uint32_t x = corner[0]; x < corner[0] + size[0] && x < raster->width; x++) {
            mix(raster, (size_t)y * raster->width + x, white, opacity);
        }
    }
}

void raster_box(struct raster *raster, uint32_t x, uint32_t y, uint32_t width,
                uint32_t height, const float colour[3])
{
    for (uint32_t row = y; row < y + height && row < raster->height; row++) {
        for (uint32_t column = x; column < x + width && column < raster->width;
             column++) {
            put(raster, (size_t)row * raster->width + column, colour);
        }
    }
}

void raster_text(struct raster *raster, uint32_t x, uint32_t y, uint32_t scale,
                 const float colour[3], const char *text)
{
    for (const char *c = text; *c != '\0'; c++, x += (GLYPH_COLUMNS + 1) * scale) {
        if (*c < GLYPH_FIRST || *c > GLYPH_LAST) {
            continue;
        }
        const uint8_t *glyph = glyphs[*c - GLYPH_FIRST];
        for (uint32_t column = 0; column < GLYPH_COLUMNS; column++) {
            for (uint32_t row = 0; row < GLYPH_ROWS; row++) {
                if ((glyph[column] >> row & 1) != 0) {
                    raster_box(raster, x + column * scale, y + row * scale, scale, scale,
                               colour);
                }
            }
        }
    }
}
