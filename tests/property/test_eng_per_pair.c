/* test_eng_per_pair.c - mode first-per-pair against mode all, taken apart here.
 *
 * Random scenes in which things come, go, rest and move, thick and thin: for each two
 * objects the contact of the least toi among those of mode all, of several the first in
 * order; the same bytes in every way.
 */
#include "cases.h"
#include "eng_answer.h"
#include "eng_stir.h"
#include "eng_way.h"
#include "play_actor.h"
#include "sequences.h"

#define SEQUENCES   150
#define THREADS_MAX 3u

static struct {
    uint64_t steps, pairs, of_many, ties, at_start, cut;
} sums;

static bool are_of_same(const struct pccd_contact *a, const struct pccd_contact *b)
{
    return (a->object_a == b->object_a && a->object_b == b->object_b) ||
           (a->object_a == b->object_b && a->object_b == b->object_a);
}

/* Move the first of each two objects to the front, in the order of the answer; returns
 * how many there are. */
static uint64_t take_firsts(struct pccd_contact *contacts, uint64_t count)
{
    uint64_t kept = 0;
    for (uint64_t i = 0; i < count; i++) {
        bool is_first = true;
        uint64_t others = 0;
        for (uint64_t k = 0; k < count && is_first; k++) {
            if (k != i && are_of_same(&contacts[i], &contacts[k])) {
                is_first = contacts[k].toi > contacts[i].toi ||
                           (contacts[k].toi == contacts[i].toi && k > i);
                sums.ties += contacts[k].toi == contacts[i].toi;
                others++;
            }
        }
        if (is_first) {
            sums.of_many += others > 0;
            sums.at_start += contacts[i].toi == 0;
            contacts[kept].reserved = (uint32_t)i; /* the others stay to compare with */
            kept++;
        }
    }
    for (uint64_t i = 0; i < kept; i++) {
        uint32_t from = contacts[i].reserved;
        contacts[i].reserved = 0;
        contacts[i] = contacts[from];
        contacts[i].reserved = 0;
    }
    return kept;
}

static void check(uint64_t seed, const struct eng_question *question,
                  const struct eng_step_result *result, const struct answer *all,
                  uint64_t firsts)
{
    char way[WAY_TEXT_MAX];
    uint64_t hash[2];
    uint64_t count = firsts < question->contact_max ? firsts : question->contact_max;
    way_tell(question, way);
    bool is_same =
        result->count == count && result->record_bytes == sizeof(struct pccd_contact) &&
        (count == 0 ||
         memcmp(result->records, all->records, count * sizeof(struct pccd_contact)) == 0);
    answer_hash(all->records, count, sizeof(struct pccd_contact), hash);
    if (!is_same || memcmp(hash, result->hash, sizeof hash) != 0 ||
        result->incomplete !=
            (firsts > count ? PCCD_INCOMPLETE_CONTACT_LIMIT : PCCD_COMPLETE) ||
        (firsts == count && result->toi_first != all->result.toi_first) ||
        (firsts == count && result->safe_step != all->result.safe_step)) {
        fail_msg("PCCD_SEED=%llu, %s: %llu records, want %llu%s",
                 (unsigned long long)seed, way, (unsigned long long)result->count,
                 (unsigned long long)count, is_same ? "; other numbers" : "");
    }
    sums.steps++;
    sums.pairs += count;
    sums.cut += firsts > count;
}

/* The step that is staged, in the scene that has lived and, now and then, in new ones by
 * every way there is. */
static void take_step(struct stir *stir, struct prng *prng, uint64_t seed)
{
    struct player *player = &stir->player;
    struct eng_question question = ENG_QUESTION_DEFAULT;
    struct eng_step_result result;
    struct answer all;
    question.mode = PCCD_MODE_FIRST_PER_PAIR;
    question.distance = prng_below(prng, 3) == 0 ? 8 * PLAY_UNIT : 0;
    question.approach = prng_below(prng, 4) == 0 ? 0.25 : 0;
    player_open(player);
    uint32_t ways = prng_below(prng, 4) == 0 ? way_count() : 0;
    struct eng_question question_all = question;
    question_all.mode = PCCD_MODE_ALL;
    way_draw(prng, THREADS_MAX, &question);
    question.contact_max = prng_below(prng, 5) == 0 ? prng_below(prng, 4) : 1u << 20;
    assert_int_equal(player_step(player, &question, &result), PCCD_OK);
    answer_find_fresh(player, &question_all, &all);
    assert_int_equal(all.result.incomplete, PCCD_COMPLETE);
    uint64_t firsts = take_firsts(all.records, all.result.count);
    check(seed, &question, &result, &all, firsts);
    for (uint32_t i = 0; i < ways; i++) {
        struct player copy;
        way_choose(i, &question);
        player_copy(player, NULL, &copy);
        assert_int_equal(player_step(&copy, &question, &result), PCCD_OK);
        check(seed, &question, &result, &all, firsts);
        player_deinit(&copy);
    }
    answer_free(&all);
}

static void live(uint64_t seed)
{
    struct prng prng = {seed};
    struct stir stir;
    struct eng_scene_settings made = stir_draw_scene(&prng);
    stir_init(&stir, &made, stir_draw_size(&prng, 1), prng_next(&prng));
    uint32_t steps = 3 + prng_u32(&prng, 8);
    for (uint32_t step = 0; step < steps; step++) {
        stir_change(&stir);
        if (prng_below(&prng, 6) == 0) {
            player_draw_thickness(&stir.player, &prng);
        }
        stir_move(&stir);
        take_step(&stir, &prng, seed);
    }
    stir_deinit(&stir);
}

/* If it failed, a game would be told that two bodies meet later than they do, or not at
 * all, or twice. */
CASE(per_pair__is_the_first_of_all_contacts_of_two_objects)
{
    sequences_live(live, SEQUENCES, "PCCD_PER_PAIR_SEQUENCES");
    print_message("# %llu steps, %llu pairs of objects, %llu of several contacts, %llu "
                  "ties, %llu at t = 0, %llu cut\n",
                  (unsigned long long)sums.steps, (unsigned long long)sums.pairs,
                  (unsigned long long)sums.of_many, (unsigned long long)sums.ties,
                  (unsigned long long)sums.at_start, (unsigned long long)sums.cut);
    if (!getenv("PCCD_SEED") && sums.steps >= SEQUENCES) {
        assert_true(sums.of_many > 0 && sums.ties > 0 && sums.at_start > 0 &&
                    sums.pairs > sums.at_start && sums.cut > 0);
    }
}
