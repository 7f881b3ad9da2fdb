//! Chemical elements.

use super::element_tables::{BONDI, SYMBOLS, TABLE};

/// A chemical element, or an unknown one (`X`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Element(u8);

impl Element {
    /// An atom of which the element is not known.
    pub const UNKNOWN: Self = Self(0);
    /// Hydrogen.
    pub const HYDROGEN: Self = Self(1);
    /// Carbon.
    pub const CARBON: Self = Self(6);
    /// Nitrogen.
    pub const NITROGEN: Self = Self(7);
    /// Oxygen.
    pub const OXYGEN: Self = Self(8);

    /// The element of an atomic number from 1 to 118.
    pub fn from_atomic_number(number: u32) -> Option<Self> {
        if (1..=118).contains(&number) { Some(Self(number as u8)) } else { None }
    }

    /// The element of a symbol, in any case. `D` and `T` are hydrogen.
    pub fn from_symbol(symbol: &str) -> Option<Self> {
        if symbol.eq_ignore_ascii_case("D") || symbol.eq_ignore_ascii_case("T") {
            return Some(Self::HYDROGEN);
        }
        let place = SYMBOLS.iter().position(|known| known.eq_ignore_ascii_case(symbol))?;
        if place == 0 { None } else { Some(Self(place as u8)) }
    }

    /// The atomic number; 0 where the element is not known.
    pub fn atomic_number(self) -> u32 {
        u32::from(self.0)
    }

    /// The symbol; `X` where the element is not known.
    pub fn symbol(self) -> &'static str {
        SYMBOLS.get(usize::from(self.0)).copied().unwrap_or("X")
    }

    /// The van der Waals radius in ångströms, where one is published.
    ///
    /// Of hydrogen, the noble gases up to xenon and the non-metals and halogens it is Bondi's (J. Phys. Chem. 68, 441, 1964), which
    /// pictures of molecules use; of all others up to einsteinium Alvarez' (Dalton Trans. 42, 8617, 2013). Bondi's of metals rest on
    /// few contacts and are much smaller (copper 1.40 against 2.38). Promethium, polonium to radium and the elements from fermium on
    /// have none.
    pub fn van_der_waals_radius(self) -> Option<f64> {
        let bondi = BONDI.iter().find(|(number, _)| *number == self.0);
        let hundredths = bondi.map_or_else(|| TABLE.get(usize::from(self.0)).copied(), |(_, radius)| Some(*radius))?;
        if hundredths == 0 { None } else { Some(f64::from(hundredths) / 100.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_and_numbers_are_one_to_one() {
        for number in 1..=118 {
            let element = Element::from_atomic_number(number).unwrap();
            assert_eq!(element.atomic_number(), number);
            assert_eq!(Element::from_symbol(&element.symbol().to_uppercase()), Some(element));
        }
        for none in [0, 119, u32::MAX] {
            assert_eq!(Element::from_atomic_number(none), None);
        }
        for no in ["", "X", "Xx", "CA1", "J"] {
            assert_eq!(Element::from_symbol(no), None, "{no}");
        }
        assert_eq!(Element::from_symbol("d"), Some(Element::HYDROGEN));
        // Anchors against a row that slipped.
        for (symbol, number) in [("Ca", 20), ("Xe", 54), ("Lu", 71), ("Rn", 86), ("Es", 99), ("Og", 118)] {
            assert_eq!(Element::from_symbol(symbol).unwrap().atomic_number(), number);
        }
        assert_eq!(Element::UNKNOWN.symbol(), "X");
    }

    #[test]
    fn radii_are_the_published_ones() {
        let radius = |symbol: &str| Element::from_symbol(symbol).unwrap().van_der_waals_radius();
        let bondi =
            [("H", 1.2), ("C", 1.7), ("N", 1.55), ("O", 1.52), ("S", 1.8), ("P", 1.8), ("I", 1.98), ("Xe", 2.16)];
        let alvarez =
            [("Li", 2.12), ("Mg", 2.51), ("Fe", 2.44), ("Zn", 2.39), ("Ba", 3.03), ("Gd", 2.83), ("Au", 2.32)];
        let late = [("Bi", 2.54), ("U", 2.71), ("Es", 2.7), ("Lu", 2.74), ("Sm", 2.9)];
        for (symbol, published) in bondi.into_iter().chain(alvarez).chain(late) {
            assert_eq!(radius(symbol), Some(published), "{symbol}");
        }
        for none in ["Pm", "Po", "Ra", "Fm", "Og"] {
            assert_eq!(radius(none), None);
        }
        assert_eq!(Element::UNKNOWN.van_der_waals_radius(), None);
        let known = (1..=118).filter(|&number| Element(number).van_der_waals_radius().is_some()).count();
        // 99 up to einsteinium, without promethium and the five from polonium to radium.
        assert_eq!(known, 93);
    }
}
