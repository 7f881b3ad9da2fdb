//! Symbols and radii of the elements.

/// Symbols by atomic number.
#[rustfmt::skip]
pub(super) const SYMBOLS: [&str; 119] = [
    "X", "H", "He", "Li", "Be", "B", "C", "N", "O", "F", "Ne", "Na", "Mg", "Al", "Si", "P", "S", "Cl", "Ar", "K",
    "Ca", "Sc", "Ti", "V", "Cr", "Mn", "Fe", "Co", "Ni", "Cu", "Zn", "Ga", "Ge", "As", "Se", "Br", "Kr", "Rb", "Sr",
    "Y", "Zr", "Nb", "Mo", "Tc", "Ru", "Rh", "Pd", "Ag", "Cd", "In", "Sn", "Sb", "Te", "I", "Xe", "Cs", "Ba", "La",
    "Ce", "Pr", "Nd", "Pm", "Sm", "Eu", "Gd", "Tb", "Dy", "Ho", "Er", "Tm", "Yb", "Lu", "Hf", "Ta", "W", "Re", "Os",
    "Ir", "Pt", "Au", "Hg", "Tl", "Pb", "Bi", "Po", "At", "Rn", "Fr", "Ra", "Ac", "Th", "Pa", "U", "Np", "Pu", "Am",
    "Cm", "Bk", "Cf", "Es", "Fm", "Md", "No", "Lr", "Rf", "Db", "Sg", "Bh", "Hs", "Mt", "Ds", "Rg", "Cn", "Nh", "Fl",
    "Mc", "Lv", "Ts", "Og",
];

/// Van der Waals radii in hundredths of an ångström by atomic number (Alvarez 2013); 0 where there is none.
#[rustfmt::skip]
pub(super) const TABLE: [u16; 100] = [
    0, 120, 143, 212, 198, 191, 177, 166, 150, 146, 158, 250, 251, 225, 219, 190, 189, 182, 183, 273, 262, 258, 246,
    242, 245, 245, 244, 240, 240, 238, 239, 232, 229, 188, 182, 186, 225, 321, 284, 275, 252, 256, 245, 244, 246, 244,
    215, 253, 249, 243, 242, 247, 199, 204, 206, 348, 303, 298, 288, 292, 295, 0, 290, 287, 283, 279, 287, 281, 283,
    279, 280, 274, 263, 253, 257, 249, 248, 241, 229, 232, 245, 247, 260, 254, 0, 0, 0, 0, 0, 280, 293, 288, 271, 282,
    281, 283, 305, 340, 305, 270,
];

/// Atomic numbers with radii in hundredths of an ångström (Bondi 1964): hydrogen, non-metals and noble gases.
#[rustfmt::skip]
pub(super) const BONDI: [(u8, u16); 19] = [
    (1, 120), (2, 140), (6, 170), (7, 155), (8, 152), (9, 147), (10, 154), (14, 210), (15, 180), (16, 180), (17, 175),
    (18, 188), (33, 185), (34, 190), (35, 185), (36, 202), (52, 206), (53, 198), (54, 216),
];
