/* deal_rank.c - items on the rank that computes them. */
#include "deal.h"

#include <string.h>

#include "pccd_types.h"
#include "together.h"

void deal_tell(struct deal *deal, const struct deal_tell *tell)
{
    if (together_is_root()) {
        deal_root_tell(deal, tell);
        return;
    }
    struct deal_sent *sent = &deal->sent[deal->next_sent];
    deal->next_sent = (deal->next_sent + 1) % DEAL_SENT;
    together_wait(&sent->request);
    sent->tell = *tell;
    MPI_Isend(&sent->tell, (int)sizeof sent->tell, MPI_BYTE, 0, DEAL_TAG_TELL,
              MPI_COMM_WORLD, &sent->request);
}

static void ask(struct deal *deal)
{
    const struct deal_tell tell = {.word = DEAL_ASK};
    MPI_Irecv(&deal->coming, (int)sizeof deal->coming, MPI_BYTE, 0, DEAL_TAG_HAND,
              MPI_COMM_WORLD, &deal->request);
    deal->is_asked = true;
    deal_tell(deal, &tell);
}

/* The next items, which may have to be waited for. */
static void take_hand(struct deal *deal)
{
    if (together_is_root()) {
        deal_root_take(deal, &deal->hand);
        return;
    }
    if (!deal->is_asked) {
        ask(deal);
    }
    together_wait(&deal->request);
    deal->is_asked = false;
    deal->hand = deal->coming;
}

uint64_t deal_next(struct deal *deal)
{
    if (deal->used == deal->hand.count) {
        if (!deal->is_over) {
            take_hand(deal);
            deal->used = 0;
            deal->is_over = deal->hand.count == 0;
        }
        if (deal->is_over) {
            return DEAL_NONE;
        }
    }
    uint64_t item = deal->hand.items[deal->used++];
    if (deal->used == deal->hand.count && !together_is_root()) {
        ask(deal); /* the answer comes while this item is computed */
    }
    return item;
}

void deal_put(struct deal *deal, uint64_t item, const void *result)
{
    struct deal_tell tell = {.word = DEAL_RESULT, .item = item};
    memcpy(tell.with.result, result, deal->work->result_bytes);
    deal_tell(deal, &tell);
}

/* After an error an answer may still come: it is waited for, its memory is ours. */
static void end(struct deal *deal, int status, const struct ctl_error *error)
{
    struct deal_tell tell = {.word = DEAL_END, .status = status};
    if (deal->is_asked) {
        together_wait(&deal->request);
    }
    if (status != PCCD_OK) {
        tell.with.error = *error;
    }
    deal_tell(deal, &tell);
    for (uint32_t i = 0; i < DEAL_SENT; i++) {
        together_wait(&deal->sent[i].request);
    }
}

int deal(const struct deal_work *work, struct ctl_error *error)
{
    struct deal deal = {.work = work, .request = MPI_REQUEST_NULL};
    int verdict = PCCD_OK;
    for (uint32_t i = 0; i < DEAL_SENT; i++) {
        deal.sent[i].request = MPI_REQUEST_NULL;
    }
    if (together_is_root()) {
        verdict = deal_root(&deal, error);
    } else {
        int status = work->compute(work->compute_context, &deal, error);
        end(&deal, status, error);
    }
    together_tell(&verdict, sizeof verdict);
    together_tell(error, sizeof *error);
    return verdict;
}
