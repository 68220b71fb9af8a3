/* Sends the frames of a file and writes their corrections to a file: frames DOMAIN SCENE OUT [REPEATS].
 *
 * With REPEATS every frame is sent that often, and the median round trip is printed, in microseconds. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "untangled.h"

static void check(untangled_error code) {
    if (code != UNTANGLED_OK) {
        fprintf(stderr, "%s\n", untangled_last_error());
        exit(2);
    }
}

static void *read_array(FILE *file, size_t size, size_t count) {
    void *array = malloc(size * count + 1);
    if (array == NULL || fread(array, size, count, file) != count) {
        fprintf(stderr, "the scene is too short\n");
        exit(2);
    }
    return array;
}

static double now_us(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e6 * (double)time.tv_sec + 1e-3 * (double)time.tv_nsec;
}

static int ascending(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

int main(int argc, char **argv) {
    if (argc < 4) {
        return 2;
    }
    FILE *file = fopen(argv[2], "rb"), *out = fopen(argv[3], "wb");
    if (file == NULL || out == NULL) {
        return 2;
    }
    const size_t repeats = argc > 4 ? (size_t)atoi(argv[4]) : 1;
    uint32_t *counts = read_array(file, 4, 3);
    const size_t num_vertices = counts[0], num_triangles = counts[1], num_frames = counts[2];
    uint32_t *triangles = read_array(file, 12, num_triangles);
    double *masses_kg = read_array(file, 8, num_vertices);
    float *frames = read_array(file, 12, num_vertices * num_frames);
    untangled_registration registration;
    check(untangled_registration_init(&registration));
    registration.num_vertices = num_vertices;
    registration.num_triangles = num_triangles;
    registration.triangles = triangles;
    registration.masses_kg = masses_kg;
    registration.correction = UNTANGLED_FORCE;
    registration.paths = repeats == 1;

    untangled_client client;
    untangled_session session;
    check(untangled_connect(argv[1], 60000000, &client));
    check(untangled_register(client, &registration, &session));
    double *times = malloc(sizeof(double) * repeats * num_frames);
    size_t trip = 0;
    for (size_t repeat = 0; repeat < repeats; ++repeat) {
        for (size_t k = 0; k < num_frames; ++k, ++trip) {
            float *positions;
            uint64_t frame;
            untangled_correction correction;
            const double begin = now_us();
            check(untangled_begin_frame(session, 0.0, 0.01, &positions));
            memcpy(positions, frames + 3 * num_vertices * k, 12 * num_vertices);
            check(untangled_send_frame(session, &frame));
            check(untangled_wait(session, frame, 60000000, &correction));
            times[trip] = now_us() - begin;
            if (repeat == 0) {
                fwrite(correction.vertices, sizeof(untangled_vertex), num_vertices, out);
                fwrite(correction.paths, sizeof(untangled_path), correction.num_paths, out);
                fwrite(correction.path_points, sizeof(untangled_path_point), correction.num_path_points, out);
            }
            check(untangled_release(session, &correction));
        }
    }
    check(untangled_close(session));
    check(untangled_disconnect(client));
    qsort(times, trip, sizeof(double), ascending);
    printf("%.3f\n", times[trip / 2]);
    free(times);
    free(frames);
    free(masses_kg);
    free(triangles);
    free(counts);
    fclose(file);
    return fclose(out) == 0 ? 0 : 2;
}
