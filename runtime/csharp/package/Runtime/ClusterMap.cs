using System;
using System.Runtime.InteropServices;

namespace Sightcell
{
    /// <summary>The clusters (meshlets) of a host, arranged for the polygon order of a file. Never changes; shared by
    /// threads.</summary>
    public sealed unsafe class ClusterMap : NativeObject
    {
        /// <summary>The number of clusters.</summary>
        public int Count { get; }

        /// <summary>The number of words of a row of bits.</summary>
        public int Words => (int)(((uint)Count + 31) / 32);

        /// <summary>Makes a map of clusters of the host.</summary>
        /// <param name="clusterOfSource">the cluster of each polygon by source id, or Constants.NoCluster</param>
        public ClusterMap(Database database, ReadOnlySpan<uint> clusterOfSource, int count)
        {
            IntPtr made = IntPtr.Zero;
            Count = count;
            fixed (uint* clusters = &MemoryMarshal.GetReference(clusterOfSource))
            {
                Take(Native.sightcell_cluster_map_create(Hold(database), clusters, (UIntPtr)clusterOfSource.Length,
                    checked((uint)count), &made), made, "cluster map");
            }
        }

        /// <summary>Makes a map of the clusters of a file of clusters: bit c of a row is cluster c of the file.</summary>
        public ClusterMap(Database database)
        {
            IntPtr made = IntPtr.Zero;
            IntPtr of = Hold(database);
            Count = (int)Native.sightcell_db_cluster_count(of);
            Take(Native.sightcell_cluster_map_of_file(of, &made), made, "cluster map");
        }

        internal override void Destroy(IntPtr pointer)
        {
            Native.sightcell_cluster_map_destroy(pointer);
        }

        /// <summary>The clusters of a row whose bits are 1, in ascending order. Returns their number.</summary>
        public static int List(ReadOnlySpan<uint> row, Span<uint> dst)
        {
            UIntPtr count;
            fixed (uint* bits = &MemoryMarshal.GetReference(row))
            fixed (uint* first = &MemoryMarshal.GetReference(dst))
            {
                Status status = Native.sightcell_cluster_list(bits, (UIntPtr)row.Length, first, (UIntPtr)dst.Length, &count);
                if (status != Status.Ok) throw new SightcellException(status, "cluster list");
            }
            return (int)count;
        }

        /// <summary>The words in which two rows of equal length differ. Returns their number.</summary>
        public static int Changes(ReadOnlySpan<uint> before, ReadOnlySpan<uint> now, Span<ClusterWord> dst)
        {
            if (before.Length != now.Length) throw new SightcellException(Status.Argument, "rows differ in length");
            UIntPtr count;
            fixed (uint* old = &MemoryMarshal.GetReference(before))
            fixed (uint* bits = &MemoryMarshal.GetReference(now))
            fixed (ClusterWord* first = &MemoryMarshal.GetReference(dst))
            {
                Status status = Native.sightcell_cluster_changes(old, bits, (UIntPtr)now.Length, first, (UIntPtr)dst.Length, &count);
                if (status != Status.Ok) throw new SightcellException(status, "cluster changes");
            }
            return (int)count;
        }
    }

    /// <summary>The shadow casters of a file. One thread at a time.</summary>
    public sealed unsafe class Casters : NativeObject
    {
        /// <summary>Reads the casters. Throws Status.Absent for a file that was baked without --sun.</summary>
        public Casters(Database database)
        {
            IntPtr made = IntPtr.Zero;
            Take(Native.sightcell_casters_create(Hold(database), &made), made, "casters");
        }

        internal override void Destroy(IntPtr pointer)
        {
            Native.sightcell_casters_destroy(pointer);
        }

        /// <summary>The suns of the file.</summary>
        public Sun[] Suns()
        {
            UIntPtr count;
            Status status = Native.sightcell_casters_suns(Pointer, null, UIntPtr.Zero, &count);
            Check(status == Status.Capacity ? Status.Ok : status, "suns");
            Sun[] suns = new Sun[(int)count];
            fixed (Sun* dst = suns) Check(Native.sightcell_casters_suns(Pointer, dst, count, &count), "suns");
            return suns;
        }
    }
}
