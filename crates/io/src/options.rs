//! How files are read and written, where there is a choice.

use shapeloom_core::{choice, options};

options! {
    /// How files are read.
    pub struct ReadOptions("read") {
        required {}
        optional {
            /// Whether corners at exactly the same position become one vertex, in formats that repeat positions (STL).
            weld: bool = true,
            /// Whether vertices at positions that are infinite or not a number are left out, with the elements that use
            /// them, instead of being an error.
            drop_non_finite: bool = false,
        }
    }
}

choice! {
    /// How numbers are laid down.
    pub enum Encoding {
        /// The format's own custom: binary, little endian, where it has it and that is customary.
        Automatic = "automatic",
        /// Text.
        Ascii = "ascii",
        /// Binary, little endian; big endian in formats that know only that.
        Binary = "binary",
        /// Binary, big endian.
        BinaryBigEndian = "binary-big-endian",
    }
}

choice! {
    /// What becomes of parts that share a geometry.
    pub enum Instances {
        /// The geometry is written once, and each part names it.
        Keep = "keep",
        /// Each part is written out where it is.
        Flatten = "flatten",
    }
}

options! {
    /// How files are written.
    pub struct WriteOptions("write") {
        required {}
        optional {
            /// How numbers are laid down.
            encoding: Encoding = Encoding::Automatic,
            /// What becomes of parts that share a geometry, in formats with scenes.
            instances: Instances = Instances::Keep,
        }
    }
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self::new()
    }
}

impl Default for WriteOptions {
    fn default() -> Self {
        Self::new()
    }
}
