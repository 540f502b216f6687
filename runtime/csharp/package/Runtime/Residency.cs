using System;
using System.Runtime.InteropServices;

namespace Sightcell
{
    /// <summary>The texture residency of a file. One thread at a time.</summary>
    public sealed unsafe class Residency : NativeObject
    {
        /// <summary>A level that no texture has: no picture needs the texture.</summary>
        public const byte NoLevel = 255;

        /// <summary>Reads the levels. Throws Status.Absent for a file that was baked without --residency.</summary>
        public Residency(Database database)
        {
            IntPtr made = IntPtr.Zero;
            Take(Native.sightcell_residency_create(Hold(database), &made), made, "residency");
        }

        internal override void Destroy(IntPtr pointer)
        {
            Native.sightcell_residency_destroy(pointer);
        }

        /// <summary>The textures of the file, by ascending glTF image.</summary>
        public ResidentTexture[] Textures()
        {
            UIntPtr count;
            Status status = Native.sightcell_residency_textures(Pointer, null, UIntPtr.Zero, &count);
            Check(status == Status.Capacity ? Status.Ok : status, "textures");
            ResidentTexture[] textures = new ResidentTexture[(int)count];
            fixed (ResidentTexture* dst = textures)
            {
                Check(Native.sightcell_residency_textures(Pointer, dst, count, &count), "textures");
            }
            return textures;
        }

        /// <summary>The finest level of each texture that a picture from a cell can need, or NoLevel.
        /// pixelsPerRadian: height / (2 tan(angle / 2)) of the picture.</summary>
        public int CellLevels(uint cell, float pixelsPerRadian, byte* dst, int capacity)
        {
            UIntPtr count;
            Status status = Native.sightcell_residency_cell_levels(Pointer, cell, pixelsPerRadian, dst,
                (UIntPtr)capacity, &count);
            Check(status, "levels");
            return (int)count;
        }

        public int CellLevels(uint cell, float pixelsPerRadian, Span<byte> dst)
        {
            fixed (byte* first = &MemoryMarshal.GetReference(dst))
            {
                return CellLevels(cell, pixelsPerRadian, first, dst.Length);
            }
        }
    }
}
