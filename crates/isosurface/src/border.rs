//! What a surface does at the border of a lattice.

use shapeloom_core::choice;

choice! {
    /// What a surface does where the inside reaches the border of the lattice.
    pub enum Border {
        /// It runs along the border: the solid is cut off there, and the surface is closed. As if a layer of outside samples lay
        /// around the lattice, with every crossing to it on the border itself.
        Closed = "closed",
        /// It ends at the border.
        Open = "open",
    }
}
