/* peer.c - a client that does what an input says.
 *
 * Everything without an allocation of its own, but for msgpack-c's: those that fail shall
 * be the server's.
 */
#include "peer.h"

#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "host.h"
#include "seqpacket.h"

#define WAIT_MS 120000 /* for an answer that must come */
#define PING_ID 0xffffffffu

void fuzz_peer_open(struct fuzz_peer *peer)
{
    fuzz_scarcity_pause();
    *peer = (struct fuzz_peer){.socket = fuzz_host_connect(),
                               .upload = PROTO_MEMORY_NONE,
                               .results = PROTO_MEMORY_NONE,
                               .decoder = proto_decoder_new(),
                               .next_id = 1};
    FUZZ_CHECK(peer->decoder != NULL);
    fuzz_scarcity_resume();
}

void fuzz_peer_close(struct fuzz_peer *peer)
{
    close(peer->socket);
    peer->socket = -1;
    proto_memory_deinit(&peer->upload);
    proto_memory_deinit(&peer->results);
    proto_decoder_free(peer->decoder);
    peer->decoder = NULL;
}

/* ---- sending ----------------------------------------------------------------------- */

static void take_answer(struct fuzz_peer *peer, bool *is_ping);

/* Wait for an event, whatever alarm of the fuzzer rings meanwhile. */
static void await(struct pollfd *watched)
{
    int count;
    do {
        count = poll(watched, 1, WAIT_MS);
    } while (count < 0 && errno == EINTR);
    FUZZ_CHECK(count > 0);
}

/* Send one datagram; take answers while the server does not take it. */
void fuzz_peer_send(struct fuzz_peer *peer, const void *data, size_t bytes, int fd_count)
{
    int fds[PROTO_FDS_MAX] = {peer->socket, peer->socket};
    bool is_ping = false;
    if (bytes == 0) {
        return;
    }
    while (!peer->is_over) {
        struct pollfd watched = {.fd = peer->socket, .events = POLLOUT | POLLIN};
        await(&watched);
        if ((watched.revents & POLLIN) != 0) {
            take_answer(peer, &is_ping);
        } else if ((watched.revents & (POLLHUP | POLLERR)) != 0) {
            peer->is_over = true;
        } else {
            int status = proto_send(peer->socket, data, bytes, fds,
                                    fd_count < PROTO_FDS_MAX ? fd_count : PROTO_FDS_MAX);
            if (status == PCCD_E_AGAIN) { /* there is room, but not for so much */
                continue;
            }
            if (status == PCCD_E_SYSTEM && fd_count > 0 && errno == EPERM) {
                fd_count = 0; /* refused by the kernel (seqpacket.h) */
                continue;
            }
            FUZZ_CHECK(status == 0 || status == PCCD_E_DISCONNECTED);
            peer->is_over = status != 0;
            return;
        }
    }
}

/* A number of the kinds that matter: small ones, handles, limits, any. */
static uint64_t take_number(struct fuzz_peer *peer, struct fuzz_input *input)
{
    uint8_t choice = fuzz_take_u8(input);
    switch (choice % 16) {
    case 0:
    case 1:
    case 2:
    case 3:
    case 4:
        return choice % 16;
    case 5:
        return 1u << 20; /* the first handle of a table */
    case 6:
        return (1u << 20) + 1;
    case 7:
        return (2u << 20);
    case 8:
        return fuzz_peer_publish(peer, 0);
    case 9:
        return fuzz_peer_publish(peer, 1);
    case 10:
        return fuzz_take_u8(input);
    case 11:
        return fuzz_take_u16(input);
    case 12:
        return fuzz_take_u32(input);
    case 13:
        return fuzz_take_u64(input);
    case 14:
        return 65536;
    default:
        return UINT64_MAX;
    }
}

/* So many times the same letter, for names that two clients give; or a word. Settings are
 * those that change nothing for the visitor. */
static void take_text(uint64_t number, struct fuzz_input *input, char *member)
{
    static const char *const words[] = {"",   "grace", "threads",  "0",
                                        "-1", "8",     "\xc3\xa9", "\n\x7f%s"};
    if (number == UINT64_MAX) {
        strcpy(member, words[fuzz_take_u8(input) % (sizeof words / sizeof words[0])]);
        return;
    }
    memset(member, 'x', number % PROTO_STR_MAX);
}

static void take_field(struct fuzz_peer *peer, const struct proto_field *field,
                       struct fuzz_input *input, char *member)
{
    uint64_t number = take_number(peer, input);
    double real;
    switch (field->type) {
    case PROTO_TYPE_u32:
        memcpy(member, &(uint32_t){(uint32_t)number}, sizeof(uint32_t));
        break;
    case PROTO_TYPE_u64:
        memcpy(member, &number, sizeof number);
        break;
    case PROTO_TYPE_f64:
        real = (double)number;
        memcpy(member, number > UINT32_MAX ? (const void *)&number : (const void *)&real,
               sizeof real);
        break;
    case PROTO_TYPE_bool:
        memcpy(member, &(bool){number % 2 == 1}, sizeof(bool));
        break;
    case PROTO_TYPE_str:
        take_text(number, input, member);
        break;
    }
}

void fuzz_peer_ask(struct fuzz_peer *peer, int method, struct fuzz_input *input)
{
    static struct proto_encoder encoder;
    static _Alignas(8) char body[4096];
    const struct proto_fields *fields = &proto_messages[method].request;
    memset(body, 0, sizeof body);
    FUZZ_CHECK(fields->struct_bytes <= sizeof body);
    for (uint32_t i = 0; i < fields->count; i++) {
        take_field(peer, &fields->items[i], input, body + fields->items[i].offset);
    }
    if (method == PROTO_METHOD_HELLO) {
        peer->hello_id = peer->next_id;
    }
    FUZZ_CHECK(proto_encode_request(&encoder, peer->next_id++, method, body) == 0);
    fuzz_peer_send(peer, encoder.data, encoder.bytes, 0);
}

static void say_hello_again(struct fuzz_peer *peer)
{
    static struct proto_encoder encoder;
    const struct proto_HELLO_request hello = {
        .version_min = PROTO_VERSION_MIN,
        .version_max = PROTO_VERSION_MAX,
        .resumable = true,
        .resume_epoch = peer->welcome.epoch,
        .resume_session = peer->welcome.session,
        .token_hi = peer->welcome.token_hi,
        .token_lo = peer->welcome.token_lo,
    };
    peer->hello_id = peer->next_id++;
    FUZZ_CHECK(
        proto_encode_request(&encoder, peer->hello_id, PROTO_METHOD_HELLO, &hello) == 0);
    fuzz_peer_send(peer, encoder.data, encoder.bytes, 0);
}

void fuzz_peer_return(struct fuzz_peer *peer)
{
    close(peer->socket);
    peer->socket = fuzz_host_connect();
    peer->is_over = false;
    say_hello_again(peer);
    /* What was asked last may come again under its number. */
    peer->next_id = peer->hello_id > 2 ? peer->hello_id - 2 : peer->next_id;
}

/* ---- answers ----------------------------------------------------------------------- */

/* The memories of a ring; the sizes are what the descriptors say. */
static void take_ring(struct fuzz_peer *peer, const int fds[2])
{
    struct stat info[2];
    FUZZ_CHECK(fstat(fds[0], &info[0]) == 0 && fstat(fds[1], &info[1]) == 0);
    proto_memory_deinit(&peer->upload);
    proto_memory_deinit(&peer->results);
    FUZZ_CHECK(
        proto_memory_map(&peer->upload, fds[0], (size_t)info[0].st_size, false) == 0 &&
        proto_memory_map(&peer->results, fds[1], (size_t)info[1].st_size, true) == 0);
    peer->release = 0;
}

/* Check a message of the server's, as far as there is memory to decode it. */
static void check_message(struct fuzz_peer *peer, const void *data, size_t bytes,
                          bool *is_ping)
{
    struct proto_envelope envelope;
    struct proto_error error;
    int status = proto_decode(peer->decoder, data, bytes, &envelope, &error);
    FUZZ_CHECK(status == 0 || status == PCCD_E_NOMEM);
    *is_ping = false;
    if (status != 0) {
        return;
    }
    if (envelope.kind == PROTO_NOTIFICATION) { /* of a step */
        FUZZ_CHECK(envelope.method >= PROTO_METHOD_COUNT);
        return;
    }
    FUZZ_CHECK(envelope.kind == PROTO_RESPONSE);
    FUZZ_CHECK(!envelope.failed || envelope.error.text[0] != '\0');
    if (!envelope.failed && envelope.id == peer->hello_id) {
        (void)proto_decode_body(&envelope, &proto_messages[PROTO_METHOD_HELLO].result,
                                &peer->welcome, &error);
    }
    *is_ping = envelope.id == PING_ID;
    peer->answered++;
}

static void take_answer(struct fuzz_peer *peer, bool *is_ping)
{
    static uint8_t buffer[PROTO_MESSAGE_BYTES_MAX];
    int fds[PROTO_FDS_MAX];
    int fd_count = 0;
    size_t bytes = 0;
    int status =
        proto_receive(peer->socket, buffer, sizeof buffer, &bytes, fds, &fd_count);
    if (status != 0) {
        FUZZ_CHECK(status == PCCD_E_DISCONNECTED);
        peer->is_over = true;
        return;
    }
    FUZZ_CHECK(fd_count == 0 || fd_count == 2);
    if (fd_count == 2) {
        take_ring(peer, fds);
    }
    check_message(peer, buffer, bytes, is_ping);
}

void fuzz_peer_settle(struct fuzz_peer *peer)
{
    static struct proto_encoder encoder;
    const struct proto_PING_request ping = {0};
    bool is_ping = false;
    uint32_t taken = peer->answered;
    FUZZ_CHECK(proto_encode_request(&encoder, PING_ID, PROTO_METHOD_PING, &ping) == 0);
    fuzz_peer_send(peer, encoder.data, encoder.bytes, 0);
    while (!peer->is_over && !is_ping) {
        struct pollfd watched = {.fd = peer->socket, .events = POLLIN};
        await(&watched);
        take_answer(peer, &is_ping);
        if (peer->answered == taken && fuzz_scarcity_hits() > 0) {
            return; /* it may have been this one that could not be decoded */
        }
        taken = peer->answered;
    }
}

/* ---- the ring ---------------------------------------------------------------------- */

void fuzz_peer_write(struct fuzz_peer *peer, struct fuzz_input *input)
{
    size_t at = fuzz_take_u16(input);
    uint8_t bytes[256];
    size_t count = fuzz_take_bytes(input, bytes, fuzz_take_u8(input));
    if (peer->upload.base != NULL && at + count <= peer->upload.bytes) {
        memcpy((uint8_t *)peer->upload.base + at, bytes, count);
    }
}

uint64_t fuzz_peer_publish(struct fuzz_peer *peer, uint32_t slot)
{
    struct proto_upload *shared = peer->upload.base;
    if (shared == NULL) {
        return 2;
    }
    uint64_t seq = (atomic_load(&shared->slots[slot % PROTO_SLOTS_MAX].seq) | 1u) + 1u;
    atomic_store(&shared->slots[slot % PROTO_SLOTS_MAX].seq, seq);
    return seq;
}

void fuzz_peer_release(struct fuzz_peer *peer, uint64_t head)
{
    struct proto_upload *shared = peer->upload.base;
    if (shared != NULL) {
        atomic_store(&shared->result_head.value, head);
    }
}
