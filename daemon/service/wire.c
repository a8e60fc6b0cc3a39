/* wire.c - the engine's statuses in the wire's terms.
 *
 * Room:     service. See wire.h.
 * Does:     one switch; an unknown value is our bug.
 * Does not: format texts.
 * Threads:  [any].
 */
#include "wire.h"

#include "invariant.h"

int srv_wire_status(int engine_status)
{
    switch ((enum eng_status)engine_status) {
    case ENG_OK:
        return PCCD_OK;
    case ENG_E_NOMEM:
        return PCCD_E_NOMEM;
    case ENG_E_INVAL:
        return PCCD_E_INVAL;
    case ENG_E_LIMIT:
        return PCCD_E_LIMIT;
    case ENG_E_INDEX:
        return PCCD_E_INDEX;
    case ENG_E_NOTFINITE:
        return PCCD_E_NOTFINITE;
    case ENG_E_STATE:
        return PCCD_E_STATE;
    case ENG_E_OVERLAP:
        return PCCD_E_SEGMENT;
    case ENG_E_LONG: /* is nobody's business but the step's */
        break;
    }
    srv_assert_failed("the engine status is in the list", __FILE__, __LINE__);
}
