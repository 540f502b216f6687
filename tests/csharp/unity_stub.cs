// What the package and its sample take of Unity, with the signatures of Unity's scripting reference: enough to compile
// them. NativeArray works, so that the overloads for it run too.
using System;
using System.Runtime.InteropServices;

namespace Unity.Collections
{
    public struct NativeArray<T> : IDisposable where T : struct
    {
        internal IntPtr Memory;
        public int Length { get; }

        public NativeArray(int length)
        {
            Length = length;
            Memory = Marshal.AllocHGlobal(length * Marshal.SizeOf(typeof(T)));
        }

        public T this[int index] => (T)Marshal.PtrToStructure(Memory + index * Marshal.SizeOf(typeof(T)), typeof(T));

        public void Dispose() => Marshal.FreeHGlobal(Memory);
    }
}

namespace Unity.Collections.LowLevel.Unsafe
{
    public static unsafe class NativeArrayUnsafeUtility
    {
        public static void* GetUnsafePtr<T>(NativeArray<T> array) where T : struct => (void*)array.Memory;

        public static void* GetUnsafeReadOnlyPtr<T>(NativeArray<T> array) where T : struct => (void*)array.Memory;
    }
}

namespace UnityEngine
{
    public struct Vector3
    {
        public float x, y, z;

        public Vector3(float x, float y, float z)
        {
            this.x = x;
            this.y = y;
            this.z = z;
        }
    }

    public class Object
    {
        public string name = "";
    }

    public class Component : Object
    {
        public GameObject gameObject => null;
        public Transform transform => null;

        public T GetComponent<T>() => default(T);

        public T[] GetComponentsInChildren<T>(bool includeInactive) => new T[0];
    }

    public class GameObject : Object
    {
    }

    public class Transform : Component
    {
        public Vector3 position => default(Vector3);

        public Vector3 InverseTransformPoint(Vector3 position) => position;
    }

    public class MonoBehaviour : Component
    {
    }

    public class Camera : Component
    {
    }

    public class Renderer : Component
    {
        public bool forceRenderingOff;
    }

    public class MeshFilter : Component
    {
        public Mesh sharedMesh => null;
    }

    public class Mesh : Object
    {
        public Vector3[] vertices => null;
        public int subMeshCount => 0;

        public int[] GetIndices(int submesh) => null;
    }

    public class TextAsset : Object
    {
        public byte[] bytes => null;
    }

    public class TooltipAttribute : Attribute
    {
        public TooltipAttribute(string tooltip)
        {
        }
    }

    public static class Debug
    {
        public static void LogWarning(object message)
        {
        }

        public static void LogException(Exception exception, Object context)
        {
        }
    }
}
