//! The one grid of a shape, as writers need it.

use shapeloom_core::Words;
use shapeloom_core::glam::DVec3;
use shapeloom_shape::{Geometry, Shape};
use shapeloom_voxels::isosurface::Lattice;
use shapeloom_voxels::{Samples, VoxelGrid};

use crate::placed::only_part;
use crate::sink::Sink;
use crate::{Format, WriteError};

/// The one grid of a shape, where its part places it.
pub(crate) struct OneGrid<'a> {
    pub(crate) grid: &'a VoxelGrid,
    pub(crate) lattice: Lattice,
}

impl<'a> OneGrid<'a> {
    /// # Errors
    /// A shape of no part or several, or places that are not finite.
    pub(crate) fn try_new(shape: &'a Shape, format: &Format) -> Result<Self, WriteError> {
        let part = only_part(shape, format, "voxel grids")?;
        let Geometry::VoxelGrid(grid) = &*part.geometry else {
            let kind = part.geometry.kind();
            return Err(WriteError::Unsupported { format: format.id, part: 0, kind, holds: format.kinds });
        };
        let plain = part.placement == shapeloom_core::Affine::IDENTITY;
        let lattice = if plain { *grid.lattice() } else { grid.lattice().transformed(&part.placement) };
        // A placement may have flattened it, or moved it out of all numbers.
        Lattice::try_new(lattice.dimensions(), *lattice.placement()).map_err(|_| WriteError::NotFinite {
            format: format.id,
            part: 0,
            name: part.name.clone(),
            element: "lattice",
            index: 0,
        })?;
        Ok(Self { grid, lattice })
    }

    pub(crate) fn origin(&self) -> DVec3 {
        self.lattice.placement().translation
    }

    /// Whether steps run along the axes, forward; then they are the spacing.
    pub(crate) fn along_axes(&self) -> Option<DVec3> {
        let steps = self.lattice.steps();
        let spacing = DVec3::new(steps[0].x, steps[1].y, steps[2].z);
        let rest = (0..3).all(|axis| (0..3).all(|other| axis == other || steps[axis][other] == 0.0));
        (rest && spacing.min_element() > 0.0).then_some(spacing)
    }

    /// Spacing and unit directions, with the largest error of their products in model units at the farthest sample.
    pub(crate) fn spacing_and_directions(&self) -> (DVec3, [DVec3; 3], f64) {
        if let Some(spacing) = self.along_axes() {
            return (spacing, [DVec3::X, DVec3::Y, DVec3::Z], 0.0);
        }
        let steps = self.lattice.steps();
        let spacing = self.lattice.spacing();
        let directions = [0, 1, 2].map(|axis| steps[axis] / spacing[axis]);
        let far = self.lattice.dimensions().map(|count| f64::from(count - 1));
        let error = (0..3).map(|axis| (directions[axis] * spacing[axis] - steps[axis]).length() * far[axis]).sum();
        (spacing, directions, error)
    }

    /// The bytes of the samples, little or big endian; bits become bytes.
    pub(crate) fn put_samples(&self, sink: &mut Sink<'_>, big: bool) -> Result<(), WriteError> {
        /// Numbers between two looks at whether to pass on.
        const SOME: usize = 1 << 12;
        match self.grid.samples() {
            Samples::U8(values) => values.chunks(SOME).try_for_each(|some| sink.bytes(some)),
            Samples::U16(values) => values.chunks(SOME).try_for_each(|some| {
                sink.piece(|block| {
                    block.extend(
                        some.iter().flat_map(|value| if big { value.to_be_bytes() } else { value.to_le_bytes() }),
                    )
                })
            }),
            Samples::F32(values) => values.chunks(SOME).try_for_each(|some| {
                sink.piece(|block| {
                    block.extend(
                        some.iter().flat_map(|value| if big { value.to_be_bytes() } else { value.to_le_bytes() }),
                    )
                })
            }),
            Samples::Bits(_) => {
                let count = self.lattice.samples();
                (0..count.div_ceil(SOME as u64)).try_for_each(|some| {
                    let first = some * SOME as u64;
                    let each = first..(first + SOME as u64).min(count);
                    sink.piece(|block| block.extend(each.map(|at| self.grid.samples().get(at) as u8)))
                })
            }
        }
    }

    /// The bytes of one sample in a file.
    pub(crate) fn size(&self) -> u64 {
        match self.grid.samples() {
            Samples::Bits(_) | Samples::U8(_) => 1,
            Samples::U16(_) => 2,
            Samples::F32(_) => 4,
        }
    }
}

/// Three numbers with blanks between, the shortest that read back to the same bits.
pub(crate) fn three(numbers: DVec3) -> String {
    format!("{} {} {}", plain(numbers.x), plain(numbers.y), plain(numbers.z))
}

/// The shortest decimal number that reads back to the same bits.
pub(crate) fn plain(number: f64) -> String {
    crate::text::shortest(number).to_string()
}

/// How far places are rounded, in words.
pub(crate) fn rounding_words(error: f64) -> String {
    if error == 0.0 {
        "samples, spacing and directions as they are, in numbers that read back to the same bits".into()
    } else {
        format!(
            "the product of spacing and unit directions, which is off by at most {} at the last sample",
            Words(error)
        )
    }
}
