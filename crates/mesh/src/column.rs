//! Attribute columns.

use std::ops::Range;

use shapeloom_core::Affine;
use shapeloom_core::glam::DVec3;

use crate::AttributeError;

/// How values of several elements are mixed into one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blend {
    /// The weighted sum; whole numbers are rounded to the nearest and clamped to their type.
    Linear,
    /// The weighted sum scaled to unit length; zero stays zero.
    Direction,
    /// The value with the largest weight, between equal weights the first: for ids, labels and text.
    Copy,
}

/// How values move when the shape is mapped by an affine map. Applies to the first three components.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransformRule {
    /// Not at all.
    None,
    /// As points.
    Point,
    /// As vectors.
    Vector,
    /// As unit normals, by the inverse transpose.
    Normal,
}

/// The values of a column, element by element, the components of an element side by side.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Single precision.
    F32(Vec<f32>),
    /// Double precision.
    F64(Vec<f64>),
    /// Signed bytes.
    I8(Vec<i8>),
    /// Bytes.
    U8(Vec<u8>),
    /// Signed, 16 bits.
    I16(Vec<i16>),
    /// Unsigned, 16 bits.
    U16(Vec<u16>),
    /// Signed, 32 bits.
    I32(Vec<i32>),
    /// Unsigned, 32 bits.
    U32(Vec<u32>),
    /// Text, as an index into names for each element.
    Text {
        /// The distinct texts.
        names: Vec<String>,
        /// An index into `names` for each element.
        index: Vec<u32>,
    },
}

/// Runs the same expression on the vector inside a [`Values`], text as its index.
macro_rules! each_vector {
    ($values:expr, $vector:ident => $body:expr) => {
        match $values {
            Values::F32($vector) => $body,
            Values::F64($vector) => $body,
            Values::I8($vector) => $body,
            Values::U8($vector) => $body,
            Values::I16($vector) => $body,
            Values::U16($vector) => $body,
            Values::I32($vector) => $body,
            Values::U32($vector) => $body,
            Values::Text { index: $vector, .. } => $body,
        }
    };
}

/// The same, giving values of the same kind back.
macro_rules! map_vector {
    ($values:expr, $vector:ident => $body:expr) => {
        match $values {
            Values::F32($vector) => Values::F32($body),
            Values::F64($vector) => Values::F64($body),
            Values::I8($vector) => Values::I8($body),
            Values::U8($vector) => Values::U8($body),
            Values::I16($vector) => Values::I16($body),
            Values::U16($vector) => Values::U16($body),
            Values::I32($vector) => Values::I32($body),
            Values::U32($vector) => Values::U32($body),
            Values::Text { names, index: $vector } => Values::Text { names: names.clone(), index: $body },
        }
    };
}

impl Values {
    /// The number of single values.
    pub fn len(&self) -> usize {
        each_vector!(self, values => values.len())
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The name of the type: `f32`, `u8`, `text`.
    pub fn type_name(&self) -> &'static str {
        match self {
            Self::F32(_) => "f32",
            Self::F64(_) => "f64",
            Self::I8(_) => "i8",
            Self::U8(_) => "u8",
            Self::I16(_) => "i16",
            Self::U16(_) => "u16",
            Self::I32(_) => "i32",
            Self::U32(_) => "u32",
            Self::Text { .. } => "text",
        }
    }

    /// The values at these ranges, one range after the other, `total` in all.
    pub(crate) fn pieces(&self, ranges: impl Iterator<Item = Range<usize>>, total: usize) -> Self {
        fn pick<T: Copy>(values: &[T], ranges: impl Iterator<Item = Range<usize>>, total: usize) -> Vec<T> {
            let mut out = Vec::with_capacity(total);
            ranges.for_each(|range| out.extend_from_slice(&values[range]));
            out
        }
        map_vector!(self, values => pick(values, ranges, total))
    }

    /// Whether two single values have the same bits.
    pub(crate) fn same(&self, a: usize, b: usize) -> bool {
        each_vector!(self, values => values[a].to_f64().to_bits() == values[b].to_f64().to_bits())
    }

    pub(crate) fn bytes(&self) -> usize {
        let names = match self {
            Self::Text { names, .. } => names.iter().map(|name| name.len() + size_of::<String>()).sum(),
            _ => 0,
        };
        names + each_vector!(self, values => size_of_val(values.as_slice()))
    }
}

/// Converts between a stored number and the `f64` in which blending happens.
trait Scalar: Copy {
    fn to_f64(self) -> f64;
    fn from_f64(value: f64) -> Self;
}

macro_rules! scalars {
    (float $($float:ty),*; whole $($whole:ty),*) => {
        $(impl Scalar for $float {
            fn to_f64(self) -> f64 {
                f64::from(self)
            }

            fn from_f64(value: f64) -> Self {
                value as Self
            }
        })*
        $(impl Scalar for $whole {
            fn to_f64(self) -> f64 {
                f64::from(self)
            }

            fn from_f64(value: f64) -> Self {
                value.round() as Self
            }
        })*
    };
}

scalars!(float f32, f64; whole i8, u8, i16, u16, i32, u32);

/// The source with the largest weight, between equal weights the first.
pub(crate) fn heaviest<'a>(terms: impl Iterator<Item = (&'a u32, &'a f64)>) -> Option<u32> {
    let heavier = |best: Option<(u32, f64)>, (&source, &weight): (&u32, &f64)| match best {
        Some((_, most)) if most >= weight => best,
        _ => Some((source, weight)),
    };
    terms.fold(None, heavier).map(|(source, _)| source)
}

/// A named attribute: `width` values for each element, with the rules by which they blend and move.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    name: String,
    width: usize,
    values: Values,
    blend: Blend,
    transform: TransformRule,
}

impl Column {
    /// A column of `width` values an element that blend linearly and do not move.
    ///
    /// # Errors
    /// The number of values is no multiple of the width, or text has another width than 1 or an index without a name.
    pub fn try_new(name: impl Into<String>, width: usize, values: Values) -> Result<Self, AttributeError> {
        let name = name.into();
        if width == 0 || !values.len().is_multiple_of(width) {
            return Err(AttributeError::Width { name, width, values: values.len() });
        }
        let mut blend = Blend::Linear;
        if let Values::Text { names, index } = &values {
            if width != 1 || index.iter().any(|&i| i as usize >= names.len()) {
                return Err(AttributeError::Text { name });
            }
            blend = Blend::Copy;
        }
        Ok(Self { name, width, values, blend, transform: TransformRule::None })
    }

    /// Unit normals, `f64`: blended as directions, moved as normals.
    pub fn normals(name: impl Into<String>, normals: &[DVec3]) -> Self {
        let values = normals.iter().flat_map(|normal| normal.to_array()).collect();
        Self {
            name: name.into(),
            width: 3,
            values: Values::F64(values),
            blend: Blend::Direction,
            transform: TransformRule::Normal,
        }
    }

    /// Texture coordinates, `f64`, two an element.
    pub fn texcoords(name: impl Into<String>, coordinates: &[[f64; 2]]) -> Self {
        let values = Values::F64(coordinates.as_flattened().to_vec());
        Self { name: name.into(), width: 2, values, blend: Blend::Linear, transform: TransformRule::None }
    }

    /// Ids or labels, which are copied and never mixed.
    pub fn labels(name: impl Into<String>, labels: Vec<u32>) -> Self {
        let values = Values::U32(labels);
        Self { name: name.into(), width: 1, values, blend: Blend::Copy, transform: TransformRule::None }
    }

    /// The same column with another blend rule. Text is always copied.
    #[must_use]
    pub fn with_blend(mut self, blend: Blend) -> Self {
        if !matches!(self.values, Values::Text { .. }) {
            self.blend = blend;
        }
        self
    }

    /// The same column with another transform rule. It applies to columns of at least three numbers an element.
    #[must_use]
    pub fn with_transform(mut self, transform: TransformRule) -> Self {
        self.transform = transform;
        self
    }

    /// The same column under another name.
    #[must_use]
    pub fn renamed(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Values for each element.
    pub fn width(&self) -> usize {
        self.width
    }

    /// The values, element by element.
    pub fn values(&self) -> &Values {
        &self.values
    }

    /// How values of several elements are mixed.
    pub fn blend(&self) -> Blend {
        self.blend
    }

    /// How values move under an affine map.
    pub fn transform(&self) -> TransformRule {
        self.transform
    }

    /// The number of elements.
    pub fn len(&self) -> usize {
        self.values.len() / self.width
    }

    /// Whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The memory that the column takes, in bytes.
    pub fn memory_bytes(&self) -> usize {
        self.values.bytes() + self.name.len()
    }

    /// One value as a number; the index for text.
    ///
    /// # Panics
    /// When the element or component does not exist.
    pub fn number(&self, element: usize, component: usize) -> f64 {
        assert!(component < self.width, "component {component} of a column of width {}", self.width);
        each_vector!(&self.values, values => values[element * self.width + component].to_f64())
    }

    /// The first three components of an element, missing ones as zero.
    ///
    /// # Panics
    /// When the element does not exist.
    pub fn vector(&self, element: usize) -> DVec3 {
        let at = |component: usize| if component < self.width { self.number(element, component) } else { 0.0 };
        DVec3::new(at(0), at(1), at(2))
    }

    /// The text of an element, if this is a text column.
    ///
    /// # Panics
    /// When the element does not exist.
    pub fn text(&self, element: usize) -> Option<&str> {
        match &self.values {
            Values::Text { names, index } => Some(&names[index[element] as usize]),
            _ => None,
        }
    }

    /// Whether two elements have the same bits.
    pub(crate) fn same(&self, a: usize, b: usize) -> bool {
        (0..self.width).all(|component| self.number(a, component).to_bits() == self.number(b, component).to_bits())
    }

    /// The column whose element `i` is this one's element `sources[i]`.
    ///
    /// # Panics
    /// When a source does not exist.
    #[must_use]
    pub fn gathered(&self, sources: &[u32]) -> Self {
        fn gather<T: Copy>(values: &[T], width: usize, sources: &[u32]) -> Vec<T> {
            let mut out = Vec::with_capacity(sources.len() * width);
            for &source in sources {
                let first = source as usize * width;
                out.extend_from_slice(&values[first..first + width]);
            }
            out
        }
        let values = map_vector!(&self.values, values => gather(values, self.width, sources));
        Self { values, ..self.clone_frame() }
    }

    /// The column whose element `i` is the mixture of `sources[starts[i]..starts[i + 1]]` with their weights, by this
    /// column's blend rule.
    ///
    /// # Panics
    /// When a source does not exist.
    #[must_use]
    pub(crate) fn mixed(&self, starts: &[u32], sources: &[u32], weights: &[f64]) -> Self {
        fn blend<T: Scalar>(values: &[T], column: &Column, parts: (&[u32], &[u32], &[f64])) -> Vec<T> {
            let (starts, sources, weights) = parts;
            let mut out = Vec::with_capacity(starts.len().saturating_sub(1) * column.width);
            let mut sums = vec![0.0; column.width];
            for bounds in starts.windows(2) {
                let part = bounds[0] as usize..bounds[1] as usize;
                let whole = weights[part.clone()] == [1.0];
                let terms = sources[part.clone()].iter().zip(&weights[part]);
                // One whole source is copied too: a direction, or a zero with its sign, keeps its bits.
                if column.blend == Blend::Copy || whole {
                    let first = heaviest(terms).unwrap_or(0) as usize * column.width;
                    out.extend_from_slice(&values[first..first + column.width]);
                    continue;
                }
                sums.fill(0.0);
                for (&source, &weight) in terms {
                    let first = source as usize * column.width;
                    for (sum, value) in sums.iter_mut().zip(&values[first..first + column.width]) {
                        *sum += value.to_f64() * weight;
                    }
                }
                if column.blend == Blend::Direction {
                    let length = sums.iter().map(|sum| sum * sum).sum::<f64>().sqrt();
                    if length > 0.0 {
                        sums.iter_mut().for_each(|sum| *sum /= length);
                    }
                }
                out.extend(sums.iter().map(|&sum| T::from_f64(sum)));
            }
            out
        }
        let parts = (starts, sources, weights);
        let values = map_vector!(&self.values, values => blend(values, self, parts));
        Self { values, ..self.clone_frame() }
    }

    /// The column after the shape was mapped.
    #[must_use]
    pub fn transformed(&self, map: &Affine) -> Self {
        fn apply<T: Scalar>(values: &[T], width: usize, f: impl Fn(DVec3) -> DVec3) -> Vec<T> {
            let mut out = values.to_vec();
            for element in out.chunks_exact_mut(width) {
                let moved = f(DVec3::new(element[0].to_f64(), element[1].to_f64(), element[2].to_f64()));
                for (component, value) in element.iter_mut().zip(moved.to_array()) {
                    *component = T::from_f64(value);
                }
            }
            out
        }
        if self.width < 3 || self.transform == TransformRule::None {
            return self.clone();
        }
        let rule = self.transform;
        let f = |vector: DVec3| match rule {
            TransformRule::None => vector,
            TransformRule::Point => map.point(vector),
            TransformRule::Vector => map.vector(vector),
            TransformRule::Normal => map.normal(vector),
        };
        let values = map_vector!(&self.values, values => apply(values, self.width, f));
        Self { values, ..self.clone_frame() }
    }

    /// The column without its values.
    fn clone_frame(&self) -> Self {
        Self {
            name: self.name.clone(),
            width: self.width,
            values: Values::U8(Vec::new()),
            blend: self.blend,
            transform: self.transform,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_widths_and_text_are_refused() {
        assert!(Column::try_new("a", 2, Values::F32(vec![1.0; 3])).is_err());
        assert!(Column::try_new("a", 0, Values::F32(vec![])).is_err());
        let text = Values::Text { names: vec!["x".into()], index: vec![0, 1] };
        assert!(matches!(Column::try_new("a", 1, text), Err(AttributeError::Text { .. })));
    }

    #[test]
    fn blending_follows_the_rule() {
        let numbers = Column::try_new("n", 1, Values::U8(vec![10, 21, 250])).unwrap();
        let (starts, sources, weights) = ([0, 2, 4], [0, 1, 2, 2], [0.5, 0.5, 1.0, 1.0]);
        // 15.5 rounds to 16, 500 is clamped to 255.
        assert_eq!(numbers.mixed(&starts, &sources, &weights).values, Values::U8(vec![16, 255]));
        let labels = Column::labels("l", vec![7, 8, 9]);
        assert_eq!(labels.mixed(&[0, 3], &[0, 1, 2], &[0.2, 0.5, 0.3]).values, Values::U32(vec![8]));
        let normals = Column::normals("m", &[DVec3::X, DVec3::Y]);
        let mixed = normals.mixed(&[0, 2], &[0, 1], &[0.5, 0.5]);
        assert!((mixed.vector(0) - DVec3::new(0.5, 0.5, 0.0).normalize()).length() < 1e-15);
        let opposite = Column::normals("m", &[DVec3::X, -DVec3::X]).mixed(&[0, 2], &[0, 1], &[0.5, 0.5]);
        assert_eq!(opposite.vector(0), DVec3::ZERO);
    }

    #[test]
    fn normals_move_by_the_inverse_transpose() {
        let map = Affine::from_scale(DVec3::new(2.0, 1.0, 1.0));
        let slanted = Column::normals("n", &[DVec3::new(1.0, 1.0, 0.0).normalize()]).transformed(&map);
        assert!((slanted.vector(0) - DVec3::new(1.0, 2.0, 0.0).normalize()).length() < 1e-15);
        let vector = Column::try_new("v", 3, Values::F32(vec![1.0, 1.0, 0.0])).unwrap();
        let vector = vector.with_transform(TransformRule::Vector).transformed(&map);
        assert_eq!(vector.vector(0), DVec3::new(2.0, 1.0, 0.0));
    }

    #[test]
    fn text_is_gathered_with_its_names() {
        let text = Values::Text { names: vec!["wood".into(), "iron".into()], index: vec![1, 0] };
        let column = Column::try_new("material", 1, text).unwrap().gathered(&[0, 0, 1]);
        assert_eq!([0, 1, 2].map(|i| column.text(i).unwrap().to_owned()), ["iron", "iron", "wood"]);
    }
}
