using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Sightcell
{
    /// <summary>An open .pvs file, or a .glb that contains one. Any number of threads may use it at once. Functions that
    /// return arrays and strings allocate: call them after loading, not per frame.</summary>
    public sealed unsafe class Database : NativeObject
    {
        private GCHandle pinned;
        private string name = "file in memory";

        private Database()
        {
        }

        /// <summary>Reads a file from the disk and opens it.</summary>
        public static Database Open(string path)
        {
            byte[] text = Utf8.Bytes(path);
            Database made = new Database { name = path };
            IntPtr opened = IntPtr.Zero;
            CheckLibrary();
            fixed (byte* bytes = text)
            {
                made.Take(Native.sightcell_db_open_file(bytes, null, &opened), opened, path);
            }
            return made;
        }

        /// <summary>Opens a file in an array. The database pins the array until it is disposed: do not change it.</summary>
        public static Database Open(byte[] bytes)
        {
            if (bytes == null) throw new ArgumentNullException(nameof(bytes));
            Database made = new Database();
            made.pinned = GCHandle.Alloc(bytes, GCHandleType.Pinned);
            try
            {
                made.OpenAt((void*)made.pinned.AddrOfPinnedObject(), bytes.LongLength);
            }
            catch
            {
                made.pinned.Free();
                throw;
            }
            return made;
        }

        /// <summary>Opens a file in memory, such as that of a NativeArray. The caller keeps it until the database and all
        /// that was made of it are disposed.</summary>
        public static Database Open(void* bytes, long size)
        {
            Database made = new Database();
            made.OpenAt(bytes, size);
            return made;
        }

        private void OpenAt(void* bytes, long size)
        {
            IntPtr opened = IntPtr.Zero;
            CheckLibrary();
            Take(Native.sightcell_db_open(bytes, (UIntPtr)size, null, &opened), opened, name);
        }

        private static void CheckLibrary()
        {
            if (Native.sightcell_version() != Constants.ApiVersion)
            {
                throw new SightcellException(Status.Version, "the library has another version than this package");
            }
        }

        internal override void Destroy(IntPtr pointer)
        {
            Native.sightcell_db_close(pointer);
            if (pinned.IsAllocated) pinned.Free();
        }

        /// <summary>Facts about the file.</summary>
        public DatabaseInfo Info
        {
            get
            {
                DatabaseInfo info = DatabaseInfo.Sized;
                Check(Native.sightcell_db_info(Pointer, &info), name);
                return info;
            }
        }

        /// <summary>The 16 bytes that identify the scene of the bake.</summary>
        public byte[] SceneFingerprint()
        {
            DatabaseInfo info = Info;
            byte[] bytes = new byte[16];
            Marshal.Copy((IntPtr)info.SceneFingerprint, bytes, 0, 16);
            return bytes;
        }

        /// <summary>Whether the file was baked from the scene with this fingerprint.</summary>
        public bool IsOfScene(byte[] fingerprint)
        {
            if (fingerprint == null || fingerprint.Length != 16) throw new ArgumentException("a fingerprint has 16 bytes");
            fixed (byte* bytes = fingerprint)
            {
                Status status = Native.sightcell_db_same_scene(Pointer, bytes);
                Check(status == Status.OtherScene ? Status.Ok : status, name);
                return status == Status.Ok;
            }
        }

        /// <summary>The draw table. It is NOT in the order of the scene: see sightcell_db_draws.</summary>
        public Draw[] Draws()
        {
            Draw[] draws = new Draw[Info.DrawCount];
            UIntPtr count;
            fixed (Draw* dst = draws)
            {
                Check(Native.sightcell_db_draws(Pointer, dst, (UIntPtr)draws.Length, &count), name);
            }
            return draws;
        }

        /// <summary>The source id of each stored polygon, by which a host permutes its index buffers.</summary>
        public uint[] Order()
        {
            uint[] order = new uint[Info.PolygonCount];
            UIntPtr count;
            fixed (uint* dst = order)
            {
                Check(Native.sightcell_db_order(Pointer, dst, (UIntPtr)order.Length, &count), name);
            }
            return order;
        }

        /// <summary>The box of a cell, without the margin.</summary>
        public Box CellBox(uint cell)
        {
            Box box = default(Box);
            Check(Native.sightcell_db_cell_box(Pointer, cell, (float*)&box.Min, (float*)&box.Max), "cell " + cell);
            return box;
        }

        /// <summary>A valid viewpoint of a cell. False if the file has none of this number. Not for calls per frame.</summary>
        public bool TryCellEye(uint cell, uint number, out Float3 eye)
        {
            Float3 found = default(Float3);
            Status status = Native.sightcell_db_cell_eye(Pointer, cell, number, (float*)&found);
            eye = found;
            Check(status == Status.Absent ? Status.Ok : status, "cell " + cell);
            return status == Status.Ok;
        }

        /// <summary>The upper bound of the miss probability of each cell, 0 .. 1. Throws Status.Absent if the file has no
        /// bounds.</summary>
        public float[] ErrorBounds()
        {
            float[] bounds = new float[Info.CellCount];
            UIntPtr count;
            fixed (float* dst = bounds)
            {
                Check(Native.sightcell_db_error_bounds(Pointer, dst, (UIntPtr)bounds.Length, &count), name);
            }
            return bounds;
        }

        /// <summary>Which share of a cell its error bound is about: see sightcell_db_cell_viewpoints.</summary>
        public void CellViewpoints(uint cell, out float validShare, out float outsideShare)
        {
            float valid, outside;
            Check(Native.sightcell_db_cell_viewpoints(Pointer, cell, &valid, &outside), "cell " + cell);
            validShare = valid;
            outsideShare = outside;
        }

        /// <summary>The number of visibility volumes, 0 for a file without.</summary>
        public uint VolumeCount
        {
            get
            {
                uint count = Native.sightcell_db_volume_count(Pointer);
                GC.KeepAlive(this);
                return count;
            }
        }

        /// <summary>The box of a volume.</summary>
        public Box VolumeBox(uint volume)
        {
            Box box = default(Box);
            Check(Native.sightcell_db_volume_box(Pointer, volume, (float*)&box.Min, (float*)&box.Max), "volume " + volume);
            return box;
        }

        /// <summary>The number of named groups.</summary>
        public uint NamedGroupCount
        {
            get
            {
                uint count = Native.sightcell_db_named_group_count(Pointer);
                GC.KeepAlive(this);
                return count;
            }
        }

        /// <summary>The name of a named group.</summary>
        public string NamedGroupName(uint group)
        {
            UIntPtr size;
            Status status = Native.sightcell_db_named_group_name(Pointer, group, null, UIntPtr.Zero, &size);
            Check(status == Status.Capacity ? Status.Ok : status, "named group " + group);
            byte[] text = new byte[(int)size + 1];
            fixed (byte* dst = text)
            {
                Check(Native.sightcell_db_named_group_name(Pointer, group, dst, size, &size), "named group " + group);
            }
            return Encoding.UTF8.GetString(text, 0, (int)size);
        }

        /// <summary>The number of the named group with this name, or Constants.NoNamedGroup.</summary>
        public uint FindNamedGroup(string group)
        {
            uint found;
            fixed (byte* text = Utf8.Bytes(group))
            {
                Check(Native.sightcell_db_find_named_group(Pointer, text, &found), group);
            }
            return found;
        }

        /// <summary>The named group of each draw, or Constants.NoNamedGroup.</summary>
        public uint[] NamedGroupsOfDraws()
        {
            uint[] groups = new uint[Info.DrawCount];
            UIntPtr count;
            fixed (uint* dst = groups)
            {
                Check(Native.sightcell_db_named_groups_of_draws(Pointer, dst, (UIntPtr)groups.Length, &count), name);
            }
            return groups;
        }

        /// <summary>The clusters of a file of clusters, as ranges of the stored order; none for other files.</summary>
        public PolygonRange[] Clusters()
        {
            PolygonRange[] clusters = new PolygonRange[Native.sightcell_db_cluster_count(Pointer)];
            UIntPtr count;
            fixed (PolygonRange* dst = clusters)
            {
                if (clusters.Length > 0)
                {
                    Check(Native.sightcell_db_clusters(Pointer, dst, (UIntPtr)clusters.Length, &count), name);
                }
            }
            GC.KeepAlive(this);
            return clusters;
        }

        /// <summary>Finds the draw of the file for each draw of the host: see sightcell_db_match. The file needs names
        /// (bake --names).</summary>
        /// <param name="hashes">GeometryHash of each draw, in the order of the scene</param>
        /// <param name="names">of the nodes of these draws; null, or null for some: no name</param>
        /// <param name="drawOfHost">receives the number in the draw table, or Constants.NoDraw</param>
        /// <returns>false if a draw is missing or extra: the file is of another scene</returns>
        public bool Match(ulong[] hashes, string[] names, uint[] drawOfHost, out DrawMatch match)
        {
            if (drawOfHost.Length != hashes.Length || (names != null && names.Length != hashes.Length))
            {
                throw new ArgumentException("hashes, names and drawOfHost differ in length");
            }
            DrawMatch counts = DrawMatch.Sized;
            GCHandle[] held = new GCHandle[names == null ? 0 : names.Length];
            IntPtr[] texts = new IntPtr[held.Length];
            Status status;
            try
            {
                for (int i = 0; i < held.Length; ++i)
                {
                    if (names[i] == null) continue;
                    held[i] = GCHandle.Alloc(Utf8.Bytes(names[i]), GCHandleType.Pinned);
                    texts[i] = held[i].AddrOfPinnedObject();
                }
                fixed (ulong* hash = hashes)
                fixed (uint* draw = drawOfHost)
                fixed (IntPtr* text = texts)
                {
                    status = Native.sightcell_db_match(Pointer, hash, (byte**)text, (UIntPtr)hashes.Length, draw, &counts);
                }
            }
            finally
            {
                foreach (GCHandle each in held)
                {
                    if (each.IsAllocated) each.Free();
                }
            }
            match = counts;
            Check(status == Status.OtherScene ? Status.Ok : status, name);
            return status == Status.Ok;
        }

        /// <summary>The geometry hash of triangles, for Match: positions in the space of the glTF mesh, three indices per
        /// triangle.</summary>
        public static ulong GeometryHash(ReadOnlySpan<Float3> positions, ReadOnlySpan<uint> indices)
        {
            ulong hash;
            fixed (Float3* position = &MemoryMarshal.GetReference(positions))
            fixed (uint* index = &MemoryMarshal.GetReference(indices))
            {
                Float3 none;
                uint no_index;
                Status status = Native.sightcell_geometry_hash(position == null ? &none : position, (UIntPtr)sizeof(Float3),
                    (UIntPtr)positions.Length, index == null ? &no_index : index, (UIntPtr)indices.Length, &hash);
                if (status != Status.Ok) throw new SightcellException(status, "geometry hash");
            }
            return hash;
        }

        /// <summary>The geometry hash of a draw of the file.</summary>
        public ulong DrawHash(uint draw)
        {
            ulong hash;
            Check(Native.sightcell_db_draw_hash(Pointer, draw, &hash), "draw " + draw);
            return hash;
        }

        /// <summary>A name of a draw. The file needs names (bake --names).</summary>
        public string DrawName(uint draw, NameKind kind)
        {
            byte* text = stackalloc byte[255];  // longer names are stored without their end
            UIntPtr size;
            Check(Native.sightcell_db_draw_name(Pointer, draw, (uint)kind, text, (UIntPtr)255, &size), "draw " + draw);
            return Encoding.UTF8.GetString(text, (int)size);
        }

        /// <summary>Memory of the database, and counts of a paged one.</summary>
        public DatabaseStats Statistics
        {
            get
            {
                DatabaseStats stats = DatabaseStats.Sized;
                Check(Native.sightcell_db_statistics(Pointer, &stats), name);
                return stats;
            }
        }

        /// <summary>Reads the whole file and checks everything. Throws the first fault.</summary>
        public void CheckAll()
        {
            Check(Native.sightcell_db_check(Pointer), name);
        }

        /// <summary>The text of a misses file, which `sightcell bake --misses` reads.</summary>
        public string MissesText(Miss[] misses)
        {
            UIntPtr size;
            fixed (Miss* first = misses)
            {
                Status status = Native.sightcell_db_misses_text(Pointer, first, (UIntPtr)misses.Length, null, UIntPtr.Zero, &size);
                Check(status == Status.Capacity ? Status.Ok : status, "misses");
                byte[] text = new byte[(int)size];
                fixed (byte* dst = text)
                {
                    Check(Native.sightcell_db_misses_text(Pointer, first, (UIntPtr)misses.Length, dst, size, &size), "misses");
                }
                return Encoding.ASCII.GetString(text);
            }
        }
    }
}
