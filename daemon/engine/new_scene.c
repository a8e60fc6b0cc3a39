/* new_scene.c - a scene is made, and what objects of a mesh share. */
#include "paper.h"
#include "step.h"
#include "step_memory.h"
#include "wide_state.h"

int eng_scene_new(const struct eng_scene_settings *settings, struct eng_scene **scene)
{
    static const struct eng_slot_calls *const owners[ENG_SLOTS] = {
        [ENG_SLOT_PAPER] = &eng_paper_slot,
        [ENG_SLOT_WIDE] = &eng_wide_slot,
        [ENG_SLOT_STEP] = &eng_step_slot};
    return eng_world_new(settings, owners, scene);
}

int eng_mesh_arrange(struct eng_mesh *mesh, uint32_t threads)
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
