//! How files are read and written, where there is a choice.

use shapeloom_core::{Bounds, choice, options};

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
            /// How pictures encode heights.
            encoding: HeightEncoding = HeightEncoding::Grey,
            /// The height of white in pictures of whole numbers, in model units: of 255, 65535, or the largest value that
            /// the file says. 0 lets the file decide, and else takes a tenth of the longer side. Below 0 white is low.
            height: f64 [Bounds::FINITE] = 0.0,
            /// The distance between the samples of a picture, in model units. 0 lets the file decide, and else takes 1.
            spacing: f64 [Bounds::NON_NEGATIVE] = 0.0,
            /// What heights are multiplied by after all else, in every format of height fields.
            exaggeration: f64 [Bounds::FINITE] = 1.0,
        }
    }
}

choice! {
    /// How pictures encode heights.
    pub enum HeightEncoding {
        /// The brighter the higher; colours are refused.
        Grey = "grey",
        /// Terrain tiles as Mapbox has them: -10000 + (red · 65536 + green · 256 + blue) / 10 metres.
        Mapbox = "mapbox",
        /// Terrain tiles as Mapzen has them: red · 256 + green + blue / 256 - 32768 metres.
        Terrarium = "terrarium",
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
