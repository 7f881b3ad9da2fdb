//! Bodies in binary.

use shapeloom_core::glam::DVec3;
use shapeloom_core::{OverBudget, Place};

use super::header::{Element, Layout, short};
use super::plan::{Plan, Role};
use super::rows::{Rows, check_list_values, finite_fault, index_fault, polygon_fault};
use super::types::{Number, Type, with_type, with_values};
use crate::faces::Faces;
use crate::memory::{Memory, make_room};
use crate::{Fault, ReadContext, ReadError};
use shapeloom_mesh::Values;

/// Rows that are decoded together: few enough to stay in the cache from column to column.
const BLOCK: usize = 4096;

/// Reads the rows of an element from `at` on, and moves `at` behind them. `vertices` is how many there are in the file.
///
/// # Errors
/// Rows that are cut off; lengths of lists that are none; indices of faces that no vertex has; positions that are not
/// finite, unless they are to be dropped later.
pub(super) fn read_rows(
    bytes: &[u8],
    at: &mut usize,
    layout: Layout,
    (element, plan): (&Element, &Plan),
    vertices: usize,
    context: &ReadContext,
    memory: &mut Memory<'_>,
) -> Result<Rows, ReadError> {
    let reader = Reader { bytes, element, plan, vertices, context, rows: RowLayout::new(element) };
    if layout == Layout::BigEndian { reader.read::<true>(at, memory) } else { reader.read::<false>(at, memory) }
}

/// The byte at which a row begins.
pub(super) fn row_offset(bytes: &[u8], start: usize, layout: Layout, element: &Element, row: usize) -> usize {
    let rows = RowLayout::new(element);
    if rows.lists.is_empty() {
        return start.saturating_add(rows.tail.saturating_mul(row));
    }
    let mut at = start;
    let mut walked = Walked::default();
    for row in 0..row {
        walked.starts.clear();
        walked.counts.clear();
        let found = if layout == Layout::BigEndian {
            rows.walk::<true>(bytes, at, row, &mut walked)
        } else {
            rows.walk::<false>(bytes, at, row, &mut walked)
        };
        match found {
            Ok(next) => at = next,
            Err(_) => break,
        }
    }
    at
}

/// Where things are in a row. A row is cut into segments after each of its lists, so that what stands in a segment is
/// at a fixed distance from its start.
struct RowLayout<'e> {
    /// What the file calls the rows.
    name: &'e str,
    lists: Vec<ListLayout>,
    /// The bytes after the last list; all bytes of a row without lists.
    tail: usize,
    /// The segment of each property, and how many bytes after its start it stands.
    places: Vec<(usize, usize)>,
}

struct ListLayout {
    property: usize,
    /// The bytes of the segment before the length.
    before: usize,
    count: Type,
    item: Type,
}

/// Where the segments of some rows begin, and how long their lists are.
#[derive(Default)]
struct Walked {
    starts: Vec<usize>,
    counts: Vec<u32>,
}

impl<'e> RowLayout<'e> {
    fn new(element: &'e Element) -> Self {
        let mut layout = Self { name: &element.name, lists: Vec::new(), tail: 0, places: Vec::new() };
        for (property, found) in element.properties.iter().enumerate() {
            layout.places.push((layout.lists.len(), layout.tail));
            match found.count {
                None => layout.tail += found.kind.size(),
                Some(count) => {
                    layout.lists.push(ListLayout { property, before: layout.tail, count, item: found.kind });
                    layout.tail = 0;
                }
            }
        }
        layout
    }

    /// The list of a property.
    fn list(&self, property: usize) -> Option<usize> {
        self.lists.iter().position(|list| list.property == property)
    }

    /// Passes over a row, notes its segments, and returns where the next one begins.
    #[inline]
    fn walk<const BIG: bool>(
        &self,
        bytes: &[u8],
        start: usize,
        row: usize,
        walked: &mut Walked,
    ) -> Result<usize, Box<Fault>> {
        let mut at = start;
        walked.starts.push(at);
        for list in &self.lists {
            let length = at + list.before;
            let counted = bytes.get(length..length + list.count.size()).ok_or_else(|| self.cut(start, row))?;
            let count = match list.count {
                Type::Uchar => i64::from(counted.first().copied().unwrap_or(0)),
                Type::Int => i64::from(i32::decode::<BIG>(counted)),
                other => with_type!(other, N => N::decode::<BIG>(counted).to_f64() as i64),
            };
            let first = length + list.count.size();
            let left = (bytes.len() - first) as u64;
            let wanted = count.unsigned_abs() * list.item.size() as u64;
            if count < 0 || wanted > left {
                return Err(self.wrong_length(length, row, count, left / list.item.size() as u64));
            }
            walked.counts.push(count as u32);
            at = first + wanted as usize;
            walked.starts.push(at);
        }
        if bytes.len() - at < self.tail {
            return Err(self.cut(start, row));
        }
        Ok(at + self.tail)
    }

    #[cold]
    fn cut(&self, at: usize, row: usize) -> Box<Fault> {
        Fault::new("E-ply-truncated", Place::Byte(at as u64), "the end of the file", "the rest of the row")
            .within(format!("{} {row}", short(self.name)))
            .advice("the file was cut off: get it again")
    }

    #[cold]
    fn wrong_length(&self, at: usize, row: usize, count: i64, most: u64) -> Box<Fault> {
        let (place, found) = (Place::Byte(at as u64), format!("a list of {count} numbers"));
        let fault = if count < 0 {
            Fault::new("E-ply-count", place, found, "a length of 0 or more")
        } else {
            let expected = format!("at most {most}, for which the rest of the file has room");
            Fault::new("E-ply-truncated", place, found, expected)
        };
        fault
            .within(format!("{} {row}", short(self.name)))
            .advice("the file was cut off, or its byte order is not the one that it names")
    }
}

/// Rows of which the starts of the segments are known.
trait RowSet {
    fn len(&self) -> usize;

    /// The bytes from a segment of each row on.
    fn segment(&self, segment: usize) -> impl ExactSizeIterator<Item = &[u8]>;
}

/// Rows of one length, one after the other.
struct Even<'a> {
    bytes: &'a [u8],
    stride: usize,
    /// Where the segments begin in a row; there are no more than two.
    segments: [usize; 2],
}

impl RowSet for Even<'_> {
    fn len(&self) -> usize {
        self.bytes.len() / self.stride
    }

    #[inline]
    fn segment(&self, segment: usize) -> impl ExactSizeIterator<Item = &[u8]> {
        let start = self.segments.get(segment).copied().unwrap_or(0);
        self.bytes.chunks_exact(self.stride).map(move |row| row.get(start..).unwrap_or(&[]))
    }
}

/// Rows that were walked over.
struct Uneven<'a> {
    bytes: &'a [u8],
    starts: &'a [usize],
    segments: usize,
}

impl RowSet for Uneven<'_> {
    fn len(&self) -> usize {
        self.starts.len() / self.segments
    }

    #[inline]
    fn segment(&self, segment: usize) -> impl ExactSizeIterator<Item = &[u8]> {
        let rows = self.starts.chunks_exact(self.segments);
        rows.map(move |starts| starts.get(segment).and_then(|&start| self.bytes.get(start..)).unwrap_or(&[]))
    }
}

struct Reader<'a> {
    bytes: &'a [u8],
    element: &'a Element,
    plan: &'a Plan,
    vertices: usize,
    context: &'a ReadContext,
    rows: RowLayout<'a>,
}

impl Reader<'_> {
    fn read<const BIG: bool>(&self, at: &mut usize, memory: &mut Memory<'_>) -> Result<Rows, ReadError> {
        let total = self.element.rows;
        let mut rows = Rows::with_room(self.element, self.plan, total, memory)?;
        if self.element.properties.is_empty() {
            // Rows of no bytes: there is nothing to read, however many there are.
            rows.len = total;
            return Ok(rows);
        }
        let triangles = self.triangle_rows();
        if let Some((stride, _)) = triangles {
            rows.faces = Faces::with_room(memory, total.min((self.bytes.len() - *at) / stride))?;
        }
        let mut walked = Walked::default();
        let mut done = 0;
        while done < total {
            self.context.exec.check()?;
            let count = (total - done).min(BLOCK);
            if self.rows.lists.is_empty() {
                let stride = self.rows.tail;
                let end = *at + count * stride;
                let part = self.bytes.get(*at..end).ok_or_else(|| self.rows.cut(*at, done))?;
                self.columns::<BIG>(&Even { bytes: part, stride, segments: [0; 2] }, &mut rows);
                self.check_finite(&rows, done, |row| *at + row * stride)?;
                *at = end;
            } else if let Some(end) = self.triangles::<BIG>(triangles, *at, done, count, &mut rows, memory)? {
                *at = end;
            } else {
                self.uneven::<BIG>(at, done, count, &mut walked, &mut rows, memory)?;
            }
            done += count;
            self.context.exec.progress(*at as f64 / self.bytes.len().max(1) as f64);
        }
        Ok(rows)
    }

    /// The length of a row, and where the corners stand in it, if every face were a triangle; none unless corners are
    /// the only list, its length is a byte, and its numbers the usual ones.
    fn triangle_rows(&self) -> Option<(usize, usize)> {
        match self.rows.lists.as_slice() {
            [list @ ListLayout { count: Type::Uchar, item: Type::Int | Type::Uint, property, .. }]
                if self.plan.corners == Some(*property) =>
            {
                Some((list.before + 13 + self.rows.tail, list.before + 1))
            }
            _ => None,
        }
    }

    /// Reads a block of faces if all of them are triangles, and returns where it ends.
    fn triangles<const BIG: bool>(
        &self,
        layout: Option<(usize, usize)>,
        at: usize,
        first: usize,
        count: usize,
        rows: &mut Rows,
        memory: &mut Memory<'_>,
    ) -> Result<Option<usize>, ReadError> {
        let Some((stride, corners)) = layout else { return Ok(None) };
        let end = at + count * stride;
        let Some(part) = self.bytes.get(at..end) else { return Ok(None) };
        if !part.iter().skip(corners - 1).step_by(stride).all(|&length| length == 3) {
            return Ok(None);
        }
        let set = Even { bytes: part, stride, segments: [0, corners + 12] };
        let mut most = 0;
        let triangles = part.chunks_exact(stride).map(|row| {
            let row: &[u8; 12] = row.get(corners..).and_then(|row| row.first_chunk()).unwrap_or(&[0; 12]);
            // A negative index is too large as well: vertices are fewer than half of what 32 bits count, or the type has
            // no sign.
            let corner = |at: usize| u32::decode::<BIG>(&row[at..]);
            let triangle = [corner(0), corner(4), corner(8)];
            most = triangle[0].max(triangle[1]).max(triangle[2]).max(most);
            triangle
        });
        rows.faces.extend_triangles(memory, triangles)?;
        let limit = match self.rows.lists.as_slice() {
            [ListLayout { item: Type::Int, .. }] => self.vertices.min(1 << 31),
            _ => self.vertices,
        };
        if most as usize >= limit {
            let wrong =
                |row: &&[u8; 12]| row.chunks_exact(4).any(|number| u32::decode::<BIG>(number) as usize >= limit);
            let bodies = part.chunks_exact(stride).map(|row| row.get(corners..).and_then(|row| row.first_chunk()));
            let row = bodies.flatten().position(|row| wrong(&row)).unwrap_or(0);
            let body = part.get(row * stride + corners..).unwrap_or(&[]);
            let place = Place::Byte((at + row * stride) as u64);
            return Err(self.index_fault::<BIG>(place, first + row, body, 3).into());
        }
        self.columns::<BIG>(&set, rows);
        Ok(Some(end))
    }

    /// Reads a block of rows with lists of any length.
    fn uneven<const BIG: bool>(
        &self,
        at: &mut usize,
        first: usize,
        count: usize,
        walked: &mut Walked,
        rows: &mut Rows,
        memory: &mut Memory<'_>,
    ) -> Result<(), ReadError> {
        let lists = self.rows.lists.len();
        walked.starts.clear();
        walked.counts.clear();
        let corners = self.plan.corners.and_then(|property| self.rows.list(property));
        for row in first..first + count {
            let start = *at;
            *at = self.rows.walk::<BIG>(self.bytes, start, row, walked)?;
            let Some(corners) = corners else { continue };
            let arity = walked.counts.get(walked.counts.len() - lists + corners).copied().unwrap_or(0);
            if arity < 3 {
                walked.starts.truncate(walked.starts.len() - lists - 1);
                walked.counts.truncate(walked.counts.len() - lists);
                make_room(memory, &mut rows.skipped, 1)?;
                rows.skipped.push(row as u32);
            } else {
                let most = self.context.limits.max_polygon;
                if arity > most {
                    let place = Place::Byte(start as u64);
                    return Err(polygon_fault(place, row, u64::from(arity), most).into());
                }
                let from = walked.starts.get(walked.starts.len() - lists - 1 + corners).copied().unwrap_or(0);
                self.face::<BIG>(corners, from, arity as usize, (start, row), rows, memory)?;
            }
        }
        let set = Uneven { bytes: self.bytes, starts: &walked.starts, segments: lists + 1 };
        let (kept, before) = (set.len(), rows.len);
        self.columns::<BIG>(&set, rows);
        self.check_finite(rows, before, |row| set.starts.get(row * set.segments).copied().unwrap_or(0))?;
        for (&property, list) in self.plan.lists.iter().zip(&mut rows.lists) {
            let Some(index) = self.rows.list(property) else { continue };
            let Some(layout) = self.rows.lists.get(index) else { continue };
            let counts = || walked.counts.iter().skip(index).step_by(lists).map(|&count| count as usize);
            let total: usize = counts().sum();
            check_list_values(list.values.len() as u64 + total as u64)?;
            let mut end = list.values.len() as u32;
            make_room(memory, &mut list.ends, kept)?;
            list.ends.extend(counts().map(|count| {
                end += count as u32;
                end
            }));
            let before = layout.before + layout.count.size();
            let bodies = set.segment(index).map(|segment| segment.get(before..).unwrap_or(&[])).zip(counts());
            with_values!(&mut list.values, vector => extend_lists::<BIG, _>(vector, bodies, total, memory)?, ());
        }
        Ok(())
    }

    /// Reads one face of three corners or more.
    #[inline]
    fn face<const BIG: bool>(
        &self,
        list: usize,
        segment: usize,
        arity: usize,
        (start, row): (usize, usize),
        rows: &mut Rows,
        memory: &mut Memory<'_>,
    ) -> Result<(), ReadError> {
        let Some(list) = self.rows.lists.get(list) else { return Ok(()) };
        let from = segment + list.before + list.count.size();
        let body = self.bytes.get(from..from + arity * list.item.size()).unwrap_or(&[]);
        let mut small = [0; 8];
        let mut large = Vec::new();
        let corners = match small.get_mut(..arity) {
            Some(corners) => corners,
            None => {
                // Polygons of many corners are few, and each has its bytes in the file.
                large.resize(arity, 0);
                &mut large[..]
            }
        };
        let most = with_type!(list.item, N => indices::<BIG, N>(body, corners));
        if most as usize >= self.vertices {
            let place = Place::Byte(start as u64);
            return Err(self.index_fault::<BIG>(place, row, body, arity).into());
        }
        rows.faces.push(memory, corners)
    }

    /// The fault of the first of these corners that names no vertex.
    #[cold]
    fn index_fault<const BIG: bool>(&self, place: Place, row: usize, body: &[u8], arity: usize) -> Box<Fault> {
        let item = self.plan.corners.and_then(|property| self.rows.list(property));
        let item = item.and_then(|list| self.rows.lists.get(list)).map_or(Type::Uint, |list| list.item);
        let found = with_type!(item, N => {
            let numbers = body.chunks_exact(size_of::<N>()).take(arity).map(N::decode::<BIG>);
            numbers.map(|number| (number.index(), number.to_f64())).find(|(index, _)| *index as usize >= self.vertices)
        });
        index_fault(place, row, found.map_or(0.0, |(_, number)| number), self.vertices)
    }

    /// Adds the columns and positions of some rows.
    fn columns<const BIG: bool>(&self, set: &impl RowSet, rows: &mut Rows) {
        for (group, values) in self.plan.columns.iter().zip(&mut rows.columns) {
            with_values!(values, vector => self.column::<BIG, _>(set, &group.properties, vector), ());
        }
        if let Some(axes) = self.plan.axes {
            self.positions::<BIG>(set, axes, &mut rows.positions);
        }
        rows.len += set.len();
    }

    fn place(&self, property: usize) -> (usize, usize) {
        self.rows.places.get(property).copied().unwrap_or((0, 0))
    }

    fn column<const BIG: bool, N: Number>(&self, set: &impl RowSet, properties: &[usize], vector: &mut Vec<N>) {
        if let [property] = *properties {
            let (segment, offset) = self.place(property);
            vector.extend(set.segment(segment).map(|row| N::decode::<BIG>(row.get(offset..).unwrap_or(&[]))));
            return;
        }
        let before = vector.len();
        let width = properties.len().max(1);
        vector.resize(before + set.len() * width, N::default());
        for (component, &property) in properties.iter().enumerate() {
            let (segment, offset) = self.place(property);
            let new = vector.get_mut(before..).unwrap_or(&mut []).chunks_exact_mut(width);
            for (element, row) in new.zip(set.segment(segment)) {
                if let Some(value) = element.get_mut(component) {
                    *value = N::decode::<BIG>(row.get(offset..).unwrap_or(&[]));
                }
            }
        }
    }

    fn positions<const BIG: bool>(&self, set: &impl RowSet, axes: [usize; 3], positions: &mut Vec<DVec3>) {
        let [x, y, z] = axes.map(|property| self.place(property));
        let [kind, others @ ..] =
            axes.map(|at| self.element.properties.get(at).map_or(Type::Float, |found| found.kind));
        if others == [kind; 2] && x.0 == y.0 && y.0 == z.0 {
            with_type!(kind, N => positions.extend(set.segment(x.0).map(|row| {
                let at = |offset: usize| N::decode::<BIG>(row.get(offset..).unwrap_or(&[])).to_f64();
                DVec3::new(at(x.1), at(y.1), at(z.1))
            })));
            return;
        }
        let before = positions.len();
        positions.resize(before + set.len(), DVec3::ZERO);
        for (axis, (property, (segment, offset))) in axes.into_iter().zip([x, y, z]).enumerate() {
            let kind = self.element.properties.get(property).map_or(Type::Float, |found| found.kind);
            let new = positions.get_mut(before..).unwrap_or(&mut []).iter_mut();
            with_type!(kind, N => new.zip(set.segment(segment)).for_each(|(position, row)| {
                position[axis] = N::decode::<BIG>(row.get(offset..).unwrap_or(&[])).to_f64();
            }));
        }
    }

    /// Refuses positions from a row on that are not finite. `offset` says where the rows from there on begin.
    fn check_finite(&self, rows: &Rows, first: usize, offset: impl Fn(usize) -> usize) -> Result<(), Box<Fault>> {
        if self.plan.role != Role::Vertex || self.context.options.drop_non_finite {
            return Ok(());
        }
        let new = rows.positions.get(first..).unwrap_or(&[]);
        // Without branches, as all are finite nearly always.
        let sound = new.iter().fold(true, |sound, point| {
            sound & (point.x.abs() < f64::INFINITY) & (point.y.abs() < f64::INFINITY) & (point.z.abs() < f64::INFINITY)
        });
        let wrong = new.iter().enumerate().find(|(_, point)| !sound && !point.is_finite());
        let Some((row, point)) = wrong else { return Ok(()) };
        let number = point.to_array().into_iter().find(|number| !number.is_finite()).unwrap_or(f64::NAN);
        Err(finite_fault(Place::Byte(offset(row) as u64), first + row, number.to_string()))
    }
}

#[inline]
fn indices<const BIG: bool, N: Number>(body: &[u8], corners: &mut [u32]) -> u32 {
    let mut most = 0;
    for (corner, number) in corners.iter_mut().zip(body.chunks_exact(size_of::<N>())) {
        *corner = N::decode::<BIG>(number).index();
        most = most.max(*corner);
    }
    most
}

fn extend_lists<'a, const BIG: bool, N: Number>(
    vector: &mut Vec<N>,
    bodies: impl Iterator<Item = (&'a [u8], usize)>,
    total: usize,
    memory: &mut Memory<'_>,
) -> Result<(), OverBudget> {
    make_room(memory, vector, total)?;
    for (body, count) in bodies {
        vector.extend(body.chunks_exact(size_of::<N>()).take(count).map(N::decode::<BIG>));
    }
    Ok(())
}
