// One exchange from a tangled cloth to one that is certified clean: two square sheets through each other.
//
//     untangled serve &
//     c++ -std=c++17 repair.cpp $(pkg-config --cflags --libs untangled-client) -o repair && ./repair
//
// The first half waits for the repair. The second half goes on meanwhile, as a simulator with a frame rate would.
#include <cmath>
#include <cstdio>

#include "untangled.hpp"

using Positions = std::vector<std::array<float, 3>>;
constexpr double dt_s = 1.0 / 60.0;
constexpr untangled::Duration deadline = std::chrono::seconds(60);

// A level sheet, and one that stands and has its lower rows through it.
static Positions make_scene(untangled::Cloth &cloth) {
    Positions positions;
    for (std::uint32_t sheet = 0; sheet < 2; ++sheet) {
        for (std::uint32_t k = 0; k < 400; ++k) {
            const float u = 0.02f * static_cast<float>(k / 20), v = 0.02f * static_cast<float>(k % 20);
            if (sheet == 0) {
                positions.push_back({u, v, 0.01f * std::sin(9.0f * u)});
            } else {
                positions.push_back({u, 0.193f + 0.1f * u, v - 0.051f});
            }
            if (k / 20 < 19 && k % 20 < 19) {
                const std::uint32_t a = 400 * sheet + k;
                cloth.triangles.push_back({a, a + 20, a + 21});
                cloth.triangles.push_back({a, a + 21, a + 1});
            }
        }
    }
    cloth.num_vertices = positions.size();
    return positions;
}

// In single precision, as the cloth was sent: then these are the bits that were checked.
static void add(Positions &cloth, const untangled::Repair &repair) {
    for (std::size_t k = 0; k < cloth.size(); ++k) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            cloth[k][axis] += repair.displacements()[k][axis];
        }
    }
}

// Edges that pierce a face. A real host uses value and mask while it waits: see ../INTEGRATE.md.
static unsigned long long intersections(untangled::Session &session, const Positions &cloth) {
    return session.exchange(0.0, dt_s, {cloth.data(), cloth.size()}, deadline).summary().num_edge_face_intersections;
}

int main(int argc, char **argv) {
    untangled::Cloth description;
    description.repairs = true;
    const Positions tangled = make_scene(description);
    untangled::Client client(argc > 1 ? std::optional<std::string>(argv[1]) : std::nullopt);
    auto session = client.open(description);

    Positions cloth = tangled;
    {
        const auto repair = session.repair(0.0, dt_s, {cloth.data(), cloth.size()}, deadline);
        std::printf("certified: %d, %u vertices moved\n", repair.certified(), repair.summary().num_moved);
        add(cloth, repair);
    }
    std::printf("%llu edges pierce a face\n", intersections(session, cloth));

    cloth = tangled;
    session.ask_for_repair();
    for (int step = 0; intersections(session, cloth) > 0; ++step) {
        if (const auto repair = session.poll_repair()) {
            // Of an earlier frame: its displacements are added to the positions of now.
            add(cloth, *repair);
            std::printf("repaired after step %d\n", step);
        }
    }
    return 0;
}
