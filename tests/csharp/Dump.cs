// Writes what the package returns for files, in the format of dump.c.
using System;
using System.Runtime.InteropServices;
using Sightcell;

internal static unsafe class Dump
{
    private static readonly PolygonRange[] ranges = new PolygonRange[20000], more = new PolygonRange[20000];
    private static readonly IndirectCommand[] commands = new IndirectCommand[20000];
    private static readonly DebugLine[] lines = new DebugLine[20000];
    private static readonly uint[] words = new uint[60000], list = new uint[60000], stored = new uint[60000];
    private static Database database;
    private static View view;
    private static DatabaseInfo info;

    private static uint Hash(void* data, int count)
    {
        uint sum = 2166136261;
        for (int i = 0; i < count; ++i) sum = unchecked((sum ^ ((uint*)data)[i]) * 16777619);
        return sum;
    }

    // The result of a call: its number, or the status of the exception.
    private static Status Try(Func<int> call, out int count)
    {
        count = 0;
        try
        {
            count = call();
            return Status.Ok;
        }
        catch (SightcellException failure)
        {
            return failure.Status;
        }
    }

    // data: an array of blittable structs.
    private static void Line(string name, Status status, int count, Array data, int words)
    {
        GCHandle pinned = GCHandle.Alloc(data, GCHandleType.Pinned);
        uint hash = status == Status.Ok ? Hash((void*)pinned.AddrOfPinnedObject(), words) : 0;
        pinned.Free();
        Console.WriteLine("{0} {1} {2} {3:x8}", name, (int)status, status == Status.Ok ? count : 0, hash);
    }

    private static void List(string name, Func<int> call, Array data, int perElement)
    {
        Status status = Try(call, out int count);
        Line(name, status, count, data, count * perElement);
    }

    private static void Floats(string name, Status status, params float[] values)
    {
        Console.Write("{0} {1}", name, (int)status);
        for (int i = 0; i < values.Length && status == Status.Ok; ++i)
        {
            float value = values[i];
            Console.Write(" {0:x8}", *(uint*)&value);
        }
        Console.WriteLine();
    }

    private static void Floats(string name, Box box)
    {
        Floats(name, Status.Ok, box.Min.X, box.Min.Y, box.Min.Z, box.Max.X, box.Max.Y, box.Max.Z);
    }

    private static void Scene()
    {
        Draw[] draws = database.Draws();
        Line("draws", Status.Ok, draws.Length, draws, draws.Length * sizeof(Draw) / 4);
        uint[] order = database.Order();
        Line("order", Status.Ok, order.Length, order, order.Length);
        uint[] groups = database.NamedGroupsOfDraws();
        Line("groups", Status.Ok, groups.Length, groups, groups.Length);
        for (uint g = 0; g < database.NamedGroupCount; ++g)
        {
            string name = database.NamedGroupName(g);
            Console.WriteLine("group {0} {1}", name, database.FindNamedGroup(name));
        }
        for (uint d = 0; d < info.DrawCount; ++d)
        {
            ulong hash = 0;
            string name = "";
            Status ofHash = Try(() => { hash = database.DrawHash(d); return 0; }, out _);
            Status ofName = Try(() => { name = database.DrawName(d, NameKind.Node); return 0; }, out _);
            Console.WriteLine("draw {0} {1:x16} {2} {3}", (int)ofHash, hash, (int)ofName, name);
        }
        for (uint c = 0; c < info.CellCount; ++c)
        {
            Floats("cell", database.CellBox(c));
            Float3 eye = default(Float3);
            bool known = false;
            Status status = Try(() => { known = database.TryCellEye(c, 0, out eye); return 0; }, out _);
            Floats("eye", status == Status.Ok && !known ? Status.Absent : status, eye.X, eye.Y, eye.Z);
            float valid = 0, outside = 0;
            status = Try(() => { database.CellViewpoints(c, out valid, out outside); return 0; }, out _);
            Floats("shares", status, valid, outside);
        }
        float[] bounds = new float[0];
        Status ofBounds = Try(() => { bounds = database.ErrorBounds(); return 0; }, out _);
        Line("bounds", ofBounds, bounds.Length, bounds, bounds.Length);
        for (uint v = 0; v < database.VolumeCount; ++v) Floats("volume", database.VolumeBox(v));
        PolygonRange[] clusters = database.Clusters();
        Line("clusters", Status.Ok, clusters.Length, clusters, 3 * clusters.Length);
    }

    private static void Outputs(Frame frame, ClusterMap own, ClusterMap ofFile, Casters casters, Lights lights,
        Residency residency)
    {
        ulong[] objects = new ulong[(info.DrawCount + 63) / 64];
        Status status = Try(() => { view.Objects(objects); return 0; }, out _);
        Line("objects", status, objects.Length, objects, 2 * objects.Length);
        List("ranges", () => view.Ranges(ranges), ranges, 3);
        List("polygons", () => view.Polygons(words), words, 1);
        List("indices", () => view.Indices(stored, words), words, 1);
        List("commands", () => view.Commands(4, commands), commands, 5);
        bool known = view.Changes(frame.Revision - 1, ranges, out int added, more, out int removed);
        Line("added", known ? Status.Ok : Status.Stale, added, ranges, 3 * added);
        Line("removed", known ? Status.Ok : Status.Stale, removed, more, 3 * removed);
        float[] importance = new float[info.DrawCount];
        status = Try(() => { known = view.Importance(importance); return 0; }, out _);
        status = status == Status.Ok && !known ? Status.Stale : status;
        Line("importance", status, importance.Length, importance, importance.Length);
        uint[] row = new uint[own.Words];
        status = Try(() => { view.Clusters(own, row); return 0; }, out _);
        Line("own clusters", status, row.Length, row, row.Length);
        List("cluster list", () => ClusterMap.List(row, list), list, 1);
        if (ofFile != null)
        {
            uint[] bits = new uint[ofFile.Words];
            status = Try(() => { view.Clusters(ofFile, bits); return 0; }, out _);
            Line("file clusters", status, bits.Length, bits, bits.Length);
        }
        if (casters != null)
        {
            List("casters", () => view.CasterRanges(casters, 0, ranges), ranges, 3);
            List("caster indices", () => view.CasterIndices(casters, 0, stored, words), words, 1);
        }
        if (lights != null)
        {
            List("lights", () => view.LightsHere(lights, words), words, 1);
            List("light", () => view.LightRanges(lights, 3, ranges), ranges, 3);
            List("light indices", () => view.LightIndices(lights, 3, stored, words), words, 1);
        }
        if (residency != null)
        {
            byte[] levels = new byte[residency.Textures().Length];
            List("levels", () => Widened(levels, view.TextureLevels(residency, 700, levels)), words, 1);
            List("cell levels", () => Widened(levels, residency.CellLevels(0, 700, levels)), words, 1);
        }
        List("lines", () => view.DebugLines((DebugLineKinds)31, lines), lines, 8);
    }

    private static int Widened(byte[] levels, int count)
    {
        for (int i = 0; i < count; ++i) words[i] = levels[i];
        return count;
    }

    private static void Frame(string name, Frame frame)
    {
        Console.WriteLine("{0} 0 {1} {2} {3} {4}", name, frame.Cell, (uint)frame.Flags, frame.PolygonCount, frame.Revision);
    }

    private static void Move(Float3 eye, ClusterMap own, ClusterMap ofFile, Casters casters, Lights lights,
        Residency residency)
    {
        Float3 max = new Float3(eye.X + 0.5f, eye.Y + 0.5f, eye.Z + 0.5f);
        Frame frame = view.Move(eye);
        Frame("move", frame);
        Outputs(frame, own, ofFile, casters, lights, residency);
        Console.WriteLine("visible 0 {0}", view.BoxVisible(eye, max) ? 1 : 0);
        Frame("box", view.MoveBox(eye, max));
    }

    private static void Walk()
    {
        uint[] clusterOfSource = new uint[info.PolygonCount];
        for (uint i = 0; i < clusterOfSource.Length; ++i) clusterOfSource[i] = i / 7;
        ClusterMap ofFile = null;
        Casters casters = null;
        Lights lights = null;
        Residency residency = null;
        using (ClusterMap own = new ClusterMap(database, clusterOfSource, (int)info.PolygonCount / 7 + 1))
        {
            Console.WriteLine("map {0}", (int)Try(() => { ofFile = new ClusterMap(database); return 0; }, out _));
            Console.WriteLine("suns {0}", (int)Try(() => { casters = new Casters(database); return 0; }, out _));
            Console.WriteLine("lights {0}", (int)Try(() => { lights = new Lights(database); return 0; }, out _));
            if (lights != null)
            {
                BakedLight[] all = lights.List();
                Line("list of lights", Status.Ok, all.Length, all, sizeof(BakedLight) / 4 * all.Length);
            }
            Console.WriteLine("residency {0}", (int)Try(() => { residency = new Residency(database); return 0; }, out _));
            if (residency != null)
            {
                ResidentTexture[] textures = residency.Textures();
                Line("textures", Status.Ok, textures.Length, textures, 3 * textures.Length);
            }
            for (uint i = 0; i < 3 * info.PolygonCount; ++i) stored[i] = 10 * i;
            for (uint c = 0; c < info.CellCount; ++c)
            {
                Box box = database.CellBox(c);
                Move(new Float3(0.5f * (box.Min.X + box.Max.X), 0.5f * (box.Min.Y + box.Max.Y), 0.5f * (box.Min.Z + box.Max.Z)),
                    own, ofFile, casters, lights, residency);
            }
            view.SetOrigin(new Double3(1e6, 0, -1e6));
            view.SetPolicy(ViewPolicy.OutsideNearest | ViewPolicy.PendingLast, 3e6f);
            Console.WriteLine("origin 0\npolicy 0");
            for (uint g = 0; g < database.NamedGroupCount; ++g) view.ShowNamedGroup(g, false);
            Move(new Float3(-1e6f, 0.5f, 1e6f), own, ofFile, casters, lights, residency);
        }
        ViewStats[] stats = { view.Statistics };
        Line("statistics", Status.Ok, (int)stats[0].Moves, stats, sizeof(ViewStats) / 4);
        Miss[] misses = { new Miss { Eye = new Double3(1.5, 2, 3) },
                          new Miss { Eye = new Double3(-1.5, 0.125, 3e5), Polygon = info.PolygonCount - 1 } };
        Console.WriteLine(database.MissesText(misses));
        residency?.Dispose();
        lights?.Dispose();
        casters?.Dispose();
        ofFile?.Dispose();
    }

    public static void Files(string[] paths)
    {
        foreach (string path in paths)
        {
            try
            {
                database = Database.Open(path);
                Console.WriteLine("open 0 {0}", Utf8Text(Status.Ok));
            }
            catch (SightcellException failure)
            {
                Console.WriteLine("open {0} {1}", (int)failure.Status, Utf8Text(failure.Status));
                continue;
            }
            info = database.Info;
            DatabaseInfo[] infos = { info };
            Line("info", Status.Ok, (int)info.CellCount, infos, sizeof(DatabaseInfo) / 4);
            Console.WriteLine("check {0}", (int)Try(() => { database.CheckAll(); return 0; }, out _));
            Scene();
            view = new View(database);
            Walk();
            view.Dispose();
            database.Dispose();
        }
    }

    private static string Utf8Text(Status status)
    {
        return Marshal.PtrToStringAnsi((IntPtr)Native.sightcell_status_text(status));
    }
}
