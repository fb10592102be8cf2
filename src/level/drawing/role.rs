//! What a layer (or class, or id, or block) is by its name: wall, door, window, furniture.

use std::str::FromStr;

/// What lines are drawn for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Role {
    /// Stops sight.
    Wall,
    /// A closed shape whose inside is solid.
    Column,
    /// An opening with a leaf.
    Door,
    /// An opening with a sill.
    Window,
    /// An opening without a leaf.
    Archway,
    /// Stands in a room and stops nobody's sight.
    Furniture,
    /// Left out.
    Ignored,
}

impl Role {
    /// The word for `--layer` and messages.
    pub fn as_str(self) -> &'static str {
        match self {
            Role::Wall => "wall",
            Role::Column => "column",
            Role::Door => "door",
            Role::Window => "window",
            Role::Archway => "archway",
            Role::Furniture => "furniture",
            Role::Ignored => "ignored",
        }
    }
}

/// A pattern of layer names with what such layers are. `*` stands for any text, `?` for any letter;
/// capitals do not matter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LayerRule {
    /// What the layers are.
    pub role: Role,
    /// Their names.
    pub pattern: String,
}

impl FromStr for LayerRule {
    type Err = String;

    /// `wall=A-WALL*`
    fn from_str(text: &str) -> Result<LayerRule, String> {
        const ROLES: [Role; 7] = [
            Role::Wall,
            Role::Column,
            Role::Door,
            Role::Window,
            Role::Archway,
            Role::Furniture,
            Role::Ignored,
        ];
        let (word, pattern) = text.split_once('=').unwrap_or((text, ""));
        let role = ROLES.into_iter().find(|r| r.as_str() == word);
        match role {
            Some(role) if !pattern.is_empty() => Ok(LayerRule {
                role,
                pattern: pattern.to_string(),
            }),
            _ => Err(format!(
                "a rule for layers is such as wall=A-WALL*; what they can be: {}",
                ROLES.map(Role::as_str).join(", ")
            )),
        }
    }
}

/// Parts of names that tell what a layer is, in the words of several languages. What is ignored comes
/// first: `A-WALL-PATT` is the hatching of walls, `DOOR-TEXT` their numbers.
const WORDS: [(Role, &[&str]); 7] = [
    (
        Role::Ignored,
        &[
            "*DIM*",
            "*ANNO*",
            "*TEXT*",
            "*PATT*",
            "*HATCH*",
            "*IDEN*",
            "*NOTE*",
            "*GRID*",
            "*AXIS*",
            "*TITLE*",
            "*TTLB*",
            "*DEFPOINTS*",
            "*VIEWPORT*",
            "*SCHRAFFUR*",
            "*BEMASS*",
            "*COTE*",
            "*PORTAL*",
            "CELLS",
            "STEPS",
            "*CEIL*",
            "*SYMB*",
            "*LEGEND*",
            "*NORTH*",
            "*DIMENSION*",
            "*LABEL*",
            "*BACKGROUND*",
        ],
    ),
    (Role::Archway, &["*ARCHWAY*", "*OPENING*", "*OPNG*"]),
    (
        Role::Door,
        &[
            "*DOOR*", "*TUER*", "*TÜR*", "*PORTE*", "*PUERTA*", "*PORTA*", "*DEUR*",
        ],
    ),
    (
        Role::Window,
        &[
            "*WINDOW*",
            "*GLAZ*",
            "*FENSTER*",
            "*FENETRE*",
            "*FENÊTRE*",
            "*VENTAN*",
            "*FINESTR*",
            "*RAAM*",
            "A-WIND*",
            "WIN",
            "WIND",
        ],
    ),
    (
        Role::Column,
        &[
            "*COLUMN*",
            "*COLS*",
            "*PILLAR*",
            "*STUETZE*",
            "*STÜTZE*",
            "*POTEAU*",
            "*PILAR*",
        ],
    ),
    (
        Role::Furniture,
        &[
            "*FURN*",
            "*MOEBEL*",
            "*MÖBEL*",
            "*MOBILI*",
            "*MUEBLE*",
            "*MEUBLE*",
            "*EQPM*",
            "*FIXT*",
            "*SANITAER*",
            "*SANITÄR*",
            "*PLUMB*",
            "*DESK*",
            "*CHAIR*",
            "*TABLE*",
            "*SOFA*",
            "*TOILET*",
            "*SINK*",
            "*SHELF*",
        ],
    ),
    (
        Role::Wall,
        &[
            "*WALL*",
            "*WAND*",
            "*WAENDE*",
            "*WÄNDE*",
            "*MUR",
            "*MURS*",
            "*MURO*",
            "*MURI*",
            "*PARED*",
            "*PARETI*",
            "*CLOISON*",
            "*PRTN*",
            "*PARTITION*",
            "MUR*",
            "*MAUER*",
        ],
    ),
];

/// What a name says, by the rules given and then by the usual words. `None`: nothing.
pub fn role_of(name: &str, rules: &[LayerRule]) -> Option<Role> {
    let name = folded(name);
    let given = rules.iter().find(|r| fits(&folded(&r.pattern), &name));
    given.map(|r| r.role).or_else(|| {
        let mut words = WORDS.iter();
        let by_word = |(_, words): &&(Role, &[&str])| words.iter().any(|w| fits(&folded(w), &name));
        words.find(by_word).map(|(role, _)| *role)
    })
}

fn folded(text: &str) -> Vec<char> {
    text.chars().flat_map(char::to_uppercase).collect()
}

/// Whether a name fits a pattern. One pass with a single place to go back to, so that no pattern
/// takes longer than the product of the lengths.
fn fits(pattern: &[char], name: &[char]) -> bool {
    let (mut p, mut n) = (0, 0);
    let mut back: Option<(usize, usize)> = None;
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => {
                back = Some((p, n));
                p += 1;
            }
            Some(&c) if c == '?' || c == name[n] => {
                p += 1;
                n += 1;
            }
            _ => match back {
                Some((star, at)) => {
                    back = Some((star, at + 1));
                    p = star + 1;
                    n = at + 1;
                }
                None => return false,
            },
        }
    }
    pattern[p..].iter().all(|&c| c == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns() {
        let fits = |p: &str, n: &str| fits(&folded(p), &folded(n));
        assert!(fits("A-WALL*", "a-wall-full") && fits("*wall*", "WALLS") && fits("?", "ü"));
        assert!(!fits("A-WALL", "A-WALL-FULL") && !fits("*x", "xy") && fits("*", ""));
        assert!(fits("a*b*c", "aXbXbYc") && !fits("a*b*c", "aXbXbY"));
        let long = "a".repeat(2000);
        assert!(!fits("*a*a*a*a*a*a*a*a*b", &long));
    }

    #[test]
    fn usual_names() {
        let role = |name| role_of(name, &[]);
        assert_eq!(role("A-WALL-FULL"), Some(Role::Wall));
        assert_eq!(role("A-WALL-PATT"), Some(Role::Ignored));
        assert_eq!(role("Türen EG"), Some(Role::Door));
        assert_eq!(role("A-GLAZ"), Some(Role::Window));
        assert_eq!(role("S-COLS"), Some(Role::Column));
        assert_eq!(role("I-FURN"), Some(Role::Furniture));
        // Layers of our own exports; a porta is a door, a portal of cells is none.
        for own in ["PORTALS", "CELLS", "STEPS"] {
            assert_eq!(role(own), Some(Role::Ignored), "{own}");
        }
        assert_eq!(role("A-PORTA"), Some(Role::Door));
        assert_eq!(role("0"), None);
        assert_eq!(role("ARCHWAYS"), Some(Role::Archway));
        assert_eq!(role("COLUMNS"), Some(Role::Column));
        let rules = ["wall=0".parse().unwrap(), "ignored=*WALL*".parse().unwrap()];
        assert_eq!(role_of("0", &rules), Some(Role::Wall));
        assert_eq!(role_of("A-WALL", &rules), Some(Role::Ignored));
        assert!("0".parse::<LayerRule>().is_err() && "roof=0".parse::<LayerRule>().is_err());
    }
}
