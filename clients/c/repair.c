/* One exchange from a tangled cloth to one that is certified clean: two square sheets through each other.
 *
 *     untangled serve &
 *     cc repair.c $(pkg-config --cflags --libs untangled-client) -lm -o repair && ./repair
 *
 * The first half waits for the repair. The second half goes on meanwhile, as a simulator with a frame rate would. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "untangled.h"

#define SIDE 20
#define NUM_VERTICES (2 * SIDE * SIDE)
#define NUM_TRIANGLES (4 * (SIDE - 1) * (SIDE - 1))
#define DEADLINE_US 60000000

static float tangled[NUM_VERTICES][3], cloth[NUM_VERTICES][3];
static uint32_t triangles[NUM_TRIANGLES][3];
static const double dt_s = 1.0 / 60.0;

/* A sheet that lies level, and one that stands and has its lower rows through the other. */
static void make_scene(void) {
    uint32_t triangle = 0;
    for (uint32_t sheet = 0; sheet < 2; ++sheet) {
        for (uint32_t k = 0; k < SIDE * SIDE; ++k) {
            const float u = 0.02f * (float)(k / SIDE), v = 0.02f * (float)(k % SIDE);
            float *position = tangled[sheet * SIDE * SIDE + k];
            position[0] = u;
            position[1] = sheet == 0 ? v : 0.193f + 0.1f * u;
            position[2] = sheet == 0 ? 0.01f * sinf(9.0f * u) : v - 0.051f;
            if (k / SIDE + 1 < SIDE && k % SIDE + 1 < SIDE) {
                const uint32_t a = sheet * SIDE * SIDE + k, b = a + SIDE;
                const uint32_t two[2][3] = {{a, b, b + 1}, {a, b + 1, a + 1}};
                memcpy(triangles[triangle], two, sizeof two);
                triangle += 2;
            }
        }
    }
}

static void check(untangled_error code, const char *what) {
    if (code != UNTANGLED_OK) {
        fprintf(stderr, "%s: %s\n", what, untangled_last_error());
        exit(2);
    }
}

/* In single precision, as the cloth was sent: then these are the bits that were checked. */
static void add(const untangled_repair *repair) {
    for (size_t k = 0; k < repair->num_vertices; ++k) {
        for (size_t axis = 0; axis < 3; ++axis) {
            cloth[k][axis] += repair->displacements[3 * k + axis];
        }
    }
}

/* Edges that pierce a face. A real host uses value and mask while it waits: see example.c. */
static unsigned long long intersections(untangled_session session) {
    untangled_correction correction;
    check(untangled_exchange(session, 0.0, dt_s, cloth[0], NUM_VERTICES, DEADLINE_US, &correction), "exchanging");
    const unsigned long long left = correction.num_edge_face_intersections;
    check(untangled_release(session, &correction), "releasing");
    return left;
}

int main(int argc, char **argv) {
    make_scene();
    untangled_client client;
    check(untangled_connect(argc > 1 ? argv[1] : NULL, 5000000, &client), "connecting");
    untangled_registration registration;
    check(untangled_registration_init(&registration), "registration");
    registration.num_vertices = NUM_VERTICES;
    registration.triangles = triangles[0];
    registration.num_triangles = NUM_TRIANGLES;
    registration.options = UNTANGLED_REPAIRS;
    untangled_session session;
    check(untangled_register(client, &registration, &session), "registering");

    memcpy(cloth, tangled, sizeof cloth);
    untangled_repair repair;
    check(untangled_exchange_repair(session, 0.0, dt_s, cloth[0], NUM_VERTICES, DEADLINE_US, &repair), "repairing");
    printf("certified: %u, %u vertices moved\n", repair.certified, repair.num_moved);
    add(&repair);
    check(untangled_release_repair(session, &repair), "releasing a repair");
    printf("%llu edges pierce a face\n", intersections(session));

    memcpy(cloth, tangled, sizeof cloth);
    check(untangled_ask_for_repair(session, 0), "asking for a repair");
    for (int step = 0; intersections(session) > 0; ++step) {
        const untangled_error code = untangled_poll_repair(session, &repair);
        if (code == UNTANGLED_NOTHING_NEW) {
            continue;
        }
        check(code, "polling");
        /* Of an earlier frame: its displacements are added to the positions of now. */
        add(&repair);
        check(untangled_release_repair(session, &repair), "releasing a repair");
        printf("repaired after step %d\n", step);
    }

    check(untangled_close(session), "closing");
    check(untangled_disconnect(client), "disconnecting");
    return 0;
}
