// Each failure as the exception that a host gets.
using System;
using System.IO;
using Sightcell;

internal static class Errors
{
    private static void Expect(string name, Action call)
    {
        try
        {
            call();
            Console.WriteLine("{0}: no exception", name);
        }
        catch (SightcellException failure)
        {
            Console.WriteLine("{0}: {1} {2} | {3}", name, failure.Status, failure.Id, failure.Message);
        }
        catch (Exception other)
        {
            Console.WriteLine("{0}: {1}", name, other.GetType().Name);
        }
    }

    // paths: of a good file, and of one for each failure to open.
    public static void Print(string[] paths)
    {
        Database database = Database.Open(paths[0]);
        View view = new View(database);
        for (int i = 1; i < paths.Length; ++i)
        {
            string path = paths[i];
            Expect(Path.GetFileName(path), () => Database.Open(path));
            if (File.Exists(path)) Expect("bytes of " + Path.GetFileName(path), () => Database.Open(File.ReadAllBytes(path)));
        }
        Expect("null path", () => Database.Open((string)null));
        Expect("null database", () => new View(null));
        Expect("no such cell", () => database.CellBox(database.Info.CellCount));
        Expect("NaN", () => view.Move(new Float3(float.NaN, 0, 0)));
        PolygonRange[] ranges = new PolygonRange[database.Info.RangeBound];
        Console.WriteLine("after NaN: {0} ranges", view.Ranges(ranges) > 0 ? "some" : "no");
        Expect("small span", () => view.Ranges(new PolygonRange[0]));
        Expect("no importance", () => view.Importance(new float[database.Info.DrawCount]));
        Expect("no names", () => database.DrawName(0, NameKind.Node));
        Expect("no casters", () => new Casters(database));
        Expect("no lights", () => new Lights(database));
        Expect("no residency", () => new Residency(database));
        Expect("clusters of polygons", () => new ClusterMap(database));
        Expect("table of one", () => new ClusterMap(database, new uint[1], 1));
        Expect("rows", () => ClusterMap.Changes(new uint[1], new uint[2], new ClusterWord[2]));
        view.Dispose();
        Expect("disposed view", () => view.Move(default(Float3)));
        database.Dispose();
        Expect("disposed database", () => new View(database));
        view.Dispose();
    }
}
