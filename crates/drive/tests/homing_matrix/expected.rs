//! By which edges each method goes, from wherever it starts.

/// The switches: NOT below the first, HOME between the next two, POT from the last on, in pulses.
pub type Axis = [i32; 4];

pub const AXIS: Axis = [-300, 0, 100, 400];

/// The manual's diagrams of variant 0: method, then the legs from the left of HOME, from on it and from its right; 17 and 18 have the legs
/// from beside their limit and from on it.
///
/// H and L are fast and slow with the direction of travel. HL and HR are the left and the right edge of HOME, NOT and POT the negative and
/// the positive limit, with ^ switching on and _ switching off. The axis comes to rest behind each edge, unless a ~ follows.
const VARIANT_0: &str = "
    17 | H- NOT^                  | L+ NOT_
    18 | H+ POT^                  | L- POT_
    19 | H+ HL^ L- HL_            | L- HL_         | H+ POT^ L- HL_
    20 | L+ HL^                   | H- HL_ L+ HL^  | L+ POT^ H- HL_ L+ HL^
    21 | H- NOT^ L+ HR_           | L+ HR_         | H- HR^ L+ HR_
    22 | L- NOT^ H+ HR_ L- HR^    | H+ HR_ L- HR^  | L- HR^
    23 | H+ HL^ L- HL_            | L- HL_         | H+ POT^ L- HL_
    24 | L+ HL^                   | H- HL_ L+ HL^  | L+ POT^ H- HL_ L+ HL^
    25 | H+ HR_ L- HR^            | H+ HR_ L- HR^  | H+ POT^ L- HR^
    26 | L+ HR_                   | L+ HR_         | L+ POT^ H- HR^ L+ HR_
    27 | H- NOT^ L+ HR_           | L+ HR_         | H- HR^ L+ HR_
    28 | L- NOT^ H+ HR_ L- HR^    | H+ HR_ L- HR^  | L- HR^
    29 | H- NOT^ L+ HL^           | H- HL_ L+ HL^  | H- HL_ L+ HL^
    30 | L- NOT^ H+ HL^ L- HL_    | L- HL_         | L- HL_";

/// Variant 1 as reconstructed.
const VARIANT_1: &str = "
    17 | H- NOT^ L+ NOT_                 | L+ NOT_
    18 | H+ POT^ L- POT_                 | L- POT_
    19 | H+ HL^ L- HL_                   | L- HL_         | H+ POT^ L- HL_
    20 | L+ HL^                          | H- HL_ L+ HL^  | L+ POT^ H- HL_ L+ HL^
    21 | H- NOT^ L+ HR_                  | L+ HR_         | H- HR^ L+ HR_
    22 | L- NOT^ H+ HR_ L- HR^           | H+ HR_ L- HR^  | L- HR^
    23 | H+ HL^ L- HL_                   | L- HL_         | H+ POT^ H- HR^ ~ L- HL_
    24 | H+ HL^ L- HL_ L+ HL^            | L- HL_ L+ HL^  | H+ POT^ H- HR^ ~ L- HL_ L+ HL^
    25 | H+ HL^ ~ L+ HR_ L- HR^          | L+ HR_ L- HR^  | H+ POT^ H- HR^ L+ HR_ L- HR^
    26 | H+ HL^ ~ L+ HR_                 | L+ HR_         | H+ POT^ H- HR^ L+ HR_
    27 | H- NOT^ H+ HL^ ~ L+ HR_         | L+ HR_         | H- HR^ L+ HR_
    28 | H- NOT^ H+ HL^ ~ L+ HR_ L- HR^  | L+ HR_ L- HR^  | H- HR^ L+ HR_ L- HR^
    29 | H- NOT^ H+ HL^ L- HL_ L+ HL^    | L- HL_ L+ HL^  | H- HR^ ~ L- HL_ L+ HL^
    30 | H- NOT^ H+ HL^ L- HL_           | L- HL_         | H- HR^ ~ L- HL_";

/// A switch's edge on its way on or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// Which of the axis' edges.
    pub place: usize,
    pub on: bool,
}

#[derive(Clone, Copy, Debug)]
pub struct Leg {
    pub fast: bool,
    pub direction: i32,
    pub edge: Edge,
    pub rests: bool,
}

/// A method's legs from one kind of start.
pub type Legs = Vec<Leg>;

pub fn legs(text: &str) -> Legs {
    let mut legs = Legs::new();
    let mut words = text.split_whitespace();
    while let Some(word) = words.next() {
        if word == "~" {
            legs.last_mut().unwrap().rests = false;
            continue;
        }
        let edge = words.next().expect("an edge");
        let (name, on) = edge.split_at(edge.len() - 1);
        let place = ["NOT", "HL", "HR", "POT"].iter().position(|place| *place == name).unwrap();
        legs.push(Leg {
            fast: word.starts_with('H'),
            direction: if word.ends_with('-') { -1 } else { 1 },
            edge: Edge { place, on: on == "^" },
            rests: true,
        });
    }
    legs
}

/// Variant, method and legs of all kinds of start.
pub fn methods() -> Vec<(u16, i8, Vec<Legs>)> {
    let tables = [(0, VARIANT_0), (1, VARIANT_1)];
    let lines = tables
        .into_iter()
        .flat_map(|(variant, table)| table.lines().skip(1).map(move |line| (variant, line)));
    lines
        .map(|(variant, line)| {
            let mut columns = line.split('|').map(str::trim);
            let method = columns.next().unwrap().parse().unwrap();
            (variant, method, columns.map(legs).collect())
        })
        .collect()
}

/// The legs from `start`. Who stands on the limit that the first leg looks for has that leg behind it.
pub fn legs_from(start: i32, axis: &Axis, method: i8, kinds: &[Legs]) -> Legs {
    let (negative, positive) = (start < axis[0], start >= axis[3]);
    match method {
        17 => return kinds[usize::from(negative)].clone(),
        18 => return kinds[usize::from(positive)].clone(),
        _ => {}
    }
    let kind = usize::from(start >= axis[1]) + usize::from(start >= axis[2]);
    let skipped = match kinds[kind][0].edge.place {
        0 => negative,
        3 => positive,
        _ => false,
    };
    kinds[kind][usize::from(skipped)..].to_vec()
}

/// Left of, on and right of each switch, and a pulse from each edge.
pub fn starts(axis: &Axis) -> Vec<i32> {
    let beside = axis.iter().flat_map(|edge| [edge - 1, *edge, edge + 1]);
    let between = [
        axis[0] - 9,
        (axis[0] + axis[1]) / 2,
        (axis[1] + axis[2]) / 2,
        (axis[2] + axis[3]) / 2,
        axis[3] + 9,
    ];
    beside.chain(between).collect()
}
