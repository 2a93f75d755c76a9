//! The kinds of findings, each with its sentence.
//!
//! A file may load with thousands of equal faults, so each kind has a sentence for one case and one
//! for many.

/// Declares the kinds, each with its sentences for one case and for many.
///
/// `#` is the number of cases, `@` the name in the first case.
macro_rules! kinds {
    ($($(#[$doc:meta])* $name:ident: $one:literal, $many:literal;)+) => {
        /// The subject of a [`Finding`](super::Finding).
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
    VertexNotFinite:
        "a vertex is infinite or NaN and is skipped",
        "# vertices are infinite or NaN and are skipped";
    /// A vertex with unreadable numbers.
    VertexUnreadable:
        "a vertex cannot be read (@) and is skipped",
        "# vertices cannot be read (the first: @) and are skipped";
    /// A vertex that no face uses.
    VertexUnused:
        "a vertex is not used by any face and does not affect size and centre",
        "# vertices are not used by any face and do not affect size and centre";
    /// A number in an unusual notation.
    NumberOdd:
        "the number \"@\" is written in an unusual way and is read nevertheless",
        "# statements have numbers that are written in an unusual way (the first: \"@\") and are \
         read nevertheless";
    /// A line that ends in a backslash before a statement.
    NotContinued:
        "a statement \"@\" ends in a backslash, but the next line is a new statement",
        "# statements \"@\" end in a backslash, but the next lines are new statements";
    /// Control characters in a line.
    ControlCharacter:
        "a line has control characters, which are read as blanks",
        "# lines have control characters, which are read as blanks";
    /// A face that refers to a skipped vertex.
    FaceOnLostVertex:
        "a face refers to a skipped vertex and is skipped too",
        "# faces refer to skipped vertices and are skipped too";
    /// A face that refers to a vertex that does not exist.
    FaceRange:
        "a face refers to a vertex that the file does not have and is skipped",
        "# faces refer to vertices that the file does not have and are skipped";
    /// A face of one or two corners.
    FaceShort:
        "a face has fewer than three corners and is skipped",
        "# faces have fewer than three corners and are skipped";
    /// A face with a corner that is not a number.
    FaceUnreadable:
        "a face has a corner that is not a number (\"@\") and is skipped",
        "# faces have corners that are not numbers (such as \"@\") and are skipped";
    /// A smoothing group that is not a number.
    SmoothingUnreadable:
        "a smoothing group is neither a number nor \"off\" (\"@\") and is taken as off",
        "# smoothing groups are neither numbers nor \"off\" (such as \"@\") and are taken as off";
    /// Lines and points, which are not drawn.
    LineOrPoint:
        "a statement \"@\" is skipped: only faces are drawn",
        "# statements \"@\" are skipped: only faces are drawn";
    /// Curves and surfaces that are not polygons.
    FreeForm:
        "a statement of a free-form curve or surface is skipped: only polygons are drawn",
        "# statements of free-form curves and surfaces are skipped: only polygons are drawn";
    /// An unknown statement.
    Unknown: "an unknown statement \"@\" is ignored", "# unknown statements \"@\" are ignored";
    /// A texture coordinate that does not exist.
    UvRange:
        "a face refers to a texture coordinate that the file does not have; its corner has none",
        "# faces refer to texture coordinates that the file does not have; their corners have none";
    /// A normal that does not exist.
    NormalRange:
        "a face refers to a normal that the file does not have; its normals are computed",
        "# faces refer to normals that the file does not have; their normals are computed";
    /// A texture coordinate with one number.
    UvSingle:
        "a texture coordinate has one number; the other is taken as 0",
        "# texture coordinates have one number; the other is taken as 0";
    /// A texture coordinate that is infinite or NaN.
    UvNotFinite:
        "a texture coordinate is infinite or NaN and is ignored",
        "# texture coordinates are infinite or NaN and are ignored";
    /// A normal that is infinite or NaN.
    NormalNotFinite:
        "a normal is infinite or NaN and is ignored",
        "# normals are infinite or NaN and are ignored";
    /// A texture coordinate that cannot be read.
    UvUnreadable:
        "a texture coordinate cannot be read and is ignored",
        "# texture coordinates cannot be read and are ignored";
    /// A normal that cannot be read.
    NormalUnreadable:
        "a normal cannot be read and is ignored",
        "# normals cannot be read and are ignored";
    /// Only some faces have texture coordinates.
    UvMixed:
        "a face has no texture coordinates, while others have",
        "# faces have no texture coordinates, while others have";
    /// Only some faces have normals.
    NormalMixed:
        "a face has no normals, while others have; they are computed",
        "# faces have no normals, while others have; they are computed";
    /// Extra numbers at the end of a statement.
    ExtraNumbers:
        "a vertex has more numbers than x, y, z and a colour; the rest is ignored",
        "# vertices have more numbers than x, y, z and a colour; the rest is ignored";
    /// A weight that is not 1.
    Weight:
        "a vertex has a weight other than 1, which is ignored",
        "# vertices have a weight other than 1, which is ignored";
    /// Colours on only some vertices.
    ColorPartly:
        "a vertex has no colour, while others have: it is white",
        "# vertices have no colour, while others have: they are white";
    /// Colours from 0 to 255.
    ColorBytes:
        "vertex colours exceed 1 and are read as 0 to 255",
        "vertex colours exceed 1 and are read as 0 to 255";
    /// Colours above 1.
    ColorBright:
        "vertex colours exceed 1 and are clamped",
        "vertex colours exceed 1 and are clamped";
    /// Vertex colours in ZBrush's comments.
    ColorComments:
        "a comment #MRGB (vertex colours of ZBrush) is ignored",
        "# comments #MRGB (vertex colours of ZBrush) are ignored";
    /// A face that refers to a vertex twice.
    FaceRepeats: "a face refers to a vertex twice", "# faces refer to a vertex twice";
    /// A face without area.
    FaceNoArea:
        "a face has no area and no normal",
        "# faces have no area and no normals";
    /// A polygon with triangles that extend beyond it.
    PolygonCrosses:
        "a polygon of @ corners crosses itself; its triangles may lie outside it",
        "# polygons (the first of @ corners) cross themselves; their triangles may lie outside \
            them";
    /// Closed bodies that are inside out, all of them.
    InsideOut:
        "the closed body is inside out; --flip-winding turns it",
        "all # closed bodies are inside out; --flip-winding turns them";
    /// Some closed bodies that are inside out.
    InsideOutPartly:
        "a closed body is inside out, while others are not",
        "# closed bodies are inside out, while others are not";
    /// Normals of the file that point against the winding of their face.
    NormalsAgainst:
        "the normals of a face point against its winding; --no-file-normals ignores them",
        "the normals of # faces point against their winding; --no-file-normals ignores them";
    /// A file without faces.
    NoFaces:
        "the file has vertices but no faces: it draws nothing",
        "the file has vertices but no faces: it draws nothing";
    /// A missing MTL file.
    MtlMissing: "the material file \"@\" was not found", "the material file \"@\" was not found";
    /// A missing MTL file, replaced by the one with the model's name.
    MtlRenamed:
        "the material file \"@\" was not found; the one with the model's name is used",
        "the material file \"@\" was not found; the one with the model's name is used";
    /// An MTL file with the model's name, used because the model names materials but no MTL file.
    MtlOfModel:
        "the file names materials but no material file; \"@\" is used",
        "the file names materials but no material file; \"@\" is used";
    /// An MTL file with the model's name, not used because the model names no materials.
    MtlUnnamed:
        "the file names no materials; the material file \"@\" is not used",
        "the file names no materials; the material file \"@\" is not used";
    /// A picture with the model's name that no file refers to.
    PictureUnnamed:
        "the file names no material file; the picture \"@\" is not used",
        "the file names no material file; the picture \"@\" is not used";
    /// Materials that no `usemtl` uses.
    MaterialsUnused:
        "no face names a material: the one in the material file is not used",
        "no face names a material: the # in the material files are not used";
    /// More MTL files than the limit.
    MtlMany:
        "a statement \"mtllib\" is ignored: at most 1000 different ones are read",
        "# statements \"mtllib\" are ignored: at most 1000 different ones are read";
    /// An MTL file that cannot be read.
    MtlUnreadable: "the material file cannot be read: @", "the material file cannot be read: @";
    /// A `usemtl` with a name that is not defined.
    MaterialUnknown:
        "the material \"@\" is not defined: silver is used",
        "the material \"@\" is not defined: silver is used";
    /// Two materials with the same name.
    MaterialTwice:
        "the material \"@\" is defined twice: the first is used",
        "the material \"@\" is defined # times more: the first is used";
    /// A statement before any `newmtl`.
    MtlStray:
        "a statement \"@\" comes before any newmtl and is ignored",
        "# statements (the first: \"@\") come before any newmtl and are ignored";
    /// A number of a material that cannot be read.
    MtlNumber:
        "a statement \"@\" has a number that cannot be read and is ignored",
        "# statements (the first: \"@\") have numbers that cannot be read and are ignored";
    /// Ka is set to 0.2 Kd.
    MendedAmbient:
        "material \"@\": Ka is missing, white, above 1 or equal to Kd, and is taken as 0.2 Kd",
        "# materials: Ka is missing, white, above 1 or equal to Kd, and is taken as 0.2 Kd";
    /// Kd is set to 0.8, or to 1 with a texture.
    MendedDiffuse:
        "material \"@\": Kd is missing and is taken as 0.8, or 1 with a texture",
        "# materials: Kd is missing and is taken as 0.8, or 1 with a texture";
    /// Ks is set to 0.
    MendedSpecular:
        "material \"@\": Ks is missing or switched off by illum, and is taken as 0",
        "# materials: Ks is missing or switched off by illum, and is taken as 0";
    /// Ns is set to 1.
    MendedExponent:
        "material \"@\": Ns is below 1 and is taken as 1",
        "# materials: Ns is below 1 and is taken as 1";
    /// The highlight is removed.
    MendedMatt:
        "material \"@\": Ns is missing or 0: the surface is matt, without the highlight of Ks",
        "# materials: Ns is missing or 0: the surfaces are matt, without the highlights of Ks";
    /// Colours from 0 to 255.
    MendedBytes:
        "the colours of materials are whole numbers above 16 and are read as 0 to 255",
        "the colours of materials are whole numbers above 16 and are read as 0 to 255";
    /// Kd is 0 with a texture.
    DiffuseBlack:
        "material \"@\": Kd 0 makes its texture black",
        "# materials: Kd 0 makes their textures black";
    /// A bump map that contains normals.
    BumpIsNormals:
        "the bump map \"@\" shows normals and is read as a normal map; --bump-maps heights reads \
         it as heights",
        "the bump map \"@\" shows normals and is read as a normal map; --bump-maps heights reads \
         it as heights";
    /// Ke is set to 1 with a map.
    MendedEmission:
        "material \"@\": map_Ke without Ke; Ke is taken as 1",
        "# materials: map_Ke without Ke; Ke is taken as 1";
    /// Ks is set to 1 with a map.
    MendedMapped:
        "material \"@\": map_Ks without Ks; Ks is taken as 1",
        "# materials: map_Ks without Ks; Ks is taken as 1";
    /// `bsdf pbr`: a highlight from roughness and metalness.
    MendedPacked:
        "material \"@\": with bsdf pbr, Ks is taken as occlusion, roughness and metalness",
        "# materials: with bsdf pbr, Ks is taken as occlusion, roughness and metalness";
    /// An unsupported illumination model.
    Illumination:
        "material \"@\": illum is not 0, 1 or 2: it is drawn as 2, without mirrors and refraction",
        "# materials: illum is not 0, 1 or 2: it is drawn as 2, without mirrors and refraction";
    /// A colour or an opacity outside 0 to 1.
    MendedRange:
        "material \"@\": a value is outside 0 to 1 and is clamped",
        "# values of materials are outside 0 to 1 and are clamped";
    /// `Tr 1` in all used materials.
    MendedTransparency:
        "material \"@\": Tr 1, which would hide the whole model, is taken as opaque",
        "# materials: Tr 1, which would hide the whole model, is taken as opaque";
    /// A `d` of 0.
    Transparent:
        "material \"@\" is wholly transparent and draws nothing",
        "# materials are wholly transparent and draw nothing";
    /// A map of an unsupported kind.
    MapUnused:
        "a statement \"@\" is ignored: maps of this kind are not drawn",
        "# statements \"@\" are ignored: maps of this kind are not drawn";
    /// An unsupported option of a map.
    MapOption:
        "the option \"@\" of a map is ignored",
        "the option \"@\" of # maps is ignored";
    /// A missing texture.
    TextureMissing: "the texture \"@\" was not found", "the texture \"@\" was not found";
    /// A texture on faces without texture coordinates.
    TextureUnmapped:
        "the texture @ is not shown: its faces have no texture coordinates",
        "the texture @ is not shown: its faces have no texture coordinates";
    /// More textures than the limit.
    TextureMany:
        "a texture is ignored: at most 10,000 different ones are read",
        "# textures are ignored: at most 10,000 different ones are read";
    /// A texture that cannot be read.
    TextureUnreadable: "the texture cannot be read: @", "the texture cannot be read: @";
    /// A truncated texture file.
    TextureCutOff:
        "the texture is cut off: @ ends early, and the rest of the picture is grey",
        "the texture is cut off: @ ends early, and the rest of the picture is grey";
    /// A missing model of a scene.
    ModelMissing:
        "the model \"@\" was not found: a box is shown instead",
        "the model \"@\" was not found: a box is shown instead";
    /// A model of a scene that cannot be read.
    ModelUnreadable:
        "a model cannot be read and is shown as a box: @",
        "a model cannot be read and is shown as a box: @";
    /// A selection of an item that the scene does not have.
    SelectionMissing:
        "the view selects @, which is not in the scene: the first one is selected",
        "the view selects @, which is not in the scene: the first one is selected";
    /// A spot or a camera attached to an item that the scene does not have.
    OwnerMissing: "@, which is not in the scene", "@, which is not in the scene";
}

/// The most characters of a name that are shown.
const LONGEST_NAME: usize = 200;

impl FindingKind {
    /// Returns whether cases with different names are joined into one finding.
    pub(super) const fn joins_names(self) -> bool {
        matches!(
            self,
            Self::FaceUnreadable
                | Self::VertexUnreadable
                | Self::NumberOdd
                | Self::SmoothingUnreadable
                | Self::PolygonCrosses
                | Self::MtlStray
                | Self::MtlNumber
                | Self::MendedAmbient
                | Self::MendedDiffuse
                | Self::MendedSpecular
                | Self::MendedExponent
                | Self::MendedMatt
                | Self::DiffuseBlack
                | Self::MendedRange
                | Self::MendedEmission
                | Self::MendedMapped
                | Self::MendedPacked
                | Self::Illumination
                | Self::MendedTransparency
                | Self::Transparent
        )
    }

    /// Returns whether the model loses something that its file defines.
    #[must_use]
    pub const fn is_loss(self) -> bool {
        matches!(
            self,
            Self::VertexNotFinite
                | Self::VertexUnreadable
                | Self::UvUnreadable
                | Self::FaceRange
                | Self::FaceUnreadable
                | Self::NoFaces
                | Self::InsideOut
                | Self::NormalsAgainst
                | Self::MaterialsUnused
                | Self::DiffuseBlack
                | Self::MtlMissing
                | Self::MtlUnreadable
                | Self::Transparent
                | Self::TextureMissing
                | Self::TextureUnreadable
                | Self::TextureCutOff
                | Self::TextureUnmapped
                | Self::ModelMissing
                | Self::ModelUnreadable
        )
    }

    pub(super) fn text(self, count: usize, name: &str, line: Option<u32>, files: usize) -> String {
        let [one, many] = self.words();
        let words = if count == 1 { one } else { many };
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
