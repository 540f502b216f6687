using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Sightcell
{
    /// <summary>A position or direction in the axes of glTF: right-handed, +Y up, meters.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 12)]
    public struct Float3
    {
        public float X, Y, Z;

        public Float3(float x, float y, float z)
        {
            X = x;
            Y = y;
            Z = z;
        }
    }

    /// <summary>A position in double precision.</summary>
    [StructLayout(LayoutKind.Sequential, Size = 24)]
    public struct Double3
    {
        public double X, Y, Z;

        public Double3(double x, double y, double z)
        {
            X = x;
            Y = y;
            Z = z;
        }
    }

    /// <summary>A box in world space. It contains the points with Min &lt;= p &lt; Max on each axis.</summary>
    public struct Box
    {
        public Float3 Min, Max;
    }

    /// <summary>What this package throws when a function of the library fails.</summary>
    public sealed class SightcellException : Exception
    {
        /// <summary>The status that the function returned.</summary>
        public Status Status { get; }

        /// <summary>The id of the status, such as not_ours. It is the same in all languages.</summary>
        public string Id { get; }

        public SightcellException(Status status, string what)
            : base("sightcell: " + what + ": " + Text(status) + " [" + Native.StatusId(status) + "]")
        {
            Status = status;
            Id = Native.StatusId(status);
        }

        private static unsafe string Text(Status status)
        {
            return Utf8.String(Native.sightcell_status_text(status));
        }
    }

    /// <summary>Strings of the library are UTF-8. These functions allocate.</summary>
    internal static unsafe class Utf8
    {
        public static string String(byte* text)
        {
            int size = 0;
            while (text[size] != 0) ++size;
            return Encoding.UTF8.GetString(text, size);
        }

        /// <summary>The bytes of a string, with a zero at the end.</summary>
        public static byte[] Bytes(string text)
        {
            if (text == null) throw new ArgumentNullException(nameof(text));
            byte[] bytes = new byte[Encoding.UTF8.GetByteCount(text) + 1];
            Encoding.UTF8.GetBytes(text, 0, text.Length, bytes, 0);
            return bytes;
        }
    }
}
