//! Finds the correspondences of all paths of a frame.

use nalgebra::Point3;

use super::{
    Attraction, Correspondences, MaterialPoint, PathCorrespondence,
    centres::Centres,
    chart::Chart,
    fit::fit,
    image::Image,
    laid::{Laid, Mirror, are_mirrored, part_partner},
    lift::Lift,
    rbf::ThinPlate,
    sheets::Sheets,
    track::Track,
};
use crate::{
    analysis::Analysis,
    frame::Frame,
    mesh::{FaceId, Mesh, VertexId},
    paths::{PathPoint, PathSegment, Sheet},
    regions::starts_pair,
    settings::Settings,
    stage::StageObserver,
};

/// Rings of faces round a path and its region in its own chart.
const OWN_RINGS: usize = 1;
/// A chart stops growing at this many faces; targets beyond it are drawn back to its outline.
const MAX_FACES: usize = 40_000;

/// Finds correspondences, reusing its memory from frame to frame.
#[derive(Debug, Default)]
pub struct Correspondent {
    correspondences: Correspondences,
    charts: [Chart; 2],
    laid: Option<Laid>,
    track: Track,
    centres: Centres,
    plate: ThinPlate,
    face_points: Vec<(FaceId, usize, Point3<f64>)>,
}

impl Correspondent {
    /// Finds the correspondence of every path whose region divides its piece. Paths without one, and paths for which no chart
    /// exists, are left out; so are the shortest ones, once the observer says that time is up.
    ///
    /// Cost: for each path linear in its faces, its region and as much of the other sheet; cubic in its centres.
    pub fn find(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        analysis: &Analysis,
        settings: &Settings,
        observer: &mut dyn StageObserver,
    ) -> &Correspondences {
        self.clear();
        let order = &analysis.regions.order[..analysis.regions.num_done];
        for (place, &copy) in order.iter().enumerate() {
            if starts_pair(&analysis.paths, order, place) && observer.is_spent() {
                break;
            }
            if is_partitioning(analysis, copy) {
                let found = self.follow(mesh, frame, analysis, settings, copy);
                self.correspondences.paths.extend(found);
                self.track.face_own();
            }
            self.correspondences.num_done = place + 1;
        }
        self.correspondences.paths.sort_unstable_by_key(|path| path.copy);
        &self.correspondences
    }

    /// Forgets what was found.
    pub(crate) fn clear(&mut self) -> &Correspondences {
        self.correspondences.paths.clear();
        self.correspondences.attractions.clear();
        self.correspondences.separations.clear();
        self.correspondences.num_done = 0;
        self.laid = None;
        &self.correspondences
    }

    /// What was found last.
    pub(crate) fn found(&self) -> &Correspondences {
        &self.correspondences
    }

    /// The correspondence of one path with a region; nothing where there is no chart, the region lies on no side of the path, or the
    /// corresponding path answers for both.
    fn follow(
        &mut self,
        mesh: &Mesh,
        frame: &Frame,
        analysis: &Analysis,
        settings: &Settings,
        copy: usize,
    ) -> Option<PathCorrespondence> {
        let path = &analysis.paths.copies[copy];
        let points = &analysis.paths.points[path.points.clone()];
        let segments = &analysis.paths.segments[path.segments.clone()];
        let is_joint = analysis.regions.by_copy[copy].as_ref().is_some_and(|region| region.joint);
        if is_joint && path.partner < copy {
            return None;
        }
        let region = analysis.regions.vertices_of(copy);
        // Both paths round one region: each vertex of it belongs to another one of it, as in a fold.
        let partner_region = if is_joint {
            Some(region)
        } else {
            is_partitioning(analysis, path.partner).then(|| analysis.regions.vertices_of(path.partner))
        };
        let one_chart = path.partner == copy || is_joint;
        let edge_length_m = mean_edge_length(mesh, frame, segments)?;

        let laid = self.laid.take().filter(|laid| [laid.copy, laid.partner] == [path.partner, copy]);
        // No swap: the next frame shall find memory of the same size.
        let [first, second] = &mut self.charts;
        let (own, partner) = if laid.is_some() { (second, first) } else { (first, second) };
        let own_chart = if let Some(laid) = &laid {
            laid.kinds[1]
        } else {
            let patch = own.patch_mut();
            patch.start(mesh, segments.iter().map(|segment| segment.own));
            if is_joint {
                patch.add_faces(mesh, segments.iter().map(|segment| segment.partner));
            }
            patch.add_around(mesh, region);
            patch.grow(mesh, OWN_RINGS, MAX_FACES);
            own.build(mesh, frame)?
        };
        let mirror = laid.as_ref().and_then(|laid| laid.mirror.clone());
        if mirror.is_some() {
            self.track.face_partner();
        } else {
            if !self.track.lay_own(mesh, points, segments, path.closed, own) {
                return None;
            }
            own.set_period(self.track.own.period);
        }
        let partner_chart = if one_chart {
            own_chart
        } else if let Some(laid) = &laid {
            laid.kinds[0]
        } else {
            // A region there is where the targets lie; otherwise they reach as far as the region here.
            let rings = match partner_region {
                Some(_) => OWN_RINGS,
                None => depth(region, own, &self.track.own, edge_length_m).saturating_add(OWN_RINGS + 1),
            };
            let patch = partner.patch_mut();
            patch.start(mesh, segments.iter().map(|segment| segment.partner));
            patch.add_around(mesh, partner_region.unwrap_or(&[]));
            patch.grow(mesh, rings, MAX_FACES);
            partner.build(mesh, frame)?
        };
        if partner_region.is_some() && !one_chart && laid.is_none() {
            self.laid = Some(Laid { copy, partner: path.partner, kinds: [own_chart, partner_chart], mirror: None });
        }
        if mirror.is_none() {
            let other = if one_chart { &mut *own } else { &mut *partner };
            if !self.track.lay_partner(mesh, points, segments, other) {
                return None;
            }
            other.set_period(self.track.partner.period);
        }
        let (own, partner) = (&*own, if one_chart { &*own } else { &*partner });
        let (side, image_side) = if let Some(Mirror { sides, .. }) = &mirror {
            (sides.1?, Some(sides.0))
        } else {
            let mut side_of =
                |sheet, chart, region| self.track.region_side(mesh, points, segments, sheet, chart, region);
            let side = side_of(Sheet::Own, own, region)?;
            (side, partner_region.and_then(|region| side_of(Sheet::Partner, partner, region)))
        };
        let sheets = Sheets { mesh, frame, points, segments, own, partner };
        let sides = (side, image_side.unwrap_or_else(|| sheets.likelier_side(side)));

        let residual_m =
            fit(&mut self.centres, &mut self.plate, &self.track, sides, edge_length_m, is_joint, settings)?;
        // Each length of path counts once: a path that is its own partner runs over it twice, a pair with two regions comes twice.
        let share = if partner_region.is_some() && !is_joint { 0.5 } else { 1.0 };
        let (first_pull, first_parting) =
            (self.correspondences.attractions.len(), self.correspondences.separations.len());
        let separations = &mut self.correspondences.separations;
        if let Some(Mirror { separations: of_partner, .. }) = mirror {
            part_partner(separations, of_partner);
        } else {
            sheets.part(sides, share, separations);
        }
        if let Some(laid) = &mut self.laid
            && are_mirrored(&analysis.paths, [copy, path.partner])
        {
            let separations = first_parting..separations.len();
            laid.mirror = Some(Mirror { sides: (side, image_side), separations });
        }
        let image = Image { own, partner, track: &self.track, plate: &self.plate, sides };
        let attractions = &mut self.correspondences.attractions;
        let mut attraction = |source: MaterialPoint| {
            if let Some(target) = image.of(mesh, &source) {
                attractions.push(Attraction { source, target });
            }
        };
        if region.is_empty() {
            points_within(mesh, points, segments, &mut self.face_points, &mut attraction);
        }
        for &vertex in region {
            attraction(MaterialPoint::vertex(vertex));
        }
        Some(PathCorrespondence {
            copy,
            own_chart,
            partner_chart,
            round: self.track.own.period.is_some() && self.track.partner.period.is_some(),
            num_centres: self.centres.from.len(),
            rank_deficiency: self.centres.from.len() + 3 - self.plate.rank(),
            condition: self.plate.condition(),
            residual_m,
            edge_length_m,
            attractions: first_pull..self.correspondences.attractions.len(),
            separations: first_parting..self.correspondences.separations.len(),
        })
    }
}

/// One point inside on each face that a region without vertices runs through: the middle of the path's ways through the face.
/// Where there is only one such way there is no inside to speak of, and the path's own points must do.
fn points_within(
    mesh: &Mesh,
    points: &[PathPoint],
    segments: &[PathSegment],
    scratch: &mut Vec<(FaceId, usize, Point3<f64>)>,
    found: &mut impl FnMut(MaterialPoint),
) {
    scratch.clear();
    for (index, segment) in segments.iter().enumerate() {
        if let Some(middle) = MaterialPoint::middle(mesh, segment.own, [&points[index].own, &points[index + 1].own]) {
            scratch.push((segment.own, index, Point3::from(middle.weights)));
        }
    }
    scratch.sort_unstable_by_key(|&(face, index, _)| (face, index));
    for ways in scratch.chunk_by(|a, b| a.0 == b.0).filter(|ways| ways.len() > 1) {
        let mut weights = [0.0; 3];
        for (_, _, middle) in ways {
            for (sum, weight) in weights.iter_mut().zip(middle.iter()) {
                *sum += weight;
            }
        }
        let sum: f64 = weights.iter().sum();
        found(MaterialPoint { vertices: mesh.face(ways[0].0), weights: weights.map(|weight| weight / sum) });
    }
}

fn is_partitioning(analysis: &Analysis, copy: usize) -> bool {
    analysis.regions.by_copy[copy].as_ref().is_some_and(|region| region.partitioning)
}

/// How far, in edges, a region reaches from its path.
fn depth(region: &[VertexId], chart: &Chart, path: &Lift, edge_length_m: f64) -> usize {
    let distances = region.iter().filter_map(|&vertex| Some(path.nearest_copy(chart, chart.vertex(vertex)?).1));
    let depth = distances.filter(|distance| distance.is_finite()).fold(0.0, f64::max);
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "saturates, which is what is wanted")]
    let rings = (1.5 * depth / edge_length_m).ceil() as usize;
    rings
}

/// Mean edge length of the faces that a path runs through; nothing if it is zero.
pub(crate) fn mean_edge_length(mesh: &Mesh, frame: &Frame, segments: &[PathSegment]) -> Option<f64> {
    let mut sum = 0.0;
    for segment in segments {
        let [a, b, c] = mesh.face(segment.own).map(|vertex| frame.position(vertex));
        sum += (b - a).norm() + (c - b).norm() + (a - c).norm();
    }
    #[expect(clippy::cast_precision_loss, reason = "a count of segments")]
    let mean = sum / (3 * segments.len()) as f64;
    (mean.is_finite() && mean > 0.0).then_some(mean)
}
