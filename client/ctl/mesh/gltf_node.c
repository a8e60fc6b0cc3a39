/* client/ctl/mesh/gltf_node.c - the nodes of a glTF file, and where they are.
 *
 * Room:     client/ctl.
 * Does:     trees without recursion; places in doubles.
 * Threads:  one at a time.
 * Source:   gltf_node.h.
 */
#include "gltf_node.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>

#include "pccd_types.h"

#define LAST_ROW_ERROR 1e-5 /* of inverse matrices that were rounded to floats */

/* ---- places ------------------------------------------------------------------------ */

/* Divided by the length at the end, so that rounded quarter turns are exact. */
bool gltf_place_of(const double translation[3], const double rotation[4],
                   const double scale[3], struct gltf_place *place)
{
    double x = rotation[0], y = rotation[1], z = rotation[2], w = rotation[3];
    double n = (x * x + y * y) + (z * z + w * w);
    const double turn[3][3] = {
        {(w * w + x * x) - (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
        {2 * (x * y + w * z), (w * w + y * y) - (x * x + z * z), 2 * (y * z - w * x)},
        {2 * (x * z - w * y), 2 * (y * z + w * x), (w * w + z * z) - (x * x + y * y)},
    };
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) {
            place->m[row][column] = turn[row][column] / n * scale[column];
        }
        place->m[row][3] = translation[row];
    }
    return isfinite(n) && n > 0;
}

bool gltf_place_of_matrix(const double columns[16], struct gltf_place *place)
{
    bool is_affine = fabs(columns[15] - 1) <= LAST_ROW_ERROR;
    for (int column = 0; column < 4; column++) {
        for (int row = 0; row < 3; row++) {
            place->m[row][column] = columns[4 * column + row];
        }
        is_affine &= column == 3 || fabs(columns[4 * column + 3]) <= LAST_ROW_ERROR;
    }
    return is_affine;
}

struct gltf_place gltf_place_product(const struct gltf_place *a,
                                     const struct gltf_place *b)
{
    struct gltf_place product;
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) {
            product.m[row][column] = a->m[row][0] * b->m[0][column] +
                                     a->m[row][1] * b->m[1][column] +
                                     a->m[row][2] * b->m[2][column];
        }
        product.m[row][3] += a->m[row][3];
    }
    return product;
}

void gltf_place_apply(const struct gltf_place *place, double x[3])
{
    const double(*m)[4] = place->m;
    double y[3];
    for (int row = 0; row < 3; row++) {
        y[row] = (m[row][0] * x[0] + m[row][1] * x[1] + m[row][2] * x[2]) + m[row][3];
    }
    x[0] = y[0];
    x[1] = y[1];
    x[2] = y[2];
}

/* ---- nodes ------------------------------------------------------------------------- */

static int read_place(struct gltf *gltf, struct gltf_node *node, size_t index)
{
    static const struct gltf_node still = {.rotation = {0, 0, 0, 1}, .scale = {1, 1, 1}};
    const json_t *json = node->json;
    double columns[16];
    *node = still;
    node->json = json;
    node->parent = node->child = node->sibling = -1;
    node->has_matrix = json_object_get(json, "matrix") != NULL;
    static const char *const names[3] = {"translation", "rotation", "scale"};
    double *const values[3] = {node->translation, node->rotation, node->scale};
    int status = PCCD_OK;
    for (int i = 0; i < 3 && status == PCCD_OK; i++) {
        if (node->has_matrix && json_object_get(json, names[i]) != NULL) {
            return gltf_fail(gltf, PCCD_E_FORMAT, "node %zu: has a matrix, and a %s, too",
                             index, names[i]);
        }
        status =
            gltf_numbers(gltf, json, names[i], i == 1 ? 4 : 3, values[i], "node", index);
    }
    if (status == PCCD_OK && node->has_matrix) {
        status = gltf_numbers(gltf, json, "matrix", 16, columns, "node", index);
        if (status == PCCD_OK && !gltf_place_of_matrix(columns, &node->local)) {
            return gltf_fail(gltf, PCCD_E_FORMAT,
                             "node %zu: the last row of its matrix is not 0 0 0 1",
                             index);
        }
    }
    return status;
}

/* From the last child to the first, so that the list begins with the first. */
static int read_children(struct gltf *gltf, struct gltf_tree *tree, size_t index)
{
    struct gltf_node *node = &tree->nodes[index];
    const json_t *children = json_object_get(node->json, "children");
    for (size_t k = json_array_size(children); k-- > 0;) {
        const json_t *number = json_array_get(children, k);
        json_int_t child = json_is_integer(number) ? json_integer_value(number) : -1;
        if (child < 0 || (uint64_t)child >= tree->count) {
            return gltf_fail(gltf, PCCD_E_INDEX,
                             "node %zu: there is no node %" JSON_INTEGER_FORMAT
                             " for its children",
                             index, child);
        }
        struct gltf_node *below = &tree->nodes[child];
        if (below->parent >= 0) {
            return gltf_fail(gltf, PCCD_E_FORMAT,
                             "node %" JSON_INTEGER_FORMAT
                             ": is a child of node %zu and of node %" PRId64,
                             child, index, below->parent);
        }
        below->parent = (int64_t)index;
        below->sibling = node->child;
        node->child = child;
    }
    return PCCD_OK;
}

/* Add a node without parents and all below it to a list, parents first. */
static void list_from(const struct gltf_tree *tree, size_t root, size_t *list,
                      size_t *count)
{
    int64_t at = (int64_t)root;
    while (at >= 0) {
        const struct gltf_node *node = &tree->nodes[at];
        list[(*count)++] = (size_t)at;
        at = node->child;
        /* Nothing is below it: what is beside it, or beside the next one above. */
        while (at < 0 && node->parent >= 0) {
            at = node->sibling;
            node = &tree->nodes[node->parent];
        }
    }
}

static int read_order(struct gltf *gltf, struct gltf_tree *tree)
{
    size_t count = 0;
    for (size_t i = 0; i < tree->count; i++) {
        if (tree->nodes[i].parent < 0) {
            list_from(tree, i, tree->order, &count);
        }
    }
    for (size_t i = 0; i < count; i++) {
        tree->nodes[tree->order[i]].is_shown = true; /* for a moment: it is in a tree */
    }
    for (size_t i = 0; i < tree->count && count < tree->count; i++) {
        if (!tree->nodes[i].is_shown) {
            return gltf_fail(gltf, PCCD_E_FORMAT, "node %zu: is below itself", i);
        }
    }
    for (size_t i = 0; i < tree->count; i++) {
        tree->nodes[i].is_shown = false;
    }
    return PCCD_OK;
}

/* What the scene shows; without any scene that is all. */
static int read_scene(struct gltf *gltf, struct gltf_tree *tree)
{
    int64_t index = gltf_number(gltf->root, "scene", 0);
    const json_t *scene = gltf_entry(gltf, "scenes", index);
    const json_t *roots = json_object_get(scene, "nodes");
    if (gltf_entry_count(gltf, "scenes") == 0) {
        for (size_t i = 0; i < tree->count; i++) {
            tree->shown[i] = tree->order[i];
            tree->nodes[i].is_shown = true;
        }
        tree->shown_count = tree->count;
        return PCCD_OK;
    }
    if (scene == NULL) {
        return gltf_fail(gltf, PCCD_E_INDEX, "scene %" PRId64 ": there is none", index);
    }
    for (size_t k = 0; k < json_array_size(roots); k++) {
        const json_t *number = json_array_get(roots, k);
        json_int_t node = json_is_integer(number) ? json_integer_value(number) : -1;
        if (node < 0 || (uint64_t)node >= tree->count) {
            return gltf_fail(gltf, PCCD_E_INDEX,
                             "scene %" PRId64 ": there is no node %" JSON_INTEGER_FORMAT,
                             index, node);
        }
        if (tree->nodes[node].parent >= 0 || tree->nodes[node].is_shown) {
            return gltf_fail(
                gltf, PCCD_E_FORMAT,
                "scene %" PRId64 ": node %" JSON_INTEGER_FORMAT " is %s", index, node,
                tree->nodes[node].is_shown ? "there twice" : "a child of another node");
        }
        tree->nodes[node].is_shown = true;
        list_from(tree, (size_t)node, tree->shown, &tree->shown_count);
    }
    return PCCD_OK;
}

int gltf_tree_read(struct gltf *gltf, struct gltf_tree *tree)
{
    size_t count = gltf_entry_count(gltf, "nodes");
    *tree = (struct gltf_tree){
        .nodes = calloc(count + 1, sizeof *tree->nodes),
        .count = count,
        .order = calloc(count + 1, sizeof *tree->order),
        .shown = calloc(count + 1, sizeof *tree->shown),
    };
    if (tree->nodes == NULL || tree->order == NULL || tree->shown == NULL) {
        return gltf_fail(gltf, PCCD_E_NOMEM, "no memory for %zu nodes", count);
    }
    int status = PCCD_OK;
    for (size_t i = 0; i < count && status == PCCD_OK; i++) {
        tree->nodes[i].json = gltf_entry(gltf, "nodes", (int64_t)i);
        status = read_place(gltf, &tree->nodes[i], i);
    }
    for (size_t i = 0; i < count && status == PCCD_OK; i++) {
        status = read_children(gltf, tree, i);
    }
    if (status == PCCD_OK) {
        status = read_order(gltf, tree);
    }
    return status == PCCD_OK ? read_scene(gltf, tree) : status;
}

void gltf_tree_deinit(struct gltf_tree *tree)
{
    for (size_t i = 0; tree->nodes != NULL && i < tree->count; i++) {
        free(tree->nodes[i].weights);
    }
    free(tree->nodes);
    free(tree->order);
    free(tree->shown);
    *tree = (struct gltf_tree){.nodes = NULL};
}

void gltf_tree_mark(struct gltf_tree *tree, size_t node)
{
    for (int64_t at = (int64_t)node; at >= 0 && !tree->nodes[at].moves_mesh;
         at = tree->nodes[at].parent) {
        tree->nodes[at].moves_mesh = true;
    }
}

int gltf_tree_place(struct gltf *gltf, struct gltf_tree *tree)
{
    for (size_t i = 0; i < tree->count; i++) {
        struct gltf_node *node = &tree->nodes[tree->order[i]];
        if (!node->moves_mesh) {
            continue;
        }
        if (!node->has_matrix && !gltf_place_of(node->translation, node->rotation,
                                                node->scale, &node->local)) {
            return gltf_fail(gltf, PCCD_E_FORMAT, "node %zu: its rotation has no length",
                             tree->order[i]);
        }
        node->world =
            node->parent < 0
                ? node->local
                : gltf_place_product(&tree->nodes[node->parent].world, &node->local);
    }
    return PCCD_OK;
}
