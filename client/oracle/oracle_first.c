/* oracle_first.c - the first of several times, each an exact root. */
#include "oracle_root.h"

#include <stdlib.h>

void first_init(struct oracle_first *first)
{
    for (int i = 0; i < FIRST_MAX; i++) {
        root_init(&first->roots[i]);
    }
    first->count = 0;
}

void first_clear(struct oracle_first *first)
{
    for (int i = 0; i < FIRST_MAX; i++) {
        root_clear(&first->roots[i]);
    }
}

struct oracle_first *first_new(void)
{
    struct oracle_first *first = malloc(sizeof *first);
    if (!first) {
        abort();
    }
    first_init(first);
    return first;
}

struct oracle_first *first_or_null(struct oracle_first *first)
{
    if (first->count == 0) {
        oracle_first_free(first);
        return NULL;
    }
    return first;
}

void oracle_first_free(struct oracle_first *first)
{
    if (first) {
        first_clear(first);
        free(first);
    }
}

int oracle_first_compare(struct oracle_first *first, double t)
{
    int least = 1;
    for (int i = 0; i < first->count; i++) {
        int sign = root_compare(&first->roots[i], t);
        least = sign < least ? sign : least;
    }
    return least;
}

void oracle_first_bracket(struct oracle_first *first, unsigned bits, mpq_t lo, mpq_t hi)
{
    mpq_t end;
    mpq_init(end);
    for (int i = 0; i < first->count; i++) {
        struct root *root = &first->roots[i];
        while (!root->is_exact && root->n < bits) {
            root_narrow(root);
        }
        mpq_set_z(end, root->a);
        mpq_div_2exp(end, end, root->n);
        if (i == 0 || mpq_cmp(end, lo) < 0) {
            mpq_set(lo, end);
        }
        if (!root->is_exact) {
            mpz_add_ui(mpq_numref(end), root->a, 1);
            mpz_set_ui(mpq_denref(end), 1);
            mpq_div_2exp(end, end, root->n);
        }
        if (i == 0 || mpq_cmp(end, hi) < 0) {
            mpq_set(hi, end);
        }
    }
    mpq_clear(end);
}
