/* check.cc - what pccd.hpp promises, against a real daemon and in this process (TAP). */
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <pccd.hpp>

#if __cplusplus >= 202002L
#include <span>
#endif

namespace
{

struct vec3 {
    double x, y, z;
};

int count = 0, failed = 0;

void tell(bool is_right, const char *name)
{
    count++;
    failed += !is_right;
    std::printf("%sok %d - %s\n", is_right ? "" : "not ", count, name);
}

const std::vector<vec3> two = {{0, 0, 0},     {1, 0, 0},     {0, 1, 0},
                               {.25, .25, 1}, {.75, .25, 4}, {.25, .75, 4}};
const std::uint32_t faces[2][3] = {{0, 1, 2}, {3, 4, 5}};

std::vector<vec3> moved(double by)
{
    std::vector<vec3> x = two;
    for (std::size_t i = 3; i < x.size(); i++) {
        x[i].z += by;
    }
    return x;
}

// If one failed, a program would not know where on its mesh something is.
void check_points()
{
    pccd_body body{};
    const pccd_edge edges[] = {{0, 1}, {0, 2}, {1, 2}};
    body.object = 7;
    body.first = 100;
    body.vertex_count = 6;
    body.triangle_count = 2;
    body.triangles = faces[0];
    body.edges = edges;
    body.edge_count = 3;
    body.x0 = &two[0].x;
    pccd_contact contact{};
    contact.kind = PCCD_VF;
    contact.object_a = contact.object_b = 7;
    contact.feature_a = 3;
    const pccd::view<const pccd_body> bodies(&body, 1);
    const pccd::view<const pccd_contact> contacts(&contact, 1);
    const pccd::stencils stencils = pccd::stencils_of(bodies, contacts);
    const auto manifolds = pccd::manifolds_of(bodies, contacts);
    tell(stencils.vertices.size() == 1 && stencils.vertices[0][0] == 103 &&
             stencils.weights[0][1] == -1 && manifolds.size() == 1 &&
             manifolds[0].count == 1 && manifolds[0].points[0].point[2] == .5 &&
             pccd::try_stencils({}, contacts).status() == PCCD_E_HANDLE,
         "records__have_places");
}

// If one failed, a program would be told another thing than by pccd.h.
void check_step(pccd::client &client)
{
    pccd::scene scene = client.make_scene();
    pccd::mesh mesh = client.make_mesh({two, faces});
    pccd::object object = scene.add(mesh);
    tell(mesh.info().triangle_count == 2 && mesh.edges().size() == 6 &&
             object.vertex_count() == 6,
         "mesh__tells_what_it_has");
    const std::vector<vec3> down = moved(-2);
    const pccd::answer answer = scene.step(pccd::to(object, down));
    tell(answer.is_complete() && answer.contacts().size() == 1 &&
             answer.contacts()[0].kind == PCCD_VF && answer->toi_first <= .5 &&
             answer->toi_first > .499 && answer.pairs().empty() && answer.near().empty(),
         "step__finds_the_contact");
    std::uint32_t kinds = 0;
    for (const pccd_contact &contact : answer.contacts()) {
        kinds |= 1u << contact.kind;
    }
    tell(kinds == 1, "contacts__are_a_range");

    pccd_answer plain{};
    const int status = pccd_step_x0x1(client.get(), scene.id(), object.id(), two.data(),
                                      down.data(), PCCD_FORMAT_F64, 6, nullptr, &plain);
    tell(status == PCCD_OK && std::memcmp(plain.hash, answer->hash, 16) == 0,
         "step__has_the_hash_of_that_in_c");
    pccd_answer_release(client.get(), &plain);

    pccd::step_settings candidates;
    candidates.mode = PCCD_MODE_PAIRS;
    pccd::answer page = scene.step(pccd::between(object, two, down), candidates);
    const std::uint64_t last = page->total - 1;
    const std::uint32_t feature = page.pairs()[last].feature_b;
    page = scene.fetch(page, last);
    tell(last > 0 && page->first == last && page.pairs().size() == 1 &&
             page.pairs()[0].feature_b == feature && !page.has_more(),
         "fetch__begins_at_any_record");

    pccd::near_settings near(PCCD_NEAR_NEAREST, std::numeric_limits<double>::infinity());
    near.what = PCCD_NEAR_PAIRS;
    near.distance = 1.25;
    const pccd_motion back = pccd::to(object, two);
    const pccd::answer pairs = scene.near(near, {&back, 1});
    tell(pairs.contacts().empty() && !pairs.near().empty() &&
             std::fabs(pairs->distance_min - 1) < 1e-9,
         "near__measures_after_a_motion");

    object.set_radius(.5);
    pccd::step_settings settings;
    settings.separation = .125;
    const pccd::answer thick = scene.step(pccd::to(object, two), settings);
    tell(thick->initial > 0 && thick->safe_step == 0, "radius__is_of_the_next_step");

    object.set_user_data(~std::uint64_t{6});
    object.set_name("sleeve");
    settings.mode = PCCD_MODE_FIRST_PER_PAIR;
    const pccd::answer firsts = scene.step(pccd::to(object, down), settings);
    tell(firsts->total == 1 && scene.user_data(0) == 0 &&
             scene.user_data(object.id()) == ~std::uint64_t{6},
         "user_data__is_of_the_object");

    const pccd::object other = scene.add(mesh);
    scene.ignore(object, other);
    settings.separation = 0;
    const auto met = scene.step(pccd::to(object, two), settings)->total;
    scene.keep_clearance(object, other, 100);
    tell(scene.step(pccd::to(object, two), settings)->total == met + 1 &&
             scene.try_keep_clearance(object, other, -1).status() == PCCD_E_INVAL,
         "clearance__is_of_two_objects");
}

// If one failed, surfaces that pass through each other from the start would be taken for
// free.
void check_crossed(pccd::client &client)
{
    const std::vector<vec3> spiked = {{-30, -30, 0}, {30, -30, 0}, {0, 30, 0},
                                      {0, 0, -2},    {1, 0, 6},    {0, 1, 6}};
    pccd::scene scene = client.make_scene();
    pccd::mesh mesh = client.make_mesh({spiked, faces});
    pccd::object object = scene.add(mesh);
    pccd::step_settings settings;
    settings.mode = PCCD_MODE_ANY;
    const pccd::answer plain = scene.step(pccd::to(object, spiked), settings);
    settings.tells_start = true;
    const pccd::answer told = scene.step(pccd::to(object, spiked), settings);
    tell(plain->verdict == PCCD_VERDICT_NO && told->verdict == PCCD_VERDICT_YES &&
             told->crossings == 2 && told->start_inside == 0 && told->safe_step == 0,
         "step__tells_that_it_begins_crossed");
    pccd::near_settings near(PCCD_NEAR_PAIRS, 1);
    near.tells_crossings = true;
    tell(scene.near(near)->crossings == 2, "near__tells_what_crosses");
}

// If one failed, many small worlds would be told another thing than each by itself.
void check_batch(pccd::client &client)
{
    pccd::mesh mesh = client.make_mesh({two, faces});
    std::vector<pccd::scene> scenes;
    std::vector<pccd::object> objects;
    std::vector<pccd_batch_part> parts;
    std::vector<std::vector<vec3>> ends;
    std::vector<const void *> x1, x0(5, two.data());
    for (int i = 0; i < 5; i++) {
        scenes.push_back(client.make_scene());
        objects.push_back(scenes.back().add(mesh));
        parts.push_back(i == 4 ? pccd::still(scenes.back())
                               : pccd::part_of(scenes.back(), objects.back(),
                                               PCCD_FORMAT_F64,
                                               i == 3 ? PCCD_BATCH_X0X1 : PCCD_BATCH_X1));
        ends.push_back(moved(i % 2 == 0 ? -2 : -.5));
    }
    ends[3][5].x = std::numeric_limits<double>::infinity();
    for (const std::vector<vec3> &end : ends) {
        x1.push_back(end.data());
    }
    pccd::batch batch = client.make_batch(parts);
    pccd::batch other = std::move(batch);
    for (int i = 0; i < 200; i++) { // many more than answers that may wait
        other.step(x0, x0);
    }
    const pccd::batch_answer found = other.step(x1, x0);
    bool is_right = other.scene_count() == 5 && found->count == 5 && found->failed == 1 &&
                    found.scenes()[3].status == PCCD_E_NOTFINITE;
    const std::size_t contacts[5] = {1, 0, 1, 0, 0};
    for (std::size_t i = 0; i < 5; i++) {
        is_right &= found.contacts(i).size() == contacts[i] && found.pairs(i).empty();
    }
    const pccd::answer single = scenes[0].step(pccd::between(objects[0], two, ends[0]));
    tell(is_right && std::memcmp(found.scenes()[0].hash, single->hash, 16) == 0,
         "batch__answers_each_scene_as_by_itself");

    pccd::step_settings settings;
    settings.mode = PCCD_MODE_PAIRS;
    const std::uint64_t step = other.submit(x1, x0, settings);
    const pccd::batch_answer pairs = client.wait_batch(step);
    tell(pairs->step == step && pairs.pairs(0).size() == pairs.scenes()[0].count &&
             pairs.contacts(0).empty() && !pairs.pairs(0).empty() &&
             client.try_poll_batch().status() == PCCD_E_AGAIN,
         "batch__is_waited_for");
    x1.pop_back();
    tell(other.try_step(x1, x0).status() == PCCD_E_INVAL &&
             client.try_make_batch({}).status() == PCCD_E_INVAL,
         "batch__that_is_not_whole_is_told");
}

// Like a matrix of Eigen: as many rows and columns as are known, -1: not; by rows or not.
template <class T, int Rows, int Cols, int ByRows> struct matrix {
    using Scalar = T;
    enum {
        IsRowMajor = ByRows,
        RowsAtCompileTime = Rows,
        ColsAtCompileTime = Cols,
        IsVectorAtCompileTime = Rows == 1 || Cols == 1
    };
    matrix(const T *x, int n_rows, int n_cols, int n_gap = 0)
        : x_(x), rows_(n_rows), cols_(n_cols), gap_(n_gap)
    {
    }
    const T *data() const { return x_; }
    long size() const { return long(rows_) * cols_; }
    long rows() const { return rows_; }
    long cols() const { return cols_; }
    long innerStride() const { return IsVectorAtCompileTime ? 1 + gap_ : 1; }
    long outerStride() const { return (ByRows ? cols_ : rows_) + gap_; }
    const T *x_;
    int rows_, cols_, gap_;
};
// Like Eigen's vector of three, which copies itself.
struct vector3 {
    using Scalar = double;
    enum { IsRowMajor = 0, RowsAtCompileTime = 3, ColsAtCompileTime = 1 };
    vector3(double x, double y, double z) : v{x, y, z} {}
    vector3(const vector3 &o) : v{o.v[0], o.v[1], o.v[2]} {}
    double v[3];
};
static_assert(!std::is_trivially_copyable_v<vector3>, "as Eigen's");
static_assert(!pccd::detail::may_hold_groups<matrix<double, -1, -1, 0>, 3>() &&
                  !pccd::detail::may_hold_groups<matrix<double, -1, 3, 0>, 3>() &&
                  !pccd::detail::may_hold_groups<matrix<int, -1, 2, 0>, 2>(),
              "what has the x of all vertices together is refused");
static_assert(!pccd::detail::is_group_of<matrix<int, 3, 1, 0>, float, 3>(),
              "integers are no positions");
// A vertex with its normal, which has the size of three doubles, and others of that kind.
struct two_floats3 {
    float x[3], normal[3];
};
struct ints3 {
    int x, y, z;
};
struct coloured {
    float x, y;
    std::uint32_t colour;
};
struct named3 {
    double x, y, z;
};
class hidden3 {
public:
    hidden3() : v_{} {}
    float operator[](int i) const { return v_[i]; }

private:
    float v_[3];
};
template <class Element, class Number> constexpr bool is_triple()
{
    return pccd::detail::is_group_of<Element, Number, 3>();
}
static_assert(!is_triple<two_floats3, double>() && !is_triple<ints3, float>() &&
                  !is_triple<coloured, float>() && !is_triple<hidden3, int>() &&
                  !is_triple<std::array<int, 3>, float>() &&
                  !is_triple<std::array<float, 6>, double>() &&
                  !is_triple<std::array<float, 3>, std::uint32_t>(),
              "what has the size alone of three numbers is refused");
static_assert(is_triple<named3, double>() && is_triple<hidden3, float>() &&
                  is_triple<float[3], float>() && is_triple<ints3, std::uint32_t>() &&
                  is_triple<std::array<float, 3>, float>() &&
                  pccd::detail::is_group_of<pccd_edge, std::uint32_t, 2>() &&
                  pccd::detail::is_group_of<std::array<int, 1>, std::uint32_t, 1>(),
              "three numbers are taken");

// If one failed, the coordinates of a matrix would be mixed up without a word, and
// contacts missed; or it would have to be copied first.
void check_matrices(pccd::client &client)
{
    const double x[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, .25, .25, 1, .5, .25, 4, .25, .5, 4};
    double x1[18];
    std::memcpy(x1, x, sizeof x);
    x1[11] -= 2;
    x1[14] -= 2;
    x1[17] -= 2;
    const int face[6] = {0, 1, 2, 3, 4, 5};
    const matrix<int, -1, 3, 1> by_rows(face, 2, 3);
    auto meets = [&](auto begin, auto end, auto triangles) {
        pccd::scene scene = client.make_scene();
        pccd::mesh mesh = client.make_mesh({begin, triangles});
        pccd::object body = scene.add(mesh);
        return scene.step(pccd::to(body, end)).contacts().size() == 1;
    };
    tell(meets(matrix<double, -1, 3, 1>(x, 6, 3), matrix<double, -1, -1, 1>(x1, 6, 3),
               by_rows) &&
             meets(matrix<double, 3, -1, 0>(x, 3, 6), matrix<double, -1, 1, 0>(x1, 18, 1),
                   matrix<int, 3, -1, 0>(face, 3, 2)),
         "positions__may_be_a_matrix");
    const std::vector<vector3> triples = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    tell(client.make_mesh({triples, std::vector<int>{0, 1, 2}}).info().vertex_count == 3,
         "positions__may_be_vectors_of_eigen");
    tell(!client.try_make_mesh({matrix<double, -1, -1, 1>(x, 3, 6), by_rows}) &&
             !client.try_make_mesh({matrix<double, -1, 3, 1>(x, 4, 3, 1), by_rows}) &&
             !client.try_make_mesh({matrix<double, -1, 1, 0>(x, 9, 1, 1), by_rows}),
         "positions__with_gaps_or_in_the_columns_are_told");
}

// If one failed, positions would have to be copied into another container first.
void check_positions(pccd::client &client)
{
    const float flat[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const double rows[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::array<std::array<float, 3>, 3> triples = {
        {{{0, 0, 0}}, {{1, 0, 0}}, {{0, 1, 0}}}};
    const std::vector<double> numbers(&rows[0][0], &rows[0][0] + 9);
    const std::vector<std::uint32_t> face = {0, 1, 2};
    const std::vector<int> signed_face = {0, 1, 2};
    tell(client.make_mesh({flat, face}).info().vertex_count == 3 &&
             client.make_mesh({rows, face}).info().triangle_count == 1 &&
             client.make_mesh({triples, signed_face}).info().triangle_count == 1 &&
             client.make_mesh({numbers, face}).info().vertex_count == 3,
         "positions__may_be_any_range");
    pccd::shape rods;
    rods.x = pccd::positions(rows);
    const std::uint32_t edges[2][2] = {{0, 1}, {1, 2}};
    rods.edges = edges;
    tell(client.make_mesh(rods).info().free_edge_count == 2, "shape__may_be_rods");
    const std::vector<float> seven(7);
    const pccd::result<pccd::mesh> none = client.try_make_mesh({seven, face});
    tell(!none && none.status() == PCCD_E_INVAL,
         "positions__that_are_no_triples_are_told");
#if __cplusplus >= 202002L
    const std::span<const float> span(flat);
    tell(client.make_mesh({span, face}).info().vertex_count == 3,
         "positions__may_be_a_span");
    const pccd::view<const float> view(flat);
    tell(std::span<const float>(view).size() == 9, "view__becomes_a_span");
#endif
}

// If one failed, memory of the daemon would leak, or be freed under somebody.
void check_ownership(pccd::client &client)
{
    auto scene_count = [&client] {
        int scenes = 0;
        pccd_list_scenes(
            client.get(), 0,
            [](void *context, const pccd_scene_info *) {
                ++*static_cast<int *>(context);
            },
            &scenes);
        return scenes;
    };
    const int before = scene_count();
    {
        pccd::scene one = client.make_scene();
        pccd::scene other = client.make_scene();
        tell(scene_count() == before + 2, "scene__is_there");
        one = std::move(other);
        tell(scene_count() == before + 1 && one.id() != 0 && other.id() == 0,
             "scene__that_is_replaced_goes");
    }
    tell(scene_count() == before, "scene__goes_with_its_handle");

    pccd::scene scene = client.make_scene();
    pccd::mesh mesh = client.make_mesh({two, faces});
    pccd::object object = scene.add(mesh);
    for (int i = 0; i < 200; i++) { // many more than answers that may wait
        pccd::answer answer = scene.step(pccd::to(object, moved(i % 2 == 0 ? -2 : 0)));
    }
    const std::uint64_t step = scene.submit({}, pccd::step_settings());
    const pccd::answer last = client.wait(step);
    tell(last->step == step && last.is_complete(), "answer__is_given_back");
    tell(client.try_poll().status() == PCCD_E_AGAIN, "poll__has_nothing_left");
}

// If it failed, an object that outlives its client's name would use freed memory.
void check_order()
{
    std::vector<pccd::object> kept;
    {
        pccd::client client("direct:");
        pccd::scene scene = client.make_scene();
        kept.push_back(scene.add(client.make_mesh({two, faces})));
    }
    tell(kept[0].id() != 0, "connection__stays_while_something_needs_it");
}

// If one failed, somebody would look for the reason elsewhere.
void check_errors(pccd::client &client)
{
    pccd::scene scene = client.make_scene();
    std::vector<vec3> bad = two;
    bad[4].y = std::numeric_limits<double>::quiet_NaN();
    const pccd::result<pccd::mesh> mesh = client.try_make_mesh({bad, faces});
    tell(!mesh && mesh.status() == PCCD_E_NOTFINITE &&
             std::strstr(mesh.why().what(), "E_NOTFINITE: ") != nullptr &&
             std::strlen(mesh.why().what()) > 20,
         "error__says_what_was_wrong");
    pccd::mesh good = client.make_mesh({two, faces});
    pccd::object object = scene.add(good);
    const pccd_motion motion =
        pccd::between(object, two, pccd::positions(two.data() ? &two[0].x : nullptr, 3));
    tell(scene.try_step({&motion, 1}).status() == PCCD_E_INVAL,
         "motion__of_unequal_ends_is_told");
#if defined(__cpp_exceptions)
    int status = 0;
    try {
        pccd::result<pccd::answer> none = scene.try_step({&motion, 1});
        tell((*none)->count != 0, "result__without_a_value_has_none");
    } catch (const pccd::error &error) {
        tell(error.status() == PCCD_E_INVAL, "result__without_a_value_has_none");
    }
    try {
        scene.step(pccd::to(object, bad));
    } catch (const pccd::error &error) {
        status = error.status();
    }
    tell(status == PCCD_E_NOTFINITE, "error__is_thrown");
    tell(scene.try_step({}).status() == PCCD_OK, "scene__goes_on_after_an_error");
    try {
        pccd::client nobody("unix:/nonexistent/pccd.sock");
        status = 0;
    } catch (const pccd::error &error) {
        status = error.status();
    }
    tell(status != 0, "client__that_finds_no_daemon_throws");
#endif
}

// If one failed, a motion of other vertices than were meant would be made in silence.
void check_motions(pccd::client &client)
{
    pccd::scene scene = client.make_scene();
    pccd::mesh good = client.make_mesh({two, faces});
    pccd::object object = scene.add(good);
    const std::vector<vec3> few(two.begin(), two.begin() + 3);
    std::vector<vec3> many = two;
    many.insert(many.end(), two.begin(), two.end());
    bool is_told = true;
    for (const pccd_motion &part : {pccd::to(object, few), pccd::to(object, many),
                                    pccd::between(object, few, few)}) {
        is_told = is_told && scene.try_step({&part, 1}).status() == PCCD_E_INVAL;
    }
    const pccd_motion end = pccd::to(object, few, 3);
    tell(is_told && scene.try_step({&end, 1}).status() == PCCD_OK && end.first == 3,
         "motion__of_a_part_is_told_or_meant");
    good.replace({few, std::vector<std::uint32_t>{0, 1, 2}});
    const pccd_motion all = pccd::to(object, few);
    const pccd_motion old = pccd::to(object, two);
    const double pose[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    const pccd_motion still = pccd::rigid(object, pose, pose);
    tell(object.vertex_count() == 3 && scene.try_step({&all, 1}).status() == PCCD_OK &&
             scene.try_step({&old, 1}).status() == PCCD_E_INVAL &&
             scene.try_step({&still, 1}).status() == PCCD_OK,
         "motion__is_of_the_mesh_as_it_is");
    good.replace({two, faces});
    std::vector<vec3> away = two;
    for (vec3 &x : away) {
        x.x += 90;
    }
    const pccd::object far = scene.add(client.make_mesh({away, faces}));
    pccd::result<pccd::answer> nearest =
        scene.try_near(pccd::near_settings(PCCD_NEAR_NEAREST));
    tell(nearest.status() == PCCD_OK && (*nearest)->total == 1,
         "nearest__looks_as_far_as_it_takes");
    pccd::scene gone = std::move(scene);
    tell(scene.try_step({}).status() == PCCD_E_INVAL, "scene__that_is_gone_is_told");
    scene = std::move(gone);
}

// If it failed, what an exporter has split would stay apart in C++ alone, or be joined
// where it comes apart.
void check_weld()
{
    const std::vector<vec3> split = {{0, 0, 0},    {1, 0, 0}, {0, 1, 0},
                                     {1, -0.0, 0}, {0, 1, 0}, {1, 1, 0}};
    std::vector<vec3> later = split;
    later[4].z = 1;
    const pccd::positions frame = later;
    const pccd::welded still = pccd::weld({split, faces});
    const pccd::welded moved = pccd::weld({split, faces}, {&frame, 1});
    tell(still.joined == 2 && still.to == std::vector<std::uint32_t>{0, 1, 2, 1, 2, 5} &&
             moved.joined == 1 && moved.apart == 1 && moved.to[4] == 4 &&
             moved.more_distance > 0 && moved.more == 0,
         "weld__joins_what_stays_at_one_place");
    const std::vector<vec3> few(split.begin(), split.begin() + 3);
    const pccd::positions short_frame = few;
    tell(pccd::try_weld({few, faces}).status() == PCCD_E_INDEX &&
             pccd::try_weld({split, faces}, {&short_frame, 1}).status() == PCCD_E_INVAL &&
             pccd::try_weld({split, faces}, {}, -1).status() == PCCD_E_INVAL,
         "weld__says_what_is_wrong");
}

// If one failed, a door would turn about another pin, or not as in C.
void check_turning(pccd::client &client)
{
    const std::vector<vec3> door = {{.125, 0, -1}, {1, 0, -1}, {1, 0, 1}, {.125, 0, 1}};
    const std::vector<vec3> post = {{.25, .25, -2}, {.25, .25, 2}, {-1, 1, 0}};
    const std::uint32_t door_faces[2][3] = {{0, 1, 2}, {0, 2, 3}};
    const std::uint32_t post_face[1][3] = {{0, 1, 2}};
    const double pin[3] = {0, 0, 0}, up[3] = {0, 0, 1}, none[3] = {0, 0, 0};
    const pccd_pose still = {{0, 0, 0}, {0, 0, 0, 1}}, half = {{0, 0, 0}, {0, 0, 1, 0}};
    pccd::scene scene = client.make_scene();
    pccd::mesh of_door = client.make_mesh({door, door_faces});
    pccd::mesh of_post = client.make_mesh({post, post_face});
    pccd::object turns = scene.add(of_door);
    pccd::object stands = scene.add(of_post);
    pccd::joints joints;
    const std::uint32_t hinge = joints.screw(pin, up, std::acos(-1.0) / 2);
    const pccd::answer answer = scene.step(pccd::turning(turns, hinge), joints.with());
    tell(answer->total == 3 && answer->toi_first <= .5 && answer->toi_first > .4999,
         "turning__meets_at_its_angle");
    const std::size_t before = joints.all().size();
    tell(joints.try_screw(pin, none, 1).status() == PCCD_E_INVAL &&
             joints.try_poses(still, half).status() == PCCD_E_INVAL &&
             joints.all().size() == before &&
             joints.poses(still, half, 0, up, hinge) == before + 2 &&
             joints.rotation_vector(pin, up, pin, up) == before + 4,
         "joints__are_added_or_refused");
}

// If one failed, a ray would go through what it hits in C, or a capsule be thin.
void check_rays(pccd::client &client)
{
    const std::vector<vec3> begin = {{.25, .25, 1}, {.25, .25, -1}},
                            end = {{.25, .25, -1}, {5, 5, -1}}, low = {{.25, .25, 1}};
    const double radius = .25;
    pccd::scene scene = client.make_scene();
    pccd::mesh mesh = client.make_mesh({two, faces});
    pccd::object object = scene.add(mesh);
    pccd::rays_settings settings(2);
    settings.pieces = 1;
    const std::vector<pccd_ray_hit> hits = scene.make_rays(settings).cast(begin, end);
    tell(hits.size() == 2 && hits[0].t == 0 && hits[0].object == object.id() &&
             hits[0].points == 3 && hits[0].feature == 1 && std::isinf(hits[1].t),
         "rays__hit_what_is_first");
    settings = pccd::rays_settings(1, 2);
    settings.radii = &radius;
    pccd::rays capsule = scene.make_rays(settings);
    const std::vector<vec3> from = {{.25, .25, -2}, {.25, .25, -1}},
                            to = {{.25, .25, -1}, {.25, .25, 0}};
    const std::vector<pccd_ray_hit> hit = capsule.cast(from, to);
    tell(hit.size() == 1 && hit[0].t > .749 && hit[0].t <= .75 && hit[0].feature == 0 &&
             std::fabs(hit[0].point[2] + .25) < 1e-6 && hit[0].normal[2] == -1,
         "rays__are_as_thick_as_said");
    tell(capsule.try_cast(begin, low).status() == PCCD_E_INVAL &&
             scene.try_make_rays(pccd::rays_settings(1, 3)).status() == PCCD_E_INVAL,
         "rays__need_both_ends");
}

void check_all(pccd::client client)
{
    check_step(client);
    check_crossed(client);
    check_batch(client);
    check_positions(client);
    check_matrices(client);
    check_ownership(client);
    check_errors(client);
    check_motions(client);
    check_turning(client);
    check_rays(client);
}

} // namespace

int main()
{
    pccd::options options;
    options.private_daemon = true;
    pccd::result<pccd::client> client = pccd::client::try_connect(options);
    if (!client) {
        std::printf("Bail out! %s\n", client.why().what());
        return 1;
    }
    check_all(*client);
    check_all(pccd::client("direct:"));
    check_order();
    check_points();
    check_weld();
    std::printf("1..%d\n", count);
    return failed != 0;
}
