//! The commands, a file each.

pub(crate) mod boolean;
pub(crate) mod check;
pub(crate) mod coloring;
pub(crate) mod compare;
pub(crate) mod convert;
pub(crate) mod draw;
pub(crate) mod explain;
pub(crate) mod formats;
pub(crate) mod graph;
pub(crate) mod info;
pub(crate) mod make;
pub(crate) mod render;
pub(crate) mod structures;
