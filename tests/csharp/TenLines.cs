// The snippets of the package's README are regions of this file.
using System;
using Sightcell;

internal static class TenLines
{
    private static Database database;
    private static View view;
    private static Draw[] draws;
    private static ulong[] bits;
    private static uint[] stored, indices;
    private static int shown;

    private static void Show(Draw draw, bool visible) => shown += visible ? 1 : 0;

    private static void Open(string path)
    {
        /* [open */
        database = Database.Open(path);   // throws SightcellException: draw everything
        view = new View(database);        // one per camera
        draws = database.Draws();         // not in the order of the scene
        bits = new ulong[(draws.Length + 63) / 64];
        /* open] */
    }

    private static void OnFrame(float x, float y, float z)
    {
        /* [frame */
        Frame frame = view.Move(new Float3(x, y, z));  // meters, axes of glTF
        if ((frame.Flags & FrameFlags.Changed) == 0) return;
        view.Objects(bits);
        for (int d = 0; d < draws.Length; ++d) Show(draws[d], (bits[d / 64] >> (d % 64) & 1) != 0);
        /* frame] */
    }

    private static void Permute(uint[] sourceIndices)
    {
        /* [permute */
        uint[] order = database.Order();
        stored = new uint[3 * order.Length];
        indices = new uint[3 * order.Length];
        for (int s = 0; s < order.Length; ++s) Array.Copy(sourceIndices, 3 * (int)order[s], stored, 3 * s, 3);
        /* permute] */
    }

    private static int Fill()
    {
        /* [fill */
        int count = view.Indices(stored, indices);  // for Mesh.SetIndexBufferData and Mesh.SetSubMesh
        /* fill] */
        return count;
    }

    public static void Run(string path)
    {
        Open(path);
        OnFrame(0.5f, 0.5f, 0.5f);
        OnFrame(0.5f, 0.5f, 0.5f);
        Console.WriteLine("shown {0} of {1}", shown, draws.Length);
        uint[] source = new uint[3 * database.Info.PolygonCount];
        for (uint i = 0; i < source.Length; ++i) source[i] = i;
        Permute(source);
        uint[] polygons = new uint[database.Info.PolygonCount];
        int count = Fill(), visible = view.Polygons(polygons);
        bool same = count == 3 * visible;
        for (int i = 0; same && i < count; ++i) same = indices[i] == 3 * polygons[i / 3] + i % 3;
        Console.WriteLine("indices {0}", same ? "same" : "differ");
        view.Dispose();
        database.Dispose();
    }
}
