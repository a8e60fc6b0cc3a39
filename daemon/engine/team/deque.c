/* deque.c - a bounded work-stealing deque. */
#include "deque.h"

void eng_deque_init(struct eng_deque *deque)
{
    atomic_init(&deque->top, 0);
    atomic_init(&deque->bottom, 0);
    for (uint32_t i = 0; i < ENG_DEQUE_MAX; i++) {
        atomic_init(&deque->tasks[i], 0);
    }
}

static atomic_uint_fast64_t *place(struct eng_deque *deque, int64_t i)
{
    return &deque->tasks[(uint64_t)i & (ENG_DEQUE_MAX - 1)];
}

bool eng_deque_push(struct eng_deque *deque, uint64_t task)
{
    /* Relaxed: only the owner writes bottom. */
    int64_t bottom = atomic_load_explicit(&deque->bottom, memory_order_relaxed);
    /* Acquire: a place may be written again once its thief has moved top past it. */
    int64_t top = atomic_load_explicit(&deque->top, memory_order_acquire);
    if (bottom - top >= (int64_t)ENG_DEQUE_MAX) {
        return false;
    }
    atomic_store_explicit(place(deque, bottom), task, memory_order_relaxed);
    /* Release: a thief that sees the new bottom sees the task. */
    atomic_store_explicit(&deque->bottom, bottom + 1, memory_order_release);
    return true;
}

bool eng_deque_pop(struct eng_deque *deque, uint64_t *task)
{
    int64_t bottom = atomic_load_explicit(&deque->bottom, memory_order_relaxed) - 1;
    /* seq_cst: this store and the load of top are the owner's half of a store-load pair;
     * a thief loads top, then bottom. One of them sees the other. */
    atomic_store_explicit(&deque->bottom, bottom, memory_order_seq_cst);
    int64_t top = atomic_load_explicit(&deque->top, memory_order_seq_cst);
    if (top > bottom) {
        atomic_store_explicit(&deque->bottom, bottom + 1, memory_order_relaxed);
        return false;
    }
    *task = atomic_load_explicit(place(deque, bottom), memory_order_relaxed);
    if (top < bottom) {
        return true;
    }
    /* The last task: race the thieves for it. */
    bool won = atomic_compare_exchange_strong_explicit(
        &deque->top, &top, top + 1, memory_order_seq_cst, memory_order_acquire);
    atomic_store_explicit(&deque->bottom, bottom + 1, memory_order_relaxed);
    return won;
}

bool eng_deque_steal(struct eng_deque *deque, uint64_t *task)
{
    int64_t top = atomic_load_explicit(&deque->top, memory_order_seq_cst);
    int64_t bottom = atomic_load_explicit(&deque->bottom, memory_order_seq_cst);
    if (top >= bottom) {
        return false;
    }
    *task = atomic_load_explicit(place(deque, top), memory_order_relaxed);
    return atomic_compare_exchange_strong_explicit(
        &deque->top, &top, top + 1, memory_order_seq_cst, memory_order_relaxed);
}
