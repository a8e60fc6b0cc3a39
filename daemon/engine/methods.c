/* methods.c - the methods that a step can use; what a scene and a mesh have of them. */
#include "method.h"
#include "paper.h"
#include "step.h"
#include "step_memory.h"
#include "wide_state.h"

const struct eng_method_calls *const eng_methods[PCCD_METHOD_COUNT] = {
    [PCCD_METHOD_PAPER] = &eng_method_paper, [PCCD_METHOD_WIDE] = &eng_method_wide};

int eng_scene_new(const struct eng_scene_settings *settings, struct eng_scene **scene)
{
    static const struct eng_slot_calls *const owners[ENG_SLOTS] = {
        [ENG_SLOT_PAPER] = &eng_paper_slot,
        [ENG_SLOT_WIDE] = &eng_wide_slot,
        [ENG_SLOT_STEP] = &eng_step_slot};
    return eng_world_new(settings, owners, scene);
}

int eng_mesh_sort_features(struct eng_mesh *mesh, uint32_t threads)
{
    if (!mesh->committed || mesh->order) {
        return PCCD_E_STATE;
    }
    struct eng_wide_order *order;
    int status = eng_wide_order_new(mesh, (const double(*)[3])mesh->x, threads, &order);
    if (status == PCCD_OK) {
        mesh->order = order;
        mesh->order_bytes = order->bytes;
    }
    return status;
}
