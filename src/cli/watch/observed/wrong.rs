//! Cloth inside of bodies, and behind inner layers. Mesh and positions alone say it, so it is found out here, in the
//! process of the viewer: the session pays nothing for it.

use untangle::{
    frame::Frame,
    mesh::{Mesh, MeshDescription},
    sides::{Layers, Sides, WrongSide},
};
use untangled_client::observe::ObservedMesh;

/// A vertex on the wrong side, and how deep it is there in metres.
pub(super) type Wrong = (u32, f64);

/// What is on the wrong side in a frame.
#[derive(Debug, Default, PartialEq)]
pub(super) struct WrongSides {
    /// Inside of a body, ascending; of welded vertices the lowest.
    pub(super) body: Vec<Wrong>,
    /// Behind an inner layer.
    pub(super) layer: Vec<Wrong>,
}

/// Finds what is on the wrong side.
#[derive(Debug)]
pub(super) struct SideFinder {
    mesh: Mesh,
    frame: Frame,
    /// One thread: the others are the simulation's.
    threads: rayon::ThreadPool,
}

impl SideFinder {
    /// For a mesh with a body, or with several layers; nothing for others, or one that is no mesh.
    pub(super) fn new(observed: &ObservedMesh) -> Option<Self> {
        if observed.body.is_empty() && observed.layers.is_none() {
            return None;
        }
        let description = MeshDescription {
            num_vertices: observed.num_vertices,
            faces: observed.triangles.clone(),
            layers: observed.layers.clone(),
            body: observed.body.clone(),
            ..MeshDescription::default()
        };
        let mesh = Mesh::new(description).ok()?.with_outwards(observed.outwards.as_deref());
        let threads = rayon::ThreadPoolBuilder::new().num_threads(1).build().ok()?;
        Some(Self { mesh, frame: Frame::default(), threads })
    }

    /// What is on the wrong side at these positions, in metres; nothing where they can't be used.
    pub(super) fn find(&mut self, positions: &[[f32; 3]]) -> WrongSides {
        let Self { mesh, frame, threads } = self;
        if frame.set(mesh, positions.iter().map(|position| position.map(f64::from))).is_err() {
            return WrongSides::default();
        }
        let list = |found: Vec<WrongSide>| found.iter().map(|wrong| (wrong.vertex.0, wrong.way.depth_m)).collect();
        threads.install(|| {
            let sides = Sides::of(mesh, frame);
            let body = sides.as_ref().map(|sides| sides.wrong_vertices(mesh, frame)).unwrap_or_default();
            let layers = Layers::of(mesh, frame, sides.as_ref());
            let layer = layers.map(|layers| layers.behind(mesh, frame.positions())).unwrap_or_default();
            WrongSides { body: list(body), layer: list(layer) }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron with one corner at the origin, from vertex `first` on.
    fn tetrahedron(first: u32) -> [[u32; 3]; 4] {
        [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|face| face.map(|corner| corner + first))
    }

    const CORNERS: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn cloth_inside_of_a_body_is_found_with_its_depth() {
        let mesh = ObservedMesh {
            num_vertices: 7,
            triangles: [&[[0, 1, 2]][..], &tetrahedron(3)].concat(),
            body: vec![3, 4, 5, 6],
            ..ObservedMesh::default()
        };
        let mut finder = SideFinder::new(&mesh).unwrap();
        let positions = [&[[0.1, 0.2, 0.2], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]][..], &CORNERS].concat();
        let found = finder.find(&positions);
        assert_eq!((found.body.len(), found.body[0].0, found.layer), (1, 0, vec![]));
        assert!((found.body[0].1 - 0.1).abs() < 1e-6, "{:?}", found.body);
        let outside = [&[[0.1, 0.2, -0.2], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]][..], &CORNERS].concat();
        assert_eq!(finder.find(&outside), WrongSides::default());
        assert_eq!(finder.find(&[[f32::NAN; 3]; 7]), WrongSides::default());
    }

    #[test]
    fn what_is_behind_a_layer_hangs_on_what_the_daemon_says_is_outwards() {
        let sheet = |first: u32| [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]].map(|face| face.map(|k: u32| k + first));
        let mesh = |outwards| ObservedMesh {
            num_vertices: 10,
            triangles: [sheet(0), sheet(5)].concat(),
            layers: Some([[0; 5], [1; 5]].concat()),
            outwards: Some(vec![outwards; 8]),
            ..ObservedMesh::default()
        };
        let flat = |z: f32, size: f32| {
            [[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| [size * x, size * y, z])
        };
        let positions = [flat(0.0, 1.0), flat(0.1, 0.5)].concat();
        let behind = |outwards| SideFinder::new(&mesh(outwards)).unwrap().find(&positions).layer;
        assert_eq!(behind(true), [], "it lies over the inner layer");
        assert_eq!(behind(false).iter().map(|wrong| wrong.0).collect::<Vec<_>>(), [5, 6, 7, 8, 9]);
    }

    #[test]
    fn plain_cloth_and_what_is_no_mesh_have_no_sides() {
        let plain = ObservedMesh { num_vertices: 3, triangles: vec![[0, 1, 2]], ..ObservedMesh::default() };
        assert!(SideFinder::new(&plain).is_none());
        let broken = ObservedMesh { num_vertices: 3, triangles: vec![[0, 1, 1]], body: vec![0], ..plain };
        assert!(SideFinder::new(&broken).is_none());
    }
}
