/* ids.h - which object of a scene has an id.
 *
 * Threads: changed by [compute] between steps; read by the [team].
 */
#ifndef ENG_IDS_H
#define ENG_IDS_H

#include <stdint.h>

#define ENG_NO_OBJECT UINT32_MAX

struct eng_ids_place {
    uint32_t id;
    uint32_t object; /* index; ENG_NO_OBJECT: a free place */
};

/* Zeroed: there is none. */
struct eng_ids {
    struct eng_ids_place *table; /* [size], a power of two; at least half is free */
    uint32_t size;
};

void eng_ids_deinit(struct eng_ids *ids);
uint64_t eng_ids_bytes(const struct eng_ids *ids);

/* Make room for `count` ids in all. PCCD_OK or PCCD_E_NOMEM. */
int eng_ids_reserve(struct eng_ids *ids, uint32_t count);

/* Add one that is not there; there is room. */
void eng_ids_add(struct eng_ids *ids, uint32_t id, uint32_t object);
/* Remove one that is there. */
void eng_ids_remove(struct eng_ids *ids, uint32_t id);

/* Index of the object with that id; ENG_NO_OBJECT: there is none. */
uint32_t eng_ids_find(const struct eng_ids *ids, uint32_t id);

#endif
