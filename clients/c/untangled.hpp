// C++17 over untangled.h: handles that close themselves, errors as exceptions. Header only; link the same library.
//
// A session may be used from any thread, by one at a time. Destroy what it lends (Frame, Correction) before the
// session.
#ifndef UNTANGLED_HPP
#define UNTANGLED_HPP

#include "untangled.h"

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace untangled {

/// What went wrong: a code for programs, a message for people.
class Error : public std::runtime_error {
public:
    explicit Error(untangled_error code) : std::runtime_error(untangled_last_error()), code_(code) {}
    untangled_error code() const noexcept { return code_; }
    /// Whether the simulation should go on without help for this step, and try again with the next one.
    bool transient() const noexcept { return untangled_is_transient(code_); }

private:
    untangled_error code_;
};

inline void check(untangled_error code) {
    if (code != UNTANGLED_OK) {
        throw Error(code);
    }
}

/// A view of elements that another object owns.
template <class T> class Span {
public:
    Span() = default;
    Span(T *data, std::size_t size) : data_(data), size_(size) {}
    T *data() const noexcept { return data_; }
    std::size_t size() const noexcept { return size_; }
    T *begin() const noexcept { return data_; }
    T *end() const noexcept { return data_ + size_; }
    T &operator[](std::size_t index) const noexcept { return data_[index]; }

private:
    T *data_ = nullptr;
    std::size_t size_ = 0;
};

/// Limits of a call that waits.
using Duration = std::chrono::microseconds;

inline std::uint64_t microseconds(Duration duration) {
    return duration.count() < 0 ? 0 : static_cast<std::uint64_t>(duration.count());
}

/// A cloth and what is asked for. Only `num_vertices` and `triangles` are required.
struct Cloth {
    std::size_t num_vertices = 0;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    /// Texture coordinates, and for each triangle those of its corners.
    std::vector<std::array<double, 2>> uv_coordinates;
    std::vector<std::array<std::uint32_t, 3>> uv_corners;
    /// Unstrained positions in metres; empty or `num_vertices`.
    std::vector<std::array<double, 3>> rest_positions_m;
    /// Kilograms; empty or `num_vertices`. Needed for forces.
    std::vector<double> masses_kg;
    std::vector<std::uint32_t> pins;
    /// From the body outwards; empty or `num_vertices`.
    std::vector<std::uint32_t> layers;
    /// Vertices of bodies, which the host alone moves: see `untangled_register_with_body`.
    std::vector<std::uint32_t> body;
    untangled_precision precision = UNTANGLED_F32;
    untangled_kind correction = UNTANGLED_DISPLACEMENT;
    /// Whether corrections shall bring intersection paths.
    bool paths = false;
    /// Whether frames may be repaired.
    bool repairs = false;
    /// Whether corrections shall list only the vertices that have a value or a flag: see `Correction::entries`.
    bool sparse = false;
    /// Whether corrections shall have labels, for `Contacts`; makes them sparse as well.
    bool labels = false;
    /// Whether vertices with exactly one place in `rest_positions_m` are one along seams: see `UNTANGLED_WELD`.
    bool weld = false;
    /// A JSON object; empty for the daemon's defaults.
    std::string settings_json;
};

/// Positions of the next frame, in shared memory: write all, then send. Left unsent, it is abandoned.
template <class Real> class Frame {
public:
    Frame(untangled_session session, std::array<Real, 3> *data, std::size_t size)
        : session_(session), positions_(data, size) {}
    Frame(Frame &&other) noexcept : session_(other.session_), positions_(std::exchange(other.positions_, {})) {}
    Frame &operator=(Frame &&) = delete;
    ~Frame() {
        if (positions_.data() != nullptr) {
            untangled_abandon_frame(session_);
        }
    }

    Span<std::array<Real, 3>> positions() const noexcept { return positions_; }

    /// Sends it, and returns its number.
    std::uint64_t send() {
        positions_ = {};
        std::uint64_t number = 0;
        check(untangled_send_frame(session_, &number));
        return number;
    }

private:
    untangled_session session_;
    Span<std::array<Real, 3>> positions_;
};

/// The correction of one frame, in shared memory. Hold at most three of a session.
class Correction {
public:
    Correction(untangled_session session, const untangled_correction &view) : session_(session), view_(view) {}
    Correction(Correction &&other) noexcept : session_(other.session_), view_(std::exchange(other.view_, {})) {}
    Correction &operator=(Correction &&other) noexcept {
        std::swap(session_, other.session_);
        std::swap(view_, other.view_);
        return *this;
    }
    ~Correction() {
        if (view_.token != 0) {
            untangled_release(session_, &view_);
        }
    }

    /// Value and flags of each vertex.
    Span<const untangled_vertex> vertices() const noexcept { return {view_.vertices, view_.num_vertices}; }
    /// The vertices that have a value or a flag other than pinned, and nothing of a correction that did not come
    /// sparse: see `Session::is_sparse`.
    Span<const untangled_entry> entries() const {
        const untangled_sparse_view list = sparse();
        return {list.entries, list.num_entries};
    }
    /// Labels, for `Contacts`; empty where they were not asked for, or the daemon is too old.
    Span<const untangled_label> labels() const {
        const untangled_sparse_view list = sparse();
        return {list.labels, list.num_labels};
    }
    /// Intersection paths; empty where they were not asked for.
    Span<const untangled_path> paths() const noexcept { return {view_.paths, view_.num_paths}; }
    /// Points of one path; empty where the record points outside of the points that were received.
    Span<const untangled_path_point> points(const untangled_path &path) const noexcept {
        const std::size_t end = std::size_t(path.first_point) + path.num_points;
        if (end > view_.num_path_points) {
            return {};
        }
        return {view_.path_points + path.first_point, path.num_points};
    }
    /// Counts, times, and the force and torque left over.
    const untangled_correction &summary() const noexcept { return view_; }

private:
    untangled_sparse_view sparse() const {
        untangled_sparse_view list = {};
        check(untangled_sparse(session_, &view_, &list));
        return list;
    }

    untangled_session session_;
    untangled_correction view_;
};

/// The repair of one frame, in shared memory: the displacement of every vertex. Hold one of a session.
class Repair {
public:
    Repair(untangled_session session, const untangled_repair &view) : session_(session), view_(view) {}
    Repair(Repair &&other) noexcept : session_(other.session_), view_(std::exchange(other.view_, {})) {}
    Repair &operator=(Repair &&other) noexcept {
        std::swap(session_, other.session_);
        std::swap(view_, other.view_);
        return *this;
    }
    ~Repair() {
        if (view_.token != 0) {
            untangled_release_repair(session_, &view_);
        }
    }

    /// Whether an exact check found no crossing, and no cloth inside of a body or behind an inner layer, in what the
    /// host has after adding the displacements.
    bool certified() const noexcept { return view_.certified != 0; }
    /// Whether time was up: the displacements lead to the best state so far.
    bool truncated() const noexcept { return view_.truncated != 0; }
    /// Displacements of a session in single precision; empty in double.
    Span<const std::array<float, 3>> displacements() const noexcept {
        return span<float>(view_.displacements);
    }
    /// Displacements of a session in double precision; empty in single.
    Span<const std::array<double, 3>> displacements_f64() const noexcept {
        return span<double>(view_.displacements_f64);
    }
    /// Counts, times, and how much the cloth changes.
    const untangled_repair &summary() const noexcept { return view_; }

private:
    template <class Real> Span<const std::array<Real, 3>> span(const Real *first) const noexcept {
        if (first == nullptr) {
            return {};
        }
        return {reinterpret_cast<const std::array<Real, 3> *>(first), view_.num_vertices};
    }

    untangled_session session_;
    untangled_repair view_;
};

/// Which contacts of a cloth have to be off: those between the two sides of one tangle, by the labels of a correction.
class Contacts {
public:
    explicit Contacts(std::size_t num_vertices) { check(untangled_contacts_create(num_vertices, &contacts_)); }
    Contacts(Contacts &&other) noexcept : contacts_(std::exchange(other.contacts_, {})) {}
    Contacts &operator=(Contacts &&other) noexcept {
        std::swap(contacts_, other.contacts_);
        return *this;
    }
    ~Contacts() {
        if (contacts_.id != 0) {
            untangled_contacts_free(contacts_);
        }
    }

    /// Takes the labels of a frame in place of those before.
    void set(Span<const untangled_label> labels) {
        check(untangled_contacts_set(contacts_, labels.data(), labels.size()));
    }
    /// Writes for each contact of a vertex and a face whether it is off. All have the same length.
    void vertex_faces_off(Span<const std::uint32_t> vertices, Span<const std::array<std::uint32_t, 3>> faces,
                          Span<bool> off) const {
        check_lengths(vertices.size(), faces.size(), off.size());
        const auto corners = reinterpret_cast<const std::uint32_t *>(faces.data());
        check(untangled_vertex_faces_off(contacts_, vertices.data(), corners, off.size(), off.data()));
    }
    /// Writes for each contact of two edges whether it is off. All have the same length.
    void edge_edges_off(Span<const std::array<std::uint32_t, 2>> first,
                        Span<const std::array<std::uint32_t, 2>> second, Span<bool> off) const {
        check_lengths(first.size(), second.size(), off.size());
        const auto ends = reinterpret_cast<const std::uint32_t *>(first.data());
        const auto others = reinterpret_cast<const std::uint32_t *>(second.data());
        check(untangled_edge_edges_off(contacts_, ends, others, off.size(), off.data()));
    }
    untangled_contacts handle() const noexcept { return contacts_; }

private:
    static void check_lengths(std::size_t first, std::size_t second, std::size_t off) {
        if (first != off || second != off) {
            throw std::invalid_argument("untangled::Contacts: the two ends and the answers differ in number");
        }
    }

    untangled_contacts contacts_ = {};
};

/// One cloth that the daemon knows.
class Session {
public:
    explicit Session(untangled_session session) : session_(session), num_vertices_(untangled_num_vertices(session)) {}
    Session(Session &&other) noexcept
        : session_(std::exchange(other.session_, {})), num_vertices_(other.num_vertices_) {}
    Session &operator=(Session &&other) noexcept {
        std::swap(session_, other.session_);
        std::swap(num_vertices_, other.num_vertices_);
        return *this;
    }
    ~Session() {
        if (session_.id != 0) {
            untangled_close(session_);
        }
    }

    std::size_t num_vertices() const noexcept { return num_vertices_; }
    /// Vertices that became one with an earlier one in their place, where that was asked for.
    std::size_t num_welded_vertices() const { return untangled_num_welded_vertices(session_); }
    /// Whether corrections come sparse, as asked for: not from a daemon that is too old.
    bool is_sparse() const { return untangled_is_sparse(session_); }
    /// Whether corrections have labels, as asked for: not from a daemon that is too old.
    bool has_labels() const { return untangled_has_labels(session_); }
    /// More than once if a daemon went away.
    std::uint32_t num_registrations() const { return untangled_num_registrations(session_); }

    /// Begins a frame in single precision, in place.
    Frame<float> begin_frame(double simulated_s, double dt_s) {
        float *positions = nullptr;
        check(untangled_begin_frame(session_, simulated_s, dt_s, &positions));
        return {session_, reinterpret_cast<std::array<float, 3> *>(positions), num_vertices_};
    }
    /// Begins a frame in double precision, in place.
    Frame<double> begin_frame_f64(double simulated_s, double dt_s) {
        double *positions = nullptr;
        check(untangled_begin_frame_f64(session_, simulated_s, dt_s, &positions));
        return {session_, reinterpret_cast<std::array<double, 3> *>(positions), num_vertices_};
    }
    /// Waits for the correction of a frame: lock step.
    Correction wait(std::uint64_t frame, Duration deadline) {
        untangled_correction view = {};
        check(untangled_wait(session_, frame, microseconds(deadline), &view));
        return {session_, view};
    }
    /// The newest correction that has come since the last call, if any: free running.
    std::optional<Correction> newest() {
        untangled_correction view = {};
        const untangled_error code = untangled_newest(session_, &view);
        if (code == UNTANGLED_NOTHING_NEW) {
            return std::nullopt;
        }
        check(code);
        return Correction(session_, view);
    }
    /// Copies positions, sends them, and waits: lock step for hosts that keep their positions elsewhere.
    Correction exchange(double simulated_s, double dt_s, Span<const std::array<float, 3>> positions,
                        Duration deadline) {
        untangled_correction view = {};
        const float *data = reinterpret_cast<const float *>(positions.data());
        check(untangled_exchange(session_, simulated_s, dt_s, data, positions.size(), microseconds(deadline), &view));
        return {session_, view};
    }
    /// Whether it was registered with repairs, by a daemon that knows them.
    bool has_repairs() const noexcept { return untangled_has_repairs(session_); }
    /// Asks for a repair of the next frame that is sent; without a time the setting `repair_deadline_us` limits it.
    void ask_for_repair(Duration time = Duration::zero()) {
        check(untangled_ask_for_repair(session_, microseconds(time)));
    }
    /// The newest repair that has come since the last call, if any. It is taken as added: those of frames that were
    /// sent before are dropped.
    std::optional<Repair> poll_repair() {
        untangled_repair view = {};
        const untangled_error code = untangled_poll_repair(session_, &view);
        if (code == UNTANGLED_NOTHING_NEW) {
            return std::nullopt;
        }
        check(code);
        return Repair(session_, view);
    }
    /// Waits for the repair of a frame.
    Repair wait_repair(std::uint64_t frame, Duration deadline) {
        untangled_repair view = {};
        check(untangled_wait_repair(session_, frame, microseconds(deadline), &view));
        return {session_, view};
    }
    /// One exchange from a tangled cloth to one that is certified clean, or to the best within the deadline.
    Repair repair(double simulated_s, double dt_s, Span<const std::array<float, 3>> positions, Duration deadline) {
        untangled_repair view = {};
        const float *data = reinterpret_cast<const float *>(positions.data());
        const std::size_t size = positions.size();
        check(untangled_exchange_repair(session_, simulated_s, dt_s, data, size, microseconds(deadline), &view));
        return {session_, view};
    }
    Repair repair_f64(double simulated_s, double dt_s, Span<const std::array<double, 3>> positions,
                      Duration deadline) {
        untangled_repair view = {};
        const double *data = reinterpret_cast<const double *>(positions.data());
        const std::size_t size = positions.size();
        check(untangled_exchange_repair_f64(session_, simulated_s, dt_s, data, size, microseconds(deadline), &view));
        return {session_, view};
    }
    /// Says that the next frame is no continuation of those before, for the setting `repair` = `auto`.
    void begin_motion() { check(untangled_begin_motion(session_)); }
    /// A deadline for hosts that have no frame rate to keep: 0.2 s, and 20 microseconds for each triangle.
    Duration default_deadline() const {
        return Duration(static_cast<Duration::rep>(untangled_default_deadline_us(session_)));
    }
    /// Replaces the settings from the next frame on.
    void update_settings(const std::string &json, Duration timeout) {
        check(untangled_update_settings(session_, json.c_str(), microseconds(timeout)));
    }
    untangled_session handle() const noexcept { return session_; }

private:
    untangled_session session_;
    std::size_t num_vertices_;
};

/// A connection to a daemon. Sessions live on without it.
class Client {
public:
    /// Connects to the daemon of a domain; without one `UNTANGLED_DOMAIN`, else `default`.
    explicit Client(const std::optional<std::string> &domain = std::nullopt,
                    Duration timeout = std::chrono::seconds(5)) {
        if (untangled_abi_version() != UNTANGLED_ABI_VERSION) {
            throw std::runtime_error("the untangled library and its header are of different versions");
        }
        check(untangled_connect(domain ? domain->c_str() : nullptr, microseconds(timeout), &client_));
    }
    Client(Client &&other) noexcept : client_(std::exchange(other.client_, {})) {}
    Client &operator=(Client &&other) noexcept {
        std::swap(client_, other.client_);
        return *this;
    }
    ~Client() {
        if (client_.id != 0) {
            untangled_disconnect(client_);
        }
    }

    /// Opens a session. Lengths that don't fit the cloth are errors.
    Session open(const Cloth &cloth) {
        const auto fits = [](std::size_t size, std::size_t expected) { return size == 0 || size == expected; };
        if (!fits(cloth.rest_positions_m.size(), cloth.num_vertices) ||
            !fits(cloth.masses_kg.size(), cloth.num_vertices) || !fits(cloth.layers.size(), cloth.num_vertices) ||
            !fits(cloth.uv_corners.size(), cloth.triangles.size())) {
            throw std::invalid_argument("untangled::Cloth: an array has not one element for each vertex or triangle");
        }
        untangled_registration registration = {};
        check(untangled_registration_init(&registration));
        const auto start = [](const auto &list) { return list.empty() ? nullptr : list.front().data(); };
        registration.num_vertices = cloth.num_vertices;
        registration.triangles = start(cloth.triangles);
        registration.num_triangles = cloth.triangles.size();
        registration.uv_coordinates = start(cloth.uv_coordinates);
        registration.num_uv_coordinates = cloth.uv_coordinates.size();
        registration.uv_corners = start(cloth.uv_corners);
        registration.rest_positions_m = start(cloth.rest_positions_m);
        registration.masses_kg = cloth.masses_kg.empty() ? nullptr : cloth.masses_kg.data();
        registration.pins = cloth.pins.empty() ? nullptr : cloth.pins.data();
        registration.num_pins = cloth.pins.size();
        registration.layers = cloth.layers.empty() ? nullptr : cloth.layers.data();
        registration.precision = cloth.precision;
        registration.correction = cloth.correction;
        registration.paths = cloth.paths ? 1 : 0;
        registration.options = (cloth.sparse ? UNTANGLED_SPARSE : 0) | (cloth.labels ? UNTANGLED_LABELS : 0) |
                               (cloth.repairs ? UNTANGLED_REPAIRS : 0) | (cloth.weld ? UNTANGLED_WELD : 0);
        registration.settings_json = cloth.settings_json.empty() ? nullptr : cloth.settings_json.c_str();
        untangled_session session = {};
        check(untangled_register_with_body(client_, &registration, cloth.body.empty() ? nullptr : cloth.body.data(),
                                           cloth.body.size(), &session));
        return Session(session);
    }
    /// The daemon's state as a JSON document.
    std::string status() {
        std::size_t length = 0;
        check(untangled_status(client_, nullptr, 0, &length));
        // It may have grown meanwhile.
        std::string text(length + 4096, '\0');
        check(untangled_status(client_, text.data(), text.size(), &length));
        text.resize(length);
        return text;
    }

private:
    untangled_client client_ = {};
};

} // namespace untangled

#endif
