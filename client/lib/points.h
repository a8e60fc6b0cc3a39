/* points.h - records of either kind, as places of features (pccd_points.h). */
#ifndef CLI_POINTS_H
#define CLI_POINTS_H

#include <stdbool.h>

#include "pccd_points.h"

/* Records of contacts or of what is near, and the bodies that they name. */
struct cli_records {
    const struct pccd_body *bodies;
    uint32_t body_count;
    const struct pccd_contact *contacts; /* [count], or NULL, and */
    const struct pccd_near *near;        /* [count] at time t */
    uint64_t count;
    double t;
};

/* A record with its vertices. */
struct cli_feature_pair {
    uint32_t kind;
    uint32_t object[2];
    const struct pccd_body *body[2];
    uint32_t points[2];      /* of each feature; EF: 2 and 0 */
    uint32_t vertex[2][3];   /* of each body */
    double weight[2][3];
    double t;                /* when it is */
    float normal[3];         /* from b to a */
    double distance;         /* d_lo of what is near */
};

/* Check what all functions are given, and where bodies are; `what` is the function. */
int cli_records_check(const struct cli_records *records, const char *what);
int cli_records_check_positions(const struct cli_records *records, const char *what);
/* Look up record i. E_HANDLE, E_INDEX. */
int cli_feature_pair_find(const struct cli_records *records, uint64_t i,
                          struct cli_feature_pair *pair);
/* Find where its points are. */
void cli_feature_pair_points(const struct cli_feature_pair *pair, double points[2][3]);

#endif
