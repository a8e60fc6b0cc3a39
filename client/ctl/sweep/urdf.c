/* urdf.c - reads a mechanism from URDF and SRDF.
 *
 * Whatever would change what is proved is read or refused, with the line and the name of
 * the link or joint. What does not concern shapes and joints (visual, inertial,
 * transmission, gazebo ..) is left out.
 *
 * Source: wiki.ros.org/urdf/XML; urdfdom_headers; wiki.ros.org/srdf.
 */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "robot.h"
#include "shown.h"
#include "xml.h"

#define NAME_BYTES 300u

struct reader {
    struct xml *xml;
    struct robot *robot;
};

/* Return an attribute that must be there; "" where it is not. */
static const char *needed(struct reader *reader, const struct xml_element *of,
                          const char *name, const char *whose)
{
    const char *text = xml_text(of, name);
    if (text == NULL) {
        xml_refuse(reader->xml, of, "%s: <%s> has no %s", whose, of->name, name);
    }
    return text != NULL ? text : "";
}

static void name_of(char *to, const char *what, const char *name)
{
    snprintf(to, NAME_BYTES, "%s \"%.200s\"", what, tool_shown(name));
}

/* Return the only element of that name below another one; NULL: there is none. */
static const struct xml_element *only(struct reader *reader, const struct xml_element *of,
                                      const char *name, const char *whose)
{
    const struct xml_element *first = xml_find(of->child, name);
    const struct xml_element *second = first != NULL ? xml_find(first->next, name) : NULL;
    if (second != NULL) {
        xml_refuse(reader->xml, second, "%s: a second <%s>", whose, name);
    }
    return first;
}

/* Take <origin>. */
static void take_origin(struct reader *reader, const struct xml_element *of,
                        struct robot_place *to, const char *whose)
{
    const struct xml_element *origin = only(reader, of, "origin", whose);
    double rpy[3] = {0, 0, 0};
    if (origin == NULL) {
        return;
    }
    (void)xml_numbers(reader->xml, origin, "xyz", 3, to->position, whose);
    (void)xml_numbers(reader->xml, origin, "rpy", 3, rpy, whose);
    robot_turn(to, rpy);
}

/* ---- links ------------------------------------------------------------------------- */

static const struct {
    const char *name;
    enum robot_form form;
    const char *numbers[2]; /* the attributes of its size */
    uint32_t count;         /* of the first one */
} forms[] = {{"mesh", ROBOT_MESH, {"scale", NULL}, 3},
             {"box", ROBOT_BOX, {"size", NULL}, 3},
             {"cylinder", ROBOT_CYLINDER, {"radius", "length"}, 1},
             {"sphere", ROBOT_SPHERE, {"radius", NULL}, 1},
             {"capsule", ROBOT_CAPSULE, {"radius", "length"}, 1}};

static void take_geometry(struct reader *reader, const struct xml_element *of,
                          struct robot_shape *to, const char *whose)
{
    uint32_t form = 0, forms_count = sizeof forms / sizeof forms[0];
    while (form < forms_count && strcmp(forms[form].name, of->name) != 0) {
        form++;
    }
    if (form == forms_count) {
        xml_refuse(reader->xml, of, "%s: <%s> is no shape that is known", whose,
                   tool_shown(of->name));
        return;
    }
    to->form = forms[form].form;
    if (to->form == ROBOT_MESH) {
        to->path = needed(reader, of, "filename", whose);
        if (to->path[0] == '\0' && reader->xml->status == PCCD_OK) {
            xml_refuse(reader->xml, of, "%s: filename=\"\" of <mesh> names no file",
                       whose);
        }
    }
    for (uint32_t k = 0; k < 2 && forms[form].numbers[k] != NULL; k++) {
        const char *name = forms[form].numbers[k];
        uint32_t count = forms[form].count;
        if (to->form != ROBOT_MESH) {
            (void)needed(reader, of, name, whose);
        }
        (void)xml_numbers(reader->xml, of, name, count, &to->size[k], whose);
        for (uint32_t c = k; c < k + count; c++) {
            bool is_there = to->form == ROBOT_MESH ? to->size[c] != 0 : to->size[c] > 0;
            if (!is_there || fabs(to->size[c]) > 1e18) {
                xml_refuse(reader->xml, of, "%s: %s=\"%s\" of <%s> %s", whose, name,
                           tool_shown(xml_text(of, name)), of->name,
                           is_there ? "is larger than 1e18" : "leaves nothing of it");
            }
        }
    }
}

static void take_collision(struct reader *reader, const struct xml_element *of,
                           uint32_t part, const char *whose)
{
    const struct xml_element *geometry = only(reader, of, "geometry", whose);
    if (geometry == NULL || geometry->child == NULL) {
        xml_refuse(reader->xml, of, "%s: a <collision> without geometry", whose);
        return;
    }
    if (geometry->child->next != NULL) {
        xml_refuse(reader->xml, geometry->child->next,
                   "%s: a <geometry> of more than one shape", whose);
        return;
    }
    struct robot_shape *shape = &reader->robot->shapes[reader->robot->shape_count++];
    shape->part = part;
    shape->line = of->line;
    take_origin(reader, of, &shape->place, whose);
    take_geometry(reader, geometry->child, shape, whose);
}

static void take_link(struct reader *reader, const struct xml_element *of)
{
    char whose[NAME_BYTES];
    const char *name = needed(reader, of, "name", "a link");
    name_of(whose, "link", name);
    uint32_t other = robot_find_part(reader->robot, name);
    if (other != ROBOT_NONE) {
        xml_refuse(reader->xml, of, "%s: line %" PRIu32 " has another one of this name",
                   whose, reader->robot->parts[other].line);
    }
    uint32_t part = reader->robot->part_count++;
    reader->robot->parts[part].name = name;
    reader->robot->parts[part].line = of->line;
    reader->robot->parts[part].is_visual_alone =
        xml_find(of->child, "visual") != NULL && xml_find(of->child, "collision") == NULL;
    for (const struct xml_element *at = xml_find(of->child, "collision");
         at != NULL && reader->xml->status == PCCD_OK;
         at = xml_find(at->next, "collision")) {
        take_collision(reader, at, part, whose);
    }
}

/* ---- joints ------------------------------------------------------------------------ */

static const struct {
    const char *name;
    enum pccd_joint_kind kind;
    bool has_limit, is_held;
} types[] = {{"fixed", PCCD_JOINT_FIXED, false, false},
             {"revolute", PCCD_JOINT_TURN, true, false},
             {"continuous", PCCD_JOINT_TURN, false, false},
             {"prismatic", PCCD_JOINT_SLIDE, true, false},
             {"floating", PCCD_JOINT_FIXED, false, true},
             {"planar", PCCD_JOINT_FIXED, false, true}};

static void take_type(struct reader *reader, const struct xml_element *of,
                      struct robot_joint *to, const char *whose)
{
    const char *type = needed(reader, of, "type", whose);
    const struct xml_element *limit = only(reader, of, "limit", whose);
    uint32_t k = 0, count = sizeof types / sizeof types[0];
    while (k < count && strcmp(types[k].name, type) != 0) {
        k++;
    }
    if (k == count) {
        xml_refuse(reader->xml, of, "%s: no joint is of the type \"%s\"", whose,
                   tool_shown(type));
        return;
    }
    to->kind = types[k].kind;
    to->held = types[k].is_held ? types[k].name : NULL;
    to->is_endless = strcmp(type, "continuous") == 0;
    if (types[k].has_limit && limit == NULL) {
        xml_refuse(reader->xml, of, "%s: %s, and no <limit>", whose, type);
    } else if (types[k].has_limit) { /* without lower or upper: 0, as URDF says */
        (void)xml_numbers(reader->xml, limit, "lower", 1, &to->range[0], whose);
        (void)xml_numbers(reader->xml, limit, "upper", 1, &to->range[1], whose);
    } else if (to->is_endless) {
        to->range[0] = -ROBOT_PI;
        to->range[1] = ROBOT_PI;
    }
}

/* Return the link of <parent> or <child>. */
static uint32_t take_end(struct reader *reader, const struct xml_element *of,
                         const char *end, const char *whose)
{
    const struct xml_element *at = only(reader, of, end, whose);
    if (at == NULL) {
        xml_refuse(reader->xml, of, "%s: it has no <%s>", whose, end);
        return 0;
    }
    const char *name = needed(reader, at, "link", whose);
    uint32_t part = robot_find_part(reader->robot, name);
    if (part == ROBOT_NONE) {
        xml_refuse(reader->xml, at, "%s: its %s is a link \"%s\", and there is none",
                   whose, end, tool_shown(name));
        return 0;
    }
    return part;
}

static void take_joint(struct reader *reader, const struct xml_element *of)
{
    char whose[NAME_BYTES];
    struct robot *robot = reader->robot;
    const char *name = needed(reader, of, "name", "a joint");
    uint32_t other = robot_find_joint(robot, name), index = robot->joint_count;
    name_of(whose, "joint", name);
    if (other != ROBOT_NONE) {
        xml_refuse(reader->xml, of, "%s: line %" PRIu32 " has another one of this name",
                   whose, robot->joints[other].line);
    }
    uint32_t parent = take_end(reader, of, "parent", whose);
    uint32_t child = take_end(reader, of, "child", whose);
    if (reader->xml->status != PCCD_OK) {
        return;
    }
    struct robot_part *part = &robot->parts[child];
    if (part->joint != ROBOT_NONE) {
        xml_refuse(reader->xml, of,
                   "%s: its link \"%s\" hangs on joint \"%s\", too: loops are not swept",
                   whose, tool_shown(part->name),
                   tool_shown(robot->joints[part->joint].name));
        return;
    }
    struct robot_joint *joint = &robot->joints[robot->joint_count++];
    joint->name = name;
    joint->line = of->line;
    joint->parent = parent; /* the part; its joint in the end */
    part->joint = index;
    take_origin(reader, of, &joint->place, whose);
    take_type(reader, of, joint, whose);
    const struct xml_element *axis = only(reader, of, "axis", whose);
    const struct xml_element *mimic = only(reader, of, "mimic", whose);
    if (axis != NULL) {
        (void)needed(reader, axis, "xyz", whose);
        (void)xml_numbers(reader->xml, axis, "xyz", 3, joint->axis, whose);
    }
    if (mimic != NULL) {
        joint->leader_name = needed(reader, mimic, "joint", whose);
        (void)xml_numbers(reader->xml, mimic, "multiplier", 1, &joint->said[0], whose);
        (void)xml_numbers(reader->xml, mimic, "offset", 1, &joint->said[1], whose);
    }
}

/* ---- the files --------------------------------------------------------------------- */

static void take_robot(struct reader *reader, const struct option_arguments *with)
{
    struct robot *robot = reader->robot;
    const struct xml_element *root = reader->xml->root, *at;
    uint32_t counts[3] = {0, 0, 0}, standing = 0; /* joints, links, collisions */
    if (strcmp(root->name, "robot") != 0) {
        xml_refuse(reader->xml, root, "URDF begins with <robot>, not <%s>",
                   tool_shown(root->name));
        return;
    }
    for (at = root->child; at != NULL; at = at->next) {
        counts[0] += strcmp(at->name, "joint") == 0;
        counts[1] += strcmp(at->name, "link") == 0;
        for (const struct xml_element *in = at->child; in != NULL; in = in->next) {
            counts[2] += strcmp(in->name, "collision") == 0;
        }
        if (strncmp(at->name, "xacro:", 6) == 0) {
            xml_refuse(reader->xml, at, "<%s>: have xacro make URDF of it first",
                       tool_shown(at->name));
        }
    }
    if (reader->xml->status == PCCD_OK) {
        reader->xml->status = robot_alloc(robot, counts[0], counts[1] + with->count,
                                          counts[2] + with->count, reader->xml->error);
    }
    for (at = root->child; at != NULL && reader->xml->status == PCCD_OK; at = at->next) {
        if (strcmp(at->name, "link") == 0) {
            take_link(reader, at);
        }
    }
    for (at = root->child; at != NULL && reader->xml->status == PCCD_OK; at = at->next) {
        if (strcmp(at->name, "joint") == 0) {
            take_joint(reader, at);
        }
    }
    for (uint32_t i = 0; i < robot->joint_count && reader->xml->status == PCCD_OK; i++) {
        robot->joints[i].parent = robot->parts[robot->joints[i].parent].joint;
    }
    for (uint32_t i = 0; i < robot->part_count && reader->xml->status == PCCD_OK; i++) {
        standing += robot->parts[i].joint == ROBOT_NONE;
        if (standing == 2 && robot->parts[i].joint == ROBOT_NONE) {
            xml_refuse(reader->xml, root, "no joint joins link \"%s\" to the others",
                       tool_shown(robot->parts[i].name));
        }
    }
    for (size_t i = 0; i < with->count && reader->xml->status == PCCD_OK; i++) {
        struct robot_shape *shape = &robot->shapes[robot->shape_count++];
        shape->part = robot->part_count++;
        shape->path = robot->parts[shape->part].name = with->list[i];
        shape->is_given = true;
    }
}

static void take_state(struct reader *reader, const struct xml_element *of)
{
    struct robot *robot = reader->robot;
    for (const struct xml_element *at = xml_find(of->child, "joint");
         at != NULL && reader->xml->status == PCCD_OK; at = xml_find(at->next, "joint")) {
        const char *name = needed(reader, at, "name", "a group_state");
        uint32_t joint = robot_find_joint(robot, name);
        double value = 0;
        (void)needed(reader, at, "value", "a group_state");
        (void)xml_numbers(reader->xml, at, "value", 1, &value, "a group_state");
        if (joint == ROBOT_NONE) {
            xml_refuse(reader->xml, at, "the URDF has no joint \"%s\"", tool_shown(name));
        } else if (robot_is_free(robot, joint)) {
            robot->start[joint] = value;
        }
    }
}

/* Remember that there is a state of this name. */
static void note_state(struct robot *robot, const char *name)
{
    char *states = NULL;
    if (asprintf(&states, "%s%s%s", robot->states != NULL ? robot->states : "",
                 robot->states != NULL ? ", " : "", name) >= 0) {
        free(robot->states);
        robot->states = states;
    }
}

static void take_pairs(struct reader *reader, const char *state)
{
    static const char *const ends[] = {"link1", "link2"};
    struct robot *robot = reader->robot;
    const struct xml_element *root = reader->xml->root;
    const char *name = xml_text(root, "name"), *own = xml_text(robot->xml.root, "name");
    bool has_state = state == NULL;
    if (strcmp(root->name, "robot") != 0 || xml_find(root->child, "link") != NULL) {
        xml_refuse(reader->xml, root, "no SRDF: %s",
                   strcmp(root->name, "robot") != 0 ? "it does not begin with <robot>"
                                                    : "it has links, as URDF has");
    } else if (name != NULL && own != NULL && strcmp(name, own) != 0) {
        xml_refuse(reader->xml, root,
                   "it is of the robot \"%s\", and the URDF of another",
                   tool_shown(name));
    }
    for (const struct xml_element *at = root->child;
         at != NULL && reader->xml->status == PCCD_OK; at = at->next) {
        uint32_t parts[2] = {0, 0};
        name = xml_text(at, "name");
        if (strcmp(at->name, "group_state") == 0 && state != NULL && name != NULL &&
            strcmp(name, state) == 0) {
            take_state(reader, at);
            has_state = true;
        } else if (strcmp(at->name, "group_state") == 0 && state == NULL &&
                   name != NULL) {
            note_state(robot, name);
        } else if (strcmp(at->name, "disable_default_collisions") == 0 ||
                   strcmp(at->name, "enable_collisions") == 0) {
            xml_refuse(reader->xml, at, "<%s> is not understood; name each pair",
                       at->name);
        } else if (strcmp(at->name, "disable_collisions") == 0) {
            for (int k = 0; k < 2; k++) {
                const char *link = needed(reader, at, ends[k], "a pair");
                parts[k] = robot_find_part(robot, link);
                if (parts[k] == ROBOT_NONE) {
                    xml_refuse(reader->xml, at, "the URDF has no link \"%s\"",
                               tool_shown(link));
                }
            }
            if (reader->xml->status == PCCD_OK) {
                reader->xml->status = robot_set_pair(robot, parts[0], parts[1],
                                                     ROBOT_APART, reader->xml->error);
            }
        }
    }
    if (!has_state) {
        xml_refuse(reader->xml, root, "there is no group_state \"%s\"",
                   tool_shown(state));
    }
}

int robot_read_urdf(struct robot *robot, const char *path,
                    const struct robot_options *options, struct ctl_error *error)
{
    struct reader reader = {.robot = robot, .xml = &robot->xml};
    struct xml srdf = {.root = NULL};
    robot->path = path;
    if (xml_open(&robot->xml, path, error) == PCCD_OK) {
        take_robot(&reader, &options->with);
    }
    int status = robot->xml.status;
    if (status == PCCD_OK) {
        status = robot_finish(robot, error);
    }
    if (status == PCCD_OK && options->srdf != NULL) {
        reader.xml = &srdf;
        if (xml_open(&srdf, options->srdf, error) == PCCD_OK) {
            take_pairs(&reader, options->state);
        }
        status = srdf.status;
        xml_close(&srdf);
    }
    if (status == PCCD_OK) {
        robot_follow(robot, robot->start);
        status = robot_make_shapes(robot, options, error);
    }
    return status;
}
