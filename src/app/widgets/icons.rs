//! Small pictures, drawn with lines: the fonts have no arrows, ticks or symbols that can be relied
//! on.
//!
//! Each is drawn in a square from (-1, -1) at the upper left to (1, 1).

use std::f32::consts::TAU;

use egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, Vec2, vec2};

use crate::scene::{ItemId, Light, LightKind, Scene};

/// A small picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Icon {
    /// A cube: an object.
    Object,
    /// A part of an object.
    Part,
    /// A film camera.
    Camera,
    /// Light from everywhere.
    Ambient,
    /// A disk with rays.
    Sun,
    /// The diamond that marks a bulb.
    Bulb,
    /// A cone of light.
    Spot,
    /// An open eye: it is shown.
    Eye,
    /// A closed eye: it is hidden.
    EyeClosed,
    /// A full disk in a ring: it shines.
    On,
    /// An empty ring: it is out.
    Off,
    /// Add.
    Plus,
    /// Two sheets: duplicate.
    Copy,
    /// A pen: rename.
    Pen,
    /// A bin: delete.
    Bin,
    /// Up the list.
    Up,
    /// Down the list.
    Down,
    /// Closed: there is more to the right.
    Right,
    /// Yes.
    Tick,
    /// An exclamation mark in a triangle.
    Warning,
}

impl Icon {
    /// The picture of an item.
    pub(crate) fn of(scene: &Scene, id: ItemId) -> Self {
        match id {
            ItemId::Object(_) => Self::Object,
            ItemId::Camera(_) => Self::Camera,
            ItemId::Light(id) => scene.lights.get(id).map_or(Self::Bulb, Self::of_light),
        }
    }

    /// The picture of a light of this kind.
    pub(crate) const fn of_light(light: &Light) -> Self {
        match light.kind {
            LightKind::Ambient => Self::Ambient,
            LightKind::Sun { .. } => Self::Sun,
            LightKind::Bulb { .. } => Self::Bulb,
            LightKind::Spot { .. } => Self::Spot,
        }
    }

    /// Draws it in the middle of `rect`, `side` points wide.
    pub(crate) fn paint(self, painter: &Painter, rect: Rect, side: f32, color: Color32) {
        let pen = Pen {
            painter,
            centre: rect.center(),
            half: side / 2.0,
            stroke: Stroke::new(1.3, color),
        };
        self.draw(&pen);
    }

    fn draw(self, pen: &Pen<'_>) {
        match self {
            Self::Object => cube(pen),
            Self::Part => pen.closed(&[(-0.6, 0.5), (0.6, 0.5), (0.0, -0.6)]),
            Self::Camera => {
                pen.closed(&[(-1.0, -0.35), (0.3, -0.35), (0.3, 0.75), (-1.0, 0.75)]);
                pen.line(&[(0.3, 0.05), (1.0, -0.3), (1.0, 0.7), (0.3, 0.35)]);
                pen.circle((-0.35, -0.75), 0.3);
            }
            Self::Ambient => {
                pen.circle((0.0, 0.0), 0.9);
                pen.dot((0.0, 0.0), 0.35);
            }
            Self::Sun => {
                pen.circle((0.0, 0.0), 0.42);
                pen.rays(8, 0.7, 1.0);
            }
            Self::Bulb => {
                pen.closed(&[(0.0, -0.9), (0.75, 0.0), (0.0, 0.9), (-0.75, 0.0)]);
                pen.dot((0.0, 0.0), 0.3);
            }
            Self::Spot => {
                pen.line(&[(-0.9, 0.9), (0.0, -0.8), (0.9, 0.9)]);
                pen.line(&[(-0.7, 0.95), (0.7, 0.95)]);
                pen.dot((0.0, -0.8), 0.25);
            }
            Self::Eye | Self::EyeClosed => eye(pen, self == Self::Eye),
            Self::On => {
                pen.circle((0.0, 0.0), 0.8);
                pen.dot((0.0, 0.0), 0.45);
            }
            Self::Off => pen.circle((0.0, 0.0), 0.8),
            Self::Plus => {
                pen.line(&[(-0.8, 0.0), (0.8, 0.0)]);
                pen.line(&[(0.0, -0.8), (0.0, 0.8)]);
            }
            Self::Copy => {
                pen.closed(&[(-0.3, -0.3), (0.9, -0.3), (0.9, 0.9), (-0.3, 0.9)]);
                pen.line(&[(-0.6, 0.4), (-0.9, 0.4), (-0.9, -0.9), (0.4, -0.9), (0.4, -0.6)]);
            }
            Self::Pen => {
                pen.closed(&[(-0.9, 0.9), (-0.75, 0.3), (0.45, -0.9), (0.9, -0.45), (-0.3, 0.75)]);
            }
            Self::Bin => bin(pen),
            Self::Up => pen.line(&[(-0.7, 0.35), (0.0, -0.35), (0.7, 0.35)]),
            Self::Down => pen.line(&[(-0.7, -0.35), (0.0, 0.35), (0.7, -0.35)]),
            Self::Right => pen.line(&[(-0.35, -0.7), (0.35, 0.0), (-0.35, 0.7)]),
            Self::Tick => pen.thick(&[(-0.75, 0.0), (-0.2, 0.55), (0.8, -0.6)]),
            Self::Warning => {
                pen.closed(&[(0.0, -0.85), (0.95, 0.8), (-0.95, 0.8)]);
                pen.line(&[(0.0, -0.25), (0.0, 0.25)]);
                pen.dot((0.0, 0.52), 0.1);
            }
        }
    }
}

fn cube(pen: &Pen<'_>) {
    let (top, right, low) = ((0.0, -0.95), (0.85, -0.45), (0.0, 0.05));
    pen.closed(&[top, right, (0.85, 0.5), (0.0, 1.0), (-0.85, 0.5), (-0.85, -0.45)]);
    pen.line(&[(-0.85, -0.45), low, right]);
    pen.line(&[low, (0.0, 1.0)]);
}

fn eye(pen: &Pen<'_>, open: bool) {
    // An almond: two arcs of a circle about (0, 0.9) and its mirror image.
    let arc = |sign: f32| -> Vec<(f32, f32)> {
        let point = |i: u8| {
            let x = f32::from(i) / 5.0 - 1.0;
            (x, sign * 0.62 * (1.0 - x * x))
        };
        (0..=10).map(point).collect()
    };
    pen.line(&arc(1.0));
    if open {
        pen.line(&arc(-1.0));
        pen.dot((0.0, 0.0), 0.32);
    } else {
        pen.line(&[(0.0, 0.62), (0.0, 0.95)]);
        pen.line(&[(-0.6, 0.4), (-0.8, 0.75)]);
        pen.line(&[(0.6, 0.4), (0.8, 0.75)]);
    }
}

fn bin(pen: &Pen<'_>) {
    pen.line(&[(-0.85, -0.6), (0.85, -0.6)]);
    pen.line(&[(-0.3, -0.6), (-0.3, -0.95), (0.3, -0.95), (0.3, -0.6)]);
    pen.line(&[(-0.65, -0.6), (-0.5, 0.95), (0.5, 0.95), (0.65, -0.6)]);
    pen.line(&[(-0.2, -0.2), (-0.15, 0.55)]);
    pen.line(&[(0.2, -0.2), (0.15, 0.55)]);
}

struct Pen<'a> {
    painter: &'a Painter,
    centre: Pos2,
    half: f32,
    stroke: Stroke,
}

impl Pen<'_> {
    fn at(&self, (x, y): (f32, f32)) -> Pos2 {
        self.centre + vec2(x, y) * self.half
    }

    fn points(&self, places: &[(f32, f32)]) -> Vec<Pos2> {
        places.iter().map(|place| self.at(*place)).collect()
    }

    fn line(&self, places: &[(f32, f32)]) {
        self.painter.add(Shape::line(self.points(places), self.stroke));
    }

    fn thick(&self, places: &[(f32, f32)]) {
        let stroke = Stroke::new(1.8, self.stroke.color);
        self.painter.add(Shape::line(self.points(places), stroke));
    }

    fn closed(&self, places: &[(f32, f32)]) {
        self.painter.add(Shape::closed_line(self.points(places), self.stroke));
    }

    fn circle(&self, centre: (f32, f32), radius: f32) {
        self.painter.circle_stroke(self.at(centre), radius * self.half, self.stroke);
    }

    fn dot(&self, centre: (f32, f32), radius: f32) {
        self.painter.circle_filled(self.at(centre), radius * self.half, self.stroke.color);
    }

    fn rays(&self, count: u8, from: f32, to: f32) {
        for i in 0..count {
            let way = Vec2::angled(TAU * f32::from(i) / f32::from(count)) * self.half;
            self.painter
                .line_segment([self.centre + way * from, self.centre + way * to], self.stroke);
        }
    }
}
