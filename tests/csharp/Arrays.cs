// The overloads for arrays of Unity return what those for spans return.
using System;
using Sightcell;
#if UNITY_2021_3_OR_NEWER
using Unity.Collections;
#endif

internal static class Arrays
{
    public static void Print(string path)
    {
#if UNITY_2021_3_OR_NEWER
        using (Database database = Database.Open(path))
        using (View view = new View(database))
        {
            DatabaseInfo info = database.Info;
            int polygons = (int)info.PolygonCount;
            ClusterMap map = new ClusterMap(database, new uint[polygons], 1);
            view.Move(database.CellBox(0).Min);
            ulong[] objects = new ulong[(info.DrawCount + 63) / 64];
            PolygonRange[] ranges = new PolygonRange[info.RangeBound];
            IndirectCommand[] commands = new IndirectCommand[info.RangeBound];
            uint[] indices = new uint[3 * polygons], row = new uint[map.Words];
            NativeArray<ulong> objectArray = new NativeArray<ulong>(objects.Length);
            NativeArray<PolygonRange> rangeArray = new NativeArray<PolygonRange>(ranges.Length);
            NativeArray<IndirectCommand> commandArray = new NativeArray<IndirectCommand>(commands.Length);
            NativeArray<uint> indexArray = new NativeArray<uint>(indices.Length), rowArray = new NativeArray<uint>(row.Length);
            NativeArray<uint> storedArray = new NativeArray<uint>(indices.Length);
            uint[] stored = new uint[indices.Length];
            for (int i = 0; i < stored.Length; ++i) stored[i] = storedArray[i];

            view.Objects(objects);
            view.Objects(objectArray);
            Same("objects", objects, objectArray, objects.Length);
            int count = view.Ranges(ranges);
            Same("ranges", ranges, rangeArray, count == view.Ranges(rangeArray) ? count : -1);
            count = view.Commands(1, commands);
            Same("commands", commands, commandArray, count == view.Commands(1, commandArray) ? count : -1);
            count = view.Indices(stored, indices);
            Same("indices", indices, indexArray, count == view.Indices(storedArray, indexArray) ? count : -1);
            view.Clusters(map, row);
            view.Clusters(map, rowArray);
            Same("clusters", row, rowArray, row.Length);
            Float3 there = new Float3(1, 2, 3).ToUnity().ToScene();
            Console.WriteLine("axes {0} {1} {2} {3}", there.X, there.Y, there.Z, new Float3(1, 2, 3).ToUnity().x);
        }
    }

    private static void Same<T>(string name, T[] expected, NativeArray<T> found, int count) where T : struct
    {
        int same = 0;
        while (same < count && expected[same].Equals(found[same])) ++same;
        Console.WriteLine("{0} {1}", name, count > 0 && same == count ? "same" : "differ at " + same + " of " + count);
#endif
    }
}
