//! What properties become: coordinates, corners, columns.

use std::collections::{HashMap, HashSet};

use shapeloom_mesh::{COLOR, NORMAL, TEXCOORD};

use super::header::Element;
use super::types::Type;

/// What the rows of an element are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Vertex,
    Face,
    Edge,
    Strips,
    Table,
}

/// What a column means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Meaning {
    Plain,
    Normal,
    Texcoord,
    /// Whole numbers, which are sRGB in shapes too.
    Color,
    /// Fractions in sRGB, which are linear in shapes.
    FloatColor,
}

/// Scalar properties of one type that make a column.
#[derive(Clone, Debug)]
pub(super) struct Group {
    pub name: String,
    pub kind: Type,
    /// The property of each component.
    pub properties: Vec<usize>,
    pub meaning: Meaning,
}

/// What the properties of an element become.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub role: Role,
    /// The properties `x y z` of a vertex.
    pub axes: Option<[usize; 3]>,
    /// The list of the corners of a face.
    pub corners: Option<usize>,
    pub columns: Vec<Group>,
    /// Lists, without the corners.
    pub lists: Vec<usize>,
}

/// The names of the list of corners, of faces and strips.
pub(super) const CORNERS: [&str; 2] = ["vertex_indices", "vertex_index"];
/// The names of the ends of an edge.
pub(super) const ENDS: [&str; 2] = ["vertex1", "vertex2"];

const NORMALS: &[&str] = &["nx", "ny", "nz"];
const TEXCOORDS: [&[&str]; 4] = [&["s", "t"], &["u", "v"], &["texture_u", "texture_v"], &["texture_s", "texture_t"]];
const COLORS: [&[&str]; 6] = [
    &["red", "green", "blue", "alpha"],
    &["red", "green", "blue"],
    &["r", "g", "b", "a"],
    &["r", "g", "b"],
    &["diffuse_red", "diffuse_green", "diffuse_blue", "diffuse_alpha"],
    &["diffuse_red", "diffuse_green", "diffuse_blue"],
];

impl Plan {
    pub fn new(element: &Element) -> Self {
        let scalar = |name: &str| element.find(name).filter(|&at| element.properties[at].count.is_none());
        let corners = element.find_list(&CORNERS);
        let role = match element.name.as_str() {
            "vertex" => Role::Vertex,
            "face" if corners.is_some() => Role::Face,
            "tristrips" if corners.is_some() => Role::Strips,
            "edge" if ENDS.iter().all(|name| scalar(name).is_some()) => Role::Edge,
            _ => Role::Table,
        };
        let corners = corners.filter(|_| role == Role::Face);
        let axes = match (role, scalar("x"), scalar("y"), scalar("z")) {
            (Role::Vertex, Some(x), Some(y), Some(z)) => Some([x, y, z]),
            _ => None,
        };
        let mut taken = vec![false; element.properties.len()];
        axes.into_iter().flatten().chain(corners).for_each(|property| taken[property] = true);
        let mut groups = Groups { element, taken, names: HashSet::new(), found: Vec::new() };
        if matches!(role, Role::Vertex | Role::Face | Role::Edge) {
            groups.meaningful();
        }
        groups.families();
        let lists = (0..element.properties.len())
            .filter(|&at| element.properties[at].count.is_some() && Some(at) != corners)
            .collect();
        let mut columns = groups.found;
        columns.sort_by_key(|group| group.properties.first().copied());
        Self { role, axes, corners, columns, lists }
    }
}

struct Groups<'e> {
    element: &'e Element,
    /// Whether a property is in a group already.
    taken: Vec<bool>,
    names: HashSet<String>,
    found: Vec<Group>,
}

impl Groups<'_> {
    /// The properties of these names, if they are all there and of one type.
    fn of_one_type(&self, names: &[&str]) -> Option<(Vec<usize>, Type)> {
        let all: Option<Vec<usize>> = names.iter().map(|name| self.element.find(name)).collect();
        let all = all?;
        let properties = || all.iter().map(|&at| &self.element.properties[at]);
        let kind = properties().next()?.kind;
        let alike = properties().all(|property| property.count.is_none() && property.kind == kind);
        (alike && !all.iter().any(|&at| self.taken[at])).then_some((all, kind))
    }

    fn take(&mut self, name: &str, meaning: Meaning, (properties, kind): (Vec<usize>, Type)) {
        properties.iter().for_each(|&at| self.taken[at] = true);
        self.names.insert(name.to_owned());
        self.found.push(Group { name: name.to_owned(), kind, properties, meaning });
    }

    /// Normals, texture coordinates and colours by their customary names. A property that is called as the column would
    /// be keeps its name, and the others keep theirs too.
    fn meaningful(&mut self) {
        let free = |name: &str| self.element.find(name).is_none();
        let (normal, texcoord, color) = (free(NORMAL), free(TEXCOORD), free(COLOR));
        if let Some(found) = self.of_one_type(NORMALS).filter(|found| normal && found.1.is_floating()) {
            self.take(NORMAL, Meaning::Normal, found);
        }
        let mut pairs = TEXCOORDS.iter().filter_map(|names| self.of_one_type(names));
        if let Some(found) = pairs.find(|found| texcoord && found.1.is_floating()) {
            self.take(TEXCOORD, Meaning::Texcoord, found);
        }
        let mut colors = COLORS.iter().filter_map(|names| self.of_one_type(names));
        let fits = |kind: Type| kind.is_floating() || matches!(kind, Type::Uchar | Type::Ushort);
        if let Some(found) = colors.find(|found| color && fits(found.1)) {
            let meaning = if found.1.is_floating() { Meaning::FloatColor } else { Meaning::Color };
            self.take(COLOR, meaning, found);
        }
    }

    /// Everything else: `name_0 name_1 ...` of one type, side by side, are one column, any other property is its own.
    fn families(&mut self) {
        let element = self.element;
        let names: HashMap<&str, usize> =
            element.properties.iter().enumerate().map(|(at, property)| (property.name.as_str(), at)).collect();
        let mut at = 0;
        while let Some(property) = element.properties.get(at) {
            if self.taken[at] || property.count.is_some() {
                at += 1;
                continue;
            }
            let mut name = property.name.as_str();
            let mut width = 1;
            if let Some(base) = name.strip_suffix("_0").filter(|base| !base.is_empty()) {
                width = element.properties[at..]
                    .iter()
                    .enumerate()
                    .take_while(|(number, next)| {
                        next.kind == property.kind
                            && next.count.is_none()
                            && !self.taken[at + number]
                            && next.name.strip_prefix(base).and_then(|rest| rest.strip_prefix('_'))
                                == Some(number.to_string().as_str())
                    })
                    .count();
                let free = !names.contains_key(base) && !self.names.contains(base);
                if width > 1 && free {
                    name = base;
                } else {
                    width = 1;
                }
            }
            self.take(name, Meaning::Plain, ((at..at + width).collect(), property.kind));
            at += width;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::header::Property;
    use super::*;

    fn plan(name: &str, properties: &[(&str, Type)]) -> Plan {
        let properties = properties.iter().map(|(word, kind)| match word.strip_prefix("list ") {
            Some(name) => Property { name: name.into(), kind: *kind, count: Some(Type::Uchar) },
            None => Property { name: (*word).into(), kind: *kind, count: None },
        });
        Plan::new(&Element { name: name.into(), rows: 0, line: 1, properties: properties.collect() })
    }

    fn columns(plan: &Plan) -> Vec<(&str, usize, Meaning)> {
        plan.columns.iter().map(|group| (group.name.as_str(), group.properties.len(), group.meaning)).collect()
    }

    fn floats(names: &str) -> Vec<(&str, Type)> {
        names.split(' ').map(|name| (name, Type::Float)).collect()
    }

    #[test]
    fn customary_names_are_joined() {
        let mut properties = floats("nz x ny y nx z w u v s t");
        properties.extend(["blue", "green", "red"].map(|name| (name, Type::Uchar)));
        properties.push(("alpha", Type::Float));
        let found = plan("vertex", &properties);
        assert_eq!((found.role, found.axes), (Role::Vertex, Some([1, 3, 5])));
        let wanted = [
            ("normal", 3, Meaning::Normal),
            ("w", 1, Meaning::Plain),
            ("u", 1, Meaning::Plain),
            ("v", 1, Meaning::Plain),
            ("texcoord", 2, Meaning::Texcoord),
            ("color", 3, Meaning::Color),
            ("alpha", 1, Meaning::Plain),
        ];
        let mut found_columns = columns(&found);
        found_columns.sort_by_key(|column| wanted.iter().position(|one| one == column));
        assert_eq!(found_columns, wanted);
        let normal = found.columns.iter().find(|group| group.name == "normal").unwrap();
        assert_eq!(normal.properties, [4, 2, 0]);
        let found = plan("vertex", &floats("x y z r g b a diffuse_red diffuse_green diffuse_blue"));
        assert_eq!(columns(&found)[0], ("color", 4, Meaning::FloatColor));
        assert_eq!(columns(&found).len(), 4);
        // A name that is taken leaves all as they are; a table has no meanings.
        assert_eq!(columns(&plan("vertex", &floats("x y z nx ny nz normal"))).len(), 4);
        assert_eq!(columns(&plan("camera", &floats("x y z nx ny nz"))).len(), 6);
        // Whole numbers are no directions.
        assert_eq!(columns(&plan("face", &["nx", "ny", "nz"].map(|name| (name, Type::Char)))).len(), 3);
    }

    #[test]
    fn families_are_joined() {
        let names = |text: &'static str| {
            let plan = plan("thing", &floats(text));
            plan.columns.iter().map(|group| (group.name.clone(), group.properties.len())).collect::<Vec<_>>()
        };
        let of =
            |list: &[(&str, usize)]| list.iter().map(|(name, width)| ((*name).to_owned(), *width)).collect::<Vec<_>>();
        assert_eq!(names("a_0 a_1 a_2 b_0 c_1 c_2"), of(&[("a", 3), ("b_0", 1), ("c_1", 1), ("c_2", 1)]));
        assert_eq!(names("a a_0 a_1"), of(&[("a", 1), ("a_0", 1), ("a_1", 1)]));
        assert_eq!(names("a_0 a_1 a_3 _0 _1"), of(&[("a", 2), ("a_3", 1), ("_0", 1), ("_1", 1)]));
        let mixed = plan("thing", &[("a_0", Type::Float), ("a_1", Type::Float), ("a_2", Type::Int)]);
        assert_eq!(columns(&mixed), [("a", 2, Meaning::Plain), ("a_2", 1, Meaning::Plain)]);
        assert_eq!(names("a_0 b a_1"), of(&[("a_0", 1), ("b", 1), ("a_1", 1)]));
    }

    #[test]
    fn elements_have_their_roles() {
        let list = [("list vertex_index", Type::Int), ("list texcoord", Type::Float)];
        let face = plan("face", &list);
        assert_eq!((face.role, face.corners, face.lists), (Role::Face, Some(0), vec![1]));
        let strips = plan("tristrips", &list);
        assert_eq!((strips.role, strips.corners, strips.lists), (Role::Strips, None, vec![0, 1]));
        assert_eq!(plan("face", &floats("x")).role, Role::Table);
        assert_eq!(plan("edge", &floats("vertex1 vertex2")).role, Role::Edge);
        assert_eq!(plan("edge", &floats("vertex1")).role, Role::Table);
        assert_eq!(plan("vertex", &floats("x y")).axes, None);
    }
}
