/* slot_layout.h - where things lie in the payload of a slot. */
#ifndef CLI_SLOT_LAYOUT_H
#define CLI_SLOT_LAYOUT_H

#include <stdint.h>

#define CLI_PAYLOAD_ALIGN 64u /* of the first range: a cache line */
#define CLI_RANGE_ALIGN   8u  /* of every range: the protocol's */

static inline uint64_t cli_round_up(uint64_t bytes, uint64_t unit)
{
    return (bytes + unit - 1) / unit * unit;
}

#endif
