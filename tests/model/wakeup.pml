/* wakeup.pml - completion without a wake-up: no client sleeps beside its answer.
 *
 * Model of PROTOCOL.md, "Completion without a wake-up": client/lib/rpc.c (cli_progress)
 * and daemon/server/request.c (conclude), of a daemon that leaves the wake-up out while
 * client_wait is 0. Loads and stores are sequentially consistent, as both sides make them.
 *
 * Checked: no execution ends with an answer that nobody takes (an invalid end state).
 *
 * MUTANT 1  the client does not look once more after it has stored client_wait
 * MUTANT 2  the daemon loads client_wait before its store is seen (not seq_cst)
 * MUTANT 3  the client stores client_wait only after its last look
 */
#ifndef MUTANT
#define MUTANT 0
#endif
#define ANSWERS 3

byte done_seq = 0;  /* answers that are there: the daemon's */
bit client_wait = 0; /* the client's */
bit woken = 0;      /* the wake-up: stays until it is taken */
byte taken = 0;

active proctype daemon()
{
    byte sent = 0;
    bit waits;
    do
    :: sent < ANSWERS ->
#if MUTANT == 2
        waits = client_wait;
        done_seq++;
#else
        done_seq++;
        waits = client_wait;
#endif
        if
        :: waits -> woken = 1
        :: else
        fi;
        sent++
    :: else -> break
    od
}

/* Take what is there. */
inline look()
{
    atomic { taken = done_seq }
}

active proctype client()
{
    byte before;
    do
    :: taken == ANSWERS -> break
    :: else ->
        before = taken;
        look();
        if
        :: taken > before -> skip
        :: else ->
#if MUTANT == 3
            look();
            if
            :: taken > before -> skip
            :: else -> client_wait = 1; woken == 1; woken = 0; client_wait = 0
            fi
#else
            client_wait = 1;
#if MUTANT != 1
            look();
#endif
            if
            :: taken > before -> skip
            :: else -> woken == 1; woken = 0
            fi;
            client_wait = 0
#endif
        fi
    od;
    assert(taken == ANSWERS)
}
