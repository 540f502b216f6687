// The package as a program uses it. usage: Program.exe dump FILE... | allocations FILE | lifetime FILE | errors ...
using System;
using System.Reflection;
using System.Runtime.InteropServices;
using Sightcell;

internal static class Program
{
    private const int Moves = 10000;

    private static int Main(string[] arguments)
    {
        string[] rest = new string[arguments.Length - 1];
        Array.Copy(arguments, 1, rest, 0, rest.Length);
        switch (arguments[0])
        {
            case "dump": Dump.Files(rest); return 0;
            case "layout": Layout.Print(); return 0;
            case "functions": Functions(); return 0;
            case "allocations": Allocations(rest[0]); return 0;
            case "lifetime": Lifetime(rest[0]); return 0;
            case "errors": Errors.Print(rest); return 0;
            case "arrays": Arrays.Print(rest[0]); return 0;
            case "ten": TenLines.Run(rest[0]); return 0;
            default: return 2;
        }
    }

    // The library has each function that the package declares.
    private static void Functions()
    {
        int count = 0;
        foreach (MethodInfo method in typeof(Native).GetMethods(BindingFlags.Static | BindingFlags.Public))
        {
            if ((method.Attributes & MethodAttributes.PinvokeImpl) == 0) continue;
            Marshal.Prelink(method);
            ++count;
        }
        Console.WriteLine(count);
    }

    // What a host does in each frame.
    private sealed class Host : IDisposable
    {
        private readonly Database database;
        private readonly View view;
        private readonly ClusterMap map;
        private readonly Float3[] eyes;
        private readonly ulong[] objects;
        private readonly PolygonRange[] ranges, added, removed;
        private readonly IndirectCommand[] commands;
        private readonly uint[] stored, indices, row, before, list;
        private readonly ClusterWord[] changed;
        private int at;
        public long Drawn;

        public Host(string path)
        {
            database = Database.Open(path);
            view = new View(database);
            DatabaseInfo info = database.Info;
            uint[] clusters = new uint[info.PolygonCount];
            for (uint i = 0; i < clusters.Length; ++i) clusters[i] = i / 8;
            map = new ClusterMap(database, clusters, (int)(info.PolygonCount / 8 + 1));
            eyes = new Float3[info.CellCount + 1];
            for (uint c = 0; c < info.CellCount; ++c) eyes[c] = database.CellBox(c).Min;
            eyes[info.CellCount] = new Float3(1e9f, 0, 0);
            objects = new ulong[(info.DrawCount + 63) / 64];
            ranges = new PolygonRange[info.RangeBound];
            added = new PolygonRange[info.RangeBound];
            removed = new PolygonRange[info.RangeBound];
            commands = new IndirectCommand[info.RangeBound];
            stored = new uint[3 * info.PolygonCount];
            indices = new uint[3 * info.PolygonCount];
            row = new uint[map.Words];
            before = new uint[map.Words];
            list = new uint[map.Count];
            changed = new ClusterWord[map.Words];
        }

        public void Frame()
        {
            Float3 eye = eyes[at++ % eyes.Length];
            Frame frame = view.Move(eye);
            view.Objects(objects);
            Drawn += view.Ranges(ranges) + view.Indices(stored, indices) + view.Commands(2, commands);
            if (view.Changes(frame.Revision, added, out int more, removed, out int less)) Drawn += more + less;
            view.Clusters(map, row);
            Drawn += ClusterMap.List(row, list) + ClusterMap.Changes(before, row, changed);
            view.BoxVisible(eye, eye);
            Drawn += (long)view.Statistics.Moves + view.MoveBox(eye, eye).PolygonCount;
        }

        public void Dispose()
        {
            map.Dispose();
            view.Dispose();
            database.Dispose();
        }
    }

    // Bytes that the thread allocated in so many frames; with waste, the test allocates itself.
    private static long Allocated(Host host, bool waste)
    {
        for (int i = 0; i < 100; ++i) host.Frame();
        int collections = GC.CollectionCount(0);
        long begin = GC.GetAllocatedBytesForCurrentThread();
        for (int i = 0; i < Moves; ++i)
        {
            host.Frame();
            if (waste) GC.KeepAlive(new byte[8]);
        }
        long bytes = GC.GetAllocatedBytesForCurrentThread() - begin;
        return bytes + GC.CollectionCount(0) - collections;
    }

    private static void Allocations(string path)
    {
        using (Host host = new Host(path))
        {
            Console.WriteLine("frames {0}", Allocated(host, false));
            Console.WriteLine("waste {0}", Allocated(host, true) >= 8 * Moves ? "seen" : "overlooked");
            if (host.Drawn == 0) throw new InvalidOperationException("nothing was drawn");
        }
    }

    // Views outlive the Dispose of their database, and objects without Dispose are collected in any order.
    private static void Lifetime(string path)
    {
        Database database = Database.Open(path);
        View view = new View(database);
        database.Dispose();
        Console.WriteLine("view {0}", view.Move(default(Float3)).PolygonCount > 0);
        view.Dispose();
        Console.WriteLine("closed {0} {1}", view.IsClosed, database.IsClosed);
        byte[] bytes = System.IO.File.ReadAllBytes(path);
        for (int i = 0; i < 300; ++i)
        {
            Database dropped = i % 2 == 0 ? Database.Open(path) : Database.Open(bytes);
            new View(dropped).Move(default(Float3));
            new ClusterMap(dropped, new uint[dropped.Info.PolygonCount], 1);
            if (i % 50 != 0) continue;
            GC.Collect();
            GC.WaitForPendingFinalizers();
        }
        GC.Collect();
        GC.WaitForPendingFinalizers();
        Console.WriteLine("collected");
    }
}
