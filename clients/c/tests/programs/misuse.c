/* What a host may do wrong is an error with a code and a message. Arguments: the domain of a running daemon. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "untangled.h"

#define EXPECT(code, call)                                                                                            \
    do {                                                                                                               \
        const untangled_error got = (call);                                                                            \
        if (got != (code)) {                                                                                           \
            fprintf(stderr, "line %d: %d, not %d: %s\n", __LINE__, (int)got, (int)(code), untangled_last_error());     \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (0)

#define SAYS(text)                                                                                                     \
    do {                                                                                                               \
        if (strstr(untangled_last_error(), text) == NULL) {                                                            \
            fprintf(stderr, "line %d: no \"%s\" in: %s\n", __LINE__, text, untangled_last_error());                    \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (0)

static const uint32_t triangles[] = {0, 1, 2, 2, 1, 3};
static const double masses[] = {0.1, 0.1, 0.1, 0.1};
static const float flat[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};

static untangled_registration square(void) {
    untangled_registration registration;
    EXPECT(UNTANGLED_OK, untangled_registration_init(&registration));
    registration.num_vertices = 4;
    registration.triangles = triangles;
    registration.num_triangles = 2;
    registration.masses_kg = masses;
    return registration;
}

static void registrations(untangled_client client) {
    untangled_session session = {7};
    untangled_registration bad = square();
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_register(client, NULL, &session));
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_register(client, &bad, NULL));
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_registration_init(NULL));
    bad.struct_size = 8;
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_register(client, &bad, &session));
    SAYS("struct_size");
    bad = square();
    bad.triangles = NULL;
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_register(client, &bad, &session));
    SAYS("triangles");
    bad = square();
    bad.triangles = (const uint32_t *)((const char *)triangles + 1);
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_register(client, &bad, &session));
    SAYS("aligned");
    bad = square();
    bad.num_vertices = (size_t)-1;
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_register(client, &bad, &session));
    bad = square();
    bad.correction = 4;
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_register(client, &bad, &session));
    bad = square();
    bad.precision = 2;
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_register(client, &bad, &session));
    bad = square();
    bad.uv_coordinates = masses;
    bad.num_uv_coordinates = 2;
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_register(client, &bad, &session));
    SAYS("go together");
    bad = square();
    bad.settings_json = "{";
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_register(client, &bad, &session));
    bad.settings_json = "\xff";
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_register(client, &bad, &session));
    SAYS("UTF-8");
    bad.settings_json = "{\"stifness\": 1}";
    EXPECT(UNTANGLED_REFUSED, untangled_register(client, &bad, &session));
    SAYS("stifness");
    bad = square();
    bad.num_vertices = 3;
    EXPECT(UNTANGLED_REFUSED, untangled_register(client, &bad, &session));
    SAYS("3");
    if (session.id != 0) {
        fprintf(stderr, "a session came of an error\n");
        exit(1);
    }
}

static void frames(untangled_client client, untangled_session session) {
    untangled_correction corrections[4], none;
    float *positions;
    double *doubles;
    uint64_t frame;
    EXPECT(UNTANGLED_NO_FRAME, untangled_send_frame(session, &frame));
    EXPECT(UNTANGLED_NO_FRAME, untangled_abandon_frame(session));
    EXPECT(UNTANGLED_NOTHING_NEW, untangled_newest(session, &none));
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_begin_frame(session, 0, 0.01, NULL));
    EXPECT(UNTANGLED_PRECISION, untangled_begin_frame_f64(session, 0, 0.01, &doubles));
    EXPECT(UNTANGLED_OK, untangled_begin_frame(session, 0, 0.01, &positions));
    EXPECT(UNTANGLED_FRAME_OPEN, untangled_begin_frame(session, 0, 0.01, &positions));
    EXPECT(UNTANGLED_FRAME_OPEN, untangled_exchange(session, 0, 0.01, flat, 4, 1000000, &none));
    EXPECT(UNTANGLED_OK, untangled_abandon_frame(session));
    EXPECT(UNTANGLED_TIMEOUT, untangled_wait(session, 1000, 1000, &none));
    SAYS("1000");
    if (!untangled_is_transient(UNTANGLED_TIMEOUT) || untangled_is_transient(UNTANGLED_REFUSED)) {
        exit(1);
    }
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_exchange(session, 0, 0.01, flat, 3, 1000000, &none));
    SAYS("4");
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_exchange(session, 0, 0.01, NULL, 4, 1000000, &none));
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_exchange(session, 0, 0.01, flat, 4, 1000000, NULL));

    /* A frame with a NaN names the vertex; the session lives on. */
    EXPECT(UNTANGLED_OK, untangled_begin_frame(session, 0, 0.01, &positions));
    memcpy(positions, flat, sizeof flat);
    positions[7] = NAN;
    EXPECT(UNTANGLED_OK, untangled_send_frame(session, &frame));
    EXPECT(UNTANGLED_FRAME_REFUSED, untangled_wait(session, frame, 60000000, &none));
    SAYS("vertex 2 (counted from 0)");
    EXPECT(UNTANGLED_FRAME_REFUSED, untangled_exchange(session, 0, -1.0, flat, 4, 60000000, &none));

    /* Three are lent at a time; each is given back once. */
    for (int k = 0; k < 3; ++k) {
        EXPECT(UNTANGLED_OK, untangled_exchange(session, 0, 0.01, flat, 4, 60000000, &corrections[k]));
    }
    EXPECT(UNTANGLED_TOO_MANY_CORRECTIONS, untangled_exchange(session, 0, 0.01, flat, 4, 60000000, &corrections[3]));
    none = corrections[1];
    EXPECT(UNTANGLED_OK, untangled_release(session, &corrections[1]));
    EXPECT(UNTANGLED_INVALID_HANDLE, untangled_release(session, &corrections[1]));
    EXPECT(UNTANGLED_INVALID_HANDLE, untangled_release(session, &none));
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_release(session, NULL));
    EXPECT(UNTANGLED_OK, untangled_exchange(session, 0, 0.01, flat, 4, 60000000, &corrections[3]));
    if (corrections[3].num_vertices != 4 || corrections[1].vertices != NULL) {
        exit(1);
    }

    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_update_settings(session, NULL, 5000000));
    EXPECT(UNTANGLED_REFUSED, untangled_update_settings(session, "{\"quality\": \"best\"}", 5000000));
    EXPECT(UNTANGLED_OK, untangled_update_settings(session, "{\"quality\": \"fast\"}", 5000000));
    char text[8];
    size_t length;
    EXPECT(UNTANGLED_OK, untangled_status(client, NULL, 0, &length));
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_status(client, text, sizeof text, &length));
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_status(client, text, sizeof text, NULL));
}

int main(int argc, char **argv) {
    untangled_client client, nobody = {0};
    untangled_session session, closed;
    float *positions;
    if (argc != 2 || untangled_abi_version() != UNTANGLED_ABI_VERSION) {
        return 2;
    }
    EXPECT(UNTANGLED_INVALID_ARGUMENT, untangled_connect(argv[1], 0, NULL));
    EXPECT(UNTANGLED_DOMAIN, untangled_connect("no such domain", 0, &client));
    EXPECT(UNTANGLED_NO_DAEMON, untangled_connect("test-nobody-home", 1000, &client));
    SAYS("test-nobody-home");
    EXPECT(UNTANGLED_OK, untangled_connect(argv[1], 60000000, &client));
    registrations(client);
    untangled_registration good = square();
    EXPECT(UNTANGLED_INVALID_HANDLE, untangled_register(nobody, &good, &session));
    EXPECT(UNTANGLED_OK, untangled_register(client, &good, &session));
    if (untangled_num_vertices(session) != 4 || untangled_num_registrations(session) != 1) {
        return 1;
    }
    frames(client, session);
    closed = session;
    EXPECT(UNTANGLED_OK, untangled_close(session));
    EXPECT(UNTANGLED_INVALID_HANDLE, untangled_close(closed));
    EXPECT(UNTANGLED_INVALID_HANDLE, untangled_begin_frame(closed, 0, 0.01, &positions));
    EXPECT(UNTANGLED_OK, untangled_disconnect(client));
    EXPECT(UNTANGLED_INVALID_HANDLE, untangled_disconnect(client));
    if (untangled_num_vertices(closed) != 0) {
        return 1;
    }
    puts("every mistake is an error");
    return 0;
}
