/* deal_root.c - the rank that deals.
 *
 * Listen to the other ranks and to its own second thread, which computes; deal; pass
 * results on. It looks for messages often, and sleeps between: a thread that waited in
 * MPI would take a processor from those that compute. It does not wait until a message is
 * taken, either: who computes a step for minutes takes none.
 *
 * Threads: two: deal_root in the main one, deal_root_tell and _take in the other. What is
 * left to deal, and work->is_done and work->take, are under the lock.
 */
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "ctl.h"
#include "deal.h"
#include "pccd.h"
#include "terminal.h"
#include "together.h"

#define PARTS        4u       /* a rank gets a quarter of its share of what is left */
#define PAUSE_NS     100000u  /* between two looks for messages: after one, */
#define PAUSE_NS_MAX 4000000u /* and at most, when long none has come */

/* Hand that was dealt to a rank, until MPI has it. */
struct answer {
    struct deal_hand hand;
    MPI_Request request;
};

struct dealer {
    struct deal *deal;
    struct answer *answers; /* [ranks]; of the root none */
    uint64_t next;          /* item to be looked at next */
    uint64_t left;          /* to be dealt yet */
    uint64_t bound;         /* items from here on are not dealt any more */
    int ranks;              /* that have not ended */
    int status;             /* of the lowest rank that had an error */
    int rank;
    struct ctl_error *error;
};

static void give_up(const char *why)
{
    (void)ctl_complain("%s", why);
    MPI_Abort(MPI_COMM_WORLD, CTL_FAILED);
}

/* ---- the second thread ------------------------------------------------------------- */

void deal_root_tell(struct deal *deal, const struct deal_tell *tell)
{
    struct deal_note *note = malloc(sizeof *note);
    if (note == NULL) {
        give_up("out of memory");
        return;
    }
    *note = (struct deal_note){.tell = *tell};
    pthread_mutex_lock(&deal->lock);
    *deal->last = note;
    deal->last = &note->next;
    pthread_cond_signal(&deal->told);
    pthread_mutex_unlock(&deal->lock);
}

static void *compute(void *context)
{
    struct deal *deal = context;
    struct deal_tell tell = {.word = DEAL_END};
    struct ctl_error error = {.text = ""};
    tell.status = deal->work->compute(deal->work->compute_context, deal, &error);
    tell.with.error = error;
    deal_root_tell(deal, &tell);
    return NULL;
}

/* ---- dealing ----------------------------------------------------------------------- */

/* The lowest rank's error counts, so that a mistake of all is told in the same way. */
static void note_error(struct dealer *dealer, int rank, int status, const char *text)
{
    if (dealer->status != PCCD_OK && dealer->rank <= rank) {
        return;
    }
    dealer->status = status;
    dealer->rank = rank;
    (void)ctl_error_set(dealer->error, status, "rank %d: %.990s", rank,
                        text[0] != '\0' ? text : pccd_status_text(status));
    dealer->bound = 0;
}

/* A quarter of a rank's share of what is left, one at least: few messages at first, and
 * at the end nobody has much more to do than another. */
static void deal_hand(struct dealer *dealer, struct deal_hand *hand)
{
    const struct deal_work *work = dealer->deal->work;
    uint64_t share = dealer->left / (PARTS * (uint64_t)together_size());
    uint64_t most = share < 1 ? 1 : share > DEAL_HAND ? DEAL_HAND : share;
    memset(hand, 0, sizeof *hand);
    while (hand->count < most && dealer->next < work->count &&
           dealer->next < dealer->bound) {
        if (!work->is_done(work->context, dealer->next)) {
            hand->items[hand->count++] = dealer->next;
            dealer->left--;
        }
        dealer->next++;
    }
}

void deal_root_take(struct deal *deal, struct deal_hand *hand)
{
    pthread_mutex_lock(&deal->lock);
    deal_hand(deal->dealer, hand);
    pthread_mutex_unlock(&deal->lock);
}

static void answer(struct dealer *dealer, int rank)
{
    struct answer *answer = &dealer->answers[rank];
    together_wait(&answer->request); /* it asks again when it has the last one */
    deal_root_take(dealer->deal, &answer->hand);
    MPI_Isend(&answer->hand, (int)sizeof answer->hand, MPI_BYTE, rank, DEAL_TAG_HAND,
              MPI_COMM_WORLD, &answer->request);
}

static void take_result(struct dealer *dealer, const struct deal_tell *tell)
{
    const struct deal_work *work = dealer->deal->work;
    struct ctl_error error = {.text = ""};
    bool is_last = false;
    int status =
        work->take(work->context, tell->item, tell->with.result, &is_last, &error);
    if (status != PCCD_OK) {
        note_error(dealer, 0, status, error.text);
    }
    if (is_last && tell->item < dealer->bound) {
        dealer->bound = tell->item;
    }
}

static void take(struct dealer *dealer, int rank, const struct deal_tell *tell)
{
    struct deal *deal = dealer->deal;
    if (tell->word == DEAL_ASK) {
        answer(dealer, rank);
        return;
    }
    pthread_mutex_lock(&deal->lock);
    if (tell->word == DEAL_RESULT) {
        take_result(dealer, tell);
    } else {
        dealer->ranks--;
        if (tell->status != PCCD_OK) {
            note_error(dealer, rank, tell->status, tell->with.error.text);
        }
    }
    pthread_mutex_unlock(&deal->lock);
}

/* Everything that has come from other ranks. Returns whether there was anything. */
static bool take_messages(struct dealer *dealer)
{
    bool has_any = false;
    for (;;) {
        struct deal_tell tell;
        MPI_Status status;
        int is_there = 0;
        MPI_Iprobe(MPI_ANY_SOURCE, DEAL_TAG_TELL, MPI_COMM_WORLD, &is_there, &status);
        if (!is_there) {
            return has_any;
        }
        MPI_Recv(&tell, (int)sizeof tell, MPI_BYTE, status.MPI_SOURCE, DEAL_TAG_TELL,
                 MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        take(dealer, status.MPI_SOURCE, &tell);
        has_any = true;
    }
}

/* The same from the second thread; without any, wait for one, but not for long. */
static bool take_notes(struct dealer *dealer, uint32_t wait_ns)
{
    struct deal *deal = dealer->deal;
    pthread_mutex_lock(&deal->lock);
    if (deal->first == NULL && wait_ns > 0) {
        struct timespec until;
        clock_gettime(CLOCK_MONOTONIC, &until);
        until.tv_nsec += wait_ns;
        until.tv_sec += until.tv_nsec / 1000000000;
        until.tv_nsec %= 1000000000;
        (void)pthread_cond_timedwait(&deal->told, &deal->lock, &until);
    }
    struct deal_note *note = deal->first;
    deal->first = NULL;
    deal->last = &deal->first;
    pthread_mutex_unlock(&deal->lock);
    bool has_any = note != NULL;
    while (note != NULL) {
        struct deal_note *next = note->next;
        take(dealer, 0, &note->tell);
        free(note);
        note = next;
    }
    return has_any;
}

/* Look for messages until all ranks have ended. Of two ranks that compute a step in 40
 * ms, one message comes in 20 ms: it is looked for ten times, and not later than half of
 * the time that it took to come. */
static void listen(struct dealer *dealer)
{
    const struct deal_work *work = dealer->deal->work;
    uint32_t pause_ns = 0;
    while (dealer->ranks > 0) {
        bool has_note = take_notes(dealer, pause_ns);
        bool has_any = take_messages(dealer) || has_note;
        uint32_t longer = pause_ns + pause_ns / 2;
        longer = longer < PAUSE_NS ? PAUSE_NS : longer;
        pause_ns = has_any ? 0 : longer < PAUSE_NS_MAX ? longer : PAUSE_NS_MAX;
        if (terminal_was_interrupted()) {
            work->interrupted(work->context);
            MPI_Abort(MPI_COMM_WORLD, CTL_FAILED);
        }
    }
}

int deal_root(struct deal *deal, struct ctl_error *error)
{
    const struct deal_work *work = deal->work;
    const int size = together_size();
    struct dealer dealer = {
        .deal = deal, .bound = UINT64_MAX, .ranks = size, .error = error};
    pthread_condattr_t clock;
    pthread_t thread;
    pthread_condattr_init(&clock);
    pthread_condattr_setclock(&clock, CLOCK_MONOTONIC);
    pthread_mutex_init(&deal->lock, NULL);
    pthread_cond_init(&deal->told, &clock);
    pthread_condattr_destroy(&clock);
    deal->last = &deal->first;
    deal->dealer = &dealer;
    for (uint64_t i = 0; i < work->count; i++) {
        dealer.left += work->is_done(work->context, i) ? 0 : 1;
    }
    dealer.answers = malloc((size_t)size * sizeof *dealer.answers);
    terminal_catch_interrupts();
    if (dealer.answers == NULL || pthread_create(&thread, NULL, compute, deal) != 0) {
        give_up("no thread to compute in");
        return PCCD_E_SYSTEM;
    }
    for (int r = 0; r < size; r++) {
        dealer.answers[r].request = MPI_REQUEST_NULL;
    }
    listen(&dealer);
    pthread_join(thread, NULL);
    for (int r = 0; r < size; r++) {
        together_wait(&dealer.answers[r].request);
    }
    free(dealer.answers);
    pthread_cond_destroy(&deal->told);
    pthread_mutex_destroy(&deal->lock);
    return dealer.status;
}
