/* test_eng_path.c - paths of joints, beside long floats. */
#include "eng_kit.h"
#include "eng_turns.h"

#include <math.h>
#include <string.h>

#include "path.h"
#include "sine.h"

#define CHAIN_MAX 16

/* PCCD_TURNS: how many chains, in the place of a few thousand. */
static long tries(long usual)
{
    const char *asked = getenv("PCCD_TURNS");
    return asked != NULL ? strtol(asked, NULL, 10) : usual;
}

static void apply(const struct eng_path_pose *pose, const double b[3], double x[3])
{
    for (int i = 0; i < 3; i++) {
        const double *m = pose->m + 4 * i;
        x[i] = ((m[0] * b[0] + m[1] * b[1]) + m[2] * b[2]) + m[3];
    }
}

static double size_of(const double b[3])
{
    return fmax(fabs(b[0]), fmax(fabs(b[1]), fabs(b[2])));
}

/* Random chains of all kinds, seen from any of their frames. */
CASE(path__poses_are_within_their_error)
{
    struct prng random = {prng_seed()};
    struct turns_place place;
    double worst = 0;
    turns_init(&place);
    for (long n = tries(2000); n > 0; n--) {
        struct pccd_joint joints[CHAIN_MAX];
        static struct eng_path path;
        struct eng_path_pose pose;
        uint32_t count = 1 + prng_u32(&random, CHAIN_MAX);
        double size = ldexp(1, (int)prng_u32(&random, 40) - 20), b[3], x[3];
        uint32_t of = prng_u32(&random, count + 1) - 1, to = prng_u32(&random, count);
        uint32_t fault;
        const char *why;
        turns_random(&random, joints, count, size);
        assert_true(eng_joints_check(joints, count, &fault, &why));
        assert_int_equal(eng_path_between(joints, of, to, &path), PCCD_OK);
        for (int k = 0; k < 3; k++) {
            double t = k < 2 ? k : prng_between(&random, 0, 1);
            for (int i = 0; i < 3; i++) {
                b[i] = prng_between(&random, -size, size);
            }
            eng_path_pose(&path, t, &pose);
            apply(&pose, b, x);
            turns_go(joints, of, to, t, b, &place);
            double off = turns_distance(&place, x);
            double error = pose.error[0] + pose.error[1] * size_of(b);
            assert_true(off <= error);
            worst = fmax(worst, off / error);
        }
    }
    print_message("# at most %.2f of the error that is claimed\n", worst);
    assert_true(worst > 0.01);
    turns_deinit(&place);
}
