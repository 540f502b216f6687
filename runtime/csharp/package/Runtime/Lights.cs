using System;
using System.Runtime.InteropServices;

namespace Sightcell
{
    /// <summary>The lights of a file. One thread at a time.</summary>
    public sealed unsafe class Lights : NativeObject
    {
        /// <summary>Reads the lights. Throws Status.Absent for a file that was baked without --lights.</summary>
        public Lights(Database database)
        {
            IntPtr made = IntPtr.Zero;
            Take(Native.sightcell_lights_create(Hold(database), &made), made, "lights");
        }

        internal override void Destroy(IntPtr pointer)
        {
            Native.sightcell_lights_destroy(pointer);
        }

        /// <summary>The lights of the file. Their places in the array are their numbers.</summary>
        public BakedLight[] List()
        {
            UIntPtr count;
            Status status = Native.sightcell_lights_list(Pointer, null, UIntPtr.Zero, &count);
            Check(status == Status.Capacity ? Status.Ok : status, "lights");
            BakedLight[] lights = new BakedLight[(int)count];
            fixed (BakedLight* dst = lights) Check(Native.sightcell_lights_list(Pointer, dst, count, &count), "lights");
            return lights;
        }
    }
}
