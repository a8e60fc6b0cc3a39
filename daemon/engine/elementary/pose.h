/* pose.h - the difference vectors of two features at one moment.
 *
 * Threads: [any]; types only.
 */
#ifndef ENG_POSE_H
#define ENG_POSE_H

struct eng_pose {
    double p[3];
    double b[3];
    double c[3];
};

#endif
