#if UNITY_2021_3_OR_NEWER
using Unity.Collections;
using Unity.Collections.LowLevel.Unsafe;
using UnityEngine;

namespace Sightcell
{
    /// <summary>The outputs of a view in arrays of Unity, and the axes of Unity. Nothing here allocates.</summary>
    public static unsafe class UnityArrays
    {
        /// <summary>A position of Unity in the axes of glTF. Importers of glTF for Unity invert the X axis: Unity is
        /// left-handed. Where the root of the scene is moved or turned, pass a position relative to it.</summary>
        public static Float3 ToScene(this Vector3 position) => new Float3(-position.x, position.y, position.z);

        /// <summary>A position of the file in the axes of Unity.</summary>
        public static Vector3 ToUnity(this Float3 position) => new Vector3(-position.X, position.Y, position.Z);

        /// <summary>As View.Objects.</summary>
        public static void Objects(this View view, NativeArray<ulong> bitsByDraw)
        {
            view.Objects((ulong*)NativeArrayUnsafeUtility.GetUnsafePtr(bitsByDraw), bitsByDraw.Length);
        }

        /// <summary>As View.Ranges.</summary>
        public static int Ranges(this View view, NativeArray<PolygonRange> dst)
        {
            return view.Ranges((PolygonRange*)NativeArrayUnsafeUtility.GetUnsafePtr(dst), dst.Length);
        }

        /// <summary>As View.Indices, for Mesh.SetIndexBufferData.</summary>
        public static int Indices(this View view, NativeArray<uint> storedIndices, NativeArray<uint> dst)
        {
            return view.Indices((uint*)NativeArrayUnsafeUtility.GetUnsafeReadOnlyPtr(storedIndices),
                (uint*)NativeArrayUnsafeUtility.GetUnsafePtr(dst), dst.Length);
        }

        /// <summary>As View.Commands, in a buffer of 20 bytes per command.</summary>
        public static int Commands(this View view, uint minGap, NativeArray<IndirectCommand> dst)
        {
            return view.Commands(minGap, NativeArrayUnsafeUtility.GetUnsafePtr(dst), sizeof(IndirectCommand), dst.Length);
        }

        /// <summary>As View.Clusters, for GraphicsBuffer.SetData.</summary>
        public static void Clusters(this View view, ClusterMap map, NativeArray<uint> bits)
        {
            view.Clusters(map, (uint*)NativeArrayUnsafeUtility.GetUnsafePtr(bits), bits.Length);
        }
    }
}
#endif
