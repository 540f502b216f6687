using System.Collections.Generic;
using Sightcell;
using UnityEngine;

/// <summary>Turns off the renderers below this object that are not visible from the camera. The objects are those of a glTF
/// scene; the file was baked from the same scene with --names. Meshes have to be readable (Read/Write enabled).
/// Where anything fails, everything is drawn.</summary>
public sealed class SightcellCulling : MonoBehaviour
{
    [Tooltip("The .pvs file, renamed to end in .bytes")]
    public TextAsset file;

    public Camera eye;

    // One entry per sub-mesh, which is a primitive of the glTF mesh.
    private readonly List<Renderer> renderers = new List<Renderer>();
    private readonly List<ulong> hashes = new List<ulong>();
    private readonly List<string> names = new List<string>();
    private uint[] drawOfPart;
    private ulong[] bits;
    private Database database;
    private View view;

    private void OnEnable()
    {
        try
        {
            database = Database.Open(file.bytes);
            if (drawOfPart == null) FindParts();
            if (!database.Match(hashes.ToArray(), names.ToArray(), drawOfPart, out DrawMatch match))
            {
                Debug.LogWarning($"{file.name}: {match.Missing} draws of the file are not in the scene, {match.Extra} of the " +
                                 "scene not in the file");
            }
            bits = new ulong[(database.Info.DrawCount + 63) / 64];
            view = new View(database);
        }
        catch (SightcellException failure)
        {
            Debug.LogException(failure, this);
            OnDisable();
        }
    }

    private void OnDisable()
    {
        view?.Dispose();
        database?.Dispose();
        view = null;
        database = null;
        foreach (Renderer each in renderers) each.forceRenderingOff = false;
    }

    // Depth first, as the scene has them; children of importers are in the order of the glTF file.
    private void FindParts()
    {
        foreach (MeshFilter filter in GetComponentsInChildren<MeshFilter>(true))
        {
            Mesh mesh = filter.sharedMesh;
            Renderer part = filter.GetComponent<Renderer>();
            if (mesh == null || part == null) continue;
            Vector3[] vertices = mesh.vertices;
            Float3[] positions = new Float3[vertices.Length];
            for (int i = 0; i < vertices.Length; ++i) positions[i] = vertices[i].ToScene();
            for (int i = 0; i < mesh.subMeshCount; ++i)
            {
                hashes.Add(Database.GeometryHash(positions, System.Array.ConvertAll(mesh.GetIndices(i), index => (uint)index)));
                names.Add(filter.gameObject.name);
                renderers.Add(part);
            }
        }
        drawOfPart = new uint[hashes.Count];
    }

    private void LateUpdate()
    {
        if (view == null) return;
        Float3 position = transform.InverseTransformPoint(eye.transform.position).ToScene();
        if ((view.Move(position).Flags & FrameFlags.Changed) == 0) return;
        view.Objects(bits);
        for (int i = 0; i < renderers.Count;)
        {
            Renderer each = renderers[i];
            bool visible = false;
            for (; i < renderers.Count && renderers[i] == each; ++i) visible |= IsVisible(drawOfPart[i]);
            if (each.forceRenderingOff == visible) each.forceRenderingOff = !visible;
        }
    }

    // Parts that the file does not have are always drawn.
    private bool IsVisible(uint draw)
    {
        return draw == Constants.NoDraw || (bits[draw / 64] >> (int)(draw % 64) & 1) != 0;
    }
}
