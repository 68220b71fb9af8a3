// The C++ wrapper: handles close themselves, errors are exceptions. Arguments: the domain of a running daemon.
#include <cstdio>
#include <cstdlib>
#include <type_traits>

#include "untangled.hpp"

#define EXPECT(condition)                                                                                              \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            std::fprintf(stderr, "line %d: %s\n", __LINE__, #condition);                                               \
            std::exit(1);                                                                                              \
        }                                                                                                              \
    } while (0)

static_assert(!std::is_copy_constructible_v<untangled::Client> && !std::is_copy_constructible_v<untangled::Session> &&
              !std::is_copy_constructible_v<untangled::Correction> &&
               !std::is_copy_constructible_v<untangled::Frame<float>>);

template <class Call> static untangled_error error_of(Call call) {
    try {
        call();
    } catch (const untangled::Error &error) {
        EXPECT(error.what()[0] != '\0');
        return error.code();
    }
    return UNTANGLED_OK;
}

int main(int argc, char **argv) {
    using namespace std::chrono_literals;
    EXPECT(argc == 2);
    EXPECT(error_of([] { untangled::Client("test-nobody-home", 1ms); }) == UNTANGLED_NO_DAEMON);
    untangled::Client client(argv[1], 60s);

    untangled::Cloth cloth;
    cloth.num_vertices = 6;
    cloth.triangles = {{0, 1, 2}, {3, 4, 5}};
    cloth.masses_kg = {1, 1, 1, 1, 1};
    try {
        client.open(cloth);
        EXPECT(!"five masses for six vertices");
    } catch (const std::invalid_argument &) {
    }
    cloth.masses_kg.push_back(1);
    cloth.paths = true;
    auto session = client.open(cloth);
    EXPECT(session.num_vertices() == 6 && session.num_registrations() == 1);
    EXPECT(!session.newest());

    const std::array<std::array<float, 3>, 6> crossed = {
        {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0.5f, 1, 2}, {1.5f, 1, 2}, {1, 1.1f, -1}}};
    {
        // Abandoned, it was never there.
        auto frame = session.begin_frame(0.0, 0.01);
        auto moved = std::move(frame);
        EXPECT(moved.positions().size() == 6 && frame.positions().size() == 0);
    }
    // Far more than are lent at a time: each is given back.
    for (int k = 0; k < 20; ++k) {
        auto frame = session.begin_frame(0.01 * k, 0.01);
        std::copy(crossed.begin(), crossed.end(), frame.positions().begin());
        const auto correction = session.wait(frame.send(), 60s);
        EXPECT(correction.summary().frame == std::uint64_t(k + 1));
        EXPECT(correction.summary().num_edge_face_intersections == 2);
        EXPECT(correction.vertices()[5].flags & UNTANGLED_INSIDE);
        EXPECT(correction.paths().size() == 2);
        for (const auto &path : correction.paths()) {
            EXPECT(correction.points(path).size() == path.num_points && path.num_points == 2);
        }
    }
    auto correction = session.exchange(0.0, 0.01, {crossed.data(), crossed.size()}, 60s);
    correction = session.exchange(0.0, 0.01, {crossed.data(), crossed.size()}, 60s);
    EXPECT(correction.summary().frame == 22);
    EXPECT(error_of([&] { session.exchange(0.0, 0.01, {crossed.data(), 5}, 60s); }) == UNTANGLED_INVALID_ARGUMENT);
    EXPECT(error_of([&] { session.begin_frame_f64(0.0, 0.01); }) == UNTANGLED_PRECISION);
    EXPECT(error_of([&] { session.update_settings("{\"quality\": 1}", 60s); }) == UNTANGLED_REFUSED);
    session.update_settings("{\"quality\": \"fast\"}", 60s);
    EXPECT(client.status().find("untangled.status/1") != std::string::npos);

    EXPECT(!session.has_repairs() && !session.poll_repair());
    EXPECT(error_of([&] { session.repair(0.0, 0.01, {crossed.data(), crossed.size()}, 60s); }) ==
           UNTANGLED_NO_REPAIRS);
    cloth.repairs = true;
    auto repaired = client.open(cloth);
    EXPECT(repaired.has_repairs());
    {
        auto repair = repaired.repair(0.0, 0.01, {crossed.data(), crossed.size()}, 60s);
        EXPECT(repair.certified() && !repair.truncated() && repair.displacements_f64().size() == 0);
        auto clean = crossed;
        for (std::size_t k = 0; k < clean.size(); ++k) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                clean[k][axis] += repair.displacements()[k][axis];
            }
        }
        // One is held.
        EXPECT(error_of([&] { repaired.wait_repair(1, 1ms); }) == UNTANGLED_TOO_MANY_CORRECTIONS);
        const auto after = repaired.exchange(0.0, 0.01, {clean.data(), clean.size()}, 60s);
        EXPECT(after.summary().num_edge_face_intersections == 0 && repair.summary().num_moved > 0);
    }
    repaired.begin_motion();
    repaired.ask_for_repair(30s);
    {
        auto frame = repaired.begin_frame(0.0, 0.01);
        std::copy(crossed.begin(), crossed.end(), frame.positions().begin());
        const auto number = frame.send();
        EXPECT(repaired.wait_repair(number, 60s).summary().frame == number);
        EXPECT(!repaired.poll_repair());
    }

    cloth.body = {3, 4};
    EXPECT(error_of([&] { client.open(cloth); }) == UNTANGLED_REFUSED);
    cloth.body = {3, 4, 5};
    {
        auto dressed = client.open(cloth);
        const auto beside = dressed.exchange(0.0, 0.01, {crossed.data(), crossed.size()}, 60s);
        EXPECT(beside.summary().num_edge_face_intersections == 2);
        for (std::size_t k = 3; k < 6; ++k) {
            const auto &vertex = beside.vertices()[k];
            EXPECT((vertex.flags & UNTANGLED_PINNED) && vertex.value[0] == 0 && vertex.value[2] == 0);
        }
    }
    cloth.body.clear();

    cloth.precision = UNTANGLED_F64;
    auto precise = client.open(cloth);
    auto frame = precise.begin_frame_f64(0.0, 0.01);
    for (std::size_t k = 0; k < 6; ++k) {
        std::copy(crossed[k].begin(), crossed[k].end(), frame.positions()[k].begin());
    }
    EXPECT(precise.wait(frame.send(), 60s).summary().num_edge_face_intersections == 2);
    std::array<std::array<double, 3>, 6> doubled = {};
    for (std::size_t k = 0; k < 6; ++k) {
        std::copy(crossed[k].begin(), crossed[k].end(), doubled[k].begin());
    }
    {
        const auto repair = precise.repair_f64(0.0, 0.01, {doubled.data(), doubled.size()}, 60s);
        EXPECT(repair.certified() && repair.displacements().size() == 0 && repair.displacements_f64().size() == 6);
    }
    try {
        precise.wait(1000, 1ms);
        EXPECT(!"frame 1000");
    } catch (const untangled::Error &error) {
        EXPECT(error.transient() && error.code() == UNTANGLED_TIMEOUT);
    }
    cloth.precision = UNTANGLED_F32;
    cloth.labels = true;
    auto labelled = client.open(cloth);
    EXPECT(labelled.is_sparse() && labelled.has_labels() && !session.is_sparse() && !session.has_labels());
    auto listed = labelled.exchange(0.0, 0.01, {crossed.data(), crossed.size()}, 60s);
    EXPECT(listed.entries().size() > 0 && listed.labels().size() > 0);
    EXPECT(correction.entries().size() == 0 && correction.labels().size() == 0);
    for (const auto &entry : listed.entries()) {
        EXPECT(listed.vertices()[entry.vertex].flags == entry.flags);
    }
    // The tip may pass through the triangle that it has pierced, not through its own.
    untangled::Contacts contacts(labelled.num_vertices());
    contacts.set(listed.labels());
    const std::array<std::uint32_t, 2> tips = {5, 5};
    const std::array<std::array<std::uint32_t, 3>, 2> faces = {{{0, 1, 2}, {3, 4, 5}}};
    std::array<bool, 2> off = {};
    contacts.vertex_faces_off({tips.data(), 2}, {faces.data(), 2}, {off.data(), 2});
    EXPECT(off[0] && !off[1]);
    const std::array<std::array<std::uint32_t, 2>, 1> edges[2] = {{{{0, 1}}}, {{{5, 3}}}};
    contacts.edge_edges_off({edges[0].data(), 1}, {edges[1].data(), 1}, {off.data(), 1});
    try {
        contacts.vertex_faces_off({tips.data(), 1}, {faces.data(), 2}, {off.data(), 2});
        EXPECT(!"one vertex for two faces");
    } catch (const std::invalid_argument &) {
    }
    // Two triangles that share an edge by doubled vertices.
    untangled::Cloth seam;
    seam.num_vertices = 6;
    seam.triangles = {{0, 1, 2}, {3, 4, 5}};
    seam.rest_positions_m = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
    seam.weld = true;
    auto welded = client.open(seam);
    EXPECT(welded.num_welded_vertices() == 2 && welded.num_vertices() == 6 && session.num_welded_vertices() == 0);
    std::puts("the wrapper keeps its word");
    return 0;
}
