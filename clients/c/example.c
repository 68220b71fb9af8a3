/* A whole host: two square sheets through each other, moved apart by what the daemon says.
 *
 *     untangled serve &
 *     cc example.c $(pkg-config --cflags --libs untangled-client) -lm -o example && ./example
 *
 * It prints how many edges pierce a face, step by step, and ends with 0 when none does any more. Each step does what
 * any host does: write the positions in place, send, wait, use value and mask. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "untangled.h"

#define SIDE 20
#define NUM_VERTICES (2 * SIDE * SIDE)
#define NUM_TRIANGLES (4 * (SIDE - 1) * (SIDE - 1))
#define DEADLINE_US 2000000

static float cloth[NUM_VERTICES][3];
static uint32_t triangles[NUM_TRIANGLES][3];

/* A sheet that lies level, and one that stands and has its lower rows through the other. */
static void make_scene(void) {
    uint32_t triangle = 0;
    for (uint32_t sheet = 0; sheet < 2; ++sheet) {
        const uint32_t first = sheet * SIDE * SIDE;
        for (uint32_t i = 0; i < SIDE; ++i) {
            for (uint32_t j = 0; j < SIDE; ++j) {
                const float u = 0.02f * (float)i, v = 0.02f * (float)j;
                float *position = cloth[first + i * SIDE + j];
                position[0] = u;
                position[1] = sheet == 0 ? v : 0.193f + 0.1f * u;
                position[2] = sheet == 0 ? 0.01f * sinf(9.0f * u) : v - 0.051f;
                if (i + 1 < SIDE && j + 1 < SIDE) {
                    const uint32_t a = first + i * SIDE + j, b = a + SIDE;
                    const uint32_t two[2][3] = {{a, b, b + 1}, {a, b + 1, a + 1}};
                    memcpy(triangles[triangle], two, sizeof two);
                    triangle += 2;
                }
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

int main(int argc, char **argv) {
    make_scene();

    untangled_client client;
    check(untangled_connect(argc > 1 ? argv[1] : NULL, 5000000, &client), "connecting");

    untangled_registration registration;
    check(untangled_registration_init(&registration), "registration");
    registration.num_vertices = NUM_VERTICES;
    registration.triangles = triangles[0];
    registration.num_triangles = NUM_TRIANGLES;
    registration.correction = UNTANGLED_DISPLACEMENT;
    registration.paths = 1;
    untangled_session session;
    check(untangled_register(client, &registration, &session), "registering");

    const double dt_s = 1.0 / 60.0;
    uint64_t left = 1;
    for (int step = 0; step < 200 && left > 0; ++step) {
        /* 1. Write in place. A real host copies from its solver, or solves right there. */
        float *positions;
        uint64_t frame;
        check(untangled_begin_frame(session, step * dt_s, dt_s, &positions), "beginning a frame");
        memcpy(positions, cloth, sizeof cloth);
        check(untangled_send_frame(session, &frame), "sending a frame");

        /* 2. Wait, never longer than a deadline: without an answer the simulation goes on without help. */
        untangled_correction correction;
        const untangled_error code = untangled_wait(session, frame, DEADLINE_US, &correction);
        if (untangled_is_transient(code)) {
            continue;
        }
        check(code, "waiting");

        /* 3. Use value and mask. This host has no contact of its own; a solver with contact switches it off where
         * the mask is set. */
        size_t masked = 0;
        for (size_t k = 0; k < correction.num_vertices; ++k) {
            for (int axis = 0; axis < 3; ++axis) {
                cloth[k][axis] += correction.vertices[k].value[axis];
            }
            masked += (correction.vertices[k].flags & UNTANGLED_MASK) != 0;
        }
        left = correction.num_edge_face_intersections;
        printf("step %d: %llu edges pierce a face, %zu paths, %zu vertices masked\n", step, (unsigned long long)left,
               correction.num_paths, masked);
        check(untangled_release(session, &correction), "releasing");
    }

    check(untangled_close(session), "closing");
    check(untangled_disconnect(client), "disconnecting");
    return left == 0 ? 0 : 1;
}
