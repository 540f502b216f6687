/* stream.h: the C11 interface for clients of streamed scenes.
 *
 * `sightcell pack --stream` divides a scene into small files for a web server: a front, cell chunks, pages with
 * polygons, and images (docs/streaming.md). This library reads the front and the cell chunks. From the position of the
 * camera it determines which files to request next, which draws to show, and which files may be removed. The host
 * loads files, decodes pages and images, and draws:
 *
 *   1. sightcell_stream_open          with the bytes of scene.front
 *   2. sightcell_stream_view_create   once per camera
 *   3. sightcell_stream_view_move     in every frame, with the position and direction of the camera
 *   4. sightcell_stream_view_requests the files to load next, the most useful first
 *   5. sightcell_stream_deliver       with the bytes of each file that has arrived
 *   6. sightcell_stream_view_draws    the draws to show, where the frame has SIGHTCELL_STREAM_CHANGED
 *
 * The conventions of sightcell.h for coordinates, units, errors, lists, memory and versions hold here too.
 *
 * DRAWS. A page has polygons of geometries. A draw is one instance of a geometry. The host shows each draw of
 * sightcell_stream_view_draws with all polygons of its geometry that it has, in whatever page. Where pages are missing,
 * polygons are missing; none is wrong.
 *
 * FILES. Chunks, pages and image files have numbers 0 .. info.file_count - 1: first the chunks, then the pages, then
 * the image files. A file has one of four states, which all views of the scene share:
 *
 *   ABSENT     at first. Requests contain it where a view needs it.
 *   REQUESTED  the host is loading or decoding it.
 *   PRESENT    the host can draw it; of a chunk: the library has it.
 *   FAILED     the host has given it up. Requests do not contain it until the host makes it ABSENT again.
 *
 * COMPLETE CELLS. The cell of a view is complete when its pages, and at least one file of each of its images, are
 * PRESENT or FAILED. Until a new cell is complete, the view also shows the draws of the last complete one, and the
 * files of that cell are not removable. So a camera that is faster than the network sees what it saw before.
 *
 * THREADS. Functions that take a sightcell_stream may be called on any thread. A sightcell_stream_view may be used by
 * one thread at a time; different views are independent. The library starts no threads.
 *
 * MEMORY. Only open, close, deliver (of a chunk), create and destroy call the allocator. No function that runs per
 * frame does.
 */
#ifndef SIGHTCELL_STREAM_H
#define SIGHTCELL_STREAM_H

#include "sightcell/sightcell.h"

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Constants --------------------------------------------------------------------------------------------------- */

/* The most bytes of a file name, with the zero at the end. */
#define SIGHTCELL_STREAM_NAME_SIZE 40

/* sightcell_stream_file.kind */
enum {
  SIGHTCELL_STREAM_CHUNK = 0, /* view cells */
  SIGHTCELL_STREAM_PAGE = 1,  /* polygons, a .glb */
  SIGHTCELL_STREAM_IMAGE = 2  /* one version of an image */
};

/* States of files. */
enum {
  SIGHTCELL_STREAM_ABSENT = 0,
  SIGHTCELL_STREAM_REQUESTED = 1,
  SIGHTCELL_STREAM_PRESENT = 2,
  SIGHTCELL_STREAM_FAILED = 3
};

/* sightcell_stream_file.image_type */
enum {
  SIGHTCELL_STREAM_PNG = 0,
  SIGHTCELL_STREAM_JPEG = 1,
  SIGHTCELL_STREAM_WEBP = 2,
  SIGHTCELL_STREAM_KTX2 = 3,
  SIGHTCELL_STREAM_UNKNOWN = 4
};

/* Bits of sightcell_stream_draw.flags. */
enum {
  SIGHTCELL_STREAM_MOVES = 1u,     /* the host moves it: the matrix is that at rest */
  SIGHTCELL_STREAM_ALWAYS = 2u,    /* shown from every cell */
  SIGHTCELL_STREAM_HOST_SHOWS = 4u /* in no cell: only the host shows it */
};

/* Bits of sightcell_stream_frame.flags. */
enum {
  SIGHTCELL_STREAM_CHANGED = 1u,      /* sightcell_stream_view_draws returns other draws than after the last move */
  SIGHTCELL_STREAM_OUTSIDE = 4u,      /* the eye is in no cell: the view keeps its cell */
  SIGHTCELL_STREAM_PENDING = 8u,      /* the cell is not complete */
  SIGHTCELL_STREAM_UNKNOWN_CELL = 16u /* a chunk that may have the cell of the eye is not PRESENT; with PENDING */
};

/* Why a file is requested, in this order. */
enum {
  SIGHTCELL_STREAM_FOR_LOOKUP = 0, /* chunks whose box contains the eye */
  SIGHTCELL_STREAM_FOR_ALL = 1,    /* files that every cell needs */
  SIGHTCELL_STREAM_FOR_CELL = 2,   /* pages of the cell, and the first file of each of its images */
  SIGHTCELL_STREAM_FOR_DETAIL = 3, /* larger files of these images */
  SIGHTCELL_STREAM_FOR_NEXT = 4    /* chunks, pages and first images of cells that the camera can reach soon */
};

/* ---- Structs ----------------------------------------------------------------------------------------------------- */

/* Facts about a streamed scene. */
typedef struct sightcell_stream_info {
  uint32_t struct_size; /* set by the caller to sizeof(sightcell_stream_info) */
  uint32_t polygon_count;
  uint32_t geometry_count;
  uint32_t draw_count;
  uint32_t file_count; /* chunk_count + page_count + image_file_count */
  uint32_t chunk_count;
  uint32_t page_count;
  uint32_t image_file_count;
  uint32_t image_count;
  uint32_t cell_count;
  float min[3], max[3];          /* meters: a box around all draws at rest */
  uint8_t scene_fingerprint[16]; /* equals that of sightcell_info for the .pvs file of the same scene */
} sightcell_stream_info;

/* A draw: an instance of a geometry. Draws are in the order of the glTF scene. */
typedef struct sightcell_stream_draw {
  uint32_t geometry;
  uint32_t material;  /* index in the JSON text, 0xFFFFFFFF for the default material of glTF */
  uint32_t flags;     /* SIGHTCELL_STREAM_MOVES, _ALWAYS, _HOST_SHOWS */
  uint32_t object;    /* of draws that are levels of detail of one object, 0xFFFFFFFF for none: the host shows one */
  uint32_t level;     /* of detail, 0 the finest */
  uint32_t node;      /* glTF index */
  uint32_t mesh;      /* glTF index */
  uint32_t primitive; /* index in the mesh */
  uint32_t instance;  /* index in EXT_mesh_gpu_instancing, else 0 */
  float matrix[12];   /* to world space, column by column: three axes, then the translation */
} sightcell_stream_draw;

/* A file of the server. */
typedef struct sightcell_stream_file {
  uint32_t kind;   /* SIGHTCELL_STREAM_CHUNK, _PAGE, _IMAGE */
  uint32_t number; /* of the chunk or page; for an image file: of the image */
  uint32_t size;   /* bytes, without a Content-Encoding of HTTP */
  uint32_t width;  /* of an image file, pixels; 0 if unknown */
  uint32_t height;
  uint32_t image_type;                   /* SIGHTCELL_STREAM_PNG and so on */
  uint8_t hash[8];                       /* the first bytes of the SHA-256 of its contents */
  char name[SIGHTCELL_STREAM_NAME_SIZE]; /* its path on the server, next to scene.front */
} sightcell_stream_file;

/* Position and direction of a camera, in world space. */
typedef struct sightcell_stream_pose {
  float eye[3];      /* meters */
  float velocity[3]; /* meters per second */
  float forward[3];  /* direction of the view, of any length; (0, 0, 0): all directions count equally */
  float up[3];       /* not parallel to forward; need not be perpendicular to it */
  float half_width;  /* tangent of half the horizontal angle of view */
  float half_height; /* tangent of half the vertical angle of view */
} sightcell_stream_pose;

/* Result of a move. */
typedef struct sightcell_stream_frame {
  uint32_t cell; /* number of the view cell in the .pvs file; SIGHTCELL_NO_CELL before the first one is known */
  uint32_t complete_cell; /* the cell that was complete last, or SIGHTCELL_NO_CELL */
  uint32_t flags;         /* SIGHTCELL_STREAM_CHANGED, _OUTSIDE, _PENDING, _UNKNOWN_CELL */
  uint32_t missing;       /* pages of the cell, and images without a file, that are neither PRESENT nor FAILED */
  uint32_t failed;        /* pages of the cell that are FAILED */
  float weight;           /* steradians: sum of the weights of the pages of the cell */
  float weight_present;   /* steradians: of those that are PRESENT */
  uint32_t reserved[9];   /* 0 */
} sightcell_stream_frame;

/* A file to load. */
typedef struct sightcell_stream_request {
  uint32_t file;
  uint32_t reason; /* SIGHTCELL_STREAM_FOR_* */
  float weight;    /* steradians that the polygons of the page, or of the image, cover in the cell; 0 for chunks */
  uint32_t ahead;  /* how much of these polygons is probably in the view, in 64ths; 64 for images, 0 for chunks */
} sightcell_stream_request;

/* A streamed scene. Shared by threads. */
typedef struct sightcell_stream sightcell_stream;

/* A camera in one streamed scene. One thread at a time. */
typedef struct sightcell_stream_view sightcell_stream_view;

/* ---- Open and close ---------------------------------------------------------------------------------------------- */

/* Opens a streamed scene and checks its front.
 * front, size: the bytes of scene.front. Read during the call only.
 * chunk_memory: the maximum of bytes for cell chunks in memory. Chunks that views are using can exceed it.
 * mem: copied. NULL means malloc and free. May be called on any thread that opens, delivers or creates.
 * out: receives the scene, or NULL on failure.
 * Fails with MEMORY, NOT_OURS, VERSION, TRUNCATED (fewer bytes than the front requires), CORRUPT.
 * Cost: two allocations, one of which is released again: 84 bytes per draw, 60 per file, 4 per geometry, and the JSON
 *   text. */
SIGHTCELL_API sightcell_status sightcell_stream_open(const void* front, size_t size, uint64_t chunk_memory,
                                                     const sightcell_allocator* mem, sightcell_stream** out);

/* Closes a scene and releases its memory. Destroy its views first. NULL is allowed. */
SIGHTCELL_API void sightcell_stream_close(sightcell_stream* stream);

/* ---- What a scene contains --------------------------------------------------------------------------------------- */

/* Returns facts about the scene.
 * out: out->struct_size as for sightcell_db_info; at least sizeof(sightcell_stream_info) of this version. */
SIGHTCELL_API sightcell_status sightcell_stream_describe(const sightcell_stream* stream, sightcell_stream_info* out);

/* Tests whether a .pvs file and this scene were made from the same scene, for hosts that use both.
 * scene_fingerprint: that of sightcell_info.
 * Fails with OTHER_SCENE. */
SIGHTCELL_API sightcell_status sightcell_stream_same_scene(const sightcell_stream* stream,
                                                           const uint8_t scene_fingerprint[16]);

/* Copies the JSON text with the sections materials, textures, samplers and images of the glTF document.
 * dst, capacity, count: in bytes, UTF-8, without a zero at the end. */
SIGHTCELL_API sightcell_status sightcell_stream_json(const sightcell_stream* stream, char* dst, size_t capacity,
                                                     size_t* count);

/* Lists the draws.
 * dst, capacity, count: in draws. */
SIGHTCELL_API sightcell_status sightcell_stream_draws(const sightcell_stream* stream, sightcell_stream_draw* dst,
                                                      size_t capacity, size_t* count);

/* Lists the number of polygons of each geometry, with those that pages leave out.
 * dst, capacity, count: in geometries. */
SIGHTCELL_API sightcell_status sightcell_stream_geometries(const sightcell_stream* stream, uint32_t* dst,
                                                           size_t capacity, size_t* count);

/* Returns the files of an image. They have consecutive numbers, the smallest version first.
 * first, count: receive the number of its first file and how many there are; 0 without textures. */
SIGHTCELL_API sightcell_status sightcell_stream_image_files(const sightcell_stream* stream, uint32_t image,
                                                            uint32_t* first, uint32_t* count);

/* Describes a file.
 * file: its number. */
SIGHTCELL_API sightcell_status sightcell_stream_describe_file(const sightcell_stream* stream, uint32_t file,
                                                              sightcell_stream_file* out);

/* ---- Files that arrive and go ------------------------------------------------------------------------------------ */

/* Checks the bytes of a file, without any change of states.
 * Fails with TRUNCATED (another size than the front states) and CHECKSUM (other contents).
 * Cost: SHA-256 of the bytes. */
SIGHTCELL_API sightcell_status sightcell_stream_check(const sightcell_stream* stream, uint32_t file, const void* bytes,
                                                      size_t size);

/* Checks the bytes of a file that has arrived. A chunk is decoded and becomes PRESENT, so that views find its cells; if
 * memory is short, the chunks that views needed least recently become ABSENT. A page or image becomes REQUESTED: the
 * host decodes it and then makes it PRESENT.
 * bytes, size: the file, with any Content-Encoding of HTTP undone. Read during the call only.
 * Fails with TRUNCATED and CHECKSUM as sightcell_stream_check, and for a chunk with CORRUPT and MEMORY. The state does
 *   not change then: the host requests the file again, or makes it FAILED. */
SIGHTCELL_API sightcell_status sightcell_stream_deliver(sightcell_stream* stream, uint32_t file, const void* bytes,
                                                        size_t size);

/* Sets the state of a file.
 * state: SIGHTCELL_STREAM_*. Chunks become PRESENT by sightcell_stream_deliver alone: PRESENT is an ARGUMENT error for
 *   them. A chunk that is PRESENT keeps its state while a view uses it. */
SIGHTCELL_API sightcell_status sightcell_stream_set_state(sightcell_stream* stream, uint32_t file, uint32_t state);

/* Returns the state of a file, ABSENT for NULL and for a number out of range. */
SIGHTCELL_API uint32_t sightcell_stream_state(const sightcell_stream* stream, uint32_t file);

/* Lists pages and image files that are PRESENT and that no view needs for its cell or its complete cell, those first
 * that were needed least recently. A host that is short of memory releases some and makes them ABSENT.
 * dst, capacity: in files. The list ends there, without an error.
 * count: receives the number of elements written.
 * Cost: O(files * log(capacity)). */
SIGHTCELL_API sightcell_status sightcell_stream_removable(sightcell_stream* stream, uint32_t* dst, size_t capacity,
                                                          size_t* count);

/* ---- Views ------------------------------------------------------------------------------------------------------- */

/* Creates a view.
 * stream: must outlive the view.
 * out: receives the view, or NULL on failure.
 * Fails with MEMORY.
 * Cost: one allocation of 4 bytes per file. */
SIGHTCELL_API sightcell_status sightcell_stream_view_create(sightcell_stream* stream, sightcell_stream_view** out);

/* Destroys a view and releases its memory. NULL is allowed. */
SIGHTCELL_API void sightcell_stream_view_destroy(sightcell_stream_view* view);

/* Moves the camera. Takes the cell of the smallest volume whose box contains the eye; of equal ones, that of the lowest
 * number. In no cell, the view keeps the cell that it has. Before the first cell is known, it takes the nearest one of
 * the nearest chunk.
 * Fails with ARGUMENT for a null pointer and numbers that are not finite: the view is unchanged.
 * Cost: O(chunks + cells of the chunks around the eye + pages of the cell). */
SIGHTCELL_API sightcell_status sightcell_stream_view_move(sightcell_stream_view* view,
                                                          const sightcell_stream_pose* pose,
                                                          sightcell_stream_frame* frame);

/* Lists the ABSENT files that the view needs, in the order in which to load them: by reason, then by weight / bytes *
 * max(ahead, 1). Files for next cells are in the order in which the camera can reach these cells. The host makes the
 * files that it loads REQUESTED. seconds: of movement ahead, at the velocity of the last move; 0 or more. 0: nothing
 * for next cells. dst, capacity: in requests. The list ends there, without an error. count: receives the number of
 * elements written. Cost: O(chunks + pages of the cell and of up to 64 next cells, times log(capacity)). */
SIGHTCELL_API sightcell_status sightcell_stream_view_requests(sightcell_stream_view* view, float seconds,
                                                              sightcell_stream_request* dst, size_t capacity,
                                                              size_t* count);

/* Writes a bit for each draw: 1 if the host shows it. These are the draws of the cell, until it is complete those of
 * the last complete cell too, and those with SIGHTCELL_STREAM_ALWAYS.
 * bits_by_draw: draw d is bit d % 64 of word d / 64. Bits after the last draw are 0.
 * words: elements of bits_by_draw, (info.draw_count + 63) / 64 or more, all of which are written.
 * Fails with CAPACITY if there are fewer words. */
SIGHTCELL_API sightcell_status sightcell_stream_view_draws(const sightcell_stream_view* view, uint64_t* bits_by_draw,
                                                           size_t words);

#ifdef __cplusplus
}
#endif

#endif /* SIGHTCELL_STREAM_H */
