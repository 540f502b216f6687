using System;
using System.Runtime.InteropServices;

namespace Sightcell
{
    /// <summary>An object of the library. Dispose releases it; without Dispose, the garbage collector does so some time
    /// after its last use. An object keeps the database that it was made of alive.
    /// DangerousGetHandle is the pointer that functions of Native take.</summary>
    public abstract class NativeObject : SafeHandle
    {
        private NativeObject parent;

        internal NativeObject() : base(IntPtr.Zero, true)
        {
        }

        public override bool IsInvalid => handle == IntPtr.Zero;

        /// <summary>The pointer of an object that was not disposed.</summary>
        internal IntPtr Pointer
        {
            get
            {
                if (IsClosed || IsInvalid) throw new ObjectDisposedException(GetType().Name);
                return handle;
            }
        }

        /// <summary>Keeps an object alive for as long as this one. Called before the function that makes this one.</summary>
        internal IntPtr Hold(NativeObject of)
        {
            if (of == null) throw new ArgumentNullException(nameof(of));
            IntPtr pointer = of.Pointer;
            bool added = false;
            of.DangerousAddRef(ref added);
            parent = of;
            return pointer;
        }

        /// <summary>Takes what a function made, or throws its failure.</summary>
        internal void Take(Status status, IntPtr made, string what)
        {
            if (status == Status.Ok)
            {
                SetHandle(made);
                return;
            }
            Release();
            throw new SightcellException(status, what);
        }

        /// <summary>Throws where a function failed. As a method of the object that was passed to the function, it also
        /// keeps this object from being released by the garbage collector during the call.</summary>
        internal void Check(Status status, string what)
        {
            GC.KeepAlive(this);
            if (status != Status.Ok) throw new SightcellException(status, what);
        }

        protected override bool ReleaseHandle()
        {
            Destroy(handle);
            Release();
            return true;
        }

        internal abstract void Destroy(IntPtr pointer);

        private void Release()
        {
            parent?.DangerousRelease();
            parent = null;
        }
    }
}
