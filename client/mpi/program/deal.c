/* deal.c - the items of a long work, on the rank that deals and on those that compute.
 *
 * The root listens to the other ranks while its second thread computes. It looks for
 * messages often, and sleeps between: a thread that waited in MPI would take a processor
 * from those that compute. It does not wait until a message is taken, either: who
 * computes a step for minutes takes none.
 */
#include "deal.h"

#include <mpi.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "ctl.h"
#include "pccd.h"
#include "terminal.h"
#include "together.h"

#define PARTS        4u      /* a rank gets a quarter of its share of what is left, */
#define HAND_MAX     64u     /* and at most so many items */
#define SENT         8u      /* messages of a rank that MPI may have yet to send */
#define PAUSE_NS     100000  /* between two looks for messages: after one, */
#define PAUSE_NS_MAX 4000000 /* and at most, when long none has come */

enum { TAG_TELL = 1, TAG_HAND };

enum word {
    ASK,    /* give me items */
    RESULT, /* here is the result of one */
    END     /* I shall not ask again: done, or an error */
};

/* A rank tells the root. */
struct tell {
    uint32_t word; /* enum word */
    int32_t status;
    uint64_t item;
    union {
        unsigned char result[DEAL_RESULT_BYTES];
        struct ctl_error error;
    } with;
};

/* Message of a rank, until MPI has it. */
struct sent {
    struct tell tell;
    MPI_Request request;
};

/* Items one after the other that are a rank's to do; count 0: nothing is left. */
struct hand {
    uint64_t first, count;
};

/* Hand that was dealt to a rank, until MPI has it. */
struct answer {
    struct hand hand;
    MPI_Request request;
};

struct deal {
    const struct deal_work *work;
    struct hand hand;     /* items that this rank has not begun */
    struct answer coming; /* others than the root: the items that come next, */
    bool is_asked;        /* which are on their way; and what has gone, by turns */
    struct sent sent[SENT];
    uint32_t turn;
    /* The root: under the lock. */
    pthread_mutex_t lock;
    uint64_t next;  /* item to be dealt next */
    uint64_t bound; /* items from here on are not dealt any more */
    int ranks;      /* that have not ended */
    int status;     /* of the lowest rank that had an error */
    int rank;
    struct ctl_error *error;
};

/* ---- dealing ----------------------------------------------------------------------- */

/* The lowest rank's error counts, so that a mistake of all is told in the same way. */
static void note_error(struct deal *deal, int rank, int status, const char *text)
{
    if (deal->status != PCCD_OK && deal->rank <= rank) {
        return;
    }
    deal->status = status;
    deal->rank = rank;
    (void)ctl_error_set(deal->error, status, "rank %d: %.990s", rank,
                        text[0] != '\0' ? text : pccd_status_text(status));
    deal->bound = 0;
}

/* A quarter of a rank's share of what is left, one at least: few messages at first, and
 * at the end nobody has much more to do than another. */
static struct hand deal_hand(struct deal *deal)
{
    pthread_mutex_lock(&deal->lock);
    uint64_t left = deal->next < deal->bound ? deal->bound - deal->next : 0;
    uint64_t share = left / (PARTS * (uint64_t)together_size());
    uint64_t most = share < 1 ? 1 : share > HAND_MAX ? HAND_MAX : share;
    const struct hand hand = {deal->next, left < most ? left : most};
    deal->next += hand.count;
    pthread_mutex_unlock(&deal->lock);
    return hand;
}

/* Take a result, or that a rank has ended. */
static void take(struct deal *deal, int rank, const struct tell *tell)
{
    pthread_mutex_lock(&deal->lock);
    if (tell->word == RESULT) {
        struct ctl_error error = {.text = ""};
        bool is_last = false;
        int status = deal->work->take(deal->work->context, tell->item, tell->with.result,
                                      &is_last, &error);
        if (status != PCCD_OK) {
            note_error(deal, 0, status, error.text);
        }
        if (is_last && tell->item < deal->bound) {
            deal->bound = tell->item;
        }
    } else {
        deal->ranks--;
        if (tell->status != PCCD_OK) {
            note_error(deal, rank, tell->status, tell->with.error.text);
        }
    }
    pthread_mutex_unlock(&deal->lock);
}

/* Take everything that has come from other ranks. Return whether there was anything. */
static bool take_messages(struct deal *deal, struct answer *answers)
{
    bool has_any = false;
    for (;;) {
        struct tell tell;
        MPI_Status status;
        int is_there = 0;
        MPI_Iprobe(MPI_ANY_SOURCE, TAG_TELL, MPI_COMM_WORLD, &is_there, &status);
        if (!is_there) {
            return has_any;
        }
        const int rank = status.MPI_SOURCE;
        MPI_Recv(&tell, (int)sizeof tell, MPI_BYTE, rank, TAG_TELL, MPI_COMM_WORLD,
                 MPI_STATUS_IGNORE);
        if (tell.word == ASK) {
            struct answer *answer = &answers[rank];
            together_wait(&answer->request); /* it asks again when it has the last one */
            answer->hand = deal_hand(deal);
            MPI_Isend(&answer->hand, (int)sizeof answer->hand, MPI_BYTE, rank, TAG_HAND,
                      MPI_COMM_WORLD, &answer->request);
        } else {
            take(deal, rank, &tell);
        }
        has_any = true;
    }
}

static bool is_over(struct deal *deal)
{
    pthread_mutex_lock(&deal->lock);
    bool is_over = deal->ranks == 0;
    pthread_mutex_unlock(&deal->lock);
    return is_over;
}

/* Look for messages until all ranks have ended. Of two ranks that compute a step in 40
 * ms, one message comes in 20 ms: it is looked for ten times, and not later than half of
 * the time that it took to come. */
static void listen(struct deal *deal, struct answer *answers)
{
    struct timespec pause = {0, 0};
    while (!is_over(deal)) {
        long longer = pause.tv_nsec + pause.tv_nsec / 2;
        longer = longer < PAUSE_NS ? PAUSE_NS : longer;
        pause.tv_nsec = take_messages(deal, answers) ? 0
                        : longer < PAUSE_NS_MAX      ? longer
                                                     : PAUSE_NS_MAX;
        if (terminal_was_interrupted()) {
            pthread_mutex_lock(&deal->lock);
            deal->work->interrupted(deal->work->context);
            MPI_Abort(MPI_COMM_WORLD, CTL_FAILED);
        }
        nanosleep(&pause, NULL);
    }
}

/* ---- computing --------------------------------------------------------------------- */

/* Tell the root, from any rank. */
static void tell_root(struct deal *deal, const struct tell *tell)
{
    struct sent *sent = &deal->sent[deal->turn++ % SENT];
    if (together_is_root()) {
        take(deal, 0, tell);
        return;
    }
    together_wait(&sent->request);
    sent->tell = *tell;
    MPI_Isend(&sent->tell, (int)sizeof sent->tell, MPI_BYTE, 0, TAG_TELL, MPI_COMM_WORLD,
              &sent->request);
}

static void ask(struct deal *deal)
{
    const struct tell tell = {.word = ASK};
    MPI_Irecv(&deal->coming.hand, (int)sizeof deal->coming.hand, MPI_BYTE, 0, TAG_HAND,
              MPI_COMM_WORLD, &deal->coming.request);
    deal->is_asked = true;
    tell_root(deal, &tell);
}

/* Get the next items, which may have to be waited for. */
static struct hand take_hand(struct deal *deal)
{
    if (together_is_root()) {
        return deal_hand(deal);
    }
    if (!deal->is_asked) {
        ask(deal);
    }
    together_wait(&deal->coming.request);
    deal->is_asked = false;
    return deal->coming.hand;
}

uint64_t deal_next(struct deal *deal)
{
    if (deal->hand.count == 0) {
        deal->hand = take_hand(deal);
    }
    if (deal->hand.count == 0) {
        return DEAL_NONE;
    }
    if (--deal->hand.count == 0 && !together_is_root()) {
        ask(deal); /* the answer comes while this item is computed */
    }
    return deal->hand.first++;
}

void deal_put(struct deal *deal, uint64_t item, const void *result)
{
    struct tell tell = {.word = RESULT, .item = item};
    memcpy(tell.with.result, result, deal->work->result_bytes);
    tell_root(deal, &tell);
}

/* Compute until nothing is left, and say so. After an error an answer may still come: it
 * is waited for, its memory is ours. */
static void *compute(void *context)
{
    struct deal *deal = context;
    struct tell tell = {.word = END};
    struct ctl_error error = {.text = ""};
    tell.status = deal->work->compute(deal->work->context, deal, &error);
    tell.with.error = error;
    if (deal->is_asked) {
        together_wait(&deal->coming.request);
    }
    tell_root(deal, &tell);
    for (uint32_t i = 0; i < SENT && !together_is_root(); i++) {
        together_wait(&deal->sent[i].request);
    }
    return NULL;
}

/* Deal, on the root, while a second thread computes. */
static void deal_root(struct deal *deal)
{
    const size_t size = (size_t)together_size();
    struct answer *answers = malloc(size * sizeof *answers);
    pthread_t thread;
    pthread_mutex_init(&deal->lock, NULL);
    terminal_catch_interrupts();
    if (answers == NULL || pthread_create(&thread, NULL, compute, deal) != 0) {
        (void)ctl_complain("no thread to compute in");
        MPI_Abort(MPI_COMM_WORLD, CTL_FAILED);
        return;
    }
    for (size_t r = 0; r < size; r++) {
        answers[r].request = MPI_REQUEST_NULL;
    }
    listen(deal, answers);
    pthread_join(thread, NULL);
    for (size_t r = 0; r < size; r++) {
        together_wait(&answers[r].request);
    }
    free(answers);
    pthread_mutex_destroy(&deal->lock);
}

int deal(const struct deal_work *work, struct ctl_error *error)
{
    struct deal deal = {
        .work = work, .bound = work->count, .ranks = together_size(), .error = error};
    for (uint32_t i = 0; i < SENT; i++) {
        deal.sent[i].request = MPI_REQUEST_NULL;
    }
    if (together_is_root()) {
        deal_root(&deal);
    } else {
        (void)compute(&deal);
    }
    together_tell(&deal.status, sizeof deal.status);
    together_tell(error, sizeof *error);
    return deal.status;
}
