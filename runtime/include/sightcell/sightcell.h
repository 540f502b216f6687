/* Sightcell runtime: which polygons of a scene can be seen from where the camera is. C11.
 *
 * A .pvs file (made by `sightcell bake`) divides the places a camera can be into view cells and stores for each cell
 * the polygons that can be seen from anywhere in it. Open the file once (sightcell_db), make one sightcell_view per
 * camera, call sightcell_view_move every frame and take what to draw as draw ranges, as an index list or as source ids.
 *
 * Axes and units: glTF's, right-handed, +Y up, metres, world space of the baked scene.
 * Polygon: one triangle of one draw. Source ids 0 .. polygon_count-1 number the polygons of the glTF scene in the order
 *   nodes depth-first, primitives, instances, triangles. Stored numbers 0 .. polygon_count-1 number them in the order
 * of the file. Draw: one (node, primitive, instance) of the glTF. Host layout: in an instanced file a host issues
 * draws; stored numbers go draw by draw, and draw d owns first_stored .. first_stored + polygon_count - 1. For a merged
 * file (bake --layout merged) a host has flattened its scene into world space, so that all draws of one material are
 * one list of polygons, a draw group, which it issues instead; stored numbers go group by group, and those of a group's
 * draws are mixed. A draw that moves is a group of its own. Fail open: whenever the runtime cannot know what is seen
 * (outside all cells, a NaN, a damaged file) the view says SIGHTCELL_FRAME_DRAW_ALL and every output returns
 * everything, so a host that ignores flags draws too much, never too little. Errors: every function that can fail
 * returns a sightcell_status. A null pointer or a number out of range is SIGHTCELL_ERR_ARGUMENT; outputs are left alone
 * then, unless a function says otherwise. Nothing is logged. Lists: a function that fills dst takes its capacity in
 * elements and always sets *count to the number of elements there are. When they do not fit it returns
 * SIGHTCELL_ERR_CAPACITY and writes nothing to dst; with capacity 0 dst may be NULL: that is how to ask for the size.
 * Memory: opening and sightcell_view_create allocate, through the given allocator only; nothing that runs per frame
 * does. Threads: a sightcell_db may be used by any number of threads at once; a sightcell_view by one at a time.
 * Different views are independent. Since: everything here is there since API version 1.
 */
#ifndef SIGHTCELL_SIGHTCELL_H
#define SIGHTCELL_SIGHTCELL_H

#include <stddef.h>
#include <stdint.h>

/* SIGHTCELL_STATIC: the runtime is linked as a static library. SIGHTCELL_EXPORTS: set while building the shared one. */
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

#define SIGHTCELL_API_VERSION 1

/* What a frame's cell says outside all cells. */
#define SIGHTCELL_NO_CELL 0xFFFFFFFFu
/* Of a draw that is in no named group. */
#define SIGHTCELL_NO_NAMED_GROUP 0xFFFFFFFFu

typedef enum sightcell_status {
  SIGHTCELL_OK = 0,
  SIGHTCELL_ERR_ARGUMENT = 1,    /* a null pointer, a number out of range, a NaN */
  SIGHTCELL_ERR_MEMORY = 2,      /* the allocator returned NULL */
  SIGHTCELL_ERR_CAPACITY = 3,    /* dst is too small; *count says what is needed */
  SIGHTCELL_ERR_STALE = 4,       /* too old to say what changed: take the full list */
  SIGHTCELL_ERR_IO = 10,         /* the file cannot be opened or read */
  SIGHTCELL_ERR_NOT_OURS = 20,   /* not a .pvs file */
  SIGHTCELL_ERR_VERSION = 21,    /* a .pvs file of another version */
  SIGHTCELL_ERR_TRUNCATED = 22,  /* fewer bytes than the file says it has */
  SIGHTCELL_ERR_CHECKSUM = 23,   /* damaged: a checksum differs */
  SIGHTCELL_ERR_CORRUPT = 24,    /* contradicts itself */
  SIGHTCELL_ERR_LIMIT = 25,      /* a number above what the format, or this machine, can hold */
  SIGHTCELL_ERR_OTHER_SCENE = 26 /* belongs to another scene; nothing returns it yet */
} sightcell_status;

/* What a view shows outside all cells. */
enum {
  SIGHTCELL_OUTSIDE_ALL = 0,     /* everything */
  SIGHTCELL_OUTSIDE_NEAREST = 1, /* the set of the nearest cell */
  SIGHTCELL_OUTSIDE_LAST = 2     /* the set of the cell that was left */
};

/* Bits of sightcell_frame.flags. */
enum {
  SIGHTCELL_FRAME_CHANGED = 1u,  /* what is to be drawn differs from the move before; always set by the first move */
  SIGHTCELL_FRAME_DRAW_ALL = 2u, /* nothing is known: every output returns everything that is not hidden by name */
  SIGHTCELL_FRAME_OUTSIDE = 4u,  /* the eye is in no cell */
  SIGHTCELL_FRAME_PENDING = 8u,  /* the cell is still on its way; comes with DRAW_ALL; only after open_source */
  SIGHTCELL_FRAME_DAMAGED = 16u  /* the cell's data is damaged; comes with DRAW_ALL */
};

/* What one move found. 64 bytes for ever. */
typedef struct sightcell_frame {
  uint32_t cell;          /* number of the view cell, SIGHTCELL_NO_CELL outside */
  uint32_t flags;         /* SIGHTCELL_FRAME_* */
  uint32_t polygon_count; /* polygons to draw; all of them under DRAW_ALL */
  uint32_t revision;      /* 0 before the first move; one more with each change of what is to be drawn; wraps around */
  uint32_t reserved[12];  /* 0 */
} sightcell_frame;

/* count polygons of one draw in stored order; first counts from the draw's first polygon. In a primitive's permuted
 * index buffer that is indices 3*first .. 3*(first+count)-1. In a merged file draw is a draw group, and in the index
 * buffer of the whole scene, with f the first_stored of any of its draws, that is 3*(f+first) .. 3*(f+first+count)-1.
 */
typedef struct sightcell_range {
  uint32_t draw, first, count;
} sightcell_range;

/* One indirect draw, in the layout of GL's DrawElementsIndirectCommand and Vulkan's VkDrawIndexedIndirectCommand. */
typedef struct sightcell_command {
  uint32_t index_count, instance_count, first_index, base_vertex, first_instance;
} sightcell_command;

/* One draw of the baked scene: where it comes from in the glTF and which polygons are its own. */
typedef struct sightcell_draw {
  uint32_t node, mesh, primitive, instance; /* glTF indices; instance of EXT_mesh_gpu_instancing, else 0 */
  uint32_t material;                        /* glTF index, 0xFFFFFFFF for the default material */
  uint32_t group;         /* draw group of a merged file, of one material, ascending from 0 with no gap; else 0 */
  uint32_t first_source;  /* source id of its first polygon */
  uint32_t polygon_count; /* may be 0 */
  uint32_t first_stored;  /* stored number of its, or of its draw group's, first polygon */
  uint32_t base_vertex;   /* vertices of all draws before this one in the source */
  uint64_t host_tag;      /* the host's own value, carried through */
} sightcell_draw;

/* Facts about a file. */
typedef struct sightcell_info {
  uint32_t struct_size; /* the caller sets it to sizeof(sightcell_info) before the call */
  uint32_t format_version;
  uint32_t layout; /* 0 instanced, 1 merged */
  uint32_t polygon_count, cell_count, draw_count;
  uint32_t range_bound;  /* the most ranges that sightcell_view_ranges ever returns for this file */
  float margin;          /* metres by which cells were grown for the bake: how far an old cell is kept */
  float max_pixel_error; /* largest proved bound of any cell, 0..1; 1 where a cell has none */
  float confidence;      /* of that bound, 0..1 */
  uint8_t scene_fingerprint[16];
} sightcell_info;

/* A polygon, by its source id, that a host found missing from an eye in world space. */
typedef struct sightcell_miss {
  double eye[3];
  uint32_t polygon;
  uint32_t reserved; /* 0 */
} sightcell_miss;

/* What a view did so far. */
typedef struct sightcell_view_stats {
  uint32_t struct_size; /* the caller sets it to sizeof(sightcell_view_stats) before the call */
  uint32_t reserved;
  uint64_t moves;          /* sightcell_view_move and sightcell_view_move_box */
  uint64_t rows_decoded;   /* cells whose sets were decoded for them */
  uint64_t changes;        /* moves that changed what is to be drawn */
  uint64_t moves_outside;  /* with OUTSIDE */
  uint64_t moves_pending;  /* with PENDING */
  uint64_t moves_draw_all; /* with DRAW_ALL, for whatever reason */
  uint64_t polygons;       /* sum of polygon_count over all moves */
} sightcell_view_stats;

/* What a db takes, and what went in and out of one that is read piece by piece, where it is not 0. */
typedef struct sightcell_db_stats {
  uint32_t struct_size;        /* the caller sets it to sizeof(sightcell_db_stats) before the call */
  uint32_t chunk_count;        /* of rows, 64 cells each */
  uint64_t memory_bytes;       /* of the allocator, without views; with the file's bytes where the db owns them */
  uint64_t resident_bytes;     /* of chunks that are in memory now */
  uint64_t requests;           /* for chunks */
  uint64_t delivered_bytes;    /* of chunks that were good */
  uint64_t evictions;          /* chunks that made room for others */
  uint64_t refused_deliveries; /* of which sightcell_db_deliver did not say OK */
} sightcell_db_stats;

/* Kinds of lines that sightcell_view_debug_lines writes. */
enum {
  SIGHTCELL_DEBUG_CELL = 1u,      /* the box of the cell that the eye is in */
  SIGHTCELL_DEBUG_KEPT = 2u,      /* the same grown by the margin, in which the cell is kept */
  SIGHTCELL_DEBUG_NEIGHBORS = 4u, /* the boxes of other cells that touch the grown one, 64 at most */
  SIGHTCELL_DEBUG_VOLUMES = 8u    /* volumes that can be seen */
};

/* One edge of a box, in metres relative to the view's origin. */
typedef struct sightcell_debug_line {
  float from[3], to[3];
  uint32_t kind;   /* one SIGHTCELL_DEBUG_* */
  uint32_t number; /* of the cell or volume */
} sightcell_debug_line;

/* Where memory comes from. alloc returns size bytes at a multiple of align (a power of two, at most 16), or NULL;
 * release gets back the block with its size. Called only while opening, closing, checking, creating and destroying, on
 * the calling thread. */
typedef struct sightcell_allocator {
  void* (*alloc)(void* user, size_t size, size_t align);
  void (*release)(void* user, void* block, size_t size);
  void* user;
} sightcell_allocator;

/* Where the bytes of a file come from that is read piece by piece. request asks for size bytes from offset on; they
 * come by sightcell_db_deliver with the same ticket, from any thread, before request returns or later. Anything but OK:
 * they will not come. Every request is to be answered, by bytes or by NULL: a chunk whose answer is lost is asked for
 * again only when 64 requests came after it. Called by sightcell_db_open_source, sightcell_view_move, sightcell_view_move_box and
 * sightcell_db_prefetch on their thread. */
typedef struct sightcell_source {
  void* user;
  uint64_t size; /* of the whole file, bytes */
  sightcell_status (*request)(void* user, uint64_t offset, uint32_t size, uint32_t ticket);
} sightcell_source;

typedef struct sightcell_db sightcell_db;     /* one file; shared by threads */
typedef struct sightcell_view sightcell_view; /* one camera of one db; one thread at a time */

/* SIGHTCELL_API_VERSION of the library that is really linked. */
SIGHTCELL_API uint32_t sightcell_version(void);
/* One English line; static storage, never NULL, any value. */
SIGHTCELL_API const char* sightcell_status_text(sightcell_status status);

/* Opens a file that lies in memory. bytes: the whole file, size bytes, any alignment; they are viewed, not copied, and
 * must stay until sightcell_db_close. mem: copied; NULL for malloc and free. *out: the db, NULL on failure.
 * Checks all but the rows, which are checked 64 cells at a time when first used. One allocation of about 60 bytes per
 * cell (48 per 8 x 8 places where cells lie on a lattice, so 0.75 per cell at best), 12 per draw or draw group, 4 per
 * polygon of a primitive (once for all its instances; of a merged file, 4 per polygon) and 110,000 for the code tables.
 * Fails with any status from ARGUMENT, MEMORY and NOT_OURS to LIMIT. */
SIGHTCELL_API sightcell_status sightcell_db_open(const void* bytes, size_t size, const sightcell_allocator* mem,
                                                 sightcell_db** out);
/* The same for a file on disk (path: UTF-8), which is read whole into memory of the allocator. Also fails with IO, and
 * always so in the module for web pages, which has no files. */
SIGHTCELL_API sightcell_status sightcell_db_open_file(const char* path, const sightcell_allocator* mem,
                                                      sightcell_db** out);
/* The same for a file of which only what open needs stays in memory, and of the rows resident_bytes at most: chunks of
 * 64 cells, of which those used longest ago go first. source: copied. *out is set before the first request, so that the
 * host can deliver; requests of open are answered before they return. Allocates the front of the file (all but rows),
 * resident_bytes or all rows, whichever is less, and tables as sightcell_db_open, with 36 bytes per 64 cells more. Also
 * fails with IO (nothing was delivered), with CAPACITY when a chunk is larger than resident_bytes, with VERSION for
 * files of version 0, LIMIT when the front is 4 GiB or more, and with what request returned. */
SIGHTCELL_API sightcell_status sightcell_db_open_source(const sightcell_source* source, const sightcell_allocator* mem,
                                                        uint64_t resident_bytes, sightcell_db** out);
/* Brings what was asked for: bytes is read during the call alone. Any thread. NULL: it could not be read, and will be
 * asked for again when it is needed. OK; STALE: nobody waits for the ticket (delivered twice, or given up for later
 * requests); TRUNCATED, CORRUPT: too few or too many bytes, which will be asked for again; CHECKSUM: damaged, so that
 * its cells are DAMAGED from now on; CAPACITY: all that is in memory was wanted later than this; ARGUMENT. Allocates
 * nothing. O(chunks in memory). */
SIGHTCELL_API sightcell_status sightcell_db_deliver(sightcell_db* db, uint32_t ticket, const void* bytes,
                                                    uint32_t size);
/* Asks for chunks that a camera may need which is at eye (metres, world space) and moves by velocity (metres per
 * second) for so many seconds, those it may reach first coming first, up to resident_bytes in all and 32 requests a
 * call. It may turn: half of the way it has gone counts on either side. Any thread, every frame or now and then.
 * Allocates nothing. O(chunks). OK and nothing to do for a file that lies in memory. ARGUMENT: numbers that are not
 * finite, seconds below 0. */
SIGHTCELL_API sightcell_status sightcell_db_prefetch(sightcell_db* db, const float eye[3], const float velocity[3],
                                                     float seconds);
/* Gives all memory back. Destroy the views first. NULL is fine. */
SIGHTCELL_API void sightcell_db_close(sightcell_db* db);

/* Polygons of the scene; 0 for NULL. */
SIGHTCELL_API uint32_t sightcell_db_polygon_count(const sightcell_db* db);
/* View cells, numbered 0 .. count-1; 0 for NULL. */
SIGHTCELL_API uint32_t sightcell_db_cell_count(const sightcell_db* db);
/* The half-open box of a cell in metres: min <= p < max. ARGUMENT: no such cell. */
SIGHTCELL_API sightcell_status sightcell_db_cell_box(const sightcell_db* db, uint32_t cell, float min[3], float max[3]);
/* Volumes: coarse boxes of the space in which something may move, numbered 0 .. count-1, which cells see or do not see
 * as they do polygons (bake --volumes). They are counted nowhere else, and never drawn. 0 for NULL and for files
 * without. */
SIGHTCELL_API uint32_t sightcell_db_volume_count(const sightcell_db* db);
/* The box of a volume in metres: min <= p < max. ARGUMENT: no such volume. */
SIGHTCELL_API sightcell_status sightcell_db_volume_box(const sightcell_db* db, uint32_t volume, float min[3],
                                                       float max[3]);
/* Named groups: draws that the scene gave a name to (extras.sightcell.group), such as a door or a switch, numbered
 * 0 .. count-1. They never hide anything, so a host may show and hide them at run time without a new bake: by itself,
 * or with sightcell_view_show_named_group. Draws of one draw group of a merged file are all in the same one. 0 for
 * NULL. */
SIGHTCELL_API uint32_t sightcell_db_named_group_count(const sightcell_db* db);
/* The name of one in UTF-8, without a zero at the end. capacity and *count in bytes. ARGUMENT: no such group. */
SIGHTCELL_API sightcell_status sightcell_db_named_group_name(const sightcell_db* db, uint32_t group, char* dst,
                                                             size_t capacity, size_t* count);
/* *group: the one with that name (UTF-8, with a zero at the end), SIGHTCELL_NO_NAMED_GROUP where there is none. */
SIGHTCELL_API sightcell_status sightcell_db_find_named_group(const sightcell_db* db, const char* name, uint32_t* group);
/* Which one each draw is in, or SIGHTCELL_NO_NAMED_GROUP, in draw order. capacity and *count in draws. */
SIGHTCELL_API sightcell_status sightcell_db_named_groups_of_draws(const sightcell_db* db, uint32_t* dst,
                                                                  size_t capacity, size_t* count);
/* Facts about the file. out->struct_size must be set; ARGUMENT when it is smaller than this struct. A larger one (of a
 * later header) is filled as far as this library knows it, and struct_size says how far. */
SIGHTCELL_API sightcell_status sightcell_db_info(const sightcell_db* db, sightcell_info* out);
/* Reads the whole file and checks everything: for tools. Allocates for the time of the call. OK or the first fault. IO
 * after open_source: the file is not there. */
SIGHTCELL_API sightcell_status sightcell_db_check(const sightcell_db* db);
/* The draw table in draw order. capacity and *count in draws. */
SIGHTCELL_API sightcell_status sightcell_db_draws(const sightcell_db* db, sightcell_draw* dst, size_t capacity,
                                                  size_t* count);
/* source_id_of_stored[s]: the source id of stored polygon s; permute your index buffers with it once after loading. In
 * a merged file, the indices of polygon s are base_vertex of the draw that has the source id, plus its own.
 * capacity and *count in polygons. */
SIGHTCELL_API sightcell_status sightcell_db_order(const sightcell_db* db, uint32_t* source_id_of_stored,
                                                  size_t capacity, size_t* count);

/* A camera, before its first move: revision 0, sees nothing. Allocates all that it will ever need: about 110 bytes per
 * range of the largest cell set. db must outlive it. *out: the view, NULL on failure. MEMORY. */
SIGHTCELL_API sightcell_status sightcell_view_create(const sightcell_db* db, sightcell_view** out);
/* NULL is fine. */
SIGHTCELL_API void sightcell_view_destroy(sightcell_view* view);

/* The camera is now at eye. All decoding happens here, and only when the cell changes. The cell: the old one while eye
 * is inside its box grown by info.margin and in no cell of smaller volume; else the cell that holds eye, of several
 * that of the smallest volume, then the lowest number; else outside. Both eyes of a headset fit one view when the
 * margin exceeds their distance. Outside all cells: OK, DRAW_ALL | OUTSIDE. Damaged cell: OK, DRAW_ALL | DAMAGED, other
 * cells work. ARGUMENT: eye is NULL or holds a NaN, or frame is NULL; the view then draws all, and frame (if there is
 * one) says so. Allocates nothing. */
SIGHTCELL_API sightcell_status sightcell_view_move(sightcell_view* view, const float eye[3], sightcell_frame* frame);

/* The camera is somewhere in a box, both ends included: two eyes, a server's guess, a frame ahead. The cell of its
 * center where that cell's grown box holds all of it. Else what any of the cells sees that the box touches; where that
 * makes more than info.range_bound ranges, the smallest gaps between them are drawn as well. frame->cell is that of the
 * center. OUTSIDE when part of the box is in no grown box, with DRAW_ALL by SIGHTCELL_OUTSIDE_ALL; DRAW_ALL when
 * it touches more than 64 cells. Costs what moving into each of the cells costs. Otherwise as sightcell_view_move, also
 * ARGUMENT when min is above max. */
SIGHTCELL_API sightcell_status sightcell_view_move_box(sightcell_view* view, const float min[3], const float max[3],
                                                       sightcell_frame* frame);
/* What later moves show outside all cells: SIGHTCELL_OUTSIDE_*. NEAREST: the set of the nearest cell; LAST: that of the
 * cell that was shown last; both up to max_distance metres away from its box (>= 0, may be infinite), and everything
 * beyond. frame.cell stays SIGHTCELL_NO_CELL, and OUTSIDE is set. NEAREST looks at all cells, in O(chunks of 8 x 8) for
 * those on a lattice, but only when the eye has moved so far that another may be nearer. ARGUMENT: no such policy, a
 * distance below 0 or NaN. */
SIGHTCELL_API sightcell_status sightcell_view_policy(sightcell_view* view, uint32_t outside, float max_distance);
/* Where the view's eyes and boxes count from, in metres of world space, for hosts that keep the numbers near the camera
 * small: later moves and box queries mean origin + eye, in doubles. (0, 0, 0) at first. ARGUMENT: not finite. */
SIGHTCELL_API sightcell_status sightcell_view_origin(sightcell_view* view, const double origin[3]);

/* Whether later moves show a named group (shown: 0 hides it); all are shown at first. No output has polygons of a
 * hidden one, also under DRAW_ALL, and frame.polygon_count does not count them. What is behind a closed door is in the
 * sets as if it were open. The next move has CHANGED where that made a difference, and sightcell_view_changes says
 * which. O(draws). ARGUMENT: no such group. Allocates nothing. */
SIGHTCELL_API sightcell_status sightcell_view_show_named_group(sightcell_view* view, uint32_t group, uint32_t shown);

/* The functions below answer for the last move, change nothing and allocate nothing. */

/* Source ids of the polygons to draw, each once, in stored order. capacity and *count in ids; *count is
 * frame.polygon_count. */
SIGHTCELL_API sightcell_status sightcell_view_polygons(const sightcell_view* view, uint32_t* source_ids,
                                                       size_t capacity, size_t* count);
/* The same as ranges, ascending by draw, then by first; at most info.range_bound. capacity and *count in ranges. */
SIGHTCELL_API sightcell_status sightcell_view_ranges(const sightcell_view* view, sightcell_range* dst, size_t capacity,
                                                     size_t* count);
/* The same as an index list. stored_indices: the host's 3 indices per stored polygon, 3 * polygon_count in all (of its
 * own mesh each, or, in a merged file, base_vertex of its draw added); dst
 * gets those of the polygons to draw, in the order of sightcell_view_ranges: the indices of range i begin behind those
 * of the ranges before it. dst is written from front to back and never read, so it may be mapped GPU memory; it must
 * not overlap stored_indices. capacity and *count in indices. */
SIGHTCELL_API sightcell_status sightcell_view_indices(const sightcell_view* view, const uint32_t* stored_indices,
                                                      uint32_t* dst, size_t capacity, size_t* count);
/* The same as indirect draws of sightcell_command, one every `stride` bytes from dst on: 3 * polygons indices of one
 * instance; first_index 3 * range.first, so that the index buffer of its primitive begins at 0, or, in a merged file,
 * the place in the one buffer of the scene; base_vertex of the draw, in a merged file 0; first_instance the draw, or
 * draw group. min_gap: where fewer than so many polygons of a draw lie between two of its ranges they are drawn as
 * well, and both are one command; 0 and 1 draw nothing else. Ascending as ranges are; at most as many. dst is written
 * from front to back and never read, 20 bytes of each stride alone, and may have any alignment. stride below 20:
 * ARGUMENT. capacity and *count in commands. LIMIT: more than 1,431,655,765 polygons, whose indices 32 bits cannot
 * number. */
SIGHTCELL_API sightcell_status sightcell_view_commands(const sightcell_view* view, uint32_t min_gap, void* dst,
                                                       size_t stride, size_t capacity, size_t* count);
/* The same as one bit per draw, the lowest bit of the first word for draw 0: has it a polygon to draw? Bits behind the
 * last draw are 0. words: at least (info.draw_count + 63) / 64, all of which are written; CAPACITY below. Of a merged
 * file, where polygons of draws are mixed, this takes time for every polygon. */
SIGHTCELL_API sightcell_status sightcell_view_objects(const sightcell_view* view, uint64_t* bits_by_draw, size_t words);
/* Can anything in a box, both ends included, be seen from the cell that the eye is in: a player, a dynamic object, a
 * sound? In metres, relative to the view's origin. *visible: 0 when all volumes that the box touches are hidden; else
 * 1, also where it reaches beyond all volumes, in a file without volumes and under DRAW_ALL. Costs some tens of
 * nanoseconds for a box that touches few volumes. ARGUMENT: a NaN, min above max; *visible is 1 then. */
SIGHTCELL_API sightcell_status sightcell_view_box_visible(const sightcell_view* view, const float min[3],
                                                          const float max[3], uint32_t* visible);
/* What was added and removed since a revision: the current one (nothing) or the one before. STALE for any other, and
 * when one of the two is DRAW_ALL: take the full list then. Either capacity too small: CAPACITY, nothing is written,
 * both counts say what is needed. On STALE both counts are 0. */
SIGHTCELL_API sightcell_status sightcell_view_changes(const sightcell_view* view, uint32_t since_revision,
                                                      sightcell_range* added, size_t added_capacity,
                                                      size_t* added_count, sightcell_range* removed,
                                                      size_t removed_capacity, size_t* removed_count);

/* For tools and tests; none of it is needed to draw. */

/* Counts since the view was created. ARGUMENT: out->struct_size is smaller than this struct. Allocates nothing. */
SIGHTCELL_API sightcell_status sightcell_view_statistics(const sightcell_view* view, sightcell_view_stats* out);
/* Any thread. ARGUMENT: as before. Allocates nothing. */
SIGHTCELL_API sightcell_status sightcell_db_statistics(const sightcell_db* db, sightcell_db_stats* out);
/* The edges of boxes around the eye, twelve for each, to be drawn over the picture. kinds: SIGHTCELL_DEBUG_* together.
 * Boxes that would be the same to the last bit are written once for each kind. capacity and *count in lines.
 * Outside all cells there are lines of volumes alone. Allocates nothing. */
SIGHTCELL_API sightcell_status sightcell_view_debug_lines(const sightcell_view* view, uint32_t kinds,
                                                          sightcell_debug_line* dst, size_t capacity, size_t* count);
/* The text of a file that `sightcell verify --from` and `sightcell bake --misses` take: polygons that a host found
 * missing, as by comparing a full picture with the culled one, with the scene that they are of. JSON in ASCII without a
 * zero at the end. Eyes are written in steps of a nanometre. capacity and *count in bytes. ARGUMENT: no such polygon,
 * an eye that is not finite or beyond 1,000,000 km. Allocates nothing. */
SIGHTCELL_API sightcell_status sightcell_db_misses_text(const sightcell_db* db, const sightcell_miss* misses,
                                                        size_t miss_count, char* dst, size_t capacity, size_t* count);

#ifdef __cplusplus
}
#endif

#endif /* SIGHTCELL_SIGHTCELL_H */
