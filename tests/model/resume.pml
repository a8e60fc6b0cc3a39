/* resume.pml - every step is answered once, with the right positions.
 *
 * Model of PROTOCOL.md, "When the connection is lost": client/lib/recover.c and
 * daemon/server/{linger,replies,dispatch}.c. Step k moves the objects from position k-1
 * to k; its answer tells the position. Connections are cut at any moment, with whatever
 * is on its way; the daemon crashes at any moment and comes back with nothing.
 *
 * Checked: answers are taken in order, each once, each with its own position (assertions);
 * all of them in the end (no invalid end state).
 *
 * MUTANT 1  answers are not kept: what comes again is computed again
 * MUTANT 2  one answer less is kept than requests may be without an answer
 * MUTANT 3  a request that is still in flight is not recognised when it comes again
 * MUTANT 4  the newest of the requests without an answer is sent again first
 * MUTANT 5  another daemon is not told where the objects were
 * MUTANT 6  what was in flight is answered over the next connection before it comes again
 */
#ifndef MUTANT
#define MUTANT 0
#endif

#define STEPS   4
#define WINDOW  2 /* requests without an answer */
#define CUTS    2
#define CRASHES 1
#if MUTANT == 2
#define KEPT (WINDOW - 1)
#else
#define KEPT WINDOW
#endif

chan request = [4] of { byte, byte };     /* connection, id */
chan answer = [8] of { byte, byte, byte }; /* connection, id, position */
chan jobs = [4] of { byte };              /* in flight, of the session */

bit up = 1; /* the connection stands */
byte connection = 0;
byte epoch = 0;

/* The daemon's session. */
byte position = 0;
byte newest = 0;
bit in_flight[STEPS + 1];
bit held[STEPS + 1]; /* not to be answered unless it comes again */
byte kept_id[WINDOW];
byte kept_position[WINDOW];
byte kept_next = 0;

/* The client. */
byte answered = 0;
byte next = 1;
byte known_epoch = 0;

inline reply(id, at)
{
    if
    :: up -> answer!connection, id, at
    :: !up /* nobody is there to be sent to */
    fi
}

/* At the loss, or when the client is back before the daemon has seen it. */
inline hold()
{
    byte i;
    i = 1;
    do
    :: i <= STEPS -> held[i] = 1; i++
    :: else -> break
    od
}

inline begin(id)
{
    in_flight[id] = 1;
    held[id] = 0;
    jobs!id
}

inline forget_session()
{
    position = 0; newest = 0; kept_next = 0;
    kept_id[0] = 0; kept_id[1] = 0;
    do
    :: jobs?gone -> in_flight[gone] = 0
    :: empty(jobs) -> break
    od;
    do /* its sockets are gone, with what was not read */
    :: request?_, _
    :: empty(request) -> break
    od
}

active proctype loop() /* the daemon's loop thread */
{
    byte from, id;
    bit known;
end:
    do
    :: atomic { request?from, id ->
#if MUTANT == 3
        known = 0;
#else
        known = in_flight[id];
#endif
        if
        :: from != connection /* its socket is closed */
        :: from == connection && id > newest -> newest = id; begin(id)
        :: from == connection && id <= newest ->
            if
            :: known -> held[id] = 0 /* its answer comes when it is computed */
            :: !known ->
                if
#if MUTANT != 1
                :: kept_id[0] == id -> reply(id, kept_position[0])
                :: kept_id[1] == id -> reply(id, kept_position[1])
#endif
                :: else -> begin(id)
                fi
            fi
        fi }
    od
}

active proctype compute() /* the daemon's compute thread */
{
    byte id;
end:
    do
    :: atomic { jobs?<id> ->
        jobs?id;
        in_flight[id] = 0;
        position++;
        kept_id[kept_next % KEPT] = id;
        kept_position[kept_next % KEPT] = position;
        kept_next++;
        if
#if MUTANT != 6
        :: held[id]
        :: !held[id] -> reply(id, position)
#else
        :: true -> reply(id, position)
#endif
        fi }
    od
}

active proctype world()
{
    byte cuts = 0, crashes = 0, gone;
end:
    do
    :: atomic { up && cuts < CUTS && answered < STEPS -> up = 0; cuts++ }
    :: atomic { crashes < CRASHES && answered < STEPS ->
        up = 0; crashes++; epoch++; forget_session() }
    od
}

inline connect_again()
{
    connection++;
    up = 1;
    do /* what was on its way is lost with the old socket */
    :: request?_, _
    :: empty(request) -> break
    od;
    if
    :: known_epoch == epoch -> hold() /* resumed */
    :: else ->
        known_epoch = epoch;
#if MUTANT != 5
        position = answered
#endif
    fi;
#if MUTANT == 4
    id = next - 1;
    do
    :: id > answered -> request!connection, id; id--
    :: else -> break
    od
#else
    id = answered + 1;
    do
    :: id < next -> request!connection, id; id++
    :: else -> break
    od
#endif
}

active proctype client()
{
    byte from, id, at;
    do
    :: atomic { up && next <= STEPS && next - answered <= WINDOW ->
        request!connection, next; next++ }
    :: atomic { answer?from, id, at -> /* also what had come before the cut */
        assert(id == answered + 1);
        assert(at == id);
        answered++ }
    :: atomic { !up && answered < STEPS && empty(answer) -> connect_again() }
    :: answered == STEPS -> break
    od
}
