//! The table of hard cases by number, and a test that each one is tested.

use crate::claims::{Proof, Tally};

/// A hard case.
pub(crate) struct Case {
    pub(crate) number: u8,
    pub(crate) group: &'static str,
    /// The kind of oracle. Z: integers or fractions. D: double-double, or f64 along another path.
    /// I: an invariant. R: two runs that must agree.
    pub(crate) oracle: &'static str,
    /// The failure of a naive program.
    pub(crate) wrong: &'static str,
}

const fn case(number: u8, group: &'static str, oracle: &'static str, wrong: &'static str) -> Case {
    Case { number, group, oracle, wrong }
}

const GEOMETRY: &str = "Geometry";
const CLIPPING: &str = "Clipping";
const COVERAGE: &str = "Coverage";
const DEPTH: &str = "Depth";
const INTERPOLATION: &str = "Interpolation";
const LIGHT: &str = "Light";
const COLOUR: &str = "Colour";
const CAMERA: &str = "Camera";
const SHADOWS: &str = "Shadows";
const UNDO: &str = "Undo";
const SURFACES: &str = "Surfaces";
const FILES: &str = "Files and scale";
const TRANSPARENCY: &str = "Transparency";

/// Runs the quick round of a claim; `cargo test --test proofs` checks any number of cases.
#[track_caller]
pub(crate) fn quick_round(name: &str) -> Tally {
    let proof = Proof::named(name).unwrap();
    match proof.run(0..proof.batches(proof.quick), &|_| {}) {
        Ok(tally) => tally,
        Err(counterexample) => panic!("{}: {counterexample}", proof.claim),
    }
}

/// The cases, by number.
#[rustfmt::skip]
pub(crate) static CASES: &[Case] = &[
    case(1, GEOMETRY, "D", "the normal of a small face far from the origin is noise"),
    case(2, GEOMETRY, "Z", "a b - c d loses all its digits, and its sign"),
    case(3, GEOMETRY, "D", "what is far from the origin trembles on the screen"),
    case(4, GEOMETRY, "D", "normals of a stretched object lean over"),
    case(5, GEOMETRY, "I", "an object made smaller often enough is lost for good"),
    case(6, GEOMETRY, "R", "a mirrored object is inside out, or lit from the wrong side"),
    case(7, GEOMETRY, "I", "a flat object has no inverse: NaNs spread from it"),
    case(8, GEOMETRY, "D", "the length of a long vector is infinite, of a short one 0"),
    case(9, GEOMETRY, "I", "a face without area is drawn, or divides by its area"),
    case(10, GEOMETRY, "I", "normals that cancel out have no direction"),
    case(11, CLIPPING, "I", "a corner in the observer's plane divides by 0"),
    case(12, CLIPPING, "Z", "a line through the observer's plane comes out on the other side"),
    case(13, CLIPPING, "R", "two faces cut at a plane part along the edge that they share"),
    case(14, CLIPPING, "Z", "a corner on a plane is cut off, or cut twice"),
    case(15, CLIPPING, "Z", "what reaches beyond all six planes folds over"),
    case(16, CLIPPING, "Z", "corners a million pixels off overflow, or lose their last bits"),
    case(17, CLIPPING, "Z", "edge functions of 32 bits overflow in large triangles"),
    case(18, CLIPPING, "I", "what is behind the observer is drawn upside down"),
    case(19, CLIPPING, "D", "colours and textures jump where a face was cut"),
    case(20, COVERAGE, "Z", "centres on an edge are taken twice, or not at all"),
    case(21, COVERAGE, "Z", "fans have cracks, and pixels that are drawn twice"),
    case(22, COVERAGE, "Z", "snapping turns slivers round, and unsigned counts go wrong"),
    case(23, COVERAGE, "I", "a closed body is open at its outline"),
    case(24, COVERAGE, "I", "an edge that another face's corner splits leaks, without a warning"),
    case(25, COVERAGE, "R", "a picture changes when it is moved by whole pixels"),
    case(26, COVERAGE, "R", "left and right, or rows and columns, are not treated alike"),
    case(27, COVERAGE, "R", "threads, tiles and instructions show in the picture"),
    case(28, COVERAGE, "Z", "corners snapped too coarsely cover the wrong pixels"),
    case(29, COVERAGE, "Z", "points set every 0.1 unit leave holes near by and are wasted far off"),
    case(30, DEPTH, "Z", "what is a little nearer, a kilometre off, is not in front"),
    case(31, DEPTH, "Z", "surfaces a thousandth apart flicker"),
    case(32, DEPTH, "R", "which of two equal surfaces is seen depends on how they were cut up"),
    case(33, DEPTH, "Z", "the plane equation of a sliver gives depths from far away"),
    case(34, DEPTH, "D", "the line where two faces meet is ragged"),
    case(35, DEPTH, "I", "16 bits of depth in parallel projection merge what lies close"),
    case(36, DEPTH, "R", "the order of drawing shows among equal depths"),
    case(37, INTERPOLATION, "D", "a texture swims on a wall that runs away from the observer"),
    case(38, INTERPOLATION, "I", "colours beyond those of the corners"),
    case(39, INTERPOLATION, "I", "places on the texture beyond it read past its end"),
    case(40, INTERPOLATION, "I", "one colour at all corners comes out as another"),
    case(41, INTERPOLATION, "Z", "nothing says along which diagonal a quad is cut"),
    case(42, LIGHT, "D", "a reciprocal root of 12 bits spoils highlights"),
    case(43, LIGHT, "I", "a unit vector's product with itself is above 1, and acos gives NaN"),
    case(44, LIGHT, "D", "acos of almost 1 has lost the angle"),
    case(45, LIGHT, "I", "a negative number to a broken power is none; 0 to 0 is anything"),
    case(46, LIGHT, "I", "subnormal powers cost four times the time and show nothing"),
    case(47, LIGHT, "R", "a lamp on a surface divides by its distance, 0"),
    case(48, LIGHT, "I", "a lamp behind a surface gives it a highlight"),
    case(49, LIGHT, "I", "the border of a cone flickers; cones of 0 and 90 degrees are special"),
    case(50, LIGHT, "R", "the order of lights shows in the last bit"),
    case(51, LIGHT, "I", "light clamped before the texture is too dark"),
    case(52, COLOUR, "Z", "bytes cut off instead of rounded are too dark by half a step"),
    case(53, COLOUR, "Z", "many lights rounded one by one drift from their sum"),
    case(54, COLOUR, "I", "a NaN becomes any byte"),
    case(55, COLOUR, "I", "a byte does not survive the way to a factor and back"),
    case(56, CAMERA, "I", "looking straight down, or at one's own eye, has no up"),
    case(57, CAMERA, "D", "turning again and again shears and shrinks"),
    case(58, CAMERA, "D", "large angles lose their digits"),
    case(59, CAMERA, "I", "an orbit over the pole flips over"),
    case(60, CAMERA, "D", "an orbit drifts away from its centre"),
    case(61, CAMERA, "D", "steps of a tenth do not add up"),
    case(62, UNDO, "Z", "undoing by an inverse comes back to almost where it was"),
    case(63, UNDO, "Z", "what was saved, deleted or dragged is not what comes back"),
    case(64, FILES, "Z", "odd numbers in files are read as 0, or stop the program"),
    case(65, FILES, "Z", "odd faces in files read past the end, or are filled wrongly"),
    case(66, FILES, "R", "a scene in millimetres looks other than one in kilometres"),
    case(67, FILES, "I", "nothing at all, and very much, are not drawn"),
    case(68, SHADOWS, "D", "light leaks in under a cube on the ground, or the ground speckles"),
    case(69, SHADOWS, "I", "rays pass through the edges and corners of a closed body"),
    case(70, SHADOWS, "I", "the surface under a lamp puts everything else in shadow"),
    case(71, SHADOWS, "D", "far from the origin a thin gap has no shadow, or all is shadow"),
    case(72, SHADOWS, "D", "thin leaves shade themselves, or not what lies close below"),
    case(73, SHADOWS, "R", "a mirrored body casts no shadow"),
    case(74, SHADOWS, "I", "a light inside of a closed body shines through it"),
    case(75, SHADOWS, "R", "a bias that suits one unit of length is wrong in another"),
    case(76, SHADOWS, "I", "triangles of one plane shade each other"),
    case(77, SHADOWS, "I", "edges speckle if a pixel has several samples"),
    case(78, SHADOWS, "Z", "a surface in a shadow map shades itself in stripes"),
    case(79, SHADOWS, "Z", "holes that only a map of opacity has let no light through"),
    case(80, TRANSPARENCY, "R", "which of two sheets in one plane is in front depends on the list"),
    case(81, TRANSPARENCY, "D", "sheets that cut through each other are wholly before or behind"),
    case(82, TRANSPARENCY, "I", "opacity 0 leaves a trace, and opacity 1 lets something through"),
    case(83, TRANSPARENCY, "D", "a thousand layers of bytes drift from their sum"),
    case(84, TRANSPARENCY, "R", "the order of the list shows through glass"),
    case(85, TRANSPARENCY, "D", "glass that reaches behind the eye is drawn whole or not at all"),
    case(86, TRANSPARENCY, "D", "a fading texture is cut off at one half"),
    case(87, SHADOWS, "Z", "the edge of night on a smooth ball is a row of triangles"),
    case(90, SURFACES, "D", "bumps on the mirrored half of a model are dents"),
    case(91, SURFACES, "R", "bumps break at a seam of the texture coordinates"),
    case(92, SURFACES, "I", "texture coordinates without area divide by 0: the surface is black"),
    case(93, SURFACES, "R", "bumps of no height change the last bit, or cost time"),
    case(94, SURFACES, "R", "a flat map of normals tilts everything by half a step"),
    case(95, SURFACES, "Z", "what shines by itself is dimmed by light that is not there"),
    case(96, COLOUR, "Z", "black and white do not survive decoding and encoding"),
    case(97, COLOUR, "Z", "the middle between black and white is too dark"),
];

#[test]
fn every_case_has_a_row_and_a_test_with_its_number() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/hard_cases");
    let mut sources = String::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        sources += &std::fs::read_to_string(entry.unwrap().path()).unwrap();
    }
    let mut last = 0;
    for row in CASES {
        let number = row.number;
        assert!(number > last, "case {number} is after case {last}");
        assert!(sources.contains(&format!("fn case_{number}_")), "case {number} has no test");
        last = number;
    }
    let first = CASES.iter().take_while(|row| row.number <= 67).count();
    assert_eq!(first, 67, "one of the first cases is missing");
}
