//! What was mended, left out or odd in a file that could be loaded all the same.
//!
//! Findings of one kind are joined into one sentence with their number and the first line, so that
//! a file with a million faults is as easy to read about as one with two.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// One thing that was mended, left out or odd.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The path of the file; of the first one if it is about several.
    pub file: String,
    /// The first line of that file that it is about, counted from 1.
    pub line: Option<u32>,
    /// What it is.
    pub kind: FindingKind,
    /// How often it was found.
    pub count: usize,
    /// What the first case is about.
    name: String,
    /// How many files it is about.
    files: usize,
    /// The whole of it in plain words.
    pub text: String,
}

impl Finding {
    /// Takes up the cases of the same kind in another file.
    fn join(&mut self, other: &Self) {
        self.count += other.count;
        self.files += other.files;
        self.text = self.kind.text(self.count, &self.name, self.line, self.files);
    }
}

/// Findings of one kind in several files as one, in the place of the first.
#[must_use]
pub fn joined(findings: Vec<Finding>) -> Vec<Finding> {
    let mut places = BTreeMap::new();
    let mut list: Vec<Finding> = Vec::new();
    for finding in findings {
        let name = if finding.kind.joins_names() { "" } else { &finding.name };
        match places.entry((finding.kind, name.to_owned())) {
            Entry::Occupied(place) => {
                let first: &mut Finding = &mut list[*place.get()];
                first.join(&finding);
            }
            Entry::Vacant(place) => {
                place.insert(list.len());
                list.push(finding);
            }
        }
    }
    list
}

impl std::fmt::Display for Finding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}", self.file, self.text)
    }
}

/// Declares the kinds, each with its words for one case and for more.
///
/// `#` stands for the number of cases, `@` for the name that the first one is about.
macro_rules! kinds {
    ($($(#[$doc:meta])* $name:ident: $one:literal, $many:literal;)+) => {
        /// What a [`Finding`] is about.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum FindingKind {
            $($(#[$doc])* $name,)+
        }

        impl FindingKind {
            fn words(self) -> [&'static str; 2] {
                match self {
                    $(Self::$name => [$one, $many],)+
                }
            }
        }
    };
}

kinds! {
    /// A vertex with a coordinate that is infinite or NaN.
    VertexNotFinite: "a vertex is infinite or NaN and is skipped", "# vertices are infinite or NaN and are skipped";
    /// A face that refers to such a vertex.
    FaceOnLostVertex: "a face refers to a skipped vertex and is skipped too", "# faces refer to skipped vertices and are skipped too";
    /// A face that refers to a vertex that is not there.
    FaceRange: "a face refers to a vertex that the file does not have and is skipped", "# faces refer to vertices that the file does not have and are skipped";
    /// A face of one or two corners.
    FaceShort: "a face has fewer than three corners and is skipped", "# faces have fewer than three corners and are skipped";
    /// A face with a corner that is not a number.
    FaceUnreadable: "a face has a corner that is not a number (\"@\") and is skipped", "# faces have corners that are not numbers (such as \"@\") and are skipped";
    /// A smoothing group that is not a number.
    SmoothingUnreadable: "a smoothing group is neither a number nor \"off\" (\"@\") and is taken as off", "# smoothing groups are neither numbers nor \"off\" (such as \"@\") and are taken as off";
    /// Lines and points, which are not drawn.
    LineOrPoint: "a statement \"@\" is skipped: only faces are drawn", "# statements \"@\" are skipped: only faces are drawn";
    /// Curves and surfaces that are not polygons.
    FreeForm: "a statement of a free-form curve or surface is skipped: only polygons are drawn", "# statements of free-form curves and surfaces are skipped: only polygons are drawn";
    /// A statement that OBJ or MTL does not have.
    Unknown: "an unknown statement \"@\" is ignored", "# unknown statements \"@\" are ignored";
    /// A texture coordinate that is not there.
    UvRange: "a face refers to a texture coordinate that the file does not have; its corner has none", "# faces refer to texture coordinates that the file does not have; their corners have none";
    /// A normal that is not there.
    NormalRange: "a face refers to a normal that the file does not have; its normals are computed", "# faces refer to normals that the file does not have; their normals are computed";
    /// A texture coordinate of one number.
    UvSingle: "a texture coordinate has one number; 0 is taken for the other", "# texture coordinates have one number; 0 is taken for the other";
    /// A texture coordinate that is infinite or NaN.
    UvNotFinite: "a texture coordinate is infinite or NaN and is ignored", "# texture coordinates are infinite or NaN and are ignored";
    /// A normal that is infinite or NaN.
    NormalNotFinite: "a normal is infinite or NaN and is ignored", "# normals are infinite or NaN and are ignored";
    /// Only some faces have texture coordinates.
    UvMixed: "a face has no texture coordinates, while others have", "# faces have no texture coordinates, while others have";
    /// Only some faces have normals.
    NormalMixed: "a face has no normals, while others have; they are computed", "# faces have no normals, while others have; they are computed";
    /// Numbers after those that a statement has.
    ExtraNumbers: "a vertex has more numbers than x, y, z and a colour; the rest is ignored", "# vertices have more numbers than x, y, z and a colour; the rest is ignored";
    /// A weight that is not 1.
    Weight: "a vertex has a weight other than 1, which is ignored", "# vertices have a weight other than 1, which is ignored";
    /// Colours on some vertices only.
    ColorPartly: "a vertex has no colour, while others have: it is white", "# vertices have no colour, while others have: they are white";
    /// Colours from 0 to 255.
    ColorBytes: "vertex colours exceed 1 and are read as 0 to 255", "vertex colours exceed 1 and are read as 0 to 255";
    /// A face that refers to a vertex twice.
    FaceRepeats: "a face refers to a vertex twice", "# faces refer to a vertex twice";
    /// A face without area.
    FaceNoArea: "a face has no area and no normal of its own", "# faces have no area and no normals of their own";
    /// A polygon whose triangles leave it.
    PolygonCrosses: "a polygon of @ corners crosses itself; its triangles may lie outside of it", "# polygons (the first of @ corners) cross themselves; their triangles may lie outside of them";
    /// No face at all.
    NoFaces: "the file has vertices but no faces: it draws nothing", "the file has vertices but no faces: it draws nothing";
    /// An MTL file that is not there.
    MtlMissing: "the material file \"@\" was not found", "the material file \"@\" was not found";
    /// More MTL files than are read.
    MtlMany: "a statement \"mtllib\" is ignored: 1000 different ones are read at most", "# statements \"mtllib\" are ignored: 1000 different ones are read at most";
    /// An MTL file that cannot be read.
    MtlUnreadable: "the material file cannot be read: @", "the material file cannot be read: @";
    /// A `usemtl` of a name that no MTL file has.
    MaterialUnknown: "the material \"@\" is not defined: silver is used", "the material \"@\" is not defined: silver is used";
    /// Two materials of one name.
    MaterialTwice: "the material \"@\" is defined twice: the first is used", "the material \"@\" is defined # times more: the first is used";
    /// A statement before any `newmtl`.
    MtlStray: "a statement \"@\" stands before any newmtl and is ignored", "# statements (the first: \"@\") stand before any newmtl and are ignored";
    /// A number of a material that cannot be read.
    MtlNumber: "a statement \"@\" has a number that cannot be read and is ignored", "# statements (the first: \"@\") have numbers that cannot be read and are ignored";
    /// Ka := 0.2 Kd.
    MendedAmbient: "material \"@\": Ka is missing, white, above 1 or equal to Kd, and is taken as 0.2 Kd", "# materials: Ka is missing, white, above 1 or equal to Kd, and is taken as 0.2 Kd";
    /// Kd := 0.8, or 1 with a texture.
    MendedDiffuse: "material \"@\": Kd is missing and is taken as 0.8, or 1 with a texture", "# materials: Kd is missing and is taken as 0.8, or 1 with a texture";
    /// Ks := 0.
    MendedSpecular: "material \"@\": Ks is missing or switched off by illum, and is taken as 0", "# materials: Ks is missing or switched off by illum, and is taken as 0";
    /// Ns := 1.
    MendedExponent: "material \"@\": Ns is missing or below 1, and is taken as 1", "# materials: Ns is missing or below 1, and is taken as 1";
    /// A colour or an opacity outside 0 to 1.
    MendedRange: "material \"@\": a value is outside 0 to 1 and is clamped", "# values of materials are outside 0 to 1 and are clamped";
    /// `Tr 1` in all materials that are used.
    MendedTransparency: "material \"@\": Tr 1, which would hide the whole model, is taken as opaque", "# materials: Tr 1, which would hide the whole model, is taken as opaque";
    /// `d` below 0.5.
    Transparent: "material \"@\" is more than half transparent and draws nothing: there is no blending", "# materials are more than half transparent and draw nothing: there is no blending";
    /// `d` below 1.
    Translucent: "material \"@\" is partly transparent and is drawn opaque: there is no blending", "# materials are partly transparent and are drawn opaque: there is no blending";
    /// A map other than `map_Kd`.
    MapUnused: "a statement \"@\" is ignored: map_Kd is the only texture that is drawn", "# statements \"@\" are ignored: map_Kd is the only texture that is drawn";
    /// A texture that is not there.
    TextureMissing: "the texture \"@\" was not found", "the texture \"@\" was not found";
    /// More textures than are read.
    TextureMany: "a texture is ignored: 10,000 different ones are read at most", "# textures are ignored: 10,000 different ones are read at most";
    /// A texture that cannot be read.
    TextureUnreadable: "the texture cannot be read: @", "the texture cannot be read: @";
    /// A texture whose file ends before the picture does.
    TextureCutOff: "the texture is cut off: @ ends early, and the rest of the picture is grey", "the texture is cut off: @ ends early, and the rest of the picture is grey";
    /// A selection of something that the scene does not have.
    SelectionMissing: "the view selects @, which is not in the scene: the first one is selected", "the view selects @, which is not in the scene: the first one is selected";
    /// A spot or a camera that is bound to something that the scene does not have.
    OwnerMissing: "@, which is not in the scene", "@, which is not in the scene";
}

/// How many signs of a name are shown.
const LONGEST_NAME: usize = 200;

impl FindingKind {
    /// Whether cases about different names are one finding.
    const fn joins_names(self) -> bool {
        matches!(
            self,
            Self::FaceUnreadable
                | Self::SmoothingUnreadable
                | Self::PolygonCrosses
                | Self::MtlStray
                | Self::MtlNumber
                | Self::MendedAmbient
                | Self::MendedDiffuse
                | Self::MendedSpecular
                | Self::MendedExponent
                | Self::MendedRange
                | Self::MendedTransparency
                | Self::Transparent
                | Self::Translucent
        )
    }

    fn text(self, count: usize, name: &str, line: Option<u32>, files: usize) -> String {
        let [one, many] = self.words();
        let words = if count == 1 { one } else { many };
        let name = match name.char_indices().nth(LONGEST_NAME) {
            Some((end, _)) => &format!("{}...", &name[..end]),
            None => name,
        };
        let shown = name.replace(char::is_control, "\u{FFFD}");
        let text = words.replace('#', &count.to_string()).replace('@', &shown);
        match (line, files) {
            (None, 1) => text,
            (None, _) => format!("{text} ({files} files)"),
            (Some(line), 1) if count == 1 => format!("{text} (line {line})"),
            (Some(line), 1) => format!("{text} (first: line {line})"),
            (Some(line), _) => format!("{text} (first: line {line}; {files} files)"),
        }
    }
}

/// How many names of a kind are told apart: nobody reads more.
const MOST_NAMES: usize = 100;

/// No name sorts after it.
const LAST: &str = "\u{10FFFF}";

/// Findings of one file as they come in.
#[derive(Debug, Default)]
pub(super) struct Findings {
    file: String,
    /// By kind and, where names are told apart, name.
    cases: BTreeMap<(FindingKind, String), Cases>,
    /// How many names of a kind are told apart.
    names: BTreeMap<FindingKind, usize>,
    /// Cases of names beyond those.
    others: BTreeMap<FindingKind, Cases>,
}

#[derive(Debug)]
struct Cases {
    count: usize,
    name: String,
    line: Option<u32>,
}

impl Findings {
    pub(super) fn new(file: &str) -> Self {
        Self { file: file.to_owned(), ..Self::default() }
    }

    /// Notes one case at a line.
    pub(super) fn note(&mut self, kind: FindingKind, line: u32) {
        self.add(kind, "", Some(line));
    }

    /// Notes one case that is about a name, at a line where there is one.
    pub(super) fn add(&mut self, kind: FindingKind, name: &str, line: Option<u32>) {
        self.add_cases(kind, Cases { count: 1, name: name.to_owned(), line });
    }

    /// Notes so many cases, the first of them at `line`; none is no finding.
    pub(super) fn note_all(&mut self, kind: FindingKind, count: usize, line: u32) {
        if count > 0 {
            self.add_cases(kind, Cases { count, name: String::new(), line: Some(line) });
        }
    }

    /// Takes up what was found in the lines that follow, of which `lines` are before them.
    pub(super) fn append(&mut self, following: Self, lines: u32) {
        let placed = |cases: Cases| {
            let line = cases.line.map(|line| line.saturating_add(lines));
            Cases { line, ..cases }
        };
        for ((kind, _), cases) in following.cases {
            self.add_cases(kind, placed(cases));
        }
        for (kind, cases) in following.others {
            self.add_others(kind, &placed(cases));
        }
    }

    fn add_cases(&mut self, kind: FindingKind, cases: Cases) {
        let name = if kind.joins_names() { "" } else { &*cases.name };
        let key = (kind, name.to_owned());
        if let Some(first) = self.cases.get_mut(&key) {
            first.count += cases.count;
            return;
        }
        self.cases.insert(key, cases);
        let names = self.names.entry(kind).or_default();
        *names += 1;
        if *names <= MOST_NAMES {
            return;
        }
        *names -= 1;
        // The last one by name goes: which stay does not depend on the order in which they came.
        let last = self.cases.range(..(kind, LAST.to_owned())).next_back();
        if let Some(cases) =
            last.map(|(key, _)| key.clone()).and_then(|key| self.cases.remove(&key))
        {
            self.add_others(kind, &cases);
        }
    }

    /// Takes up cases of names that are not told apart.
    fn add_others(&mut self, kind: FindingKind, cases: &Cases) {
        let Cases { count, line, .. } = *cases;
        let none = Cases { count: 0, name: "... and others".to_owned(), line };
        let others = self.others.entry(kind).or_insert(none);
        others.count += count;
        others.line = others.line.min(line);
    }

    pub(super) fn into_list(self) -> Vec<Finding> {
        let Self { file, mut cases, others, .. } = self;
        cases.extend(others.into_iter().map(|(kind, cases)| ((kind, LAST.to_owned()), cases)));
        let finding = |((kind, _), cases): ((FindingKind, String), Cases)| {
            let Cases { count, name, line } = cases;
            let text = kind.text(count, &name, line, 1);
            Finding { file: file.clone(), line, kind, count, name, files: 1, text }
        };
        cases.into_iter().map(finding).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_endless_names_a_hundred_are_told_apart_whatever_order_they_come_in() {
        let found = |names: &mut dyn Iterator<Item = u32>, share: usize| {
            let names: Vec<u32> = names.collect();
            let mut all = Findings::new("a.obj");
            for names in names.chunks(share) {
                let mut findings = Findings::default();
                for name in names {
                    findings.add(FindingKind::Unknown, &format!("{name:04}"), Some(name + 1));
                }
                all.append(findings, 0);
            }
            all.into_list()
        };
        let forth = found(&mut (0..1000), 1000);
        assert_eq!(forth.len(), 101);
        let text = "900 unknown statements \"... and others\" are ignored (first: line 101)";
        assert_eq!(forth[100].text, text);
        assert_eq!(forth, found(&mut (0..1000), 7));
        assert_eq!(forth, found(&mut (0..1000).rev(), 130));
        let long = FindingKind::TextureMissing.text(1, &"x".repeat(1 << 20), None, 1);
        assert!(long.len() < 300, "{} signs", long.len());
    }
}
