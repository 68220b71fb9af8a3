//! Faces without a common vertex.

use super::{
    contact::{Contact, Crossing},
    corners::Corners,
};
use crate::{
    frame::Frame,
    mesh::{FaceId, Mesh},
    predicates::{Plane, Side},
};

/// Tests one pair of usable faces without a common vertex.
///
/// Cost: most pairs end after three signs.
// Not inlined: it is called rarely, from loops that have to be inlined whole.
#[inline(never)]
pub(crate) fn contact_of_disjoint(mesh: &Mesh, frame: &Frame, faces: [FaceId; 2]) -> Option<Contact> {
    // One order, so that nothing depends on how the pair was found.
    let [first, second] = if faces[0] < faces[1] { faces } else { [faces[1], faces[0]] };
    let (a, b) = (Corners::of(mesh, frame, first), Corners::of(mesh, frame, second));
    contact(mesh, &a, &b)
}

fn contact(mesh: &Mesh, a: &Corners, b: &Corners) -> Option<Contact> {
    let sides_b = b.sides_of(&a.plane());
    if sides_b[0] == sides_b[1] && sides_b[1] == sides_b[2] {
        return None;
    }
    let sides_a = a.sides_of(&b.plane());
    if sides_a[0] == sides_a[1] && sides_a[1] == sides_a[2] {
        return None;
    }
    // Each face crosses the other's plane along two edges, those of its lone corner. All four pierce the common line of
    // the planes; on which side of one of them another one passes says in which order, and so which lie within the
    // other face.
    let (lone_a, lone_b) = (lone_corner(sides_a), lone_corner(sides_b));
    let from_a = |step: usize| a.sites[(lone_a + step) % 3];
    let from_b = |step: usize| b.sites[(lone_b + step) % 3];
    // Of an edge of a from its corner p to q and one of b from r to s: the side of the plane (p, q, r) of s is that of
    // (p, r, s) of q.
    let first = Plane::through([from_a(0), from_b(0), from_b(1)]);
    let second = Plane::through([from_a(0), from_b(0), from_b(2)]);
    let (aa, ab) = (first.side_of(from_a(1)), second.side_of(from_a(1)));
    let (ba, bb) = (first.side_of(from_a(2)), second.side_of(from_a(2)));
    let edge_from = |of: &Corners, lone: usize, step: usize| of.edge_at(mesh, (lone + 2 * (step - 1)) % 3);
    let mut crossings: [Option<Crossing>; 2] = [None; 2];
    let mut num_crossings = 0;
    for (is_crossing, of, lone, step, face) in [
        (aa != ab, a, lone_a, 1, b),
        (ba != bb, a, lone_a, 2, b),
        (aa != ba, b, lone_b, 1, a),
        (ab != bb, b, lone_b, 2, a),
    ] {
        if is_crossing {
            assert!(num_crossings < 2, "faces {} and {} have three crossings", a.face.0, b.face.0);
            crossings[num_crossings] = Some((edge_from(of, lone, step), face.face));
            num_crossings += 1;
        }
    }
    match crossings {
        [Some(first), Some(second)] => Some(Contact::Crossings([first, second])),
        [None, _] => None,
        _ => panic!("faces {} and {} have one crossing: the signs are not consistent", a.face.0, b.face.0),
    }
}

/// The corner that lies on one side while the two others lie on the other.
fn lone_corner([a, b, c]: [Side; 3]) -> usize {
    if b == c {
        0
    } else if a == c {
        1
    } else {
        2
    }
}
