/* eng_way.c - the ways in which a step may be taken without a difference. */
#include "eng_way.h"

#include <stdio.h>

#include "step_memory.h"
#include "trees.h"

const enum pccd_method way_methods[WAY_METHODS] = {PCCD_METHOD_PAPER, PCCD_METHOD_WIDE};

const struct eng_kernels *way_kernels(uint32_t i)
{
    for (int isa = 0; isa < ENG_ISA_COUNT; isa++) {
        const struct eng_kernels *kernels = eng_kernels_of((enum eng_isa)isa);
        if (kernels && i-- == 0) {
            return kernels;
        }
    }
    return NULL;
}

uint32_t way_kernels_count(void)
{
    uint32_t count = 0;
    while (way_kernels(count)) {
        count++;
    }
    return count;
}

uint32_t way_count(void)
{
    return WAY_METHODS * 2 * way_kernels_count();
}

void way_choose(uint32_t i, struct eng_question *settings)
{
    settings->team_always = true;
    settings->method = way_methods[i % WAY_METHODS];
    settings->threads = 1 + i / WAY_METHODS % 2;
    settings->kernels = way_kernels(i / WAY_METHODS / 2);
}

void way_draw(struct prng *prng, uint32_t thread_max, struct eng_question *settings)
{
    settings->method = way_methods[prng_below(prng, WAY_METHODS)];
    settings->kernels = way_kernels(prng_u32(prng, way_kernels_count()));
    settings->threads = 1 + prng_u32(prng, thread_max);
    settings->team_always = true;
    settings->tuning.scheduler = (enum eng_scheduler)prng_below(prng, 2);
    settings->tuning.high_level = (enum eng_high_level)prng_below(prng, 2);
    settings->tuning.refit = (enum eng_refit_scheme)prng_below(prng, 2);
}

bool way_tree_is_sound(const struct eng_scene *scene,
                       const struct eng_step_result *result)
{
    return result->method == PCCD_METHOD_WIDE || eng_tree_validate(scene);
}

bool way_was_by_bodies(const struct eng_scene *scene)
{
    return eng_step_memory_of(scene)->bodies.is_last;
}

void way_tell(const struct eng_question *settings, char text[WAY_TEXT_MAX])
{
    const struct eng_kernels *kernels = settings->kernels;
    snprintf(text, WAY_TEXT_MAX,
             "method %d, %s, %u threads, scheduler %d, high level %d, refit %d",
             (int)settings->method, (kernels ? kernels : eng_kernels())->name,
             settings->threads, (int)settings->tuning.scheduler,
             (int)settings->tuning.high_level, (int)settings->tuning.refit);
}
