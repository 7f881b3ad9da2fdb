//! What is asked of a mesh, by its purpose.

use shapeloom_core::choice;

choice! {
    /// What a mesh is for.
    pub enum Profile {
        /// Anything: a sound closed surface.
        General = "general",
        /// Printing: a solid that a slicer can fill.
        Print = "print",
        /// Drawing in real time: surfaces may be open and may cross.
        Game = "game",
        /// Simulation: a sound closed surface without slivers and contacts, from which a volume mesh can be made.
        Simulation = "simulation",
    }
}

/// A rule, and who asks for it.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// The code of a finding against it.
    pub code: &'static str,
    /// What it asks for.
    pub wants: &'static str,
    profiles: &'static [Profile],
}

const ALL: &[Profile] = &[Profile::General, Profile::Print, Profile::Game, Profile::Simulation];
const SOLID: &[Profile] = &[Profile::General, Profile::Print, Profile::Simulation];

/// Every rule.
pub const RULES: [Rule; 17] = [
    Rule { code: "W-check-empty", wants: "there is a face", profiles: ALL },
    Rule { code: "W-check-open", wants: "no edge has only one face", profiles: SOLID },
    Rule { code: "W-check-edge", wants: "no edge has more than two faces", profiles: ALL },
    Rule { code: "W-check-vertex", wants: "the faces at each vertex are one fan", profiles: SOLID },
    Rule { code: "W-check-orientation", wants: "faces that share an edge turn alike", profiles: ALL },
    Rule { code: "W-check-orientable", wants: "faces can be turned alike", profiles: ALL },
    Rule {
        code: "W-check-inverted",
        wants: "outer shells face outward and cavities inward",
        profiles: &[Profile::General, Profile::Print, Profile::Simulation],
    },
    Rule { code: "W-check-volume", wants: "a closed surface encloses a volume above 0", profiles: &[Profile::Print] },
    Rule { code: "W-check-degenerate", wants: "every face has an area and names no vertex twice", profiles: ALL },
    Rule {
        code: "W-check-duplicate",
        wants: "no face repeats another, by its vertices or by its corners' places",
        profiles: ALL,
    },
    Rule { code: "W-check-polygon", wants: "no polygon meets itself", profiles: ALL },
    Rule { code: "W-check-crossing", wants: "no face passes through another", profiles: SOLID },
    Rule {
        code: "W-check-overlap",
        wants: "no two faces overlap in a plane, looking the same way or folded along a side",
        profiles: SOLID,
    },
    Rule {
        code: "W-check-contact",
        wants: "faces touch in nothing but shared sides and corners, and no two vertices lie in one place",
        profiles: &[Profile::Simulation],
    },
    Rule { code: "W-check-isolated", wants: "every vertex has a face", profiles: &[Profile::General, Profile::Game] },
    Rule { code: "W-check-sliver", wants: "no angle is below one degree", profiles: &[Profile::Simulation] },
    Rule { code: "W-check-normals", wants: "vertices or corners have normals", profiles: &[Profile::Game] },
];

impl Profile {
    /// Whether this purpose asks for the rule with that code.
    pub fn asks_for(self, code: &str) -> bool {
        RULES.iter().any(|rule| rule.code == code && rule.profiles.contains(&self))
    }

    /// The rules that this purpose asks for.
    pub fn rules(self) -> impl Iterator<Item = &'static Rule> {
        RULES.iter().filter(move |rule| rule.profiles.contains(&self))
    }
}
