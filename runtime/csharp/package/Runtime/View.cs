using System;
using System.Runtime.InteropServices;

namespace Sightcell
{
    /// <summary>A camera in the scene of a database. One thread at a time; different views are independent.
    /// Nothing here allocates but the constructor, and exceptions where a function fails. A list function fills dst and
    /// returns the number of elements; it throws Status.Capacity where they do not fit. Arrays convert to spans. The
    /// overloads with pointers are for NativeArray and mapped memory.</summary>
    public sealed unsafe class View : NativeObject
    {
        /// <summary>Creates a view. All memory that it will ever need is allocated here.</summary>
        public View(Database database)
        {
            IntPtr made = IntPtr.Zero;
            Take(Native.sightcell_view_create(Hold(database), &made), made, "view");
        }

        internal override void Destroy(IntPtr pointer)
        {
            Native.sightcell_view_destroy(pointer);
        }

        // ---- Moves ----

        /// <summary>Moves the camera. eye: meters, axes of glTF, relative to the origin of the view. Where it throws, for a
        /// NaN, the view returns everything from then on.</summary>
        public Frame Move(Float3 eye)
        {
            Frame frame;
            Check(Native.sightcell_view_move(Pointer, (float*)&eye, &frame), "move");
            return frame;
        }

        /// <summary>Moves the camera to an unknown position in a box, whose corners belong to it.</summary>
        public Frame MoveBox(Float3 min, Float3 max)
        {
            Frame frame;
            Check(Native.sightcell_view_move_box(Pointer, (float*)&min, (float*)&max, &frame), "move");
            return frame;
        }

        /// <summary>Sets which set later moves return outside all cells, up to a distance in meters from the box of its
        /// cell.</summary>
        public void SetPolicy(ViewPolicy policy, float maxDistance)
        {
            Check(Native.sightcell_view_policy(Pointer, (uint)policy, maxDistance), "policy");
        }

        /// <summary>Sets the point that positions of later calls are relative to, in meters of world space.</summary>
        public void SetOrigin(Double3 origin)
        {
            Check(Native.sightcell_view_origin(Pointer, (double*)&origin), "origin");
        }

        /// <summary>Shows or hides a named group from the next move on.</summary>
        public void ShowNamedGroup(uint group, bool shown)
        {
            Check(Native.sightcell_view_show_named_group(Pointer, group, shown ? 1u : 0u), "named group");
        }

        // ---- Outputs ----

        /// <summary>Writes a bit for each draw of the draw table: draw d is bit d % 64 of word d / 64, 1 if it has a polygon
        /// to draw. words: (draws + 63) / 64.</summary>
        public void Objects(ulong* bitsByDraw, int words)
        {
            Check(Native.sightcell_view_objects(Pointer, bitsByDraw, (UIntPtr)words), "objects");
        }

        public void Objects(Span<ulong> bitsByDraw)
        {
            fixed (ulong* dst = &MemoryMarshal.GetReference(bitsByDraw)) Objects(dst, bitsByDraw.Length);
        }

        /// <summary>The polygons to draw as ranges of the permuted index buffers: at most Info.RangeBound.</summary>
        public int Ranges(PolygonRange* dst, int capacity)
        {
            UIntPtr count;
            Check(Native.sightcell_view_ranges(Pointer, dst, (UIntPtr)capacity, &count), "ranges");
            return (int)count;
        }

        public int Ranges(Span<PolygonRange> dst)
        {
            fixed (PolygonRange* first = &MemoryMarshal.GetReference(dst)) return Ranges(first, dst.Length);
        }

        /// <summary>The source ids of the polygons to draw: frame.PolygonCount.</summary>
        public int Polygons(uint* dst, int capacity)
        {
            UIntPtr count;
            Check(Native.sightcell_view_polygons(Pointer, dst, (UIntPtr)capacity, &count), "polygons");
            return (int)count;
        }

        public int Polygons(Span<uint> dst)
        {
            fixed (uint* first = &MemoryMarshal.GetReference(dst)) return Polygons(first, dst.Length);
        }

        /// <summary>The indices of the polygons to draw: 3 * frame.PolygonCount. storedIndices: 3 per polygon of the file, in
        /// stored order. dst may be mapped memory of the GPU.</summary>
        public int Indices(uint* storedIndices, uint* dst, int capacity)
        {
            UIntPtr count;
            Check(Native.sightcell_view_indices(Pointer, storedIndices, dst, (UIntPtr)capacity, &count), "indices");
            return (int)count;
        }

        public int Indices(ReadOnlySpan<uint> storedIndices, Span<uint> dst)
        {
            fixed (uint* stored = &MemoryMarshal.GetReference(storedIndices))
            fixed (uint* first = &MemoryMarshal.GetReference(dst))
            {
                return Indices(stored, first, dst.Length);
            }
        }

        /// <summary>The polygons to draw as indirect draws, one every stride bytes: at most Info.RangeBound. Two ranges of a
        /// draw with fewer than minGap polygons between them become one.</summary>
        public int Commands(uint minGap, void* dst, int stride, int capacity)
        {
            UIntPtr count;
            Check(Native.sightcell_view_commands(Pointer, minGap, dst, (UIntPtr)stride, (UIntPtr)capacity, &count), "commands");
            return (int)count;
        }

        public int Commands(uint minGap, Span<IndirectCommand> dst)
        {
            fixed (IndirectCommand* first = &MemoryMarshal.GetReference(dst))
            {
                return Commands(minGap, first, sizeof(IndirectCommand), dst.Length);
            }
        }

        /// <summary>Writes a bit for each cluster: cluster c is bit c % 32 of word c / 32. words: map.Words.</summary>
        public void Clusters(ClusterMap map, uint* bits, int words)
        {
            Check(Native.sightcell_view_clusters(Pointer, map.Pointer, bits, (UIntPtr)words), "clusters");
            GC.KeepAlive(map);
        }

        public void Clusters(ClusterMap map, Span<uint> bits)
        {
            fixed (uint* dst = &MemoryMarshal.GetReference(bits)) Clusters(map, dst, bits.Length);
        }

        /// <summary>The polygons to draw into the shadow map of a sun, as ranges.</summary>
        public int CasterRanges(Casters casters, uint sun, PolygonRange* dst, int capacity)
        {
            UIntPtr count;
            Status status = Native.sightcell_view_casters(Pointer, casters.Pointer, sun, dst, (UIntPtr)capacity, &count);
            Check(status, "casters");
            GC.KeepAlive(casters);
            return (int)count;
        }

        public int CasterRanges(Casters casters, uint sun, Span<PolygonRange> dst)
        {
            fixed (PolygonRange* first = &MemoryMarshal.GetReference(dst))
            {
                return CasterRanges(casters, sun, first, dst.Length);
            }
        }

        /// <summary>The same polygons as an index list.</summary>
        public int CasterIndices(Casters casters, uint sun, uint* storedIndices, uint* dst, int capacity)
        {
            UIntPtr count;
            Status status = Native.sightcell_view_caster_indices(Pointer, casters.Pointer, sun, storedIndices, dst,
                (UIntPtr)capacity, &count);
            Check(status, "casters");
            GC.KeepAlive(casters);
            return (int)count;
        }

        public int CasterIndices(Casters casters, uint sun, ReadOnlySpan<uint> storedIndices, Span<uint> dst)
        {
            fixed (uint* stored = &MemoryMarshal.GetReference(storedIndices))
            fixed (uint* first = &MemoryMarshal.GetReference(dst))
            {
                return CasterIndices(casters, sun, stored, first, dst.Length);
            }
        }

        /// <summary>The numbers of the lights that touch what is visible from here.</summary>
        public int LightsHere(Lights lights, uint* dst, int capacity)
        {
            UIntPtr count;
            Status status = Native.sightcell_view_lights(Pointer, lights.Pointer, dst, (UIntPtr)capacity, &count);
            Check(status, "lights");
            GC.KeepAlive(lights);
            return (int)count;
        }

        public int LightsHere(Lights lights, Span<uint> dst)
        {
            fixed (uint* first = &MemoryMarshal.GetReference(dst))
            {
                return LightsHere(lights, first, dst.Length);
            }
        }

        /// <summary>The polygons that a light reaches, as ranges.</summary>
        public int LightRanges(Lights lights, uint light, PolygonRange* dst, int capacity)
        {
            UIntPtr count;
            Status status = Native.sightcell_view_light_ranges(Pointer, lights.Pointer, light, dst, (UIntPtr)capacity, &count);
            Check(status, "light");
            GC.KeepAlive(lights);
            return (int)count;
        }

        public int LightRanges(Lights lights, uint light, Span<PolygonRange> dst)
        {
            fixed (PolygonRange* first = &MemoryMarshal.GetReference(dst))
            {
                return LightRanges(lights, light, first, dst.Length);
            }
        }

        /// <summary>The same polygons as an index list.</summary>
        public int LightIndices(Lights lights, uint light, uint* storedIndices, uint* dst, int capacity)
        {
            UIntPtr count;
            Status status = Native.sightcell_view_light_indices(Pointer, lights.Pointer, light, storedIndices, dst,
                (UIntPtr)capacity, &count);
            Check(status, "light");
            GC.KeepAlive(lights);
            return (int)count;
        }

        public int LightIndices(Lights lights, uint light, ReadOnlySpan<uint> storedIndices, Span<uint> dst)
        {
            fixed (uint* stored = &MemoryMarshal.GetReference(storedIndices))
            fixed (uint* first = &MemoryMarshal.GetReference(dst))
            {
                return LightIndices(lights, light, stored, first, dst.Length);
            }
        }

        /// <summary>The finest level of each texture that a picture from here can need, or Residency.NoLevel.
        /// pixelsPerRadian: height / (2 tan(angle / 2)) of the picture.</summary>
        public int TextureLevels(Residency residency, float pixelsPerRadian, byte* dst, int capacity)
        {
            UIntPtr count;
            Status status = Native.sightcell_view_texture_levels(Pointer, residency.Pointer, pixelsPerRadian, dst,
                (UIntPtr)capacity, &count);
            Check(status, "levels");
            GC.KeepAlive(residency);
            return (int)count;
        }

        public int TextureLevels(Residency residency, float pixelsPerRadian, Span<byte> dst)
        {
            fixed (byte* first = &MemoryMarshal.GetReference(dst))
            {
                return TextureLevels(residency, pixelsPerRadian, first, dst.Length);
            }
        }

        /// <summary>The visible solid angle of each draw, in steradians. False under DrawAll, where it is not known: all
        /// elements are 0 then.</summary>
        public bool Importance(Span<float> byDraw)
        {
            UIntPtr count;
            fixed (float* dst = &MemoryMarshal.GetReference(byDraw))
            {
                Status status = Native.sightcell_view_importance(Pointer, dst, (UIntPtr)byDraw.Length, &count);
                Check(status == Status.Stale ? Status.Ok : status, "importance");
                return status == Status.Ok;
            }
        }

        /// <summary>The ranges that were added and removed since a revision. False where this is not known: take the full
        /// list then.</summary>
        public bool Changes(uint sinceRevision, Span<PolygonRange> added, out int addedCount, Span<PolygonRange> removed,
            out int removedCount)
        {
            UIntPtr more, less;
            fixed (PolygonRange* plus = &MemoryMarshal.GetReference(added))
            fixed (PolygonRange* minus = &MemoryMarshal.GetReference(removed))
            {
                Status status = Native.sightcell_view_changes(Pointer, sinceRevision, plus, (UIntPtr)added.Length, &more, minus,
                    (UIntPtr)removed.Length, &less);
                Check(status == Status.Stale ? Status.Ok : status, "changes");
                addedCount = (int)more;
                removedCount = (int)less;
                return status == Status.Ok;
            }
        }

        /// <summary>Whether anything in a box can be visible, for objects that move. True for a file without volumes.</summary>
        public bool BoxVisible(Float3 min, Float3 max)
        {
            uint visible;
            Check(Native.sightcell_view_box_visible(Pointer, (float*)&min, (float*)&max, &visible), "box");
            return visible != 0;
        }

        // ---- Tools ----

        /// <summary>Counts since the view was created.</summary>
        public ViewStats Statistics
        {
            get
            {
                ViewStats stats = ViewStats.Sized;
                Check(Native.sightcell_view_statistics(Pointer, &stats), "statistics");
                return stats;
            }
        }

        /// <summary>The edges of boxes of cells and volumes. With an empty span, it returns their number.</summary>
        public int DebugLines(DebugLineKinds kinds, Span<DebugLine> dst)
        {
            UIntPtr count;
            fixed (DebugLine* first = &MemoryMarshal.GetReference(dst))
            {
                Status status = Native.sightcell_view_debug_lines(Pointer, (uint)kinds, first, (UIntPtr)dst.Length, &count);
                Check(status == Status.Capacity && dst.Length == 0 ? Status.Ok : status, "debug lines");
                return (int)count;
            }
        }
    }
}
