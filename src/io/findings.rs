//! What was mended, left out or odd in a file that could be loaded all the same.
//!
//! Findings of one kind are joined into one sentence with their number and the first line, so that
//! a file with a million faults is as easy to read about as one with two.

use std::collections::BTreeMap;

/// One thing that was mended, left out or odd.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The file, without folders.
    pub file: String,
    /// The first line that it is about, counted from 1.
    pub line: Option<u32>,
    /// What it is.
    pub kind: FindingKind,
    /// How often it was found.
    pub count: usize,
    /// The whole of it in plain words.
    pub text: String,
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
    /// A vertex with an infinite coordinate, or one that is no number.
    VertexNotFinite: "a vertex is not finite, and is left out", "# vertices are not finite, and are left out";
    /// A face that names such a vertex.
    FaceOnLostVertex: "a face names a vertex that is left out, and is left out with it", "# faces name vertices that are left out, and are left out with them";
    /// A face that names a vertex that is not there.
    FaceRange: "a face names a vertex that the file does not have, and is left out", "# faces name vertices that the file does not have, and are left out";
    /// A face of one or two corners.
    FaceShort: "a face has fewer than three corners, and is left out", "# faces have fewer than three corners, and are left out";
    /// A face with a corner that is no number.
    FaceUnreadable: "a face has a corner that is no number (\"@\"), and is left out", "# faces have corners that are no numbers (as \"@\"), and are left out";
    /// A smoothing group that is no number.
    SmoothingUnreadable: "a smoothing group is neither a number nor \"off\" (\"@\"), and is taken as off", "# smoothing groups are neither numbers nor \"off\" (as \"@\"), and are taken as off";
    /// Lines and points, which are not drawn.
    LineOrPoint: "a statement \"@\" is left out: only faces are drawn", "# statements \"@\" are left out: only faces are drawn";
    /// Curves and surfaces that are not polygons.
    FreeForm: "a free-form curve or surface is left out: only polygons are drawn", "# statements of free-form curves and surfaces are left out: only polygons are drawn";
    /// A statement that OBJ or MTL does not have.
    Unknown: "an unknown statement \"@\" is passed over", "# unknown statements \"@\" are passed over";
    /// A texture place that is not there.
    UvRange: "a face names a place on the texture that the file does not have; it has none there", "# faces name places on the texture that the file does not have; they have none there";
    /// A normal that is not there.
    NormalRange: "a face names a normal that the file does not have; it has none there", "# faces name normals that the file does not have; they have none there";
    /// A texture place with one number.
    UvSingle: "a place on the texture has one number; 0 is taken for the other", "# places on the texture have one number; 0 is taken for the other";
    /// A texture place that is not finite.
    UvNotFinite: "a place on the texture is not finite, and is left out", "# places on the texture are not finite, and are left out";
    /// A normal that is not finite.
    NormalNotFinite: "a normal is not finite, and is left out", "# normals are not finite, and are left out";
    /// Only some faces have places on the texture.
    UvMixed: "a face has no places on the texture, while others have", "# faces have no places on the texture, while others have";
    /// Only some faces have normals.
    NormalMixed: "a face has no normals of the file's, while others have; its own are computed", "# faces have no normals of the file's, while others have; theirs are computed";
    /// Numbers after those that a statement has.
    ExtraNumbers: "a vertex has more numbers than x, y, z and a colour; they are passed over", "# vertices have more numbers than x, y, z and a colour; they are passed over";
    /// A weight that is not 1.
    Weight: "a vertex has a weight other than 1, which is passed over", "# vertices have a weight other than 1, which is passed over";
    /// Colours on some vertices only.
    ColorPartly: "a vertex has no colour, while others have: it is white", "# vertices have no colour, while others have: they are white";
    /// Colours from 0 to 255.
    ColorBytes: "the colours of vertices exceed 1, and are taken as 0 to 255", "the colours of vertices exceed 1, and are taken as 0 to 255";
    /// A face that names a vertex twice.
    FaceRepeats: "a face names a vertex twice", "# faces name a vertex twice";
    /// A face without area.
    FaceNoArea: "a face has no area, and no normal of its own", "# faces have no area, and no normals of their own";
    /// A polygon whose triangles leave it.
    PolygonCrosses: "a polygon of @ corners crosses itself or is too large to be cut up rightly", "# polygons (the first of @ corners) cross themselves or are too large to be cut up rightly";
    /// No face at all.
    NoFaces: "the file has vertices, but no face: it draws nothing", "the file has vertices, but no face: it draws nothing";
    /// An MTL file that is not there.
    MtlMissing: "the material file \"@\" was not found", "the material file \"@\" was not found";
    /// More MTL files than anyone names.
    MtlMany: "a statement \"mtllib\" is passed over: a thousand different ones are enough", "# statements \"mtllib\" are passed over: a thousand different ones are enough";
    /// An MTL file that cannot be read.
    MtlUnreadable: "the material file cannot be read: @", "the material file cannot be read: @";
    /// A `usemtl` of a name that no MTL file has.
    MaterialUnknown: "the material \"@\" is not known: silver is taken", "the material \"@\" is not known: silver is taken";
    /// Two materials of one name.
    MaterialTwice: "the material \"@\" is there twice: the first is taken", "the material \"@\" is there # times too often: the first is taken";
    /// A statement before any `newmtl`.
    MtlStray: "a statement \"@\" belongs to no material, and is passed over", "# statements (the first \"@\") belong to no material, and are passed over";
    /// A number of a material that cannot be read.
    MtlNumber: "a number cannot be read in \"@\", which is passed over", "# statements have numbers that cannot be read (the first: \"@\"), and are passed over";
    /// Ka := 0.2 Kd.
    MendedAmbient: "0.2 Kd is taken for Ka of the material \"@\", which is missing, white, above 1, or Kd again", "0.2 Kd is taken for Ka of # materials (first: \"@\"), which is missing, white, above 1, or Kd again";
    /// Kd := 0.8, or 1 with a texture.
    MendedDiffuse: "the material \"@\" has no Kd: 0.8 is taken, or 1 with a texture", "# materials (first: \"@\") have no Kd: 0.8 is taken, or 1 with a texture";
    /// Ks := 0.
    MendedSpecular: "0 is taken for Ks of the material \"@\", which is missing or switched off by illum", "0 is taken for Ks of # materials (first: \"@\"), which is missing or switched off by illum";
    /// Ns := 1.
    MendedExponent: "1 is taken for Ns of the material \"@\", which is missing or below 1", "1 is taken for Ns of # materials (first: \"@\"), which is missing or below 1";
    /// A colour or an opacity outside 0 to 1.
    MendedRange: "a number of the material \"@\" is outside 0 to 1, and is brought there", "# numbers of materials (first: \"@\") are outside 0 to 1, and are brought there";
    /// `d` below 0.5.
    Transparent: "the material \"@\" is more than half transparent: it draws nothing, for nothing is blended", "# materials (first: \"@\") are more than half transparent: they draw nothing, for nothing is blended";
    /// `d` below 1.
    Translucent: "the material \"@\" is drawn without its transparency, for nothing is blended", "# materials (first: \"@\") are drawn without their transparency, for nothing is blended";
    /// A map other than `map_Kd`.
    MapUnused: "a statement \"@\" is passed over: the only texture that is drawn is map_Kd", "# statements \"@\" are passed over: the only texture that is drawn is map_Kd";
    /// A texture that is not there.
    TextureMissing: "the texture \"@\" was not found", "the texture \"@\" was not found";
    /// More textures than anyone names.
    TextureMany: "a texture is passed over: ten thousand different ones are enough", "# textures are passed over: ten thousand different ones are enough";
    /// A texture that cannot be read.
    TextureUnreadable: "the texture cannot be read: @", "the texture cannot be read: @";
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
                | Self::Transparent
                | Self::Translucent
        )
    }

    fn text(self, count: usize, name: &str, line: Option<u32>) -> String {
        let [one, many] = self.words();
        let words = if count == 1 { one } else { many };
        let name = match name.char_indices().nth(LONGEST_NAME) {
            Some((end, _)) => &format!("{}...", &name[..end]),
            None => name,
        };
        let text = words.replace('#', &count.to_string()).replace('@', name);
        match line {
            None => text,
            Some(line) if count == 1 => format!("{text} (line {line})"),
            Some(line) => format!("{text} (first: line {line})"),
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
            let text = kind.text(count, &name, line);
            Finding { file: file.clone(), line, kind, count, text }
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
        let text = "900 unknown statements \"... and others\" are passed over (first: line 101)";
        assert_eq!(forth[100].text, text);
        assert_eq!(forth, found(&mut (0..1000), 7));
        assert_eq!(forth, found(&mut (0..1000).rev(), 130));
        let long = FindingKind::TextureMissing.text(1, &"x".repeat(1 << 20), None);
        assert!(long.len() < 300, "{} signs", long.len());
    }
}
