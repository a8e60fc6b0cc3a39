/* hog.h - a client whose request computes for seconds, to test that others are still
 * served. */
#ifndef TEST_HOG_H
#define TEST_HOG_H

#include <stdbool.h>
#include <stdint.h>

#include "raw.h"

enum hog_kind {
    HOG_COINCIDENT = 0, /* a step of triangles that are all in one place */
    HOG_FAN = 1,        /* a step of triangles around one vertex */
    HOG_COMMIT = 2,     /* mesh.commit of random triangles */
    HOG_KINDS
};

struct hog {
    struct test_raw raw;
    enum hog_kind kind;
    uint32_t triangles;
    uint32_t scene;
    uint32_t mesh;
    uint32_t object;      /* the steps' */
    uint32_t id;          /* of the request that was sent; 0: none */
    uint64_t deadline_ns; /* of a step; 0 at first: none */
};

const char *test_hog_name(enum hog_kind kind);

/* Connect, and do all that comes before the long request. False: it did not work. */
bool test_hog_open(struct hog *hog, const char *socket, enum hog_kind kind,
                   uint32_t triangles);
/* Send it. False: it could not be sent. */
bool test_hog_begin(struct hog *hog);
/* Wait for its answer, however long it takes. Returns 0 or a status; of a step *answer is
 * set, if it is not NULL. */
int test_hog_end(struct hog *hog, struct proto_FRAME_SUBMIT_result *answer);
/* Let go of what the long request has made, so that it can be sent anew. Return false if
 * that did not work. */
bool test_hog_again(struct hog *hog);
void test_hog_close(struct hog *hog);

#endif
