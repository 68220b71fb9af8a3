/* The calls of a frame allocate nothing except for the one small block by which iceoryx2 keeps a loan. Arguments: the
 * domain of a running daemon. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "untangled.h"

/* All memory of this process, the library's too, comes from here; the real allocator is below. */
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *old, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);

static unsigned long taken;

void *malloc(size_t size) {
    __atomic_add_fetch(&taken, 1, __ATOMIC_RELAXED);
    return __libc_malloc(size);
}
void *calloc(size_t count, size_t size) {
    __atomic_add_fetch(&taken, 1, __ATOMIC_RELAXED);
    return __libc_calloc(count, size);
}
void *realloc(void *old, size_t size) {
    __atomic_add_fetch(&taken, 1, __ATOMIC_RELAXED);
    return __libc_realloc(old, size);
}
int posix_memalign(void **place, size_t alignment, size_t size) {
    __atomic_add_fetch(&taken, 1, __ATOMIC_RELAXED);
    *place = __libc_memalign(alignment, size);
    return *place == NULL;
}

static const uint32_t triangles[] = {0, 1, 2, 3, 4, 5};
static const float crossed[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0.5f, 1, 2, 1.5f, 1, 2, 1, 1.1f, -1};

static void check(untangled_error code) {
    if (code != UNTANGLED_OK) {
        fprintf(stderr, "%s\n", untangled_last_error());
        exit(2);
    }
}

static void lock_step(untangled_session session) {
    float *positions;
    uint64_t frame;
    untangled_correction correction;
    check(untangled_begin_frame(session, 0.0, 0.01, &positions));
    memcpy(positions, crossed, sizeof crossed);
    check(untangled_send_frame(session, &frame));
    check(untangled_wait(session, frame, 60000000, &correction));
    if (correction.num_edge_face_intersections != 2 || correction.num_paths != 2) {
        fprintf(stderr, "%llu edges, %zu paths\n", (unsigned long long)correction.num_edge_face_intersections,
                correction.num_paths);
        exit(1);
    }
    check(untangled_release(session, &correction));
    /* Errors say what they say without memory as well. */
    if (untangled_newest(session, &correction) != UNTANGLED_NOTHING_NEW) {
        exit(1);
    }
    if (untangled_wait(session, frame + 1, 100, &correction) != UNTANGLED_TIMEOUT) {
        exit(1);
    }
}

static double now_s(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

int main(int argc, char **argv) {
    untangled_client client;
    untangled_session session;
    untangled_registration registration;
    if (argc != 2) {
        return 2;
    }
    check(untangled_connect(argv[1], 60000000, &client));
    check(untangled_registration_init(&registration));
    registration.num_vertices = 6;
    registration.triangles = triangles;
    registration.num_triangles = 2;
    registration.paths = 1;
    check(untangled_register(client, &registration, &session));
    /* A first frame opens connections. */
    for (int warm = 0; warm < 5; ++warm) {
        lock_step(session);
    }
    const unsigned long at_first = taken;
    int judged = 0, bad = 0;
    double last = now_s();
    for (int k = 0; k < 300; ++k) {
        const unsigned long before = taken;
        lock_step(session);
        const double now = now_s();
        /* Where nothing has come for 50 ms the client checks the daemon's process, which allocates: frames that take as
         * long, on a busy machine, are not counted. */
        if (now - last < 0.04) {
            ++judged;
            bad += taken - before > 1;
        }
        last = now;
    }
    check(untangled_close(session));
    check(untangled_disconnect(client));
    printf("%lu allocations before, %d of %d frames with more than one\n", at_first, bad, judged);
    return at_first > 0 && judged > 0 && bad == 0 ? 0 : 1;
}
