/* sightcell.h: the C11 interface of the Sightcell runtime, which gives a renderer the polygons that its camera may see.
 *
 * `sightcell bake` divides the space in which a camera moves into boxes, the view cells. It stores the potentially
 * visible set (PVS) of each cell in a .pvs file: the polygons that can be visible from some viewpoint in the cell. A
 * host is a program that uses the runtime. In each frame, the runtime finds the cell of the host's camera and returns
 * the polygons of the set of this cell:
 *
 *   1. sightcell_db_open_file     once per file
 *   2. sightcell_view_create      once per camera
 *   3. sightcell_view_move        in every frame, with the position of the camera
 *   4. an output function         such as sightcell_view_ranges, where the frame has SIGHTCELL_FRAME_CHANGED
 *
 * The following conventions hold for all functions.
 *
 * COORDINATES AND UNITS. Axes are those of glTF: right-handed, +Y up. Lengths are in meters and times in seconds.
 * Positions are in the world space of the baked scene. Where a function takes a view, they are relative to the origin
 * of the view (sightcell_view_origin). The box of a cell or volume contains the points with min <= p < max on each
 * axis.
 *
 * POLYGONS. A polygon is one triangle of one instance of one primitive. It has two numbers in 0 .. polygon_count - 1.
 * The source id is its number in the glTF scene: nodes depth-first, then the primitives of the mesh of a node, then
 * instances, then triangles. The stored number is its number in the file, which stores polygons in an order of its own.
 * sightcell_db_order maps stored numbers to source ids.
 *
 * DRAWS. A draw is one (node, primitive, instance) of the glTF scene. A host of an instanced file (the default layout
 * of the bake) keeps its meshes and issues draws. Draw d has the stored numbers first_stored .. first_stored +
 * polygon_count - 1. The draw table is NOT in source order: its order is part of the bake's result, and draw d is not
 * the d-th draw of the scene. A host finds its own object for a draw in one of four ways:
 *   - by node, primitive and instance, which are the indices of the glTF file;
 *   - by host_tag, if the host baked its own arrays and gave each draw a tag;
 *   - by geometry and name (identity.h), for importers that keep neither numbers nor the order of triangles;
 *   - by sorting a copy of the draw table by first_source: then the draws are in the order of the scene.
 *
 * INDEX BUFFERS. The host permutes its index buffers once after loading: triangle i of draw d becomes the triangle
 * source_id_of_stored[first_stored + i] - first_source of its primitive. This order is the same for all draws of one
 * primitive, so that its instances keep sharing one index buffer. (Files baked with `--order per-instance` are the
 * exception: each of their draws needs an index buffer of its own.)
 *
 * MERGED FILES. A host of a merged file (`bake --layout merged`) has flattened its scene into world space. The draws of
 * one material form a draw group, which the host issues instead of draws. A draw that moves is a group of its own, and
 * draws of different named groups or levels of detail are in different groups. Stored numbers go group by group, and
 * the polygons of the draws of one group are mixed. Descriptions of ranges and commands of draws hold for draw groups.
 *
 * EYE POSITIONS. The set of a cell is computed for the valid viewpoints in its box grown by sightcell_info.margin:
 * those that keep the bake's --player-radius (sightcell_info.player_radius) from every surface and are not inside a
 * solid. The runtime does not have the geometry, so it cannot test this. An eye inside a solid, or nearer to a surface,
 * gets the set of its cell like any other eye, and no flag reports it. Polygons that are visible from such an eye may
 * be missing from the set, and the error bound does not cover them. A host whose camera can enter solids should draw
 * everything while it is in one.
 * A cell that has no valid viewpoint is not in the file: an eye there is outside all cells.
 *
 * ERROR BOUND. The miss probability of a cell is the probability that a ray from a random valid viewpoint, in a random
 * direction, meets a polygon that the set lacks. Options and fields call it pixel error. The bake computes an upper
 * bound of it for each cell; sightcell_info.max_pixel_error is the largest one. A file may restrict the bound to a part
 * of the valid viewpoints of a cell: see sightcell_db_cell_viewpoints.
 *
 * FAIL OPEN. Where the runtime cannot know which polygons are visible (outside all cells, for a NaN, for damaged data,
 * for data that is not loaded yet) the frame has SIGHTCELL_FRAME_DRAW_ALL, and each output function returns everything
 * except the named groups that the host has hidden. A host that ignores the flags draws too much, never too little.
 *
 * ERRORS. A function that can fail returns a sightcell_status. Each of these returns SIGHTCELL_ERR_ARGUMENT for a null
 * pointer and for a number out of range; outputs are unchanged then, unless the comment of the function states
 * otherwise. The comment lists the other statuses besides OK. If the bytes of a file change while it is open, functions
 * return SIGHTCELL_ERR_CORRUPT or wrong sets, but never access memory outside of buffers. The runtime logs nothing.
 *
 * LISTS. A function that fills dst takes its capacity, and sets *count to the number of elements of the list. If they
 * do not fit, it returns SIGHTCELL_ERR_CAPACITY and writes nothing to dst. With capacity 0, dst may be NULL: a call
 * with capacity 0 returns the number.
 *
 * OWNERSHIP AND MEMORY. The caller owns each sightcell_db and sightcell_view, and closes or destroys it. Memory comes
 * from the allocator that the caller passes to open, or from malloc. Comments of the sections "Open and close" and
 * "Views" state the allocations of their functions, and sightcell_db_check allocates while it runs. No other function
 * allocates, so none that runs per frame does.
 *
 * THREADS. All functions may be called on any thread. A sightcell_db may be used by any number of threads at once. A
 * sightcell_view may be used by one thread at a time; different views are independent. The library starts no threads.
 *
 * COMPATIBILITY. Symbols, structs and values do not change within SIGHTCELL_API_VERSION; later libraries may add some.
 */
#ifndef SIGHTCELL_SIGHTCELL_H
#define SIGHTCELL_SIGHTCELL_H

#include <stddef.h>
#include <stdint.h>

/* Define SIGHTCELL_STATIC to link the static library. SIGHTCELL_EXPORTS is set only while building the shared one. */
#if defined(SIGHTCELL_STATIC)
#define SIGHTCELL_API
#elif defined(_WIN32)
#if defined(SIGHTCELL_EXPORTS)
#define SIGHTCELL_API __declspec(dllexport)
#else
#define SIGHTCELL_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define SIGHTCELL_API __attribute__((visibility("default")))
#else
#define SIGHTCELL_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Constants --------------------------------------------------------------------------------------------------- */

/* Version of this interface. sightcell_version returns the version of the linked library. */
#define SIGHTCELL_API_VERSION 1

/* Value of sightcell_frame.cell for an eye outside all cells. */
#define SIGHTCELL_NO_CELL 0xFFFFFFFFu

/* Number of the named group for a draw that is in no named group. */
#define SIGHTCELL_NO_NAMED_GROUP 0xFFFFFFFFu

/* Result of a function. */
typedef enum sightcell_status {
  SIGHTCELL_OK = 0,
  SIGHTCELL_ERR_ARGUMENT = 1,    /* null pointer, number out of range, NaN */
  SIGHTCELL_ERR_MEMORY = 2,      /* the allocator returned NULL */
  SIGHTCELL_ERR_CAPACITY = 3,    /* dst is too small; *count is the number of elements */
  SIGHTCELL_ERR_STALE = 4,       /* not known for this frame, revision or ticket */
  SIGHTCELL_ERR_ABSENT = 5,      /* the file does not have what the function needs */
  SIGHTCELL_PENDING = 6,         /* no error: the db waits for the bytes of a request */
  SIGHTCELL_ERR_IO = 10,         /* the file cannot be opened or read */
  SIGHTCELL_ERR_NOT_OURS = 20,   /* not a .pvs file */
  SIGHTCELL_ERR_VERSION = 21,    /* a .pvs file of a version that this library does not read */
  SIGHTCELL_ERR_TRUNCATED = 22,  /* fewer bytes than the header of the file requires */
  SIGHTCELL_ERR_CHECKSUM = 23,   /* damaged: a checksum differs */
  SIGHTCELL_ERR_CORRUPT = 24,    /* values that contradict each other */
  SIGHTCELL_ERR_LIMIT = 25,      /* a number beyond a limit of the format or of this machine */
  SIGHTCELL_ERR_OTHER_SCENE = 26 /* the file belongs to another scene */
} sightcell_status;

/* The set that a view returns where it has none of its own: sightcell_view_policy. */
enum {
  SIGHTCELL_OUTSIDE_ALL = 0,     /* outside all cells everything; the default */
  SIGHTCELL_OUTSIDE_NEAREST = 1, /* outside, the set of the nearest cell */
  SIGHTCELL_OUTSIDE_LAST = 2,    /* outside, the set of the cell that was left last */
  SIGHTCELL_PENDING_LAST = 16    /* added to one of these: the last set while the data of a cell has not arrived */
};

/* Bits of sightcell_frame.flags. */
enum {
  SIGHTCELL_FRAME_CHANGED = 1u,  /* the polygons to draw differ from those after the last move; set by the first move */
  SIGHTCELL_FRAME_DRAW_ALL = 2u, /* the visible polygons are not known: outputs return everything */
  SIGHTCELL_FRAME_OUTSIDE = 4u,  /* the eye is in no cell */
  SIGHTCELL_FRAME_PENDING = 8u,  /* the data of the cell has not arrived; with DRAW_ALL unless PENDING_LAST is set */
  SIGHTCELL_FRAME_DAMAGED = 16u  /* the data of the cell is damaged; with DRAW_ALL; other cells are not affected */
};

/* ---- Structs ----------------------------------------------------------------------------------------------------- */

/* Result of a move. Its size is 64 bytes in all versions. */
typedef struct sightcell_frame {
  uint32_t cell;          /* the view cell that contains the eye, or SIGHTCELL_NO_CELL */
  uint32_t flags;         /* SIGHTCELL_FRAME_* */
  uint32_t polygon_count; /* polygons to draw */
  uint32_t revision;      /* number of changes of the polygons to draw since the view was created; wraps around */
  uint32_t reserved[12];  /* 0 */
} sightcell_frame;

/* Polygons of one draw that follow each other in stored order.
 * In the permuted index buffer of its primitive these are the indices 3*first .. 3*(first+count)-1. In the one index
 * buffer of a merged scene they are 3*(f+first) .. 3*(f+first+count)-1, where f is first_stored of the draw group. */
typedef struct sightcell_range {
  uint32_t draw;  /* draw, or draw group of a merged file */
  uint32_t first; /* counted from the first polygon of the draw, or draw group */
  uint32_t count; /* 1 or more */
} sightcell_range;

/* An indirect draw: GL's DrawElementsIndirectCommand, Vulkan's VkDrawIndexedIndirectCommand. */
typedef struct sightcell_command {
  uint32_t index_count;    /* 3 per polygon */
  uint32_t instance_count; /* 1 */
  uint32_t first_index;    /* in the index buffer of the primitive, or of a merged scene */
  uint32_t base_vertex;    /* sightcell_draw.base_vertex; 0 for a merged file */
  uint32_t first_instance; /* the draw, or draw group */
} sightcell_command;

/* An entry of the draw table: the origin of a draw in the scene, and its polygons. */
typedef struct sightcell_draw {
  uint32_t node;          /* glTF index */
  uint32_t mesh;          /* glTF index */
  uint32_t primitive;     /* index in the mesh */
  uint32_t instance;      /* index in EXT_mesh_gpu_instancing, else 0 */
  uint32_t material;      /* glTF index, 0xFFFFFFFF for the default material */
  uint32_t group;         /* draw group of a merged file, 0 .. n-1 in ascending order; else 0 */
  uint32_t first_source;  /* source id of its first polygon; the ids of a draw are consecutive */
  uint32_t polygon_count; /* may be 0 */
  uint32_t first_stored;  /* stored number of the first polygon of the draw, or of its draw group */
  uint32_t base_vertex;   /* number of vertices of all draws before this one in source order */
  uint64_t host_tag;      /* the value that the host gave the draw when it baked its own arrays, else 0 */
} sightcell_draw;

/* Facts about a file. */
typedef struct sightcell_info {
  uint32_t struct_size;    /* set by the caller to sizeof(sightcell_info) */
  uint32_t format_version; /* of the file */
  uint32_t layout;         /* 0 instanced, 1 merged */
  uint32_t polygon_count;
  uint32_t cell_count;
  uint32_t draw_count;
  uint32_t range_bound;  /* the most ranges that sightcell_view_ranges returns for this file */
  float margin;          /* meters: the set of a cell holds for its box grown by this on all sides */
  float max_pixel_error; /* largest upper bound of any cell, 0 .. 1; of the miss probability, or the bake's --metric */
  float confidence;      /* with which that bound holds, 0 .. 1 */
  uint8_t scene_fingerprint[16];
  float player_radius; /* meters: what valid viewpoints keep from surfaces; 0 if the file does not state it */
} sightcell_info;

/* A reported miss: a polygon that is visible from an eye and is missing from the set of its cell. */
typedef struct sightcell_miss {
  double eye[3];     /* meters, world space */
  uint32_t polygon;  /* source id */
  uint32_t reserved; /* 0 */
} sightcell_miss;

/* Counts of a view since its creation. */
typedef struct sightcell_view_stats {
  uint32_t struct_size; /* set by the caller to sizeof(sightcell_view_stats) */
  uint32_t reserved;
  uint64_t moves;          /* calls of sightcell_view_move and sightcell_view_move_box */
  uint64_t rows_decoded;   /* sets of cells that these calls decoded */
  uint64_t changes;        /* moves with CHANGED */
  uint64_t moves_outside;  /* moves with OUTSIDE */
  uint64_t moves_pending;  /* moves with PENDING */
  uint64_t moves_draw_all; /* moves with DRAW_ALL */
  uint64_t polygons;       /* sum of polygon_count over all moves */
} sightcell_view_stats;

/* Counts of a db. A chunk is the sets of up to 64 cells. resident_bytes and the members after it are 0 for a db that is
 * not paged (sightcell_db_open_source). */
typedef struct sightcell_db_stats {
  uint32_t struct_size;        /* set by the caller to sizeof(sightcell_db_stats) */
  uint32_t chunk_count;        /* chunks of the file */
  uint64_t memory_bytes;       /* allocated for the db, with the bytes of the file that it owns, without views */
  uint64_t resident_bytes;     /* chunks that are in memory now */
  uint64_t requests;           /* requests for chunks */
  uint64_t delivered_bytes;    /* chunks that were accepted */
  uint64_t evictions;          /* chunks that were removed for others */
  uint64_t refused_deliveries; /* calls of sightcell_db_deliver that did not return OK */
} sightcell_db_stats;

/* Kinds of lines of sightcell_view_debug_lines; may be combined. */
enum {
  SIGHTCELL_DEBUG_CELL = 1u,           /* the box of the cell that contains the eye */
  SIGHTCELL_DEBUG_KEPT = 2u,           /* the same box grown by the margin, in which the view keeps the cell */
  SIGHTCELL_DEBUG_NEIGHBORS = 4u,      /* the boxes of up to 64 other cells that touch the grown box */
  SIGHTCELL_DEBUG_VOLUMES = 8u,        /* visible volumes */
  SIGHTCELL_DEBUG_OUTSIDE_REGION = 16u /* parts of the grown box that are outside the region of the cell */
};

/* One edge of a box. */
typedef struct sightcell_debug_line {
  float from[3], to[3]; /* meters, relative to the origin of the view */
  uint32_t kind;        /* one SIGHTCELL_DEBUG_* */
  uint32_t number;      /* of the cell or volume */
} sightcell_debug_line;

/* Source of memory. Only functions that open, close, check, create and destroy call it, on the thread of the caller.
 * alloc: returns size bytes at a multiple of align (a power of two, at most 16), or NULL.
 * release: takes back a block of alloc; size is the size that was passed to alloc.
 * user: passed to both. */
typedef struct sightcell_allocator {
  void* (*alloc)(void* user, size_t size, size_t align);
  void (*release)(void* user, void* block, size_t size);
  void* user;
} sightcell_allocator;

/* Source of the bytes of a paged file.
 * user: passed to request.
 * size: of the whole file, in bytes.
 * request: asks for size bytes from offset. The host passes them to sightcell_db_deliver with the same ticket, on any
 *   thread, before request returns or later. A result other than OK means that no delivery follows. Each request that
 *   returned OK needs a delivery of bytes or of NULL: without one, the chunk is requested again only after 64 other
 *   requests. sightcell_db_open_source, sightcell_db_begin_source, sightcell_db_opened, sightcell_db_prefetch,
 *   sightcell_view_move and sightcell_view_move_box call request, on their own threads. */
typedef struct sightcell_source {
  void* user;
  uint64_t size;
  sightcell_status (*request)(void* user, uint64_t offset, uint32_t size, uint32_t ticket);
} sightcell_source;

/* An open file. Shared by threads. */
typedef struct sightcell_db sightcell_db;

/* A camera in the scene of one db. One thread at a time. */
typedef struct sightcell_view sightcell_view;

/* ---- Library ----------------------------------------------------------------------------------------------------- */

/* Returns SIGHTCELL_API_VERSION of the linked library. */
SIGHTCELL_API uint32_t sightcell_version(void);

/* Returns one line of English text for a status, also for a value that is no status. The text is static, never NULL. */
SIGHTCELL_API const char* sightcell_status_text(sightcell_status status);

/* ---- Open and close ---------------------------------------------------------------------------------------------- */

/* Opens a file that is in memory. Checks all of it but the sets: the first use of a set checks those of its chunk.
 * bytes: the whole file, at any alignment. The db refers to them: the caller keeps them until sightcell_db_close. They
 *   may be a .glb that contains a .pvs file (sightcell bake --embed), but not for the WebAssembly module.
 * size: of the file, in bytes.
 * mem: copied. NULL means malloc and free.
 * out: receives the db, or NULL on failure.
 * Fails with MEMORY, NOT_OURS, VERSION, TRUNCATED, CHECKSUM, CORRUPT, LIMIT, and with ABSENT for a .glb without a .pvs
 *   file.
 * Cost: one pass over all but the sets, and of a .glb one or two over its JSON. One allocation: 40 to 60 bytes per
 *   cell (48 per 8 x 8 positions for cells on a lattice, so 0.75 per cell at best), 16 per draw (merged: 4 per draw and
 *   20 per draw group), 4 per polygon of a primitive whatever the number of its instances (merged: 4 per polygon), 4
 *   per volume plus 50 to 100 per block of 4 x 4 x 4 volumes, and 62,000 for code tables. */
SIGHTCELL_API sightcell_status sightcell_db_open(const void* bytes, size_t size, const sightcell_allocator* mem,
                                                 sightcell_db** out);

/* Opens a file on disk: reads all of it into memory of the allocator, closes it, and then does what sightcell_db_open
 * does. Of a .glb it keeps the .pvs file alone, in a block of its own.
 * path: UTF-8.
 * Fails with IO and as sightcell_db_open. The WebAssembly module has no files and always returns IO. */
SIGHTCELL_API sightcell_status sightcell_db_open_file(const char* path, const sightcell_allocator* mem,
                                                      sightcell_db** out);

/* Opens a paged file: loads everything but the sets now, and the sets when they are needed, in chunks of up to 64
 * cells: about 16 KB or less, or one cell.
 * source: copied. The host must deliver the bytes of the requests of this call before request returns.
 * resident_bytes: the maximum of bytes of chunks in memory. The least recently used chunks are removed first.
 * out: receives the db before the first request, so that request can deliver to it; NULL on failure.
 * Fails with IO (nothing was delivered), CAPACITY (a chunk is larger than resident_bytes), VERSION (also for files of
 *   version 0), LIMIT (also if all but the sets takes 4 GiB or more), the result of request, and as sightcell_db_open.
 * Cost: as sightcell_db_open, and memory for all of the file but the sets, for resident_bytes (or for all sets, if that
 *   is less), and 36 bytes per chunk. */
SIGHTCELL_API sightcell_status sightcell_db_open_source(const sightcell_source* source, const sightcell_allocator* mem,
                                                        uint64_t resident_bytes, sightcell_db** out);

/* Begins to open a paged file, for hosts that cannot answer a request before it returns, such as web pages and threads
 * that must not wait. The host then calls sightcell_db_opened, for example once per frame, until it returns OK. Until
 * then, db may be passed to sightcell_db_opened, sightcell_db_deliver and sightcell_db_close only.
 * source, mem, resident_bytes: as for sightcell_db_open_source; the host may deliver at any time.
 * out: receives the db before the first request; NULL on failure.
 * Returns PENDING, OK if everything was delivered before this returned, or fails as sightcell_db_open_source. */
SIGHTCELL_API sightcell_status sightcell_db_begin_source(const sightcell_source* source, const sightcell_allocator* mem,
                                                         uint64_t resident_bytes, sightcell_db** out);

/* Continues to open a db of sightcell_db_begin_source with what was delivered. Requests twice in all: the header of the
 * file, then everything but the sets. On one thread at a time.
 * Returns PENDING while a request waits for its delivery, and OK when the db is open, also for a db of another open
 *   function. Fails as sightcell_db_open_source, with IO where the host has delivered NULL; then the host closes the
 * db. Cost: none while PENDING; the last step costs what sightcell_db_open costs. */
SIGHTCELL_API sightcell_status sightcell_db_opened(sightcell_db* db);

/* Tests whether a file was baked from the scene that the host has.
 * scene_fingerprint: that of the host's scene, which `sightcell info` prints, or that of another open file or of
 *   sightcell_stream_info.
 * Fails with OTHER_SCENE. */
SIGHTCELL_API sightcell_status sightcell_db_same_scene(const sightcell_db* db, const uint8_t scene_fingerprint[16]);

/* Delivers the bytes of a request. May be called on any thread, also from within request.
 * ticket: of the request.
 * bytes, size: the requested bytes; read during the call only. NULL if the host could not read them: they are requested
 *   again when they are needed.
 * Fails with STALE (no request has this ticket: it was delivered before, or given up after 64 later requests),
 *   TRUNCATED and CORRUPT (too few or too many bytes; requested again), CHECKSUM (damaged: frames in its cells are
 *   DAMAGED from now on), CAPACITY (all chunks in memory are in use, or were wanted more recently), ARGUMENT also for a
 *   db that is not paged.
 * Cost: O(chunks in memory) and a copy of the bytes. */
SIGHTCELL_API sightcell_status sightcell_db_deliver(sightcell_db* db, uint32_t ticket, const void* bytes,
                                                    uint32_t size);

/* Requests the chunks that a moving camera may need soon, starting with those that it can reach first: up to
 * resident_bytes in all, and up to 32 requests per call. Does nothing for a db that is not paged.
 * eye: position, world space.
 * velocity: meters per second. The search region widens by half the distance traveled, because the camera may turn.
 * seconds: the time ahead, 0 or more.
 * Fails with ARGUMENT for numbers that are not finite.
 * Cost: O(chunks). May be called in each frame, or less often. */
SIGHTCELL_API sightcell_status sightcell_db_prefetch(sightcell_db* db, const float eye[3], const float velocity[3],
                                                     float seconds);

/* Closes a db and releases its memory. Destroy its views first. NULL is allowed. */
SIGHTCELL_API void sightcell_db_close(sightcell_db* db);

/* ---- What a file contains ---------------------------------------------------------------------------------------- */

/* Returns facts about the file.
 * out: the caller sets out->struct_size. If it differs from the size of the struct of this library, because the caller
 *   was compiled with another header, the function fills the members that both have, and sets struct_size to the size
 *   of that part. Fails with ARGUMENT if it is smaller than 56: the first struct ended with scene_fingerprint. */
SIGHTCELL_API sightcell_status sightcell_db_info(const sightcell_db* db, sightcell_info* out);

/* Returns the number of polygons of the scene, 0 for NULL. */
SIGHTCELL_API uint32_t sightcell_db_polygon_count(const sightcell_db* db);

/* Returns the number of view cells, 0 for NULL. Cells are numbered 0 .. count - 1. */
SIGHTCELL_API uint32_t sightcell_db_cell_count(const sightcell_db* db);

/* Returns the box of a cell, without the margin.
 * min, max: receive its corners, in meters of world space. */
SIGHTCELL_API sightcell_status sightcell_db_cell_box(const sightcell_db* db, uint32_t cell, float min[3], float max[3]);

/* Returns which share of a cell its error bound is about. The region of a cell is a part of its grown box, or all of
 * it. The bound holds for the valid viewpoints in the region (see EYE POSITIONS above).
 * valid_share: receives the estimated share of the region that is valid viewpoints, above 0 and at most 1.
 * outside_share: receives the upper limit, at 95 % confidence, of the share of the valid viewpoints of the grown box
 *   that are outside the region: 0 .. 1, and 0 if the region is the whole box.
 * For a file that does not state this (sightcell_info.player_radius is 0), they receive 1 and 0. */
SIGHTCELL_API sightcell_status sightcell_db_cell_viewpoints(const sightcell_db* db, uint32_t cell, float* valid_share,
                                                            float* outside_share);

/* Lists the draw table. It is not in source order: see DRAWS above.
 * dst, capacity, count: in draws. */
SIGHTCELL_API sightcell_status sightcell_db_draws(const sightcell_db* db, sightcell_draw* dst, size_t capacity,
                                                  size_t* count);

/* Lists the source id of each stored polygon: the host permutes its index buffers by it once after loading.
 * source_id_of_stored: element s receives the source id of stored polygon s. In a merged file, the indices of polygon s
 *   are the source's own plus base_vertex of the draw that has this source id.
 * capacity, count: in polygons. */
SIGHTCELL_API sightcell_status sightcell_db_order(const sightcell_db* db, uint32_t* source_id_of_stored,
                                                  size_t capacity, size_t* count);

/* Returns the number of visibility volumes, 0 for NULL and for files baked without --volumes. A volume is a coarse box
 * of space in which an object may move. The set of a cell contains the volumes that are visible from it. They are never
 * drawn, and no other count includes them. sightcell_view_box_visible tests a box against them. */
SIGHTCELL_API uint32_t sightcell_db_volume_count(const sightcell_db* db);

/* Returns the box of a volume.
 * min, max: receive its corners, in meters of world space. */
SIGHTCELL_API sightcell_status sightcell_db_volume_box(const sightcell_db* db, uint32_t volume, float min[3],
                                                       float max[3]);

/* Returns the number of named groups, 0 for NULL. A named group is the draws to which the scene gives one name
 * (extras.sightcell.group), such as a door. They never occlude anything, so a host can show and hide them at run time
 * without a new bake: in its own code, or with sightcell_view_show_named_group. The draws of one draw group of a merged
 * file are all in the same named group, or all in none. */
SIGHTCELL_API uint32_t sightcell_db_named_group_count(const sightcell_db* db);

/* Returns the name of a named group.
 * dst, capacity, count: in bytes, UTF-8, without a zero at the end. */
SIGHTCELL_API sightcell_status sightcell_db_named_group_name(const sightcell_db* db, uint32_t group, char* dst,
                                                             size_t capacity, size_t* count);

/* Finds a named group by its name. O(named groups).
 * name: UTF-8, with a zero at the end.
 * group: receives its number, or SIGHTCELL_NO_NAMED_GROUP if there is none; the function returns OK in both cases. */
SIGHTCELL_API sightcell_status sightcell_db_find_named_group(const sightcell_db* db, const char* name, uint32_t* group);

/* Lists the named group of each draw, or SIGHTCELL_NO_NAMED_GROUP, in the order of the draw table.
 * dst, capacity, count: in draws. */
SIGHTCELL_API sightcell_status sightcell_db_named_groups_of_draws(const sightcell_db* db, uint32_t* dst,
                                                                  size_t capacity, size_t* count);

/* ---- Views ------------------------------------------------------------------------------------------------------- */

/* Creates a view. Before its first move, it has revision 0 and its outputs are empty.
 * db: must outlive the view.
 * out: receives the view, or NULL on failure.
 * Fails with MEMORY, and with PENDING before sightcell_db_opened has returned OK.
 * Cost: one allocation of about 110 bytes per range of the largest set; the view needs no other. */
SIGHTCELL_API sightcell_status sightcell_view_create(const sightcell_db* db, sightcell_view** out);

/* Destroys a view and releases its memory. NULL is allowed. */
SIGHTCELL_API void sightcell_view_destroy(sightcell_view* view);

/* Sets the point that the positions of later calls are relative to, for hosts that keep coordinates near the camera
 * small. Sums are in double precision.
 * origin: meters, world space, finite. (0, 0, 0) in a new view. */
SIGHTCELL_API sightcell_status sightcell_view_origin(sightcell_view* view, const double origin[3]);

/* Sets which polygons later moves return outside all cells, where frames still have SIGHTCELL_NO_CELL and OUTSIDE, and
 * in a cell of a paged file whose data has not arrived, where frames still have PENDING.
 * outside: SIGHTCELL_OUTSIDE_*, plus SIGHTCELL_PENDING_LAST or not. With it, a move into a cell without its data keeps
 *   the set that was shown, which may lack polygons, until the data is there or a named group is shown or hidden.
 * max_distance: meters, 0 or more, may be infinite. The set of another cell holds up to this distance from the box of
 *   that cell; beyond it, the view returns everything.
 * Cost of NEAREST: a move visits all cells (on a lattice, all blocks of 8 x 8 cells), but only when the eye has moved
 *   so far that another cell may be nearer. */
SIGHTCELL_API sightcell_status sightcell_view_policy(sightcell_view* view, uint32_t outside, float max_distance);

/* Shows or hides a named group from the next move on. New views show all named groups.
 * group: its number.
 * shown: 0 hides it. Then no output contains its polygons, also under DRAW_ALL, and frame.polygon_count does not count
 *   them. Sets contain the polygons behind a closed door, as if it were open.
 * The next move has CHANGED if this changes the polygons to draw, and sightcell_view_changes returns the difference.
 * Cost: O(draws). */
SIGHTCELL_API sightcell_status sightcell_view_show_named_group(sightcell_view* view, uint32_t group, uint32_t shown);

/* ---- Moves ------------------------------------------------------------------------------------------------------- */

/* Moves the camera. Finds its cell, and decodes the set of the cell if the cell has changed.
 * The view keeps its cell while the eye is inside the box of that cell grown by info.margin and in no cell of smaller
 * volume. Else it takes the cell that contains the eye; of several, the one of the smallest volume, then of the lowest
 * number. Both eyes of a headset can share a view if the margin exceeds their distance.
 * eye: position. See EYE POSITIONS above for eyes inside solids.
 * frame: receives the result. Outside all cells: OK, with DRAW_ALL | OUTSIDE unless sightcell_view_policy changed that.
 *   A damaged cell: OK, with DRAW_ALL | DAMAGED.
 * Fails with ARGUMENT if eye is NULL or has a NaN, or frame is NULL: the view then returns everything, and *frame has
 *   DRAW_ALL unless frame is NULL.
 * Cost: a few nanoseconds while the cell stays the same, a lookup and O(runs of the set) when it changes. */
SIGHTCELL_API sightcell_status sightcell_view_move(sightcell_view* view, const float eye[3], sightcell_frame* frame);

/* Moves the camera to an unknown position in a box, such as that of two eyes, of a server's estimate or of the next
 * frames.
 * Takes the cell of the center of the box if the grown box of that cell contains all of the box. Else the result is the
 * union of the sets of all cells that the box touches; where it has more than info.range_bound ranges, the smallest
 * gaps between them are filled with polygons.
 * min, max: corners, which belong to the box. min <= max.
 * frame: as for sightcell_view_move. frame->cell is the cell of the center. The frame has OUTSIDE if a part of the box
 *   is in no grown box, with DRAW_ALL under SIGHTCELL_OUTSIDE_ALL. It has DRAW_ALL if the box touches more than 64
 *   cells.
 * Fails as sightcell_view_move, also if min is above max.
 * Cost: the sum of the moves into each of the cells. */
SIGHTCELL_API sightcell_status sightcell_view_move_box(sightcell_view* view, const float min[3], const float max[3],
                                                       sightcell_frame* frame);

/* ---- Outputs ----------------------------------------------------------------------------------------------------- */
/* These functions return the result of the last move in different forms. They do not change the view. */

/* Lists the polygons to draw as ranges, in ascending order of draws, then of first.
 * dst, capacity, count: in ranges; at most info.range_bound. */
SIGHTCELL_API sightcell_status sightcell_view_ranges(const sightcell_view* view, sightcell_range* dst, size_t capacity,
                                                     size_t* count);

/* Lists the source ids of the polygons to draw, each once, in stored order.
 * source_ids, capacity, count: in polygons; the list has frame.polygon_count. */
SIGHTCELL_API sightcell_status sightcell_view_polygons(const sightcell_view* view, uint32_t* source_ids,
                                                       size_t capacity, size_t* count);

/* Copies the indices of the polygons to draw into one index list, in the order of sightcell_view_ranges.
 * stored_indices: the host's indices in stored order, 3 * db_polygon_count elements. They count the vertices of the
 *   draw's own mesh; in a merged file base_vertex of the draw is added.
 * dst: receives 3 indices per polygon. Written from front to back and never read, so it may be mapped GPU memory. Must
 *   not overlap stored_indices.
 * capacity, count: in indices; the list has 3 * frame.polygon_count. */
SIGHTCELL_API sightcell_status sightcell_view_indices(const sightcell_view* view, const uint32_t* stored_indices,
                                                      uint32_t* dst, size_t capacity, size_t* count);

/* Lists the polygons to draw as indirect draws, in the order of sightcell_view_ranges.
 * min_gap: two ranges of a draw with fewer than min_gap polygons between them become one command, which also draws
 *   these polygons. 0 and 1 join no ranges.
 * dst: receives a sightcell_command every stride bytes, at any alignment. Written from front to back and never read;
 *   only 20 bytes of each stride are written.
 * stride: bytes, 20 or more.
 * capacity, count: in commands; never more than ranges.
 * Fails with LIMIT if the scene has more than 1,431,655,765 polygons, because their indices do not fit into 32 bits. */
SIGHTCELL_API sightcell_status sightcell_view_commands(const sightcell_view* view, uint32_t min_gap, void* dst,
                                                       size_t stride, size_t capacity, size_t* count);

/* Writes a bit for each draw: 1 if it has a polygon to draw.
 * bits_by_draw: draw d is bit d % 64 of word d / 64. Bits after the last draw are 0.
 * words: elements of bits_by_draw, (info.draw_count + 63) / 64 or more, all of which are written.
 * Fails with CAPACITY if there are fewer words.
 * Cost: O(ranges); for a merged file O(polygons to draw). */
SIGHTCELL_API sightcell_status sightcell_view_objects(const sightcell_view* view, uint64_t* bits_by_draw, size_t words);

/* Lists how large a part of the view each draw covers, so that a host can load first what is most visible. For files
 * baked with --importance (or `sightcell recode --importance`).
 * dst: receives the solid angle in steradians, out of 4 pi for the whole view, that the visible polygons of the draw
 *   cover in the mean over the valid viewpoints of the cell. 0 for a draw without a polygon to draw. The file has a
 *   class for each polygon, and each class spans a factor of 4, so a value is accurate to about a factor of 2. After
 *   sightcell_view_move_box, it is the largest value of the cells that the box touches. Elements are draws in the order
 *   of the draw table, or draw groups of a merged file in ascending order.
 * capacity, count: in draws, or draw groups.
 * Fails with ABSENT if the file has no importance, and for a paged db, which does not load it; with STALE under
 *   DRAW_ALL, because importance is not known there; with CHECKSUM or CORRUPT if the data is damaged. All elements of
 *   dst are 0 then.
 * Cost: O(polygons to draw + chunks), and some tens of microseconds for code tables. The first call in each chunk
 *   also checks their importance data. */
SIGHTCELL_API sightcell_status sightcell_view_importance(const sightcell_view* view, float* dst, size_t capacity,
                                                         size_t* count);

/* Lists the polygons that were added and removed since a revision, as ranges.
 * since_revision: frame.revision of the last frame that the caller has drawn. It must be the current revision (no
 *   differences) or the one before.
 * added, removed: with capacity and count in ranges.
 * Fails with STALE for any other revision, and if either of the two frames has DRAW_ALL: both counts are 0, and the
 *   caller takes the full list. Fails with CAPACITY if one of the lists does not fit: both counts are set, and neither
 *   list is written. */
SIGHTCELL_API sightcell_status sightcell_view_changes(const sightcell_view* view, uint32_t since_revision,
                                                      sightcell_range* added, size_t added_capacity,
                                                      size_t* added_count, sightcell_range* removed,
                                                      size_t removed_capacity, size_t* removed_count);

/* Tests whether anything in a box (a player, an object that moves, a sound) can be visible. For files with volumes.
 * min, max: corners, which belong to the box. min <= max.
 * visible: receives 0 if volumes cover the box and none that it touches is visible; else 1. So it is 1 for a file
 *   without volumes and under DRAW_ALL.
 * Fails with ARGUMENT for a NaN or if min is above max: *visible is 1 then.
 * Cost: some tens of nanoseconds for a box that touches few volumes. */
SIGHTCELL_API sightcell_status sightcell_view_box_visible(const sightcell_view* view, const float min[3],
                                                          const float max[3], uint32_t* visible);

/* ---- Tools and tests --------------------------------------------------------------------------------------------- */
/* A renderer does not need these functions. */

/* Reads the whole file and checks everything. Returns OK or the first fault.
 * Fails with CHECKSUM, CORRUPT, MEMORY (it allocates while it runs) and IO (the db is paged). */
SIGHTCELL_API sightcell_status sightcell_db_check(const sightcell_db* db);

/* Returns the counts of a db.
 * out: out->struct_size as for sightcell_db_info. */
SIGHTCELL_API sightcell_status sightcell_db_statistics(const sightcell_db* db, sightcell_db_stats* out);

/* Returns the counts of a view since its creation.
 * out: out->struct_size as for sightcell_db_info. */
SIGHTCELL_API sightcell_status sightcell_view_statistics(const sightcell_view* view, sightcell_view_stats* out);

/* Lists the edges of boxes of cells and volumes, twelve per box, which a host can draw over the picture.
 * kinds: SIGHTCELL_DEBUG_* combined. Outside all cells, the list has only lines of volumes. The boxes of OUTSIDE_REGION
 *   are the part of the grown box where the error bound of the cell does not hold, as sightcell_db_cell_viewpoints
 *   describes it. There are none if the region is the whole box.
 * dst, capacity, count: in lines.
 * Fails with CORRUPT for OUTSIDE_REGION if the region of the cell is damaged, which open does not check. */
SIGHTCELL_API sightcell_status sightcell_view_debug_lines(const sightcell_view* view, uint32_t kinds,
                                                          sightcell_debug_line* dst, size_t capacity, size_t* count);

/* Writes the text of a misses file, which `sightcell verify --from` and `sightcell bake --misses` read. It lists
 * polygons that a host found missing, for example by comparing a full picture with the culled one.
 * misses, miss_count: eyes within 1,000,000 km of the origin; they are rounded to a nanometer.
 * dst, capacity, count: in bytes, JSON in ASCII, without a zero at the end.
 * Fails with ARGUMENT for a polygon that does not exist and for an eye that is not finite or too far away. */
SIGHTCELL_API sightcell_status sightcell_db_misses_text(const sightcell_db* db, const sightcell_miss* misses,
                                                        size_t miss_count, char* dst, size_t capacity, size_t* count);

#ifdef __cplusplus
}
#endif

#endif /* SIGHTCELL_SIGHTCELL_H */
