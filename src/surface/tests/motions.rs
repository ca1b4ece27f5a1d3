//! Rows against motions that both sides share, and against differences of gaps and slips.

use super::*;
use crate::linalg::random::scattered;
use crate::surface::vector::{cross, dot, largest, length, plus, times, ZERO};
use crate::surface::{Meeting, Opposite, Rows, Shape, Slave};

/// Nodes above, in and below a bumpy surface, some of them on its edges and nodes.
fn slave_of(master: &Mesh, shape: Shape, gap: f64) -> Mesh {
    let mut slave = random_mesh(shape, if shape.dim() == 2 { 20 } else { 5 }, 0.2);
    let up = shape.dim() - 1;
    slave.x.iter_mut().for_each(|x| x[up] += gap);
    let inner: Vec<usize> = (0..master.x.len()).filter(|&k| !master.faces.is_on_rim(k as u32)).collect();
    for (k, node) in inner.iter().take(7).enumerate() {
        let at = plus(
            master.x[*node],
            [0.0, 1e-11, 1e-3, 0.1][k % 4],
            [0.3, 0.4, if shape.dim() == 2 { 0.0 } else { 0.5 }],
        );
        slave.x[2 * k + 1] = at;
    }
    slave
}

/// The slave nodes all take part, whichever way their normals point.
fn all_found(slave: &Mesh, master: &Mesh) -> Vec<Option<Partner>> {
    found(slave, master, Rule { cosine: 2.0, ..rule(0.6) }, 1, &mut vec![NONE; slave.x.len()]).unwrap()
}

/// Openings along which a pair has rows.
pub fn used(dim: usize) -> impl Iterator<Item = usize> {
    (0..3).filter(move |i| dim == 3 || *i != 1)
}

/// The change of opening i in motions of slave and master.
pub fn product(
    rows: &Rows,
    i: usize,
    slave: impl Fn(usize) -> Vector,
    master: impl Fn(usize) -> Vector,
) -> f64 {
    let of_slave = rows.slave.iter().map(|(node, of)| dot(of[i], slave(*node as usize)));
    of_slave.chain(rows.master.iter().map(|(node, of)| dot(of[i], master(*node as usize)))).sum()
}

pub fn norm(rows: &Rows, i: usize) -> f64 {
    rows.slave.iter().chain(&rows.master).map(|(_, of)| dot(of[i], of[i])).sum::<f64>().sqrt()
}

fn alone(partner: &Partner) -> Meeting {
    Meeting::Feet(vec![Some(*partner)])
}

struct Case {
    slave: Mesh,
    master: Mesh,
    normals: Vec<Vector>,
}

fn case(shape: Shape, gap: f64, bumps: f64) -> Case {
    let master = random_mesh(shape, 4, bumps);
    let (slave, normals) = (slave_of(&master, shape, gap), master.faces.normals(&master.x).unwrap());
    Case { slave, master, normals }
}

impl Case {
    fn each(&self, mut see: impl FnMut(usize, &Partner, [Rows; 2], bool)) -> usize {
        let Self { slave, master, normals } = self;
        let placed = Placed { faces: &master.faces, x: &master.x, normals };
        let (of_slave, opposite) =
            (Slave { faces: &slave.faces, x: &slave.x, begin: &slave.x }, Opposite::Faces(placed, &master.x));
        let mut on_edges = 0;
        for (k, partner) in all_found(slave, master).iter().enumerate() {
            let Some(partner) = partner else { continue };
            let meeting = alone(partner);
            let rows = meeting.rows(&of_slave, &opposite, 0, k as u32).unwrap();
            let rows = [rows, meeting.tie(&of_slave, &opposite, 0, k as u32).unwrap()];
            let is_inside = matches!(partner, Partner::Face(foot) if foot.is_inside);
            on_edges += usize::from(!is_inside);
            see(k, partner, rows, is_inside);
        }
        on_edges
    }
}

#[test]
fn rows_do_no_work_in_a_motion_that_both_sides_share() {
    for (shape, gap) in
        Shape::ALL.into_iter().flat_map(|shape| [0.0, 0.05, 0.5, -0.2].map(|gap| (shape, gap)))
    {
        let case = case(shape, gap, 0.4);
        let flat = shape.dim() == 2;
        let spins = if flat {
            vec![[0.0, 0.0, 1.0]]
        } else {
            vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, -0.5, 0.8]]
        };
        let ways = if flat {
            vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
        } else {
            vec![[0.3, 0.4, 0.5], [0.9, -0.2, 0.1]]
        };
        let motions =
            spins.into_iter().map(|spin| (spin, ZERO)).chain(ways.into_iter().map(|way| (ZERO, way)));
        let motions: Vec<_> = motions.collect();
        let mut seen = 0;
        let on_edges = case.each(|k, partner, rows, _| {
            let all = rows.iter().flat_map(|rows| used(shape.dim()).map(move |i| (rows, i)));
            for ((rows, i), (spin, way)) in all.flat_map(|of| motions.iter().map(move |motion| (of, motion)))
            {
                let u = |x: Vector| plus(cross(*spin, x), 1.0, *way);
                let work = product(rows, i, |_| u(case.slave.x[k]), |node| u(case.master.x[node]));
                assert!(work.abs() <= 1e-13 * norm(rows, i), "{shape:?} {gap}: {work:e} {partner:?}");
            }
            seen += 2 * shape.dim();
        });
        assert!(seen > 40 && (gap == -0.2 || on_edges > 0), "{shape:?} {gap}: {seen} {on_edges}");
    }
}

/// At fixed material points: those of the foot do not move on the face.
#[test]
fn rows_are_the_gradients_of_gap_slip_and_opening() {
    const H: f64 = 1e-5;
    for (shape, gap) in Shape::ALL.into_iter().flat_map(|shape| [0.05, 0.3].map(|gap| (shape, gap))) {
        let Case { slave, master, normals } = case(shape, gap, 0.2);
        let dim = shape.dim();
        let random = scattered(3 * (slave.x.len() + master.x.len()));
        let way: Vec<Vector> =
            random.chunks(3).map(|w| [w[0], w[1], if dim == 2 { 0.0 } else { w[2] }]).collect();
        let (of_slave, of_master) = way.split_at(slave.x.len());
        let moved = |x: &[Vector], u: &[Vector], h: f64| -> Vec<Vector> {
            x.iter().zip(u).map(|(x, u)| plus(*x, h, *u)).collect()
        };
        let at = [H, -H].map(|h| (moved(&slave.x, of_slave, h), moved(&master.x, of_master, h)));
        for (k, partner) in all_found(&slave, &master).iter().enumerate() {
            let Some(partner @ Partner::Face(foot)) = partner else { continue };
            let node = k as u32;
            let placed = Placed { faces: &master.faces, x: &master.x, normals: &normals };
            let with = |begin: usize| {
                let (x, y) = &at[begin];
                let of = Slave { faces: &slave.faces, x: &slave.x, begin: x };
                alone(partner).rows(&of, &Opposite::Faces(placed, y), 0, node).unwrap()
            };
            let opened = |which: usize| {
                let (x, y) = &at[which];
                let placed = Placed { x: y, ..placed };
                let of = Slave { faces: &slave.faces, x, begin: x };
                alone(partner).tie(&of, &Opposite::Faces(placed, y), 0, node).unwrap().opening
            };
            let (now, plus_h, minus_h) = (with(0), with(0), with(1));
            let times_way =
                |rows: &Rows, i: usize| product(rows, i, |node| of_slave[node], |node| of_master[node]);
            for a in 0..dim - 1 {
                let slope = (plus_h.before[a] - minus_h.before[a]) / (2.0 * H);
                assert!(
                    (slope - times_way(&now, a)).abs() < 1e-7,
                    "{shape:?} {slope} {}",
                    times_way(&now, a)
                );
            }
            let (here, there) = (opened(0), opened(1));
            let of = Slave { faces: &slave.faces, x: &slave.x, begin: &slave.x };
            let own = alone(partner).tie(&of, &Opposite::Faces(placed, &master.x), 0, node).unwrap();
            for i in 0..3 {
                let slope = (here[i] - there[i]) / (2.0 * H);
                assert!((slope - times_way(&own, i)).abs() < 1e-7, "{shape:?} {i}");
            }
            let gaps = at.each_ref().map(|(x, y)| {
                let patch = master.faces.patch(foot.face, y);
                let w = plus(x[k], -1.0, patch.point(foot.r));
                match foot.is_inside {
                    true => dot(w, patch.normal(&shape.at(foot.r))),
                    false => foot.gap.signum() * length(w),
                }
            });
            if foot.distance > 1e-2 {
                let slope = (gaps[0] - gaps[1]) / (2.0 * H);
                assert!((slope - times_way(&now, 2)).abs() < 1e-7, "{shape:?}: {slope} {foot:?}");
            }
        }
    }
}

#[test]
fn directions_of_a_row_are_unit_vectors_across_each_other() {
    for shape in Shape::ALL {
        let case = case(shape, 0.1, 0.4);
        let Case { slave, master, normals } = &case;
        let placed = Placed { faces: &master.faces, x: &master.x, normals };
        for (k, partner) in all_found(slave, master).iter().enumerate() {
            let Some(partner) = partner else { continue };
            let of = Slave { faces: &slave.faces, x: &slave.x, begin: &slave.x };
            let all = alone(partner).rows(&of, &Opposite::Faces(placed, &master.x), 0, k as u32).unwrap();
            let [t, second, of_master] = all.directions;
            let normal = times(-1.0, of_master);
            assert!((length(t) - 1.0).abs() < 1e-15 && dot(t, normal).abs() < 1e-15);
            let expected = if shape.dim() == 2 { ZERO } else { cross(normal, t) };
            assert!(largest(plus(second, -1.0, expected)) < 1e-15);
            // in the plane along the slave's faces, whose body is on the left
            assert!(
                shape.dim() == 3
                    || largest(plus(t, -1.0, times(1.0, cross([0.0, 0.0, 1.0], normal)))) < 1e-15
            );
            assert!((0..2).all(|a| (all.before[a] - all.opening[a]).abs() < 1e-14), "nothing has slipped");
        }
    }
}
