// Made by runtime/csharp/make_package.py from the headers in runtime/include/sightcell. Edit those instead.
// The headers have the conventions of all functions, such as coordinates, lists and threads.
#pragma warning disable IDE1006 // functions have the names that they have in C

using System;
using System.Runtime.InteropServices;
using System.Security;

namespace Sightcell
{
    /// <summary>Constants of the headers.</summary>
    public static class Constants
    {
        /// <summary>Version of this interface. sightcell_version returns the version of the linked library.</summary>
        public const uint ApiVersion = 1;
        /// <summary>Value of sightcell_frame.cell for an eye outside all cells.</summary>
        public const uint NoCell = 0xFFFFFFFF;
        /// <summary>Number of the named group for a draw that is in no named group.</summary>
        public const uint NoNamedGroup = 0xFFFFFFFF;
        /// <summary>In a table of clusters: the polygon is in no cluster, because the host does not draw it.</summary>
        public const uint NoCluster = 0xFFFFFFFF;
        /// <summary>In a map of draws: the file has no draw for this one.</summary>
        public const uint NoDraw = 0xFFFFFFFF;
        /// <summary>A level that no texture has: no picture needs the texture.</summary>
        public const uint NoLevel = 255;
    }

    /// <summary>Result of a function.</summary>
    public enum Status : int
    {
        Ok = 0,
        /// <summary>null pointer, number out of range, NaN</summary>
        Argument = 1,
        /// <summary>the allocator returned NULL</summary>
        Memory = 2,
        /// <summary>dst is too small; *count is the number of elements</summary>
        Capacity = 3,
        /// <summary>not known for this frame, revision or ticket</summary>
        Stale = 4,
        /// <summary>the file does not have what the function needs</summary>
        Absent = 5,
        /// <summary>no error: the db waits for the bytes of a request</summary>
        Pending = 6,
        /// <summary>the file cannot be opened or read</summary>
        Io = 10,
        /// <summary>not a .pvs file</summary>
        NotOurs = 20,
        /// <summary>a .pvs file of a version that this library does not read</summary>
        Version = 21,
        /// <summary>fewer bytes than the header of the file requires</summary>
        Truncated = 22,
        /// <summary>damaged: a checksum differs</summary>
        Checksum = 23,
        /// <summary>values that contradict each other</summary>
        Corrupt = 24,
        /// <summary>a number beyond a limit of the format or of this machine</summary>
        Limit = 25,
        /// <summary>the file belongs to another scene</summary>
        OtherScene = 26,
    }

    /// <summary>The set that a view returns where it has none of its own: sightcell_view_policy.</summary>
    [Flags]
    public enum ViewPolicy : uint
    {
        /// <summary>outside all cells everything; the default</summary>
        OutsideAll = 0,
        /// <summary>outside, the set of the nearest cell</summary>
        OutsideNearest = 1,
        /// <summary>outside, the set of the cell that was left last</summary>
        OutsideLast = 2,
        /// <summary>added to one of these: the last set while the data of a cell has not arrived</summary>
        PendingLast = 16,
    }

    /// <summary>Bits of sightcell_frame.flags.</summary>
    [Flags]
    public enum FrameFlags : uint
    {
        /// <summary>the polygons to draw differ from those after the last move; set by the first move</summary>
        Changed = 1,
        /// <summary>the visible polygons are not known: outputs return everything</summary>
        DrawAll = 2,
        /// <summary>the eye is in no cell</summary>
        Outside = 4,
        /// <summary>the data of the cell has not arrived; with DRAW_ALL unless PENDING_LAST is set</summary>
        Pending = 8,
        /// <summary>the data of the cell is damaged; with DRAW_ALL; other cells are not affected</summary>
        Damaged = 16,
    }

    /// <summary>Kinds of lines of sightcell_view_debug_lines; may be combined.</summary>
    [Flags]
    public enum DebugLineKinds : uint
    {
        /// <summary>the box of the cell that contains the eye</summary>
        Cell = 1,
        /// <summary>the same box grown by the margin, in which the view keeps the cell</summary>
        Kept = 2,
        /// <summary>the boxes of up to 64 other cells that touch the grown box</summary>
        Neighbors = 4,
        /// <summary>visible volumes</summary>
        Volumes = 8,
        /// <summary>parts of the grown box that are outside the region of the cell</summary>
        OutsideRegion = 16,
    }

    /// <summary>Which name of a draw.</summary>
    public enum NameKind : uint
    {
        /// <summary>of its glTF node</summary>
        Node = 0,
        /// <summary>of its glTF mesh</summary>
        Mesh = 1,
    }

    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    public delegate IntPtr AllocatorAlloc(IntPtr user, UIntPtr size, UIntPtr align);

    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    public delegate void AllocatorRelease(IntPtr user, IntPtr block, UIntPtr size);

    [UnmanagedFunctionPointer(CallingConvention.Cdecl)]
    public delegate Status SourceRequest(IntPtr user, ulong offset, uint size, uint ticket);

    /// <summary>Result of a move. Its size is 64 bytes in all versions.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 64)]
    public unsafe struct Frame
    {
        /// <summary>the view cell that contains the eye, or SIGHTCELL_NO_CELL</summary>
        public uint Cell;
        /// <summary>SIGHTCELL_FRAME_*</summary>
        public FrameFlags Flags;
        /// <summary>polygons to draw</summary>
        public uint PolygonCount;
        /// <summary>number of changes of the polygons to draw since the view was created; wraps around</summary>
        public uint Revision;
        /// <summary>0</summary>
        public fixed uint Reserved[12];
    }

    /// <summary>
    /// Polygons of one draw that follow each other in stored order.
    /// In the permuted index buffer of its primitive these are the indices 3*first .. 3*(first+count)-1. In the one index
    /// buffer of a merged scene they are 3*(f+first) .. 3*(f+first+count)-1, where f is first_stored of the draw group.
    /// </summary>
    [StructLayout(LayoutKind.Sequential, Size = 12)]
    public unsafe struct PolygonRange
    {
        /// <summary>draw, or draw group of a merged file</summary>
        public uint Draw;
        /// <summary>counted from the first polygon of the draw, or draw group</summary>
        public uint First;
        /// <summary>1 or more</summary>
        public uint Count;
    }

    /// <summary>An indirect draw: GL's DrawElementsIndirectCommand, Vulkan's VkDrawIndexedIndirectCommand.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 20)]
    public unsafe struct IndirectCommand
    {
        /// <summary>3 per polygon</summary>
        public uint IndexCount;
        /// <summary>1</summary>
        public uint InstanceCount;
        /// <summary>in the index buffer of the primitive, or of a merged scene</summary>
        public uint FirstIndex;
        /// <summary>sightcell_draw.base_vertex; 0 for a merged file</summary>
        public uint BaseVertex;
        /// <summary>the draw, or draw group</summary>
        public uint FirstInstance;
    }

    /// <summary>An entry of the draw table: the origin of a draw in the scene, and its polygons.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 48)]
    public unsafe struct Draw
    {
        /// <summary>glTF index</summary>
        public uint Node;
        /// <summary>glTF index</summary>
        public uint Mesh;
        /// <summary>index in the mesh</summary>
        public uint Primitive;
        /// <summary>index in EXT_mesh_gpu_instancing, else 0</summary>
        public uint Instance;
        /// <summary>glTF index, 0xFFFFFFFF for the default material</summary>
        public uint Material;
        /// <summary>draw group of a merged file, 0 .. n-1 in ascending order; else 0</summary>
        public uint Group;
        /// <summary>source id of its first polygon; the ids of a draw are consecutive</summary>
        public uint FirstSource;
        /// <summary>may be 0</summary>
        public uint PolygonCount;
        /// <summary>stored number of the first polygon of the draw, or of its draw group</summary>
        public uint FirstStored;
        /// <summary>number of vertices of all draws before this one in source order</summary>
        public uint BaseVertex;
        /// <summary>the value that the host gave the draw when it baked its own arrays, else 0</summary>
        public ulong HostTag;
    }

    /// <summary>Facts about a file.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 60)]
    public unsafe struct DatabaseInfo
    {
        /// <summary>set by the caller to sizeof(sightcell_info)</summary>
        public uint StructSize;
        /// <summary>of the file</summary>
        public uint FormatVersion;
        /// <summary>0 instanced, 1 merged</summary>
        public uint Layout;
        public uint PolygonCount;
        public uint CellCount;
        public uint DrawCount;
        /// <summary>the most ranges that sightcell_view_ranges returns for this file</summary>
        public uint RangeBound;
        /// <summary>meters: the set of a cell holds for its box grown by this on all sides</summary>
        public float Margin;
        /// <summary>largest upper bound of any cell, 0 .. 1; of the miss probability, or the bake's --metric</summary>
        public float MaxPixelError;
        /// <summary>with which that bound holds, 0 .. 1</summary>
        public float Confidence;
        public fixed byte SceneFingerprint[16];
        /// <summary>meters: what valid viewpoints keep from surfaces; 0 if the file does not state it</summary>
        public float PlayerRadius;

        /// <summary>A struct whose StructSize is set, as functions need it.</summary>
        public static DatabaseInfo Sized => new DatabaseInfo { StructSize = 60 };
    }

    /// <summary>A reported miss: a polygon that is visible from an eye and is missing from the set of its cell.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 32)]
    public unsafe struct Miss
    {
        /// <summary>meters, world space</summary>
        public Double3 Eye;
        /// <summary>source id</summary>
        public uint Polygon;
        /// <summary>0</summary>
        public uint Reserved;
    }

    /// <summary>Counts of a view since its creation.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 64)]
    public unsafe struct ViewStats
    {
        /// <summary>set by the caller to sizeof(sightcell_view_stats)</summary>
        public uint StructSize;
        public uint Reserved;
        /// <summary>calls of sightcell_view_move and sightcell_view_move_box</summary>
        public ulong Moves;
        /// <summary>sets of cells that these calls decoded</summary>
        public ulong RowsDecoded;
        /// <summary>moves with CHANGED</summary>
        public ulong Changes;
        /// <summary>moves with OUTSIDE</summary>
        public ulong MovesOutside;
        /// <summary>moves with PENDING</summary>
        public ulong MovesPending;
        /// <summary>moves with DRAW_ALL</summary>
        public ulong MovesDrawAll;
        /// <summary>sum of polygon_count over all moves</summary>
        public ulong Polygons;

        /// <summary>A struct whose StructSize is set, as functions need it.</summary>
        public static ViewStats Sized => new ViewStats { StructSize = 64 };
    }

    /// <summary>
    /// Counts of a db. A chunk is the sets of up to 64 cells. resident_bytes and the members after it are 0 for a db that is
    /// not paged (sightcell_db_open_source).
    /// </summary>
    [StructLayout(LayoutKind.Sequential, Size = 56)]
    public unsafe struct DatabaseStats
    {
        /// <summary>set by the caller to sizeof(sightcell_db_stats)</summary>
        public uint StructSize;
        /// <summary>chunks of the file</summary>
        public uint ChunkCount;
        /// <summary>allocated for the db, with the bytes of the file that it owns, without views</summary>
        public ulong MemoryBytes;
        /// <summary>chunks that are in memory now</summary>
        public ulong ResidentBytes;
        /// <summary>requests for chunks</summary>
        public ulong Requests;
        /// <summary>chunks that were accepted</summary>
        public ulong DeliveredBytes;
        /// <summary>chunks that were removed for others</summary>
        public ulong Evictions;
        /// <summary>calls of sightcell_db_deliver that did not return OK</summary>
        public ulong RefusedDeliveries;

        /// <summary>A struct whose StructSize is set, as functions need it.</summary>
        public static DatabaseStats Sized => new DatabaseStats { StructSize = 56 };
    }

    /// <summary>One edge of a box.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 32)]
    public unsafe struct DebugLine
    {
        /// <summary>meters, relative to the origin of the view</summary>
        public Float3 From;
        /// <summary>meters, relative to the origin of the view</summary>
        public Float3 To;
        /// <summary>one SIGHTCELL_DEBUG_*</summary>
        public DebugLineKinds Kind;
        /// <summary>of the cell or volume</summary>
        public uint Number;
    }

    /// <summary>
    /// Source of memory. Only functions that open, close, check, create and destroy call it, on the thread of the caller.
    /// alloc: returns size bytes at a multiple of align (a power of two, at most 16), or NULL.
    /// release: takes back a block of alloc; size is the size that was passed to alloc.
    /// user: passed to both.
    /// </summary>
    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct MemoryAllocator
    {
        /// <summary>A function: AllocatorAlloc.</summary>
        public IntPtr Alloc;
        /// <summary>A function: AllocatorRelease.</summary>
        public IntPtr Release;
        public IntPtr User;
    }

    /// <summary>
    /// Source of the bytes of a paged file.
    /// user: passed to request.
    /// size: of the whole file, in bytes.
    /// request: asks for size bytes from offset. The host passes them to sightcell_db_deliver with the same ticket, on any
    ///   thread, before request returns or later. A result other than OK means that no delivery follows. Each request that
    ///   returned OK needs a delivery of bytes or of NULL: without one, the chunk is requested again only after 64 other
    ///   requests. sightcell_db_open_source, sightcell_db_begin_source, sightcell_db_opened, sightcell_db_prefetch,
    ///   sightcell_view_move and sightcell_view_move_box call request, on their own threads.
    /// </summary>
    [StructLayout(LayoutKind.Sequential)]
    public unsafe struct PagedSource
    {
        public IntPtr User;
        public ulong Size;
        /// <summary>A function: SourceRequest.</summary>
        public IntPtr Request;
    }

    /// <summary>A sun of the file. It moves from one direction to the other; both are equal where it does not move.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 24)]
    public unsafe struct Sun
    {
        /// <summary>unit vector toward the sun</summary>
        public Float3 From;
        public Float3 To;
    }

    /// <summary>A word of a row that changed.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 8)]
    public unsafe struct ClusterWord
    {
        /// <summary>of the word in the row</summary>
        public uint Index;
        /// <summary>its new value</summary>
        public uint Bits;
    }

    /// <summary>How the draws of a host and of a file match.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 28)]
    public unsafe struct DrawMatch
    {
        /// <summary>set by the caller to sizeof(sightcell_draw_match)</summary>
        public uint StructSize;
        /// <summary>draws of the host that have a draw of the file</summary>
        public uint Matched;
        /// <summary>of these, those that others are equal to: found by order</summary>
        public uint ByOrder;
        /// <summary>draws of the file that the host does not have</summary>
        public uint Missing;
        /// <summary>draws of the host that the file does not have</summary>
        public uint Extra;
        /// <summary>the first of them in source order, a number of the draw table; SIGHTCELL_NO_DRAW if none</summary>
        public uint FirstMissing;
        /// <summary>the first of them, an index of the host; SIGHTCELL_NO_DRAW if none</summary>
        public uint FirstExtra;

        /// <summary>A struct whose StructSize is set, as functions need it.</summary>
        public static DrawMatch Sized => new DrawMatch { StructSize = 28 };
    }

    /// <summary>A point or spot light.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 40)]
    public unsafe struct BakedLight
    {
        /// <summary>number in the glTF file</summary>
        public uint Node;
        /// <summary>world space, meters</summary>
        public Float3 Position;
        /// <summary>unit vector in which a spot light shines</summary>
        public Float3 Direction;
        /// <summary>meters; infinity: no limit</summary>
        public float Range;
        /// <summary>of a spot light: angle between axis and edge, radians; 0: a point light</summary>
        public float Cone;
        /// <summary>of the probability that a ray from the light meets a polygon that its set lacks, 0 .. 1</summary>
        public float ErrorBound;
    }

    /// <summary>A texture.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 12)]
    public unsafe struct ResidentTexture
    {
        /// <summary>number in the glTF file</summary>
        public uint Image;
        /// <summary>texels of level 0</summary>
        public uint Width;
        public uint Height;
    }

    /// <summary>The functions of the headers. The classes of this package call them.</summary>
    [SuppressUnmanagedCodeSecurity]
    public static unsafe class Native
    {
#if !UNITY_EDITOR && (UNITY_IOS || UNITY_TVOS || UNITY_WEBGL)
        private const string Library = "__Internal"; // linked into the player
#else
        private const string Library = "sightcell";
#endif

        /// <summary>Returns SIGHTCELL_API_VERSION of the linked library.</summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern uint sightcell_version();

        /// <summary>Returns one line of English text for a status, also for a value that is no status. The text is static, never NULL.</summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern byte* sightcell_status_text(Status status);

        /// <summary>
        /// Opens a file that is in memory. Checks all of it but the sets: the first use of a set checks those of its chunk.
        /// bytes: the whole file, at any alignment. The db refers to them: the caller keeps them until sightcell_db_close. They
        ///   may be a .glb that contains a .pvs file (sightcell bake --embed), but not for the WebAssembly module.
        /// size: of the file, in bytes.
        /// mem: copied. NULL means malloc and free.
        /// out: receives the db, or NULL on failure.
        /// Fails with MEMORY, NOT_OURS, VERSION, TRUNCATED, CHECKSUM, CORRUPT, LIMIT, and with ABSENT for a .glb without a .pvs
        ///   file.
        /// Cost: one pass over all but the sets, and of a .glb one or two over its JSON. One allocation: 40 to 60 bytes per
        ///   cell (48 per 8 x 8 positions for cells on a lattice, so 0.75 per cell at best), 16 per draw (merged: 4 per draw and
        ///   20 per draw group), 4 per polygon of a primitive whatever the number of its instances (merged: 4 per polygon), 4
        ///   per volume plus 50 to 100 per block of 4 x 4 x 4 volumes, and 62,000 for code tables.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_open(void* bytes, UIntPtr size, MemoryAllocator* mem, IntPtr* @out);

        /// <summary>
        /// Opens a file on disk: reads all of it into memory of the allocator, closes it, and then does what sightcell_db_open
        /// does. Of a .glb it keeps the .pvs file alone, in a block of its own.
        /// path: UTF-8.
        /// Fails with IO and as sightcell_db_open. The WebAssembly module has no files and always returns IO.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_open_file(byte* path, MemoryAllocator* mem, IntPtr* @out);

        /// <summary>
        /// Opens a paged file: loads everything but the sets now, and the sets when they are needed, in chunks of up to 64
        /// cells: about 16 KB or less, or one cell.
        /// source: copied. The host must deliver the bytes of the requests of this call before request returns.
        /// resident_bytes: the maximum of bytes of chunks in memory. The least recently used chunks are removed first.
        /// out: receives the db before the first request, so that request can deliver to it; NULL on failure.
        /// Fails with IO (nothing was delivered), CAPACITY (a chunk is larger than resident_bytes), VERSION (also for files of
        ///   version 0), LIMIT (also if all but the sets takes 4 GiB or more), the result of request, and as sightcell_db_open.
        /// Cost: as sightcell_db_open, and memory for all of the file but the sets, for resident_bytes (or for all sets, if that
        ///   is less), and 36 bytes per chunk.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_open_source(PagedSource* source, MemoryAllocator* mem, ulong residentBytes, IntPtr* @out);

        /// <summary>
        /// Begins to open a paged file, for hosts that cannot answer a request before it returns, such as web pages and threads
        /// that must not wait. The host then calls sightcell_db_opened, for example once per frame, until it returns OK. Until
        /// then, db may be passed to sightcell_db_opened, sightcell_db_deliver and sightcell_db_close only.
        /// source, mem, resident_bytes: as for sightcell_db_open_source; the host may deliver at any time.
        /// out: receives the db before the first request; NULL on failure.
        /// Returns PENDING, OK if everything was delivered before this returned, or fails as sightcell_db_open_source.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_begin_source(PagedSource* source, MemoryAllocator* mem, ulong residentBytes, IntPtr* @out);

        /// <summary>
        /// Continues to open a db of sightcell_db_begin_source with what was delivered. Requests twice in all: the header of the
        /// file, then everything but the sets. On one thread at a time.
        /// Returns PENDING while a request waits for its delivery, and OK when the db is open, also for a db of another open
        ///   function. Fails as sightcell_db_open_source, with IO where the host has delivered NULL; then the host closes the
        /// db. Cost: none while PENDING; the last step costs what sightcell_db_open costs.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_opened(IntPtr db);

        /// <summary>
        /// Tests whether a file was baked from the scene that the host has.
        /// scene_fingerprint: that of the host's scene, which `sightcell info` prints, or that of another open file or of
        ///   sightcell_stream_info.
        /// Fails with OTHER_SCENE.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_same_scene(IntPtr db, byte* sceneFingerprint);

        /// <summary>
        /// Delivers the bytes of a request. May be called on any thread, also from within request.
        /// ticket: of the request.
        /// bytes, size: the requested bytes; read during the call only. NULL if the host could not read them: they are requested
        ///   again when they are needed.
        /// Fails with STALE (no request has this ticket: it was delivered before, or given up after 64 later requests),
        ///   TRUNCATED and CORRUPT (too few or too many bytes; requested again), CHECKSUM (damaged: frames in its cells are
        ///   DAMAGED from now on), CAPACITY (all chunks in memory are in use, or were wanted more recently), ARGUMENT also for a
        ///   db that is not paged.
        /// Cost: O(chunks in memory) and a copy of the bytes.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_deliver(IntPtr db, uint ticket, void* bytes, uint size);

        /// <summary>
        /// Requests the chunks that a moving camera may need soon, starting with those that it can reach first: up to
        /// resident_bytes in all, and up to 32 requests per call. Does nothing for a db that is not paged.
        /// eye: position, world space.
        /// velocity: meters per second. The search region widens by half the distance traveled, because the camera may turn.
        /// seconds: the time ahead, 0 or more.
        /// Fails with ARGUMENT for numbers that are not finite.
        /// Cost: O(chunks). May be called in each frame, or less often.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_prefetch(IntPtr db, float* eye, float* velocity, float seconds);

        /// <summary>Closes a db and releases its memory. Destroy its views first. NULL is allowed.</summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern void sightcell_db_close(IntPtr db);

        /// <summary>
        /// Returns facts about the file.
        /// out: the caller sets out-&gt;struct_size. If it differs from the size of the struct of this library, because the caller
        ///   was compiled with another header, the function fills the members that both have, and sets struct_size to the size
        ///   of that part. Fails with ARGUMENT if it is smaller than 56: the first struct ended with scene_fingerprint.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_info(IntPtr db, DatabaseInfo* @out);

        /// <summary>Returns the number of polygons of the scene, 0 for NULL.</summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern uint sightcell_db_polygon_count(IntPtr db);

        /// <summary>Returns the number of view cells, 0 for NULL. Cells are numbered 0 .. count - 1.</summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern uint sightcell_db_cell_count(IntPtr db);

        /// <summary>
        /// Returns the box of a cell, without the margin.
        /// min, max: receive its corners, in meters of world space.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_cell_box(IntPtr db, uint cell, float* min, float* max);

        /// <summary>
        /// Returns which share of a cell its error bound is about. The region of a cell is a part of its grown box, or all of
        /// it. The bound holds for the valid viewpoints in the region (see EYE POSITIONS above).
        /// valid_share: receives the estimated share of the region that is valid viewpoints, above 0 and at most 1.
        /// outside_share: receives the upper limit, at 95 % confidence, of the share of the valid viewpoints of the grown box
        ///   that are outside the region: 0 .. 1, and 0 if the region is the whole box.
        /// For a file that does not state this (sightcell_info.player_radius is 0), they receive 1 and 0.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_cell_viewpoints(IntPtr db, uint cell, float* validShare, float* outsideShare);

        /// <summary>
        /// Lists the draw table. It is not in source order: see DRAWS above.
        /// dst, capacity, count: in draws.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_draws(IntPtr db, Draw* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Lists the source id of each stored polygon: the host permutes its index buffers by it once after loading.
        /// source_id_of_stored: element s receives the source id of stored polygon s. In a merged file, the indices of polygon s
        ///   are the source's own plus base_vertex of the draw that has this source id.
        /// capacity, count: in polygons.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_order(IntPtr db, uint* sourceIdOfStored, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Returns the number of visibility volumes, 0 for NULL and for files baked without --volumes. A volume is a coarse box
        /// of space in which an object may move. The set of a cell contains the volumes that are visible from it. They are never
        /// drawn, and no other count includes them. sightcell_view_box_visible tests a box against them.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern uint sightcell_db_volume_count(IntPtr db);

        /// <summary>
        /// Returns the box of a volume.
        /// min, max: receive its corners, in meters of world space.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_volume_box(IntPtr db, uint volume, float* min, float* max);

        /// <summary>
        /// Returns the number of named groups, 0 for NULL. A named group is the draws to which the scene gives one name
        /// (extras.sightcell.group), such as a door. They never occlude anything, so a host can show and hide them at run time
        /// without a new bake: in its own code, or with sightcell_view_show_named_group. The draws of one draw group of a merged
        /// file are all in the same named group, or all in none.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern uint sightcell_db_named_group_count(IntPtr db);

        /// <summary>
        /// Returns the name of a named group.
        /// dst, capacity, count: in bytes, UTF-8, without a zero at the end.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_named_group_name(IntPtr db, uint group, byte* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Finds a named group by its name. O(named groups).
        /// name: UTF-8, with a zero at the end.
        /// group: receives its number, or SIGHTCELL_NO_NAMED_GROUP if there is none; the function returns OK in both cases.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_find_named_group(IntPtr db, byte* name, uint* group);

        /// <summary>
        /// Lists the named group of each draw, or SIGHTCELL_NO_NAMED_GROUP, in the order of the draw table.
        /// dst, capacity, count: in draws.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_named_groups_of_draws(IntPtr db, uint* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Creates a view. Before its first move, it has revision 0 and its outputs are empty.
        /// db: must outlive the view.
        /// out: receives the view, or NULL on failure.
        /// Fails with MEMORY, and with PENDING before sightcell_db_opened has returned OK.
        /// Cost: one allocation of about 110 bytes per range of the largest set; the view needs no other.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_create(IntPtr db, IntPtr* @out);

        /// <summary>Destroys a view and releases its memory. NULL is allowed.</summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern void sightcell_view_destroy(IntPtr view);

        /// <summary>
        /// Sets the point that the positions of later calls are relative to, for hosts that keep coordinates near the camera
        /// small. Sums are in double precision.
        /// origin: meters, world space, finite. (0, 0, 0) in a new view.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_origin(IntPtr view, double* origin);

        /// <summary>
        /// Sets which polygons later moves return outside all cells, where frames still have SIGHTCELL_NO_CELL and OUTSIDE, and
        /// in a cell of a paged file whose data has not arrived, where frames still have PENDING.
        /// outside: SIGHTCELL_OUTSIDE_*, plus SIGHTCELL_PENDING_LAST or not. With it, a move into a cell without its data keeps
        ///   the set that was shown, which may lack polygons, until the data is there or a named group is shown or hidden.
        /// max_distance: meters, 0 or more, may be infinite. The set of another cell holds up to this distance from the box of
        ///   that cell; beyond it, the view returns everything.
        /// Cost of NEAREST: a move visits all cells (on a lattice, all blocks of 8 x 8 cells), but only when the eye has moved
        ///   so far that another cell may be nearer.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_policy(IntPtr view, uint outside, float maxDistance);

        /// <summary>
        /// Shows or hides a named group from the next move on. New views show all named groups.
        /// group: its number.
        /// shown: 0 hides it. Then no output contains its polygons, also under DRAW_ALL, and frame.polygon_count does not count
        ///   them. Sets contain the polygons behind a closed door, as if it were open.
        /// The next move has CHANGED if this changes the polygons to draw, and sightcell_view_changes returns the difference.
        /// Cost: O(draws).
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_show_named_group(IntPtr view, uint group, uint shown);

        /// <summary>
        /// Moves the camera. Finds its cell, and decodes the set of the cell if the cell has changed.
        /// The view keeps its cell while the eye is inside the box of that cell grown by info.margin and in no cell of smaller
        /// volume. Else it takes the cell that contains the eye; of several, the one of the smallest volume, then of the lowest
        /// number. Both eyes of a headset can share a view if the margin exceeds their distance.
        /// eye: position. See EYE POSITIONS above for eyes inside solids.
        /// frame: receives the result. Outside all cells: OK, with DRAW_ALL | OUTSIDE unless sightcell_view_policy changed that.
        ///   A damaged cell: OK, with DRAW_ALL | DAMAGED.
        /// Fails with ARGUMENT if eye is NULL or has a NaN, or frame is NULL: the view then returns everything, and *frame has
        ///   DRAW_ALL unless frame is NULL.
        /// Cost: a few nanoseconds while the cell stays the same, a lookup and O(runs of the set) when it changes.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_move(IntPtr view, float* eye, Frame* frame);

        /// <summary>
        /// Moves the camera to an unknown position in a box, such as that of two eyes, of a server's estimate or of the next
        /// frames.
        /// Takes the cell of the center of the box if the grown box of that cell contains all of the box. Else the result is the
        /// union of the sets of all cells that the box touches; where it has more than info.range_bound ranges, the smallest
        /// gaps between them are filled with polygons.
        /// min, max: corners, which belong to the box. min &lt;= max.
        /// frame: as for sightcell_view_move. frame-&gt;cell is the cell of the center. The frame has OUTSIDE if a part of the box
        ///   is in no grown box, with DRAW_ALL under SIGHTCELL_OUTSIDE_ALL. It has DRAW_ALL if the box touches more than 64
        ///   cells.
        /// Fails as sightcell_view_move, also if min is above max.
        /// Cost: the sum of the moves into each of the cells.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_move_box(IntPtr view, float* min, float* max, Frame* frame);

        /// <summary>
        /// Lists the polygons to draw as ranges, in ascending order of draws, then of first.
        /// dst, capacity, count: in ranges; at most info.range_bound.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_ranges(IntPtr view, PolygonRange* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Lists the source ids of the polygons to draw, each once, in stored order.
        /// source_ids, capacity, count: in polygons; the list has frame.polygon_count.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_polygons(IntPtr view, uint* sourceIds, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Copies the indices of the polygons to draw into one index list, in the order of sightcell_view_ranges.
        /// stored_indices: the host's indices in stored order, 3 * db_polygon_count elements. They count the vertices of the
        ///   draw's own mesh; in a merged file base_vertex of the draw is added.
        /// dst: receives 3 indices per polygon. Written from front to back and never read, so it may be mapped GPU memory. Must
        ///   not overlap stored_indices.
        /// capacity, count: in indices; the list has 3 * frame.polygon_count.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_indices(IntPtr view, uint* storedIndices, uint* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Lists the polygons to draw as indirect draws, in the order of sightcell_view_ranges.
        /// min_gap: two ranges of a draw with fewer than min_gap polygons between them become one command, which also draws
        ///   these polygons. 0 and 1 join no ranges.
        /// dst: receives a sightcell_command every stride bytes, at any alignment. Written from front to back and never read;
        ///   only 20 bytes of each stride are written.
        /// stride: bytes, 20 or more.
        /// capacity, count: in commands; never more than ranges.
        /// Fails with LIMIT if the scene has more than 1,431,655,765 polygons, because their indices do not fit into 32 bits.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_commands(IntPtr view, uint minGap, void* dst, UIntPtr stride, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Writes a bit for each draw: 1 if it has a polygon to draw.
        /// bits_by_draw: draw d is bit d % 64 of word d / 64. Bits after the last draw are 0.
        /// words: elements of bits_by_draw, (info.draw_count + 63) / 64 or more, all of which are written.
        /// Fails with CAPACITY if there are fewer words.
        /// Cost: O(ranges); for a merged file O(polygons to draw).
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_objects(IntPtr view, ulong* bitsByDraw, UIntPtr words);

        /// <summary>
        /// Lists how large a part of the view each draw covers, so that a host can load first what is most visible. For files
        /// baked with --importance (or `sightcell recode --importance`).
        /// dst: receives the solid angle in steradians, out of 4 pi for the whole view, that the visible polygons of the draw
        ///   cover in the mean over the valid viewpoints of the cell. 0 for a draw without a polygon to draw. The file has a
        ///   class for each polygon, and each class spans a factor of 4, so a value is accurate to about a factor of 2. After
        ///   sightcell_view_move_box, it is the largest value of the cells that the box touches. Elements are draws in the order
        ///   of the draw table, or draw groups of a merged file in ascending order.
        /// capacity, count: in draws, or draw groups.
        /// Fails with ABSENT if the file has no importance, and for a paged db, which does not load it; with STALE under
        ///   DRAW_ALL, because importance is not known there; with CHECKSUM or CORRUPT if the data is damaged. All elements of
        ///   dst are 0 then.
        /// Cost: O(polygons to draw + chunks), and some tens of microseconds for code tables. The first call in each chunk
        ///   also checks their importance data.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_importance(IntPtr view, float* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Lists the polygons that were added and removed since a revision, as ranges.
        /// since_revision: frame.revision of the last frame that the caller has drawn. It must be the current revision (no
        ///   differences) or the one before.
        /// added, removed: with capacity and count in ranges.
        /// Fails with STALE for any other revision, and if either of the two frames has DRAW_ALL: both counts are 0, and the
        ///   caller takes the full list. Fails with CAPACITY if one of the lists does not fit: both counts are set, and neither
        ///   list is written.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_changes(IntPtr view, uint sinceRevision, PolygonRange* added, UIntPtr addedCapacity, UIntPtr* addedCount, PolygonRange* removed, UIntPtr removedCapacity, UIntPtr* removedCount);

        /// <summary>
        /// Tests whether anything in a box (a player, an object that moves, a sound) can be visible. For files with volumes.
        /// min, max: corners, which belong to the box. min &lt;= max.
        /// visible: receives 0 if volumes cover the box and none that it touches is visible; else 1. So it is 1 for a file
        ///   without volumes and under DRAW_ALL.
        /// Fails with ARGUMENT for a NaN or if min is above max: *visible is 1 then.
        /// Cost: some tens of nanoseconds for a box that touches few volumes.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_box_visible(IntPtr view, float* min, float* max, uint* visible);

        /// <summary>
        /// Reads the whole file and checks everything. Returns OK or the first fault.
        /// Fails with CHECKSUM, CORRUPT, MEMORY (it allocates while it runs) and IO (the db is paged).
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_check(IntPtr db);

        /// <summary>
        /// Returns the counts of a db.
        /// out: out-&gt;struct_size as for sightcell_db_info.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_statistics(IntPtr db, DatabaseStats* @out);

        /// <summary>
        /// Returns the counts of a view since its creation.
        /// out: out-&gt;struct_size as for sightcell_db_info.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_statistics(IntPtr view, ViewStats* @out);

        /// <summary>
        /// Lists the edges of boxes of cells and volumes, twelve per box, which a host can draw over the picture.
        /// kinds: SIGHTCELL_DEBUG_* combined. Outside all cells, the list has only lines of volumes. The boxes of OUTSIDE_REGION
        ///   are the part of the grown box where the error bound of the cell does not hold, as sightcell_db_cell_viewpoints
        ///   describes it. There are none if the region is the whole box.
        /// dst, capacity, count: in lines.
        /// Fails with CORRUPT for OUTSIDE_REGION if the region of the cell is damaged, which open does not check.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_debug_lines(IntPtr view, uint kinds, DebugLine* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Writes the text of a misses file, which `sightcell verify --from` and `sightcell bake --misses` read. It lists
        /// polygons that a host found missing, for example by comparing a full picture with the culled one.
        /// misses, miss_count: eyes within 1,000,000 km of the origin; they are rounded to a nanometer.
        /// dst, capacity, count: in bytes, JSON in ASCII, without a zero at the end.
        /// Fails with ARGUMENT for a polygon that does not exist and for an eye that is not finite or too far away.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_misses_text(IntPtr db, Miss* misses, UIntPtr missCount, byte* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Opens the shadow casters of a file.
        /// db: must outlive the casters.
        /// out: receives the casters, or NULL on failure.
        /// Fails with ARGUMENT; with ABSENT if the file has no casters, or pages; with CHECKSUM or CORRUPT if they are damaged;
        ///   with MEMORY; with PENDING before sightcell_db_opened has returned OK.
        /// Cost: reads all casters once. One allocation of the allocator of db: 62 KB and at most 5 bytes per polygon.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_casters_create(IntPtr db, IntPtr* @out);

        /// <summary>Destroys casters and releases their memory. NULL is allowed.</summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern void sightcell_casters_destroy(IntPtr casters);

        /// <summary>
        /// Lists the suns of the file, in the order of the bake.
        /// dst, capacity, count: in suns, 1 or more.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_casters_suns(IntPtr casters, Sun* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Lists the polygons to draw into the shadow map of a sun as ranges, in ascending order of draws, then of first: those
        /// of the last move, and the casters of the cells that it shows. Everything under DRAW_ALL, and where the casters of a
        /// cell are damaged. Hidden named groups are left out.
        /// casters: of the db of the view.
        /// sun: its number.
        /// dst, capacity, count: in ranges.
        /// Fails with ARGUMENT also if casters are of another db and if there is no such sun.
        /// Cost: O(polygons / 64 + ranges). Allocates nothing.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_casters(IntPtr view, IntPtr casters, uint sun, PolygonRange* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Copies the indices of the same polygons into one index list, as sightcell_view_indices does.
        /// stored_indices, dst, capacity, count: as for sightcell_view_indices.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_caster_indices(IntPtr view, IntPtr casters, uint sun, uint* storedIndices, uint* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Makes a map.
        /// db: must outlive the map.
        /// cluster_of_source: element i is the cluster of the polygon with source id i, or SIGHTCELL_NO_CLUSTER. Read during the
        ///   call only.
        /// polygon_count: elements of cluster_of_source; must be sightcell_db_polygon_count.
        /// cluster_count: number of clusters. A cluster may have no polygon in the table.
        /// out: receives the map, or NULL on failure.
        /// Fails with ARGUMENT also if polygon_count differs and if a cluster is not below cluster_count; with MEMORY; with
        ///   PENDING before sightcell_db_opened has returned OK.
        /// Cost: O(polygons). One allocation of the allocator of db: 2 bytes per polygon, and 8 bytes for each word of the row
        ///   that 16 consecutive polygons of the file have clusters in: about 3 to 4 bytes per polygon in all for clusters of
        ///   neighboring triangles.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_cluster_map_create(IntPtr db, uint* clusterOfSource, UIntPtr polygonCount, uint clusterCount, IntPtr* @out);

        /// <summary>
        /// Returns the number of clusters of a file of clusters; 0 for other files, for NULL, and before sightcell_db_opened has
        /// returned OK. Cost: O(1).
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern uint sightcell_db_cluster_count(IntPtr db);

        /// <summary>
        /// Lists the clusters of a file of clusters in the order of their numbers: the draw (draw group of a merged file) of
        /// each, its first polygon in the stored order of the draw, and its number of polygons, 1 to 256.
        /// dst, capacity, count: in clusters; the list has sightcell_db_cluster_count.
        /// Fails with PENDING too.
        /// Cost: O(clusters).
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_clusters(IntPtr db, PolygonRange* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Makes a map of the clusters of a file of clusters: bit c of a row is cluster c of the file.
        /// db: must outlive the map.
        /// out: receives the map, or NULL on failure.
        /// Fails with ABSENT if the sets of the file are of polygons; with MEMORY; with PENDING before sightcell_db_opened has
        ///   returned OK.
        /// Cost: O(clusters + polygons / 64). One allocation of the allocator of db: 4 bytes per cluster and for each 64
        ///   polygons.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_cluster_map_of_file(IntPtr db, IntPtr* @out);

        /// <summary>Destroys a map and releases its memory. NULL is allowed.</summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern void sightcell_cluster_map_destroy(IntPtr map);

        /// <summary>
        /// Writes a bit for each cluster: 1 if it has a polygon to draw. Like the outputs of sightcell.h, this returns the
        /// result of the last move, and everything under DRAW_ALL. The bit of a cluster without a polygon in the table is 0.
        /// map: of the db of the view.
        /// bits: the row. Cluster c is bit c % 32 of word c / 32. Bits after the last cluster are 0.
        /// words: elements of bits, (cluster_count + 31) / 32 or more, all of which are written.
        /// Fails with ARGUMENT also if map is of another db; with CAPACITY if there are fewer words.
        /// Cost: O(ranges + clusters / 32 + polygons in the set / 16). Takes 17 KB of the stack.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_clusters(IntPtr view, IntPtr map, uint* bits, UIntPtr words);

        /// <summary>
        /// Lists the clusters whose bits are 1, in ascending order.
        /// bits, words: a row of sightcell_view_clusters, or a row that the host has changed, such as one without the clusters
        ///   outside the frustum.
        /// dst, capacity, count: in clusters.
        /// Cost: O(words + clusters in the list).
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_cluster_list(uint* bits, UIntPtr words, uint* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Lists the words in which two rows differ, in ascending order, for hosts that update a row on the GPU in place. The
        /// host keeps two rows and fills them in turn. This also works across DRAW_ALL, and for rows that are several changes
        /// apart.
        /// before: the row that the GPU has.
        /// now: the row that it is to have.
        /// words: of each row.
        /// dst, capacity, count: in words.
        /// Cost: O(words).
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_cluster_changes(uint* before, uint* now, UIntPtr words, ClusterWord* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Computes the geometry hash of triangles.
        /// positions: x, y and z of each vertex as floats, in the space of the mesh, with any alignment.
        /// stride: bytes from vertex to vertex, 12 or more.
        /// indices: three per triangle.
        /// hash: receives the hash.
        /// Fails with ARGUMENT also if index_count is not a multiple of 3, and if an index is not below vertex_count.
        /// Cost: O(index_count).
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_geometry_hash(void* positions, UIntPtr stride, UIntPtr vertexCount, uint* indices, UIntPtr indexCount, ulong* hash);

        /// <summary>
        /// Finds the draw of the file for each draw of the host: one with the same hash, and if there are several, first one
        /// with the same name of its node, then the next one in source order. Each draw of the file is found once.
        /// hashes: of the draws of the host, in the order of the scene as far as the host has it (source order). Draws with the
        ///   hash 0, of the host and of the file, are matched with nothing and count as neither missing nor extra.
        /// names: of the glTF nodes of these draws, UTF-8 with a zero at the end; elements may be NULL. NULL: no names.
        /// count: elements of hashes, of names, and of draw_of_host.
        /// draw_of_host: receives the number in the draw table of the file for each draw of the host, or SIGHTCELL_NO_DRAW.
        /// match: receives the counts. The caller sets match-&gt;struct_size, as for sightcell_view_statistics.
        /// Fails with OTHER_SCENE if a draw is missing or extra; draw_of_host and match are complete then too, so that a host
        ///   can name what differs, or use what matched. Fails with ABSENT if the file has no draw identity: bake with --names,
        ///   or add it with `sightcell recode --names`. Fails with CHECKSUM or CORRUPT if this part of the file is damaged,
        ///   which open does not check; with MEMORY; with PENDING before sightcell_db_opened has returned OK.
        /// Cost: O(n log n). One allocation of the allocator of db, released before the call returns.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_match(IntPtr db, ulong* hashes, byte** names, UIntPtr count, uint* drawOfHost, DrawMatch* match);

        /// <summary>
        /// Returns the geometry hash of a draw.
        /// draw: number in the draw table.
        /// hash: receives the hash; 0 for a draw without polygons.
        /// Fails with ABSENT, CHECKSUM, CORRUPT and PENDING as sightcell_db_match.
        /// Cost: O(draws), because it checks that part of the file.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_draw_hash(IntPtr db, uint draw, ulong* hash);

        /// <summary>
        /// Returns a name of a draw.
        /// draw: number in the draw table.
        /// kind: SIGHTCELL_NAME_NODE or SIGHTCELL_NAME_MESH.
        /// dst, capacity, count: in bytes of UTF-8, without a zero at the end; at most 255, since longer names are stored
        ///   without their end. 0 bytes if the glTF file has no name there.
        /// Fails with ABSENT, CHECKSUM, CORRUPT and PENDING as sightcell_db_match.
        /// Cost: O(draws + names). For messages.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_draw_name(IntPtr db, uint draw, uint kind, byte* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Opens the lights of a file.
        /// db: must outlive the lights.
        /// out: receives the lights, or NULL on failure.
        /// Fails with ARGUMENT; with ABSENT if the file has no lights, or pages; with CHECKSUM or CORRUPT if they are damaged;
        ///   with MEMORY; with PENDING before sightcell_db_opened has returned OK.
        /// Cost: reads all lights once. One allocation of the allocator of db: 62 KB and at most 16 bytes per run of the largest
        ///   set of a light.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_lights_create(IntPtr db, IntPtr* @out);

        /// <summary>Destroys lights and releases their memory. NULL is allowed.</summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern void sightcell_lights_destroy(IntPtr lights);

        /// <summary>
        /// Lists the lights of the file, in the order of the scene's nodes. Their numbers are used below.
        /// dst, capacity, count: in lights, 1 or more.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_lights_list(IntPtr lights, BakedLight* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Lists the numbers of the lights that touch what the cells of the last move see, ascending. A light touches a cell if
        /// it reaches a polygon of the set of the cell. All lights under DRAW_ALL.
        /// lights: of the db of the view.
        /// dst, capacity, count: in lights.
        /// Fails with ARGUMENT also if lights are of another db.
        /// Cost: O(lights). Allocates nothing.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_lights(IntPtr view, IntPtr lights, uint* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Lists the polygons that a light reaches as ranges, in ascending order of draws, then of first. They do not depend on
        /// where the view is. Everything where the set of the light is damaged. Hidden named groups of the view are left out.
        /// lights: of the db of the view.
        /// light: its number.
        /// dst, capacity, count: in ranges.
        /// Fails with ARGUMENT also if lights are of another db and if there is no such light.
        /// Cost: O(runs of the set + draws, where there are named groups). Allocates nothing.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_light_ranges(IntPtr view, IntPtr lights, uint light, PolygonRange* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Copies the indices of the same polygons into one index list, as sightcell_view_indices does.
        /// stored_indices, dst, capacity, count: as for sightcell_view_indices.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_light_indices(IntPtr view, IntPtr lights, uint light, uint* storedIndices, uint* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Opens the texture residency of a file. Files that page have it too.
        /// db: must outlive the residency.
        /// out: receives the residency, or NULL on failure.
        /// Fails with ARGUMENT; with ABSENT if the file has none; with CHECKSUM or CORRUPT if it is damaged; with MEMORY; with
        ///   PENDING before sightcell_db_opened has returned OK.
        /// Cost: reads all levels once. One allocation of the allocator of db: 5 KB and 2 bytes per texture.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_residency_create(IntPtr db, IntPtr* @out);

        /// <summary>Destroys a residency and releases its memory. NULL is allowed.</summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern void sightcell_residency_destroy(IntPtr residency);

        /// <summary>
        /// Lists the textures of the file, in ascending order of images.
        /// dst, capacity, count: in textures.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_residency_textures(IntPtr residency, ResidentTexture* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Lists the finest level of each texture that a picture from the cells of the last move can need, or
        /// SIGHTCELL_NO_LEVEL. Level 0 of all textures under DRAW_ALL, and where the levels of a cell are damaged.
        /// residency: of the db of the view.
        /// pixels_per_radian: of the picture; above 0, at most 1048576.
        /// dst, capacity, count: in textures.
        /// Fails with ARGUMENT also if residency is of another db.
        /// Cost: O(textures + changes from cell to cell). Allocates nothing.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_view_texture_levels(IntPtr view, IntPtr residency, float pixelsPerRadian, byte* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Lists the levels of one cell.
        /// cell: its number.
        /// Other parameters, failures and cost: as for sightcell_view_texture_levels.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_residency_cell_levels(IntPtr residency, uint cell, float pixelsPerRadian, byte* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>
        /// Returns a valid viewpoint of a cell. It is in the box of the cell, without the margin.
        /// number: 0 for the first one, which each cell of a new bake has; wide cells have further ones, away from each other.
        /// eye: receives the position, in meters of world space.
        /// Fails with ABSENT if the file has no viewpoint of this number for the cell: files of version 0 and of bakes before
        ///   bake version 22 have none. There is no substitute: the runtime cannot distinguish valid viewpoints from others.
        ///   Fails with CHECKSUM or CORRUPT if this part of the file is damaged, which open does not check; with PENDING before
        ///   sightcell_db_opened has returned OK.
        /// Cost: O(cells), because it checks that part of the file. Not for calls per frame.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_cell_eye(IntPtr db, uint cell, uint number, float* eye);

        /// <summary>
        /// Lists the upper bound of the miss probability of each cell (ERROR BOUND in sightcell.h), in the order of the cells.
        /// info.max_pixel_error is the largest of them. For maps and tools.
        /// dst: receives a number 0 .. 1 for each cell; 1 for a cell whose bound was not measured.
        /// capacity, count: in cells.
        /// Fails with ABSENT if the file has no bounds; with PENDING before sightcell_db_opened has returned OK.
        /// Cost: O(cells). Not for calls per frame.
        /// </summary>
        [DllImport(Library, CallingConvention = CallingConvention.Cdecl, ExactSpelling = true)]
        public static extern Status sightcell_db_error_bounds(IntPtr db, float* dst, UIntPtr capacity, UIntPtr* count);

        /// <summary>The id of a status, such as not_ours.</summary>
        public static string StatusId(Status status)
        {
            switch (status)
            {
                case Status.Ok: return "ok";
                case Status.Argument: return "argument";
                case Status.Memory: return "memory";
                case Status.Capacity: return "capacity";
                case Status.Stale: return "stale";
                case Status.Absent: return "absent";
                case Status.Pending: return "pending";
                case Status.Io: return "io";
                case Status.NotOurs: return "not_ours";
                case Status.Version: return "version";
                case Status.Truncated: return "truncated";
                case Status.Checksum: return "checksum";
                case Status.Corrupt: return "corrupt";
                case Status.Limit: return "limit";
                case Status.OtherScene: return "other_scene";
                default: return "status_" + (int)status;
            }
        }
    }
}
