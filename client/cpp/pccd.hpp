/* pccd.hpp - the library for C++17 and later: handles that free themselves, views, errors
 * as exceptions or as values.
 *
 * Room:     client/cpp; installed. May include: pccd.h, the standard library.
 * Does:     wrap the calls of pccd.h that most programs need; client::get() and the
 *           handles' id() are for all others. Everything is inline: there is no library
 *           of its own, and no ABI but that of pccd.h.
 * Does not: copy positions or records. They are read where they lie.
 * Threads:  a client and all that was made with it belong to one thread at a time: while
 *           one is in a call, that of another fails with PCCD_E_BUSY.
 *
 * One header is all of it, to be read from top to bottom.
 *
 *     pccd::client client;                      // starts a daemon if none is running
 *     pccd::scene scene = client.make_scene();
 *     pccd::mesh mesh = client.make_mesh({x0, triangles});
 *     pccd::object cloth = scene.add(mesh);
 *     for (;;) {
 *         pccd::answer answer = scene.step(pccd::to(cloth, x1));
 *         for (const pccd_contact &contact : answer.contacts()) {
 *             respond(contact);
 *         }
 *     }
 *
 * Positions are any contiguous range of floats or doubles: std::vector<float>, or of
 * triples such as std::array<double, 3> or a struct of three floats. A matrix of Eigen
 * has a vertex in each row and lies by rows (RowMajor), or has one in each column and
 * lies by columns: Matrix3Xd. MatrixXd, with the x of all vertices together, would have
 * to be copied, and does not compile.
 *
 * Errors: each call that can fail has two forms. scene.step(...) throws pccd::error;
 * scene.try_step(...) returns a pccd::result, which is a value or an error. In a program
 * that is compiled without exceptions the first form prints the error and aborts.
 */
#ifndef PCCD_HPP
#define PCCD_HPP

#include <pccd.h>

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace pccd {

// ---- errors ---------------------------------------------------------------------------

// A status of enum pccd_status, and a sentence that says what was wrong.
class error : public std::runtime_error {
public:
    error(int status, const std::string &text)
        : std::runtime_error(std::string(pccd_status_name(status)) + ": " +
                             (text.empty() ? pccd_status_text(status) : text)),
          status_(status)
    {
    }
    int status() const noexcept { return status_; }

private:
    int status_;
};

[[noreturn]] inline void fail(const error &what)
{
#if defined(__cpp_exceptions)
    throw what;
#else
    std::fprintf(stderr, "pccd: %s\n", what.what());
    std::abort();
#endif
}

// A value, or why there is none.
template <class T> class result {
public:
    result(T value) : state_(std::in_place_index<0>, std::move(value)) {}
    result(error why) : state_(std::in_place_index<1>, std::move(why)) {}

    explicit operator bool() const noexcept { return state_.index() == 0; }
    int status() const noexcept { return *this ? PCCD_OK : why().status(); }
    // Only of one that failed.
    const error &why() const noexcept { return *std::get_if<1>(&state_); }
    // The value is moved out; without one, the error is thrown.
    T value() && { return std::move(held()); }
    // The same where it is.
    T &operator*() { return held(); }
    T *operator->() { return &held(); }

private:
    T &held()
    {
        if (!*this) {
            fail(why());
        }
        return *std::get_if<0>(&state_);
    }

    std::variant<T, error> state_;
};

// Of a call that brings nothing.
struct done {};

// ---- views ----------------------------------------------------------------------------

// Some elements in memory that belongs to somebody else. It converts into std::span.
template <class T> class view {
public:
    view() = default;
    view(T *data, std::size_t size) : data_(data), size_(size) {}
    template <class Range, class = std::enable_if_t<std::is_convertible_v<
                               decltype(std::data(std::declval<Range &>())), T *>>>
    view(Range &&range)
        : data_(std::data(range)), size_(static_cast<std::size_t>(std::size(range)))
    {
    }
    T *data() const noexcept { return data_; }
    std::size_t size() const noexcept { return size_; }
    bool empty() const noexcept { return size_ == 0; }
    T *begin() const noexcept { return data_; }
    T *end() const noexcept { return data_ + size_; }
    T &operator[](std::size_t i) const noexcept { return data_[i]; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};

namespace detail {

template <class Range>
using element_of =
    std::remove_cv_t<std::remove_pointer_t<decltype(std::data(std::declval<Range &>()))>>;

// A matrix or vector of Eigen, or what has the same members.
template <class Range, class = void> struct is_matrix : std::false_type {};
template <class Range>
struct is_matrix<Range, std::void_t<typename Range::Scalar, decltype(Range::IsRowMajor),
                                    decltype(Range::RowsAtCompileTime)>>
    : std::true_type {};

// Whether a number of the type T lies in memory as one of the type Number does.
template <class T, class Number> constexpr bool is_like()
{
    return std::is_arithmetic_v<T> && sizeof(T) == sizeof(Number) &&
           std::is_floating_point_v<T> == std::is_floating_point_v<Number>;
}

// What becomes a number like Number, and nothing else.
template <class Number> struct only {
    template <class T, class = std::enable_if_t<is_like<T, Number>()>>
    operator T() const noexcept;
};
// Whether braces around these make an Element, and so it has as many members, or more.
template <class Element, class, class... Onlies> struct takes : std::false_type {};
template <class Element, class... Onlies>
struct takes<Element, std::void_t<decltype(Element{std::declval<Onlies>()...})>,
             Onlies...> : std::true_type {};

// The first number of a class that hides its members: void if it does not tell.
template <class Element> auto first_of(const Element &e, int) -> decltype(e[0]);
template <class Element> auto first_of(const Element &e, long) -> decltype(e.x);
template <class Element> void first_of(const Element &e, ...);

// Whether a class holds `Group` numbers like Number, as far as it tells: one of their
// size may hold six floats in the place of three doubles, or integers.
template <class Element, class Number, std::size_t Group> constexpr bool is_class_of()
{
    using one = only<Number>;
    if constexpr (!std::is_aggregate_v<Element>) {
        using first = std::decay_t<decltype(first_of(std::declval<const Element &>(), 0))>;
        return !std::is_arithmetic_v<first> || is_like<first, Number>();
    } else if constexpr (Group == 3) {
        return takes<Element, void, one, one, one>() &&
               !takes<Element, void, one, one, one, one>();
    } else if constexpr (Group == 2) {
        return takes<Element, void, one, one>() && !takes<Element, void, one, one, one>();
    } else {
        return takes<Element, void, one>() && !takes<Element, void, one, one>();
    }
}

// Numbers of the type Number, `Group` of them together: a flat range of these, or one of
// arrays or structs of `Group` each.
template <class Element, class Number, std::size_t Group> constexpr bool is_group_of()
{
    using plain = std::remove_all_extents_t<Element>;
    if constexpr (std::is_arithmetic_v<plain>) {
        return is_like<plain, Number>() && (std::is_arithmetic_v<Element> ||
                                            sizeof(Element) == Group * sizeof(Number));
    } else if constexpr (is_matrix<Element>()) {
        return is_group_of<typename Element::Scalar, Number, Group>() &&
               sizeof(Element) == Group * sizeof(Number);
    } else if constexpr (std::is_trivially_copyable_v<Element> &&
                         sizeof(Element) == Group * sizeof(Number)) {
        return is_class_of<Element, Number, Group>();
    } else {
        return false;
    }
}

// Whether a range may be groups of `Group` numbers, one behind the other in memory: no
// matrix whose columns, or rows if it lies by rows, are known to be something else.
// Where it lies by columns their length has to be known, as a mesh is mostly by rows.
template <class Range, std::size_t Group> constexpr bool may_hold_groups()
{
    if constexpr (is_matrix<Range>()) {
        constexpr int length = Range::IsRowMajor ? int(Range::ColsAtCompileTime)
                                                 : int(Range::RowsAtCompileTime);
        return bool(Range::IsVectorAtCompileTime) || length == int(Group) ||
               (bool(Range::IsRowMajor) && length < 0);
    }
    return true;
}
// Whether it is.
template <std::size_t Group, class Range> bool holds_groups(const Range &range)
{
    static_assert(may_hold_groups<Range, Group>(),
                  "a matrix that lies by columns, such as Eigen::MatrixXd, has the x of "
                  "all vertices together: take Matrix<double, Dynamic, 3, RowMajor>");
    if constexpr (is_matrix<Range>()) {
        if constexpr (!bool(Range::IsVectorAtCompileTime)) {
            const auto length = Range::IsRowMajor ? range.cols() : range.rows();
            return length == int(Group) && range.innerStride() == 1 &&
                   range.outerStride() == length;
        } else {
            return range.innerStride() == 1;
        }
    }
    return true;
}

} // namespace detail

// The coordinates of vertices, x y z x y z ..., as floats or doubles.
class positions {
public:
    positions() = default;
    positions(const float *x, std::uint32_t vertex_count)
        : data_(x), count_(vertex_count), format_(PCCD_FORMAT_F32)
    {
    }
    positions(const double *x, std::uint32_t vertex_count)
        : data_(x), count_(vertex_count), format_(PCCD_FORMAT_F64)
    {
    }
    template <class Range, class Element = detail::element_of<const Range>>
    positions(const Range &range)
    {
        constexpr bool is_single = detail::is_group_of<Element, float, 3>();
        static_assert(is_single || detail::is_group_of<Element, double, 3>(),
                      "positions are floats or doubles, or triples of these");
        constexpr std::size_t bytes = is_single ? sizeof(float) : sizeof(double);
        const std::size_t numbers =
            static_cast<std::size_t>(std::size(range)) * sizeof(Element) / bytes;
        data_ = std::data(range);
        count_ = static_cast<std::uint32_t>(numbers / 3);
        format_ = is_single ? PCCD_FORMAT_F32 : PCCD_FORMAT_F64;
        is_whole_ =
            numbers % 3 == 0 && numbers / 3 == count_ && detail::holds_groups<3>(range);
    }
    const void *data() const noexcept { return data_; }
    std::uint32_t count() const noexcept { return count_; }
    pccd_format format() const noexcept { return format_; }
    // Not so if the numbers are no triples that lie one behind the other, or more than
    // 2^32 of them.
    bool is_whole() const noexcept { return is_whole_; }

private:
    const void *data_ = nullptr;
    std::uint32_t count_ = 0;
    pccd_format format_ = PCCD_FORMAT_F64;
    bool is_whole_ = true;
};

// Vertex indices, Group of them a feature: 3 a triangle, 2 an edge, 1 a point.
template <std::size_t Group> class indices {
public:
    indices() = default;
    template <class Range, class Element = detail::element_of<const Range>>
    indices(const Range &range)
    {
        static_assert(detail::is_group_of<Element, std::uint32_t, Group>(),
                      "indices are 32-bit integers, or groups of these");
        const std::size_t numbers =
            static_cast<std::size_t>(std::size(range)) * sizeof(Element) / 4;
        data_ = reinterpret_cast<const std::uint32_t *>(std::data(range));
        count_ = static_cast<std::uint32_t>(numbers / Group);
        is_whole_ = numbers % Group == 0 && numbers / Group == count_ &&
                    detail::holds_groups<Group>(range);
    }
    const std::uint32_t *data() const noexcept { return data_; }
    std::uint32_t count() const noexcept { return count_; }
    bool is_whole() const noexcept { return is_whole_; }

private:
    const std::uint32_t *data_ = nullptr;
    std::uint32_t count_ = 0;
    bool is_whole_ = true;
};

// What a mesh is made of. A member that is left out is empty.
struct shape {
    positions x;
    indices<3> triangles{};
    indices<2> edges{};         // rods
    indices<1> points{};        // clouds
    view<const double> radii{}; // none, or one for each vertex
};

// ---- settings: those of pccd.h, with the defaults filled in ----------------------

struct options : pccd_options {
    options() { pccd_options_init(this); }
};
struct step_settings : pccd_step_settings {
    step_settings() : pccd_step_settings{} { struct_bytes = sizeof(pccd_step_settings); }
};
struct near_settings : pccd_near_settings {
    // Of PCCD_NEAR_NEAREST however far that is; of others what touches.
    explicit near_settings(pccd_near_what asked = PCCD_NEAR_PAIRS)
        : near_settings(asked, asked == PCCD_NEAR_NEAREST
                                   ? std::numeric_limits<double>::infinity()
                                   : 0.0)
    {
    }
    near_settings(pccd_near_what asked, double within) : pccd_near_settings{}
    {
        struct_bytes = sizeof(pccd_near_settings);
        what = asked;
        distance = within;
    }
};
struct rays_settings : pccd_rays_settings {
    // Points; with `radii` spheres, with two ends capsules (pccd_rays.h).
    explicit rays_settings(std::uint32_t ray_count, std::uint32_t ends_of_each = 1)
        : pccd_rays_settings{}
    {
        struct_bytes = sizeof(pccd_rays_settings);
        count = ray_count;
        ends = ends_of_each;
    }
};
struct object_settings : pccd_object_settings {
    object_settings() : pccd_object_settings{}
    {
        struct_bytes = sizeof(pccd_object_settings);
    }
};

// ---- handles --------------------------------------------------------------------------

namespace detail {

using shared_client = std::shared_ptr<pccd_client>;

inline error last(const shared_client &link, int status)
{
    return error(status, pccd_error_text(link.get()));
}

// A handle of the daemon. It is given back by `Free` with the last owner; the connection
// stays for as long as something needs it.
template <int (*Free)(pccd_client *, std::uint32_t)> class handle {
public:
    handle(shared_client link, std::uint32_t id) : link_(std::move(link)), id_(id) {}
    handle(handle &&other) noexcept
        : link_(std::move(other.link_)), id_(std::exchange(other.id_, 0u))
    {
    }
    handle &operator=(handle &&other) noexcept
    {
        if (this != &other) {
            reset();
            link_ = std::move(other.link_);
            id_ = std::exchange(other.id_, 0u);
        }
        return *this;
    }
    handle(const handle &) = delete;
    handle &operator=(const handle &) = delete;
    ~handle() { reset(); }

    // For the calls of pccd.h; 0 after it was moved from.
    std::uint32_t id() const noexcept { return id_; }

protected:
    const shared_client &connection() const noexcept { return link_; }
    result<done> finish(int status) const
    {
        return status == PCCD_OK ? result<done>(done{}) : last(link_, status);
    }

private:
    void reset() noexcept
    {
        if (link_ && id_ != 0) {
            Free(link_.get(), std::exchange(id_, 0u));
        }
        link_.reset();
    }

    shared_client link_;
    std::uint32_t id_;
};

// A shape as pccd.h has it.
inline result<pccd_mesh_data> data_of(const shape &shape)
{
    const bool has_radii = !shape.radii.empty();
    if (!shape.x.is_whole() || !shape.triangles.is_whole() || !shape.edges.is_whole() ||
        !shape.points.is_whole() ||
        (has_radii && shape.radii.size() != shape.x.count())) {
        return error(PCCD_E_INVAL, "positions and triangles are groups of three, "
                                   "edges of two, and each vertex has a radius");
    }
    pccd_mesh_data data{};
    data.struct_bytes = sizeof data;
    data.x = shape.x.data();
    data.format = shape.x.format();
    data.vertex_count = shape.x.count();
    data.triangle_count = shape.triangles.count();
    data.triangles = shape.triangles.data();
    data.radii = has_radii ? shape.radii.data() : nullptr;
    data.edges = shape.edges.data();
    data.points = shape.points.data();
    data.edge_count = shape.edges.count();
    data.point_count = shape.points.count();
    return data;
}

} // namespace detail

// ---- vertices that are one ------------------------------------------------------------

// Which vertices of a shape are one (pccd_weld.h): to[v] stands for v. The counts say
// what became of the others.
struct welded : pccd_weld_counts {
    std::vector<std::uint32_t> to;
};

// Vertices of a shape that are at most `distance` apart, 0: at one place, in its own
// positions and in `frames`. It needs no client.
inline result<welded> try_weld(const shape &shape, view<const positions> frames = {},
                               double distance = 0)
{
    result<pccd_mesh_data> data = detail::data_of(shape);
    if (!data) {
        return data.why();
    }
    pccd_weld *made = nullptr;
    int status = pccd_weld_begin(&*data, distance, true, &made);
    const std::unique_ptr<pccd_weld, decltype(&pccd_weld_end)> weld(made, pccd_weld_end);
    if (status == PCCD_OK) {
        status = pccd_weld_frame(made, data->x, data->format);
    }
    for (const positions &x : frames) {
        if (!x.is_whole() || x.count() != shape.x.count()) {
            return error(PCCD_E_INVAL, "frames have as many vertices as the shape");
        }
        if (status == PCCD_OK) {
            status = pccd_weld_frame(made, x.data(), x.format());
        }
    }
    if (status != PCCD_OK) {
        return error(status, pccd_error_text(nullptr));
    }
    welded welded{};
    const std::uint32_t *to = pccd_weld_read(made, &welded);
    welded.to.assign(to, to + shape.x.count());
    return welded;
}
inline welded weld(const shape &shape, view<const positions> frames = {},
                   double distance = 0)
{
    return try_weld(shape, frames, distance).value();
}

// ---- where records are (pccd_points.h) ------------------------------------------------

// Of each record four vertices, by their numbers among all, and their weights.
struct stencils {
    std::vector<std::array<std::uint32_t, 4>> vertices;
    std::vector<std::array<double, 4>> weights;
};

namespace detail {

template <class Call> result<stencils> stencils_by(std::size_t count, const Call &call)
{
    stencils made;
    made.vertices.resize(count);
    made.weights.resize(count);
    const int status =
        call(reinterpret_cast<std::uint32_t(*)[4]>(made.vertices.data()),
             reinterpret_cast<double(*)[4]>(made.weights.data()));
    if (status != PCCD_OK) {
        return error(status, pccd_error_text(nullptr));
    }
    return made;
}

template <class Call>
result<std::vector<pccd_manifold>> manifolds_by(std::size_t count, const Call &call)
{
    std::vector<pccd_manifold> made(count);
    std::uint64_t total = 0;
    const int status = call(made.data(), std::uint64_t{count}, &total);
    if (status != PCCD_OK) {
        return error(status, pccd_error_text(nullptr));
    }
    made.resize(static_cast<std::size_t>(total));
    return made;
}

} // namespace detail

// They need no client; bodies are in the order of their objects.
inline result<stencils> try_stencils(view<const pccd_body> bodies,
                                     view<const pccd_contact> contacts)
{
    return detail::stencils_by(contacts.size(), [&](auto *vertices, auto *weights) {
        return pccd_stencils(bodies.data(), static_cast<std::uint32_t>(bodies.size()),
                             contacts.data(), contacts.size(), vertices, weights);
    });
}
inline result<stencils> try_stencils(view<const pccd_body> bodies,
                                     view<const pccd_near> near)
{
    return detail::stencils_by(near.size(), [&](auto *vertices, auto *weights) {
        return pccd_near_stencils(bodies.data(),
                                  static_cast<std::uint32_t>(bodies.size()), near.data(),
                                  near.size(), vertices, weights);
    });
}
// For each two bodies at most four points of the contacts whose toi is at most `time`
// later than their first; of what is near and at most `distance` apart, at time t.
inline result<std::vector<pccd_manifold>>
try_manifolds(view<const pccd_body> bodies, view<const pccd_contact> contacts,
              double time = 1e-6)
{
    return detail::manifolds_by(contacts.size(), [&](auto *made, auto room, auto *total) {
        return pccd_manifolds(bodies.data(), static_cast<std::uint32_t>(bodies.size()),
                              contacts.data(), contacts.size(), time, made, room, total);
    });
}
inline result<std::vector<pccd_manifold>>
try_manifolds(view<const pccd_body> bodies, view<const pccd_near> near, double distance,
              double t)
{
    return detail::manifolds_by(near.size(), [&](auto *made, auto room, auto *total) {
        return pccd_near_manifolds(bodies.data(),
                                   static_cast<std::uint32_t>(bodies.size()), near.data(),
                                   near.size(), distance, t, made, room, total);
    });
}
template <class... Given> auto stencils_of(const Given &...given)
{
    return try_stencils(given...).value();
}
template <class... Given> auto manifolds_of(const Given &...given)
{
    return try_manifolds(given...).value();
}

// A registered mesh. Objects that were made of it stay when it goes.
class mesh : public detail::handle<pccd_mesh_destroy> {
public:
    const pccd_mesh_info &info() const noexcept { return info_; }

    // The edges in the order of the records' feature numbers.
    result<std::vector<pccd_edge>> try_edges() const
    {
        std::vector<pccd_edge> edges(info_.edge_count);
        const int status =
            pccd_mesh_edges(connection().get(), id(), edges.data(), info_.edge_count);
        if (status != PCCD_OK) {
            return detail::last(connection(), status);
        }
        return edges;
    }
    std::vector<pccd_edge> edges() const { return try_edges().value(); }

    // Another shape for it and for each object that is made of it.
    result<done> try_replace(const shape &shape)
    {
        std::uint32_t same = id();
        result<done> status = put(connection(), shape, &same, &info_);
        if (status && vertex_count_) {
            *vertex_count_ = info_.vertex_count;
        }
        return status;
    }
    void replace(const shape &shape) { try_replace(shape).value(); }

private:
    friend class client;
    friend class scene;
    using handle::handle;

    static result<done> put(const detail::shared_client &link, const shape &shape,
                            std::uint32_t *id, pccd_mesh_info *info)
    {
        result<pccd_mesh_data> data = detail::data_of(shape);
        if (!data) {
            return data.why();
        }
        const int status = pccd_mesh_put(link.get(), &*data, id, info);
        if (status != PCCD_OK) {
            return detail::last(link, status);
        }
        return done{};
    }

    pccd_mesh_info info_{};
    std::shared_ptr<std::uint32_t> vertex_count_; // its objects', too
};

// An instance of a mesh in a scene. It is removed with this handle.
class object {
public:
    object(object &&other) noexcept
        : link_(std::move(other.link_)), scene_(other.scene_),
          id_(std::exchange(other.id_, 0u)), vertex_count_(std::move(other.vertex_count_))
    {
    }
    object &operator=(object &&other) noexcept
    {
        if (this != &other) {
            reset();
            link_ = std::move(other.link_);
            scene_ = other.scene_;
            id_ = std::exchange(other.id_, 0u);
            vertex_count_ = std::move(other.vertex_count_);
        }
        return *this;
    }
    object(const object &) = delete;
    object &operator=(const object &) = delete;
    ~object() { reset(); }

    std::uint32_t id() const noexcept { return id_; }
    // Of its mesh.
    std::uint32_t vertex_count() const noexcept
    {
        return vertex_count_ ? *vertex_count_ : 0;
    }

    // Set what settings.what names: whom it may meet, how thick it is.
    result<done> try_set(const pccd_object_settings &settings)
    {
        const int status = pccd_object_set(link_.get(), scene_, id_, &settings);
        return status == PCCD_OK ? result<done>(done{}) : detail::last(link_, status);
    }
    void set(const pccd_object_settings &settings) { try_set(settings).value(); }
    // What people who look at a recording are told that it is (pccd_object_name).
    result<done> try_set_name(const std::string &name)
    {
        const int status = pccd_object_name(link_.get(), scene_, id_, name.c_str());
        return status == PCCD_OK ? result<done>(done{}) : detail::last(link_, status);
    }
    void set_name(const std::string &name) { try_set_name(name).value(); }
    // Half its thickness, in the unit of the coordinates.
    void set_radius(double radius)
    {
        object_settings settings;
        settings.what = PCCD_OBJECT_RADIUS;
        settings.radius = radius;
        set(settings);
    }
    // A number of the user's, such as an entity's: scene::user_data gives it back.
    void set_user_data(std::uint64_t user_data)
    {
        object_settings settings;
        settings.what = PCCD_OBJECT_USER_DATA;
        settings.user_data = user_data;
        set(settings);
    }

private:
    friend class scene;
    object(detail::shared_client link, std::uint32_t scene, std::uint32_t id,
           std::shared_ptr<const std::uint32_t> count)
        : link_(std::move(link)), scene_(scene), id_(id), vertex_count_(std::move(count))
    {
    }
    void reset() noexcept
    {
        if (link_ && id_ != 0) {
            pccd_scene_remove(link_.get(), scene_, std::exchange(id_, 0u));
        }
        link_.reset();
    }

    detail::shared_client link_;
    std::uint32_t scene_ = 0;
    std::uint32_t id_ = 0;
    std::shared_ptr<const std::uint32_t> vertex_count_;
};

// ---- what moves in a step -------------------------------------------------------------

// The vertices first, first + 1, ... of an object, from where they are to x1; the others
// stand still.
inline pccd_motion to(const object &object, const positions &x1, std::uint32_t first)
{
    pccd_motion motion{};
    motion.object = object.id();
    motion.first = first;
    motion.count = x1.is_whole() ? x1.count() : 0;
    motion.format = x1.format();
    motion.x1 = x1.is_whole() ? x1.data() : nullptr;
    return motion;
}

// All of them. A step with a motion of more vertices, or fewer, fails with PCCD_E_INVAL.
inline pccd_motion to(const object &object, const positions &x1)
{
    pccd_motion motion = to(object, x1, 0);
    motion.x1 = x1.count() == object.vertex_count() ? motion.x1 : nullptr;
    return motion;
}

// From x0 to x1, which have as many vertices and the same format.
inline pccd_motion between(const object &object, const positions &x0, const positions &x1)
{
    pccd_motion motion = to(object, x1);
    const bool is_alike =
        x0.is_whole() && x0.count() == x1.count() && x0.format() == x1.format();
    motion.x0 = is_alike ? x0.data() : nullptr;
    motion.x1 = is_alike ? motion.x1 : nullptr;
    return motion;
}

// All of a body by a transform for each end of the step, rows of [R | t]. Each vertex
// goes straight from where the first puts it to where the second does.
inline pccd_motion rigid(const object &object, const double (&m0)[12],
                         const double (&m1)[12])
{
    pccd_motion motion{};
    motion.object = object.id();
    motion.count = object.vertex_count();
    motion.m0 = m0;
    motion.m1 = m1;
    return motion;
}

// ---- bodies that turn -----------------------------------------------------------------

// The joints of a step (pccd_turning.h), on which objects hang. What adds a motion returns
// the joint that a body hangs on; `parent` is such a joint, or the world.
class joints {
public:
    using vector = double[3];

    // Turn by `angle` (radians) about the axis through `centre`, and go by `shift` along
    // it.
    result<std::uint32_t> try_screw(const vector &centre, const vector &axis,
                                    double angle, double shift = 0,
                                    std::uint32_t parent = PCCD_NO_JOINT)
    {
        return add([&](pccd_joint *to, std::uint32_t room, std::uint32_t *count) {
            return pccd_joints_screw(centre, axis, angle, shift, parent, to, room,
                                     count);
        });
    }
    std::uint32_t screw(const vector &centre, const vector &axis, double angle,
                        double shift = 0, std::uint32_t parent = PCCD_NO_JOINT)
    {
        return try_screw(centre, axis, angle, shift, parent).value();
    }
    // Go from one pose to another, with so many whole turns more; `axis` says which way.
    result<std::uint32_t> try_poses(const pccd_pose &from, const pccd_pose &to,
                                    std::int32_t turns = 0, const double *axis = nullptr,
                                    std::uint32_t parent = PCCD_NO_JOINT)
    {
        return add([&](pccd_joint *where, std::uint32_t room, std::uint32_t *count) {
            return pccd_joints_poses(&from, &to, turns, axis, parent, where, room,
                                     count);
        });
    }
    std::uint32_t poses(const pccd_pose &from, const pccd_pose &to,
                        std::int32_t turns = 0, const double *axis = nullptr,
                        std::uint32_t parent = PCCD_NO_JOINT)
    {
        return try_poses(from, to, turns, axis, parent).value();
    }
    // Go with a rotation vector that goes straight from w0 to w1.
    result<std::uint32_t> try_rotation_vector(const vector &origin0, const vector &origin1,
                                              const vector &w0, const vector &w1,
                                              std::uint32_t parent = PCCD_NO_JOINT)
    {
        return add([&](pccd_joint *to, std::uint32_t room, std::uint32_t *count) {
            return pccd_joints_rotation_vector(origin0, origin1, w0, w1, parent, to,
                                               room, count);
        });
    }
    std::uint32_t rotation_vector(const vector &origin0, const vector &origin1,
                                  const vector &w0, const vector &w1,
                                  std::uint32_t parent = PCCD_NO_JOINT)
    {
        return try_rotation_vector(origin0, origin1, w0, w1, parent).value();
    }
    // Add a joint as it is.
    std::uint32_t add(const pccd_joint &joint)
    {
        all_.push_back(joint);
        return static_cast<std::uint32_t>(all_.size() - 1);
    }

    // All of them, to be changed between steps.
    std::vector<pccd_joint> &all() noexcept { return all_; }
    const std::vector<pccd_joint> &all() const noexcept { return all_; }
    // Settings of a step whose motions `turning` are on these, which stay where they are
    // until it is submitted.
    step_settings with(const step_settings &settings = {}) const
    {
        return set(settings);
    }
    near_settings with(const near_settings &settings) const { return set(settings); }

private:
    template <class Settings> Settings set(Settings settings) const
    {
        settings.joints = all_.data();
        settings.joint_count = static_cast<std::uint32_t>(all_.size());
        return settings;
    }
    template <class Call> result<std::uint32_t> add(const Call &call)
    {
        std::uint32_t count = static_cast<std::uint32_t>(all_.size());
        const std::uint32_t first = count, room = count + PCCD_JOINTS_MOST;
        all_.resize(room);
        const int status = call(all_.data(), room, &count);
        all_.resize(status == PCCD_OK ? count : first);
        if (status != PCCD_OK) {
            return error(status, pccd_error_text(nullptr));
        }
        return count - 1;
    }

    std::vector<pccd_joint> all_;
};

// All of a body on a joint of the step's settings: scene.step(turning(door, joint),
// joints.with()).
inline pccd_motion turning(const object &object, std::uint32_t joint)
{
    pccd_motion motion{};
    motion.object = object.id();
    motion.first = joint;
    motion.count = object.vertex_count();
    return motion;
}

// ---- answers --------------------------------------------------------------------------

// The answer to a step or to a question about what is near. Its records lie in memory
// that the daemon shares; they are given back with it.
class answer {
public:
    answer(answer &&other) noexcept
        : link_(std::move(other.link_)), data_(std::exchange(other.data_, pccd_answer{}))
    {
    }
    answer &operator=(answer &&other) noexcept
    {
        if (this != &other) {
            reset();
            link_ = std::move(other.link_);
            data_ = std::exchange(other.data_, pccd_answer{});
        }
        return *this;
    }
    answer(const answer &) = delete;
    answer &operator=(const answer &) = delete;
    ~answer() { reset(); }

    // All that is known of it: total, toi_first, safe_step, verdict, counters, ...
    const pccd_answer *operator->() const noexcept { return &data_; }
    const pccd_answer &data() const noexcept { return data_; }

    // The records of this page: one of these has them, by what was asked.
    view<const pccd_contact> contacts() const noexcept { return page(data_.contacts); }
    view<const pccd_pair> pairs() const noexcept { return page(data_.pairs); }
    view<const pccd_near> near() const noexcept { return page(data_.near); }
    view<const double> vertex_bounds() const noexcept
    {
        return page(data_.vertex_bounds);
    }
    // Nothing is missing: no further page, no deadline, no cancel, no limit.
    bool is_complete() const noexcept { return data_.incomplete == PCCD_COMPLETE; }
    bool has_more() const noexcept { return data_.cursor < data_.total; }

private:
    friend class client;
    friend class scene;
    explicit answer(detail::shared_client link) : link_(std::move(link)), data_{}
    {
        data_.struct_bytes = sizeof data_;
    }
    template <class T> view<const T> page(const T *records) const noexcept
    {
        return {records, records ? static_cast<std::size_t>(data_.count) : 0};
    }
    void reset() noexcept
    {
        if (link_) {
            pccd_answer_release(link_.get(), &data_);
        }
        link_.reset();
    }

    detail::shared_client link_;
    pccd_answer data_;
};

// ---- rays -----------------------------------------------------------------------------

// Rays, spheres or capsules, which scene::make_rays has prepared. They are taken out of
// the scene with this handle.
class rays {
public:
    // Cast all of them from begin to end, doubles, as many vertices as they have ends.
    result<std::vector<pccd_ray_hit>> try_cast(const positions &begin,
                                               const positions &end,
                                               const pccd_step_settings &settings = {})
    {
        for (const positions *x : {&begin, &end}) {
            if (!x->is_whole() || x->count() != vertex_count_ ||
                x->format() != PCCD_FORMAT_F64) {
                return error(PCCD_E_INVAL, "cast: begin and end are three doubles for each "
                                           "ray, six for each capsule");
            }
        }
        std::vector<pccd_ray_hit> hits(count_);
        const int status = pccd_rays_cast(
            made_.get_deleter().link.get(), made_.get(),
            static_cast<const double *>(begin.data()),
            static_cast<const double *>(end.data()), &settings, hits.data());
        if (status != PCCD_OK) {
            return detail::last(made_.get_deleter().link, status);
        }
        return hits;
    }
    std::vector<pccd_ray_hit> cast(const positions &begin, const positions &end,
                                   const pccd_step_settings &settings = {})
    {
        return try_cast(begin, end, settings).value();
    }

private:
    friend class scene;
    struct free {
        detail::shared_client link;
        void operator()(pccd_rays *made) const noexcept
        {
            pccd_rays_end(link.get(), made);
        }
    };
    rays(detail::shared_client link, pccd_rays *made, const pccd_rays_settings &settings)
        : made_(made, free{std::move(link)}), count_(settings.count),
          vertex_count_(settings.count * (settings.ends == 2 ? 2 : 1))
    {
    }

    std::unique_ptr<pccd_rays, free> made_;
    std::uint32_t count_, vertex_count_;
};

// ---- scenes ---------------------------------------------------------------------------

class scene : public detail::handle<pccd_scene_destroy> {
public:
    using motions = view<const pccd_motion>;

    // An object, where its mesh is registered.
    result<object> try_add(const mesh &mesh)
    {
        std::uint32_t id = 0;
        const int status = pccd_scene_add(connection().get(), this->id(), mesh.id(), &id);
        if (status != PCCD_OK) {
            return detail::last(connection(), status);
        }
        return object(connection(), this->id(), id, mesh.vertex_count_);
    }
    object add(const mesh &mesh) { return try_add(mesh).value(); }

    // Rays that are cast through this scene.
    result<rays> try_make_rays(const pccd_rays_settings &settings)
    {
        pccd_rays *made = nullptr;
        const int status = pccd_rays_begin(connection().get(), id(), &settings, &made);
        if (status != PCCD_OK) {
            return detail::last(connection(), status);
        }
        return rays(connection(), made, settings);
    }
    rays make_rays(const pccd_rays_settings &settings)
    {
        return try_make_rays(settings).value();
    }

    // Submit and wait.
    result<answer> try_step(motions what, const pccd_step_settings &settings = {})
    {
        answer answer(connection());
        const int status = pccd_step(connection().get(), id(), what.data(), number(what),
                                     &settings, &answer.data_);
        return finish(status, std::move(answer));
    }
    answer step(motions what, const pccd_step_settings &settings = {})
    {
        return try_step(what, settings).value();
    }
    answer step(const pccd_motion &what, const pccd_step_settings &settings = {})
    {
        return try_step({&what, 1}, settings).value();
    }
    answer step(std::initializer_list<pccd_motion> what,
                const pccd_step_settings &settings = {})
    {
        return try_step({what.begin(), what.size()}, settings).value();
    }

    // Submit; take the answer by client::wait or try_poll. Returns the step's number.
    result<std::uint64_t> try_submit(motions what,
                                     const pccd_step_settings &settings = {})
    {
        std::uint64_t step = 0;
        const int status = pccd_submit(connection().get(), id(), what.data(),
                                       number(what), &settings, &step);
        if (status != PCCD_OK) {
            return detail::last(connection(), status);
        }
        return step;
    }
    std::uint64_t submit(motions what, const pccd_step_settings &settings = {})
    {
        return try_submit(what, settings).value();
    }

    // Go as far as nothing meets: x[i] gets where motion i, which has x0 and x1, ends;
    // `part` how far of the way that is, 0 .. 1 (pccd_step_safe).
    result<answer> try_step_safe(motions what, view<void *const> x, double &part,
                                 const pccd_step_settings &settings = {})
    {
        answer answer(connection());
        if (x.size() != what.size()) {
            return error(PCCD_E_INVAL, "each motion needs a place for where it ends");
        }
        const int status =
            pccd_step_safe(connection().get(), id(), what.data(), number(what), &settings,
                           x.data(), &part, &answer.data_);
        return finish(status, std::move(answer));
    }
    answer step_safe(motions what, view<void *const> x, double &part,
                     const pccd_step_settings &settings = {})
    {
        return try_step_safe(what, x, part, settings).value();
    }

    // What is near where the scene is, or after these motions.
    result<answer> try_near(const pccd_near_settings &settings, motions what = {})
    {
        answer answer(connection());
        const int status = pccd_ask_near(connection().get(), id(), what.data(),
                                         number(what), &settings, &answer.data_);
        return finish(status, std::move(answer));
    }
    answer near(const pccd_near_settings &settings, motions what = {})
    {
        return try_near(settings, what).value();
    }

    // The page behind this one: while (answer.has_more()) answer = scene.next(answer);
    // The records of this one are given back first.
    result<answer> try_next(answer &page) { return try_fetch(page, page.data_.cursor); }
    answer next(answer &page) { return try_next(page).value(); }
    // The page of the same answer that begins with the record at `cursor`.
    result<answer> try_fetch(answer &page, std::uint64_t cursor)
    {
        const std::uint64_t step = page.data_.step;
        page.reset();
        answer answer(connection());
        const int status =
            pccd_fetch(connection().get(), id(), step, cursor, &answer.data_);
        return finish(status, std::move(answer));
    }
    answer fetch(answer &page, std::uint64_t cursor)
    {
        return try_fetch(page, cursor).value();
    }

    // The number that was given to an object of this scene, by its id in a record; else 0.
    // The daemon is not asked.
    std::uint64_t user_data(std::uint32_t object) const
    {
        std::uint64_t number = 0;
        pccd_user_data(connection().get(), id(), &object, 1, &number);
        return number;
    }

    // Let two objects ignore each other, or meet again.
    result<done> try_ignore(const object &a, const object &b, bool ignored = true)
    {
        return handle::finish(
            pccd_pair_ignore(connection().get(), id(), a.id(), b.id(), ignored));
    }
    void ignore(const object &a, const object &b, bool ignored = true)
    {
        try_ignore(a, b, ignored).value();
    }
    // Let two objects meet within a clearance, at least 0, in the place of their radii.
    result<done> try_keep_clearance(const object &a, const object &b, double clearance)
    {
        return handle::finish(
            pccd_pair_clearance(connection().get(), id(), a.id(), b.id(), clearance));
    }
    void keep_clearance(const object &a, const object &b, double clearance)
    {
        try_keep_clearance(a, b, clearance).value();
    }

private:
    friend class client;
    using handle::handle;

    static std::uint32_t number(motions what)
    {
        return static_cast<std::uint32_t>(what.size());
    }
    result<answer> finish(int status, answer &&answer) const
    {
        if (status != PCCD_OK) {
            return detail::last(connection(), status);
        }
        return std::move(answer);
    }
};

// ---- batches: steps of many scenes by one request -------------------------------------

// What moves in a scene, as a part of a batch: all of an object.
inline pccd_batch_part part_of(const scene &scene, const object &object,
                               pccd_format format, pccd_batch_way way = PCCD_BATCH_X1)
{
    pccd_batch_part part{};
    part.scene = scene.id();
    part.object = object.id();
    part.count = object.vertex_count();
    part.format = format;
    part.way = way;
    return part;
}
// A scene in which nothing moves.
inline pccd_batch_part still(const scene &scene)
{
    pccd_batch_part part{};
    part.scene = scene.id();
    return part;
}

// What came of all scenes, in the order of the batch. It is given back with this handle.
class batch_answer {
public:
    batch_answer(batch_answer &&other) noexcept
        : link_(std::move(other.link_)),
          data_(std::exchange(other.data_, pccd_batch_answer{}))
    {
    }
    batch_answer &operator=(batch_answer &&other) noexcept
    {
        if (this != &other) {
            reset();
            link_ = std::move(other.link_);
            data_ = std::exchange(other.data_, pccd_batch_answer{});
        }
        return *this;
    }
    batch_answer(const batch_answer &) = delete;
    batch_answer &operator=(const batch_answer &) = delete;
    ~batch_answer() { reset(); }

    // All that is known of it: failed, incomplete, total, batch_ns, ...
    const pccd_batch_answer *operator->() const noexcept { return &data_; }
    const pccd_batch_answer &data() const noexcept { return data_; }
    // What came of each; scenes that failed say so themselves.
    view<const pccd_scene_answer> scenes() const noexcept
    {
        return {data_.scenes, static_cast<std::size_t>(data_.count)};
    }
    // The records of scene i that came with the answer: one of these has them.
    view<const pccd_contact> contacts(std::size_t i) const noexcept
    {
        return page(pccd_batch_contacts(&data_, i), i);
    }
    view<const pccd_pair> pairs(std::size_t i) const noexcept
    {
        return page(pccd_batch_pairs(&data_, i), i);
    }

private:
    friend class batch;
    friend class client;
    explicit batch_answer(detail::shared_client link) : link_(std::move(link)), data_{}
    {
        data_.struct_bytes = sizeof data_;
    }
    template <class T> view<const T> page(const T *records, std::size_t i) const noexcept
    {
        return {records, records ? static_cast<std::size_t>(data_.scenes[i].count) : 0};
    }
    void reset() noexcept
    {
        if (link_) {
            pccd_batch_release(link_.get(), &data_);
        }
        link_.reset();
    }

    detail::shared_client link_;
    pccd_batch_answer data_;
};

// Which scenes are stepped together, and what moves in each.
class batch {
public:
    // Where the positions of each part are: [count][3] of its format, of a rigid one
    // double[12].
    using places = view<const void *const>;

    batch(batch &&other) noexcept
        : link_(std::move(other.link_)), made_(std::exchange(other.made_, nullptr)),
          part_count_(other.part_count_)
    {
    }
    batch &operator=(batch &&other) noexcept
    {
        if (this != &other) {
            reset();
            link_ = std::move(other.link_);
            made_ = std::exchange(other.made_, nullptr);
            part_count_ = other.part_count_;
        }
        return *this;
    }
    batch(const batch &) = delete;
    batch &operator=(const batch &) = delete;
    ~batch() { reset(); }

    // For the calls of pccd_batch.h that this header does not have.
    pccd_batch *get() const noexcept { return made_; }
    std::uint32_t scene_count() const noexcept { return pccd_batch_scenes(made_); }

    // Submit and wait. x0 is needed if a part has both ends; places of others are not
    // looked at there.
    result<batch_answer> try_step(places x1, places x0 = {},
                                  const pccd_step_settings &settings = {})
    {
        batch_answer answer(link_);
        if (!is_whole(x1, x0)) {
            return bad_places();
        }
        const int status = pccd_batch_step(made_, x0.empty() ? nullptr : x0.data(),
                                           x1.data(), &settings, &answer.data_);
        if (status != PCCD_OK) {
            return detail::last(link_, status);
        }
        return answer;
    }
    batch_answer step(places x1, places x0 = {}, const pccd_step_settings &settings = {})
    {
        return try_step(x1, x0, settings).value();
    }
    // Submit; take the answer by client::wait_batch. Returns the first scene's step.
    result<std::uint64_t> try_submit(places x1, places x0 = {},
                                     const pccd_step_settings &settings = {})
    {
        std::uint64_t step = 0;
        if (!is_whole(x1, x0)) {
            return bad_places();
        }
        const int status = pccd_batch_submit(made_, x0.empty() ? nullptr : x0.data(),
                                             x1.data(), &settings, &step);
        if (status != PCCD_OK) {
            return detail::last(link_, status);
        }
        return step;
    }
    std::uint64_t submit(places x1, places x0 = {},
                         const pccd_step_settings &settings = {})
    {
        return try_submit(x1, x0, settings).value();
    }

private:
    friend class client;
    batch(detail::shared_client link, pccd_batch *made, std::size_t part_count)
        : link_(std::move(link)), made_(made), part_count_(part_count)
    {
    }
    bool is_whole(places x1, places x0) const
    {
        return x1.size() == part_count_ && (x0.empty() || x0.size() == part_count_);
    }
    static error bad_places()
    {
        return error(PCCD_E_INVAL, "each part of the batch needs a place of positions");
    }
    void reset() noexcept
    {
        pccd_batch_destroy(std::exchange(made_, nullptr));
        link_.reset();
    }

    detail::shared_client link_;
    pccd_batch *made_;
    std::size_t part_count_;
};

// ---- clients --------------------------------------------------------------------------

// A connection to a daemon, which is started if none is running.
class client {
public:
    static result<client> try_connect(const pccd_options &options = pccd::options())
    {
        pccd_client *made = nullptr;
        const int status = pccd_connect(&options, &made);
        if (status != PCCD_OK) {
            return error(status, pccd_error_text(nullptr));
        }
        return client(made);
    }
    explicit client(const pccd_options &options = pccd::options())
        : client(try_connect(options).value())
    {
    }
    // "direct:" to compute in this process.
    explicit client(const char *url) : client(at(url)) {}

    // For the calls of pccd.h that this header does not have.
    pccd_client *get() const noexcept { return link_.get(); }
    const char *url() const noexcept { return pccd_url(get()); }
    int fd() const noexcept { return pccd_fd(get()); }

    result<scene> try_make_scene(const pccd_scene_settings *settings = nullptr)
    {
        std::uint32_t id = 0;
        const int status = pccd_scene_create(get(), settings, &id);
        if (status != PCCD_OK) {
            return detail::last(link_, status);
        }
        return scene(link_, id);
    }
    scene make_scene(const pccd_scene_settings *settings = nullptr)
    {
        return try_make_scene(settings).value();
    }

    result<mesh> try_make_mesh(const shape &shape)
    {
        std::uint32_t id = 0;
        pccd_mesh_info info{};
        result<done> put = mesh::put(link_, shape, &id, &info);
        if (!put) {
            return put.why();
        }
        mesh made(link_, id);
        made.info_ = info;
        made.vertex_count_ = std::make_shared<std::uint32_t>(info.vertex_count);
        return made;
    }
    mesh make_mesh(const shape &shape) { return try_make_mesh(shape).value(); }

    // Wait for the answer to a step; timeout_ms < 0: the client's default.
    result<answer> try_wait(std::uint64_t step, int timeout_ms = -1)
    {
        answer answer(link_);
        const int status = pccd_wait(get(), step, timeout_ms, &answer.data_);
        if (status != PCCD_OK) {
            return detail::last(link_, status);
        }
        return answer;
    }
    answer wait(std::uint64_t step, int timeout_ms = -1)
    {
        return try_wait(step, timeout_ms).value();
    }
    // The oldest finished answer, without waiting: PCCD_E_AGAIN if there is none. A step
    // that failed is an answer too, with data().status.
    result<answer> try_poll()
    {
        answer answer(link_);
        const int status = pccd_poll(get(), &answer.data_);
        if (status != PCCD_OK) {
            return detail::last(link_, status);
        }
        return answer;
    }

    // The parts of one scene stand one behind the other.
    result<batch> try_make_batch(view<const pccd_batch_part> parts)
    {
        pccd_batch *made = nullptr;
        const int status = pccd_batch_create(
            get(), parts.data(), static_cast<std::uint32_t>(parts.size()), &made);
        if (status != PCCD_OK) {
            return detail::last(link_, status);
        }
        return batch(link_, made, parts.size());
    }
    batch make_batch(view<const pccd_batch_part> parts)
    {
        return try_make_batch(parts).value();
    }
    // As wait and try_poll, for batches; each leaves the answers of the others alone.
    result<batch_answer> try_wait_batch(std::uint64_t step, int timeout_ms = -1)
    {
        batch_answer answer(link_);
        const int status = pccd_batch_wait(get(), step, timeout_ms, &answer.data_);
        if (status != PCCD_OK) {
            return detail::last(link_, status);
        }
        return answer;
    }
    batch_answer wait_batch(std::uint64_t step, int timeout_ms = -1)
    {
        return try_wait_batch(step, timeout_ms).value();
    }
    result<batch_answer> try_poll_batch()
    {
        batch_answer answer(link_);
        const int status = pccd_batch_poll(get(), &answer.data_);
        if (status != PCCD_OK) {
            return detail::last(link_, status);
        }
        return answer;
    }

private:
    explicit client(pccd_client *made) : link_(made, pccd_close) {}
    static client at(const char *url)
    {
        pccd::options options;
        options.url = url;
        return try_connect(options).value();
    }

    detail::shared_client link_;
};

} // namespace pccd

#endif
