// The C interface of untangled. clients/README.md says how to use it; clients/c/example.c shows it.
//
// Made from the crate in this folder, and kept in step by a test: WRITE_HEADER=1 cargo test -p untangled-client-c
//
// A session may be used from any thread, by one at a time: calls of other threads wait. Lengths are in metres, times in
// seconds, masses in kilograms, forces in newtons. Functions return a code; untangled_last_error() says it in words.

#ifndef UNTANGLED_H
#define UNTANGLED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// The vertex is inside: switch the host's self-collision off here.
#define UNTANGLED_INSIDE 1

// The vertex is near a path: switch the host's self-collision off here too.
#define UNTANGLED_NEAR_PATH 2

// The correction was limited.
#define UNTANGLED_CLAMPED 4

// The vertex is pinned and never corrected.
#define UNTANGLED_PINNED 8

// Where the host's self-collision has to be off, or it defends the tangle: inside or near a path.
#define UNTANGLED_MASK 3

// Option of a registration: corrections list only the vertices that have a value or a flag, see `untangled_entries`.
// `vertices` of a correction holds all of them even so, at the cost of these entries. A daemon that is too old sends
// all vertices.
#define UNTANGLED_SPARSE 1

// Option of a registration: corrections have labels, which say of single contacts whether they have to be off, see
// `untangled_contacts_set`. Makes them sparse as well. A daemon that is too old sends none.
#define UNTANGLED_LABELS 2

// Option of a registration: frames may be repaired, see `untangled_exchange_repair`. Takes shared memory for four
// frames more.
#define UNTANGLED_REPAIRS 4

// Option of a registration: vertices with exactly one place in `rest_positions_m` are one along seams, for meshes that
// were split for texture coordinates or normals; see `untangled_num_welded_vertices`. They have to be in one place in
// each state, and corrections keep them there. A daemon that is too old refuses it.
#define UNTANGLED_WELD 8

// The version of this interface. It changes where a program has to be compiled again.
#define UNTANGLED_ABI_VERSION 1

// What became of a call. `untangled_last_error` says it in words.
enum untangled_error
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Done.
    UNTANGLED_OK = 0,
    // An argument is null, not aligned, too long, of the wrong length, or no such code.
    UNTANGLED_INVALID_ARGUMENT = 1,
    // The handle was closed or released, or never was one.
    UNTANGLED_INVALID_HANDLE = 2,
    // A frame was begun and neither sent nor abandoned.
    UNTANGLED_FRAME_OPEN = 3,
    // No frame was begun.
    UNTANGLED_NO_FRAME = 4,
    // The session was registered with the other precision.
    UNTANGLED_PRECISION = 5,
    // No daemon serves the domain.
    UNTANGLED_NO_DAEMON = 6,
    // The daemon runs another version of iceoryx2 or of the protocol.
    UNTANGLED_VERSION = 7,
    // The domain can't be used.
    UNTANGLED_DOMAIN = 8,
    // It did not come in time. Go on without.
    UNTANGLED_TIMEOUT = 9,
    // The daemon refused a request; the message names the element and the value at fault.
    UNTANGLED_REFUSED = 10,
    // Shared memory is too full.
    UNTANGLED_NOT_ENOUGH_MEMORY = 11,
    // The transport failed.
    UNTANGLED_TRANSPORT = 12,
    // The daemon went away, and has not yet taken the session up again. Go on without, and try again with the next
    // frame.
    UNTANGLED_RECONNECTING = 13,
    // The daemon went away while it was waited for. Go on without; the next frame registers the session again.
    UNTANGLED_DAEMON_LOST = 14,
    // The daemon went on to a newer frame. Go on without.
    UNTANGLED_OVERTAKEN = 15,
    // The daemon could not use the frame; the message names the vertex and the value at fault. The session lives on.
    UNTANGLED_FRAME_REFUSED = 16,
    // Nothing has come since the last call.
    UNTANGLED_NOTHING_NEW = 17,
    // As many corrections are held as a session may hold: release one.
    UNTANGLED_TOO_MANY_CORRECTIONS = 18,
    // Something in this library failed that should not.
    UNTANGLED_INTERNAL = 19,
    // The daemon ended the frame at a limit of time or of intersections, before there was a correction. Go on without.
    UNTANGLED_NOT_ANALYSED = 20,
    // The session has no repairs: it was registered without `UNTANGLED_REPAIRS`, or by a daemon that does not know
    // them.
    UNTANGLED_NO_REPAIRS = 21,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum untangled_error untangled_error;
#else
typedef int32_t untangled_error;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// Precision of the positions that a session publishes.
enum untangled_precision
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Single.
    UNTANGLED_F32 = 0,
    // Double.
    UNTANGLED_F64 = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum untangled_precision untangled_precision;
#else
typedef uint32_t untangled_precision;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What corrections shall be.
enum untangled_kind
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
    // Newtons; needs masses.
    UNTANGLED_FORCE = 0,
    // Metres per second squared.
    UNTANGLED_ACCELERATION = 1,
    // Metres per second.
    UNTANGLED_VELOCITY_CHANGE = 2,
    // Metres.
    UNTANGLED_DISPLACEMENT = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum untangled_kind untangled_kind;
#else
typedef uint32_t untangled_kind;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A cloth and what is asked for. Fill it with `untangled_registration_init` first; only `num_vertices` and `triangles`
// are required.
typedef struct {
    // Set by `untangled_registration_init`; a library whose structure has another size refuses it.
    size_t struct_size;
    // Number of vertices.
    size_t num_vertices;
    // Vertex indices, `num_triangles x 3`.
    const uint32_t *triangles;
    // Number of triangles.
    size_t num_triangles;
    // Texture coordinates, `num_uv_coordinates x 2`, or null.
    const double *uv_coordinates;
    // Number of texture coordinates.
    size_t num_uv_coordinates;
    // For each triangle the texture coordinate of its corners, `num_triangles x 3`; null only without texture
    // coordinates.
    const uint32_t *uv_corners;
    // Unstrained positions in metres, `num_vertices x 3`, or null.
    const double *rest_positions_m;
    // Mass of each vertex in kilograms, or null; needed for forces.
    const double *masses_kg;
    // Vertices that the host does not let move, or null.
    const uint32_t *pins;
    // Number of pins.
    size_t num_pins;
    // Layer of each vertex, from the body outwards, or null.
    const uint32_t *layers;
    // `UNTANGLED_F32` (as `untangled_registration_init` leaves it) or `UNTANGLED_F64`.
    uint32_t precision;
    // `UNTANGLED_FORCE` and so on; `UNTANGLED_DISPLACEMENT` as `untangled_registration_init` leaves it.
    uint32_t correction;
    // 1 to receive intersection paths with each correction, else 0.
    uint32_t paths;
    // Sum of `UNTANGLED_SPARSE` and so on; 0 for none.
    uint32_t options;
    // Settings by name as a JSON object, as in `untangled config`; null for the daemon's defaults.
    const char *settings_json;
} untangled_registration;

// A connection to a daemon; `{0}` is none.
typedef struct {
    // Its number.
    uint64_t id;
} untangled_client;

// One cloth that the daemon knows; `{0}` is none.
typedef struct {
    // Its number.
    uint64_t id;
} untangled_session;

// Value and flags of a vertex.
typedef struct {
    // In the unit of the kind that was asked for.
    float value[3];
    // `UNTANGLED_INSIDE` and so on.
    uint32_t flags;
} untangled_vertex;

// An intersection path.
typedef struct {
    // Which pair it belongs to.
    uint32_t pair;
    // Type of that pair: CLOSED/CLOSED, EIGHT, LL, BLI, BLB, BLLB, CROSS, BB/II, BB/BI, BB/BB, BI/BI.
    uint32_t pair_type;
    // Type of this path: CLOSED, LL, BLI, BLB, BB, BI, II.
    uint32_t path_type;
    // Index of the corresponding path; its own where it is its own.
    uint32_t partner;
    // 1 for a loop on the cloth, else 0.
    uint32_t closed;
    // Index of its first point. Check it against the number of points: the daemon wrote it.
    uint32_t first_point;
    // Number of its points.
    uint32_t num_points;
    // Zero.
    uint32_t reserved;
} untangled_path;

// A point of an intersection path.
typedef struct {
    // In the world, in metres.
    double position_m[3];
    // The face that the path runs through after this point, and the partner's.
    uint32_t faces[2];
} untangled_path_point;

// The correction of one frame. Addresses point into shared memory, and are valid until `untangled_release` or
// `untangled_close`.
typedef struct {
    // The frame that it is for.
    uint64_t frame;
    // Simulated time of that frame in seconds.
    double simulated_s;
    // Step of that frame in seconds.
    double dt_s;
    // Number of vertices.
    size_t num_vertices;
    // Value and flags of each vertex.
    const untangled_vertex *vertices;
    // Number of intersection paths; 0 where they were not asked for.
    size_t num_paths;
    // Intersection paths, or null.
    const untangled_path *paths;
    // Number of points of all paths.
    size_t num_path_points;
    // Points of all paths, or null.
    const untangled_path_point *path_points;
    // What the values are.
    uint32_t kind;
    // 1 where time was up before all paths had been worked on, else 0.
    uint32_t truncated;
    // Number of edges that pierce a face.
    uint64_t num_edge_face_intersections;
    // Number of intersecting face pairs.
    uint64_t num_face_pairs;
    // Length of all paths in metres, each pair once.
    double contour_length_m;
    // Number of vertices that are inside.
    uint64_t num_inside;
    // Longest displacement that the correction makes in one step, in metres.
    double max_displacement_m;
    // Force left over, in newtons.
    double net_force_n[3];
    // Torque left over, in newton metres.
    double net_torque_nm[3];
    // Number of path pairs by type, as in `untangled_path.pair_type`.
    uint32_t num_pairs[16];
    // Nanoseconds of each stage: ingest, intersect, paths, regions, correspond, respond, publish, total.
    uint64_t stage_ns[8];
    // Frames so far that were overtaken before the daemon looked at them.
    uint64_t num_skipped_frames;
    // Where truncated: number of path pairs for which time did not suffice.
    uint64_t num_pairs_left_out;
    // Where truncated: their length in metres.
    double length_left_out_m;
    // What `untangled_release` knows it by.
    uint64_t token;
} untangled_correction;

// The repair of one frame: the displacement of every vertex to a state without intersections, or to the best that was
// reached. Positions of the frame plus displacements, added in the precision of the session, are the bits that were
// checked. Addresses point into shared memory, and are valid until `untangled_release_repair` or `untangled_close`.
typedef struct {
    // The frame whose positions the displacements are added to.
    uint64_t frame;
    // Simulated time of that frame in seconds.
    double simulated_s;
    // Number of vertices.
    size_t num_vertices;
    // Displacements in metres, `num_vertices x 3`, of a session in single precision; else null.
    const float *displacements;
    // Displacements in metres, `num_vertices x 3`, of a session in double precision; else null.
    const double *displacements_f64;
    // 1 where an exact check found no crossing in the repaired state, and no cloth inside of a body or behind an inner
    // layer; else 0.
    uint32_t certified;
    // 1 where time was up, else 0.
    uint32_t truncated;
    // Number of vertices that move.
    uint32_t num_moved;
    // Vertices of cloth inside of a body in the repaired state; 0 without bodies.
    uint32_t num_inside_body;
    // Edges that pierce a face in the repaired state.
    uint64_t num_edge_face_intersections;
    // Pairs of faces that cross in the repaired state, as the check counts them.
    uint64_t num_crossings;
    // Pairs of intersection paths in the repaired state.
    uint64_t num_pairs;
    // Their length in metres.
    double contour_length_m;
    // Mean displacement of the vertices that move, in metres.
    double mean_displacement_m;
    // Largest displacement in metres.
    double max_displacement_m;
    // Least length of an edge, divided by its length in the frame.
    double min_edge_ratio;
    // Largest length of an edge, divided by its length in the frame.
    double max_edge_ratio;
    // Least area of a face, divided by its area in the frame.
    double min_area_ratio;
    // Number of iterations.
    uint64_t num_iterations;
    // Nanoseconds that the request waited.
    uint64_t waited_ns;
    // Nanoseconds of work.
    uint64_t repair_ns;
    // Requests so far that a newer one replaced while they waited.
    uint64_t num_replaced;
    // What `untangled_release_repair` knows it by.
    uint64_t token;
    // Vertices of cloth behind an inner layer in the repaired state; 0 without layers.
    uint64_t num_behind;
} untangled_repair;

// Value and flags of a vertex, with its index.
typedef struct {
    // The vertex.
    uint32_t vertex;
    // In the unit of the kind that was asked for.
    float value[3];
    // `UNTANGLED_INSIDE` and so on.
    uint32_t flags;
} untangled_entry;

// A vertex and its side of a pair of paths.
typedef struct {
    // The vertex.
    uint32_t vertex;
    // `4 * pair + side`, side 1 or 2, 3 for both; `0xffffffff` for both sides of every pair.
    uint32_t label;
} untangled_label;

// What a sparse correction lists. Addresses are valid as long as those of the correction.
typedef struct {
    // Whether the correction came sparse.
    bool is_sparse;
    // Number of entries.
    size_t num_entries;
    // The vertices that have a value or a flag other than pinned, ascending.
    const untangled_entry *entries;
    // Number of labels; 0 where they were not asked for.
    size_t num_labels;
    // Labels, ascending by vertex.
    const untangled_label *labels;
} untangled_sparse_view;

// A filter of contacts; `{0}` is none.
typedef struct {
    // Its number.
    uint64_t id;
} untangled_contacts;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Why the last call of this thread that failed did so, in words, UTF-8. It is valid until the next call of this
// thread.
const char *untangled_last_error(void);

// Whether a simulation should go on without help for this step, and try again with the next one.
bool untangled_is_transient(int32_t code);

// Writes what a registration is before anything is said: empty, single precision, displacements.
//
// # Safety
// `registration` is null, or a registration may be written there.
untangled_error untangled_registration_init(untangled_registration *registration);

// `UNTANGLED_ABI_VERSION` of the library that was linked, to compare with that of the header.
uint32_t untangled_abi_version(void);

// Connects to the daemon of a domain, waiting up to `timeout_us` microseconds for it to come up; later requests may
// take as long. `domain` null is the environment variable `UNTANGLED_DOMAIN`, else `default`.
//
// # Safety
// `domain` is null or ends in a zero byte; `client` is null or may be written.
untangled_error untangled_connect(const char *domain, uint64_t timeout_us, untangled_client *client);

// Ends a connection. Its sessions live on.
untangled_error untangled_disconnect(untangled_client client);

// Opens a session; everything that `registration` points to is copied.
//
// # Safety
// `registration` is null or points to one whose addresses are null or hold as many elements as it says; `session` is
// null or may be written.
untangled_error untangled_register(untangled_client client,
                                   const untangled_registration *registration,
                                   untangled_session *session);

// Opens a session of which some vertices belong to bodies: the host alone moves them, cloth belongs outside of them,
// and they get no corrections. A triangle has all of its corners among them, or none; bodies may intersect each other
// and themselves. A daemon that does not know bodies is `UNTANGLED_REFUSED`. Everything that is pointed to is copied.
//
// # Safety
// As `untangled_register`; `body` is null or holds `num_body` vertex indices.
untangled_error untangled_register_with_body(untangled_client client,
                                             const untangled_registration *registration,
                                             const uint32_t *body,
                                             size_t num_body,
                                             untangled_session *session);

// Ends a session and tells the daemon, which has a second to take note. What the session has lent, positions and
// corrections, must not be used any more.
untangled_error untangled_close(untangled_session session);

// A deadline in microseconds for hosts that have no frame rate to keep: 0.2 s, and 20 microseconds for each triangle;
// 0 for no session.
uint64_t untangled_default_deadline_us(untangled_session session);

// Number of vertices of a session; 0 for no session.
size_t untangled_num_vertices(untangled_session session);

// Vertices that became one with an earlier one in their place, where a session was registered with `UNTANGLED_WELD`;
// else 0.
size_t untangled_num_welded_vertices(untangled_session session);

// How often a session was registered, more than once if a daemon went away; 0 for no session.
uint32_t untangled_num_registrations(untangled_session session);

// Replaces a session's settings from the next frame on; names left out take the daemon's defaults.
//
// # Safety
// `settings_json` is null or ends in a zero byte.
untangled_error untangled_update_settings(untangled_session session, const char *settings_json, uint64_t timeout_us);

// The daemon's state as a JSON document (schema `untangled.status/1`) that ends in a zero byte. Its length without
// that goes to `length`; a `buffer` of `capacity` bytes that is too short is `UNTANGLED_INVALID_ARGUMENT`, and null
// with 0 asks for the length alone.
//
// # Safety
// `buffer` is null or `capacity` bytes may be written there; `length` is null or may be written.
untangled_error untangled_status(untangled_client client, char *buffer, size_t capacity, size_t *length);

// Begins a frame of a session in single precision: `positions` becomes the address of `num_vertices x 3` numbers in
// shared memory, in metres. They hold what an earlier frame left there: write all of them, then call
// `untangled_send_frame`. One frame at a time.
//
// # Safety
// `positions` is null or may be written.
untangled_error untangled_begin_frame(untangled_session session, double simulated_s, double dt_s, float **positions);

// `untangled_begin_frame` of a session in double precision.
//
// # Safety
// `positions` is null or may be written.
untangled_error untangled_begin_frame_f64(untangled_session session,
                                          double simulated_s,
                                          double dt_s,
                                          double **positions);

// Sends the frame that was begun; its number goes to `frame`, unless that is null. The positions must not be used any
// more, also after an error, except `UNTANGLED_INVALID_ARGUMENT`, which leaves the frame begun.
//
// # Safety
// `frame` is null or may be written.
untangled_error untangled_send_frame(untangled_session session, uint64_t *frame);

// Drops the frame that was begun. The positions must not be used any more.
untangled_error untangled_abandon_frame(untangled_session session);

// Waits for the correction of a frame, up to `deadline_us` microseconds. Release what it wrote to `correction`; a
// session can hold three.
//
// # Safety
// `correction` is null or may be written.
untangled_error untangled_wait(untangled_session session,
                               uint64_t frame,
                               uint64_t deadline_us,
                               untangled_correction *correction);

// The newest correction that has come since the last call; `UNTANGLED_NOTHING_NEW` where none has. Does not block.
//
// # Safety
// `correction` is null or may be written.
untangled_error untangled_newest(untangled_session session, untangled_correction *correction);

// Copies `num_vertices x 3` positions into a frame, sends it, and waits for its correction: lock step in one call, for
// hosts that keep their positions elsewhere. `num_vertices` must be the session's.
//
// # Safety
// `positions` is null or holds `num_vertices x 3` numbers; `correction` is null or may be written.
untangled_error untangled_exchange(untangled_session session,
                                   double simulated_s,
                                   double dt_s,
                                   const float *positions,
                                   size_t num_vertices,
                                   uint64_t deadline_us,
                                   untangled_correction *correction);

// Gives a correction back, and clears it. Its addresses must not be used any more.
//
// # Safety
// `correction` is null or points to one.
untangled_error untangled_release(untangled_session session, untangled_correction *correction);

// Whether a session has repairs: where it was registered with `UNTANGLED_REPAIRS`, by a daemon that knows them.
bool untangled_has_repairs(untangled_session session);

// Asks for a repair of the next frame that is sent, by whatever call. Its correction comes as ever; the repair comes
// beside it when it is done, see `untangled_poll_repair`. With `time_us` the daemon sends the best state so far early
// enough to be here within that time; with 0 the setting `repair_deadline_us` limits it.
untangled_error untangled_ask_for_repair(untangled_session session, uint64_t time_us);

// The newest repair that has come since the last call; `UNTANGLED_NOTHING_NEW` where none has. Does not block. Add its
// displacements to the positions of its frame, or to those of now. What was handed out is taken as added: repairs of
// frames that were sent before are dropped. Release what it wrote to `repair`; a session can hold one.
//
// # Safety
// `repair` is null or may be written.
untangled_error untangled_poll_repair(untangled_session session, untangled_repair *repair);

// Waits for the repair of a frame, up to `deadline_us` microseconds. Release what it wrote to `repair`.
//
// # Safety
// `repair` is null or may be written.
untangled_error untangled_wait_repair(untangled_session session,
                                      uint64_t frame,
                                      uint64_t deadline_us,
                                      untangled_repair *repair);

// Copies `num_vertices x 3` positions into a frame that asks for a repair, sends it, and waits for that: one exchange
// from a tangled cloth to one that is certified clean, or to the best that is reached within the deadline.
// `num_vertices` must be the session's. Release what it wrote to `repair`.
//
// # Safety
// `positions` is null or holds `num_vertices x 3` numbers; `repair` is null or may be written.
untangled_error untangled_exchange_repair(untangled_session session,
                                          double simulated_s,
                                          double dt_s,
                                          const float *positions,
                                          size_t num_vertices,
                                          uint64_t deadline_us,
                                          untangled_repair *repair);

// `untangled_exchange_repair` of a session in double precision.
//
// # Safety
// `positions` is null or holds `num_vertices x 3` numbers; `repair` is null or may be written.
untangled_error untangled_exchange_repair_f64(untangled_session session,
                                              double simulated_s,
                                              double dt_s,
                                              const double *positions,
                                              size_t num_vertices,
                                              uint64_t deadline_us,
                                              untangled_repair *repair);

// Gives a repair back, and clears it. Its addresses must not be used any more.
//
// # Safety
// `repair` is null or points to one.
untangled_error untangled_release_repair(untangled_session session, untangled_repair *repair);

// Says that the next frame is no continuation of those before: with the setting `repair` = `auto` the daemon then
// begins anew to judge progress.
untangled_error untangled_begin_motion(untangled_session session);

// Whether a session gets sparse corrections, as asked for by `UNTANGLED_SPARSE`: not from a daemon that is too old.
bool untangled_is_sparse(untangled_session session);

// Whether a session gets labels, as asked for by `UNTANGLED_LABELS`: not from a daemon that is too old.
bool untangled_has_labels(untangled_session session);

// Entries and labels of a correction that came sparse; of one that did not, `sparse` becomes all zero. The addresses
// are valid as long as those of the correction.
//
// # Safety
// `correction` is null or points to one; `sparse` is null or may be written.
untangled_error untangled_sparse(untangled_session session,
                                 const untangled_correction *correction,
                                 untangled_sparse_view *sparse);

// Makes a filter for the contacts of a cloth of so many vertices; it switches none off. Free it with
// `untangled_contacts_free`.
//
// # Safety
// `contacts` is null or may be written.
untangled_error untangled_contacts_create(size_t num_vertices, untangled_contacts *contacts);

// Gives a filter back.
untangled_error untangled_contacts_free(untangled_contacts contacts);

// Gives a filter the labels of a frame, those of `untangled_sparse`, in place of those before. They are copied.
//
// # Safety
// `labels` is null or holds `num_labels` of them.
untangled_error untangled_contacts_set(untangled_contacts contacts, const untangled_label *labels, size_t num_labels);

// Says of contacts between a vertex and a face each whether they have to be off: those between the two sides of one
// pair of paths, and no others. `vertices` holds `num_contacts` indices, `faces` `num_contacts x 3`, those of the
// corners; `off` becomes true or false for each. Indices beyond the cloth have no labels. Calls of several threads on
// one filter wait for each other; let each thread have its own, or ask for many contacts at a time.
//
// # Safety
// `vertices` and `faces` are null or hold that many numbers; `off` is null or may be written so often.
untangled_error untangled_vertex_faces_off(untangled_contacts contacts,
                                           const uint32_t *vertices,
                                           const uint32_t *faces,
                                           size_t num_contacts,
                                           bool *off);

// Says of contacts between two edges each whether they have to be off; `first` and `second` hold `num_contacts x 2`
// indices of vertices. See `untangled_vertex_faces_off`.
//
// # Safety
// `first` and `second` are null or hold that many numbers; `off` is null or may be written so often.
untangled_error untangled_edge_edges_off(untangled_contacts contacts,
                                         const uint32_t *first,
                                         const uint32_t *second,
                                         size_t num_contacts,
                                         bool *off);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* UNTANGLED_H */
