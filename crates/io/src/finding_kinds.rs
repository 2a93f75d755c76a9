//! The kinds of findings, each with its sentence.
//!
//! A file may load with thousands of equal faults, so each kind has a sentence for one case and one
//! for many.

/// A property of some kinds.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Mark {
    /// Cases with different names are joined into one finding.
    Joined,
    /// The model loses something that its file defines.
    Loss,
}

/// Declares the kinds, each with its marks, and its sentences for one case and, if it is another,
/// for many.
///
/// `#` is the number of cases, `@` the name in the first case.
macro_rules! kinds {
    ($($name:ident $([$($mark:ident),+])?: $one:literal $(, $many:literal)?;)+) => {
        /// The subject of a [`Finding`](super::Finding).
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum FindingKind {
            $(#[doc = $one] $name,)+
        }

        impl FindingKind {
            fn words(self) -> &'static [&'static str] {
                match self {
                    $(Self::$name => &[$one $(, $many)?],)+
                }
            }

            fn marks(self) -> &'static [Mark] {
                match self {
                    $(Self::$name => &[$($(Mark::$mark),+)?],)+
                }
            }
        }
    };
}

kinds! {
    VertexNotFinite [Loss]:
        "a vertex is too large, infinite or NaN, and is skipped",
        "# vertices are too large, infinite or NaN, and are skipped";
    VertexUnreadable [Joined, Loss]:
        "a vertex cannot be read (@) and is skipped",
        "# vertices cannot be read (the first: @) and are skipped";
    TriangleNotFinite [Loss]:
        "a triangle has a corner that is unreadable, too large, infinite or NaN, and is skipped",
        "# triangles have corners that are unreadable, too large, infinite or NaN, and are skipped";
    StlUnknown [Joined]:
        "the word \"@\" is not a statement of STL and is ignored",
        "# words (the first: \"@\") are not statements of STL and are ignored";
    VertexUnused:
        "a vertex is not used by any face, line or point and does not affect size and centre",
        "# vertices are not used by any face, line or point and do not affect size and centre";
    NumberOdd [Joined]:
        "the number \"@\" is written in an unusual way and is read nevertheless",
        "# statements have numbers that are written in an unusual way (the first: \"@\") and are \
         read nevertheless";
    NotContinued:
        "a statement \"@\" ends in a backslash, but the next line is a new statement",
        "# statements \"@\" end in a backslash, but the next lines are new statements";
    ControlCharacter:
        "a line has control characters, which are read as blanks",
        "# lines have control characters, which are read as blanks";
    FaceOnLostVertex:
        "a face refers to a skipped vertex and is skipped too",
        "# faces refer to skipped vertices and are skipped too";
    FaceRange [Loss]:
        "a face refers to a vertex that the file does not have and is skipped",
        "# faces refer to vertices that the file does not have and are skipped";
    FaceShort:
        "a face has fewer than three corners and is skipped",
        "# faces have fewer than three corners and are skipped";
    FaceUnreadable [Joined, Loss]:
        "a face has a corner that is not a number (\"@\") and is skipped",
        "# faces have corners that are not numbers (such as \"@\") and are skipped";
    SmoothingUnreadable [Joined]:
        "a smoothing group is neither a number nor \"on\" or \"off\" (\"@\") and is taken as off",
        "# smoothing groups are neither numbers nor \"on\" or \"off\" (such as \"@\") and \
         are taken as off";
    StrokeVertex [Joined, Loss]:
        "a line or point refers to vertex \"@\", which the file does not have, and is skipped",
        "# lines or points refer to vertices that the file does not have (the first: \"@\") and \
         are skipped";
    StrokeShort:
        "a line has fewer than two vertices, or a point none, and is skipped",
        "# lines have fewer than two vertices, or points none, and are skipped";
    FreeForm:
        "a statement of a free-form curve or surface is skipped: only polygons are drawn",
        "# statements of free-form curves and surfaces are skipped: only polygons are drawn";
    Unknown: "an unknown statement \"@\" is ignored", "# unknown statements \"@\" are ignored";
    UvRange:
        "a face refers to a texture coordinate that the file does not have; its corner has none",
        "# faces refer to texture coordinates that the file does not have; their corners have none";
    NormalRange:
        "a face refers to a normal that the file does not have; its normals are computed",
        "# faces refer to normals that the file does not have; their normals are computed";
    UvSingle:
        "a texture coordinate has one number; the other is taken as 0",
        "# texture coordinates have one number; the other is taken as 0";
    UvNotFinite:
        "a texture coordinate is too large, infinite or NaN, and is ignored",
        "# texture coordinates are too large, infinite or NaN, and are ignored";
    NormalNotFinite:
        "a normal is too large, infinite or NaN, and is ignored",
        "# normals are too large, infinite or NaN, and are ignored";
    UvUnreadable [Loss]:
        "a texture coordinate cannot be read and is ignored",
        "# texture coordinates cannot be read and are ignored";
    NormalUnreadable:
        "a normal cannot be read and is ignored",
        "# normals cannot be read and are ignored";
    UvMixed:
        "a face has no texture coordinates, while others have",
        "# faces have no texture coordinates, while others have";
    NormalMixed:
        "a face has no normals, while others have; they are computed",
        "# faces have no normals, while others have; they are computed";
    ExtraNumbers:
        "a vertex has more numbers than x, y, z and a colour; the rest is ignored",
        "# vertices have more numbers than x, y, z and a colour; the rest is ignored";
    Weight:
        "a vertex has a weight other than 1, which is ignored",
        "# vertices have a weight other than 1, which is ignored";
    ColorPartly:
        "a vertex has no colour, while others have: it is white",
        "# vertices have no colour, while others have: they are white";
    ColorBytes: "vertex colours exceed 1 and are read as 0 to 255";
    ColorBright: "vertex colours exceed 1 and are clamped";
    ColorComments:
        "a comment @ (vertex colours of ZBrush) is ignored",
        "# comments @ (vertex colours of ZBrush) are ignored";
    FaceRepeats: "a face refers to a vertex twice", "# faces refer to a vertex twice";
    FaceNoArea: "a face has no area and no normal", "# faces have no area and no normals";
    PolygonCrosses [Joined]:
        "a polygon of @ corners crosses itself; its triangles may lie outside it",
        "# polygons (the first of @ corners) cross themselves; their triangles may lie outside \
            them";
    InsideOut [Loss]:
        "the closed body is inside out; --flip-winding turns it",
        "all # closed bodies are inside out; --flip-winding turns them";
    InsideOutPartly:
        "a closed body is inside out, while others are not",
        "# closed bodies are inside out, while others are not";
    NormalsAgainst [Loss]:
        "the normals of a face point against its winding; --no-file-normals ignores them",
        "the normals of # faces point against their winding; --no-file-normals ignores them";
    OnlyVertices: "the file has only vertices: they are drawn as points";
    MtlMissing [Loss]: "the material file \"@\" was not found";
    MtlRenamed: "the material file \"@\" was not found; the one with the model's name is used";
    MtlOfModel: "the file names materials but no material file; \"@\" is used";
    MtlUnnamed: "the file names no materials; the material file \"@\" is not used";
    PictureUnnamed: "the file names no material file; the picture \"@\" is not used";
    MaterialsUnused [Loss]:
        "no face names a material: the one in the material file is not used",
        "no face names a material: the # in the material files are not used";
    MtlMany:
        "a statement \"mtllib\" is ignored: at most 1000 different ones are read",
        "# statements \"mtllib\" are ignored: at most 1000 different ones are read";
    MtlUnreadable [Loss]: "the material file cannot be read: @";
    MaterialUnknown [Joined]:
        "the material \"@\" is not defined: silver is used",
        "# materials (the first: \"@\") are not defined: silver is used";
    MaterialTwice [Joined]:
        "the material \"@\" is defined twice: the first is used",
        "# definitions repeat earlier ones (such as that of material \"@\"), which are used";
    MtlStray [Joined]:
        "a statement \"@\" comes before any newmtl and is ignored",
        "# statements (the first: \"@\") come before any newmtl and are ignored";
    MtlNumber [Joined]:
        "a statement \"@\" has a number that cannot be read and is ignored",
        "# statements (the first: \"@\") have numbers that cannot be read and are ignored";
    MendedAmbient [Joined]:
        "material \"@\": Ka is missing, white, above 1 or equal to Kd, and is taken as 0.2 Kd",
        "# materials: Ka is missing, white, above 1 or equal to Kd, and is taken as 0.2 Kd";
    MendedDiffuse [Joined]:
        "material \"@\": Kd is missing and is taken as 0.8, or 1 with a texture",
        "# materials: Kd is missing and is taken as 0.8, or 1 with a texture";
    MendedSpecular [Joined]:
        "material \"@\": Ks is missing or switched off by illum, and is taken as 0",
        "# materials: Ks is missing or switched off by illum, and is taken as 0";
    MendedExponent [Joined]:
        "material \"@\": Ns is below 1 and is taken as 1",
        "# materials: Ns is below 1 and is taken as 1";
    MendedMatt [Joined]:
        "material \"@\": Ns is missing or 0: the surface is matt, without the highlight of Ks",
        "# materials: Ns is missing or 0: the surfaces are matt, without the highlights of Ks";
    MendedBytes [Joined]:
        "material \"@\": whole colours above 1 are read as 0 to 255",
        "# materials: whole colours above 1 are read as 0 to 255";
    DiffuseBlack [Joined, Loss]:
        "material \"@\": Kd 0 makes its texture black",
        "# materials: Kd 0 makes their textures black";
    BumpIsNormals [Joined]:
        "the bump map \"@\" shows normals and is read as a normal map; --bump-maps heights reads \
         it as heights",
        "# bump maps (the first: \"@\") show normals and are read as normal maps; --bump-maps \
         heights reads them as heights";
    DisplacementIsBump [Joined]:
        "material \"@\": disp moves no vertices, and is drawn as a bump map",
        "# materials: disp moves no vertices, and is drawn as a bump map";
    MendedEmission [Joined]:
        "material \"@\": map_Ke without Ke; Ke is taken as 1",
        "# materials: map_Ke without Ke; Ke is taken as 1";
    MendedMapped [Joined]:
        "material \"@\": map_Ks without Ks; Ks is taken as 1",
        "# materials: map_Ks without Ks; Ks is taken as 1";
    MendedPacked [Joined]:
        "material \"@\": with bsdf pbr, Ks is taken as occlusion, roughness and metalness",
        "# materials: with bsdf pbr, Ks is taken as occlusion, roughness and metalness";
    MendedRough [Joined]:
        "material \"@\": without Ks and Ns, the highlight follows from Pr and Pm",
        "# materials: without Ks and Ns, the highlights follow from Pr and Pm";
    MendedMetal [Joined]:
        "material \"@\" is a metal of Blender: Ka is its metalness, and Ks gets the colour of Kd",
        "# materials are metals of Blender: Ka is their metalness, and Ks gets the colour of Kd";
    Illumination [Joined]:
        "material \"@\": illum is not a whole number from 0 to 9: it is drawn as 2",
        "# materials: illum is not a whole number from 0 to 9: it is drawn as 2";
    MendedRange [Joined]:
        "material \"@\": a value is outside 0 to 1 and is clamped",
        "# values of materials are outside 0 to 1 and are clamped";
    MendedTransparency [Joined]:
        "material \"@\": d 0 or Tr 1, which would hide the whole model, is taken as opaque",
        "# materials: d 0 or Tr 1, which would hide the whole model, is taken as opaque";
    MendedContradiction [Joined]:
        "material \"@\": d 0 contradicts Tr 0 and is taken as 1",
        "# materials: d 0 contradicts Tr 0 and is taken as 1";
    MendedDissolve [Joined]:
        "material \"@\": d 0, which would hide all that map_d shows, is taken as 1",
        "# materials: d 0, which would hide all that map_d shows, is taken as 1";
    MendedConstant [Joined]:
        "material \"@\": illum 0 without a texture is taken as 1: it is lit, without a highlight",
        "# materials: illum 0 without a texture is taken as 1: they are lit, without highlights";
    ColorTextured [Joined]:
        "material \"@\": its texture replaces the vertex colours",
        "# materials: their textures replace the vertex colours";
    Transparent [Joined, Loss]:
        "material \"@\" is wholly transparent and draws nothing",
        "# materials are wholly transparent and draw nothing";
    HaloEven [Joined]:
        "a statement \"@\" -halo fades towards the edges; it is drawn evenly",
        "# statements \"@\" -halo fade towards the edges; they are drawn evenly";
    MapOpaque [Joined]:
        "material \"@\": map_d names the picture of map_Kd, which has no alpha: it is opaque",
        "# materials: map_d names the picture of map_Kd, which has no alpha: they are opaque";
    MapUnnamed [Joined]:
        "a statement \"@\" names no file and is ignored",
        "# statements (the first: \"@\") name no file and are ignored";
    MapUnused:
        "a statement \"@\" is ignored: maps of this kind are not drawn",
        "# statements \"@\" are ignored: maps of this kind are not drawn";
    MapOption: "the option \"@\" of a map is ignored", "the option \"@\" of # maps is ignored";
    TextureMissing [Loss]: "the texture \"@\" was not found";
    TextureUnmapped [Joined, Loss]:
        "the texture @ is not shown: its faces have no texture coordinates",
        "the textures of # materials (the first: @) are not shown: their faces have no texture \
         coordinates";
    TextureMany:
        "a texture is ignored: at most 10,000 different ones are read",
        "# textures are ignored: at most 10,000 different ones are read";
    TextureUnreadable [Loss]: "the texture cannot be read: @";
    TexturePointer [Joined, Loss]:
        "the texture \"@\" is a Git LFS pointer without its content: run \"git lfs pull\"",
        "# textures (the first: \"@\") are Git LFS pointers without their content: run \"git lfs \
         pull\"";
    TextureCutOff [Loss]:
        "the texture is cut off: @ ends early, and the rest of the picture is grey";
    ModelMissing [Loss]: "the model \"@\" was not found: a box is shown instead";
    ModelUnreadable [Loss]: "a model cannot be read and is shown as a box: @";
    SelectionMissing: "the view selects @, which is not in the scene: the first one is selected";
    OwnerMissing: "@, which is not in the scene";
    SettingFormer [Joined]:
        "the setting \"@\" no longer exists; the default is used",
        "# settings (the first: \"@\") no longer exist; the defaults are used";
}

/// The most characters of a name that are shown.
const LONGEST_NAME: usize = 200;

impl FindingKind {
    /// Returns whether cases with different names are joined into one finding.
    pub(super) fn joins_names(self) -> bool {
        self.marks().contains(&Mark::Joined)
    }

    /// Returns whether the model loses something that its file defines.
    pub fn is_loss(self) -> bool {
        self.marks().contains(&Mark::Loss)
    }

    pub(super) fn text(self, count: usize, name: &str, line: Option<u32>, files: usize) -> String {
        let words = self.words();
        let words = if count == 1 { words.first() } else { words.last() };
        let words = words.copied().unwrap_or_default();
        let name = match name.char_indices().nth(LONGEST_NAME) {
            Some((end, _)) => &format!("{}...", &name[..end]),
            None => name,
        };
        // Names come from files, so control characters must not reach a terminal.
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
