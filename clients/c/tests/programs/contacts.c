/* Sparse corrections, and contacts by their labels, against brute force. Arguments: the domain of a running daemon. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "untangled.h"

#define EXPECT(condition)                                                                                              \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "line %d: %s (%s)\n", __LINE__, #condition, untangled_last_error());                       \
            exit(1);                                                                                                   \
        }                                                                                                              \
    } while (0)

enum { NUM_VERTICES = 40, NUM_LABELS = 60, NUM_CONTACTS = 1000 };

static const uint32_t triangles[] = {0, 1, 2, 3, 4, 5};
static const float crossed[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0.5f, 1, 2, 1.5f, 1, 2, 1, 1.1f, -1};
static const float apart[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 0.5f, 1, 2, 1.5f, 1, 2, 1, 1.1f, 1};

/* The same numbers in every run. */
static uint32_t next(uint32_t below) {
    static uint32_t state = 1;
    state = state * 1664525u + 1013904223u;
    return (state >> 16) % below;
}

/* The rule, by brute force: all labels of one end with all of the other. */
static bool is_off(const untangled_label *labels, size_t num_labels, const uint32_t *first, size_t num_first,
                   const uint32_t *second, size_t num_second) {
    for (size_t a = 0; a < num_labels; ++a) {
        for (size_t b = 0; b < num_labels; ++b) {
            const uint32_t one = labels[a].label, other = labels[b].label;
            bool at_first = false, at_second = false;
            for (size_t k = 0; k < num_first; ++k) {
                at_first |= labels[a].vertex == first[k];
            }
            for (size_t k = 0; k < num_second; ++k) {
                at_second |= labels[b].vertex == second[k];
            }
            if (at_first && at_second &&
                ((one >> 2 == other >> 2 && ((one | other) & 3) == 3) || one == UINT32_MAX || other == UINT32_MAX)) {
                return true;
            }
        }
    }
    return false;
}

static void check_filter(void) {
    untangled_contacts contacts;
    untangled_label labels[NUM_LABELS];
    static uint32_t vertices[NUM_CONTACTS], faces[3 * NUM_CONTACTS], first[2 * NUM_CONTACTS], second[2 * NUM_CONTACTS];
    static bool off[NUM_CONTACTS];
    size_t num_off = 0;
    for (size_t k = 0; k < NUM_LABELS; ++k) {
        labels[k].vertex = next(NUM_VERTICES - 10);
        labels[k].label = k == 7 ? UINT32_MAX : 4 * next(6) + 1 + next(3);
    }
    for (size_t k = 0; k < 3 * NUM_CONTACTS; ++k) {
        faces[k] = next(NUM_VERTICES + 2);
    }
    for (size_t k = 0; k < 2 * NUM_CONTACTS; ++k) {
        first[k] = next(NUM_VERTICES);
        second[k] = next(NUM_VERTICES);
    }
    for (size_t k = 0; k < NUM_CONTACTS; ++k) {
        vertices[k] = next(NUM_VERTICES);
    }
    EXPECT(untangled_contacts_create(NUM_VERTICES, &contacts) == UNTANGLED_OK && contacts.id != 0);
    EXPECT(untangled_contacts_set(contacts, labels, NUM_LABELS) == UNTANGLED_OK);
    EXPECT(untangled_vertex_faces_off(contacts, vertices, faces, NUM_CONTACTS, off) == UNTANGLED_OK);
    for (size_t k = 0; k < NUM_CONTACTS; ++k) {
        EXPECT(off[k] == is_off(labels, NUM_LABELS, vertices + k, 1, faces + 3 * k, 3));
        num_off += off[k];
    }
    EXPECT(num_off > NUM_CONTACTS / 10 && num_off < NUM_CONTACTS);
    EXPECT(untangled_edge_edges_off(contacts, first, second, NUM_CONTACTS, off) == UNTANGLED_OK);
    for (size_t k = 0; k < NUM_CONTACTS; ++k) {
        EXPECT(off[k] == is_off(labels, NUM_LABELS, first + 2 * k, 2, second + 2 * k, 2));
    }
    EXPECT(untangled_contacts_set(contacts, NULL, 0) == UNTANGLED_OK);
    EXPECT(untangled_vertex_faces_off(contacts, vertices, faces, NUM_CONTACTS, off) == UNTANGLED_OK);
    for (size_t k = 0; k < NUM_CONTACTS; ++k) {
        EXPECT(!off[k]);
    }
    EXPECT(untangled_vertex_faces_off(contacts, NULL, NULL, 0, NULL) == UNTANGLED_OK);
    EXPECT(untangled_vertex_faces_off(contacts, NULL, faces, 1, off) == UNTANGLED_INVALID_ARGUMENT);
    EXPECT(untangled_edge_edges_off(contacts, first, second, 1, NULL) == UNTANGLED_INVALID_ARGUMENT);
    EXPECT(untangled_edge_edges_off(contacts, first, second, SIZE_MAX / 2, off) == UNTANGLED_INVALID_ARGUMENT);
    EXPECT(untangled_contacts_set(contacts, NULL, 1) == UNTANGLED_INVALID_ARGUMENT);
    EXPECT(untangled_contacts_free(contacts) == UNTANGLED_OK);
    EXPECT(untangled_contacts_free(contacts) == UNTANGLED_INVALID_HANDLE);
    EXPECT(untangled_contacts_set(contacts, NULL, 0) == UNTANGLED_INVALID_HANDLE);
    EXPECT(untangled_contacts_create(NUM_VERTICES, NULL) == UNTANGLED_INVALID_ARGUMENT);
}

static untangled_session open_session(untangled_client client, uint32_t options) {
    untangled_session session;
    untangled_registration registration;
    EXPECT(untangled_registration_init(&registration) == UNTANGLED_OK);
    registration.num_vertices = 6;
    registration.triangles = triangles;
    registration.num_triangles = 2;
    registration.options = options;
    EXPECT(untangled_register(client, &registration, &session) == UNTANGLED_OK);
    EXPECT(untangled_is_sparse(session) == (options != 0));
    EXPECT(untangled_has_labels(session) == ((options & UNTANGLED_LABELS) != 0));
    return session;
}

static void check_session(untangled_client client, uint32_t options) {
    const untangled_session session = open_session(client, options);
    for (int k = 0; k < 4; ++k) {
        const bool is_crossed = k % 2 == 0;
        untangled_correction correction;
        untangled_sparse_view sparse;
        size_t place = 0;
        EXPECT(untangled_exchange(session, 0.0, 0.01, is_crossed ? crossed : apart, 6, 60000000, &correction) ==
               UNTANGLED_OK);
        EXPECT(correction.num_vertices == 6 && (correction.num_inside == 1) == is_crossed);
        EXPECT(untangled_sparse(session, &correction, &sparse) == UNTANGLED_OK);
        EXPECT(sparse.is_sparse == (options != 0));
        for (uint32_t vertex = 0; vertex < 6 && options != 0; ++vertex) {
            const untangled_vertex *whole = correction.vertices + vertex;
            if (place < sparse.num_entries && sparse.entries[place].vertex == vertex) {
                EXPECT(memcmp(sparse.entries[place].value, whole->value, sizeof whole->value) == 0);
                EXPECT(sparse.entries[place].flags == whole->flags);
                ++place;
            } else {
                EXPECT(whole->value[0] == 0 && whole->value[1] == 0 && whole->value[2] == 0 && whole->flags == 0);
            }
        }
        EXPECT(place == sparse.num_entries && (place > 0) == (is_crossed && options != 0));
        EXPECT((sparse.num_labels > 0) == (is_crossed && (options & UNTANGLED_LABELS) != 0));
        EXPECT(untangled_release(session, &correction) == UNTANGLED_OK);
        EXPECT(untangled_sparse(session, &correction, &sparse) == UNTANGLED_INVALID_HANDLE && sparse.entries == NULL);
        EXPECT(untangled_sparse(session, NULL, &sparse) == UNTANGLED_INVALID_ARGUMENT);
    }
    EXPECT(untangled_close(session) == UNTANGLED_OK);
}

/* Two triangles that share an edge by doubled vertices, one of them folded over: welded there is one cloth. */
static void check_weld(untangled_client client) {
    static const uint32_t seam[] = {0, 1, 2, 3, 4, 5};
    static const double rest[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 4, 0, 0, 4, 4, 0, 0, 4, 0};
    static const float folded[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 4, 0, 0, 1, 1, 1, 0, 4, 0};
    static const float open[] = {0, 0, 0, 4, 0, 0, 0, 4, 0, 4, 0, 1, 1, 1, 1, 0, 4, 0};
    untangled_session session;
    untangled_registration registration;
    untangled_correction correction;
    EXPECT(untangled_registration_init(&registration) == UNTANGLED_OK);
    registration.num_vertices = 6;
    registration.triangles = seam;
    registration.num_triangles = 2;
    registration.options = UNTANGLED_WELD;
    EXPECT(untangled_register(client, &registration, &session) == UNTANGLED_REFUSED);
    registration.rest_positions_m = rest;
    EXPECT(untangled_register(client, &registration, &session) == UNTANGLED_OK);
    EXPECT(untangled_num_welded_vertices(session) == 2 && untangled_num_vertices(session) == 6);
    EXPECT(untangled_exchange(session, 0.0, 0.01, folded, 6, 60000000, &correction) == UNTANGLED_OK);
    EXPECT(correction.num_vertices == 6 && correction.num_face_pairs == 0);
    EXPECT(untangled_release(session, &correction) == UNTANGLED_OK);
    EXPECT(untangled_exchange(session, 0.0, 0.01, open, 6, 60000000, &correction) == UNTANGLED_FRAME_REFUSED);
    EXPECT(untangled_close(session) == UNTANGLED_OK && untangled_num_welded_vertices(session) == 0);
    registration.options = 0;
    EXPECT(untangled_register(client, &registration, &session) == UNTANGLED_OK);
    EXPECT(untangled_num_welded_vertices(session) == 0);
    EXPECT(untangled_close(session) == UNTANGLED_OK);
}

int main(int argc, char **argv) {
    untangled_client client;
    untangled_session session;
    untangled_registration registration;
    if (argc != 2) {
        return 2;
    }
    check_filter();
    EXPECT(untangled_connect(argv[1], 60000000, &client) == UNTANGLED_OK);
    check_session(client, 0);
    check_session(client, UNTANGLED_SPARSE);
    check_session(client, UNTANGLED_LABELS);
    check_weld(client);
    EXPECT(untangled_registration_init(&registration) == UNTANGLED_OK);
    registration.options = 1u << 30;
    EXPECT(untangled_register(client, &registration, &session) == UNTANGLED_INVALID_ARGUMENT);
    EXPECT(untangled_disconnect(client) == UNTANGLED_OK);
    return 0;
}
