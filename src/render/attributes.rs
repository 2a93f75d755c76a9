//! From the place in a triangle to place, normal and light.

use fearless_simd::Level;
use glam::{DMat3, DVec3};

use super::effects::{Batch, Light, load, store};
use super::gather::Gathered;
use super::plan::{Back, Draw, Eye, FramePlan};
use super::real::{Kernel, Machine, Triple};

/// Place, normal and direction to the observer of every pixel.
pub(super) fn attributes<T: Light>(
    level: Level,
    plan: &FramePlan,
    draw: &Draw,
    rows: &Gathered<T>,
    batch: &mut Batch<T>,
) {
    let back = draw.back == Back::Lit;
    let rays = Rays::new(plan);
    T::run(level, Attributes { rows, batch, normals: draw.view_from_normal, rays, back });
}

/// From a pixel to the way on which its surface lies: x = (column a + b), y = (row c + d), each times
/// w in perspective, where -w is z.
#[derive(Clone, Copy, Debug)]
struct Rays {
    parallel: bool,
    x: [f64; 2],
    y: [f64; 2],
}

impl Rays {
    #[expect(clippy::cast_precision_loss, reason = "pictures have fewer than 2^53 pixels a side")]
    fn new(plan: &FramePlan) -> Self {
        let (px, py) = (plan.clip_from_view.x_axis.x, plan.clip_from_view.y_axis.y);
        let (width, height) = (plan.size.width as f64, plan.size.height as f64);
        Self {
            parallel: plan.eye == Eye::Parallel,
            x: [2.0 / width / px, -1.0 / px],
            y: [-2.0 / height / py, 1.0 / py],
        }
    }
}

struct Attributes<'a, T> {
    rows: &'a Gathered<T>,
    batch: &'a mut Batch<T>,
    normals: DMat3,
    rays: Rays,
    back: bool,
}

impl<T: Light> Kernel<T> for Attributes<'_, T> {
    #[inline(always)]
    fn run<M: Machine<Number = T>>(self, machine: M) {
        let Self { rows, batch, normals, rays, back } = self;
        let zero = machine.lift(0.0);
        let lift = |v: DVec3| Triple::lift(zero, [v.x, v.y, v.z]);
        let (nx, ny, nz) = (lift(normals.x_axis), lift(normals.y_axis), lift(normals.z_axis));
        for at in (0..rows.len).step_by(M::LANES) {
            let second = machine.load(&rows.weights[0], at);
            let third = machine.load(&rows.weights[1], at);
            let [x0, y0, z0, _] = machine.load_four(&rows.corners[0], at);
            let [x1, y1, z1, _] = machine.load_four(&rows.corners[1], at);
            let [x2, y2, z2, _] = machine.load_four(&rows.corners[2], at);
            let (n0, n1, n2) = (Triple([x0, y0, z0]), Triple([x1, y1, z1]), Triple([x2, y2, z2]));
            let n = n0.plus(n1.minus(n0).times(second)).plus(n2.minus(n0).times(third));
            let n = nx.times(n.0[0]).plus(ny.times(n.0[1])).plus(nz.times(n.0[2])).unit();
            store(machine, n, &mut batch.normal, at);

            let x = machine.load(&rows.pixel[0], at) * machine.lift(rays.x[0])
                + machine.lift(rays.x[1]);
            let y = machine.load(&rows.pixel[1], at) * machine.lift(rays.y[0])
                + machine.lift(rays.y[1]);
            if rays.parallel {
                let Triple([z0, z1, z2]) = load(machine, &rows.z, at);
                let z = z0 + (z1 - z0) * second + (z2 - z0) * third;
                store(machine, Triple([x, y, z]), &mut batch.position, at);
                let to_eye = Triple::lift(z, [0.0, 0.0, 1.0]);
                store(machine, to_eye, &mut batch.to_eye, at);
            } else {
                let w = machine.load(&rows.w, at);
                let one = machine.lift(1.0);
                store(machine, Triple([x * w, y * w, -w]), &mut batch.position, at);
                store(machine, Triple([-x, -y, one]).unit(), &mut batch.to_eye, at);
            }
        }
        if back {
            turn_backs(rows, batch);
        }
    }
}

/// A back that is lit has its normal turned.
#[inline(always)]
fn turn_backs<T: Light>(rows: &Gathered<T>, batch: &mut Batch<T>) {
    for i in (0..rows.len).filter(|i| rows.back[*i]) {
        for row in &mut batch.normal {
            row[i] = -row[i];
        }
    }
}

/// Light of the corners mixed at every pixel.
pub(super) fn mix<T: Light>(level: Level, rows: &Gathered<T>, batch: &mut Batch<T>) {
    T::run(level, Mix { rows, batch });
}

struct Mix<'a, T> {
    rows: &'a Gathered<T>,
    batch: &'a mut Batch<T>,
}

impl<T: Light> Kernel<T> for Mix<'_, T> {
    #[inline(always)]
    fn run<M: Machine<Number = T>>(self, machine: M) {
        let Self { rows, batch } = self;
        for at in (0..rows.len).step_by(M::LANES) {
            let second = machine.load(&rows.weights[0], at);
            let third = machine.load(&rows.weights[1], at);
            for (kind, to) in [&mut batch.diffuse, &mut batch.specular].into_iter().enumerate() {
                let [r0, g0, b0, _] = machine.load_four(&rows.light[0][kind], at);
                let [r1, g1, b1, _] = machine.load_four(&rows.light[1][kind], at);
                let [r2, g2, b2, _] = machine.load_four(&rows.light[2][kind], at);
                let (a, b, c) = (Triple([r0, g0, b0]), Triple([r1, g1, b1]), Triple([r2, g2, b2]));
                let mixed = a.plus(b.minus(a).times(second)).plus(c.minus(a).times(third));
                store(machine, mixed, to, at);
            }
        }
    }
}
