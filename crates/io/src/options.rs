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
            /// How many samples a raw volume has along x, y and z, such as 256x256x128.
            dimensions: String = String::new(),
            /// The type of the samples of a raw volume.
            scalar: ScalarType = ScalarType::U8,
            /// The order of the bytes of a sample in a raw volume.
            byte_order: ByteOrder = ByteOrder::Little,
            /// How many bytes of a raw volume come before the first sample.
            skip: u32 = 0,
            /// The distances between samples along x, y and z in raw volumes and stacks of pictures, such as 0.5x0.5x2, or
            /// one number for all three.
            voxel_size: String = "1".to_owned(),
            /// How hard the atoms of molecules are: small numbers blur them to one lump, from 8 on they keep their balls.
            blobbiness: f64 [Bounds { max: 64.0, ..Bounds::POSITIVE }] = 2.0,
            /// What the van der Waals radii of the atoms of molecules are multiplied by.
            atom_scale: f64 [Bounds::POSITIVE] = 1.0,
            /// Whether a picture is a slice of a volume, whose others are the files beside it with the numbers that follow
            /// the one in its name, or the further pages of its file.
            stack: bool = false,
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
    /// The numbers of a file without a header.
    pub enum ScalarType {
        /// 8 bits with a sign.
        I8 = "i8",
        /// 8 bits.
        U8 = "u8",
        /// 16 bits with a sign.
        I16 = "i16",
        /// 16 bits.
        U16 = "u16",
        /// 32 bits with a sign.
        I32 = "i32",
        /// 32 bits.
        U32 = "u32",
        /// 64 bits with a sign.
        I64 = "i64",
        /// 64 bits.
        U64 = "u64",
        /// Single precision.
        F32 = "f32",
        /// Double precision.
        F64 = "f64",
    }
}

choice! {
    /// Which byte of a number comes first in a file without a header.
    pub enum ByteOrder {
        /// The lowest.
        Little = "little",
        /// The highest.
        Big = "big",
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
            /// Whether the samples of volumes are compressed, in formats that know it.
            compress: bool = false,
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
