/* pccd_ipc.hpp - pccd for programs that use ipc-toolkit: its broad phase, and how far a
 * step may go.
 *
 * Room:     client/ipc; installed. May include: pccd.hpp, ipc-toolkit 1.6, the standard
 *           library. C++17; nothing is compiled until a program includes it.
 * Does:     give ipc-toolkit the candidates that it asks its broad phases for, from
 *           hierarchies that stay between calls; tell which part of a step has no
 *           collision; tell whether a mesh passes through itself.
 * Does not: compute barriers, or decide what is active. That is by ipc-toolkit's own
 *           arithmetic and its own rule for near-parallel edges.
 * Threads:  an object belongs to one thread at a time; pccd has threads of its own.
 *
 * One class is all of it, to be read from top to bottom.
 *
 *     pccd::ipc_broad_phase broad_phase;                      // once for a mesh
 *     broad_phase.build_collisions(collisions, mesh, x, dhat, dmin);
 *     double a = broad_phase.collision_free_stepsize(mesh, x, x1, dmin);
 *
 * As long as the edges and faces stay the same, only positions travel. They are doubles
 * on both sides and are not rounded.
 */
#ifndef PCCD_IPC_HPP
#define PCCD_IPC_HPP

#include <pccd.hpp>

#include <ipc/broad_phase/lbvh.hpp>
#include <ipc/candidates/candidates.hpp>
#include <ipc/collisions/normal/normal_collisions.hpp>
#include <ipc/distance/edge_edge.hpp>
#include <ipc/distance/edge_edge_mollifier.hpp>
#include <ipc/distance/point_triangle.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace pccd {

class ipc_broad_phase final : public ::ipc::BroadPhase {
public:
    using matrix = Eigen::ConstRef<Eigen::MatrixXd>;
    using table = Eigen::ConstRef<Eigen::MatrixXi>;

    // In this process; ipc_broad_phase(pccd::client()) asks the user's daemon.
    ipc_broad_phase() : ipc_broad_phase(client("direct:")) {}
    explicit ipc_broad_phase(client where) : state_(new state(std::move(where))) {}

    // Threads of a question, at most; 0: pccd decides. The answers never depend on it.
    std::uint32_t threads = 0;
    // Which part of the way to the first contact a step goes, so that a gap is left for
    // the barrier; 0 .. 1. 0.9 is that of ipc::AdditiveCCD; 1: up to the contact.
    double conservative_rescaling = 0.9;

    std::string name() const override { return "pccd"; }

    // ---- what ipc-toolkit calls ---------------------------------------------------

    using ::ipc::BroadPhase::build;

    // All pairs that are no farther apart than twice the radius can be asked for then.
    // That is every pair which boxes that are inflated by the radius would give and which
    // is within that distance. The distance is made longer by so much that no pair is
    // missing which ipc-toolkit's rounding takes for nearer than it is (see `slack`).
    void build(matrix vertices, table edges, table faces, const double radius) override
    {
        begin(vertices, edges, faces, radius);
        is_moving_ = false;
    }
    // All pairs that come so near in the step, and others.
    void build(matrix vertices_t0, matrix vertices_t1, table edges, table faces,
               const double radius) override
    {
        begin(vertices_t0, edges, faces, radius);
        x1_ = vertices_t1;
        is_moving_ = true;
    }
    // Boxes alone say nothing of where things are: ipc-toolkit's LBVH answers.
    void build(const ::ipc::AABBs &boxes, table edges, table faces,
               const std::uint8_t dimension) override
    {
        clear();
        dim = dimension;
        lbvh_.build(boxes, edges, faces, dimension);
        has_lbvh_ = true;
        is_boxes_ = true;
    }
    // The mesh and its hierarchies stay.
    void clear() override
    {
        ::ipc::BroadPhase::clear();
        lbvh_.clear();
        has_lbvh_ = is_boxes_ = false;
        state_->records.reset();
    }

    void detect_edge_edge_candidates(
        std::vector<::ipc::EdgeEdgeCandidate> &candidates) const override
    {
        if (!is_ours()) {
            return lbvh().detect_edge_edge_candidates(candidates);
        }
        each(PCCD_EE, candidates, [&](std::uint32_t a, std::uint32_t b) {
            const ::ipc::index_t i = state_->edge_ids[a], j = state_->edge_ids[b];
            if (i >= 0 && j >= 0 && may_meet(can_vertices_collide, ends(a), ends(b))) {
                candidates.emplace_back(std::min(i, j), std::max(i, j));
            }
        });
    }
    void detect_face_vertex_candidates(
        std::vector<::ipc::FaceVertexCandidate> &candidates) const override
    {
        if (!is_ours()) {
            return lbvh().detect_face_vertex_candidates(candidates);
        }
        each(PCCD_VF, candidates, [&](std::uint32_t v, std::uint32_t f) {
            if (may_meet(can_vertices_collide, few{{v}, 1}, corners(f))) {
                candidates.emplace_back(static_cast<::ipc::index_t>(f),
                                        static_cast<::ipc::index_t>(v));
            }
        });
    }
    // These are for two dimensions, loose points and tests for intersection.
    void detect_vertex_vertex_candidates(
        std::vector<::ipc::VertexVertexCandidate> &candidates) const override
    {
        lbvh().detect_vertex_vertex_candidates(candidates);
    }
    void detect_edge_vertex_candidates(
        std::vector<::ipc::EdgeVertexCandidate> &candidates) const override
    {
        lbvh().detect_edge_vertex_candidates(candidates);
    }
    void detect_edge_face_candidates(
        std::vector<::ipc::EdgeFaceCandidate> &candidates) const override
    {
        lbvh().detect_edge_face_candidates(candidates);
    }
    void detect_face_face_candidates(
        std::vector<::ipc::FaceFaceCandidate> &candidates) const override
    {
        lbvh().detect_face_face_candidates(candidates);
    }

    // ---- what takes the place of ipc-toolkit's functions --------------------------

    // The same set as to.build(mesh, vertices, dhat, dmin, this) makes, by ipc-toolkit's
    // own distances and rule for near-parallel edges, but what belongs together is
    // sorted, not looked up in tables. For sets of the type IPC of meshes without loose
    // vertices and without planes; for others it calls that.
    void build_collisions(::ipc::NormalCollisions &to, const ::ipc::CollisionMesh &mesh,
                          matrix vertices, const double dhat, const double dmin = 0)
    {
        if (to.collision_set_type() != ::ipc::NormalCollisions::CollisionSetType::IPC ||
            to.enable_shape_derivatives() || mesh.num_codim_vertices() > 0 ||
            !mesh.planes.empty() || vertices.cols() != 3 || mesh.num_edges() == 0) {
            to.build(mesh, vertices, dhat, dmin, this);
            return;
        }
        can_vertices_collide = mesh.can_collide;
        build(vertices, mesh.edges(), mesh.faces(), .5 * (dhat + dmin));
        if (!state_->records) {
            ask();
        }
        to.clear();
        merging all{mesh, to, x0_, (dhat + dmin) * (dhat + dmin), dmin, {}, {}};
        walk(PCCD_VF, [&](std::uint32_t v, std::uint32_t f) {
            if (may_meet(can_vertices_collide, few{{v}, 1}, corners(f))) {
                all.add(static_cast<int>(v), corners(f), static_cast<int>(f));
            }
        });
        walk(PCCD_EE, [&](std::uint32_t a, std::uint32_t b) {
            const ::ipc::index_t i = state_->edge_ids[a], j = state_->edge_ids[b];
            if (i >= 0 && j >= 0 && may_meet(can_vertices_collide, ends(a), ends(b))) {
                all.add(std::min(i, j), std::max(i, j));
            }
        });
        all.finish();
    }

    // A part a of the way from vertices_t0 to vertices_t1: on all of [0, a] every pair is
    // farther apart than min_distance, in the exact sense, and so it is at each
    // x0 + s * (x1 - x0) with 0 <= s <= a that is computed in doubles: the distance is
    // made longer by what rounding can take away (see `slack`). 0 .. 1; 1 if nothing
    // meets; 0 if something is too near to begin with. Pairs that mesh.can_collide leaves
    // out do not count; planes of the mesh do.
    double collision_free_stepsize(const ::ipc::CollisionMesh &mesh, matrix vertices_t0,
                                   matrix vertices_t1, const double min_distance = 0)
    {
        const double safe = safe_part(mesh, vertices_t0, vertices_t1, min_distance);
        return safe < 1 ? conservative_rescaling * safe : 1;
    }
    bool is_step_collision_free(const ::ipc::CollisionMesh &mesh, matrix vertices_t0,
                                matrix vertices_t1, const double min_distance = 0)
    {
        return safe_part(mesh, vertices_t0, vertices_t1, min_distance) == 1;
    }
    // Whether an edge passes through the inside of a face that it shares no vertex with,
    // decided exactly. What merely touches does not intersect.
    bool has_intersections(const ::ipc::CollisionMesh &mesh, matrix vertices)
    {
        clear();
        register_mesh(vertices, mesh.edges(), mesh.faces());
        x0_ = vertices;
        const pccd_motion motion = to(*state_->body, rows(x0_));
        near_settings settings(PCCD_NEAR_CROSSINGS);
        settings.threads = threads;
        state_->records.emplace(state_->world->near(settings, {&motion, 1}));
        check_whole();
        bool is_crossed = false;
        walk(PCCD_EF, [&](std::uint32_t e, std::uint32_t f) {
            is_crossed |= may_meet(mesh.can_collide, ends(e), corners(f));
        });
        state_->records.reset();
        return is_crossed;
    }

    // By what a distance of d is made longer where coordinates are at most `most`. With
    // u = 2^-53, x0 + s (x1 - x0) is off by at most 5 u most in each coordinate, two
    // points together by 2 sqrt(3) 5 u most < 18 u most; differences of coordinates in
    // ipc-toolkit's distances by less. 128 u most is 7 times that. 2^-40 of d is for the
    // rounding of its squares and products: all but needles are off by less.
    static double slack(double d, double most)
    {
        return d * std::ldexp(1, -40) + most * std::ldexp(1, -46);
    }

private:
    using row_matrix =
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    // The vertices of a feature.
    struct few {
        std::uint32_t v[3];
        int count;
    };

    // What stays between calls, and the records of the last one.
    struct state {
        explicit state(client where) : link(std::move(where)) {}
        client link;
        Eigen::MatrixXi edges, faces; // as the mesh is registered
        Eigen::Index vertex_count = 0;
        std::optional<mesh> shape;
        std::optional<scene> world;
        std::optional<object> body;
        std::vector<pccd_edge> ends;          // of pccd's edges
        std::vector<::ipc::index_t> edge_ids; // ipc-toolkit's number of each; -1: none
        std::optional<answer> records;        // a page
    };

    void begin(matrix vertices, table edges, table faces, double radius)
    {
        clear();
        dim = static_cast<std::uint8_t>(vertices.cols());
        x0_ = vertices;
        edges_ = edges;
        faces_ = faces;
        radius_ = radius;
    }
    bool is_ours() const
    {
        return !is_boxes_ && dim == 3 && edges_.rows() + faces_.rows() > 0;
    }
    const ::ipc::LBVH &lbvh() const
    {
        lbvh_.can_vertices_collide = can_vertices_collide;
        if (!has_lbvh_ && is_moving_) {
            lbvh_.build(x0_, x1_, edges_, faces_, radius_);
        } else if (!has_lbvh_) {
            lbvh_.build(x0_, edges_, faces_, radius_);
        }
        has_lbvh_ = true;
        return lbvh_;
    }

    static positions rows(const row_matrix &x)
    {
        return positions(x.data(), static_cast<std::uint32_t>(x.rows()));
    }
    static double most(const row_matrix &x) { return x.cwiseAbs().maxCoeff(); }

    // ---- the mesh -----------------------------------------------------------------

    static std::vector<std::uint32_t> flat(table from)
    {
        std::vector<std::uint32_t> to;
        to.reserve(static_cast<std::size_t>(from.size()));
        for (Eigen::Index i = 0; i < from.rows(); i++) {
            for (Eigen::Index k = 0; k < from.cols(); k++) {
                to.push_back(static_cast<std::uint32_t>(from(i, k)));
            }
        }
        return to;
    }
    static bool is_same(const Eigen::MatrixXi &a, table b)
    {
        return a.rows() == b.rows() && a.cols() == b.cols() && a == b;
    }

    // ipc-toolkit's numbers of pccd's edges, which go by (b, a), a < b.
    void number_edges(table edges) const
    {
        struct numbered {
            std::uint32_t b, a;
            ::ipc::index_t id;
            bool operator<(const numbered &o) const
            {
                return b != o.b ? b < o.b : a < o.a;
            }
        };
        std::vector<numbered> theirs;
        for (Eigen::Index i = 0; i < edges.rows(); i++) {
            const int one = edges(i, 0), other = edges(i, 1);
            theirs.push_back({static_cast<std::uint32_t>(std::max(one, other)),
                              static_cast<std::uint32_t>(std::min(one, other)),
                              static_cast<::ipc::index_t>(i)});
        }
        std::sort(theirs.begin(), theirs.end());
        std::size_t named = 0;
        state_->ends = state_->shape->edges();
        state_->edge_ids.clear();
        for (const pccd_edge &edge : state_->ends) {
            const numbered wanted = {edge.b, edge.a, 0};
            const auto [from, to] =
                std::equal_range(theirs.begin(), theirs.end(), wanted);
            state_->edge_ids.push_back(from == to ? -1 : from->id);
            named += from != to;
        }
        if (named != theirs.size() || state_->shape->info().duplicate_count > 0) {
            forget();
            fail(error(PCCD_E_INVAL, "an edge or a face of the mesh is there twice, or "
                                     "an edge has one end only"));
        }
    }
    void forget() const
    {
        state_->records.reset();
        state_->body.reset();
        state_->world.reset();
        state_->shape.reset();
    }
    void register_mesh(matrix x, table edges, table faces) const
    {
        if (x.cols() != 3) {
            fail(error(PCCD_E_INVAL, "only meshes in three dimensions are served"));
        }
        if (state_->body && state_->vertex_count == x.rows() &&
            is_same(state_->edges, edges) && is_same(state_->faces, faces)) {
            return;
        }
        forget();
        // Loose vertices are named, or pccd would not test them.
        std::vector<bool> is_named(static_cast<std::size_t>(x.rows()));
        const std::vector<std::uint32_t> e = flat(edges), f = flat(faces);
        std::vector<std::uint32_t> points;
        for (const std::uint32_t v : e) {
            is_named[v] = true;
        }
        for (const std::uint32_t v : f) {
            is_named[v] = true;
        }
        for (std::uint32_t v = 0; v < is_named.size(); v++) {
            if (!is_named[v]) {
                points.push_back(v);
            }
        }
        const row_matrix placed = x;
        shape what;
        what.x = rows(placed);
        what.triangles = indices<3>(f);
        what.edges = indices<2>(e);
        what.points = indices<1>(points);
        state_->shape.emplace(state_->link.make_mesh(what));
        number_edges(edges);
        state_->world.emplace(state_->link.make_scene());
        state_->body.emplace(state_->world->add(*state_->shape));
        state_->vertex_count = x.rows();
        state_->edges = edges;
        state_->faces = faces;
    }

    // ---- records ------------------------------------------------------------------

    few ends(std::uint32_t edge) const
    {
        return {{state_->ends[edge].a, state_->ends[edge].b}, 2};
    }
    few corners(std::uint32_t face) const
    {
        few c{{}, 3};
        for (int k = 0; k < 3; k++) {
            c.v[k] = static_cast<std::uint32_t>(state_->faces(face, k));
        }
        return c;
    }
    // As in ipc-toolkit: two features may meet if some vertices of them may.
    static bool may_meet(const ::ipc::CollisionFilter &filter, const few &a, const few &b)
    {
        for (int i = 0; i < a.count; i++) {
            for (int k = 0; k < b.count; k++) {
                if (filter(a.v[i], b.v[k])) {
                    return true;
                }
            }
        }
        return false;
    }

    // An answer that is cut short proves nothing. Further pages are no cut.
    void check_whole() const
    {
        const pccd_incomplete cut = (*state_->records)->incomplete;
        if (cut != PCCD_COMPLETE && cut != PCCD_INCOMPLETE_RESULT_FULL) {
            state_->records.reset();
            fail(error(PCCD_E_LIMIT, "more pairs than pccd keeps"));
        }
    }
    void ask() const
    {
        register_mesh(x0_, edges_, faces_);
        if (is_moving_) {
            const pccd_motion motion = between(*state_->body, rows(x0_), rows(x1_));
            step_settings settings;
            settings.mode = PCCD_MODE_PAIRS;
            settings.threads = threads;
            settings.separation =
                2 * radius_ + slack(2 * radius_, std::max(most(x0_), most(x1_)));
            state_->records.emplace(state_->world->step({&motion, 1}, settings));
        } else {
            const pccd_motion motion = to(*state_->body, rows(x0_));
            near_settings settings(PCCD_NEAR_PAIRS, 2 * radius_);
            settings.threads = threads;
            settings.distance += slack(2 * radius_, most(x0_));
            state_->records.emplace(state_->world->near(settings, {&motion, 1}));
        }
        check_whole();
    }
    // All candidates of a kind.
    template <class List, class Take>
    void each(std::uint32_t kind, List &list, Take take) const
    {
        if (!state_->records) {
            ask();
        }
        list.reserve(list.size() + (*state_->records)->counts[kind]);
        walk(kind, take);
    }
    // Call take(feature_a, feature_b) for each record of a kind, page by page.
    template <class Take> void walk(std::uint32_t kind, Take take) const
    {
        answer &page = *state_->records;
        std::uint64_t at = 0;
        for (std::uint32_t k = 0; k < kind; k++) {
            at += page->counts[k];
        }
        for (const std::uint64_t end = at + page->counts[kind]; at < end;) {
            if (at < page->first || at >= page->first + page->count) {
                page = state_->world->fetch(page, at);
            }
            const std::uint64_t first = page->first;
            const std::uint64_t until = std::min(end, first + page->count);
            for (; at < until; at++) {
                const std::size_t i = static_cast<std::size_t>(at - first);
                if (page->pairs) {
                    take(page->pairs[i].feature_a, page->pairs[i].feature_b);
                } else if (page->near) {
                    take(page->near[i].feature_a, page->near[i].feature_b);
                } else {
                    take(page->contacts[i].feature_a, page->contacts[i].feature_b);
                }
            }
        }
    }

    // ---- normal collisions --------------------------------------------------------

    // Makes a set of pairs, as ipc::NormalCollisionsBuilder does.
    struct merging {
        struct part {
            std::uint64_t key; // the two features
            double weight;
            bool operator<(const part &o) const { return key < o.key; }
        };
        using point = Eigen::Vector3d;

        const ::ipc::CollisionMesh &mesh;
        ::ipc::NormalCollisions &to;
        const row_matrix &x;
        double active; // squared distances below it
        double dmin;
        std::vector<part> vv, ev;

        point at(int i) const { return point(x(i, 0), x(i, 1), x(i, 2)); }
        point rest(int i) const { return mesh.rest_positions().row(i).transpose(); }
        void add_vv(int a, int b, double weight)
        {
            vv.push_back({key_of(std::min(a, b), std::max(a, b)), weight});
        }
        static std::uint64_t key_of(int a, int b)
        {
            return std::uint64_t(std::uint32_t(a)) << 32 | std::uint32_t(b);
        }

        void add(int v, const few &corner, int f)
        {
            const int c[3] = {int(corner.v[0]), int(corner.v[1]), int(corner.v[2])};
            const point p = at(v), p0 = at(c[0]), p1 = at(c[1]), p2 = at(c[2]);
            const auto type = ::ipc::point_triangle_distance_type(p, p0, p1, p2);
            if (::ipc::point_triangle_distance(p, p0, p1, p2, type) >= active) {
                return;
            }
            const double weight =
                to.use_area_weighting() ? .25 * mesh.vertex_area(std::size_t(v)) : 1;
            const int number = static_cast<int>(type); // corners, edges, inside
            if (number < 3) {
                add_vv(v, c[number], weight);
            } else if (number < 6) {
                ev.push_back({key_of(mesh.faces_to_edges()(f, number - 3), v), weight});
            } else {
                to.fv_collisions.emplace_back(f, v, weight, none());
                to.fv_collisions.back().dmin = dmin;
            }
        }
        void add(int a, int b)
        {
            const Eigen::MatrixXi &e = mesh.edges();
            const int i[4] = {e(a, 0), e(a, 1), e(b, 0), e(b, 1)};
            const point p0 = at(i[0]), p1 = at(i[1]), p2 = at(i[2]), p3 = at(i[3]);
            const auto type = ::ipc::edge_edge_distance_type(p0, p1, p2, p3);
            if (::ipc::edge_edge_distance(p0, p1, p2, p3, type) >= active) {
                return;
            }
            const double eps = ::ipc::edge_edge_mollifier_threshold(
                rest(i[0]), rest(i[1]), rest(i[2]), rest(i[3]));
            const double weight = to.use_area_weighting()
                                      ? .25 * (mesh.edge_area(std::size_t(a)) +
                                               mesh.edge_area(std::size_t(b)))
                                      : 1;
            const int number =
                static_cast<int>(type); // pairs of ends, an end and an edge
            if (number == 8 || ::ipc::edge_edge_cross_squarednorm(p0, p1, p2, p3) < eps) {
                to.ee_collisions.emplace_back(a, b, eps, weight, none(), type);
                to.ee_collisions.back().dmin = dmin;
            } else if (number < 4) {
                add_vv(i[number / 2], i[2 + number % 2], weight);
            } else if (number < 6) {
                ev.push_back({key_of(a, i[number - 2]), weight});
            } else {
                ev.push_back({key_of(b, i[number - 6]), weight});
            }
        }
        static const Eigen::SparseVector<double> &none()
        {
            static const Eigen::SparseVector<double> empty;
            return empty;
        }
        template <class List> void put(std::vector<part> &parts, List &list) const
        {
            std::sort(parts.begin(), parts.end());
            for (std::size_t i = 0, next; i < parts.size(); i = next) {
                double weight = 0;
                for (next = i; next < parts.size() && parts[next].key == parts[i].key;
                     next++) {
                    weight += parts[next].weight;
                }
                list.emplace_back(int(parts[i].key >> 32),
                                  int(std::uint32_t(parts[i].key)), weight, none());
                list.back().dmin = dmin;
            }
        }
        void finish()
        {
            put(vv, to.vv_collisions);
            put(ev, to.ev_collisions);
        }
    };

    // ---- how far ------------------------------------------------------------------

    bool may_meet(const ::ipc::CollisionFilter &filter, const pccd_contact &c) const
    {
        return may_meet(filter,
                        c.kind == PCCD_EE ? ends(c.feature_a) : few{{c.feature_a}, 1},
                        c.kind == PCCD_VF   ? corners(c.feature_b)
                        : c.kind == PCCD_VV ? few{{c.feature_b}, 1}
                                            : ends(c.feature_b));
    }
    // The double below the toi of the first contact that the filter lets meet; 1 without
    // any. *has_others: there are contacts, but the filter lets none of them meet.
    double before_first(const ::ipc::CollisionFilter &filter, const pccd_motion &motion,
                        const step_settings &settings, bool *has_others)
    {
        double toi = 2;
        answer page = state_->world->step(motion, settings);
        *has_others = page->total > 0;
        for (;;) {
            if (page->incomplete != PCCD_COMPLETE &&
                page->incomplete != PCCD_INCOMPLETE_RESULT_FULL) {
                fail(error(PCCD_E_LIMIT, "more contacts than pccd keeps"));
            }
            for (const pccd_contact &contact : page.contacts()) {
                if (contact.toi < toi && may_meet(filter, contact)) {
                    toi = contact.toi;
                }
            }
            if (!page.has_more()) {
                break;
            }
            page = state_->world->next(page);
        }
        *has_others = *has_others && toi > 1;
        return toi > 1 ? 1 : std::max(0.0, std::nextafter(toi, -1.0));
    }
    // On [0, the part] each vertex is farther than `distance` in front of all planes.
    static double before_planes(const ::ipc::CollisionMesh &mesh, matrix x0, matrix x1,
                                double distance)
    {
        double part = 1;
        for (const auto &plane : mesh.planes) {
            for (Eigen::Index i = 0; i < x0.rows(); i++) {
                const double d0 = plane.signedDistance(x0.row(i).transpose()) - distance;
                const double d1 = plane.signedDistance(x1.row(i).transpose()) - distance;
                if (d0 <= 0) {
                    return 0;
                }
                if (d1 <= 0) { // less by 2^-50 of itself than what rounding can add
                    part = std::min(part, d0 / (d0 - d1) * (1 - std::ldexp(1, -50)));
                }
            }
        }
        return part;
    }
    double safe_part(const ::ipc::CollisionMesh &mesh, matrix vertices_t0,
                     matrix vertices_t1, double min_distance)
    {
        clear();
        if (mesh.num_vertices() == 0) {
            return 1;
        }
        register_mesh(vertices_t0, mesh.edges(), mesh.faces());
        x0_ = vertices_t0;
        x1_ = vertices_t1;
        const pccd_motion motion = between(*state_->body, rows(x0_), rows(x1_));
        step_settings settings;
        settings.mode = PCCD_MODE_FIRST;
        settings.threads = threads;
        settings.separation =
            min_distance + slack(min_distance, std::max(most(x0_), most(x1_)));
        bool has_others = false;
        double part = before_first(mesh.can_collide, motion, settings, &has_others);
        if (has_others) { // those that come first do not count
            settings.mode = PCCD_MODE_ALL;
            part = before_first(mesh.can_collide, motion, settings, &has_others);
        }
        return std::min(
            part, before_planes(mesh, vertices_t0, vertices_t1, settings.separation));
    }

    std::unique_ptr<state> state_;
    row_matrix x0_, x1_;
    Eigen::MatrixXi edges_, faces_;
    double radius_ = 0;
    bool is_moving_ = false, is_boxes_ = false;
    mutable ::ipc::LBVH lbvh_; // for what pccd is not asked
    mutable bool has_lbvh_ = false;
};

} // namespace pccd

#endif
